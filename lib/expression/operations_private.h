/* nevh: the operations of formulas, all that is known of each.
   SPDX-License-Identifier: GPL-3.0-or-later

   NEVH__OPERATIONS(X) gives X(kind, identifier, name, arity, value, by_a, by_b,
   ...):

   kind     ARITHMETIC; FUNCTION, analytic between its edges; KINK, with kinks or
            jumps; SPECIAL, compiled text and Taylor series do without; GSL, these
            too, and what GSL computes may differ between machines in last digits
   name     in formulas
   value    the value y of arguments a and b.  Functions are called by
            NEVH__F(f) where they are elementary, by NEVH__L(f) where libm has
            them, and by NEVH__H(f) where nevh has, for each kind of numbers;
            includers define these
   by_a     g times the derivatives by the arguments, of doubles
   ...      initializers of a nevh__operation_traits: the same as formulas, and what
            else differs from 0

   A formula here is in postfix notation: names of operations, neg for -a,
   numbers, a, b and y, with spaces between.  A derivative is {numerator,
   denominator}, of which no denominator is 1. */
#ifndef NEVH_OPERATIONS_PRIVATE_H
#define NEVH_OPERATIONS_PRIVATE_H

#define NEVH__LN10 2.302585092994045684

// clang-format off
#define NEVH__OPERATIONS(X)                                                    \
    X(ARITHMETIC, ADD, "+", 2, a + b, g, g,                                    \
      .by_a = {"1"}, .by_b = {"1"})                                            \
    X(ARITHMETIC, SUBTRACT, "-", 2, a - b, g, -g,                              \
      .by_a = {"1"}, .by_b = {"1 neg"})                                        \
    X(ARITHMETIC, MULTIPLY, "*", 2, a * b, NEVH__G(b), NEVH__G(a),             \
      .by_a = {"b"}, .by_b = {"a"})                                            \
    X(ARITHMETIC, DIVIDE, "/", 2, a / b, NEVH__G(1 / b), NEVH__G(-y * (1 / b)),\
      .by_a = {"1", "b"}, .by_b = {"y neg", "b"},                              \
      .at_edge = "a function of a quotient, which has a pole there,")          \
    X(ARITHMETIC, POWER, "^", 2, NEVH__F(pow)(a, b),                           \
      NEVH__G(nevh__chain(b, NEVH__F(pow)(a, b - 1))),                         \
      NEVH__G(nevh__chain(y, NEVH__F(log)(a))),                                \
      .by_a = {"b a b 1 - ^ *"}, .by_b = {"a log y *"},                        \
      .at_edge = "a power that is no whole number, whose base reaches 0,")     \
    X(ARITHMETIC, NEGATE, "-", 1, -a, -g, 0,                                   \
      .by_a = {"1 neg"}, .exact = true)                                        \
    X(ARITHMETIC, SQUARE, "^2", 1, a * a, NEVH__TWICE_G(a), 0,                 \
      .by_a = {"2 a *"}, .as = "a a *")                                        \
    X(ARITHMETIC, CUBE, "^3", 1, a * (a * a), NEVH__THRICE_G(a * a), 0,        \
      .by_a = {"3 a a * *"}, .as = "a a a * *")                                \
    X(FUNCTION, SIN, "sin", 1, NEVH__F(sin)(a), NEVH__G(NEVH__F(cos)(a)), 0,   \
      .by_a = {"a cos"})                                                       \
    X(FUNCTION, COS, "cos", 1, NEVH__F(cos)(a), NEVH__G(-NEVH__F(sin)(a)), 0,  \
      .by_a = {"a sin neg"})                                                   \
    X(FUNCTION, TAN, "tan", 1, NEVH__F(tan)(a), NEVH__G(1 + y * y), 0,         \
      .by_a = {"1 y y * +"},                                                   \
      .at_edge = "a function of tan(...), which has a pole there,")            \
    X(FUNCTION, ASIN, "asin", 1, NEVH__F(asin)(a),                             \
      NEVH__G(1 / NEVH__F(sqrt)((1 - a) * (1 + a))), 0,                        \
      .by_a = {"1", "1 a a * - sqrt"}, .edge = "1 a a * -",                    \
      .at_edge = "asin(...), whose argument reaches 1 or -1,")                 \
    X(FUNCTION, ACOS, "acos", 1, NEVH__F(acos)(a),                             \
      NEVH__G(-1 / NEVH__F(sqrt)((1 - a) * (1 + a))), 0,                       \
      .by_a = {"1 neg", "1 a a * - sqrt"}, .edge = "1 a a * -",                \
      .at_edge = "acos(...), whose argument reaches 1 or -1,")                 \
    X(FUNCTION, ATAN, "atan", 1, NEVH__F(atan)(a), NEVH__G(1 / (1 + a * a)), 0,\
      .by_a = {"1", "1 a a * +"})                                              \
    X(FUNCTION, ATAN2, "atan2", 2, NEVH__F(atan2)(a, b),                       \
      NEVH__G(b / NEVH__F(hypot)(a, b) / NEVH__F(hypot)(a, b)),                \
      NEVH__G(-a / NEVH__F(hypot)(a, b) / NEVH__F(hypot)(a, b)),               \
      .by_a = {"b", "a a * b b * +"}, .by_b = {"a neg", "a a * b b * +"},      \
      .usage = "(y, x)",                                                       \
      .jumps = true,                                                           \
      .at_edge = "atan2(...), which jumps where its direction is that of the " \
                 "negative axis,")                                             \
    X(FUNCTION, SINH, "sinh", 1, NEVH__F(sinh)(a), NEVH__G(NEVH__F(cosh)(a)),  \
      0, .by_a = {"a cosh"}, .steep = true)                                    \
    X(FUNCTION, COSH, "cosh", 1, NEVH__F(cosh)(a), NEVH__G(NEVH__F(sinh)(a)),  \
      0, .by_a = {"a sinh"}, .steep = true)                                    \
    X(FUNCTION, TANH, "tanh", 1, NEVH__F(tanh)(a),                             \
      NEVH__G(1 / NEVH__F(cosh)(a) / NEVH__F(cosh)(a)), 0,                     \
      .by_a = {"1 y y * -"}, .steep = true)                                    \
    X(FUNCTION, ASINH, "asinh", 1, NEVH__F(asinh)(a),                          \
      NEVH__G(1 / NEVH__F(hypot)(1, a)), 0,                                    \
      .by_a = {"1", "1 a a * + sqrt"}, .lanewise = true)                       \
    X(FUNCTION, ACOSH, "acosh", 1, NEVH__F(acosh)(a),                          \
      NEVH__G(1 / NEVH__F(sqrt)(a - 1) / NEVH__F(sqrt)(a + 1)), 0,             \
      .by_a = {"a 1 - -0.5 ^ 1 a + -0.5 ^ *"},                                 \
      .edge = "a 1 -", .at_edge = "acosh(...), whose argument reaches 1,")     \
    X(FUNCTION, ATANH, "atanh", 1, NEVH__F(atanh)(a),                          \
      NEVH__G(1 / ((1 - a) * (1 + a))), 0,                                     \
      .by_a = {"1", "1 a a * -"}, .edge = "1 a a * -",                         \
      .at_edge = "atanh(...), whose argument reaches 1 or -1,")                \
    X(FUNCTION, EXP, "exp", 1, NEVH__F(exp)(a), NEVH__G(y), 0,                 \
      .by_a = {"y"}, .steep = true)                                            \
    X(FUNCTION, LOG, "log", 1, NEVH__F(log)(a), NEVH__G(1 / a), 0,             \
      .by_a = {"1", "a"}, .edge = "a",                                         \
      .at_edge = "log(...), whose argument reaches 0,")                        \
    X(FUNCTION, LOG10, "log10", 1, NEVH__F(log10)(a),                          \
      NEVH__G(1 / (a * NEVH__LN10)), 0,                                        \
      .by_a = {"1", "a 10 log *"}, .edge = "a",                                \
      .at_edge = "log10(...), whose argument reaches 0,")                      \
    X(FUNCTION, SQRT, "sqrt", 1, NEVH__F(sqrt)(a), NEVH__G(0.5 * (1 / y)), 0,  \
      .by_a = {"0.5", "y"}, .as = "a 0.5 ^", .edge = "a", .touches = true,     \
      .at_edge = "sqrt(...), whose argument reaches 0,")                       \
    X(FUNCTION, CBRT, "cbrt", 1, NEVH__F(cbrt)(a), NEVH__G(1 / (3 * y * y)), 0,\
      .by_a = {"1", "3 y y * *"}, .edge = "a",                                 \
      .at_edge = "cbrt(...), whose argument reaches 0,")                       \
    X(FUNCTION, HYPOT, "hypot", 2, NEVH__F(hypot)(a, b),                       \
      NEVH__G(nevh__choose(y == 0, 0, a / y)),                                 \
      NEVH__G(nevh__choose(y == 0, 0, b / y)),                                 \
      .by_a = {"a", "y"}, .by_b = {"b", "y"}, .as = "a a * b b * + 0.5 ^",     \
      .lanewise = true, .edge = "a a * b b * +", .touches = true,              \
      .at_edge = "hypot(...), both of whose arguments reach 0,")               \
    X(KINK, ABS, "abs", 1, NEVH__L(fabs)(a), NEVH__G(nevh__sign(a)), 0,        \
      .by_a = {"a sign"}, .as = "a a sign *", .lanewise = true, .exact = true, \
      .edge = "a", .at_edge = "abs(...), whose argument reaches 0,")           \
    X(KINK, MIN, "min", 2, NEVH__H(real_min)(a, b), NEVH__G(a < b),            \
      NEVH__G(!(a < b)),                                                       \
      .by_a = {"b a - sign 0 max"}, .by_b = {"1 b a - sign 0 max -"},          \
      .as = "a b - b a - sign 0.5 * 0.5 + * b +", .lanewise = true,            \
      .exact = true, .edge = "a b -",                                          \
      .at_edge = "min(...), whose arguments become equal,")                    \
    X(KINK, MAX, "max", 2, NEVH__H(real_max)(a, b), NEVH__G(a > b),            \
      NEVH__G(!(a > b)),                                                       \
      .by_a = {"a b - sign 0 max"}, .by_b = {"1 a b - sign 0 max -"},          \
      .as = "a b - a b - sign 0.5 * 0.5 + * b +", .lanewise = true,            \
      .exact = true, .edge = "a b -",                                          \
      .at_edge = "max(...), whose arguments become equal,")                    \
    X(KINK, SIGN, "sign", 1, NEVH__H(sign)(a), NEVH__G(0), 0,                  \
      .by_a = {"0"}, .lanewise = true, .exact = true,                          \
      .jumps = true,                                                           \
      .edge = "a", .at_edge = "sign(...), whose argument reaches 0,")          \
    X(KINK, MOD, "mod", 2, NEVH__H(mod)(a, b), g, NEVH__G(-rint((a - y) / b)), \
      .by_a = {"1"}, .by_b = {"a b / floor neg"},                              \
      .as = "a b a b / floor * -", .lanewise = true, .usage = "(a, b)",        \
      .edge = "a b / a b / floor - 1 a b / a b / floor - - *",                 \
      .jumps = true,                                                           \
      .at_edge = "mod(...), whose first argument reaches a multiple of the "   \
                 "second,")                                                    \
    X(KINK, FLOOR, "floor", 1, NEVH__L(floor)(a),                              \
      nevh__choose(y == y, 0, y), 0,                                           \
      .by_a = {"0"}, .lanewise = true, .exact = true,                          \
      .edge = "a a floor - 1 a a floor - - *",                                 \
      .jumps = true,                                                           \
      .at_edge = "floor(...), whose argument reaches a whole number,")         \
    X(GSL, BESSEL_J0, "bessel_j0", 1, NEVH__S(bessel_j0)(a),                   \
      NEVH__G(-nevh__bessel_j1(a)), 0, .usage = 0)                             \
    X(GSL, BESSEL_J1, "bessel_j1", 1, NEVH__S(bessel_j1)(a),                   \
      NEVH__G(nevh__bessel_j1_slope(a)), 0, .usage = 0)                        \
    X(GSL, ELLIPTIC_K, "elliptic_k", 1, NEVH__S(elliptic_k)(a),                \
      NEVH__G(nevh__elliptic_k_slope(a)), 0, .usage = 0)                       \
    X(GSL, ELLIPTIC_E, "elliptic_e", 1, NEVH__S(elliptic_e)(a),                \
      NEVH__G(nevh__elliptic_e_slope(a)), 0, .usage = 0)                       \
    X(SPECIAL, ECCENTRIC, "kepler", 2, NEVH__S(kepler)(a, b),                  \
      NEVH__G(nevh__kepler_slope(y, b)),                                       \
      NEVH__G(NEVH__F(sin)(y) * nevh__kepler_slope(y, b)),                     \
      .by_a = {"1", "1 b y cos * -"}, .by_b = {"y sin", "1 b y cos * -"})
// clang-format on

#endif
