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

   The step is splitting_step.h, compiled for numbers (one orbit whose terms have
   point gradients), for rows of whole vectors (orbits side by side, or one that
   is repeated over a vector), and for rows of any width with gradients of any
   kind.  All give the same bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "splitting_step.h"
#include "gradient/field_private.h"
#include "splitting_private.h"
#include "work/work_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

/* The evaluation of gradients: constants of inlined functions. */
typedef enum {
    BY_POINT,  /* planned, of one state, exact */
    BY_NUMBER, /* planned, of one state, from values */
    BY_VECTOR, /* planned, of rows of whole vectors */
    BY_WORK    /* by nevh_work_gradient */
} gradient_way;

/* The numbers of a step, n rows each. */
typedef struct {
    nevh__half q, p;
    double *slope, *kept, *time; /* time: one row */
} rows;

typedef struct {
    nevh_operation first;
    size_t kicks;
    nevh__splitting_scheme scheme;
    gradient_way way;
    double *buffer;         /* holds all rows */
    double *from, *by_work; /* those of planned gradients, and of the width */
    size_t stride;          /* of a row of the former */
    nevh__evaluation kick, drift; /* unless the way is BY_WORK */
} splitting_plan;

/* The memory of each half, and the last derivative of a step. */
typedef struct {
    double *compensation_q, *compensation_p, *kept, *has_kept;
} memory;

/* size: of a half, n x width. */
NEVH__INLINE memory recall(const nevh_work *w, size_t size) {
    double *m = w->memory;
    return (memory){m, m + size, m + 2 * size, m + 3 * size};
}

static void clear(nevh_work *w) {
    splitting_plan *o = w->plan;
    if (!o)
        return;
    free(o->buffer);
    free(o->scheme.weights);
    free(o->scheme.times);
    free(o);
    w->plan = NULL;
}

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
static void fill(splitting_plan *o, const nevh_splitting *table) {
    double passed[2] = {0, 0};
    nevh__splitting_expand(table, o->scheme.weights);
    for (size_t i = 0; i < o->scheme.count; i++) {
        o->scheme.times[i] = passed[1 - i % 2];
        passed[i % 2] += o->scheme.weights[i];
    }
}

/* Rows of `size` numbers; with those of the state and the memory where these
   are copied. */
NEVH__INLINE rows lay_out(size_t size, bool copied, double *from) {
    rows r;
    r.q.change = nevh__take(&from, size);
    r.q.point = nevh__take(&from, size);
    r.p.change = nevh__take(&from, size);
    r.p.point = nevh__take(&from, size);
    r.slope = nevh__take(&from, size);
    r.q.state = nevh__take(&from, copied ? size : 0);
    r.p.state = nevh__take(&from, copied ? size : 0);
    r.q.compensation = nevh__take(&from, copied ? size : 0);
    r.p.compensation = nevh__take(&from, copied ? size : 0);
    r.kept = nevh__take(&from, copied ? size : 0);
    r.time = from;
    return r;
}

/* Rows of the width, and before them those of planned gradients if these have
   another stride.  Returns false when memory is out. */
static bool plan_rows(splitting_plan *o, const nevh_work *w) {
    size_t copied = o->stride == w->width ? 0 : (10 * w->n + 1) * o->stride;
    size_t size = copied + (5 * w->n + 1) * w->width + NEVH__LANES;
    o->buffer = nevh__array(size, sizeof *o->buffer);
    if (!o->buffer)
        return false;
    o->from = nevh__aligned(o->buffer);
    o->by_work = o->from + copied;
    return true;
}

static void plan_gradients(splitting_plan *o, const nevh_work *w) {
    size_t stride = o->stride;
    rows r = lay_out(w->n * stride, stride != w->width, o->from);
    const double *q = r.q.point, *p = r.p.point;
    o->kick = nevh__work_plan(w, stride, r.time, q, p, r.slope, NULL);
    o->drift = nevh__work_plan(w, stride, r.time, q, p, NULL, r.slope);
}

