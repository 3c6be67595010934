/* nevh: a sweep over the stages of an implicit Runge-Kutta method, or of a
   Lobatto pair, for any number of orbits side by side.
   SPDX-License-Identifier: GPL-3.0-or-later

   The text needs vector_private.h, stage_progress.h, fabs and fma of the C
   library, and two functions of the includer; stage_sweeps.c compiles it for the stages of one
   orbit and for orbits as vectors, and for any number of orbits.  Unknown are
   the derivatives of H, as they are written; signs come in with the weights:

       Q_i = q + (sum_j mu_ij (h b_j dH/dp_j) + e),
       P_i = p + (sum_j mu_ij (-h b_j dH/dq_j) + e).

   For H = T(p) + V(q) unknown are dH/dq alone: a sweep takes P_i from them,
   dH/dp there, Q_i from those, and dH/dq there.

   A row is what belongs to one variable.  Of orbits it has a number an orbit,
   stage by stage.  Of one orbit (lanes is NEVH__STAGES_TOGETHER) it has a number
   a stage, and stages fill vectors; what is behind them repeats the first one,
   and so decides nothing; where rows are not padded, it is overwritten by the
   next.  All give the same bits. */
#ifndef NEVH_STAGE_STEP_H
#define NEVH_STAGE_STEP_H

#include "implicit/stage_progress.h"
#include "system/vector_private.h"
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

enum { NEVH__STAGES_TOGETHER = 0 };

typedef struct {
    size_t n, stages;
    size_t row;       /* from a column of mu to the next: whole vectors, of one
                      orbit */
    size_t stride;    /* from a row of the arrays below to the next */
    size_t half;      /* from the points of q to those of p */
    bool partitioned; /* H is T(p) + V(q) */
    bool unchecked;   /* slopes are not looked at when taken */
    const double *mu_q, *mu_p; /* mu_ij, column by column */
    const double *to_q, *to_p; /* h b_j, -h b_j: in all lanes of a vector */
    const double *q, *p,
        *compensation; /* n, n and 2n rows of lanes: the state, e */
    double *products;  /* a row */
    double *points;    /* 2n rows: Q_i, P_i */
    double *gradient;  /* 2n rows: dH/dp, then dH/dq */
    const struct nevh__stage_owner *owner; /* the includer's */
} nevh__stage_step;

/* The changes that sweeps make to the rows that are solved for. */
typedef struct {
    size_t first, rows; /* of the gradient */
    const double *unit; /* 2n rows of lanes: |h| over the scale */
    double *before;     /* rows: as the last sweep left them */
    double *least;      /* rows: the smallest change so far */
    double *lowest;     /* of each lane: the smallest change of a sweep so far,
                           in units of scale */
} nevh__stage_changes;

/* dH/dp is not finite where it has not been looked at. */
enum { NEVH__STAGE_RANGE = -1 };

/* The includer's: takes dH/dq, dH/dp or both at x->points to x->gradient.
   Returns 0, or what makes the sweep fail. */
NEVH__INLINE int nevh__stage_slopes(const nevh__stage_step *x, bool q, bool p);
#ifndef NEVH__FOR_READERS
/* The includer's, too: where T is that of known masses, what momenta are
   multiplied by, n rows as points are; else NULL. */
NEVH__INLINE const double *nevh__stage_inverse(const nevh__stage_step *x);
#endif

/* sum_j weights_ij (to_j x_j), or `plain` without to, of a vector of one orbit's
   stages from `from` on: even and odd j, which need not wait for each other. */
#define NEVH__STAGE_PRODUCT(j)                                                 \
    (plain ? NEVH__VECTOR_AT(weights + (j)*row + from) * x[j]                  \
           : NEVH__VECTOR_AT(weights + (j)*row + from) *                       \
                 (NEVH__VECTOR_AT(to + (j)*NEVH__LANES) * x[j]))
