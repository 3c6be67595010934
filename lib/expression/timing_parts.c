/* nevh: the parts of terms that read t, and what they can be over a stretch of
   time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/timing_parts_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NODES = 4096, SAMPLES = 8 };
typedef nevh__time_parts parts;
typedef nevh__time_part part;

static part *part_of(parts *m, size_t node) {
    if (node >= m->capacity) {
        size_t capacity = 2 * node + 64;
        part *grown = nevh__grow(m->part, capacity, sizeof *grown);
        if (!grown) {
            m->failed = true;
            return NULL;
        }
        memset(grown + m->capacity, 0,
               (capacity - m->capacity) * sizeof *grown);
        m->part = grown;
        m->capacity = capacity;
    }
    return &m->part[node];
}

/* A node, and what its value changes by. */
typedef struct {
    int node;
    unsigned by;
} slot;

static slot timing_parts_number(parts *m, double x, unsigned by) {
    return (slot){nevh__tape_number(m->graph, x), by};
}

/* A coordinate or momentum: a number where the state stays. */
static slot timing_parts_variable(parts *m, nevh__variable v, size_t k) {
    unsigned by = v == NEVH__Q ? NEVH__BY_Q : NEVH__BY_P;
    if (m->to)
        return (slot){nevh__tape_variable(m->graph, v, k), by};
    return timing_parts_number(m, v == NEVH__Q ? m->q[k] : m->p[k], by);
}

static slot operand_of(parts *m, const nevh_term *term, size_t instance,
                       const slot slots[], nevh__tape_operand o) {
    const nevh__tape *tape = term->params;
    switch (o.kind) {
    case NEVH__T:
        return (slot){nevh__tape_variable(m->graph, NEVH__T, 0), NEVH__BY_T};
    case NEVH__Q:
        return timing_parts_variable(m, NEVH__Q,
                                     term->q[instance * term->nq + o.at]);
    case NEVH__P:
        return timing_parts_variable(m, NEVH__P,
                                     term->p[instance * term->np + o.at]);
    case NEVH__C:
        return timing_parts_number(m, term->c[instance * term->nc + o.at], 0);
    case NEVH__NUMBER:
        return timing_parts_number(m, tape->numbers[o.at], 0);
    default:
        return slots[o.at];
    }
}

static void timing_parts_mark(parts *m, slot x, size_t effect, bool outer) {
    bool moves = m->to || x.by & NEVH__BY_T;
    part *s = x.node >= 0 && moves ? part_of(m, (size_t)x.node) : NULL;
    if (!s)
        return;
    s->effect = effect;
    s->pure |= x.by == NEVH__BY_T;
    s->outer |= outer && x.by == NEVH__BY_T;
}

static bool is_pure(const parts *m, int node) {
    return (size_t)node < m->capacity && m->part[node].pure;
}

/* The summands that read t alone, of a sum; -1: there are none. */
static int pure_part(parts *m, int node) {
    const nevh__tape_node n = m->graph->nodes[node];
    if (is_pure(m, node))
        return node;
    if (n.kind != NEVH__SLOT ||
        (n.operation != NEVH__ADD && n.operation != NEVH__SUBTRACT &&
         n.operation != NEVH__NEGATE))
        return -1;
    int a = pure_part(m, n.a), b = pure_part(m, n.b);
    bool minus = n.operation != NEVH__ADD;
    if (n.operation == NEVH__NEGATE)
        a = -1;
    if (b >= 0 && minus)
        b = nevh__tape_apply(m->graph, NEVH__NEGATE, b, b);
    if (a < 0 || b < 0)
        return a < 0 ? b : a;
    return nevh__tape_apply(m->graph, NEVH__ADD, a, b);
}

/* Marks a part that is as narrow as an operation which also reads q or p: exp(f(t)
   + g(q)) as exp(f(t)), g(q)/f(t) as 1/f(t). */
static void mark_like(parts *m, nevh__tape_operation f, slot a, slot b,
                      size_t effect) {
    int x = -1;
    if (f == NEVH__DIVIDE && b.by == NEVH__BY_T)
        x = nevh__tape_apply(m->graph, f, nevh__tape_number(m->graph, 1),
                             b.node);
    else if (nevh__operation_arguments(f) == 1 && f != NEVH__NEGATE) {
        int pure = pure_part(m, a.node);
        x = pure < 0 ? -1 : nevh__tape_apply(m->graph, f, pure, pure);
    }
    timing_parts_mark(m, (slot){x, NEVH__BY_T}, effect, f == NEVH__DIVIDE);
}

