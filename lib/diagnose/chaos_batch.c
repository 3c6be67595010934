/* nevh: chaos of many orbits side by side.

   All starts take steps together; each has its own clock, and is looked at after
   as many steps as if it were alone.  Where a step of all fails, each start
   takes it apart from the others, in copies that fill all lanes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include "run/stepper_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    LOOKS_TOGETHER = 64
}; /* looks until the next orbit is asked for again */

/* The states that are stepped: those of the analysis, or a copy. */
typedef struct {
    double *q, *p, *memory;
} columns;

typedef struct {
    bool busy;
    uint64_t member;
    double last; /* steps */
    nevh__report report;
} orbit;

struct nevh__chaos_batch {
    const nevh__chaos_jobs *jobs;
    orbit *orbits;
    columns kept;
    double *state; /* 2n */
    double taken;  /* steps, by all together */
    size_t stride;
    bool stopped;
};

bool nevh__chaos_batch_plan(nevh_chaos *c) {
    size_t size = 2 * c->n * c->width;
    nevh__chaos_batch *x = c->batch = nevh__array(1, sizeof *x);
    if (!x)
        return false;
    x->orbits = nevh__array(c->starts, sizeof *x->orbits);
    x->kept.q = nevh__array(size, sizeof(double));
    x->kept.p = nevh__array(size, sizeof(double));
    x->kept.memory =
        nevh__array(c->stepper->rows * c->width + 1, sizeof(double));
    x->state = nevh__array(2 * c->n, sizeof(double));
    return x->orbits && x->kept.q && x->kept.p && x->kept.memory && x->state;
}

void nevh__chaos_batch_free(nevh__chaos_batch *x) {
    if (!x)
        return;
    free(x->orbits);
    free(x->kept.q);
    free(x->kept.p);
    free(x->kept.memory);
    free(x->state);
    free(x);
}

/* Lanes. */

static columns own_columns(const nevh_chaos *c) {
    return (columns){c->q, c->p, c->stepper->work.memory};
}

static size_t chaos_batch_rows_of(const nevh_chaos *c) {
    return c->tangent ? 2 * c->n : c->n;
}

static void copy_all(const nevh_chaos *c, columns from, columns to) {
    size_t bytes = chaos_batch_rows_of(c) * c->width * sizeof(double);
    memcpy(to.q, from.q, bytes);
    memcpy(to.p, from.p, bytes);
    memcpy(to.memory, from.memory,
           c->stepper->rows * c->width * sizeof(double));
}

static void copy_columns(const nevh_chaos *c, size_t rows, const double *from,
                         size_t a, double *to, size_t b) {
    for (size_t k = 0; k < rows; k++)
        memmove(to + k * c->width + b * c->lanes,
                from + k * c->width + a * c->lanes, c->lanes * sizeof *to);
}

static void copy_start(const nevh_chaos *c, columns from, size_t a, columns to,
                       size_t b) {
    copy_columns(c, chaos_batch_rows_of(c), from.q, a, to.q, b);
    copy_columns(c, chaos_batch_rows_of(c), from.p, a, to.p, b);
    copy_columns(c, c->stepper->rows, from.memory, a, to.memory, b);
}

static void chaos_batch_forget(nevh_chaos *c, size_t start) {
    double *memory = c->stepper->work.memory + start * c->lanes;
    for (size_t row = 0; row < c->stepper->rows; row++)
        memset(memory + row * c->width, 0, c->lanes * sizeof *memory);
}

/* Steps. */

static double time_now(const nevh_chaos *c) {
    return c->t_start + c->batch->taken * c->way * c->dt;
}

/* The lanes belong to the memory as it is. */
static void chaos_batch_settle(nevh_chaos *c) {
    c->stepper->last_t = time_now(c);
    nevh__remember(c->stepper, c->q, c->p);
}

static int chaos_batch_take_steps(nevh_chaos *c, double steps) {
    return nevh_run(c->stepper, time_now(c), c->way * c->dt, (size_t)steps,
                    c->q, c->p, NULL, 0);
}

/* From the states that are kept. */
static void step_apart(nevh_chaos *c, double steps) {
    nevh__chaos_batch *x = c->batch;
    columns own = own_columns(c);
    for (size_t i = 0; i < c->starts; i++) {
        if (!x->orbits[i].busy)
            continue;
        for (size_t k = 0; k < c->starts; k++)
            copy_start(c, x->kept, i, own, k);
        nevh__chaos_fill_up(c);
        chaos_batch_settle(c);
        if (chaos_batch_take_steps(c, steps))
            x->orbits[i].report = c->stepper->report;
        else
            copy_start(c, own, i, x->kept, i);
    }
    copy_all(c, x->kept, own);
    x->taken += steps;
    chaos_batch_settle(c);
    x->taken -= steps;
}

static void pass_steps(nevh_chaos *c, double steps) {
    nevh__chaos_batch *x = c->batch;
    x->taken += steps;
    for (size_t i = 0; i < c->starts; i++)
        if (x->orbits[i].busy)
            c->start[i].clock.done += steps;
}

/* As far as all can go.  Returns how many steps. */
static double step_on(nevh_chaos *c, double steps) {
    nevh_stepper *s = c->stepper;
    s->taken = 0;
    nevh__advance_unseen(s, time_now(c), c->way * c->dt, (size_t)steps, c->q,
                         c->p);
    pass_steps(c, (double)s->taken);
    return (double)s->taken;
}

