/* nevh: where the functions of a graph stop being analytic.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/graph_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    enum { STRICT = 1, LOOSE = 2, JUMPS = 32 }; /* has_steep has others */
    bool jumps = e->jump >= 0; /* may be forgotten later: on its own */
    uint8_t *watched = &g->nodes[jumps ? e->jump : e->node].watched;
    uint8_t mine = jumps ? JUMPS : e->strict ? STRICT : LOOSE;
    if (e->steep)
        return has_steep(g, e);
    bool had = *watched & (mine == LOOSE ? STRICT | LOOSE : mine);
    *watched |= mine;
    return had;
}

static void edges_add(nevh__graph *g, nevh__graph_edge e) {
    if (e.node < 0 || g->failed || g->nodes[e.node].degree == 0)
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
    *base = operation == NEVH__DIVIDE ? y->base : x->base;
    switch (operation) {
    case NEVH__DIVIDE:
        return -y->power;
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
    static const double least = 12, least_pole = 4, least_quotient = 2;
    int base;
    double power = power_of(g, operation, a, b, &base);
    double order = power * fmax(g->nodes[base].degree, 1);
    bool sum = (operation == NEVH__DIVIDE || operation == NEVH__POWER) &&
               g->nodes[base].kind == NEVH__GRAPH_ADD; /* as 1/(1 + x^2) */
    double pole = sum ? least_quotient : least_pole;
    if (order > least || order <= -pole)
        edges_add(g, (nevh__graph_edge){.node = base,
                                        .also = -1,
                                        .jump = -1,
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
                          .jump = -1,
                          .steep = true,
                          .function = (uint8_t)operation,
                          .effect = effect};
    if (a < 0 || b < 0)
        return;
    if (operation == NEVH__POWER && !nevh__graph_is_number(g, b, NULL)) {
        nevh__wide x;
        bool negative = nevh__graph_is_number(g, a, &x) && x < 0;
        e.function = NEVH__EXP;
        e.node = nevh__graph_build(g, "b a log *",
                                   negative ? nevh__graph_number(g, -x) : a, b);
    } else if (!nevh__operation_of(operation)->steep)
        return;
    edges_add(g, e);
}

void nevh__graph_watch(nevh__graph *g, unsigned operation, int a, int b,
                       const char *effect) {
    nevh__graph_edge e = {.node = -1,
                          .also = -1,
                          .jump = -1,
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
        e.jump = nevh__graph_apply(g, NEVH__FLOOR, a, a);
    if (operation == NEVH__MOD)
        e.jump = nevh__graph_build(g, "a b / floor", a, b);
    if (f->edge) {
        e.strict = !f->touches;
        e.node = nevh__graph_build(g, f->edge, a, b);
    } else if (operation == NEVH__POWER) {
        e.strict = !nevh__graph_is_number(g, b, NULL);
        e.node = is_whole(g, b) ? -1 : a;
    } else if (operation == NEVH__ATAN2) {
        nevh__wide y;
        bool flat = nevh__graph_is_number(g, a, &y) && y == 0; /* 0 or pi */
        e.node = flat ? b : a;
        e.also = flat ? -1 : b;
        e.jump = flat ? -1 : nevh__graph_angle(g, a, b);
    }
    edges_add(g, e);
}

/* The end of the cut of atan2 is left, a pole of derivatives; no edge of floor or mod
   is. */
void nevh__graph_join_cuts(nevh__graph *g, const int roots[], size_t count) {
    size_t kept = 0, n = g->n_edges;
    unsigned char *jumps = nevh__array(n + 1, 1);
    g->failed = g->failed || !jumps;
    bool any = false;
    for (size_t i = 0; i < n; i++)
        any = any || g->edges[i].jump >= 0;
    if (any && !g->failed)
        nevh__graph_find_jumps(g, roots, count, jumps);
    for (size_t i = 0; i < n && !g->failed; i++) {
        nevh__graph_edge e = g->edges[i];
        bool joined = e.jump >= 0 && !jumps[i];
        if (joined && e.also >= 0) {
            e.node = nevh__graph_build(g, "a a * b b * +", e.node, e.also);
            e.also = e.jump = -1;
            e.function = NEVH__DIVIDE;
        }
        if (!joined || (e.jump < 0 && e.node >= 0))
            g->edges[kept++] = e;
    }
    if (!g->failed)
        g->n_edges = kept;
    free(jumps);
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
                             .jump = -1,
                             .strict = true,
                             .function = tangent ? NEVH__TAN : NEVH__DIVIDE,
                             .effect = effect});
    }
    free(mark);
}
