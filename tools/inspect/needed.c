/* nevh effects --needed: the fewest effects that keep an observable.

   Sets are runs.  A run without each effect says how the observable changes along
   the orbit; the sum of these over a set predicts what the set changes.  Changes that are
   large do not add up: pairs that cancel are found by runs without both.  Sets are run
   from the fewest effects on, the best predicted first, except for those that are
   predicted to miss the error by far.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "impact_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 500, MOST = 16 }; /* effects that can be switched */
static const double by_far = 30;
static const double hardly = 1e-6; /* of its size: no range to speak of */

/* Effects that change little together, and what they do. */
typedef struct {
    unsigned off;
    double *change;
} pair;

/* Sets are bits of effects that are off. */
typedef struct {
    plan *plan;
    const char *integrator;
    size_t count, kept, runs;
    char *effect[MOST];
    bool essential[MOST]; /* without it there is no such run */
    double *whole, *part; /* the observable, of all effects and of some */
    double *change[MOST];
    double scale, alone[MOST], error;
    pair pairs[MOST / 2];
    size_t n_pairs;
} search;

/* Returns whether the run with a set switched off has all its values. */
static bool run_without(search *x, unsigned off, double to[]) {
    plan *p = x->plan;
    bool fine = true;
    for (size_t i = 0; i < x->count && fine; i++)
        fine = impact_switch(p, x->effect[i], !(off >> i & 1));
    x->runs++;
    if (!fine)
        return false;
    trace o = trace_sampled(p, x->integrator, SAMPLES);
    fine = !o.status && o.kept > 0 && (!x->kept || o.kept == x->kept);
    for (size_t i = 0; fine && i < o.kept; i++) {
        const double *q = o.states + 2 * p->n * i;
        double t = p->run->t_start + (double)(i * o.every) * p->dt[0];
        fine = !nevh_scene_judged_value(p->scene, t, q, q + p->n, &to[i]) &&
               isfinite(to[i]);
    }
    x->kept = fine ? o.kept : x->kept;
    return fine;
}

static double largest(const search *x, const double change[]) {
    double most = 0;
    for (size_t k = 0; k < x->kept; k++)
        most = fmax(most, fabs(change[k]));
    return most / x->scale;
}

/* The change of the observable by a run. */
static double change_of(search *x, unsigned off, double change[]) {
    if (!run_without(x, off, x->part))
        return INFINITY;
    for (size_t k = 0; k < x->kept; k++)
        change[k] = x->part[k] - x->whole[k];
    return largest(x, change);
}

static int take_whole(search *x) {
    double low = INFINITY, high = -INFINITY;
    if (!run_without(x, 0, x->whole))
        return tool_refuse("%s: the run with all effects fails, or --needed "
                           "has no value in it",
                           x->plan->name),
               TOOL_FAILED;
    for (size_t k = 0; k < x->kept; k++) {
        low = fmin(low, x->whole[k]);
        high = fmax(high, x->whole[k]);
    }
    double size = fmax(fabs(low), fabs(high));
    x->scale = high - low > hardly * size ? high - low : size > 0 ? size : 1;
    return TOOL_OK;
}

static void take_each(search *x) {
    for (size_t i = 0; i < x->count; i++) {
        x->alone[i] = change_of(x, 1u << i, x->change[i]);
        x->essential[i] = !isfinite(x->alone[i]);
    }
}

/* True if both change the observable by much, and nearly as much or up to where one
   has no such run. */
static bool may_cancel(const search *x, size_t i, size_t j) {
    static const double alike = 2;
    double a = x->alone[i], b = x->alone[j];
    bool alone = x->essential[i] || x->essential[j];
    return fmin(a, b) > x->error && (alone || (a < alike * b && b < alike * a));
}

/* Each effect is of one pair at most. */
static void take_pairs(search *x) {
    static const double little = 0.25; /* of what each of them does alone */
    unsigned taken = 0;
    double *change = tool_allocate(SAMPLES, sizeof *change);
    for (size_t i = 0; i < x->count; i++)
        for (size_t j = 0; j < i; j++) {
            unsigned off = 1u << i | 1u << j;
            if (taken & off || !may_cancel(x, i, j) ||
                change_of(x, off, change) >
                    little * fmin(1, fmin(x->alone[i], x->alone[j])))
                continue;
            taken |= off;
            x->pairs[x->n_pairs++] = (pair){off, change};
            change = tool_allocate(SAMPLES, sizeof *change);
        }
}

