/* nevh: Runge-Kutta stages of one orbit of a small system.

   Its blocks are of a vector's size anyway, so states and slopes are repeated
   over vectors from the start: a stage is then a few sums and the calls of H,
   which write its slopes where the next one reads them.  Operation by operation
   it is runge_kutta_kernel.c: the same bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "runge_kutta_private.h"
#include "stage_sums_private.h"
#include "work/work_private.h"
#include <nevh/body.h>
#include <stdlib.h>

#ifdef NEVH__HAS_VECTOR

/* Rows that are summed at once, to keep a processor busy; sums besides those of
   stages. */
enum { SIDE_BY_SIDE = 4, ENDS = 3 };

struct nevh__repeated_stages {
    nevh_work *work;
    const nevh_butcher *table;
    size_t n, size;        /* size: of 2n vectors */
    double *room;          /* holds all numbers that follow */
    double *points;        /* q, p of a stage */
    double *slopes;        /* dH/dp, dH/dq of each stage */
    double *time;          /* a vector */
    double *start, *steps; /* 2n: the state; h, or -h for momenta */
    double *weights;
    size_t *offsets;
    nevh__sum *sums; /* those of the stages, and of the ends */
    nevh__call *calls;
};

static void list_weights(nevh__repeated_stages *r) {
    const nevh_butcher *table = r->table;
    const double *const ends[ENDS] = {table->b, table->error, table->coarse};
    size_t s = table->stages;
    for (size_t i = 0; i < s + ENDS; i++)
        r->sums[i] =
            nevh__sum_of(i < s ? table->a + i * s : ends[i - s], i < s ? i : s,
                         r->size, r->weights + i * s, r->offsets + i * s);
}

static bool lay_out(nevh__repeated_stages *r) {
    size_t s = r->table->stages, lists = (s + ENDS) * s;
    r->room =
        nevh__array((s + 1) * r->size + 4 * r->n + lists + 2 * NEVH__LANES,
                    sizeof *r->room);
    r->offsets = nevh__array(lists, sizeof *r->offsets);
    r->sums = nevh__array(s + ENDS, sizeof *r->sums);
    r->calls = nevh__array(s, sizeof *r->calls);
    if (!r->room || !r->offsets || !r->sums || !r->calls)
        return false;
    r->points = nevh__aligned(r->room);
    r->slopes = r->points + r->size;
    r->time = r->slopes + s * r->size;
    r->start = r->time + NEVH__LANES;
    r->steps = r->start + 2 * r->n;
    r->weights = r->steps + 2 * r->n;
    return true;
}

int nevh__repeated_stages_plan(nevh_work *w, nevh__repeated_stages **stages) {
    if (!nevh__work_repeats(w))
        return NEVH_OK;
    nevh__repeated_stages *r = *stages = nevh__array(1, sizeof *r);
    if (!r)
        return NEVH_ENOMEM;
    r->work = w;
    r->table = w->integrator->table;
    r->n = w->n;
    r->size = 2 * w->n * NEVH__LANES;
    if (!lay_out(r))
        return NEVH_ENOMEM;
    list_weights(r);
    size_t half = r->size / 2;
    for (size_t i = 0; i < r->table->stages; i++) {
        double *dh_dp = r->slopes + i * r->size, *dh_dq = dh_dp + half;
        r->calls[i] = nevh__call_plan(w->field, NEVH__LANES, r->time, r->points,
                                      r->points + half, dh_dq, dh_dp);
    }
    return NEVH_OK;
}

void nevh__repeated_stages_free(nevh__repeated_stages *r) {
    if (!r)
        return;
    free(r->room);
    free(r->offsets);
    free(r->sums);
    free(r->calls);
    free(r);
}

bool nevh__repeated_stages_ready(nevh__repeated_stages *r) {
    return r && !r->work->accounts && nevh__call_ready(r->calls);
}

/* State + (h times the sum + carry). */
NEVH__INLINE void place_rows(const nevh__repeated_stages *r, size_t count,
                             const nevh__sum *x, size_t first,
                             const double carry[]) {
    nevh__vector rows[SIDE_BY_SIDE];
    nevh__add_up(x, count, r->slopes + first * NEVH__LANES, rows);
    NEVH_UNROLL
    for (size_t i = 0; i < count; i++) {
        size_t k = first + i;
        nevh__vector change = rows[i] * r->steps[k] + carry[k];
        *(nevh__vector *)(r->points + k * NEVH__LANES) = r->start[k] + change;
    }
}

