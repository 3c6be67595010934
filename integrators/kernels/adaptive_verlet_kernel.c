/* nevh: Stoermer-Verlet steps whose length follows the orbit.

   Nominal steps h are steps of a time tau with dt/dtau = 1/rho, where the
   density rho is to follow 1/s for a step function s(q, p) > 0.  Taking
   h s(q, p) at the start of each step would do so, but backwards the step is
   another one, and the energy drifts.  Hairer and Soederlind integrate rho
   beside the state instead,

       rho' = rho + h/2 G(q, p),  a Verlet step of h/rho',
       rho  = rho' + h/2 G at its end,     G = -(ds/dt) / s along the orbit,

   which is symmetric [E. Hairer, G. Soederlind, Explicit, time reversible,
   adaptive step size control, SIAM J. Sci. Comput. 26 (2005) 1838-1851].

   s is the user's, or else |f|^(-3/4), f being the field, with coordinates in
   units of the largest length over which H varies with one, and momenta alike:
   under gravity, where |f| grows as 1/r^2, that is r^1.5.  A unit for each
   would make |f| of a round orbit depend on the direction, and rho lose s.
   Where f is nearly zero its length at the start bounds the step.  s is divided
   by its value at the start.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "adaptive_verlet_private.h"
#include "gradient/field_private.h"
#include "system/system_private.h"
#include "work/transform_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double power = 0.75;
static const double most_stretch = 10; /* of |f|, from its size at the start */
static const double spread = 1e-2;     /* of differences along the orbit */

typedef struct {
    nevh_field *s;         /* of the user's s; NULL: |f| is taken */
    double *q, *p;         /* the state under way */
    double *force, *speed; /* dV/dq and dT/dp there */
    double *dq, *dp;       /* increments of the step */
    double *pair;          /* two states beside each other: q, p, */
    double *pair_slopes;   /* dV/dq, dT/dp */
    double *ds_dq, *ds_dp;
    double unit_q, unit_p; /* of coordinates and of momenta, for |f| */
} plan_data;

/* What a step tells the next one, after the compensations and dV/dq. */
typedef struct {
    double begun;
    double unit;    /* s at the start of the orbit, or |f| */
    double density; /* rho */
    double change;  /* G */
} control;
enum { CONTROL_ROWS = sizeof(control) / sizeof(double) };

static void clear(nevh_work *w) {
    plan_data *d = w->plan;
    if (!d)
        return;
    nevh_field_free(d->s);
    free(d);
    w->plan = NULL;
}

/* n doubles each, in the order of plan_data. */
static void divide(const nevh_work *w, plan_data *d) {
    double **const parts[] = {&d->q,  &d->p,  &d->force, &d->speed,
                              &d->dq, &d->dp, &d->ds_dq, &d->ds_dp};
    double *at = w->scratch;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++, at += w->n)
        *parts[i] = at;
    d->pair = at;
    d->pair_slopes = at + 4 * w->n;
}

/* Not w->scale, which is the size of the orbit where that is less. */
static int plan_units(nevh_work *w) {
    plan_data *d = w->plan;
    double *length = nevh__array(2 * w->n, sizeof *length);
    if (!length)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    int status = nevh__field_lengths(w->field, w->options, length);
    for (size_t k = 0; k < w->n; k++) {
        d->unit_q = fmax(d->unit_q, length[k]);
        d->unit_p = fmax(d->unit_p, length[w->n + k]);
    }
    free(length);
    return status
               ? nevh_work_fail(w, status, "%s", nevh_field_message(w->field))
               : NEVH_OK;
}

static int plan(nevh_work *w) {
    plan_data *d = w->plan = nevh__array(1, sizeof *d);
    w->memory_rows = 3 * w->n + CONTROL_ROWS;
    w->scratch_size = 16 * w->n;
    if (!d)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    return w->options->transform ? nevh__transform_field(w, &d->s)
                                 : plan_units(w);
}

/* dV/dq, dT/dp or both at the state under way. */
static int take(nevh_work *w, double t, double force[], double speed[]) {
    const plan_data *d = w->plan;
    return nevh_work_gradient(w, 1, &t, d->q, d->p, force, speed);
}

