/* nevh: the order in which recurrences run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/schedule_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int schedule_compare(const void *a, const void *b) {
    const nevh__work_item *x = *(const nevh__work_item *const *)a,
                          *y = *(const nevh__work_item *const *)b;
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

static size_t schedule_alike(nevh__work_item *const *of, size_t from,
                             size_t count) {
    size_t i = from + 1;
    while (i < count && of[i]->level == of[from]->level &&
           of[i]->kind == of[from]->kind && of[i]->arity == of[from]->arity &&
           of[i]->function == of[from]->function && of[i]->tag == of[from]->tag)
        i++;
    return i - from;
}

static size_t batch_size(nevh__work_item *const *of, size_t from,
                         size_t count) {
    size_t all = schedule_alike(of, from, count);
    while (all < MANY && from + all < count) {
        const nevh__work_item *x = of[from], *y = of[from + all];
        size_t more = schedule_alike(of, from + all, count);
        if (x->level != y->level || x->kind != y->kind ||
            x->arity != y->arity || x->function != y->function || more >= MANY)
            break;
        all += more;
    }
    return all;
}

typedef struct {
    nevh__scheduler *s;
    nevh__recurrence *r;
    nevh__work_item **order;
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
        if (w->s->items[i].kind == NEVH__ITEM_NUMBER)
            w->s->items[i].value = (uint32_t)at++;
    r->n_constants = at - r->first_constant;
    r->n_numbers = r->n_constants + 2 * r->n;
    for (size_t i = 0; i < w->count; i++) {
        nevh__work_item *x = w->order[i];
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

static bool schedule_allocate(writer *w) {
    nevh__recurrence *r = w->r;
    r->batches = nevh__array(w->count, sizeof *r->batches);
    r->index = nevh__array(w->index, sizeof *r->index);
    r->numbers = nevh__array(r->n_numbers, sizeof *r->numbers);
    r->lane_a = nevh__array(2 * r->lanes, sizeof *r->lane_a);
    r->slope = nevh__array(2 * r->n, sizeof *r->slope);
    r->lane_b = r->lane_a ? r->lane_a + r->lanes : NULL;
    return r->batches && r->index && r->numbers && r->lane_a && r->slope;
}

static uint32_t schedule_value_of(const writer *w, int at) {
    return w->s->items[at].value;
}

static uint32_t lanes_for(writer *w, size_t from, size_t count, bool weighted) {
    size_t first = w->fill[!weighted];
    w->fill[!weighted] += count;
    for (size_t i = 0; i < count; i++) {
        const nevh__work_item *x = w->order[from + i];
        uint32_t a = schedule_value_of(w, x->operand[0]), b = x->value;
        if (x->kind == NEVH__BATCH_MULTIPLY)
            b = schedule_value_of(w, x->operand[1]);
        if (x->kind == NEVH__BATCH_CALL)
            b = schedule_value_of(w, x->slope);
        w->r->lane_a[first + i] = x->kind == NEVH__BATCH_ROOT ? b : a;
        w->r->lane_b[first + i] = b;
    }
    return (uint32_t)first;
}

static void write_operand(writer *w, nevh__batch *b, size_t from, int which) {
    uint32_t first = schedule_value_of(w, w->order[from]->operand[which]);
    uint32_t *to = w->r->index + w->index;
    b->together[which] = true;
    for (size_t i = 0; i < b->count; i++) {
        to[i] = schedule_value_of(w, w->order[from + i]->operand[which]);
        if (to[i] != first + i)
            b->together[which] = false;
    }
    b->operand[which] = b->together[which] ? first : (uint32_t)w->index;
    w->index += b->together[which] ? 0 : b->count;
}

static void write_batch(writer *w, size_t from, size_t count) {
    nevh__recurrence *r = w->r;
    const nevh__work_item *x = w->order[from];
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
        int node = nevh__schedule_peel(w->s->g, slope[k], &factor);
        r->slope[k] = schedule_value_of(w, w->s->item_of[node]);
        r->numbers[r->n_numbers++] = factor;
    }
}

/* Marks the nodes of which roots and powers are left that are no whole ones. */
static bool *mark_roots(const nevh__scheduler *s) {
    bool *root = nevh__array((size_t)s->g->used, sizeof *root);
    for (int i = 0; root && i < s->g->used; i++) {
        const nevh__graph_node *x = &s->g->nodes[i];
        double c = (double)x->number;
        if (s->uses[i] && x->kind == NEVH__GRAPH_POWER && c != rint(c))
            root[x->a] = true;
    }
    return root;
}

