/* nevh: how far does an orbit go that starts at rest at 0?

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

enum { MOST_STEPS = 1600, ENOUGH = 100 }; /* all; those that are short */
static const double short_step = 0x1p-4;  /* beside the time */
static const double tolerance = 1e-3, growth = 8, shortest = 0x1p-400;
static const double most_work = 4e6; /* instances times steps */
static const double overflowing = 0x1p500, underflowing = 0x1p-900;

/* Adds (dH/dp, -dH/dq) of one block of instances, lane by lane. */
static void add_block(nevh_field *f, const nevh__planned *term, size_t first,
                      double t, const double y[], double dydt[]) {
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
                j >= term->nv ? decl->c[instance * decl->nc + j - term->nv]
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

static int motion(double t, const double y[], double dydt[], void *field) {
    nevh_field *f = field;
    double sum = 0;
    memset(dydt, 0, 2 * f->n * sizeof *dydt);
    for (size_t i = 0; i < f->n_terms; i++)
        for (size_t first = 0; first < f->terms[i].term->decl.count;
             first += NEVH__LANES)
            if (f->terms[i].nv)
                add_block(f, &f->terms[i], first, t, y, dydt);
    for (size_t i = 0; i < 2 * f->n; i++)
        sum += dydt[i] - dydt[i];
    return sum == 0 ? GSL_SUCCESS : GSL_EBADFUNC;
}

/* The error over what is allowed, of sizes so far, which y makes larger. */
static double excess(size_t size, const double y[], const double error[],
                     double sizes[]) {
    double most = 0;
    for (size_t i = 0; i < size; i++) {
        sizes[i] = fmax(sizes[i], fabs(y[i]));
        if (sizes[i] > underflowing)
            most = fmax(most, fabs(error[i]) / (tolerance * sizes[i]));
    }
    return most;
}

/* y: 4 x 2n; the first are the state.  Returns whether there are sizes. */
static bool follow(nevh_field *f, gsl_odeiv2_step *step, double t, double *y,
                   double sizes[]) {
    size_t size = 2 * f->n;
    double *before = y + size, *error = before + size, *last = error + size;
    gsl_odeiv2_system ode = {motion, NULL, size, f};
    double start = t, h = fmax(shortest, 0x1p-40 * fabs(t));
    int settled = 0;
    for (int i = 0; i < MOST_STEPS && settled < ENOUGH; i++) {
        memcpy(before, y, size * sizeof *y);
        memcpy(last, sizes, size * sizeof *y);
        int status =
            gsl_odeiv2_step_apply(step, t, h, y, error, NULL, NULL, &ode);
        double over = status ? INFINITY : excess(size, y, error, sizes);
        if (!(over <= 1)) {
            memcpy(y, before, size * sizeof *y);
            memcpy(sizes, last, size * sizeof *y);
            h *= over < INFINITY ? fmax(0.1, 0.9 * pow(over, -0.2)) : 0.1;
            continue;
        }
        t += h;
        settled += h < short_step * (t - start);
        h *= over > 0 ? fmin(growth, 0.9 * pow(over, -0.2)) : growth;
        for (size_t k = 0; k < size; k++)
            if (!(sizes[k] < overflowing))
                return false;
    }
    return settled >= ENOUGH;
}

bool nevh__sizes_from_rest(const nevh__step_selection *e, double sizes[]) {
    nevh_field *f = e->field;
    memset(sizes, 0, 2 * f->n * sizeof *sizes);
    for (size_t i = 0; i < f->n_terms; i++)
        if (f->terms[i].nv && !f->terms[i].term->decl.gradient)
            return false;
    double *y = nevh__array(8 * f->n, sizeof *y);
    double *trial = nevh__array(24 * f->n, sizeof *trial); /* as GSL takes */
    free(trial);
    gsl_odeiv2_step *step =
        y && trial && (double)f->instances * MOST_STEPS < most_work
            ? gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, 2 * f->n)
            : NULL;
    if (step) {
        memcpy(y, e->samples.q, f->n * sizeof *y);
        memcpy(y + f->n, e->samples.p, f->n * sizeof *y);
    }
    bool found = step && follow(f, step, e->samples.t[0], y, sizes);
    if (step)
        gsl_odeiv2_step_free(step);
    free(y);
    return found;
}
