/* nevh: runs that end at a given time.

   A main orbit's steps are never shortened: the end, where it does not fall on
   a step, is reached by one step more from a copy of the state, and the
   stepper's memory stays with the orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/run_at_private.h"
#include <fenv.h>
#include <math.h>
#include <string.h>

static size_t state_size(const nevh_stepper *s) {
    return s->work.size * sizeof(double);
}

/* The last stretch; the stepper stays on the main orbit. */
static int branch_off(nevh__running *r, nevh__branch *b, double h) {
    nevh_stepper *s = r->stepper;
    b->h = h;
    int status = nevh__branch_step(b);
    memcpy(r->q, status ? b->q : b->q_end, state_size(s));
    memcpy(r->p, status ? b->p : b->p_end, state_size(s));
    if (!status) { /* what is shown includes what the last step gained */
        s->taken++;
        status = nevh__show(r, true, b->t_end);
    }
    nevh__branch_resume(b);
    s->now_q = s->now_p = NULL;
    if (status && s->taken == r->orbit->steps_before)
        nevh__undo(s);
    else
        nevh__remember(s, b->q, b->p);
    return status;
}

/* One step of the main orbit; *t in and out. */
static int own_step(nevh__running *r, nevh__branch *b, double *t) {
    nevh_stepper *s = r->stepper;
    nevh__branch_keep(b, *t, r->q, r->p);
    int status = nevh__advance(s, *t, r->h, r->q, r->p);
    if (status)
        return status;
    b->elapsed = s->work.elapsed;
    *t = s->last_t;
    if (b->elapsed / r->h > 0)
        return NEVH_OK;
    nevh__branch_resume(b);
    memcpy(r->q, b->q, state_size(s));
    memcpy(r->p, b->p, state_size(s));
    return nevh__fail(&s->report, NEVH_EFAILED,
                      "%s: no time has passed in the step from t = %.9g by %g",
                      s->work.integrator->name, b->t, r->h);
}

/* Steps of the scheme's own time, until the next one would pass the end. */
static int run_own(nevh__running *r, nevh__branch *b) {
    nevh_stepper *s = r->stepper;
    double t = b->t, t_end = b->t_end, forward = r->h > 0 ? 1 : -1;
    int status = nevh__show(r, t == t_end, t);
    while (!status && t != t_end) {
        status = own_step(r, b, &t);
        if (status)
            break;
        if ((t - t_end) * forward > 0)
            return branch_off(r, b, r->h);
        s->taken++;
        status = nevh__show(r, t == t_end, t);
    }
    nevh__end_run(r);
    return status;
}

/* `steps` steps that end at t_end to the last bit. */
static int run_whole(nevh__running *r, double steps) {
    nevh_stepper *s = r->stepper;
    const nevh_orbit *o = r->orbit;
    double before = fmax(steps - 1, 0);
    bool here = (double)s->taken >= steps;
    int status = nevh__run_steps(r, (size_t)before, here);
    if (!status && !here)
        status = nevh__advance(s, o->t0 + before * r->h, r->h, r->q, r->p);
    if (!status && !here) {
        s->taken++;
        s->last_t = o->t_end;
        status = nevh__show(r, true, o->t_end);
    }
    nevh__end_run(r);
    return status;
}

/* Whole steps, and what is left. */
static int run_fixed(nevh__running *r, nevh__branch *b) {
    const nevh_orbit *o = r->orbit;
    double steps;
    if (nevh__whole_steps(o->t_end - o->t0, &r->h, &steps))
        return run_whole(r, steps);
    bool there = (double)r->stepper->taken > steps; /* by a saved run */
    int status = nevh__run_steps(r, (size_t)steps, there);
    if (status || there) {
        nevh__end_run(r);
        return status;
    }
    nevh__branch_keep(b, o->t0 + steps * r->h, r->q, r->p);
    return branch_off(r, b, o->t_end - b->t);
}

int nevh__span_check(nevh_stepper *s, double t0, double h, double t_end) {
    double steps = (t_end - t0) / h;
    if (steps >= 0 && steps < 0x1p53)
        return NEVH_OK;
    return nevh__fail(&s->report, NEVH_EINVAL,
                      "no number of steps of %g leads from %.9g to %.9g", h, t0,
                      t_end);
}

/* After nevh__begin_run. */
static int orbit_run_untrapped(nevh__running *r) {
    nevh_stepper *s = r->stepper;
    const nevh_orbit *o = r->orbit;
    nevh__branch b = {.t = nevh__start_time(r), .t_end = o->t_end};
    int status = nevh__span_check(s, o->t0, o->h, o->t_end);
    if (!status)
        status = nevh__branch_open(&b, s);
    if (!status && o->sample && o->n_times > o->samples_before) {
        r->samples = nevh__samples_new(r);
        status = r->samples ? NEVH_OK : s->report.status;
    }
    if (status)
        nevh__end_run(r);
    else
        status = s->own_time ? run_own(r, &b) : run_fixed(r, &b);
    if (status && status != NEVH_STOPPED && r->samples)
        nevh__samples_rest(r->samples, r->q, r->p);
    nevh__samples_free(r->samples);
    nevh__branch_close(&b);
    return status;
}

static int orbit_run(nevh__running *r) {
    fenv_t own;
    feholdexcept(&own);
    int status = orbit_run_untrapped(r);
    fesetenv(&own);
    return status;
}

int nevh_orbit_run(nevh_stepper *s, const nevh_orbit *o, double q[],
                   double p[]) {
    if (!s || !o)
        return s ? nevh__fail(&s->report, NEVH_EINVAL, "there is no nevh_orbit")
                 : nevh_stepper_status(s);
    nevh__running r = {s, o, o->h, q, p, NULL};
    int status = nevh__begin_run(&r);
    return status ? status : orbit_run(&r);
}

int nevh_run_until(nevh_stepper *s, double t0, double h, double t_end,
                   double q[], double p[], const nevh_observer observers[],
                   size_t count) {
    nevh_orbit o = {t0, h, t_end, observers, count, .n_times = 0};
    return nevh_orbit_run(s, &o, q, p);
}

typedef struct {
    double *states;
    size_t count, kept, n;
} table;

static int orbit_keep(void *data, size_t i, double t, const double q[],
                      const double p[]) {
    table *a = data;
    (void)t;
    for (size_t k = 0; k < a->n; k++) {
        a->states[k * a->count + i] = q[k];
        a->states[(a->n + k) * a->count + i] = p[k];
    }
    a->kept = i + 1;
    return 0;
}

int nevh_run_at(nevh_stepper *s, double t0, double h, double t_end,
                const double times[], size_t count, double states[],
                size_t *kept, double q[], double p[],
                const nevh_observer observers[], size_t n_observers) {
    if (s && s->planned && count > 0 && !times)
        return nevh__fail(&s->report, NEVH_EINVAL, "there are no times");
    table a = {states, count, 0, s ? s->work.n : 0};
    nevh_orbit o = {t0,    h,     t_end,      observers, n_observers,
                    times, count, orbit_keep, &a,        .steps_before = 0};
    int status = nevh_orbit_run(s, &o, q, p);
    if (kept)
        *kept = a.kept;
    return status;
}
