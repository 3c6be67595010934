/* nevh: the time transform of a step's Hamiltonian; see <nevh/transform.h>.
   SPDX-License-Identifier: GPL-3.0-or-later

   grad K = s grad H + (H - H0) grad s, all over s0, from the gradient of H, one
   value of it, and a field of its own for s. */
#include "work/transform_private.h"
#include "gradient/field_private.h"
#include "system/system_private.h"
#include <nevh/probe.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

static int plan_arrays(nevh_work *w, nevh__transform *f) {
    size_t stages = (size_t)w->integrator->stages, n = w->n;
    f->capacity = 4 * n + 1 > stages ? 4 * n + 1 : stages;
    f->h = nevh__array(f->capacity, sizeof *f->h);
    f->s = nevh__array(f->capacity, sizeof *f->s);
    f->ds_dq = nevh__array(n * f->capacity, sizeof *f->ds_dq);
    f->ds_dp = nevh__array(n * f->capacity, sizeof *f->ds_dp);
    f->effects = nevh__array(w->system->n_effects, sizeof *f->effects);
    if (f->h && f->s && f->ds_dq && f->ds_dp && f->effects)
        return NEVH_OK;
    return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
}

int nevh__transform_fail(nevh_work *w, const nevh_field *s) {
    return nevh_work_fail(w, nevh_field_status(s), "the transform: %s",
                          nevh_field_message(s));
}

int nevh__transform_field(nevh_work *w, nevh_field **field) {
    const nevh_system *s = w->options->transform;
    nevh_options own = *w->options;
    if (s->report.status)
        return nevh_work_fail(w, s->report.status, "the transform: %s",
                              s->report.text);
    if (s->n != w->n)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "the transform has %zu degrees of freedom, H %zu",
                              s->n, w->n);
    if (!(nevh_system_traits(s) & NEVH_AUTONOMOUS))
        return nevh_work_fail(w, NEVH_EINVAL, "the transform reads the time");
    int status = nevh_work_find_scale(w);
    if (status)
        return status;
    /* grad s is multiplied by H - H0, which is next to nothing: where s has no
       exact gradient, differences will do under any method of H's. */
    own.gradient = nevh__best_gradient(s);
    own.gradient_step = 0;
    own.gradient_steps = NULL;
    own.scale = w->scale;
    *field = nevh_field_new(s, &own);
    if (!*field)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    return nevh_field_status(*field) ? nevh__transform_fail(w, *field)
                                     : NEVH_OK;
}

static int transform_refuse(nevh_work *w, const char *why) {
    return nevh_work_fail(w, NEVH_ESTRUCT,
                          "%s cannot take a time transform: %s; midpoint, "
                          "gauss4 and the other schemes for any H can",
                          w->integrator->name, why);
}

/* Refuses an H that depends on time.  Declarations do not decide: H as one function
   may read t. */
static int transform_check_time(nevh_work *w) {
    nevh_probe *b = nevh_probe_new(w->system, w->options);
    nevh_finding f = nevh_probe_finding(b, NEVH_IS_AUTONOMOUS);
    int status = nevh_probe_status(b);
    if (status)
        nevh_work_fail(w, status, "%s", nevh_probe_message(b));
    else if (!f.holds)
        status = nevh_work_fail(w, NEVH_ESTRUCT,
                                "H depends on time (by %.2g of its size), but "
                                "the time transform s (H - H0) needs an energy "
                                "that is conserved",
                                f.evidence);
    nevh_probe_free(b);
    return status;
}

static int transform_check(nevh_work *w) {
    const nevh_integrator *scheme = w->integrator;
    if (scheme->needs)
        return transform_refuse(
            w, "it needs H = T(p) + V(q), and s(q, p) (H - H0) is "
               "no such sum");
    if (scheme->kernel->opaque || scheme->kernel->own_slopes)
        return transform_refuse(w, "it takes its gradients on its own");
    if (scheme->preserves_energy == NEVH_YES)
        return transform_refuse(w, "it is H that it preserves, not s (H - H0)");
    if (scheme->symplectic == NEVH_EXTENDED)
        return transform_refuse(
            w, "its binding is chosen for H, not for s (H - H0)");
    return nevh_system_traits(w->system) & NEVH_AUTONOMOUS
               ? NEVH_OK
               : transform_check_time(w);
}

int nevh__transform_plan(nevh_work *w) {
    int status = transform_check(w);
    if (status)
        return status;
    nevh__transform *f = w->transform = nevh__array(1, sizeof *f);
    if (!f)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    status = nevh__transform_field(w, &f->field);
    return status ? status : plan_arrays(w, f);
}

void nevh__transform_free(nevh__transform *f) {
    if (!f)
        return;
    nevh_field_free(f->field);
    free(f->h);
    free(f->s);
    free(f->ds_dq);
    free(f->ds_dp);
    free(f->effects);
    free(f);
}