static slot timing_parts_apply(parts *m, unsigned operation, slot a, slot b,
                               size_t effect) {
    nevh__tape_operation f = (nevh__tape_operation)operation;
    slot y = {nevh__tape_apply(m->graph, f, a.node, b.node), a.by | b.by};
    bool mixed = y.by & ~(unsigned)NEVH__BY_T;
    timing_parts_mark(m, y, effect, false);
    timing_parts_mark(m, a, effect, mixed);
    timing_parts_mark(m, b, effect, mixed);
    if (mixed && !m->to && y.by & NEVH__BY_T && y.node >= 0)
        mark_like(m, f, a, b, effect);
    if ((f == NEVH__SIN || f == NEVH__COS) && a.by & NEVH__BY_T && a.node >= 0)
        m->part[a.node].turned = true;
    return y;
}

static void read_instance(parts *m, const nevh__term_entry *entry,
                          size_t instance, slot slots[]) {
    const nevh_term *term = &entry->decl;
    const nevh__tape *tape = term->params;
    for (size_t i = 0; i < tape->length && !m->failed; i++) {
        const nevh__instruction *c = &tape->code[i];
        bool both = c->operation == NEVH__SINCOS;
        slot a = operand_of(m, term, instance, slots, c->a);
        slot b = operand_of(m, term, instance, slots, c->b);
        slots[c->to] = timing_parts_apply(m, both ? NEVH__SIN : c->operation, a,
                                          b, entry->effect);
        if (both)
            slots[c->also] =
                timing_parts_apply(m, NEVH__COS, a, b, entry->effect);
        m->failed |= m->graph->failed;
    }
    timing_parts_mark(m, operand_of(m, term, instance, slots, tape->result),
                      entry->effect, true);
}

static void read_formula(parts *m, const nevh__term_entry *entry) {
    const nevh__tape *tape = entry->decl.params;
    slot *slots = nevh__array(tape->slots, sizeof *slots);
    m->failed |= !slots;
    for (size_t i = 0; !m->failed && i < entry->decl.count; i++) {
        m->whole &= m->graph->used <= MOST_NODES;
        if (!m->whole)
            break;
        read_instance(m, entry, i, slots);
    }
    free(slots);
}

static void read_function(parts *m, const nevh__term_entry *entry) {
    m->whole = false;
    for (size_t i = 0;
         i < entry->decl.count && m->n_sampled < NEVH__MOST_SAMPLED; i++)
        m->sampled[m->n_sampled++] =
            (struct nevh__time_sampled){&entry->decl, i, entry->effect};
}

static void init(parts *m) {
    const nevh_system *s = m->system;
    size_t most = 0;
    m->whole = true;
    m->graph = nevh__tape_builder_new();
    m->failed = !m->graph;
    for (size_t i = 0; i < s->n_terms && !m->failed; i++) {
        const nevh__term_entry *entry = s->terms[i];
        size_t read = entry->decl.nq + entry->decl.np;
        if (!nevh__term_on(s, entry) || !(entry->decl.time || m->to))
            continue;
        if (entry->decl.value == nevh__tape_value)
            read_formula(m, entry);
        else if (!m->to)
            read_function(m, entry);
        most = read > most ? read : most;
    }
    m->nodes = m->failed ? 0 : (size_t)m->graph->used;
    m->count = m->nodes + m->n_sampled;
    m->range = nevh__array(m->count, sizeof *m->range);
    m->gathered = nevh__array(most, sizeof *m->gathered);
    m->failed |= !m->range || !m->gathered || !part_of(m, m->count);
    for (size_t i = 0; i < m->n_sampled && !m->failed; i++)
        m->part[m->nodes + i] = (part){true, true, false, m->sampled[i].effect};
}

void nevh__time_parts_init(parts *m, const nevh_system *s, const double q[],
                           const double p[]) {
    *m = (parts){.system = s, .q = q, .p = p};
    init(m);
}

void nevh__time_parts_init_between(parts *m, const nevh_system *s,
                                   const double from[], const double to[]) {
    *m = (parts){.system = s, .from = from, .to = to};
    init(m);
}

void nevh__time_parts_clear(parts *m) {
    nevh__tape_abandon(m->graph);
    free(m->part);
    free(m->range);
    free(m->gathered);
    memset(m, 0, sizeof *m);
}

/* A variable at one of some states around that of the parts, which is the first. */
static double beside_state(double x, size_t k, int state) {
    static const double golden = 0.6180339887498949;
    double turn = (double)(k + 1) * state * golden;
    double by = ldexp(turn - floor(turn) - 0.5, state);
    return x + (state ? by * (1 + fabs(x)) : 0);
}

