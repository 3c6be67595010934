/* nevh: operations on numbers with more digits than double.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/wide_private.h"
#include "expression/tape_private.h"

#ifdef NEVH_QUADMATH
#include <quadmath.h>

/* As mod of formulas: with the sign of the second argument. */
static nevh__wide modulo(nevh__wide x, nevh__wide y) {
    nevh__wide rest = fmodq(x, y);
    return rest != 0 && signbitq(rest) != signbitq(y) ? rest + y : rest;
}

/* Complete integrals of the modulus k by the arithmetic-geometric mean [M.
   Abramowitz, I. A. Stegun, Handbook of Mathematical Functions, 17.6]. */
static nevh__wide elliptic(nevh__wide k, bool second) {
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

/* Newton's iteration from the double. */
static nevh__wide eccentric(nevh__wide mean, nevh__wide e) {
    enum { MOST = 4 };
    nevh__wide x =
        nevh__operation_value(NEVH__ECCENTRIC, (double)mean, (double)e);
    for (int i = 0; i < MOST; i++)
        x -= (x - e * sinq(x) - mean) / (1 - e * cosq(x));
    return x;
}

static nevh__wide function(unsigned operation, nevh__wide x, nevh__wide y) {
    switch (operation) {
    case NEVH__POWER:
        return powq(x, y);
    case NEVH__SIN:
        return sinq(x);
    case NEVH__COS:
        return cosq(x);
    case NEVH__TAN:
        return tanq(x);
    case NEVH__ASIN:
        return asinq(x);
    case NEVH__ACOS:
        return acosq(x);
    case NEVH__ATAN:
        return atanq(x);
    case NEVH__ATAN2:
        return atan2q(x, y);
    case NEVH__SINH:
        return sinhq(x);
    case NEVH__COSH:
        return coshq(x);
    case NEVH__TANH:
        return tanhq(x);
    case NEVH__ASINH:
        return asinhq(x);
    case NEVH__ACOSH:
        return acoshq(x);
    case NEVH__ATANH:
        return atanhq(x);
    case NEVH__EXP:
        return expq(x);
    case NEVH__LOG:
        return logq(x);
    case NEVH__LOG10:
        return log10q(x);
    case NEVH__SQRT:
        return sqrtq(x);
    case NEVH__CBRT:
        return cbrtq(x);
    case NEVH__HYPOT:
        return hypotq(x, y);
    case NEVH__MOD:
        return modulo(x, y);
    case NEVH__FLOOR:
        return floorq(x);
    case NEVH__BESSEL_J0:
        return j0q(x);
    case NEVH__BESSEL_J1:
        return j1q(x);
    case NEVH__ELLIPTIC_K:
        return elliptic(x, false);
    case NEVH__ELLIPTIC_E:
        return elliptic(x, true);
    default:
        return eccentric(x, y);
    }
}

nevh__wide nevh__wide_pi(void) {
    return acosq(-1);
}
#else
static nevh__wide function(unsigned operation, nevh__wide x, nevh__wide y) {
    return nevh__operation_value((nevh__tape_operation)operation, (double)x,
                                 (double)y);
}

nevh__wide nevh__wide_pi(void) {
    return 3.14159265358979323846264338327950288L;
}
#endif

nevh__wide nevh__operation_wide(unsigned operation, nevh__wide x,
                                nevh__wide y) {
    switch (operation) {
    case NEVH__ADD:
        return x + y;
    case NEVH__SUBTRACT:
        return x - y;
    case NEVH__MULTIPLY:
        return x * y;
    case NEVH__DIVIDE:
        return x / y;
    case NEVH__NEGATE:
        return -x;
    case NEVH__SQUARE:
        return x * x;
    case NEVH__CUBE:
        return x * (x * x);
    case NEVH__ABS:
        return x < 0 ? -x : x;
    case NEVH__MIN:
        return x < y || x != x ? x : y;
    case NEVH__MAX:
        return x > y || x != x ? x : y;
    case NEVH__SIGN:
        return x != x ? x : (x > 0) - (x < 0);
    default:
        return function(operation, x, y);
    }
}
