/* nevh: operations on numbers with more digits than double.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/wide_private.h"
#include "expression/tape_inside_private.h"
#include "expression/tape_private.h"
#include <stdint.h>
#include <string.h>
#ifndef NEVH_QUADMATH
#include "expression/tape_operations_private.h"
#undef NEVH__L
#undef NEVH__H
#undef NEVH__S
#include <math.h>
#endif

#ifdef NEVH_QUADMATH
#include <quadmath.h>

/* As mod of formulas: with the sign of the second argument. */
static nevh__wide mod(nevh__wide x, nevh__wide y) {
    nevh__wide rest = fmodq(x, y);
    return rest != 0 && signbitq(rest) != signbitq(y) ? rest + y : rest;
}

/* Complete integrals of the modulus k by the arithmetic-geometric mean [M.
   Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 17.6]. */
static nevh__wide wide_elliptic(nevh__wide k, bool second) {
    enum { MOST = 20 };
    nevh__wide a = 1, g = sqrtq((1 - k) * (1 + k)), sum = k * k / 2, power = 1;
    if (second && fabsq(k) == 1)
        return 1;
    for (int i = 0; i < MOST && fabsq(a - g) > 1e-34 * a; i++) {
        nevh__wide c = (a - g) / 2, mean = a - c;
        g = sqrtq(a * g);
        a = mean;
        sum += power * c * c;
        power *= 2;
    }
    nevh__wide first = nevh__wide_pi() / (a + g);
    return second ? first * (1 - sum) : first;
}

static nevh__wide elliptic_k(nevh__wide k) {
    return wide_elliptic(k, false);
}

static nevh__wide elliptic_e(nevh__wide k) {
    return wide_elliptic(k, true);
}

/* Newton's iteration from the double. */
static nevh__wide eccentric(nevh__wide mean, nevh__wide e) {
    enum { MOST = 4 };
    nevh__wide x =
        nevh__operation_value(NEVH__ECCENTRIC, (double)mean, (double)e);
    for (int i = 0; i < MOST; i++)
        x -= (x - e * sinq(x) - mean) / (1 - e * cosq(x));
    return x;
}

#define NEVH__S(f) f
#define bessel_j0  j0q
#define bessel_j1  j1q
#define kepler     eccentric

nevh__wide nevh__wide_pi(void) {
    return acosq(-1);
}
#else
#define NEVH__S(f) nevh__##f
static nevh__wide mod(nevh__wide x, nevh__wide y) {
    return nevh__mod((double)x, (double)y);
}
nevh__wide nevh__wide_pi(void) {
    return 3.14159265358979323846264338327950288L;
}
#endif

static nevh__wide real_min(nevh__wide x, nevh__wide y) {
    return x < y || x != x ? x : y;
}

static nevh__wide real_max(nevh__wide x, nevh__wide y) {
    return x > y || x != x ? x : y;
}

static nevh__wide sign(nevh__wide x) {
    return x != x ? x : (x > 0) - (x < 0);
}

#define NEVH__F(f) NEVH__WIDE_FUNCTION(f)
#define NEVH__L(f) NEVH__WIDE_FUNCTION(f)
#define NEVH__H(f) f
#define CASE(kind, identifier, name, arity, value, by_a, by_b, ...)            \
    case NEVH__##identifier:                                                   \
        return value;
nevh__wide nevh__operation_wide(unsigned operation, nevh__wide a,
                                nevh__wide b) {
    switch (operation) {
        NEVH__OPERATIONS(CASE)
    default:
        return a - a;
    }
}

nevh__rounded nevh__rounded_pi(void) {
    nevh__wide pi = nevh__wide_pi();
    return (nevh__rounded){pi, pi * NEVH__WIDE_EPSILON};
}

/* True of a result without rounding.  What is left of sums, products, quotients and
   roots is a number itself. */
static bool is_exact(unsigned operation, nevh__wide a, nevh__wide b,
                     nevh__wide y) {
    switch (operation) {
    case NEVH__SUBTRACT:
        b = -b;
        /* fall through */
    case NEVH__ADD:
        return (a - (y - (y - a))) + (b - (y - a)) == 0;
    case NEVH__MULTIPLY:
        return NEVH__F(fma)(a, b, -y) == 0;
    case NEVH__DIVIDE:
        return NEVH__F(fma)(y, b, -a) == 0;
    case NEVH__SQRT:
        return NEVH__F(fma)(y, y, -a) == 0;
    default:
        return nevh__operation_of(operation)->exact;
    }
}

typedef struct {
    nevh__wide low, high;
} wide_range;

/* From which a function is defined for values that rounding alone has moved out of its
   domain. */
