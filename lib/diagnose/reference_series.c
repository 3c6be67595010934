/* nevh: a reference by Taylor series.

   Two runs that differ in order and tolerance go side by side.  The series of
   the finer one are kept: the state at any time is a value of one of them.  Where
   the orbit makes the difference grow beyond what is wanted, both are taken again
   with tolerances that are smaller by as much.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_private.h"
#include "system/print_private.h"
#include "taylor/orbit_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef NEVH__FINE(nevh__series_orbit) orbit;

static const double usual = 1e-20; /* tolerance of the finer run */
static const double finer = 10;    /* than the other one */
static const double apart = 1e-3;  /* as the header says */
static const double certain = 2;   /* the difference times this is the error */
static const double most_work = 3e9; /* of two runs: about three seconds */
enum { LOOKS = 6, MOST_KEPT = 64 << 20 };

struct nevh__reference_series {
    nevh__recurrence *recurrence;
    orbit fine, coarse;
    double *rates;
    double until; /* where it is to end, or where runs were not yet apart */
    bool parts;
    double limit;    /* of the difference, in ranges, for it to go on */
    double foreseen; /* series; 0: not known */
    size_t rows;     /* numbers of a series */
    size_t each, count, capacity; /* each: numbers kept of one */
    bool thin;                    /* its first row alone is kept */
    double *parted;     /* of both, where each series begins, in ranges */
    long double *kept;  /* the time since t0 when it begins, what rounding took
                           from that, and its rows */
    long double *shown; /* the rows of one series */
    size_t at;          /* which one */
    long double *value; /* 2n */
    double *difference; /* 2n: the largest so far */
};
typedef struct nevh__reference_series chain;
enum { TIMES = 2 }; /* before the rows */

void nevh__reference_series_free(chain *c) {
    if (!c)
        return;
    NEVH__FINE(nevh__series_orbit_clear)(&c->fine);
    NEVH__FINE(nevh__series_orbit_clear)(&c->coarse);
    nevh__recurrence_free(c->recurrence);
    free(c->rates);
    free(c->kept);
    free(c->shown);
    free(c->value);
    free(c->parted);
    free(c->difference);
    free(c);
}

static double work_of(const chain *c) {
    return NEVH__FINE(nevh__series_orbit_work)(&c->fine) +
           NEVH__FINE(nevh__series_orbit_work)(&c->coarse);
}

/* The memory of as many thin series. */
static double bytes_of(const nevh_reference *r, double series) {
    return series * (double)((TIMES + 2 * r->n) * sizeof(long double));
}

/* The longest series.  A series detects a narrow part of H from about ten times its
   width; it must not pass one that the compared runs would find. */
static double reference_series_longest(const nevh_reference *r,
                                       const chain *c) {
    static const double steps = 8, fewest = 128;
    double span = fabs(r->t1 - r->t0);
    double most = fmin(most_work / work_of(c), MOST_KEPT / bytes_of(r, 1)) / 4;
    double shortest = r->longest > 0 ? steps * r->longest : span / fewest;
    return fmin(fmax(shortest, span / most), span / fewest);
}

static int reference_series_plan(nevh_reference *r, chain *c,
                                 double tolerance) {
    bool damped = nevh_system_friction(r->system, c->rates);
    c->recurrence = nevh__recurrence_new(r->system, damped ? c->rates : NULL,
                                         r->timing, &r->report);
    r->may_jump = c->recurrence && nevh__domain_may_jump(c->recurrence);
    if (!c->recurrence)
        return r->report.status;
    bool made =
        NEVH__FINE(nevh__series_orbit_init)(&c->fine, c->recurrence, tolerance);
    made = NEVH__FINE(nevh__series_orbit_init)(&c->coarse, c->recurrence,
                                               finer * tolerance) &&
           made;
    if (!made)
        return nevh__no_memory(&r->report);
    c->rows = 2 * r->n * (c->fine.order + 1);
    c->each = TIMES + c->rows;
    c->shown = nevh__array(c->rows, sizeof *c->shown);
    c->fine.longest = c->coarse.longest = reference_series_longest(r, c);
    c->fine.timing = c->coarse.timing = r->timing;
    c->fine.backward = c->coarse.backward = r->t1 < r->t0;
    return c->shown ? NEVH_OK : nevh__no_memory(&r->report);
}

static int reference_series_start(nevh_reference *r, chain *c) {
    nevh__wide *state = nevh__array(2 * r->n, sizeof *state);
    if (!state)
        return nevh__no_memory(&r->report);
    for (size_t k = 0; k < 2 * r->n; k++)
        state[k] = r->start[k];
    int status = NEVH__FINE(nevh__series_orbit_start)(&c->coarse, r->t0, state,
                                                      &r->report);
    if (!status)
        status = NEVH__FINE(nevh__series_orbit_start)(&c->fine, r->t0, state,
                                                      &r->report);
    free(state);
    return status;
}

