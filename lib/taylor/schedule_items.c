/* nevh: the operations that a recurrence needs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/schedule_private.h"
#include <stdlib.h>

static bool is_sum(const nevh__graph_node *x) {
    return x->kind == NEVH__GRAPH_ADD || x->kind == NEVH__GRAPH_SCALE;
}

static void push(nevh__scheduler *s, int node, nevh__wide factor) {
    if (s->depth == s->stack_capacity) {
        size_t capacity = 2 * s->depth + 64;
        int *stack = nevh__grow(s->stack, capacity, sizeof *stack);
        if (stack)
            s->stack = stack;
        nevh__wide *factors = nevh__grow(s->factors, capacity, sizeof *factors);
        if (factors)
            s->factors = factors;
        s->failed = s->failed || !stack || !factors;
        if (s->failed)
            return;
        s->stack_capacity = capacity;
    }
    s->stack[s->depth] = node;
    s->factors[s->depth++] = factor;
}

int nevh__schedule_peel(const nevh__graph *g, int node, nevh__wide *factor) {
    const nevh__graph_node *x = &g->nodes[node];
    if (x->kind != NEVH__GRAPH_SCALE)
        return node;
    *factor *= x->number;
    return x->a;
}

static void use(nevh__scheduler *s, int node, bool by_sum) {
    if (node < 0)
        return;
    s->apart[node] += !by_sum;
    if (s->uses[node]++ == 0)
        push(s, node, 1);
}

/* Uses of all that the slopes need. */
static void count_uses(nevh__scheduler *s, const int slope[]) {
    for (size_t k = 0; k < 2 * s->n; k++) {
        nevh__wide factor = 1;
        use(s, nevh__schedule_peel(s->g, slope[k], &factor), false);
    }
    for (size_t i = 0; i < s->g->n_edges; i++) {
        use(s, s->g->edges[i].node, false);
        use(s, s->g->edges[i].also, false);
    }
    while (s->depth && !s->failed) {
        const nevh__graph_node *x = &s->g->nodes[s->stack[--s->depth]];
        nevh__wide factor = 1;
        use(s, x->a, is_sum(x));
        use(s, x->b, is_sum(x));
        if (x->slope >= 0)
            use(s, nevh__schedule_peel(s->g, x->slope, &factor), false);
    }
    for (int i = 0; i < s->g->used; i++) /* not written out twice */
        if (s->uses[i] > 1 && s->g->nodes[i].kind == NEVH__GRAPH_SCALE)
            s->apart[s->g->nodes[i].a]++;
}

/* True if a sum is written into the nodes that use it. */
static bool dissolves(const nevh__scheduler *s, int node) {
    const nevh__graph_node *x = &s->g->nodes[node];
    return !s->apart[node] &&
           (x->kind == NEVH__GRAPH_SCALE ||
            (x->kind == NEVH__GRAPH_ADD && s->uses[node] == 1));
}

static int add_item(nevh__scheduler *s, nevh__work_item x) {
    if (s->count == s->capacity) {
        size_t capacity = 2 * s->capacity + 64;
        nevh__work_item *items = nevh__grow(s->items, capacity, sizeof *items);
        if (!items) {
            s->failed = true;
            return 0;
        }
        s->items = items;
        s->capacity = capacity;
    }
    s->items[s->count] = x;
    return (int)s->count++;
}

static void add_summand(nevh__scheduler *s, int leaf, nevh__wide factor) {
    if (s->summands == s->sum_capacity) {
        size_t capacity = 2 * s->sum_capacity + 64;
        nevh__summand_item *sum = nevh__grow(s->sum, capacity, sizeof *sum);
        if (!sum) {
            s->failed = true;
            return;
        }
        s->sum = sum;
        s->sum_capacity = capacity;
    }
    s->sum[s->summands++] = (nevh__summand_item){leaf, factor};
}

/* The summands of a node, in order. */
static void schedule_items_collect(nevh__scheduler *s, int node) {
    const nevh__graph_node *x = &s->g->nodes[node];
    nevh__wide factor = x->kind == NEVH__GRAPH_SCALE ? x->number : 1;
    s->depth = s->summands = 0;
    if (x->b >= 0)
        push(s, x->b, 1);
    push(s, x->a, factor);
    while (s->depth && !s->failed) {
        int at = s->stack[--s->depth];
        factor = s->factors[s->depth];
        x = &s->g->nodes[at];
        if (!is_sum(x) || !dissolves(s, at)) {
            add_summand(s, s->item_of[at], factor);
            continue;
        }
        if (x->b >= 0)
            push(s, x->b, factor);
        push(s, x->a,
             x->kind == NEVH__GRAPH_SCALE ? factor * x->number : factor);
    }
}

