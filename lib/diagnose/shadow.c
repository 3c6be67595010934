/* nevh: the first terms of the modified Hamiltonian of a scheme.

   The products with second derivatives are gradients of the variational system's
   K = dq.Hq + dp.Hp: dK/dq = Hqq dq + Hqp dp, dK/dp = Hpq dq + Hpp dp.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include "gradient/field_private.h"
#include <float.h>
#include <math.h>
#include <nevh/probe.h>
#include <nevh/shadow.h>
#include <stdlib.h>
#include <string.h>

/* The coefficients of Hp.Hq, Hp.Hqq Hp, Hq.Hpp Hq and Hq.Hpq Hp. */
typedef struct {
    const nevh_integrator *const *scheme;
    int order;
    double d, a, b, c;
} series;

/* The last one is of products that explicit schemes do not meet. */
static const series known[] = {
    {&nevh_symplectic_euler_a, 3, -1. / 2, 1. / 12, 1. / 12, 0},
    {&nevh_symplectic_euler_b, 3, 1. / 2, 1. / 12, 1. / 12, 0},
    {&nevh_verlet, 4, 0, 1. / 12, -1. / 24, 0},
    {&nevh_position_verlet, 4, 0, -1. / 24, 1. / 12, 0},
    {&nevh_lobatto2, 4, 0, 1. / 12, -1. / 24, 1. / 12},
    {&nevh_midpoint, 4, 0, -1. / 24, -1. / 24, 1. / 12},
};

/* The lanes of two directions. */
enum { ALONG_Q, ALONG_P, LANES };

struct nevh_shadow {
    nevh__report report;
    bool planned, begun;
    const series *series;
    size_t n;
    double h;
    nevh_field *field; /* of H, for values only */
    nevh__variational *variational;
    nevh_field *along;         /* of K */
    double *scale;             /* 2n */
    double *zq, *zp, *gq, *gp; /* states of K and its gradient: 2n x LANES */
    double t_start, energy, shadow;
    size_t step_start;
    nevh_shadow_report result;
};

static const series *series_of(const nevh_integrator *scheme) {
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (*known[i].scheme == scheme)
            return &known[i];
    return NULL;
}

static int shadow_check(nevh_shadow *s, const nevh_system *system,
                        const nevh_integrator *scheme, const nevh_options *o) {
    if (!scheme)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "the integrator is NULL: is its name spelt right?");
    s->series = series_of(scheme);
    if (!s->series)
        return nevh__fail(
            &s->report, NEVH_ESTRUCT,
            "shadow H: its series is known for symplectic-euler-a, "
            "symplectic-euler-b, verlet, position-verlet, "
            "lobatto2 and midpoint, not for %s",
            nevh_integrator_name(scheme));
    if (nevh_system_friction(system, NULL))
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "shadow H: friction takes energy away, so that there "
                          "is nothing that steps keep");
    if (o->transform)
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "shadow H: a transform of time makes steps depend on "
                          "the state");
    if (!isfinite(s->h) || s->h == 0)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "shadow H: a step of %g is none", s->h);
    return NEVH_OK;
}

static const char *timed_effect(const nevh_system *s) {
    for (size_t i = 0; i < s->n_terms; i++)
        if (nevh__term_on(s, s->terms[i]) && s->terms[i]->decl.time)
            return s->terms[i]->decl.effect;
    return "";
}

/* A function in C may read t by its declaration alone. */
static int shadow_check_time(nevh_shadow *s, const nevh_system *system,
                             const nevh_probe *probe) {
    if (nevh_system_traits(system) & NEVH_AUTONOMOUS ||
        nevh_probe_finding(probe, NEVH_IS_AUTONOMOUS).holds)
        return NEVH_OK;
    return nevh__fail(&s->report, NEVH_ESTRUCT,
                      "shadow H: effect \"%s\" changes with t, so that steps "
                      "keep no function of q and p alone",
                      timed_effect(system));
}

