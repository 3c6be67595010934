/* nevh: a reference that is a run: which steps it takes, and how far it can be
   trusted.

   Runs with h and h/2 go side by side.  Where they separate early, either h is
   too long, and they are repeated with a shorter one, or the last digits of the
   state have grown: an orbit whose start differs in these tells which.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_private.h"
#include "gradient/field_private.h"
#include "run/stepper_private.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double target = 1e-11; /* of the runs' difference */
static const double fair = 1e-9; /* where more would cost more than `little` */
static const double little = 0.05; /* of what may be spent */
static const double hopeless =
    1e-6;                           /* there is no use in going on to the end */
static const double chaotic = 1e-3; /* as the header says */
static const double nudge = 1e-13;  /* of the start, that tells chaos */
static const double most_gradients = 1e7, most_values = 2e8;
static const double shorter = 0.4; /* the next step, where one is too long */
enum { MOST_RUNS = 16 };

/* Two orbits side by side. */
typedef struct {
    nevh_reference *reference;
    nevh_stepper *coarse, *fine;
    double *a, *b;      /* states: of the coarse one, of the fine one */
    double *low, *high; /* of the fine one */
    double *difference; /* the largest so far */
    double *scale;
    double *memory;    /* of all these */
    nevh__track track; /* of the fine one */
} pair;

typedef struct {
    int status;     /* of the last step */
    double h;       /* of the coarse one */
    double reached; /* time since t0, of either sign */
    double error;
    bool whole; /* they came to the end */
} outcome;

static double spent_by(const nevh_stepper *s) {
    nevh_counts c = nevh_stepper_counts(s);
    double gradients = (double)c.gradients;
    double values =
        gradients * (double)s->work.field->instances + (double)c.values;
    return fmax(gradients / most_gradients, values / most_values);
}

/* Of what may be spent, so far. */
static double spent(const pair *b) {
    return spent_by(b->coarse) + spent_by(b->fine);
}

static bool track_grow(nevh__track *k, size_t n) {
    size_t room = k->room ? 2 * k->room : 64;
    double *states = nevh__grow(k->states, room * 2 * n, sizeof *states);
    if (!states)
        return false;
    k->states = states;
    k->room = room;
    return true;
}

static void track_thin(nevh__track *k, size_t n) {
    k->count = (k->count + 1) / 2;
    for (size_t i = 1; i < k->count; i++)
        memcpy(k->states + 2 * n * i, k->states + 4 * n * i,
               2 * n * sizeof *k->states);
    k->every *= 2;
}

/* The state after so many steps. */
static int track_add(nevh__track *k, size_t n, size_t step,
                     const double state[]) {
    size_t most = NEVH__MOST_TRACK / sizeof(double) / (2 * n);
    if (step % k->every)
        return NEVH_OK;
    if (k->count >= 2 && k->count >= most)
        track_thin(k, n);
    if (step % k->every)
        return NEVH_OK;
    if (k->count == k->room && !track_grow(k, n))
        return NEVH_ENOMEM;
    memcpy(k->states + 2 * n * k->count++, state, 2 * n * sizeof *state);
    return NEVH_OK;
}

static void begin(pair *b, double h) {
    const nevh_reference *r = b->reference;
    size_t size = 2 * r->n * sizeof(double);
    memcpy(b->a, r->start, size);
    memcpy(b->b, r->start, size);
    memcpy(b->low, r->start, size);
    memcpy(b->high, r->start, size);
    memset(b->difference, 0, size);
    nevh_stepper_reset(b->coarse);
    nevh_stepper_reset(b->fine);
    b->track.count = 0;
    b->track.every = 1;
    b->track.h = h / 2;
}

