/* nevh: the outcomes crossings and period: of a section, orbits side by side.

   Values, and slopes along the flow, are taken of all lanes at once.  They are
   those that lib/run/section.c takes of one orbit; where they tell that a value
   may meet a level within the step, it searches as it does for one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include "gradient/field_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct nevh__crossing_lanes {
    double *slope, *slope_after;            /* a row of `stride` a crossing */
    double *dq, *dp, *q, *p, *t, *d, *next; /* rows: the flow; states ahead */
    int *came;                              /* a row a crossing */
    double numbers[];
};

typedef struct {
    double first, last; /* times */
    size_t count;
} crossed;

static void crossings_begin(const nevh__observation *at, void *record) {
    (void)at;
    *(crossed *)record = (crossed){0};
}

static void end_crossings(const nevh__observation *at, const void *record,
                          double result[]) {
    (void)at;
    *result = (double)((const crossed *)record)->count;
}

/* NAN below two crossings. */
static void end_period(const nevh__observation *at, const void *record,
                       double result[]) {
    const crossed *x = record;
    (void)at;
    *result =
        x->count > 1 ? (x->last - x->first) / (double)(x->count - 1) : NAN;
}

const nevh__outcome_type nevh__outcome_crossings = {
    .info = {.name = "crossings",
             .takes = NEVH_OUTCOME_TAKES_SECTION,
             .help = "how often a section is crossed"},
    .branches = true,
    .size = sizeof(crossed),
    .begin = crossings_begin,
    .end = end_crossings,
};
const nevh__outcome_type nevh__outcome_period = {
    .info = {.name = "period",
             .takes = NEVH_OUTCOME_TAKES_SECTION,
             .unit = NEVH_UNIT_TIME,
             .help = "the mean time between crossings of a section"},
    .branches = true,
    .size = sizeof(crossed),
    .begin = crossings_begin,
    .end = end_period,
};

/* A section's value, at the state beside the orbits. */
typedef struct {
    nevh_ensemble *ensemble;
    size_t outcome;
} crossing;

static int value_of_crossing(void *data, double t, const double q[],
                             const double p[], double *value) {
    const crossing *c = data;
    nevh_ensemble *e = c->ensemble;
    memcpy(e->q1, q, e->n * sizeof *q);
    memcpy(e->p1, p, e->n * sizeof *p);
    *value = nevh__narrow_value(e, c->outcome, t);
    return NEVH_OK;
}

/* A point of a section of e->crossing_lane. */
static int cross(void *ensemble, const nevh_point *point) {
    const nevh_ensemble *e = ensemble;
    crossed *x =
        nevh__record_of(e, e->crossing_of[point->section], e->crossing_lane);
    x->first = x->count++ ? x->first : point->t;
    x->last = point->t;
    return 0;
}

static bool plan_lanes(nevh_ensemble *e) {
    size_t rows = 4 * e->n + 2 * e->n_crossings + 3;
    nevh__crossing_lanes *c = nevh__array(
        1, sizeof *c + (rows * e->stride + NEVH__LANES) * sizeof *c->numbers);
    e->crossing_lanes = c;
    if (!c || !(c->came = nevh__array(e->n_crossings * e->width, sizeof(int))))
        return false;
    size_t half = e->n * e->stride;
    c->slope = nevh__aligned(c->numbers);
    c->slope_after = c->slope + e->n_crossings * e->stride;
    c->dq = c->slope_after + e->n_crossings * e->stride;
    c->dp = c->dq + half;
    c->q = c->dp + half;
    c->p = c->q + half;
    c->t = c->p + half;
    c->d = c->t + e->stride;
    c->next = c->d + e->stride;
    return true;
}

/* The crossings are freed with the ensemble, as data of the first. */
int nevh__ensemble_plan_crossings(nevh_ensemble *e) {
    if (!e->n_crossings)
        return NEVH_OK;
    crossing *data = nevh__array(e->n_crossings, sizeof *data);
    if (!data)
        return nevh__no_memory(&e->report);
    for (size_t i = 0; i < e->n_crossings; i++) {
        const nevh_outcome *o = &e->outcomes[e->crossing_of[i]].decl;
        data[i] = (crossing){e, e->crossing_of[i]};
        e->crossings[i] = (nevh_section){.value = value_of_crossing,
                                         .data = &data[i],
                                         .direction = o->direction,
                                         .period = o->modulus};
    }
    e->sections = nevh_sections_new(e->alone ? e->stepper : e->narrow,
                                    e->crossings, e->n_crossings, cross, e);
    if (e->sections && nevh_sections_status(e->sections))
        return nevh__fail_as(&e->report, &e->sections->report);
    return e->sections && (e->alone || plan_lanes(e))
               ? NEVH_OK
               : nevh__no_memory(&e->report);
}

