/* nevh: the nodes of a graph, and how they are rewritten as they are made.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/graph_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void nevh__graph_clear(nevh__graph *g) {
    free(g->nodes);
    free(g->table);
    free(g->edges);
    memset(g, 0, sizeof *g);
}

static bool graph_same(const nevh__graph_node *x, const nevh__graph_node *y) {
    return x->kind == y->kind && x->function == y->function && x->a == y->a &&
           x->b == y->b && x->at == y->at && x->number == y->number;
}

static size_t graph_hash(const nevh__graph_node *x) {
    double number = (double)x->number;
    uint64_t bits, h = x->kind * 31u + x->function;
    memcpy(&bits, &number, sizeof bits);
    h = (h * 0x9e3779b97f4a7c15u) ^ (uint64_t)(unsigned)x->a;
    h = (h * 0x9e3779b97f4a7c15u) ^ (uint64_t)(unsigned)x->b;
    h = (h * 0x9e3779b97f4a7c15u) ^ x->at;
    h = (h * 0x9e3779b97f4a7c15u) ^ bits;
    return (size_t)(h ^ h >> 29);
}

static size_t graph_slot_of(const nevh__graph *g, const nevh__graph_node *x) {
    size_t at = graph_hash(x) & (g->slots - 1);
    while (g->table[at] && !graph_same(&g->nodes[g->table[at] - 1], x))
        at = (at + 1) & (g->slots - 1);
    return at;
}

static bool graph_widen(nevh__graph *g) {
    int capacity = g->capacity ? 2 * g->capacity : 256;
    g->overflowed = g->overflowed || capacity > NEVH__GRAPH_NODES;
    if (g->overflowed)
        return false;
    nevh__graph_node *nodes =
        nevh__grow(g->nodes, (size_t)capacity, sizeof *nodes);
    if (nodes)
        g->nodes = nodes;
    int *table = nevh__array(2 * (size_t)capacity, sizeof *table);
    if (!nodes || !table) {
        free(table);
        return false;
    }
    free(g->table);
    g->table = table;
    g->capacity = capacity;
    g->slots = 2 * (size_t)capacity;
    for (int i = 0; i < g->used; i++)
        g->table[graph_slot_of(g, &g->nodes[i])] = i + 1;
    return true;
}

/* Sets the degree and the power of the node that is made next. */
static void note_growth(const nevh__graph *g, nevh__graph_node *x) {
    static const nevh__graph_node none = {.base = -1};
    const nevh__graph_node *a = x->a < 0 ? &none : &g->nodes[x->a];
    const nevh__graph_node *b = x->b < 0 ? &none : &g->nodes[x->b];
    bool product = x->kind == NEVH__GRAPH_MULTIPLY;
    x->degree = product ? a->degree + b->degree : fmaxf(a->degree, b->degree);
    x->base = g->used;
    x->power = 1;
    if (x->kind == NEVH__GRAPH_VARIABLE)
        x->degree = 1;
    if (x->kind == NEVH__GRAPH_CALL &&
        (x->function == NEVH__FLOOR || x->function == NEVH__SIGN))
        x->degree = 0;
    if (x->kind == NEVH__GRAPH_SCALE || (product && a->base == b->base)) {
        x->base = a->base;
        x->power = a->power + b->power;
    }
}

static int node(nevh__graph *g, nevh__graph_node x) {
    if (g->failed || (g->used == g->capacity && !graph_widen(g))) {
        g->failed = true;
        return -1;
    }
    size_t at = graph_slot_of(g, &x);
    if (g->table[at])
        return g->table[at] - 1;
    note_growth(g, &x);
    g->nodes[g->used++] = x;
    g->table[at] = g->used;
    return g->used - 1;
}

static const nevh__graph_node *graph_at(const nevh__graph *g, int i) {
    return &g->nodes[i];
}

