/* nevh: what is kept of the orbits under way.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
enum { LINES = 3 }; /* of a spectrum, of which the largest is told */

/* Rows of `width`, in rows of `stride` that repeat the first lane. */
static void widen(const nevh_ensemble *e, const double from[], double to[]) {
    if (from == to)
        return;
    for (size_t k = 0; k < e->n; k++)
        for (size_t lane = 0; lane < e->stride; lane++)
            to[k * e->stride + lane] =
                from[k * e->width + (lane < e->width ? lane : 0)];
}

/* A lane alone, where one of them has no velocity. */
static void velocity_of_lane(nevh_ensemble *e, size_t lane, double t,
                             const double q[], const double p[]) {
    size_t n = e->n, stride = e->stride;
    for (size_t k = 0; k < n; k++) {
        e->q1[k] = q[k * stride + lane];
        e->p1[k] = p[k * stride + lane];
    }
    int status =
        nevh_field_gradient(e->motion, 1, &t, e->q1, e->p1, NULL, e->v1);
    for (size_t k = 0; k < n; k++)
        e->v[k * stride + lane] = status ? NAN : e->v1[k];
}

void nevh__ensemble_move(nevh_ensemble *e, const double t[], const double q[],
                         const double p[]) {
    if (e->moving &&
        nevh_field_gradient(e->motion, e->stride, t, q, p, NULL, e->v))
        for (size_t lane = 0; lane < e->stride; lane++)
            velocity_of_lane(e, lane, t[lane], q, p);
}

void nevh__ensemble_value(const nevh_ensemble *e, size_t o, const double t[],
                          const double q[], const double p[], double values[]) {
    const nevh_quantity *is = &e->outcomes[o].quantity;
    is->value(is->data, e->stride, t, q, p, is->velocities ? e->v : NULL,
              values);
}

static void evaluate(nevh_ensemble *e) {
    for (size_t lane = 0; lane < e->stride; lane++)
        e->now.t[lane] = e->lanes[lane < e->width ? lane : 0].t;
    widen(e, e->q, e->wide_q);
    widen(e, e->p, e->wide_p);
    nevh__ensemble_move(e, e->now.t, e->wide_q, e->wide_p);
    for (size_t i = 0; i < e->n_outcomes; i++)
        if (e->outcomes[i].quantity.value)
            nevh__ensemble_value(e, i, e->now.t, e->wide_q, e->wide_p,
                                 e->now.value + i * e->stride);
    const nevh_quantity *stop = &e->is.stop;
    if (stop->value)
        stop->value(stop->data, e->stride, e->now.t, e->wide_q, e->wide_p,
                    stop->velocities ? e->v : NULL, e->stop);
}

double nevh__narrow_value(nevh_ensemble *e, size_t o, double t) {
    const nevh_quantity *is = &e->outcomes[o].quantity;
    for (size_t lane = 0; lane < NEVH__LANES; lane++)
        e->t1[lane] = t;
    for (size_t i = 0; i < e->n * NEVH__LANES; i++) {
        e->wide_q1[i] = e->q1[i / NEVH__LANES];
        e->wide_p1[i] = e->p1[i / NEVH__LANES];
    }
    if (is->velocities &&
        nevh_field_gradient(e->motion, NEVH__LANES, e->t1, e->wide_q1,
                            e->wide_p1, NULL, e->v1))
        return NAN;
    is->value(is->data, NEVH__LANES, e->t1, e->wide_q1, e->wide_p1,
              is->velocities ? e->v1 : NULL, e->value1);
    return e->value1[0];
}

/* sum + roundoff += x */
static void add(nevh__record *r, double x) {
    double next = r->value + x;
    r->roundoff += nevh__roundoff(next, r->value, x);
    r->value = next;
}

static void look_for_first(nevh_ensemble *e, size_t lane, size_t o,
                           nevh__record *r) {
    const nevh__lane *l = &e->lanes[lane];
    double value = e->now.value[o * e->stride + lane];
    if (l->fresh)
        r->value = value > 0 ? l->t : NAN;
    else if (value > 0)
        r->value = nevh__ensemble_locate(e, &e->ago1, lane, o, 1, value);
    else if (l->step > 1)
        r->value = nevh__ensemble_graze(e, lane, o);
    r->known = !isnan(r->value);
}

static void take(nevh_ensemble *e, size_t lane, size_t o) {
    nevh__record *r = &e->records[o * e->width + lane];
    const nevh__lane *l = &e->lanes[lane];
    size_t i = o * e->stride + lane;
    double value = e->now.value[i];
    if (l->fresh)
        *r = (nevh__record){.value = NAN, .samples = r->samples};
    switch (e->outcomes[o].kind) {
    case NEVH_OUTCOME_FIRST:
        if (!r->known)
            look_for_first(e, lane, o, r);
        break;
    case NEVH_OUTCOME_LAST:
        r->value = value;
        break;
    case NEVH_OUTCOME_MINIMUM:
        if (l->fresh || isnan(value) || value < r->value)
            r->value = value;
        break;
    case NEVH_OUTCOME_MAXIMUM:
        if (l->fresh || isnan(value) || value > r->value)
            r->value = value;
        break;
    case NEVH_OUTCOME_MEAN:
        if (l->fresh)
            r->value = 0;
        else
            add(r, (l->t - e->ago1.t[lane]) / 2 * (e->ago1.value[i] + value));
        break;
    case NEVH_OUTCOME_FREQUENCY:
        if (l->fresh)
            nevh_spectral_samples_restart(r->samples);
        nevh_spectral_samples_take(r->samples, l->step, l->t, value);
        break;
    default:
        break;
    }
}