static wide_range domain_of(unsigned operation) {
    switch (operation) {
    case NEVH__SQRT:
        return (wide_range){0, INFINITY};
    case NEVH__ASIN:
    case NEVH__ACOS:
        return (wide_range){-1, 1};
    case NEVH__ACOSH:
        return (wide_range){1, INFINITY};
    default:
        return (wide_range){-INFINITY, INFINITY};
    }
}

/* The ends of a range, and 0 if it is within: extremes and poles are there.
   returns  how many */
static int places_in(nevh__rounded x, wide_range domain, nevh__wide to[3]) {
    to[0] = real_max(x.value - x.off, domain.low);
    to[1] = real_min(x.value + x.off, domain.high);
    to[2] = 0;
    return x.off == 0 ? 1 : 2 + (to[0] < 0 && to[1] > 0);
}

/* True of a function whose extremes and jumps may be anywhere between. */
static bool is_periodic(unsigned operation) {
    return operation == NEVH__SIN || operation == NEVH__COS ||
           operation == NEVH__TAN || operation == NEVH__BESSEL_J0 ||
           operation == NEVH__BESSEL_J1;
}

static bool mod_jumps(nevh__rounded a, nevh__rounded b) {
    nevh__wide low = (a.value - a.off) / (b.value + b.off),
               high = (a.value + a.off) / (b.value - b.off);
    return !(NEVH__F(floor)(low) == NEVH__F(floor)(high)) ||
           !(NEVH__F(fabs)(high) * NEVH__WIDE_EPSILON < 1);
}

/* The largest change of a result by its arguments' roundings. */
static nevh__wide moved_by_arguments(unsigned operation, nevh__rounded a,
                                     nevh__rounded b, nevh__wide y) {
    nevh__wide at_a[3], at_b[3], off = 0;
    if (a.off == 0 && b.off == 0)
        return 0;
    if (is_periodic(operation) && !(a.off < 1))
        return 2 + NEVH__F(fabs)(y);
    if (operation == NEVH__MOD && mod_jumps(a, b))
        return NEVH__F(fabs)(b.value) + b.off;
    int n = places_in(a, domain_of(operation), at_a);
    int m = places_in(b, domain_of(NEVH__ADD), at_b);
    for (int i = 0; i < n * m; i++) {
        nevh__wide by = NEVH__F(fabs)(
            nevh__operation_wide(operation, at_a[i % n], at_b[i / n]) - y);
        off = by == by ? real_max(off, by) : INFINITY;
    }
    return off;
}

/* A bound of what a function's own algorithm rounds. */
static nevh__wide own_rounding(unsigned operation, nevh__wide a, nevh__wide b,
                               nevh__wide y) {
    if (is_exact(operation, a, b, y))
        return 0;
    nevh__wide size = NEVH__F(fabs)(y);
    if (operation == NEVH__BESSEL_J0 || operation == NEVH__BESSEL_J1)
        size = 4;
    if (operation == NEVH__ECCENTRIC)
        size = (size + NEVH__F(fabs)(a)) / (1 - b * NEVH__F(cos)(y));
    return size * NEVH__WIDE_EPSILON;
}

nevh__rounded nevh__operation_rounded(unsigned operation, nevh__rounded a,
                                      nevh__rounded b) {
    nevh__wide y = nevh__operation_wide(operation, a.value, b.value);
    nevh__wide off = moved_by_arguments(operation, a, b, y) +
                     own_rounding(operation, a.value, b.value, y);
    bool known = y - y == 0 && off == off;
    return (nevh__rounded){y, known ? off : INFINITY};
}

/* In [1, 16) or (-16, -1], by the digits of a number. */
static nevh__wide factor_by(nevh__wide x) {
    union {
        nevh__wide x;
        uint64_t word[(sizeof(nevh__wide) + 7) / 8];
    } bits;
    memset(&bits, 0, sizeof bits);
    bits.x = x;
    uint64_t hash = 0;
    for (size_t i = 0; i < sizeof bits.word / sizeof *bits.word; i++)
        hash = (hash ^ bits.word[i]) * 0x9E3779B97F4A7C15u, hash ^= hash >> 29;
    double size = exp2((double)(hash >> 12 & 0xFFFF) * 0x1p-14);
    return hash >> 60 & 1 ? size : -size;
}

nevh__wide nevh__rounded_away(nevh__rounded x) {
    nevh__wide most = NEVH__F(fabs)(x.value) + 1;
    nevh__wide off = x.off <= most ? x.off : most;
    return off > 0 ? x.value + factor_by(x.value) * off : x.value;
}
