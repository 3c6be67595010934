/* nevh: two runs of a reference side by side, with steps of h and of h/2.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_pair_private.h"
#include "gradient/field_private.h"
#include "run/stepper_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double separate = 0.1; /* that is not a beginning any more */
static const double few = 16; /* steps, after which the motion has begun */

static double reference_pair_spent_by(const nevh_stepper *s) {
    nevh_counts c = nevh_stepper_counts(s);
    double gradients = (double)c.gradients;
    double values =
        gradients * (double)s->work.field->instances + (double)c.values;
    return fmax(gradients / nevh__most_gradients, values / nevh__most_values);
}

double nevh__pair_spent(const nevh__pair *b) {
    return reference_pair_spent_by(b->coarse) +
           reference_pair_spent_by(b->fine);
}

static bool orbit_grow(nevh__reference_orbit *k, size_t n) {
    size_t capacity = k->capacity ? 2 * k->capacity : 64;
    double *states = nevh__grow(k->states, capacity * 2 * n, sizeof *states);
    if (!states)
        return false;
    k->states = states;
    k->capacity = capacity;
    return true;
}

static void orbit_thin(nevh__reference_orbit *k, size_t n) {
    k->count = (k->count + 1) / 2;
    for (size_t i = 1; i < k->count; i++)
        memcpy(k->states + 2 * n * i, k->states + 4 * n * i,
               2 * n * sizeof *k->states);
    k->every *= 2;
}

/* The state after so many steps. */
static int orbit_add(nevh__reference_orbit *k, size_t n, size_t step,
                     const double state[]) {
    size_t most = NEVH__MOST_TRACK / sizeof(double) / (2 * n);
    if (step % k->every)
        return NEVH_OK;
    if (k->count >= 2 && k->count >= most)
        orbit_thin(k, n);
    if (step % k->every)
        return NEVH_OK;
    if (k->count == k->capacity && !orbit_grow(k, n))
        return NEVH_ENOMEM;
    memcpy(k->states + 2 * n * k->count++, state, 2 * n * sizeof *state);
    return NEVH_OK;
}

static void reference_pair_begin(nevh__pair *b, double h) {
    const nevh_reference *r = b->reference;
    size_t size = 2 * r->n * sizeof(double);
    memcpy(b->a, r->start, size);
    memcpy(b->b, r->start, size);
    memcpy(b->low, r->start, size);
    memcpy(b->high, r->start, size);
    memset(b->difference, 0, size);
    nevh_stepper_reset(b->coarse);
    nevh_stepper_reset(b->fine);
    b->orbit.count = 0;
    b->orbit.every = 1;
    b->orbit.h = h / 2;
    nevh__watch_begin(&b->watch);
}

/* The largest difference now, over the ranges so far. */
static double reference_pair_compare(nevh__pair *b) {
    const nevh_reference *r = b->reference;
    double most = 0;
    nevh__reference_widen(r, b->low, b->high, b->b);
    nevh__reference_scale(r, b->low, b->high, b->scale);
    for (size_t k = 0; k < 2 * r->n; k++) {
        double difference = fabs(b->a[k] - b->b[k]);
        b->difference[k] = fmax(b->difference[k], difference);
        most = fmax(most, difference / b->scale[k]);
    }
    return most;
}

/* The largest difference over the ranges of the whole. */
static double largest_difference(const nevh__pair *b) {
    double most = 0;
    for (size_t k = 0; k < 2 * b->reference->n; k++)
        most = fmax(most, b->difference[k] / b->scale[k]);
    return most;
}

static int reference_pair_step(nevh_stepper *s, double t, double h,
                               double state[]) {
    return nevh_stepper_apply(s, t, h, state, state + s->work.n);
}

/* The i-th step of both. */
static int step_pair(nevh__pair *b, size_t i, double h) {
    const nevh_reference *r = b->reference;
    double t = r->t0 + (double)i * h, half = r->t0 + ((double)i + 0.5) * h;
    int status = reference_pair_step(b->coarse, t, h, b->a);
    if (!status)
        status = reference_pair_step(b->fine, t, h / 2, b->b);
    if (!status)
        status = orbit_add(&b->orbit, r->n, 2 * i + 1, b->b);
    if (!status)
        nevh__reference_widen(r, b->low, b->high, b->b);
    if (!status)
        status = reference_pair_step(b->fine, half, h / 2, b->b);
    return status ? status : orbit_add(&b->orbit, r->n, 2 * i + 2, b->b);
}

