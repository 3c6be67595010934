/* nevh: how operations are rewritten as a tape is made.  Nothing here changes
   a result, but for small powers; see nevh__tape_apply.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include <math.h>

static const double most_multiplied = 8, most_rooted = 5;

/* The bits count: -0 is not 0. */
static bool tape_rules_is(const nevh__tape_builder *b, int node, double x) {
    double y;
    return nevh__tape_is_number(b, node, &y) && y == x &&
           !signbit(y) == !signbit(x);
}

/* True if a node is -z. */
static bool is_negated(const nevh__tape_builder *b, int node, int *z) {
    const nevh__tape_node *n = &b->nodes[node];
    if (n->kind != NEVH__SLOT || n->operation != NEVH__NEGATE)
        return false;
    *z = n->a;
    return true;
}

/* True if a node is c*z with a number c. */
static bool is_multiple(const nevh__tape_builder *b, int node, double *c,
                        int *z) {
    const nevh__tape_node *n = &b->nodes[node];
    if (n->kind != NEVH__SLOT || n->operation != NEVH__MULTIPLY)
        return false;
    bool first = nevh__tape_is_number(b, n->a, c);
    *z = first ? n->b : n->a;
    return first || nevh__tape_is_number(b, n->b, c);
}

static int tape_rules_operation(nevh__tape_builder *b, nevh__tape_operation of,
                                int x, int y) {
    return nevh__builder_node(
        b, (nevh__tape_node){
               .kind = NEVH__SLOT, .operation = (uint8_t)of, .a = x, .b = y});
}

static int commutative(nevh__tape_builder *b, nevh__tape_operation of, int x,
                       int y) {
    return x < y ? tape_rules_operation(b, of, x, y)
                 : tape_rules_operation(b, of, y, x);
}

/* The operand that an even function may take instead: z of abs(z). */
static int without_sign(const nevh__tape_builder *b, int node) {
    const nevh__tape_node *n = &b->nodes[node];
    bool is_size = n->kind == NEVH__SLOT && n->operation == NEVH__ABS;
    return is_size ? n->a : node;
}

static int tape_rules_add(nevh__tape_builder *b, int x, int y) {
    int z;
    if (tape_rules_is(b, y, -0.0))
        return x;
    if (tape_rules_is(b, x, -0.0))
        return y;
    if (is_negated(b, y, &z))
        return nevh__tape_apply(b, NEVH__SUBTRACT, x, z);
    if (is_negated(b, x, &z))
        return nevh__tape_apply(b, NEVH__SUBTRACT, y, z);
    return commutative(b, NEVH__ADD, x, y);
}

static int tape_rules_subtract(nevh__tape_builder *b, int x, int y) {
    int z;
    if (tape_rules_is(b, y, 0.0))
        return x;
    if (tape_rules_is(b, x, -0.0))
        return nevh__tape_apply(b, NEVH__NEGATE, y, y);
    if (is_negated(b, y, &z))
        return nevh__tape_apply(b, NEVH__ADD, x, z);
    return tape_rules_operation(b, NEVH__SUBTRACT, x, y);
}

static int negate(nevh__tape_builder *b, int x) {
    int z;
    double c;
    if (is_negated(b, x, &z))
        return z;
    if (is_multiple(b, x, &c, &z))
        return nevh__tape_apply(b, NEVH__MULTIPLY, nevh__tape_number(b, -c), z);
    return tape_rules_operation(b, NEVH__NEGATE, x, x);
}

/* y is not a number unless x is none. */
static int multiply_number(nevh__tape_builder *b, int number, double c, int y) {
    int z;
    if (c == 1)
        return y;
    if (c == -1)
        return negate(b, y);
    if (is_negated(b, y, &z))
        return nevh__tape_apply(b, NEVH__MULTIPLY, nevh__tape_number(b, -c), z);
    return commutative(b, NEVH__MULTIPLY, number, y);
}

static int tape_rules_multiply(nevh__tape_builder *b, int x, int y) {
    int z, w;
    double c;
    if (nevh__tape_is_number(b, x, &c))
        return multiply_number(b, x, c, y);
    if (nevh__tape_is_number(b, y, &c))
        return multiply_number(b, y, c, x);
    if (is_negated(b, x, &z) && is_negated(b, y, &w))
        return nevh__tape_apply(b, NEVH__MULTIPLY, z, w);
    if (x == y) {
        x = without_sign(b, x);
        return tape_rules_operation(b, NEVH__SQUARE, x, x);
    }
    return commutative(b, NEVH__MULTIPLY, x, y);
}

