/* nevh: the driver.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"

/* Shows the state to the observers whose turn it is. */
static int show(nevh_stepper *s, size_t step, size_t steps, double t,
                const double q[], const double p[],
                const nevh_observer observers[], size_t count) {
    for (size_t i = 0; i < count; i++) {
        size_t every = observers[i].every ? observers[i].every : 1;
        if (step % every != 0 && step != steps)
            continue;
        if (observers[i].observe(observers[i].data, step, t, q, p))
            return nevh__fail(&s->report, NEVH_STOPPED,
                              "observer %zu stopped the run at t = %.9g", i, t);
    }
    return NEVH_OK;
}

/* The time after one more step: t0 + i h, or the sum of the times that the
   scheme took, with compensation. */
static double next_time(nevh_stepper *s, double t0, double h, double t) {
    if (!s->work.integrator->own_time)
        return t0 + (double)s->taken * h;
    double step = s->work.elapsed + s->time_lost, next = t + step;
    s->time_lost = step - (next - t);
    return s->last_t = next;
}

int nevh_run(nevh_stepper *s, double t0, double h, size_t steps, double q[],
             double p[], const nevh_observer observers[], size_t count) {
    int status = nevh__begin(s, t0, h, q, p);
    if (s)
        s->taken = 0;
    if (status)
        return status;
    double t = t0;
    s->time_lost = 0;
    status = show(s, 0, steps, t, q, p, observers, count);
    while (!status && s->taken < steps) {
        status = nevh__advance(s, t, h, q, p);
        if (status)
            break;
        s->taken++;
        t = next_time(s, t0, h, t);
        status = show(s, s->taken, steps, t, q, p, observers, count);
    }
    if (s->taken > 0)
        nevh__remember(s, q, p);
    else
        nevh__undo(s);
    return status;
}
