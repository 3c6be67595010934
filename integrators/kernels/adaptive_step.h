/* nevh: step control of an explicit method with an estimate of its error, for
   one orbit of any number side by side.

   Every lane goes from t to t + h in substeps of its own.  Step control is that
   of E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential
   Equations I (1993), II.4: with err the estimate over the tolerance, a root
   mean square of components relative to max(|y|, scale),

       next = size * 0.9 err^(-1/k + 3/4 beta) err_last^beta,  beta = 1/(5k),

   where the estimate falls with size^k; between a fifth and six times of size,
   and not above it after a rejection.  Nor above what the last two steps
   predict if the estimate goes on growing as it did between them,

       next = size * 0.9 size/size_last (err_last / err^2)^(1/k)

   [K. Gustafsson, Control-theoretic techniques for stepsize selection in
   implicit Runge-Kutta methods, ACM Trans. Math. Softw. 20 (1994) 496-517]: on
   the way to a pericentre this saves most rejections.  Where H is not finite at
   a trial's stages, the trial is rejected as well.

   The text needs vector_private.h, pace.h and elementary functions.
   lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ADAPTIVE_STEP_H
#define NEVH_ADAPTIVE_STEP_H

#include "system/vector_private.h"
#include "work/pace.h"
#include <nevh/simd.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* A scheme under a tolerance. */
typedef struct {
    size_t size;  /* numbers of a state, 2n */
    double power; /* of the length with which the estimate falls */
    bool coarse;  /* there is a second estimate */
    bool keeps;   /* the last slope of a substep is the first of the next */
    double tolerance;
    double part; /* tolerance^(1/power) / 2 */
    const double *scale;
} nevh__adaptive_rule;

/* Lengths are without sign: done and size go from t towards t + h. */
typedef struct {
    double done;
    double size;    /* of the next substep; 0: not known */
    double step;    /* under trial: size, or what is left */
    double last;    /* err of the last accepted one; 0: there is none */
    double before;  /* its length */
    double excess;  /* substeps beyond the usual of the steps before */
    bool has_first; /* the slope at the state is known */
    bool held;      /* the last trial was rejected */
    bool ends;      /* this one ends the step */
    nevh__pace pace;
} nevh__substeps;

/* A careful first length, without sign: a part of the time in which y, its
   numbers `stride` apart, changes by max(|y|, scale). */
NEVH__INLINE double nevh__substeps_first(const nevh__adaptive_rule *x, double h,
                                         size_t stride, const double y[],
                                         const double slopes[]) {
    double sum = 0;
    for (size_t i = 0; i < x->size; i++) {
        double rate =
            slopes[i * stride] / fmax(fabs(y[i * stride]), x->scale[i]);
        sum += rate * rate;
    }
    double size = x->part / sqrt(sum / (double)x->size);
    return size < INFINITY ? size : fabs(h);
}

/* The root mean square of estimates over max(|y|, scale), squared; numbers of
   states are `stride` apart. */
NEVH__INLINE double nevh__substeps_square(const nevh__adaptive_rule *x,
                                          size_t stride,
                                          const double estimate[],
                                          const double old[],
                                          const double next[]) {
    double sum = 0;
    for (size_t k = 0; k < x->size; k++) {
        size_t i = k * stride;
        double most = fmax(fabs(old[i]), fabs(next[i]));
        double part = estimate[i] / fmax(most, x->scale[k]);
        sum += part * part;
    }
    return sum / (double)x->size;
}

/* The estimate over the tolerance; NaN where it is beyond numbers. */
NEVH__INLINE double nevh__substeps_judge(const nevh__adaptive_rule *x,
                                         size_t stride, const double error[],
                                         const double coarse[],
                                         const double old[],
                                         const double next[]) {
    double square = nevh__substeps_square(x, stride, error, old, next);
    double all = square;
    if (x->coarse)
        all += 0.01 * nevh__substeps_square(x, stride, coarse, old, next);
    double err = x->coarse && all > 0 ? square / sqrt(all) : sqrt(square);
    return err / x->tolerance;
}

NEVH__INLINE bool nevh__substeps_too_short(const nevh__substeps *l, double h) {
    return !(l->size > 0x1p-52 * fabs(h)) && l->size < fabs(h);
}

/* The factor by which the next substep may be longer.  Before the first one
   err_last is the least that is remembered, 1e-4; its logarithm is written out. */
NEVH__INLINE double nevh__substeps_factor(const nevh__adaptive_rule *x,
                                          const nevh__substeps *l, double err) {
    double k = x->power, beta = 0.2 / k, now = nevh_simd_log(err);
    double last = l->last > 0 ? nevh_simd_log(l->last) : -0x1.26bb1bbb55516p+3;
    double usual = (0.75 * beta - 1 / k) * now + beta * last;
    if (!(l->last > 0))
        return 0.9 * nevh_simd_exp(usual);
    double growing = nevh_simd_log(l->step / l->before) + (last - 2 * now) / k;
    return 0.9 * nevh_simd_exp(fmin(usual, growing));
}

/* Near the end of an orbit the times themselves may be too coarse for a shorter
   substep: it would be rejected for ever.  Returns whether there is one. */
NEVH__INLINE bool nevh__substeps_reject(const nevh__adaptive_rule *x,
                                        nevh__substeps *l, double h,
                                        double err) {
    double wanted = 0.9 * nevh_simd_pow(err, -1. / x->power);
    l->size = l->step * (wanted > 0.2 ? fmin(wanted, 0.9) : 0.2);
    l->held = true;
    bool shorter = l->done + l->size < l->done + l->step;
    return shorter && !nevh__substeps_too_short(l, h);
}

/* The same where H is not finite. */
NEVH__INLINE bool nevh__substeps_retreat(nevh__substeps *l, double h) {
    l->size = 0.2 * l->step;
    l->held = true;
    return !nevh__substeps_too_short(l, h);
}

/* A substep cut short by the end of the step says nothing against longer
   ones. */
NEVH__INLINE void nevh__substeps_accept(const nevh__adaptive_rule *x,
                                        nevh__substeps *l, double h,
                                        double err) {
    double next = nevh__substeps_factor(x, l, err);
    next = l->step * fmin(fmax(next, 0.2), l->held ? 1 : 6);
    l->size = l->ends ? fmax(next, l->size) : next;
    l->done = l->ends ? fabs(h) : l->done + l->step;
    l->last = fmax(err, 1e-4);
    l->before = l->step;
    l->held = false;
    l->has_first = x->keeps;
}

/* The next substep; the last one may stretch by a hundredth. */
NEVH__INLINE void nevh__substeps_choose(nevh__substeps *l, double h) {
    double left = fabs(h) - l->done;
    double next = l->done + l->size; /* so that the sum of steps is exact */
    l->ends = 1.01 * l->size >= left;
    l->step = l->ends ? left : next - l->done;
}

/* True if this step and those before it took too many substeps. */
NEVH__INLINE bool nevh__substeps_exceed(const nevh__substeps *l) {
    return l->excess + l->pace.substeps > NEVH__MOST_SUBSTEPS;
}

/* The excess of substeps for the next step: a single step may take
   NEVH__MOST_SUBSTEPS, one after another may not. */
NEVH__INLINE double nevh__substeps_excess(const nevh__substeps *l) {
    return fmax(0, l->excess + l->pace.substeps - 1e5);
}

#endif
