/* nevh: states of a run at given times.

   Of fixed steps, a state branches off to the times that come before the next
   one.  Where steps take times of their own, that is done afterwards, from what
   was kept of the step before.  So it is where the memory of a scheme holds the
   orbit beside a state, as series do: there the state before the step, that after
   it, or the last one branched off to is a place from which others are read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/run_at_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

struct nevh__samples {
    const nevh__running *run;
    nevh_stepper *stepper;
    nevh__branch from, now; /* now: where states are found afterwards */
    nevh__branch
        tried;   /* the last state that was not to be read; t: NAN if none */
    size_t next; /* of the times */
    size_t step; /* the next one needed */
    double h;    /* as adjusted */
};

static double time_of(const nevh__samples *a, size_t i) {
    const nevh_orbit *o = a->run->orbit;
    size_t others = o->n_times - 1;
    if (o->times)
        return o->times[i];
    return i == others
               ? o->t_end
               : o->t0 + (o->t_end - o->t0) * ((double)i / (double)others);
}

static bool is_left(const nevh__samples *a) {
    return a->next < a->run->orbit->n_times;
}

/* Times that only rounding makes different. */
static bool run_at_same(const nevh__samples *a, double t, double u) {
    double size = fabs(t) + fabs(u) + fabs(a->h);
    return t == u || fabs(t - u) < 8 * DBL_EPSILON * size;
}

/* True if the run has passed the next time before t. */
static bool is_due(const nevh__samples *a, double t) {
    if (!is_left(a))
        return false;
    double due = time_of(a, a->next);
    return (t - due) * a->h > 0 && !run_at_same(a, due, t);
}

static int run_at_put(nevh__samples *a, const double q[], const double p[]) {
    const nevh_orbit *o = a->run->orbit;
    size_t i = a->next++;
    double t = time_of(a, i);
    if (!o->sample(o->sample_data, i, t, q, p))
        return NEVH_OK;
    return nevh__fail(&a->stepper->report, NEVH_STOPPED,
                      "sample %zu stopped the run at t = %.9g", i, t);
}

/* The states from that of `from` on, before t. */
static int branch_before(nevh__samples *a, double t) {
    int status = NEVH_OK;
    while (!status && is_due(a, t)) {
        a->from.t_end = time_of(a, a->next);
        if (!a->stepper->own_time)
            a->from.h = a->from.t_end - a->from.t;
        status = nevh__branch_step(&a->from);
        if (!status)
            status = run_at_put(a, a->from.q_end, a->from.p_end);
    }
    return status;
}

static int put_here(nevh__samples *a, double t, const double q[],
                    const double p[]) {
    int status = NEVH_OK;
    while (!status && is_left(a) && run_at_same(a, time_of(a, a->next), t))
        status = run_at_put(a, q, p);
    return status;
}

static int read_own(nevh__samples *a, double t) {
    a->from.h = a->h;
    int status = nevh__branch_measure(&a->from);
    return status ? status : branch_before(a, t);
}

/* True if memory holds the orbit within a step. */
static bool is_held(const nevh_stepper *s) {
    return !s->own_time && s->work.integrator->kernel->holds;
}

/* Steps to the next time from where that needs no evaluations, or else from the
   start of the step. */
static int read_next(nevh__samples *a) {
    const nevh_work *w = &a->stepper->work;
    nevh__branch *places[] = {&a->from, &a->now, &a->tried}, *b = NULL;
    double due = time_of(a, a->next);
    for (size_t i = 0; !b && i < 3; i++)
        if (w->integrator->kernel->holds(w, places[i]->memory,
                                         due - places[i]->t))
            b = places[i];
    bool read = b;
    b = read ? b : &a->from;
    b->t_end = due;
    b->h = due - b->t;
    int status = nevh__branch_step(b);
    if (!status)
        status = run_at_put(a, b->q_end, b->p_end);
    if (!status && !read)
        nevh__branch_keep(&a->tried, due, b->q_end, b->p_end);
    return status;
}

static int read_held(nevh__samples *a, double t) {
    int status = NEVH_OK;
    a->tried.t = NAN;
    while (!status && is_due(a, t))
        status = read_next(a);
    return status;
}

/* The times before t as `read` finds their states, then t itself. */
static int sample_by(nevh__samples *a, int (*read)(nevh__samples *, double t),
                     double t, const double q[], const double p[]) {
    int status = NEVH_OK;
    if (is_due(a, t)) {
        nevh__branch_keep(&a->now, t, q, p);
        status = read(a, t);
        nevh__branch_resume(&a->now);
    }
    if (!status)
        status = put_here(a, t, q, p);
    nevh__branch_keep(&a->from, t, q, p);
    return status;
}