/* Only where series begin, from which their rows follow. */
static void make_thin(const nevh_reference *r, chain *c) {
    size_t each = TIMES + 2 * r->n;
    for (size_t i = 1; i < c->count; i++)
        memmove(c->kept + i * each, c->kept + i * c->each,
                each * sizeof *c->kept);
    c->each = each;
    c->thin = true;
}

static bool reference_series_make_room(const nevh_reference *r, chain *c) {
    if (!c->thin && (c->count + 1) * c->each > MOST_KEPT / sizeof *c->kept)
        make_thin(r, c);
    if (c->count < c->capacity)
        return true;
    size_t capacity = 2 * c->capacity + 16;
    long double *kept = nevh__grow(c->kept, capacity * c->each, sizeof *kept);
    c->kept = kept ? kept : c->kept;
    double *parted = nevh__grow(c->parted, capacity, sizeof *parted);
    c->parted = parted ? parted : c->parted;
    if (!kept || !parted)
        return false;
    c->capacity = capacity;
    return true;
}

static bool reference_series_keep(const nevh_reference *r, chain *c) {
    if (!reference_series_make_room(r, c))
        return false;
    long double *to = c->kept + c->count * c->each;
    nevh__wide passed = c->fine.t - r->t0;
    to[0] = (long double)passed;
    to[1] = (long double)(passed - to[0]);
    NEVH__FINE(nevh__series_orbit_rows)(&c->fine, c->shown);
    memcpy(to + TIMES, c->shown, (c->each - TIMES) * sizeof *to);
    c->at = c->count++;
    return true;
}

/* The rows of one series. */
static const long double *reference_series_rows_of(const nevh_reference *r,
                                                   chain *c, size_t i) {
    const long double *kept = c->kept + i * c->each;
    if (!c->thin)
        return kept + TIMES;
    if (c->at == i)
        return c->shown;
    for (size_t k = 0; k < 2 * r->n; k++)
        c->fine.state[k] = kept[TIMES + k];
    nevh__report ignored = {0}; /* it was finite before */
    NEVH__FINE(nevh__series_orbit_start)
    (&c->fine, (nevh__wide)r->t0 + kept[0] + kept[1], c->fine.state, &ignored);
    NEVH__FINE(nevh__series_orbit_rows)(&c->fine, c->shown);
    c->at = i;
    return c->shown;
}

/* From one of the series. */
static void value_at(const nevh_reference *r, chain *c, size_t which,
                     long double elapsed, long double state[]) {
    size_t each = 2 * r->n, order = c->fine.order;
    const long double *kept = c->kept + which * c->each;
    const long double *rows = reference_series_rows_of(r, c, which);
    long double since = (elapsed - kept[0]) - kept[1];
    for (size_t i = 0; i < each; i++) {
        const long double *row = rows + order * each + i;
        long double sum = *row;
        for (size_t k = order; k-- > 0;)
            sum = sum * since + *(row -= each);
        state[i] = sum;
    }
}

static void reference_series_widen(nevh_reference *r,
                                   const long double state[]) {
    for (size_t k = 0; k < 2 * r->n; k++)
        r->walked[k] = (double)state[k];
    nevh__reference_widen(r, r->low, r->high, r->walked);
}

/* Extremes within the last series, as far as it is used. */
static void reference_series_look(nevh_reference *r, chain *c) {
    size_t last = c->count - 1;
    long double span = (long double)c->until - r->t0;
    long double step = copysignl((long double)c->fine.reach, span);
    for (int i = 0; i <= LOOKS; i++) {
        long double elapsed = c->kept[last * c->each] + step * i / LOOKS;
        if ((elapsed - span) * (span > 0 ? 1 : -1) > 0)
            elapsed = span;
        value_at(r, c, last, elapsed, c->value);
        reference_series_widen(r, c->value);
    }
}

/* The largest difference of both, in ranges up to there; counted where they
   continue. */
static double reference_series_compare(nevh_reference *r, chain *c) {
    const nevh__wide *state = c->fine.state; /* where the series begins */
    double most = 0;
    nevh__reference_scale(r, r->low, r->high, r->range);
    for (size_t k = 0; k < 2 * r->n; k++) {
        double by = fabs((double)(state[k] - c->coarse.state[k]));
        most = fmax(most, by / r->range[k]);
    }
    for (size_t k = 0; most <= c->limit && k < 2 * r->n; k++) {
        double by = fabs((double)(state[k] - c->coarse.state[k]));
        c->difference[k] = fmax(c->difference[k], by);
    }
    return most;
}

/* So many series tell how many there will be. */
enum { FEW = 16 };

