/* nevh: whether a solution ends before its time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"
#include <fenv.h>
#include <math.h>
#include <nevh/reference.h>
#include <stdio.h>
#include <stdlib.h>

typedef NEVH__FINE(nevh__series_orbit) orbit;

/* Series up to the end, or `most` of them, or until they have cost a second or so.
   *ends is the time where the solution itself ends. */
static int ends_follow(orbit *o, double t1, double most, double *ends,
                       nevh__report *report) {
    static const double most_work = 5e8; /* nanoseconds or so */
    int status = NEVH_OK;
    most = fmin(most, most_work / NEVH__FINE(nevh__series_orbit_work)(o));
    while (!status && (double)o->count < most &&
           fabs((double)(t1 - o->t)) > (double)o->reach)
        status = NEVH__FINE(nevh__series_orbit_next)(o, t1, report);
    *ends = status && o->ended ? (double)o->t : NAN;
    return status;
}

static int ends_start(orbit *o, double t0, const double q[], const double p[],
                      nevh__report *report) {
    size_t n = o->n;
    nevh__wide *state = nevh__array(2 * n, sizeof *state);
    for (size_t k = 0; state && k < n; k++)
        state[k] = q[k], state[n + k] = p[k];
    int status =
        state ? NEVH__FINE(nevh__series_orbit_start)(o, t0, state, report)
              : NEVH_ENOMEM;
    free(state);
    return status;
}

/* The tolerance of series, the shortest and the longest as parts of the time, and
   their number. */
typedef struct {
    double tolerance, shortest, longest, most;
} means;

static int ends_walk(const nevh_system *s, double t0, double t1,
                     const double q[], const double p[], const means *by,
                     double *ends, nevh__report *report) {
    size_t n = nevh_system_dof(s);
    double *rates = s ? nevh__array(n, sizeof *rates) : NULL;
    bool timed = s && !(nevh_system_traits(s) & NEVH_AUTONOMOUS);
    nevh_timing *timing = timed ? nevh_timing_new(s, t0, t1, q, p) : NULL;
    orbit o = {0};
    int status = NEVH_ENOMEM;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool damped = rates && nevh_system_friction(s, rates);
    nevh__recurrence *series =
        rates ? nevh__recurrence_new(s, damped ? rates : NULL, timed, report)
              : NULL;
    if (!series && rates)
        status = report->status;
    if (series &&
        NEVH__FINE(nevh__series_orbit_init)(&o, series, by->tolerance)) {
        o.longest = by->longest * fabs(t1 - t0);
        o.shortest = by->shortest;
        o.timing = timing;
        o.backward = t1 < t0;
        status = ends_start(&o, t0, q, p, report);
        if (!status)
            status = ends_follow(&o, t1, by->most, ends, report);
    }
    fesetenv(&own);
    NEVH__FINE(nevh__series_orbit_clear)(&o);
    nevh__recurrence_free(series);
    nevh_timing_free(timing);
    free(rates);
    return status;
}

double nevh_solution_ends(const nevh_system *s, double t0, double t1,
                          const double q[], const double p[]) {
    static const means fine = {1e-16, 1e-25, 1, INFINITY};
    nevh__report ignored = {0};
    double ends = NAN;
    ends_walk(s, t0, t1, q, p, &fine, &ends, &ignored);
    return ends;
}

int nevh_solution_smooth(const nevh_system *s, double t0, double t1,
                         const double q[], const double p[], char why[],
                         size_t room) {
    static const double most = 5e3, most_pairs = 1e6; /* of variables, in all */
    double n = (double)nevh_system_dof(s), ends = NAN;
    means coarse = {1e-10, 1e-15, 1. / 128, fmin(most, most_pairs / (n * n))};
    nevh__report report = {0};
    int status = ends_walk(s, t0, t1, q, p, &coarse, &ends, &report);
    bool over =
        isfinite(ends) ||
        (status == NEVH_EDOM && isfinite(nevh_solution_ends(s, t0, t1, q, p)));
    if (why && room > 0)
        snprintf(why, room, "%s", over ? "" : report.text);
    return over ? NEVH_OK : status;
}