bool nevh__graph_is_number(const nevh__graph *g, int i, nevh__wide *value) {
    if (i < 0 || graph_at(g, i)->kind != NEVH__GRAPH_NUMBER)
        return false;
    if (value)
        *value = graph_at(g, i)->number;
    return true;
}

static bool bad(const nevh__graph *g, int a, int b) {
    return g->failed || a < 0 || b < 0;
}

int nevh__graph_number(nevh__graph *g, nevh__wide x) {
    return node(g, (nevh__graph_node){.kind = NEVH__GRAPH_NUMBER,
                                      .a = -1,
                                      .b = -1,
                                      .slope = -1,
                                      .number = x});
}

int nevh__graph_variable(nevh__graph *g, size_t k) {
    return node(g, (nevh__graph_node){.kind = NEVH__GRAPH_VARIABLE,
                                      .a = -1,
                                      .b = -1,
                                      .slope = -1,
                                      .at = k});
}

static int graph_operation(nevh__graph *g, nevh__graph_kind kind, nevh__wide x,
                           int a, int b) {
    return node(
        g,
        (nevh__graph_node){
            .kind = (uint8_t)kind, .a = a, .b = b, .slope = -1, .number = x});
}

int nevh__graph_add(nevh__graph *g, int a, int b) {
    nevh__wide x, y;
    if (bad(g, a, b))
        return -1;
    bool is_x = nevh__graph_is_number(g, a, &x);
    bool is_y = nevh__graph_is_number(g, b, &y);
    if (is_x && is_y)
        return nevh__graph_number(g, x + y);
    if (is_x && x == 0)
        return b;
    if (is_y && y == 0)
        return a;
    if (a == b)
        return nevh__graph_scale(g, 2, a);
    return graph_operation(g, NEVH__GRAPH_ADD, 0, a < b ? a : b, a < b ? b : a);
}

int nevh__graph_scale(nevh__graph *g, nevh__wide c, int a) {
    nevh__wide x;
    if (bad(g, a, a))
        return -1;
    if (nevh__graph_is_number(g, a, &x))
        return nevh__graph_number(g, c * x);
    if (c == 0)
        return nevh__graph_number(g, 0);
    if (graph_at(g, a)->kind == NEVH__GRAPH_SCALE)
        return nevh__graph_scale(g, c * graph_at(g, a)->number,
                                 graph_at(g, a)->a);
    return c == 1 ? a : graph_operation(g, NEVH__GRAPH_SCALE, c, a, -1);
}

/* node = base^exponent */
static nevh__wide exponent_of(const nevh__graph *g, int i, int *base) {
    const nevh__graph_node *x = graph_at(g, i);
    *base = x->a;
    if (x->kind == NEVH__GRAPH_POWER)
        return x->number;
    if (x->kind == NEVH__GRAPH_INVERT)
        return -1;
    *base = i;
    return 1;
}

int nevh__graph_multiply(nevh__graph *g, int a, int b) {
    nevh__wide x;
    int base, other;
    if (bad(g, a, b))
        return -1;
    if (nevh__graph_is_number(g, a, &x))
        return nevh__graph_scale(g, x, b);
    if (nevh__graph_is_number(g, b, &x))
        return nevh__graph_scale(g, x, a);
    if (graph_at(g, a)->kind == NEVH__GRAPH_SCALE) {
        x = graph_at(g, a)->number;
        return nevh__graph_scale(g, x,
                                 nevh__graph_multiply(g, graph_at(g, a)->a, b));
    }
    if (graph_at(g, b)->kind == NEVH__GRAPH_SCALE)
        return nevh__graph_multiply(g, b, a);
    nevh__wide c = exponent_of(g, a, &base), d = exponent_of(g, b, &other);
    if (base == other && (a != b || graph_at(g, a)->kind == NEVH__GRAPH_POWER))
        return nevh__graph_power(g, base, c + d);
    return graph_operation(g, NEVH__GRAPH_MULTIPLY, 0, a < b ? a : b,
                           a < b ? b : a);
}

