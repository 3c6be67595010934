/* nevh: states to digits that are certain.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/certain_inside_private.h"
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DIGITS = 30, ROOM = 60 };

#ifdef NEVH_QUADMATH
#include <quadmath.h>

typedef nevh__certain_orbit orbit;

/* So many digits pairs may do for. */
enum { DIGITS_OF_PAIRS = 24 };
/* The difference of two runs may be small by chance where rounding dominates. */
static const double amplified = 8;
/* Rounding alone, of a series: inner sums have 106 bits, pairs 104 or so. */
static const double rounding = 1e-32, rounding_of_pairs = 1e-31;

static void certain_clear(orbit *o) {
    nevh__series_orbit_clear_dd(&o->dd);
    nevh__series_orbit_clear_quad(&o->quad);
}

static int certain_start(nevh_certain *c, orbit *o, bool pairs,
                         double tolerance) {
    certain_clear(o);
    o->pairs = pairs;
    bool is_other = o == &c->coarse;
    nevh__recurrence *of = is_other ? c->other : c->recurrence;
    bool fine = o->pairs
                    ? nevh__series_orbit_init_dd(&o->dd, of, tolerance)
                    : nevh__series_orbit_init_quad(&o->quad, of, tolerance);
    if (fine && is_other && pairs)
        nevh__series_away_dd(o->dd.series, ldexp(1, -102));
    else if (fine && is_other)
        nevh__series_away_quad(o->quad.series, ldexp(1, -111));
    o->dd.timing = o->quad.timing = c->timing;
    o->dd.ending = o->quad.ending = c->ending;
    o->dd.backward = o->quad.backward = c->seen < (double)c->t0;
    const nevh__wide *start = is_other ? c->away : c->start;
    nevh__wide t0 = is_other ? c->t0_away : c->t0;
    return !fine ? nevh__no_memory(&c->report)
           : o->pairs
               ? nevh__series_orbit_start_dd(&o->dd, t0, start, &c->report)
               : nevh__series_orbit_start_quad(&o->quad, t0, start, &c->report);
}

int nevh__certain_run(nevh_certain *c, orbit *o, nevh__wide t) {
    return o->pairs ? nevh__series_orbit_go_dd(&o->dd, t, &c->report)
                    : nevh__series_orbit_go_quad(&o->quad, t, &c->report);
}

static nevh__wide state(const orbit *o, size_t k) {
    return o->pairs ? o->dd.state[k] : o->quad.state[k];
}

/* The largest value of a variable so far: at the beginnings of series, within them,
   and now. */
static double most(const orbit *o, size_t k) {
    double begun = o->pairs ? o->dd.seen[k] : o->quad.seen[k];
    return fmax(begun, fabs((double)state(o, k)));
}

static double term(const orbit *o, size_t k) {
    return o->pairs ? o->dd.term[k] : o->quad.term[k];
}

static size_t certain_count(const orbit *o) {
    return o->pairs ? o->dd.count : o->quad.count;
}

/* Steps alone round nothing at an equilibrium, such as x = pi. */
static void round_start(nevh_certain *c, bool pairs) {
    nevh__wide by = ldexp(1, pairs ? -103 : -110);
    for (size_t k = 0; k < 2 * c->n; k++) {
        nevh__wide x = c->start[k], y = c->computed[k];
        bool up = y > x || (y == x && k % 2);
        bool given = (double)x == x && x == y;
        c->away[k] = given ? y : y + (up ? by : -by) * fabsq(y);
    }
}

static int start_both(nevh_certain *c, bool pairs) {
    /* Errors of some hundred series add up. */
    static const double finest = 2e-33;
    c->finest = c->passed;
    double tolerance = c->finest ? finest : pow(10, -c->digits - 4);
    round_start(c, pairs);
    feclearexcept(FE_UNDERFLOW);
    int status =
        certain_start(c, &c->coarse, pairs, fmax(tolerance, 10 * finest));
    if (status)
        return status;
    c->at = 0;
    c->parted = INFINITY;
    status = certain_start(c, &c->fine, pairs, fmax(tolerance / 30, finest));
    c->underflows = fetestexcept(FE_UNDERFLOW) != 0;
    return status;
}

/* The start, and the same for the coarse run; false: memory is out. */
static bool take_starts(nevh_certain *c, const nevh__certain_start *from,
                        const nevh__certain_start *other) {
    size_t n = c->n, size = n * sizeof *c->start;
    c->start = nevh__array(6 * n, sizeof *c->start);
    if (!c->start)
        return false;
    c->computed = c->start + 2 * n;
    c->away = c->start + 4 * n;
    memcpy(c->start, from->q, size);
    memcpy(c->start + n, from->p, size);
    memcpy(c->computed, other->q, size);
    memcpy(c->computed + n, other->p, size);
    c->t0 = from->t;
    c->t0_away = other->t;
    c->seen = (double)c->t0;
    return true;
}

