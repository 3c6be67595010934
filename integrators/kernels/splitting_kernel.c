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

   The step is one text, `take_step`, which is compiled for numbers (one orbit
   whose terms have point gradients), for rows of whole vectors (orbits side by
   side, or one that is repeated over a vector), and for rows of any width with
   gradients of any kind.  All give the same bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "splitting_private.h"
#include "gradient/field_private.h"
#include "system/vector_private.h"
#include "work/work_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

/* One half of the state under way: q under drifts, p under kicks. */
typedef struct {
    double *state;  /* at the start of the step */
    double *carry;  /* digits that earlier steps lost */
    double *change; /* the increment so far */
    double *point;  /* state + (change + carry) */
} half;

/* How gradients are taken: constants of inlined functions. */
typedef enum {
    BY_NUMBER, /* planned, of one state */
    BY_VECTOR, /* planned, of rows of whole vectors */
    BY_WORK    /* by nevh_work_gradient */
} gradient_way;

/* The numbers of a step, n rows each. */
typedef struct {
    size_t stride; /* of a row */
    bool copied;   /* the state and memory, else they are where they were */
    half q, p;
    double *slope, *kept, *time; /* time: one row */
} rows;

typedef struct {
    nevh_operation first;
    size_t count; /* of kicks and drifts */
    size_t kicks;
    bool kicks_first;
    bool same_ends; /* the last operation is of the first one's kind */
    double *weights;
    double *times; /* parts of h that the half at rest has gone through */
    gradient_way way;
    double *buffer; /* holds all rows */
    rows planned, by_work;
    nevh__call kick, drift; /* unless the way is BY_WORK */
} splitting_plan;

/* What is remembered of each half, and the last slope of a step. */
typedef struct {
    double *carry_q, *carry_p, *kept, *has_kept;
} memory;

static memory recall(const nevh_work *w) {
    double *m = w->memory;
    return (memory){m, m + w->size, m + 2 * w->size, m + 3 * w->size};
}

static void clear(nevh_work *w) {
    splitting_plan *o = w->plan;
    if (!o)
        return;
    free(o->buffer);
    free(o->weights);
    free(o->times);
    free(o);
    w->plan = NULL;
}

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
static void fill(splitting_plan *o, const nevh_splitting *table) {
    double passed[2] = {0, 0};
    nevh__splitting_expand(table, o->weights);
    for (size_t i = 0; i < o->count; i++) {
        o->times[i] = passed[1 - i % 2];
        passed[i % 2] += o->weights[i];
    }
}

static half take_half(double **from, size_t size, bool copied) {
    half x = {.change = nevh__take(from, size)};
    x.point = nevh__take(from, size);
    x.state = copied ? nevh__take(from, size) : NULL;
    x.carry = copied ? nevh__take(from, size) : NULL;
    return x;
}

static rows lay_out(const nevh_work *w, size_t stride, double *from) {
    size_t size = w->n * stride;
    bool copied = stride != w->width;
    rows r = {.stride = stride, .copied = copied};
    r.q = take_half(&from, size, copied);
    r.p = take_half(&from, size, copied);
    r.slope = nevh__take(&from, size);
    r.kept = copied ? nevh__take(&from, size) : NULL;
    r.time = from;
    return r;
}

/* Rows of the width, and before them others of `stride` if that differs. */
static bool plan_rows(splitting_plan *o, const nevh_work *w, size_t stride) {
    size_t copied = stride == w->width ? 0 : (10 * w->n + 1) * stride;
    size_t size = copied + (5 * w->n + 1) * w->width + NEVH__LANES;
    free(o->buffer);
    o->buffer = nevh__array(size, sizeof *o->buffer);
    if (!o->buffer)
        return false;
    double *from = nevh__aligned(o->buffer);
    o->planned = lay_out(w, stride, from);
    o->by_work = lay_out(w, w->width, from + copied);
    return true;
}

static bool plan_calls(splitting_plan *o, const nevh_work *w) {
    const rows *r = &o->planned;
    const double *q = r->q.point, *p = r->p.point;
    nevh_field *f = w->field;
    o->kick = nevh__call_plan(f, r->stride, r->time, q, p, r->slope, NULL);
    o->drift = nevh__call_plan(f, r->stride, r->time, q, p, NULL, r->slope);
    return o->kick.count && o->drift.count;
}

/* One state is repeated over a vector where it is small and has no point
   gradients.  Returns false when memory is out. */
