/* nevh: Runge-Kutta steps, one of h or as many as a tolerance needs.

   Every lane goes from t to t + h in substeps of its own; lanes that are under
   way take their slopes together.  Step control is that of E. Hairer, S. P.
   Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993), II.4:
   with err the estimate over the tolerance, a root mean square of components
   relative to max(|y|, scale),

       next = size * 0.9 err^(-1/k + 3/4 beta) err_last^beta,  beta = 1/(5k),

   where the estimate falls with size^k; between a fifth and six times of size,
   and not above it after a rejection.  Nor above what the last two steps
   predict if the estimate goes on growing as it did between them,

       next = size * 0.9 size/size_last (err_last / err^2)^(1/k)

   [K. Gustafsson, Control-theoretic techniques for stepsize selection in
   implicit Runge-Kutta methods, ACM Trans. Math. Softw. 20 (1994) 496-517]: on
   the way to a pericentre this saves most rejections.  Where H is not finite at
   a trial's stages, the trial is rejected as well.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "runge_kutta_private.h"
#include "work/work_private.h"
#include "system/system_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Lengths are without sign: done and size go from t towards t + h. */
typedef struct {
    double done;
    double size;    /* of the next substep; 0: not known */
    double step;    /* under trial: size, or what is left */
    double last;    /* err of the last accepted one; 0: there is none */
    double before;  /* its length */
    double excess;  /* substeps beyond the usual of the steps before */
    bool has_first; /* the slope at the state is known */
    bool held;      /* the last trial was rejected */
    bool ends;      /* this one ends the step */
    nevh__pace pace;
} lane_substeps;

struct nevh__adaptive {
    lane_substeps *lanes; /* width */
    size_t *under_way;    /* width */
    size_t *unknown;      /* width: those of them without a first slope */
};

/* The step of all lanes: rows of `width`. */
typedef struct {
    nevh_work *work;
    const nevh__family *family;
    double t, h;
    lane_substeps *lanes;
    double *y, *all_compensation,
        *first;           /* 2n rows: state, its compensation, its slope */
    nevh__stages trial;   /* of some lanes, their columns side by side */
    double *begin, *each; /* the trial's t and h */
    double *old;          /* the trial's state, 2n x columns as all below */
    double *compensation, *next, *next_compensation, *change, *error, *coarse;
} step_state;

static const double least_error = 1e-4; /* that is remembered */
/* A single step may take NEVH__MOST_SUBSTEPS, one after another may not. */
static const double usual_substeps = 1e5;
enum { ROWS = 11 }; /* of 2n x width, in a step */

static nevh__adaptive *plan_of(const nevh_work *w) {
    return ((const nevh__stages_plan *)w->plan)->adaptive;
}

void nevh__adaptive_clear(nevh_work *w) {
    nevh__adaptive *a = plan_of(w);
    if (!a)
        return;
    free(a->lanes);
    free(a->under_way);
    free(a->unknown);
    free(a);
}

/* Memory: compensation, size, err and length of the last one, the excess; where the last stage is
   the next first one, also that slope and whether it is there. */
int nevh__adaptive_plan(nevh_work *w) {
    nevh__stages_plan *plan = w->plan;
    const nevh__family *family = &plan->family;
    int status = nevh_work_find_scale(w);
    if (status)
        return status;
    nevh__adaptive *a = plan->adaptive = nevh__array(1, sizeof *a);
    if (!a)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    a->lanes = nevh__array(w->width, sizeof *a->lanes);
    a->under_way = nevh__array(w->width, sizeof *a->under_way);
    a->unknown = nevh__array(w->width, sizeof *a->unknown);
    if (!a->lanes || !a->under_way || !a->unknown)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = 2 * w->n + 4;
    if (family->last_is_first)
        w->memory_rows += 2 * w->n + 1;
    w->scratch_size = ROWS * 2 * w->size + 2 * w->width;
    return NEVH_OK;
}

static step_state lay_out(nevh_work *w, double t, double h) {
    const nevh__stages_plan *plan = w->plan;
    step_state s = {.work = w,
                    .family = &plan->family,
                    .t = t,
                    .h = h,
                    .lanes = plan->adaptive->lanes};
    size_t each = 2 * w->size;
    double *at = w->scratch;
    double **const rows[ROWS] = {&s.y,
                                 &s.all_compensation,
                                 &s.first,
                                 &s.old,
                                 &s.compensation,
                                 &s.next,
                                 &s.next_compensation,
                                 &s.error,
                                 &s.coarse,
                                 &s.change,
                                 &s.trial.slope};
    for (int i = 0; i < ROWS; i++, at += each)
        *rows[i] = at;
    s.begin = at;
    s.each = s.begin + w->width;
    s.trial.work = w;
    s.trial.t = s.begin;
    s.trial.h = s.each;
    s.trial.q = s.old;
    s.trial.compensation = s.compensation;
    return s;
}

