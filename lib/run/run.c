/* nevh: the driver.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"

int nevh__show(nevh_stepper *s, size_t step, bool last, double t,
               const double q[], const double p[],
               const nevh_observer observers[], size_t count) {
    for (size_t i = 0; i < count; i++) {
        size_t every = observers[i].every ? observers[i].every : 1;
        if (step % every != 0 && !last)
            continue;
        if (observers[i].observe(observers[i].data, step, t, q, p))
            return nevh__fail(&s->report, NEVH_STOPPED,
                              "observer %zu stopped the run at t = %.9g", i, t);
    }
    return NEVH_OK;
}

double nevh__next_time(const nevh_stepper *s, double t0, double h) {
    return s->own_time ? s->last_t : t0 + (double)s->taken * h;
}

int nevh__begin_run(nevh_stepper *s, double t0, double h, const double q[],
                    const double p[]) {
    int status = nevh__begin(s, t0, h, q, p);
    if (s)
        s->taken = 0;
    return status;
}

/* Whether a step is no more than the kernel's. */
static bool plain(const nevh_stepper *s) {
    return !s->friction && !s->work.ledger && !s->work.transform &&
           !s->own_time;
}

/* The next step after `taken` that somebody looks at, or the last one. */
static size_t next_shown(size_t taken, size_t steps,
                         const nevh_observer observers[], size_t count) {
    size_t next = steps;
    for (size_t i = 0; i < count; i++) {
        size_t every = observers[i].every ? observers[i].every : 1;
        size_t rest = every - taken % every;
        next = rest < next - taken ? taken + rest : next;
    }
    return next;
}

/* Steps before `until`, at which nobody looks; *t goes along. */
static int run_unseen(nevh_stepper *s, double t0, double h, size_t until,
                      double *t, double q[], double p[]) {
    nevh_work *w = &s->work;
    int status = NEVH_OK;
    s->last_h = w->elapsed = h;
    while (s->taken + 1 < until) {
        size_t done = w->native ? nevh__native_run(w, t0, h, s->taken,
                                                   until - 1 - s->taken, q, p)
                                : 0;
        s->taken += done;
        *t = s->last_t = nevh__next_time(s, t0, h);
        if (s->taken + 1 == until)
            break;
        status = nevh__work_step(w, *t, h, q, p);
        if (status)
            break;
        s->taken++;
        *t = s->last_t = nevh__next_time(s, t0, h);
    }
    return status;
}

int nevh__run_steps(nevh_stepper *s, double t0, double h, size_t steps,
                    bool ends, double q[], double p[],
                    const nevh_observer observers[], size_t count) {
    double t = t0;
    bool hurries = plain(s);
    int status =
        nevh__show(s, 0, ends && steps == 0, t, q, p, observers, count);
    while (!status && s->taken < steps) {
        size_t next = next_shown(s->taken, steps, observers, count);
        if (hurries && next > s->taken + 1)
            status = run_unseen(s, t0, h, next, &t, q, p);
        if (!status)
            status = nevh__advance(s, t, h, q, p);
        if (status)
            break;
        s->taken++;
        t = s->last_t = nevh__next_time(s, t0, h);
        status = nevh__show(s, s->taken, ends && s->taken == steps, t, q, p,
                            observers, count);
    }
    return status;
}

void nevh__end_run(nevh_stepper *s, const double q[], const double p[]) {
    if (s->taken > 0)
        nevh__remember(s, q, p);
    else
        nevh__undo(s);
}

int nevh_run(nevh_stepper *s, double t0, double h, size_t steps, double q[],
             double p[], const nevh_observer observers[], size_t count) {
    int status = nevh__begin_run(s, t0, h, q, p);
    if (status)
        return status;
    status = nevh__run_steps(s, t0, h, steps, true, q, p, observers, count);
    nevh__end_run(s, q, p);
    return status;
}
