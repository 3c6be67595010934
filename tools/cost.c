/* nevh cost: what a digit costs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const double cost_target[COST_TARGETS] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

/* Every scheme that fits, and the gradient that costs least, unless asked for
   others. */
void plan_search(plan *p, const options *o) {
    if (o->gradients.count == 0) {
        list_free(&p->gradients);
        list_add(&p->gradients,
                 gradient_fits(p, "exact", NULL) ? "exact" : "central4");
    }
    if (o->integrators.count == 0) {
        list_free(&p->integrators);
        fitting_integrators(p, p->gradients.item[0], &p->integrators);
    }
}

static void descend_all(costs *c) {
    static const double share = 0.6; /* the rest is for targets */
    ladder *next;
    for (size_t i = 0; i < c->count; i++)
        ladder_begin(&c->search, &c->ladder[i]);
    while ((next = ladder_next(c->ladder, c->count)) &&
           !search_is_over(&c->search, share))
        ladder_descend(&c->search, next);
    for (size_t i = 0; i < c->count; i++)
        if (c->ladder[i].end == LADDER_OPEN)
            c->ladder[i].end = LADDER_LIMIT;
}

static void run_ladders(costs *c) {
    enum { RUNGS = 8 };
    descend_all(c);
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < COST_TARGETS; k++)
            ladder_refine(&c->search, &c->ladder[i], cost_target[k]);
    for (size_t i = 0; i < c->count; i++)
        ladder_fill(&c->search, &c->ladder[i], RUNGS);
}

static void make_ladders(costs *c) {
    const plan *p = c->search.plan;
    c->ladder = tool_allocate(p->gradients.count * p->integrators.count,
                              sizeof *c->ladder);
    for (size_t g = 0; g < p->gradients.count; g++)
        for (size_t i = 0; i < p->integrators.count; i++)
            c->ladder[c->count++] =
                ladder_new(p->integrators.item[i], p->gradients.item[g]);
}

bool costs_count(const costs *c, const ladder *l) {
    return !l->count || c->search.by_state || !ladder_keeps_energy(l);
}

const ladder *costs_cheapest(const costs *c, size_t target) {
    const ladder *best = NULL;
    double least = INFINITY;
    for (size_t i = 0; i < c->count; i++) {
        const ladder *l = &c->ladder[i];
        const row *r =
            ladder_cheapest(l, cost_target[target], c->search.by_state);
        if (costs_count(c, l) && r && r->seconds < least)
            least = r->seconds, best = l;
    }
    return best;
}

/* Rows side by side, in the order of the ladders. */
static row *all_rows(const costs *c, size_t *count) {
    *count = 0;
    for (size_t i = 0; i < c->count; i++)
        *count += c->ladder[i].count;
    row *rows = tool_allocate(*count, sizeof *rows);
    for (size_t i = 0, at = 0; i < c->count; at += c->ladder[i++].count)
        memcpy(rows + at, c->ladder[i].rung, c->ladder[i].count * sizeof *rows);
    return rows;
}

static page make_page(const options *o, costs *c) {
    page result = {0};
    bool is_table = o->format == FORMAT_TABLE;
    size_t count;
    row *rows = all_rows(c, &count);
    observe_orders(rows, count);
    result.table =
        is_table ? cost_table(c) : records(c->search.plan, rows, count);
    if (!is_table || !o->quiet) {
        plan_notes(c->search.plan, &result.before);
        row_notes(o, c->search.plan, rows, count, &result.before);
        cost_notes(c, &result.before);
        cost_words(c, &result.after);
    }
    free(rows);
    return result;
}

static int status_of(const costs *c) {
    bool ran = false, failed = false;
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < c->ladder[i].count; k++) {
            ran |= c->ladder[i].rung[k].ran;
            failed |= c->ladder[i].rung[k].failed;
        }
    return failed && (!ran || c->search.dt) ? TOOL_FAILED : TOOL_OK;
}

static int cost_plan(const options *o, plan *p) {
    static const double budget = 20; /* seconds */
    output out;
    if (output_open(&out, o->file))
        return TOOL_USAGE;
    costs c = {.search = search_begin(p, o, budget),
               .all = o->integrators.count > 0};
    make_ladders(&c);
    run_ladders(&c);
    page result = make_page(o, &c);
    search_end(&c.search);
    page_print(&result, o->format, out.stream);
    page_free(&result);
    int status = status_of(&c);
    for (size_t i = 0; i < c.count; i++)
        ladder_free(&c.ladder[i]);
    free(c.ladder);
    return output_close(&out, status);
}

int cost(const options *o) {
    plan p;
    int status = plan_make(&p, o);
    if (!status) {
        plan_search(&p, o);
        status = cost_plan(o, &p);
    }
    plan_free(&p);
    return status;
}