/* The differences at the last power of two steps, and since. */
typedef struct {
    double before, since;
} octave;

/* True if the orbits have separated.  At the very beginning small differences are
   large parts of a motion that has hardly begun: these shrink. */
static bool have_separated(octave *o, double step, double difference,
                           double most) {
    if (exp2(floor(log2(step))) == step) {
        o->before = o->since;
        o->since = 0;
    }
    o->since = fmax(o->since, difference);
    if (step < few)
        return !(difference <= 1);
    return !(difference <= most) &&
           !(difference <= o->before && difference <= separate);
}

nevh__pair_outcome nevh__pair_run(nevh__pair *b, double h, double most) {
    const nevh_reference *r = b->reference;
    double span = r->t1 - r->t0, steps = ceil(fabs(span / h) * (1 - 1e-12));
    nevh__pair_outcome o = {.h = span / steps};
    octave past = {0};
    reference_pair_begin(b, o.h);
    o.status = orbit_add(&b->orbit, r->n, 0, b->b);
    for (double i = 0; !o.status && i < steps && nevh__pair_spent(b) < 1; i++) {
        o.status = step_pair(b, (size_t)i, o.h);
        if (o.status ||
            have_separated(&past, i + 1, reference_pair_compare(b), most))
            break;
        b->watch.t = r->t0 + (i + 0.5) * o.h;
        o.stepped_over = !nevh__watch_step(&b->watch, b->a, b->b);
        if (o.stepped_over)
            break;
        o.reached = (i + 1) * o.h;
        o.whole = i + 1 == steps;
    }
    o.error = fmax(largest_difference(b), nevh__watch_error(&b->watch));
    return o;
}

nevh__step_error nevh__pair_first_error(nevh__pair *b, double h) {
    const nevh_reference *r = b->reference;
    uint64_t newtons = nevh_stepper_counts(b->coarse).newtons;
    double error[2] = {0}, change[2] = {0}, size[2] = {0};
    reference_pair_begin(b, h);
    if (step_pair(b, 0, h) || nevh_stepper_counts(b->coarse).newtons > newtons)
        return (nevh__step_error){INFINITY, INFINITY};
    for (size_t k = 0; k < 2 * r->n; k++) {
        size_t half = k >= r->n;
        double e = fabs(b->a[k] - b->b[k]), c = fabs(b->b[k] - r->start[k]);
        error[half] = fmax(error[half], e);
        change[half] = fmax(change[half], c);
        size[half] = fmax(size[half], fmax(fabs(r->start[k]), c));
    }
    nevh__step_error most = {0};
    for (int i = 0; i < 2; i++)
        if (error[i] > 0) {
            most.of_change = fmax(most.of_change, error[i] / change[i]);
            most.of_state = fmax(most.of_state, error[i] / size[i]);
        }
    return most;
}

int nevh__pair_init(nevh__pair *b) {
    nevh_reference *r = b->reference;
    size_t n = r->n;
    b->coarse = nevh__reference_stepper(r);
    b->fine = nevh__reference_stepper(r);
    b->memory = nevh__array(12 * n, sizeof *b->memory);
    if (!b->coarse || !b->fine || !b->memory || !orbit_grow(&b->orbit, n))
        return nevh__no_memory(&r->report);
    b->a = b->memory;
    b->b = b->a + 2 * n;
    b->low = b->b + 2 * n;
    b->high = b->low + 2 * n;
    b->difference = b->high + 2 * n;
    b->scale = b->difference + 2 * n;
    if (nevh__watch_init(&b->watch, r))
        return nevh__no_memory(&r->report);
    int status = nevh_stepper_status(b->coarse);
    return status ? nevh__fail_as(&r->report, &b->coarse->report) : NEVH_OK;
}

void nevh__pair_clear(nevh__pair *b) {
    nevh_stepper_free(b->coarse);
    nevh_stepper_free(b->fine);
    nevh__watch_clear(&b->watch);
    free(b->orbit.states);
    free(b->memory);
}
