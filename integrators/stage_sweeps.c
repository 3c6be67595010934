/* nevh: fixed-point sweeps over the stages of one orbit, as vectors.

   In a small system a sweep is a chain of short operations, each of which
   waits for the one before, so what counts is how few they are.  Unknown are
   the derivatives of H, as they are written; signs and weights come in with the
   sums over stages.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "stage_sweeps_private.h"
#include "gradient/field_private.h"
#include "system/vector_private.h"
#include "work_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

#ifdef NEVH__HAS_VECTOR

struct nevh__sweeps {
    nevh_work *work;
    size_t n, stages, stride;
    size_t rows;                   /* of the gradient that are solved for */
    size_t unknown;                /* the first of them */
    double *room;                  /* holds all that follow */
    double *mu_q, *mu_p, *guess;   /* the tableau's */
    double *c, *times;             /* a row */
    double *to_q, *to_p;           /* h b_j, - h b_j: vectors of each */
    double *points;                /* 2n rows */
    double *gradient;              /* 2n rows: dH/dp, then dH/dq */
    double *before;                /* rows: as the last sweep left them */
    double *least;                 /* rows: smallest change so far */
    const double *weights;         /* h b_j */
    double h;                      /* for which they were taken over */
    double lowest;                 /* change of a sweep so far */
    const double *q, *p, *carry;   /* of the step */
    nevh__call whole, drift, kick; /* where H can be called as it is */
    bool partitioned, prepared;
};

bool nevh__sweeps_suit(const nevh_work *w, size_t stages) {
    return w->width == 1 && !w->transform &&
           (nevh__work_lean(w) || stages % NEVH__LANES == 0);
}

static void pad(const nevh__sweeps *s, size_t rows, const double from[],
                double to[]) {
    for (size_t i = 0; i < rows * s->stride; i++) {
        size_t stage = i % s->stride;
        to[i] = from[i / s->stride * s->stages + (stage < s->stages) * stage];
    }
}

static bool lay_out(nevh__sweeps *s) {
    size_t n = s->n, row = s->stride, matrix = s->stages * row;
    size_t vectors = s->stages * NEVH__LANES;
    size_t all =
        3 * matrix + 2 * row + 2 * vectors + (4 * n + 2 * s->rows) * row;
    s->room = nevh__array(all + NEVH__LANES, sizeof *s->room);
    if (!s->room)
        return false;
    double *from = nevh__aligned(s->room);
    s->mu_q = nevh__take(&from, matrix);
    s->mu_p = nevh__take(&from, matrix);
    s->guess = nevh__take(&from, matrix);
    s->c = nevh__take(&from, row);
    s->times = nevh__take(&from, row);
    s->to_q = nevh__take(&from, vectors);
    s->to_p = nevh__take(&from, vectors);
    s->points = nevh__take(&from, 2 * n * row);
    s->gradient = nevh__take(&from, 2 * n * row);
    s->before = nevh__take(&from, s->rows * row);
    s->least = from;
    return true;
}

static void find_calls(nevh__sweeps *s) {
    nevh_field *f = s->work->field;
    size_t half = s->n * s->stride;
    const double *q = s->points, *p = q + half;
    double *dh_dp = s->gradient, *dh_dq = dh_dp + half;
    if (s->partitioned) {
        s->drift = nevh__call_plan(f, s->stride, s->times, q, p, NULL, dh_dp);
        s->kick = nevh__call_plan(f, s->stride, s->times, q, p, dh_dq, NULL);
    } else
        s->whole = nevh__call_plan(f, s->stride, s->times, q, p, dh_dq, dh_dp);
}

