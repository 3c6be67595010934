/* nevh: fixed-point sweeps over the stages of one orbit, or of eight, as vectors.

   The lanes of a vector are stages of one orbit or, where there are enough of
   them, orbits at one stage.  In a small system a sweep is a chain of short operations, each of which
   waits for the one before, so what counts is how few they are.  Unknown are
   the derivatives of H, as they are written; signs and weights come in with the
   sums over stages.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "stage_sweeps_private.h"
#include "gradient/field_private.h"
#include "system/vector_private.h"
#include "work/work_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

#ifdef NEVH__HAS_VECTOR

struct nevh__sweeps {
    nevh_work *work;
    size_t n, stages;
    size_t lanes;                  /* orbits: 1, or those of a vector */
    size_t row;                    /* of the tableau: stages, padded */
    size_t stride;                 /* of other rows: stages of all lanes */
    size_t rows;                   /* of the gradient that are solved for */
    size_t unknown;                /* the first of them */
    void *memory;                  /* holds all that follow */
    double *mu_q, *mu_p, *guess;   /* the tableau's */
    double *c, *times;             /* a row */
    double *loaded;                /* of several orbits: what these are for */
    const double *q, *p, *carry;   /* n, n and 2n rows of lanes: the state */
    const double *unit;            /* 2n rows of lanes: |h| over scale */
    double *last;                  /* rows of stages of lanes */
    double *products;              /* a row: h b_j times a slope */
    double *to_q, *to_p;           /* h b_j, - h b_j: vectors of each */
    double *points;                /* 2n rows */
    double *gradient;              /* 2n rows: dH/dp, then dH/dq */
    double *before;                /* rows: as the last sweep left them */
    double *least;                 /* rows: smallest change so far */
    const double *weights;         /* h b_j */
    double h;                      /* for which they were taken over */
    double lowest[NEVH__LANES];    /* change of a sweep so far */
    nevh__call whole, drift, kick; /* where H can be called as it is */
    bool partitioned, prepared;
};

/* States that only fill vectors, and sweeps of orbits that are done, cost
   little where gradients are exact. */
bool nevh__sweeps_suit(const nevh_work *w, size_t stages, size_t lanes) {
    return !w->transform &&
           (nevh__work_lean(w) || (lanes == 1 && stages % NEVH__LANES == 0));
}

static void pad(const nevh__sweeps *s, size_t rows, const double from[],
                double to[]) {
    for (size_t i = 0; i < rows * s->row; i++) {
        size_t stage = i % s->row;
        to[i] = from[i / s->row * s->stages + (stage < s->stages) * stage];
    }
}

