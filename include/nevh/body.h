/* nevh: all forms of a term from one body, and of its gradient from another.
   SPDX-License-Identifier: GPL-3.0-or-later

   A term has up to three functions of the same meaning: value takes one state,
   block many at once, complex_value one state over complex numbers, for
   derivatives without truncation.  NEVH_BODY makes the three from one text:

       typedef struct { double m, l, g; } rod;

       NEVH_BODY(pendulum, rod, {
           nevh_num v = nevh_p(0) / params->l;
           return v * v / (2 * params->m) -
                  params->m * params->g * params->l * nevh_cos(nevh_q(0));
       })

       const rod mine = {1, 0.5, 9.8};
       nevh_term term = {.effect = "all", .nq = 1, .np = 1, .params = &mine,
                         NEVH_FORMS(pendulum)};

   In the body
       nevh_q(k) nevh_p(k)  the instance's k-th coordinate and momentum
       nevh_c(k) nevh_t     its k-th constant, and time: double
       params               const rod *; where there are none, name it void
       nevh_num             the type of whatever comes from q or p
       nevh_sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt cbrt
       pow hypot abs min max, each with nevh_ before it
       nevh_real(x)         the real part, for what must be compared

   Exact derivatives are written once, too, if one has them:

       NEVH_GRADIENT(pendulum, rod, {
           nevh_dh_dq(0) = params->m * params->g * params->l *
                           nevh_sin(nevh_q(0));
           nevh_dh_dp(0) = nevh_p(0) / (params->m * params->l * params->l);
       })

       nevh_term term = {..., NEVH_FORMS(pendulum), NEVH_GRADIENTS(pendulum)};

   makes gradient, which takes many states, and point_gradient, which takes one
   and gives the same bits.  There nevh_num is double.  nevh_dh_dq(k) and
   nevh_dh_dp(k) are assigned to, and not read; each half is computed only where
   it is wanted.  The same bits come from a body as simple as the next paragraph
   asks for, which then is done eight states at once; where nevh says that the
   point gradient of a body is not its gradient, the body is not, and the term
   takes .gradient = pendulum_gradient alone.

   Helpers that take a nevh_num must be macros, since a function takes either
   double or complex numbers.  2, 4 or 8 states are done at once where a body
   calls nothing but these functions, none of them under an if or a ?:, and has
   NEVH_UNROLL before a loop, whose number of rounds must be a constant, at most
   16.  That takes no flags, only GCC 12 on x86-64 with glibc.  Elsewhere, with
   -DNEVH_PORTABLE, or where a body is less simple, a block goes from state to
   state.

   NEVH_BODY and NEVH_GRADIENT are for C11.  C++ finds NEVH_SIMD, NEVH_LANES,
   NEVH_UNROLL, NEVH_POINT, nevh_simd_sin and nevh_point_sin etc. alone. */
#ifndef NEVH_BODY_H
#define NEVH_BODY_H

#include <nevh/system.h>
#include <math.h>

#if defined __GNUC__ && !defined __clang__ && defined __x86_64__ &&            \
    defined __LP64__ && defined __GLIBC__ && !defined NEVH_PORTABLE &&         \
    !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__ &&           \
    !defined __SSP_ALL__
/* Under the last three the choice among a function's versions may crash as the
   program starts, or nothing becomes vector code. */
#if __GNUC__ >= 12 && __GLIBC_PREREQ(2, 22)
#define NEVH__VECTORS 1
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

/* What glibc's libmvec has in vector form.  Under names that GCC does not
   know: it would join the sine and cosine of one angle to a complex
   exponential, which has none. */
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
extern double nevh__simd_pow(double, double) __asm__("pow") NEVH__VECTOR;
#if __GLIBC_PREREQ(2, 35)
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
NEVH__POW(nevh_simd_pow, nevh__simd_pow)
#else
#define nevh_simd_sin  sin
#define nevh_simd_cos  cos
#define nevh_simd_exp  exp
#define nevh_simd_log  log
#define nevh_simd_pow  pow
#define nevh_simd_sqrt sqrt
#endif
#if !defined NEVH__VECTORS || !__GLIBC_PREREQ(2, 35)
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
NEVH__POINT2(nevh__point_pow, nevh__simd_pow)
NEVH__POW(nevh_point_pow, nevh__point_pow)
#if __GLIBC_PREREQ(2, 35)
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
#if !defined NEVH__VECTORS || !__GLIBC_PREREQ(2, 35)
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