static int certain_make(nevh_certain *c, const nevh__certain_start *from,
                        const nevh__certain_start *other) {
    c->system = from->system;
    c->n = c->system->n;
    if (c->system->report.status)
        return nevh__fail_as(&c->report, &c->system->report);
    if (!from->q || !from->p || !isfinite((double)from->t))
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "an orbit needs a time and a state to start from");
    if (c->digits < 1 || c->digits > MOST_DIGITS)
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "%d digits: there are 1 to %d", c->digits,
                          MOST_DIGITS);
    if (!take_starts(c, from, other))
        return nevh__no_memory(&c->report);
    c->recurrence = nevh__recurrence_wide(c->system, from->rates, &c->report);
    if (other == from)
        c->other = c->recurrence;
    else if (c->recurrence)
        c->other =
            nevh__recurrence_wide(other->system, other->rates, &c->report);
    return c->other ? start_both(c, c->digits <= DIGITS_OF_PAIRS)
                    : c->report.status;
}

nevh_certain *nevh__certain_from(const nevh__certain_start *from,
                                 const nevh__certain_start *other, int digits) {
    nevh_certain *c = nevh__array(1, sizeof *c);
    if (!c)
        return NULL;
    c->digits = digits;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = certain_make(c, from, other);
    fesetenv(&own);
    if (status != NEVH_ENOMEM)
        return c;
    nevh_certain_free(c);
    return NULL;
}

nevh_certain *nevh_certain_new(const nevh_system *system, double t0,
                               const double q[], const double p[], int digits) {
    size_t n = system ? system->n : 0;
    nevh__wide *wide = nevh__array(3 * n, sizeof *wide);
    double *rates = nevh__array(n, sizeof *rates);
    nevh_certain *c = NULL;
    if (system && wide && rates) {
        bool damped = nevh_system_friction(system, rates);
        for (size_t k = 0; k < n; k++) {
            wide[k] = q ? q[k] : 0;
            wide[n + k] = p ? p[k] : 0;
            wide[2 * n + k] = rates[k];
        }
        nevh__certain_start from = {.system = system,
                                    .t = t0,
                                    .q = q ? wide : NULL,
                                    .p = p ? wide + n : NULL,
                                    .rates = damped ? wide + 2 * n : NULL};
        c = nevh__certain_from(&from, &from, digits);
    }
    free(wide);
    free(rates);
    return c;
}

void nevh_certain_free(nevh_certain *c) {
    if (!c)
        return;
    certain_clear(&c->fine);
    certain_clear(&c->coarse);
    if (c->other != c->recurrence)
        nevh__recurrence_free(c->other);
    nevh__recurrence_free(c->recurrence);
    nevh_timing_free(c->timing);
    free(c->start);
    free(c);
}

static double apart(const nevh_certain *c, size_t k) {
    return fabs((double)(state(&c->fine, k) - state(&c->coarse, k)));
}

static bool any_is_far(const nevh_certain *c, size_t from) {
    static const double far = 0.05; /* of what a variable was at most */
    static const double tiny =
        1e-25; /* of the largest: rounding, as of sin(pi) */
    double largest = 0;
    bool found = false;
    for (size_t k = from; k < from + c->n; k++)
        largest = fmax(largest, most(&c->fine, k));
    for (size_t k = from; k < from + c->n; k++)
        found = found || (apart(c, k) > far * most(&c->fine, k) &&
                          most(&c->fine, k) > tiny * largest);
    return found;
}

/* From then on what digits a variable has in common is chance.  Orbits part in coordinates and
   in momenta; momenta alone differ where they are rounding, at an equilibrium. */
static bool have_parted(const nevh_certain *c) {
    return any_is_far(c, 0) && any_is_far(c, c->n);
}

/* Some series further, or to t where that is nearer. */
static nevh__wide next_look(const nevh_certain *c, nevh__wide t) {
    static const int apart = 16; /* series */
    const orbit *o = &c->fine;
    nevh__wide now = c->t0 + c->at;
    nevh__wide by = apart * (o->pairs ? o->dd.reach : o->quad.reach);
    bool near = !(fabs((double)(t - now)) > (double)by) || now + by == now;
    return near ? t : t > now ? now + by : now - by;
}

