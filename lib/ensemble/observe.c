/* nevh: what is kept of the orbits under way.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include <math.h>
#include <string.h>

/* Rows of `width`, in rows of `stride` that repeat the first lane. */
static void observe_widen(const nevh_ensemble *e, const double from[],
                          double to[]) {
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
    const nevh_quantity *quantity = &e->outcomes[o].decl.quantity;
    quantity->value(quantity->data, e->stride, t, q, p,
                    quantity->velocities ? e->v : NULL, values);
}

static void observe_evaluate(nevh_ensemble *e) {
    for (size_t lane = 0; lane < e->stride; lane++)
        e->now.t[lane] = e->lanes[lane < e->width ? lane : 0].t;
    observe_widen(e, e->q, e->wide_q);
    observe_widen(e, e->p, e->wide_p);
    nevh__ensemble_move(e, e->now.t, e->wide_q, e->wide_p);
    for (size_t i = 0; i < e->n_outcomes; i++)
        if (e->outcomes[i].decl.quantity.value)
            nevh__ensemble_value(e, i, e->now.t, e->wide_q, e->wide_p,
                                 e->now.value + i * e->stride);
    const nevh_quantity *stop = &e->options.stop;
    if (stop->value)
        stop->value(stop->data, e->stride, e->now.t, e->wide_q, e->wide_p,
                    stop->velocities ? e->v : NULL, e->stop);
}

double nevh__narrow_value(nevh_ensemble *e, size_t o, double t) {
    const nevh_quantity *quantity = &e->outcomes[o].decl.quantity;
    for (size_t lane = 0; lane < NEVH__LANES; lane++)
        e->t1[lane] = t;
    for (size_t i = 0; i < e->n * NEVH__LANES; i++) {
        e->wide_q1[i] = e->q1[i / NEVH__LANES];
        e->wide_p1[i] = e->p1[i / NEVH__LANES];
    }
    if (quantity->velocities &&
        nevh_field_gradient(e->motion, NEVH__LANES, e->t1, e->wide_q1,
                            e->wide_p1, NULL, e->v1))
        return NAN;
    quantity->value(quantity->data, NEVH__LANES, e->t1, e->wide_q1, e->wide_p1,
                    quantity->velocities ? e->v1 : NULL, e->value1);
    return e->value1[0];
}

void *nevh__record_of(const nevh_ensemble *e, size_t o, size_t lane) {
    const nevh__outcome_entry *entry = &e->outcomes[o];
    return entry->records + lane * entry->type->size;
}

/* The orbit of a lane, then an outcome of it. */
static void turn_to_lane(nevh__observation *at, size_t lane) {
    const nevh_ensemble *e = at->ensemble;
    at->lane = lane;
    at->step = e->lanes[lane].step;
    at->t = e->lanes[lane].t;
    at->t_before = e->ago1.t[lane];
}

static void *turn_to_outcome(nevh__observation *at, size_t o) {
    const nevh_ensemble *e = at->ensemble;
    const nevh__outcome_entry *entry = &e->outcomes[o];
    size_t i = o * e->stride + at->lane;
    at->outcome = o;
    at->decl = &entry->decl;
    at->value = e->now.value[i];
    at->values = &e->now.value[i];
    at->value_before = e->ago1.value[i];
    return entry->records + at->lane * entry->type->size;
}

static void observe_take(nevh__observation *at, bool fresh) {
    const nevh_ensemble *e = at->ensemble;
    for (size_t o = 0; o < e->n_outcomes; o++) {
        const nevh__outcome_type *type = e->outcomes[o].type;
        if (fresh && type->begin)
            type->begin(at, turn_to_outcome(at, o));
        else if (!fresh && type->step)
            type->step(at, turn_to_outcome(at, o));
    }
}

/* Nothing more can come of it. */
static bool all_known(const nevh_ensemble *e, size_t lane) {
    for (size_t o = 0; o < e->n_outcomes; o++) {
        const nevh__outcome_type *type = e->outcomes[o].type;
        if (!type->known || !type->known(nevh__record_of(e, o, lane)))
            return false;
    }
    return e->n_outcomes > 0;
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
    nevh__observation at = {
        .ensemble = e, .t_start = e->options.t_start, .count = 1};
    observe_evaluate(e);
    if (e->energy)
        look_at_energy(e);
    for (size_t lane = 0; lane < e->width; lane++) {
        nevh__lane *l = &e->lanes[lane];
        if (!l->look || l->over)
            continue;
        turn_to_lane(&at, lane);
        observe_take(&at, l->fresh);
        l->over |=
            all_known(e, lane) || (e->options.stop.value && e->stop[lane] > 0);
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

static void observe_collect(nevh_ensemble *e, size_t lane) {
    nevh__observation at = {.ensemble = e, .t_start = e->options.t_start};
    double *to = e->result;
    turn_to_lane(&at, lane);
    for (size_t o = 0; o < e->n_outcomes; o++) {
        const nevh__outcome_type *type = e->outcomes[o].type;
        if (type->end)
            type->end(&at, turn_to_outcome(&at, o), to);
        to += type->whole_state ? 2 * e->n : 1;
    }
}

void nevh__ensemble_end(nevh_ensemble *e, size_t lane) {
    nevh__lane *l = &e->lanes[lane];
    for (size_t i = 0; i < e->columns; i++)
        e->result[i] = NAN;
    if (!l->report.status)
        observe_collect(e, lane);
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
