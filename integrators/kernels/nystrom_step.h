/* nevh: the stages of an explicit Runge-Kutta-Nystroem method, for any number of
   orbits side by side; nystrom_kernel.c has the formulas.
   SPDX-License-Identifier: GPL-3.0-or-later

   The text needs vector_private.h, stage_sums_private.h and three functions of
   the includer; nystrom_kernel.c compiles it for numbers, for vectors, and for
   rows of any width. */
#ifndef NEVH_NYSTROM_STEP_H
#define NEVH_NYSTROM_STEP_H

#include "stage_sums_private.h"
#include <stdbool.h>

typedef struct {
    const double *c;              /* of the stages */
    const nevh__sum *sums;        /* sum_j a_ij D_j of each stage */
    size_t lanes, size;           /* orbits of a row; n x lanes */
    size_t equal;                 /* as many orbits side by side are the same */
    size_t stride;                /* from the slopes of a stage to the next */
    bool diagonal;                /* T_p(p) - T_p(0) is W p */
    bool moves;                   /* T_p(0) is not 0 */
    double *q, *p, *compensation; /* the start; compensation: 2n rows */
    double *h;                    /* n rows, of equal ones */
    double *way;                  /* h T_p(p), n rows; with a diagonal W */
    double *gain;                 /* h^2 W, n rows */
    double *at_rest;              /* T_p(0), n rows */
    double *momenta;              /* n rows: at which T_p is asked for */
    double *velocities;           /* n rows: what it is */
    double *points;               /* n rows: q_i */
    double *slopes;               /* D_i: n rows a stage */
    const struct nevh__nystrom_owner *owner; /* the includer's */
} nevh__nystrom_step;

/* A slope that was not looked at when taken is not finite. */
enum { NEVH__NYSTROM_RANGE = -1 };

/* The includer's: T_p of x->momenta to x->velocities; D_i of a stage at
   x->points; the time t + c h of what follows.  The first two return 0, or what
   makes the step fail.  way: what the includer has handed to the functions
   below. */
NEVH__INLINE int nevh__nystrom_drift(const nevh__nystrom_step *x, int way);
NEVH__INLINE int nevh__nystrom_kick(const nevh__nystrom_step *x, int way,
                                    size_t stage);
NEVH__INLINE void nevh__nystrom_time(const nevh__nystrom_step *x, int way,
                                     double c);

/* Places the momenta for T_p: c p - h sum. */
NEVH__INLINE void nevh__nystrom_place_momenta(const nevh__nystrom_step *x,
                                              const nevh__sum *sum, double c) {
    const double *compensation = x->compensation + x->size;
    size_t i = 0;
    for (; i + NEVH__IN_VECTOR <= x->size; i += NEVH__IN_VECTOR) {
        nevh__vector total;
        nevh__add_up(sum, 1, x->slopes + i, &total);
        NEVH__VECTOR_AT(x->momenta + i) =
            c * NEVH__VECTOR_AT(x->p + i) +
            (c * NEVH__VECTOR_AT(compensation + i) -
             NEVH__VECTOR_AT(x->h + i) * total);
    }
    for (; i < x->size; i++)
        x->momenta[i] =
            c * x->p[i] + (c * compensation[i] -
                           x->h[i] * nevh__add_up_one(sum, x->slopes + i));
}

/* The change of q: h (T_p + (c - 1) T_p(0)). */
#define NEVH__NYSTROM_WAY(type, x, i, c)                                       \
    ((x)->moves ? *(const type *)((x)->h + (i)) *                              \
                      (*(const type *)((x)->velocities + (i)) +                \
                       ((c)-1) * *(const type *)((x)->at_rest + (i)))          \
                : *(const type *)((x)->h + (i)) *                              \
                      *(const type *)((x)->velocities + (i)))

/* q_i: the start and what it moved by. */
NEVH__INLINE void nevh__nystrom_place_points(const nevh__nystrom_step *x,
                                             double c) {
    size_t i = 0;
    for (; i + NEVH__IN_VECTOR <= x->size; i += NEVH__IN_VECTOR)
        NEVH__VECTOR_AT(x->points + i) =
            NEVH__VECTOR_AT(x->q + i) +
            (NEVH__NYSTROM_WAY(nevh__vector, x, i, c) +
             NEVH__VECTOR_AT(x->compensation + i));
    for (; i < x->size; i++)
        x->points[i] =
            x->q[i] + (NEVH__NYSTROM_WAY(double, x, i, c) + x->compensation[i]);
}

/* The same by W: of `rows` vectors. */
NEVH__INLINE void nevh__nystrom_place_vectors(const nevh__nystrom_step *x,
                                              const nevh__sum *sum, double c,
                                              size_t rows, size_t from) {
    nevh__vector sums[2];
    nevh__add_up(sum, rows, x->slopes + from, sums);
    NEVH_UNROLL
    for (size_t k = 0; k < rows; k++) {
        size_t i = from + k * NEVH__IN_VECTOR;
        NEVH__VECTOR_AT(x->points + i) =
            NEVH__VECTOR_AT(x->q + i) +
            ((c * NEVH__VECTOR_AT(x->way + i) +
              NEVH__VECTOR_AT(x->compensation + i)) -
             NEVH__VECTOR_AT(x->gain + i) * sums[k]);
    }
}

