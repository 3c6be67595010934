/* nevh: runs that end at a given time.

   A main orbit's steps are never shortened: the end, where it does not fall on
   a step, is reached by one step more from a copy of the state, and the
   stepper's memory stays with the orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/branch_private.h"
#include <math.h>
#include <string.h>

static size_t state_size(const nevh_stepper *s) {
    return s->work.size * sizeof(double);
}

/* The last stretch; the stepper stays on the main orbit. */
static int branch_off(nevh__branch *b, double h, double q[], double p[],
                      const nevh_observer observers[], size_t count) {
    nevh_stepper *s = b->stepper;
    b->h = h;
    int status = nevh__branch_step(b);
    memcpy(q, status ? b->q : b->q_end, state_size(s));
    memcpy(p, status ? b->p : b->p_end, state_size(s));
    if (!status) { /* what is shown includes what the last step gained */
        s->taken++;
        status =
            nevh__show(s, s->taken, true, b->t_end, q, p, observers, count);
    }
    nevh__branch_resume(b);
    if (status && s->taken == 0)
        nevh__undo(s);
    else
        nevh__remember(s, b->q, b->p);
    return status;
}

/* One step of the main orbit; *t in and out. */
static int own_step(nevh__branch *b, double h, double *t, double q[],
                    double p[]) {
    nevh_stepper *s = b->stepper;
    nevh__branch_keep(b, *t, q, p);
    int status = nevh__advance(s, *t, h, q, p);
    if (status)
        return status;
    b->elapsed = s->work.elapsed;
    *t = s->last_t;
    if (b->elapsed / h > 0)
        return NEVH_OK;
    nevh__branch_resume(b);
    memcpy(q, b->q, state_size(s));
    memcpy(p, b->p, state_size(s));
    return nevh__fail(&s->report, NEVH_EFAILED,
                      "%s: no time has passed in the step from t = %.9g by %g",
                      s->work.integrator->name, b->t, h);
}

/* Steps of the scheme's own time, until the next one would pass the end. */
static int run_own(nevh__branch *b, double h, double q[], double p[],
                   const nevh_observer observers[], size_t count) {
    nevh_stepper *s = b->stepper;
    double t = b->t, forward = h > 0 ? 1 : -1;
    int status = nevh__show(s, 0, t == b->t_end, t, q, p, observers, count);
    while (!status && t != b->t_end) {
        status = own_step(b, h, &t, q, p);
        if (status)
            break;
        if ((t - b->t_end) * forward > 0)
            return branch_off(b, h, q, p, observers, count);
        s->taken++;
        status =
            nevh__show(s, s->taken, t == b->t_end, t, q, p, observers, count);
    }
    nevh__end_run(s, q, p);
    return status;
}

/* `steps` steps that end at t_end to the last bit. */
static int run_whole(nevh__branch *b, double h, double steps, double q[],
                     double p[], const nevh_observer observers[],
                     size_t count) {
    nevh_stepper *s = b->stepper;
    double t0 = b->t, before = fmax(steps - 1, 0);
    int status = nevh__run_steps(s, t0, h, (size_t)before, steps == 0, q, p,
                                 observers, count);
    if (!status && steps > 0)
        status = nevh__advance(s, t0 + before * h, h, q, p);
    if (!status && steps > 0) {
        s->taken++;
        s->last_t = b->t_end;
        status =
            nevh__show(s, s->taken, true, b->t_end, q, p, observers, count);
    }
    nevh__end_run(s, q, p);
    return status;
}

/* Whole steps, and what is left. */
static int run_fixed(nevh__branch *b, double h, double q[], double p[],
                     const nevh_observer observers[], size_t count) {
    nevh_stepper *s = b->stepper;
    double t0 = b->t, steps;
    if (nevh__whole_steps(b->t_end - t0, &h, &steps))
        return run_whole(b, h, steps, q, p, observers, count);
    int status =
        nevh__run_steps(s, t0, h, (size_t)steps, false, q, p, observers, count);
    if (status) {
        nevh__end_run(s, q, p);
        return status;
    }
    nevh__branch_keep(b, t0 + steps * h, q, p);
    return branch_off(b, b->t_end - b->t, q, p, observers, count);
}

int nevh__span_check(nevh_stepper *s, double t0, double h, double t_end) {
    double steps = (t_end - t0) / h;
    if (steps >= 0 && steps < 0x1p53)
        return NEVH_OK;
    return nevh__fail(&s->report, NEVH_EINVAL,
                      "no number of steps of %g leads from %.9g to %.9g", h, t0,
                      t_end);
}

int nevh_run_until(nevh_stepper *s, double t0, double h, double t_end,
                   double q[], double p[], const nevh_observer observers[],
                   size_t count) {
    int status = nevh__begin_run(s, t0, h, q, p);
    if (status)
        return status;
    nevh__branch b = {.t = t0, .t_end = t_end};
    status = nevh__span_check(s, t0, h, t_end);
    if (!status)
        status = nevh__branch_open(&b, s);
    if (status)
        nevh__undo(s);
    else
        status =
            (s->own_time ? run_own : run_fixed)(&b, h, q, p, observers, count);
    nevh__branch_close(&b);
    return status;
}