static int level_over(const nevh__scheduler *s, int level, int operand) {
    int below = s->items[operand].level;
    return below >= level ? below + 1 : level;
}

/* The sum of a part of the summands. */
static int part_of_sum(nevh__scheduler *s, const nevh__work_item *like,
                       size_t from, size_t count) {
    nevh__work_item x = *like;
    size_t each = 1;
    x.kind = NEVH__BATCH_SUM;
    while (each * NEVH__MOST_SUMMANDS < count)
        each *= NEVH__MOST_SUMMANDS;
    for (size_t i = 0; i < count && !s->failed; i += each) {
        size_t some = count - i < each ? count - i : each;
        bool whole = some > 1;
        x.operand[x.arity] = whole ? part_of_sum(s, like, from + i, some)
                                   : s->sum[from + i].leaf;
        x.number[x.arity] = whole ? 1 : s->sum[from + i].factor;
        x.level = s->failed ? 0 : level_over(s, x.level, x.operand[x.arity]);
        x.arity++;
    }
    return s->failed ? 0 : add_item(s, x);
}

static void take_operand(nevh__scheduler *s, nevh__work_item *x, int node) {
    x->operand[x->arity] = s->item_of[node];
    x->level = level_over(s, x->level, s->item_of[node]);
    x->arity++;
}

static int item_for(nevh__scheduler *s, const nevh__graph_node *n, int node) {
    static const int kinds[] = {[NEVH__GRAPH_NUMBER] = NEVH__ITEM_NUMBER,
                                [NEVH__GRAPH_VARIABLE] = NEVH__ITEM_VARIABLE,
                                [NEVH__GRAPH_ADD] = NEVH__BATCH_SUM,
                                [NEVH__GRAPH_SCALE] = NEVH__BATCH_SUM,
                                [NEVH__GRAPH_MULTIPLY] = NEVH__BATCH_MULTIPLY,
                                [NEVH__GRAPH_INVERT] = NEVH__BATCH_INVERT,
                                [NEVH__GRAPH_POWER] = NEVH__BATCH_POWER,
                                [NEVH__GRAPH_CALL] = NEVH__BATCH_CALL};
    _Static_assert(sizeof kinds / sizeof *kinds == NEVH__GRAPH_KINDS,
                   "each kind of node");
    nevh__work_item x = {.kind = kinds[n->kind],
                         .function = n->function,
                         .slope = -1,
                         .number = {n->number},
                         .tag = n->tag,
                         .rank = n->rank};
    if (n->kind == NEVH__GRAPH_VARIABLE)
        x.value = (uint32_t)n->at;
    if (x.kind < 0)
        return add_item(s, x);
    if (is_sum(n)) {
        schedule_items_collect(s, node);
        x.number[0] = 0;
        return s->failed ? 0 : part_of_sum(s, &x, 0, s->summands);
    }
    if (n->kind == NEVH__GRAPH_POWER && n->number == 0.5L)
        x.kind = NEVH__BATCH_ROOT;
    take_operand(s, &x, n->a);
    if (n->b >= 0)
        take_operand(s, &x, n->b);
    return add_item(s, x);
}

/* Items of all that is needed; slopes follow when all are there. */
static void make_items(nevh__scheduler *s) {
    const nevh__graph *g = s->g;
    for (int i = 0; i < g->used && !s->failed; i++)
        s->item_of[i] = s->uses[i] && !(is_sum(&g->nodes[i]) && dissolves(s, i))
                            ? item_for(s, &g->nodes[i], i)
                            : -1;
    for (int i = 0; i < g->used && !s->failed; i++)
        if (s->item_of[i] >= 0 && g->nodes[i].slope >= 0) {
            nevh__work_item *x = &s->items[s->item_of[i]];
            x->number[0] = 1;
            x->slope = s->item_of[nevh__schedule_peel(g, g->nodes[i].slope,
                                                      &x->number[0])];
        }
}

void nevh__schedule_items(nevh__scheduler *s, const int slope[]) {
    size_t nodes = (size_t)s->g->used;
    s->uses = nevh__array(nodes, sizeof *s->uses);
    s->apart = nevh__array(nodes, sizeof *s->apart);
    s->item_of = nevh__array(nodes, sizeof *s->item_of);
    s->failed = !s->uses || !s->apart || !s->item_of;
    if (!s->failed)
        count_uses(s, slope);
    if (!s->failed)
        make_items(s);
}
