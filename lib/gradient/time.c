/* nevh: dH/dt by differences of the values of the terms that read t.

   The step is found as those of the variables are: how far may t move before
   the term is no longer quadratic in it, then a ladder of powers of two at
   states around the start, and at times within that length.  A term that is
   quadratic in t, or in which nothing is to be seen, takes its step from the
   time in which the motion covers the lengths of its variables.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/explore_private.h"
#include <math.h>
#include <stdlib.h>

static const double reach = 2;         /* of the length, for times to try */
static const double part = 0x1p-4;     /* of the time of the motion, or of t */
static const double visible = 0x1p-17; /* of t, for a difference to be seen */

/* Adds the derivative of a filled block; its copies are the stencil. */
static int difference(nevh_field *f, nevh__planned *term, const nevh__block *b,
                      const nevh__time_step *step, double dh_dt[]) {
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
                term->term->is.name, term->term->is.effect, b->t[b->lane],
                step->delta);
    }
    return status;
}

int nevh__field_time_slope(nevh_field *f, size_t i, const nevh__time_step *step,
                           size_t width, const double t[], const double q[],
                           const double p[], double dh_dt[]) {
    int status = nevh__field_ready(f);
    nevh__block b =
        nevh__block_over(width, t, q, p, 2 * step->method->offsets, 1);
    while (!status && nevh__block_next(f, &f->terms[i], &b))
        status = difference(f, &f->terms[i], &b, step, dh_dt);
    return status;
}

/* The shortest time in which a variable moves by its length, of the samples;
   where nothing moves, the size of t, or 1. */
static double find_pace(const nevh__explorer *e, double slopes[]) {
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
static double find_length(const nevh__explorer *e, const nevh__planned *term,
                          double pace) {
    size_t count = term->term->is.count;
    double seen = fmax(pace, visible * fabs(e->options->t));
    double shortest = NAN, guess = exp2(floor(log2(seen)));
    nevh__explorer here = *e;
    for (here.at = 0; here.at < e->lanes; here.at++)
        for (size_t i = 0; i < count; i += nevh__stride(count))
            shortest = fmin(shortest, nevh__curve_length(&here, term, i,
                                                         NEVH__TIME, guess));
    return shortest;
}

/* Samples displaced at random get a time of their own. */
static void spread_times(nevh__explorer *e, double length) {
    uint64_t random = 1;
    for (size_t at = e->neighbours; at < e->samples.count; at++)
        e->samples.t[at] =
            e->options->t + reach * length * nevh__random(&random);
}

/* The shortest step of those that the instances want; the difference of order
   2 where that is as good for all. */
static nevh__time_step climb(const nevh__explorer *e, const nevh__planned *term,
                             double length) {
    size_t count = term->term->is.count;
    double delta[2] = {INFINITY, INFINITY}; /* of order 8, of order 2 */
    for (size_t i = 0; i < count; i += nevh__stride(count)) {
        nevh__step step =
            nevh__climb_along(e, nevh_central8, term, i, NEVH__TIME, length);
        double *least = &delta[step.quadratic];
        *least = fmin(*least, step.delta);
    }
    if (delta[0] < INFINITY)
        return (nevh__time_step){nevh_central8, delta[0]};
    return (nevh__time_step){nevh_central2, delta[1]};
}

static nevh__time_step choose(nevh__explorer *e, const nevh__planned *term,
                              double pace) {
    double length = find_length(e, term, pace), size = fabs(e->options->t);
    if (isfinite(length)) {
        spread_times(e, length);
        return climb(e, term, length);
    }
    bool unseen = isnan(length);
    double delta = fmax(part * pace, (unseen ? visible : part) * size);
    return (nevh__time_step){unseen ? nevh_central8 : nevh_central2,
                             exp2(round(log2(delta)))};
}

/* Steps for the samples that there are, where these are shorter. */
static void choose_all(nevh__explorer *e, double slopes[],
                       nevh__time_step steps[]) {
    const nevh_field *f = e->field;
    double pace = find_pace(e, slopes);
    for (size_t i = 0; i < f->n_terms; i++) {
        if (!f->terms[i].term->is.time)
            continue;
        nevh__time_step step = choose(e, &f->terms[i], pace);
        if (!steps[i].method || step.delta < steps[i].delta)
            steps[i] = step;
    }
}

/* Around the start; then also along the orbit, which may meet what moves: but
   far from the start times themselves are coarser, and ask for longer steps. */
int nevh__field_plan_time(nevh_field *f, const nevh_options *o,
                          nevh__time_step steps[]) {
    nevh__explorer e;
    double *slopes = nevh__array(2 * f->n, sizeof *slopes);
    int status = slopes ? nevh__explorer_open(&e, f, o)
                        : nevh__fail(&f->report, NEVH_ENOMEM, "out of memory");
    if (!slopes)
        return status;
    if (!status) {
        nevh__find_neighbours(&e);
        choose_all(&e, slopes, steps);
        e.samples.count = e.neighbours;
        if (!nevh__find_samples(&e))
            status = nevh__fail(&f->report, NEVH_ENOMEM, "out of memory");
    }
    if (!status)
        choose_all(&e, slopes, steps);
    nevh__explorer_close(&e);
    free(slopes);
    return status;
}
