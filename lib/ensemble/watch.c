/* nevh: outcomes of several steps at once, from values that compiled steps give.

   Steps end before one whose state has to be looked at: the values of all steps tell
   which.  What was begun too far is taken back to there.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include <stdlib.h>
#include <string.h>

enum { MOST_STEPS = 62, MOST_NUMBERS = 1 << 12, NO_ROW = -1 };

struct nevh__watch {
    nevh__watched is;
    const nevh__tape **tapes; /* by row */
    int *row;                 /* by outcome; NO_ROW: it has none */
    int stop, energy;         /* likewise */
    size_t rows, most;        /* most: steps */
    double *
        values; /* rows of `width` for the last step but one, the last, and each
                       of the next */
    double *q, *p, *memory; /* where they begin */
};

/* Plans. */

/* The row of a formula of the state; NO_ROW: it is none. */
static int take_row(nevh__watch *w, const nevh_quantity *is) {
    const nevh__tape *tape = is->data;
    if (is->value != nevh__tape_quantity || is->velocities ||
        nevh__tape_count(tape, NEVH__T) || nevh__tape_count(tape, NEVH__C))
        return NO_ROW;
    w->tapes[w->is.count] = tape;
    return (int)w->is.count++;
}

static bool take_rows(nevh_ensemble *e, nevh__watch *w) {
    bool all = true;
    for (size_t i = 0; i < e->n_outcomes; i++) {
        const nevh__outcome_entry *o = &e->outcomes[i];
        w->row[i] = NO_ROW;
        if (o->type->step)
            all = (w->row[i] = take_row(w, &o->decl.quantity)) != NO_ROW && all;
    }
    w->stop = w->energy = NO_ROW;
    if (e->options.stop.value)
        all = (w->stop = take_row(w, &e->options.stop)) != NO_ROW && all;
    if (e->has_energy)
        w->energy = (int)w->is.count;
    return all;
}

bool nevh__ensemble_watch_plan(nevh_ensemble *e) {
    if (!e->watches || e->alone || e->n_crossings || e->stride != e->width)
        return true;
    nevh__watch *w = e->watch = nevh__array(1, sizeof *w);
    if (!w)
        return false;
    w->tapes = nevh__array(e->n_outcomes + 1, sizeof *w->tapes);
    w->row = nevh__array(e->n_outcomes + 1, sizeof *w->row);
    if (!w->tapes || !w->row)
        return false;
    bool all = take_rows(e, w);
    w->is.tapes = w->tapes;
    w->is.energy = e->has_energy;
    w->rows = nevh__watched_rows(&w->is);
    if (all)
        return true;
    nevh__ensemble_watch_free(w);
    e->watch = NULL;
    return true;
}

const nevh__watched *nevh__ensemble_watched(const nevh_ensemble *e) {
    return e->watch ? &e->watch->is : NULL;
}

int nevh__ensemble_watch_begin(nevh_ensemble *e) {
    nevh__watch *w = e->watch;
    const nevh__native *native = e->stepper->work.native;
    if (!w || !native || !native->watches) {
        nevh__ensemble_watch_free(w);
        e->watch = NULL;
        return NEVH_OK;
    }
    size_t size = e->n * e->width, most = MOST_NUMBERS / (w->rows * e->width);
    w->most = most > MOST_STEPS ? MOST_STEPS : most < 4 ? 4 : most;
    w->values = nevh__array((w->most + 2) * w->rows * e->width + 2 * size +
                                e->stepper->rows * e->width,
                            sizeof *w->values);
    if (!w->values)
        return nevh__no_memory(&e->report);
    w->q = w->values + (w->most + 2) * w->rows * e->width;
    w->p = w->q + size;
    w->memory = w->p + size;
    return NEVH_OK;
}

void nevh__ensemble_watch_free(nevh__watch *w) {
    if (!w)
        return;
    free(w->tapes);
    free(w->row);
    free(w->values);
    free(w);
}

/* Values. */

/* A row `steps` after the beginning, -1 or more. */
static double *row_at(const nevh_ensemble *e, int row, int steps) {
    const nevh__watch *w = e->watch;
    return w->values + ((size_t)(steps + 1) * w->rows + (size_t)row) * e->width;
}

static void copy_lanes(const nevh_ensemble *e, double to[],
                       const double from[]) {
    memcpy(to, from, e->width * sizeof *to);
}

static void watch_keep(nevh_ensemble *e) {
    nevh__watch *w = e->watch;
    size_t bytes = e->n * e->width * sizeof *e->q;
    memcpy(w->q, e->q, bytes);
    memcpy(w->p, e->p, bytes);
    memcpy(w->memory, e->stepper->work.memory,
           e->stepper->rows * e->width * sizeof *w->memory);
    for (size_t o = 0; o < e->n_outcomes; o++)
        if (w->row[o] != NO_ROW) {
            copy_lanes(e, row_at(e, w->row[o], -1),
                       e->ago1.value + o * e->stride);
            copy_lanes(e, row_at(e, w->row[o], 0),
                       e->now.value + o * e->stride);
        }
}

static void give_back(nevh_ensemble *e) {
    const nevh__watch *w = e->watch;
    size_t bytes = e->n * e->width * sizeof *e->q;
    memcpy(e->q, w->q, bytes);
    memcpy(e->p, w->p, bytes);
    memcpy(e->stepper->work.memory, w->memory,
           e->stepper->rows * e->width * sizeof *w->memory);
}