#ifndef __cplusplus

/* Complex numbers of tiny imaginary part: f(a + ib) = f(a) + ib f'(a).  What
   is real stays real, also where f' is infinite.  <complex.h> is kept away,
   since it takes the name I. */

typedef union {
    double part[2];
    double _Complex z;
} nevh__complex;

NEVH__INLINE double nevh__re(double _Complex z) {
    return ((nevh__complex){.z = z}).part[0];
}

NEVH__INLINE double nevh__im(double _Complex z) {
    return ((nevh__complex){.z = z}).part[1];
}

NEVH__INLINE double _Complex nevh__pair(double a, double b) {
    return ((nevh__complex){.part = {a, b}}).z;
}

#define NEVH__TIMES(slope, b) ((b) == 0 ? 0 : (slope) * (b))
/* In slope, a is the argument and f the function's value. */
#define NEVH__ANALYTIC(name, slope)                                            \
    NEVH__INLINE double _Complex nevh__complex_##name(double _Complex z) {     \
        double a = nevh__re(z), b = nevh__im(z), f = name(a);                  \
        return nevh__pair(f, NEVH__TIMES(slope, b));                           \
    }
/* Here a and c are the arguments. */
#define NEVH__ANALYTIC2(name, slope_a, slope_c)                                \
    NEVH__INLINE double _Complex nevh__complex_##name(double _Complex y,       \
                                                      double _Complex z) {     \
        double a = nevh__re(y), b = nevh__im(y);                               \
        double c = nevh__re(z), d = nevh__im(z), f = name(a, c);               \
        return nevh__pair(f,                                                   \
                          NEVH__TIMES(slope_a, b) + NEVH__TIMES(slope_c, d));  \
    }
NEVH__ANALYTIC(sin, cos(a))
NEVH__ANALYTIC(cos, -sin(a))
NEVH__ANALYTIC(tan, 1 + f * f)
NEVH__ANALYTIC(asin, 1 / sqrt((1 - a) * (1 + a)))
NEVH__ANALYTIC(acos, -1 / sqrt((1 - a) * (1 + a)))
NEVH__ANALYTIC(atan, 1 / (1 + a * a))
NEVH__ANALYTIC(sinh, cosh(a))
NEVH__ANALYTIC(cosh, sinh(a))
NEVH__ANALYTIC(tanh, 1 / cosh(a) / cosh(a)) /* 1 - f^2 would cancel */
NEVH__ANALYTIC(exp, f)
NEVH__ANALYTIC(log, 1 / a)
NEVH__ANALYTIC(sqrt, 0.5 / f)
NEVH__ANALYTIC(cbrt, 1 / (3 * f * f))
NEVH__ANALYTIC2(atan2, c / hypot(a, c) / hypot(a, c),
                -a / hypot(a, c) / hypot(a, c))
NEVH__ANALYTIC2(hypot, a / f, c / f)
NEVH__ANALYTIC2(pow, c == 0 ? 0 : c * pow(a, c - 1),
                a == 0 && c > 0 ? 0 : f * log(a))
#undef NEVH__ANALYTIC2
#undef NEVH__ANALYTIC
#undef NEVH__TIMES

NEVH__INLINE double _Complex nevh__complex_abs(double _Complex z) {
    return nevh__re(z) < 0 ? -z : z;
}

NEVH__INLINE double nevh__same(double x) {
    return x;
}

/* Of two numbers one that is NaN wins, so that it is noticed. */

NEVH__INLINE double nevh__min(double x, double y) {
    return x != x || x < y ? x : y;
}

