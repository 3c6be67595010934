/* nevh: sweeps over the stages of one orbit, of eight, or of any number.

   In a small system a sweep is a chain of short operations, each of which waits
   for the one before, so what counts is how few they are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "stage_sweeps_private.h"
#include "gradient/field_private.h"
#include "stage_step.h"
#include "work/work_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

struct nevh__stage_owner {
    nevh__stage_step x;
    nevh__stage_changes changes;
    nevh_work *work;
    const nevh__stage_weights *weights;
    nevh__swept kind;
    size_t lanes;               /* of a row: most orbits */
    size_t used;                /* points that count in an evaluation */
    void *memory;               /* holds all that follow */
    double *times;              /* a row */
    double *loaded;             /* of several orbits: their state */
    double *past;               /* rows of steps of stages of lanes */
    double lowest[NEVH__LANES]; /* change of a sweep so far */
    size_t chosen[NEVH__LANES]; /* of several: whose constants points have */
    nevh__evaluation whole, drift, kick; /* the gradient, or its halves */
    bool from_values;                    /* so it is, of any orbits */
};

void nevh__stage_weights_set(nevh__stage_weights *w, const nevh__tableau *a,
                             double h) {
    size_t s = w->stages;
    if (h == w->h)
        return;
    nevh__stage_split(s, a->b, h, w->hb);
    for (size_t j = 0; j < s * NEVH__LANES; j++) {
        w->to_q[j] = w->hb[j / NEVH__LANES];
        w->to_p[j] = -w->hb[j / NEVH__LANES];
    }
    w->h = h;
}

/* Stages that take part, and their weights. */
static size_t past_stages(const nevh__stage_weights *w, double steps,
                          const double **guess) {
    bool all = steps >= (double)w->steps;
    *guess = all ? w->long_guess : w->guess;
    return all ? w->steps * w->stages : steps > 0 ? w->stages : 0;
}

double nevh__stage_continue(const nevh__stage_weights *w, size_t i,
                            size_t width, double steps, const double past[]) {
    const double *guess;
    size_t count = past_stages(w, steps, &guess);
    return nevh__stage_sum_orbit(w->row, count, width, guess + i, past);
}

static void lay_out(nevh__arena *a, void *sweeps) {
    nevh__sweeps *s = sweeps;
    nevh__stage_step *x = &s->x;
    size_t each = sizeof(double), lanes = s->lanes;
    size_t all = s->kind == NEVH__ORBITS ? 0 : s->changes.rows * x->stride;
    s->times = nevh__arena_take(a, x->stride, each);
    x->half = x->n * x->stride + NEVH__LANES; /* a last row may be longer */
    x->points = nevh__arena_take(a, 2 * x->half, each);
    x->gradient = nevh__arena_take(a, 2 * x->n * x->stride, each);
    s->changes.before = nevh__arena_take(a, all, each);
    s->changes.least = nevh__arena_take(a, all, each);
    s->past = nevh__arena_take(
        a, lanes > 1 || s->work->width > 1 ? s->weights->steps * all : 0, each);
    x->products = nevh__arena_take(a, x->stride, each);
    s->loaded = nevh__arena_take(a, 6 * x->n * lanes, each);
}

static void plan_gradients(nevh__sweeps *s) {
    const nevh__stage_step *x = &s->x;
    size_t half = x->n * x->stride, width = x->stride;
    const double *q = x->points, *p = q + x->half, *t = s->times;
    double *dh_dp = x->gradient, *dh_dq = dh_dp + half;
    if (x->partitioned) {
        s->drift = nevh__work_plan(s->work, width, t, q, p, NULL, dh_dp);
        s->kick = nevh__work_plan(s->work, width, t, q, p, dh_dq, NULL);
    } else
        s->whole = nevh__work_plan(s->work, width, t, q, p, dh_dq, dh_dp);
    bool planned =
        s->x.partitioned ? s->drift.count && s->kick.count : s->whole.count > 0;
    s->x.unchecked = planned && s->kind != NEVH__ORBITS;
    s->from_values = planned && !s->whole.exact && !s->kick.exact;
}

