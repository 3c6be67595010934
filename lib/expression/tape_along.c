/* nevh: the derivative of a tape along a displacement, as a tape.

   One forward sweep over the operations of h(q, p) builds, beside each result,
   its change along (dq, dp).  So the gradient of the new tape, by the reverse
   sweep that all tapes have, holds the product of the Hessian of h with (dq, dp)
   beside the gradient of h: forward over reverse.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static int tape_along_apply(sweep *s, nevh__tape_operation f, int a, int b) {
    return nevh__tape_apply(s->b, f, a, b);
}

static int tape_along_number(sweep *s, double x) {
    return nevh__tape_number(s->b, x);
}

/* Sums and products of which one may be no change. */
static int sum(sweep *s, int a, int b) {
    if (a == STILL || b == STILL)
        return a == STILL ? b : a;
    return tape_along_apply(s, NEVH__ADD, a, b);
}

static int tape_along_call(sweep *s, nevh__tape_operation f, int a) {
    return tape_along_apply(s, f, a, a);
}

static int build_number(void *data, double x) {
    return tape_along_number(data, x);
}

static int build_operation(void *data, nevh__tape_operation f, int a, int b) {
    return tape_along_apply(data, f, a, b);
}

static int tape_along_build(sweep *s, const char *formula, const int of[3]) {
    const nevh__algebra nodes = {s, build_number, build_operation};
    return nevh__operation_build(formula, of, &nodes);
}

/* A change times the numerator of the derivative by it; the sign comes last, so that
   sums are differences where they can be. */
static int tape_along_product(sweep *s, const char *top, int d,
                              const int of[3]) {
    static const char neg[] = " neg";
    char positive[64] = "";
    if (d == STILL)
        return STILL;
    size_t length = strlen(top), less = length - (sizeof neg - 1);
    if (length < sizeof neg || strcmp(top + less, neg) != 0)
        return tape_along_apply(s, NEVH__MULTIPLY, tape_along_build(s, top, of),
                                d);
    snprintf(positive, sizeof positive, "%.*s", (int)less, top);
    d = tape_along_product(s, positive, d, of);
    return tape_along_apply(s, NEVH__NEGATE, d, d);
}

/* The derivative of y = f(a, b), or of f(a), where b has none.  Derivatives by two
   arguments have one denominator. */
static int tape_along_change(sweep *s, const nevh__operation_traits *f, dual a,
                             dual b, int y) {
    int of[3] = {a.y, b.y, y};
    bool still = a.d == STILL && b.d == STILL;
    if (still || strcmp(f->by_a.top, "0") == 0)
        return STILL;
    int bottom =
        f->by_a.bottom ? tape_along_build(s, f->by_a.bottom, of) : STILL;
    int from_b = tape_along_product(s, f->by_b.top, b.d, of);
    int d = sum(s, tape_along_product(s, f->by_a.top, a.d, of), from_b);
    return bottom == STILL ? d : tape_along_apply(s, NEVH__DIVIDE, d, bottom);
}

static dual tape_along_value_of(sweep *s, nevh__tape_operand o) {
    size_t k = o.at, *count = (size_t *)s->tape->count;
    if (o.kind == NEVH__SLOT)
        return s->slots[k];
    if (o.kind == NEVH__NUMBER)
        return (dual){tape_along_number(s, s->tape->numbers[k]), STILL};
    nevh__variable v = (nevh__variable)o.kind;
    int y = nevh__tape_variable(s->b, v, k);
    if (v != NEVH__Q && v != NEVH__P)
        return (dual){y, STILL};
    return (dual){y, nevh__tape_variable(s->b, v, count[v] + k)};
}

static void carry_out(sweep *s, const nevh__instruction *at) {
    static const dual still = {0, STILL};
    dual a = tape_along_value_of(s, at->a), b = tape_along_value_of(s, at->b);
    if (at->operation == NEVH__SINCOS) {
        int sine = tape_along_call(s, NEVH__SIN, a.y),
            cosine = tape_along_call(s, NEVH__COS, a.y);
        s->slots[at->to] =
            (dual){sine, tape_along_change(s, nevh__operation_of(NEVH__SIN), a,
                                           still, sine)};
        s->slots[at->also] =
            (dual){cosine, tape_along_change(s, nevh__operation_of(NEVH__COS),
                                             a, still, cosine)};
        return;
    }
    nevh__tape_operation f = (nevh__tape_operation)at->operation;
    const nevh__operation_traits *operation = nevh__operation_of(f);
    int y = tape_along_apply(s, f, a.y, b.y);
    s->slots[at->to] =
        (dual){y, tape_along_change(s, operation, a,
                                    operation->arity == 2 ? b : still, y)};
}

static bool is_possible(const nevh__tape *tape) {
    for (size_t i = 0; i < tape->length; i++)
        if (tape->code[i].operation != NEVH__SINCOS &&
            !nevh__operation_of(tape->code[i].operation)->by_a.top)
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
    int d = tape_along_value_of(&s, tape->result).d;
    nevh__tape *along = nevh__tape_finish(
        s.b, d == STILL ? tape_along_number(&s, 0) : d, status);
    free(s.slots);
    return along;
}