NEVH__INLINE double nevh__max(double x, double y) {
    return x != x || x > y ? x : y;
}

NEVH__INLINE double _Complex nevh__complex_min(double _Complex x,
                                               double _Complex y) {
    double a = nevh__re(x);
    return a != a || a < nevh__re(y) ? x : y;
}

NEVH__INLINE double _Complex nevh__complex_max(double _Complex x,
                                               double _Complex y) {
    double a = nevh__re(x);
    return a != a || a > nevh__re(y) ? x : y;
}

/* One lane of a block.  In each form of a body nevh__q is of another type, by
   which the functions are chosen. */
typedef struct {
    const double *x;
    size_t width, lane;
} nevh__lanes;

NEVH__INLINE double nevh__of_state(const double *x, size_t k) {
    return x[k];
}

/* One state of a gradient. */
typedef struct {
    const double *x;
} nevh__one;

NEVH__INLINE double nevh__of_one(nevh__one x, size_t k) {
    return x.x[k];
}

NEVH__INLINE double nevh__of_lane(nevh__lanes x, size_t k) {
    return x.x[k * x.width + x.lane];
}

NEVH__INLINE double _Complex nevh__of_complex(const double (*x)[2], size_t k) {
    return nevh__pair(x[k][0], x[k][1]);
}

/* clang-format 14 does not know _Generic. */
// clang-format off
#define NEVH__AT(x, k)                                                         \
    _Generic((x), const double *: nevh__of_state,                              \
                  nevh__lanes: nevh__of_lane,                                  \
                  nevh__one: nevh__of_one,                                     \
                  const double (*)[2]: nevh__of_complex)((x), (size_t)(k))
#define NEVH__ANY(x, real, complex)                                            \
    _Generic((x), double _Complex: complex, default: real)
