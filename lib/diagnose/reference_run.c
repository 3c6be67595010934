/* nevh: a reference that is a run: which steps it takes, and how far it can be
   trusted.

   Runs with h and h/2 go side by side.  Where they separate early, either h is
   too long, and they are repeated with a shorter one, or the last digits of the
   state have grown: an orbit whose start differs in these tells which.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_pair_private.h"
#include "run/stepper_private.h"
#include "system/print_private.h"
#include <float.h>
#include <math.h>
#include <string.h>

static const double target = 1e-11; /* of the runs' difference */
static const double fair = 1e-9; /* where more would cost more than `little` */
static const double little = 0.05; /* of what may be spent */
static const double hopeless =
    1e-6;                         /* there is no use in going on to the end */
static const double apart = 1e-3; /* as the header says */
static const double bearable = 1e-4; /* error of a first step, for one that can
                                        be afforded to the end */
static const double late = 0.3; /* of what may be spent, to try shorter steps */
static const double shorter = 0.4; /* the next step, where one is too long */
enum { MOST_RUNS = 16 };

/* The longest step allowed, but none shorter than can be afforded; cost: of a pair
   of steps, as a part of the limit. */
static double longest_step(const nevh_reference *r, double cost) {
    static const double fewest = 128, part = 0.1; /* of what may be spent */
    double span = fabs(r->t1 - r->t0), longest = span / fewest;
    if (r->longest > 0)
        longest = fmin(longest, fmax(r->longest, cost * span / part));
    longest = fmin(longest, nevh_timing_shortest(r->timing, NULL, NULL) / 4);
    return copysign(longest, r->t1 - r->t0);
}

/* The longest step that is good at the start; the best one where none is, as
   rounding makes tiny ones bad.  One by which the end can be afforded will do
   where it is not bad. */