NEVH__INLINE void nevh__stage_sum_stages(size_t row, size_t stages,
                                         const double *weights, bool plain,
                                         const double *to, const double x[],
                                         size_t from, nevh__vector *sum) {
    nevh__vector even = {0}, odd = {0};
    size_t j = 0;
    NEVH_UNROLL
    for (; j + 1 < stages; j += 2) {
        even += NEVH__STAGE_PRODUCT(j);
        odd += NEVH__STAGE_PRODUCT(j + 1);
    }
    if (j < stages)
        even += NEVH__STAGE_PRODUCT(j);
    *sum = even + odd;
}
#undef NEVH__STAGE_PRODUCT

#ifndef NEVH__FOR_READERS
/* sum_j weights[j*row] x[j*lanes] of a vector of orbits, and of one. */
NEVH__INLINE void nevh__stage_sum_orbits(size_t row, size_t stages,
                                         size_t lanes, const double *weights,
                                         const double x[], nevh__vector *sum) {
    nevh__vector even = {0}, odd = {0};
    size_t j = 0;
    NEVH_UNROLL
    for (; j + 1 < stages; j += 2) {
        even += weights[j * row] * NEVH__VECTOR_AT(x + j * lanes);
        odd += weights[(j + 1) * row] * NEVH__VECTOR_AT(x + (j + 1) * lanes);
    }
    if (j < stages)
        even += weights[j * row] * NEVH__VECTOR_AT(x + j * lanes);
    *sum = even + odd;
}

NEVH__INLINE double nevh__stage_sum_orbit(size_t row, size_t stages,
                                          size_t lanes, const double *weights,
                                          const double x[]) {
    double even = 0, odd = 0;
    size_t j = 0;
    for (; j + 1 < stages; j += 2) {
        even += weights[j * row] * x[j * lanes];
        odd += weights[(j + 1) * row] * x[(j + 1) * lanes];
    }
    if (j < stages)
        even += weights[j * row] * x[j * lanes];
    return even + odd;
}
#endif

/* A variable's points from its slopes. */
NEVH__INLINE void nevh__stage_place_stages(size_t stages, size_t row,
                                           const double *mu, const double *to,
                                           const double *slopes, double y,
                                           double compensation,
                                           double *points) {
    for (size_t from = 0; from < row; from += NEVH__IN_VECTOR) {
        nevh__vector sum;
        nevh__stage_sum_stages(row, stages, mu, false, to, slopes, from, &sum);
        NEVH__VECTOR_AT(points + from) = y + (sum + compensation);
    }
}

#ifndef NEVH__FOR_READERS
NEVH__INLINE void nevh__stage_place_orbits(
    size_t stages, size_t row, size_t lanes, const double *restrict mu,
    const double *restrict to, const double *restrict slopes,
    const double *restrict y, const double *restrict compensation,
    double *restrict products, double *restrict points) {
    const size_t one = NEVH__IN_VECTOR;
    for (size_t j = 0; j < stages; j++) {
        const double *restrict x = slopes + j * lanes;
        double *restrict product = products + j * lanes;
        size_t lane = 0;
        for (; lane + one <= lanes; lane += one)
            NEVH__VECTOR_AT(product + lane) =
                to[j * NEVH__LANES] * NEVH__VECTOR_AT(x + lane);
        for (; lane < lanes; lane++)
            product[lane] = to[j * NEVH__LANES] * x[lane];
    }
    for (size_t i = 0; i < stages; i++, points += lanes) {
        size_t lane = 0;
        for (; lane + one <= lanes; lane += one) {
            nevh__vector sum;
            nevh__stage_sum_orbits(row, stages, lanes, mu + i, products + lane,
                                   &sum);
            NEVH__VECTOR_AT(points + lane) =
                NEVH__VECTOR_AT(y + lane) +
                (sum + NEVH__VECTOR_AT(compensation + lane));
        }
        for (; lane < lanes; lane++)
            points[lane] =
                y[lane] + (nevh__stage_sum_orbit(row, stages, lanes, mu + i,
                                                 products + lane) +
                           compensation[lane]);
    }
}
#endif

