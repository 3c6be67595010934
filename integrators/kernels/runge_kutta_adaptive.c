/* nevh: Runge-Kutta steps, one of h or as many as a tolerance needs.

   Lanes that are under way take their slopes together; each has substeps of its
   own, adaptive_step.h.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "adaptive_step.h"
#include "runge_kutta_private.h"
#include "work/work_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct nevh__adaptive {
    nevh__adaptive_rule rule;
    nevh__substeps *lanes; /* width */
    size_t *under_way;     /* width */
    size_t *unknown;       /* width: those of them without a first slope */
    double *scale;         /* 2n: of one lane */
};

/* The step of all lanes: rows of `width`. */
typedef struct {
    nevh_work *work;
    const nevh__family *family;
    const nevh__adaptive_rule *rule;
    double t, h;
    nevh__substeps *lanes;
    double *y, *all_compensation,
        *first;           /* 2n rows: state, its compensation, its slope */
    nevh__stages trial;   /* of some lanes, their columns side by side */
    double *begin, *each; /* the trial's t and h */
    double *old;          /* the trial's state, 2n x columns as all below */
    double *compensation, *next, *next_compensation, *change, *error, *coarse;
} step_state;

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
    free(a->scale);
    free(a);
}

const nevh__adaptive_rule *nevh__adaptive_rule_of(const nevh_work *w) {
    return &plan_of(w)->rule;
}

static nevh__adaptive_rule rule_of(const nevh_work *w,
                                   const nevh__family *family) {
    double k = family->error_power, tolerance = w->options->tolerance;
    return (nevh__adaptive_rule){.size = 2 * w->n,
                                 .power = k,
                                 .coarse = family->coarse,
                                 .keeps = family->last_is_first,
                                 .tolerance = tolerance,
                                 .part = 0.5 * nevh_simd_pow(tolerance, 1. / k),
                                 .scale = w->scale};
}

double nevh__first_substep(const nevh_work *w, int power, double h,
                           size_t stride, const double y[],
                           const double slopes[]) {
    const nevh__family family = {.error_power = power};
    nevh__adaptive_rule rule = rule_of(w, &family);
    return nevh__substeps_first(&rule, h, stride, y, slopes);
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
    a->rule = rule_of(w, family);
    a->lanes = nevh__array(w->width, sizeof *a->lanes);
    a->under_way = nevh__array(w->width, sizeof *a->under_way);
    a->unknown = nevh__array(w->width, sizeof *a->unknown);
    a->scale = nevh__array(2 * w->n, sizeof *a->scale);
    if (!a->lanes || !a->under_way || !a->unknown || !a->scale)
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
                    .rule = &plan->adaptive->rule,
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
            (nevh__substeps){.size = size[lane],
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
        excess[lane] = nevh__substeps_excess(&s->lanes[lane]);
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
    if (s->work->field->lanes)
        nevh__field_choose(s->work->field, count, lanes);
    s->trial.columns = count;
    s->trial.p = s->old + s->work->n * count;
    gather(s, lanes, s->y, s->old);
    gather(s, lanes, s->all_compensation, s->compensation);
    for (size_t c = 0; c < count; c++) {
        const nevh__substeps *l = &s->lanes[lanes[c]];
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

/* The rule, with the lane's scale. */
static nevh__adaptive_rule rule_in(const step_state *s, size_t lane) {
    const nevh_work *w = s->work;
    nevh__adaptive_rule rule = *s->rule;
    rule.scale = nevh__field_lane_scale(w->field, lane, plan_of(w)->scale);
    return rule;
}

static int give_up(const step_state *s, const nevh__substeps *l,
                   const char *why) {
    const nevh_work *w = s->work;
    return nevh_work_fail(s->work, NEVH_EFAILED,
                          "%s gave up at t = %.9g: the step of %g takes %s at "
                          "a tolerance of %g",
                          w->integrator->name, s->t + copysign(l->done, s->h),
                          s->h, why, w->options->tolerance);
}

static int reject(const step_state *s, nevh__substeps *l, double err) {
    return nevh__substeps_reject(s->rule, l, s->h, err)
               ? NEVH_OK
               : give_up(s, l, "substeps too short to be taken");
}

static int accept(step_state *s, size_t column, size_t lane, double err) {
    nevh__substeps *l = &s->lanes[lane];
    nevh__substeps_accept(s->rule, l, s->h, err);
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
    if (status == NEVH_EDOM)
        return nevh__substeps_retreat(&s->lanes[*lanes], s->h) ? NEVH_OK
                                                               : status;
    for (size_t c = 0; !status && c < count; c++) {
        const nevh__adaptive_rule rule = rule_in(s, lanes[c]);
        double err = nevh__substeps_judge(
            &rule, count, s->error + c, s->coarse + c, s->old + c, s->next + c);
        status = err <= 1 ? accept(s, c, lanes[c], err)
                          : reject(s, &s->lanes[lanes[c]], err);
    }
    return status;
}

static int choose(const step_state *s, size_t lane) {
    nevh__substeps *l = &s->lanes[lane];
    const nevh__adaptive_rule rule = rule_in(s, lane);
    if (l->size == 0)
        l->size = nevh__substeps_first(&rule, s->h, s->work->width, s->y + lane,
                                       s->first + lane);
    if (nevh__substeps_too_short(l, s->h))
        return give_up(s, l, "substeps too short to be taken");
    char why[NEVH__WHY];
    if (nevh__too_many(&l->pace, fabs(s->h), l->done, why))
        return give_up(s, l, why);
    if (nevh__substeps_exceed(l))
        return give_up(s, l,
                       "more than 100000 substeps, as do those before it,");
    nevh__substeps_choose(l, s->h);
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