static int invert(nevh__graph *g, int a) {
    nevh__wide x;
    int base;
    if (bad(g, a, a))
        return -1;
    if (nevh__graph_is_number(g, a, &x))
        return nevh__graph_number(g, 1 / x);
    if (graph_at(g, a)->kind == NEVH__GRAPH_SCALE) {
        x = graph_at(g, a)->number;
        return nevh__graph_scale(g, 1 / x, invert(g, graph_at(g, a)->a));
    }
    nevh__wide c = exponent_of(g, a, &base);
    if (base != a)
        return nevh__graph_power(g, base, -c);
    return graph_operation(g, NEVH__GRAPH_INVERT, 0, a, -1);
}

/* a^n, n > 0, by squaring: a series of its own would divide by a. */
static int whole_power(nevh__graph *g, int a, long n) {
    if (n == 1)
        return a;
    int half = whole_power(g, a, n / 2);
    int even = nevh__graph_multiply(g, half, half);
    return n % 2 ? nevh__graph_multiply(g, a, even) : even;
}

enum { MOST_MULTIPLIED = 1 << 20 };

/* The factor k of a node k x, and x. */
static nevh__wide factor_of(const nevh__graph *g, int i, int *x) {
    bool scaled = graph_at(g, i)->kind == NEVH__GRAPH_SCALE;
    *x = scaled ? graph_at(g, i)->a : i;
    return scaled ? graph_at(g, i)->number : 1;
}

/* The exponent n of a product x^n, or 0. */
static double whole_exponent(const nevh__graph *g, int i) {
    const nevh__graph_node *x = graph_at(g, i);
    return x->kind == NEVH__GRAPH_MULTIPLY && x->base != i ? x->power : 0;
}

static bool is_even(double x) {
    return fmod(x, 2) == 0;
}

static int times_power(nevh__graph *g, nevh__wide k, nevh__wide c, int rest) {
    return nevh__graph_scale(g, nevh__operation_wide(NEVH__POWER, k, c), rest);
}

/* (k x^n)^c where it is analytic, as of n = 4 and c = 1/2; else -1. */
static int even_power(nevh__graph *g, int a, nevh__wide c) {
    int x;
    nevh__wide k = factor_of(g, a, &x);
    double n = whole_exponent(g, x), power = n * (double)c;
    if (!(k > 0) || !(power > 0) || !is_even(n) || !is_even(power))
        return -1;
    return times_power(g, k, c,
                       nevh__graph_power(g, graph_at(g, x)->base, power));
}

int nevh__graph_cube_root(nevh__graph *g, int a) {
    int x;
    if (bad(g, a, a))
        return -1;
    nevh__wide k = factor_of(g, a, &x);
    double n = whole_exponent(g, x);
    if (n == 0 || fmod(n, 3) != 0)
        return -1;
    return nevh__graph_scale(g, nevh__operation_wide(NEVH__CBRT, k, k),
                             nevh__graph_power(g, graph_at(g, x)->base, n / 3));
}

/* v of a step (sign(v) + 1)/2, which max and min have; else -1. */
static int graph_step_of(const nevh__graph *g, int i) {
    const nevh__graph_node *x = graph_at(g, i);
    nevh__wide half = 0;
    int a = x->a, b = x->b, sign;
    if (x->kind != NEVH__GRAPH_ADD ||
        !(nevh__graph_is_number(g, a, &half) ||
          nevh__graph_is_number(g, b, &half)) ||
        half != 0.5)
        return -1;
    a = nevh__graph_is_number(g, a, NULL) ? b : a;
    half = factor_of(g, a, &sign);
    x = graph_at(g, sign);
    return half == 0.5 && x->kind == NEVH__GRAPH_CALL &&
                   x->function == NEVH__SIGN
               ? x->a
               : -1;
}

/* max(k u, 0)^c = step |k u|^c, whose series is not that of 0^c where the maximum
   is 0; else -1. */
