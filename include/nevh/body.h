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

#include <nevh/simd.h>
#include <nevh/system.h>

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
        double a = nevh__re(z), b = nevh__im(z);                               \
        double f = nevh_simd_##name(a);                                        \
        return nevh__pair(f, NEVH__TIMES(slope, b));                           \
    }
/* Here a and c are the arguments. */
#define NEVH__ANALYTIC2(name, slope_a, slope_c)                                \
    NEVH__INLINE double _Complex nevh__complex_##name(double _Complex y,       \
                                                      double _Complex z) {     \
        double a = nevh__re(y), b = nevh__im(y);                               \
        double c = nevh__re(z), d = nevh__im(z);                               \
        double f = nevh_simd_##name(a, c);                                     \
        return nevh__pair(f,                                                   \
                          NEVH__TIMES(slope_a, b) + NEVH__TIMES(slope_c, d));  \
    }
NEVH__ANALYTIC(sin, nevh_simd_cos(a))
NEVH__ANALYTIC(cos, -nevh_simd_sin(a))
NEVH__ANALYTIC(tan, 1 + f * f)
NEVH__ANALYTIC(asin, 1 / sqrt((1 - a) * (1 + a)))
NEVH__ANALYTIC(acos, -1 / sqrt((1 - a) * (1 + a)))
NEVH__ANALYTIC(atan, 1 / (1 + a * a))
NEVH__ANALYTIC(sinh, nevh_simd_cosh(a))
NEVH__ANALYTIC(cosh, nevh_simd_sinh(a))
NEVH__ANALYTIC(tanh, 1 / nevh_simd_cosh(a) /
                         nevh_simd_cosh(a)) /* 1 - f^2 would cancel */
NEVH__ANALYTIC(exp, f)
NEVH__ANALYTIC(log, 1 / a)
NEVH__ANALYTIC(sqrt, 0.5 / f)
NEVH__ANALYTIC(cbrt, 1 / (3 * f * f))
NEVH__ANALYTIC2(atan2, c / nevh_simd_hypot(a, c) / nevh_simd_hypot(a, c),
                -a / nevh_simd_hypot(a, c) / nevh_simd_hypot(a, c))
NEVH__ANALYTIC2(hypot, a / f, c / f)
NEVH__ANALYTIC2(pow, c == 0 ? 0 : c * nevh_simd_pow(a, c - 1),
                a == 0 && c > 0 ? 0 : f * nevh_simd_log(a))
#undef NEVH__ANALYTIC2
#undef NEVH__ANALYTIC
#undef NEVH__TIMES

NEVH__INLINE double _Complex nevh__complex_abs(double _Complex z) {
    return nevh__re(z) < 0 ? -z : z;
}

NEVH__INLINE double nevh__same(double x) {
    return x;
}

/* Minimum and maximum that are NaN if either argument is. */

NEVH__INLINE double nevh__real_min(double x, double y) {
    return x != x || x < y ? x : y;
}

