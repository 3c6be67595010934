/* nevh: the state at t_start: momenta that belong to initial velocities.

   v = dH/dp is solved for the momenta that are not given.  Where each velocity
   depends on its own momentum alone and in proportion to it, rescaling every
   momentum by the velocity that is missing gets there at once; that also finds
   the size of the momenta, which may be anything.  In units of these, GSL's
   hybrid solver does the rest.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_private.h"
#include <float.h>
#include <gsl/gsl_multiroots.h>
#include <math.h>
#include <stdlib.h>

enum { RESCALINGS = 60, MOST_ITERATIONS = 200, MOST_IDLE = 5, MOST_ROWS = 500 };

static const double CLOSE = 1e-10; /* residual that counts as solved */

typedef struct {
    double *room;
    const nevh__model *m;
    size_t rows, *row; /* which of the n momenta are sought */
    const double *q;
    double *p, *slope, *rest; /* n; slope: dH/dp at p, rest: at p = 0 */
    double *unit, *best;      /* rows */
    double scale, residual;   /* of velocities; of the best, largest */
    gsl_multiroot_fdfsolver *gsl;
    gsl_vector *u, *moved, *f, *f_moved;
} search;

/* The velocities at p, and how far they are off at most, over the scale. */
static double measure(search *s) {
    double most = 0;
    nevh__velocities(s->m->system, s->m->run.t_start, s->q, s->p, s->room,
                     s->slope);
    for (size_t j = 0; j < s->rows; j++) {
        size_t k = s->row[j];
        double off = fabs(s->slope[k] - s->m->v[k]) / s->scale;
        most = fmax(most, isfinite(off) ? off : INFINITY);
    }
    if (most < s->residual) {
        s->residual = most;
        for (size_t j = 0; j < s->rows; j++)
            s->best[j] = s->p[s->row[j]];
    }
    return most;
}

static int residual(const gsl_vector *u, void *params, gsl_vector *f) {
    search *s = params;
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = gsl_vector_get(u, j) * s->unit[j];
    if (!(measure(s) < INFINITY))
        return GSL_EBADFUNC;
    for (size_t j = 0; j < s->rows; j++)
        gsl_vector_set(f, j,
                       (s->slope[s->row[j]] - s->m->v[s->row[j]]) / s->scale);
    return GSL_SUCCESS;
}

/* The Jacobian at u, where the residual is f.  gsl_multiroot_fdjacobian does
   the same, but allocates on every call. */
static int differences(const gsl_vector *u, const gsl_vector *f, search *s,
                       gsl_matrix *jacobian) {
    int status = GSL_SUCCESS;
    gsl_vector_memcpy(s->moved, u);
    for (size_t j = 0; !status && j < s->rows; j++) {
        double x = gsl_vector_get(u, j);
        double dx = GSL_SQRT_DBL_EPSILON * fmax(fabs(x), 1);
        gsl_vector_set(s->moved, j, x + dx);
        status = residual(s->moved, s, s->f_moved);
        gsl_vector_set(s->moved, j, x);
        gsl_vector_sub(s->f_moved, f);
        gsl_vector_scale(s->f_moved, 1 / dx);
        gsl_matrix_set_col(jacobian, j, s->f_moved);
    }
    return status;
}

static int slopes(const gsl_vector *u, void *params, gsl_matrix *jacobian) {
    search *s = params;
    int status = residual(u, s, s->f);
    return status ? status : differences(u, s->f, s, jacobian);
}

static int both(const gsl_vector *u, void *params, gsl_vector *f,
                gsl_matrix *jacobian) {
    int status = residual(u, params, f);
    return status ? status : differences(u, f, params, jacobian);
}

static void iterate(search *s) {
    gsl_multiroot_function_fdf f = {residual, slopes, both, s->rows, s};
    for (size_t j = 0; j < s->rows; j++)
        gsl_vector_set(s->u, j, s->best[j] / s->unit[j]);
    int status = gsl_multiroot_fdfsolver_set(s->gsl, &f, s->u);
    for (int i = 0, idle = 0;
         !status && i < MOST_ITERATIONS && idle < MOST_IDLE && s->residual > 0;
         i++) {
        double before = s->residual;
        status = gsl_multiroot_fdfsolver_iterate(s->gsl);
        idle = s->residual < before ? 0 : idle + 1;
    }
}

/* Each momentum times the velocity wanted over the one that it has, both
   counted from rest. */