/* s at the points, all of it positive. */
static int find_s(nevh_work *w, size_t points, const double t[],
                  const double q[], const double p[]) {
    nevh__transform *f = w->transform;
    if (points > f->capacity)
        return nevh_work_fail(w, NEVH_EFAILED,
                              "%s: %zu points, where the transform planned %zu",
                              w->integrator->name, points, f->capacity);
    if (nevh_field_value(f->field, points, t, q, p, f->s))
        return nevh__transform_fail(w, f->field);
    for (size_t i = 0; i < points; i++)
        if (!(f->s[i] > 0))
            return nevh_work_fail(w, NEVH_EDOM,
                                  "the transform s is %g, not positive, at t = "
                                  "%.9g, q[0] = %.9g, p[0] = %.9g",
                                  f->s[i], t[i], q[i], p[i]);
    return NEVH_OK;
}

/* s and H - H0 at the points. */
static int find_both(nevh_work *w, size_t points, const double t[],
                     const double q[], const double p[]) {
    nevh__transform *f = w->transform;
    int status = find_s(w, points, t, q, p);
    if (status)
        return status;
    if (nevh_field_value(w->field, points, t, q, p, f->h))
        return nevh_work_fail(w, nevh_field_status(w->field), "%s",
                              nevh_field_message(w->field));
    for (size_t i = 0; i < points; i++)
        f->h[i] -= f->memory[NEVH__ENERGY];
    return NEVH_OK;
}

int nevh__transform_begin(nevh_work *w, double memory[], double t,
                          const double q[], const double p[]) {
    nevh__transform *f = w->transform;
    f->memory = memory;
    if (memory[NEVH__BEGUN] != 0)
        return NEVH_OK;
    memory[NEVH__ENERGY] = 0;
    int status = find_both(w, 1, &t, q, p);
    if (status)
        return status;
    memory[NEVH__BEGUN] = 1;
    memory[NEVH__ENERGY] = f->h[0];
    memory[NEVH__UNIT] = f->s[0];
    return NEVH_OK;
}

/* One half: dh = (s dh + (H - H0) ds) / s0. */
static void combine(const nevh_work *w, size_t points, const double ds[],
                    double dh[]) {
    const nevh__transform *f = w->transform;
    double unit = f->memory[NEVH__UNIT];
    for (size_t k = 0; dh && k < w->n; k++)
        for (size_t i = 0; i < points; i++) {
            double *out = &dh[k * points + i];
            *out = (f->s[i] * *out + f->h[i] * ds[k * points + i]) / unit;
        }
}

int nevh__transform_gradient(nevh_work *w, size_t points, const double t[],
                             const double q[], const double p[], double dh_dq[],
                             double dh_dp[]) {
    nevh__transform *f = w->transform;
    int status = find_both(w, points, t, q, p);
    if (status)
        return status;
    if (nevh_field_gradient(f->field, points, t, q, p, dh_dq ? f->ds_dq : NULL,
                            dh_dp ? f->ds_dp : NULL))
        return nevh__transform_fail(w, f->field);
    combine(w, points, f->ds_dq, dh_dq);
    combine(w, points, f->ds_dp, dh_dp);
    return NEVH_OK;
}

int nevh__transform_value(nevh_work *w, size_t points, const double t[],
                          const double q[], const double p[], double h[]) {
    const nevh__transform *f = w->transform;
    int status = find_both(w, points, t, q, p);
    for (size_t i = 0; !status && i < points; i++)
        h[i] = f->s[i] * f->h[i] / f->memory[NEVH__UNIT];
    return status;
}

/* Rounding noise of s grad H, and of (H - H0) grad s, where H is a sum of rounded
   effects. */
int nevh__transform_noise(nevh_work *w, double t, const double q[],
                          const double p[], double noise_q[],
                          double noise_p[]) {
    nevh__transform *f = w->transform;
    double unit = f->memory[NEVH__UNIT], rounding = 0;
    int status = find_s(w, 1, &t, q, p);
    if (status)
        return status;
    if (nevh_field_gradient(f->field, 1, &t, q, p, f->ds_dq, f->ds_dp))
        return nevh__transform_fail(w, f->field);
    if (nevh_field_effects(w->field, t, q, p, f->effects))
        return nevh_work_fail(w, nevh_field_status(w->field), "%s",
                              nevh_field_message(w->field));
    for (size_t i = 0; i < w->system->n_effects; i++)
        rounding += DBL_EPSILON * fabs(f->effects[i]);
    for (size_t k = 0; k < w->n; k++) {
        noise_q[k] =
            (f->s[0] * noise_q[k] + rounding * fabs(f->ds_dq[k])) / unit;
        noise_p[k] =
            (f->s[0] * noise_p[k] + rounding * fabs(f->ds_dp[k])) / unit;
    }
    return NEVH_OK;
}

int nevh__transform_pass(nevh_work *w, double weight, const double t[],
                         const double q[], const double p[]) {
    int status = find_s(w, 1, t, q, p);
    if (status)
        return status;
    double rate = w->transform->s[0] / w->transform->memory[NEVH__UNIT];
    w->elapsed += weight * rate;
    if (rate > NEVH__LEAST_RATE && rate <= DBL_MAX)
        return NEVH_OK;
    return nevh_work_fail(w, NEVH_EDOM,
                          "the transform s is %g times its value at the start "
                          "at t = %.9g%s",
                          rate, t[0], rate < 1 ? " (a collision?)" : "");
}
