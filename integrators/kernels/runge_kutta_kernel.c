/* nevh: explicit Runge-Kutta methods, the non-symplectic reference.

   The stages are runge_kutta_step.h, compiled for rows of whole vectors (one
   orbit that is repeated over a vector, or orbits side by side), in which
   gradients are planned, and for rows of any width with gradients of any kind.
   Differences of one orbit are planned for that orbit alone: their points fill
   vectors.
   The sum is added to the state with compensation.  Friction is a part of f.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "runge_kutta_step.h"
#include "runge_kutta_private.h"
#include "work/work_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

/* Sums besides those of the stages. */
enum { CHANGE, ERROR, COARSE, ENDS };
/* The evaluation of gradients: constants of inlined functions. */
enum { BY_WORK, PLANNED };

struct nevh__runge_kutta_state {
    const nevh_butcher *table;
    void *memory; /* holds all that follow, rows of at most so many lanes */
    size_t lanes;
    double *state, *compensation, *step, *point; /* 2n rows */
    double *slopes;                              /* 2n rows a stage */
    double *time;                                /* a row */
    size_t stride;  /* from the slopes of a stage to the next */
    size_t planned; /* lanes of planned gradients; 0: there are none */
    double known_h; /* that lanes of `step` are for */
    nevh__evaluation *gradients;
    double *weights;
    size_t *offsets;
    nevh__sum *sums; /* those of the stages, and of the ends */
};

/* A step whose stages are being taken. */
struct nevh__runge_kutta_owner {
    const nevh__stages *stages;
    const nevh__runge_kutta_state *state;
};

static nevh__runge_kutta_state *state_of(const nevh_work *w) {
    return ((const nevh__stages_plan *)w->plan)->runge_kutta;
}

static void clear(nevh_work *w) {
    nevh__stages_plan *plan = w->plan;
    if (!plan)
        return;
    nevh__adaptive_clear(w);
    if (plan->runge_kutta)
        free(plan->runge_kutta->memory);
    free(plan->runge_kutta);
    free(plan);
    w->plan = NULL;
}

static void list_weights(nevh__runge_kutta_state *y) {
    const nevh_butcher *table = y->table;
    const double *const ends[ENDS] = {table->b, table->error, table->coarse};
    size_t s = table->stages;
    for (size_t i = 0; i < s + ENDS; i++)
        y->sums[i] =
            nevh__sum_of(i < s ? table->a + i * s : ends[i - s], i < s ? i : s,
                         y->stride, y->weights + i * s, y->offsets + i * s);
}

static void lay_out(nevh__arena *a, void *state) {
    nevh__runge_kutta_state *y = state;
    size_t stages = y->table->stages, lists = (stages + ENDS) * stages;
    size_t each = sizeof(double), rows = y->stride;
    y->state = nevh__arena_take(a, rows, each);
    y->compensation = nevh__arena_take(a, rows, each);
    y->step = nevh__arena_take(a, rows, each);
    y->point = nevh__arena_take(a, rows, each);
    y->slopes = nevh__arena_take(a, stages * rows, each);
    y->time = nevh__arena_take(a, y->lanes, each);
    y->gradients = nevh__arena_take(a, stages, sizeof *y->gradients);
    y->weights = nevh__arena_take(a, lists, each);
    y->offsets = nevh__arena_take(a, lists, sizeof *y->offsets);
    y->sums = nevh__arena_take(a, stages + ENDS, sizeof *y->sums);
}

static void plan_gradients(nevh_work *w, nevh__runge_kutta_state *y) {
    bool differences = w->field->gradient != nevh_exact;
    y->planned = nevh__work_lanes(w, true, differences);
    size_t half = w->n * y->planned;
    for (size_t i = 0; y->planned && i < y->table->stages; i++) {
        double *dh_dp = y->slopes + i * y->stride, *dh_dq = dh_dp + half;
        y->gradients[i] = nevh__work_plan(w, y->planned, y->time, y->point,
                                          y->point + half, dh_dq, dh_dp);
    }
}

/* Rows of columns; what is behind these repeats the first one. */
NEVH__INLINE void load(size_t rows, size_t columns, size_t lanes,
                       const double from[], double to[]) {
    if (columns == lanes)
        memcpy(to, from, rows * lanes * sizeof *to);
    else if (columns == 1)
        nevh__broadcast(rows, from, to);
    else
        for (size_t k = 0; k < rows; k++)
            for (size_t i = 0; i < lanes; i++)
                to[k * lanes + i] = from[k * columns + (i < columns ? i : 0)];
}