static void lay_out(nevh__arena *a, void *sweeps) {
    nevh__sweeps *s = sweeps;
    size_t n = s->n, matrix = s->stages * s->row, lanes = s->lanes;
    size_t vectors = s->stages * NEVH__LANES, all = s->rows * s->stride;
    size_t each = sizeof(double);
    s->mu_q = nevh__arena_take(a, matrix, each);
    s->mu_p = nevh__arena_take(a, matrix, each);
    s->guess = nevh__arena_take(a, matrix, each);
    s->c = nevh__arena_take(a, s->row, each);
    s->times = nevh__arena_take(a, s->stride, each);
    s->to_q = nevh__arena_take(a, vectors, each);
    s->to_p = nevh__arena_take(a, vectors, each);
    s->points = nevh__arena_take(a, 2 * n * s->stride, each);
    s->gradient = nevh__arena_take(a, 2 * n * s->stride, each);
    s->before = nevh__arena_take(a, all, each);
    s->least = nevh__arena_take(a, all, each);
    s->last = nevh__arena_take(a, all, each);
    s->products = nevh__arena_take(a, s->stride, each);
    s->loaded = nevh__arena_take(a, 6 * n * lanes, each);
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

void nevh__sweeps_take(nevh__sweeps *s, const nevh__tableau *a) {
    pad(s, s->stages, a->mu_q, s->mu_q);
    pad(s, s->stages, a->mu_p, s->mu_p);
    pad(s, s->stages, a->guess, s->guess);
    pad(s, 1, a->c, s->c);
}

nevh__sweeps *nevh__sweeps_new(nevh_work *w, const nevh__tableau *a,
                               const double hb[], bool partitioned,
                               size_t lanes) {
    nevh__sweeps *s = nevh__array(1, sizeof *s);
    if (!s)
        return NULL;
    s->work = w;
    s->n = w->n;
    s->stages = a->stages;
    s->lanes = lanes;
    s->row = nevh__padded(a->stages);
    s->stride = nevh__padded(a->stages * lanes);
    s->rows = (partitioned ? 1 : 2) * w->n;
    s->unknown = 2 * w->n - s->rows;
    s->partitioned = partitioned;
    s->weights = hb;
    s->memory = nevh__arena_new(lay_out, s);
    if (!s->memory) {
        nevh__sweeps_free(s);
        return NULL;
    }
    nevh__sweeps_take(s, a);
    find_calls(s);
    return s;
}

void nevh__sweeps_free(nevh__sweeps *s) {
    if (s)
        free(s->memory);
    free(s);
}

/* One vector of a[j] (hb[j] x[j]).  Its lanes are stages, with weights of their
   own and a number of one orbit, or orbits, with the weight of one stage and
   numbers of their own, for which x has the products. */
#define PRODUCT(lanes, a, hb, x, j, row, from)                                 \
    ((lanes) == 1 ? NEVH__VECTOR_AT((a) + (j) * (row) + (from)) *              \
                        (NEVH__VECTOR_AT((hb) + (j)*NEVH__LANES) * (x)[j])     \
                  : (a)[(j) * (row) + (from) / NEVH__LANES] *                  \
                        NEVH__VECTOR_AT((x) + (j)*NEVH__LANES))

/* One vector of the sum over j: even and odd j, which need not wait for each
   other. */
NEVH__INLINE void weigh_up(size_t row, size_t lanes, size_t stages,
                           const double *a, const double *hb, const double x[],
                           size_t from, nevh__vector *sum) {
    nevh__vector even = {0}, odd = {0};
    size_t j = 0;
    NEVH_UNROLL
    for (; j + 1 < stages; j += 2) {
        even += PRODUCT(lanes, a, hb, x, j, row, from);
        odd += PRODUCT(lanes, a, hb, x, j + 1, row, from);
    }
    if (j < stages)
        even += PRODUCT(lanes, a, hb, x, j, row, from);
    *sum = even + odd;
}

/* The same without hb. */
NEVH__INLINE void sum_up(size_t row, size_t lanes, size_t stages,
                         const double *a, const double x[], size_t from,
                         nevh__vector *sum) {
    nevh__vector even = {0}, odd = {0};
    size_t j = 0;
    if (lanes > 1) {
        weigh_up(row, lanes, stages, a, NULL, x, from, sum);
        return;
    }
    for (; j + 1 < stages; j += 2) {
        even += NEVH__VECTOR_AT(a + j * row + from) * x[j];
        odd += NEVH__VECTOR_AT(a + (j + 1) * row + from) * x[j + 1];
    }
    if (j < stages)
        even += NEVH__VECTOR_AT(a + j * row + from) * x[j];
    *sum = even + odd;
}

/* hb[j] x[j] of orbits. */
NEVH__INLINE void multiply(size_t stages, const double *restrict hb,
                           const double *restrict x, double *restrict out) {
    for (size_t j = 0; j < stages * NEVH__LANES; j += NEVH__LANES)
        *(nevh__vector *)(out + j) =
            NEVH__VECTOR_AT(hb + j) * NEVH__VECTOR_AT(x + j);
}

/* The gradient that continues the last slopes. */
NEVH__INLINE void begin(const nevh__sweeps *s, size_t lanes, double t, double h,
                        const double last[]) {
    size_t at = s->unknown * s->stride, numbers = s->stages * lanes;
    for (size_t i = 0; i < s->stride; i++)
        s->times[i] = t + s->c[i / lanes] * h;
    for (size_t k = 0; k < s->rows; k++)
        for (size_t from = 0; from < s->stride; from += NEVH__LANES) {
            double *to = s->before + k * s->stride + from;
            double sign = s->unknown + k < s->n ? 1 : -1;
            nevh__vector sum = {0};
            if (last)
                sum_up(s->row, lanes, s->stages, s->guess, last + k * numbers,
                       from, &sum);
            *(nevh__vector *)to = sign * sum;
            *(nevh__vector *)(to - s->before + s->gradient + at) = sign * sum;
            NEVH_LANES(i, NEVH__LANES) {
                s->least[to - s->before + i] = INFINITY;
            }
        }
}

NEVH_SIMD static void begin_one(const nevh__sweeps *s, double t, double h,
                                const double last[]) {
    begin(s, 1, t, h, last);
}

NEVH_SIMD static void begin_many(const nevh__sweeps *s, double t, double h,
                                 const double last[]) {
    begin(s, NEVH__LANES, t, h, last);
}

static void weigh(nevh__sweeps *s, double h) {
    for (size_t j = 0; j < s->stages * NEVH__LANES; j++) {
        s->to_q[j] = s->weights[j / NEVH__LANES];
        s->to_p[j] = -s->weights[j / NEVH__LANES];
    }
    s->h = h;
}

/* Rows of `count` lanes from `first` on; what is left repeats the first. */
static void load(const nevh__sweeps *s, const nevh__sweep_start *x,
                 const double from[], size_t rows, double to[]) {
    from += x->first;
    for (size_t k = 0; k < rows; k++, from += x->width, to += s->lanes)
        if (x->count == NEVH__LANES)
            memcpy(to, from, NEVH__LANES * sizeof *to);
        else
            for (size_t i = 0; i < s->lanes; i++)
                to[i] = from[i < x->count ? i : 0];
}

/* One orbit is left where it is. */
static void load_state(nevh__sweeps *s, const nevh__sweep_start *x) {
    size_t half = s->n * s->lanes;
    double *to = s->loaded;
    s->q = x->q;
    s->p = x->p;
    s->carry = x->carry;
    s->unit = x->unit;
    if (x->width == 1)
        return;
    load(s, x, x->q, s->n, to);
    load(s, x, x->p, s->n, to + half);
    load(s, x, x->carry, 2 * s->n, to + 2 * half);
    load(s, x, x->unit, 2 * s->n, to + 4 * half);
    s->q = to;
    s->p = to + half;
    s->carry = to + 2 * half;
    s->unit = to + 4 * half;
}

/* The last slopes, 0 where they are of another step; NULL: all are. */
static const double *load_last(const nevh__sweeps *s,
                               const nevh__sweep_start *x) {
    size_t rows = s->rows * s->stages;
    if (x->width == 1)
        return *x->last_h == x->h ? x->last : NULL;
    load(s, x, x->last, rows, s->last);
    for (size_t i = 0; i < s->lanes; i++)
        if (x->last_h[x->first + (i < x->count ? i : 0)] != x->h)
            for (size_t row = 0; row < rows; row++)
                s->last[row * s->lanes + i] = 0;
    return s->last;
}

bool nevh__sweeps_begin(nevh__sweeps *s, const nevh__sweep_start *x) {
    s->prepared = s->partitioned ? nevh__call_ready(&s->drift) &&
                                       nevh__call_ready(&s->kick)
                                 : nevh__call_ready(&s->whole);
    if (s->lanes > 1 && !s->prepared)
        return false;
    if (x->h != s->h)
        weigh(s, x->h);
    for (size_t i = 0; i < s->lanes; i++)
        s->lowest[i] = INFINITY;
    load_state(s, x);
    (s->lanes == 1 ? begin_one : begin_many)(s, x->t, x->h, load_last(s, x));
    return true;
}

/* Stages' states, n rows, from the gradient; velocities too, where these are
   momenta over known masses. */
NEVH__INLINE void place_rows(const nevh__sweeps *s, size_t lanes, size_t stages,
                             size_t row, bool q, const double *inverse) {
    size_t n = s->n, stride = lanes == 1 ? row : stages * lanes;
    size_t half = n * stride;
    const double *restrict mu = q ? s->mu_q : s->mu_p;
    const double *restrict hb = q ? s->to_q : s->to_p;
    const double *restrict slopes = s->gradient + (q ? 0 : half);
    const double *restrict y = q ? s->q : s->p;
    const double *restrict carry = s->carry + (q ? 0 : n * lanes);
    double *restrict points = s->points + (q ? 0 : half);
    double *restrict velocities = s->gradient;
    for (size_t k = 0; k < n; k++) {
        const double *x = lanes == 1 ? slopes + k * stride : s->products;
        if (lanes > 1)
            multiply(stages, hb, slopes + k * stride, s->products);
        for (size_t from = 0; from < stride; from += NEVH__LANES) {
            size_t at = k * stride + from;
            nevh__vector sum, point;
            weigh_up(row, lanes, stages, mu, hb, x, from, &sum);
            if (lanes == 1)
                point = y[k] + (sum + carry[k]);
            else
                point = NEVH__VECTOR_AT(y + k * lanes) +
                        (sum + NEVH__VECTOR_AT(carry + k * lanes));
            *(nevh__vector *)(points + at) = point;
            if (inverse)
                *(nevh__vector *)(velocities + at) =
                    NEVH__VECTOR_AT(inverse + at) * point;
        }
    }
}

NEVH__INLINE void place(const nevh__sweeps *s, size_t lanes, bool q) {
    const double *inverse = q || !s->prepared ? NULL : s->drift.inverse;
    size_t eight = NEVH__LANES;
    if (s->stages == eight)
        place_rows(s, lanes, eight, eight, q, inverse);
    else if (s->row == eight)
        place_rows(s, lanes, s->stages, eight, q, inverse);
    else
        place_rows(s, lanes, s->stages, s->row, q, inverse);
}

/* The gradient as it always is taken, which says what is wrong with it. */
static int ask(const nevh__sweeps *s, bool q, bool p) {
    double *dh_dp = s->gradient, *dh_dq = dh_dp + s->n * s->stride;
    return nevh__work_gradient_padded(s->work, s->stride, s->stages, s->times,
                                      s->points, s->points + s->n * s->stride,
                                      q ? dh_dq : NULL, p ? dh_dp : NULL);
}

/* The gradient, or a half of it; where it is exact and planned, it is not
   looked at yet. */
NEVH__INLINE int take_gradient(const nevh__sweeps *s, const nevh__call *c,
                               bool q, bool p) {
    if (!s->prepared)
        return ask(s, q, p);
    return c->inverse ? NEVH_OK : nevh__work_run(s->work, c);
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

NEVH__INLINE void compare(const nevh__sweeps *s, size_t lanes,
                          comparison *made) {
    const double *restrict now = s->gradient + s->unknown * s->stride;
    double *restrict before = s->before, *restrict least = s->least;
    const double *restrict unit = s->unit + s->unknown * lanes;
    for (size_t k = s->unknown, stride = s->stride; k < 2 * s->n;
         k++, unit += lanes)
        for (size_t from = 0; from < stride; from += NEVH__LANES) {
            NEVH_LANES(i, NEVH__LANES) {
                double one = unit[lanes == 1 ? 0 : i];
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
NEVH__INLINE int find_halves(const nevh__sweeps *s, size_t lanes) {
    place(s, lanes, false);
    int status = take_gradient(s, &s->drift, false, true);
    if (status)
        return status;
    place(s, lanes, true);
    if (s->prepared && !all_finite(s->n * s->stride, s->gradient))
        return lanes == 1 ? ask(s, false, true) : NEVH_EDOM;
    return take_gradient(s, &s->kick, true, false);
}

NEVH__INLINE int find_whole(const nevh__sweeps *s, size_t lanes) {
    place(s, lanes, true);
    place(s, lanes, false);
    return take_gradient(s, &s->whole, true, true);
}

/* What a sweep did to one lane. */
NEVH__INLINE void tell(double all, double better, double most, double *lowest,
                       nevh__stage_progress *made) {
    double change = all < INFINITY ? most : INFINITY, least = *lowest;
    made->moved = all != 0;
    made->change = change;
    made->improved = change < least || better > 0;
    *lowest = change < least ? change : least;
}

NEVH__INLINE int sweep(nevh__sweeps *s, size_t lanes,
                       nevh__stage_progress made[]) {
    comparison found;
    int status = s->partitioned ? find_halves(s, lanes) : find_whole(s, lanes);
    if (status)
        return status;
    NEVH_LANES(i, NEVH__LANES) {
        found.all[i] = found.better[i] = found.most[i] = 0;
    }
    compare(s, lanes, &found);
    if (lanes == 1)
        tell(sum_lanes(found.all), sum_lanes(found.better),
             greatest(found.most), s->lowest, made);
    for (size_t i = 0; lanes > 1 && i < lanes; i++)
        tell(found.all[i], found.better[i], found.most[i], &s->lowest[i],
             &made[i]);
    return NEVH_OK;
}

NEVH_SIMD static int sweep_one(nevh__sweeps *s, nevh__stage_progress made[]) {
    return sweep(s, 1, made);
}

NEVH_SIMD static int sweep_many(nevh__sweeps *s, nevh__stage_progress made[]) {
    return sweep(s, NEVH__LANES, made);
}

int nevh__sweeps_sweep(nevh__sweeps *s, nevh__stage_progress made[]) {
    if (s->lanes > 1)
        return sweep_many(s, made);
    int status = sweep_one(s, made);
    if (!status && !(made->change < INFINITY))
        return ask(s, true, !s->partitioned);
    return status;
}

void nevh__sweeps_count(const nevh__sweeps *s, size_t sweeps) {
    if (s->prepared)
        s->work->field->gradients += sweeps * s->stages;
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

static void fetch_lane(const nevh__sweeps *s, size_t lane, size_t width,
                       double slopes[]) {
    for (size_t k = 0; k < 2 * s->n; k++) {
        double sign = k < s->n ? 1 : -1;
        const double *from = s->gradient + k * s->stride + lane;
        for (size_t i = 0; i < s->stages; i++, slopes += width)
            *slopes = sign * from[i * s->lanes];
    }
}

void nevh__sweeps_fetch(const nevh__sweeps *s, size_t lane, size_t width,
                        double slopes[]) {
    if (width > 1) {
        fetch_lane(s, lane, width, slopes);
        return;
    }
    fetch(s, 0, 1, slopes);
    fetch(s, s->n, -1, slopes);
}

#else

nevh__sweeps *nevh__sweeps_new(nevh_work *w, const nevh__tableau *a,
                               const double hb[], bool partitioned,
                               size_t lanes) {
    (void)w, (void)a, (void)hb, (void)partitioned, (void)lanes;
    return NULL;
}

void nevh__sweeps_free(nevh__sweeps *s) {
    (void)s;
}

bool nevh__sweeps_suit(const nevh_work *w, size_t stages, size_t lanes) {
    (void)w, (void)stages, (void)lanes;
    return false;
}

bool nevh__sweeps_begin(nevh__sweeps *s, const nevh__sweep_start *x) {
    (void)s, (void)x;
    return false;
}

int nevh__sweeps_sweep(nevh__sweeps *s, nevh__stage_progress made[]) {
    (void)s, (void)made;
    return NEVH_EINVAL;
}

void nevh__sweeps_count(const nevh__sweeps *s, size_t sweeps) {
    (void)s, (void)sweeps;
}

void nevh__sweeps_fetch(const nevh__sweeps *s, size_t lane, size_t width,
                        double slopes[]) {
    (void)s, (void)lane, (void)width, (void)slopes;
}

#endif
