/* nevh: the kernel of steps by parts.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "form_flow_private.h"
#include "hierarchy_private.h"
#include "parts_step.h"
#include "splitting_private.h"
#include "turn_private.h"
#include "work/work_private.h"
#include <stdlib.h>
#include <string.h>

enum { FEW_SUBSTEPS = 8, MOST_SUBSTEPS = 10000 };

static void clear(nevh_work *w) {
    nevh__parts_scheme *o = w->plan;
    if (!o)
        return;
    nevh__form_flow_free(o->flow);
    nevh__turns_free(o->turns);
    free(o->operations);
    free(o);
    w->plan = NULL;
}

/* One of the same kind as the last is part of it. */
static void add(nevh__parts_scheme *o, nevh__part_kind kind, double weight) {
    nevh__part_operation *last = &o->operations[o->count];
    if (o->count && last[-1].kind == kind)
        last[-1].weight += weight;
    else {
        *last = (nevh__part_operation){.weight = weight, .kind = kind};
        o->count++;
    }
}

/* Times of kicks; flows over equal parts of the step share their matrices.  Returns
   how many of these there are, the first of `distinct`. */
static size_t find_flows(nevh__parts_scheme *o, double distinct[]) {
    size_t found = 0;
    double passed = 0;
    for (nevh__part_operation *x = o->operations; x < o->operations + o->count;
         x++) {
        x->time = passed;
        if (x->kind != NEVH__FLOW)
            continue;
        while (x->which < found && distinct[x->which] != x->weight)
            x->which++;
        distinct[x->which] = x->weight;
        found += x->which == found;
        passed += x->weight;
    }
    return found;
}

/* weights: of the table, and room for those of all flows. */
static int plan_operations(nevh_work *w, size_t substeps, double weights[]) {
    const nevh_splitting *table = w->integrator->table;
    nevh__parts_scheme *o = w->plan;
    bool kicks = table->first == NEVH_KICK;
    double parts = (double)substeps;
    size_t count = nevh__splitting_operations(table);
    nevh__splitting_expand(table, weights);
    for (size_t i = 0; i < count; i++, kicks = !kicks) {
        if (kicks || !substeps)
            add(o, kicks ? NEVH__OUTER_KICK : NEVH__FLOW, weights[i]);
        for (size_t k = 0; !kicks && k < substeps; k++) {
            add(o, NEVH__INNER_KICK, weights[i] / (2 * parts));
            add(o, NEVH__FLOW, weights[i] / parts);
            add(o, NEVH__INNER_KICK, weights[i] / (2 * parts));
        }
    }
    if (nevh__turns_new(w->field, &o->turns))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    o->turn = o->turns ? nevh__turns_add : NULL;
    /* friction would change slopes of terms that read momenta */
    o->kept = table->first == NEVH_DRIFT || o->turn ? 0
              : substeps                            ? NEVH__KICKS
                                                    : 1;
    o->set = nevh__form_flow_set;
    o->add = nevh__form_flow_add;
    o->flow = nevh__form_flow_new(w, find_flows(o, weights), weights);
    if (o->flow && nevh__form_flow_bodies(o->flow))
        o->lessen = nevh__form_flow_lessen;
    return o->flow ? NEVH_OK : w->report->status;
}

/* 0: there are no inner terms. */
static size_t substeps_of(const nevh_work *w) {
    size_t given = w->options->substeps;
    for (size_t i = 0; i < w->field->n_terms; i++)
        if (w->field->terms[i].part == NEVH__INNER)
            return given ? given : FEW_SUBSTEPS;
    return 0;
}

static int plan(nevh_work *w) {
    nevh__parts_scheme *o = w->plan = nevh__array(1, sizeof *o);
    size_t substeps = substeps_of(w);
    if (substeps > MOST_SUBSTEPS)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "%zu substeps, where at most %d are possible",
                              substeps, MOST_SUBSTEPS);
    size_t count = nevh__splitting_operations(w->integrator->table);
    size_t most = count * (2 * substeps + 1);
    double *weights = nevh__array(most, sizeof *weights);
    if (o)
        o->operations = nevh__array(most, sizeof *o->operations);
    int status = o && o->operations && weights
                     ? plan_operations(w, substeps, weights)
                     : nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    free(weights);
    if (status)
        return status;
    w->memory_rows = (2 + o->kept) * w->n + (o->kept > 0);
    w->scratch_size = (5 + NEVH__KICKS) * w->size + w->width;
    return NEVH_OK;
}

const nevh__form_flow *nevh__parts_flow_of(const nevh_work *w) {
    const nevh__parts_scheme *o = w->plan;
    return o && w->integrator->needs & NEVH_PARTS ? o->flow : NULL;
}