void nevh__ensemble_free_crossings(nevh_ensemble *e) {
    nevh_sections_free(e->sections);
    if (e->crossing_lanes)
        free(e->crossing_lanes->came);
    free(e->crossing_lanes);
    if (e->n_crossings && e->crossings)
        free(e->crossings[0].data);
    free(e->crossing_of);
    free(e->crossings);
}

/* dp/dt and dq/dt of a lane alone, where one of them has none. */
static void flow_of_lane(nevh_ensemble *e, size_t lane, double t,
                         const double q[], const double p[]) {
    nevh__crossing_lanes *c = e->crossing_lanes;
    double *v = e->v1, *force = e->wide_p1;
    for (size_t k = 0; k < e->n; k++) {
        e->q1[k] = q[k * e->stride + lane];
        e->p1[k] = p[k * e->stride + lane];
    }
    int status = nevh__field_whole_gradient(e->narrow->work.field, 1, &t, e->q1,
                                            e->p1, force, v);
    for (size_t k = 0; k < e->n; k++) {
        c->dq[k * e->stride + lane] = status ? NAN : v[k];
        c->dp[k * e->stride + lane] = status ? NAN : force[k];
    }
}

static void find_flow(nevh_ensemble *e, const double t[], const double q[],
                      const double p[]) {
    nevh__crossing_lanes *c = e->crossing_lanes;
    const double *rates = e->narrow->rates;
    if (nevh__field_whole_gradient(e->narrow->work.field, e->stride, t, q, p,
                                   c->dp, c->dq))
        for (size_t lane = 0; lane < e->width; lane++)
            flow_of_lane(e, lane, t[lane], q, p);
    for (size_t i = 0; i < e->n * e->stride; i++)
        c->dp[i] = -c->dp[i] - (rates ? rates[i / e->stride] * p[i] : 0);
}

/* Finds the derivatives of the values in all lanes. */
static void crossings_find_slopes(nevh_ensemble *e, const double t[],
                                  const double q[], const double p[],
                                  const double values[], double slopes[]) {
    nevh__crossing_lanes *c = e->crossing_lanes;
    find_flow(e, t, q, p);
    for (size_t lane = 0; lane < e->stride; lane++) {
        c->d[lane] = nevh__section_ahead * (e->now.t[lane] - e->ago1.t[lane]);
        c->t[lane] = t[lane] + c->d[lane];
    }
    for (size_t i = 0; i < e->n * e->stride; i++) {
        c->q[i] = q[i] + c->d[i % e->stride] * c->dq[i];
        c->p[i] = p[i] + c->d[i % e->stride] * c->dp[i];
    }
    nevh__ensemble_move(e, c->t, c->q, c->p);
    for (size_t i = 0; i < e->n_crossings; i++) {
        const double *value = values + e->crossing_of[i] * e->stride;
        double *slope = slopes + i * e->stride;
        nevh__ensemble_value(e, e->crossing_of[i], c->t, c->q, c->p, c->next);
        for (size_t lane = 0; lane < e->stride; lane++)
            slope[lane] = isnan(c->dq[lane])
                              ? NAN
                              : (c->next[lane] - value[lane]) / c->d[lane];
    }
}

/* The step that a lane has taken last. */
static void load_step(nevh_ensemble *e, size_t lane) {
    nevh_sections *x = e->sections;
    const nevh__crossing_lanes *c = e->crossing_lanes;
    x->first = e->lanes[lane].step == 1;
    x->t = e->ago1.t[lane];
    x->t_after = e->now.t[lane];
    x->h = e->ago1.h[lane];
    for (size_t i = 0; i < x->count; i++) {
        nevh__section_state *k = &x->states[i];
        size_t at = e->crossing_of[i] * e->stride + lane;
        k->value = e->ago1.value[at];
        k->value_after = e->now.value[at];
        k->slope = c->slope[i * e->stride + lane];
        k->slope_after = c->slope_after[i * e->stride + lane];
        k->came = c->came[i * e->width + lane];
    }
}