static void rescale(search *s) {
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = 1;
    for (int i = 0; i < RESCALINGS && measure(s) > DBL_EPSILON; i++)
        for (size_t j = 0; j < s->rows; j++) {
            size_t k = s->row[j];
            double has = s->slope[k] - s->rest[k];
            double factor = (s->m->v[k] - s->rest[k]) / has;
            if (has != 0 && isfinite(factor))
                s->p[k] *= fmin(fmax(factor, -1e30), 1e30);
        }
}

static void choose_units(search *s) {
    double most = 0;
    for (size_t j = 0; j < s->rows; j++)
        most = fmax(most, fabs(s->best[j]));
    for (size_t j = 0; j < s->rows; j++) {
        double size = fabs(s->best[j]);
        s->unit[j] = size > 0 ? size : most > 0 ? most : 1;
    }
}

/* GSL aborts when memory is out: so ask first for as much as it takes. */
static bool take_gsl(search *s) {
    void *trial = nevh__array(s->rows * (3 * s->rows + 32), sizeof(double));
    free(trial);
    if (!trial)
        return false;
    s->gsl = gsl_multiroot_fdfsolver_alloc(gsl_multiroot_fdfsolver_hybridsj,
                                           s->rows);
    s->u = gsl_vector_calloc(s->rows);
    s->moved = gsl_vector_calloc(s->rows);
    s->f = gsl_vector_calloc(s->rows);
    s->f_moved = gsl_vector_calloc(s->rows);
    return s->gsl && s->u && s->moved && s->f && s->f_moved;
}

static bool take_memory(search *s) {
    size_t n = s->m->n;
    s->room = nevh__velocity_room(s->m->system);
    s->row = nevh__array(n, sizeof *s->row);
    s->slope = nevh__array(n, sizeof *s->slope);
    s->rest = nevh__array(n, sizeof *s->rest);
    s->unit = nevh__array(n, sizeof *s->unit);
    s->best = nevh__array(n, sizeof *s->best);
    return s->room && s->row && s->slope && s->rest && s->unit && s->best;
}

static void done(search *s) {
    free(s->room);
    if (s->gsl)
        gsl_multiroot_fdfsolver_free(s->gsl);
    gsl_vector_free(s->u);
    gsl_vector_free(s->moved);
    gsl_vector_free(s->f);
    gsl_vector_free(s->f_moved);
    free(s->row);
    free(s->slope);
    free(s->rest);
    free(s->unit);
    free(s->best);
}

static int solve(search *s) {
    for (size_t k = 0; k < s->m->n; k++) {
        s->scale = fmax(s->scale, s->m->by_velocity[k] ? fabs(s->m->v[k]) : 0);
        if (s->m->by_velocity[k])
            s->row[s->rows++] = k;
    }
    s->scale = s->scale > 0 ? s->scale : 1;
    s->residual = INFINITY;
    measure(s); /* momenta are zero here */
    for (size_t k = 0; k < s->m->n; k++)
        s->rest[k] = isfinite(s->slope[k]) ? s->slope[k] : 0;
    rescale(s);
    if (s->residual > DBL_EPSILON && s->residual < INFINITY &&
        s->rows <= MOST_ROWS) {
        choose_units(s);
        if (!take_gsl(s))
            return NEVH_ENOMEM;
        iterate(s);
    }
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = s->best[j];
    return s->residual <= CLOSE ? NEVH_OK : NEVH_EMAXITER;
}

static bool fail(nevh_scene *scene, const search *s, int status) {
    const nevh__model *m = s->m;
    size_t k = 0;
    while (!m->by_velocity[k])
        k++;
    if (status == NEVH_ENOMEM)
        return nevh__scene_no_memory(scene);
    return nevh__scene_fail(
        scene, status, &m->moving[k]->key,
        "no momenta were found that give the initial velocities");
}

int nevh_scene_start(nevh_scene *scene, double q[], double p[]) {
    const nevh__model *m = scene->model;
    bool any = false;
    if (!m)
        return scene->status;
    for (size_t k = 0; k < m->n; k++) {
        q[k] = m->q[k];
        p[k] = m->p[k];
        any |= m->by_velocity[k];
    }
    if (!any)
        return NEVH_OK;
    scene->status = NEVH_OK;
    search s = {.m = m, .q = q, .p = p};
    int status = take_memory(&s) ? solve(&s) : NEVH_ENOMEM;
    if (status)
        fail(scene, &s, status);
    done(&s);
    return status;
}