/* 2^k whose reciprocal is normal. */
static bool is_power_of_two(double c) {
    int exponent;
    return fabs(frexp(c, &exponent)) == 0.5 && isnormal(1 / c);
}

static int tape_rules_divide(nevh__tape_builder *b, int x, int y) {
    int z, w;
    double c;
    if (nevh__tape_is_number(b, y, &c) && is_power_of_two(c))
        return nevh__tape_apply(b, NEVH__MULTIPLY, x,
                                nevh__tape_number(b, 1 / c));
    if (is_negated(b, x, &z) && is_negated(b, y, &w))
        return nevh__tape_apply(b, NEVH__DIVIDE, z, w);
    return tape_rules_operation(b, NEVH__DIVIDE, x, y);
}

/* x^n, n > 0, by squaring. */
static int tape_rules_multiplied(nevh__tape_builder *b, int x, int n) {
    if (n == 1)
        return x;
    if (n == 3)
        return nevh__tape_apply(b, NEVH__CUBE, x, x);
    int most = tape_rules_multiplied(b, x, n % 2 ? n - 1 : n / 2);
    return nevh__tape_apply(b, NEVH__MULTIPLY, n % 2 ? x : most, most);
}

/* x^c, c > 0, by multiplication and perhaps a root. */
static int expanded(nevh__tape_builder *b, int x, double c) {
    int n = (int)c;
    if (c == n)
        return tape_rules_multiplied(b, x, n);
    int root = nevh__tape_apply(b, NEVH__SQRT, x, x);
    if (n == 0)
        return root;
    return nevh__tape_apply(b, NEVH__MULTIPLY, tape_rules_multiplied(b, x, n),
                            root);
}

static bool is_expandable(double c) {
    return fabs(c) <= (rint(c) == c ? most_multiplied : most_rooted) &&
           rint(2 * c) == 2 * c;
}

static int tape_rules_power(nevh__tape_builder *b, int x, int y) {
    double c;
    if (tape_rules_is(b, x, 1))
        return x;
    if (nevh__tape_is_number(b, y, &c) && fmod(c, 2) == 0)
        x = without_sign(b, x);
    if (!nevh__tape_is_number(b, y, &c) || !is_expandable(c))
        return tape_rules_operation(b, NEVH__POWER, x, y);
    if (c == 0)
        return nevh__tape_number(b, 1);
    int up = expanded(b, x, fabs(c));
    if (c > 0)
        return up;
    return nevh__tape_apply(b, NEVH__DIVIDE, nevh__tape_number(b, 1), up);
}

static int rewritten(nevh__tape_builder *b, nevh__tape_operation of, int x,
                     int y) {
    switch (of) {
    case NEVH__ADD:
        return tape_rules_add(b, x, y);
    case NEVH__SUBTRACT:
        return tape_rules_subtract(b, x, y);
    case NEVH__MULTIPLY:
        return tape_rules_multiply(b, x, y);
    case NEVH__DIVIDE:
        return tape_rules_divide(b, x, y);
    case NEVH__POWER:
        return tape_rules_power(b, x, y);
    case NEVH__NEGATE:
        return negate(b, x);
    case NEVH__ABS:
    case NEVH__COS:
    case NEVH__COSH:
        x = without_sign(b, x);
        return tape_rules_operation(b, of, x, x);
    case NEVH__HYPOT:
        return tape_rules_operation(b, of, without_sign(b, x),
                                    without_sign(b, y));
    default:
        return tape_rules_operation(b, of, x, y);
    }
}

int nevh__tape_apply(nevh__tape_builder *b, nevh__tape_operation of, int x,
                     int y) {
    double c, d;
    if (nevh__operation_arguments(of) == 1)
        y = x;
    if (x < 0 || y < 0 || !b || b->failed)
        return -1;
    if (!b->unfolded && nevh__tape_is_number(b, x, &c) &&
        nevh__tape_is_number(b, y, &d))
        return nevh__tape_number(b, nevh__operation_value(of, c, d));
    return rewritten(b, of, x, y);
}