/* The sum of changes by a set at a sample; pairs are known as such. */
static double sum_at(const search *x, unsigned off, size_t k) {
    double sum = 0;
    for (size_t i = 0; i < x->n_pairs; i++)
        if ((off & x->pairs[i].off) == x->pairs[i].off) {
            sum += x->pairs[i].change[k];
            off &= ~x->pairs[i].off;
        }
    for (size_t i = 0; i < x->count; i++)
        sum += off >> i & 1 ? x->change[i][k] : 0;
    return sum;
}

/* The change that is predicted of a set; infinite with an essential effect that is of no
   pair. */
static double predicted(const search *x, unsigned off) {
    double most = 0;
    unsigned single = off;
    for (size_t i = 0; i < x->n_pairs; i++)
        if ((off & x->pairs[i].off) == x->pairs[i].off)
            single &= ~x->pairs[i].off;
    for (size_t i = 0; i < x->count; i++)
        if (single >> i & 1 && x->essential[i])
            return INFINITY;
    for (size_t k = 0; k < x->kept; k++)
        most = fmax(most, fabs(sum_at(x, off, k)));
    return most / x->scale;
}

typedef struct {
    unsigned off;
    size_t size;
    double predicted;
} candidate;

static int compare(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    if (x->size != y->size)
        return x->size > y->size ? -1 : 1;
    return (x->predicted > y->predicted) - (x->predicted < y->predicted);
}

/* Returns the set that can be off. */
static unsigned choose(search *x) {
    unsigned sets = 1u << x->count, found = 0;
    candidate *all = tool_allocate(sets, sizeof *all);
    double *change = tool_allocate(SAMPLES, sizeof *change);
    double error = INFINITY;
    for (unsigned i = 0; i < sets; i++) {
        all[i] = (candidate){i, 0, predicted(x, i)};
        for (unsigned bit = i; bit; bit &= bit - 1)
            all[i].size++;
    }
    qsort(all, sets, sizeof *all, compare);
    for (unsigned i = 0; i < sets && !(error <= x->error); i++)
        if (all[i].predicted <= by_far * x->error) {
            found = all[i].off;
            error = found ? change_of(x, found, change) : 0;
        }
    x->error = error;
    return found;
}

static void show(const search *x, unsigned off, page *result) {
    list names = {0};
    table_titles(result->table, "effect,needed,change\nwithout it");
    for (size_t i = 0; i < x->count; i++) {
        bool needed = !(off >> i & 1);
        table_text(result->table, x->effect[i]);
        table_text(result->table, needed ? "yes" : "no");
        if (x->essential[i])
            table_text(result->table, NULL);
        else
            table_shown(result->table, "%.1e", x->alone[i]);
        if (needed)
            list_add(&names, x->effect[i]);
    }
    char *text = list_joined(&names);
    list_print(&result->after,
               "needed: %s.  A run with these alone changes %s by at most "
               "%.1e of its range, %.6g, until t = %.9g; %zu runs.",
               *text ? text : "none", x->plan->observable, x->error, x->scale,
               x->plan->t_end, x->runs);
}

static int find(const options *o, plan *p, search *x) {
    for (size_t i = 0; i < nevh_system_effect_count(p->system); i++) {
        const char *name = nevh_system_effect_name(p->system, i);
        if (!nevh_system_effect_on(p->system, name))
            continue;
        if (x->count == MOST)
            return tool_refuse("%s: more than %d effects are on", p->name,
                               MOST);
        x->change[x->count] = tool_allocate(SAMPLES, sizeof(double));
        x->effect[x->count++] = text_print("%s", name);
    }
    if (!plan_fits(p, &x->integrator))
        return TOOL_USAGE;
    if (nevh_scene_set_judged(p->scene, o->observable))
        return tool_refuse("%s: --needed %s", p->name,
                           nevh_scene_message(p->scene));
    p->observable = o->observable;
    int status = take_whole(x);
    if (!status)
        take_each(x);
    if (!status)
        take_pairs(x);
    return status;
}

int needed(const options *o, plan *p) {
    if (!(o->search.error > 0))
        return tool_refuse("--needed FORMULA needs --error X, a part of its "
                           "range");
    page result = {.table = table_new()};
    search x = {.plan = p,
                .whole = tool_allocate(SAMPLES, sizeof(double)),
                .part = tool_allocate(SAMPLES, sizeof(double)),
                .error = o->search.error};
    int status = find(o, p, &x);
    if (!status) {
        show(&x, choose(&x), &result);
        list_print(&result.before, "runs of %s, dt = %g", x.integrator,
                   p->dt[0]);
        status = output_page(o, &result, status);
    }
    for (size_t i = 0; i < x.count; i++)
        impact_switch(p, x.effect[i], true);
    return status;
}