static void load(step_state *s, const double q[], const double p[]) {
    const nevh_work *w = s->work;
    size_t n = w->size, width = w->width;
    const double *size = w->memory + 2 * n, *last = size + width;
    const double *before = last + width, *excess = before + width;
    const double *first = excess + width, *has_first = first + 2 * n;
    bool keeps = s->family->last_is_first;
    memcpy(s->y, q, n * sizeof *q);
    memcpy(s->y + n, p, n * sizeof *p);
    memcpy(s->all_compensation, w->memory, 2 * n * sizeof *s->all_compensation);
    if (keeps)
        memcpy(s->first, first, 2 * n * sizeof *first);
    for (size_t lane = 0; lane < width; lane++)
        s->lanes[lane] =
            (lane_substeps){.size = size[lane],
                            .last = last[lane],
                            .before = before[lane],
                            .excess = excess[lane],
                            .has_first = keeps && has_first[lane] != 0};
}

static void store(const step_state *s, double q[], double p[]) {
    const nevh_work *w = s->work;
    size_t n = w->size, width = w->width;
    double *size = w->memory + 2 * n, *last = size + width;
    double *before = last + width, *excess = before + width;
    double *first = excess + width, *has_first = first + 2 * n;
    bool keeps = s->family->last_is_first;
    memcpy(q, s->y, n * sizeof *q);
    memcpy(p, s->y + n, n * sizeof *p);
    memcpy(w->memory, s->all_compensation, 2 * n * sizeof *s->all_compensation);
    if (keeps)
        memcpy(first, s->first, 2 * n * sizeof *first);
    for (size_t lane = 0; lane < width; lane++) {
        size[lane] = s->lanes[lane].size;
        last[lane] = s->lanes[lane].last;
        before[lane] = s->lanes[lane].before;
        excess[lane] =
            fmax(0, s->lanes[lane].excess + s->lanes[lane].pace.substeps -
                        usual_substeps);
        if (keeps)
            has_first[lane] = s->lanes[lane].has_first;
    }
}

/* Columns of the lanes, out of rows of all and back. */
static void gather(const step_state *s, const size_t lanes[],
                   const double all[], double out[]) {
    size_t columns = s->trial.columns, width = s->work->width;
    for (size_t k = 0; k < 2 * s->work->n; k++)
        for (size_t c = 0; c < columns; c++)
            out[k * columns + c] = all[k * width + lanes[c]];
}

static void scatter(const step_state *s, size_t column, size_t lane,
                    const double from[], double all[]) {
    size_t columns = s->trial.columns, width = s->work->width;
    for (size_t k = 0; k < 2 * s->work->n; k++)
        all[k * width + lane] = from[k * columns + column];
}

static void gather_states(step_state *s, size_t count, const size_t lanes[]) {
    s->trial.columns = count;
    s->trial.p = s->old + s->work->n * count;
    gather(s, lanes, s->y, s->old);
    gather(s, lanes, s->all_compensation, s->compensation);
    for (size_t c = 0; c < count; c++) {
        const lane_substeps *l = &s->lanes[lanes[c]];
        s->begin[c] = s->t + copysign(l->done, s->h);
        s->each[c] = copysign(l->step, s->h);
    }
}

/* The slopes at the states of those lanes that do not know them. */
static int take_first_slopes(step_state *s, size_t count,
                             const size_t lanes[]) {
    size_t *unknown = plan_of(s->work)->unknown, some = 0;
    for (size_t i = 0; i < count; i++)
        if (!s->lanes[lanes[i]].has_first)
            unknown[some++] = lanes[i];
    if (some == 0)
        return NEVH_OK;
    gather_states(s, some, unknown);
    int status = s->family->take(&s->trial, 0, 1);
    for (size_t c = 0; c < some; c++) {
        scatter(s, c, unknown[c], s->trial.slope, s->first);
        s->lanes[unknown[c]].has_first = true;
    }
    return status;
}

