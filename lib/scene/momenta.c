/* nevh: momenta that belong to initial velocities.

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
    MOST_ROWS = 500,
    MOST_IN_TURN = 64, /* rows times rounds */
    MOST_ON_THE_WAY = 400,
    SMALLEST = -600, /* powers of two of a momentum's unit */
    LARGEST = 660
};

static const double CLOSE = 1e-10; /* residual that counts as solved */

typedef struct {
    double *buffer;
    const nevh__scene_model *m;
    size_t rows, *row; /* which of the n momenta are sought */
    const double *q;
    double *p, *slope, *rest;   /* n; slope: dH/dp at p, rest: at p = 0 */
    double *scale;              /* rows: of velocities */
    double *unit, *best, *last; /* rows: of momenta */
    double residual;            /* of the best, largest */
    double *from, part; /* rows; velocities sought are those plus a part of
                                 what those given differ by: 1 */
    gsl_multiroot_fdfsolver *gsl;
    gsl_vector *u, *moved, *f, *f_moved;
} search;

/* The deviation of a row's velocity, over its scale. */
static double offset(const search *s, size_t j) {
    size_t k = s->row[j];
    double wanted = s->m->v[k], rest = 1 - s->part;
    if (rest > 0)
        wanted -= rest * (wanted - s->from[j]);
    return (s->slope[k] - wanted) / s->scale[j];
}

/* The velocities at p, and how far they are off at most. */
static double momenta_measure(search *s) {
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

static int momenta_residual(const gsl_vector *u, void *params, gsl_vector *f) {
    search *s = params;
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = gsl_vector_get(u, j) * s->unit[j];
    if (!(momenta_measure(s) < INFINITY))
        return GSL_EBADFUNC;
    for (size_t j = 0; j < s->rows; j++)
        gsl_vector_set(f, j, offset(s, j));
    return GSL_SUCCESS;
}

/* The Jacobian at u, where the residual is f.  gsl_multiroot_fdjacobian does
   the same, but allocates on every call. */
static int momenta_differences(const gsl_vector *u, const gsl_vector *f,
                               search *s, gsl_matrix *jacobian) {
    int status = GSL_SUCCESS;
    gsl_vector_memcpy(s->moved, u);
    for (size_t j = 0; !status && j < s->rows; j++) {
        double x = gsl_vector_get(u, j);
        double dx = GSL_SQRT_DBL_EPSILON * fmax(fabs(x), 1);
        gsl_vector_set(s->moved, j, x + dx);
        status = momenta_residual(s->moved, s, s->f_moved);
        gsl_vector_set(s->moved, j, x);
        gsl_vector_sub(s->f_moved, f);
        gsl_vector_scale(s->f_moved, 1 / dx);
        gsl_matrix_set_col(jacobian, j, s->f_moved);
    }
    return status;
}

static int momenta_slopes(const gsl_vector *u, void *params,
                          gsl_matrix *jacobian) {
    search *s = params;
    int status = momenta_residual(u, s, s->f);
    return status ? status : momenta_differences(u, s->f, s, jacobian);
}

static int momenta_both(const gsl_vector *u, void *params, gsl_vector *f,
                        gsl_matrix *jacobian) {
    int status = momenta_residual(u, params, f);
    return status ? status : momenta_differences(u, f, params, jacobian);
}

/* From the momenta that there are. */
static void momenta_iterate(search *s) {
    gsl_multiroot_function_fdf f = {momenta_residual, momenta_slopes,
                                    momenta_both, s->rows, s};
    for (size_t j = 0; j < s->rows; j++)
        gsl_vector_set(s->u, j, s->p[s->row[j]] / s->unit[j]);
    int status = gsl_multiroot_fdfsolver_set(s->gsl, &f, s->u);
    for (int i = 0, idle = 0;
         !status && i < MOST_ITERATIONS && idle < MOST_IDLE && s->residual > 0;
         i++) {
        double before = s->residual;
        status = gsl_multiroot_fdfsolver_iterate(s->gsl);
        idle = s->residual < before ? 0 : idle + 1;
    }
}

/* The factor for a momentum; 1 if it is not known. */
static double factor_of(double wanted, double has) {
    double factor = wanted / has;
    if (wanted == 0 || has == 0 || !isfinite(factor))
        return wanted == 0 ? 0 : 1;
    return copysign(fmin(fmax(fabs(factor), 1e-3), 1e3), factor);
}

/* Each momentum times the velocity wanted over the one that it has, both
   counted from rest. */
static void momenta_rescale(search *s) {
    bool moves = true;
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = 1;
    for (int i = 0; moves && i < RESCALINGS && momenta_measure(s) > DBL_EPSILON;
         i++) {
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
            momenta_measure(s);
            factor = factor_of(s->scale[j] / 4,
                               fabs(s->slope[s->row[j]] - s->rest[s->row[j]]));
            *p *= factor;
        }
        bool found = factor > 0.5 && factor < 2 && *p > 1e-200 && *p < 1e200;
        s->unit[j] = found ? *p : 1;
        *p = 0;
    }
}

