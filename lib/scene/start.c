/* nevh: the state at t_start: momenta that belong to initial velocities.

   v = dH/dp is solved for the momenta that are not given.  Where each velocity
   depends on its own momentum alone and in proportion to it, rescaling every
   momentum by the velocity that is missing gets there at once; that also finds
   the size of the momenta, which may be anything.  In units of these, GSL's
   hybrid solver does the rest.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_ensemble_private.h"
#include <float.h>
#include <gsl/gsl_multiroots.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    RESCALINGS = 1000,
    MOST_ITERATIONS = 200,
    MOST_IDLE = 20,
    MOST_ROWS = 500
};

static const double CLOSE = 1e-10; /* residual that counts as solved */

typedef struct {
    double *buffer;
    const nevh__scene_model *m;
    size_t rows, *row; /* which of the n momenta are sought */
    const double *q;
    double *p, *slope, *rest; /* n; slope: dH/dp at p, rest: at p = 0 */
    double *scale;            /* rows: of velocities */
    double *unit, *best;      /* rows: of momenta */
    double residual;          /* of the best, largest */
    gsl_multiroot_fdfsolver *gsl;
    gsl_vector *u, *moved, *f, *f_moved;
} search;

/* How far the velocity of a row is off, over its scale. */
static double offset(const search *s, size_t j) {
    size_t k = s->row[j];
    return (s->slope[k] - s->m->v[k]) / s->scale[j];
}