/* The largest number that a state, or what is made of it, is multiplied by. */
static double largest_factor(const nevh_certain *c) {
    const orbit *o = &c->fine;
    nevh__wide t = c->t0 + c->at;
    double most = fmax(1, o->pairs ? o->dd.unit : o->quad.unit);
    for (size_t i = 0; i < c->recurrence->n_numbers; i++)
        most = fmax(most, fabs((double)c->recurrence->numbers[i]));
    return fmax(most, o->pairs ? nevh__series_largest_dd(
                                     o->dd.probe, t, o->dd.state, o->dd.probed)
                               : nevh__series_largest_quad(o->quad.probe, t,
                                                           o->quad.state,
                                                           o->quad.probed));
}

/* True if what is below 1e-308, where doubles end, may be all that there is of a force,
   as states are small or factors large. */
static bool is_lost(nevh_certain *c) {
    static const double enough = 1e-260;
    double least = INFINITY;
    for (size_t k = 0; c->underflows && k < 2 * c->n; k++)
        if (most(&c->fine, k) > 0)
            least = fmin(least, most(&c->fine, k));
    return c->underflows && !(least / largest_factor(c) > enough);
}

/* Begins new series of the coarse run on the way, at first from where its state is off
   by rounding: those of the start, and what rounding did to them, are the other run's. */
static int part_from_fine(nevh_certain *c, nevh__wide t) {
    static const double part = 0.5;
    orbit *o = &c->coarse;
    nevh__wide from = c->at == 0 ? c->t0_away : c->t0 + c->at;
    nevh__wide to = from + (t - from) * part;
    nevh__wide by = c->at == 0 ? ldexp(1, o->pairs ? -104 : -111) : 0;
    int status = nevh__certain_run(c, o, to);
    nevh__wide *state = o->pairs ? o->dd.state : o->quad.state;
    for (size_t k = 0; !status && k < 2 * c->n; k++)
        state[k] *= k % 2 ? 1 + by : 1 - by;
    c->renewed = fabs((double)(t - c->t0));
    if (!status)
        status = o->pairs ? nevh__series_orbit_start_dd(&o->dd, to, state,
                                                        &c->report)
                          : nevh__series_orbit_start_quad(&o->quad, to, state,
                                                          &c->report);
    return status;
}

static int go_both(nevh_certain *c, nevh__wide t) {
    static const double later = 8;
    int status = NEVH_OK;
    for (bool there = false; !status && !there;) {
        feclearexcept(FE_UNDERFLOW);
        nevh__wide next = next_look(c, t);
        there = next == t;
        if (c->at == 0 || fabs((double)(next - c->t0)) > later * c->renewed)
            status = part_from_fine(c, next);
        if (!status)
            status = nevh__certain_run(c, &c->coarse, next);
        if (!status)
            status = nevh__certain_run(c, &c->fine, next);
        c->at = (double)(next - c->t0);
        if (!status && isinf(c->parted))
            status = nevh__certain_passed(c);
        if (!status && have_parted(c))
            c->parted = fmin(c->parted, fabs(c->at));
        c->underflows |= fetestexcept(FE_UNDERFLOW) != 0;
    }
    c->lost = !status && is_lost(c);
    return status;
}

/* True if a variable's error exceeds the requested digits, relative to its largest
   value. */
static bool lacks_digits(const nevh_certain *c) {
    bool lacks = false;
    for (size_t k = 0; k < 2 * c->n; k++)
        lacks = lacks || nevh_certain_error(c, k) >
                             0.5 * pow(10, -c->digits) * most(&c->fine, k);
    return lacks;
}

/* NULL: memory is out. */
static nevh_timing *timing_until(const nevh_certain *c, double t) {
    size_t n = c->n;
    double *state = nevh__array(2 * n, sizeof *state);
    for (size_t k = 0; state && k < 2 * n; k++)
        state[k] = (double)c->start[k];
    nevh_timing *timing =
        state ? nevh_timing_new(c->system, (double)c->t0, t, state, state + n)
              : NULL;
    free(state);
    return timing;
}

/* Plans the dependence of H on time up to there, and as far again, so that many
   short calls plan seldom; orbits begin again if it was not known. */
