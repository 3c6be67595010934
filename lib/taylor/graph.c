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

static bool same(const nevh__graph_node *x, const nevh__graph_node *y) {
    return x->kind == y->kind && x->function == y->function && x->a == y->a &&
           x->b == y->b && x->at == y->at && x->number == y->number;
}

static size_t hash(const nevh__graph_node *x) {
    double number = (double)x->number;
    uint64_t bits, h = x->kind * 31u + x->function;
    memcpy(&bits, &number, sizeof bits);
    h = (h * 0x9e3779b97f4a7c15u) ^ (uint64_t)(unsigned)x->a;
    h = (h * 0x9e3779b97f4a7c15u) ^ (uint64_t)(unsigned)x->b;
    h = (h * 0x9e3779b97f4a7c15u) ^ x->at;
    h = (h * 0x9e3779b97f4a7c15u) ^ bits;
    return (size_t)(h ^ h >> 29);
}

static size_t slot_of(const nevh__graph *g, const nevh__graph_node *x) {
    size_t at = hash(x) & (g->slots - 1);
    while (g->table[at] && !same(&g->nodes[g->table[at] - 1], x))
        at = (at + 1) & (g->slots - 1);
    return at;
}

static bool widen(nevh__graph *g) {
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
        g->table[slot_of(g, &g->nodes[i])] = i + 1;
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
    if (x->kind == NEVH__GRAPH_SCALE || (product && a->base == b->base)) {
        x->base = a->base;
        x->power = a->power + b->power;
    }
}

static int node(nevh__graph *g, nevh__graph_node x) {
    if (g->failed || (g->used == g->capacity && !widen(g))) {
        g->failed = true;
        return -1;
    }
    size_t at = slot_of(g, &x);
    if (g->table[at])
        return g->table[at] - 1;
    note_growth(g, &x);
    g->nodes[g->used++] = x;
    g->table[at] = g->used;
    return g->used - 1;
}

static const nevh__graph_node *at(const nevh__graph *g, int i) {
    return &g->nodes[i];
}

