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

#include "elementary/elementary_list.h"

/* x and y: what the functions take; z: from one number, and from vectors of two, four,
   four again and eight. */
enum { SIDE = 8, WAYS = 5 };
typedef struct {
    double x[SIDE], y[SIDE], z[WAYS][SIDE];
} lanes;

#if defined __GNUC__ && defined __x86_64__
#pragma GCC diagnostic ignored "-Wpsabi"
typedef double by_two __attribute__((vector_size(16), aligned(8)));
typedef double by_four __attribute__((vector_size(32), aligned(8)));
typedef double by_eight __attribute__((vector_size(64), aligned(8)));
#define VECTORS_OF(name, vector, letter, side, isa)                            \
    extern vector _ZGV##letter##N##side##v_nevh_simd_##name(vector);           \
    __attribute__((target(isa))) static void name##_##letter(lanes *l,         \
                                                             double *z) {      \
        for (int i = 0; i < SIDE; i += side)                                   \
            *(vector *)(z + i) = _ZGV##letter##N##side##v_nevh_simd_##name(    \
                *(vector *)(l->x + i));                                        \
    }
#define VECTORS_OF_TWO(name, vector, letter, side, isa)                        \
    extern vector _ZGV##letter##N##side##vv_nevh_simd_##name(vector, vector);  \
    __attribute__((target(isa))) static void name##_##letter(lanes *l,         \
                                                             double *z) {      \
        for (int i = 0; i < SIDE; i += side)                                   \
            *(vector *)(z + i) = _ZGV##letter##N##side##vv_nevh_simd_##name(   \
                *(vector *)(l->x + i), *(vector *)(l->y + i));                 \
    }
#define EACH_VECTOR(X, name)                                                   \
    X(name, by_two, b, 2, "sse2")                                              \
    X(name, by_four, c, 4, "avx")                                              \
    X(name, by_four, d, 4, "avx2")                                             \
    X(name, by_eight, e, 8, "avx512f")
#define BY_VECTORS(name)                                                       \
    name##_b(l, l->z[1]);                                                      \
    if (__builtin_cpu_supports("avx"))                                         \
        name##_c(l, l->z[2]);                                                  \
    if (__builtin_cpu_supports("avx2"))                                        \
        name##_d(l, l->z[3]);                                                  \
    if (__builtin_cpu_supports("avx512f") &&                                   \
        __builtin_cpu_supports("avx512dq") &&                                  \
        __builtin_cpu_supports("avx512vl") &&                                  \
        __builtin_cpu_supports("avx512bw"))                                    \
        name##_e(l, l->z[4]);
#else
#define EACH_VECTOR(X, name)
#define BY_VECTORS(name)
#endif
#define TAKE(name, ...)                                                        \
    static void take_##name(lanes *l) {                                        \
        for (int i = 0; i < SIDE; i++)                                         \
            l->z[0][i] = nevh_simd_##name(__VA_ARGS__);                        \
        for (int way = 1; way < WAYS; way++)                                   \
            memcpy(l->z[way], l->z[0], sizeof *l->z);                          \
        BY_VECTORS(name)                                                       \
    }
#define TAKE_ONE(name, f, family)                                              \
    EACH_VECTOR(VECTORS_OF, name)                                              \
    TAKE(name, l->x[i])                                                        \
    static long double exact_##f(long double x, long double y) {               \
        (void)y;                                                               \
        return f##l(x);                                                        \
    }
#define TAKE_TWO(name, f, family)                                              \
    EACH_VECTOR(VECTORS_OF_TWO, name)                                          \
    TAKE(name, l->x[i], l->y[i])                                               \
    static long double exact_##f(long double x, long double y) {               \
        return f##l(x, y);                                                     \
    }
NEVH__EACH_ONE(TAKE_ONE)
NEVH__EACH_TWO(TAKE_TWO)

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
#define RANGE_OF_POWERS(...)                                                   \
    { "pow", take_power, exact_pow, __VA_ARGS__ }
static const range ranges[] = {
    RANGE(sin, -7, 7, 0, 0, false),
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
    RANGE(atan2, -1e300, 1e300, -1e300, 1e300, false),
    RANGE(hypot, -1, 1, -1, 1, false),
    RANGE(hypot, -1e300, 1e300, -1e300, 1e300, false),
    RANGE(hypot, -1e-300, 1e-300, -1e-300, 1e-300, false),
    RANGE_OF_POWERS(0.01, 100, -10, 10, false),
    RANGE_OF_POWERS(0.9, 1.1, -7000, 7000, false),
    RANGE_OF_POWERS(1e-300, 1e300, -1, 1, true)};
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
            for (int way = 1; way < WAYS; way++)
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
        for (int i = 0; i < SIDE * WAYS; i++) {
            double x = l.x[i % SIDE], y = l.y[i % SIDE],
                   got = l.z[i / SIDE][i % SIDE], want = (double)r->exact(x, y);
            ck_assert_msg(
                got == want ? signbit(got) == signbit(want)
                            : (isnan(got) && isnan(want)) ||
                                  (isfinite(want) && error_of(got, want) <= 1),
                "%s(%g, %g) is %g, not %g", r->name, x, y, want, got);
        }
    }
}

static uint64_t seed = 88172645463325252u;

/* Any number, or one near 0. */
static double any(int k) {
    double x;
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    memcpy(&x, &seed, sizeof x);
    double part = (double)(seed >> 11) * 0x1p-53 - 0.5;
    return k % 3 == 0 ? x : k % 3 == 1 ? 20 * part : 2.2 * part;
}

/* A digest of all functions: what x86-64 and ARM have, by GCC and Clang with and
   without optimization. */
TEST(bits_of_every_machine) {
    enum { DRAWS = 50000 };
    uint64_t digest = 14695981039346656037u;
#define ADD(f, ...)                                                            \
    for (int k = 0; k < DRAWS; k++) {                                          \
        double x = any(k), y = any(k), z = nevh_simd_##f(__VA_ARGS__);         \
        uint64_t bits = 0;                                                     \
        (void)y;                                                               \
        if (z == z)                                                            \
            memcpy(&bits, &z, sizeof bits);                                    \
        digest = (digest ^ bits) * 0x100000001b3u;                             \
    }
#define ADD_ONE(name, f, family) ADD(name, x)
#define ADD_TWO(name, f, family) ADD(name, x, y)
    NEVH__EACH_ONE(ADD_ONE)
    NEVH__EACH_TWO(ADD_TWO)
#undef ADD_TWO
#undef ADD_ONE
#undef ADD
    ck_assert_msg(digest == 0x88689f58eae77b4bu, "%016llx",
                  (unsigned long long)digest);
}

/* Whether an exponent is whole, and odd, where numbers are as far apart as 1. */
TEST(large_powers_of_minus_one) {
    static const double exponents[] = {
        0x1p51 + 1, 0x1p51 + 0.5, -0x1p51 - 0.5, 0x1p52 + 1, 0x1p52 + 2,
        0x1p53 - 1, 0x1p53 - 2,   0x1p53 + 2,    0x1p60,     -0x1p52 - 1};
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
        double got = nevh_simd_power(-1, exponents[i]);
        double want = pow(-1, exponents[i]);
        ck_assert_msg(got == want || (isnan(got) && isnan(want)),
                      "(-1)^%.17g is %g, not %g", exponents[i], want, got);
    }
}