/* Nothing more can come of it. */
static bool all_known(const nevh_ensemble *e, size_t lane) {
    for (size_t i = 0; i < e->n_outcomes; i++)
        if (!e->records[i * e->width + lane].known)
            return false;
    return e->n_outcomes > 0;
}

int nevh__ensemble_cross(void *ensemble, const nevh_point *point) {
    nevh_ensemble *e = ensemble;
    size_t o = e->crossing_of[point->section];
    nevh__record *r = &e->records[o * e->width + e->crossing_lane];
    r->first = r->count++ ? r->first : point->t;
    r->last = point->t;
    return 0;
}

static void look_at_energy(nevh_ensemble *e) {
    for (size_t lane = 0; lane < e->width; lane++) {
        const nevh__lane *l = &e->lanes[lane];
        e->on[lane] = l->look;
        e->step[lane] = l->step;
        if (l->look && l->fresh)
            nevh__energy_restart(e->energy, lane);
    }
    nevh__energy_observe_lanes(e->energy, e->on, e->step, e->now.t, e->q, e->p);
    for (size_t lane = 0; lane < e->width; lane++) {
        nevh__lane *l = &e->lanes[lane];
        if (!l->look || e->on[lane])
            continue;
        nevh__fail(&l->report, NEVH_EDOM,
                   "the energy, or its balance, is not finite at t = %.9g",
                   l->t);
        l->over = true;
    }
}

void nevh__ensemble_look(nevh_ensemble *e) {
    evaluate(e);
    if (e->energy)
        look_at_energy(e);
    for (size_t lane = 0; lane < e->width; lane++) {
        nevh__lane *l = &e->lanes[lane];
        if (!l->look || l->over)
            continue;
        for (size_t i = 0; i < e->n_outcomes; i++)
            take(e, lane, i);
        l->over |=
            all_known(e, lane) || (e->is.stop.value && e->stop[lane] > 0);
        l->fresh = false;
    }
    if (e->crossing_lanes)
        nevh__ensemble_look_at_crossings(e);
}

void nevh__ensemble_fail(nevh_ensemble *e, size_t lane,
                         const nevh__report *report) {
    e->lanes[lane].report = *report;
    e->lanes[lane].over = true;
}

/* Of the largest line; NAN where there is none, or too few samples, or less than
   a turn of it. */
static double frequency_of(const nevh__record *r, double period) {
    nevh_spectral_line lines[LINES];
    size_t found = 0, count;
    double h;
    nevh_spectral_samples_straighten(r->samples, period);
    const double *values = nevh_spectral_samples_values(r->samples, &count, &h);
    int status = nevh_frequencies(h, count, values, LINES, lines, &found);
    if (status || !found)
        return NAN;
    double turns = lines[0].frequency * h * (double)(count - 1) / (2 * pi);
    return turns < 1 ? NAN : lines[0].frequency;
}

static double number_of(const nevh_ensemble *e, size_t lane, size_t o) {
    const nevh__record *r = &e->records[o * e->width + lane];
    double span = e->lanes[lane].t - e->is.t_start;
    switch (e->outcomes[o].kind) {
    case NEVH_OUTCOME_TIME:
        return e->lanes[lane].t;
    case NEVH_OUTCOME_ENERGY_ERROR:
        return nevh_energy_result(e->energy, lane).max;
    case NEVH_OUTCOME_VERDICT:
        return nevh_energy_result(e->energy, lane).verdict;
    case NEVH_OUTCOME_MEAN:
        return span != 0 ? (r->value + r->roundoff) / span
                         : e->now.value[o * e->stride + lane];
    case NEVH_OUTCOME_FREQUENCY:
        return frequency_of(r, e->outcomes[o].modulus);
    case NEVH_OUTCOME_CROSSINGS:
        return (double)r->count;
    case NEVH_OUTCOME_PERIOD:
        return r->count > 1 ? (r->last - r->first) / (double)(r->count - 1)
                            : NAN;
    default:
        return r->value;
    }
}

static void collect(nevh_ensemble *e, size_t lane) {
    double *to = e->result;
    for (size_t i = 0; i < e->n_outcomes; i++) {
        if (e->outcomes[i].kind != NEVH_OUTCOME_STATE) {
            *to++ = number_of(e, lane, i);
            continue;
        }
        for (size_t k = 0; k < e->n; k++, to++) {
            to[0] = e->q[k * e->width + lane];
            to[e->n] = e->p[k * e->width + lane];
        }
        to += e->n;
    }
}

void nevh__ensemble_end(nevh_ensemble *e, size_t lane) {
    nevh__lane *l = &e->lanes[lane];
    for (size_t i = 0; i < e->columns; i++)
        e->result[i] = NAN;
    if (!l->report.status)
        collect(e, lane);
    nevh_member_result result = {l->member, l->report.status, l->report.text,
                                 e->result};
    l->busy = l->over = false;
    nevh__own_drop(e, lane);
    if (e->chaotic && !l->report.status) {
        nevh__chaotic_queue(e, lane);
        return;
    }
    e->stopped = e->done(e->data, &result) != 0 || e->stopped;
}