static bool find_way(splitting_plan *o, nevh_work *w) {
    size_t lanes = nevh__work_lanes(w, false, true);
    o->stride = lanes ? lanes : w->width;
    if (!plan_rows(o, w))
        return false;
    if (lanes)
        plan_gradients(o, w);
    o->way = lanes == 0      ? BY_WORK
             : lanes > 1     ? BY_VECTOR
             : o->kick.exact ? BY_POINT
                             : BY_NUMBER;
    return true;
}

static int plan(nevh_work *w) {
    const nevh_splitting *table = w->integrator->table;
    splitting_plan *o = w->plan = nevh__array(1, sizeof *o);
    if (!o)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    o->first = table->first;
    o->scheme.count = nevh__splitting_operations(table);
    o->scheme.keeps = o->scheme.count % 2 == 1;
    o->scheme.kicks_first = o->first == NEVH_KICK;
    o->kicks = (o->scheme.count + o->scheme.kicks_first) / 2;
    o->scheme.weights = nevh__array(o->scheme.count, sizeof *o->scheme.weights);
    o->scheme.times = nevh__array(o->scheme.count, sizeof *o->scheme.times);
    if (!o->scheme.weights || !o->scheme.times || !find_way(o, w))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    fill(o, table);
    w->memory_rows = 3 * w->n + 1;
    return NEVH_OK;
}

/* The includer's data of a step. */
struct nevh__splitting_owner {
    nevh_work *work;
    const splitting_plan *plan;
    size_t stride;
    double *time; /* a row */
};

NEVH__INLINE void set_time(const nevh__splitting_step *x, size_t i) {
    double time = x->t + x->scheme->times[i] * x->h;
    for (size_t lane = 0; lane < x->owner->stride; lane++)
        x->owner->time[lane] = time;
}

static int account(const nevh__splitting_step *x, size_t i, bool kick) {
    set_time(x, i);
    return nevh_work_account(x->owner->work, kick ? NEVH_OF_Q : NEVH_OF_P,
                             x->scheme->weights[i] * x->h, x->owner->time,
                             x->q.point, x->p.point);
}

NEVH__INLINE int slope_by_work(const nevh__splitting_step *x, size_t i,
                               bool kick, bool kept) {
    nevh_work *w = x->owner->work;
    int status = NEVH_OK;
    set_time(x, i);
    if (!kept)
        status = nevh_work_gradient(
            w, x->owner->stride, x->owner->time, x->q.point, x->p.point,
            kick ? x->slope : NULL, kick ? NULL : x->slope);
    return status || !w->accounts ? status : account(x, i, kick);
}

NEVH__INLINE int nevh__splitting_slope(const nevh__splitting_step *x, int way,
                                       size_t i, bool kick, bool kept) {
    const struct nevh__splitting_owner *o = x->owner;
    const nevh__evaluation *e = kick ? &o->plan->kick : &o->plan->drift;
    if (way == BY_WORK)
        return slope_by_work(x, i, kick, kept);
    if (kept)
        return NEVH_OK;
    if (e->timed)
        set_time(x, i);
    if (way == BY_VECTOR)
        return nevh__work_run(o->work, e);
    if (way == BY_NUMBER)
        return nevh__work_run_values(o->work, e);
    nevh__evaluation_run_points(e);
    return NEVH_OK;
}

NEVH__INLINE const double *
nevh__splitting_inverse(const nevh__splitting_step *x, int way) {
    return way == BY_WORK ? NULL : x->owner->plan->drift.inverse;
}

static int fail(nevh_work *w) {
    return nevh_work_fail(w, NEVH_EDOM,
                          "the new state is not a finite number: take a "
                          "smaller step");
}

/* Copies orbits to rows of vectors, whose padding repeats the first.  One orbit
   that stands there already is left, since vectors stored number by number
   would be slow to load. */
NEVH__INLINE void load(const nevh_work *w, size_t stride, const double from[],
                       double to[]) {
    for (size_t k = 0; k < w->n; k++, from += w->width, to += stride) {
        if (w->width == 1 && memcmp(from, to, sizeof *to) == 0)
            continue;
        for (size_t i = 0; i < stride; i++)
            to[i] = from[i < w->width ? i : 0];
    }
}

