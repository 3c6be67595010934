/* nevh: native steps are taken, after the first of them were compared with the
   kernel's.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include "native/native_private.h"
#include "system/system_private.h"
#include <stdlib.h>
#include <string.h>

/* Gradients, and values of their terms; of steps by parts drifts are inner kicks. */
static void add_counts(nevh_work *w, const nevh__native *x, size_t kicks,
                       size_t drifts) {
    w->field->gradients += kicks;
    w->field->inner += drifts * w->field->n_inner;
    for (size_t i = 0; i < w->field->n_terms; i++)
        w->field->terms[i].values +=
            kicks * x->kick_values[i] + drifts * x->drift_values[i];
}

/* Counts the evaluations of so many steps, as the kernel does. */
static void count(nevh_work *w, const nevh__native *x, size_t steps,
                  bool kept) {
    size_t saved = x->keeps ? steps - !kept : 0;
    bool of_kicks = x->whole || x->kicks_first;
    bool of_drifts = x->whole || !x->kicks_first;
    size_t kicks = steps * x->kicks - (of_kicks ? saved : 0);
    size_t drifts = steps * x->drifts - (of_drifts ? saved : 0);
    add_counts(w, x, kicks * w->width, drifts * w->width);
}

/* The number of lanes that have the slope that the step before left. */
static size_t count_kept(const nevh_work *w) {
    const double *flags = w->memory + w->native->flags_at * w->size;
    size_t kept = 0;
    for (size_t lane = 0; lane < w->width; lane++)
        kept += flags[lane] != 0;
    return kept;
}

static size_t take_take(const nevh_work *w, nevh__steps_call *c) {
    const nevh__native *x = w->native;
    nevh__compiled_steps compiled = x->steps;
    c->numbers = x->numbers;
    c->weights = x->weights;
    c->times = x->times;
    c->operations = x->kicks + x->drifts;
    c->memory = w->memory;
    c->plan = w->plan;
    if (x->room)
        c->room = nevh__aligned(x->room);
    return compiled(c);
}

/* Gradients at stages, and values that told the noise of differences. */
static void count_sweeps(nevh_work *w, const nevh__native *x,
                         const size_t counted[3]) {
    nevh_field *f = w->field;
    size_t points = counted[2] * x->stages;
    w->sweeps += counted[0];
    f->gradients += counted[0] * x->stages;
    for (size_t i = 0; i < f->n_terms; i++) {
        nevh__planned *term = &f->terms[i];
        term->values += points * (x->kick_values[i] + x->drift_values[i]);
        if (term->delta)
            term->values += counted[1] * term->term->decl.count;
    }
}

static size_t take_steps(nevh_work *w, nevh__steps_call c) {
    const nevh__native *x = w->native;
    size_t kept = x->keeps ? count_kept(w) : 0;
    if (kept > 0 && kept < w->width)
        return 0; /* the kernel's step takes those that are missing */
    size_t counted[3] = {0, 0, 0};
    c.counted = counted;
    size_t done = take_take(w, &c);
    if (x->stages)
        count_sweeps(w, x, counted);
    else if (x->adapts)
        add_counts(w, x, counted[0] + counted[1] * x->kicks,
                   counted[0] * x->first_drifts + counted[1] * x->drifts);
    else {
        if (done && done < c.steps) { /* nothing has been stored */
            c.steps = done;
            done = take_take(w, &c);
        }
        if (done)
            count(w, x, done, kept > 0);
        if (done && x->own_time)
            w->elapsed = x->times[0];
    }
    return done;
}

/* All that a step changes. */
typedef struct {
    double *numbers; /* q, p and memory */
    size_t memory;   /* doubles */
    uint64_t *values;
    uint64_t gradients, inner, sweeps, newtons, rescues;
    double elapsed;
} before;

static void free_before(before *b) {
    free(b->numbers);
    free(b->values);
}

static bool make_before(before *b, const nevh_work *w) {
    *b = (before){.memory = w->memory_rows * w->width};
    b->numbers = nevh__array(2 * w->size + b->memory + 1, sizeof(double));
    b->values = nevh__array(w->field->n_terms + 1, sizeof *b->values);
    return b->numbers && b->values;
}

/* From the stepper, or back to it. */
static void take_keep(before *b, const nevh_work *w, const double q[],
                      const double p[]) {
    memcpy(b->numbers, q, w->size * sizeof *q);
    memcpy(b->numbers + w->size, p, w->size * sizeof *p);
    if (b->memory)
        memcpy(b->numbers + 2 * w->size, w->memory, b->memory * sizeof *q);
    for (size_t i = 0; i < w->field->n_terms; i++)
        b->values[i] = w->field->terms[i].values;
    b->gradients = w->field->gradients;
    b->inner = w->field->inner;
    b->sweeps = w->sweeps;
    b->newtons = w->newtons;
    b->rescues = w->rescues;
    b->elapsed = w->elapsed;
}

static void give_back(const before *b, nevh_work *w, double q[], double p[]) {
    memcpy(q, b->numbers, w->size * sizeof *q);
    memcpy(p, b->numbers + w->size, w->size * sizeof *p);
    if (b->memory)
        memcpy(w->memory, b->numbers + 2 * w->size, b->memory * sizeof *q);
    for (size_t i = 0; i < w->field->n_terms; i++)
        w->field->terms[i].values = b->values[i];
    w->field->gradients = b->gradients;
    w->field->inner = b->inner;
    w->sweeps = b->sweeps;
    w->newtons = b->newtons;
    w->rescues = b->rescues;
    w->elapsed = b->elapsed;
}

static size_t take_compare(nevh_work *w, before *start, before *native,
                           nevh__steps_call c) {
    nevh__native *x = w->native;
    double *q = c.q, *p = c.p;
    take_keep(start, w, q, p);
    size_t done = take_steps(w, c), again = 0;
    if (!done)
        return 0;
    take_keep(native, w, q, p);
    give_back(start, w, q, p);
    while (
        again < done &&
        !nevh__work_step(w, c.t0 + (double)(c.from + again) * c.h, c.h, q, p))
        again++;
    x->compared = again == done &&
                  !memcmp(native->numbers, q, w->size * sizeof *q) &&
                  !memcmp(native->numbers + w->size, p, w->size * sizeof *p);
    x->differs = !x->compared;
    if (x->compared)
        give_back(native, w, q, p);
    return again;
}

/* A compiler may have been told to change digits: few steps of many numbers show
   that, or some of few. */
static size_t compare_first(nevh_work *w, nevh__steps_call c) {
    enum { MANY = 1000, SOME = 8 };
    size_t most = w->size > MANY ? 1 : SOME, done = 0;
    before start, native;
    bool made = make_before(&start, w);
    made = make_before(&native, w) && made;
    c.steps = c.steps < most ? c.steps : most;
    if (made)
        done = take_compare(w, &start, &native, c);
    free_before(&start);
    free_before(&native);
    return done;
}

size_t nevh__native_run(nevh_work *w, double t0, double h, size_t from,
                        size_t steps, double q[], double p[]) {
    const nevh__native *x = w->native;
    if (!x->steps || x->differs || !nevh__field_at_hand(w->field))
        return 0;
    nevh__steps_call c = {
        .t0 = t0, .h = h, .from = from, .steps = steps, .q = q, .p = p};
    return x->compared ? take_steps(w, c) : compare_first(w, c);
}

size_t nevh__native_watch(nevh_work *w, nevh__steps_call c) {
    const nevh__native *x = w->native;
    return x && x->steps && x->watches && x->compared &&
                   nevh__field_at_hand(w->field)
               ? take_steps(w, c)
               : 0;
}