/* Finds the properties of H: lengths, and whether it depends on t. */
static int plan_probe(nevh_shadow *s, const nevh_system *system,
                      const nevh_options *o) {
    nevh_probe *probe = nevh_probe_new(system, o);
    int status = nevh_probe_status(probe);
    if (status)
        nevh__fail(&s->report, status, "%s", nevh_probe_message(probe));
    else {
        memcpy(s->scale, o->scale ? o->scale : nevh_probe_lengths(probe),
               2 * s->n * sizeof *s->scale);
        status = shadow_check_time(s, system, probe);
    }
    nevh_probe_free(probe);
    return status;
}

static nevh_field *shadow_plan_field(nevh_shadow *s, const nevh_system *system,
                                     const nevh_options *o) {
    nevh_field *field = nevh_field_new(system, o);
    if (nevh_field_status(field))
        nevh__fail(&s->report, nevh_field_status(field), "%s",
                   nevh_field_message(field));
    return field;
}

static int shadow_plan(nevh_shadow *s, const nevh_system *system,
                       const nevh_options *o) {
    size_t size = 2 * s->n;
    s->zq = nevh__array(size * (4 * LANES + 1), sizeof *s->zq);
    if (!s->zq)
        return nevh__no_memory(&s->report);
    s->zp = s->zq + size * LANES;
    s->gq = s->zp + size * LANES;
    s->gp = s->gq + size * LANES;
    s->scale = s->gp + size * LANES;
    int status = plan_probe(s, system, o);
    if (!status) {
        nevh_options values = {.gradient = &nevh__no_gradient,
                               .portable = o->portable};
        s->field = shadow_plan_field(s, system, &values);
        s->variational = nevh__variational_new(system, s->scale, &s->report);
        status = s->report.status;
    }
    if (!status)
        s->along = shadow_plan_field(s, s->variational->system,
                                     &(nevh_options){.gradient = nevh_exact,
                                                     .width = LANES,
                                                     .portable = o->portable});
    return s->report.status;
}

nevh_shadow *nevh_shadow_new(const nevh_system *system,
                             const nevh_integrator *scheme, double h,
                             const nevh_options *options) {
    static const nevh_options defaults;
    const nevh_options *o = options ? options : &defaults;
    nevh_shadow *s = system ? nevh__array(1, sizeof *s) : NULL;
    if (!s)
        return NULL;
    s->n = system->n;
    s->h = h;
    int status = nevh_system_status(system);
    if (status)
        nevh__fail_as(&s->report, &system->report);
    else
        status = shadow_check(s, system, scheme, o);
    if (!status)
        status = shadow_plan(s, system, o);
    s->planned = !status;
    return s;
}

void nevh_shadow_free(nevh_shadow *s) {
    if (!s)
        return;
    nevh_field_free(s->field);
    nevh_field_free(s->along);
    nevh__variational_free(s->variational);
    free(s->zq);
    free(s);
}

NEVH__REPORTS(shadow)

int nevh_shadow_order(const nevh_shadow *s) {
    return s && s->planned ? s->series->order : 0;
}

/* The gradient of K, so many states side by side: coordinates are q and dq,
   momenta dp and p. */
static int shadow_slopes(nevh_shadow *s, size_t lanes) {
    static const double t[LANES];
    int status =
        nevh_field_gradient(s->along, lanes, t, s->zq, s->zp, s->gq, s->gp);
    return status ? nevh__fail(&s->report, status, "%s",
                               nevh_field_message(s->along))
                  : NEVH_OK;
}

/* dK/d(dq) = Hq and dK/d(dp) = Hp; then displacements are Hp of q in one lane,
   and Hq of p in the other. */
