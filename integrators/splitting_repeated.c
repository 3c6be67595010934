/* nevh: splitting steps of one orbit of a small system.

   Its blocks are of a vector's size anyway, and what stays in vectors needs no
   filling and no collecting: so the state is repeated over a vector, and stays
   so from step to step, unless what the caller hands over is another one.
   Operation by operation it is splitting_kernel.c: the same bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "splitting_private.h"
#include "gradient/field_private.h"
#include "system/vector_private.h"
#include "work_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

/* One half of the state under way: q under drifts, p under kicks; each row is a
   vector of the same number. */
typedef struct {
    double *state;  /* at the start of the step */
    double *carry;  /* digits that earlier steps lost */
    double *change; /* the increment so far */
    double *point;  /* state + (change + carry) */
} half;

struct nevh__repeated {
    size_t n, size; /* size: of a half, n vectors */
    double *room;   /* holds all that follow */
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
    r->room = nevh__array(10 * r->size + 2 * NEVH__LANES, sizeof *r->room);
    if (!r->room)
        return false;
    double *from = nevh__aligned(r->room);
    r->q = take_half(&from, r->size);
    r->p = take_half(&from, r->size);
    r->slope = nevh__take(&from, r->size);
    r->kept = nevh__take(&from, r->size);
    r->time = from;
    return true;
}

int nevh__repeated_plan(nevh_work *w, nevh__repeated **repeated) {
    if (w->width > 1 || !w->field->repeats)
        return NEVH_OK;
    nevh__repeated *r = nevh__array(1, sizeof *r);
    if (!r)
        return NEVH_ENOMEM;
    r->n = w->n;
    r->size = w->n * NEVH__LANES;
    if (!lay_out(r)) {
        nevh__repeated_free(r);
        return NEVH_ENOMEM;
    }
    r->kick = nevh__call_plan(w->field, NEVH__LANES, r->time, r->q.point,
                              r->p.point, r->slope, NULL);
    r->drift = nevh__call_plan(w->field, NEVH__LANES, r->time, r->q.point,
                               r->p.point, NULL, r->slope);
    *repeated = r;
    return NEVH_OK;
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
    double t, h;
    bool kept;
} journey;

NEVH__INLINE void begin(size_t size, const half *x) {
    double *restrict change = x->change, *restrict point = x->point;
    const double *restrict state = x->state, *restrict carry = x->carry;
    NEVH_LANES(i, size) {
        change[i] = 0;
        point[i] = state[i] + carry[i];
    }
}

NEVH__INLINE void advance(size_t size, const half *x, double step,
                          const double *restrict slope) {
    double *restrict change = x->change, *restrict point = x->point;
    const double *restrict state = x->state, *restrict carry = x->carry;
    NEVH_LANES(i, size) {
        double sum = change[i] + step * slope[i];
        change[i] = sum;
        point[i] = state[i] + (sum + carry[i]);
    }
}

NEVH__INLINE void operate(const journey *j, size_t i) {
    const nevh__repeated *r = j->orbit;
    const nevh__operations *o = j->plan;
    bool kick = (i % 2 ? !o->first : o->first) == NEVH_KICK;
    bool kept = i == 0 && j->kept;
    const nevh__call *call = kick ? &r->kick : &r->drift;
    double dt = o->weights[i] * j->h;
    if (call->timed && !kept) {
        double time = j->t + o->times[i] * j->h;
        NEVH_LANES(lane, NEVH__LANES) {
            r->time[lane] = time;
        }
    }
    if (!kept)
        nevh__call_run(call);
    advance(r->size, kick ? &r->p : &r->q, kick ? -dt : dt,
            kept ? r->kept : r->slope);
}

/* The sum of x - x over the new state: 0 if that is finite, else NaN. */
NEVH__INLINE double check(size_t size, const half *x) {
    double sum = 0;
    for (size_t i = 0; i < size; i += NEVH__LANES) {
        double next = x->state[i] + (x->change[i] + x->carry[i]);
        sum += next - next;
    }
    return sum;
}

NEVH__INLINE void commit(size_t size, const half *x) {
    double *restrict state = x->state, *restrict carry = x->carry;
    const double *restrict change = x->change;
    NEVH_LANES(i, size) {
        double start = state[i], d = change[i] + carry[i], next = start + d;
        double part = next - start;
        carry[i] = (start - (next - part)) + (d - part);
        state[i] = next;
    }
}

/* The step in vectors; whether all is finite, else the state is as it was. */
NEVH_SIMD static bool go(const journey *j) {
    const nevh__repeated *r = j->orbit;
    begin(r->size, &r->q);
    begin(r->size, &r->p);
    for (size_t i = 0; i < j->plan->count; i++)
        operate(j, i);
    if (check(r->size, &r->q) + check(r->size, &r->p) != 0)
        return false;
    commit(r->size, &r->q);
    commit(r->size, &r->p);
    const double *restrict slope = r->slope;
    double *restrict kept = r->kept;
    NEVH_LANES(i, r->size) {
        kept[i] = slope[i];
    }
    return true;
}

static void hand_over(size_t n, const double rows[], double to[]) {
    for (size_t k = 0; k < n; k++)
        to[k] = rows[k * NEVH__LANES];
}

static size_t kicks(const nevh__operations *o, bool kept) {
    size_t kicks = (o->count + (o->first == NEVH_KICK)) / 2;
    return kicks - (kept && o->first == NEVH_KICK);
}

bool nevh__repeated_step(nevh_work *w, double t, double h, double q[],
                         double p[]) {
    nevh__operations *o = w->plan;
    nevh__repeated *r = o->repeated;
    nevh__splitting_memory m = nevh__splitting_recall(w);
    size_t n = r->n;
    journey j = {r, o, t, h, o->same_ends && *m.has_kept != 0};
    if (!nevh__call_renew(&r->kick) || !nevh__call_renew(&r->drift))
        return false;
    take_over(n, q, r->q.state);
    take_over(n, p, r->p.state);
    take_over(n, m.carry_q, r->q.carry);
    take_over(n, m.carry_p, r->p.carry);
    if (j.kept)
        take_over(n, m.kept, r->kept);
    if (!go(&j))
        return false;
    w->field->gradients += kicks(o, j.kept);
    hand_over(n, r->q.state, q);
    hand_over(n, r->p.state, p);
    hand_over(n, r->q.carry, m.carry_q);
    hand_over(n, r->p.carry, m.carry_p);
    if (o->same_ends) {
        hand_over(n, r->kept, m.kept);
        *m.has_kept = 1;
    }
    return true;
}
