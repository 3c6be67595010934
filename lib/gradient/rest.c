/* nevh: how far does an orbit go, of which nothing is known, such as one that
   starts at rest at 0, or nearly so in a strong field?

   There no variable has a size, and where H is quadratic nothing has a length.
   So the terms' own gradients are followed from a step that is far too short
   for anything to happen, longer and longer as long as the error allows it.
   While steps grow with the time, so do the variables, as powers of it, which
   have no size; once steps are short beside the time, they have.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/step_selection_private.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_FAILED = 8 };
enum { MOST_STEPS = 1600, ENOUGH = 100 }; /* all; those that are short */
static const double short_step = 0x1p-4;  /* beside the time */
static const double tolerance = 1e-3, growth = 8, shortest = 0x1p-400;
static const double most_work = 4e6; /* instances times steps */
/* Growth of sizes in the second half of short steps: orbits that escape as exp(t)
   grow by more. */
static const double most_growth = 8;
static const double overflowing = 0x1p500, underflowing = 0x1p-900;

/* Adds (dH/dp, -dH/dq) of one block of instances, lane by lane. */
static void rest_add_block(nevh_field *f, const nevh__planned *term,
                           size_t first, double t, const double y[],
                           double dydt[]) {
    const nevh_term *decl = &term->term->decl;
    size_t n = f->n, rows = term->nv + decl->nc;
    size_t used = decl->count - first;
    used = used < NEVH__LANES ? used : NEVH__LANES;
    for (size_t lane = 0; lane < NEVH__LANES; lane++) {
        size_t instance = first + (lane < used ? lane : 0);
        f->times[lane] = t;
        for (size_t j = 0; j < rows; j++) {
            size_t of = j < term->nv ? nevh__index(term, instance, j) : 0;
            f->rows[j * NEVH__LANES + lane] =
                j >= term->nv
                    ? nevh__constant(f, term, instance, j - term->nv, f->alone)
                    : y[j < term->nq ? of : n + of];
        }
    }
    double *q = f->rows, *p = q + term->nq * NEVH__LANES;
    double *dp = f->slopes + term->nq * NEVH__LANES;
    decl->gradient(NEVH__LANES, decl->time ? f->times : f->zeros, q, p,
                   p + term->np * NEVH__LANES, decl->params, f->slopes, dp);
    for (size_t lane = 0; lane < used; lane++)
        for (size_t j = 0; j < term->nv; j++) {
            size_t of = nevh__index(term, first + lane, j);
            double slope = f->slopes[j * NEVH__LANES + lane];
            dydt[j < term->nq ? n + of : of] += j < term->nq ? -slope : slope;
        }
}

bool nevh__has_gradients(const nevh_field *f) {
    for (size_t i = 0; i < f->n_terms; i++)
        if (f->terms[i].nv && !f->terms[i].term->decl.gradient)
            return false;
    return true;
}

static void add_terms(nevh_field *f, double t, const double y[],
                      double dydt[]) {
    for (size_t i = 0; i < f->n_terms; i++)
        for (size_t first = 0;
             f->terms[i].nv && first < f->terms[i].term->decl.count;
             first += NEVH__LANES)
            rest_add_block(f, &f->terms[i], first, t, y, dydt);
}

typedef struct {
    nevh_field *field;
    double *friction; /* n rates; NULL: there is none */
} law;

/* The flow by the terms' own gradients, or else that of the field. */
static int motion(double t, const double y[], double dydt[], void *of) {
    const law *m = of;
    nevh_field *f = m->field;
    size_t n = f->n;
    double sum = 0;
    memset(dydt, 0, 2 * n * sizeof *dydt);
    if (nevh__has_gradients(f))
        add_terms(f, t, y, dydt);
    else if (nevh_field_gradient(f, 1, &t, y, y + n, dydt + n, dydt))
        return GSL_EBADFUNC;
    for (size_t i = 0; i < n && !nevh__has_gradients(f); i++)
        dydt[n + i] = -dydt[n + i];
    for (size_t i = 0; m->friction && i < n; i++)
        dydt[n + i] -= m->friction[i] * y[n + i];
    for (size_t i = 0; i < 2 * n; i++)
        sum += dydt[i] - dydt[i];
    return sum == 0 ? GSL_SUCCESS : GSL_EBADFUNC;
}

/* The error over what is allowed, of sizes so far, which y makes larger. */
static double rest_excess(size_t size, const double y[], const double error[],
                          double sizes[]) {
    double most = 0;
    for (size_t i = 0; i < size; i++) {
        sizes[i] = fmax(sizes[i], fabs(y[i]));
        if (sizes[i] > underflowing)
            most = fmax(most, fabs(error[i]) / (tolerance * sizes[i]));
    }
    return most;
}

