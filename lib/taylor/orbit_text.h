/* nevh: an orbit along Taylor series in one kind of numbers.

   Before this is included are defined: real, of which states are, and DOUBLE_DOUBLE
   where coefficients are not; NAMED(name), the name of a function; FUNCTION(f), a
   function of theirs as <math.h> has it; SHORTEST, of a time that is left, for
   series to be taken.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/number_text.h"
#include "taylor/orbit_private.h"
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct NAMED(nevh__series_orbit) orbit;

enum { PROBE_ORDER = 2 };

bool NAMED(nevh__series_orbit_init)(orbit *o, const nevh__recurrence *r,
                                    double tolerance) {
    size_t order = (size_t)ceil(2 - 0.6 * log(tolerance));
    *o = (orbit){.recurrence = r,
                 .n = r->n,
                 .order = order,
                 .tolerance = tolerance,
                 .longest = INFINITY,
                 .shortest = SHORTEST,
                 .unit = 1};
    o->series = NAMED(nevh__series_new)(r, order);
    o->rows = nevh__array(2 * r->n * (order + 1), sizeof *o->rows);
    o->probe = NAMED(nevh__series_new)(r, PROBE_ORDER);
    o->probed = nevh__array(2 * r->n * (PROBE_ORDER + 1), sizeof *o->probed);
    o->elsewhere = nevh__array(2 * r->n, sizeof *o->elsewhere);
    o->start = nevh__array(2 * r->n, sizeof *o->start);
    o->state = nevh__array(2 * r->n, sizeof *o->state);
    o->most = nevh__array(6 * r->n, sizeof *o->most);
    o->seen = o->most ? o->most + 2 * r->n : NULL;
    o->term = o->most ? o->most + 4 * r->n : NULL;
    return o->series && o->rows && o->probe && o->probed && o->elsewhere &&
           o->start && o->state && o->most;
}

void NAMED(nevh__series_orbit_clear)(orbit *o) {
    NAMED(nevh__series_free)(o->series);
    NAMED(nevh__series_free)(o->probe);
    free(o->rows);
    free(o->probed);
    free(o->elsewhere);
    free(o->start);
    free(o->state);
    free(o->most);
    memset(o, 0, sizeof *o);
}

/* The unit of a variable's error: its largest value so far, or that of the others
   of its half. */
static double size_of(const orbit *o, size_t i) {
    return o->most[i] > 0 ? o->most[i] : o->usual[i >= o->n];
}

static long double largest_of(const orbit *o, size_t order, size_t half) {
    long double most = 0;
    for (size_t i = half * o->n; i < (half + 1) * o->n; i++) {
        long double x = lengthen(o->rows[order * 2 * o->n + i]);
        most = fmaxl(most, fabsl(x) / size_of(o, i));
    }
    return most;
}

static long double largest(const orbit *o, size_t order) {
    return fmaxl(largest_of(o, order, 0), largest_of(o, order, 1));
}

/* Half the radius of convergence, as the last coefficients show it: those of a part
   that is small, but grows on the way, are within the tolerance beyond it. */
static long double convergence(const orbit *o) {
    size_t last = o->order, by = last / 3;
    long double now = fmaxl(largest(o, last), largest(o, last - 1));
    long double then = fmaxl(largest(o, last - by), largest(o, last - by - 1));
    return now > 0 && then > 0 ? powl(then / now, 1 / (long double)by) / 2
                               : INFINITY;
}

static real reach_of(const orbit *o) {
    double tolerance = log2(o->tolerance), reach = INFINITY;
    for (size_t k = o->order; k >= o->order / 2; k--) {
        double size = (double)log2l(largest(o, k));
        reach = fmin(reach, nevh__series_reach(o->order, tolerance, k, size));
    }
    return o->unit * exp2l(reach);
}

static void take_unit(orbit *o, double unit) {
    if (!isfinite(unit) || unit == 0)
        return;
    o->unit = ldexp(1, ilogb(unit));
    NAMED(nevh__series_in)(o->series, o->unit);
}

/* Expands a series; if coefficients are too large for the unit of time, in a
   shorter one. */
static bool expand(orbit *o, real t, const real state[]) {
    static const double shorter = 0x1p-15;
    enum { TRIES = 64 };
    for (int i = 0; i < TRIES; i++) {
        if (NAMED(nevh__series_expand)(o->series, t, state, o->rows))
            return true;
        take_unit(o, o->unit * shorter);
    }
    return false;
}