nevh__sweeps *nevh__sweeps_new(nevh_work *w, const nevh__tableau *a,
                               const double hb[], bool partitioned) {
    nevh__sweeps *s = nevh__array(1, sizeof *s);
    if (!s)
        return NULL;
    s->work = w;
    s->n = w->n;
    s->stages = a->stages;
    s->stride = nevh__padded(a->stages);
    s->rows = (partitioned ? 1 : 2) * w->n;
    s->unknown = 2 * w->n - s->rows;
    s->partitioned = partitioned;
    s->weights = hb;
    if (!lay_out(s)) {
        nevh__sweeps_free(s);
        return NULL;
    }
    pad(s, s->stages, a->mu_q, s->mu_q);
    pad(s, s->stages, a->mu_p, s->mu_p);
    pad(s, s->stages, a->guess, s->guess);
    pad(s, 1, a->c, s->c);
    find_calls(s);
    return s;
}

void nevh__sweeps_free(nevh__sweeps *s) {
    if (s)
        free(s->room);
    free(s);
}

/* One vector of stages, sum_j weights[j * stride] x[j]: those with even j and
   those with odd j, which need not wait for each other. */
NEVH__INLINE void sum_up(size_t stages, size_t stride, const double weights[],
                         const double x[], nevh__vector *sum) {
    nevh__vector even = {0}, odd = {0};
    size_t j = 0;
    for (; j + 1 < stages; j += 2) {
        even += *(const nevh__vector *)(weights + j * stride) * x[j];
        odd += *(const nevh__vector *)(weights + (j + 1) * stride) * x[j + 1];
    }
    if (j < stages)
        even += *(const nevh__vector *)(weights + j * stride) * x[j];
    *sum = even + odd;
}

/* The gradient that continues the last slopes. */
NEVH_SIMD static void begin(const nevh__sweeps *s, double t, double h,
                            const double last[]) {
    size_t at = s->unknown * s->stride;
    NEVH_LANES(i, s->stride) {
        s->times[i] = t + s->c[i] * h;
    }
    for (size_t k = 0; k < s->rows; k++)
        for (size_t from = 0; from < s->stride; from += NEVH__LANES) {
            double *to = s->before + k * s->stride + from;
            double sign = s->unknown + k < s->n ? 1 : -1;
            nevh__vector sum = {0};
            if (last)
                sum_up(s->stages, s->stride, s->guess + from,
                       last + k * s->stages, &sum);
            *(nevh__vector *)to = sign * sum;
            *(nevh__vector *)(to - s->before + s->gradient + at) = sign * sum;
            NEVH_LANES(i, NEVH__LANES) {
                s->least[to - s->before + i] = INFINITY;
            }
        }
}

static void weigh(nevh__sweeps *s, double h) {
    for (size_t j = 0; j < s->stages * NEVH__LANES; j++) {
        s->to_q[j] = s->weights[j / NEVH__LANES];
        s->to_p[j] = -s->weights[j / NEVH__LANES];
    }
    s->h = h;
}

void nevh__sweeps_begin(nevh__sweeps *s, double t, double h, const double q[],
                        const double p[], const double carry[],
                        const double last[]) {
    if (h != s->h)
        weigh(s, h);
    s->lowest = INFINITY;
    s->q = q;
    s->p = p;
    s->carry = carry;
    begin(s, t, h, last);
    s->prepared = s->partitioned ? nevh__call_renew(&s->drift) &&
                                       nevh__call_renew(&s->kick)
                                 : nevh__call_renew(&s->whole);
}

/* sum_j mu[j * stride] (hb[j] slopes[j]), the same way. */
NEVH__INLINE void weigh_up(size_t stages, size_t stride, const double mu[],
                           const double hb[], const double slopes[],
                           nevh__vector *sum) {
    nevh__vector even = {0}, odd = {0};
    const nevh__vector *weights = (const nevh__vector *)hb;
    size_t j = 0;
    NEVH_UNROLL
    for (; j + 1 < stages; j += 2) {
        even +=
            *(const nevh__vector *)(mu + j * stride) * (weights[j] * slopes[j]);
        odd += *(const nevh__vector *)(mu + (j + 1) * stride) *
               (weights[j + 1] * slopes[j + 1]);
    }
    if (j < stages)
        even +=
            *(const nevh__vector *)(mu + j * stride) * (weights[j] * slopes[j]);
    *sum = even + odd;
}

/* Stages' states, n rows, from the gradient; velocities too, where these are
   momenta over known masses. */
