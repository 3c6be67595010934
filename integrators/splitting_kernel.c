/* nevh: explicit symplectic splitting of H = T(p) + V(q).

   A step is a sequence of kicks p -= b h dV/dq(q) and drifts q += a h dT/dp(p).
   Increments are summed from zero over the step and added to the state once,
   with compensation [Sofroniou, Spaletta, "Increment formulations for rounding
   error reduction in the numerical solution of structured differential
   systems", Future Gener. Comput. Syst. 19 (2003) 375-383].

   When the first operation is of the same kind as the last, the last gradient
   of a step is the first of the next, and is kept.  Neighbouring kicks of two
   steps are not merged, so the orbit is the same whether or not anyone looks.

   In V(q, t) time is that of the drifts, in T(p, t) that of the kicks.

   One orbit of a small system is repeated over a vector: its blocks are of that
   size anyway, and what stays in vectors needs no filling and no collecting.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "splitting_private.h"
#include "system/system_private.h"
#include "gradient/field_private.h"
#include "work_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    nevh_operation first;
    size_t count;
    bool same_ends; /* the last operation is of the first one's kind */
    double *weights;
    double *times;       /* parts of h that the half at rest has gone through */
    nevh__call calls[2]; /* for kicks and drifts of one orbit, repeated */
    bool prepared, ready[2];
} operations;

/* One half of the state under way: q under drifts, p under kicks. */
typedef struct {
    double *start;  /* the state at the start of the step */
    double *change; /* its increment so far */
    double *carry;  /* lost digits of earlier steps */
    double *point;  /* start + (change + carry) */
} half;

typedef struct {
    size_t lanes, size; /* n x lanes: elements of a half */
    bool repeated;
    half q, p;
    double *slope, *kept, *has_kept, *time;
    const operations *plan;
} layout;

static layout lay_out(const nevh_work *w, double q[], double p[]) {
    double *m = w->memory, *s = nevh__aligned(w->scratch);
    bool repeated = nevh__work_repeats(w);
    size_t lanes = repeated ? NEVH__LANES : w->width, n = w->n * lanes;
    return (layout){
        .plan = w->plan,
        .lanes = lanes,
        .size = n,
        .repeated = repeated,
        .q = {repeated ? s + 6 * n : q, s, repeated ? s + 7 * n : m, s + n},
        .p = {repeated ? s + 8 * n : p, s + 2 * n,
              repeated ? s + 9 * n : m + w->size, s + 3 * n},
        .slope = s + 4 * n,
        .kept = repeated ? s + 5 * n : m + 2 * w->size,
        .has_kept = m + 3 * w->size,
        .time = s + 10 * n};
}

static void unplan(nevh_work *w) {
    operations *o = w->plan;
    free(o->weights);
    free(o->times);
    free(o);
    w->plan = NULL;
}

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
static void fill(operations *o, const nevh_splitting *table) {
    double passed[2] = {0, 0};
    nevh__splitting_expand(table, o->weights);
    for (size_t i = 0; i < o->count; i++) {
        o->times[i] = passed[1 - i % 2];
        passed[i % 2] += o->weights[i];
    }
}

static int plan(nevh_work *w) {
    const nevh_splitting *table = w->integrator->table;
    operations *o = w->plan = nevh__array(1, sizeof *o);
    if (!o)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    o->first = table->first;
    o->count = nevh__splitting_operations(table);
    o->same_ends = o->count % 2 == 1;
    o->weights = nevh__array(o->count, sizeof *o->weights);
    o->times = nevh__array(o->count, sizeof *o->times);
    if (!o->weights || !o->times)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    fill(o, table);
    w->memory_rows = 3 * w->n + 1;
    size_t lanes = nevh__padded(w->width);
    w->scratch_size = (10 * w->n + 1) * lanes + NEVH__LANES;
    return NEVH_OK;
}

static void begin(const layout *l, const half *x) {
    for (size_t i = 0; i < l->size; i++) {
        x->change[i] = 0;
        x->point[i] = x->start[i] + x->carry[i];
    }
}

NEVH_SIMD static void repeat(size_t n, const double from[], double to[]) {
    for (size_t k = 0; k < n; k++, to += NEVH__LANES)
        NEVH_LANES(lane, NEVH__LANES) {
            to[lane] = from[k];
        }
}

NEVH_SIMD static void begin_vectors(size_t size, double start[], double carry[],
                                    double change[], double point[]) {
    NEVH_LANES(i, size) {
        change[i] = 0;
        point[i] = start[i] + carry[i];
    }
}

/* The state, what was lost of it, and the kept slope, repeated. */
static void begin_repeated(const nevh_work *w, const layout *l,
                           const double q[], const double p[]) {
    const half *const both[] = {&l->q, &l->p};
    for (size_t i = 0; i < 2; i++) {
        const half *x = both[i];
        repeat(w->n, i ? p : q, x->start);
        repeat(w->n, w->memory + i * w->n, x->carry);
        begin_vectors(l->size, x->start, x->carry, x->change, x->point);
    }
    repeat(w->n, w->memory + 2 * w->n, l->kept);
}