static size_t lanes_of(const nevh_work *w, nevh__swept kind) {
    return kind == NEVH__ORBITS         ? w->width
           : kind == NEVH__EIGHT_ORBITS ? NEVH__LANES
                                        : 1;
}

bool nevh__sweeps_suit(const nevh_work *w, size_t stages, nevh__swept kind) {
    return nevh__work_row(w, stages * lanes_of(w, kind));
}

nevh__sweeps *nevh__sweeps_new(nevh_work *w, const nevh__stage_weights *a,
                               bool partitioned, nevh__swept kind) {
    nevh__sweeps *s = nevh__array(1, sizeof *s);
    if (!s)
        return NULL;
    s->work = w;
    s->weights = a;
    s->kind = kind;
    s->lanes = lanes_of(w, kind);
    s->used = a->stages;
    s->x = (nevh__stage_step){.n = w->n,
                              .stages = a->stages,
                              .row = a->row,
                              .partitioned = partitioned,
                              .mu_q = a->mu_q,
                              .mu_p = a->mu_p,
                              .to_q = a->to_q,
                              .to_p = a->to_p,
                              .owner = s};
    s->x.stride = a->stages * s->lanes;
    if (kind != NEVH__ORBITS)
        s->x.stride = nevh__padded(s->x.stride);
    s->changes.rows = (partitioned ? 1 : 2) * w->n;
    s->changes.first = 2 * w->n - s->changes.rows;
    s->memory = nevh__arena_new(lay_out, s);
    if (!s->memory) {
        nevh__sweeps_free(s);
        return NULL;
    }
    s->changes.lowest = s->lowest;
    if (kind != NEVH__ORBITS || w->width == 1)
        plan_gradients(s);
    return s;
}

void nevh__sweeps_free(nevh__sweeps *s) {
    if (s)
        free(s->memory);
    free(s);
}

/* The gradient as it always is taken, which says what is wrong with it. */
static int ask(const nevh__sweeps *s, bool q, bool p) {
    const nevh__stage_step *x = &s->x;
    double *dh_dp = x->gradient, *dh_dq = dh_dp + x->n * x->stride;
    return nevh__work_gradient_padded(
        s->work, s->used,
        &(nevh__places){x->stride, s->times, x->points, x->points + x->half,
                        q ? dh_dq : NULL, p ? dh_dp : NULL});
}

/* An exact, planned gradient is not checked yet. */
NEVH__INLINE int nevh__stage_slopes(const nevh__stage_step *x, bool q, bool p) {
    const nevh__sweeps *s = x->owner;
    const nevh__evaluation *e = q && p ? &s->whole : q ? &s->kick : &s->drift;
    if (x->unchecked)
        return e->inverse ? NEVH_OK : nevh__work_run(s->work, e);
    if (!s->from_values)
        return ask(s, q, p);
    s->work->field->gradients += q ? s->used : 0;
    return nevh__work_run_values(s->work, e);
}

NEVH__INLINE const double *nevh__stage_inverse(const nevh__stage_step *x) {
    return x->unchecked ? x->owner->drift.inverse : NULL;
}

/* The gradient that continues the slopes of so many steps. */
NEVH__INLINE void begin(nevh__sweeps *s, size_t lanes, double t, double h,
                        double steps, const double past[]) {
    const nevh__stage_step *x = &s->x;
    const nevh__stage_weights *w = s->weights;
    size_t columns = lanes == NEVH__STAGES_TOGETHER ? 1 : lanes;
    const double *guess;
    size_t count = past_stages(w, steps, &guess);
    for (size_t i = 0; i < x->stride; i++)
        s->times[i] = t + w->c[i / columns] * h;
    nevh__stage_begin_sweeps(x, &s->changes, lanes, guess, count, past,
                             w->steps * x->stages * columns);
}

