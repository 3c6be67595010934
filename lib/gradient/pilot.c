/* nevh: states to try difference steps at.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/control_private.h"
#include "gradient/step_selection_private.h"
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <nevh/gsl.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_STEPS = 240, PILOT_SAMPLES = 24, RANDOM_SAMPLES = 4 };
static const double tolerance = 1e-3;
static const double near_by = 0.3, anywhere = 2; /* of the lengths */
static const double far_off = 64;
static const double most_work = 4e5; /* values times variables */

static void add_sample(nevh__step_selection *e, double t, const double q[],
                       const double p[]) {
    nevh__samples *s = &e->samples;
    size_t n = e->field->n;
    if (s->count == s->most)
        return;
    s->t[s->count] = t;
    memcpy(s->q + s->count * n, q, n * sizeof *q);
    memcpy(s->p + s->count * n, p, n * sizeof *p);
    s->count++;
}

/* The row of largest sizes for the sample that comes next. */
static double *largest_row(nevh__samples *s, size_t n) {
    return s->largest + s->count * 2 * n;
}

/* Sizes of a state on the way to the next sample. */
static void add_sizes(nevh__step_selection *e, const double y[]) {
    size_t n = e->field->n;
    if (e->samples.count == e->samples.most)
        return;
    double *largest = largest_row(&e->samples, n);
    for (size_t i = 0; i < 2 * n; i++)
        largest[i] = fmax(largest[i], fabs(y[i]));
}

/* The next sample's largest sizes are at least those of the sample before. */
static void begin_sizes(nevh__step_selection *e) {
    size_t n = e->field->n;
    nevh__samples *s = &e->samples;
    if (s->count == s->most)
        return;
    double *row = largest_row(s, n);
    if (s->count > e->lanes)
        memcpy(row, row - 2 * n, 2 * n * sizeof *row);
    for (size_t i = 0; s->count <= e->lanes && i < 2 * n; i++)
        row[i] = nevh__largest_size(e, i, s->count);
}

/* Displaced from one of the lanes given. */
static void add_random(nevh__step_selection *e, size_t lane, double part,
                       uint64_t *random) {
    nevh__samples *s = &e->samples;
    size_t n = e->field->n, from = lane * n;
    if (s->count == s->most)
        return;
    double *q = s->q + s->count * n, *p = s->p + s->count * n;
    for (size_t i = 0; i < n; i++) {
        q[i] = s->q[from + i] + part * e->length[i] * nevh__random(random);
        p[i] = s->p[from + i] + part * e->length[n + i] * nevh__random(random);
    }
    s->t[s->count++] = s->t[lane];
}

void nevh__set_crude_steps(nevh__step_selection *e) {
    nevh_field *f = e->field;
    double part = pow(DBL_EPSILON, 1. / (f->gradient->order + 1));
    for (size_t j = 0; j < f->n_terms; j++) {
        nevh__planned *term = &f->terms[j];
        for (size_t at = 0; at < term->term->decl.count * term->nv; at++) {
            size_t k = at % term->nv, i = nevh__index(term, at / term->nv, k);
            double length = e->length[k < term->nq ? i : f->n + i];
            term->delta[at] = exp2(round(log2(part * length)));
        }
    }
}

double nevh__first_step(const nevh__step_selection *e, const void *system,
                        double t, const double y[], double dydt[]) {
    const gsl_odeiv2_system *ode = system;
    double step = INFINITY;
    if (ode->function(t, y, dydt, ode->params))
        return 0;
    for (size_t i = 0; i < ode->dimension; i++)
        if (dydt[i] != 0)
            step = fmin(step, 0.01 * e->length[i] / fabs(dydt[i]));
    return isfinite(step) ? step : 0;
}

/* True if a variable has left the neighbourhood of the start, which happens if H is
   not bounded below. */
static bool runs_away(const nevh__step_selection *e, const double y[]) {
    size_t n = e->field->n;
    for (size_t i = 0; i < 2 * n; i++) {
        double start = i < n ? e->samples.q[i] : e->samples.p[i - n];
        if (!(fabs(y[i]) <= far_off * (fabs(start) + e->length[i])))
            return true;
    }
    return false;
}

/* y: room for 4n doubles. */
static void pilot_integrate(nevh__step_selection *e, int steps,
                            gsl_odeiv2_system *ode, gsl_odeiv2_step *step,
                            gsl_odeiv2_control *control,
                            gsl_odeiv2_evolve *evolve, double *y) {
    size_t n = e->field->n;
    memcpy(y, e->samples.q, n * sizeof *y);
    memcpy(y + n, e->samples.p, n * sizeof *y);
    double t = e->samples.t[0], h = nevh__first_step(e, ode, t, y, y + 2 * n);
    int status = h > 0 ? GSL_SUCCESS : GSL_FAILURE;
    begin_sizes(e);
    for (int i = 1; !status && i <= steps; i++) {
        status = gsl_odeiv2_evolve_apply(evolve, control, step, ode, &t,
                                         0.5 * DBL_MAX, &h, y);
        if (status || runs_away(e, y))
            break;
        add_sizes(e, y);
        if (i % (steps / PILOT_SAMPLES) != 0)
            continue;
        add_sample(e, t, y, y + n);
        begin_sizes(e);
        if (e->scales_alone &&
            nevh__sizes_settled(e, e->samples.count - e->lanes))
            break;
    }
}

/* False when memory is out. */
static bool run_pilot(nevh__step_selection *e, int steps) {
    nevh_field *f = e->field;
    double *y = nevh__array(24 * f->n, sizeof *y); /* what GSL will take, too */
    gsl_odeiv2_system ode = nevh_gsl_system(f);
    if (!y || !ode.jacobian) {
        free(y);
        return false;
    }
    gsl_odeiv2_step *step =
        gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, ode.dimension);
    nevh__control control = {.absolute = tolerance,
                             .relative = tolerance,
                             .by_size = true,
                             .scale = e->length};
    nevh__control_init(&control);
    gsl_odeiv2_evolve *evolve = gsl_odeiv2_evolve_alloc(ode.dimension);
    if (step && evolve)
        pilot_integrate(e, steps, &ode, step, &control.gsl, evolve, y);
    gsl_odeiv2_step_free(step);
    gsl_odeiv2_evolve_free(evolve);
    free(y);
    return step && evolve;
}

/* As many steps as most_work allows: a step takes six gradients.  Of exact ones few
   are taken where each has many instances. */
static int pilot_steps(const nevh_field *f) {
    static const double many = 7e3;
    double work = 0;
    if (f->gradient == nevh_exact)
        return (double)f->instances > many ? PILOT_SAMPLES : MOST_STEPS;
    for (size_t j = 0; j < f->n_terms; j++)
        work += (double)f->terms[j].term->decl.count *
                (double)(f->terms[j].nv * f->terms[j].nv);
    work *= 6 * f->gradient->order;
    return work * MOST_STEPS > most_work ? (int)(most_work / work) : MOST_STEPS;
}

void nevh__find_neighbours(nevh__step_selection *e) {
    uint64_t random = 1;
    e->neighbours = e->samples.count;
    bool given = e->options->q || e->options->p;
    size_t count = given ? RANDOM_SAMPLES : e->samples.most;
    for (size_t i = 0; i < count; i++)
        add_random(e, i % e->lanes, given ? near_by : anywhere, &random);
}

bool nevh__find_samples(nevh__step_selection *e) {
    int steps = pilot_steps(e->field);
    if ((e->options->q || e->options->p) && steps >= PILOT_SAMPLES &&
        !run_pilot(e, steps))
        return false;
    nevh__find_neighbours(e);
    return true;
}
