/* nevh tests: orbits whose sections are recorded.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_SECTION_H
#define NEVH_TESTS_SECTION_H

#include "support.h"
#include <math.h>
#include <nevh/section.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* What was found. */
enum { MOST_POINTS = 4000 };
typedef struct {
    size_t count, stop_at; /* 0: never */
    struct {
        size_t section;
        int direction;
        double t, q[MOST_DOF], p[MOST_DOF];
    } at[MOST_POINTS];
    size_t n;
} album;

static inline int record(void *data, const nevh_point *point) {
    album *a = data;
    ck_assert_uint_lt(a->count, MOST_POINTS);
    a->at[a->count].section = point->section;
    a->at[a->count].direction = point->direction;
    a->at[a->count].t = point->t;
    memcpy(a->at[a->count].q, point->q, a->n * sizeof(double));
    memcpy(a->at[a->count].p, point->p, a->n * sizeof(double));
    return ++a->count == a->stop_at;
}

static inline size_t count_of(const album *a, size_t section, int direction) {
    size_t count = 0;
    for (size_t i = 0; i < a->count; i++)
        count += a->at[i].section == section && a->at[i].direction == direction;
    return count;
}

typedef struct {
    nevh_system *system;
    nevh_stepper *stepper;
    nevh_sections *sections;
    nevh_observer observer;
    album found;
    double t, q[MOST_DOF], p[MOST_DOF];
} orbit;

static inline orbit *look_at(nevh_system *system, const nevh_integrator *scheme,
                             const double q[], const double p[],
                             const nevh_section sections[], size_t count) {
    orbit *o = calloc(1, sizeof *o);
    nevh_options options = {.gradient = nevh_exact, .q = q, .p = p};
    size_t n = nevh_system_dof(system);
    ck_assert_ptr_nonnull(o);
    o->system = system;
    o->stepper = nevh_stepper_new(system, scheme, &options);
    ck_assert_msg(!nevh_stepper_status(o->stepper), "%s",
                  nevh_stepper_message(o->stepper));
    o->found.n = n;
    o->sections =
        nevh_sections_new(o->stepper, sections, count, record, &o->found);
    ck_assert_msg(!nevh_sections_status(o->sections), "%s",
                  nevh_sections_message(o->sections));
    o->observer = (nevh_observer){nevh_sections_observe, o->sections, 1};
    memcpy(o->q, q, n * sizeof *q);
    memcpy(o->p, p, n * sizeof *p);
    return o;
}

static inline int go(orbit *o, double h, double t_end) {
    int status =
        nevh_run_until(o->stepper, o->t, h, t_end, o->q, o->p, &o->observer, 1);
    o->t = t_end;
    return status;
}

static inline void put_away(orbit *o) {
    nevh_sections_free(o->sections);
    nevh_stepper_free(o->stepper);
    nevh_system_free(o->system);
    free(o);
}

/* Sections. */
static inline int coordinate(void *data, double t, const double q[],
                             const double p[], double *value) {
    (void)t, (void)p;
    *value = q[0] - (data ? *(const double *)data : 0);
    return NEVH_OK;
}
static inline int second(void *data, double t, const double q[],
                         const double p[], double *value) {
    (void)t, (void)p;
    *value = q[1] - *(const double *)data;
    return NEVH_OK;
}
static inline int power(void *data, double t, const double q[],
                        const double p[], double *value) {
    (void)t, (void)p;
    *value = pow(q[0] - 0.3, *(const double *)data);
    return NEVH_OK;
}
static inline int momentum(void *data, double t, const double q[],
                           const double p[], double *value) {
    (void)t, (void)q;
    *value = p[0] - *(const double *)data;
    return NEVH_OK;
}
/* Zeros in time, ended by NAN. */
static inline int zeros(void *data, double t, const double q[],
                        const double p[], double *value) {
    (void)q, (void)p;
    *value = 1;
    for (const double *zero = data; !isnan(*zero); zero++)
        *value *= t - *zero;
    return NEVH_OK;
}
static inline int flat(void *data, double t, const double q[], const double p[],
                       double *value) {
    (void)data, (void)q, (void)p;
    *value = t < 0.5 ? t - 0.5 : t > 1 ? t - 1 : 0;
    return NEVH_OK;
}
static inline int sawtooth(void *data, double t, const double q[],
                           const double p[], double *value) {
    (void)data, (void)t, (void)p;
    *value = remainder(q[0], 2 * pi);
    return NEVH_OK;
}
static inline int pole(void *data, double t, const double q[], const double p[],
                       double *value) {
    (void)data, (void)t, (void)p;
    *value = 1 / q[0];
    return NEVH_OK;
}
static inline int proportional(void *data, double t, const double q[],
                               const double p[], double *value) {
    (void)q, (void)p;
    *value = t * *(const double *)data;
    return NEVH_OK;
}
static inline int breaking(void *data, double t, const double q[],
                           const double p[], double *value) {
    const int *status = data;
    (void)p;
    *value = t > 1 && !*status ? NAN : q[0];
    return t > 1 ? *status : NEVH_OK;
}

static const nevh_oscillator unit_spring = {1, 1};
static const nevh_pendulum unit_pendulum = {1, 1, 1}, rotor = {1, 1, 0};

/* x = cos t, by a scheme that keeps the circle. */
static inline orbit *on_circle(double t0, const nevh_section sections[],
                               size_t count) {
    const double q = cos(t0), p = -sin(t0);
    orbit *o = look_at(nevh_oscillator_model->system(&unit_spring),
                       nevh_gauss20, &q, &p, sections, count);
    o->t = t0;
    return o;
}

static inline orbit *pendulum(const nevh_pendulum *params, double q, double p,
                              const nevh_section sections[], size_t count) {
    return look_at(nevh_pendulum_model->system(params), nevh_gauss8, &q, &p,
                   sections, count);
}

static inline orbit *of_problem(const problem *b, const nevh_integrator *scheme,
                                const nevh_section sections[], size_t count) {
    orbit *o = look_at(b->make(), scheme, b->q, b->p, sections, count);
    o->t = b->t0;
    return o;
}

#endif