static int power_of_maximum(nevh__graph *g, int a, nevh__wide c) {
    int x, u, v, step;
    nevh__wide k = factor_of(g, a, &x);
    if (c < 0 || graph_at(g, x)->kind != NEVH__GRAPH_MULTIPLY)
        return -1;
    for (int i = 0; i < 2; i++) {
        step = i ? graph_at(g, x)->a : graph_at(g, x)->b;
        u = i ? graph_at(g, x)->b : graph_at(g, x)->a;
        int of = graph_step_of(g, step);
        nevh__wide m = of < 0 ? 0 : factor_of(g, of, &v);
        if (of < 0 || v != u || !(k * m > 0))
            continue;
        int size = nevh__graph_apply(g, NEVH__ABS, u, u);
        int power =
            nevh__graph_multiply(g, step, nevh__graph_power(g, size, c));
        return times_power(g, k < 0 ? -k : k, c, power);
    }
    return -1;
}

/* a^c as a power of something simpler, c no whole number; else -1. */
static int broken_power(nevh__graph *g, int a, nevh__wide c) {
    int simpler = even_power(g, a, c);
    if (simpler < 0)
        simpler = power_of_maximum(g, a, c);
    double inner =
        (double)graph_at(g, a)->number; /* a whole one: of either sign */
    return simpler < 0 && !g->failed &&
                   graph_at(g, a)->kind == NEVH__GRAPH_POWER &&
                   inner != rint(inner)
               ? nevh__graph_power(g, graph_at(g, a)->a,
                                   graph_at(g, a)->number * c)
               : simpler;
}

int nevh__graph_power(nevh__graph *g, int a, nevh__wide c) {
    double near = (double)c;
    if (bad(g, a, a))
        return -1;
    if (c == 0)
        return nevh__graph_number(g, 1);
    bool whole = near == c && near == rint(near);
    if (whole && near > 0 && near <= MOST_MULTIPLIED)
        return whole_power(g, a, (long)near);
    if (c == -1)
        return invert(g, a);
    int simpler = whole ? -1 : broken_power(g, a, c);
    return simpler >= 0 || g->failed
               ? simpler
               : graph_operation(g, NEVH__GRAPH_POWER, c, a, -1);
}

/* Functions and their derivatives. */

/* of: the function of whose second half NEVH__NOTHING is. */
static int raw_call(nevh__graph *g, int function, size_t of, int a, int b) {
    return node(g, (nevh__graph_node){.kind = NEVH__GRAPH_CALL,
                                      .function = (uint8_t)function,
                                      .at = of,
                                      .a = a,
                                      .b = b,
                                      .slope = -1});
}

static int build_number(void *data, double x) {
    return nevh__graph_number(data, x);
}

static int build_operation(void *data, nevh__tape_operation f, int a, int b) {
    return nevh__graph_apply(data, f, a, b);
}

static int graph_build(nevh__graph *g, const char *formula, const int of[3]) {
    const nevh__algebra nodes = {g, build_number, build_operation};
    return nevh__operation_build(formula, of, &nodes);
}

static int graph_slope_of(nevh__graph *g, nevh__derivative_text by,
                          const int of[3]) {
    int top = graph_build(g, by.top, of);
    return by.bottom ? nevh__graph_multiply(
                           g, top, invert(g, graph_build(g, by.bottom, of)))
                     : top;
}

int nevh__graph_angle(nevh__graph *g, int a, int b) {
    bool known =
        nevh__graph_is_number(g, a, NULL) && nevh__graph_is_number(g, b, NULL);
    return known || bad(g, a, b) ? -1 : raw_call(g, NEVH__ATAN2, 0, a, b);
}