/* The edge of a domain that a series comes to; SIZE_MAX: there is none. */
static size_t edge_of(const orbit *o) {
    return nevh__domain_edge(o->recurrence,
                             NAMED(nevh__series_watched)(o->series), o->order,
                             (double)(o->reach / o->unit));
}

/* Why there is no series at t that holds for long, where a domain has an edge. */
static int fail_at_edge(const orbit *o, double t, nevh__report *report) {
    char why[200];
    size_t edge = edge_of(o);
    if (edge == SIZE_MAX)
        return NEVH_OK;
    nevh__domain_words(o->recurrence, edge, why, sizeof why);
    bool first = o->count <= 1;
    return nevh__fail(
        report, o->ended ? NEVH_EFAILED : NEVH_EDOM,
        o->ended ? "the solution itself ends at t = %.9g: it "
                   "changes without bound there, with %s"
        : first
            ? "there is no series at the start, t = %.9g: " NEVH__SERIES_EDGE
            : "the series ends near t = %.9g: " NEVH__SERIES_EDGE,
        t, why);
}

/* No further than what changes with time allows, and up to the next break. */
static void limit_by_time(orbit *o) {
    const nevh_time_break *next =
        nevh__timing_next(o->timing, (double)o->t, !o->backward);
    o->reach = FUNCTION(fmin)(
        o->reach, (real)nevh__timing_reach(o->timing, (double)o->t));
    o->stops = false;
    if (!next || next->pole)
        return;
    o->stop = o->backward ? next->before : next->after;
    real left = FUNCTION(fabs)(o->stop - o->t);
    o->stops = o->reach >= left;
    o->reach = o->stops ? left : o->reach;
}

/* True if series that get shorter and shorter mean the end of a solution, where the
   state changes ever faster; at a branch point it does not.  Before a thin wall it does,
   but gets smaller, and hardly changes in a series until it is there. */
static bool ends(const orbit *o) {
    static const double shrunk = 1e4, faster = 10, hardly = 1e-3;
    size_t now = o->count % NEVH__ORBIT_PAST;
    size_t half = largest_of(o, 1, 1) >= largest_of(o, 1, 0); /* the faster */
    for (size_t i = 1; i < NEVH__ORBIT_PAST && i < o->count; i++) {
        size_t then = (o->count - i) % NEVH__ORBIT_PAST;
        if (o->held[then] > shrunk * o->held[now])
            return o->speed[now] > faster * o->speed[then] &&
                   (o->extent[half][now] > o->extent[half][then] ||
                    o->change[half][then] > hardly);
    }
    return false;
}

/* Keeps the reach of this series, how fast it begins, the sizes of coordinates and of
   momenta, and the part of these by which they change. */
static void note_past(orbit *o) {
    size_t at = o->count % NEVH__ORBIT_PAST;
    double reach = (double)(o->reach / o->unit);
    o->held[at] = (double)o->reach;
    o->speed[at] = (double)(largest(o, 1) / o->unit);
    for (size_t half = 0; half < 2; half++) {
        double squares = 0, slopes = 0;
        for (size_t i = half * o->n; i < (half + 1) * o->n; i++) {
            double slope = shorten(o->rows[2 * o->n + i]) * reach;
            squares += (double)(o->start[i] * o->start[i]);
            slopes += slope * slope;
        }
        o->extent[half][at] = sqrt(squares);
        o->change[half][at] = sqrt(slopes / squares);
    }
}

/* The largest of either half, now or so far. */
static void take_largest(const orbit *o, bool now, double most[2]) {
    most[0] = most[1] = 0;
    for (size_t i = 0; i < 2 * o->n; i++) {
        double x = now ? fabs((double)o->start[i]) : o->seen[i];
        most[i >= o->n] = fmax(most[i >= o->n], x);
    }
}

/* Keeps where series are shortest, after the longest one, but for the edges of domains
   and breaks in time. */
static void note_narrow(orbit *o) {
    static const double once = 8; /* longer ones before do not count then */
    static const double there = 2;
    nevh__narrow *x = &o->narrow;
    double whole = (double)o->whole;
    if (!isfinite(whole))
        return;
    if (whole > x->longest && !nevh__narrow_is(x, once)) {
        x->longest = x->shortest = whole;
        take_largest(o, true, x->before);
    } else if (whole < x->shortest) {
        x->shortest = whole;
        x->at = (double)o->t;
    }
    x->over = !(whole < there * x->shortest);
    if (!x->over)
        take_largest(o, false, x->most);
}