static bool find_way(splitting_plan *o, const nevh_work *w) {
    bool one = w->width == 1;
    o->way = BY_NUMBER;
    if (!plan_rows(o, w, w->width))
        return false;
    if (one && !w->transform && plan_calls(o, w))
        return true;
    o->way = BY_VECTOR;
    bool exact = w->field->gradient == nevh_exact;
    bool whole = w->width % NEVH__LANES == 0; /* no states to fill vectors */
    if (!w->transform && (one ? w->field->repeats : exact || whole)) {
        if (!plan_rows(o, w, nevh__padded(w->width)))
            return false;
        if (plan_calls(o, w))
            return true;
    }
    o->way = BY_WORK;
    return true;
}

static int plan(nevh_work *w) {
    const nevh_splitting *table = w->integrator->table;
    splitting_plan *o = w->plan = nevh__array(1, sizeof *o);
    if (!o)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    o->first = table->first;
    o->count = nevh__splitting_operations(table);
    o->same_ends = o->count % 2 == 1;
    o->kicks_first = o->first == NEVH_KICK;
    o->kicks = (o->count + o->kicks_first) / 2;
    o->weights = nevh__array(o->count, sizeof *o->weights);
    o->times = nevh__array(o->count, sizeof *o->times);
    if (!o->weights || !o->times || !find_way(o, w))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    fill(o, table);
    w->memory_rows = 3 * w->n + 1;
    return NEVH_OK;
}

/* One step under way. */
typedef struct {
    nevh_work *work;
    const splitting_plan *plan;
    rows rows;
    double t, h;
    bool has_kept; /* the last slope of the step before */
} context;