/* The largest difference now, over the ranges so far. */
static double compare(pair *b) {
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
static double largest_difference(const pair *b) {
    double most = 0;
    for (size_t k = 0; k < 2 * b->reference->n; k++)
        most = fmax(most, b->difference[k] / b->scale[k]);
    return most;
}

static int step(nevh_stepper *s, double t, double h, double state[]) {
    return nevh_stepper_apply(s, t, h, state, state + s->work.n);
}

/* The i-th step of both. */
static int step_pair(pair *b, size_t i, double h) {
    const nevh_reference *r = b->reference;
    double t = r->t0 + (double)i * h, half = r->t0 + ((double)i + 0.5) * h;
    int status = step(b->coarse, t, h, b->a);
    if (!status)
        status = step(b->fine, t, h / 2, b->b);
    if (!status)
        status = track_add(&b->track, r->n, 2 * i + 1, b->b);
    if (!status)
        nevh__reference_widen(r, b->low, b->high, b->b);
    if (!status)
        status = step(b->fine, half, h / 2, b->b);
    return status ? status : track_add(&b->track, r->n, 2 * i + 2, b->b);
}

/* Until they differ by more than `most`, or may cost no more. */
static outcome run_pair(pair *b, double h, double most) {
    const nevh_reference *r = b->reference;
    double span = r->t1 - r->t0, steps = ceil(fabs(span / h) * (1 - 1e-12));
    outcome o = {.h = span / steps};
    begin(b, o.h);
    o.status = track_add(&b->track, r->n, 0, b->b);
    for (double i = 0; !o.status && i < steps && spent(b) < 1; i++) {
        o.status = step_pair(b, (size_t)i, o.h);
        if (o.status || !(compare(b) <= most))
            break;
        o.reached = (i + 1) * o.h;
        o.whole = i + 1 == steps;
    }
    o.error = largest_difference(b);
    return o;
}

/* How far the last digits of the start are blown up until `reached`, by steps
   of h. */
static double blow_up(pair *b, double h, double reached) {
    const nevh_reference *r = b->reference;
    double steps = round(reached / h), most = 0;
    begin(b, h);
    for (size_t k = 0; k < 2 * r->n; k++)
        b->a[k] += nudge * (b->a[k] != 0 ? fabs(b->a[k]) : r->range[k]);
    for (double i = 0; i < steps && spent(b) < 1; i++) {
        double t = r->t0 + i * h;
        if (step(b->coarse, t, h, b->a) || step(b->fine, t, h, b->b))
            break;
        most = fmax(most, compare(b));
    }
    return most / nudge;
}

/* A step that changes the state by so much more than its error: the relative
   error of one step from the start; INFINITY when it cannot be taken. */
static double first_error(pair *b, double h) {
    const nevh_reference *r = b->reference;
    uint64_t newtons = nevh_stepper_counts(b->coarse).newtons;
    double error[2] = {0}, change[2] = {0};
    begin(b, h);
    if (step_pair(b, 0, h) || nevh_stepper_counts(b->coarse).newtons > newtons)
        return INFINITY;
    for (size_t k = 0; k < 2 * r->n; k++) {
        double e = fabs(b->a[k] - b->b[k]), c = fabs(b->b[k] - r->start[k]);
        error[k >= r->n] = fmax(error[k >= r->n], e);
        change[k >= r->n] = fmax(change[k >= r->n], c);
    }
    double most = 0;
    for (int i = 0; i < 2; i++)
        if (error[i] > 0)
            most = fmax(most, error[i] / change[i]);
    return most;
}

/* The longest step that is good at the start, from the longest allowed on
   downwards; the best one where none is, as rounding makes tiny ones bad. */
static double first_step(pair *b, int order) {
    static const double good = 1e-9, fewest = 256, shortest = 0x1p-60;
    const nevh_reference *r = b->reference;
    double span = r->t1 - r->t0, longest = span / fewest, h = 0, least = 1;
    for (double part = 1; part >= shortest && least >= good; part /= 4) {
        double error = first_error(b, part * longest);
        if (error < least)
            h = part * longest, least = error;
    }
    double longer = pow(0.1 * good / fmax(least, 1e-18), 1. / order);
    h *= fmin(fmax(longer, 0.5), 2);
    return fabs(h) < fabs(longest) ? h : longest;
}

static int give_up(pair *b, const outcome *o) {
    nevh__report *report = &b->reference->report;
    double t = b->reference->t0 + o->reached;
    const char *name = nevh_integrator_name(b->reference->integrator);
    const nevh_stepper *s =
        nevh_stepper_status(b->coarse) ? b->coarse : b->fine;
    if (o->status == NEVH_ENOMEM)
        return nevh__fail(report, NEVH_ENOMEM, "out of memory");
    if (o->status)
        return nevh__fail(report, o->status, "%s as a reference: %s", name,
                          nevh_stepper_message(s));
    return nevh__fail(report, NEVH_EFAILED,
                      "%s is accurate until t = %.4g only, within %.0g "
                      "gradients or %.0g evaluations of terms",
                      name, t, most_gradients, most_values);
}

/* The pair's fine orbit becomes the reference. */
static void keep(pair *b, const outcome *o) {
    nevh_reference *r = b->reference;
    size_t size = 2 * r->n * sizeof(double);
    nevh__track old = r->track;
    r->track = b->track;
    b->track = old;
    memcpy(r->low, b->low, size);
    memcpy(r->high, b->high, size);
    memcpy(r->range, b->scale, size);
    r->error = fmax(o->error, DBL_EPSILON);
    snprintf(r->text, sizeof r->text, "%s at dt = %.3g, own error %.0e",
             nevh_integrator_name(r->integrator), fabs(o->h) / 2, r->error);
}

/* As far as runs with differences in the last digits stay together. */
static void keep_chaos(pair *b, double h) {
    nevh_reference *r = b->reference;
    outcome o = run_pair(b, h, chaotic);
    if (o.status || (!o.whole && spent(b) >= 1))
        return;
    keep(b, &o);
    if (o.whole)
        return;
    r->horizon = r->t0 + o.reached;
    snprintf(r->text, sizeof r->text,
             "%s at dt = %.3g, until chaos at t = %.4g",
             nevh_integrator_name(r->integrator), fabs(o.h) / 2, r->horizon);
}

/* Whether rounding explains that they have separated. */
static bool is_chaos(pair *b, const outcome *o) {
    nevh_reference *r = b->reference;
    memcpy(r->range, b->scale, 2 * r->n * sizeof *r->range);
    return blow_up(b, o->h, o->reached) * DBL_EPSILON * 30 > hopeless;
}

/* What is known from the runs so far. */
typedef struct {
    double error;   /* of the last that came to the end */
    double reached; /* by the others, at most */
    int stalled;    /* of these, in turn, how many came no further */
} progress;

static double shorter_step(const outcome *o, int order) {
    if (o->status)
        return o->h / 2;
    if (!o->whole)
        return shorter * o->h;
    double ratio = 0.85 * pow(target / o->error, 1. / order);
    return o->h * fmin(fmax(ratio, 0.2), 0.7);
}

/* Longer again where a run to the end would cost more than is left, if `cost`
   is what the last one did. */
static double affordable_step(const pair *b, const outcome *o, double cost,
                              double h) {
    double span = b->reference->t1 - b->reference->t0;
    double whole = o->reached != 0 ? cost * span / o->reached : 0;
    double fitting = 1.1 * o->h * whole / (1 - spent(b));
    if (fabs(fitting) < fabs(h))
        return h;
    return copysign(fmin(fabs(fitting), 0.9 * fabs(o->h)), h);
}

/* Two shorter steps, 4e9 times better at order 12, should have come further. */
static bool has_stalled(progress *p, const outcome *o) {
    bool further = fabs(o->reached) > 1.1 * p->reached;
    p->stalled = further ? 0 : p->stalled + 1;
    p->reached = fmax(p->reached, fabs(o->reached));
    return p->stalled >= 2;
}

/* So that rounding alone separates the runs, where that can be afforded: they
   will go on for longer than the last, at most to the end. */
static double chaos_step(const pair *b, const outcome *o, double cost) {
    const nevh_reference *r = b->reference;
    double longer = fmin(3, (r->t1 - r->t0) / o->reached);
    return cost * longer / shorter < 1 - spent(b) ? shorter * o->h : o->h;
}

/* Whether that was the last run; `cost` is its own. */
static bool is_enough(pair *b, const outcome *o, double cost, progress *p) {
    if (o->status == NEVH_ENOMEM || spent(b) >= 1)
        return true;
    if (o->status)
        return false;
    if (!o->whole) {
        bool chaos = has_stalled(p, o) || is_chaos(b, o);
        if (chaos)
            keep_chaos(b, chaos_step(b, o, cost));
        return chaos;
    }
    bool floor = o->error > p->error / 8;
    if (o->error < p->error)
        keep(b, o);
    p->error = fmin(p->error, o->error);
    return floor || o->error <= target || (o->error <= fair && cost > little);
}

static int find_run(pair *b) {
    nevh_reference *r = b->reference;
    int order = nevh_stepper_order(b->coarse);
    double h = first_step(b, order), last = 0;
    progress p = {.error = INFINITY};
    outcome o = {0};
    for (int i = 0; h != 0 && i < MOST_RUNS; i++) {
        double before = spent(b);
        if (*r->text && last * o.h / h > 1 - before)
            break; /* good as it is */
        o = run_pair(b, h, hopeless);
        last = spent(b) - before;
        if (is_enough(b, &o, last, &p))
            break;
        h = affordable_step(b, &o, last, shorter_step(&o, order));
    }
    return *r->text && o.status != NEVH_ENOMEM ? NEVH_OK : give_up(b, &o);
}

static int open_pair(pair *b) {
    nevh_reference *r = b->reference;
    size_t n = r->n;
    b->coarse = nevh__reference_stepper(r);
    b->fine = nevh__reference_stepper(r);
    b->memory = nevh__array(12 * n, sizeof *b->memory);
    if (!b->coarse || !b->fine || !b->memory || !track_grow(&b->track, n))
        return nevh__fail(&r->report, NEVH_ENOMEM, "out of memory");
    b->a = b->memory;
    b->b = b->a + 2 * n;
    b->low = b->b + 2 * n;
    b->high = b->low + 2 * n;
    b->difference = b->high + 2 * n;
    b->scale = b->difference + 2 * n;
    int status = nevh_stepper_status(b->coarse);
    return status ? nevh__fail_as(&r->report, &b->coarse->report) : NEVH_OK;
}

int nevh__reference_run(nevh_reference *r) {
    pair b = {.reference = r};
    if (nevh_integrator_own_time(r->integrator))
        return nevh__fail(&r->report, NEVH_EINVAL,
                          "%s chooses its own times, which a reference must "
                          "not",
                          nevh_integrator_name(r->integrator));
    int status = open_pair(&b);
    if (!status)
        status = find_run(&b);
    nevh_stepper_free(b.coarse);
    nevh_stepper_free(b.fine);
    free(b.track.states);
    free(b.memory);
    return status;
}