double nevh__first_substep(const nevh_work *w, int power, double h,
                           size_t stride, const double y[],
                           const double slopes[]) {
    double sum = 0;
    for (size_t i = 0; i < 2 * w->n; i++) {
        double rate =
            slopes[i * stride] / fmax(fabs(y[i * stride]), w->scale[i]);
        sum += rate * rate;
    }
    double rate = sqrt(sum / (2 * (double)w->n));
    double size = 0.5 * pow(w->options->tolerance, 1. / power) / rate;
    return size <= DBL_MAX ? size : fabs(h);
}

/* The root mean square of estimates over max(|y|, scale), squared. */
static double square(const step_state *s, size_t column,
                     const double estimate[]) {
    const nevh_work *w = s->work;
    double sum = 0;
    for (size_t k = 0; k < 2 * w->n; k++) {
        size_t i = k * s->trial.columns + column;
        double most = fmax(fabs(s->old[i]), fabs(s->next[i]));
        double x = estimate[i] / fmax(most, w->scale[k]);
        sum += x * x;
    }
    return sum / (2 * (double)w->n);
}

/* The estimate over the tolerance; NaN where it is beyond numbers. */
static double judge(const step_state *s, size_t column) {
    double error = square(s, column, s->error), all = error;
    if (s->family->coarse)
        all += 0.01 * square(s, column, s->coarse);
    double err = s->family->coarse && all > 0 ? error / sqrt(all) : sqrt(error);
    return err / s->work->options->tolerance;
}

static int give_up(const step_state *s, const lane_substeps *l,
                   const char *why) {
    const nevh_work *w = s->work;
    return nevh_work_fail(s->work, NEVH_EFAILED,
                          "%s gave up at t = %.9g: the step of %g takes %s at "
                          "a tolerance of %g",
                          w->integrator->name, s->t + copysign(l->done, s->h),
                          s->h, why, w->options->tolerance);
}

static bool too_short(const step_state *s, const lane_substeps *l) {
    return !(l->size > DBL_EPSILON * fabs(s->h)) && l->size < fabs(s->h);
}

/* How much longer the next substep may be. */
static double factor(const step_state *s, const lane_substeps *l, double err) {
    double k = s->family->error_power, beta = 0.2 / k, now = log2(err);
    double last = log2(l->last > 0 ? l->last : least_error);
    double usual = (0.75 * beta - 1 / k) * now + beta * last;
    if (!(l->last > 0))
        return 0.9 * exp2(usual);
    double growing = log2(l->step / l->before) + (last - 2 * now) / k;
    return 0.9 * exp2(fmin(usual, growing));
}

/* Near the end of an orbit the times themselves may be too coarse for a shorter
   substep: it would be rejected for ever. */
static int reject(const step_state *s, lane_substeps *l, double err) {
    double wanted = 0.9 * pow(err, -1. / s->family->error_power);
    l->size = l->step * (wanted > 0.2 ? fmin(wanted, 0.9) : 0.2);
    l->held = true;
    bool shorter = l->done + l->size < l->done + l->step;
    return too_short(s, l) || !shorter
               ? give_up(s, l, "substeps too short to be taken")
               : NEVH_OK;
}

/* A substep cut short by the end of the step says nothing against longer
   ones. */
static int accept(step_state *s, size_t column, size_t lane, double err) {
    lane_substeps *l = &s->lanes[lane];
    double next = l->step * fmin(fmax(factor(s, l, err), 0.2), l->held ? 1 : 6);
    l->size = l->ends ? fmax(next, l->size) : next;
    l->done = l->ends ? fabs(s->h) : l->done + l->step;
    l->last = fmax(err, least_error);
    l->before = l->step;
    l->held = false;
    l->has_first = s->family->last_is_first;
    scatter(s, column, lane, s->next, s->y);
    scatter(s, column, lane, s->next_compensation, s->all_compensation);
    if (l->has_first)
        scatter(s, column, lane, s->trial.slope, s->first);
    return s->work->accounts ? s->family->account(&s->trial) : NEVH_OK;
}