NEVH_SIMD static void begin_one(nevh__sweeps *s, double t, double h,
                                double steps, const double past[]) {
    begin(s, NEVH__STAGES_TOGETHER, t, h, steps, past);
}

NEVH_SIMD static void begin_eight(nevh__sweeps *s, double t, double h,
                                  double steps, const double past[]) {
    begin(s, NEVH__LANES, t, h, steps, past);
}

/* Points are those of `count` lanes; what is left repeats the first. */
static void choose(nevh__sweeps *s, const nevh__sweep_start *x, size_t count) {
    nevh_field *f = s->work->field;
    if (!f->lanes)
        return;
    for (size_t i = 0; s->kind == NEVH__EIGHT_ORBITS && i < count; i++)
        s->chosen[i] = x->lanes[i < x->count ? i : 0];
    nevh__field_choose(f, count,
                       s->kind == NEVH__EIGHT_ORBITS ? s->chosen : x->lanes);
    nevh__evaluation_refresh(&s->whole);
    nevh__evaluation_refresh(&s->drift);
    nevh__evaluation_refresh(&s->kick);
}

/* Rows of `count` lanes; what is left repeats the first. */
static void load(const nevh__sweep_start *x, size_t lanes, const double from[],
                 size_t rows, double to[]) {
    bool vector = x->count == NEVH__LANES && lanes == NEVH__LANES &&
                  x->lanes[x->count - 1] == x->lanes[0] + x->count - 1;
    for (size_t k = 0; k < rows; k++, from += x->width, to += lanes)
        if (vector)
            memcpy(to, from + x->lanes[0], NEVH__LANES * sizeof *to);
        else
            for (size_t i = 0; i < lanes; i++)
                to[i] = from[x->lanes[i < x->count ? i : 0]];
}

/* One orbit is left where it is. */
static void load_state(nevh__sweeps *s, const nevh__sweep_start *x,
                       size_t lanes) {
    size_t n = s->x.n, half = n * lanes;
    double *to = s->loaded;
    s->x.q = x->q;
    s->x.p = x->p;
    s->x.compensation = x->compensation;
    s->changes.unit = x->unit;
    choose(s, x, lanes);
    if (x->width == 1)
        return;
    load(x, lanes, x->q, n, to);
    load(x, lanes, x->p, n, to + half);
    load(x, lanes, x->compensation, 2 * n, to + 2 * half);
    s->x.q = to;
    s->x.p = to + half;
    s->x.compensation = to + 2 * half;
    if (!x->unit)
        return;
    load(x, lanes, x->unit, 2 * n, to + 4 * half);
    s->changes.unit = to + 4 * half;
}

/* The number of steps by h whose derivatives the orbit remembers. */
static double steps_of(const nevh__sweep_start *x, size_t i) {
    size_t lane = x->lanes[i < x->count ? i : 0];
    return x->past_h[lane] == x->h ? x->steps[lane] : 0;
}

bool nevh__sweeps_begin(nevh__sweeps *s, const nevh__sweep_start *x) {
    size_t rows = s->changes.rows * s->weights->steps * s->x.stages;
    double steps = steps_of(x, 0);
    if (s->lanes > 1 && !s->x.unchecked)
        return false;
    for (size_t i = 0; i < s->lanes; i++)
        s->lowest[i] = INFINITY;
    load_state(s, x, s->lanes);
    if (x->width > 1)
        load(x, s->lanes, x->past, rows, s->past);
    (s->lanes == 1 ? begin_one : begin_eight)(s, x->t, x->h, steps,
                                              x->width > 1 ? s->past : x->past);
    for (size_t i = 1; i < s->lanes; i++) {
        double own = steps_of(x, i);
        const double *guess;
        size_t count = past_stages(s->weights, own, &guess);
        if (own != steps)
            nevh__stage_begin_lane(&s->x, &s->changes, i, guess, count, s->past,
                                   s->weights->steps * s->x.stride);
    }
    return true;
}

