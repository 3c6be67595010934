/* nevh: what formulas need before them in compiled steps, but for elementary functions.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COMPILED_FORMULAS_H
#define NEVH_COMPILED_FORMULAS_H

typedef __SIZE_TYPE__ size, size_t;
typedef __UINT64_TYPE__ uint64_t;
typedef __UINT32_TYPE__ uint32_t;
_Static_assert(sizeof(double) == sizeof 1.0 && sizeof(size) == sizeof(void *),
               "double or size_t is another type in CC");
#ifdef NEVH__PLAIN_DOUBLES /* sums and products of nevh are no longer than doubles */
_Static_assert(__FLT_EVAL_METHOD__ >= 0 && __FLT_EVAL_METHOD__ != 2,
               "CC computes in another precision than nevh");
#endif
#define INLINE       static inline __attribute__((always_inline, unused))
#define NEVH__INLINE INLINE
#define SLOPE        INLINE
#define NEVH__MAIN   static __attribute__((noinline, unused))
#define CONST        __attribute__((const))
#define bool _Bool
#define true 1
#define false 0
#define NULL     ((void *)0)
#define INFINITY __builtin_inf()
#define NAN      __builtin_nan("")
#define memcpy   __builtin_memcpy
typedef double few __attribute__((vector_size(32), aligned(8)));
#define ALL_FOUR(x)  ((few){x, x, x, x})
#define EACH_OF_FOUR for (int lane = 0; lane < 4; lane++)
#ifdef NEVH__FOUR_TOGETHER
typedef few wide;
#define ALL       ALL_FOUR
#define EACH_LANE EACH_OF_FOUR
#else
typedef double wide __attribute__((vector_size(64), aligned(8)));
#define ALL(x)    ((wide){x, x, x, x, x, x, x, x})
#define EACH_LANE for (int lane = 0; lane < 8; lane++)
#endif
typedef double couple __attribute__((vector_size(16), aligned(8)));
extern double fabs(double) CONST, floor(double) CONST, rint(double) CONST;
extern double sqrt(double) CONST, fmod(double, double) CONST;

INLINE wide wide_sqrt(wide x) {
    wide y;
    EACH_LANE y[lane] = __builtin_sqrt(x[lane]);
    return y;
}

INLINE couple couple_sqrt(couple x) {
    return (couple){__builtin_sqrt(x[0]), __builtin_sqrt(x[1])};
}

INLINE few few_sqrt(few x) {
    few y;
    EACH_OF_FOUR y[lane] = __builtin_sqrt(x[lane]);
    return y;
}

#endif