/* The deviation of a row's velocity at the momentum p. */
static double offset_at(search *s, size_t j, double p) {
    s->p[s->row[j]] = p;
    momenta_measure(s);
    return offset(s, j);
}

/* Between a and b, where offsets have unlike signs, below is that at a. */
static void momenta_halve(search *s, size_t j, double a, double b,
                          double below) {
    for (double middle = (a + b) / 2; middle != a && middle != b;
         middle = (a + b) / 2) {
        double off = offset_at(s, j, middle);
        if ((off < 0) == (below < 0))
            a = middle;
        else
            b = middle;
    }
}

/* Below that part of a momentum, a step to its side is none. */
static const double least_step = 0x1p-40;

/* The momentum of one row, to either side of where it is. */
static void seek(search *s, size_t j) {
    double from = s->p[s->row[j]], here = offset_at(s, j, from);
    double before[2] = {from, from};
    for (int power = SMALLEST; here != 0 && power < LARGEST; power++) {
        double step = ldexp(s->unit[j], power);
        for (int side = 0; side < 2 && step > least_step * fabs(from); side++) {
            double p = side ? from - step : from + step;
            double off = offset_at(s, j, p);
            if (isfinite(off) && (off < 0) != (here < 0)) {
                momenta_halve(s, j, before[side], p, here);
                return;
            }
            before[side] = isfinite(off) ? p : before[side];
        }
    }
    s->p[s->row[j]] = from;
}

static void seek_in_turn(search *s) {
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = 0;
    for (size_t i = 0; i * s->rows < MOST_IN_TURN && s->residual > CLOSE; i++)
        for (size_t j = 0; j < s->rows; j++)
            seek(s, j);
    momenta_measure(s);
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
    s->last = nevh__array(n, sizeof *s->last);
    s->from = nevh__array(n, sizeof *s->from);
    return s->buffer && s->row && s->slope && s->rest && s->scale && s->unit &&
           s->best && s->last && s->from;
}

static void momenta_done(search *s) {
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
    free(s->last);
    free(s->from);
}

static void choose_rows(search *s) {
    for (size_t k = 0; k < s->m->n; k++)
        if (s->m->by_velocity[k])
            s->row[s->rows++] = k;
    choose_scales(s);
    s->residual = INFINITY;
    momenta_measure(s); /* the momenta sought are zero here */
    for (size_t k = 0; k < s->m->n; k++)
        s->rest[k] = isfinite(s->slope[k]) ? s->slope[k] : 0;
}

static void set_momenta(search *s, const double p[], double factor) {
    for (size_t j = 0; j < s->rows; j++)
        s->p[s->row[j]] = p ? factor * p[j] : 0;
}

/* Towards the velocities given, from those that there are. */
static void momenta_follow(search *s) {
    double done = 0, step = 0.5;
    momenta_measure(s);
    for (size_t j = 0; j < s->rows; j++) {
        double p = s->best[j] = s->p[s->row[j]];
        s->unit[j] = p != 0 ? fabs(p) : s->unit[j];
        s->from[j] = s->slope[s->row[j]];
    }
    for (int i = 0; done < 1 && step > 0x1p-30 && i < MOST_ON_THE_WAY; i++) {
        s->part = fmin(1, done + step);
        s->residual = INFINITY;
        memcpy(s->last, s->best, s->rows * sizeof *s->last);
        momenta_iterate(s);
        if (s->residual <= CLOSE) {
            done = s->part;
            step *= 2;
        } else {
            memcpy(s->best, s->last, s->rows * sizeof *s->last);
            step /= 2;
        }
        set_momenta(s, s->best, 1);
    }
    s->part = 1;
    s->residual = momenta_measure(s);
}

static int solve_coupled(search *s) {
    if (!take_gsl(s))
        return NEVH_ENOMEM;
    choose_units(s);
    set_momenta(s, NULL, 0);
    momenta_iterate(s);
    if (s->residual > CLOSE) {
        set_momenta(s, s->best, 1);
        momenta_iterate(s);
    }
    if (s->residual > CLOSE) {
        seek_in_turn(s);
        momenta_follow(s);
    }
    return NEVH_OK;
}

/* True if all momenta that are large enough give these velocities, which are then a
   limit that no momentum reaches.  Squares of such momenta may overflow. */
static bool is_limit(search *s) {
    bool moved = false, same = true;
    double most = 0;
    for (size_t j = 0; j < s->rows; j++)
        most = fmax(most, fabs(s->best[j]));
    for (int power = 10; power <= 30; power += 10) {
        double factor = fmin(ldexp(1, power), fmax(1, 0x1p500 / most));
        set_momenta(s, s->best, factor);
        momenta_measure(s);
        for (size_t j = 0; j < s->rows; j++) {
            size_t k = s->row[j];
            double little = 4 * DBL_EPSILON * s->scale[j];
            moved |= fabs(s->m->v[k] - s->rest[k]) > little;
            same &= fabs(s->slope[k] - s->m->v[k]) <= little;
        }
    }
    return moved && same;
}