/* A row of a lane's stages; what is behind them repeats the first. */
static void pick(const nevh__sweeps *s, size_t rows, const double from[],
                 size_t lane, size_t apart, double to[]) {
    size_t stages = s->x.stages;
    for (size_t k = 0; k < rows; k++, from += stages * apart)
        for (size_t i = 0; i < s->x.stride; i++)
            *to++ = from[(i < stages ? i : 0) * apart + lane];
}

void nevh__sweeps_take_over(nevh__sweeps *s, const nevh__sweep_start *x,
                            const nevh__sweeps *o, size_t lane) {
    load_state(s, x, 1);
    for (size_t i = 0; i < s->x.stride; i++)
        s->times[i] = x->t + s->weights->c[i] * x->h;
    pick(s, 2 * s->x.n, o->x.gradient, lane, o->lanes, s->x.gradient);
    pick(s, s->changes.rows, o->changes.before, lane, o->lanes,
         s->changes.before);
    pick(s, s->changes.rows, o->changes.least, lane, o->lanes,
         s->changes.least);
    s->lowest[0] = o->lowest[lane];
}

NEVH__INLINE int sweep(nevh__sweeps *s, size_t lanes,
                       nevh__stage_progress made[]) {
    int status = nevh__stage_map(&s->x, lanes);
    if (!status)
        nevh__stage_compare_sweep(&s->x, &s->changes, lanes, made);
    return status;
}

NEVH_SIMD static int sweep_one(nevh__sweeps *s, nevh__stage_progress made[]) {
    return sweep(s, NEVH__STAGES_TOGETHER, made);
}

NEVH_SIMD static int sweep_eight(nevh__sweeps *s, nevh__stage_progress made[]) {
    return sweep(s, NEVH__LANES, made);
}

int nevh__sweeps_sweep(nevh__sweeps *s, nevh__stage_progress made[]) {
    if (s->lanes > 1) {
        if (s->work->field->lanes) /* one may have been taken alone */
            nevh__field_choose(s->work->field, s->lanes, s->chosen);
        int status = sweep_eight(s, made);
        return status == NEVH__STAGE_RANGE ? NEVH_EDOM : status;
    }
    int status = sweep_one(s, made);
    if (status == NEVH__STAGE_RANGE)
        return ask(s, false, true);
    if (!status && !(made->change < INFINITY))
        return ask(s, true, !s->x.partitioned);
    return status;
}

void nevh__sweeps_count(const nevh__sweeps *s, size_t sweeps) {
    if (s->x.unchecked)
        s->work->field->gradients += sweeps * s->x.stages;
}

/* Rows without what is behind the stages. */
NEVH_SIMD static void fetch(const nevh__sweeps *s, size_t first, double sign,
                            double slopes[]) {
    const nevh__stage_step *x = &s->x;
    const double *from = x->gradient + first * x->stride;
    double *to = slopes + first * x->stages;
    if (x->stages == x->stride)
        NEVH_LANES(i, x->n * x->stages) {
            to[i] = sign * from[i];
        }
    else
        for (size_t k = 0; k < x->n; k++, from += x->stride, to += x->stages)
            for (size_t i = 0; i < x->stages; i++)
                to[i] = sign * from[i];
}