const nevh__hierarchy *nevh__parts_hierarchy(const nevh_work *w) {
    const nevh__form_flow *flow = nevh__parts_flow_of(w);
    return flow ? nevh__form_flow_bodies(flow) : NULL;
}

/* The includer's data of a step. */
struct nevh__parts_owner {
    nevh_work *work;
    double *time; /* a row */
};

/* Slopes that are kept, and which lanes have them. */
static double *kept_slopes(const nevh_work *w, size_t which) {
    return w->memory + (2 + which) * w->size;
}

static int set_time(const nevh__parts_step *x, const nevh__part_operation *o,
                    double t) {
    nevh_work *w = x->owner->work;
    for (size_t lane = 0; lane < w->width; lane++)
        x->owner->time[lane] = t;
    if (!w->accounts || o->kind == NEVH__INNER_KICK) /* these read no time */
        return NEVH_OK;
    return nevh_work_account(w, o->kind == NEVH__FLOW ? NEVH_OF_P : NEVH_OF_Q,
                             o->weight * x->h, x->owner->time, x->point[0],
                             x->point[1]);
}

NEVH__INLINE int nevh__parts_flow(const nevh__parts_step *x,
                                  const nevh__part_operation *o, double t) {
    int status = set_time(x, o, t);
    if (!status)
        x->scheme->add(x->scheme->flow, o->which, x->owner->work->width,
                       x->point[0], x->point[1], x->change[0], x->change[1]);
    return status;
}

/* Lanes that start afresh take their first slopes, and others keep theirs: at t + h
   of the step before, which rounds otherwise than t. */
NEVH__INLINE int nevh__parts_slope(const nevh__parts_step *x, size_t size,
                                   const nevh__part_operation *o, double t,
                                   bool first) {
    nevh_work *w = x->owner->work;
    const double *has = first ? kept_slopes(w, x->scheme->kept) : NULL;
    double *slope = x->slope[o->kind], *time = x->owner->time;
    bool outer = o->kind == NEVH__OUTER_KICK;
    const nevh__places at = {w->width,    time,  x->point[0],
                             x->point[1], slope, outer ? x->turn : NULL};
    int status = set_time(x, o, t);
    bool all = first;
    for (size_t lane = 0; all && lane < w->width; lane++)
        all = has[lane] != 0;
    if (!status && !all)
        status = outer ? nevh__work_gradient_padded(w, w->width, &at)
                       : nevh__work_inner_gradient(w, &at);
    if (!status && !all && outer && x->scheme->lessen)
        x->scheme->lessen(x->scheme->flow, w->width, x->point[0], slope);
    for (size_t i = 0; !status && first && i < size; i++)
        if (has[i % w->width] != 0)
            slope[i] = kept_slopes(w, o->kind)[i];
    return status;
}

NEVH__INLINE void nevh__parts_turn(const nevh__parts_step *x, double weight) {
    x->scheme->turn(x->scheme->turns, x->owner->work->width, weight,
                    x->point[0], x->point[1], x->slope[NEVH__OUTER_KICK],
                    x->turn, x->change[0], x->change[1]);
}

static void keep_slopes(nevh_work *w, const nevh__parts_step *x) {
    size_t kept = x->scheme->kept;
    for (size_t i = 0; i < kept; i++)
        memcpy(kept_slopes(w, i), x->slope[i], w->size * sizeof(double));
    for (size_t lane = 0; kept && lane < w->width; lane++)
        kept_slopes(w, kept)[lane] = 1;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    double *row = w->scratch, *lost = w->memory;
    nevh__parts_step x = {.scheme = w->plan,
                          .t = t,
                          .h = h,
                          .state = {q, p},
                          .lost = {lost, lost + w->size}};
    for (int i = 0; i < 2; i++) {
        x.change[i] = nevh__take(&row, w->size);
        x.point[i] = nevh__take(&row, w->size);
        x.slope[i] = nevh__take(&row, w->size);
    }
    x.turn = x.scheme->turn ? nevh__take(&row, w->size) : NULL;
    const struct nevh__parts_owner owner = {w, row};
    x.owner = &owner;
    int status = nevh__parts_take(&x, w->size);
    if (!status)
        status = nevh_work_commit(w, w->size, q, x.change[0], lost, p,
                                  x.change[1], lost + w->size);
    if (!status)
        keep_slopes(w, &x);
    return status;
}

static void apply_friction(nevh_work *w, const double factor[]) {
    for (size_t i = 0; i < w->size; i++)
        w->memory[w->size + i] *= factor[i / w->width];
}

const nevh_kernel nevh__parts_kernel = {.plan = plan,
                                        .step = step,
                                        .clear = clear,
                                        .apply_friction = apply_friction};
const nevh_kernel nevh__substeps_kernel = {.plan = plan,
                                           .step = step,
                                           .clear = clear,
                                           .apply_friction = apply_friction,
                                           .has_substeps = true};