/* A small part of the time in which what is not 0 changes. */
static double first_step(law *m, double t, const double y[], double dydt[]) {
    double h = INFINITY;
    if (motion(t, y, dydt, m))
        return 0;
    for (size_t i = 0; i < 2 * m->field->n; i++)
        if (y[i] != 0 && dydt[i] != 0)
            h = fmin(h, 0x1p-10 * fabs(y[i] / dydt[i]));
    return fmax(h < INFINITY ? h : shortest, 0x1p-40 * fabs(t));
}

/* y: 4 x 2n; the first are the state.  Returns whether there are sizes. */
static bool rest_follow(law *m, gsl_odeiv2_step *step, double t, double *y,
                        double sizes[], nevh__orbit_fn visit, void *context) {
    size_t size = 2 * m->field->n;
    double *before = y + size, *error = before + size, *last = error + size;
    gsl_odeiv2_system ode = {motion, NULL, size, m};
    double start = t, h = first_step(m, t, y, error);
    int settled = 0, failed = 0;
    for (int i = 0; h > 0 && i < MOST_STEPS && settled < ENOUGH; i++) {
        memcpy(before, y, size * sizeof *y);
        memcpy(last, sizes, size * sizeof *y);
        int status =
            gsl_odeiv2_step_apply(step, t, h, y, error, NULL, NULL, &ode);
        double over = status ? INFINITY : rest_excess(size, y, error, sizes);
        if (status && ++failed > MOST_FAILED)
            return false;
        if (!(over <= 1)) {
            memcpy(y, before, size * sizeof *y);
            memcpy(sizes, last, size * sizeof *y);
            h *= over < INFINITY ? fmax(0.1, 0.9 * pow(over, -0.2)) : 0.1;
            continue;
        }
        t += h;
        if (h < short_step * (t - start) && ++settled && visit)
            visit(context, t, h, y);
        h *= over > 0 ? fmin(growth, 0.9 * pow(over, -0.2)) : growth;
        for (size_t k = 0; k < size; k++)
            if (!(sizes[k] < overflowing))
                return false;
    }
    return settled >= ENOUGH;
}

bool nevh__follow_orbit(nevh_field *f, double t, const double q[],
                        const double p[], double sizes[], nevh__orbit_fn visit,
                        void *context) {
    size_t n = f->n;
    memset(sizes, 0, 2 * n * sizeof *sizes);
    if ((double)f->instances * MOST_STEPS > most_work)
        return false;
    double *y = nevh__array(9 * n, sizeof *y);
    double *trial = nevh__array(24 * n, sizeof *trial); /* as GSL takes */
    free(trial);
    gsl_odeiv2_step *step =
        y && trial ? gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, 2 * n) : NULL;
    if (step) {
        memcpy(y, q, n * sizeof *y);
        memcpy(y + n, p, n * sizeof *y);
    }
    for (size_t i = 0; step && i < 2 * n; i++)
        sizes[i] = fabs(y[i]);
    law m = {f, y ? y + 8 * n : NULL};
    if (y && !nevh_system_friction(f->system, m.friction))
        m.friction = NULL;
    bool found = step && rest_follow(&m, step, t, y, sizes, visit, context);
    if (step)
        gsl_odeiv2_step_free(step);
    free(y);
    return found;
}

/* Sizes after the first short step, and when half of them have been taken; the last
   state. */
typedef struct {
    const double *sizes;
    double *first, *half, *q, *p;
    size_t n;
    int steps;
} halfway;

static void rest_remember(void *context, double t, double h, const double y[]) {
    halfway *w = context;
    (void)t, (void)h;
    if (++w->steps == 1)
        memcpy(w->first, w->sizes, 2 * w->n * sizeof *y);
    if (w->steps == ENOUGH / 2)
        memcpy(w->half, w->sizes, 2 * w->n * sizeof *y);
    memcpy(w->q, y, w->n * sizeof *y);
    memcpy(w->p, y + w->n, w->n * sizeof *y);
}

bool nevh__sizes_from_start(const nevh__step_selection *e, bool escapes,
                            double sizes[]) {
    const nevh__samples *s = &e->samples;
    size_t n = e->field->n;
    double *first = nevh__array(4 * n, sizeof *first);
    double *half = first ? first + 2 * n : NULL;
    double *q = s->q + s->most * n, *p = s->p + s->most * n;
    halfway w = {sizes, first, half, q, p, n, 0};
    bool found = first && nevh__has_gradients(e->field) &&
                 nevh__follow_orbit(e->field, s->t[0], s->q, s->p, sizes,
                                    rest_remember, &w);
    bool leaves = false;
    for (size_t i = 0; found && i < 2 * n; i++)
        leaves = leaves || !(sizes[i] <= most_growth * half[i]);
    if (leaves)
        memcpy(sizes, first, 2 * n * sizeof *sizes);
    free(first);
    return found && (escapes || !leaves);
}