NEVH__INLINE void nevh__nystrom_place_number(const nevh__nystrom_step *x,
                                             double c, size_t i, double sum) {
    x->points[i] =
        x->q[i] + ((c * x->way[i] + x->compensation[i]) - x->gain[i] * sum);
}

NEVH__INLINE void nevh__nystrom_place_diagonal(const nevh__nystrom_step *x,
                                               const nevh__sum *sum, double c) {
    size_t i = 0, one = NEVH__IN_VECTOR;
    for (; i + 2 * one <= x->size; i += 2 * one)
        nevh__nystrom_place_vectors(x, sum, c, 2, i);
    for (; i + one <= x->size; i += one)
        nevh__nystrom_place_vectors(x, sum, c, 1, i);
    for (; i + 2 <= x->size; i += 2) {
        double sums[2];
        nevh__add_up_two(sum, x->slopes + i, sums);
        nevh__nystrom_place_number(x, c, i, sums[0]);
        nevh__nystrom_place_number(x, c, i + 1, sums[1]);
    }
    if (i < x->size)
        nevh__nystrom_place_number(x, c, i,
                                   nevh__add_up_one(sum, x->slopes + i));
}

/* The state of the first stage. */
NEVH__INLINE void nevh__nystrom_place_start(const nevh__nystrom_step *x) {
    for (size_t i = 0; i < x->size; i++)
        x->points[i] = x->q[i] + x->compensation[i];
}

/* The state of a stage, to points, and its time. */
NEVH__INLINE int nevh__nystrom_place(const nevh__nystrom_step *x, int way,
                                     size_t stage) {
    const nevh__sum *sum = &x->sums[stage];
    double c = x->c[stage];
    int status = 0;
    if (stage == 0)
        nevh__nystrom_place_start(x);
    else if (x->diagonal)
        nevh__nystrom_place_diagonal(x, sum, c);
    else {
        nevh__nystrom_place_momenta(x, sum, c);
        status = nevh__nystrom_drift(x, way);
        nevh__nystrom_place_points(x, c);
    }
    nevh__nystrom_time(x, way, c);
    return status;
}

/* T_p(p), to velocities, unless these are known, and by how far it moves q. */
NEVH__INLINE int nevh__nystrom_find_way(const nevh__nystrom_step *x, int way,
                                        bool known) {
    const double *compensation = x->compensation + x->size;
    int status = 0;
    for (size_t i = 0; i < x->size; i++)
        x->momenta[i] = x->p[i] + compensation[i];
    if (!known)
        status = nevh__nystrom_drift(x, way);
    for (size_t i = 0; i < x->size; i++)
        x->way[i] = x->h[i] * x->velocities[i];
    return status;
}

/* The stages from `first` to `until` - 1; slopes of those before are there.
   unchecked (a constant): slopes are looked at here; of equal orbits, of one. */
NEVH__INLINE int nevh__nystrom_take(const nevh__nystrom_step *x, int way,
                                    bool unchecked, size_t first,
                                    size_t until) {
    int status = 0;
    double bad = 0;
    nevh__nystrom_place_start(x); /* where T_p is asked for, if H is one
                                     function */
    nevh__nystrom_time(x, way, 0);
    if (x->diagonal || until == 1)
        status = nevh__nystrom_find_way(x, way, first > 0);
    for (size_t i = first; !status && i < until; i++) {
        status = nevh__nystrom_place(x, way, i);
        if (!status)
            status = nevh__nystrom_kick(x, way, i);
        const double *slopes = x->slopes + i * x->stride;
        for (size_t k = 0; unchecked && k < x->size; k += x->equal)
            bad += slopes[k] - slopes[k];
    }
    return status || bad == 0 ? status : NEVH__NYSTROM_RANGE;
}

/* -h sum, of every `apart`th orbit. */
NEVH__INLINE void nevh__nystrom_sum_kicks(const nevh__nystrom_step *x,
                                          const nevh__sum *sum, size_t apart,
                                          double out[]) {
    for (size_t i = 0, at = 0; at < x->size; i++, at += apart)
        out[i] = -(x->h[at] * nevh__add_up_one(sum, x->slopes + at));
}

/* The change of q by the velocity at c p - h sum. */
NEVH__INLINE int nevh__nystrom_sum_drifts(const nevh__nystrom_step *x, int way,
                                          const nevh__sum *sum, double c,
                                          size_t apart, double out[]) {
    int status = 0;
    for (size_t i = 0, at = 0; x->diagonal && at < x->size; i++, at += apart)
        out[i] = c * x->way[at] -
                 x->gain[at] * nevh__add_up_one(sum, x->slopes + at);
    if (x->diagonal)
        return status;
    nevh__nystrom_place_momenta(x, sum, c);
    status = nevh__nystrom_drift(x, way);
    for (size_t i = 0, at = 0; at < x->size; i++, at += apart)
        out[i] = NEVH__NYSTROM_WAY(double, x, at, c);
    return status;
}
#undef NEVH__NYSTROM_WAY

#endif