#define NEVH__LIBM(f, x)                                                       \
    NEVH__ANY(x, _Generic(nevh__q, nevh__lanes: nevh_simd_##f,                 \
                                   nevh__one: nevh_point_##f, default: f),     \
              nevh__complex_##f)
// clang-format on
#define NEVH__OWN(f, x)  NEVH__ANY(x, nevh__##f, nevh__complex_##f)
#define nevh_q(k)        NEVH__AT(nevh__q, k)
#define nevh_p(k)        NEVH__AT(nevh__p, k)
#define nevh_c(k)        NEVH__AT(nevh__c, k)
#define nevh_sin(x)      NEVH__LIBM(sin, x)((x) + nevh__none)
#define nevh_cos(x)      NEVH__LIBM(cos, x)((x) + nevh__none)
#define nevh_tan(x)      NEVH__LIBM(tan, x)((x) + nevh__none)
#define nevh_asin(x)     NEVH__LIBM(asin, x)((x) + nevh__none)
#define nevh_acos(x)     NEVH__LIBM(acos, x)((x) + nevh__none)
#define nevh_atan(x)     NEVH__LIBM(atan, x)((x) + nevh__none)
#define nevh_atan2(y, x) NEVH__LIBM(atan2, (y) + (x))((y) + nevh__none, x)
#define nevh_sinh(x)     NEVH__LIBM(sinh, x)((x) + nevh__none)
#define nevh_cosh(x)     NEVH__LIBM(cosh, x)((x) + nevh__none)
#define nevh_tanh(x)     NEVH__LIBM(tanh, x)((x) + nevh__none)
#define nevh_exp(x)      NEVH__LIBM(exp, x)((x) + nevh__none)
#define nevh_log(x)      NEVH__LIBM(log, x)((x) + nevh__none)
#define nevh_sqrt(x)     NEVH__LIBM(sqrt, x)(x)
#define nevh_cbrt(x)     NEVH__LIBM(cbrt, x)((x) + nevh__none)
#define nevh_pow(x, y)   NEVH__LIBM(pow, (x) + (y))((x) + nevh__none, y)
#define nevh_hypot(x, y) NEVH__LIBM(hypot, (x) + (y))((x) + nevh__none, y)
#define nevh_abs(x)      NEVH__ANY(x, fabs, nevh__complex_abs)(x)
#define nevh_min(x, y)   NEVH__OWN(min, (x) + (y))(x, y)
#define nevh_max(x, y)   NEVH__OWN(max, (x) + (y))(x, y)
#define nevh_real(x)     NEVH__ANY(x, nevh__same, nevh__re)(x)

/* Products without a search for NaN; quotients that do not overflow. */
#if defined __GNUC__ && !defined __clang__
#define NEVH__COMPLEX __attribute__((optimize("cx-fortran-rules")))
#else
#define NEVH__COMPLEX
#endif

/* One form of a body: its numbers, what is added to arguments, which is -0.,
   and the body. */
#define NEVH__FORM(number, nothing, params_type, ...)                          \
    {                                                                          \
        NEVH__MAYBE_UNUSED typedef number nevh_num;                            \
        NEVH__MAYBE_UNUSED const double nevh__none = nothing;                  \
        const params_type *params = nevh__params;                              \
        (void)nevh_t, (void)nevh__q, (void)nevh__p, (void)nevh__c;             \
        (void)params;                                                          \
        __VA_ARGS__                                                            \
    }

/* Defines NAME_value, NAME_block and NAME_complex, static functions of the
   types in nevh_term.  The body, in braces, comes last; it may ask only for
   what the term declares to read. */
// clang-format off
#define NEVH_BODY(name, params_type, ...)                                      \
    NEVH__MAYBE_UNUSED static double name##_value(                             \
        double nevh_t, const double *nevh__q, const double *nevh__p,           \
        const double *nevh__c, const void *nevh__params)                       \
    NEVH__FORM(double, -0., params_type, __VA_ARGS__)                          \
                                                                               \
    NEVH__INLINE double name##_lane(                                           \
        double nevh_t, nevh__lanes nevh__q, nevh__lanes nevh__p,               \
        nevh__lanes nevh__c, const void *nevh__params)                         \
    NEVH__FORM(double, -0., params_type, __VA_ARGS__)                          \
                                                                               \
    NEVH__MAYBE_UNUSED NEVH_SIMD static void name##_block(                     \
        size_t width, const double *t, const double *q, const double *p,       \
        const double *c, const void *params, double *h)                        \
    {                                                                          \
        NEVH_LANES(i, width) {                                                 \
            h[i] = name##_lane(t[i], (nevh__lanes){q, width, i},               \
                               (nevh__lanes){p, width, i},                     \
                               (nevh__lanes){c, width, i}, params);            \
        }                                                                      \
    }                                                                          \
                                                                               \
    NEVH__COMPLEX NEVH__INLINE double _Complex name##_analytic(                \
        double nevh_t, const double (*nevh__q)[2],                             \
        const double (*nevh__p)[2], const double *nevh__c,                     \
        const void *nevh__params)                                              \
    NEVH__FORM(double _Complex, -0., params_type, __VA_ARGS__)                 \
                                                                               \
    NEVH__MAYBE_UNUSED NEVH__COMPLEX static void name##_complex(               \
        double t, const double (*q)[2], const double (*p)[2],                  \
        const double *c, const void *params, double h[2])                      \
    {                                                                          \
        double _Complex sum = name##_analytic(t, q, p, c, params);             \
        h[0] = nevh__re(sum);                                                  \
        h[1] = nevh__im(sum);                                                  \
    }
// clang-format on

/* The three of them, in a nevh_term's initialiser. */
#define NEVH_FORMS(name)                                                       \
    .value = name##_value, .block = name##_block,                              \
    .complex_value = name##_complex

/* Where a gradient's body writes.  What nobody wants goes nowhere, and GCC, who
   knows beforehand, leaves it out with all that leads to it. */
typedef struct {
    double *x;
    size_t width, lane;
    bool wanted;
    double *nowhere;
} nevh__slopes;

NEVH__INLINE double *nevh__slope(nevh__slopes d, size_t k) {
    return d.wanted ? d.x + (k * d.width + d.lane) : d.nowhere;
}

