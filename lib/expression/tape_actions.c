/* nevh: whether a formula is a function of actions, (s q^2 + p^2/s)/2.

   Sums of squares run along with the operations; an operation that is not linear
   takes them where those of q and p are in one proportion, s^2, everywhere.  What
   is no sum of squares as it is written, such as q^4 + 2 q^2 p^2 + p^4, is refused.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "expression/tape_operations_private.h"
#include <math.h>
#include <stdlib.h>

typedef enum {
    NUMBER,  /* `factor` */
    LINEAR,  /* `factor` times a variable */
    SQUARES, /* the sum of squares, and of functions of actions */
    ACTIONS, /* a function of actions */
    OTHER
} node_kind;

typedef struct {
    node_kind kind;
    double factor;
    size_t variable; /* a coordinate's index, or n and that of its momentum */
    double *square;  /* 2n; of SQUARES, else 0 */
} node;

typedef struct {
    size_t n;
    const size_t *of; /* the coordinate of each momentum */
    double *s;
} question;

/* Makes a node a function of actions; false: it is none. */
static bool take_actions(const question *x, node *u) {
    for (size_t k = 0; u->kind == SQUARES && k < x->n; k++) {
        double a = u->square[k], b = u->square[x->n + k], s = sqrt(a / b);
        if (a == 0 && b == 0)
            continue;
        if (x->s[k] == 0)
            x->s[k] = s;
        if (!(s > 0) || !isfinite(s) || !(fabs(s - x->s[k]) <= 1e-12 * x->s[k]))
            return false;
        u->square[k] = u->square[x->n + k] = 0;
    }
    u->kind = u->kind == SQUARES ? ACTIONS : u->kind;
    return u->kind == ACTIONS || u->kind == NUMBER;
}

static void add(const question *x, node u, node v, double sign, node *y) {
    y->kind = u.kind == LINEAR || v.kind == LINEAR ? OTHER : SQUARES;
    for (size_t i = 0; i < 2 * x->n; i++)
        y->square[i] = u.square[i] + sign * v.square[i];
}

static void scale(const question *x, node u, double by, node *y) {
    y->kind = u.kind;
    y->variable = u.variable;
    y->factor = by * u.factor;
    for (size_t i = 0; i < 2 * x->n; i++)
        y->square[i] = by * u.square[i];
}

/* u v, or hypot(u, v)^2, of variables. */
static void multiply(node u, node v, bool product, node *y) {
    y->kind = SQUARES;
    if (!product) {
        y->square[u.variable] += u.factor * u.factor;
        y->square[v.variable] += v.factor * v.factor;
    } else if (u.variable == v.variable)
        y->square[u.variable] = u.factor * v.factor;
    else
        y->kind = OTHER;
}

/* y: empty. */
static void apply(const question *x, unsigned operation, node u, node v,
                  node *y) {
    bool linear = u.kind == LINEAR && v.kind == LINEAR;
    bool numbers = u.kind == NUMBER && v.kind == NUMBER;
    bool times = operation == NEVH__MULTIPLY, over = operation == NEVH__DIVIDE;
    if (u.kind == OTHER || v.kind == OTHER) {
        y->kind = OTHER;
    } else if (numbers && operation != NEVH__SINCOS) {
        y->kind = NUMBER;
        y->factor = nevh__operation_value(operation, u.factor, v.factor);
    } else if (operation == NEVH__ADD || operation == NEVH__SUBTRACT) {
        add(x, u, v, operation == NEVH__ADD ? 1 : -1, y);
    } else if (operation == NEVH__NEGATE) {
        scale(x, u, -1, y);
    } else if ((times || over) && v.kind == NUMBER) {
        scale(x, u, times ? v.factor : 1 / v.factor, y);
    } else if (times && u.kind == NUMBER) {
        scale(x, v, u.factor, y);
    } else if (linear && (times || operation == NEVH__SQUARE)) {
        multiply(u, v, true, y);
    } else if (linear && operation == NEVH__HYPOT) {
        multiply(u, v, false, y);
        y->kind = take_actions(x, y) ? ACTIONS : OTHER;
    } else {
        bool both = take_actions(x, &u) && take_actions(x, &v);
        y->kind = both ? ACTIONS : OTHER;
    }
}

/* own: 2n zeros at first, which are those of all but SQUARES. */
static node operand_of(const question *x, const nevh__tape *tape,
                       nevh__tape_operand o, const double c[],
                       const node slots[], double none[]) {
    switch (o.kind) {
    case NEVH__SLOT:
        return slots[o.at];
    case NEVH__NUMBER:
        return (node){NUMBER, tape->numbers[o.at], 0, none};
    case NEVH__C:
        return (node){NUMBER, c[o.at], 0, none};
    case NEVH__Q:
        return (node){LINEAR, 1, o.at, none};
    case NEVH__P:
        return (node){LINEAR, 1, x->n + x->of[o.at], none};
    default:
        return (node){OTHER, 0, 0, none};
    }
}

static void step(const question *x, const nevh__tape *tape,
                 const nevh__instruction *at, const double c[], node slots[],
                 double room[]) {
    size_t size = 2 * x->n;
    double *none = room, *made = none + size;
    bool two = at->operation != NEVH__SINCOS &&
               nevh__operation_of(at->operation)->arity == 2;
    node u = operand_of(x, tape, at->a, c, slots, none);
    node v = two ? operand_of(x, tape, at->b, c, slots, none) : u;
    node y = {NUMBER, 0, 0, made};
    for (size_t i = 0; i < size; i++)
        made[i] = 0;
    apply(x, at->operation, u, v, &y);
    y.square = made + (1 + at->to) * size;
    for (size_t i = 0; i < size; i++)
        y.square[i] = y.kind == SQUARES ? made[i] : 0;
    slots[at->to] = y;
    if (at->operation == NEVH__SINCOS) {
        slots[at->also] = y;
        slots[at->also].square = none;
    }
}

bool nevh__tape_actions(const double c[], const void *tape, const size_t of[],
                        double s[]) {
    const nevh__tape *t = tape;
    question x = {t->count[NEVH__Q], of, s};
    size_t size = 2 * x.n;
    node *slots = nevh__array(t->slots + 1, sizeof *slots);
    double *room = nevh__array((t->slots + 2) * size + 1, sizeof *room);
    bool actions = slots && room && x.n == t->count[NEVH__P];
    for (size_t k = 0; k < x.n; k++)
        s[k] = 0;
    for (size_t i = 0; actions && i < t->length; i++)
        step(&x, t, &t->code[i], c, slots, room);
    if (actions) {
        node result = operand_of(&x, t, t->result, c, slots, room);
        actions = take_actions(&x, &result);
    }
    free(slots);
    free(room);
    return actions;
}
