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
#include <nevh/extend.h>
#include <string.h>

/* One half of the state under way: q under drifts, p under kicks. */
typedef struct {
    double *start;   /* the state at the start of the step */
    double *change;  /* its increment so far */
    double *carry;   /* lost digits of earlier steps */
    double *point;   /* start + (change + carry) */
    double fraction; /* of h that has passed for it */
} half;

typedef struct {
    half q, p;
    double *slope, *kept, *has_kept, *time;
} layout;

static layout lay_out(const nevh_work *w, double q[], double p[]) {
    double *m = w->memory, *s = w->scratch;
    size_t n = w->size;
    return (layout){.q = {q, s, m, s + n, 0},
                    .p = {p, s + 2 * n, m + n, s + 3 * n, 0},
                    .slope = s + 4 * n,
                    .time = s + 5 * n,
                    .kept = m + 2 * n,
                    .has_kept = m + 3 * n};
}

static int plan(nevh_work *w) {
    w->memory_rows = 3 * w->n + 1;
    w->scratch_size = 5 * w->size + w->width;
    return NEVH_OK;
}

static void begin(const nevh_work *w, half *x) {
    for (size_t i = 0; i < w->size; i++) {
        x->change[i] = 0;
        x->point[i] = x->start[i] + x->carry[i];
    }
}

static void advance(const nevh_work *w, half *x, double step,
                    const double slope[]) {
    for (size_t i = 0; i < w->size; i++) {
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

/* A kick takes dH/dq at the drifts' time, a drift dH/dp at the kicks'. */
static int operate(nevh_work *w, layout *l, nevh_operation operation, double t,
                   double h, double weight, bool kept) {
    bool kick = operation == NEVH_KICK;
    half *moves = kick ? &l->p : &l->q, *rests = kick ? &l->q : &l->p;
    for (size_t lane = 0; lane < w->width; lane++)
        l->time[lane] = t + rests->fraction * h;
    int status = kept ? NEVH_OK
                      : nevh_work_gradient(w, w->width, l->time, l->q.point,
                                           l->p.point, kick ? l->slope : NULL,
                                           kick ? NULL : l->slope);
    if (!status)
        status = nevh_work_account(w, kick ? NEVH_OF_Q : NEVH_OF_P, weight * h,
                                   l->time, l->q.point, l->p.point);
    if (status)
        return status;
    advance(w, moves, (kick ? -weight : weight) * h, kept ? l->kept : l->slope);
    moves->fraction += weight;
    return NEVH_OK;
}

static void keep(const nevh_work *w, const layout *l) {
    memcpy(l->kept, l->slope, w->size * sizeof *l->kept);
    for (size_t lane = 0; lane < w->width; lane++)
        l->has_kept[lane] = 1;
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    const nevh_splitting *table = w->integrator->table;
    layout l = lay_out(w, q, p);
    begin(w, &l.q);
    begin(w, &l.p);
    bool same_ends = table->count % 2 == 1 && table->count > 1;
    bool kept = same_ends && all_kept(w, &l);
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < table->count; i++)
        status = operate(w, &l, i % 2 ? !table->first : table->first, t, h,
                         table->weights[i], i == 0 && kept);
    if (!status)
        status = nevh_work_commit(w, w->size, q, l.q.change, l.q.carry, p,
                                  l.p.change, l.p.carry);
    if (!status && same_ends)
        keep(w, &l);
    return status;
}

/* A kept dT/dp is of another p. */
static void damp(nevh_work *w, const double factor[]) {
    const nevh_splitting *table = w->integrator->table;
    layout l = lay_out(w, NULL, NULL);
    for (size_t i = 0; i < w->size; i++)
        l.p.carry[i] *= factor[i / w->width];
    for (size_t lane = 0; table->first == NEVH_DRIFT && lane < w->width; lane++)
        l.has_kept[lane] = 0;
}

const nevh_kernel nevh_splitting_kernel = {
    .plan = plan, .step = step, .damp = damp};
