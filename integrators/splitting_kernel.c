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
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "splitting_private.h"
#include "system/system_private.h"
#include <stdlib.h>
#include <string.h>

/* One half of the state under way: q under drifts, p under kicks. */
typedef struct {
    double *start;  /* the state at the start of the step */
    double *change; /* its increment so far */
    double *carry;  /* lost digits of earlier steps */
    double *point;  /* start + (change + carry) */
} half;

typedef struct {
    size_t lanes, size; /* n x lanes: elements of a half */
    half q, p;
    double *slope, *kept, *has_kept, *time;
} layout;

static layout lay_out(nevh_work *w, double q[], double p[]) {
    nevh__splitting_memory m = nevh__splitting_recall(w);
    double *s = w->scratch;
    size_t n = w->size;
    return (layout){.lanes = w->width,
                    .size = n,
                    .q = {q, s, m.carry_q, s + n},
                    .p = {p, s + 2 * n, m.carry_p, s + 3 * n},
                    .slope = s + 4 * n,
                    .kept = m.kept,
                    .has_kept = m.has_kept,
                    .time = s + 5 * n};
}

static void unplan(nevh_work *w) {
    nevh__operations *o = w->plan;
    nevh__repeated_free(o->repeated);
    free(o->weights);
    free(o->times);
    free(o);
    w->plan = NULL;
}

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
static void fill(nevh__operations *o, const nevh_splitting *table) {
    double passed[2] = {0, 0};
    nevh__splitting_expand(table, o->weights);
    for (size_t i = 0; i < o->count; i++) {
        o->times[i] = passed[1 - i % 2];
        passed[i % 2] += o->weights[i];
    }
}

static int plan(nevh_work *w) {
    const nevh_splitting *table = w->integrator->table;
    nevh__operations *o = w->plan = nevh__array(1, sizeof *o);
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
    w->scratch_size = (5 * w->n + 1) * w->width;
    if (nevh__repeated_plan(w, &o->repeated))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    return NEVH_OK;
}

static void begin(const layout *l, const half *x) {
    for (size_t i = 0; i < l->size; i++) {
        x->change[i] = 0;
        x->point[i] = x->start[i] + x->carry[i];
    }
}

static void advance(const layout *l, const half *x, double step,
                    const double slope[]) {
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
    set_time(l, t);
    return nevh_work_gradient(w, l->lanes, l->time, l->q.point, l->p.point,
                              kick ? l->slope : NULL, kick ? NULL : l->slope);
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
    memcpy(l->kept, l->slope, w->size * sizeof *l->kept);
    for (size_t lane = 0; lane < w->width; lane++)
        l->has_kept[lane] = 1;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const nevh__operations *o = w->plan;
    if (o->repeated && !w->accounts && nevh__repeated_step(w, t, h, q, p))
        return NEVH_OK;
    layout l = lay_out(w, q, p);
    begin(&l, &l.q);
    begin(&l, &l.p);
    bool kept = o->same_ends && all_kept(w, &l);
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < o->count; i++)
        status =
            operate(w, &l, i % 2 ? !o->first : o->first, t + o->times[i] * h,
                    o->weights[i] * h, i == 0 && kept);
    if (!status)
        status = nevh_work_commit(w, w->size, q, l.q.change, l.q.carry, p,
                                  l.p.change, l.p.carry);
    if (!status && o->same_ends)
        keep(w, &l);
    return status;
}

/* What is kept is a dH/dp, or a dH/dq that may read p, unless declarations say
   that it does not. */
static void damp(nevh_work *w, const double factor[]) {
    const nevh__operations *o = w->plan;
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
