/* nevh: the driver.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/taylor_private.h"
#include "run/run_at_private.h"
#include <fenv.h>

int nevh__show(nevh__running *r, bool last, double t) {
    nevh_stepper *s = r->stepper;
    const nevh_orbit *o = r->orbit;
    bool sampled =
        r->samples && (last || nevh__samples_step(r->samples) <= s->taken);
    int status =
        sampled ? nevh__samples_at(r->samples, t, r->q, r->p) : NEVH_OK;
    for (size_t i = 0; !status && i < o->n_observers; i++) {
        const nevh_observer *one = &o->observers[i];
        if (s->taken % (one->every ? one->every : 1) != 0 && !last)
            continue;
        if (one->observe(one->data, s->taken, t, r->q, r->p))
            status =
                nevh__fail(&s->report, NEVH_STOPPED,
                           "observer %zu stopped the run at t = %.9g", i, t);
    }
    if (!status && sampled)
        status = nevh__samples_after(r->samples, t, r->q, r->p);
    return status;
}

double nevh__next_time(const nevh_stepper *s, double t0, double h) {
    return s->own_time ? s->last_t : t0 + (double)s->taken * h;
}

double nevh__start_time(const nevh__running *r) {
    return r->orbit->steps_before ? r->orbit->t_before : r->orbit->t0;
}

int nevh__begin_run(nevh__running *r) {
    nevh_stepper *s = r->stepper;
    int status = nevh__begin(s, nevh__start_time(r), r->h, r->q, r->p);
    if (s)
        s->taken = r->orbit->steps_before;
    if (status)
        return status;
    s->now_q = r->q;
    s->now_p = r->p;
    return NEVH_OK;
}

bool nevh__steps_are_plain(const nevh_stepper *s) {
    return !s->friction && !s->work.ledger && !s->work.transform &&
           !s->own_time;
}

/* The next step that an observer or a sample needs, or the last one. */
static size_t next_shown(const nevh__running *r, size_t steps) {
    const nevh_orbit *o = r->orbit;
    size_t taken = r->stepper->taken, next = steps;
    if (r->samples && nevh__samples_step(r->samples) < next)
        next = nevh__samples_step(r->samples);
    for (size_t i = 0; i < o->n_observers; i++) {
        size_t every = o->observers[i].every ? o->observers[i].every : 1;
        size_t rest = every - taken % every;
        next = rest < next - taken ? taken + rest : next;
    }
    return next;
}

/* Steps that are taken in one go, if any. */
static size_t run_on(nevh_work *w, double t0, double h, size_t from,
                     size_t steps, double q[], double p[]) {
    if (w->integrator->kernel == &nevh__taylor_kernel)
        return nevh__taylor_run(w, t0, h, from, steps, q, p);
    return w->native ? nevh__native_run(w, t0, h, from, steps, q, p) : 0;
}

int nevh__advance_unseen(nevh_stepper *s, double t0, double h, size_t until,
                         double q[], double p[]) {
    nevh_work *w = &s->work;
    int status = NEVH_OK;
    s->last_h = w->elapsed = h;
    while (!status && s->taken < until) {
        s->taken += run_on(w, t0, h, s->taken, until - s->taken, q, p);
        s->last_t = nevh__next_time(s, t0, h);
        if (s->taken == until)
            break;
        status = nevh__work_step(w, s->last_t, h, q, p);
        if (status)
            break;
        s->taken++;
        s->last_t = nevh__next_time(s, t0, h);
    }
    return status;
}

int nevh__run_steps(nevh__running *r, size_t steps, bool ends) {
    nevh_stepper *s = r->stepper;
    double t = nevh__start_time(r);
    bool hurries = nevh__steps_are_plain(s);
    int status = nevh__show(r, ends && s->taken >= steps, t);
    while (!status && s->taken < steps) {
        size_t next = next_shown(r, steps);
        if (hurries && next > s->taken + 1) {
            status = nevh__advance_unseen(s, r->orbit->t0, r->h, next - 1, r->q,
                                          r->p);
            t = s->last_t;
        }
        if (!status)
            status = nevh__advance(s, t, r->h, r->q, r->p);
        if (status)
            break;
        s->taken++;
        t = s->last_t = nevh__next_time(s, r->orbit->t0, r->h);
        status = nevh__show(r, ends && s->taken == steps, t);
    }
    return status;
}

void nevh__end_run(nevh__running *r) {
    nevh_stepper *s = r->stepper;
    s->now_q = s->now_p = NULL;
    if (s->taken > r->orbit->steps_before)
        nevh__remember(s, r->q, r->p);
    else
        nevh__undo(s);
}

int nevh_run(nevh_stepper *s, double t0, double h, size_t steps, double q[],
             double p[], const nevh_observer observers[], size_t count) {
    nevh_orbit orbit = {.t0 = t0, .observers = observers, .n_observers = count};
    nevh__running r = {s, &orbit, h, q, p, NULL};
    int status = nevh__begin_run(&r);
    if (status)
        return status;
    bool holds_traps =
        s->holds_traps || steps > 1; /* that takes as long as a step */
    fenv_t own;
    if (holds_traps)
        feholdexcept(&own);
    status = nevh__run_steps(&r, steps, true);
    nevh__end_run(&r);
    if (holds_traps)
        fesetenv(&own);
    return status;
}