/* Stages' states, n rows, from the gradient; velocities too, where these are
   momenta over known masses. */
NEVH__INLINE void nevh__stage_place_rows(const nevh__stage_step *x,
                                         size_t lanes, size_t stages,
                                         size_t row, size_t stride, bool q,
                                         const double *inverse) {
    bool together = lanes == NEVH__STAGES_TOGETHER;
    size_t n = x->n, apart = together ? 1 : lanes;
    const double *restrict mu = q ? x->mu_q : x->mu_p;
    const double *restrict to = q ? x->to_q : x->to_p;
    const double *restrict slopes = x->gradient + (q ? 0 : n * stride);
    const double *restrict y = q ? x->q : x->p;
    const double *restrict compensation = x->compensation + (q ? 0 : n * apart);
    double *restrict points = x->points + (q ? 0 : x->half);
    double *restrict velocities = x->gradient;
    for (size_t k = 0; k < n; k++) {
        size_t at = k * stride;
        if (together)
            nevh__stage_place_stages(stages, row, mu, to, slopes + at, y[k],
                                     compensation[k], points + at);
#ifndef NEVH__FOR_READERS
        else
            nevh__stage_place_orbits(stages, row, lanes, mu, to, slopes + at,
                                     y + k * lanes, compensation + k * lanes,
                                     x->products, points + at);
#endif
        for (size_t i = at; inverse && i < at + stride; i += NEVH__IN_VECTOR)
            NEVH__VECTOR_AT(velocities + i) =
                NEVH__VECTOR_AT(inverse + i) * NEVH__VECTOR_AT(points + i);
    }
}

/* NEVH__ONE_SHAPE: sizes are constants of the includer. */
#ifdef NEVH__ONE_SHAPE
NEVH__INLINE void nevh__stage_place(const nevh__stage_step *x, size_t lanes,
                                    bool q) {
    nevh__stage_place_rows(x, lanes, x->stages, x->row, x->stride, q, NULL);
}
#else
/* Methods of eight stages, and of less than eight, have loops of their own. */
NEVH__INLINE void nevh__stage_place(const nevh__stage_step *x, size_t lanes,
                                    bool q) {
    const double *inverse = q ? NULL : nevh__stage_inverse(x);
    size_t eight = NEVH__LANES, whole = lanes ? lanes * eight : eight;
    if (x->stages == eight && x->stride == whole)
        nevh__stage_place_rows(x, lanes, eight, eight, whole, q, inverse);
    else if (x->stride == eight && lanes == NEVH__STAGES_TOGETHER)
        nevh__stage_place_rows(x, lanes, x->stages, eight, eight, q, inverse);
    else if (x->row == eight)
        nevh__stage_place_rows(x, lanes, x->stages, eight, x->stride, q,
                               inverse);
    else
        nevh__stage_place_rows(x, lanes, x->stages, x->row, x->stride, q,
                               inverse);
}
#endif

NEVH__INLINE bool nevh__stage_finite(size_t size, const double x[]) {
    double bad[NEVH__LANES];
    NEVH_LANES(i, NEVH__LANES) {
        bad[i] = 0;
    }
    for (size_t from = 0; from < size; from += NEVH__LANES)
        NEVH_LANES(i, NEVH__LANES) {
            bad[i] += x[from + i] - x[from + i];
        }
    return nevh__sum_lanes(bad) == 0;
}

/* The slopes at the points that the slopes lead to. */
NEVH__INLINE int nevh__stage_map(const nevh__stage_step *x, size_t lanes) {
    nevh__stage_place(x, lanes, false);
    if (!x->partitioned) {
        nevh__stage_place(x, lanes, true);
        return nevh__stage_slopes(x, true, true);
    }
    int status = nevh__stage_slopes(x, false, true);
    if (status)
        return status;
    nevh__stage_place(x, lanes, true);
    if (x->unchecked && !nevh__stage_finite(x->n * x->stride, x->gradient))
        return NEVH__STAGE_RANGE;
    return nevh__stage_slopes(x, true, false);
}

