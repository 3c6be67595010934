/* nevh: steps by parts, H = A + B: flows of A and kicks of B = V(t, q) in turn.

   Increments are summed from zero over the step and added to the state once, with
   compensation.  The time of a kick is that of the flows before it.  Where a step
   begins with a kick it ends with one, whose slope is kept for the next step.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "form_flow_private.h"
#include "splitting_private.h"
#include "work/work_private.h"
#include <stdlib.h>
#include <string.h>

enum { FEW_SUBSTEPS = 8, MOST_SUBSTEPS = 10000 };

/* Kicks of B, of inner terms, flows. */
typedef enum { OUTER, INNER, FLOW } operation_kind;
enum { KICKS = FLOW };

typedef struct {
    double weight, time;
    operation_kind kind;
    size_t which; /* the part of a step that a flow takes */
} operation;

typedef struct {
    size_t count;
    operation *operations;
    nevh__form_flow *flow;
    size_t kept; /* slopes that the next step begins with */
} parts_plan;

/* Rows of the scratch. */
typedef struct {
    double *dq, *dp, *q, *p, *slope[KICKS], *time;
} rows;

static rows lay_out(const nevh_work *w) {
    double *from = w->scratch;
    rows r;
    r.dq = nevh__take(&from, w->size);
    r.dp = nevh__take(&from, w->size);
    r.q = nevh__take(&from, w->size);
    r.p = nevh__take(&from, w->size);
    r.slope[OUTER] = nevh__take(&from, w->size);
    r.slope[INNER] = nevh__take(&from, w->size);
    r.time = from;
    return r;
}

static void clear(nevh_work *w) {
    parts_plan *o = w->plan;
    if (!o)
        return;
    nevh__form_flow_free(o->flow);
    free(o->operations);
    free(o);
    w->plan = NULL;
}

/* One of the same kind as the last is part of it. */
static void add(parts_plan *o, operation_kind kind, double weight) {
    operation *last = &o->operations[o->count];
    if (o->count && last[-1].kind == kind)
        last[-1].weight += weight;
    else {
        *last = (operation){.weight = weight, .kind = kind};
        o->count++;
    }
}

/* Times of kicks; flows over equal parts of the step share their matrices.  Returns
   how many of these there are, the first of `distinct`. */
static size_t find_flows(parts_plan *o, double distinct[]) {
    size_t found = 0;
    double passed = 0;
    for (operation *x = o->operations; x < o->operations + o->count; x++) {
        x->time = passed;
        if (x->kind != FLOW)
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
    parts_plan *o = w->plan;
    bool kicks = table->first == NEVH_KICK;
    double parts = (double)substeps;
    size_t count = nevh__splitting_operations(table);
    nevh__splitting_expand(table, weights);
    for (size_t i = 0; i < count; i++, kicks = !kicks) {
        if (kicks || !substeps)
            add(o, kicks ? OUTER : FLOW, weights[i]);
        for (size_t k = 0; !kicks && k < substeps; k++) {
            add(o, INNER, weights[i] / (2 * parts));
            add(o, FLOW, weights[i] / parts);
            add(o, INNER, weights[i] / (2 * parts));
        }
    }
    o->kept = table->first == NEVH_DRIFT ? 0 : substeps ? KICKS : 1;
    o->flow = nevh__form_flow_new(w, find_flows(o, weights), weights);
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
    parts_plan *o = w->plan = nevh__array(1, sizeof *o);
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
    w->scratch_size = (4 + KICKS) * w->size + w->width;
    return NEVH_OK;
}

/* The state in the midst of a step. */
static void place(const nevh_work *w, const rows *r, const double q[],
                  const double p[]) {
    const double *rest = w->memory;
    for (size_t i = 0; i < w->size; i++) {
        r->q[i] = q[i] + (r->dq[i] + rest[i]);
        r->p[i] = p[i] + (r->dp[i] + rest[w->size + i]);
    }
}

/* Slopes that are kept, and which lanes have them. */
static double *kept_slopes(const nevh_work *w, size_t which) {
    return w->memory + (2 + which) * w->size;
}

/* Lanes that start afresh take their first slopes, and others keep theirs: at t + h
   of the step before, which rounds otherwise than t. */
static int take_slope(nevh_work *w, const rows *r, operation_kind kind,
                      bool first) {
    const parts_plan *o = w->plan;
    const double *has = first ? kept_slopes(w, o->kept) : NULL;
    double *slope = r->slope[kind];
    int status = NEVH_OK;
    bool all = first;
    for (size_t lane = 0; all && lane < w->width; lane++)
        all = has[lane] != 0;
    if (!all && kind == OUTER)
        status =
            nevh_work_gradient(w, w->width, r->time, r->q, r->p, slope, NULL);
    else if (!all)
        status = nevh__work_inner_gradient(
            w, &(nevh__places){w->width, r->time, r->q, r->p, slope, NULL});
    for (size_t i = 0; !status && first && i < w->size; i++)
        if (has[i % w->width] != 0)
            slope[i] = kept_slopes(w, kind)[i];
    return status;
}

/* first: of its kind at the beginning of a step that keeps slopes. */
static int operate(nevh_work *w, const rows *r, const operation *x, bool first,
                   double t, double h) {
    const parts_plan *o = w->plan;
    double weight = x->weight * h;
    int status = NEVH_OK;
    for (size_t lane = 0; lane < w->width; lane++)
        r->time[lane] = t + x->time * h;
    if (w->accounts && x->kind != INNER) /* these read no time */
        status = nevh_work_account(w, x->kind == FLOW ? NEVH_OF_P : NEVH_OF_Q,
                                   weight, r->time, r->q, r->p);
    if (status)
        return status;
    if (x->kind == FLOW) {
        nevh__form_flow_add(o->flow, x->which, w->width, r->q, r->p, r->dq,
                            r->dp);
        return NEVH_OK;
    }
    status = take_slope(w, r, x->kind, first);
    for (size_t i = 0; i < w->size; i++)
        r->dp[i] -= weight * r->slope[x->kind][i];
    return status;
}

static void keep_slopes(nevh_work *w, const rows *r) {
    const parts_plan *o = w->plan;
    for (size_t i = 0; i < o->kept; i++)
        memcpy(kept_slopes(w, i), r->slope[i], w->size * sizeof(double));
    for (size_t lane = 0; o->kept && lane < w->width; lane++)
        kept_slopes(w, o->kept)[lane] = 1;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const parts_plan *o = w->plan;
    rows r = lay_out(w);
    int status = NEVH_OK;
    nevh__form_flow_set(o->flow, h);
    for (size_t i = 0; i < w->size; i++)
        r.dq[i] = r.dp[i] = 0;
    for (size_t i = 0; !status && i < o->count; i++) {
        place(w, &r, q, p);
        status = operate(w, &r, &o->operations[i], i < o->kept, t, h);
    }
    if (!status)
        status = nevh_work_commit(w, w->size, q, r.dq, w->memory, p, r.dp,
                                  w->memory + w->size);
    if (!status)
        keep_slopes(w, &r);
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
