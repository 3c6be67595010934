/* nevh: the stages of Runge-Kutta-Nystroem methods; see nystrom_kernel.c.

   Of one orbit of a small system gradients are called where they stand: number
   by number, where its terms have point gradients, or else as eight equal
   orbits side by side.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "nystrom_private.h"
#include "work/work_private.h"
#include <math.h>
#include <string.h>

/* The ways to take a step, as constants of inlined functions: `called` is the
   lanes of planned calls, or this where there are none. */
enum { NOT_CALLED = 0 };

/* Rows of columns. */
static void prepare_columns(nevh__nystrom_state *y, const nevh__stages *s) {
    size_t n = y->n, size = n * s->columns;
    y->lanes = s->columns;
    y->size = size;
    y->known_h = NAN;
    memcpy(y->q, s->q, size * sizeof *y->q);
    memcpy(y->p, s->p, size * sizeof *y->p);
    memcpy(y->carry, s->carry, 2 * size * sizeof *y->carry);
    for (size_t i = 0; i < size; i++) {
        y->h[i] = s->h[i % s->columns];
        y->at_rest[i] = y->rest[i / s->columns];
        if (y->inverse)
            y->gain[i] = y->h[i] * y->h[i] * y->inverse[i / s->columns];
    }
}

/* Rows of equal lanes. */
NEVH_SIMD static void prepare_lanes(nevh__nystrom_state *y,
                                    const nevh__stages *s) {
    size_t n = y->n;
    y->lanes = y->call_lanes;
    y->size = n * y->lanes;
    nevh__repeat(n, s->q, y->q);
    nevh__repeat(n, s->p, y->p);
    nevh__repeat(2 * n, s->carry, y->carry);
    if (y->known_h == *s->h)
        return;
    nevh__repeat(n, y->rest, y->at_rest);
    for (size_t k = 0; k < n; k++) {
        double h = *s->h, gain = y->inverse ? h * h * y->inverse[k] : 0;
        nevh__repeat(1, &h, y->h + k * y->lanes);
        nevh__repeat(1, &gain, y->gain + k * y->lanes);
    }
    y->known_h = *s->h;
}

/* Of T_p: c p - h sum_j weights[j] D_j. */
NEVH__INLINE void place_momenta(const nevh__nystrom_state *y,
                                const nevh__sum *x, double c) {
    const double *carry = y->carry + y->size;
    size_t i = 0;
    for (; i + NEVH__IN_VECTOR <= y->size; i += NEVH__IN_VECTOR) {
        nevh__vector sum;
        nevh__add_up(x, 1, y->slopes + i, &sum);
        *(nevh__vector *)(y->momenta + i) =
            c * *(const nevh__vector *)(y->p + i) +
            (c * *(const nevh__vector *)(carry + i) -
             *(const nevh__vector *)(y->h + i) * sum);
    }
    for (; i < y->size; i++)
        y->momenta[i] =
            c * y->p[i] +
            (c * carry[i] - y->h[i] * nevh__add_up_one(x, y->slopes + i));
}

/* What q moves by: h (T_p + (c - 1) T_p(0)). */
#define WAY(type, y, i, c)                                                     \
    ((y)->moves ? *(const type *)((y)->h + (i)) *                              \
                      (*(const type *)((y)->velocities + (i)) +                \
                       ((c)-1) * *(const type *)((y)->at_rest + (i)))          \
                : *(const type *)((y)->h + (i)) *                              \
                      *(const type *)((y)->velocities + (i)))

/* q_i: the start and what it moved by. */
NEVH__INLINE void place_points(const nevh__nystrom_state *y, double c) {
    size_t i = 0;
    for (; i + NEVH__IN_VECTOR <= y->size; i += NEVH__IN_VECTOR)
        *(nevh__vector *)(y->points + i) =
            *(const nevh__vector *)(y->q + i) +
            (WAY(nevh__vector, y, i, c) +
             *(const nevh__vector *)(y->carry + i));
    for (; i < y->size; i++)
        y->points[i] = y->q[i] + (WAY(double, y, i, c) + y->carry[i]);
}

/* The same by W: of `rows` vectors. */
NEVH__INLINE void place_vectors(const nevh__nystrom_state *y,
                                const nevh__sum *x, double c, size_t rows,
                                size_t from) {
    nevh__vector sums[2];
    nevh__add_up(x, rows, y->slopes + from, sums);
    NEVH_UNROLL
    for (size_t k = 0; k < rows; k++) {
        size_t i = from + k * NEVH__IN_VECTOR;
        *(nevh__vector *)(y->points + i) =
            *(const nevh__vector *)(y->q + i) +
            ((c * *(const nevh__vector *)(y->way + i) +
              *(const nevh__vector *)(y->carry + i)) -
             *(const nevh__vector *)(y->gain + i) * sums[k]);
    }
}

