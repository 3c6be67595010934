/* nevh: what the operations of a tape do.
   SPDX-License-Identifier: GPL-3.0-or-later

   NEVH__FORMULAS(X) gives X(identifier, value, slope_a, slope_b): the value
   of arguments a and b, and its derivatives, in which y is the value.  Before
   it is used, NEVH__F(f) is defined: which form of libm's f to take. */
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

/* Both are evaluated, so that no function is called under a condition. */
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
    return product != product && x == x && y == y ? 0 : product;
}

#define NEVH__LN10 2.302585092994045684

// clang-format off
#define NEVH__FORMULAS(X)                                                      \
    X(ADD, a + b, 1, 1)                                                        \
    X(SUBTRACT, a - b, 1, -1)                                                  \
    X(MULTIPLY, a * b, b, a)                                                   \
    X(DIVIDE, a / b, 1 / b, -y / b)                                            \
    X(POWER, NEVH__F(pow)(a, b),                                               \
      nevh__choose(b == 0, 0, b * NEVH__F(pow)(a, b - 1)),                     \
      nevh__choose(a == 0 && b > 0, 0, y * NEVH__F(log)(a)))                   \
    X(NEGATE, -a, -1, 0)                                                       \
    X(SIN, NEVH__F(sin)(a), NEVH__F(cos)(a), 0)                                \
    X(COS, NEVH__F(cos)(a), -NEVH__F(sin)(a), 0)                               \
    X(TAN, NEVH__F(tan)(a), 1 + y * y, 0)                                      \
    X(ASIN, NEVH__F(asin)(a), 1 / NEVH__F(sqrt)((1 - a) * (1 + a)), 0)         \
    X(ACOS, NEVH__F(acos)(a), -1 / NEVH__F(sqrt)((1 - a) * (1 + a)), 0)        \
    X(ATAN, NEVH__F(atan)(a), 1 / (1 + a * a), 0)                              \
    X(ATAN2, NEVH__F(atan2)(a, b),                                             \
      b / NEVH__F(hypot)(a, b) / NEVH__F(hypot)(a, b),                         \
      -a / NEVH__F(hypot)(a, b) / NEVH__F(hypot)(a, b))                        \
    X(SINH, NEVH__F(sinh)(a), NEVH__F(cosh)(a), 0)                             \
    X(COSH, NEVH__F(cosh)(a), NEVH__F(sinh)(a), 0)                             \
    X(TANH, NEVH__F(tanh)(a), 1 / NEVH__F(cosh)(a) / NEVH__F(cosh)(a), 0)      \
    X(ASINH, asinh(a), 1 / NEVH__F(hypot)(1, a), 0)                            \
    X(ACOSH, acosh(a), 1 / NEVH__F(sqrt)(a - 1) / NEVH__F(sqrt)(a + 1), 0)     \
    X(ATANH, atanh(a), 1 / ((1 - a) * (1 + a)), 0)                             \
    X(EXP, NEVH__F(exp)(a), y, 0)                                              \
    X(LOG, NEVH__F(log)(a), 1 / a, 0)                                          \
    X(LOG10, log10(a), 1 / (a * NEVH__LN10), 0)                                \
    X(SQRT, NEVH__F(sqrt)(a), 0.5 / y, 0)                                      \
    X(CBRT, NEVH__F(cbrt)(a), 1 / (3 * y * y), 0)                              \
    X(HYPOT, NEVH__F(hypot)(a, b), nevh__choose(y == 0, 0, a / y),             \
      nevh__choose(y == 0, 0, b / y))                                          \
    X(ABS, fabs(a), nevh__sign(a), 0)                                          \
    X(MIN, nevh__min(a, b), a < b, !(a < b))                                   \
    X(MAX, nevh__max(a, b), a > b, !(a > b))                                   \
    X(SIGN, nevh__sign(a), 0, 0)                                               \
    X(MOD, nevh__mod(a, b), 1, -rint((a - y) / b))                             \
    X(FLOOR, floor(a), 0, 0)                                                   \
    X(BESSEL_J0, nevh__bessel_j0(a), -nevh__bessel_j1(a), 0)                   \
    X(BESSEL_J1, nevh__bessel_j1(a), nevh__bessel_j1_slope(a), 0)              \
    X(ELLIPTIC_K, nevh__elliptic_k(a), nevh__elliptic_k_slope(a), 0)           \
    X(ELLIPTIC_E, nevh__elliptic_e(a), nevh__elliptic_e_slope(a), 0)
// clang-format on

#endif
