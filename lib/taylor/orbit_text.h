/* nevh: an orbit along Taylor series in one kind of numbers.

   Before this is included are defined: real, the numbers; NAMED(name), the name
   of a function; FUNCTION(f), a function of theirs as <math.h> has it; SHORTEST,
   of a time that is left, for series to be taken.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct NAMED(nevh__orbit) orbit;

bool NAMED(nevh__orbit_init)(orbit *o, const nevh__recurrence *r,
                             double tolerance) {
    size_t order = (size_t)ceil(2 - 0.6 * log(tolerance));
    *o = (orbit){.recurrence = r,
                 .n = r->n,
                 .order = order,
                 .tolerance = tolerance,
                 .longest = INFINITY};
    o->series = NAMED(nevh__series_new)(r, order);
    o->rows = nevh__array(2 * r->n * (order + 1), sizeof *o->rows);
    o->state = nevh__array(2 * r->n, sizeof *o->state);
    o->most = nevh__array(2 * r->n, sizeof *o->most);
    return o->series && o->rows && o->state && o->most;
}

void NAMED(nevh__orbit_clear)(orbit *o) {
    NAMED(nevh__series_free)(o->series);
    free(o->rows);
    free(o->state);
    free(o->most);
    memset(o, 0, sizeof *o);
}

/* What a variable's error is measured in: the largest that it was, or that the
   others of its half were. */
static double size_of(const orbit *o, size_t i) {
    size_t from = i < o->n ? 0 : o->n;
    double most = o->most[i];
    for (size_t k = from; most == 0 && k < from + o->n; k++)
        most = o->most[k];
    return most > 0 ? most : 1;
}

static real largest(const orbit *o, size_t order) {
    real most = 0;
    for (size_t i = 0; i < 2 * o->n; i++) {
        real x = FUNCTION(fabs)(o->rows[order * 2 * o->n + i]) / size_of(o, i);
        most = x > most ? x : most;
    }
    return most;
}

static real reach_of(const orbit *o) {
    real last = FUNCTION(log)(o->tolerance / largest(o, o->order));
    real before = FUNCTION(log)(o->tolerance / largest(o, o->order - 1));
    return FUNCTION(exp)(
        FUNCTION(fmin)(last / (real)o->order, before / (real)(o->order - 1)));
}

static int begin(orbit *o, real t, const real state[], nevh__report *report) {
    for (size_t i = 0; i < 2 * o->n; i++)
        o->most[i] = fmax(o->most[i], fabs((double)state[i]));
    o->t = t;
    o->count++;
    if (!NAMED(nevh__series_expand)(o->series, t, state, o->rows))
        return nevh__fail(report, NEVH_EDOM,
                          "the series at t = %.9g is not finite: H has no "
                          "derivatives there, or the state is out of its "
                          "domain",
                          (double)t);
    o->reach = FUNCTION(fmin)(reach_of(o), (real)o->longest);
    return NEVH_OK;
}

int NAMED(nevh__orbit_start)(orbit *o, real t, const real state[],
                             nevh__report *report) {
    memcpy(o->state, state, 2 * o->n * sizeof *state);
    return begin(o, t, state, report);
}

static void evaluate(orbit *o, real since) {
    size_t each = 2 * o->n;
    for (size_t i = 0; i < each; i++) {
        real sum = o->rows[o->order * each + i];
        for (size_t k = o->order; k-- > 0;)
            sum = sum * since + o->rows[k * each + i];
        o->state[i] = sum;
    }
}

int NAMED(nevh__orbit_next)(orbit *o, real t, nevh__report *report) {
    real next = t > o->t ? o->t + o->reach : o->t - o->reach;
    if (!(o->reach > SHORTEST * FUNCTION(fabs)(t - o->t)) || next == o->t)
        return nevh__fail(report, NEVH_EFAILED,
                          "series get too short near t = %.9g: does the orbit "
                          "end there?",
                          (double)o->t);
    evaluate(o, next - o->t);
    return begin(o, next, o->state, report);
}

int NAMED(nevh__orbit_go)(orbit *o, real t, nevh__report *report) {
    int status = NEVH_OK;
    while (!status && FUNCTION(fabs)(t - o->t) > o->reach)
        status = NAMED(nevh__orbit_next)(o, t, report);
    if (!status)
        evaluate(o, t - o->t);
    return status;
}