/* Element by element, `lanes` (a constant) at a time. */
#define EACH(i, lanes, size)                                                   \
    for (size_t i##_from = 0; i##_from < (size); i##_from += (lanes))          \
    NEVH__NO_ALIAS for (size_t i = i##_from; i != i##_from + (lanes); i++)

NEVH__INLINE void begin(size_t lanes, size_t size, const half *q,
                        const half *p) {
    EACH(i, lanes, size) {
        q->change[i] = 0;
        p->change[i] = 0;
        q->point[i] = q->state[i] + q->carry[i];
        p->point[i] = p->state[i] + p->carry[i];
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

NEVH__INLINE void set_time(const context *x, size_t i) {
    double time = x->t + x->plan->times[i] * x->h;
    for (size_t lane = 0; lane < x->rows.stride; lane++)
        x->rows.time[lane] = time;
}

/* dH/dq for a kick, or else dH/dp, to the slope. */
NEVH__INLINE int take_slope(const context *x, gradient_way way, size_t i,
                            bool kick) {
    const nevh__call *call = kick ? &x->plan->kick : &x->plan->drift;
    if (way == BY_WORK || call->timed)
        set_time(x, i);
    if (way == BY_WORK)
        return nevh_work_gradient(x->work, x->rows.stride, x->rows.time,
                                  x->rows.q.point, x->rows.p.point,
                                  kick ? x->rows.slope : NULL,
                                  kick ? NULL : x->rows.slope);
    return way == BY_NUMBER ? nevh__work_run_points(x->work, call)
                            : nevh__work_run(x->work, call);
}

static int account(const context *x, size_t i, bool kick) {
    set_time(x, i);
    return nevh_work_account(x->work, kick ? NEVH_OF_Q : NEVH_OF_P,
                             x->plan->weights[i] * x->h, x->rows.time,
                             x->rows.q.point, x->rows.p.point);
}

/* A kick, or else a drift; `kept`: by the last slope of the step before. */
NEVH__INLINE int operate(const context *x, gradient_way way, size_t lanes,
                         size_t size, size_t i, bool kick, bool kept) {
    double dt = x->plan->weights[i] * x->h;
    int status = kept ? NEVH_OK : take_slope(x, way, i, kick);
    if (way == BY_WORK && !status && x->work->accounts)
        status = account(x, i, kick);
    if (!status)
        advance(lanes, size, kick ? &x->rows.p : &x->rows.q, kick ? -dt : dt,
                kept ? x->rows.kept : x->rows.slope);
    return status;
}

/* A kick and a drift where T is that of known masses: velocities are momenta
   times `inverse`, and need not go through memory (15 to 25 % of a step of
   several kicks). */
NEVH__INLINE void operate_both(const context *x, gradient_way way, size_t lanes,
                               size_t size, size_t i) {
    const half *q = &x->rows.q, *p = &x->rows.p;
    double *restrict slope = x->rows.slope;
    const double *restrict inverse = x->plan->drift.inverse;
    double kick = -(x->plan->weights[i] * x->h);
    double drift = x->plan->weights[i + 1] * x->h;
    take_slope(x, way, i, true);
    EACH(k, lanes, size) {
        double sum = p->change[k] + kick * slope[k];
        double momentum = p->state[k] + (sum + p->carry[k]);
        double velocity = inverse[k] * momentum;
        double moved = q->change[k] + drift * velocity;
        slope[k] = velocity;
        p->change[k] = sum;
        p->point[k] = momentum;
        q->change[k] = moved;
        q->point[k] = q->state[k] + (moved + q->carry[k]);
    }
}

/* All kicks and drifts in turn. */
NEVH__INLINE int operate_all(const context *x, gradient_way way, size_t lanes,
                             size_t size) {
    size_t i = 0, count = x->plan->count;
    bool kick = x->plan->kicks_first;
    int status = NEVH_OK;
    if (x->has_kept) {
        status = kick ? operate(x, way, lanes, size, i++, true, true)
                      : operate(x, way, lanes, size, i++, false, true);
        kick = !kick;
    }
    if (!kick && !status)
        status = operate(x, way, lanes, size, i++, false, false);
    for (; !status && i + 1 < count; i += 2) {
        if (way != BY_WORK && x->plan->drift.inverse) {
            operate_both(x, way, lanes, size, i);
            continue;
        }
        status = operate(x, way, lanes, size, i, true, false);
        if (!status)
            status = operate(x, way, lanes, size, i + 1, false, false);
    }
    if (!status && i < count)
        status = operate(x, way, lanes, size, i, true, false);
    return status;
}

/* The sum of x - x over the new state, which the last points are: 0 if that is
   finite, else NaN. */
NEVH__INLINE double check(size_t lanes, size_t size, const double q[],
                          const double p[]) {
    double bad[NEVH__LANES] = {0};
    for (size_t from = 0; from < size; from += lanes)
        for (size_t i = 0; i < lanes; i++)
            bad[i] += (q[from + i] - q[from + i]) + (p[from + i] - p[from + i]);
    return lanes == 1 ? bad[0]
                      : ((bad[0] + bad[1]) + (bad[2] + bad[3])) +
                            ((bad[4] + bad[5]) + (bad[6] + bad[7]));
}

NEVH__INLINE void commit(const half *x, size_t i) {
    double start = x->state[i], d = x->change[i] + x->carry[i];
    x->carry[i] = nevh__roundoff(x->point[i], start, d);
    x->state[i] = x->point[i];
}

/* The last points are the new state; `keep`: and the last slope is kept. */
NEVH__INLINE void commit_all(const rows *r, size_t lanes, size_t size,
                             bool keep) {
    EACH(i, lanes, size) {
        commit(&r->q, i);
        commit(&r->p, i);
        if (keep)
            r->kept[i] = r->slope[i];
    }
}

static int fail(nevh_work *w) {
    return nevh_work_fail(w, NEVH_EDOM,
                          "the new state is not a finite number: take a "
                          "smaller step");
}

/* Unless NEVH_OK, the state is as it was. */
NEVH__INLINE int take_step(const context *x, gradient_way way, size_t lanes,
                           size_t size) {
    begin(lanes, size, &x->rows.q, &x->rows.p);
    int status = operate_all(x, way, lanes, size);
    if (status)
        return status;
    if (check(lanes, size, x->rows.q.point, x->rows.p.point) != 0)
        return way == BY_WORK ? fail(x->work) : NEVH_EDOM;
    if (x->plan->same_ends)
        commit_all(&x->rows, lanes, size, true);
    else
        commit_all(&x->rows, lanes, size, false);
    return NEVH_OK;
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

NEVH__INLINE void load_all(const context *x, const memory *m, const double q[],
                           const double p[]) {
    const rows *r = &x->rows;
    load(x->work, r->stride, q, r->q.state);
    load(x->work, r->stride, p, r->p.state);
    load(x->work, r->stride, m->carry_q, r->q.carry);
    load(x->work, r->stride, m->carry_p, r->p.carry);
    if (x->has_kept)
        load(x->work, r->stride, m->kept, r->kept);
}

NEVH__INLINE void store_all(const context *x, const memory *m, double q[],
                            double p[]) {
    const rows *r = &x->rows;
    store(x->work, r->stride, r->q.state, q);
    store(x->work, r->stride, r->p.state, p);
    store(x->work, r->stride, r->q.carry, m->carry_q);
    store(x->work, r->stride, r->p.carry, m->carry_p);
    if (x->plan->same_ends)
        store(x->work, r->stride, r->kept, m->kept);
}

/* Rows that are not copied are the caller's and the memory's. */
NEVH__INLINE rows bind(const rows *planned, const memory *m, double q[],
                       double p[]) {
    rows r = *planned;
    r.q.state = q;
    r.p.state = p;
    r.q.carry = m->carry_q;
    r.p.carry = m->carry_p;
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

/* A step of `width` orbits, in rows of so many lanes at least. */
NEVH__INLINE int step_along(nevh_work *w, gradient_way way, size_t width,
                            size_t lanes, double t, double h, double q[],
                            double p[]) {
    const splitting_plan *o = w->plan;
    const rows *planned = way == BY_WORK ? &o->by_work : &o->planned;
    memory m = recall(w);
    context x = {.work = w, .plan = o, .t = t, .h = h};
    bool copied = way == BY_VECTOR && planned->copied;
    x.rows = copied ? *planned : bind(planned, &m, q, p);
    x.has_kept = o->same_ends && all_kept(width, &m);
    if (copied)
        load_all(&x, &m, q, p);
    int status = way != BY_NUMBER
                     ? take_step(&x, way, lanes, w->n * x.rows.stride)
                 : w->n == 1 ? take_step(&x, way, 1, 1)
                 : w->n == 2 ? take_step(&x, way, 1, 2)
                             : take_step(&x, way, 1, w->n);
    if (status)
        return status;
    if (copied)
        store_all(&x, &m, q, p);
    if (way != BY_WORK)
        w->field->gradients +=
            (o->kicks - (x.has_kept && o->kicks_first)) * width;
    for (size_t lane = 0; o->same_ends && lane < width; lane++)
        m.has_kept[lane] = 1;
    return NEVH_OK;
}

NEVH__ONE_BY_ONE static int step_number(nevh_work *w, double t, double h,
                                        double q[], double p[]) {
    if (!nevh__field_at_hand(w->field))
        return NEVH_ESTALE;
    return step_along(w, BY_NUMBER, 1, 1, t, h, q, p);
}

NEVH_SIMD static int step_vectors(nevh_work *w, double t, double h, double q[],
                                  double p[]) {
    return step_along(w, BY_VECTOR, w->width, NEVH__LANES, t, h, q, p);
}

NEVH_SIMD static int step_by_work(nevh_work *w, double t, double h, double q[],
                                  double p[]) {
    return step_along(w, BY_WORK, w->width, 1, t, h, q, p);
}

/* A step with planned gradients; NEVH_ESTALE: it may not be taken. */
static int step_planned(nevh_work *w, double t, double h, double q[],
                        double p[]) {
    const splitting_plan *o = w->plan;
    if (o->way == BY_NUMBER)
        return step_number(w, t, h, q, p);
    return nevh__call_ready(&o->kick) && nevh__call_ready(&o->drift)
               ? step_vectors(w, t, h, q, p)
               : NEVH_ESTALE;
}

/* Where such a step fails without a reason, the other way tells it. */
static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const splitting_plan *o = w->plan;
    if (o->way != BY_WORK && !w->accounts) {
        int status = step_planned(w, t, h, q, p);
        if (!status || (status != NEVH_ESTALE && nevh__work_failed(w)))
            return status;
    }
    return step_by_work(w, t, h, q, p);
}

/* What is kept is a dH/dp, or a dH/dq that may read p, unless declarations say
   that it does not. */
static void apply_friction(nevh_work *w, const double factor[]) {
    const splitting_plan *o = w->plan;
    memory m = recall(w);
    for (size_t i = 0; i < w->size; i++)
        m.carry_p[i] *= factor[i / w->width];
    if (o->first == NEVH_KICK && nevh_system_traits(w->system) & NEVH_SEPARABLE)
        return;
    for (size_t lane = 0; lane < w->width; lane++)
        m.has_kept[lane] = 0;
}

const nevh_kernel nevh_splitting_kernel = {.plan = plan,
                                           .step = step,
                                           .clear = clear,
                                           .apply_friction = apply_friction};