static int look_ahead(nevh_certain *c, double t) {
    double t0 = (double)c->t0;
    bool known =
        fabs(t - t0) <= fabs(c->seen - t0) && (t - t0) * (c->seen - t0) >= 0;
    if (known || nevh_system_traits(c->system) & NEVH_AUTONOMOUS)
        return NEVH_OK;
    double seen = t0 + 2 * (t - t0);
    nevh_timing *timing = timing_until(c, seen);
    if (timing && !nevh_timing_whole(timing)) {
        nevh_timing_free(timing);
        timing = timing_until(c, seen = t);
    }
    if (!timing)
        return nevh__no_memory(&c->report);
    if (!nevh_timing_whole(timing)) {
        nevh_timing_free(timing);
        return nevh__fail(&c->report, NEVH_EFAILED,
                          "H changes too often between t = %.9g and %.9g to "
                          "be certain that no change is missed",
                          t0, t);
    }
    certain_clear(&c->fine),
        certain_clear(&c->coarse); /* they borrow the former one */
    nevh_timing_free(c->timing);
    c->timing = timing;
    c->seen = seen;
    return start_both(c, c->fine.pairs);
}

void nevh_certain_stop_at(nevh_certain *c,
                          const volatile sig_atomic_t *ending) {
    if (!c)
        return;
    c->ending = ending;
    c->fine.dd.ending = c->fine.quad.ending = ending;
    c->coarse.dd.ending = c->coarse.quad.ending = ending;
}

/* True if numbers with more digits, or smaller tolerances, may tell more. */
static bool may_do_better(const nevh_certain *c, int status) {
    bool ended = c->ending && *c->ending;
    bool poor = status == NEVH_EFAILED || (!status && lacks_digits(c));
    return !ended && ((c->fine.pairs && poor) || c->passed > c->finest);
}

int nevh_certain_go_to(nevh_certain *c, double time, long double rest) {
    nevh__wide t = (nevh__wide)time + rest;
    if (!c || !certain_count(&c->fine))
        return nevh_certain_status(c);
    c->report = (nevh__report){0};
    if (!isfinite((double)t))
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "the time %g is not a finite number", (double)t);
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = look_ahead(c, (double)t);
    if (!status)
        status = nevh__certain_end(c, go_both(c, t));
    while (may_do_better(c, status)) {
        c->report = (nevh__report){0};
        status = start_both(c, false);
        status = status ? status : nevh__certain_end(c, go_both(c, t));
    }
    fesetenv(&own);
    return status;
}

size_t nevh_certain_series(const nevh_certain *c) {
    return c ? certain_count(&c->fine) + certain_count(&c->coarse) : 0;
}

static bool certain_has(const nevh_certain *c, size_t k) {
    return c && certain_count(&c->fine) && k < 2 * c->n;
}

double nevh_certain_value(const nevh_certain *c, size_t k) {
    return certain_has(c, k) ? (double)state(&c->fine, k) : NAN;
}

double nevh_certain_error(const nevh_certain *c, size_t k) {
    if (!certain_has(c, k))
        return NAN;
    double once = c->fine.pairs ? rounding_of_pairs : rounding;
    double size = fmax(most(&c->fine, k), term(&c->fine, k));
    double floor = once * sqrt((double)certain_count(&c->fine)) * size;
    if (c->underflows)
        floor = fmax(floor, DBL_MIN);
    if (fabs(c->at) >= c->parted || c->lost)
        floor = 2 * most(&c->fine, k);
    return fmax(amplified * apart(c, k), floor);
}

double nevh_certain_size(const nevh_certain *c, size_t k) {
    return certain_has(c, k) ? most(&c->fine, k) : NAN;
}

int nevh_certain_digits(const nevh_certain *c, size_t k) {
    double value = fabs(nevh_certain_value(c, k));
    double error = nevh_certain_error(c, k);
    if (!(value > error))
        return 0;
    if (error == 0)
        return c->digits;
    double digits = floor(log10(value / error) - log10(0.5));
    digits = digits < 0 ? 0 : digits;
    return digits < c->digits ? (int)digits : c->digits;
}

char *nevh_certain_text(const nevh_certain *c, size_t k) {
    char *text = certain_has(c, k) ? nevh__array(ROOM, 1) : NULL;
    int digits = nevh_certain_digits(c, k);
    if (text)
        strcpy(text, "0");
    if (text && digits > 0)
        quadmath_snprintf(text, ROOM, digits > 1 ? "%#.*Qg" : "%.*Qg", digits,
                          state(&c->fine, k));
    return text;
}

char *nevh_certain_number(double number, long double rest) {
    char *text = nevh__array(ROOM, 1);
    if (text)
        quadmath_snprintf(text, ROOM, "%.*Qg", MOST_DIGITS,
                          (nevh__wide)number + rest);
    return text;
}

NEVH__REPORTS(certain)

int nevh_certain_go(nevh_certain *c, double t) {
    return nevh_certain_go_to(c, t, 0);
}
#endif