/* Stages, estimates and new states of a trial. */
static int take_trial(step_state *s, size_t count, const size_t lanes[]) {
    const nevh__family *family = s->family;
    nevh__stages *trial = &s->trial;
    size_t n = s->work->n * count;
    gather_states(s, count, lanes);
    gather(s, lanes, s->first, trial->slope);
    int status = family->take(trial, 1, family->stages);
    if (!status)
        status = family->finish(trial, s->change, s->error, s->coarse);
    if (status)
        return status;
    memcpy(s->next, s->old, 2 * n * sizeof *s->next);
    memcpy(s->next_compensation, s->compensation,
           2 * n * sizeof *s->next_compensation);
    return nevh_work_commit(s->work, n, s->next, s->change,
                            s->next_compensation, s->next + n, s->change + n,
                            s->next_compensation + n);
}

/* One substep of each of the lanes, accepted or not.  Where together they
   fail, each goes alone, so that none depends on its neighbours. */
static int try(step_state *s, size_t count, const size_t lanes[]) {
    int status = take_trial(s, count, lanes);
    if (status == NEVH_EDOM && count > 1) {
        status = NEVH_OK;
        for (size_t i = 0; !status && i < count; i++)
            status = try(s, 1, lanes + i);
        return status;
    }
    if (status == NEVH_EDOM) {
        lane_substeps *l = &s->lanes[*lanes];
        l->size = 0.2 * l->step;
        l->held = true;
        return too_short(s, l) ? status : NEVH_OK;
    }
    for (size_t c = 0; !status && c < count; c++) {
        double err = judge(s, c);
        status = err <= 1 ? accept(s, c, lanes[c], err)
                          : reject(s, &s->lanes[lanes[c]], err);
    }
    return status;
}

/* The next substep; the last one may stretch by a hundredth. */
static int choose(const step_state *s, size_t lane) {
    lane_substeps *l = &s->lanes[lane];
    double length = fabs(s->h), left = length - l->done;
    if (l->size == 0)
        l->size =
            nevh__first_substep(s->work, s->family->error_power, s->h,
                                s->work->width, s->y + lane, s->first + lane);
    if (too_short(s, l))
        return give_up(s, l, "substeps too short to be taken");
    char why[NEVH__WHY];
    if (nevh__too_many(&l->pace, fabs(s->h), l->done, why))
        return give_up(s, l, why);
    if (l->excess + l->pace.substeps > NEVH__MOST_SUBSTEPS)
        return give_up(s, l,
                       "more than 100000 substeps, as do those before it,");
    double next = l->done + l->size; /* so that the sum of steps is exact */
    l->ends = 1.01 * l->size >= left;
    l->step = l->ends ? left : next - l->done;
    return NEVH_OK;
}

static int adaptive_step(nevh_work *w, double t, double h, double q[],
                         double p[]) {
    size_t *lanes = plan_of(w)->under_way, count;
    step_state s = lay_out(w, t, h);
    int status = NEVH_OK;
    if (w->accounts && w->width > 1)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "the balance of the energy under step control is "
                              "kept for one orbit, not for %zu side by side",
                              w->width);
    load(&s, q, p);
    do {
        count = 0;
        for (size_t lane = 0; lane < w->width; lane++)
            if (s.lanes[lane].done < fabs(h))
                lanes[count++] = lane;
        status = take_first_slopes(&s, count, lanes);
        for (size_t i = 0; !status && i < count; i++)
            status = choose(&s, lanes[i]);
        if (!status && count)
            status = try(&s, count, lanes);
    } while (!status && count);
    if (!status)
        store(&s, q, p);
    return status;
}

/* One step of h.  A last stage that is the next step's first is left to that
   step: its weight is 0. */
static int step_once(nevh_work *w, const nevh__family *family, double t,
                     double h, double q[], double p[]) {
    size_t n = w->size, width = w->width;
    double *change = w->scratch, *times = change + 2 * n;
    nevh__stages s = {.work = w,
                      .columns = width,
                      .t = times,
                      .h = times + width,
                      .q = q,
                      .p = p,
                      .compensation = w->memory};
    for (size_t lane = 0; lane < width; lane++) {
        times[lane] = t;
        times[width + lane] = h;
    }
    int status = family->take(&s, 0, family->stages - family->last_is_first);
    if (!status)
        status = family->finish(&s, change, NULL, NULL);
    if (!status && w->accounts)
        status = family->account(&s);
    return status ? status
                  : nevh_work_commit(w, n, q, change, w->memory, p, change + n,
                                     w->memory + n);
}

int nevh__stages_step(nevh_work *w, double t, double h, double q[],
                      double p[]) {
    const nevh__stages_plan *plan = w->plan;
    return plan->adaptive ? adaptive_step(w, t, h, q, p)
                          : step_once(w, &plan->family, t, h, q, p);
}
