/* nevh: blocks and their points written by hand, as vector code.
   SPDX-License-Identifier: GPL-3.0-or-later

   <nevh/body.h> makes them from one text, and includes this. */
#ifndef NEVH_SIMD_H
#define NEVH_SIMD_H

#include <nevh/status.h>
#include <math.h>
#include <stddef.h>

#if defined __GNUC__ && !defined __clang__ && __GNUC__ >= 12 &&                \
    defined __x86_64__ && defined __LP64__ && defined __GLIBC__ &&             \
    !defined NEVH_PORTABLE && !defined __SANITIZE_ADDRESS__ &&                 \
    !defined __SANITIZE_THREAD__ && !defined __SSP_ALL__
/* Under the last three the choice among a function's versions may crash as the
   program starts, or nothing becomes vector code. */
#define NEVH__VECTORS 1
#endif

/* GCC inlines into a function with flags of its own only what it must. */
#ifdef __GNUC__
#define NEVH__MAYBE_UNUSED __attribute__((unused))
#define NEVH__INLINE       __attribute__((always_inline)) static inline
#else
#define NEVH__MAYBE_UNUSED
#define NEVH__INLINE static inline
#endif

/* For blocks written by hand:

       NEVH_SIMD static void my_gradient(size_t width, ...) {
           NEVH_LANES(i, width) {
               dh_dq[i] = c[i] * nevh_simd_sin(q[i]);
           }
       }

   NEVH_SIMD has GCC make the function three times, for AVX-512, AVX2 and any
   x86-64, of which the program takes the best as it starts.  Nothing in it
   changes a result: no-math-errno and no-trapping-math give up errno and exception
   flags alone.
   NEVH_LANES takes eight lanes at a time, so that all of them, of whatever
   width, go through the same code; width must be a multiple of 8, and no lane
   may read what another one writes. */
#ifdef NEVH__VECTORS
#define NEVH__CLONES(slp)                                                      \
    __attribute__((                                                            \
        target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"),          \
        optimize("O2", "tree-loop-vectorize", slp,                             \
                 "vect-cost-model=unlimited", "fp-contract=off",               \
                 "no-math-errno", "no-trapping-math")))
#define NEVH_SIMD NEVH__CLONES("tree-slp-vectorize")
#define NEVH_LANES(i, width)                                                   \
    for (size_t i##_from = 0; i##_from < (width); i##_from += 8)               \
    _Pragma("GCC ivdep") for (size_t i = i##_from; i != i##_from + 8; i++)
#define NEVH_UNROLL _Pragma("GCC unroll 16")
#else
#define NEVH_SIMD
#define NEVH_POINT
#define NEVH_LANES(i, width) for (size_t i = 0; i < (width); i++)
#define NEVH_UNROLL
#endif

/* Elementary functions, arguments and domains being those of <math.h>: errors below
   1 ulp, and the same bits on every machine, of one number and of vectors.  With
   NEVH_SIMD, calls in NEVH_LANES are of vectors.  Outside its domain a function is NaN;
   errno is not set, and floating-point flags that are left mean nothing.  Rounding has to
   be to nearest.  Thread-safe.
   nevh_simd_power is pow.  So is nevh_simd_pow, but with optimization the exponents
   -2, -1, 1, 2, 3 and 4 that the compiler knows become products. */
#if defined NEVH__VECTORS && !defined NEVH__ELEMENTARY
#define NEVH__VECTOR __attribute__((simd("notinbranch"), const, nothrow))
#elif defined __GNUC__
#define NEVH__VECTOR __attribute__((const, nothrow))
#else
#define NEVH__VECTOR
#endif
#ifdef __cplusplus
extern "C" {
#endif
NEVH_API double nevh_simd_sin(double) NEVH__VECTOR;
NEVH_API double nevh_simd_cos(double) NEVH__VECTOR;
NEVH_API double nevh_simd_tan(double) NEVH__VECTOR;
NEVH_API double nevh_simd_asin(double) NEVH__VECTOR;
NEVH_API double nevh_simd_acos(double) NEVH__VECTOR;
NEVH_API double nevh_simd_atan(double) NEVH__VECTOR;
NEVH_API double nevh_simd_sinh(double) NEVH__VECTOR;
NEVH_API double nevh_simd_cosh(double) NEVH__VECTOR;
NEVH_API double nevh_simd_tanh(double) NEVH__VECTOR;
NEVH_API double nevh_simd_asinh(double) NEVH__VECTOR;
NEVH_API double nevh_simd_acosh(double) NEVH__VECTOR;
NEVH_API double nevh_simd_atanh(double) NEVH__VECTOR;
NEVH_API double nevh_simd_exp(double) NEVH__VECTOR;
NEVH_API double nevh_simd_log(double) NEVH__VECTOR;
NEVH_API double nevh_simd_log10(double) NEVH__VECTOR;
NEVH_API double nevh_simd_cbrt(double) NEVH__VECTOR;
NEVH_API double nevh_simd_atan2(double y, double x) NEVH__VECTOR;
NEVH_API double nevh_simd_hypot(double, double) NEVH__VECTOR;
NEVH_API double nevh_simd_power(double, double) NEVH__VECTOR;
#ifdef NEVH__VECTORS
/* GCC has no vector form of a root that may set errno. */
extern double __builtin_sqrt(double) __attribute__((const));
#define nevh_simd_sqrt __builtin_sqrt
#else
#define nevh_simd_sqrt sqrt
#endif
#ifdef __cplusplus
}
#endif

NEVH__INLINE double nevh_simd_pow(double x, double y) {
#ifdef __GNUC__
    if (__builtin_constant_p(y)) {
        double square = x * x;
        if (y == -2)
            return 1 / square;
        if (y == -1)
            return 1 / x;
        if (y == 1)
            return x;
        if (y == 2)
            return square;
        if (y == 3)
            return square * x;
        if (y == 4)
            return square * square;
    }
#endif
    return nevh_simd_power(x, y);
}

/* nevh_point_sin etc. are other names, for point gradients written by hand, which
   give what their blocks do, bit for bit:

       NEVH_POINT static void my_point_gradient(double t, ...) {
           if (dh_dq)
               dh_dq[0] = c[0] * nevh_point_sin(q[0]);
       }

   NEVH_POINT is NEVH_SIMD, but stores numbers one by one, as they will be read: two
   joined in a vector have to wait. */
#ifdef NEVH__VECTORS
#define NEVH_POINT NEVH__CLONES("no-tree-slp-vectorize")
#endif
#define nevh_point_sin   nevh_simd_sin
#define nevh_point_cos   nevh_simd_cos
#define nevh_point_tan   nevh_simd_tan
#define nevh_point_asin  nevh_simd_asin
#define nevh_point_acos  nevh_simd_acos
#define nevh_point_atan  nevh_simd_atan
#define nevh_point_sinh  nevh_simd_sinh
#define nevh_point_cosh  nevh_simd_cosh
#define nevh_point_tanh  nevh_simd_tanh
#define nevh_point_exp   nevh_simd_exp
#define nevh_point_log   nevh_simd_log
#define nevh_point_sqrt  nevh_simd_sqrt
#define nevh_point_cbrt  nevh_simd_cbrt
#define nevh_point_pow   nevh_simd_pow
#define nevh_point_atan2 nevh_simd_atan2
#define nevh_point_hypot nevh_simd_hypot

#endif
