/* nevh: a run, and its states at given times.

   An observer of each step branches off to the times that come before the next
   one.  Where steps take times of their own, it does so afterwards, from what
   it kept of the step before.  So it does where the memory of a scheme holds the
   orbit beside a state, as series do: there the state before the step, that after
   it, or the last one branched off to is a place from which others are read.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/branch_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    nevh_stepper *stepper;
    nevh__branch from, now; /* now: where states are found afterwards */
    nevh__branch
        tried; /* the last state that was not to be read; t: NAN if none */
    const double *times;
    size_t count, kept;
    double *states;
    double h, t_end;     /* h as the run adjusts it */
    int status;          /* of a branch, */
    nevh__report report; /* and what it said */
} sampler;

/* Times that only rounding makes different. */
static bool same(const sampler *a, double t, double u) {
    double size = fabs(t) + fabs(u) + fabs(a->h);
    return t == u || fabs(t - u) < 8 * DBL_EPSILON * size;
}

/* Whether the next time is passed before t. */
static bool is_due(const sampler *a, double t) {
    return a->kept < a->count && (t - a->times[a->kept]) * a->h > 0 &&
           !same(a, a->times[a->kept], t);
}

static void put(sampler *a, const double q[], const double p[]) {
    size_t n = a->stepper->work.n;
    for (size_t k = 0; k < n; k++) {
        a->states[k * a->count + a->kept] = q[k];
        a->states[(n + k) * a->count + a->kept] = p[k];
    }
    a->kept++;
}

/* The states from that of `from` on, before t. */
static int branch_before(sampler *a, double t) {
    while (!a->status && is_due(a, t)) {
        a->from.t_end = a->times[a->kept];
        if (!a->stepper->own_time)
            a->from.h = a->from.t_end - a->from.t;
        a->status = nevh__branch_step(&a->from);
        if (!a->status)
            put(a, a->from.q_end, a->from.p_end);
    }
    if (a->status)
        a->report = a->stepper->report;
    return a->status;
}

static void put_here(sampler *a, double t, const double q[], const double p[]) {
    while (a->kept < a->count && same(a, a->times[a->kept], t))
        put(a, q, p);
}

static int sample_fixed(sampler *a, double t, const double q[],
                        const double p[]) {
    double next = fabs(a->t_end - t) < fabs(a->h) ? a->t_end : t + a->h;
    put_here(a, t, q, p);
    if (!is_due(a, next))
        return NEVH_OK;
    nevh__branch_keep(&a->from, t, q, p);
    int status = branch_before(a, next);
    nevh__branch_resume(&a->from);
    return status;
}

static int sample_own(sampler *a, double t, const double q[],
                      const double p[]) {
    int status = NEVH_OK;
    if (is_due(a, t)) {
        nevh__branch_keep(&a->now, t, q, p);
        a->from.h = a->h;
        a->status = nevh__branch_measure(&a->from);
        status = branch_before(a, t);
        nevh__branch_resume(&a->now);
    }
    put_here(a, t, q, p);
    nevh__branch_keep(&a->from, t, q, p);
    return status;
}

/* Whether the memory of steps holds the orbit beside their ends. */
static bool is_held(const nevh_stepper *s) {
    return !s->own_time && s->work.integrator->kernel->holds;
}

/* Steps to the next time from where that needs no evaluations, or else from the
   start of the step. */
static int read_next(sampler *a) {
    const nevh_work *w = &a->stepper->work;
    nevh__branch *places[] = {&a->from, &a->now, &a->tried}, *b = NULL;
    double due = a->times[a->kept];
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
        put(a, b->q_end, b->p_end);
    if (!status && !read)
        nevh__branch_keep(&a->tried, due, b->q_end, b->p_end);
    return status;
}

