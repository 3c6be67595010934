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
    nevh_field *f = w->field;
    x->whole = nevh__lean_call(f, NEVH__LANES, x->time, q, p, dh_dq, dh_dp);
    x->forces = nevh__lean_call(f, NEVH__LANES, x->time, q, p, dh_dq, NULL);
    x->velocities = nevh__lean_call(f, NEVH__LANES, x->time, q, p, NULL, dh_dp);
}

nevh__wide *nevh__wide_ready(nevh_work *w, nevh__wide *x, double *scratch) {
    if (!nevh__work_repeats(w))
        return NULL;
    if (!x->points)
        lay_out(w, x, scratch);
    x->calls =
        nevh__lean_renew(&x->whole) ||
        (nevh__lean_renew(&x->forces) && nevh__lean_renew(&x->velocities));
    return x;
}

/* h times the weighted sum of the slopes, a vector of it. */
NEVH__INLINE void sum_eight(size_t stride, size_t count, const double weights[],
                            const double slopes[], double h, double out[]) {
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
        out[i] = sum[i] * h;
    }
}

NEVH_SIMD static void sum_vectors(size_t stride, size_t count,
                                  const double weights[], const double slopes[],
                                  double h, double sum[]) {
    for (size_t i = 0; i < stride; i += NEVH__LANES)
        sum_eight(stride, count, weights, slopes + i, h, sum + i);
}

void nevh__wide_sum(const nevh__stages *s, size_t count, const double weights[],
                    double sum[]) {
    sum_vectors(s->stride, count, weights, s->slopes, *s->h, sum);
}

NEVH_SIMD static void place_vectors(size_t stride, size_t count,
                                    const double weights[],
                                    const double slopes[], double h,
                                    const double state[], const double carry[],
                                    double point[]) {
    for (size_t from = 0; from < stride; from += NEVH__LANES) {
        double change[NEVH__LANES];
        sum_eight(stride, count, weights, slopes + from, h, change);
        NEVH_LANES(i, NEVH__LANES) {
            point[from + i] = state[from + i] + (change[i] + carry[from + i]);
        }
    }
}

void nevh__wide_place(const nevh__stages *s, size_t stage) {
    const nevh_butcher *table = s->work->integrator->table;
    place_vectors(s->stride, stage, table->a + stage * table->stages, s->slopes,
                  *s->h, s->q, s->carry, s->point);
    *s->time = *s->t + table->c[stage] * *s->h;
}

NEVH_SIMD static void repeat(size_t count, const double from[], double to[]) {
    for (size_t k = 0; k < count; k++, to += NEVH__LANES) {
        double x = from[k];
        NEVH_LANES(lane, NEVH__LANES) {
            to[lane] = x;
        }
    }
}

static bool take(nevh__wide *x, const nevh__call *call, const double *t) {
    if (call->t == x->time)
        repeat(1, t, x->time);
    return nevh__lean_take(call, 1);
}

bool nevh__wide_take(const nevh__stages *s, double slopes[]) {
    nevh__wide *x = s->wide;
    size_t n = s->work->n;
    repeat(2 * n, s->point, x->points);
    if (!x->calls || (x->whole.gradient ? !take(x, &x->whole, s->time)
                                        : !take(x, &x->velocities, s->time) ||
                                              !take(x, &x->forces, s->time)))
        return false;
    const double *dh_dq = x->slopes, *dh_dp = dh_dq + n * NEVH__LANES;
    for (size_t k = 0; k < n; k++) {
        slopes[k] = 0 + dh_dp[k * NEVH__LANES];
        slopes[n + k] = 0 + dh_dq[k * NEVH__LANES];
    }
    return true;
}