NEVH__INLINE void store(const nevh_work *w, size_t stride, const double from[],
                        double to[]) {
    for (size_t k = 0; k < w->n; k++, from += stride, to += w->width)
        for (size_t i = 0; i < w->width; i++)
            to[i] = from[i];
}

NEVH__INLINE void load_all(const nevh_work *w, size_t stride, const rows *r,
                           const memory *m, const double q[], const double p[],
                           bool has_kept) {
    load(w, stride, q, r->q.state);
    load(w, stride, p, r->p.state);
    load(w, stride, m->compensation_q, r->q.compensation);
    load(w, stride, m->compensation_p, r->p.compensation);
    if (has_kept)
        load(w, stride, m->kept, r->kept);
}

NEVH__INLINE void store_all(const nevh_work *w, size_t stride, const rows *r,
                            const memory *m, double q[], double p[],
                            bool keeps) {
    store(w, stride, r->q.state, q);
    store(w, stride, r->p.state, p);
    store(w, stride, r->q.compensation, m->compensation_q);
    store(w, stride, r->p.compensation, m->compensation_p);
    if (keeps)
        store(w, stride, r->kept, m->kept);
}

/* Rows that are not copied are the caller's and the memory's. */
NEVH__INLINE rows bind(size_t size, double *from, const memory *m, double q[],
                       double p[]) {
    rows r = lay_out(size, false, from);
    r.q.state = q;
    r.p.state = p;
    r.q.compensation = m->compensation_q;
    r.p.compensation = m->compensation_p;
    r.kept = m->kept;
    return r;
}

/* The last slopes of the step before, of `lanes` orbits. */
NEVH__INLINE bool all_kept(size_t lanes, const memory *m) {
    int64_t none = 0;
    for (size_t lane = 0; lane < lanes; lane++)
        none |= m->has_kept[lane] == 0;
    return none == 0;
}

/* Lanes that start afresh take their first slopes here, so that others keep
   theirs: at t + h of the step before, which rounds otherwise than t. */
static int complete_kept(nevh_work *w, double t, const double q[],
                         const double p[], bool *all) {
    const splitting_plan *o = w->plan;
    memory m = recall(w, w->size);
    rows r = lay_out(w->size, false, o->by_work);
    size_t kept = 0;
    for (size_t lane = 0; lane < w->width; lane++) {
        kept += m.has_kept[lane] != 0;
        r.time[lane] = t;
    }
    if (kept == 0)
        return NEVH_OK;
    for (size_t i = 0; i < w->size; i++) {
        r.q.point[i] = q[i] + m.compensation_q[i];
        r.p.point[i] = p[i] + m.compensation_p[i];
    }
    bool kick = o->scheme.kicks_first;
    int status =
        nevh_work_gradient(w, w->width, r.time, r.q.point, r.p.point,
                           kick ? r.slope : NULL, kick ? NULL : r.slope);
    for (size_t i = 0; !status && i < w->size; i++)
        if (m.has_kept[i % w->width] == 0)
            m.kept[i] = r.slope[i];
    *all = !status;
    return status;
}

/* `width` orbits with n coordinates, in rows of `stride`, `lanes` in a vector. */
typedef struct {
    size_t n, width, stride, lanes;
} orbits;

/* The gradients that a step took, and whose last slopes are now kept. */
NEVH__INLINE void count_slopes(nevh_work *w, const orbits *x, const memory *m,
                               bool had_kept, bool counts) {
    const splitting_plan *o = w->plan;
    if (counts)
        w->field->gradients +=
            (o->kicks - (had_kept && o->scheme.kicks_first)) * x->width;
    for (size_t lane = 0; o->scheme.keeps && lane < x->width; lane++)
        m->has_kept[lane] = 1;
}

