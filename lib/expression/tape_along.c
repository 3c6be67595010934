/* nevh: the derivative of a tape along a displacement, as a tape.

   One forward sweep over the operations of h(q, p) builds, beside each result,
   its change along (dq, dp).  So the gradient of the new tape, by the reverse
   sweep that all tapes have, holds the product of the Hessian of h with (dq, dp)
   beside the gradient of h: forward over reverse.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include <stdlib.h>

/* No change: not a node. */
enum { STILL = -2 };

/* A value and its change. */
typedef struct {
    int y, d;
} dual;

typedef struct {
    const nevh__tape *tape;
    nevh__tape_builder *b;
    dual *slots;
} sweep;

static int apply(sweep *s, nevh__tape_operation f, int a, int b) {
    return nevh__tape_apply(s->b, f, a, b);
}

static int number(sweep *s, double x) {
    return nevh__tape_number(s->b, x);
}

/* Sums and products of which one may be no change. */
static int sum(sweep *s, int a, int b) {
    if (a == STILL || b == STILL)
        return a == STILL ? b : a;
    return apply(s, NEVH__ADD, a, b);
}

static int product(sweep *s, int by, int d) {
    return d == STILL ? STILL : apply(s, NEVH__MULTIPLY, by, d);
}

static int ratio(sweep *s, int d, int by) {
    return d == STILL ? STILL : apply(s, NEVH__DIVIDE, d, by);
}

static int negative(sweep *s, int d) {
    return d == STILL ? STILL : apply(s, NEVH__NEGATE, d, d);
}

static int square(sweep *s, int a) {
    return apply(s, NEVH__MULTIPLY, a, a);
}

/* sqrt(first + sign a^2) */
static int root(sweep *s, double first, int sign, int a) {
    nevh__tape_operation f = sign > 0 ? NEVH__ADD : NEVH__SUBTRACT;
    int inside = apply(s, f, number(s, first), square(s, a));
    return apply(s, NEVH__SQRT, inside, inside);
}

static int one_and(sweep *s, nevh__tape_operation f, int a) {
    return apply(s, f, number(s, 1), square(s, a));
}

static int call(sweep *s, nevh__tape_operation f, int a) {
    return apply(s, f, a, a);
}

/* a^b: b a^(b - 1) da + log(a) a^b db */
static int power(sweep *s, dual a, dual b, int y) {
    int less = apply(s, NEVH__SUBTRACT, b.y, number(s, 1));
    int by_a = apply(s, NEVH__MULTIPLY, b.y, apply(s, NEVH__POWER, a.y, less));
    int first = product(s, by_a, a.d);
    if (b.d == STILL)
        return first;
    int by_b = apply(s, NEVH__MULTIPLY, call(s, NEVH__LOG, a.y), y);
    return sum(s, first, product(s, by_b, b.d));
}

/* db + (da - db) where a is chosen: above 0. */
static int choice(sweep *s, int above, dual a, dual b) {
    int sign = call(s, NEVH__SIGN, above);
    int chosen = apply(s, NEVH__MAX, sign, number(s, 0));
    int other = apply(s, NEVH__SUBTRACT, number(s, 1), chosen);
    return sum(s, product(s, chosen, a.d), product(s, other, b.d));
}

/* Of y = f(a, b). */
static int change_of_two(sweep *s, unsigned f, dual a, dual b, int y) {
    switch (f) {
    case NEVH__ADD:
        return sum(s, a.d, b.d);
    case NEVH__SUBTRACT:
        return sum(s, a.d, negative(s, b.d));
    case NEVH__MULTIPLY:
        return sum(s, product(s, b.y, a.d), product(s, a.y, b.d));
    case NEVH__DIVIDE:
        return ratio(s, sum(s, a.d, negative(s, product(s, y, b.d))), b.y);
    case NEVH__POWER:
        return power(s, a, b, y);
    case NEVH__ATAN2:
        return ratio(
            s, sum(s, product(s, b.y, a.d), negative(s, product(s, a.y, b.d))),
            apply(s, NEVH__ADD, square(s, a.y), square(s, b.y)));
    case NEVH__HYPOT:
        return ratio(s, sum(s, product(s, a.y, a.d), product(s, b.y, b.d)), y);
    case NEVH__MIN:
        return choice(s, apply(s, NEVH__SUBTRACT, b.y, a.y), a, b);
    case NEVH__MAX:
        return choice(s, apply(s, NEVH__SUBTRACT, a.y, b.y), a, b);
    case NEVH__MOD: {
        int times = call(s, NEVH__FLOOR, apply(s, NEVH__DIVIDE, a.y, b.y));
        return sum(s, a.d, negative(s, product(s, times, b.d)));
    }
    default: { /* ECCENTRIC: y - b sin y = a */
        int below = apply(s, NEVH__SUBTRACT, number(s, 1),
                          apply(s, NEVH__MULTIPLY, b.y, call(s, NEVH__COS, y)));
        return ratio(s, sum(s, a.d, product(s, call(s, NEVH__SIN, y), b.d)),
                     below);
    }
    }
}

static bool is_known(unsigned f) {
    return f != NEVH__BESSEL_J0 && f != NEVH__BESSEL_J1 &&
           f != NEVH__ELLIPTIC_K && f != NEVH__ELLIPTIC_E;
}

