/* nevh: a reference by Taylor series in long doubles.

   Two runs that differ in order and tolerance go side by side.  The series of
   the finer one are kept: the state at any time is a value of one of them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_private.h"
#include "taylor/orbit_private.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double fine = 1e-20, coarse = 1e-19; /* tolerances */
static const double apart = 1e-3;                 /* as the header says */
static const double most_work = 4e8;              /* about a second */
enum { LOOKS = 6, MOST_KEPT = 64 << 20 };

struct nevh__reference_series {
    nevh__recurrence *recurrence;
    nevh__orbit_long fine, coarse;
    double *rates;
    size_t each, count, capacity; /* each: numbers of a series */
    double *parted;     /* of both, where each series begins, in ranges */
    long double *kept;  /* the time since t0 when it begins, and its rows */
    double *difference; /* 2n: the largest so far */
};
typedef struct nevh__reference_series chain;

void nevh__reference_series_free(chain *c) {
    if (!c)
        return;
    nevh__orbit_clear_long(&c->fine);
    nevh__orbit_clear_long(&c->coarse);
    nevh__recurrence_free(c->recurrence);
    free(c->rates);
    free(c->kept);
    free(c->parted);
    free(c->difference);
    free(c);
}

/* In nanoseconds, or so; on any machine the same. */
static double work_of(const nevh__orbit_long *o) {
    const nevh__recurrence *r = o->recurrence;
    double order = (double)o->order;
    double sums = (double)(r->used[0] + r->used[1]) * order * order / 2;
    return sums + order * (2 * (double)r->values + 20) + 500;
}

static double bytes_of(const chain *c) {
    return (double)(c->each * sizeof(long double));
}

/* What is narrow, a series sees from some ten times its width away: it is not to
   be passed where the runs that are compared would find it. */
static double longest(const nevh_reference *r, const chain *c) {
    static const double steps = 8, fewest = 128;
    double span = fabs(r->t1 - r->t0);
    double work = work_of(&c->fine) + work_of(&c->coarse);
    double most = fmin(most_work / work, MOST_KEPT / bytes_of(c)) / 4;
    double wanted = r->longest > 0 ? steps * r->longest : span / fewest;
    return fmin(fmax(wanted, span / most), span / fewest);
}

static int out_of_memory(nevh_reference *r) {
    return nevh__fail(&r->report, NEVH_ENOMEM, "out of memory");
}

static int plan(nevh_reference *r, chain *c) {
    bool damped = nevh_system_friction(r->system, c->rates);
    c->recurrence =
        nevh__recurrence_new(r->system, damped ? c->rates : NULL, &r->report);
    if (!c->recurrence)
        return r->report.status;
    bool made = nevh__orbit_init_long(&c->fine, c->recurrence, fine);
    made = nevh__orbit_init_long(&c->coarse, c->recurrence, coarse) && made;
    if (!made)
        return out_of_memory(r);
    c->each = 1 + 2 * r->n * (c->fine.order + 1);
    c->fine.longest = c->coarse.longest = longest(r, c);
    return NEVH_OK;
}

static int start(nevh_reference *r, chain *c) {
    long double *state = nevh__array(2 * r->n, sizeof *state);
    if (!state)
        return out_of_memory(r);
    for (size_t k = 0; k < 2 * r->n; k++)
        state[k] = r->start[k];
    int status = nevh__orbit_start_long(&c->coarse, r->t0, state, &r->report);
    if (!status)
        status = nevh__orbit_start_long(&c->fine, r->t0, state, &r->report);
    free(state);
    return status;
}

static bool keep(const nevh_reference *r, chain *c) {
    if (c->count == c->capacity) {
        size_t capacity = 2 * c->capacity + 64;
        long double *kept =
            nevh__grow(c->kept, capacity * c->each, sizeof *kept);
        c->kept = kept ? kept : c->kept;
        double *parted = nevh__grow(c->parted, capacity, sizeof *parted);
        c->parted = parted ? parted : c->parted;
        if (!kept || !parted)
            return false;
        c->capacity = capacity;
    }
    long double *to = c->kept + c->count++ * c->each;
    *to = c->fine.t - r->t0;
    memcpy(to + 1, c->fine.rows, (c->each - 1) * sizeof *to);
    return true;
}

static void value_at(const nevh_reference *r, const long double *kept,
                     long double elapsed, double state[]) {
    size_t each = 2 * r->n, order = r->series->fine.order;
    long double since = elapsed - *kept;
    for (size_t i = 0; i < each; i++) {
        const long double *row = kept + 1 + order * each + i;
        long double sum = *row;
        for (size_t k = order; k-- > 0;)
            sum = sum * since + *(row -= each);
        state[i] = (double)sum;
    }
}

/* Extremes within the last series, as far as it is used. */
static void look(nevh_reference *r, const chain *c) {
    const long double *kept = c->kept + (c->count - 1) * c->each;
    long double span = (long double)r->t1 - r->t0;
    long double step = copysignl(c->fine.reach, span);
    for (int i = 0; i <= LOOKS; i++) {
        long double elapsed = *kept + step * i / LOOKS;
        if ((elapsed - span) * (span > 0 ? 1 : -1) > 0)
            elapsed = span;
        value_at(r, kept, elapsed, r->walked);
        nevh__reference_widen(r, r->low, r->high, r->walked);
    }
}