NEVH__INLINE void place_number(const nevh__nystrom_state *y, double c, size_t i,
                               double sum) {
    y->points[i] = y->q[i] + ((c * y->way[i] + y->carry[i]) - y->gain[i] * sum);
}

NEVH__INLINE void place_diagonal(const nevh__nystrom_state *y,
                                 const nevh__sum *x, double c) {
    size_t i = 0, one = NEVH__IN_VECTOR;
    for (; i + 2 * one <= y->size; i += 2 * one)
        place_vectors(y, x, c, 2, i);
    for (; i + one <= y->size; i += one)
        place_vectors(y, x, c, 1, i);
    for (; i + 2 <= y->size; i += 2) {
        double sums[2];
        nevh__add_up_two(x, y->slopes + i, sums);
        place_number(y, c, i, sums[0]);
        place_number(y, c, i + 1, sums[1]);
    }
    if (i < y->size)
        place_number(y, c, i, nevh__add_up_one(x, y->slopes + i));
}

/* The state of the first stage. */
NEVH__INLINE void place_start(const nevh__nystrom_state *y) {
    for (size_t i = 0; i < y->size; i++)
        y->points[i] = y->q[i] + y->carry[i];
}

/* Also where T seems to read the time: its differences are those of H. */
NEVH__INLINE void set_time(const nevh__nystrom_state *y, const nevh__stages *s,
                           size_t called, double c) {
    if (called && !y->kicks->timed && !y->drift.timed)
        return;
    for (size_t i = 0; i < y->lanes; i++) {
        size_t column = s->columns > 1 ? i : 0;
        y->time[i] = s->t[column] + c * s->h[column];
    }
}

NEVH__INLINE int run(nevh_work *w, const nevh__call *call, size_t called) {
    return called == 1 ? nevh__work_run_points(w, call)
                       : nevh__work_run(w, call);
}

/* T_p of the momenta. */
NEVH__INLINE int drift(const nevh__nystrom_state *y, size_t called) {
    if (!called)
        return nevh_work_gradient(y->work, y->lanes, y->time, y->points,
                                  y->momenta, NULL, y->velocities);
    return run(y->work, &y->drift, called);
}

NEVH__INLINE int kick(const nevh__nystrom_state *y, size_t called,
                      size_t stage) {
    if (!called)
        return nevh_work_gradient(y->work, y->lanes, y->time, y->points, y->p,
                                  y->slopes + stage * y->stride, NULL);
    return run(y->work, &y->kicks[stage], called);
}

/* The state of a stage, to points, and its time. */
NEVH__INLINE int place(const nevh__nystrom_state *y, const nevh__stages *s,
                       size_t called, size_t stage) {
    const nevh_nystrom *table = y->table;
    const nevh__sum *x = &y->sums[stage];
    double c = table->c[stage];
    int status = NEVH_OK;
    if (stage == 0)
        place_start(y);
    else if (y->inverse)
        place_diagonal(y, x, c);
    else {
        place_momenta(y, x, c);
        status = drift(y, called);
        place_points(y, c);
    }
    set_time(y, s, called, c);
    return status;
}

/* T_p(p), to velocities, and by how far it moves q. */
NEVH__INLINE int find_way(const nevh__nystrom_state *y, size_t called,
                          bool known) {
    const double *carry = y->carry + y->size;
    int status = NEVH_OK;
    for (size_t i = 0; i < y->size; i++)
        y->momenta[i] = y->p[i] + carry[i];
    if (!known)
        status = drift(y, called);
    for (size_t i = 0; i < y->size; i++)
        y->way[i] = y->h[i] * y->velocities[i];
    return status;
}

/* Of calls, stops where a slope is not finite. */
NEVH__INLINE int take(const nevh__nystrom_state *y, const nevh__stages *s,
                      size_t called, size_t first, size_t until) {
    int status = NEVH_OK;
    double bad = 0;
    place_start(y); /* where T_p is asked for, if H is one function */
    set_time(y, s, called, 0);
    if (y->inverse || until == 1)
        status = find_way(y, called, first > 0);
    for (size_t i = first; !status && i < until; i++) {
        status = place(y, s, called, i);
        if (!status)
            status = kick(y, called, i);
        const double *slopes = y->slopes + i * y->stride;
        for (size_t k = 0; called && k < y->size; k += y->lanes)
            bad += slopes[k] - slopes[k];
    }
    return bad == 0 ? status : NEVH_EDOM;
}

