/* nevh tests: elementary functions are within 1 ulp, and the same bits by one number
   and by vectors.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <nevh/simd.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "elementary/elementary_number.h"

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"
#define VECTORS 1
typedef double by_two __attribute__((vector_size(16), aligned(8)));
#define NEVH__SIDE   2
#define NEVH__NUMBER by_two
#define NEVH__PAIR   by_two_pair
#define NEVH__E(f)   by_two_##f
#include "elementary/elementary_lanes.h"
typedef double by_eight __attribute__((vector_size(64), aligned(8)));
#define NEVH__SIDE   8
#define NEVH__NUMBER by_eight
#define NEVH__PAIR   by_eight_pair
#define NEVH__E(f)   by_eight_##f
#include "elementary/elementary_lanes.h"
#endif

/* x and y: what the functions take; z: from one, two and eight numbers. */
enum { SIDE = 8 };
typedef struct {
    double x[SIDE], y[SIDE], z[3][SIDE];
} lanes;

#define EACH_ONE(X)                                                            \
    X(sin)                                                                     \
    X(cos)                                                                     \
    X(tan)                                                                     \
    X(asin)                                                                    \
    X(acos)                                                                    \
    X(atan)                                                                    \
    X(sinh)                                                                    \
    X(cosh)                                                                    \
    X(tanh)                                                                    \
    X(asinh)                                                                   \
    X(acosh)                                                                   \
    X(atanh)                                                                   \
    X(exp)                                                                     \
    X(log)                                                                     \
    X(log10)                                                                   \
    X(cbrt)
#define EACH_TWO(X)                                                            \
    X(atan2)                                                                   \
    X(hypot)                                                                   \
    X(pow)

#ifdef VECTORS
#define WIDE_ONE(f)                                                            \
    for (int i = 0; i < SIDE; i += 2) {                                        \
        by_two z = by_two_##f((by_two){l->x[i], l->x[i + 1]});                 \
        memcpy(l->z[1] + i, &z, sizeof z);                                     \
    }                                                                          \
    by_eight all;                                                              \
    memcpy(&all, l->x, sizeof all);                                            \
    all = by_eight_##f(all);                                                   \
    memcpy(l->z[2], &all, sizeof all);
#define WIDE_TWO(f)                                                            \
    for (int i = 0; i < SIDE; i += 2) {                                        \
        by_two z = by_two_##f((by_two){l->x[i], l->x[i + 1]},                  \
                              (by_two){l->y[i], l->y[i + 1]});                 \
        memcpy(l->z[1] + i, &z, sizeof z);                                     \
    }                                                                          \
    by_eight all, other;                                                       \
    memcpy(&all, l->x, sizeof all);                                            \
    memcpy(&other, l->y, sizeof other);                                        \
    all = by_eight_##f(all, other);                                            \
    memcpy(l->z[2], &all, sizeof all);
#else
#define WIDE_ONE(f)                                                            \
    memcpy(l->z[1], l->z[0], sizeof l->z[0]);                                  \
    memcpy(l->z[2], l->z[0], sizeof l->z[0]);
#define WIDE_TWO WIDE_ONE
#endif
#define TAKE_ONE(f)                                                            \
    static void take_##f(lanes *l) {                                           \
        for (int i = 0; i < SIDE; i++)                                         \
            l->z[0][i] = nevh__one_##f(l->x[i]);                               \
        WIDE_ONE(f)                                                            \
    }                                                                          \
    static long double exact_##f(long double x, long double y) {               \
        (void)y;                                                               \
        return f##l(x);                                                        \
    }
#define TAKE_TWO(f)                                                            \
    static void take_##f(lanes *l) {                                           \
        for (int i = 0; i < SIDE; i++)                                         \
            l->z[0][i] = nevh__one_##f(l->x[i], l->y[i]);                      \
        WIDE_TWO(f)                                                            \
    }                                                                          \
    static long double exact_##f(long double x, long double y) {               \
        return f##l(x, y);                                                     \
    }
EACH_ONE(TAKE_ONE)
EACH_TWO(TAKE_TWO)

