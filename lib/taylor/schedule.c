/* nevh: the order in which recurrences run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/series_private.h"
#include <stdlib.h>
#include <string.h>

/* An operation, or a variable or number; operands are such items. */
typedef struct {
    int kind; /* nevh__batch_kind, or of what has no operation: */
    uint8_t arity, function;
    int operand[NEVH__MOST_SUMMANDS];
    int slope;
    nevh__wide number[NEVH__MOST_SUMMANDS];
    int level, tag, rank;
    uint32_t value;
} item;
enum { VARIABLE = -2, NUMBER = -1 };

typedef struct {
    int leaf;
    nevh__wide factor;
} summand;

typedef struct {
    const nevh__graph *g;
    size_t n;
    int *uses; /* by node: of live ones, and by what is no sum */
    int *apart;
    int *item_of; /* by node; -1: none */
    item *items;
    size_t count, capacity;
    summand *sum;
    size_t summands, sum_capacity;
    int *stack;
    nevh__wide *factors; /* of what is on the stack */
    size_t depth, stack_capacity;
    bool failed;
} scheduler;

static bool is_sum(const nevh__graph_node *x) {
    return x->kind == NEVH__GRAPH_ADD || x->kind == NEVH__GRAPH_SCALE;
}

static void push(scheduler *s, int node, nevh__wide factor) {
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

/* What remains of a multiple. */
static int peel(const nevh__graph *g, int node, nevh__wide *factor) {
    const nevh__graph_node *x = &g->nodes[node];
    if (x->kind != NEVH__GRAPH_SCALE)
        return node;
    *factor *= x->number;
    return x->a;
}

static void use(scheduler *s, int node, bool by_sum) {
    if (node < 0)
        return;
    s->apart[node] += !by_sum;
    if (s->uses[node]++ == 0)
        push(s, node, 1);
}

/* Uses of all that the slopes need. */
static void count_uses(scheduler *s, const int slope[]) {
    for (size_t k = 0; k < 2 * s->n; k++) {
        nevh__wide factor = 1;
        use(s, peel(s->g, slope[k], &factor), false);
    }
    while (s->depth && !s->failed) {
        const nevh__graph_node *x = &s->g->nodes[s->stack[--s->depth]];
        nevh__wide factor = 1;
        use(s, x->a, is_sum(x));
        use(s, x->b, is_sum(x));
        if (x->slope >= 0)
            use(s, peel(s->g, x->slope, &factor), false);
    }
    for (int i = 0; i < s->g->used; i++) /* not written out twice */
        if (s->uses[i] > 1 && s->g->nodes[i].kind == NEVH__GRAPH_SCALE)
            s->apart[s->g->nodes[i].a]++;
}

/* Whether a sum is written into those that use it. */
static bool dissolves(const scheduler *s, int node) {
    const nevh__graph_node *x = &s->g->nodes[node];
    return !s->apart[node] &&
           (x->kind == NEVH__GRAPH_SCALE ||
            (x->kind == NEVH__GRAPH_ADD && s->uses[node] == 1));
}

static int add_item(scheduler *s, item x) {
    if (s->count == s->capacity) {
        size_t capacity = 2 * s->capacity + 64;
        item *items = nevh__grow(s->items, capacity, sizeof *items);
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

static void add_summand(scheduler *s, int leaf, nevh__wide factor) {
    if (s->summands == s->sum_capacity) {
        size_t capacity = 2 * s->sum_capacity + 64;
        summand *sum = nevh__grow(s->sum, capacity, sizeof *sum);
        if (!sum) {
            s->failed = true;
            return;
        }
        s->sum = sum;
        s->sum_capacity = capacity;
    }
    s->sum[s->summands++] = (summand){leaf, factor};
}

/* The summands of a node, in order. */
static void collect(scheduler *s, int node) {
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

static int level_over(const scheduler *s, int level, int operand) {
    int below = s->items[operand].level;
    return below >= level ? below + 1 : level;
}

/* The sum of a part of the summands. */
static int part_of_sum(scheduler *s, const item *like, size_t from,
                       size_t count) {
    item x = *like;
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

static void take_operand(scheduler *s, item *x, int node) {
    x->operand[x->arity] = s->item_of[node];
    x->level = level_over(s, x->level, s->item_of[node]);
    x->arity++;
}

static int item_for(scheduler *s, const nevh__graph_node *n, int node) {
    static const int kinds[] = {[NEVH__GRAPH_NUMBER] = NUMBER,
                                [NEVH__GRAPH_VARIABLE] = VARIABLE,
                                [NEVH__GRAPH_ADD] = NEVH__BATCH_SUM,
                                [NEVH__GRAPH_SCALE] = NEVH__BATCH_SUM,
                                [NEVH__GRAPH_MULTIPLY] = NEVH__BATCH_MULTIPLY,
                                [NEVH__GRAPH_INVERT] = NEVH__BATCH_INVERT,
                                [NEVH__GRAPH_POWER] = NEVH__BATCH_POWER,
                                [NEVH__GRAPH_CALL] = NEVH__BATCH_CALL};
    _Static_assert(sizeof kinds / sizeof *kinds == NEVH__GRAPH_KINDS,
                   "each kind of node");
    item x = {.kind = kinds[n->kind],
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
        collect(s, node);
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
static void make_items(scheduler *s) {
    const nevh__graph *g = s->g;
    for (int i = 0; i < g->used && !s->failed; i++)
        s->item_of[i] = s->uses[i] && !(is_sum(&g->nodes[i]) && dissolves(s, i))
                            ? item_for(s, &g->nodes[i], i)
                            : -1;
    for (int i = 0; i < g->used && !s->failed; i++)
        if (s->item_of[i] >= 0 && g->nodes[i].slope >= 0) {
            item *x = &s->items[s->item_of[i]];
            x->number[0] = 1;
            x->slope = s->item_of[peel(g, g->nodes[i].slope, &x->number[0])];
        }
}

static int compare(const void *a, const void *b) {
    const item *x = *(const item *const *)a, *y = *(const item *const *)b;
#define BY(what)                                                               \
    if (x->what != y->what)                                                    \
        return x->what < y->what ? -1 : 1;
    BY(level)
    BY(kind)
    BY(arity)
    BY(function)
    BY(tag)
    BY(rank)
#undef BY
    return x < y ? -1 : x > y;
}

/* Instances of one operation that are a batch of their own. */
enum { MANY = 8 };

static size_t alike(item *const *of, size_t from, size_t count) {
    size_t i = from + 1;
    while (i < count && of[i]->level == of[from]->level &&
           of[i]->kind == of[from]->kind && of[i]->arity == of[from]->arity &&
           of[i]->function == of[from]->function && of[i]->tag == of[from]->tag)
        i++;
    return i - from;
}

static size_t batch_size(item *const *of, size_t from, size_t count) {
    size_t all = alike(of, from, count);
    while (all < MANY && from + all < count) {
        const item *x = of[from], *y = of[from + all];
        size_t more = alike(of, from + all, count);
        if (x->level != y->level || x->kind != y->kind ||
            x->arity != y->arity || x->function != y->function || more >= MANY)
            break;
        all += more;
    }
    return all;
}

typedef struct {
    scheduler *s;
    nevh__recurrence *r;
    item **order;
    size_t count, index, lanes[2], fill[2]; /* lanes: weighted, plain */
} writer;

static bool has_lane(int kind, bool weighted) {
    switch (kind) {
    case NEVH__BATCH_CALL:
        return weighted;
    case NEVH__BATCH_POWER:
        return true;
    case NEVH__BATCH_SUM:
        return false;
    default:
        return kind >= 0 && !weighted;
    }
}

/* Values of numbers and operations, and the sizes of all. */
static void number_values(writer *w) {
    nevh__recurrence *r = w->r;
    size_t at = 2 * r->n + 1;
    r->first_constant = at;
    for (size_t i = 0; i < w->s->count; i++)
        if (w->s->items[i].kind == NUMBER)
            w->s->items[i].value = (uint32_t)at++;
    r->n_constants = at - r->first_constant;
    r->n_numbers = r->n_constants + 2 * r->n;
    for (size_t i = 0; i < w->count; i++) {
        item *x = w->order[i];
        x->value = (uint32_t)at++;
        w->lanes[0] += has_lane(x->kind, true);
        w->lanes[1] += has_lane(x->kind, false);
        w->index += x->arity;
        r->n_numbers += x->arity;
    }
    r->values = at;
    r->weighted = nevh__padded(w->lanes[0]);
    r->lanes = r->weighted + nevh__padded(w->lanes[1]);
    w->fill[1] = r->weighted;
    r->used[0] = w->lanes[0];
    r->used[1] = w->lanes[1];
}

static bool allocate(writer *w) {
    nevh__recurrence *r = w->r;
    r->batches = nevh__array(w->count, sizeof *r->batches);
    r->index = nevh__array(w->index, sizeof *r->index);
    r->numbers = nevh__array(r->n_numbers, sizeof *r->numbers);
    r->lane_a = nevh__array(2 * r->lanes, sizeof *r->lane_a);
    r->slope = nevh__array(2 * r->n, sizeof *r->slope);
    r->lane_b = r->lane_a ? r->lane_a + r->lanes : NULL;
    return r->batches && r->index && r->numbers && r->lane_a && r->slope;
}

static uint32_t value_of(const writer *w, int at) {
    return w->s->items[at].value;
}

static uint32_t lanes_for(writer *w, size_t from, size_t count, bool weighted) {
    size_t first = w->fill[!weighted];
    w->fill[!weighted] += count;
    for (size_t i = 0; i < count; i++) {
        const item *x = w->order[from + i];
        uint32_t a = value_of(w, x->operand[0]), b = x->value;
        if (x->kind == NEVH__BATCH_MULTIPLY)
            b = value_of(w, x->operand[1]);
        if (x->kind == NEVH__BATCH_CALL)
            b = value_of(w, x->slope);
        w->r->lane_a[first + i] = x->kind == NEVH__BATCH_ROOT ? b : a;
        w->r->lane_b[first + i] = b;
    }
    return (uint32_t)first;
}

static void write_operand(writer *w, nevh__batch *b, size_t from, int which) {
    uint32_t first = value_of(w, w->order[from]->operand[which]);
    uint32_t *to = w->r->index + w->index;
    b->together[which] = true;
    for (size_t i = 0; i < b->count; i++) {
        to[i] = value_of(w, w->order[from + i]->operand[which]);
        if (to[i] != first + i)
            b->together[which] = false;
    }
    b->operand[which] = b->together[which] ? first : (uint32_t)w->index;
    w->index += b->together[which] ? 0 : b->count;
}

static void write_batch(writer *w, size_t from, size_t count) {
    nevh__recurrence *r = w->r;
    const item *x = w->order[from];
    nevh__batch *b = &r->batches[r->n_batches++];
    *b = (nevh__batch){.kind = (uint8_t)x->kind,
                       .arity = x->arity,
                       .function = x->function,
                       .count = (uint32_t)count,
                       .first = x->value,
                       .number = (uint32_t)r->n_numbers};
    if (has_lane(x->kind, true))
        b->lane = lanes_for(w, from, count, true);
    if (has_lane(x->kind, false))
        *(x->kind == NEVH__BATCH_POWER ? &b->also : &b->lane) =
            lanes_for(w, from, count, false);
    for (int k = 0; k < x->arity; k++)
        write_operand(w, b, from, k);
    size_t numbers = x->kind == NEVH__BATCH_SUM ? x->arity : 1;
    for (size_t k = 0; k < numbers; k++)
        for (size_t i = 0; i < count; i++)
            r->numbers[r->n_numbers++] = w->order[from + i]->number[k];
    if (count > r->widest)
        r->widest = count;
}

static void write_slopes(writer *w, const int slope[]) {
    nevh__recurrence *r = w->r;
    r->slope_number = r->n_numbers;
    for (size_t k = 0; k < 2 * r->n; k++) {
        nevh__wide factor = 1;
        int node = peel(w->s->g, slope[k], &factor);
        r->slope[k] = value_of(w, w->s->item_of[node]);
        r->numbers[r->n_numbers++] = factor;
    }
}

static bool write(writer *w, const int slope[]) {
    scheduler *s = w->s;
    w->order = nevh__array(s->count, sizeof *w->order);
    if (!w->order)
        return false;
    for (size_t i = 0; i < s->count; i++)
        if (s->items[i].kind >= 0)
            w->order[w->count++] = &s->items[i];
    qsort(w->order, w->count, sizeof *w->order, compare);
    number_values(w);
    if (!allocate(w))
        return false;
    w->index = 0;
    w->r->n_numbers = 0;
    for (size_t i = 0; i < s->count; i++)
        if (s->items[i].kind == NUMBER)
            w->r->numbers[w->r->n_numbers++] = s->items[i].number[0];
    for (size_t from = 0; from < w->count;) {
        size_t count = batch_size(w->order, from, w->count);
        write_batch(w, from, count);
        from += count;
    }
    write_slopes(w, slope);
    return true;
}

static bool schedule(nevh__recurrence *r, const nevh__graph *g,
                     const int slope[]) {
    size_t nodes = (size_t)g->used;
    scheduler s = {.g = g, .n = r->n};
    writer w = {.s = &s, .r = r};
    s.uses = nevh__array(nodes, sizeof *s.uses);
    s.apart = nevh__array(nodes, sizeof *s.apart);
    s.item_of = nevh__array(nodes, sizeof *s.item_of);
    s.failed = !s.uses || !s.apart || !s.item_of;
    if (!s.failed)
        count_uses(&s, slope);
    if (!s.failed)
        make_items(&s);
    bool fine = !s.failed && write(&w, slope);
    free(s.uses);
    free(s.apart);
    free(s.item_of);
    free(s.items);
    free(s.sum);
    free(s.stack);
    free(s.factors);
    free(w.order);
    return fine;
}

nevh__recurrence *nevh__recurrence_wide(const nevh_system *system,
                                        const nevh__wide friction[],
                                        nevh__report *report) {
    nevh__graph g = {0};
    nevh__recurrence *r = nevh__array(1, sizeof *r);
    int *slope = nevh__array(2 * system->n, sizeof *slope);
    int status = NEVH_ENOMEM;
    if (r && slope) {
        r->n = system->n;
        status = nevh__graph_of_system(&g, system, friction, slope, report);
    }
    if (!status && !schedule(r, &g, slope))
        status = NEVH_ENOMEM;
    if (status == NEVH_ENOMEM)
        nevh__fail(report, NEVH_ENOMEM, "out of memory");
    nevh__graph_clear(&g);
    free(slope);
    if (!status)
        return r;
    nevh__recurrence_free(r);
    return NULL;
}

nevh__recurrence *nevh__recurrence_new(const nevh_system *system,
                                       const double friction[],
                                       nevh__report *report) {
    if (!friction)
        return nevh__recurrence_wide(system, NULL, report);
    nevh__wide *rates = nevh__array(system->n, sizeof *rates);
    for (size_t k = 0; rates && k < system->n; k++)
        rates[k] = friction[k];
    nevh__recurrence *r =
        rates ? nevh__recurrence_wide(system, rates, report) : NULL;
    if (!rates)
        nevh__fail(report, NEVH_ENOMEM, "out of memory");
    free(rates);
    return r;
}

void nevh__recurrence_free(nevh__recurrence *r) {
    if (!r)
        return;
    free(r->batches);
    free(r->index);
    free(r->numbers);
    free(r->lane_a);
    free(r->slope);
    free(r);
}
