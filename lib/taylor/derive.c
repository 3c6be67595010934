/* nevh: the graph of dH/dq and dH/dp, from the tapes of the terms that are on.

   Each instance of a term is written out, what instances have in common is one
   node, and one sweep from the values back to the variables gives the gradient.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_inside_private.h"
#include "taylor/graph_private.h"
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    nevh__graph *g;
    int tagged;
    bool broken; /* kinks in t are allowed */
    nevh__report *report;
    size_t n;
    int *roots; /* of the instances */
    size_t n_roots, capacity;
} reader;

static int derive_refuse(const reader *r, const nevh_term *term,
                         const char *what) {
    return nevh__fail(r->report, NEVH_ESTRUCT,
                      "term \"%s\" of effect \"%s\" has no Taylor series: %s",
                      term->name, term->effect, what);
}

static int derive_out_of_memory(const reader *r) {
    return r->g->overflowed
               ? nevh__fail(r->report, NEVH_ESTRUCT,
                            "H has more than %d operations with its "
                            "derivatives: too many for a Taylor series",
                            NEVH__GRAPH_NODES)
               : nevh__no_memory(r->report);
}

/* NULL: its series is known, up to its edge if it has one. */
static const char *why_not(const nevh__instruction *c) {
    return nevh__operation_is_special(c->operation)
               ? "is one whose recurrence is not known here"
               : NULL;
}

static int refuse_operation(const reader *r, const nevh_term *term,
                            const nevh__instruction *c) {
    char text[200];
    snprintf(text, sizeof text, "its function %s(...) %s",
             nevh__operation_name((nevh__tape_operation)c->operation),
             why_not(c));
    return derive_refuse(r, term, text);
}

/* Tags the nodes made since the last call. */
static void tag(reader *r, int what, bool backwards) {
    for (; r->tagged < r->g->used; r->tagged++) {
        r->g->nodes[r->tagged].tag = what;
        r->g->nodes[r->tagged].rank = backwards ? -r->tagged : r->tagged;
    }
}

/* The node of an operand of an instance. */
static int derive_operand(const reader *r, const nevh_term *term,
                          size_t instance, const int slots[],
                          nevh__tape_operand o) {
    const nevh__tape *tape = term->params;
    switch (o.kind) {
    case NEVH__T:
        return nevh__graph_variable(r->g, 2 * r->n);
    case NEVH__Q:
        return nevh__graph_variable(r->g, term->q[instance * term->nq + o.at]);
    case NEVH__P:
        return nevh__graph_variable(r->g,
                                    r->n + term->p[instance * term->np + o.at]);
    case NEVH__C:
        return nevh__graph_number(r->g, term->c[instance * term->nc + o.at]);
    case NEVH__NUMBER:
        return nevh__graph_number(r->g, tape->numbers[o.at]);
    default:
        return slots[o.at];
    }
}

/* sin and cos of one argument are two operations. */
static int derive_operate(nevh__graph *g, unsigned operation, int a, int b) {
    return nevh__graph_apply(
        g,
        operation == NEVH__SINCOS ? NEVH__SIN : (nevh__tape_operation)operation,
        a, b);
}

/* True if the operation has a kink after which series can begin again. */
static bool is_between_breaks(const reader *r, const nevh__instruction *c) {
    return r->broken && !nevh__operation_is_smooth(c->operation) &&
           (c->a.by | c->b.by) == NEVH__BY_T;
}

static int read_instance(reader *r, const nevh_term *term, size_t instance,
                         int slots[]) {
    const nevh__tape *tape = term->params;
    for (size_t i = 0; i < tape->length; i++) {
        const nevh__instruction *c = &tape->code[i];
        int a = derive_operand(r, term, instance, slots, c->a);
        int b = derive_operand(r, term, instance, slots, c->b);
        bool between = is_between_breaks(r, c);
        if (why_not(c) && !between &&
            !(nevh__graph_is_number(r->g, a, NULL) &&
              nevh__graph_is_number(r->g, b, NULL)))
            return refuse_operation(r, term, c);
        if (!between)
            nevh__graph_watch(r->g, c->operation, a, b, term->effect);
        slots[c->to] = derive_operate(r->g, c->operation, a, b);
        if (c->operation == NEVH__SINCOS)
            slots[c->also] = derive_operate(r->g, NEVH__COS, a, a);
        tag(r, (int)i, false);
    }
    int root = derive_operand(r, term, instance, slots, tape->result);
    if (r->g->failed)
        return derive_out_of_memory(r);
    if (r->n_roots == r->capacity) {
        size_t capacity = 2 * r->capacity + 16;
        int *roots = nevh__grow(r->roots, capacity, sizeof *roots);
        if (!roots)
            return derive_out_of_memory(r);
        r->roots = roots;
        r->capacity = capacity;
    }
    r->roots[r->n_roots++] = root;
    return NEVH_OK;
}