NEVH__INLINE int step_along(nevh_work *w, gradient_way way, orbits x, double t,
                            double h, double q[], double p[]) {
    const splitting_plan *o = w->plan;
    double *from = way == BY_WORK ? o->by_work : o->from;
    memory m = recall(w, x.n * x.width);
    bool copied = way == BY_VECTOR && x.stride != x.width;
    bool has_kept = o->scheme.keeps && all_kept(x.width, &m);
    int status = o->scheme.keeps && !has_kept && x.width > 1
                     ? complete_kept(w, t, q, p, &has_kept)
                     : NEVH_OK;
    if (status)
        return status;
    rows r = copied ? lay_out(x.n * x.stride, true, from)
                    : bind(x.n * x.stride, from, &m, q, p);
    struct nevh__splitting_owner owner = {w, o, x.stride, r.time};
    nevh__splitting_step step = {.t = t,
                                 .h = h,
                                 .scheme = &o->scheme,
                                 .has_kept = has_kept,
                                 .q = r.q,
                                 .p = r.p,
                                 .slope = r.slope,
                                 .kept = r.kept,
                                 .owner = &owner};
    if (copied)
        load_all(w, x.stride, &r, &m, q, p, has_kept);
    status = nevh__splitting_take(&step, way, x.lanes, x.n * x.stride);
    if (status == NEVH__SPLITTING_RANGE)
        return way == BY_WORK ? fail(w) : NEVH_EDOM;
    if (status)
        return status;
    if (copied)
        store_all(w, x.stride, &r, &m, q, p, o->scheme.keeps);
    count_slopes(w, &x, &m, step.has_kept, way != BY_WORK);
    return NEVH_OK;
}

NEVH__ONE_BY_ONE static int step_point(nevh_work *w, double t, double h,
                                       double q[], double p[]) {
    return step_along(w, BY_POINT, (orbits){1, 1, 1, 1}, t, h, q, p);
}

NEVH__ONE_BY_ONE static int step_points_of_two(nevh_work *w, double t, double h,
                                               double q[], double p[]) {
    return step_along(w, BY_POINT, (orbits){2, 1, 1, 1}, t, h, q, p);
}

NEVH__ONE_BY_ONE static int step_points(nevh_work *w, double t, double h,
                                        double q[], double p[]) {
    return step_along(w, BY_POINT, (orbits){w->n, 1, 1, 1}, t, h, q, p);
}

NEVH__ONE_BY_ONE static int step_number(nevh_work *w, double t, double h,
                                        double q[], double p[]) {
    return w->n == 1
               ? step_along(w, BY_NUMBER, (orbits){1, 1, 1, 1}, t, h, q, p)
               : step_along(w, BY_NUMBER, (orbits){w->n, 1, 1, 1}, t, h, q, p);
}

NEVH_SIMD static int step_vectors(nevh_work *w, double t, double h, double q[],
                                  double p[]) {
    const splitting_plan *o = w->plan;
    orbits x = {w->n, w->width, o->stride, NEVH__LANES};
    return step_along(w, BY_VECTOR, x, t, h, q, p);
}

NEVH_SIMD static int step_by_work(nevh_work *w, double t, double h, double q[],
                                  double p[]) {
    orbits x = {w->n, w->width, w->width, 1};
    return step_along(w, BY_WORK, x, t, h, q, p);
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const splitting_plan *o = w->plan;
    return (!w->planned           ? step_by_work
            : o->way == BY_VECTOR ? step_vectors
            : o->way == BY_NUMBER ? step_number
            : w->n == 1           ? step_point
            : w->n == 2           ? step_points_of_two
                                  : step_points)(w, t, h, q, p);
}

/* The gradient kept is a dH/dp, or a dH/dq that may read p unless declarations
   exclude it. */
static void apply_friction(nevh_work *w, const double factor[]) {
    const splitting_plan *o = w->plan;
    memory m = recall(w, w->size);
    for (size_t i = 0; i < w->size; i++)
        m.compensation_p[i] *= factor[i / w->width];
    if (o->first == NEVH_KICK && nevh_system_traits(w->system) & NEVH_SEPARABLE)
        return;
    for (size_t lane = 0; lane < w->width; lane++)
        m.has_kept[lane] = 0;
}

const nevh_kernel nevh_splitting_kernel = {.plan = plan,
                                           .step = step,
                                           .clear = clear,
                                           .apply_friction = apply_friction};