/* Moves each momentum far off from the best ones, either way: that of a velocity that
   comes close to a limit may be 0 there.  Squares do not overflow. */
static void look_far_off(search *s) {
    for (int power = 40; power >= 0; power -= 10)
        for (size_t j = 0; j < 2 * s->rows; j++) {
            double far_off = fmin(ldexp(s->unit[j / 2], power), 0x1p500);
            set_momenta(s, s->best, 1);
            s->p[s->row[j / 2]] += j % 2 ? -far_off : far_off;
            momenta_measure(s);
        }
}

static size_t farthest_off(search *s) {
    size_t most = 0;
    for (int power = 40; power >= 0; power -= 10) {
        set_momenta(s, s->best, ldexp(1, power)); /* closer to a limit */
        momenta_measure(s);
    }
    look_far_off(s);
    set_momenta(s, s->best, 1);
    momenta_measure(s);
    for (size_t j = 1; j < s->rows; j++)
        if (fabs(offset(s, j)) > fabs(offset(s, most)))
            most = j;
    return s->row[most];
}

static const char none_found[] =
    "no momenta were found that give the initial velocities";

static int momenta_refuse(search *s, nevh__report *report) {
    const nevh__scene_model *m = s->m;
    if (!(s->residual < INFINITY)) {
        static const double one = 1;
        for (size_t j = 0; j < s->rows; j++)
            s->p[s->row[j]] = one;
        const char *effect = nevh__effect_not_finite(m->system, m->run.t_start,
                                                     s->q, s->p, s->buffer);
        return nevh__fail(report, NEVH_EMAXITER,
                          "%s: effect \"%s\" has no finite derivatives with "
                          "respect to momenta, as where a mass is 0",
                          none_found, effect ? effect : "");
    }
    size_t k = farthest_off(s);
    const char *name = m->coordinate_names[k];
    return nevh__fail(report, NEVH_EMAXITER,
                      "%s: v_%s comes no closer to %.9g than %.9g", none_found,
                      name, m->v[k], s->slope[k]);
}

/* True if rounding of the velocities at rest explains what is left: of a charge that is
   slow far from the origin of its field these are large. */
static bool is_close(search *s) {
    static const double roundings = 16;
    bool close = s->residual < INFINITY;
    set_momenta(s, s->best, 1);
    momenta_measure(s);
    for (size_t j = 0; j < s->rows; j++)
        close = close && fabs(offset(s, j)) * s->scale[j] <=
                             CLOSE * s->scale[j] + roundings * DBL_EPSILON *
                                                       fabs(s->rest[s->row[j]]);
    return close;
}

/* True if momenta that are far smaller give the velocities, too, as those of light. */
static bool is_any_size(search *s) {
    static const double close = 1e-12;
    static const double least = 0x1p-300; /* squares underflow below 2^-511 */
    double most = 0;
    bool same = true;
    for (size_t j = 0; j < s->rows; j++)
        most = fmax(most, fabs(s->best[j]));
    for (double factor = 1; same && factor * most > least; factor /= 1024) {
        set_momenta(s, s->best, factor);
        momenta_measure(s);
        for (size_t j = 0; j < s->rows; j++)
            same = same && fabs(offset(s, j)) <= close;
    }
    return same;
}

static int momenta_solve(search *s, nevh__report *report) {
    int status = NEVH_OK;
    choose_rows(s);
    momenta_rescale(s);
    if (s->residual > DBL_EPSILON && s->residual < INFINITY &&
        s->rows <= MOST_ROWS)
        status = solve_coupled(s);
    if (status)
        return nevh__fail(report, status, "out of memory");
    if (s->residual > CLOSE && !is_close(s))
        return momenta_refuse(s, report);
    if (is_limit(s) && is_any_size(s))
        return nevh__fail(report, NEVH_EMAXITER,
                          "the initial velocities are those of momenta of any "
                          "size: give p_%s, and others, in place of v_%s",
                          s->m->coordinate_names[*s->row],
                          s->m->coordinate_names[*s->row]);
    if (is_limit(s))
        return nevh__fail(report, NEVH_EMAXITER,
                          "%s: they are a limit, to which larger and larger "
                          "momenta come close",
                          none_found);
    set_momenta(s, s->best, 1);
    return NEVH_OK;
}

int nevh__momenta_find(const nevh__scene_model *m, double q[], double p[],
                       nevh__report *report) {
    search s = {.m = m, .q = q, .p = p, .part = 1};
    int status =
        take_memory(&s) ? momenta_solve(&s, report) : nevh__no_memory(report);
    momenta_done(&s);
    return status;
}
