/* nevh: whether a solution ends before its time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"
#include <fenv.h>
#include <math.h>
#include <nevh/reference.h>
#include <stdlib.h>

typedef NEVH__FINE(nevh__series_orbit) orbit;

/* Series up to the end, or until they have cost a second or so. */
static double follow(orbit *o, double t1) {
    static const double most_work = 5e8; /* nanoseconds or so */
    double most = most_work / NEVH__FINE(nevh__series_orbit_work)(o);
    nevh__report ignored = {0};
    while ((double)o->count < most &&
           fabs((double)(t1 - o->t)) > (double)o->reach)
        if (NEVH__FINE(nevh__series_orbit_next)(o, t1, &ignored))
            return o->ended ? (double)o->t : NAN;
    return NAN;
}

static bool start(orbit *o, double t0, const double q[], const double p[]) {
    size_t n = o->n;
    nevh__wide *state = nevh__array(2 * n, sizeof *state);
    nevh__report ignored = {0};
    for (size_t k = 0; state && k < n; k++)
        state[k] = q[k], state[n + k] = p[k];
    bool started =
        state && !NEVH__FINE(nevh__series_orbit_start)(o, t0, state, &ignored);
    free(state);
    return started;
}

double nevh_solution_ends(const nevh_system *s, double t0, double t1,
                          const double q[], const double p[]) {
    static const double tolerance = 1e-16, shortest = 1e-25;
    size_t n = nevh_system_dof(s);
    double ends = NAN, *rates = s ? nevh__array(n, sizeof *rates) : NULL;
    bool timed = s && !(nevh_system_traits(s) & NEVH_AUTONOMOUS);
    nevh_timing *timing = timed ? nevh_timing_new(s, t0, t1, q, p) : NULL;
    nevh__report ignored = {0};
    orbit o = {0};
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool damped = rates && nevh_system_friction(s, rates);
    nevh__recurrence *series =
        rates ? nevh__recurrence_new(s, damped ? rates : NULL, timed, &ignored)
              : NULL;
    if (series && NEVH__FINE(nevh__series_orbit_init)(&o, series, tolerance)) {
        o.longest = fabs(t1 - t0);
        o.shortest = shortest;
        o.timing = timing;
        o.backward = t1 < t0;
        if (start(&o, t0, q, p))
            ends = follow(&o, t1);
    }
    fesetenv(&own);
    NEVH__FINE(nevh__series_orbit_clear)(&o);
    nevh__recurrence_free(series);
    nevh_timing_free(timing);
    free(rates);
    return ends;
}
