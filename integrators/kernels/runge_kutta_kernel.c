/* nevh: explicit Runge-Kutta methods, the non-symplectic reference.

   Slopes k_i = f(t + c_i h, y + h sum_j a_ij k_j), y += h sum_i b_i k_i, the
   sum added to the state with compensation.  Friction is a part of f.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "runge_kutta_private.h"
#include "system/vector_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 2 }; /* of 2n x width in a step, besides the slopes */

static void clear(nevh_work *w) {
    nevh__stages_plan *plan = w->plan;
    if (!plan)
        return;
    nevh__adaptive_clear(w);
    nevh__repeated_stages_free(plan->repeated);
    free(plan);
    w->plan = NULL;
}

/* sum = the sum over `count` rows of weights[j] rows[j], each in turn. */
NEVH_SIMD static void sum_up(size_t size, size_t stride, size_t count,
                             const double weights[], const double rows[],
                             double sum[]) {
    size_t i = 0;
    for (; i + NEVH__IN_VECTOR <= size; i += NEVH__IN_VECTOR) {
        nevh__vector all = {0};
        for (size_t j = 0; j < count; j++)
            if (weights[j] != 0)
                all +=
                    weights[j] * *(const nevh__vector *)(rows + j * stride + i);
        *(nevh__vector *)(sum + i) = all;
    }
    for (; i < size; i++) {
        double all = 0;
        for (size_t j = 0; j < count; j++)
            if (weights[j] != 0)
                all += weights[j] * rows[j * stride + i];
        sum[i] = all;
    }
}

/* h times the sum over `count` stages of weights[j] slopes[j]. */
static void sum_stages(const nevh__stages *s, size_t count,
                       const double weights[], double sum[]) {
    size_t columns = s->columns, size = 2 * s->work->n * columns;
    if (s->holds) {
        nevh__repeated_stages_sum(s, weights, sum);
        return;
    }
    sum_up(size, s->stride, count, weights, s->slopes, sum);
    for (size_t i = 0; i < size; i += columns)
        for (size_t c = 0; c < columns; c++)
            sum[i + c] *= s->h[c];
}

/* The stage's state, to point, and its time. */
static void place(const nevh__stages *s, size_t stage) {
    const nevh_butcher *table = s->work->integrator->table;
    size_t n = s->work->n * s->columns;
    sum_stages(s, stage, table->a + stage * table->stages, s->change);
    for (size_t i = 0; i < n; i++) {
        s->point[i] = s->q[i] + (s->change[i] + s->carry[i]);
        s->point[n + i] = s->p[i] + (s->change[n + i] + s->carry[n + i]);
    }
    for (size_t c = 0; c < s->columns; c++)
        s->time[c] = s->t[c] + table->c[stage] * s->h[c];
}

/* dp/dt = -dH/dq - rate p. */
static void rub(const nevh__stages *s, double slopes[]) {
    const double *rates = s->work->friction, *p = s->point;
    size_t n = s->work->n, columns = s->columns;
    for (size_t k = 0; k < n; k++)
        for (size_t i = (n + k) * columns; i < (n + k + 1) * columns; i++)
            slopes[i] -= rates[k] * p[i];
}

/* The slopes at the point, but for friction. */
static int take_slopes(const nevh__stages *s, double slopes[]) {
    size_t n = s->work->n * s->columns;
    int status = nevh_work_gradient(s->work, s->columns, s->time, s->point,
                                    s->point + n, slopes + n, slopes);
    for (size_t i = n; !status && i < 2 * n; i++)
        slopes[i] = -slopes[i];
    return status;
}

static int take(nevh__stages *s, size_t first, size_t until) {
    s->holds = s->repeated && nevh__repeated_stages_take(s, first, until);
    if (s->holds)
        return NEVH_OK;
    for (size_t stage = first; stage < until; stage++) {
        double *slopes = s->slopes + s->stride * stage;
        place(s, stage);
        int status = take_slopes(s, slopes);
        if (status)
            return status;
        if (s->work->friction)
            rub(s, slopes);
    }
    return NEVH_OK;
}

/* All columns take the same h. */
static int account(const nevh__stages *s) {
    nevh_work *w = s->work;
    const nevh_butcher *table = w->integrator->table;
    int status = NEVH_OK;
    for (size_t i = 0; w->accounts && !status && i < table->stages; i++)
        if (table->b[i] != 0) {
            place(s, i);
            status = nevh_work_account(w, NEVH_OF_Q | NEVH_OF_P,
                                       table->b[i] * s->h[0], s->time, s->point,
                                       s->point + w->n * s->columns);
        }
    return status;
}

static int finish(const nevh__stages *s, double change[], double error[],
                  double coarse[]) {
    const nevh_butcher *table = s->work->integrator->table;
    sum_stages(s, table->stages, table->error, error);
    if (table->coarse)
        sum_stages(s, table->stages, table->coarse, coarse);
    sum_stages(s, table->stages, table->b, change);
    return NEVH_OK;
}

/* Without a tolerance, memory is the carry alone, and a last stage that is the
   next step's first is left to that step. */
static int plan(nevh_work *w) {
    const nevh_butcher *table = w->integrator->table;
    w->plan = nevh__array(1, sizeof(nevh__stages_plan));
    if (!w->plan)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    nevh__stages_plan *plan = w->plan;
    if (nevh__repeated_stages_plan(w, &plan->repeated))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    plan->family = (nevh__family){.stages = table->stages,
                                  .rows = table->stages,
                                  .error_power = table->error_power,
                                  .last_is_first = table->last_is_first,
                                  .coarse = table->coarse,
                                  .take = take,
                                  .finish = finish,
                                  .account = account};
    if (table->error && w->options->tolerance > 0)
        return nevh__adaptive_plan(w);
    w->memory_rows = 2 * w->n;
    w->scratch_size = (table->stages + ROWS) * 2 * w->size + 3 * w->width;
    return NEVH_OK;
}

static nevh__stages lay_out(nevh_work *w, double q[], double p[]) {
    const nevh_butcher *table = w->integrator->table;
    const nevh__stages_plan *plan = w->plan;
    size_t stride = 2 * w->size;
    double *change = w->scratch + stride * table->stages;
    double *times = change + ROWS * stride;
    bool ready = nevh__repeated_stages_ready(plan->repeated);
    return (nevh__stages){.work = w,
                          .columns = w->width,
                          .t = times + w->width,
                          .h = times + 2 * w->width,
                          .q = q,
                          .p = p,
                          .carry = w->memory,
                          .slopes = w->scratch,
                          .stride = stride,
                          .change = change,
                          .point = change + stride,
                          .time = times,
                          .repeated = ready ? plan->repeated : NULL};
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const nevh_butcher *table = w->integrator->table;
    size_t n = w->size, stages = table->stages - table->last_is_first;
    if (((nevh__stages_plan *)w->plan)->adaptive)
        return nevh__adaptive_step(w, t, h, q, p);
    nevh__stages s = lay_out(w, q, p);
    for (size_t lane = 0; lane < w->width; lane++) {
        s.time[w->width + lane] = t;
        s.time[2 * w->width + lane] = h;
    }
    int status = take(&s, 0, stages);
    if (!status)
        status = account(&s);
    if (status)
        return status;
    sum_stages(&s, stages, table->b, s.change);
    return nevh_work_commit(w, n, q, s.change, w->memory, p, s.change + n,
                            w->memory + n);
}

const nevh_kernel nevh_runge_kutta_kernel = {
    .plan = plan, .step = step, .clear = clear, .has_friction = true};