NEVH__INLINE void load_steps(const nevh__stages *s,
                             nevh__runge_kutta_state *y) {
    size_t n = s->work->n, half = n * s->lanes;
    bool one = s->columns == 1;
    if (one && y->known_h == *s->h)
        return;
    load(1, s->columns, s->lanes, s->h, y->step);
    for (size_t i = s->lanes; i < half; i++)
        y->step[i] = y->step[i - s->lanes];
    for (size_t i = 0; i < half; i++)
        y->step[half + i] = -y->step[i];
    y->known_h = one && s->lanes > 1 ? *s->h : NAN;
}

/* The state; and the first slope, where that is known. */
NEVH__INLINE nevh__runge_kutta_step begin(const nevh__stages *s,
                                          nevh__runge_kutta_state *y,
                                          bool has_first) {
    size_t n = s->work->n, columns = s->columns, lanes = s->lanes;
    load(n, columns, lanes, s->q, y->state);
    load(n, columns, lanes, s->p, y->state + n * lanes);
    load(2 * n, columns, lanes, s->compensation, y->compensation);
    load_steps(s, y);
    if (has_first)
        load(2 * n, columns, lanes, s->slope, y->slopes);
    return (nevh__runge_kutta_step){.sums = y->sums,
                                    .size = 2 * n * lanes,
                                    .stride = y->stride,
                                    .state = y->state,
                                    .compensation = y->compensation,
                                    .step = y->step,
                                    .point = y->point,
                                    .slopes = y->slopes};
}

/* Rows of lanes, without what is behind the columns. */
static void store(const nevh__stages *s, const double from[], double to[]) {
    for (size_t k = 0; k < 2 * s->work->n; k++)
        for (size_t i = 0; i < s->columns; i++)
            to[k * s->columns + i] = from[k * s->lanes + i];
}

NEVH__INLINE void set_time(const nevh__stages *s,
                           const nevh__runge_kutta_state *y, size_t stage) {
    double c = y->table->c[stage];
    for (size_t i = 0; i < s->lanes; i++) {
        size_t column = i < s->columns ? i : 0;
        y->time[i] = s->t[column] + c * s->h[column];
    }
}

/* dp/dt = -(dH/dq + rate p). */
NEVH__INLINE void add_friction(const nevh__stages *s, const double p[],
                               double dh_dq[]) {
    const double *rates = s->work->friction;
    for (size_t k = 0; k < s->work->n; k++) {
        double rate = rates[k];
        for (size_t i = k * s->lanes; i < (k + 1) * s->lanes; i++)
            dh_dq[i] += rate * p[i];
    }
}

/* For one orbit a lane of each row suffices. */
NEVH__INLINE bool is_finite(const nevh__stages *s, size_t size,
                            const double slopes[]) {
    double bad[NEVH__LANES] = {0}, one = 0;
    if (s->columns == 1) {
        for (size_t i = 0; i < size; i += s->lanes)
            one += slopes[i] - slopes[i];
        return one == 0;
    }
    for (size_t from = 0; from < size; from += NEVH__LANES)
        NEVH_LANES(i, NEVH__LANES) {
            bad[i] += slopes[from + i] - slopes[from + i];
        }
    return nevh__sum_lanes(bad) == 0;
}

NEVH__INLINE int nevh__runge_kutta_slope(const nevh__runge_kutta_step *x,
                                         int way, size_t stage) {
    const nevh__stages *s = x->owner->stages;
    const nevh__runge_kutta_state *y = x->owner->state;
    size_t half = x->size / 2;
    double *dh_dp = x->slopes + stage * x->stride, *dh_dq = dh_dp + half;
    const nevh__evaluation *e = &y->gradients[stage];
    if (way == BY_WORK || e->timed)
        set_time(s, y, stage);
    if (way == PLANNED && !e->exact)
        s->work->field->gradients += s->columns;
    int status = way == BY_WORK
                     ? nevh_work_gradient(s->work, s->lanes, y->time, x->point,
                                          x->point + half, dh_dq, dh_dp)
                     : nevh__work_run(s->work, e);
    if (status)
        return status;
    if (s->work->friction)
        add_friction(s, x->point + half, dh_dq);
    return way == BY_WORK || is_finite(s, x->size, dh_dp) ? NEVH_OK : NEVH_EDOM;
}

NEVH__INLINE int take_stages(const nevh__stages *s, int way, size_t first,
                             size_t until) {
    nevh__runge_kutta_state *y = state_of(s->work);
    struct nevh__runge_kutta_owner owner = {s, y};
    nevh__runge_kutta_step x = begin(s, y, first > 0);
    x.owner = &owner;
    int status = nevh__runge_kutta_take(&x, way, first, until);
    bool last = until == y->table->stages && y->table->last_is_first;
    if (!status && s->slope && (until == 1 || last))
        store(s, y->slopes + (until - 1) * y->stride, s->slope);
    return status;
}