/* Lanes that were changed since the last step have lost their memory. */
static void step_together(nevh_chaos *c, double steps) {
    bool plain = nevh__steps_are_plain(c->stepper);
    if (plain)
        steps -= step_on(c, steps);
    if (!steps)
        return;
    if (!plain &&
        !nevh__begin(c->stepper, time_now(c), c->way * c->dt, c->q, c->p))
        chaos_batch_settle(c);
    copy_all(c, own_columns(c), c->batch->kept);
    if (plain || chaos_batch_take_steps(c, steps))
        step_apart(c, steps);
    pass_steps(c, steps);
}

/* Steps since the last multiple of the stride. */
static double steps_since(const nevh_chaos *c, size_t start) {
    uint64_t done = (uint64_t)c->start[start].clock.done;
    return (double)(done % c->batch->stride);
}

/* Until the next look at a start. */
static double steps_to_look(const nevh_chaos *c, size_t start) {
    double left = c->batch->orbits[start].last - c->start[start].clock.done;
    return fmin(left, (double)c->batch->stride - steps_since(c, start));
}

/* Steps of some ten milliseconds, after which the run may have to end. */
static double most_steps(const nevh_chaos *c) {
    static const double most_numbers = 1 << 20;
    return fmax(
        1, floor(most_numbers / (double)(chaos_batch_rows_of(c) * c->width)));
}

/* Orbits. */

static bool any_busy(const nevh_chaos *c, size_t *which) {
    for (size_t i = 0; i < c->starts; i++)
        if (c->batch->orbits[i].busy) {
            *which = i;
            return true;
        }
    return false;
}

static void chaos_batch_end(nevh_chaos *c, size_t start) {
    nevh__chaos_batch *x = c->batch;
    orbit *at = &x->orbits[start];
    nevh__chaos_member found = {
        at->member,           at->report.status,
        at->report.text,      nevh__chaos_rate(c, start, 0),
        c->start[start].sali, nevh__chaos_megno(c, start)};
    at->busy = false;
    x->stopped |= x->jobs->done(x->jobs->data, &found) != 0;
}

/* Draws are those of the first start: no member is told from another. */
static bool chaos_batch_begin(nevh_chaos *c, size_t start) {
    nevh__chaos_batch *x = c->batch;
    orbit *at = &x->orbits[start];
    double until;
    *at = (orbit){.busy = true};
    if (x->stopped || !x->jobs->next(x->jobs->data, &at->member, x->state,
                                     x->state + c->n, &until))
        return at->busy = false;
    uint64_t drawn = nevh__chaos_draw(c, 0);
    nevh__chaos_place(c, start, x->state, &drawn);
    chaos_batch_forget(c, start);
    at->last = nevh__chaos_steps(c, until);
    if (!(at->last > 0))
        chaos_batch_end(c, start);
    return true;
}

/* A start without an orbit goes along with another's. */
static void chaos_batch_fill(nevh_chaos *c) {
    nevh__chaos_batch *x = c->batch;
    size_t which;
    bool more = !(x->jobs->together && any_busy(c, &which));
    if (more && x->jobs->together)
        x->taken = 0;
    for (size_t i = 0; more && i < c->starts; i++)
        while (more && !x->orbits[i].busy)
            more = chaos_batch_begin(c, i);
    if (any_busy(c, &which))
        for (size_t i = 0; i < c->starts; i++)
            if (!x->orbits[i].busy)
                copy_start(c, own_columns(c), which, own_columns(c), i);
    nevh__chaos_fill_up(c);
}

/* Looks at a start whose turn it is.  Returns whether its orbit has ended. */
static bool chaos_batch_look(nevh_chaos *c, size_t start) {
    nevh__chaos_batch *x = c->batch;
    orbit *at = &x->orbits[start];
    const nevh__chaos_clock *clock = &c->start[start].clock;
    bool over = clock->done >= at->last || at->report.status;
    if (at->report.status || !(over || steps_since(c, start) == 0))
        return over;
    if (!isfinite(nevh__chaos_look(c, start))) {
        nevh__fail(&at->report, NEVH_EDOM,
                   "a displacement has grown beyond all numbers, or vanished, "
                   "at t = %.9g",
                   c->t_start + clock->done * c->way * c->dt);
        return true;
    }
    if (!c->tangent)
        chaos_batch_forget(c, start);
    return over ||
           (x->jobs->aligned && c->start[start].sali < nevh__chaos_aligned(c));
}

static bool look_at_all(nevh_chaos *c) {
    bool any = false;
    for (size_t i = 0; i < c->starts; i++)
        if (c->batch->orbits[i].busy && chaos_batch_look(c, i)) {
            chaos_batch_end(c, i);
            any = true;
        }
    return any;
}

void nevh__chaos_batch_run(nevh_chaos *c, const nevh__chaos_jobs *jobs) {
    nevh__chaos_batch *x = c->batch;
    size_t which, looks = 0;
    bool asks = true;
    x->jobs = jobs;
    x->stride = jobs->sparse ? c->turn : c->first_stride;
    x->taken = 0;
    x->stopped = false;
    for (size_t i = 0; i < c->starts; i++)
        x->orbits[i].busy = false;
    nevh_stepper_reset(c->stepper);
    while (!x->stopped) {
        if (asks)
            chaos_batch_fill(c);
        if (!any_busy(c, &which))
            break;
        double steps = most_steps(c);
        for (size_t i = 0; i < c->starts; i++)
            if (x->orbits[i].busy)
                steps = fmin(steps, steps_to_look(c, i));
        step_together(c, steps);
        asks = look_at_all(c) || ++looks % LOOKS_TOGETHER == 0;
        x->stopped |= jobs->ending && *jobs->ending;
    }
}