/* |f|, in those units. */
static double field_size(const nevh_work *w) {
    const plan_data *d = w->plan;
    double size = 0;
    for (size_t k = 0; k < w->n; k++) {
        size = hypot(size, d->speed[k] / d->unit_q);
        size = hypot(size, d->force[k] / d->unit_p);
    }
    return size;
}

/* |f| squared over itself guarded from 0. */
static double guard(double size, double unit) {
    double least = unit / most_stretch / size;
    return 1 / (1 + least * least);
}

/* The part of another field along the unit vector of f. */
static double along_field(const nevh_work *w, double size, const double force[],
                          const double speed[]) {
    const plan_data *d = w->plan;
    double sum = 0, q = d->unit_q, p = d->unit_p;
    for (size_t k = 0; k < w->n; k++)
        sum += d->speed[k] / q / size * (speed[2 * k] / q) +
               d->force[k] / p / size * (force[2 * k] / p);
    return sum;
}

/* -d(ln s)/dt for s = |f|^-power, by a difference along the orbit. */
static int change_of_field(nevh_work *w, double t, double unit, double *g) {
    plan_data *d = w->plan;
    size_t n = w->n;
    double size = field_size(w), times[2] = {t, t}, time = spread / size;
    double *q = d->pair, *p = q + 2 * n, *force = d->pair_slopes;
    double *speed = force + 2 * n;
    *g = 0;
    if (!(size > 0))
        return NEVH_OK;
    for (size_t k = 0; k < n; k++) {
        q[2 * k] = d->q[k] + time * d->speed[k];
        q[2 * k + 1] = d->q[k] - time * d->speed[k];
        p[2 * k] = d->p[k] - time * d->force[k];
        p[2 * k + 1] = d->p[k] + time * d->force[k];
    }
    int status = nevh_work_gradient(w, 2, times, q, p, force, speed);
    if (status)
        return status;
    double ahead = along_field(w, size, force, speed);
    double behind = along_field(w, size, force + 1, speed + 1);
    *g = power * guard(size, unit) * ((ahead - behind) / (2 * spread));
    return NEVH_OK;
}

/* The user's s. */
static int value_of_s(nevh_work *w, double t, double *s) {
    const plan_data *d = w->plan;
    if (nevh_field_value(d->s, 1, &t, d->q, d->p, s))
        return nevh__transform_fail(w, d->s);
    if (*s > 0)
        return NEVH_OK;
    return nevh_work_fail(w, NEVH_EDOM,
                          "the step function s is %g, not positive, at t = "
                          "%.9g, q[0] = %.9g, p[0] = %.9g",
                          *s, t, d->q[0], d->p[0]);
}

/* -(ds/dt)/s for it. */
static int change_of_s(nevh_work *w, double t, double *g) {
    const plan_data *d = w->plan;
    double s, sum = 0;
    int status = value_of_s(w, t, &s);
    if (status)
        return status;
    if (nevh_field_gradient(d->s, 1, &t, d->q, d->p, d->ds_dq, d->ds_dp))
        return nevh__transform_fail(w, d->s);
    for (size_t k = 0; k < w->n; k++)
        sum += d->ds_dq[k] * d->speed[k] - d->ds_dp[k] * d->force[k];
    *g = -sum / s;
    return NEVH_OK;
}

static int find_change(nevh_work *w, double t, control *c) {
    const plan_data *d = w->plan;
    return d->s ? change_of_s(w, t, &c->change)
                : change_of_field(w, t, c->unit, &c->change);
}

/* Where an orbit begins; dV/dq and dT/dp are known. */
static int begin(nevh_work *w, double t, control *c) {
    const plan_data *d = w->plan;
    const nevh__step_control *table = w->integrator->table;
    int status = NEVH_OK;
    c->begun = c->density = 1;
    c->unit = field_size(w);
    if (d->s)
        status = value_of_s(w, t, &c->unit);
    return status || !table->reversible ? status : find_change(w, t, c);
}

/* s over its value at the start, at the state under way. */
static int stretch(nevh_work *w, double t, const control *c, double *s) {
    const plan_data *d = w->plan;
    if (d->s) {
        int status = value_of_s(w, t, s);
        *s /= c->unit;
        return status;
    }
    double size = field_size(w), least = c->unit / most_stretch;
    double ratio = hypot(c->unit, least) / hypot(size, least);
    *s = ratio > 0 ? pow(ratio, power) : 1;
    return NEVH_OK;
}

