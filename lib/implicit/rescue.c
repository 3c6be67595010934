/* nevh: stages that neither fixed-point iteration nor Newton's reaches.

   GSL's hybrid multiroot solver on x - G(x) = 0, one lane at a time, in units
   of the state's scales, from a standing start.  It is iterated until the
   residual stops falling, not to a tolerance.  Everything GSL allocates, it
   allocates when the stepper is planned.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include "gradient/field_private.h"
#include <gsl/gsl_multiroots.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_ITERATIONS = 200, MOST_IDLE = 5 };

struct nevh__rescue {
    gsl_multiroot_fdfsolver *gsl;
    gsl_vector *start, *moved, *f, *f_moved; /* the latter for differences */
    double *best, *g; /* rows: the best x so far; G of a trial x */
    double residual;  /* of the best, largest, in units of scale */
    size_t lane;
    int status; /* of the last evaluation of G */
};

/* Memory that is out inside GSL ends in its error handler, whose default is to
   abort.  So ask first for as much as it will take. */
static bool memory_suffices(size_t rows) {
    void *trial = nevh__array(rows * (3 * rows + 32), sizeof(double));
    free(trial);
    return trial != NULL;
}

struct nevh__rescue *nevh__rescue_new(nevh__stage_solver *s) {
    struct nevh__rescue *r = nevh__array(1, sizeof *r);
    if (!r || !memory_suffices(s->rows)) {
        free(r);
        return NULL;
    }
    r->best = nevh__array(s->rows, sizeof *r->best);
    r->g = nevh__array(s->rows, sizeof *r->g);
    r->gsl = gsl_multiroot_fdfsolver_alloc(gsl_multiroot_fdfsolver_hybridsj,
                                           s->rows);
    r->start = gsl_vector_calloc(s->rows);
    r->moved = gsl_vector_calloc(s->rows);
    r->f = gsl_vector_calloc(s->rows);
    r->f_moved = gsl_vector_calloc(s->rows);
    if (r->best && r->g && r->gsl && r->start && r->moved && r->f && r->f_moved)
        return r;
    nevh__rescue_free(r);
    return NULL;
}

void nevh__rescue_free(struct nevh__rescue *r) {
    if (!r)
        return;
    if (r->gsl)
        gsl_multiroot_fdfsolver_free(r->gsl);
    gsl_vector_free(r->start);
    gsl_vector_free(r->moved);
    gsl_vector_free(r->f);
    gsl_vector_free(r->f_moved);
    free(r->best);
    free(r->g);
    free(r);
}

/* GSL's unknowns are slopes times |h| over scale. */
static double unit(const nevh__stage_solver *s, size_t row) {
    return nevh__stage_unit(s, row, s->rescue->lane);
}

static int rescue_residual(const gsl_vector *u, void *params, gsl_vector *f) {
    nevh__stage_solver *s = params;
    struct nevh__rescue *r = s->rescue;
    size_t width = s->work->width;
    double *x = s->problem->x + r->lane, most = 0;
    for (size_t row = 0; row < s->rows; row++)
        x[row * width] = gsl_vector_get(u, row) * unit(s, row);
    r->status =
        s->problem->map(s->problem->data, 1, &r->lane, s->problem->x, r->g);
    if (r->status)
        return GSL_EBADFUNC;
    for (size_t row = 0; row < s->rows; row++) {
        double one = (x[row * width] - r->g[row]) / unit(s, row);
        gsl_vector_set(f, row, one);
        most = fmax(most, isfinite(one) ? fabs(one) : INFINITY);
    }
    if (most < r->residual) {
        r->residual = most;
        for (size_t row = 0; row < s->rows; row++)
            r->best[row] = x[row * width];
    }
    return most < INFINITY ? GSL_SUCCESS : GSL_EBADFUNC;
}

/* The Jacobian at u, where the residual is f.  gsl_multiroot_fdjacobian does
   the same, but allocates on every call. */
static int rescue_differences(const gsl_vector *u, const gsl_vector *f,
                              nevh__stage_solver *s, gsl_matrix *jacobian) {
    struct nevh__rescue *r = s->rescue;
    int status = GSL_SUCCESS;
    gsl_vector_memcpy(r->moved, u);
    for (size_t j = 0; !status && j < s->rows; j++) {
        double x = gsl_vector_get(u, j);
        double dx = GSL_SQRT_DBL_EPSILON * (x != 0 ? fabs(x) : 1);
        gsl_vector_set(r->moved, j, x + dx);
        status = rescue_residual(r->moved, s, r->f_moved);
        gsl_vector_set(r->moved, j, x);
        gsl_vector_sub(r->f_moved, f);
        gsl_vector_scale(r->f_moved, 1 / dx);
        gsl_matrix_set_col(jacobian, j, r->f_moved);
    }
    return status;
}

static int rescue_slopes(const gsl_vector *u, void *params,
                         gsl_matrix *jacobian) {
    nevh__stage_solver *s = params;
    int status = rescue_residual(u, s, s->rescue->f);
    return status ? status : rescue_differences(u, s->rescue->f, s, jacobian);
}

static int rescue_both(const gsl_vector *u, void *params, gsl_vector *f,
                       gsl_matrix *jacobian) {
    int status = rescue_residual(u, params, f);
    return status ? status : rescue_differences(u, f, params, jacobian);
}

static void rescue_iterate(nevh__stage_solver *s) {
    struct nevh__rescue *r = s->rescue;
    gsl_multiroot_function_fdf f = {rescue_residual, rescue_slopes, rescue_both,
                                    s->rows, s};
    r->residual = INFINITY;
    gsl_vector_set_zero(r->start);
    int status = gsl_multiroot_fdfsolver_set(r->gsl, &f, r->start);
    for (int i = 0, idle = 0;
         !status && i < MOST_ITERATIONS && idle < MOST_IDLE && r->residual > 0;
         i++) {
        double before = r->residual;
        status = gsl_multiroot_fdfsolver_iterate(r->gsl);
        s->work->sweeps++;
        idle = r->residual < before ? 0 : idle + 1;
    }
}

static int give_up(const nevh__stage_solver *s, size_t lane) {
    const nevh__stage_problem *e = s->problem;
    const struct nevh__rescue *r = s->rescue;
    if (r && r->residual == INFINITY && r->status)
        return r->status; /* G could not be evaluated at all */
    char which[40] = "";
    if (s->work->width > 1 && !s->work->system->names)
        snprintf(which, sizeof which, " (lane %zu)", lane);
    return nevh_work_fail(
        s->work, NEVH_EMAXITER,
        "the stage equations of %s were not solved at t = %.9g, h = %g%s: "
        "fixed-point iteration does not contract, and %s: take a smaller step",
        s->work->integrator->name, e->t, e->h, which,
        r ? "neither simplified Newton nor GSL's hybrid solver found a root"
          : "the system is too large for Newton's and GSL's solvers");
}

int nevh__rescue_lane(nevh__stage_solver *s, size_t lane) {
    struct nevh__rescue *r = s->rescue;
    size_t width = s->work->width;
    double *x = s->problem->x + lane;
    s->work->rescues++;
    if (!r)
        return give_up(s, lane);
    r->lane = lane;
    rescue_iterate(s);
    if (r->residual == INFINITY)
        return give_up(s, lane);
    for (size_t row = 0; row < s->rows; row++)
        x[row * width] = r->best[row];
    if (nevh__stage_small(s, lane, r->residual))
        return NEVH_OK;
    return s->status ? s->status : give_up(s, lane);
}