NEVH_SIMD static int take_planned(const nevh__stages *s, size_t first,
                                  size_t until) {
    return take_stages(s, PLANNED, first, until);
}

NEVH_SIMD static int take_by_work(const nevh__stages *s, size_t first,
                                  size_t until) {
    return take_stages(s, BY_WORK, first, until);
}

static int take(nevh__stages *s, size_t first, size_t until) {
    nevh_work *w = s->work;
    size_t planned = state_of(w)->planned;
    bool as_planned = nevh__work_as_planned(w, planned, s->columns);
    s->lanes = as_planned ? planned : s->columns;
    if (!as_planned)
        return take_by_work(s, first, until);
    int status = take_planned(s, first, until);
    if (!status && w->field->gradient == nevh_exact)
        w->field->gradients += (until - first) * s->columns;
    return status;
}

/* All columns take the same h. */
static int account(const nevh__stages *s) {
    nevh_work *w = s->work;
    nevh__runge_kutta_state *y = state_of(w);
    nevh__runge_kutta_step x = begin(s, y, false);
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < y->table->stages; i++)
        if (y->table->b[i] != 0) {
            nevh__runge_kutta_place(&x, i);
            set_time(s, y, i);
            status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P,
                                       y->table->b[i] * s->h[0], y->time,
                                       y->point, y->point + x.size / 2);
        }
    return status;
}

/* s times a sum over all stages, of each column. */
NEVH_SIMD static void sum_up(const nevh__stages *s, const nevh__sum *sum,
                             double out[]) {
    const nevh__runge_kutta_state *y = state_of(s->work);
    size_t lanes = s->lanes, size = 2 * s->work->n * lanes, i = 0;
    nevh__vector rows[2];
    nevh__runge_kutta_step x = {.step = y->step, .slopes = y->slopes};
    if (s->columns == 1 && lanes > 1) {
        for (; i < size; i += lanes)
            *out++ = y->step[i] * nevh__add_up_one(sum, y->slopes + i);
        return;
    }
    double *to = lanes == s->columns ? out : y->point;
    for (; i + 2 * NEVH__IN_VECTOR <= size; i += 2 * NEVH__IN_VECTOR) {
        nevh__runge_kutta_sum(&x, sum, 2, i, rows);
        NEVH__VECTOR_AT(to + i) = rows[0];
        NEVH__VECTOR_AT(to + i + NEVH__IN_VECTOR) = rows[1];
    }
    for (; i < size; i++)
        to[i] = y->step[i] * nevh__add_up_one(sum, y->slopes + i);
    if (to != out)
        store(s, to, out);
}

static int finish(const nevh__stages *s, double change[], double error[],
                  double coarse[]) {
    const nevh__runge_kutta_state *y = state_of(s->work);
    const nevh__sum *ends = y->sums + y->table->stages;
    if (error)
        sum_up(s, &ends[ERROR], error);
    if (error && y->table->coarse)
        sum_up(s, &ends[COARSE], coarse);
    sum_up(s, &ends[CHANGE], change);
    return NEVH_OK;
}

static int plan_state(nevh_work *w, nevh__runge_kutta_state **state) {
    nevh__runge_kutta_state *y = *state = nevh__array(1, sizeof *y);
    if (!y)
        return NEVH_ENOMEM;
    y->table = w->integrator->table;
    y->known_h = NAN;
    y->lanes = nevh__padded(w->width);
    y->stride = 2 * w->n * y->lanes;
    y->memory = nevh__arena_new(lay_out, y);
    if (!y->memory)
        return NEVH_ENOMEM;
    list_weights(y);
    plan_gradients(w, y);
    return NEVH_OK;
}

/* Without a tolerance, memory is the compensation alone, and a last stage that is the
   next step's first is left to that step. */
static int plan(nevh_work *w) {
    const nevh_butcher *table = w->integrator->table;
    nevh__stages_plan *plan = w->plan = nevh__array(1, sizeof *plan);
    if (!plan || plan_state(w, &plan->runge_kutta))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    plan->family = (nevh__family){.stages = table->stages,
                                  .error_power = table->error_power,
                                  .last_is_first = table->last_is_first,
                                  .coarse = table->coarse,
                                  .take = take,
                                  .finish = finish,
                                  .account = account};
    if (table->error && w->options->tolerance > 0)
        return nevh__adaptive_plan(w);
    w->memory_rows = 2 * w->n;
    w->scratch_size = 2 * w->size + 2 * w->width;
    return NEVH_OK;
}

const nevh_kernel nevh_runge_kutta_kernel = {.plan = plan,
                                             .step = nevh__stages_step,
                                             .clear = clear,
                                             .has_friction = true};