/* The state that a series has after a time. */
static void place(const orbit *o, real since, real state[]) {
    size_t each = 2 * o->n;
    number by = narrow(since / o->unit);
    for (size_t i = 0; i < each; i++) {
        const number *row = o->rows + o->order * each + i;
        number sum = *row;
        for (size_t k = o->order; --k > 0;)
            sum = plus(times(sum, by), *(row -= each));
        state[i] = widen(times(sum, by)) + o->start[i];
    }
}

/* The slope that it has there, in its unit. */
static long double slope_after(const orbit *o, size_t i, real since) {
    long double sum = 0, by = (long double)(since / o->unit);
    for (size_t k = o->order; k > 0; k--)
        sum = sum * by + (long double)k * lengthen(o->rows[k * 2 * o->n + i]);
    return sum;
}

/* True if the series has the derivatives of H after a time. */
static bool is_of_H(orbit *o, real since) {
    static const long double alike = 1e-6L, nothing = 1e-100L, part = 1e-10L;
    size_t each = 2 * o->n;
    place(o, since, o->elsewhere);
    NAMED(nevh__series_in)(o->probe, o->unit);
    if (!NAMED(nevh__series_expand)(o->probe, o->t + since, o->elsewhere,
                                    o->probed))
        return false;
    for (size_t i = 0; i < each; i++) {
        long double slope = lengthen(o->probed[each + i]);
        long double mine = slope_after(o, i, since);
        long double least = o->most[i] > 0 ? part * o->tolerance : nothing;
        long double allowed =
            alike * fmaxl(fabsl(mine), fabsl(slope)) + least * size_of(o, i);
        if (!(fabsl(mine - slope) <= allowed))
            return false;
    }
    return true;
}

/* Beyond its radius of convergence a series holds where the last coefficients are
   rounding, as near x = 0 of sin(x)/x, and not where a part is so small that they are
   within the tolerance, as far from 0 of x^-12. */
static void limit_by_convergence(orbit *o) {
    real most = (real)convergence(o) * o->unit;
    if (o->reach <= most || is_of_H(o, o->backward ? -o->reach : o->reach))
        return;
    o->reach = most;
    o->stops = false;
}

static void note_state(orbit *o, const real state[]) {
    for (size_t i = 0; i < 2 * o->n; i++)
        o->most[i] = fmax(o->most[i], fabs((double)state[i]));
    for (size_t half = 0; half < 2; half++) {
        size_t i = half * o->n, end = i + o->n;
        while (i < end && o->most[i] == 0)
            i++;
        o->usual[half] = i < end ? o->most[i] : 1;
    }
}

/* The shortest time in which a coefficient says that a variable changes by its size,
   of those whose size is known; 0 where nothing changes. */
static double time_of_change(const orbit *o) {
    double most = 0;
    for (size_t k = 1; k <= o->order; k++)
        for (size_t i = 0; i < 2 * o->n; i++) {
            double x = fabs(shorten(o->rows[k * 2 * o->n + i]));
            if (o->most[i] > 0)
                most = fmax(most, pow(x / o->most[i], 1 / (double)k));
        }
    return most > 0 ? o->unit / most : 0;
}

/* Finds a unit of time in which no coefficient at the start is beyond all numbers. */
static void find_unit(orbit *o, real t, const real state[]) {
    static const double near = 0x1p10;
    enum { TRIES = 8 };
    for (int i = 0; i < TRIES && expand(o, t, state); i++) {
        double unit = time_of_change(o), ratio = unit / o->unit;
        if (!(unit > 0) || (ratio < near && ratio > 1 / near))
            break;
        take_unit(o, unit);
    }
}

static int begin_untrapped(orbit *o, real t, const real state[],
                           nevh__report *report) {
    note_state(o, state);
    for (size_t i = 0; i < 2 * o->n; i++)
        o->seen[i] = fmax(o->seen[i], o->most[i]);
    memmove(o->start, state, 2 * o->n * sizeof *state);
    o->t = t;
    o->count++;
    if (!expand(o, t, state)) {
        int status = fail_at_edge(o, (double)t, report);
        return status ? status
                      : nevh__fail(report, NEVH_EDOM, NEVH__SERIES_NOT_FINITE,
                                   (double)t);
    }
    o->reach = o->whole = FUNCTION(fmin)(reach_of(o), (real)o->longest);
    o->reach = nevh__domain_reach(o->recurrence,
                                  NAMED(nevh__series_watched)(o->series),
                                  o->order, (double)(o->reach / o->unit)) *
               o->unit;
    if (o->timing)
        limit_by_time(o);
    limit_by_convergence(o);
    note_past(o);
    note_narrow(o);
    return NEVH_OK;
}