NEVH__INLINE void
place_rows(size_t n, size_t stages, size_t stride, const double *restrict mu,
           const double *restrict hb, const double *restrict gradient,
           const double y[], const double carry[], double *restrict points,
           const double *inverse, double *restrict velocities) {
    for (size_t k = 0; k < n; k++)
        for (size_t from = 0; from < stride; from += NEVH__LANES) {
            size_t at = k * stride + from;
            nevh__vector sum;
            weigh_up(stages, stride, mu + from, hb, gradient + k * stride,
                     &sum);
            nevh__vector point = y[k] + (sum + carry[k]);
            *(nevh__vector *)(points + at) = point;
            if (inverse)
                *(nevh__vector *)(velocities + at) =
                    *(const nevh__vector *)(inverse + at) * point;
        }
}

NEVH__INLINE void place(const nevh__sweeps *s, bool q) {
    size_t n = s->n, half = n * s->stride, eight = NEVH__LANES;
    const double *mu = q ? s->mu_q : s->mu_p, *hb = q ? s->to_q : s->to_p;
    const double *slopes = s->gradient + (q ? 0 : half);
    const double *y = q ? s->q : s->p, *carry = s->carry + (q ? 0 : n);
    double *points = s->points + (q ? 0 : half);
    const double *inverse = q || !s->prepared ? NULL : s->drift.inverse;
    if (s->stages == eight)
        place_rows(n, eight, eight, mu, hb, slopes, y, carry, points, inverse,
                   s->gradient);
    else
        place_rows(n, s->stages, s->stride, mu, hb, slopes, y, carry, points,
                   inverse, s->gradient);
}

/* The gradient as it always is taken, which says what is wrong with it. */
static int ask(const nevh__sweeps *s, bool q, bool p) {
    double *dh_dp = s->gradient, *dh_dq = dh_dp + s->n * s->stride;
    return nevh__work_gradient(s->work, s->stride, s->stages, s->times,
                               s->points, s->points + s->n * s->stride,
                               q ? dh_dq : NULL, p ? dh_dp : NULL);
}

/* The gradient, or a half of it; where H can be called as it is, it is not
   looked at yet. */
NEVH__INLINE int take_gradient(const nevh__sweeps *s, const nevh__call *c,
                               bool q, bool p) {
    if (!s->prepared)
        return ask(s, q, p);
    if (!c->inverse)
        nevh__call_run(c);
    return NEVH_OK;
}