/* The length of this step; the density moves on by half of h. */
static int choose_step(nevh_work *w, double t, double h, control *c,
                       double *step) {
    const nevh__step_control *table = w->integrator->table;
    double s = 1;
    int status = NEVH_OK;
    if (table->reversible) {
        c->density += h / 2 * c->change;
        s = 1 / c->density;
    } else {
        status = stretch(w, t, c, &s);
    }
    *step = h * s;
    if (status || (s > NEVH__LEAST_RATE && isfinite(*step)))
        return status;
    return nevh_work_fail(w, NEVH_EDOM,
                          "at t = %.9g the step would be %g times h = %g (a "
                          "collision, or too large a step before): take a "
                          "smaller one",
                          t, s, h);
}

/* Of a kick or drift at the state under way. */
static int account(nevh_work *w, unsigned part, double t, double length) {
    const plan_data *d = w->plan;
    return w->accounts ? nevh_work_account(w, part, length, &t, d->q, d->p)
                       : NEVH_OK;
}

static void move(size_t n, const double start[], const double compensation[],
                 double step, const double slope[], double change[],
                 double point[]) {
    for (size_t k = 0; k < n; k++) {
        change[k] += step * slope[k];
        point[k] = start[k] + (change[k] + compensation[k]);
    }
}

/* Kick, drift, kick; leaves dV/dq and dT/dp of the new state. */
static int leap(nevh_work *w, double t, double step, const double q[],
                const double p[]) {
    plan_data *d = w->plan;
    size_t n = w->n;
    const double *compensation = w->memory;
    memset(d->dq, 0, n * sizeof *d->dq);
    memset(d->dp, 0, n * sizeof *d->dp);
    int status = account(w, NEVH_OF_Q, t, step / 2);
    move(n, p, compensation + n, -step / 2, d->force, d->dp, d->p);
    if (!status)
        status = take(w, t + step / 2, NULL, d->speed);
    if (!status)
        status = account(w, NEVH_OF_P, t + step / 2, step);
    if (status)
        return status;
    move(n, q, compensation, step, d->speed, d->dq, d->q);
    status = take(w, t + step, d->force, NULL);
    if (!status)
        status = account(w, NEVH_OF_Q, t + step, step / 2);
    if (status)
        return status;
    move(n, p, compensation + n, -step / 2, d->force, d->dp, d->p);
    return take(w, t + step, NULL, d->speed);
}

/* The state at the start and its field. */
static int open_step(nevh_work *w, double t, const double q[], const double p[],
                     control *c) {
    plan_data *d = w->plan;
    size_t n = w->n;
    divide(w, d);
    memcpy(c, w->memory + 3 * n, sizeof *c);
    for (size_t k = 0; k < n; k++) {
        d->q[k] = q[k] + w->memory[k];
        d->p[k] = p[k] + w->memory[n + k];
        d->force[k] = w->memory[2 * n + k];
    }
    int status = take(w, t, c->begun == 0 ? d->force : NULL, d->speed);
    return status || c->begun != 0 ? status : begin(w, t, c);
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const nevh__step_control *table = w->integrator->table;
    plan_data *d = w->plan;
    control c;
    size_t n = w->n;
    double length = h;
    int status = open_step(w, t, q, p, &c);
    if (!status)
        status = choose_step(w, t, h, &c, &length);
    if (!status)
        status = leap(w, t, length, q, p);
    if (!status && table->reversible) {
        status = find_change(w, t + length, &c);
        c.density += h / 2 * c.change;
    }
    if (!status)
        status = nevh_work_commit(w, n, q, d->dq, w->memory, p, d->dp,
                                  w->memory + n);
    if (status)
        return status;
    memcpy(w->memory + 2 * n, d->force, n * sizeof *d->force);
    memcpy(w->memory + 3 * n, &c, sizeof c);
    w->elapsed = length;
    return NEVH_OK;
}

const nevh_kernel nevh__adaptive_verlet_kernel = {
    .plan = plan, .step = step, .clear = clear};