/* Coefficients that are 0, and series too long for their unit of time, trap no
   floating-point exception. */
static int begin(orbit *o, real t, const real state[], nevh__report *report) {
    fenv_t own;
    feholdexcept(&own);
    int status = begin_untrapped(o, t, state, report);
    fesetenv(&own);
    return status;
}

int NAMED(nevh__series_orbit_start)(orbit *o, real t, const real state[],
                                    nevh__report *report) {
    memmove(o->state, state, 2 * o->n * sizeof *state);
    note_state(o, state);
    take_unit(o, o->longest);
    find_unit(o, t, state);
    o->reach = o->unit;
    return begin(o, t, state, report);
}

/* Sizes of variables within a series, of which both ends may be zeros, and of its
   terms. */
static void note_sizes(orbit *o, double by) {
    static const double within = 0.37;
    size_t each = 2 * o->n;
    for (size_t i = 0; i < each; i++) {
        double value = 0, power = 1, part = 1;
        for (size_t k = 0; k <= o->order; k++) {
            double x = shorten(o->rows[k * each + i]);
            o->term[i] = fmax(o->term[i], fabs(x) * power);
            value += x * part;
            power *= fabs(by);
            part *= within * by;
        }
        o->seen[i] = fmax(o->seen[i], fabs(value));
    }
}

static void evaluate(orbit *o, real since) {
    note_sizes(o, (double)(since / o->unit));
    place(o, since, o->state);
}

int NAMED(nevh__series_orbit_next)(orbit *o, real t, nevh__report *report) {
    static const double longer = 0x1p20;
    if (o->ending && *o->ending)
        return nevh__fail(report, NEVH_EFAILED, "stopped at t = %.9g",
                          (double)o->t);
    real next = t > o->t ? o->t + o->reach : o->t - o->reach;
    next = o->stops ? o->stop : next;
    if (!(o->reach > o->shortest * FUNCTION(fabs)(t - o->t)) || next == o->t) {
        o->ended =
            ends(o) && !nevh__domain_is_closed(o->recurrence, edge_of(o));
        int status = fail_at_edge(o, (double)o->t, report);
        return status ? status
                      : nevh__fail(report, NEVH_EFAILED,
                                   o->ended ? "the solution itself ends at t = "
                                              "%.9g: it changes without bound "
                                              "there"
                                            : "series get too short near t = "
                                              "%.9g: does the orbit end there?",
                                   (double)o->t);
    }
    evaluate(o, next - o->t);
    take_unit(o, fmin((double)o->whole, longer * (double)o->reach));
    return begin(o, next, o->state, report);
}

/* Expands the same series again, for a time that is far longer than its unit:
   coefficients that were too small for numbers say nothing of that. */
static int fit_unit(orbit *o, double since, nevh__report *report) {
    o->count--;
    take_unit(o, since);
    return begin(o, o->t, o->start, report);
}

int NAMED(nevh__series_orbit_go)(orbit *o, real t, nevh__report *report) {
    static const double far = 0x1p8; /* units */
    int status = NEVH_OK;
    size_t fitted = SIZE_MAX; /* the series */
    for (bool there = false; !status && !there;) {
        double left = fabs((double)(t - o->t));
        double since = fmin(left, (double)o->reach);
        if (since > far * o->unit && fitted != o->count) {
            status = fit_unit(o, since, report);
            fitted = o->count;
        }
        there = !status && !(FUNCTION(fabs)(t - o->t) > o->reach);
        if (there)
            evaluate(o, t - o->t);
        else if (!status)
            status = NAMED(nevh__series_orbit_next)(o, t, report);
    }
    return status;
}

void NAMED(nevh__series_orbit_rows)(const orbit *o, long double rows[]) {
    const number *row = o->rows;
    long double factor = 1;
    for (size_t k = 0; k <= o->order; k++, factor /= o->unit)
        for (size_t i = 0; i < 2 * o->n; i++)
            *rows++ = lengthen(*row++) * factor;
}

double NAMED(nevh__series_orbit_work)(const orbit *o) {
    const nevh__recurrence *r = o->recurrence;
    double order = (double)o->order, called = 0;
    for (size_t i = 0; i < r->n_batches; i++)
        if (r->batches[i].kind >= NEVH__BATCH_INVERT)
            called += r->batches[i].count;
    return order * (order / 4 * (double)r->lanes + 6 * (double)r->values) +
           500 * called + 2000 * (double)r->n + 5000;
}