static double first_step(nevh__pair *b, int order) {
    static const double good = 1e-9, shortest = 0x1p-60;
    const nevh_reference *r = b->reference;
    double span = r->t1 - r->t0, longest = longest_step(r, 0);
    double h = 0, least = 1, affordable = 0, paid = 0,
           before = nevh__pair_spent(b);
    for (double part = 1; part >= shortest && least >= good; part /= 4) {
        nevh__step_error error = nevh__pair_first_error(b, part * longest);
        double cost = nevh__pair_spent(b) - before;
        before = nevh__pair_spent(b);
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

static int give_up_jump(const nevh__pair *b, const nevh__pair_outcome *o) {
    nevh_reference *r = b->reference;
    const nevh__jump *j = &b->watch.jump;
    double t = r->t0 + o->reached + j->part * o->h;
    if (j->found)
        return nevh__watch_fail(r, j, t);
    return nevh__fail(&r->report, NEVH_EFAILED,
                      "%s %s by %.3g near t = %.6g, mostly in effect \"%s\", "
                      "at steps of %.3g",
                      nevh_integrator_name(r->integrator),
                      b->watch.constant ? "does not keep H: it changes"
                                        : "steps over a change of H",
                      b->watch.changed, t,
                      nevh_system_effect_name(r->system, j->effect),
                      fabs(o->h) / 2);
}

static int give_up(nevh__pair *b, const nevh__pair_outcome *o) {
    nevh__report *report = &b->reference->report;
    double t = b->reference->t0 + o->reached;
    const char *name = nevh_integrator_name(b->reference->integrator);
    const nevh_stepper *s =
        nevh_stepper_status(b->coarse) ? b->coarse : b->fine;
    if (o->status == NEVH_ENOMEM)
        return nevh__no_memory(report);
    if (o->status)
        return nevh__fail(report, o->status, "%s as a reference: %s", name,
                          nevh_stepper_message(s));
    if (o->stepped_over)
        return give_up_jump(b, o);
    return nevh__fail(report, NEVH_EFAILED,
                      "%s is accurate until t = %.4g only, within %.0g "
                      "gradients or %.0g evaluations of terms",
                      name, t, nevh__most_gradients, nevh__most_values);
}

/* The pair's fine orbit becomes the reference. */
static void reference_run_keep(nevh__pair *b, const nevh__pair_outcome *o) {
    nevh_reference *r = b->reference;
    size_t size = 2 * r->n * sizeof(double);
    nevh__reference_orbit old = r->orbit;
    r->orbit = b->orbit;
    b->orbit = old;
    memcpy(r->low, b->low, size);
    memcpy(r->high, b->high, size);
    memcpy(r->range, b->scale, size);
    r->error = fmax(o->error, DBL_EPSILON);
    nevh__print(r->text, sizeof r->text, "%s at dt = %.3g, own error %.0e",
                nevh_integrator_name(r->integrator), fabs(o->h) / 2, r->error);
}

/* As far as they stay together.  `why` they will not to the end. */
static void keep_part(nevh__pair *b, double h, nevh_reference_end why) {
    nevh_reference *r = b->reference;
    nevh__pair_outcome o = nevh__pair_run(b, h, apart);
    const char *name = nevh_integrator_name(r->integrator);
    if (o.status || o.stepped_over || o.reached == 0 ||
        (!o.whole && nevh__pair_spent(b) >= 1))
        return;
    reference_run_keep(b, &o);
    r->exponent = o.whole ? NAN : r->exponent;
    r->growth = o.whole ? NAN : r->growth;
    if (o.whole)
        return;
    r->horizon = r->t0 + o.reached;
    r->end = why;
    if (why == NEVH_REFERENCE_CHAOS)
        nevh__print(r->text, sizeof r->text,
                    "%s at dt = %.3g, until chaos at t = %.4g", name,
                    fabs(o.h) / 2, r->horizon);
    else
        nevh__print(r->text, sizeof r->text, "%s at dt = %.3g, until t = %.4g",
                    name, fabs(o.h) / 2, r->horizon);
}

/* Why they have separated: by rounding, chaos or not, or by their steps.  Where
   these have `stalled` all that is as small as rounding, such as tolerances, may
   have been blown up. */
static nevh_reference_end explain(nevh__pair *b, const nevh__pair_outcome *o,
                                  bool stalled) {
    static const double many = 1e4;
    nevh_reference *r = b->reference;
    double growth;
    bool chaos = nevh__reference_is_chaotic(r, o->reached, &growth);
    bool rounding = growth * DBL_EPSILON * 3 > hopeless;
    if (!rounding && !(stalled && chaos && growth > many)) {
        r->growth = r->exponent = NAN;
        return NEVH_REFERENCE_COARSE;
    }
    r->growth = growth;
    if (!chaos)
        r->exponent = log(growth) / fabs(o->reached);
    return chaos ? NEVH_REFERENCE_CHAOS : NEVH_REFERENCE_SENSITIVE;
}

/* The results of the runs so far. */
typedef struct {
    double error; /* of the last that came to the end */
    /* For the other runs, those that failed [1] and those that did not [0]: the
       largest time reached, and the number of consecutive runs that came no
       further. */
    double reached[2];
    int stalled[2];
} progress;

static double shorter_step(const nevh__pair_outcome *o, int order) {
    if (o->status)
        return o->h / 2;
    if (!o->whole)
        return shorter * o->h;
    double ratio = 0.85 * pow(target / o->error, 1. / order);
    return o->h * fmin(fmax(ratio, 0.2), 0.7);
}

/* Longer again where a run to the end would cost more than is left, if `cost`
   is what the last one did. */
static double affordable_step(const nevh__pair *b, const nevh__pair_outcome *o,
                              double cost, double h) {
    double span = b->reference->t1 - b->reference->t0;
    double whole = o->reached != 0 ? cost * span / o->reached : 0;
    double fitting = 1.1 * o->h * whole / (1 - nevh__pair_spent(b));
    if (fabs(fitting) < fabs(h))
        return h;
    return copysign(fmin(fabs(fitting), 0.9 * fabs(o->h)), h);
}

/* Shorter steps, 4e9 times better for two at order 12, should have come
   further. */
static bool has_stalled(progress *p, const nevh__pair_outcome *o) {
    int failed = o->status != NEVH_OK;
    bool further = fabs(o->reached) > 1.02 * p->reached[failed];
    p->stalled[failed] = further ? 0 : p->stalled[failed] + 1;
    p->reached[failed] = fmax(p->reached[failed], fabs(o->reached));
    return p->stalled[failed] >= 2;
}

/* So that rounding alone separates the runs, where that can be afforded: they
   will go on for longer than the last, at most to the end. */
static double chaos_step(const nevh__pair *b, const nevh__pair_outcome *o,
                         double cost) {
    const nevh_reference *r = b->reference;
    double longer = fmin(3, (r->t1 - r->t0) / o->reached);
    return cost * longer / shorter < 1 - nevh__pair_spent(b) ? shorter * o->h
                                                             : o->h;
}

/* The shortest by which a run to the end costs no more than that part of what
   may be spent, or as much as is left. */
static double whole_step(const nevh__pair *b, const nevh__pair_outcome *o,
                         double cost) {
    static const double part = 0.2;
    double span = b->reference->t1 - b->reference->t0;
    double reached = fmax(fabs(o->reached), fabs(o->h));
    return o->h * cost * fabs(span) / reached /
           fmin(part, 0.8 * (1 - nevh__pair_spent(b)));
}

/* True if that was the last run; `cost` is its own. */
static bool is_enough(nevh__pair *b, const nevh__pair_outcome *o, double cost,
                      progress *p) {
    if (o->status == NEVH_ENOMEM || nevh__pair_spent(b) >= 1)
        return true;
    if (o->status)
        return has_stalled(p, o);
    if (o->stepped_over)
        return b->watch.jump.found;
    if (!o->whole) {
        bool stalled = has_stalled(p, o) || nevh__pair_spent(b) > late;
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
        reference_run_keep(b, o);
    p->error = fmin(p->error, o->error);
    return floor || o->error <= target || (o->error <= fair && cost > little);
}

static int find_run(nevh__pair *b) {
    nevh_reference *r = b->reference;
    int order = nevh_stepper_order(b->coarse);
    double h = first_step(b, order), last = 0;
    progress p = {.error = INFINITY};
    nevh__pair_outcome o = {0};
    for (int i = 0; h != 0 && i < MOST_RUNS; i++) {
        double before = nevh__pair_spent(b);
        if (*r->text && last * o.h / h > 1 - before)
            break; /* good as it is */
        o = nevh__pair_run(b, h, hopeless);
        last = nevh__pair_spent(b) - before;
        if (is_enough(b, &o, last, &p))
            break;
        h = affordable_step(b, &o, last, shorter_step(&o, order));
    }
    return *r->text && o.status != NEVH_ENOMEM ? NEVH_OK : give_up(b, &o);
}

int nevh__reference_run(nevh_reference *r) {
    nevh__pair b = {.reference = r};
    if (nevh_integrator_own_time(r->integrator))
        return nevh__fail(&r->report, NEVH_EINVAL,
                          "%s chooses its own times, which a reference must "
                          "not",
                          nevh_integrator_name(r->integrator));
    int status = nevh__pair_init(&b);
    if (!status)
        status = find_run(&b);
    nevh__pair_clear(&b);
    return status;
}