bool nevh__graph_is_number(const nevh__graph *g, int i, nevh__wide *value) {
    if (i < 0 || at(g, i)->kind != NEVH__GRAPH_NUMBER)
        return false;
    if (value)
        *value = at(g, i)->number;
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

static int operation(nevh__graph *g, nevh__graph_kind kind, nevh__wide x, int a,
                     int b) {
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
    return operation(g, NEVH__GRAPH_ADD, 0, a < b ? a : b, a < b ? b : a);
}

int nevh__graph_scale(nevh__graph *g, nevh__wide c, int a) {
    nevh__wide x;
    if (bad(g, a, a))
        return -1;
    if (nevh__graph_is_number(g, a, &x))
        return nevh__graph_number(g, c * x);
    if (c == 0)
        return nevh__graph_number(g, 0);
    if (at(g, a)->kind == NEVH__GRAPH_SCALE)
        return nevh__graph_scale(g, c * at(g, a)->number, at(g, a)->a);
    return c == 1 ? a : operation(g, NEVH__GRAPH_SCALE, c, a, -1);
}

/* node = base^exponent */
static nevh__wide exponent_of(const nevh__graph *g, int i, int *base) {
    const nevh__graph_node *x = at(g, i);
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
    if (at(g, a)->kind == NEVH__GRAPH_SCALE) {
        x = at(g, a)->number;
        return nevh__graph_scale(g, x, nevh__graph_multiply(g, at(g, a)->a, b));
    }
    if (at(g, b)->kind == NEVH__GRAPH_SCALE)
        return nevh__graph_multiply(g, b, a);
    nevh__wide c = exponent_of(g, a, &base), d = exponent_of(g, b, &other);
    if (base == other && (a != b || at(g, a)->kind == NEVH__GRAPH_POWER))
        return nevh__graph_power(g, base, c + d);
    return operation(g, NEVH__GRAPH_MULTIPLY, 0, a < b ? a : b, a < b ? b : a);
}

int nevh__graph_invert(nevh__graph *g, int a) {
    nevh__wide x;
    int base;
    if (bad(g, a, a))
        return -1;
    if (nevh__graph_is_number(g, a, &x))
        return nevh__graph_number(g, 1 / x);
    if (at(g, a)->kind == NEVH__GRAPH_SCALE) {
        x = at(g, a)->number;
        return nevh__graph_scale(g, 1 / x, nevh__graph_invert(g, at(g, a)->a));
    }
    nevh__wide c = exponent_of(g, a, &base);
    if (base != a)
        return nevh__graph_power(g, base, -c);
    return operation(g, NEVH__GRAPH_INVERT, 0, a, -1);
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
        return nevh__graph_invert(g, a);
    double inner = (double)at(g, a)->number; /* a whole one: of either sign */
    if (at(g, a)->kind == NEVH__GRAPH_POWER && !whole && inner != rint(inner))
        return nevh__graph_power(g, at(g, a)->a, at(g, a)->number * c);
    return operation(g, NEVH__GRAPH_POWER, c, a, -1);
}

/* Functions and their derivatives. */

static int one_plus(nevh__graph *g, nevh__wide c, int x) {
    return nevh__graph_add(g, nevh__graph_number(g, 1),
                           nevh__graph_scale(g, c, x));
}

static int square(nevh__graph *g, int x) {
    return nevh__graph_multiply(g, x, x);
}

static int raw_call(nevh__graph *g, int function, int a, int b) {
    return node(g, (nevh__graph_node){.kind = NEVH__GRAPH_CALL,
                                      .function = (uint8_t)function,
                                      .a = a,
                                      .b = b,
                                      .slope = -1});
}

static int call_of(nevh__graph *g, nevh__tape_operation f, int a) {
    return nevh__graph_call(g, f, a, -1);
}

/* The derivative of y = f(a). */
static int slope_of(nevh__graph *g, nevh__tape_operation f, int a, int y) {
    switch (f) {
    case NEVH__SIN:
        return call_of(g, NEVH__COS, a);
    case NEVH__COS:
        return nevh__graph_scale(g, -1, call_of(g, NEVH__SIN, a));
    case NEVH__TAN:
        return one_plus(g, 1, square(g, y));
    case NEVH__ASIN:
        return nevh__graph_power(g, one_plus(g, -1, square(g, a)), -0.5L);
    case NEVH__ACOS:
        return nevh__graph_scale(
            g, -1, nevh__graph_power(g, one_plus(g, -1, square(g, a)), -0.5L));
    case NEVH__ATAN:
        return nevh__graph_invert(g, one_plus(g, 1, square(g, a)));
    case NEVH__SINH:
        return call_of(g, NEVH__COSH, a);
    case NEVH__COSH:
        return call_of(g, NEVH__SINH, a);
    case NEVH__TANH:
        return one_plus(g, -1, square(g, y));
    case NEVH__ASINH:
        return nevh__graph_power(g, one_plus(g, 1, square(g, a)), -0.5L);
    case NEVH__ACOSH: {
        int below = nevh__graph_add(g, a, nevh__graph_number(g, -1));
        return nevh__graph_multiply(
            g, nevh__graph_power(g, below, -0.5L),
            nevh__graph_power(g, one_plus(g, 1, a), -0.5L));
    }
    case NEVH__ATANH:
        return nevh__graph_invert(g, one_plus(g, -1, square(g, a)));
    case NEVH__EXP:
        return y;
    case NEVH__LOG:
        return nevh__graph_invert(g, a);
    default: /* LOG10 */
        return nevh__graph_invert(
            g, nevh__graph_multiply(
                   g, a, call_of(g, NEVH__LOG, nevh__graph_number(g, 10))));
    }
}

/* Of x and y: the two halves have one argument each, and 1/r^2 in common. */
static int angle(nevh__graph *g, int y, int x) {
    int inverse =
        nevh__graph_invert(g, nevh__graph_add(g, square(g, x), square(g, y)));
    int by_y = raw_call(g, NEVH__ATAN2, y, x);
    int by_x = raw_call(g, NEVH__NOTHING, x, y);
    int slope_y = nevh__graph_multiply(g, x, inverse);
    int slope_x = nevh__graph_scale(g, -1, nevh__graph_multiply(g, y, inverse));
    if (g->failed)
        return -1;
    g->nodes[by_y].slope = slope_y;
    g->nodes[by_x].slope = slope_x;
    return nevh__graph_add(g, by_y, by_x);
}

/* A constant between its jumps. */
static int stair(nevh__graph *g, nevh__tape_operation f, int a) {
    int zero = nevh__graph_number(g, 0), y = raw_call(g, f, a, -1);
    if (g->failed)
        return -1;
    g->nodes[y].slope = zero;
    return y;
}

/* Of other functions with kinks, from a sign or a whole part. */
static int broken(nevh__graph *g, nevh__tape_operation f, int a, int b) {
    if (f == NEVH__ABS)
        return nevh__graph_multiply(g, a, stair(g, NEVH__SIGN, a));
    int apart = nevh__graph_add(g, a, nevh__graph_scale(g, -1, b));
    if (f == NEVH__MOD) {
        int ratio = nevh__graph_multiply(g, a, nevh__graph_invert(g, b));
        int whole = nevh__graph_multiply(g, b, stair(g, NEVH__FLOOR, ratio));
        return nevh__graph_add(g, a, nevh__graph_scale(g, -1, whole));
    }
    int half = nevh__graph_scale(g, 0.5L, broken(g, NEVH__ABS, apart, -1));
    int mean = nevh__graph_scale(g, 0.5L, nevh__graph_add(g, a, b));
    return nevh__graph_add(
        g, mean, f == NEVH__MAX ? half : nevh__graph_scale(g, -1, half));
}

int nevh__graph_call(nevh__graph *g, nevh__tape_operation f, int a, int b) {
    if (bad(g, a, a))
        return -1;
    if (f == NEVH__SIGN || f == NEVH__FLOOR)
        return stair(g, f, a);
    if (f == NEVH__ABS || f == NEVH__MIN || f == NEVH__MAX || f == NEVH__MOD)
        return broken(g, f, a, b);
    if (f == NEVH__SQRT)
        return nevh__graph_power(g, a, 0.5L);
    if (f == NEVH__ATAN2)
        return angle(g, a, b);
    if (f == NEVH__HYPOT)
        return nevh__graph_power(
            g, nevh__graph_add(g, square(g, a), square(g, b)), 0.5L);
    int y = raw_call(g, f, a, -1);
    if (y < 0 || g->nodes[y].slope >= 0)
        return y;
    g->nodes[y].slope = y; /* while it is being made: sine and cosine have each
                              other's */
    int slope = f == NEVH__CBRT
                    ? nevh__graph_scale(g, (nevh__wide)1 / 3,
                                        nevh__graph_invert(g, square(g, y)))
                    : slope_of(g, f, a, y);
    if (g->failed)
        return -1;
    g->nodes[y].slope = slope;
    return y;
}