static int cost_too_much(nevh_reference *r, const chain *c) {
    return nevh__fail(
        &r->report, NEVH_EFAILED,
        "Taylor series cost too much for a reference until t = %.9g", c->until);
}

/* True if both can be continued to the end. */
static bool affordable(const nevh_reference *r, const chain *c) {
    double part = (double)(c->fine.t - r->t0) / (c->until - r->t0);
    double series = (double)c->count / fmax(part, 1e-300);
    if (c->count < FEW)
        return true;
    if (c->foreseen > 0)
        series = fmax(c->foreseen, (double)c->count);
    return bytes_of(r, series) <= MOST_KEPT &&
           (series * work_of(c) <= most_work || r->integrator == nevh_taylor);
}

/* Ends the reference at the beginning of the last series that was close to the
   other run. */
static int part_at(nevh_reference *r, chain *c) {
    c->parts = true;
    c->until = r->t0 + (double)c->kept[(c->count - 2) * c->each];
    return c->until != r->t0 ? NEVH_OK
                             : nevh__fail(&r->report, NEVH_EFAILED,
                                          "two Taylor series part within one "
                                          "step");
}

/* Side by side, to the end or to where they part. */
static int reference_series_run(nevh_reference *r, chain *c) {
    int status =
        reference_series_keep(r, c) ? NEVH_OK : nevh__no_memory(&r->report);
    double forward = c->until > r->t0 ? 1 : -1;
    if (!status)
        reference_series_look(r, c);
    while (!status && (c->until - c->fine.t) * forward > c->fine.reach) {
        status =
            NEVH__FINE(nevh__series_orbit_next)(&c->fine, c->until, &r->report);
        if (!status)
            status = NEVH__FINE(nevh__series_orbit_go)(&c->coarse, c->fine.t,
                                                       &r->report);
        if (!status && !reference_series_keep(r, c))
            status = nevh__no_memory(&r->report);
        if (status)
            break;
        reference_series_look(r, c);
        double by = c->parted[c->count - 1] = reference_series_compare(r, c);
        if (!affordable(r, c))
            return cost_too_much(r, c);
        if (by > c->limit)
            return part_at(r, c);
    }
    if (!status)
        status =
            NEVH__FINE(nevh__series_orbit_go)(&c->coarse, c->until, &r->report);
    if (!status)
        status =
            NEVH__FINE(nevh__series_orbit_go)(&c->fine, c->until, &r->report);
    if (!status)
        reference_series_compare(r, c);
    return status;
}

/* Finds whether the solution ends at the time at which series got too short. */
static void find_end(nevh_reference *r, double t) {
    double ends =
        nevh_solution_ends(r->system, r->t0, r->t1, r->start, r->start + r->n);
    r->ends = isfinite(ends) ? ends : NAN;
    if (isnan(ends))
        nevh__fail(&r->report, NEVH_EFAILED,
                   "series get too short near t = %.9g, in a close encounter",
                   t);
    else if (isinf(ends))
        nevh__fail(&r->report, NEVH_EFAILED,
                   "the orbit is not known far enough to tell whether it ends");
}

/* Fails where runs have parted at an end of the solution. */
static int refuse_passed(nevh_reference *r, const chain *c) {
    static const double shorter = 100;
    if (!c->parts || !nevh__narrow_is(&c->fine.narrow, shorter))
        return NEVH_OK;
    double ends =
        nevh_solution_ends(r->system, r->t0, r->t1, r->start, r->start + r->n);
    if (!isfinite(ends))
        return NEVH_OK;
    r->ends = ends;
    return nevh__fail(&r->report, NEVH_EFAILED,
                      "the solution itself ends at t = %.6g: it changes "
                      "without bound there",
                      ends);
}

static bool reference_series_allocate(const nevh_reference *r, chain *c) {
    c->rates = nevh__array(r->n, sizeof *c->rates);
    c->value = nevh__array(2 * r->n, sizeof *c->value);
    c->difference = nevh__array(2 * r->n, sizeof *c->difference);
    return c->rates && c->value && c->difference;
}

/* A series run of that tolerance; NULL, with the reason in the report.
   first  a coarser one, or NULL */
static chain *chain_new(nevh_reference *r, double tolerance,
                        const chain *first) {
    bool parted = first && first->parts;
    chain *c = nevh__array(1, sizeof *c);
    if (!c || !reference_series_allocate(r, c)) {
        nevh__reference_series_free(c);
        nevh__no_memory(&r->report);
        return NULL;
    }
    c->until = parted ? first->until : r->t1;
    c->limit = parted ? nevh__reference_wanted / certain : apart;
    c->foreseen = first ? (double)first->count : 0;
    int status = reference_series_plan(r, c, tolerance);
    if (!status && r->integrator != nevh_taylor && FEW * work_of(c) > most_work)
        status = cost_too_much(r, c);
    if (!status)
        status = reference_series_start(r, c);
    if (!status)
        status = reference_series_run(r, c);
    if (!status)
        status = refuse_passed(r, c);
    if (!status)
        return c;
    if (c->fine.ended || c->coarse.ended)
        find_end(r, (double)c->fine.t);
    nevh__reference_series_free(c);
    return NULL;
}