static double timing_parts_sample(const parts *m,
                                  const struct nevh__time_sampled *s, double t,
                                  int state) {
    const nevh_term *term = s->term;
    double *q = m->gathered, *p = q + term->nq;
    for (size_t k = 0; k < term->nq; k++)
        q[k] =
            beside_state(m->q[term->q[s->instance * term->nq + k]], k, state);
    for (size_t k = 0; k < term->np; k++)
        p[k] = beside_state(m->p[term->p[s->instance * term->np + k]],
                            term->nq + k, state);
    const double *c = term->nc ? term->c + s->instance * term->nc : NULL;
    return term->value(t, q, p, c, term->params);
}

/* The range of values at irregular times, which may miss others. */
static nevh__range sampled_range(const parts *m,
                                 const struct nevh__time_sampled *s, double low,
                                 double high) {
    static const double golden = 0.6180339887498949;
    nevh__range r = {INFINITY, -INFINITY, 0, 0, 0};
    double before = NAN, last = NAN;
    for (int i = 0; i <= SAMPLES; i++) {
        double off =
            i == 0 || i == SAMPLES
                ? 0
                : 0.8 * (i * golden + low - floor(i * golden + low) - 0.5);
        double t = low + (high - low) * (i + off) / SAMPLES;
        double h = timing_parts_sample(m, s, t, 0),
               by = (h - last) / (t - before);
        r.low = fmin(r.low, h);
        r.high = fmax(r.high, h);
        if (t > before && isfinite(by)) {
            r.down = fmin(r.down, by);
            r.up = fmax(r.up, by);
        }
        before = t, last = h;
    }
    return r;
}

/* Between two states, of a variable: t, q and p. */
static nevh__range line_range(const parts *m, const nevh__tape_node *n,
                              double low, double high) {
    size_t dof = m->system->n;
    size_t k = n->kind == NEVH__T   ? 2 * dof
               : n->kind == NEVH__Q ? (size_t)n->bits
                                    : dof + (size_t)n->bits;
    double by = m->to[k] - m->from[k];
    double a = m->from[k] + low * by, b = m->from[k] + high * by;
    return (nevh__range){fmin(a, b), fmax(a, b), by, by, 0};
}

static nevh__range node_range(const parts *m, const nevh__tape_node *n,
                              double low, double high) {
    double x;
    switch (n->kind) {
    case NEVH__SLOT:
        return nevh__range_apply((nevh__tape_operation)n->operation,
                                 m->range[n->a], m->range[n->b]);
    case NEVH__NUMBER:
        x = nevh__tape_node_number(n);
        return (nevh__range){x, x, 0, 0, 0};
    default:
        return m->to ? line_range(m, n, low, high)
                     : (nevh__range){low, high, 1, 1, 0};
    }
}

void nevh__time_parts_over(parts *m, double low, double high) {
    for (size_t i = 0; i < m->nodes; i++)
        m->range[i] = node_range(m, &m->graph->nodes[i], low, high);
    for (size_t i = 0; i < m->n_sampled; i++)
        m->range[m->nodes + i] = sampled_range(m, &m->sampled[i], low, high);
}

/* 1 if values differ by more than those of equal times beside do, 0 if not, -1 if one is
   not finite. */
static int sample_jumps(const parts *m, const struct nevh__time_sampled *s,
                        double before, double after, int state) {
    static const double beside = 16, rounding = 64 * DBL_EPSILON;
    double gap = after - before, h[4];
    for (int i = 0; i < 4; i++)
        h[i] = timing_parts_sample(m, s, before + (i - 1) * gap, state);
    double by = fabs(h[2] - h[1]);
    double most = beside * fmax(fabs(h[1] - h[0]), fabs(h[3] - h[2])) +
                  rounding * (fabs(h[1]) + fabs(h[2]));
    return isfinite(by + most) ? by > most : -1;
}

/* The same of an instance: 1 where it jumps at some state, 0 at none, -1 not finite. */
static int instance_jumps(const parts *m, const struct nevh__time_sampled *s,
                          double before, double after) {
    enum { STATES = 8 };
    int found = -1;
    for (int state = 0; state < STATES && found < 1; state++) {
        int jumps = sample_jumps(m, s, before, after, state);
        found = jumps > found ? jumps : found;
    }
    return found;
}

bool nevh__time_parts_jump(parts *m, size_t effect, double before,
                           double after) {
    enum { MOST_TRIED = 100000 }; /* instances, at all times */
    int found = -1;
    for (size_t i = 0; i < m->system->n_terms; i++) {
        const nevh__term_entry *entry = m->system->terms[i];
        struct nevh__time_sampled s = {.term = &entry->decl};
        bool reads = nevh__term_on(m->system, entry) &&
                     entry->effect == effect && entry->decl.time;
        for (; reads && s.instance < entry->decl.count; s.instance++) {
            int jumps = m->tried++ < MOST_TRIED
                            ? instance_jumps(m, &s, before, after)
                            : 1;
            if (jumps == 1)
                return true;
            found = jumps > found ? jumps : found;
        }
    }
    return found < 0;
}
