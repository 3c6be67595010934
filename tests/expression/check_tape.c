/* nevh tests: the operations of a tape, in its four ways of evaluation.
   SPDX-License-Identifier: GPL-3.0-or-later

   Each operation is a tape f(q[0], p[0]); references are in long double, their
   derivatives by differences of order 6. */
#include "support.h"
#include "expression/tape_private.h"
#include <nevh/body.h>
#include <float.h>
#include <math.h>
#include <string.h>

static const long double pi = 3.141592653589793238462643383279502884L;

typedef long double (*reference_fn)(long double a, long double b);

#define OF(name, formula)                                                      \
    static long double name##_is(long double a, long double b) {               \
        (void)b;                                                               \
        return formula;                                                        \
    }

/* By the trapezoidal rule, which converges exponentially on a period. */
static long double bessel(int n, long double x) {
    long double sum = 0;
    for (int i = 0; i < 64; i++)
        sum += cosl(n * (pi * i / 32) - x * sinl(pi * i / 32));
    return sum / 64;
}

/* By arithmetic and geometric means; part: 0 is K, 1 is E. */
static long double elliptic(int part, long double k) {
    long double a = 1, b = sqrtl((1 - k) * (1 + k)), sum = k * k / 2;
    for (int i = 0; i < 12; i++) {
        long double mean = (a + b) / 2, half = (a - b) / 2;
        b = sqrtl(a * b);
        a = mean;
        sum += ldexpl(half * half, i);
    }
    return pi / (2 * a) * (part ? 1 - sum : 1);
}

/* Kepler's equation, halved to the last digit. */
static long double anomaly(long double mean, long double e) {
    long double low = mean - 1, high = mean + 1;
    for (int i = 0; i < 80; i++) {
        long double x = (low + high) / 2;
        *(x - e * sinl(x) < mean ? &low : &high) = x;
    }
    return (low + high) / 2;
}

OF(add, a + b)
OF(subtract, a - b)
OF(multiply, a *b)
OF(divide, a / b)
OF(power, powl(a, b))
OF(negate, -a)
OF(square, a *a)
OF(cube, a *a *a)
OF(sin, sinl(a))
OF(cos, cosl(a))
OF(tan, tanl(a))
OF(asin, asinl(a))
OF(acos, acosl(a))
OF(atan, atanl(a))
OF(atan2, atan2l(a, b))
OF(sinh, sinhl(a))
OF(cosh, coshl(a))
OF(tanh, tanhl(a))
OF(asinh, asinhl(a))
OF(acosh, acoshl(a))
OF(atanh, atanhl(a))
OF(exp, expl(a))
OF(log, logl(a))
OF(log10, log10l(a))
OF(sqrt, sqrtl(a))
OF(cbrt, cbrtl(a))
OF(hypot, hypotl(a, b))
OF(abs, fabsl(a))
OF(min, a < b ? a : b)
OF(max, a > b ? a : b)
OF(sign, a > 0 ? 1 : a < 0 ? -1 : 0)
OF(mod, a - b * floorl(a / b))
OF(floor, floorl(a))
OF(bessel_j0, bessel(0, a))
OF(bessel_j1, bessel(1, a))
OF(elliptic_k, elliptic(0, a))
OF(elliptic_e, elliptic(1, a))
OF(kepler, anomaly(a, b))

typedef struct {
    nevh__tape_operation is;
    reference_fn reference;
    double from[2], to[2];
    double ulps; /* of the scalar value; of the function's size where that is
                    larger, since zeros are not relatively exact */
} operation;