/* Scratch stays where it is, and so do the calls. */
static void prepare(const nevh_work *w, const layout *l) {
    operations *o = w->plan;
    if (!o->prepared) {
        o->calls[0] = nevh__call_plan(w->field, l->lanes, l->time, l->q.point,
                                      l->p.point, l->slope, NULL);
        o->calls[1] = nevh__call_plan(w->field, l->lanes, l->time, l->q.point,
                                      l->p.point, NULL, l->slope);
    }
    o->prepared = true;
    for (size_t i = 0; i < 2; i++)
        o->ready[i] = nevh__call_renew(&o->calls[i]);
}

NEVH_SIMD static void advance_vectors(size_t size, double step,
                                      const double slope[],
                                      const double start[],
                                      const double carry[], double change[],
                                      double point[]) {
    NEVH_LANES(i, size) {
        change[i] += step * slope[i];
        point[i] = start[i] + (change[i] + carry[i]);
    }
}

static void advance(const layout *l, const half *x, double step,
                    const double slope[]) {
    if (l->lanes % NEVH__LANES == 0) {
        advance_vectors(l->size, step, slope, x->start, x->carry, x->change,
                        x->point);
        return;
    }
    for (size_t i = 0; i < l->size; i++) {
        x->change[i] += step * slope[i];
        x->point[i] = x->start[i] + (x->change[i] + x->carry[i]);
    }
}

static bool all_kept(const nevh_work *w, const layout *l) {
    for (size_t lane = 0; lane < w->width; lane++)
        if (l->has_kept[lane] == 0)
            return false;
    return true;
}

static void set_time(const layout *l, double t) {
    for (size_t lane = 0; lane < l->lanes; lane++)
        l->time[lane] = t;
}

/* dH/dq for a kick, or else dH/dp, to the slope. */
static int take_slope(nevh_work *w, const layout *l, bool kick, double t) {
    const nevh__call *call = &l->plan->calls[!kick];
    if (l->plan->ready[!kick]) {
        if (call->timed)
            set_time(l, t);
        if (nevh__call_take(call))
            return NEVH_OK;
    }
    set_time(l, t);
    return nevh__work_gradient(w, l->lanes, w->width, l->time, l->q.point,
                               l->p.point, kick ? l->slope : NULL,
                               kick ? NULL : l->slope);
}

/* Moves p at time t by the part dt of the step, or q. */
static int operate(nevh_work *w, const layout *l, nevh_operation operation,
                   double t, double dt, bool kept) {
    bool kick = operation == NEVH_KICK;
    int status = kept ? NEVH_OK : take_slope(w, l, kick, t);
    if (w->accounts)
        set_time(l, t);
    if (!status && w->accounts)
        status = nevh_work_account(w, kick ? NEVH_OF_Q : NEVH_OF_P, dt, l->time,
                                   l->q.point, l->p.point);
    if (!status)
        advance(l, kick ? &l->p : &l->q, kick ? -dt : dt,
                kept ? l->kept : l->slope);
    return status;
}

static void keep(const nevh_work *w, const layout *l) {
    double *kept = w->memory + 2 * w->size;
    for (size_t i = 0; i < w->size; i++)
        kept[i] = l->slope[l->repeated ? i * l->lanes : i];
    for (size_t lane = 0; lane < w->width; lane++)
        l->has_kept[lane] = 1;
}

static int commit(nevh_work *w, const layout *l, double q[], double p[]) {
    for (size_t k = 1; l->repeated && k < w->n; k++) {
        l->q.change[k] = l->q.change[k * l->lanes];
        l->p.change[k] = l->p.change[k * l->lanes];
    }
    return nevh_work_commit(w, w->size, q, l->q.change, w->memory, p,
                            l->p.change, w->memory + w->size);
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const operations *o = w->plan;
    layout l = lay_out(w, q, p);
    if (l.repeated) {
        begin_repeated(w, &l, q, p);
        prepare(w, &l);
    } else {
        begin(&l, &l.q);
        begin(&l, &l.p);
    }
    bool kept = o->same_ends && all_kept(w, &l);
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < o->count; i++)
        status =
            operate(w, &l, i % 2 ? !o->first : o->first, t + o->times[i] * h,
                    o->weights[i] * h, i == 0 && kept);
    if (!status)
        status = commit(w, &l, q, p);
    if (!status && o->same_ends)
        keep(w, &l);
    return status;
}

/* What is kept is a dH/dp, or a dH/dq that may read p, unless declarations say
   that it does not. */
static void damp(nevh_work *w, const double factor[]) {
    const operations *o = w->plan;
    double *carry = w->memory + w->size, *has_kept = w->memory + 3 * w->size;
    for (size_t i = 0; i < w->size; i++)
        carry[i] *= factor[i / w->width];
    if (o->first == NEVH_KICK && nevh_system_traits(w->system) & NEVH_SEPARABLE)
        return;
    for (size_t lane = 0; lane < w->width; lane++)
        has_kept[lane] = 0;
}

const nevh_kernel nevh_splitting_kernel = {
    .plan = plan, .step = step, .unplan = unplan, .damp = damp};