/* Breaks in time are known to a few roundings of t, while the state goes on as
   before. */
static double error_of_breaks(const nevh_reference *r) {
    double late = 0, span = fabs(r->t1 - r->t0);
    for (size_t i = 0; i < nevh_timing_breaks(r->timing); i++) {
        nevh_time_break b = nevh_timing_break(r->timing, i);
        late += b.after - b.before;
    }
    return late / span;
}

static double error_of(const nevh_reference *r, const chain *c) {
    double error = fmax(DBL_EPSILON, error_of_breaks(r));
    for (size_t k = 0; k < 2 * r->n; k++)
        error = fmax(error, certain * c->difference[k] / r->range[k]);
    return error;
}

/* Sets the horizon from the first runs, which have separated. */
static void end_at(nevh_reference *r, const chain *c) {
    double reached = c->until - r->t0, parted = 0;
    for (size_t i = 1; i < c->count; i++)
        parted = fmax(parted, c->parted[i]);
    r->horizon = c->until;
    r->growth = parted / (finer * usual);
    r->exponent = log(r->growth) / fabs(reached);
    r->end = nevh__reference_is_chaotic(r, reached, NULL)
                 ? NEVH_REFERENCE_CHAOS
                 : NEVH_REFERENCE_SENSITIVE;
}

/* Tolerances that make up for what the orbit does to differences, as far as the
   numbers have digits; where runs have parted, to where they did and no further
   than the error is as wanted. */
static void reference_series_refine(nevh_reference *r) {
    double finest = ldexp(1, -NEVH__FINE_BITS);
    double error = error_of(r, r->series);
    double tolerance =
        usual * fmin(nevh__reference_wanted / (4 * error), 1 / finer);
    if (error <= nevh__reference_wanted || finest > usual / finer)
        return;
    chain *c = chain_new(r, fmax(tolerance, finest), r->series);
    bool better = c && error_of(r, c) < error;
    nevh__reference_series_free(better ? r->series : c);
    if (better)
        r->series = c;
    if (better && c->parts)
        r->horizon = c->until;
}

static void reference_series_describe(nevh_reference *r, bool dear) {
    nevh__reference_scale(r, r->low, r->high, r->range);
    r->error = error_of(r, r->series);
    const char *why = dear
                          ? " (a smaller one costs too much)"
                          : " (the digits of its numbers allow no smaller one)";
    int used =
        nevh__print(r->text, sizeof r->text,
                    "taylor in %d bits, own error %.0e%s", NEVH__FINE_BITS,
                    r->error, r->error > nevh__reference_wanted ? why : "");
    size_t left = sizeof r->text - (size_t)used;
    if (isfinite(r->horizon))
        nevh__print(r->text + used, left, ", until %st = %.4g",
                    r->end == NEVH_REFERENCE_CHAOS ? "chaos at " : "",
                    r->horizon);
}

int nevh__reference_series(nevh_reference *r) {
    if (r->timing && !nevh_timing_whole(r->timing))
        return nevh__fail(&r->report, NEVH_EFAILED,
                          "H changes too often between t = %.9g and %.9g for "
                          "Taylor series to see each change",
                          r->t0, r->t1);
    r->series = chain_new(r, usual, NULL);
    if (r->series && r->series->parts)
        end_at(r, r->series);
    if (r->series)
        reference_series_refine(r);
    if (!r->series || r->report.status == NEVH_ENOMEM) {
        memcpy(r->low, r->start, 2 * r->n * sizeof *r->low);
        memcpy(r->high, r->start, 2 * r->n * sizeof *r->high);
        return r->report.status;
    }
    reference_series_describe(r, r->report.status == NEVH_EFAILED);
    r->report = (nevh__report){0};
    r->integrator = nevh_taylor;
    return NEVH_OK;
}

void nevh__reference_series_state(const nevh_reference *r, long double elapsed,
                                  long double state[]) {
    chain *c = r->series;
    size_t from = 0, until = c->count;
    long double forward = r->t1 > r->t0 ? 1 : -1;
    while (until - from > 1) {
        size_t middle = from + (until - from) / 2;
        bool later = (elapsed - c->kept[middle * c->each]) * forward >= 0;
        *(later ? &from : &until) = middle;
    }
    value_at(r, c, from, elapsed, state);
}