#define ROW(of, name, a0, a1, b0, b1, ulps)                                    \
    { NEVH__##of, name##_is, {a0, b0}, {a1, b1}, ulps }

static const operation operations[] = {
    ROW(ADD, add, -2, 2, -2, 2, 0.51),
    ROW(SUBTRACT, subtract, -2, 2, -2, 2, 0.51),
    ROW(MULTIPLY, multiply, -2, 2, -2, 2, 0.51),
    ROW(DIVIDE, divide, -2, 2, 0.3, 2, 0.51),
    ROW(POWER, power, 0.1, 4, -4, 4, 1),
    ROW(NEGATE, negate, -2, 2, 0, 1, 0),
    ROW(SQUARE, square, -2, 2, 0, 1, 0.51),
    ROW(CUBE, cube, -2, 2, 0, 1, 2),
    ROW(SIN, sin, -20, 20, 0, 1, 1),
    ROW(COS, cos, -20, 20, 0, 1, 1),
    ROW(TAN, tan, -1.5, 1.5, 0, 1, 1),
    ROW(ASIN, asin, -0.95, 0.95, 0, 1, 1),
    ROW(ACOS, acos, -0.95, 0.95, 0, 1, 1),
    ROW(ATAN, atan, -9, 9, 0, 1, 1),
    ROW(ATAN2, atan2, -5, 5, -5, 5, 1),
    ROW(SINH, sinh, -9, 9, 0, 1, 2),
    ROW(COSH, cosh, -9, 9, 0, 1, 2),
    ROW(TANH, tanh, -9, 9, 0, 1, 2),
    ROW(ASINH, asinh, -9, 9, 0, 1, 2),
    ROW(ACOSH, acosh, 1.02, 9, 0, 1, 2),
    ROW(ATANH, atanh, -0.98, 0.98, 0, 1, 2),
    ROW(EXP, exp, -20, 5, 0, 1, 1),
    ROW(LOG, log, 0.1, 9, 0, 1, 1),
    ROW(LOG10, log10, 0.1, 9, 0, 1, 2),
    ROW(SQRT, sqrt, 0.1, 9, 0, 1, 0.51),
    ROW(CBRT, cbrt, 0.1, 9, 0, 1, 2),
    ROW(HYPOT, hypot, -5, 5, 0.1, 5, 1),
    ROW(ABS, abs, 0.1, 2, 0, 1, 0),
    ROW(MIN, min, -2, 2, -2, 2, 0),
    ROW(MAX, max, -2, 2, -2, 2, 0),
    ROW(SIGN, sign, 0.1, 2, 0, 1, 0),
    ROW(MOD, mod, 4.4, 4.7, 1.25, 1.4, 0.51),
    ROW(FLOOR, floor, 3.1, 3.9, 0, 1, 0),
    ROW(BESSEL_J0, bessel_j0, -9, 9, 0, 1, 4),
    ROW(BESSEL_J1, bessel_j1, -9, 9, 0, 1, 4),
    ROW(ELLIPTIC_K, elliptic_k, -0.95, 0.95, 0, 1, 4),
    ROW(ELLIPTIC_E, elliptic_e, -0.95, 0.95, 0, 1, 4),
    ROW(ECCENTRIC, kepler, -20, 20, 0.05, 0.95, 4),
};
enum { OPERATIONS = sizeof operations / sizeof *operations, WIDTH = 72 };

/* In [from, to). */
static double uniform(double from, double to) {
    static unsigned long long seed = 20240229;
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return from + (to - from) * ((double)(seed >> 11) / 9007199254740992.0);
}

static void draw(const operation *f, double x[], double y[]) {
    for (size_t i = 0; i < WIDTH; i++) {
        x[i] = uniform(f->from[0], f->to[0]);
        y[i] = uniform(f->from[1], f->to[1]);
    }
}

static nevh__tape *tape_of(nevh__tape_operation is) {
    nevh__tape_builder *b = nevh__tape_builder_new();
    int x = nevh__tape_variable(b, NEVH__Q, 0);
    int y = nevh__tape_variable(b, NEVH__P, 0);
    nevh__tape *tape =
        nevh__tape_finish(b, nevh__tape_apply(b, is, x, y), NULL);
    ck_assert_ptr_nonnull(tape);
    return tape;
}

/* Whether long double is more than double; under valgrind it is not. */
static bool is_exact(void) {
    volatile long double one = 1;
    return one + DBL_EPSILON / 64 != one;
}

static double ulp(double x) {
    return nextafter(fabs(x), INFINITY) - fabs(x);
}

TEST(all_are_listed) {
    ck_assert_int_eq(OPERATIONS, NEVH__OPERATION_COUNT);
    for (int i = 0; i < OPERATIONS; i++)
        ck_assert_int_eq(operations[i].is, i);
}

TEST_EACH(values, OPERATIONS) {
    const operation *f = &operations[_i];
    const char *name = nevh__operation_name(f->is);
    double x[WIDTH], y[WIDTH], t[WIDTH] = {0}, h[WIDTH], pair[2];
    double ulps = f->ulps + (is_exact() ? 0 : 64);
    nevh__tape *tape = tape_of(f->is);
    draw(f, x, y);
    nevh__tape_block(WIDTH, t, x, y, NULL, tape, h);
    for (size_t i = 0; i < WIDTH; i++) {
        long double exact = f->reference(x[i], y[i]);
        double one = nevh__tape_value(0, &x[i], &y[i], NULL, tape);
        double unit = fmax(ulp((double)exact), f->ulps > 3 ? DBL_EPSILON : 0);
        ck_assert_msg(fabsl(one - exact) <= ulps * unit,
                      "%s(%.17g, %.17g) = %.17g, not %.17Lg", name, x[i], y[i],
                      one, exact);
        ck_assert_double_eq(nevh__operation_value(f->is, x[i], y[i]), one);
        ck_assert_msg(fabsl(h[i] - exact) <=
                          (f->ulps ? fmax(ulps, 4) : ulps) * unit,
                      "block %s(%.17g, %.17g) = %.17g, not %.17Lg", name, x[i],
                      y[i], h[i], exact);
#ifndef NEVH__VECTORS
        ck_assert_double_eq(h[i], one);
#endif
        const double q[1][2] = {{x[i], 1e-100}}, p[1][2] = {{y[i], 0}};
        nevh__tape_complex(0, q, p, NULL, tape, pair);
        ck_assert_double_eq(pair[0], one);
    }
    nevh__tape_free(tape);
}

/* df/da, or df/db where by_b. */
static long double slope(const operation *f, long double a, long double b,
                         bool by_b) {
    const long double step = 0x1p-13L, weights[] = {45, -9, 1};
    long double sum = 0;
    for (int i = 1; i <= 3; i++) {
        long double da = by_b ? 0 : i * step, db = by_b ? i * step : 0;
        sum += weights[i - 1] *
               (f->reference(a + da, b + db) - f->reference(a - da, b - db));
    }
    return sum / (60 * step);
}

static bool has_two(const operation *f) {
    return nevh__operation_arguments(f->is) == 2;
}

static bool is_kinked(const operation *f, double a, double b) {
    return (f->is == NEVH__MIN || f->is == NEVH__MAX) && fabs(a - b) < 0.01;
}

/* Derivatives side by side have the bits of functions of one number. */
TEST(slopes_are_elementary) {
    enum { POINTS = 64 * 8, CALLS = 4 };
    static const nevh__tape_operation is[CALLS] = {NEVH__SIN, NEVH__COS,
                                                   NEVH__EXP, NEVH__SINH};
    double (*const derivative[CALLS])(double) = {nevh_simd_cos, nevh_simd_sin,
                                                 nevh_simd_exp, nevh_simd_cosh};
    static double x[POINTS], zero[POINTS], dx[POINTS], dy[POINTS];
    for (size_t i = 0; i < POINTS; i++)
        x[i] = uniform(-3, 3);
    for (int k = 0; k < CALLS; k++) {
        nevh__tape *tape = tape_of(is[k]);
        double sign = is[k] == NEVH__COS ? -1 : 1;
        nevh__tape_block_gradient(POINTS, zero, x, zero, NULL, tape, dx, dy);
        for (size_t i = 0; i < POINTS; i++)
            ck_assert_double_eq(dx[i], sign * derivative[k](x[i]));
        nevh__tape_free(tape);
    }
}

TEST_EACH(slopes, OPERATIONS) {
    const operation *f = &operations[_i];
    double x[WIDTH], y[WIDTH], t[WIDTH] = {0}, dx[WIDTH], dy[WIDTH], pair[2];
    nevh__tape *tape = tape_of(f->is);
    draw(f, x, y);
    nevh__tape_block_gradient(WIDTH, t, x, y, NULL, tape, dx, dy);
    for (size_t i = 0; i < WIDTH; i++)
        for (int by_b = 0; by_b < 2 && !is_kinked(f, x[i], y[i]); by_b++) {
            const double q[1][2] = {{x[i], by_b ? 0 : 0x1p-332}};
            const double p[1][2] = {{y[i], by_b ? 0x1p-332 : 0}};
            long double exact = slope(f, x[i], y[i], by_b);
            long double allowed =
                (is_exact() ? 2e-14L : 1e-9L) * (1 + 10 * fabsl(exact));
            double reverse = by_b ? dy[i] : dx[i];
            nevh__tape_complex(0, q, p, NULL, tape, pair);
            ck_assert_msg(fabsl(reverse - exact) <= allowed &&
                              fabsl(pair[1] * 0x1p332 - exact) <= allowed,
                          "%s at (%.17g, %.17g) by %d: %.17g and %.17g, not "
                          "%.17Lg",
                          nevh__operation_name(f->is), x[i], y[i], by_b,
                          reverse, pair[1] * 0x1p332, exact);
            ck_assert(!by_b || has_two(f) || reverse == 0);
        }
    nevh__tape_free(tape);
}

/* Lane i of a block of eight full of other numbers against lane i of many. */
TEST_EACH(lanes_are_alone, OPERATIONS) {
    const operation *f = &operations[_i];
    double x[WIDTH], y[WIDTH], t[WIDTH] = {0}, h[WIDTH], dx[WIDTH], dy[WIDTH];
    double x8[8], y8[8], h8[8], dx8[8], dy8[8];
    nevh__tape *tape = tape_of(f->is);
    draw(f, x, y);
    nevh__tape_block(WIDTH, t, x, y, NULL, tape, h);
    nevh__tape_block_gradient(WIDTH, t, x, y, NULL, tape, dx, dy);
    for (size_t i = 0; i < WIDTH; i++) {
        size_t lane = (i * 5 + 3) % 8;
        for (size_t k = 0; k < 8; k++) {
            x8[k] = k % 2 ? NAN : 1e300;
            y8[k] = -x8[k];
        }
        x8[lane] = x[i];
        y8[lane] = y[i];
        nevh__tape_block(8, t, x8, y8, NULL, tape, h8);
        nevh__tape_block_gradient(8, t, x8, y8, NULL, tape, dx8, dy8);
        ck_assert(memcmp(&h8[lane], &h[i], sizeof *h) == 0);
        ck_assert(memcmp(&dx8[lane], &dx[i], sizeof *h) == 0);
        ck_assert(memcmp(&dy8[lane], &dy[i], sizeof *h) == 0);
    }
    nevh__tape_free(tape);
}

/* Either derivative alone is the same as both together. */
TEST_EACH(one_side_at_a_time, OPERATIONS) {
    const operation *f = &operations[_i];
    double x[WIDTH], y[WIDTH], t[WIDTH] = {0}, d[4][WIDTH];
    nevh__tape *tape = tape_of(f->is);
    draw(f, x, y);
    nevh__tape_block_gradient(WIDTH, t, x, y, NULL, tape, d[0], d[1]);
    nevh__tape_block_gradient(WIDTH, t, x, y, NULL, tape, d[2], NULL);
    nevh__tape_block_gradient(WIDTH, t, x, y, NULL, tape, NULL, d[3]);
    ck_assert(memcmp(d[0], d[2], 2 * sizeof d[0]) == 0);
    nevh__tape_free(tape);
}

/* Value and derivatives where they are special; they are exact, and NaN is
   wanted where NaN is written. */
static const struct {
    nevh__tape_operation is;
    double a, b, value, by_a, by_b;
} special[] = {
    {NEVH__POWER, -2, 3, -8, 12, NAN},
    {NEVH__POWER, -2, -2, 0.25, 0.25, NAN},
    {NEVH__POWER, -2, 0.5, NAN, NAN, NAN},
    {NEVH__POWER, 0, 2, 0, 0, 0},
    {NEVH__POWER, 0, 1, 0, 1, 0},
    {NEVH__POWER, 0, 0, 1, 0, -INFINITY},
    {NEVH__POWER, 3, 0, 1, 0, 1.0986122886681098},
    {NEVH__POWER, 0, -1, INFINITY, NAN, NAN},
    {NEVH__LOG, -1, 0, NAN, NAN, 0},
    {NEVH__LOG, 0, 0, -INFINITY, NAN, 0},
    {NEVH__LOG10, -1, 0, NAN, NAN, 0},
    {NEVH__SQRT, -1, 0, NAN, NAN, 0},
    {NEVH__SQRT, 0, 0, 0, INFINITY, 0},
    {NEVH__CBRT, 0, 0, 0, INFINITY, 0},
    {NEVH__CBRT, -8, 0, -2, 1. / 12, 0},
    {NEVH__ASIN, 2, 0, NAN, NAN, 0},
    {NEVH__ACOS, -2, 0, NAN, NAN, 0},
    {NEVH__ACOSH, 0.5, 0, NAN, NAN, 0},
    {NEVH__ACOSH, -3, 0, NAN, NAN, 0},
    {NEVH__ATANH, 2, 0, NAN, NAN, 0},
    {NEVH__ATANH, 1, 0, INFINITY, NAN, 0},
    {NEVH__TANH, 800, 0, 1, 0, 0},
    {NEVH__DIVIDE, 1, 0, INFINITY, NAN, NAN},
    {NEVH__DIVIDE, 0, 0, NAN, NAN, NAN},
    {NEVH__ABS, 0, 0, 0, 0, 0},
    {NEVH__ABS, -3, 0, 3, -1, 0},
    {NEVH__HYPOT, 0, 0, 0, 0, 0},
    {NEVH__SIGN, 0, 0, 0, 0, 0},
    {NEVH__SIGN, -0.1, 0, -1, 0, 0},
    {NEVH__SIGN, NAN, 0, NAN, NAN, 0},
    {NEVH__MIN, 2, 2, 2, 0, 1},
    {NEVH__MAX, 2, 2, 2, 0, 1},
    {NEVH__MIN, NAN, 2, NAN, NAN, NAN},
    {NEVH__MIN, 2, NAN, NAN, NAN, NAN},
    {NEVH__MAX, NAN, 2, NAN, NAN, NAN},
    {NEVH__MAX, 2, NAN, NAN, NAN, NAN},
    {NEVH__MOD, 7, 3, 1, 1, -2},
    {NEVH__MOD, -7, 3, 2, 1, 3},
    {NEVH__MOD, 7, -3, -2, 1, 3},
    {NEVH__MOD, -7, -3, -1, 1, -2},
    {NEVH__MOD, -6, 3, 0, 1, 2},
    {NEVH__MOD, 9007199254740991, 10, 1, 1, -900719925474099},
    {NEVH__MOD, 1, 0, NAN, NAN, NAN},
    {NEVH__FLOOR, NAN, 0, NAN, NAN, 0},
    {NEVH__FLOOR, -0.5, 0, -1, 0, 0},
    {NEVH__BESSEL_J0, 0, 0, 1, 0, 0},
    {NEVH__BESSEL_J1, 0, 0, 0, 0.5, 0},
    {NEVH__BESSEL_J1, 1e-300, 0, 5e-301, 0.5, 0},
    {NEVH__BESSEL_J0, INFINITY, 0, NAN, NAN, 0},
    {NEVH__BESSEL_J1, NAN, 0, NAN, NAN, 0},
    {NEVH__BESSEL_J1, 1e300, 0, NAN, NAN, 0},
    {NEVH__ELLIPTIC_K, 1, 0, NAN, NAN, 0},
    {NEVH__ELLIPTIC_K, -1.5, 0, NAN, NAN, 0},
    {NEVH__ELLIPTIC_E, 1, 0, 1, NAN, 0},
    {NEVH__ELLIPTIC_E, INFINITY, 0, NAN, NAN, 0},
    {NEVH__ECCENTRIC, 1, 1, NAN, NAN, NAN},
    {NEVH__ECCENTRIC, 1, 1.5, NAN, NAN, NAN},
    {NEVH__ECCENTRIC, 1, -0.1, NAN, NAN, NAN},
    {NEVH__ECCENTRIC, INFINITY, 0.5, NAN, NAN, NAN},
    {NEVH__ECCENTRIC, NAN, 0.5, NAN, NAN, NAN},
    {NEVH__ECCENTRIC, 0, 0.5, 0, 2, 0},
    {NEVH__ECCENTRIC, 2.5, 0, 2.5, 1, 0.59847214410395655},
    {NEVH__ELLIPTIC_K, 1e-200, 0, 1.5707963267948966, 7.8539816339744828e-201,
     0},
};

static bool same(double x, double y) {
    return isnan(y) ? isnan(x) : isinf(y) ? x == y : fabs(x - y) <= 4 * ulp(y);
}

TEST_EACH(special_values, sizeof special / sizeof *special) {
    double x[8], y[8], t[8] = {0}, h[8], dx[8], dy[8];
    const double a = special[_i].a, b = special[_i].b;
    nevh__tape *tape = tape_of(special[_i].is);
    for (size_t lane = 0; lane < 8; lane++) {
        x[lane] = a;
        y[lane] = b;
    }
    nevh__tape_block(8, t, x, y, NULL, tape, h);
    nevh__tape_block_gradient(8, t, x, y, NULL, tape, dx, dy);
    double one = nevh__tape_value(0, x, y, NULL, tape);
    ck_assert_msg(
        same(one, special[_i].value) && same(h[3], one) &&
            same(dx[3], special[_i].by_a) && same(dy[3], special[_i].by_b),
        "%s(%g, %g): %g (block %g), slopes %g, %g",
        nevh__operation_name(special[_i].is), a, b, one, h[3], dx[3], dy[3]);
    nevh__tape_free(tape);
}

/* Published: J. Meeus, Astronomical Algorithms, chapter 30: examples a and b, and
   the hard case e = 0.99, M = 2 deg.  Then what the series of the equation says
   where e is nearly 1 and M is small: M = (1 - e) E + e E^3/6 - ... */
static const struct {
    double mean, e, anomaly, digits;
} published[] = {
    {5 * 0.017453292519943295, 0.1, 5.554589 * 0.017453292519943295, 1e-7},
    {0.2, 0.99, 1.066997365282, 1e-12},
    {2 * 0.017453292519943295, 0.99, 32.361007 * 0.017453292519943295, 2e-8},
    {1e-200, 1 - 0x1p-53, 9.007199254740992e-185, 1e-15},
    {1e-30, 1 - 0x1p-53, 9.007199254739896e-15, 1e-15},
    {1e-6, 1 - 0x1p-53, 0.018171305929724314, 1e-14},
};

TEST_EACH(keplers_equation, sizeof published / sizeof *published) {
    double found = nevh__operation_value(NEVH__ECCENTRIC, published[_i].mean,
                                         published[_i].e);
    ck_assert_double_eq_tol(found / published[_i].anomaly, 1,
                            published[_i].digits);
    ck_assert_double_eq(nevh__operation_value(NEVH__ECCENTRIC,
                                              -published[_i].mean,
                                              published[_i].e),
                        -found);
}

/* Everywhere the residual is that of rounding. */
TEST(keplers_equation_is_solved) {
    for (int i = 0; i < 20000; i++) {
        double e = i % 3 ? uniform(0, 1) : 1 - exp2(-uniform(1, 53));
        double mean = (i % 2 ? 1 : exp2(-uniform(0, 80))) * uniform(0, 3.14);
        double x = nevh__operation_value(NEVH__ECCENTRIC, mean, e);
        long double less = x - sinl(x), y = (long double)x * x, sum = 0;
        for (int k = 12; k > 0; k--)
            sum = y / (2 * k * (2 * k + 1)) * (1 - sum);
        if (x < 1) /* x - sin x cancels */
            less = x * sum;
        long double over = (1 - (long double)e) * x + (long double)e * less -
                           (long double)mean;
        ck_assert_msg(fabsl(over) <= 8 * ulp(mean), "E(%.17g, %.17g) = %.17g",
                      mean, e, x);
    }
}