NEVH__INLINE double nevh__real_max(double x, double y) {
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

/* One lane of a block.  In each form of a body nevh__body_q is of another type, by
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

// clang-format 14 does not know _Generic.
// clang-format off
#define NEVH__AT(x, k)                                                         \
    _Generic((x), const double *: nevh__of_state,                              \
                  nevh__lanes: nevh__of_lane,                                  \
                  nevh__one: nevh__of_one,                                     \
                  const double (*)[2]: nevh__of_complex)((x), (size_t)(k))
#define NEVH__ANY(x, real, complex)                                            \
    _Generic((x), double _Complex: complex, default: real)
#define NEVH__FUNCTION(f, x) NEVH__ANY(x, nevh_simd_##f, nevh__complex_##f)
// clang-format on
#define NEVH__OWN(f, x) NEVH__ANY(x, nevh__real_##f, nevh__complex_##f)

/* The variables, constants and functions that a body may use. */
#define nevh_q(k)        NEVH__AT(nevh__body_q, k)
#define nevh_p(k)        NEVH__AT(nevh__body_p, k)
#define nevh_c(k)        NEVH__AT(nevh__body_c, k)
#define nevh_sin(x)      NEVH__FUNCTION(sin, x)(x)
#define nevh_cos(x)      NEVH__FUNCTION(cos, x)(x)
#define nevh_tan(x)      NEVH__FUNCTION(tan, x)(x)
#define nevh_asin(x)     NEVH__FUNCTION(asin, x)(x)
#define nevh_acos(x)     NEVH__FUNCTION(acos, x)(x)
#define nevh_atan(x)     NEVH__FUNCTION(atan, x)(x)
#define nevh_atan2(y, x) NEVH__FUNCTION(atan2, (y) + (x))(y, x)
#define nevh_sinh(x)     NEVH__FUNCTION(sinh, x)(x)
#define nevh_cosh(x)     NEVH__FUNCTION(cosh, x)(x)
#define nevh_tanh(x)     NEVH__FUNCTION(tanh, x)(x)
#define nevh_exp(x)      NEVH__FUNCTION(exp, x)(x)
#define nevh_log(x)      NEVH__FUNCTION(log, x)(x)
#define nevh_sqrt(x)     NEVH__FUNCTION(sqrt, x)(x)
#define nevh_cbrt(x)     NEVH__FUNCTION(cbrt, x)(x)
#define nevh_pow(x, y)   NEVH__FUNCTION(pow, (x) + (y))(x, y)
#define nevh_hypot(x, y) NEVH__FUNCTION(hypot, (x) + (y))(x, y)
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

/* One form of a body: its numbers, and the body. */
#define NEVH__FORM(number, params_type, ...)                                   \
    {                                                                          \
        NEVH__MAYBE_UNUSED typedef number nevh_num;                            \
        const params_type *params = nevh__params;                              \
        (void)nevh_t, (void)nevh__body_q, (void)nevh__body_p,                  \
            (void)nevh__body_c;                                                \
        (void)params;                                                          \
        __VA_ARGS__                                                            \
    }

/* Defines NAME_value, NAME_block and NAME_complex, static functions of the
   types in nevh_term.  The body, in braces, comes last; it may ask only for
   what the term declares to read. */
// clang-format off
#define NEVH_BODY(name, params_type, ...)                                      \
    NEVH__MAYBE_UNUSED static double name##_value(                             \
        double nevh_t, const double *nevh__body_q, const double *nevh__body_p,           \
        const double *nevh__body_c, const void *nevh__params)                       \
    NEVH__FORM(double, params_type, __VA_ARGS__)                               \
                                                                               \
    NEVH__INLINE double name##_lane(                                           \
        double nevh_t, nevh__lanes nevh__body_q, nevh__lanes nevh__body_p,               \
        nevh__lanes nevh__body_c, const void *nevh__params)                         \
    NEVH__FORM(double, params_type, __VA_ARGS__)                               \
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
        double nevh_t, const double (*nevh__body_q)[2],                             \
        const double (*nevh__body_p)[2], const double *nevh__body_c,                     \
        const void *nevh__params)                                              \
    NEVH__FORM(double _Complex, params_type, __VA_ARGS__)                      \
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

/* The output rows of a gradient's body.  Derivatives that are not wanted go to a
   dummy; `wanted` is a constant, so the compiler drops the code that computes them. */
typedef struct {
    double *x;
    size_t width, lane;
    bool wanted;
    double *nowhere;
} nevh__slopes;

NEVH__INLINE double *nevh__slope(nevh__slopes d, size_t k) {
    return d.wanted ? d.x + (k * d.width + d.lane) : d.nowhere;
}

/* The outputs of a gradient's body. */
#define nevh_dh_dq(k) (*nevh__slope(nevh__body_dh_dq, (size_t)(k)))
#define nevh_dh_dp(k) (*nevh__slope(nevh__body_dh_dp, (size_t)(k)))

// clang-format off
#define NEVH__GRADIENT_FORM(name, rows, params_type, ...)                      \
    NEVH__INLINE void name(double nevh_t, rows nevh__body_q, rows nevh__body_p,          \
                           rows nevh__body_c, const void *nevh__params,             \
                           nevh__slopes nevh__body_dh_dq,                           \
                           nevh__slopes nevh__body_dh_dp)                           \
    {                                                                          \
        (void)nevh__body_dh_dq, (void)nevh__body_dh_dp;                                  \
        NEVH__FORM(double, params_type, __VA_ARGS__)                           \
    }

/* All lanes, for the halves that are wanted: constants. */
#define NEVH__GRADIENT_LANES(name, q_too, p_too)                               \
    NEVH_LANES(i, width) {                                                     \
        double nowhere;                                                        \
        name##_gradient_lane(                                                  \
            t[i], (nevh__lanes){q, width, i}, (nevh__lanes){p, width, i},      \
            (nevh__lanes){c, width, i}, params,                                \
            (nevh__slopes){dh_dq, width, i, q_too, &nowhere},                  \
            (nevh__slopes){dh_dp, width, i, p_too, &nowhere});                 \
    }
#define NEVH__GRADIENT_POINT(name, q_too, p_too)                               \
    name##_gradient_one(t, (nevh__one){q}, (nevh__one){p}, (nevh__one){c},     \
                        params,                                                \
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
