/* nevh: dH/dt by differences of the values of the terms that read t.

   The step is found as those of the variables are: how far may t move before
   the term is no longer quadratic in it, then a scan of powers of two at
   states around the start, and at times within that length.  A term that is
   quadratic in t, or in which nothing is to be seen, takes its step from the
   time in which the motion covers the lengths of its variables.

   A term that brings the derivative is asked for it, where that is finite.
   Where H ends in time, as t^1.5 does at t = 0, differences are one-sided.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "gradient/step_selection_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double reach = 2;         /* of the length, for times to try */
static const double part = 0x1p-4;     /* of the time of the motion, or of t */
static const double visible = 0x1p-17; /* of t, for a difference to be seen */

/* Adds the derivative of a filled block; its copies are the stencil. */
static int time_difference(nevh_field *f, nevh__planned *term,
                           const nevh__block *b, const nevh__time_step *step,
                           double dh_dt[]) {
    size_t apart = b->groups * b->lanes;
    for (size_t copy = 0; copy < b->copies; copy++)
        for (size_t i = copy * apart; i < (copy + 1) * apart; i++)
            f->times[i] += (double)(copy / 2 + 1) *
                           (copy % 2 ? -step->delta : step->delta);
    int status = nevh__block_values(f, term, b);
    for (size_t group = 0; !status && group < b->groups; group++) {
        size_t first = group * b->lanes;
        if (nevh__add_slopes(step->method, apart, b->lanes, f->times + first,
                             f->h + first, dh_dt + b->lane))
            status = nevh__fail(
                &f->report, NEVH_EDOM,
                "the time derivative of term \"%s\" of effect \"%s\" is not "
                "finite at t = %.9g: its step of %g is lost in a time too large",
                term->term->decl.name, term->term->decl.effect, b->t[b->lane],
                step->delta);
    }
    return status;
}

/* Lanes at once, so that what one way has added can be taken back. */
enum { LANES = 64 };

typedef struct {
    nevh_field *field;
    nevh__planned *term;
    const nevh__time_step *step;
    nevh__block lanes; /* all of its blocks */
    double *dh_dt;
} slope_task;

static nevh__block copies_of(const slope_task *task, size_t copies) {
    nevh__block b = task->lanes;
    b.copies = copies;
    return b;
}

/* Adds the term's own derivative; false if it is not finite. */
static bool add_exact(const slope_task *task) {
    nevh_field *f = task->field;
    const nevh_term *term = &task->term->term->decl;
    nevh__block b = copies_of(task, 1);
    double sum = 0;
    while (term->time_slope && nevh__block_next(f, task->term, &b)) {
        const double *q = f->rows, *p = q + task->term->nq * b.stride;
        term->time_slope(b.stride, f->times, q, p,
                         p + task->term->np * b.stride, term->params, f->h);
        for (size_t i = 0; i < b.used; i++) {
            task->dh_dt[b.lane + i % b.lanes] += f->h[i];
            sum += f->h[i] - f->h[i];
        }
    }
    return term->time_slope && sum == 0;
}

static int add_central(const slope_task *task) {
    int status = NEVH_OK;
    nevh__block b = copies_of(task, 2 * task->step->method->offsets);
    while (!status && nevh__block_next(task->field, task->term, &b))
        status = time_difference(task->field, task->term, &b, task->step,
                                 task->dh_dt);
    return status;
}

/* Adds a one-sided difference of order 4 from t; false if a value is not finite. */
static bool add_sided(const slope_task *task, double side) {
    static const double weights[] = {-25. / 12, 4, -3, 4. / 3, -0.25};
    enum { POINTS = sizeof weights / sizeof *weights };
    nevh_field *f = task->field;
    nevh__block b = copies_of(task, POINTS);
    double sum = 0;
    while (nevh__block_next(f, task->term, &b)) {
        size_t apart = b.groups * b.lanes;
        for (size_t i = 0; i < b.used; i++)
            f->times[i] += side * (double)(i / apart) * task->step->delta;
        nevh__block_evaluate(f, task->term, &b);
        for (size_t i = 0; i < b.used; i++) {
            double product = weights[i / apart] * f->h[i];
            task->dh_dt[b.lane + i % b.lanes] +=
                side * product / task->step->delta;
            sum += product - product;
        }
    }
    return sum == 0;
}

static int fail_slope(const slope_task *task) {
    const nevh_term *term = &task->term->term->decl;
    return nevh__fail(&task->field->report, NEVH_EDOM,
                      "the time derivative of term \"%s\" of effect \"%s\" is "
                      "not finite at t = %.9g, nor are differences within %.3g "
                      "to either side",
                      term->name, term->effect, task->lanes.t[task->lanes.lane],
                      4 * task->step->delta);
}

/* The first way that ends in numbers. */
static int add_slope(const slope_task *task) {
    double kept[LANES], *out = task->dh_dt + task->lanes.lane;
    size_t size = (task->lanes.until - task->lanes.lane) * sizeof *kept;
    nevh__report report = task->field->report;
    memcpy(kept, out, size);
    if (add_exact(task))
        return NEVH_OK;
    memcpy(out, kept, size);
    int status = add_central(task);
    if (!status)
        return NEVH_OK;
    memcpy(out, kept, size);
    if (!add_central(task))
        return status; /* an H that differs from call to call */
    for (int side = 1; side >= -1; side -= 2) {
        memcpy(out, kept, size);
        if (add_sided(task, side)) {
            task->field->report = report;
            return NEVH_OK;
        }
    }
    return fail_slope(task);
}

