/* nevh: splitting steps of one orbit of a small system.

   Where its terms have point gradients, all is done number by number, in the
   caller's arrays.  Else blocks are of a vector's size anyway, and what stays
   in vectors needs no filling and no collecting: so the state is repeated over
   a vector, and stays so from step to step, unless what the caller hands over
   is another one.  Operation by operation it is splitting_kernel.c: the same
   bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "splitting_private.h"
#include "gradient/field_private.h"
#include "system/vector_private.h"
#include "work_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

/* One half of the state under way: q under drifts, p under kicks; each row is a
   number, and then state and carry are the caller's, or a vector of it. */
typedef struct {
    double *state;  /* at the start of the step */
    double *carry;  /* digits that earlier steps lost */
    double *change; /* the increment so far */
    double *point;  /* state + (change + carry) */
} half;

struct nevh__repeated {
    size_t n;
    bool (*step)(nevh_work *, double t, double h, double q[], double p[]);
    double *room; /* holds all that follow */
    half q, p;
    double *slope, *kept, *time;
    nevh__call kick, drift;
};

static half take_half(double **from, size_t size) {
    half x = {.state = nevh__take(from, size)};
    x.carry = nevh__take(from, size);
    x.change = nevh__take(from, size);
    x.point = nevh__take(from, size);
    return x;
}

static bool lay_out(nevh__repeated *r) {
    size_t size = r->n * NEVH__LANES;
    r->room = nevh__array(10 * size + 2 * NEVH__LANES, sizeof *r->room);
    if (!r->room)
        return false;
    double *from = nevh__aligned(r->room);
    r->q = take_half(&from, size);
    r->p = take_half(&from, size);
    r->slope = nevh__take(&from, size);
    r->kept = nevh__take(&from, size);
    r->time = from;
    return true;
}

void nevh__repeated_free(nevh__repeated *r) {
    if (r)
        free(r->room);
    free(r);
}

static bool holds(size_t n, const double rows[], const double x[]) {
    bool same = true;
    for (size_t k = 0; k < n; k++)
        same &= memcmp(&rows[k * NEVH__LANES], &x[k], sizeof *x) == 0;
    return same;
}

NEVH_SIMD static void repeat(size_t n, const double from[], double to[]) {
    for (size_t k = 0; k < n; k++) {
        double x = from[k];
        NEVH_LANES(lane, NEVH__LANES) {
            to[k * NEVH__LANES + lane] = x;
        }
    }
}

/* Takes over what is not what the last step left. */
static void take_over(size_t n, const double from[], double rows[]) {
    if (!holds(n, rows, from))
        repeat(n, from, rows);
}

/* One step under way. */
typedef struct {
    const nevh__repeated *orbit;
    const nevh__operations *plan;
    half q, p;
    double *last; /* the slope kept of the last step; NULL: none ever is */
    double t, h;
    bool kept;
} journey;

