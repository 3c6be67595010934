/* nevh: an orbit in quad precision.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/quad_orbit_private.h"

#ifdef NEVH_QUADMATH
#include <math.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

bool nevh__quad_orbit_init(nevh__quad_orbit *o, const nevh__recurrence *r,
                           double tolerance) {
    size_t order = (size_t)ceil(2 - 0.6 * log(tolerance));
    *o = (nevh__quad_orbit){
        .recurrence = r, .n = r->n, .order = order, .tolerance = tolerance};
    o->series = nevh__series_new_quad(r, order);
    o->rows = nevh__array(2 * r->n * (order + 1), sizeof *o->rows);
    o->state = nevh__array(2 * r->n, sizeof *o->state);
    o->most = nevh__array(2 * r->n, sizeof *o->most);
    return o->series && o->rows && o->state && o->most;
}

void nevh__quad_orbit_clear(nevh__quad_orbit *o) {
    nevh__series_free_quad(o->series);
    free(o->rows);
    free(o->state);
    free(o->most);
    memset(o, 0, sizeof *o);
}

/* What a variable's error is measured in: the largest that it was, or that the
   others of its half were. */
static double size_of(const nevh__quad_orbit *o, size_t i) {
    size_t from = i < o->n ? 0 : o->n;
    double most = o->most[i];
    for (size_t k = from; most == 0 && k < from + o->n; k++)
        most = o->most[k];
    return most > 0 ? most : 1;
}

static nevh__wide largest(const nevh__quad_orbit *o, size_t order) {
    nevh__wide most = 0;
    for (size_t i = 0; i < 2 * o->n; i++) {
        nevh__wide x = fabsq(o->rows[order * 2 * o->n + i]) / size_of(o, i);
        most = x > most ? x : most;
    }
    return most;
}

static nevh__wide reach_of(const nevh__quad_orbit *o) {
    nevh__wide last = logq(o->tolerance / largest(o, o->order));
    nevh__wide before = logq(o->tolerance / largest(o, o->order - 1));
    return expq(fminq(last / (nevh__wide)o->order,
                      before / (nevh__wide)(o->order - 1)));
}

static int begin(nevh__quad_orbit *o, nevh__wide t, const nevh__wide state[],
                 nevh__report *report) {
    for (size_t i = 0; i < 2 * o->n; i++)
        o->most[i] = fmax(o->most[i], fabs((double)state[i]));
    o->t = t;
    o->count++;
    if (!nevh__series_expand_quad(o->series, t, state, o->rows))
        return nevh__fail(report, NEVH_EDOM,
                          "the series at t = %.9g is not finite: H has no "
                          "derivatives there, or the state is out of its "
                          "domain",
                          (double)t);
    o->reach = reach_of(o);
    return NEVH_OK;
}

int nevh__quad_orbit_start(nevh__quad_orbit *o, nevh__wide t,
                           const nevh__wide state[], nevh__report *report) {
    memcpy(o->state, state, 2 * o->n * sizeof *state);
    return begin(o, t, state, report);
}

static void evaluate(nevh__quad_orbit *o, nevh__wide since) {
    size_t each = 2 * o->n;
    for (size_t i = 0; i < each; i++) {
        nevh__wide sum = o->rows[o->order * each + i];
        for (size_t k = o->order; k-- > 0;)
            sum = sum * since + o->rows[k * each + i];
        o->state[i] = sum;
    }
}

int nevh__quad_orbit_go(nevh__quad_orbit *o, nevh__wide t,
                        nevh__report *report) {
    int status = NEVH_OK;
    while (!status && fabsq(t - o->t) > o->reach) {
        nevh__wide next = t > o->t ? o->t + o->reach : o->t - o->reach;
        if (!(o->reach > 1e-25 * fabsq(t - o->t)) || next == o->t)
            return nevh__fail(report, NEVH_EFAILED,
                              "series get too short near t = %.9g: does the "
                              "orbit end there?",
                              (double)o->t);
        evaluate(o, next - o->t);
        status = begin(o, next, o->state, report);
    }
    if (!status)
        evaluate(o, t - o->t);
    return status;
}
#endif