/* Of y = f(a), where a.d is a change. */
static int change_of_one(sweep *s, unsigned f, dual a, int y) {
    switch (f) {
    case NEVH__NEGATE:
        return negative(s, a.d);
    case NEVH__SQUARE:
        return product(s, apply(s, NEVH__MULTIPLY, number(s, 2), a.y), a.d);
    case NEVH__CUBE:
        return product(
            s, apply(s, NEVH__MULTIPLY, number(s, 3), square(s, a.y)), a.d);
    case NEVH__SIN:
        return product(s, call(s, NEVH__COS, a.y), a.d);
    case NEVH__COS:
        return negative(s, product(s, call(s, NEVH__SIN, a.y), a.d));
    case NEVH__TAN:
        return product(s, one_and(s, NEVH__ADD, y), a.d);
    case NEVH__ASIN:
        return ratio(s, a.d, root(s, 1, -1, a.y));
    case NEVH__ACOS:
        return negative(s, ratio(s, a.d, root(s, 1, -1, a.y)));
    case NEVH__ATAN:
        return ratio(s, a.d, one_and(s, NEVH__ADD, a.y));
    case NEVH__SINH:
        return product(s, call(s, NEVH__COSH, a.y), a.d);
    case NEVH__COSH:
        return product(s, call(s, NEVH__SINH, a.y), a.d);
    case NEVH__TANH:
        return product(s, one_and(s, NEVH__SUBTRACT, y), a.d);
    case NEVH__ASINH:
        return ratio(s, a.d, root(s, 1, 1, a.y));
    case NEVH__ACOSH: /* a > 1 */
        return ratio(s, a.d, root(s, -1, 1, a.y));
    case NEVH__ATANH:
        return ratio(s, a.d, one_and(s, NEVH__SUBTRACT, a.y));
    case NEVH__EXP:
        return product(s, y, a.d);
    case NEVH__LOG:
        return ratio(s, a.d, a.y);
    case NEVH__LOG10:
        return ratio(s, ratio(s, a.d, a.y), call(s, NEVH__LOG, number(s, 10)));
    case NEVH__SQRT:
        return ratio(s, product(s, number(s, 0.5), a.d), y);
    case NEVH__CBRT:
        return ratio(s, ratio(s, a.d, number(s, 3)), square(s, y));
    case NEVH__ABS:
        return product(s, call(s, NEVH__SIGN, a.y), a.d);
    default: /* SIGN, FLOOR: level */
        return STILL;
    }
}

static dual value_of(sweep *s, nevh__tape_operand o) {
    size_t k = o.at, *count = (size_t *)s->tape->count;
    if (o.kind == NEVH__SLOT)
        return s->slots[k];
    if (o.kind == NEVH__NUMBER)
        return (dual){number(s, s->tape->numbers[k]), STILL};
    nevh__variable v = (nevh__variable)o.kind;
    int y = nevh__tape_variable(s->b, v, k);
    if (v != NEVH__Q && v != NEVH__P)
        return (dual){y, STILL};
    return (dual){y, nevh__tape_variable(s->b, v, count[v] + k)};
}

static void carry_out(sweep *s, const nevh__instruction *at) {
    dual a = value_of(s, at->a), b = value_of(s, at->b);
    if (at->operation == NEVH__SINCOS) {
        int sine = call(s, NEVH__SIN, a.y), cosine = call(s, NEVH__COS, a.y);
        s->slots[at->to] = (dual){sine, product(s, cosine, a.d)};
        s->slots[at->also] = (dual){cosine, negative(s, product(s, sine, a.d))};
        return;
    }
    nevh__tape_operation f = (nevh__tape_operation)at->operation;
    bool two = nevh__operation_arguments(f) == 2;
    dual y = {apply(s, f, a.y, b.y), STILL};
    if (two && (a.d != STILL || b.d != STILL))
        y.d = change_of_two(s, f, a, b, y.y);
    if (!two && a.d != STILL)
        y.d = change_of_one(s, f, a, y.y);
    s->slots[at->to] = y;
}

static bool is_possible(const nevh__tape *tape) {
    for (size_t i = 0; i < tape->length; i++)
        if (tape->code[i].operation != NEVH__SINCOS &&
            !is_known(tape->code[i].operation))
            return false;
    return true;
}

nevh__tape *nevh__tape_along(const nevh__tape *tape, int *status) {
    sweep s = {.tape = tape};
    *status = NEVH_ENOGRAD;
    if (!is_possible(tape))
        return NULL;
    s.b = nevh__tape_builder_new();
    s.slots = nevh__array(tape->slots, sizeof *s.slots);
    *status = NEVH_ENOMEM;
    if (!s.b || !s.slots) {
        nevh__tape_abandon(s.b);
        free(s.slots);
        return NULL;
    }
    /* So the new variables are counted, read or not. */
    for (nevh__variable v = NEVH__Q; v <= NEVH__P; v++)
        if (tape->count[v])
            nevh__tape_variable(s.b, v, 2 * tape->count[v] - 1);
    if (tape->count[NEVH__C])
        nevh__tape_variable(s.b, NEVH__C, tape->count[NEVH__C] - 1);
    for (size_t i = 0; i < tape->length; i++)
        carry_out(&s, &tape->code[i]);
    int d = value_of(&s, tape->result).d;
    nevh__tape *along =
        nevh__tape_finish(s.b, d == STILL ? number(&s, 0) : d, status);
    free(s.slots);
    return along;
}