/* The difference between a sweep and the one before, for the lanes of all vectors. */
typedef struct {
    double all[NEVH__LANES];    /* sum of changes: 0: none; finite or not */
    double better[NEVH__LANES]; /* sum of those that are smaller than ever */
    double most[NEVH__LANES];   /* the largest, in units of scale */
} nevh__stage_comparison;

NEVH__INLINE void nevh__stage_compare_rows(const nevh__stage_step *x,
                                           const nevh__stage_changes *c,
                                           size_t lanes,
                                           nevh__stage_comparison *found) {
    const double *restrict now = x->gradient + c->first * x->stride;
    double *restrict before = c->before, *restrict least = c->least;
    bool together = lanes == NEVH__STAGES_TOGETHER;
    size_t apart = together ? 1 : lanes;
    const double *restrict unit = c->unit + c->first * apart;
    for (size_t k = 0, stride = x->stride; k < c->rows; k++, unit += apart)
        for (size_t from = 0; from < stride; from += NEVH__LANES) {
            NEVH_LANES(i, NEVH__LANES) {
                double one = unit[together ? 0 : i];
                double change = fabs(now[i] - before[i]), part = change * one;
                double bar = least[i], gain = change < bar ? change : 0;
                before[i] = now[i];
                least[i] = gain > 0 ? gain : bar;
                found->all[i] += change;
                found->better[i] += gain;
                found->most[i] = found->most[i] > part ? found->most[i] : part;
            }
            now += NEVH__LANES;
            before += NEVH__LANES;
            least += NEVH__LANES;
        }
}

NEVH__INLINE void nevh__stage_compare_changes(const nevh__stage_step *x,
                                              const nevh__stage_changes *c,
                                              size_t lanes,
                                              nevh__stage_comparison *found) {
    NEVH_LANES(i, NEVH__LANES) {
        found->all[i] = found->better[i] = found->most[i] = 0;
    }
    nevh__stage_compare_rows(x, c, lanes, found);
}

NEVH__INLINE double nevh__stage_greater(double x, double y) {
    return x > y ? x : y;
}

NEVH__INLINE double nevh__stage_greatest(const double x[NEVH__LANES]) {
#ifdef NEVH__FOR_READERS
    return x[0];
#else
    return nevh__stage_greater(
        nevh__stage_greater(nevh__stage_greater(x[0], x[1]),
                            nevh__stage_greater(x[2], x[3])),
        nevh__stage_greater(nevh__stage_greater(x[4], x[5]),
                            nevh__stage_greater(x[6], x[7])));
#endif
}

NEVH__INLINE void nevh__stage_tell(double all, double better, double most,
                                   double *lowest, nevh__stage_progress *made) {
    double change = all < INFINITY ? most : INFINITY, least = *lowest;
    made->moved = all != 0;
    made->change = change;
    made->improved = change < least || better > 0;
    *lowest = change < least ? change : least;
}

/* The change of each lane, which is a vector's, or that of the one orbit. */
NEVH__INLINE void nevh__stage_compare_sweep(const nevh__stage_step *x,
                                            const nevh__stage_changes *c,
                                            size_t lanes,
                                            nevh__stage_progress made[]) {
    nevh__stage_comparison found;
    nevh__stage_compare_changes(x, c, lanes, &found);
    if (lanes == NEVH__STAGES_TOGETHER)
        nevh__stage_tell(nevh__sum_lanes(found.all),
                         nevh__sum_lanes(found.better),
                         nevh__stage_greatest(found.most), c->lowest, made);
    for (size_t i = 0; i < lanes; i++)
        nevh__stage_tell(found.all[i], found.better[i], found.most[i],
                         &c->lowest[i], &made[i]);
}

/* The slopes that continue those of steps before, `numbers` a row, of which the
   first `count` stages take part, by the weights of `guess`. */
