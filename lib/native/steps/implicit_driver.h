/* nevh: steps of Gauss-Legendre methods and Lobatto pairs: slopes at all stages side by
   side, and step after step.

   Where fixed-point iteration does not get on, or anything is not finite, a
   step is left to the kernel, which begins it anew.  The text needs what
   stage_step.h and stage_judge.h do, a scene's kick_slope and drift_slope, sizes (STAGES,
   ROW, FIRST, PAST, APART, STRIDE), tables of the method, and, where
   NEVH__DIFFERENCES is defined, worst_noise.  lib/native hands it to the C
   compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_IMPLICIT_DRIVER_H
#define NEVH_IMPLICIT_DRIVER_H

#include "implicit/stage_judge.h"
#include "kernels/stage_step.h"

/* The memory of the kernel, behind digits that sums have lost: slopes that the
   last PAST steps solved for, their h, of how many steps they are, and for how
   many steps Newton's iteration is to go first. */
enum {
    UNKNOWN = 2 * DOF - FIRST,
    KEPT_STAGES = PAST * STAGES,
    SLOPES_AT = 2 * DOF,
    H_AT = SLOPES_AT + UNKNOWN * KEPT_STAGES,
    STEPS_AT,
    HOLD_AT,
    SWEEPS_AT
};

struct nevh__stage_owner {
    NEVH__COMPILED(const double *N;)
    const double *times;
    nevh__vector *bad;
};

struct nevh__stage_judge_owner {
    NEVH__COMPILED(const double *N;)
    const double *y, *scale;
    double t, h, *level, *bad;
    size_t *noises;
};

/* dH/dp, dH/dq or both at the points of all stages. */
NEVH__INLINE int nevh__stage_slopes(const nevh__stage_step *x, bool q, bool p) {
    const struct nevh__stage_owner *o = x->owner;
    for (size_t from = 0; from < STRIDE; from += NEVH__IN_VECTOR) {
        nevh__vector y[2 * DOF], slope[DOF];
        nevh__vector t = NEVH__VECTOR_AT(o->times + from);
        double *to = x->gradient + from;
        NEVH__EACH(k, 1, DOF) {
            const double *at = x->points + k * STRIDE + from;
            y[k] = NEVH__VECTOR_AT(at);
            y[DOF + k] = NEVH__VECTOR_AT(at + x->half);
        }
        if (p) {
            *o->bad += drift_slope(NEVH__COMPILED(o->N, ) t, y, y + DOF, slope);
            NEVH__EACH(k, 1, DOF) {
                NEVH__VECTOR_AT(to + k * STRIDE) = slope[k];
            }
        }
        if (q) {
            *o->bad += kick_slope(NEVH__COMPILED(o->N, ) t, y, y + DOF, slope);
            NEVH__EACH(k, 1, DOF) {
                NEVH__VECTOR_AT(to + (DOF + k) * STRIDE) = slope[k];
            }
        }
    }
    return 0;
}

#ifndef NEVH__FOR_READERS
NEVH__INLINE const double *nevh__stage_inverse(const nevh__stage_step *x) {
    (void)x;
    return NULL;
}
#endif

#ifdef NEVH__DIFFERENCES
/* The noise of differences in a step, in units of scale; taken once a step. */
NEVH__INLINE double nevh__stage_noise_level(const nevh__stage_judged *x) {
    const struct nevh__stage_judge_owner *o = x->owner;
    if (*o->level < 0) {
        double y[2 * DOF], scale[2 * DOF];
        NEVH__EACH(k, 1, 2 * DOF) {
            y[k] = o->y[k * APART];
            scale[k] = o->scale[k * APART];
        }
        *o->level = fabs(o->h) *
                    worst_noise(NEVH__COMPILED(o->N, ) o->t, y, scale, o->bad);
    }
    ++*o->noises;
    return *o->level;
}
#else
NEVH__INLINE double nevh__stage_noise_level(const nevh__stage_judged *x) {
    (void)x;
    return 0;
}
#endif

NEVH__INLINE bool nevh__stage_is_small(const nevh__stage_judged *x,
                                       double change) {
    return change <= NEVH__STAGE_TINY ||
           (change < INFINITY &&
            change <= NEVH__STAGE_TINY +
                          NEVH__STAGE_MARGIN * nevh__stage_noise_level(x));
}

/* h, h b_j and -h b_j. */
typedef struct {
    double h, plus[STAGES], minus[STAGES];
    double to_q[STAGES * NEVH__LANES], to_p[STAGES * NEVH__LANES];
} step_weights;

/* Arrays of a step, of so many numbers a row of the state. */
typedef struct {
    double points[2 * DOF * STRIDE], gradient[2 * DOF * STRIDE];
    double before[UNKNOWN * STRIDE], least[UNKNOWN * STRIDE];
    double times[STRIDE];
    double unit[2 * DOF * APART], scale[2 * DOF * APART], lowest[APART];
} sweeps_room;

/* y, lost: the state, and digits that sums have lost. */
NEVH__INLINE nevh__stage_step sweeps_of(sweeps_room *r, const step_weights *w,
                                        double *y, const double *lost,
                                        const struct nevh__stage_owner *owner) {
    return (nevh__stage_step){.n = DOF,
                              .stages = STAGES,
                              .row = ROW,
                              .stride = STRIDE,
                              .half = DOF * STRIDE,
                              .partitioned = PARTITIONED,
                              .unchecked = true,
                              .mu_q = mu_q,
                              .mu_p = mu_p,
                              .to_q = w->to_q,
                              .to_p = w->to_p,
                              .q = y,
                              .p = y + DOF * APART,
                              .compensation = lost,
                              .points = r->points,
                              .gradient = r->gradient,
                              .owner = owner};
}

/* A step, the includer's; false: it cannot be taken, and nothing has changed. */
NEVH__INLINE bool
take_step(NEVH__COMPILED(const double *N, ) double t, double *Q, double *P,
          double *M, const step_weights *w NEVH__COMPILED(, size_t *counted));

/* Takes up to `steps` steps of h, the first being number `from`, and returns how
   many of them it could take. */
NEVH__INLINE size_t advance(NEVH__COMPILED(const double *N, ) double t0,
                            double h, size_t from, size_t steps, double *Q,
                            double *P,
                            double *M NEVH__COMPILED(, size_t *counted)) {
    step_weights w;
    size_t done = 0;
    w.h = h;
    nevh__stage_split(STAGES, weights, h, w.plus);
    for (size_t j = 0; j < STAGES; j++) {
        w.minus[j] = -w.plus[j];
        NEVH_LANES(i, NEVH__LANES) {
            w.to_q[j * NEVH__LANES + i] = w.plus[j];
            w.to_p[j * NEVH__LANES + i] = w.minus[j];
        }
    }
    while (done < steps &&
           take_step(NEVH__COMPILED(N, ) t0 + (double)(from + done) * h, Q, P,
                     M, &w NEVH__COMPILED(, counted)))
        done++;
    return done;
}

#endif