static void fetch_lane(const nevh__sweeps *s, size_t lane, size_t width,
                       double slopes[]) {
    const nevh__stage_step *x = &s->x;
    for (size_t k = 0; k < 2 * x->n; k++) {
        double sign = k < x->n ? 1 : -1;
        const double *from = x->gradient + k * x->stride + lane;
        for (size_t i = 0; i < x->stages; i++, slopes += width)
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
    fetch(s, s->x.n, -1, slopes);
}

/* Rows of `width` slopes, of which some lanes are taken, and those of the
   gradient. */
static void load_rows(const nevh__sweep_start *x, size_t rows, double sign,
                      const double slopes[], double to[]) {
    for (size_t row = 0; row < rows; row++, slopes += x->width)
        for (size_t i = 0; i < x->count; i++)
            *to++ = sign * slopes[x->width == 1 ? 0 : x->lanes[i]];
}

static void load_slopes(nevh__sweeps *s, const nevh__sweep_start *x,
                        size_t first, const double slopes[]) {
    size_t half = s->x.n * s->x.stages;
    if (first == 0)
        load_rows(x, half, 1, slopes, s->x.gradient);
    load_rows(x, half, -1, slopes + half * x->width,
              s->x.gradient + half * x->count);
}

static void set_columns(nevh__sweeps *s, const nevh__sweep_start *x) {
    s->used = s->x.stride = s->x.stages * x->count;
    load_state(s, x, x->count);
    for (size_t i = 0; i < s->x.stride; i++)
        s->times[i] = x->t + s->weights->c[i / x->count] * x->h;
}

NEVH_SIMD static int map(nevh__sweeps *s, size_t lanes) {
    return nevh__stage_map(&s->x, lanes);
}

int nevh__sweeps_map(nevh__sweeps *s, const nevh__sweep_start *x,
                     double slopes[], double out[]) {
    const size_t n = s->x.n, stages = s->x.stages, first = s->changes.first;
    set_columns(s, x);
    load_slopes(s, x, first, slopes);
    int status = map(s, x->count > 1 ? x->count : NEVH__STAGES_TOGETHER);
    if (status)
        return status;
    const double *from = s->x.gradient, *half = from + n * s->x.stride;
    for (size_t row = 0; first && row < n * stages; row++)
        for (size_t i = 0; i < x->count; i++)
            slopes[row * x->width + x->lanes[i]] = *from++;
    for (; from < half; from++)
        *out++ = *from;
    for (; from < half + n * s->x.stride; from++)
        *out++ = -*from;
    return status;
}

NEVH_SIMD static void place(nevh__sweeps *s, size_t lanes) {
    nevh__stage_place(&s->x, lanes, false);
    nevh__stage_place(&s->x, lanes, true);
}

void nevh__sweeps_place(nevh__sweeps *s, const nevh__sweep_start *x,
                        const double slopes[]) {
    set_columns(s, x);
    load_slopes(s, x, 0, slopes);
    place(s, x->count);
}

const double *nevh__sweeps_stage(const nevh__sweeps *s, size_t stage,
                                 double state[]) {
    const size_t n = s->x.n, count = s->x.stride / s->x.stages;
    const double *from = s->x.points + stage * count;
    for (size_t k = 0; k < 2 * n; k++, state += count)
        memcpy(state, from + (k / n) * s->x.half + k % n * s->x.stride,
               count * sizeof *state);
    return s->times + stage * count;
}

NEVH_SIMD static void advance(const nevh__tableau *a, const double hb[],
                              size_t rows, size_t width, const double slopes[],
                              double sum[], double compensation[]) {
    size_t eight = NEVH__LANES;
    for (size_t k = 0; k < rows; k++, slopes += a->stages * width) {
        size_t i = k * width, end = i + width;
        const double *x = slopes;
        for (; i + eight <= end; i += eight, x += eight)
            nevh__stage_advance(a->stages, a->order, hb, eight, width, x,
                                sum + i, compensation + i);
        for (; i < end; i++, x++)
            nevh__stage_advance(a->stages, a->order, hb, 1, width, x, sum + i,
                                compensation + i);
    }
}

void nevh__stages_advance(const nevh__tableau *a, const double hb[],
                          size_t rows, size_t width, const double slopes[],
                          double sum[], double compensation[]) {
    advance(a, hb, rows, width, slopes, sum, compensation);
}