/* Values and times so many steps after the beginning become those of now. */
static void turn_to(nevh_ensemble *e, size_t steps) {
    const nevh__watch *w = e->watch;
    for (size_t lane = 0; lane < e->width; lane++)
        e->now.t[lane] =
            e->options.t_start + (double)(e->lanes[lane].step + steps) * e->h;
    for (size_t o = 0; o < e->n_outcomes; o++)
        if (w->row[o] != NO_ROW)
            copy_lanes(e, e->now.value + o * e->stride,
                       row_at(e, w->row[o], (int)steps));
}

/* Steps. */

static size_t watch_run(nevh_ensemble *e, size_t from, size_t done,
                        size_t steps) {
    return nevh__native_watch(
        &e->stepper->work,
        (nevh__steps_call){.t0 = e->options.t_start,
                           .h = e->h,
                           .from = from + done,
                           .steps = steps,
                           .q = e->q,
                           .p = e->p,
                           .room = row_at(e, 0, (int)done + 1)});
}

/* The state before the last is looked back to.  Returns how many there are: where it is
   fewer, of a state that is none. */
static size_t run_all(nevh_ensemble *e, size_t from, size_t steps) {
    size_t first = watch_run(e, from, 0, steps - 1);
    if (first < steps - 1)
        return first;
    turn_to(e, first);
    nevh__ensemble_look_back(e, e->h);
    return first + watch_run(e, from, first, 1);
}

/* Looks. */

static bool find_lanes(nevh_ensemble *e) {
    for (size_t lane = 0; lane < e->width; lane++) {
        const nevh__lane *l = &e->lanes[lane];
        e->on[lane] = l->busy;
        e->step[lane] = l->step + 1;
        if (l->busy && (l->over || l->fresh))
            return false;
    }
    return true;
}

static nevh__observation observation(nevh_ensemble *e, size_t steps) {
    return (nevh__observation){.ensemble = e,
                               .t_start = e->options.t_start,
                               .count = steps,
                               .h = e->h,
                               .pitch = e->watch->rows * e->width};
}

static void *turn_to_outcome(nevh__observation *at, size_t o, size_t lane) {
    const nevh_ensemble *e = at->ensemble;
    const nevh__lane *l = &e->lanes[lane];
    int row = e->watch->row[o];
    at->lane = lane;
    at->outcome = o;
    at->decl = &e->outcomes[o].decl;
    at->step = l->step + at->count;
    at->t = e->options.t_start + (double)at->step * e->h;
    at->t_before = l->t;
    at->value_earlier = row_at(e, row, -1)[lane];
    at->value_before = row_at(e, row, 0)[lane];
    at->values = row_at(e, row, 1) + lane;
    at->value = nevh__observed(at, at->count - 1);
    return nevh__record_of(e, o, lane);
}

/* The first of the steps that stops an orbit. */
static size_t before_stop(const nevh_ensemble *e, size_t steps) {
    size_t pitch = e->watch->rows * e->width;
    const double *values = row_at(e, e->watch->stop, 1);
    for (size_t i = 0; i < steps; i++)
        for (size_t lane = 0; lane < e->width; lane++)
            if (e->on[lane] && values[i * pitch + lane] > 0)
                return i;
    return steps;
}

/* Counts the steps that need nothing but the values after each. */
static size_t count_quiet(nevh_ensemble *e, size_t steps) {
    const nevh__watch *w = e->watch;
    size_t pitch = w->rows * e->width;
    if (w->stop != NO_ROW)
        steps = before_stop(e, steps);
    if (w->energy != NO_ROW)
        steps = nevh__energy_quiet(e->energy, e->on, steps,
                                   row_at(e, w->energy, 1), pitch);
    for (size_t o = 0; o < e->n_outcomes; o++) {
        const nevh__outcome_type *type = e->outcomes[o].type;
        for (size_t lane = 0; type->quiet && steps && lane < e->width; lane++) {
            nevh__observation at = observation(e, steps);
            const void *record = turn_to_outcome(&at, o, lane);
            if (e->on[lane])
                steps = type->quiet(&at, record);
        }
    }
    return steps;
}

static void watch_take(nevh_ensemble *e, size_t steps) {
    const nevh__watch *w = e->watch;
    nevh__observation at = observation(e, steps);
    if (w->energy != NO_ROW)
        nevh__energy_observe_quiet(e->energy, e->on, e->step,
                                   e->options.t_start, e->h, steps,
                                   row_at(e, w->energy, 1), at.pitch);
    for (size_t o = 0; o < e->n_outcomes; o++)
        for (size_t lane = 0; w->row[o] != NO_ROW && lane < e->width; lane++)
            if (e->on[lane])
                e->outcomes[o].type->step(&at, turn_to_outcome(&at, o, lane));
}

/* So many of the steps that are quiet; fewer than two are none. */
static size_t take_quiet(nevh_ensemble *e, size_t from, size_t steps) {
    nevh__snapshot ago1 = e->ago1, ago2 = e->ago2;
    watch_keep(e);
    size_t done = run_all(e, from, steps);
    size_t quiet = done > 1 ? count_quiet(e, done) : 0;
    if (quiet < steps)
        give_back(e);
    if (quiet > 1 && quiet < steps)
        run_all(e, from, quiet);
    if (quiet > 1) {
        watch_take(e, quiet);
        turn_to(e, quiet);
        return quiet;
    }
    turn_to(e, 0);
    e->ago1 = ago1;
    e->ago2 = ago2;
    return 0;
}

size_t nevh__ensemble_watch(nevh_ensemble *e, size_t from, size_t steps) {
    const nevh__watch *w = e->watch;
    if (!find_lanes(e))
        return 0;
    if (w->energy != NO_ROW) {
        size_t most = nevh__energy_most_quiet(e->energy, e->on);
        steps = steps < most ? steps : most;
    }
    steps = steps < w->most ? steps : w->most;
    return steps > 1 ? take_quiet(e, from, steps) : 0;
}
