/* nevh: what is planned for steps along Taylor series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor_private.h"
#include "work/work_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

typedef nevh__taylor_plan taylor_plan;

const nevh__recurrence *nevh__taylor_recurrence(const nevh_work *w,
                                                size_t *order) {
    const taylor_plan *plan = w->plan;
    *order = plan->order;
    return plan->recurrence;
}

void nevh__taylor_use(nevh_work *w, nevh__series_code *code,
                      const double numbers[], bool *differs) {
    taylor_plan *plan = w->plan;
    plan->code = code;
    plan->numbers = numbers;
    plan->differs = differs;
}

/* A series detects a narrow part of H from about ten times its width.  It must not
   pass one that steps of h would find: its length is at most this many steps. */
static const double most_steps = 8;

void nevh__taylor_clear(nevh_work *w) {
    taylor_plan *plan = w->plan;
    if (!plan)
        return;
    nevh__series_free_double(plan->series);
    nevh__series_free_long(plan->first);
    free(plan->first_rows);
    free(plan->watched);
    nevh__recurrence_free(plan->recurrence);
    free(plan);
    w->plan = NULL;
}

/* An order more divides the error by e^2 where steps have the best length: the
   fewer operations an order costs, the better are high ones. */
static size_t order_for(double tolerance) {
    double digits = -log(fmax(tolerance, 1e-18));
    double order = ceil(3 + 0.72 * digits);
    return order < 4 ? 4 : (size_t)order;
}

/* Tolerances below this are of errors that doubles cannot hold. */
static const double finest = DBL_EPSILON;

static bool plan_series(const nevh_work *w, taylor_plan *plan) {
    plan->series = nevh__series_new_double(plan->recurrence, plan->order);
    plan->watched = nevh__array(plan->order * plan->recurrence->n_watched,
                                sizeof *plan->watched);
    if (!NEVH__TAYLOR_LONGER || !plan->series || !plan->watched ||
        !(w->options->tolerance < finest))
        return plan->series && plan->watched;
    plan->first = nevh__series_new_long(plan->recurrence, NEVH__TAYLOR_FIRST);
    plan->first_rows = nevh__array(2 * w->n * (NEVH__TAYLOR_FIRST + 2),
                                   sizeof *plan->first_rows);
    return plan->first && plan->first_rows;
}

/* Runs go on behind kinks, as series do not. */
static int refuse_kink(nevh_work *w, const nevh__edge *e) {
    return nevh_work_fail(
        w, NEVH_ESTRUCT,
        "effect \"%s\" has no Taylor series: its function "
        "%s(...) is not analytic, so that its derivatives say "
        "nothing about it elsewhere",
        e->effect ? e->effect : "H", nevh__operation_name(e->function));
}

int nevh__taylor_plan_new(nevh_work *w) {
    double tolerance = w->options->tolerance;
    if (!(tolerance > 0))
        return nevh_work_fail(w, NEVH_EINVAL,
                              "%s has no fixed steps: it needs a tolerance",
                              w->integrator->name);
    taylor_plan *plan = w->plan = nevh__array(1, sizeof *plan);
    if (!plan)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    plan->order = order_for(tolerance);
    w->order = (int)plan->order;
    bool timed = !(nevh_system_traits(w->system) & NEVH_AUTONOMOUS);
    plan->longest = timed ? 1 : most_steps;
    nevh__report report = {0};
    plan->recurrence =
        nevh__recurrence_new(w->system, w->friction, false, &report);
    if (!plan->recurrence)
        return nevh_work_fail(w, report.status, "%s", report.text);
    size_t kink = nevh__domain_kink(plan->recurrence);
    if (kink != SIZE_MAX)
        return refuse_kink(w, &plan->recurrence->edges[kink]);
    int status = nevh_work_find_scale(w);
    if (status)
        return status;
    if (!plan_series(w, plan))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    size_t size = nevh__taylor_chain_size(w->n, plan);
    w->memory_rows = size;
    w->scratch_size = size * (w->width > 1 ? w->width : 1) + 4 * w->n;
    return NEVH_OK;
}