static int take_slopes(nevh_shadow *s, const double q[], const double p[]) {
    size_t n = s->n;
    memset(s->zq, 0, 2 * n * LANES * sizeof *s->zq);
    memset(s->zp, 0, 2 * n * LANES * sizeof *s->zp);
    memcpy(s->zq, q, n * sizeof *q);
    memcpy(s->zp + n, p, n * sizeof *p);
    int status = shadow_slopes(s, 1);
    for (size_t k = 0; k < n; k++)
        for (size_t lane = 0; lane < LANES; lane++) {
            s->zq[k * LANES + lane] = q[k];
            s->zp[(n + k) * LANES + lane] = p[k];
            s->zq[(n + k) * LANES + lane] = lane == ALONG_Q ? s->gp[k] : 0;
            s->zp[k * LANES + lane] = lane == ALONG_P ? s->gq[n + k] : 0;
        }
    return status;
}

/* shadow - H */
static int correct(nevh_shadow *s, const double q[], const double p[],
                   double *correction) {
    size_t n = s->n;
    double d = 0, a = 0, b = 0, c = 0;
    int status = take_slopes(s, q, p);
    if (!status)
        status = shadow_slopes(s, LANES);
    for (size_t k = 0; k < n; k++) {
        double hp = s->zq[(n + k) * LANES + ALONG_Q];
        double hq = s->zp[k * LANES + ALONG_P];
        d += hp * hq;
        a += hp * s->gq[k * LANES + ALONG_Q];
        b += hq * s->gp[(n + k) * LANES + ALONG_P];
        c += hq * s->gp[(n + k) * LANES + ALONG_Q];
    }
    const series *by = s->series;
    *correction =
        s->h * (by->d * d + s->h * (by->a * a + by->b * b + by->c * c));
    if (!status && !isfinite(*correction))
        return nevh__fail(&s->report, NEVH_EDOM,
                          "shadow H: second derivatives of H are not finite");
    return status;
}

int nevh_shadow_value(nevh_shadow *s, const double q[], const double p[],
                      double *energy, double *shadow) {
    double h, correction, t = 0;
    if (!s || !q || !p)
        return NEVH_EINVAL;
    if (!s->planned)
        return s->report.status;
    s->report = (nevh__report){0};
    int status = nevh_field_value(s->field, 1, &t, q, p, &h);
    if (status)
        return nevh__fail(&s->report, status, "%s",
                          nevh_field_message(s->field));
    status = correct(s, q, p, &correction);
    if (energy)
        *energy = h;
    if (shadow)
        *shadow = h + correction;
    return status;
}

/* True if t is that many steps of h from the first state. */
static bool is_whole(const nevh_shadow *s, size_t step, double t) {
    static const double part = 1e-3;
    double away = t - s->t_start - (double)(step - s->step_start) * s->h;
    return fabs(away) <= part * fabs(s->h) + 4 * DBL_EPSILON * fabs(t);
}

int nevh_shadow_observe(void *data, size_t step, double t, const double q[],
                        const double p[]) {
    static const double ulps = 16;
    nevh_shadow *s = data;
    double energy, shadow;
    if (s && s->begun && !is_whole(s, step, t))
        return NEVH_OK;
    int status = nevh_shadow_value(s, q, p, &energy, &shadow);
    if (status)
        return status;
    if (!s->begun) {
        s->begun = true;
        s->t_start = t;
        s->step_start = step;
        s->energy = energy;
        s->shadow = shadow;
    }
    nevh_shadow_report *r = &s->result;
    r->samples++;
    r->energy = fmax(r->energy, fabs(energy - s->energy));
    r->shadow = fmax(r->shadow, fabs(shadow - s->shadow));
    r->correction = fmax(r->correction, fabs(shadow - energy));
    r->rounding = fmax(r->rounding, ulps * DBL_EPSILON * fabs(energy));
    return NEVH_OK;
}

nevh_shadow_report nevh_shadow_result(const nevh_shadow *s) {
    if (!s)
        return (nevh_shadow_report){0};
    nevh_shadow_report r = s->result;
    r.breaks_down = r.shadow > r.rounding && r.shadow > r.energy / 4;
    return r;
}