int nevh__field_time_slope(nevh_field *f, size_t i, const nevh__time_step *step,
                           size_t width, const double t[], const double q[],
                           const double p[], double dh_dt[]) {
    int status = nevh__field_ready(f);
    for (size_t lane = 0; !status && lane < width; lane += LANES) {
        slope_task is = {f, &f->terms[i], step,
                         nevh__block_over(width, t, q, p, 1, 1), dh_dt};
        is.lanes.lane = lane;
        is.lanes.until = lane + LANES < width ? lane + LANES : width;
        status = add_slope(&is);
    }
    return status;
}

/* The shortest time in which a variable moves by its length, of the samples;
   where nothing moves, the size of t, or 1. */
static double find_pace(const nevh__step_selection *e, double slopes[]) {
    nevh_field *f = e->field;
    size_t n = f->n;
    double pace = INFINITY, size = fabs(e->options->t);
    for (size_t at = 0; at < e->samples.count; at++) {
        const double *q = e->samples.q + at * n, *p = e->samples.p + at * n;
        if (nevh_field_gradient(f, 1, &e->samples.t[at], q, p, slopes + n,
                                slopes))
            continue;
        for (size_t i = 0; i < 2 * n; i++)
            pace = fmin(pace, e->length[i] / fabs(slopes[i]));
    }
    return pace > 0 && pace < INFINITY ? pace : size > 0 ? size : 1;
}

/* The shortest length of t over the lanes and instances; INFINITY where all
   are quadratic, NAN where none varies. */
static double find_length(const nevh__step_selection *e,
                          const nevh__planned *term, double pace) {
    size_t count = term->term->decl.count;
    double seen = fmax(pace, visible * fabs(e->options->t));
    double shortest = NAN, guess = exp2(floor(log2(seen)));
    nevh__step_selection here = *e;
    for (here.at = 0; here.at < e->lanes; here.at++)
        for (size_t i = 0; i < count; i += nevh__stride(count))
            shortest =
                fmin(shortest,
                     nevh__curve_length(
                         &(nevh__axis){&here, term, i, NEVH__TIME}, guess));
    return shortest;
}

/* Samples displaced at random get a time of their own. */
static void spread_times(nevh__step_selection *e, double length) {
    uint64_t random = 1;
    for (size_t at = e->neighbours; at < e->samples.count; at++)
        e->samples.t[at] =
            e->options->t + reach * length * nevh__random(&random);
}

/* The shortest step of those that the instances want; the difference of order
   2 where that is as good for all. */
static nevh__time_step time_scan(const nevh__step_selection *e,
                                 const nevh__planned *term, double length) {
    size_t count = term->term->decl.count;
    double delta[2] = {INFINITY, INFINITY}; /* of order 8, of order 2 */
    for (size_t i = 0; i < count; i += nevh__stride(count)) {
        nevh__step step = nevh__scan_line(&(nevh__axis){e, term, i, NEVH__TIME},
                                          nevh_central8, length);
        double *least = &delta[step.quadratic];
        *least = fmin(*least, step.delta);
    }
    if (delta[0] < INFINITY)
        return (nevh__time_step){nevh_central8, delta[0]};
    return (nevh__time_step){nevh_central2, delta[1]};
}

static nevh__time_step time_choose(nevh__step_selection *e,
                                   const nevh__planned *term, double pace) {
    double length = find_length(e, term, pace), size = fabs(e->options->t);
    if (isfinite(length)) {
        spread_times(e, length);
        return time_scan(e, term, length);
    }
    bool unseen = isnan(length);
    double delta = fmax(part * pace, (unseen ? visible : part) * size);
    return (nevh__time_step){unseen ? nevh_central8 : nevh_central2,
                             exp2(round(log2(delta)))};
}

/* Steps for the samples that there are, where these are shorter. */
static void choose_all(nevh__step_selection *e, double slopes[],
                       nevh__time_step steps[]) {
    const nevh_field *f = e->field;
    double pace = find_pace(e, slopes);
    for (size_t i = 0; i < f->n_terms; i++) {
        if (!f->terms[i].term->decl.time)
            continue;
        nevh__time_step step = time_choose(e, &f->terms[i], pace);
        if (!steps[i].method || step.delta < steps[i].delta)
            steps[i] = step;
    }
}

/* Around the start; then also along the orbit, which may meet what moves: but
   far from the start times themselves are coarser, and ask for longer steps. */
int nevh__field_plan_time(nevh_field *f, const nevh_options *o,
                          nevh__time_step steps[]) {
    nevh__step_selection e;
    double *slopes = nevh__array(2 * f->n, sizeof *slopes);
    int status = slopes ? nevh__step_selection_init(&e, f, o)
                        : nevh__no_memory(&f->report);
    if (!slopes)
        return status;
    if (!status) {
        nevh__find_neighbours(&e);
        choose_all(&e, slopes, steps);
        e.samples.count = e.neighbours;
        if (!nevh__find_samples(&e))
            status = nevh__no_memory(&f->report);
    }
    if (!status)
        choose_all(&e, slopes, steps);
    nevh__step_selection_clear(&e);
    free(slopes);
    return status;
}