#define nevh_dh_dq(k) (*nevh__slope(nevh__dh_dq, (size_t)(k)))
#define nevh_dh_dp(k) (*nevh__slope(nevh__dh_dp, (size_t)(k)))

// clang-format off
#define NEVH__GRADIENT_FORM(name, rows, params_type, ...)                      \
    NEVH__INLINE void name(double nevh_t, rows nevh__q, rows nevh__p,          \
                           rows nevh__c, const void *nevh__params,             \
                           double nothing, nevh__slopes nevh__dh_dq,           \
                           nevh__slopes nevh__dh_dp)                           \
    {                                                                          \
        (void)nevh__dh_dq, (void)nevh__dh_dp;                                  \
        NEVH__FORM(double, nothing, params_type, __VA_ARGS__)                  \
    }

/* All lanes, for the halves that are wanted: constants. */
#define NEVH__GRADIENT_LANES(name, q_too, p_too)                               \
    NEVH_LANES(i, width) {                                                     \
        double nowhere;                                                        \
        name##_gradient_lane(                                                  \
            t[i], (nevh__lanes){q, width, i}, (nevh__lanes){p, width, i},      \
            (nevh__lanes){c, width, i}, params, NEVH__UNLIKE(i),               \
            (nevh__slopes){dh_dq, width, i, q_too, &nowhere},                  \
            (nevh__slopes){dh_dp, width, i, p_too, &nowhere});                 \
    }
#define NEVH__GRADIENT_POINT(name, q_too, p_too)                               \
    name##_gradient_one(t, (nevh__one){q}, (nevh__one){p}, (nevh__one){c},     \
                        params, -0.,                                           \
                        (nevh__slopes){dh_dq, 1, 0, q_too, &nowhere},          \
                        (nevh__slopes){dh_dp, 1, 0, p_too, &nowhere})

/* Defines NAME_gradient and NAME_point_gradient, static functions of the types
   in nevh_term.  The body, in braces, comes last; it may ask only for what the
   term declares to read. */
#define NEVH_GRADIENT(name, params_type, ...)                                  \
    NEVH__GRADIENT_FORM(name##_gradient_lane, nevh__lanes, params_type,        \
                        __VA_ARGS__)                                           \
    NEVH__GRADIENT_FORM(name##_gradient_one, nevh__one, params_type,           \
                        __VA_ARGS__)                                           \
                                                                               \
    NEVH__MAYBE_UNUSED NEVH_SIMD static void name##_gradient(                  \
        size_t width, const double *t, const double *q, const double *p,       \
        const double *c, const void *params, double *dh_dq, double *dh_dp)     \
    {                                                                          \
        NEVH__MAYBE_UNUSED const double *nothing = nevh__unlike();             \
        if (dh_dq && dh_dp)                                                    \
            NEVH__GRADIENT_LANES(name, true, true)                             \
        else if (dh_dq)                                                        \
            NEVH__GRADIENT_LANES(name, true, false)                            \
        else if (dh_dp)                                                        \
            NEVH__GRADIENT_LANES(name, false, true)                            \
    }                                                                          \
                                                                               \
    NEVH__MAYBE_UNUSED NEVH_POINT static void name##_point_gradient(           \
        double t, const double *q, const double *p, const double *c,           \
        const void *params, double *dh_dq, double *dh_dp)                      \
    {                                                                          \
        double nowhere;                                                        \
        if (dh_dq && dh_dp)                                                    \
            NEVH__GRADIENT_POINT(name, true, true);                            \
        else if (dh_dq)                                                        \
            NEVH__GRADIENT_POINT(name, true, false);                           \
        else if (dh_dp)                                                        \
            NEVH__GRADIENT_POINT(name, false, true);                           \
    }
// clang-format on

/* Both of them, in a nevh_term's initialiser. */
#define NEVH_GRADIENTS(name)                                                   \
    .gradient = name##_gradient, .point_gradient = name##_point_gradient

#endif
#endif