/* The states, from which shorter steps branch off and where the step ends. */
static void load_states(nevh_ensemble *e, size_t lane) {
    nevh_sections *x = e->sections;
    for (size_t k = 0; k < e->n; k++) {
        size_t at = k * e->width + lane;
        x->q[k] = e->ago1.q[at];
        x->p[k] = e->ago1.p[at];
        e->run_q[k] = e->q[at];
        e->run_p[k] = e->p[at];
    }
    for (size_t row = 0; row < e->stepper->rows; row++) {
        size_t at = row * e->width + lane;
        x->memory[row] = e->ago1.memory[at];
        e->run_memory[row] = e->stepper->work.memory[at];
    }
    x->q_after = e->run_q;
    x->p_after = e->run_p;
    x->memory_after = e->run_memory;
}

/* True if all values are finite; otherwise the orbit fails, as it does alone. */
static bool crossings_all_finite(nevh_ensemble *e, size_t lane) {
    nevh_sections *x = e->sections;
    double value;
    for (size_t i = 0; i < x->count; i++)
        if (!isfinite(e->now.value[e->crossing_of[i] * e->stride + lane])) {
            nevh__lane_to_narrow(e, e->q, e->p, e->stepper->work.memory, lane);
            memcpy(e->run_q, e->q1, e->n * sizeof *e->q1);
            memcpy(e->run_p, e->p1, e->n * sizeof *e->p1);
            nevh__section_value(x, &x->states[i], e->now.t[lane], e->run_q,
                                e->run_p, &value);
            nevh__ensemble_fail(e, lane, &x->report);
            return false;
        }
    return true;
}

static void look_at_lane(nevh_ensemble *e, size_t lane) {
    nevh_sections *x = e->sections;
    int *came = e->crossing_lanes->came + lane;
    bool near = false;
    load_step(e, lane);
    for (size_t i = 0; i < x->count; i++)
        near |= nevh__section_near(x, &x->states[i]);
    if (!near)
        return;
    e->crossing_lane = lane;
    x->report = (nevh__report){0};
    load_states(e, lane);
    if (nevh__sections_search(x))
        nevh__ensemble_fail(e, lane, &x->report);
    for (size_t i = 0; i < x->count; i++)
        came[i * e->width] = x->states[i].came;
}

static void keep_slopes(nevh_ensemble *e, size_t lane, const double from[]) {
    for (size_t i = lane; i < e->n_crossings * e->stride; i += e->stride)
        e->crossing_lanes->slope[i] = from[i];
}

/* Slopes where the first step began, of lanes that took it. */
static void begin_slopes(nevh_ensemble *e) {
    double *slope = e->crossing_lanes->slope_after;
    crossings_find_slopes(e, e->ago1.t, e->ago1.q, e->ago1.p, e->ago1.value,
                          slope);
    for (size_t lane = 0; lane < e->width; lane++)
        if (e->lanes[lane].look && e->lanes[lane].step == 1)
            keep_slopes(e, lane, slope);
}

void nevh__ensemble_look_at_crossings(nevh_ensemble *e) {
    nevh__crossing_lanes *c = e->crossing_lanes;
    bool any = false, first = false;
    for (size_t lane = 0; lane < e->width; lane++) {
        const nevh__lane *l = &e->lanes[lane];
        if (!l->look || l->over)
            continue;
        any |= l->step > 0;
        first |= l->step == 1;
        for (size_t i = lane; !l->step && i < e->n_crossings * e->width;
             i += e->width)
            c->came[i] = 0;
    }
    if (first)
        begin_slopes(e);
    if (any)
        crossings_find_slopes(e, e->now.t, e->q, e->p, e->now.value,
                              c->slope_after);
    for (size_t lane = 0; lane < e->width; lane++) {
        const nevh__lane *l = &e->lanes[lane];
        if (!l->look || l->over || !crossings_all_finite(e, lane) || !l->step)
            continue;
        look_at_lane(e, lane);
        keep_slopes(e, lane, c->slope_after);
    }
}