/* The ranges: arguments from FIRST to LAST, evenly or by their logarithms. */
typedef struct {
    const char *name;
    void (*take)(lanes *);
    long double (*exact)(long double, long double);
    double first, last, y_first, y_last;
    bool by_logarithm;
} range;
#define RANGE(f, ...)                                                          \
    { #f, take_##f, exact_##f, __VA_ARGS__ }
static const range ranges[] = {RANGE(sin, -7, 7, 0, 0, false),
                               RANGE(sin, 1e-12, 1e6, 0, 0, true),
                               RANGE(sin, 1e6, 1e18, 0, 0, true),
                               RANGE(cos, -7, 7, 0, 0, false),
                               RANGE(cos, 1, 1e18, 0, 0, true),
                               RANGE(tan, -7, 7, 0, 0, false),
                               RANGE(tan, 1, 1e18, 0, 0, true),
                               RANGE(asin, -1, 1, 0, 0, false),
                               RANGE(acos, -1, 1, 0, 0, false),
                               RANGE(atan, -4, 4, 0, 0, false),
                               RANGE(atan, 1e-9, 1e17, 0, 0, true),
                               RANGE(sinh, -3, 3, 0, 0, false),
                               RANGE(sinh, -710, 710, 0, 0, false),
                               RANGE(cosh, -3, 3, 0, 0, false),
                               RANGE(cosh, -710, 710, 0, 0, false),
                               RANGE(tanh, -3, 3, 0, 0, false),
                               RANGE(tanh, 1e-9, 30, 0, 0, true),
                               RANGE(asinh, -3, 3, 0, 0, false),
                               RANGE(asinh, 1e-9, 1e300, 0, 0, true),
                               RANGE(acosh, 1, 3, 0, 0, false),
                               RANGE(acosh, 1, 1e300, 0, 0, true),
                               RANGE(atanh, -1, 1, 0, 0, false),
                               RANGE(exp, -1, 1, 0, 0, false),
                               RANGE(exp, -740, 709, 0, 0, false),
                               RANGE(log, 0.5, 2, 0, 0, false),
                               RANGE(log, 1e-320, 1e308, 0, 0, true),
                               RANGE(log10, 0.5, 2, 0, 0, false),
                               RANGE(log10, 1e-320, 1e308, 0, 0, true),
                               RANGE(cbrt, -10, 10, 0, 0, false),
                               RANGE(cbrt, 1e-320, 1e308, 0, 0, true),
                               RANGE(atan2, -1, 1, -1, 1, false),
                               RANGE(hypot, -1, 1, -1, 1, false),
                               RANGE(pow, 0.01, 100, -10, 10, false),
                               RANGE(pow, 0.9, 1.1, -7000, 7000, false),
                               RANGE(pow, 1e-300, 1e300, -1, 1, true)};
enum { RANGES = sizeof ranges / sizeof *ranges };

static double between(double first, double last) {
    return first + (last - first) * (rand() / (RAND_MAX + 1.0));
}

static void draw(const range *r, lanes *l) {
    for (int i = 0; i < SIDE; i++) {
        double x = r->by_logarithm ? exp(between(log(r->first), log(r->last)))
                                   : between(r->first, r->last);
        l->x[i] = fmin(fmax(x, r->first), r->last);
        l->y[i] = between(r->y_first, r->y_last);
    }
}

/* In units of the last place of the result. */
static long double error_of(double got, long double exact) {
    int power;
    if (fabsl(exact) > DBL_MAX || got == exact)
        return 0;
    frexpl(exact, &power);
    if (power < DBL_MIN_EXP)
        power = DBL_MIN_EXP;
    return fabsl(got - exact) / ldexpl(1, power - DBL_MANT_DIG);
}

TEST_EACH(within_one_ulp, RANGES) {
    enum { DRAWS = 4000 };
    const range *r = &ranges[_i];
    lanes l;
    for (int k = 0; k < DRAWS; k++) {
        draw(r, &l);
        r->take(&l);
        for (int i = 0; i < SIDE; i++) {
            long double exact = r->exact(l.x[i], l.y[i]);
            ck_assert_msg(LDBL_MANT_DIG < 64 || error_of(l.z[0][i], exact) < 1,
                          "%s(%.17g, %.17g) is %.20Lg, not %.17g", r->name,
                          l.x[i], l.y[i], exact, l.z[0][i]);
            for (int way = 1; way < 3; way++)
                ck_assert_msg(!memcmp(&l.z[0][i], &l.z[way][i], sizeof(double)),
                              "%s(%.17g, %.17g) is %.17g and %.17g", r->name,
                              l.x[i], l.y[i], l.z[0][i], l.z[way][i]);
        }
    }
}

/* NaN is any, other values are those of the C library, signs of zeros, too. */
TEST_EACH(edges, RANGES) {
    static const double special[SIDE] = {0,   -0.,       INFINITY, -INFINITY,
                                         NAN, 0x1p-1074, 1,        -1};
    const range *r = &ranges[_i];
    lanes l;
    for (int shift = 0; shift < SIDE; shift++) {
        for (int i = 0; i < SIDE; i++) {
            l.x[i] = special[i];
            l.y[i] = special[(i + shift) % SIDE];
        }
        r->take(&l);
        for (int i = 0; i < SIDE * 3; i++) {
            double x = l.x[i % SIDE], y = l.y[i % SIDE],
                   got = l.z[i / SIDE][i % SIDE], want = (double)r->exact(x, y);
            ck_assert_msg(
                (isnan(got) && isnan(want)) ||
                    (error_of(got, want) <= 1 && signbit(got) == signbit(want)),
                "%s(%g, %g) is %g, not %g", r->name, x, y, want, got);
        }
    }
}
