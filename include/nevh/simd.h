/* nevh: blocks and their points written by hand, as vector code.
   SPDX-License-Identifier: GPL-3.0-or-later

   <nevh/body.h> makes them from one text, and includes this. */
#ifndef NEVH_SIMD_H
#define NEVH_SIMD_H

#include <math.h>
#include <stddef.h>

#if defined __GNUC__ && !defined __clang__ && defined __x86_64__ &&            \
    defined __LP64__ && defined __GLIBC__ && !defined NEVH_PORTABLE &&         \
    !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__ &&           \
    !defined __SSP_ALL__
/* Under the last three the choice among a function's versions may crash as the
   program starts, or nothing becomes vector code. */
#if __GNUC__ >= 12 && __GLIBC_PREREQ(2, 22)
#define NEVH__VECTORS 1
#if __GLIBC_PREREQ(2, 35)
#define NEVH__VECTORS_MORE 1
#endif
#endif
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
   changes a result but by the vector functions' own rounding, below 4 ulp:
   no-math-errno and no-trapping-math give up errno and exception flags alone.
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

/* The vector functions of glibc's libmvec, under names that are unknown to GCC: it
   would replace the sine and cosine of one angle by a complex exponential, which
   has no vector form. */
#ifdef NEVH__VECTORS
#ifdef __cplusplus
extern "C" {
#endif
#define NEVH__VECTOR __attribute__((simd("notinbranch"), const, nothrow))
#define NEVH__VECTOR1(f)                                                       \
    extern double nevh_simd_##f(double) __asm__(#f) NEVH__VECTOR;
#define NEVH__VECTOR2(f)                                                       \
    extern double nevh_simd_##f(double, double) __asm__(#f) NEVH__VECTOR;
NEVH__VECTOR1(sin)
NEVH__VECTOR1(cos)
NEVH__VECTOR1(exp)
NEVH__VECTOR1(log)
extern double nevh__simd_libm_pow(double, double) __asm__("pow") NEVH__VECTOR;
#ifdef NEVH__VECTORS_MORE
NEVH__VECTOR1(tan)
NEVH__VECTOR1(asin)
NEVH__VECTOR1(acos)
NEVH__VECTOR1(atan)
NEVH__VECTOR1(sinh)
NEVH__VECTOR1(cosh)
NEVH__VECTOR1(tanh)
NEVH__VECTOR1(cbrt)
NEVH__VECTOR2(atan2)
NEVH__VECTOR2(hypot)
#endif
#undef NEVH__VECTOR2
#undef NEVH__VECTOR1
#undef NEVH__VECTOR
/* GCC has no vector form of a root that may set errno. */
extern double __builtin_sqrt(double) __attribute__((const));
#define nevh_simd_sqrt __builtin_sqrt
#ifdef __cplusplus
}
#endif

/* GCC spares us small powers of its own pow alone. */
#define NEVH__POW(name, f)                                                     \
    NEVH__INLINE double name(double x, double y) {                             \
        if (!__builtin_constant_p(y))                                          \
            return f(x, y);                                                    \
        return y == -2   ? 1 / (x * x)                                         \
               : y == -1 ? 1 / x                                               \
               : y == 1  ? x                                                   \
               : y == 2  ? x * x                                               \
               : y == 3  ? x * x * x                                           \
               : y == 4  ? x * x * (x * x)                                     \
                         : f(x, y);                                             \
    }
NEVH__POW(nevh_simd_pow, nevh__simd_libm_pow)
#else
#define nevh_simd_sin  sin
#define nevh_simd_cos  cos
#define nevh_simd_exp  exp
#define nevh_simd_log  log
#define nevh_simd_pow  pow
#define nevh_simd_sqrt sqrt
#endif
#ifndef NEVH__VECTORS_MORE
#define nevh_simd_tan   tan
#define nevh_simd_asin  asin
#define nevh_simd_acos  acos
#define nevh_simd_atan  atan
#define nevh_simd_sinh  sinh
#define nevh_simd_cosh  cosh
#define nevh_simd_tanh  tanh
#define nevh_simd_cbrt  cbrt
#define nevh_simd_atan2 atan2
#define nevh_simd_hypot hypot
#endif

