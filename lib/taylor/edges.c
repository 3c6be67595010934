/* nevh: where the functions of a graph stop being analytic.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/graph_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Within the rounding of a few operations. */
static bool is_same(nevh__wide x, nevh__wide y) {
    nevh__wide apart = x < y ? y - x : x - y;
    return apart <= NEVH__WIDE_ROUNDING * (x < 0 ? -x : x);
}

static bool is_whole(const nevh__graph *g, int node) {
    nevh__wide x;
    return nevh__graph_is_number(g, node, &x) && (double)x == x &&
           rint((double)x) == (double)x;
}

/* True if the node has a steep function of this kind already: an exponential or
   hyperbolic function, or a power; the steepest power counts. */
static bool has_steep(nevh__graph *g, const nevh__graph_edge *e) {
    enum { GROWS = 4, SATURATES = 8, POWER = 16 };
    uint8_t *watched = &g->nodes[e->node].watched;
    uint8_t mine = e->function == NEVH__TANH    ? SATURATES
                   : e->function == NEVH__POWER ? POWER
                                                : GROWS;
    bool had = *watched & mine;
    for (size_t i = 0; had && mine == POWER && i < g->n_edges; i++) {
        nevh__graph_edge *other = &g->edges[i];
        if (other->node == e->node && other->steep &&
            fabs(other->exponent) < fabs(e->exponent))
            other->exponent = e->exponent;
    }
    *watched |= mine;
    return had;
}

/* True if a node was watched before; it is from now on. */
static bool edges_has(nevh__graph *g, const nevh__graph_edge *e) {
    enum { STRICT = 1, LOOSE = 2 };
    uint8_t *watched = &g->nodes[e->node].watched;
    if (e->steep)
        return has_steep(g, e);
    bool jumps = e->also >= 0 || e->whole >= 0; /* may be forgotten later */
    for (size_t i = 0; jumps && i < g->n_edges; i++)
        if (g->edges[i].node == e->node && g->edges[i].also == e->also &&
            g->edges[i].whole == e->whole)
            return true;
    if (jumps)
        return false;
    bool had = *watched & (e->strict ? STRICT : STRICT | LOOSE);
    *watched |= e->strict ? STRICT : LOOSE;
    return had;
}

static void edges_add(nevh__graph *g, nevh__graph_edge e) {
    if (e.node < 0 || g->failed || nevh__graph_is_number(g, e.node, NULL))
        return;
    if (edges_has(g, &e))
        return;
    if (g->n_edges == g->edge_capacity) {
        size_t capacity = 2 * g->edge_capacity + 16;
        nevh__graph_edge *edges = nevh__grow(g->edges, capacity, sizeof *edges);
        g->failed = g->failed || !edges;
        if (!edges)
            return;
        g->edges = edges;
        g->edge_capacity = capacity;
    }
    g->edges[g->n_edges++] = e;
}

/* The power that an operation is of one base, if it is: 0, else. */
static double power_of(const nevh__graph *g, unsigned operation, int a, int b,
                       int *base) {
    const nevh__graph_node *x = &g->nodes[a], *y = &g->nodes[b];
    nevh__wide exponent;
    *base = x->base;
    switch (operation) {
    case NEVH__MULTIPLY:
        return x->base == y->base ? x->power + y->power : 0;
    case NEVH__SQUARE:
        return 2 * x->power;
    case NEVH__CUBE:
        return 3 * x->power;
    case NEVH__POWER:
        return nevh__graph_is_number(g, b, &exponent)
                   ? (double)exponent * x->power
                   : 0;
    default:
        return 0;
    }
}

/* Watches a power of higher order than a series may resolve. */
static void watch_power(nevh__graph *g, unsigned operation, int a, int b,
                        const char *effect) {
    static const double least = 12, least_pole = 4;
    int base;
    double power = power_of(g, operation, a, b, &base);
    double order = power * fmax(g->nodes[base].degree, 1);
    if (order > least || order < -least_pole)
        edges_add(g, (nevh__graph_edge){.node = base,
                                        .also = -1,
                                        .whole = -1,
                                        .steep = true,
                                        .function = NEVH__POWER,
                                        .exponent = power,
                                        .effect = effect});
}