/* The velocities at p, and how far they are off at most. */
static double measure(search *s) {
    double most = 0;
    nevh__velocities(s->m->system, s->m->run.t_start, s->q, s->p, s->buffer,
                     s->slope);
    for (size_t j = 0; j < s->rows; j++) {
        double off = fabs(offset(s, j));
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
        gsl_vector_set(f, j, offset(s, j));
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

static void iterate(search *s, bool from_best) {
    gsl_multiroot_function_fdf f = {residual, slopes, both, s->rows, s};
    for (size_t j = 0; j < s->rows; j++)
        gsl_vector_set(s->u, j, from_best ? s->best[j] / s->unit[j] : 0);
    int status = gsl_multiroot_fdfsolver_set(s->gsl, &f, s->u);
    for (int i = 0, idle = 0;
         !status && i < MOST_ITERATIONS && idle < MOST_IDLE && s->residual > 0;
         i++) {
        double before = s->residual;
        status = gsl_multiroot_fdfsolver_iterate(s->gsl);
        idle = s->residual < before ? 0 : idle + 1;
    }
}

/* What to multiply a momentum by; 1 where that is not known. */
static double factor_of(double wanted, double has) {
    double factor = wanted / has;
    if (wanted == 0 || has == 0 || !isfinite(factor))
        return wanted == 0 ? 0 : 1;
    return copysign(fmin(fmax(fabs(factor), 1e-3), 1e3), factor);
}

/* Each momentum times the velocity wanted over the one that it has, both
   counted from rest. */
static void rescale(search *s) {
    bool moves = true;
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = 1;
    for (int i = 0; moves && i < RESCALINGS && measure(s) > DBL_EPSILON; i++) {
        moves = false;
        for (size_t j = 0; j < s->rows; j++) {
            size_t k = s->row[j];
            double p = s->p[k] * factor_of(s->m->v[k] - s->rest[k],
                                           s->slope[k] - s->rest[k]);
            bool fine = p == 0 || (fabs(p) > 1e-200 && fabs(p) < 1e200);
            moves |= fine && p != s->p[k];
            s->p[k] = fine ? p : s->p[k];
        }
    }
}

/* The size of each momentum: its velocity is a quarter of the scale, about,
   while the others are at rest.  A quarter since velocities may have a limit,
   such as that of light. */
static void choose_units(search *s) {
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = 0;
    for (size_t j = 0; j < s->rows; j++) {
        double *p = &s->p[s->row[j]], factor = 0;
        *p = 1;
        for (int i = 0; i < RESCALINGS && !(factor > 0.5 && factor < 2); i++) {
            measure(s);
            factor = factor_of(s->scale[j] / 4,
                               fabs(s->slope[s->row[j]] - s->rest[s->row[j]]));
            *p *= factor;
        }
        s->unit[j] = *p > 1e-200 && *p < 1e200 ? *p : 1;
        *p = 0;
    }
}

/* Velocities that are zero are compared with the largest. */
static void choose_scales(search *s) {
    double most = 0;
    for (size_t j = 0; j < s->rows; j++)
        most = fmax(most, fabs(s->m->v[s->row[j]]));
    for (size_t j = 0; j < s->rows; j++) {
        double size = fabs(s->m->v[s->row[j]]);
        s->scale[j] = size > 0 ? size : most > 0 ? most : 1;
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
    s->buffer = nevh__velocity_buffer(s->m->system);
    s->row = nevh__array(n, sizeof *s->row);
    s->slope = nevh__array(n, sizeof *s->slope);
    s->rest = nevh__array(n, sizeof *s->rest);
    s->scale = nevh__array(n, sizeof *s->scale);
    s->unit = nevh__array(n, sizeof *s->unit);
    s->best = nevh__array(n, sizeof *s->best);
    return s->buffer && s->row && s->slope && s->rest && s->scale && s->unit &&
           s->best;
}

static void done(search *s) {
    free(s->buffer);
    if (s->gsl)
        gsl_multiroot_fdfsolver_free(s->gsl);
    gsl_vector_free(s->u);
    gsl_vector_free(s->moved);
    gsl_vector_free(s->f);
    gsl_vector_free(s->f_moved);
    free(s->row);
    free(s->slope);
    free(s->rest);
    free(s->scale);
    free(s->unit);
    free(s->best);
}

static void choose_rows(search *s) {
    for (size_t k = 0; k < s->m->n; k++)
        if (s->m->by_velocity[k])
            s->row[s->rows++] = k;
    choose_scales(s);
    s->residual = INFINITY;
    measure(s); /* the momenta sought are zero here */
    for (size_t k = 0; k < s->m->n; k++)
        s->rest[k] = isfinite(s->slope[k]) ? s->slope[k] : 0;
}

static int solve(search *s) {
    choose_rows(s);
    rescale(s);
    if (s->residual > DBL_EPSILON && s->residual < INFINITY &&
        s->rows <= MOST_ROWS) {
        if (!take_gsl(s))
            return NEVH_ENOMEM;
        choose_units(s);
        iterate(s, false);
        if (s->residual > CLOSE)
            iterate(s, true);
    }
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = s->best[j];
    return s->residual <= CLOSE ? NEVH_OK : NEVH_EMAXITER;
}

static bool fail(nevh_scene *scene, int status) {
    const nevh__scene_model *m = scene->model;
    size_t k = 0;
    while (!m->by_velocity[k])
        k++;
    if (status == NEVH_ENOMEM)
        return nevh__scene_no_memory(scene);
    return nevh__scene_fail(
        scene, status, &m->moving[k]->key,
        "no momenta were found that give the initial velocities");
}

int nevh__momenta_find(const nevh__scene_model *m, double q[], double p[]) {
    search s = {.m = m, .q = q, .p = p};
    int status = take_memory(&s) ? solve(&s) : NEVH_ENOMEM;
    done(&s);
    return status;
}

static int find_momenta(nevh_scene *scene, double q[], double p[]) {
    int status = nevh__momenta_find(scene->model, q, p);
    if (status)
        fail(scene, status);
    return status;
}

/* The statement of an effect: a scene that begins where H is not finite is
   wrong there. */
static bool fail_effect(nevh_scene *scene, const char *effect) {
    for (size_t i = 0; i < scene->n_statements; i++) {
        const nevh__statement *s = &scene->statements[i];
        if (s->section == NEVH__EFFECTS && strcmp(s->head.name, effect) == 0)
            return nevh__scene_fail(scene, NEVH_EDOM, &s->value,
                                    "this is not finite in the initial state");
    }
    return true;
}

static int check_values(nevh_scene *scene, const double q[], const double p[]) {
    const nevh__scene_model *m = scene->model;
    double *buffer = nevh__velocity_buffer(m->system);
    if (!buffer)
        return nevh__scene_no_memory(scene), NEVH_ENOMEM;
    const char *effect =
        nevh__effect_not_finite(m->system, m->run.t_start, q, p, buffer);
    free(buffer);
    if (effect)
        fail_effect(scene, effect);
    return scene->status;
}

int nevh_scene_start(nevh_scene *scene, double q[], double p[]) {
    if (!scene)
        return NEVH_EINVAL;
    const nevh__scene_model *m = scene->model;
    bool any = false;
    if (!m)
        return scene->status;
    scene->status = NEVH_OK;
    scene->message[0] = '\0';
    for (size_t k = 0; k < m->n; k++) {
        q[k] = m->q[k];
        p[k] = m->p[k];
        any |= m->by_velocity[k];
    }
    int status = any ? find_momenta(scene, q, p) : NEVH_OK;
    return status ? status : check_values(scene, q, p);
}