NEVH__INLINE void place(const nevh__repeated_stages *r, const nevh__sum *x,
                        const double carry[]) {
    size_t k = 0;
    for (; k + SIDE_BY_SIDE <= 2 * r->n; k += SIDE_BY_SIDE)
        place_rows(r, SIDE_BY_SIDE, x, k, carry);
    for (; k < 2 * r->n; k += 2)
        place_rows(r, 2, x, k, carry);
}

/* dp/dt = -(dH/dq + rate p). */
NEVH__INLINE void rub(const nevh__repeated_stages *r, double dh_dq[]) {
    const double *rates = r->work->friction, *p = r->points + r->size / 2;
    for (size_t k = 0; k < r->n; k++) {
        double rate = rates[k];
        NEVH_LANES(i, NEVH__LANES) {
            size_t at = k * NEVH__LANES + i;
            dh_dq[at] += rate * p[at];
        }
    }
}

/* The sum of x - x over all slopes: 0 if they are finite, else NaN. */
NEVH_SIMD static double take(const nevh__repeated_stages *r,
                             const nevh__stages *s, size_t first,
                             size_t until) {
    double bad = 0, t = *s->t, h = *s->h;
    for (size_t stage = first; bad == 0 && stage < until; stage++) {
        const nevh__call *call = &r->calls[stage];
        double *slopes = r->slopes + stage * r->size;
        place(r, &r->sums[stage], s->carry);
        if (call->timed) {
            double time = t + r->table->c[stage] * h;
            NEVH_LANES(i, NEVH__LANES) {
                r->time[i] = time;
            }
        }
        nevh__call_run(call);
        if (r->work->friction)
            rub(r, slopes + r->size / 2);
        for (size_t k = 0; k < r->size; k += NEVH__LANES)
            bad += slopes[k] - slopes[k];
    }
    return bad;
}

NEVH_SIMD static void repeat(size_t n, const double slopes[], double to[]) {
    for (size_t k = 0; k < 2 * n; k++) {
        double x = k < n ? slopes[k] : -slopes[k];
        NEVH_LANES(i, NEVH__LANES) {
            to[k * NEVH__LANES + i] = x;
        }
    }
}

static double slope_of(const nevh__repeated_stages *r, size_t stage, size_t k) {
    double x = r->slopes[stage * r->size + k * NEVH__LANES];
    return k < r->n ? x : -x;
}

bool nevh__repeated_stages_take(const nevh__stages *s, size_t first,
                                size_t until) {
    const nevh__repeated_stages *r = s->repeated;
    size_t last = r->table->stages - 1;
    for (size_t i = 0; i < first; i++)
        repeat(r->n, s->slopes + i * s->stride, r->slopes + i * r->size);
    for (size_t k = 0; k < r->n; k++) {
        r->start[k] = s->q[k];
        r->start[r->n + k] = s->p[k];
        r->steps[k] = *s->h;
        r->steps[r->n + k] = -*s->h;
    }
    if (take(r, s, first, until) != 0)
        return false;
    r->work->field->gradients += until - first;
    for (size_t k = 0; until > last && k < 2 * r->n; k++)
        s->slopes[last * s->stride + k] = slope_of(r, last, k);
    for (size_t k = 0; until == 1 && k < 2 * r->n; k++)
        s->slopes[k] = slope_of(r, 0, k);
    return true;
}

NEVH_SIMD static void finish(const nevh__repeated_stages *r, const nevh__sum *x,
                             double out[]) {
    for (size_t first = 0; first < 2 * r->n; first += 2) {
        nevh__vector rows[2];
        nevh__add_up(x, 2, r->slopes + first * NEVH__LANES, rows);
        out[first] = rows[0][0] * r->steps[first];
        out[first + 1] = rows[1][0] * r->steps[first + 1];
    }
}

void nevh__repeated_stages_sum(const nevh__stages *s, const double weights[],
                               double out[]) {
    const nevh__repeated_stages *r = s->repeated;
    const nevh__sum *x = r->sums + r->table->stages;
    while (x->all != weights)
        x++;
    finish(r, x, out);
}

#else

int nevh__repeated_stages_plan(nevh_work *w, nevh__repeated_stages **stages) {
    (void)w, (void)stages;
    return NEVH_OK;
}

void nevh__repeated_stages_free(nevh__repeated_stages *r) {
    (void)r;
}

bool nevh__repeated_stages_ready(nevh__repeated_stages *r) {
    (void)r;
    return false;
}

bool nevh__repeated_stages_take(const nevh__stages *s, size_t first,
                                size_t until) {
    (void)s, (void)first, (void)until;
    return false;
}

void nevh__repeated_stages_sum(const nevh__stages *s, const double weights[],
                               double out[]) {
    (void)s, (void)weights, (void)out;
}

#endif