/* The end of the next step from t. */
static double step_end(const nevh__samples *a, double t) {
    double t_end = a->run->orbit->t_end;
    return fabs(t_end - t) < fabs(a->h) ? t_end : t + a->h;
}

void nevh__samples_rest(nevh__samples *a, const double q[], const double p[]) {
    if (!is_held(a->stepper))
        return;
    nevh__report report = a->stepper->report;
    double last = a->stepper->last_t;
    double next = step_end(a, a->from.t);
    nevh__branch_keep(&a->now, last, q, p);
    a->now.t = a->tried.t = NAN;
    while (is_due(a, next) && !read_next(a))
        ;
    a->now.t = last;
    nevh__branch_resume(&a->now);
    a->stepper->report = report;
}

int nevh__samples_at(nevh__samples *a, double t, const double q[],
                     const double p[]) {
    if (is_held(a->stepper))
        return sample_by(a, read_held, t, q, p);
    return a->stepper->own_time ? sample_by(a, read_own, t, q, p)
                                : put_here(a, t, q, p);
}

/* Fixed steps that need not be shown are those well before the next time. */
static void foresee(nevh__samples *a, double t) {
    static const double slack = 3; /* steps, for rounding */
    bool all = a->stepper->own_time || is_held(a->stepper);
    size_t taken = a->stepper->taken;
    double ahead = is_left(a) ? (time_of(a, a->next) - t) / a->h : INFINITY;
    a->step = taken + 1;
    if (!all && ahead > slack)
        a->step = taken + (size_t)fmin(ahead - slack + 1, 0x1p53);
}

int nevh__samples_after(nevh__samples *a, double t, const double q[],
                        const double p[]) {
    int status = NEVH_OK;
    double next = step_end(a, t);
    if (!a->stepper->own_time && !is_held(a->stepper) && is_due(a, next)) {
        nevh__branch_keep(&a->from, t, q, p);
        status = branch_before(a, next);
        nevh__branch_resume(&a->from);
    }
    foresee(a, t);
    return status;
}

size_t nevh__samples_step(const nevh__samples *a) {
    return a->step;
}

static int run_at_check(const nevh__samples *a) {
    const nevh_orbit *o = a->run->orbit;
    nevh__report *r = &a->stepper->report;
    double last = o->t0;
    if (a->stepper->work.width != 1)
        return nevh__fail(r, NEVH_EINVAL,
                          "states at given times are of one orbit, not of %zu "
                          "side by side",
                          a->stepper->work.width);
    if (!o->times && o->n_times < 2)
        return nevh__fail(r, NEVH_EINVAL,
                          "samples at equal distances are at least 2");
    for (size_t i = 0; o->times && i < o->n_times; i++) {
        double t = o->times[i];
        if (!((t - last) * a->h >= 0 && (o->t_end - t) * a->h >= 0))
            return nevh__fail(
                r, NEVH_EINVAL,
                "time %zu, %.9g, is not between %.9g and %.9g, or "
                "not in the order of the run",
                i, t, last, o->t_end);
        last = t;
    }
    return NEVH_OK;
}

static int run_at_plan(nevh__samples *a) {
    nevh_stepper *s = a->stepper;
    double steps;
    if (!s->own_time)
        nevh__whole_steps(a->run->orbit->t_end - a->run->orbit->t0, &a->h,
                          &steps);
    int status = run_at_check(a);
    if (!status)
        status = nevh__branch_open(&a->from, s);
    if (!status)
        status = nevh__branch_open(&a->now, s);
    return status ? status : nevh__branch_open(&a->tried, s);
}

nevh__samples *nevh__samples_new(const nevh__running *r) {
    nevh__samples *a = calloc(1, sizeof *a);
    if (!a) {
        nevh__no_memory(&r->stepper->report);
        return NULL;
    }
    *a = (nevh__samples){.run = r,
                         .stepper = r->stepper,
                         .h = r->orbit->h,
                         .next = r->orbit->samples_before};
    if (!run_at_plan(a))
        return a;
    nevh__samples_free(a);
    return NULL;
}

void nevh__samples_free(nevh__samples *a) {
    if (!a)
        return;
    nevh__branch_close(&a->from);
    nevh__branch_close(&a->now);
    nevh__branch_close(&a->tried);
    free(a);
}