/* For point gradients written by hand, which must give what their blocks do,
   bit for bit:

       NEVH_POINT static void my_point_gradient(double t, ...) {
           if (dh_dq)
               dh_dq[0] = c[0] * nevh_point_sin(q[0]);
       }

   Arithmetic and roots are rounded alike anywhere, functions like sine are not:
   nevh_point_sin etc. are for one number what nevh_simd_sin is for eight, in
   eight lanes of which one counts.  NEVH_POINT is NEVH_SIMD, but stores numbers
   one by one, as they will be read: two joined in a vector have to wait. */
#ifdef NEVH__VECTORS
#define NEVH_POINT NEVH__CLONES("no-tree-slp-vectorize")

/* Added to equal numbers these make lanes of them that GCC takes for different
   ones, so that it calls a vector function. */
static const double nevh__nothing[] __attribute__((aligned(64), unused)) = {
    -0., -0., -0., -0., -0., -0., -0., -0.};

NEVH__INLINE const double *nevh__unlike(void) {
    const double *nothing = nevh__nothing;
    __asm__("" : "+r"(nothing));
    return nothing;
}
#define NEVH__UNLIKE(i) nothing[i - i##_from]

#define NEVH__POINT1(name, f)                                                  \
    NEVH__INLINE double name(double x) {                                       \
        const double *nothing = nevh__unlike();                                \
        double lanes[8];                                                       \
        NEVH_LANES(i, 8) {                                                     \
            lanes[i] = f(x + nothing[i]);                                      \
        }                                                                      \
        return lanes[0];                                                       \
    }
#define NEVH__POINT2(name, f)                                                  \
    NEVH__INLINE double name(double x, double y) {                             \
        const double *nothing = nevh__unlike();                                \
        double lanes[8];                                                       \
        NEVH_LANES(i, 8) {                                                     \
            lanes[i] = f(x + nothing[i], y + nothing[i]);                      \
        }                                                                      \
        return lanes[0];                                                       \
    }
NEVH__POINT1(nevh_point_sin, nevh_simd_sin)
NEVH__POINT1(nevh_point_cos, nevh_simd_cos)
NEVH__POINT1(nevh_point_exp, nevh_simd_exp)
NEVH__POINT1(nevh_point_log, nevh_simd_log)
NEVH__POINT2(nevh__point_libm_pow, nevh__simd_libm_pow)
NEVH__POW(nevh_point_pow, nevh__point_libm_pow)
#ifdef NEVH__VECTORS_MORE
NEVH__POINT1(nevh_point_tan, nevh_simd_tan)
NEVH__POINT1(nevh_point_asin, nevh_simd_asin)
NEVH__POINT1(nevh_point_acos, nevh_simd_acos)
NEVH__POINT1(nevh_point_atan, nevh_simd_atan)
NEVH__POINT1(nevh_point_sinh, nevh_simd_sinh)
NEVH__POINT1(nevh_point_cosh, nevh_simd_cosh)
NEVH__POINT1(nevh_point_tanh, nevh_simd_tanh)
NEVH__POINT1(nevh_point_cbrt, nevh_simd_cbrt)
NEVH__POINT2(nevh_point_atan2, nevh_simd_atan2)
NEVH__POINT2(nevh_point_hypot, nevh_simd_hypot)
#endif
#undef NEVH__POINT2
#undef NEVH__POINT1
#else
NEVH__INLINE const double *nevh__unlike(void) {
    return NULL;
}
#define NEVH__UNLIKE(i) -0.
#define nevh_point_sin  sin
#define nevh_point_cos  cos
#define nevh_point_exp  exp
#define nevh_point_log  log
#define nevh_point_pow  pow
#endif
#define nevh_point_sqrt nevh_simd_sqrt
#ifndef NEVH__VECTORS_MORE
#define nevh_point_tan   tan
#define nevh_point_asin  asin
#define nevh_point_acos  acos
#define nevh_point_atan  atan
#define nevh_point_sinh  sinh
#define nevh_point_cosh  cosh
#define nevh_point_tanh  tanh
#define nevh_point_cbrt  cbrt
#define nevh_point_atan2 atan2
#define nevh_point_hypot hypot
#endif

#endif
