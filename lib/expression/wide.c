/* nevh: operations on numbers with more digits than double.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/wide_private.h"
#include "expression/tape_private.h"
#include "expression/tape_inside_private.h"
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

nevh__rounded nevh__operation_rounded(unsigned operation, nevh__rounded a,
                                      nevh__rounded b) {
    nevh__wide y = nevh__operation_wide(operation, a.value, b.value), off = 0;
    for (int i = 0; i < 4 && (a.off > 0 || b.off > 0); i++) {
        nevh__wide corner = nevh__operation_wide(
            operation, i % 2 ? a.value + a.off : a.value - a.off,
            i / 2 ? b.value + b.off : b.value - b.off);
        off = real_max(NEVH__F(fabs)(corner - y), off);
    }
    if (!is_exact(operation, a.value, b.value, y))
        off += NEVH__F(fabs)(y) * NEVH__WIDE_EPSILON;
    return (nevh__rounded){y, off};
}