static bool write_edges(writer *w) {
    const nevh__graph *g = w->s->g;
    nevh__recurrence *r = w->r;
    bool *root = mark_roots(w->s);
    r->edges = nevh__array(g->n_edges, sizeof *r->edges);
    r->watched = nevh__array(2 * g->n_edges, sizeof *r->watched);
    bool made = root && r->edges && r->watched;
    size_t n = r->n_watched = r->n_edges = made ? g->n_edges : 0;
    for (size_t i = 0; i < n; i++) {
        const nevh__graph_edge *e = &g->edges[i];
        r->watched[i] = schedule_value_of(w, w->s->item_of[e->node]);
        r->edges[i] = (nevh__edge){.strict = e->strict || root[e->node],
                                   .steep = e->steep,
                                   .function = e->function,
                                   .exponent = e->exponent,
                                   .effect = e->effect};
        if (e->also < 0)
            continue;
        r->edges[i].also = (uint32_t)r->n_watched;
        r->watched[r->n_watched++] =
            schedule_value_of(w, w->s->item_of[e->also]);
    }
    free(root);
    return made;
}

static bool schedule_write(writer *w, const int slope[]) {
    nevh__scheduler *s = w->s;
    w->order = nevh__array(s->count, sizeof *w->order);
    if (!w->order)
        return false;
    for (size_t i = 0; i < s->count; i++)
        if (s->items[i].kind >= 0)
            w->order[w->count++] = &s->items[i];
    qsort(w->order, w->count, sizeof *w->order, schedule_compare);
    number_values(w);
    if (!schedule_allocate(w))
        return false;
    w->index = 0;
    w->r->n_numbers = 0;
    for (size_t i = 0; i < s->count; i++)
        if (s->items[i].kind == NEVH__ITEM_NUMBER)
            w->r->numbers[w->r->n_numbers++] = s->items[i].number[0];
    for (size_t from = 0; from < w->count;) {
        size_t count = batch_size(w->order, from, w->count);
        write_batch(w, from, count);
        from += count;
    }
    write_slopes(w, slope);
    return write_edges(w);
}

static bool schedule(nevh__recurrence *r, const nevh__graph *g,
                     const int slope[]) {
    nevh__scheduler s = {.g = g, .n = r->n};
    writer w = {.s = &s, .r = r};
    nevh__schedule_items(&s, slope);
    bool fine = !s.failed && schedule_write(&w, slope);
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

static nevh__recurrence *schedule_made(const nevh_system *system,
                                       const nevh__wide friction[], bool broken,
                                       bool exact, nevh__report *report) {
    nevh__graph g = {.exact = exact};
    nevh__recurrence *r = nevh__array(1, sizeof *r);
    int *slope = nevh__array(2 * system->n, sizeof *slope);
    int status = NEVH_ENOMEM;
    if (r && slope) {
        r->n = system->n;
        status =
            nevh__graph_of_system(&g, system, friction, broken, slope, report);
    }
    if (!status && !schedule(r, &g, slope))
        status = NEVH_ENOMEM;
    if (status == NEVH_ENOMEM)
        nevh__no_memory(report);
    nevh__graph_clear(&g);
    free(slope);
    if (!status)
        return r;
    nevh__recurrence_free(r);
    return NULL;
}

nevh__recurrence *nevh__recurrence_wide(const nevh_system *system,
                                        const nevh__wide friction[],
                                        nevh__report *report) {
    return schedule_made(system, friction, false, true, report);
}

nevh__recurrence *nevh__recurrence_new(const nevh_system *system,
                                       const double friction[], bool broken,
                                       nevh__report *report) {
    if (!friction)
        return schedule_made(system, NULL, broken, false, report);
    nevh__wide *rates = nevh__array(system->n, sizeof *rates);
    for (size_t k = 0; rates && k < system->n; k++)
        rates[k] = friction[k];
    nevh__recurrence *r =
        rates ? schedule_made(system, rates, broken, false, report) : NULL;
    if (!rates)
        nevh__no_memory(report);
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
    free(r->edges);
    free(r->watched);
    free(r);
}
