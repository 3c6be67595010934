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
    1e-6;                          /* there is no use in going on to the end */
static const double apart = 1e-3;  /* as the header says */
static const double nudge = 1e-13; /* of the start, that tells chaos */
static const double bearable = 1e-4; /* error of a first step, for one that can
                                        be afforded to the end */
static const double late = 0.3; /* of what may be spent, to try shorter steps */
static const double separate = 0.1; /* that is not a beginning any more */
static const double most_gradients = 1e7, most_values = 2e8;
static const double shorter = 0.4; /* the next step, where one is too long */
static const double few = 16;      /* steps, after which the motion has begun */
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
    nevh__watch watch;
} pair;

typedef struct {
    int status;     /* of the last step */
    double h;       /* of the coarse one */
    double reached; /* time since t0, of either sign */
    double error;
    bool whole;        /* they came to the end */
    bool stepped_over; /* H changed, and not by what they differ */
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
    nevh__watch_begin(&b->watch);
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

/* The differences at the last power of two steps, and since. */
typedef struct {
    double before, since;
} octave;

/* Whether the orbits have separated.  At the very beginning little differences
   are large parts of a motion that has hardly begun: these shrink. */
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

/* Until they differ by more than `most`, or may cost no more. */
static outcome run_pair(pair *b, double h, double most) {
    const nevh_reference *r = b->reference;
    double span = r->t1 - r->t0, steps = ceil(fabs(span / h) * (1 - 1e-12));
    outcome o = {.h = span / steps};
    octave past = {0};
    begin(b, o.h);
    o.status = track_add(&b->track, r->n, 0, b->b);
    for (double i = 0; !o.status && i < steps && spent(b) < 1; i++) {
        o.status = step_pair(b, (size_t)i, o.h);
        if (o.status || have_separated(&past, i + 1, compare(b), most))
            break;
        o.stepped_over = !nevh__watch_step(&b->watch, b->a, b->b);
        if (o.stepped_over)
            break;
        o.reached = (i + 1) * o.h;
        o.whole = i + 1 == steps;
    }
    o.error = fmax(largest_difference(b), nevh__watch_error(&b->watch));
    return o;
}

static double distance(const pair *b) {
    const nevh_reference *r = b->reference;
    double most = 0;
    for (size_t k = 0; k < 2 * r->n; k++)
        most = fmax(most, fabs(b->a[k] - b->b[k]) / r->range[k]);
    return most;
}

static void put_beside(pair *b, uint64_t *random) {
    for (size_t k = 0; k < 2 * b->reference->n; k++)
        b->a[k] += nudge * fabs(b->a[k]) * nevh__random(random);
}

/* How rounding is blown up until `reached`, by steps of h: one orbit is rounded
   to fewer digits, again and again.  Differences are measured by the ranges up
   to there. */
static nevh__spread blow_up(pair *b, double h, double reached) {
    nevh_reference *r = b->reference;
    double steps = round(reached / h);
    uint64_t random = 1;
    nevh__spread s = {0};
    memcpy(r->range, b->scale, 2 * r->n * sizeof *r->range);
    begin(b, h);
    for (double i = 0; i < steps && spent(b) < 1; i++) {
        double t = r->t0 + i * h;
        if (step(b->coarse, t, h, b->a) || step(b->fine, t, h, b->b))
            break;
        if (nevh__spread_add(&s, i / steps, distance(b) / nudge))
            put_beside(b, &random);
    }
    return s;
}

/* The error of one step from the start, relative to what it changes, and to the
   state. */
typedef struct {
    double of_change, of_state;
} step_error;

/* INFINITY when the step cannot be taken. */
static step_error first_error(pair *b, double h) {
    const nevh_reference *r = b->reference;
    uint64_t newtons = nevh_stepper_counts(b->coarse).newtons;
    double error[2] = {0}, change[2] = {0}, size[2] = {0};
    begin(b, h);
    if (step_pair(b, 0, h) || nevh_stepper_counts(b->coarse).newtons > newtons)
        return (step_error){INFINITY, INFINITY};
    for (size_t k = 0; k < 2 * r->n; k++) {
        size_t half = k >= r->n;
        double e = fabs(b->a[k] - b->b[k]), c = fabs(b->b[k] - r->start[k]);
        error[half] = fmax(error[half], e);
        change[half] = fmax(change[half], c);
        size[half] = fmax(size[half], fmax(fabs(r->start[k]), c));
    }
    step_error most = {0};
    for (int i = 0; i < 2; i++)
        if (error[i] > 0) {
            most.of_change = fmax(most.of_change, error[i] / change[i]);
            most.of_state = fmax(most.of_state, error[i] / size[i]);
        }
    return most;
}

/* Where the step is allowed to be no longer, that is not shorter than can be
   afforded: `cost` is what a pair of steps spends. */
static double longest_step(const nevh_reference *r, double cost) {
    static const double fewest = 128, part = 0.1; /* of what may be spent */
    double span = fabs(r->t1 - r->t0), longest = span / fewest;
    if (r->longest > 0)
        longest = fmin(longest, fmax(r->longest, cost * span / part));
    return copysign(longest, r->t1 - r->t0);
}

/* The longest step that is good at the start; the best one where none is, as
   rounding makes tiny ones bad.  One by which the end can be afforded will do
   where it is not bad. */
static double first_step(pair *b, int order) {
    static const double good = 1e-9, shortest = 0x1p-60;
    const nevh_reference *r = b->reference;
    double span = r->t1 - r->t0, longest = longest_step(r, 0);
    double h = 0, least = 1, affordable = 0, paid = 0, before = spent(b);
    for (double part = 1; part >= shortest && least >= good; part /= 4) {
        step_error error = first_error(b, part * longest);
        double cost = spent(b) - before;
        before = spent(b);
        double whole = cost * span / (part * longest);
        if (error.of_state < bearable && whole < 0.3)
            affordable = part * longest;
        if (error.of_change < least)
            h = part * longest, least = error.of_change, paid = whole;
        longest = part == 1 ? longest_step(r, cost) : longest;
    }
    if (paid > 1 && affordable != 0)
        return affordable;
    double longer = pow(0.1 * good / fmax(least, 1e-18), 1. / order);
    h *= fmin(fmax(longer, 0.5), 2);
    return fabs(h) < fabs(longest) ? h : longest;
}

static int give_up_jump(const pair *b, const outcome *o) {
    nevh_reference *r = b->reference;
    const nevh__jump *j = &b->watch.jump;
    double t = r->t0 + o->reached + j->part * o->h;
    if (j->found)
        return nevh__watch_fail(r, j, t);
    return nevh__fail(&r->report, NEVH_EFAILED,
                      "%s does not keep H: it changes by %.3g near t = %.6g, "
                      "mostly in effect \"%s\", at steps of %.3g",
                      nevh_integrator_name(r->integrator), b->watch.changed, t,
                      nevh_system_effect_name(r->system, j->effect),
                      fabs(o->h) / 2);
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
    if (o->stepped_over)
        return give_up_jump(b, o);
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

/* As far as they stay together.  `why` they will not to the end. */
static void keep_part(pair *b, double h, nevh_reference_end why) {
    nevh_reference *r = b->reference;
    outcome o = run_pair(b, h, apart);
    const char *name = nevh_integrator_name(r->integrator);
    if (o.status || o.stepped_over || o.reached == 0 ||
        (!o.whole && spent(b) >= 1))
        return;
    keep(b, &o);
    r->exponent = o.whole ? NAN : r->exponent;
    r->growth = o.whole ? NAN : r->growth;
    if (o.whole)
        return;
    r->horizon = r->t0 + o.reached;
    r->end = why;
    if (why == NEVH_REFERENCE_CHAOS)
        snprintf(r->text, sizeof r->text,
                 "%s at dt = %.3g, until chaos at t = %.4g", name,
                 fabs(o.h) / 2, r->horizon);
    else
        snprintf(r->text, sizeof r->text, "%s at dt = %.3g, until t = %.4g",
                 name, fabs(o.h) / 2, r->horizon);
}

/* Orbits in a plane, the energy being kept or lost, have no room for chaos. */
static bool has_room(const nevh_reference *r) {
    return r->n > 1 || !(nevh_system_traits(r->system) & NEVH_AUTONOMOUS);
}

/* Why they have separated: by rounding, chaos or not, or by their steps.  Where
   these have `stalled` all that is as small as rounding, such as tolerances, may
   have been blown up. */
static nevh_reference_end explain(pair *b, const outcome *o, bool stalled) {
    static const double many = 1e4;
    nevh_reference *r = b->reference;
    nevh__spread s = blow_up(b, o->h, o->reached);
    bool chaos = has_room(r) && nevh__spread_steady(&s);
    bool rounding = s.most * DBL_EPSILON * 30 > hopeless;
    r->growth = r->exponent = NAN;
    if (!rounding && !(stalled && chaos && s.most > many))
        return NEVH_REFERENCE_COARSE;
    r->growth = s.most;
    r->exponent = nevh__spread_rate(&s, o->reached);
    return chaos ? NEVH_REFERENCE_CHAOS : NEVH_REFERENCE_SENSITIVE;
}

/* What is known from the runs so far. */
typedef struct {
    double error; /* of the last that came to the end */
    /* Of the others, of those that failed [1] and those that did not [0]: what
       was reached at most, and how many, in turn, came no further. */
    double reached[2];
    int stalled[2];
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

/* Shorter steps, 4e9 times better for two at order 12, should have come
   further. */
static bool has_stalled(progress *p, const outcome *o) {
    int failed = o->status != NEVH_OK;
    bool further = fabs(o->reached) > 1.02 * p->reached[failed];
    p->stalled[failed] = further ? 0 : p->stalled[failed] + 1;
    p->reached[failed] = fmax(p->reached[failed], fabs(o->reached));
    return p->stalled[failed] >= 2;
}

/* So that rounding alone separates the runs, where that can be afforded: they
   will go on for longer than the last, at most to the end. */
static double chaos_step(const pair *b, const outcome *o, double cost) {
    const nevh_reference *r = b->reference;
    double longer = fmin(3, (r->t1 - r->t0) / o->reached);
    return cost * longer / shorter < 1 - spent(b) ? shorter * o->h : o->h;
}

/* The shortest by which a run to the end costs no more than that part of what
   may be spent, or as much as is left. */
static double whole_step(const pair *b, const outcome *o, double cost) {
    static const double part = 0.2;
    double span = b->reference->t1 - b->reference->t0;
    double reached = fmax(fabs(o->reached), fabs(o->h));
    return o->h * cost * fabs(span) / reached /
           fmin(part, 0.8 * (1 - spent(b)));
}

/* Whether that was the last run; `cost` is its own. */
static bool is_enough(pair *b, const outcome *o, double cost, progress *p) {
    if (o->status == NEVH_ENOMEM || spent(b) >= 1)
        return true;
    if (o->status)
        return has_stalled(p, o);
    if (o->stepped_over)
        return b->watch.jump.found;
    if (!o->whole) {
        bool stalled = has_stalled(p, o) || spent(b) > late;
        nevh_reference_end why = explain(b, o, stalled);
        bool known = why != NEVH_REFERENCE_COARSE;
        if (!known && !stalled)
            return false;
        keep_part(b, known ? chaos_step(b, o, cost) : whole_step(b, o, cost),
                  why);
        return true;
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
    if (nevh__watch_open(&b->watch, r))
        return nevh__fail(&r->report, NEVH_ENOMEM, "out of memory");
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
    nevh__watch_close(&b.watch);
    free(b.track.states);
    free(b.memory);
    return status;
}
