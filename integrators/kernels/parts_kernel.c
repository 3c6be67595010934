/* nevh: steps by parts, H = A + B: flows of A and kicks of B = V(t, q) in turn.

   Increments are summed from zero over the step and added to the state once, with
   compensation.  The time of a kick is that of the flows before it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "form_flow_private.h"
#include "splitting_private.h"
#include "system/system_private.h"
#include <stdlib.h>

typedef struct {
    size_t count;
    double *weights, *times; /* of flows and kicks in turn, from a flow on */
    size_t *which;           /* the part of a step that each flow takes */
    nevh__form_flow *flow;
} parts_plan;

/* Rows of the scratch. */
typedef struct {
    double *dq, *dp, *q, *p, *slope, *time;
} rows;

static rows lay_out(const nevh_work *w) {
    double *from = w->scratch;
    rows r;
    r.dq = nevh__take(&from, w->size);
    r.dp = nevh__take(&from, w->size);
    r.q = nevh__take(&from, w->size);
    r.p = nevh__take(&from, w->size);
    r.slope = nevh__take(&from, w->size);
    r.time = from;
    return r;
}

static void clear(nevh_work *w) {
    parts_plan *o = w->plan;
    if (!o)
        return;
    nevh__form_flow_free(o->flow);
    free(o->weights);
    free(o->times);
    free(o->which);
    free(o);
    w->plan = NULL;
}

/* Flows over equal parts of the step share their matrices.  Returns how many
   there are; these are the first of `times`. */
static size_t find_flows(parts_plan *o, double distinct[]) {
    size_t found = 0;
    for (size_t i = 0; i < o->count; i += 2) {
        size_t k = 0;
        while (k < found && distinct[k] != o->weights[i])
            k++;
        distinct[k] = o->weights[i];
        found += k == found;
        o->which[i] = k;
    }
    return found;
}

static int plan_flows(nevh_work *w) {
    parts_plan *o = w->plan;
    double *distinct = nevh__array(o->count, sizeof *distinct), passed = 0;
    if (!distinct)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    size_t found = find_flows(o, distinct);
    for (size_t i = 0; i < o->count; i++) {
        o->times[i] = passed;
        passed += i % 2 ? 0 : o->weights[i];
    }
    o->flow = nevh__form_flow_new(w, found, distinct);
    free(distinct);
    return o->flow ? NEVH_OK : w->report->status;
}

static int plan(nevh_work *w) {
    const nevh_splitting *table = w->integrator->table;
    parts_plan *o = w->plan = nevh__array(1, sizeof *o);
    if (!o)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    o->count = nevh__splitting_operations(table);
    o->weights = nevh__array(o->count, sizeof *o->weights);
    o->times = nevh__array(o->count, sizeof *o->times);
    o->which = nevh__array(o->count, sizeof *o->which);
    if (!o->weights || !o->times || !o->which)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    nevh__splitting_expand(table, o->weights);
    w->memory_rows = 2 * w->n;
    w->scratch_size = 5 * w->size + w->width;
    return plan_flows(w);
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

static int kick(nevh_work *w, const rows *r, double weight) {
    int status =
        nevh_work_gradient(w, w->width, r->time, r->q, r->p, r->slope, NULL);
    for (size_t i = 0; i < w->size; i++)
        r->dp[i] -= weight * r->slope[i];
    return status;
}

static int operate(nevh_work *w, const rows *r, size_t i, double t, double h) {
    const parts_plan *o = w->plan;
    double weight = o->weights[i] * h;
    bool kicks = i % 2;
    int status = NEVH_OK;
    for (size_t lane = 0; lane < w->width; lane++)
        r->time[lane] = t + o->times[i] * h;
    if (w->accounts)
        status = nevh_work_account(w, kicks ? NEVH_OF_Q : NEVH_OF_P, weight,
                                   r->time, r->q, r->p);
    if (!status && kicks)
        status = kick(w, r, weight);
    else if (!status)
        nevh__form_flow_add(o->flow, o->which[i], w->width, r->q, r->p, r->dq,
                            r->dp);
    return status;
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
        status = operate(w, &r, i, t, h);
    }
    if (status)
        return status;
    return nevh_work_commit(w, w->size, q, r.dq, w->memory, p, r.dp,
                            w->memory + w->size);
}

static void apply_friction(nevh_work *w, const double factor[]) {
    for (size_t i = 0; i < w->size; i++)
        w->memory[w->size + i] *= factor[i / w->width];
}

const nevh_kernel nevh__parts_kernel = {.plan = plan,
                                        .step = step,
                                        .clear = clear,
                                        .apply_friction = apply_friction};
