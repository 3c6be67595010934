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
#include "adaptive_verlet_step.h"
#include "gradient/field_private.h"
#include "system/system_private.h"
#include "work/transform_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct nevh__leap_owner {
    nevh_work *work;
};

typedef struct {
    nevh_field *s; /* of the user's s; NULL: |f| is taken */
    double *ds_dq, *ds_dp;
    double unit_q, unit_p; /* of coordinates and of momenta, for |f| */
    struct nevh__leap_owner owner;
} plan_data;

/* The nevh__density of a step is stored after the compensations and dV/dq. */
enum { CONTROL_ROWS = sizeof(nevh__density) / sizeof(double) };

static void clear(nevh_work *w) {
    plan_data *d = w->plan;
    if (!d)
        return;
    nevh_field_free(d->s);
    free(d);
    w->plan = NULL;
}

double nevh__adaptive_verlet_units(const nevh_work *w, double *unit_p) {
    const plan_data *d = w->plan;
    *unit_p = d->unit_p;
    return d->unit_q;
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

NEVH__INLINE int nevh__leap_slopes(const nevh__leap *x, double t, double *force,
                                   double *speed) {
    return nevh_work_gradient(x->owner->work, 1, &t, x->q, x->p, force, speed);
}

NEVH__INLINE int nevh__leap_pair(const nevh__leap *x, double t) {
    const double times[2] = {t, t};
    return nevh_work_gradient(x->owner->work, 2, times, x->pair,
                              x->pair + 2 * x->n, x->pair_slopes,
                              x->pair_slopes + 2 * x->n);
}

NEVH__INLINE int nevh__leap_account(const nevh__leap *x, bool of_q, double t,
                                    double length) {
    nevh_work *w = x->owner->work;
    return w->accounts ? nevh_work_account(w, of_q ? NEVH_OF_Q : NEVH_OF_P,
                                           length, &t, x->q, x->p)
                       : NEVH_OK;
}

/* n doubles each, the pair's 4n. */
static nevh__leap divide(nevh_work *w) {
    plan_data *d = w->plan;
    double *at = w->scratch;
    size_t n = w->n;
    d->owner.work = w;
    d->ds_dq = at + 6 * n;
    d->ds_dp = at + 7 * n;
    return (nevh__leap){.n = n,
                        .unit_q = d->unit_q,
                        .unit_p = d->unit_p,
                        .compensation = w->memory,
                        .q = at,
                        .p = at + n,
                        .force = at + 2 * n,
                        .speed = at + 3 * n,
                        .dq = at + 4 * n,
                        .dp = at + 5 * n,
                        .pair = at + 8 * n,
                        .pair_slopes = at + 12 * n,
                        .owner = &d->owner};
}

/* The user's s. */
static int value_of_s(nevh_work *w, const nevh__leap *x, double t, double *s) {
    const plan_data *d = w->plan;
    if (nevh_field_value(d->s, 1, &t, x->q, x->p, s))
        return nevh__transform_fail(w, d->s);
    if (*s > 0)
        return NEVH_OK;
    return nevh_work_fail(w, NEVH_EDOM,
                          "the step function s is %g, not positive, at t = "
                          "%.9g, q[0] = %.9g, p[0] = %.9g",
                          *s, t, x->q[0], x->p[0]);
}

/* -(ds/dt)/s for it. */
static int change_of_s(nevh_work *w, const nevh__leap *x, double t, double *g) {
    const plan_data *d = w->plan;
    double s, sum = 0;
    int status = value_of_s(w, x, t, &s);
    if (status)
        return status;
    if (nevh_field_gradient(d->s, 1, &t, x->q, x->p, d->ds_dq, d->ds_dp))
        return nevh__transform_fail(w, d->s);
    for (size_t k = 0; k < w->n; k++)
        sum += d->ds_dq[k] * x->speed[k] - d->ds_dp[k] * x->force[k];
    *g = -sum / s;
    return NEVH_OK;
}

static int find_change(nevh_work *w, const nevh__leap *x, double t,
                       nevh__density *c) {
    const plan_data *d = w->plan;
    return d->s ? change_of_s(w, x, t, &c->change)
                : nevh__leap_change(x, t, c->unit, &c->change);
}

/* Initialises an orbit; dV/dq and dT/dp are known. */
static int begin(nevh_work *w, const nevh__leap *x, double t,
                 nevh__density *c) {
    const plan_data *d = w->plan;
    const nevh__step_control *table = w->integrator->table;
    int status = NEVH_OK;
    c->begun = c->density = 1;
    c->unit = nevh__leap_size(x);
    if (d->s)
        status = value_of_s(w, x, t, &c->unit);
    return status || !table->reversible ? status : find_change(w, x, t, c);
}

/* s over its value at the start, at the state under way. */
static int stretch(nevh_work *w, const nevh__leap *x, double t,
                   const nevh__density *c, double *s) {
    const plan_data *d = w->plan;
    if (!d->s) {
        *s = nevh__leap_stretch(x, c->unit);
        return NEVH_OK;
    }
    int status = value_of_s(w, x, t, s);
    *s /= c->unit;
    return status;
}

/* The length of this step; the density moves on by half of h. */
static int choose_step(nevh_work *w, const nevh__leap *x, double t, double h,
                       nevh__density *c, double *step) {
    const nevh__step_control *table = w->integrator->table;
    double s = 1;
    int status = NEVH_OK;
    if (table->reversible)
        s = nevh__leap_rate(c, h);
    else
        status = stretch(w, x, t, c, &s);
    *step = h * s;
    if (status || (s > NEVH__LEAST_RATE && isfinite(*step)))
        return status;
    return nevh_work_fail(w, NEVH_EDOM,
                          "at t = %.9g the step would be %g times h = %g (a "
                          "collision, or too large a step before): take a "
                          "smaller one",
                          t, s, h);
}

/* The state at the start and its field. */
static int open_step(nevh_work *w, const nevh__leap *x, double t,
                     const double q[], const double p[], nevh__density *c) {
    size_t n = w->n;
    memcpy(c, w->memory + 3 * n, sizeof *c);
    nevh__leap_place(x, q, p, w->memory + 2 * n);
    int status =
        nevh__leap_slopes(x, t, c->begun == 0 ? x->force : NULL, x->speed);
    return status || c->begun != 0 ? status : begin(w, x, t, c);
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const nevh__step_control *table = w->integrator->table;
    nevh__leap x = divide(w);
    nevh__density c;
    size_t n = w->n;
    double length = h;
    int status = open_step(w, &x, t, q, p, &c);
    if (!status)
        status = choose_step(w, &x, t, h, &c, &length);
    if (!status)
        status = nevh__leap_take(&x, t, length, q, p);
    if (!status && table->reversible) {
        status = find_change(w, &x, t + length, &c);
        c.density += h / 2 * c.change;
    }
    if (!status)
        status =
            nevh_work_commit(w, n, q, x.dq, w->memory, p, x.dp, w->memory + n);
    if (status)
        return status;
    memcpy(w->memory + 2 * n, x.force, n * sizeof *x.force);
    memcpy(w->memory + 3 * n, &c, sizeof c);
    w->elapsed = length;
    return NEVH_OK;
}

const nevh_kernel nevh__adaptive_verlet_kernel = {
    .plan = plan, .step = step, .clear = clear};