NEVH__ONE_BY_ONE static int take_points(const nevh__nystrom_state *y,
                                        const nevh__stages *s, size_t first,
                                        size_t until) {
    return take(y, s, 1, first, until);
}

NEVH_SIMD static int take_vectors(const nevh__nystrom_state *y,
                                  const nevh__stages *s, size_t first,
                                  size_t until) {
    return take(y, s, NEVH__LANES, first, until);
}

NEVH_SIMD static int take_columns(const nevh__nystrom_state *y,
                                  const nevh__stages *s, size_t first,
                                  size_t until) {
    return take(y, s, NOT_CALLED, first, until);
}

/* As a slope of the state, T_p and D_0; and back. */
static void hand_first(const nevh__nystrom_state *y, const nevh__stages *s) {
    size_t n = y->n * s->columns, apart = y->lanes / s->columns;
    for (size_t i = 0; i < n; i++) {
        s->slope[i] = y->velocities[i * apart];
        s->slope[n + i] = y->slopes[i * apart];
    }
}

static void take_first(const nevh__nystrom_state *y, const nevh__stages *s) {
    size_t n = y->n * s->columns, apart = y->lanes / s->columns;
    for (size_t i = 0; i < n; i++)
        for (size_t lane = 0; lane < apart; lane++) {
            y->velocities[i * apart + lane] = s->slope[i];
            y->slopes[i * apart + lane] = s->slope[n + i];
        }
}

static int take_slopes(nevh__nystrom_state *y, const nevh__stages *s,
                       size_t called, size_t first, size_t until) {
    if (called > 1)
        prepare_lanes(y, s);
    else
        prepare_columns(y, s);
    if (first > 0)
        take_first(y, s);
    int status = called == 1            ? take_points(y, s, first, until)
                 : called == NOT_CALLED ? take_columns(y, s, first, until)
                                        : take_vectors(y, s, first, until);
    if (!status && s->slope && until == 1)
        hand_first(y, s);
    return status;
}

int nevh__nystrom_take(nevh__stages *s, size_t first, size_t until) {
    nevh__nystrom_state *y = nevh__nystrom_of(s->work);
    s->planned = y->call_lanes && !s->work->accounts &&
                 nevh__call_ready(&y->drift) && nevh__call_ready(y->kicks);
    if (s->planned) {
        int status = take_slopes(y, s, y->call_lanes, first, until);
        if (status == NEVH_OK)
            s->work->field->gradients += until - first;
        if (status == NEVH_OK || nevh__work_failed(s->work))
            return status;
    }
    s->planned = false;
    return take_slopes(y, s, NOT_CALLED, first, until);
}

/* -h sum_j weights[j] D_j, of each column. */
static void sum_kicks(const nevh__nystrom_state *y, const nevh__stages *s,
                      const nevh__sum *x, double out[]) {
    size_t apart = y->lanes / s->columns;
    for (size_t i = 0; i < y->n * s->columns; i++) {
        size_t at = i * apart;
        out[i] = -(y->h[at] * nevh__add_up_one(x, y->slopes + at));
    }
}

/* How far q moves by the velocity at c p - h sum_j weights[j] D_j. */
NEVH_SIMD static int sum_drifts(const nevh__nystrom_state *y,
                                const nevh__stages *s, const nevh__sum *x,
                                double c, double out[]) {
    size_t apart = y->lanes / s->columns, size = y->n * s->columns;
    int status = NEVH_OK;
    for (size_t i = 0; y->inverse && i < size; i++) {
        size_t at = i * apart;
        out[i] =
            c * y->way[at] - y->gain[at] * nevh__add_up_one(x, y->slopes + at);
    }
    if (y->inverse)
        return status;
    place_momenta(y, x, c);
    status = drift(y, s->planned ? y->lanes : NOT_CALLED);
    for (size_t i = 0; i < size; i++)
        out[i] = WAY(double, y, i *apart, c);
    return status;
}

int nevh__nystrom_finish(const nevh__stages *s, double change[], double error[],
                         double coarse[]) {
    const nevh__nystrom_state *y = nevh__nystrom_of(s->work);
    const nevh__sum *ends = y->sums + y->table->stages;
    size_t n = y->n * s->columns;
    int status = NEVH_OK;
    (void)coarse;
    sum_kicks(y, s, &ends[OF_P], change + n);
    status = sum_drifts(y, s, &ends[OF_Q], 1, change);
    if (status || !error)
        return status;
    sum_kicks(y, s, &ends[ERROR_OF_P], error + n);
    return sum_drifts(y, s, &ends[ERROR_OF_Q], 0, error);
}

int nevh__nystrom_place(const nevh__nystrom_state *y, const nevh__stages *s,
                        size_t stage) {
    return place(y, s, NOT_CALLED, stage);
}
