/* nevh: whether a solution ends before its time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"
#include <fenv.h>
#include <math.h>
#include <nevh/reference.h>
#include <stdio.h>
#include <stdlib.h>

typedef NEVH__FINE(nevh__series_orbit) orbit;

static const double most_work = 5e8; /* nanoseconds or so: half a second */

/* The fate of a run. */
typedef struct {
    double ends; /* when the solution itself ends; NAN */
    nevh__narrow narrow;
} fate;

/* Series up to the end, or `most` of them, or until their cost is beyond `work`, of which
   it is taken. */
static int ends_follow(orbit *o, double t1, double most, double *work,
                       fate *found, nevh__report *report) {
    double each = NEVH__FINE(nevh__series_orbit_work)(o);
    int status = NEVH_OK;
    most = fmin(most, *work / each);
    while (!status && (double)o->count < most &&
           fabs((double)(t1 - o->t)) > (double)o->reach)
        status = NEVH__FINE(nevh__series_orbit_next)(o, t1, report);
    *work -= each * (double)o->count;
    found->ends = status && o->ended ? (double)o->t : NAN;
    found->narrow = o->narrow;
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
                     double *work, fate *found, nevh__report *report) {
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
            status = ends_follow(&o, t1, by->most, work, found, report);
    }
    fesetenv(&own);
    NEVH__FINE(nevh__series_orbit_clear)(&o);
    nevh__recurrence_free(series);
    nevh_timing_free(timing);
    free(rates);
    return status;
}

/* In series of another tolerance. */
static fate fate_of(const nevh_system *s, double t0, double t1,
                    const double q[], const double p[], double tolerance,
                    double *work) {
    means fine = {tolerance, 1e-25, 1, INFINITY};
    nevh__report ignored = {0};
    fate found = {.ends = NAN};
    ends_walk(s, t0, t1, q, p, &fine, work, &found, &ignored);
    return found;
}

/* When it ends, or passes an end. */
static double time_of(const fate *f) {
    return isnan(f->ends) ? f->narrow.at : f->ends;
}

/* True if a run may have passed an end; it is another run that tells. */
static bool may_have_passed(const fate *f) {
    static const double shorter = 100;
    return isnan(f->ends) && nevh__narrow_is(&f->narrow, shorter);
}

/* An end that runs may pass, as where a pole is of even order: at no tolerance do two
   agree on how large the state becomes there.  NAN: they do, or it costs too much;
   INFINITY: nor on the time. */
static double passed_end(const nevh_system *s, double t0, double t1,
                         const double q[], const double p[]) {
    static const double first = 1e-16, smaller = 1e-7, other = 1. / 64;
    static const double rounding = 1e3; /* finest tolerances */
    static const double series = 64, later = 1e-3, alike = 1e-4;
    double finest = ldexp(1, -NEVH__FINE_BITS), work = 2 * most_work, t = NAN;
    for (double by = first; by * other > rounding * finest; by *= smaller) {
        fate one = fate_of(s, t0, t1, q, p, by, &work);
        t = time_of(&one);
        double on = fmax(later * fabs(t - t0), series * one.narrow.shortest);
        fate again =
            fate_of(s, t0, t + copysign(on, t1 - t0), q, p, by * other, &work);
        bool go_on = isnan(one.ends) && isnan(again.ends);
        if (!(work > 0) ||
            (go_on && !nevh__narrow_unlike(&one.narrow, &again.narrow)))
            return NAN;
    }
    fate last = fate_of(s, t0, t1, q, p, finest, &work);
    return fabs(time_of(&last) - t) <= alike * fabs(t - t0) ? time_of(&last)
                                                            : INFINITY;
}

/* Series of two tolerances must have the digits in common that are shown; where
   they do not, those of smaller ones, as far as numbers have digits. */
double nevh_solution_ends(const nevh_system *s, double t0, double t1,
                          const double q[], const double p[]) {
    static const double first = 1e-16, smaller = 1e-7, other = 1. / 64;
    static const double alike = 5e-7, later = 1e-3;
    double finest = ldexp(1, -NEVH__FINE_BITS), work = most_work;
    fate one = fate_of(s, t0, t1, q, p, first, &work);
    if (isnan(one.ends))
        return may_have_passed(&one) ? passed_end(s, t0, t1, q, p) : NAN;
    work = most_work;
    for (double by = first; by * other > finest && work > 0; by *= smaller) {
        if (by < first)
            one = fate_of(s, t0, t1, q, p, by, &work);
        if (isnan(one.ends))
            break;
        double until = one.ends + later * (one.ends - t0);
        fate again = fate_of(s, t0, until, q, p, by * other, &work);
        if (fabs(again.ends - one.ends) <= alike * fabs(one.ends - t0))
            return again.ends;
        if (may_have_passed(&again))
            return passed_end(s, t0, t1, q, p);
    }
    return INFINITY;
}

int nevh_solution_smooth(const nevh_system *s, double t0, double t1,
                         const double q[], const double p[], char why[],
                         size_t room) {
    static const double most = 5e3, most_pairs = 1e6; /* of variables, in all */
    double n = (double)nevh_system_dof(s);
    fate found = {.ends = NAN};
    means coarse = {1e-10, 1e-15, 1. / 128, fmin(most, most_pairs / (n * n))};
    double work = most_work;
    nevh__report report = {0};
    int status = ends_walk(s, t0, t1, q, p, &coarse, &work, &found, &report);
    bool over =
        isfinite(found.ends) ||
        (status == NEVH_EDOM && !isnan(nevh_solution_ends(s, t0, t1, q, p)));
    if (why && room > 0)
        snprintf(why, room, "%s", over ? "" : report.text);
    return over ? NEVH_OK : status;
}