/* Two halves that have one argument each. */
static int call_of_two(nevh__graph *g, nevh__tape_operation f, int a, int b) {
    const nevh__operation_traits *known = nevh__operation_of(f);
    int by_a = raw_call(g, f, 0, a, b),
        by_b = raw_call(g, NEVH__NOTHING, f, b, a);
    const int of[3] = {a, b, -1};
    int slope_a = graph_slope_of(g, known->by_a, of);
    int slope_b = graph_slope_of(g, known->by_b, of);
    if (g->failed)
        return -1;
    g->nodes[by_a].slope = slope_a;
    g->nodes[by_b].slope = slope_b;
    return nevh__graph_add(g, by_a, by_b);
}

static int graph_call(nevh__graph *g, nevh__tape_operation f, int a) {
    int y = raw_call(g, f, 0, a, -1);
    if (y < 0 || g->nodes[y].slope >= 0)
        return y;
    g->nodes[y].slope = y; /* while it is being made: sine and cosine have each
                              other's */
    int slope =
        graph_slope_of(g, nevh__operation_of(f)->by_a, (int[]){a, a, y});
    if (g->failed)
        return -1;
    g->nodes[y].slope = slope;
    return y;
}

/* True if a node has whole values alone, as floor has. */
static bool is_whole_valued(const nevh__graph *g, int i) {
    const nevh__graph_node *x = graph_at(g, i);
    bool whole = (double)x->number == rint((double)x->number);
    switch (x->kind) {
    case NEVH__GRAPH_NUMBER:
        return whole;
    case NEVH__GRAPH_SCALE:
        return whole && is_whole_valued(g, x->a);
    case NEVH__GRAPH_ADD:
    case NEVH__GRAPH_MULTIPLY:
        return is_whole_valued(g, x->a) && is_whole_valued(g, x->b);
    default:
        return x->kind == NEVH__GRAPH_CALL && x->function == NEVH__FLOOR;
    }
}

/* (-a)^b = cos(pi b) a^b where b is whole. */
static int graph_power(nevh__graph *g, int a, int b) {
    nevh__wide c;
    if (nevh__graph_is_number(g, b, &c))
        return nevh__graph_power(g, a, c);
    if (b >= 0 && nevh__graph_is_number(g, a, &c) && c < 0 &&
        is_whole_valued(g, b))
        return nevh__graph_multiply(
            g,
            graph_call(g, NEVH__COS, nevh__graph_scale(g, nevh__wide_pi(), b)),
            graph_power(g, nevh__graph_number(g, -c), b));
    return graph_build(g, "b a log * exp", (int[]){a, b, -1});
}

int nevh__graph_build(nevh__graph *g, const char *formula, int a, int b) {
    return graph_build(g, formula, (int[]){a, b, -1});
}

int nevh__graph_apply(nevh__graph *g, nevh__tape_operation f, int a, int b) {
    const nevh__operation_traits *known = nevh__operation_of(f);
    nevh__wide x, y;
    if (bad(g, a, b))
        return -1;
    if (nevh__graph_is_number(g, a, &x) && nevh__graph_is_number(g, b, &y))
        return nevh__graph_number(g, nevh__operation_wide(f, x, y));
    int root = f == NEVH__CBRT ? nevh__graph_cube_root(g, a) : -1;
    if (root >= 0)
        return root;
    switch (f) {
    case NEVH__ADD:
        return nevh__graph_add(g, a, b);
    case NEVH__SUBTRACT:
        return nevh__graph_add(g, a, nevh__graph_scale(g, -1, b));
    case NEVH__MULTIPLY:
        return nevh__graph_multiply(g, a, b);
    case NEVH__DIVIDE:
        return nevh__graph_multiply(g, a, invert(g, b));
    case NEVH__POWER:
        return graph_power(g, a, b);
    case NEVH__NEGATE:
        return nevh__graph_scale(g, -1, a);
    default:
        return known->as           ? nevh__graph_build(g, known->as, a, b)
               : known->arity == 2 ? call_of_two(g, f, a, b)
                                   : graph_call(g, f, a);
    }
}