NEVH__INLINE void nevh__stage_begin_sweeps(const nevh__stage_step *x,
                                           const nevh__stage_changes *c,
                                           size_t lanes, const double *guess,
                                           size_t count, const double past[],
                                           size_t numbers) {
    bool together = lanes == NEVH__STAGES_TOGETHER;
    double *gradient = x->gradient + c->first * x->stride;
    for (size_t k = 0, at = 0; k < c->rows; k++)
        for (size_t from = 0; from < x->stride;
             from += NEVH__IN_VECTOR, at += NEVH__IN_VECTOR) {
            double sign = c->first + k < x->n ? 1 : -1;
            nevh__vector sum = {0};
            if (together)
                nevh__stage_sum_stages(x->row, count, guess, true, NULL,
                                       past + k * numbers, from, &sum);
#ifndef NEVH__FOR_READERS
            else
                nevh__stage_sum_orbits(x->row, count, lanes,
                                       guess + from / lanes,
                                       past + k * numbers + from % lanes, &sum);
#endif
            NEVH__VECTOR_AT(c->before + at) = sign * sum;
            NEVH__VECTOR_AT(gradient + at) = sign * sum;
            NEVH__VECTOR_AT(c->least + at) = (nevh__vector){0} + INFINITY;
        }
}

#ifndef NEVH__FOR_READERS
/* The same of one of NEVH__LANES orbits, which has another past. */
NEVH__INLINE void nevh__stage_begin_lane(const nevh__stage_step *x,
                                         const nevh__stage_changes *c,
                                         size_t lane, const double *guess,
                                         size_t count, const double past[],
                                         size_t numbers) {
    double *gradient = x->gradient + c->first * x->stride;
    for (size_t at = lane; at < c->rows * x->stride; at += NEVH__LANES) {
        size_t k = at / x->stride, stage = at % x->stride / NEVH__LANES;
        double sign = c->first + k < x->n ? 1 : -1;
        c->before[at] = gradient[at] =
            sign * nevh__stage_sum_orbit(x->row, count, NEVH__LANES,
                                         guess + stage,
                                         past + k * numbers + lane);
    }
}
#endif

/* h b_j; the outer two share what the rounded others leave of h. */
NEVH__INLINE void nevh__stage_split(size_t stages, const double b[], double h,
                                    double hb[]) {
    double rest = h;
    for (size_t j = 1; j + 1 < stages; j++) {
        hb[j] = h * b[j];
        rest -= hb[j];
    }
    hb[stages - 1] = rest;
    if (stages == 1)
        return;
    double ends = b[0] + b[stages - 1];
    hb[0] = ends == 0 ? h * b[0] : rest * (b[0] / ends);
    hb[stages - 1] = rest - hb[0];
}

/* sum + rest += h b x; what that loses is below the last bit of the rest. */
NEVH__INLINE void nevh__stage_add(double hb, double slope, double *sum,
                                  double *rest) {
    double x = hb * slope, next = *sum + x;
    *rest += nevh__roundoff(next, *sum, x) + fma(hb, slope, -x);
    *sum = next;
}

/* y += sum_j h b_j x_j and what that loses, of `lanes` (a constant, at most
   NEVH__LANES) orbits: small weights first, which `order` lists. */
NEVH__INLINE void nevh__stage_advance(size_t stages, const size_t order[],
                                      const double hb[], size_t lanes,
                                      size_t width, const double x[],
                                      double sum[], double compensation[]) {
    double total[NEVH__LANES], rest[NEVH__LANES];
    for (size_t i = 0; i < lanes; i++) {
        total[i] = sum[i];
        rest[i] = compensation[i];
    }
    for (const size_t *j = order; j < order + stages; j++)
        for (size_t i = 0; i < lanes; i++)
            nevh__stage_add(hb[*j], x[*j * width + i], &total[i], &rest[i]);
    for (size_t i = 0; i < lanes; i++) {
        sum[i] = total[i] + rest[i];
        compensation[i] = nevh__roundoff(sum[i], total[i], rest[i]);
    }
}

#endif