static int sample_held(sampler *a, double t, const double q[],
                       const double p[]) {
    if (is_due(a, t)) {
        nevh__branch_keep(&a->now, t, q, p);
        a->tried.t = NAN;
        while (!a->status && is_due(a, t))
            a->status = read_next(a);
        if (a->status)
            a->report = a->stepper->report;
        nevh__branch_resume(&a->now);
    }
    put_here(a, t, q, p);
    nevh__branch_keep(&a->from, t, q, p);
    return a->status;
}

/* What comes before the place within a step where that failed. */
static void read_before_failure(sampler *a, const double q[],
                                const double p[]) {
    nevh__report report = a->stepper->report;
    double last = a->stepper->last_t;
    double left = a->t_end - a->from.t;
    double next = fabs(left) < fabs(a->h) ? a->t_end : a->from.t + a->h;
    nevh__branch_keep(&a->now, last, q, p);
    a->now.t = a->tried.t = NAN;
    while (is_due(a, next) && !read_next(a))
        ;
    a->now.t = last;
    nevh__branch_resume(&a->now);
    a->stepper->report = report;
}

static int sample(void *data, size_t step, double t, const double q[],
                  const double p[]) {
    sampler *a = data;
    (void)step;
    if (is_held(a->stepper))
        return sample_held(a, t, q, p);
    return (a->stepper->own_time ? sample_own : sample_fixed)(a, t, q, p);
}

static int check(const sampler *a, double t0) {
    nevh__report *r = &a->stepper->report;
    double last = t0;
    if (a->stepper->work.width != 1)
        return nevh__fail(r, NEVH_EINVAL,
                          "states at given times are of one orbit, not of %zu "
                          "side by side",
                          a->stepper->work.width);
    for (size_t i = 0; i < a->count; i++) {
        double t = a->times[i];
        if (!((t - last) * a->h >= 0 && (a->t_end - t) * a->h >= 0))
            return nevh__fail(
                r, NEVH_EINVAL,
                "time %zu, %.9g, is not between %.9g and %.9g, or "
                "not in the order of the run",
                i, t, last, a->t_end);
        last = t;
    }
    return NEVH_OK;
}

static int run_sampled(sampler *a, double t0, double h, double q[], double p[],
                       const nevh_observer observers[], size_t count) {
    nevh_observer *all = nevh__array(count + 1, sizeof *all);
    int status = all ? nevh__branch_open(&a->from, a->stepper) : NEVH_ENOMEM;
    if (!status)
        status = nevh__branch_open(&a->now, a->stepper);
    if (!status)
        status = nevh__branch_open(&a->tried, a->stepper);
    if (all && count)
        memcpy(all + 1, observers, count * sizeof *all);
    if (all)
        all[0] = (nevh_observer){sample, a, 1};
    if (!status)
        status =
            nevh_run_until(a->stepper, t0, h, a->t_end, q, p, all, count + 1);
    else
        nevh__fail(&a->stepper->report, status, "out of memory");
    if (status && status != NEVH_STOPPED && all && a->tried.q &&
        is_held(a->stepper))
        read_before_failure(a, q, p);
    nevh__branch_close(&a->from);
    nevh__branch_close(&a->now);
    nevh__branch_close(&a->tried);
    free(all);
    return a->status ? nevh__fail_as(&a->stepper->report, &a->report) : status;
}

int nevh_run_at(nevh_stepper *s, double t0, double h, double t_end,
                const double times[], size_t count, double states[],
                size_t *kept, double q[], double p[],
                const nevh_observer observers[], size_t n_observers) {
    double steps;
    sampler a = {.stepper = s,
                 .times = times,
                 .count = count,
                 .states = states,
                 .h = h,
                 .t_end = t_end};
    if (kept)
        *kept = 0;
    if (!s || !s->planned || count == 0 || !(fabs(h) > 0))
        return nevh_run_until(s, t0, h, t_end, q, p, observers, n_observers);
    if (!s->own_time)
        nevh__whole_steps(t_end - t0, &a.h, &steps);
    int status = check(&a, t0);
    if (!status)
        status = run_sampled(&a, t0, h, q, p, observers, n_observers);
    if (kept)
        *kept = a.kept;
    return status;
}
