/* nevh: Runge-Kutta stages of one orbit of a small system.

   Sums go over all variables at once, whose rows have room for whole vectors;
   for gradients the stage's state is repeated over a vector, which is the
   least that a block takes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "runge_kutta_private.h"
#include "system/system_private.h"
#include "work_private.h"
#include <nevh/body.h>

size_t nevh__wide_size(const nevh_work *w) {
    return w->width == 1 ? (4 * w->n + 3) * NEVH__LANES : 0;
}

double *nevh__wide_begin(const nevh_work *w) {
    return w->width == 1 ? nevh__aligned(w->scratch) : w->scratch;
}

static void lay_out(nevh_work *w, nevh__wide *x, double *scratch) {
    size_t half = w->n * NEVH__LANES;
    x->points = nevh__aligned(scratch);
    x->slopes = x->points + 2 * half;
    x->time = x->slopes + 2 * half;
    const double *q = x->points, *p = q + half;
    double *dh_dq = x->slopes, *dh_dp = dh_dq + half;
    x->call =
        nevh__call_plan(w->field, NEVH__LANES, x->time, q, p, dh_dq, dh_dp);
}

nevh__wide *nevh__wide_ready(nevh_work *w, nevh__wide *x, double *scratch) {
    if (!nevh__work_repeats(w))
        return NULL;
    if (!x->points)
        lay_out(w, x, scratch);
    x->called = nevh__call_renew(&x->call);
    return x;
}

/* The weighted sum of the slopes, a vector of it. */
NEVH__INLINE void sum_eight(size_t stride, size_t count, const double weights[],
                            const double slopes[], double out[]) {
    double sum[NEVH__LANES];
    NEVH_LANES(i, NEVH__LANES) {
        sum[i] = 0;
    }
    for (size_t j = 0; j < count; j++)
        if (weights[j] != 0)
            NEVH_LANES(i, NEVH__LANES) {
                sum[i] += weights[j] * slopes[j * stride + i];
            }
    NEVH_LANES(i, NEVH__LANES) {
        out[i] = sum[i];
    }
}

NEVH_SIMD static void sum_vectors(size_t stride, size_t count,
                                  const double weights[], const double slopes[],
                                  double h, double sum[]) {
    for (size_t from = 0; from < stride; from += NEVH__LANES) {
        sum_eight(stride, count, weights, slopes + from, sum + from);
        NEVH_LANES(i, NEVH__LANES) {
            sum[from + i] *= h;
        }
    }
}

void nevh__wide_sum(const nevh__stages *s, size_t count, const double weights[],
                    double sum[]) {
    sum_vectors(s->stride, count, weights, s->slopes, *s->h, sum);
}

/* start + (h (sum + weight slope) + carry), rows repeated over vectors. */
NEVH__INLINE void place_rows(size_t count, double h, double weight,
                             const double slopes[], const double sum[],
                             const double start[], const double carry[],
                             double points[]) {
    for (size_t k = 0; k < count; k++)
        NEVH_LANES(i, NEVH__LANES) {
            double slope = slopes[k * NEVH__LANES + i];
            double change = (sum[k] + weight * slope) * h;
            points[k * NEVH__LANES + i] = start[k] + (change + carry[k]);
        }
}

/* The last slopes are taken from where they are repeated, so that nothing waits
   for them until they are there. */
NEVH_SIMD static void place_vectors(const nevh__stages *s, size_t count,
                                    const double weights[], double last) {
    size_t n = s->work->n, half = n * NEVH__LANES;
    double *sum = s->change, *points = s->wide->points;
    const double *dh_dq = s->wide->slopes, *dh_dp = dh_dq + half;
    for (size_t from = 0; from < s->stride; from += NEVH__LANES)
        sum_eight(s->stride, count, weights, s->slopes + from, sum + from);
    place_rows(n, *s->h, last, dh_dp, sum, s->q, s->carry, points);
    place_rows(n, *s->h, -last, dh_dq, sum + n, s->p, s->carry + n,
               points + half);
}

static void place_narrow(const nevh__stages *s, size_t count,
                         const double weights[]) {
    nevh__wide_sum(s, count, weights, s->change);
    for (size_t k = 0; k < 2 * s->work->n; k++)
        s->point[k] = s->q[k] + (s->change[k] + s->carry[k]);
}

NEVH_SIMD static void repeat(size_t count, const double from[], double to[]) {
    for (size_t k = 0; k < count; k++, to += NEVH__LANES) {
        double x = from[k];
        NEVH_LANES(lane, NEVH__LANES) {
            to[lane] = x;
        }
    }
}

void nevh__wide_place(const nevh__stages *s, size_t stage) {
    const nevh_butcher *table = s->work->integrator->table;
    const double *weights = table->a + stage * table->stages;
    nevh__wide *x = s->wide;
    *s->time = *s->t + table->c[stage] * *s->h;
    if (x->fresh && weights[stage - 1] != 0) {
        place_vectors(s, stage - 1, weights, weights[stage - 1]);
        return;
    }
    place_narrow(s, stage, weights);
    if (x->called)
        repeat(2 * s->work->n, s->point, x->points);
}

static bool take(nevh__wide *x, const double *t) {
    if (!x->called)
        return false;
    if (x->call.timed)
        repeat(1, t, x->time);
    return nevh__call_take(&x->call);
}

bool nevh__wide_take(const nevh__stages *s, double slopes[]) {
    nevh__wide *x = s->wide;
    size_t n = s->work->n;
    bool taken = take(x, s->time), rubs = s->work->friction;
    const double *dh_dq = x->slopes, *dh_dp = dh_dq + n * NEVH__LANES;
    for (size_t k = 0; x->fresh && (rubs || !taken) && k < 2 * n; k++)
        s->point[k] = x->points[k * NEVH__LANES];
    for (size_t k = 0; taken && k < n; k++) {
        slopes[k] = 0 + dh_dp[k * NEVH__LANES];
        slopes[n + k] = -(0 + dh_dq[k * NEVH__LANES]);
    }
    x->fresh = taken && !rubs;
    return taken;
}