/* Watches a function that grows faster than any polynomial. */
static void watch_steep(nevh__graph *g, unsigned operation, int a, int b,
                        const char *effect) {
    nevh__graph_edge e = {.node = a,
                          .also = -1,
                          .whole = -1,
                          .steep = true,
                          .function = (uint8_t)operation,
                          .effect = effect};
    if (a < 0 || b < 0)
        return;
    if (operation == NEVH__POWER && !nevh__graph_is_number(g, b, NULL)) {
        e.function = NEVH__EXP;
        e.node = nevh__graph_build(g, "b a log *", a, b);
    } else if (!nevh__operation_of(operation)->steep)
        return;
    edges_add(g, e);
}

void nevh__graph_watch(nevh__graph *g, unsigned operation, int a, int b,
                       const char *effect) {
    nevh__graph_edge e = {.node = -1,
                          .also = -1,
                          .whole = -1,
                          .strict = true,
                          .function = (uint8_t)operation,
                          .effect = effect};
    watch_steep(g, operation, a, b, effect);
    if (a >= 0 && b >= 0)
        watch_power(g, operation, a, b, effect);
    const nevh__operation_traits *f = nevh__operation_of(operation);
    if (operation == NEVH__CBRT && nevh__graph_cube_root(g, a) >= 0)
        return;
    if (operation == NEVH__FLOOR)
        e.whole = a;
    if (operation == NEVH__MOD)
        e.whole = nevh__graph_build(g, "a b /", a, b);
    if (f->edge) {
        e.strict = !f->touches;
        e.node = nevh__graph_build(g, f->edge, a, b);
    } else if (operation == NEVH__POWER) {
        e.strict = !nevh__graph_is_number(g, b, NULL);
        e.node = is_whole(g, b) ? -1 : a;
    } else if (operation == NEVH__ATAN2) {
        e.node = a;
        e.also = b;
    }
    edges_add(g, e);
}

/* True if a function of a period, a multiple of pi, reads the jump as nothing: whole
   periods, in all digits or in those of a double. */
static bool is_periodic(nevh__wide jump, int of_pi) {
    static const double most = 0x1p20;
    nevh__wide period = of_pi * nevh__wide_pi();
    double whole = rint((double)(jump / period));
    nevh__wide exact = whole * period, plain = whole * (double)period;
    return fabs(whole) <= most &&
           (is_same(jump, exact) || is_same(jump, plain) ||
            is_same(jump, (double)exact));
}

/* The jump of a node where its operands jump; *known is false where that is not known,
   or H may jump. */
static nevh__wide jump_of(const nevh__graph_node *x, const nevh__wide jump[],
                          bool *known) {
    nevh__wide a = x->a >= 0 ? jump[x->a] : 0, b = x->b >= 0 ? jump[x->b] : 0;
    if (a == 0 && b == 0)
        return 0;
    if (x->kind == NEVH__GRAPH_ADD)
        return a + b;
    if (x->kind == NEVH__GRAPH_SCALE)
        return x->number * a;
    bool tangent = x->function == NEVH__TAN;
    bool circular =
        x->kind == NEVH__GRAPH_CALL &&
        (tangent || x->function == NEVH__SIN || x->function == NEVH__COS);
    *known = *known && circular && is_periodic(a, tangent ? 1 : 2);
    return 0;
}

/* The jump that the function of an edge has by itself. */
static nevh__wide first_jump(const nevh__graph_edge *e,
                             const nevh__graph_node *x) {
    if (x->kind != NEVH__GRAPH_CALL)
        return 0;
    if (e->whole >= 0)
        return x->function == NEVH__FLOOR && x->a == e->whole;
    return x->function == NEVH__ATAN2 && x->a == e->node && x->b == e->also
               ? 2 * nevh__wide_pi()
               : 0;
}

/* True if H has no jump, since sines and so on alone read what jumps, in whole
   periods.
   jump  zeros, before and after */
static bool is_circular(const nevh__graph *g, int used,
                        const nevh__graph_edge *e, nevh__wide jump[],
                        const int roots[], size_t count) {
    bool known = true;
    int from = e->whole >= 0 ? e->whole : e->node, i = from;
    for (; i < used && known; i++) {
        const nevh__graph_node *x = &g->nodes[i];
        jump[i] = first_jump(e, x);
        if (jump[i] == 0)
            jump[i] = jump_of(x, jump, &known);
    }
    for (size_t k = 0; k < count && known; k++)
        known = jump[roots[k]] == 0;
    memset(jump + from, 0, (size_t)(i - from) * sizeof *jump);
    return known;
}

