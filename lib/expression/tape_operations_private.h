/* nevh: what the operations of a tape do.
   SPDX-License-Identifier: GPL-3.0-or-later

   NEVH__FORMULAS(X) gives X(identifier, value, by_a, by_b): the value y of
   arguments a and b, and g times its derivatives by them.  Before it is used,
   NEVH__F(f) is defined: which form of libm's f to take. */
#ifndef NEVH_TAPE_OPERATIONS_PRIVATE_H
#define NEVH_TAPE_OPERATIONS_PRIVATE_H

#include "expression/tape_private.h"
#include <nevh/body.h>
#include <float.h>

/* With NaN outside their domains, where GSL would abort. */
double nevh__bessel_j0(double x);
double nevh__bessel_j1(double x);
double nevh__bessel_j1_slope(double x);
double nevh__elliptic_k(double k);
double nevh__elliptic_e(double k);
double nevh__elliptic_k_slope(double k);
double nevh__elliptic_e_slope(double k);
/* The eccentric anomaly E of a mean one, and dE/dM; dE/de is sin E times that. */
double nevh__kepler(double mean, double e);
double nevh__kepler_slope(double anomaly, double e);

NEVH__INLINE double nevh__choose(bool first, double x, double y) {
    return first ? x : y;
}

NEVH__INLINE double nevh__sign(double x) {
    double sign = x > 0 ? 1 : x < 0 ? -1 : 0;
    return x != x ? x : sign;
}

NEVH__INLINE double nevh__mod(double x, double y) {
    double rest = fmod(x, y);
    return rest != 0 && (rest < 0) != (y < 0) ? rest + y : rest;
}

/* In the chain rule 0 times infinity is 0. */
NEVH__INLINE double nevh__chain(double x, double y) {
    double product = x * y;
    bool undecided = (product != product) & !isunordered(x, y);
    return undecided ? 0 : product;
}
#define NEVH__G(slope) nevh__chain(g, slope)
/* Where g is a constant, so are 2 g and 3 g. */
#define NEVH__TWICE_G(slope)  nevh__chain(2 * g, slope)
#define NEVH__THRICE_G(slope) nevh__chain(3 * g, slope)

#define NEVH__LN10 2.302585092994045684

// clang-format off
#define NEVH__FORMULAS(X)                                                      \
    X(ADD, a + b, g, g)                                                        \
    X(SUBTRACT, a - b, g, -g)                                                  \
    X(MULTIPLY, a * b, NEVH__G(b), NEVH__G(a))                                 \
    X(DIVIDE, a / b, NEVH__G(1 / b), NEVH__G(-y * (1 / b)))                    \
    X(POWER, NEVH__F(pow)(a, b),                                               \
      NEVH__G(nevh__chain(b, NEVH__F(pow)(a, b - 1))),                         \
      NEVH__G(nevh__chain(y, NEVH__F(log)(a))))                                \
    X(NEGATE, -a, -g, 0)                                                       \
    X(SQUARE, a * a, NEVH__TWICE_G(a), 0)                                      \
    X(CUBE, a * (a * a), NEVH__THRICE_G(a * a), 0)                             \
    X(SIN, NEVH__F(sin)(a), NEVH__G(NEVH__F(cos)(a)), 0)                       \
    X(COS, NEVH__F(cos)(a), NEVH__G(-NEVH__F(sin)(a)), 0)                      \
    X(TAN, NEVH__F(tan)(a), NEVH__G(1 + y * y), 0)                             \
    X(ASIN, NEVH__F(asin)(a), NEVH__G(1 / NEVH__F(sqrt)((1 - a) * (1 + a))), 0)\
    X(ACOS, NEVH__F(acos)(a), NEVH__G(-1 / NEVH__F(sqrt)((1 - a) * (1 + a))),  \
      0)                                                                       \
    X(ATAN, NEVH__F(atan)(a), NEVH__G(1 / (1 + a * a)), 0)                     \
    X(ATAN2, NEVH__F(atan2)(a, b),                                             \
      NEVH__G(b / NEVH__F(hypot)(a, b) / NEVH__F(hypot)(a, b)),                \
      NEVH__G(-a / NEVH__F(hypot)(a, b) / NEVH__F(hypot)(a, b)))               \
    X(SINH, NEVH__F(sinh)(a), NEVH__G(NEVH__F(cosh)(a)), 0)                    \
    X(COSH, NEVH__F(cosh)(a), NEVH__G(NEVH__F(sinh)(a)), 0)                    \
    X(TANH, NEVH__F(tanh)(a), NEVH__G(1 / NEVH__F(cosh)(a) / NEVH__F(cosh)(a)),\
      0)                                                                       \
    X(ASINH, asinh(a), NEVH__G(1 / NEVH__F(hypot)(1, a)), 0)                   \
    X(ACOSH, acosh(a),                                                         \
      NEVH__G(1 / NEVH__F(sqrt)(a - 1) / NEVH__F(sqrt)(a + 1)), 0)             \
    X(ATANH, atanh(a), NEVH__G(1 / ((1 - a) * (1 + a))), 0)                    \
    X(EXP, NEVH__F(exp)(a), NEVH__G(y), 0)                                     \
    X(LOG, NEVH__F(log)(a), NEVH__G(1 / a), 0)                                 \
    X(LOG10, log10(a), NEVH__G(1 / (a * NEVH__LN10)), 0)                       \
    X(SQRT, NEVH__F(sqrt)(a), NEVH__G(0.5 * (1 / y)), 0)                       \
    X(CBRT, NEVH__F(cbrt)(a), NEVH__G(1 / (3 * y * y)), 0)                     \
    X(HYPOT, NEVH__F(hypot)(a, b), NEVH__G(nevh__choose(y == 0, 0, a / y)),    \
      NEVH__G(nevh__choose(y == 0, 0, b / y)))                                 \
    X(ABS, fabs(a), NEVH__G(nevh__sign(a)), 0)                                 \
    X(MIN, nevh__real_min(a, b), NEVH__G(a < b), NEVH__G(!(a < b)))                 \
    X(MAX, nevh__real_max(a, b), NEVH__G(a > b), NEVH__G(!(a > b)))                 \
    X(SIGN, nevh__sign(a), NEVH__G(0), 0)                                      \
    X(MOD, nevh__mod(a, b), g, NEVH__G(-rint((a - y) / b)))                    \
    X(FLOOR, floor(a), NEVH__G(0), 0)                                          \
    X(BESSEL_J0, nevh__bessel_j0(a), NEVH__G(-nevh__bessel_j1(a)), 0)          \
    X(BESSEL_J1, nevh__bessel_j1(a), NEVH__G(nevh__bessel_j1_slope(a)), 0)     \
    X(ELLIPTIC_K, nevh__elliptic_k(a), NEVH__G(nevh__elliptic_k_slope(a)), 0)  \
    X(ELLIPTIC_E, nevh__elliptic_e(a), NEVH__G(nevh__elliptic_e_slope(a)), 0)  \
    X(ECCENTRIC, nevh__kepler(a, b), NEVH__G(nevh__kepler_slope(y, b)),           \
      NEVH__G(NEVH__F(sin)(y) * nevh__kepler_slope(y, b)))
// clang-format on

#endif