/* How far apart both are, in ranges up to there. */
static double compare(nevh_reference *r, chain *c) {
    const long double *state = c->fine.state; /* where the series begins */
    double most = 0;
    nevh__reference_scale(r, r->low, r->high, r->range);
    for (size_t k = 0; k < 2 * r->n; k++) {
        double by = (double)fabsl(state[k] - c->coarse.state[k]);
        c->difference[k] = fmax(c->difference[k], by);
        most = fmax(most, by / r->range[k]);
    }
    return most;
}

/* Whether both can come to the end. */
static bool affordable(const nevh_reference *r, const chain *c) {
    double part = (double)(c->fine.t - r->t0) / (r->t1 - r->t0);
    double series = (double)c->count / fmax(part, 1e-300);
    double bytes = series * bytes_of(c);
    double work = series * (work_of(&c->fine) + work_of(&c->coarse));
    if (c->count < 16)
        return true;
    return bytes <= MOST_KEPT &&
           (work <= most_work || r->integrator == nevh_taylor);
}

static void end_at(nevh_reference *r, const chain *c) {
    bool room = r->n > 1 || !(nevh_system_traits(r->system) & NEVH_AUTONOMOUS);
    double reached = (double)(c->fine.t - r->t0);
    nevh__spread s = {0};
    for (size_t i = 1; i < c->count; i++)
        nevh__spread_add(&s, (double)c->kept[i * c->each] / reached,
                         c->parted[i] / (double)LDBL_EPSILON);
    r->horizon = r->t0 + reached;
    r->end = room && nevh__spread_steady(&s) ? NEVH_REFERENCE_CHAOS
                                             : NEVH_REFERENCE_SENSITIVE;
    r->growth = s.most;
    r->exponent = nevh__spread_rate(&s, reached);
}

/* Side by side, to the end or to where they part. */
static int run(nevh_reference *r, chain *c) {
    int status = keep(r, c) ? NEVH_OK : out_of_memory(r);
    double forward = r->t1 > r->t0 ? 1 : -1;
    if (!status)
        look(r, c);
    while (!status && (r->t1 - c->fine.t) * forward > c->fine.reach) {
        status = nevh__orbit_next_long(&c->fine, r->t1, &r->report);
        if (!status)
            status = nevh__orbit_go_long(&c->coarse, c->fine.t, &r->report);
        if (!status && !keep(r, c))
            status = out_of_memory(r);
        if (status)
            break;
        look(r, c);
        double by = c->parted[c->count - 1] = compare(r, c);
        if (!affordable(r, c))
            return nevh__fail(&r->report, NEVH_EFAILED,
                              "Taylor series cost too much for a reference "
                              "until t = %.9g",
                              r->t1);
        if (by > apart) {
            end_at(r, c);
            return NEVH_OK;
        }
    }
    if (!status)
        status = nevh__orbit_go_long(&c->coarse, r->t1, &r->report);
    if (!status)
        status = nevh__orbit_go_long(&c->fine, r->t1, &r->report);
    if (!status)
        compare(r, c);
    return status;
}

static void describe(nevh_reference *r, const chain *c) {
    static const double times = 2; /* the difference, to be certain */
    nevh__reference_scale(r, r->low, r->high, r->range);
    r->error = DBL_EPSILON;
    for (size_t k = 0; k < 2 * r->n; k++)
        r->error = fmax(r->error, times * c->difference[k] / r->range[k]);
    if (!isfinite(r->horizon))
        snprintf(r->text, sizeof r->text, "taylor in %d bits, own error %.0e",
                 LDBL_MANT_DIG, r->error);
    else
        snprintf(r->text, sizeof r->text, "taylor in %d bits, until %st = %.4g",
                 LDBL_MANT_DIG,
                 r->end == NEVH_REFERENCE_CHAOS ? "chaos at " : "", r->horizon);
}

int nevh__reference_series(nevh_reference *r) {
    chain *c = r->series = nevh__array(1, sizeof *c);
    if (!c)
        return out_of_memory(r);
    c->rates = nevh__array(r->n, sizeof *c->rates);
    c->difference = nevh__array(2 * r->n, sizeof *c->difference);
    int status = c->rates && c->difference ? plan(r, c) : out_of_memory(r);
    if (!status)
        status = start(r, c);
    if (!status)
        status = run(r, c);
    if (!status) {
        describe(r, c);
        r->integrator = nevh_taylor;
        return NEVH_OK;
    }
    nevh__reference_series_free(c);
    r->series = NULL;
    r->horizon = copysign(INFINITY, r->t1 - r->t0);
    memcpy(r->low, r->start, 2 * r->n * sizeof *r->low);
    memcpy(r->high, r->start, 2 * r->n * sizeof *r->high);
    return status;
}

void nevh__reference_series_state(const nevh_reference *r, long double elapsed,
                                  double q[], double p[]) {
    const chain *c = r->series;
    size_t from = 0, until = c->count;
    long double forward = r->t1 > r->t0 ? 1 : -1;
    while (until - from > 1) {
        size_t middle = from + (until - from) / 2;
        bool later = (elapsed - c->kept[middle * c->each]) * forward >= 0;
        *(later ? &from : &until) = middle;
    }
    value_at(r, c->kept + from * c->each, elapsed, r->walked);
    memcpy(q, r->walked, r->n * sizeof *q);
    memcpy(p, r->walked + r->n, r->n * sizeof *p);
}