NEVH__INLINE double sum_lanes(const double x[]) {
    return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

NEVH__INLINE double greater(double x, double y) {
    return x > y ? x : y;
}

NEVH__INLINE double greatest(const double x[]) {
    return greater(greater(greater(x[0], x[1]), greater(x[2], x[3])),
                   greater(greater(x[4], x[5]), greater(x[6], x[7])));
}

NEVH__INLINE bool all_finite(size_t size, const double x[]) {
    double bad[NEVH__LANES];
    NEVH_LANES(i, NEVH__LANES) {
        bad[i] = 0;
    }
    for (size_t from = 0; from < size; from += NEVH__LANES)
        NEVH_LANES(i, NEVH__LANES) {
            bad[i] += x[from + i] - x[from + i];
        }
    return sum_lanes(bad) == 0;
}

/* How this sweep differs from the last, of the lanes of all vectors. */
typedef struct {
    double all[NEVH__LANES];    /* sum of changes: 0: none; finite or not */
    double better[NEVH__LANES]; /* sum of those that are smaller than ever */
    double most[NEVH__LANES];   /* the largest, in units of scale */
} comparison;

NEVH__INLINE void compare(const nevh__sweeps *s, const double unit[],
                          comparison *made) {
    const double *restrict now = s->gradient + s->unknown * s->stride;
    double *restrict before = s->before, *restrict least = s->least;
    for (size_t k = s->unknown; k < 2 * s->n; k++)
        for (size_t from = 0; from < s->stride; from += NEVH__LANES) {
            double one = unit[k];
            NEVH_LANES(i, NEVH__LANES) {
                double change = fabs(now[i] - before[i]), part = change * one;
                double bar = least[i], gain = change < bar ? change : 0;
                before[i] = now[i];
                least[i] = gain > 0 ? gain : bar;
                made->all[i] += change;
                made->better[i] += gain;
                made->most[i] = made->most[i] > part ? made->most[i] : part;
            }
            now += NEVH__LANES;
            before += NEVH__LANES;
            least += NEVH__LANES;
        }
}

/* Slopes of momenta alone are solved for: those of coordinates follow. */
NEVH__INLINE int find_halves(const nevh__sweeps *s) {
    place(s, false);
    int status = take_gradient(s, &s->drift, false, true);
    if (status)
        return status;
    place(s, true);
    if (s->prepared && !all_finite(s->n * s->stride, s->gradient))
        return ask(s, false, true);
    return take_gradient(s, &s->kick, true, false);
}

NEVH__INLINE int find_whole(const nevh__sweeps *s) {
    place(s, true);
    place(s, false);
    return take_gradient(s, &s->whole, true, true);
}

NEVH_SIMD static int sweep(nevh__sweeps *s, const double unit[],
                           nevh__stage_progress *made) {
    comparison found;
    int status = s->partitioned ? find_halves(s) : find_whole(s);
    if (status)
        return status;
    NEVH_LANES(i, NEVH__LANES) {
        found.all[i] = found.better[i] = found.most[i] = 0;
    }
    compare(s, unit, &found);
    double all = sum_lanes(found.all);
    made->moved = all != 0;
    made->change = all < INFINITY ? greatest(found.most) : INFINITY;
    made->improved = made->change < s->lowest || sum_lanes(found.better) > 0;
    s->lowest = made->change < s->lowest ? made->change : s->lowest;
    return NEVH_OK;
}

int nevh__sweeps_sweep(void *sweeps, const double unit[],
                       nevh__stage_progress *made) {
    nevh__sweeps *s = sweeps;
    int status = sweep(s, unit, made);
    if (!status && !(made->change < INFINITY))
        return ask(s, true, !s->partitioned);
    if (!status && s->prepared)
        s->work->field->gradients += s->stages;
    return status;
}

/* Rows without what is behind the stages. */
NEVH_SIMD static void fetch(const nevh__sweeps *s, size_t first, double sign,
                            double slopes[]) {
    const double *from = s->gradient + first * s->stride;
    double *to = slopes + first * s->stages;
    if (s->stages == s->stride)
        NEVH_LANES(i, s->n * s->stages) {
            to[i] = sign * from[i];
        }
    else
        for (size_t k = 0; k < s->n; k++, from += s->stride, to += s->stages)
            for (size_t i = 0; i < s->stages; i++)
                to[i] = sign * from[i];
}

void nevh__sweeps_fetch(const nevh__sweeps *s, double slopes[]) {
    fetch(s, 0, 1, slopes);
    fetch(s, s->n, -1, slopes);
}

#else

bool nevh__sweeps_suit(const nevh_work *w, size_t stages) {
    (void)w, (void)stages;
    return false;
}

nevh__sweeps *nevh__sweeps_new(nevh_work *w, const nevh__tableau *a,
                               const double hb[], bool partitioned) {
    (void)w, (void)a, (void)hb, (void)partitioned;
    return NULL;
}

void nevh__sweeps_free(nevh__sweeps *s) {
    (void)s;
}

void nevh__sweeps_begin(nevh__sweeps *s, double t, double h, const double q[],
                        const double p[], const double carry[],
                        const double last[]) {
    (void)s, (void)t, (void)h, (void)q, (void)p, (void)carry, (void)last;
}

int nevh__sweeps_sweep(void *sweeps, const double unit[],
                       nevh__stage_progress *made) {
    (void)sweeps, (void)unit, (void)made;
    return NEVH_EINVAL;
}

void nevh__sweeps_fetch(const nevh__sweeps *s, double slopes[]) {
    (void)s, (void)slopes;
}

#endif