static int read_term(reader *r, const nevh__term_entry *entry) {
    const nevh_term *term = &entry->decl;
    if (term->value != nevh__tape_value)
        return derive_refuse(
            r, term, "it is a function in C, and a series needs a formula");
    const nevh__tape *tape = term->params;
    int *slots = nevh__array(tape->slots, sizeof *slots), status = NEVH_OK;
    if (!slots)
        return derive_out_of_memory(r);
    for (size_t i = 0; !status && i < term->count; i++)
        status = read_instance(r, term, i, slots);
    free(slots);
    return status;
}

/* Watches poles without an effect's name, since poles of several effects may meet. */
static int watch_poles(reader *r) {
    nevh__graph_watch_poles(r->g, NULL);
    tag(r, 0, false);
    return r->g->failed ? derive_out_of_memory(r) : NEVH_OK;
}

static void add_to(nevh__graph *g, int *sum, int what) {
    *sum = *sum < 0 ? what : nevh__graph_add(g, *sum, what);
}

/* The part of node i, whose own derivative is known, in those of its
   operands. */
static void hand_back(nevh__graph *g, int i, int of[]) {
    const nevh__graph_node x = g->nodes[i];
    int mine = of[i];
    switch (x.kind) {
    case NEVH__GRAPH_ADD:
        add_to(g, &of[x.a], mine);
        add_to(g, &of[x.b], mine);
        break;
    case NEVH__GRAPH_SCALE:
        add_to(g, &of[x.a], nevh__graph_scale(g, x.number, mine));
        break;
    case NEVH__GRAPH_MULTIPLY:
        add_to(g, &of[x.a], nevh__graph_multiply(g, mine, x.b));
        add_to(g, &of[x.b], nevh__graph_multiply(g, mine, x.a));
        break;
    case NEVH__GRAPH_INVERT:
        mine = nevh__graph_multiply(g, nevh__graph_multiply(g, mine, i), i);
        add_to(g, &of[x.a], nevh__graph_scale(g, -1, mine));
        break;
    case NEVH__GRAPH_POWER:
        mine = nevh__graph_multiply(g, mine,
                                    nevh__graph_power(g, x.a, x.number - 1));
        add_to(g, &of[x.a], nevh__graph_scale(g, x.number, mine));
        break;
    case NEVH__GRAPH_CALL:
        add_to(g, &of[x.a], nevh__graph_multiply(g, mine, x.slope));
        break;
    default:
        break;
    }
}

/* dp/dt = -dH/dq and dq/dt = dH/dp, where node i is a variable of the state. */
static void set_slope(reader *r, int i, int derivative, int slope[]) {
    size_t n = r->n, k = r->g->nodes[i].at;
    if (r->g->nodes[i].kind != NEVH__GRAPH_VARIABLE)
        return;
    if (k < n)
        slope[n + k] = nevh__graph_scale(r->g, -1, derivative);
    else if (k < 2 * n)
        slope[k - n] = derivative;
}

static int derive_sweep(reader *r, const nevh__wide friction[], int slope[]) {
    nevh__graph *g = r->g;
    size_t n = r->n;
    int used = g->used, zero = nevh__graph_number(g, 0);
    int one = nevh__graph_number(g, 1);
    int *of = nevh__array((size_t)used, sizeof *of);
    if (!of)
        return derive_out_of_memory(r);
    for (int i = 0; i < used; i++)
        of[i] = -1;
    for (size_t i = 0; i < r->n_roots && !g->failed; i++)
        add_to(g, &of[r->roots[i]], one);
    for (size_t k = 0; k < 2 * n; k++)
        slope[k] = zero;
    for (int i = used - 1; i >= 0 && !g->failed; i--) {
        if (of[i] < 0)
            continue;
        hand_back(g, i, of);
        tag(r, -1 - g->nodes[i].tag, true);
        set_slope(r, i, of[i], slope);
    }
    for (size_t k = 0; friction && k < n; k++)
        slope[n + k] = nevh__graph_add(
            g, slope[n + k],
            nevh__graph_scale(g, -friction[k], nevh__graph_variable(g, n + k)));
    free(of);
    return g->failed ? derive_out_of_memory(r) : NEVH_OK;
}

int nevh__graph_of_system(nevh__graph *g, const nevh_system *system,
                          const nevh__wide friction[], bool broken, int slope[],
                          nevh__report *report) {
    reader r = {.g = g, .broken = broken, .report = report, .n = system->n};
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < system->n_terms; i++)
        if (nevh__term_on(system, system->terms[i]))
            status = read_term(&r, system->terms[i]);
    if (!status)
        nevh__graph_join_cuts(g, r.roots, r.n_roots);
    if (!status)
        status = watch_poles(&r);
    if (!status)
        status = derive_sweep(&r, friction, slope);
    free(r.roots);
    return status;
}
