/* nevh: what is known of a tape, and a term made of it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include <string.h>

bool nevh__tape_reads(const nevh__tape *tape, nevh__variable v, size_t k) {
    return k < tape->count[v] && tape->read[v][k];
}

size_t nevh__tape_count(const nevh__tape *tape, nevh__variable v) {
    return tape->count[v];
}

size_t nevh__tape_length(const nevh__tape *tape) {
    return tape->length;
}

enum { NO_POLYNOMIAL = 64 };

static unsigned degree_of(const unsigned degree[], nevh__tape_operand o) {
    return o.kind == NEVH__SLOT                     ? degree[o.at]
           : o.kind == NEVH__Q || o.kind == NEVH__P ? 1
                                                    : 0;
}

static unsigned applied(unsigned operation, unsigned a, unsigned b) {
    switch (operation) {
    case NEVH__ADD:
    case NEVH__SUBTRACT:
        return a > b ? a : b;
    case NEVH__MULTIPLY:
        return a + b;
    case NEVH__DIVIDE:
        return b ? NO_POLYNOMIAL : a;
    case NEVH__NEGATE:
        return a;
    case NEVH__SQUARE:
        return 2 * a;
    case NEVH__CUBE:
        return 3 * a;
    default:
        return a || b ? NO_POLYNOMIAL : 0;
    }
}

/* True if no polynomial of degree 2 in q and p, as it is written. */
static bool is_curved(const nevh__tape *tape) {
    unsigned degree[NEVH__TAPE_LIVE] = {0};
    for (size_t i = 0; i < tape->length; i++) {
        const nevh__instruction *at = &tape->code[i];
        bool two = at->operation == NEVH__SINCOS ||
                   nevh__operation_of(at->operation)->arity == 2;
        unsigned a = degree_of(degree, at->a);
        unsigned b = two ? degree_of(degree, at->b) : 0;
        unsigned made = applied(at->operation, a, b);
        degree[at->to] = made < NO_POLYNOMIAL ? made : NO_POLYNOMIAL;
        if (at->operation == NEVH__SINCOS)
            degree[at->also] = degree[at->to];
    }
    return degree_of(degree, tape->result) > 2;
}

void nevh__tape_shape(nevh_term *term, const nevh__tape *tape) {
    term->value = nevh__tape_value;
    term->block = nevh__tape_block;
    term->gradient = nevh__tape_block_gradient;
    term->time_slope = nevh__tape_block_time;
    term->complex_value = tape->analytic ? nevh__tape_complex : NULL;
    term->params = tape;
    term->nq = tape->count[NEVH__Q];
    term->np = tape->count[NEVH__P];
    term->nc = tape->count[NEVH__C];
    term->time = nevh__tape_reads(tape, NEVH__T, 0);
    term->curved = is_curved(tape);
    term->actions = nevh__tape_actions;
}

static bool same_place(const nevh__tape *a, nevh__tape_operand x,
                       const nevh__tape *b, nevh__tape_operand y) {
    (void)a, (void)b;
    return x.kind == y.kind && x.at == y.at;
}

static bool same_operand(const nevh__tape *a, nevh__tape_operand x,
                         const nevh__tape *b, nevh__tape_operand y) {
    if (x.kind != y.kind)
        return false;
    return x.kind == NEVH__NUMBER ? memcmp(&a->numbers[x.at], &b->numbers[y.at],
                                           sizeof *a->numbers) == 0
                                  : x.at == y.at;
}

static bool tape_compare(const nevh__tape *a, const nevh__tape *b,
                         bool (*same)(const nevh__tape *, nevh__tape_operand,
                                      const nevh__tape *, nevh__tape_operand)) {
    if (a->length != b->length || !same(a, a->result, b, b->result))
        return false;
    for (size_t i = 0; i < a->length; i++) {
        const nevh__instruction *x = &a->code[i], *y = &b->code[i];
        if (x->operation != y->operation || x->to != y->to ||
            x->also != y->also || !same(a, x->a, b, y->a) ||
            !same(a, x->b, b, y->b))
            return false;
    }
    return true;
}

bool nevh__tape_same(const nevh__tape *a, const nevh__tape *b) {
    return tape_compare(a, b, same_operand);
}

bool nevh__tape_alike(const nevh__tape *a, const nevh__tape *b) {
    return a->n_numbers == b->n_numbers &&
           memcmp(a->count, b->count, sizeof a->count) == 0 &&
           tape_compare(a, b, same_place);
}
