/* nevh: shorter steps that branch off, and root finding on their length.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/section_private.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_TRIALS = 100 };
static const double certain = 4 * DBL_EPSILON; /* part of a step */
static const double jump = 0.01; /* of the difference of the ends */

static bool section_branch_holds(const nevh_sections *x, const double memory[],
                                 double h) {
    const nevh_work *w = &x->branch->work;
    const nevh_kernel *kernel = w->integrator->kernel;
    return kernel->holds && kernel->holds(w, memory, h);
}

static void branch_off(nevh_sections *x, const double q[], const double p[],
                       const double memory[]) {
    const nevh_stepper *s = x->branch;
    size_t size = s->work.size * sizeof(double);
    memcpy(x->q_try, q, size);
    memcpy(x->p_try, p, size);
    memcpy(s->work.memory, memory, s->rows * s->work.width * sizeof(double));
}

/* The part of the step at hand, as a time, from whose end one of h is to branch
   off: the last such step or the whole one, where its memory holds the orbit. */
static double branch_at(const nevh_sections *x, double h) {
    if (section_branch_holds(x, x->memory, h))
        return 0;
    if (section_branch_holds(x, x->memory_after, h - x->h))
        return x->h;
    return section_branch_holds(x, x->branch->work.memory, h - x->tried)
               ? x->tried
               : 0;
}

/* A step of h from where the step at hand begins to q_try, p_try. */
static int section_branch_take_step(nevh_sections *x, double h) {
    nevh_stepper *s = x->branch;
    double from = branch_at(x, h);
    if (from == 0)
        branch_off(x, x->q, x->p, x->memory);
    else if (from == x->h)
        branch_off(x, x->q_after, x->p_after, x->memory_after);
    int status = nevh__advance(s, x->t + from, h - from, x->q_try, x->p_try);
    x->tried = status ? NAN : h;
    if (status)
        return nevh__fail_as(&x->report, &s->report);
    if (from != 0)
        s->last_t = x->t + h;
    return NEVH_OK;
}

double nevh__section_due(const nevh_sections *x, const nevh__section_state *k) {
    double forward = x->h < 0 ? -1 : 1;
    return x->origin + forward * (k->points + 1) * k->decl.every;
}

int nevh__section_value(nevh_sections *x, const nevh__section_state *k,
                        double t, const double q[], const double p[],
                        double *value) {
    char number[24];
    const char *name = k->decl.name;
    if (!k->decl.value) {
        *value = t - nevh__section_due(x, k);
        return NEVH_OK;
    }
    snprintf(number, sizeof number, "%zu", k->number);
    *value = NAN;
    int status = k->decl.value(k->decl.data, t, q, p, value);
    if (!status && isfinite(*value))
        return NEVH_OK;
    return nevh__fail(&x->report, status ? status : NEVH_EDOM,
                      status ? "the value of section %s failed at t = %.9g"
                             : "the value of section %s is not finite at "
                               "t = %.9g",
                      name ? name : number, t);
}

int nevh__section_sample(nevh_sections *x, const nevh__section_state *k,
                         double s, double *value) {
    *value = NAN;
    int status = section_branch_take_step(x, s * x->h);
    return status ? status
                  : nevh__section_value(x, k, x->branch->last_t, x->q_try,
                                        x->p_try, value);
}

static void section_branch_keep(nevh_sections *x, nevh__section_state *k,
                                double s, double t, const double q[],
                                const double p[]) {
    size_t size = x->branch->work.size * sizeof(double);
    k->found = true;
    k->s = s;
    k->t = t;
    memcpy(k->q, q, size);
    memcpy(k->p, p, size);
}

int nevh__section_take(nevh_sections *x, nevh__section_state *k, double h) {
    int status = NEVH_OK;
    if (h == 0)
        section_branch_keep(x, k, 0, x->t, x->q, x->p);
    else if (h == x->h)
        section_branch_keep(x, k, 1, x->t_after, x->q_after, x->p_after);
    else if (!(status = section_branch_take_step(x, h)))
        section_branch_keep(x, k, h / x->h, x->branch->last_t, x->q_try,
                            x->p_try);
    return status;
}

typedef struct {
    nevh_sections *x;
    nevh__section_state *k;
    nevh__section_node a, b;  /* less the level */
    double level, best, last; /* |value| */
} search;

/* Finite whatever happens, since GSL aborts otherwise; the ends are known. */
static double section_branch_miss(double s, void *data) {
    search *r = data;
    nevh_sections *x = r->x;
    double value;
    if (x->report.status || s == r->a.s)
        return r->a.value;
    if (s == r->b.s)
        return r->b.value;
    int status = nevh__section_sample(x, r->k, s, &value);
    r->last = fabs(value - r->level);
    if (status == NEVH_EDOM && isinf(value)) /* a pole is no failure */
        x->report = (nevh__report){0};
    if (status)
        return r->a.value;
    if (r->last <= r->best) {
        r->best = r->last;
        section_branch_keep(x, r->k, s, x->branch->last_t, x->q_try, x->p_try);
    }
    return value - r->level;
}

static void section_branch_narrow(search *r) {
    gsl_root_fsolver *root = r->x->root;
    gsl_function f = {section_branch_miss, r};
    int status = gsl_root_fsolver_set(root, &f, r->a.s, r->b.s);
    for (int i = 0; !status && r->best > 0 && i < MOST_TRIALS; i++) {
        status = gsl_root_fsolver_iterate(root);
        double low = gsl_root_fsolver_x_lower(root);
        double high = gsl_root_fsolver_x_upper(root);
        if (r->x->report.status || high - low <= certain)
            break;
    }
}

int nevh__section_search(nevh_sections *x, nevh__section_state *k,
                         nevh__section_node a, nevh__section_node b,
                         double level) {
    search r = {.x = x, .k = k, .a = a, .b = b, .level = level};
    r.a.value -= level;
    r.b.value -= level;
    r.best = INFINITY;
    k->found = false;
    section_branch_narrow(&r);
    k->found &=
        r.last <= jump * (fabs(a.value - level) + fabs(b.value - level));
    return x->report.status;
}