/* The end of the cut of atan2 is left, a pole of derivatives; no edge of floor or mod
   is. */
void nevh__graph_join_cuts(nevh__graph *g, const int roots[], size_t count) {
    int used = g->used;
    nevh__wide *jump = nevh__array((size_t)used, sizeof *jump);
    g->failed = g->failed || !jump;
    size_t kept = 0;
    for (size_t i = 0; i < g->n_edges && !g->failed; i++) {
        nevh__graph_edge e = g->edges[i];
        bool joined = (e.also >= 0 || e.whole >= 0) &&
                      is_circular(g, used, &e, jump, roots, count);
        if (joined && e.also >= 0) {
            e.node = nevh__graph_build(g, "a a * b b * +", e.node, e.also);
            e.also = -1;
            e.function = NEVH__DIVIDE;
        }
        if (!joined || (e.whole < 0 && e.node >= 0))
            g->edges[kept++] = e;
    }
    if (!g->failed)
        g->n_edges = kept;
    free(jump);
}

/* Poles are no edges by themselves: 1/x is as analytic behind 0 as before, and
   where a factor removes the pole the orbit passes.  But atan(1/x) jumps. */

static bool has_pole(const nevh__graph_node *x) {
    double c = (double)x->number;
    return x->kind == NEVH__GRAPH_INVERT ||
           (x->kind == NEVH__GRAPH_POWER && c < 0 && c == rint(c)) ||
           (x->kind == NEVH__GRAPH_CALL && x->function == NEVH__TAN);
}

/* True if poles of an operand are poles of the node. */
static bool hands_on(const nevh__graph_node *x) {
    double c = (double)x->number;
    return x->kind == NEVH__GRAPH_ADD || x->kind == NEVH__GRAPH_SCALE ||
           x->kind == NEVH__GRAPH_MULTIPLY || x->kind == NEVH__GRAPH_INVERT ||
           (x->kind == NEVH__GRAPH_POWER && c == rint(c));
}

enum { POLAR = 1, SEEN = 2 };

static void mark_polar(const nevh__graph *g, int used, unsigned char mark[]) {
    for (int i = 0; i < used; i++) {
        const nevh__graph_node *x = &g->nodes[i];
        bool polar = has_pole(x);
        if (hands_on(x))
            polar = polar || (x->a >= 0 && mark[x->a] & POLAR) ||
                    (x->b >= 0 && mark[x->b] & POLAR);
        mark[i] = polar ? POLAR : 0;
    }
}

/* From functions back to the poles that they see. */
static void mark_seen(const nevh__graph *g, int used, unsigned char mark[]) {
    for (int i = used - 1; i >= 0; i--) {
        const nevh__graph_node *x = &g->nodes[i];
        bool looks = mark[i] & SEEN && hands_on(x);
        if (x->kind == NEVH__GRAPH_CALL ||
            (x->kind == NEVH__GRAPH_POWER && !hands_on(x)))
            looks = true;
        int of[] = {x->a, x->b};
        for (int k = 0; looks && k < 2; k++)
            if (of[k] >= 0 && mark[of[k]] & POLAR)
                mark[of[k]] |= SEEN;
    }
}

void nevh__graph_watch_poles(nevh__graph *g, const char *effect) {
    int used = g->used;
    unsigned char *mark = nevh__array((size_t)used, sizeof *mark);
    g->failed = g->failed || !mark;
    if (!mark)
        return;
    mark_polar(g, used, mark);
    mark_seen(g, used, mark);
    for (int i = 0; i < used && !g->failed; i++) {
        const nevh__graph_node x = g->nodes[i];
        bool tangent = x.kind == NEVH__GRAPH_CALL;
        if (mark[i] & SEEN && has_pole(&x))
            edges_add(g, (nevh__graph_edge){
                             .node = tangent ? nevh__graph_apply(g, NEVH__COS,
                                                                 x.a, x.a)
                                             : x.a,
                             .also = -1,
                             .whole = -1,
                             .strict = true,
                             .function = tangent ? NEVH__TAN : NEVH__DIVIDE,
                             .effect = effect});
    }
    free(mark);
}