/* Row by row, of `lanes` each, which is a constant. */
#define EACH(i, lanes, size)                                                   \
    for (size_t i##_from = 0; i##_from < (size); i##_from += (lanes))          \
        for (size_t i = i##_from; i != i##_from + (lanes); i++)

NEVH__INLINE void begin(size_t lanes, size_t size, const half *x) {
    double *restrict change = x->change, *restrict point = x->point;
    const double *restrict state = x->state, *restrict carry = x->carry;
    EACH(i, lanes, size) {
        change[i] = 0;
        point[i] = state[i] + carry[i];
    }
}

NEVH__INLINE void advance(size_t lanes, size_t size, const half *x, double step,
                          const double *restrict slope) {
    double *restrict change = x->change, *restrict point = x->point;
    const double *restrict state = x->state, *restrict carry = x->carry;
    EACH(i, lanes, size) {
        double sum = change[i] + step * slope[i];
        change[i] = sum;
        point[i] = state[i] + (sum + carry[i]);
    }
}

NEVH__INLINE void take(const journey *j, const nevh__call *call, size_t lanes,
                       size_t i) {
    if (call->timed) {
        double time = j->t + j->plan->times[i] * j->h;
        EACH(lane, lanes, lanes) {
            j->orbit->time[lane] = time;
        }
    }
    if (lanes == 1)
        nevh__call_run_points(call);
    else
        nevh__call_run(call);
}

NEVH__INLINE void operate(const journey *j, size_t lanes, size_t size, size_t i,
                          bool kick) {
    const nevh__repeated *r = j->orbit;
    double dt = j->plan->weights[i] * j->h;
    take(j, kick ? &r->kick : &r->drift, lanes, i);
    advance(lanes, size, kick ? &j->p : &j->q, kick ? -dt : dt, r->slope);
}

/* A kick and a drift of known masses, whose numbers need not go through
   memory. */
NEVH__INLINE void operate_both(const journey *j, size_t lanes, size_t size,
                               size_t i) {
    const nevh__repeated *r = j->orbit;
    double *restrict slope = r->slope;
    const double *restrict inverse = r->drift.inverse;
    const double *restrict p = j->p.state, *restrict carry_p = j->p.carry;
    const double *restrict q = j->q.state, *restrict carry_q = j->q.carry;
    double *restrict change_p = j->p.change, *restrict point_p = j->p.point;
    double *restrict change_q = j->q.change, *restrict point_q = j->q.point;
    double kick = -(j->plan->weights[i] * j->h);
    double drift = j->plan->weights[i + 1] * j->h;
    take(j, &r->kick, lanes, i);
    EACH(k, lanes, size) {
        double sum = change_p[k] + kick * slope[k];
        double momentum = p[k] + (sum + carry_p[k]);
        double velocity = inverse[k] * momentum;
        double way = change_q[k] + drift * velocity;
        slope[k] = velocity;
        change_p[k] = sum;
        point_p[k] = momentum;
        change_q[k] = way;
        point_q[k] = q[k] + (way + carry_q[k]);
    }
}

/* All kicks and drifts in turn, of which the first may have its slope. */
NEVH__INLINE void move(const journey *j, size_t lanes, size_t size) {
    size_t i = 0, count = j->plan->count;
    bool kick = j->plan->first == NEVH_KICK;
    if (j->kept) {
        double dt = j->plan->weights[i++] * j->h;
        if (kick)
            advance(lanes, size, &j->p, -dt, j->last);
        else
            advance(lanes, size, &j->q, dt, j->last);
        kick = !kick;
    }
    if (!kick)
        operate(j, lanes, size, i++, false);
    for (; i + 1 < count; i += 2) {
        if (j->orbit->drift.inverse) {
            operate_both(j, lanes, size, i);
            continue;
        }
        operate(j, lanes, size, i, true);
        operate(j, lanes, size, i + 1, false);
    }
    if (i < count)
        operate(j, lanes, size, i, true);
}

/* The sum of x - x over the new state, which the last point is: 0 if that is
   finite, else NaN. */
NEVH__INLINE double check(size_t lanes, size_t size, const half *x) {
    double sum = 0;
    for (size_t i = 0; i < size; i += lanes)
        sum += x->point[i] - x->point[i];
    return sum;
}

NEVH__INLINE void commit(size_t lanes, size_t size, const half *x) {
    double *restrict state = x->state, *restrict carry = x->carry;
    const double *restrict change = x->change, *restrict point = x->point;
    EACH(i, lanes, size) {
        double start = state[i], d = change[i] + carry[i], next = point[i];
        double part = next - start;
        carry[i] = (start - (next - part)) + (d - part);
        state[i] = next;
    }
}

/* Whether all is finite, else the state is as it was. */
NEVH__INLINE bool go(const journey *j, size_t lanes, size_t size) {
    begin(lanes, size, &j->q);
    begin(lanes, size, &j->p);
    move(j, lanes, size);
    if (check(lanes, size, &j->q) + check(lanes, size, &j->p) != 0)
        return false;
    commit(lanes, size, &j->q);
    commit(lanes, size, &j->p);
    const double *restrict slope = j->orbit->slope;
    double *restrict last = j->last;
    if (last)
        EACH(i, lanes, size) {
            last[i] = slope[i];
        }
    return true;
}

NEVH_SIMD static bool repeat_step(const journey *j) {
    return go(j, NEVH__LANES, j->orbit->n * NEVH__LANES);
}

/* What remains to be done of a step that was taken. */
NEVH__INLINE void settle(nevh_work *w, const nevh__splitting_memory *m,
                         bool kept) {
    const nevh__operations *o = w->plan;
    bool kicks_first = o->first == NEVH_KICK;
    w->field->gradients += (o->count + kicks_first) / 2 - (kept && kicks_first);
    if (o->same_ends)
        *m->has_kept = 1;
}

/* All where the caller and the memory have it. */
NEVH__ONE_BY_ONE static bool go_in_numbers(nevh_work *w, double t, double h,
                                           double q[], double p[]) {
    const nevh__operations *o = w->plan;
    const nevh__repeated *r = o->repeated;
    nevh__splitting_memory m = nevh__splitting_recall(w);
    const journey j = {r,
                       o,
                       {q, m.carry_q, r->q.change, r->q.point},
                       {p, m.carry_p, r->p.change, r->p.point},
                       o->same_ends ? m.kept : NULL,
                       t,
                       h,
                       o->same_ends && *m.has_kept != 0};
    bool gone = false;
    if (nevh__field_at_hand(w->field))
        gone = r->n == 1   ? go(&j, 1, 1)
               : r->n == 2 ? go(&j, 1, 2)
                           : go(&j, 1, r->n);
    if (gone)
        settle(w, &m, j.kept);
    return gone;
}

static void hand_over(size_t n, const double rows[], double to[]) {
    for (size_t k = 0; k < n; k++)
        to[k] = rows[k * NEVH__LANES];
}

/* All in vectors that are kept from step to step. */
static bool go_in_vectors(nevh_work *w, double t, double h, double q[],
                          double p[]) {
    const nevh__operations *o = w->plan;
    nevh__repeated *r = o->repeated;
    nevh__splitting_memory m = nevh__splitting_recall(w);
    bool kept = o->same_ends && *m.has_kept != 0;
    size_t n = r->n;
    const journey j = {r, o, r->q, r->p, r->kept, t, h, kept};
    if (!nevh__call_renew(&r->kick) || !nevh__call_renew(&r->drift))
        return false;
    take_over(n, q, r->q.state);
    take_over(n, p, r->p.state);
    take_over(n, m.carry_q, r->q.carry);
    take_over(n, m.carry_p, r->p.carry);
    if (kept)
        take_over(n, m.kept, r->kept);
    if (!repeat_step(&j))
        return false;
    hand_over(n, r->q.state, q);
    hand_over(n, r->p.state, p);
    hand_over(n, r->q.carry, m.carry_q);
    hand_over(n, r->p.carry, m.carry_p);
    if (o->same_ends)
        hand_over(n, r->kept, m.kept);
    settle(w, &m, kept);
    return true;
}

static bool plan_calls(nevh_work *w, nevh__repeated *r, size_t lanes) {
    r->kick = nevh__call_plan(w->field, lanes, r->time, r->q.point, r->p.point,
                              r->slope, NULL);
    r->drift = nevh__call_plan(w->field, lanes, r->time, r->q.point, r->p.point,
                               NULL, r->slope);
    return r->kick.count && r->drift.count;
}

int nevh__repeated_plan(nevh_work *w, nevh__repeated **repeated) {
    if (w->width > 1 || w->n > NEVH__MOST_POINT_ROWS)
        return NEVH_OK;
    nevh__repeated *r = nevh__array(1, sizeof *r);
    if (!r)
        return NEVH_ENOMEM;
    r->n = w->n;
    if (!lay_out(r)) {
        nevh__repeated_free(r);
        return NEVH_ENOMEM;
    }
    r->step = plan_calls(w, r, 1) ? go_in_numbers
              : w->field->repeats && plan_calls(w, r, NEVH__LANES)
                  ? go_in_vectors
                  : NULL;
    if (r->step)
        *repeated = r;
    else
        nevh__repeated_free(r);
    return NEVH_OK;
}

bool nevh__repeated_step(nevh_work *w, double t, double h, double q[],
                         double p[]) {
    const nevh__operations *o = w->plan;
    return o->repeated->step(w, t, h, q, p);
}
