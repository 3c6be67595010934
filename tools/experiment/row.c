/* nevh: one run of compare, with its observers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "envelope.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

nevh_energy *row_energy_unscaled(const plan *p, const row *r,
                                 const nevh_stepper *s) {
    nevh_options o = plan_options(p, r->gradient);
    nevh_energy *energy = nevh_energy_new(p->system, &o);
    nevh_energy_expect(energy, s);
    if (p->balance)
        nevh_energy_follow(energy, s);
    if (p->balance && p->timing)
        nevh_energy_book(energy,
                         nevh_timing_whole(p->jumps) ? p->jumps : p->timing);
    return energy;
}

nevh_energy *row_energy(const plan *p, const row *r, const nevh_stepper *s) {
    nevh_energy *energy = row_energy_unscaled(p, r, s);
    plan_set_scale(p, energy);
    return energy;
}

/* The run itself, or what follows it. */
static void unstable_since(const plan *p, row *r) {
    nevh_stepper *s = row_stepper(p, r, p->balance);
    energy_limit e = {row_energy(p, r, s), .limit = r->energy.limit};
    double stopped;
    /* Errors are asked for after every step, which costs more than a step may. */
    plan_run(p, s, r->step, &(nevh_observer){energy_limit_observe, &e, 1}, 1,
             &stopped);
    r->status = e.passed ? text_print("unstable: since t = %.9g", e.t)
                         : text_print("unstable: after t = %.9g", p->t_end);
    nevh_energy_free(e.energy);
    row_stepper_keep(p, r, p->balance, s);
}

nevh_counts row_counts(const nevh_stepper *s, nevh_counts before) {
    nevh_counts c = nevh_stepper_counts(s);
    c.values -= before.values, c.gradients -= before.gradients;
    c.sweeps -= before.sweeps;
    c.newtons -= before.newtons, c.rescues -= before.rescues;
    if (c.hamiltonians > 0)
        c.hamiltonians = (double)c.values / (double)c.instances;
    return c;
}

/* The mean over all steps tried, those too long for the tolerance included. */
static double mean_step(const plan *p, const row *r) {
    int each = nevh_integrator_gradients(r->scheme);
    double evaluations = (double)r->counts.gradients;
    if (each == 0 || evaluations == 0)
        return r->dt;
    return (r->t_end - p->run->t_start) * each / evaluations;
}

/* A compiler is waited for no longer than the row's own work takes. */
typedef struct {
    const plan *plan;
    const nevh_integrator *scheme;
    const nevh_stepper *stepper;
    nevh_counts before;
    bool over_limit;
} work_watch;

static int observe_work(void *data, size_t step, double t, const double q[],
                        const double p[]) {
    work_watch *wait = data;
    nevh_counts c = row_counts(wait->stepper, wait->before);
    (void)t, (void)q, (void)p;
    wait->over_limit = nevh_counts_seconds(&c, wait->plan->n, wait->scheme,
                                           nevh_stepper_order(wait->stepper),
                                           step) > wait->plan->work_limit;
    return wait->over_limit ? NEVH_STOPPED : NEVH_OK;
}

/* Checks an error bound, about LOOKS times a run. */
typedef struct {
    error_bound *error_bound;
    const nevh_energy *energy;
    const nevh_state_error *state;
    const observable *shown; /* counts where the plan has one */
} bound_watch;

enum { LOOKS = 4000 };

static int observe_error_bound(void *data, size_t step, double t,
                               const double q[], const double p[]) {
    bound_watch *k = data;
    error_bound *bound = k->error_bound;
    double error = bound->by_state ? nevh_state_error_result(k->state)
                                   : nevh_energy_result(k->energy, 0).max;
    if (bound->by_state && k->shown->plan->observable && !isnan(error))
        error = k->shown->worst;
    (void)step, (void)q, (void)p;
    bound->unknown = isnan(error);
    bound->broken = error > bound->most;
    if (bound->unknown || bound->broken)
        return NEVH_STOPPED;
    bound->until = t;
    return NEVH_OK;
}

static void compare_pair(void *data, double t, const double q[],
                         const double p[], const double reference[]) {
    observable *shown = data;
    if (shown->plan->observable)
        observable_compare(shown, t, q, p, reference);
    if (shown->plan->energies)
        energies_compare(shown->plan->energies, t, q, p, reference);
}

/* The reference is compared with at times that are spread over the whole run:
   one that stopped early met too few of them. */
static bool compares_states(const plan *p, const row *r) {
    static const double least = 1. / 32;
    double span = p->reference_end - p->run->t_start;
    return r->t_end - p->run->t_start >= least * span;
}

/* The state error of a run that broke off counts if it is out of step; else it is
   unknown. */
static double state_error_of(const plan *p, const row *r,
                             const nevh_state_error *state) {
    double error = nevh_state_error_result(state);
    bool whole = !r->broken || error > STATE_OUT_OF_STEP;
    return whole && compares_states(p, r) ? error : NAN;
}

static void explain_unknown(const plan *p, row *r, const char *why) {
    const char *message = nevh_reference_message(p->reference);
    if (r->broken)
        snprintf(r->state_unknown, sizeof r->state_unknown,
                 "it broke off after t = %.6g: %s", r->t_end, why);
    else if (!compares_states(p, r))
        snprintf(r->state_unknown, sizeof r->state_unknown,
                 "it ended at t = %.6g, too early to be compared", r->t_end);
    else
        snprintf(r->state_unknown, sizeof r->state_unknown,
                 "the reference has no state: %s", message);
}

/* The observers of a run; NULL: it is not observed for that. */
typedef struct {
    nevh_energy *energy;
    nevh_state_error *state;
    invariants *kept;
    nevh_shadow *shadow;
    observable shown;
    energy_trace trace;
    bound_watch bound;
    work_watch work;
    nevh_observer all[7];
    size_t count;
} row_observers;

static void add_observer(row_observers *o, nevh_observe_fn observe, void *data,
                         double every) {
    if (data)
        o->all[o->count++] = (nevh_observer){observe, data, (size_t)every};
}

/* Lists the observers, which refer to each other; the energy comes first. */
static void observe_all(row_observers *o, const plan *p, row *r) {
    double steps = (p->t_end - p->run->t_start) / r->step;
    add_observer(o, nevh_energy_observe, o->energy, 1);
    add_observer(o, energy_trace_observe, r->errors ? &o->trace : NULL, 1);
    add_observer(o, nevh_state_error_observe, o->state, 1);
    add_observer(o, invariants_observe, o->kept, 1);
    add_observer(o, shadow_observe, o->shadow, 1);
    add_observer(o, observe_error_bound, r->error_bound ? &o->bound : NULL,
                 1 + floor(steps / LOOKS));
    add_observer(o, observe_work, p->work_limit > 0 ? &o->work : NULL,
                 p->n < 8 ? 8 : 1);
}

static void observers_new(row_observers *o, const plan *p, row *r,
                          const nevh_stepper *s) {
    *o = (row_observers){
        .energy = row_energy(p, r, s),
        .state = nevh_state_error_new(p->reference),
        .kept = p->diagnostics ? invariants_new(p) : NULL,
        .shadow = row_shadow(p, r),
        .shown = {p, 0},
        .work = {p, r->scheme, s, nevh_stepper_counts(s), false}};
    o->trace = (energy_trace){r->errors, o->energy};
    o->bound = (bound_watch){r->error_bound, o->energy, o->state, &o->shown};
    if (o->state)
        nevh_state_error_follow(o->state, s);
    if (o->state && (p->observable || p->energies))
        nevh_state_error_hand(o->state, compare_pair, &o->shown);
    if (p->energies)
        energies_begin(p->energies);
    observe_all(o, p, r);
}

static void set_status(const plan *p, row *r, int status, const char *why,
                       double t) {
    char *ends = ends_text(p, p->ends);
    r->ran = !r->over_limit && (!status || r->energy.verdict == NEVH_UNSTABLE);
    r->failed = !r->ran;
    r->broken = status && r->ran;
    r->status =
        status ? text_print("failed: %s (after t = %.9g)", ends ? ends : why, t)
               : text_print("ok");
    tool_release(ends);
}

/* Results of the observers, which go. */
static void observers_result(row_observers *o, const plan *p, row *r,
                             const char *why) {
    r->state_error = state_error_of(p, r, o->state);
    if (o->state && isnan(r->state_error))
        explain_unknown(p, r, why);
    r->observable_error = isnan(r->state_error) ? NAN : o->shown.worst;
    if (p->energies && r->ran && !isnan(r->state_error))
        r->energies = energies_result(p->energies);
    r->changes = o->kept ? invariants_result(o->kept) : NULL;
    if (!nevh_shadow_status(o->shadow))
        r->shadow = nevh_shadow_result(o->shadow);
    nevh_shadow_free(o->shadow);
    nevh_state_error_free(o->state);
    nevh_energy_free(o->energy);
}

static void run_observed(const plan *p, row *r, nevh_stepper *s) {
    row_observers o;
    observers_new(&o, p, r, s);
    double begin = cpu_seconds();
    int status = plan_run(p, s, r->step, o.all, o.count, &r->stopped);
    r->observed_seconds = cpu_seconds() - begin;
    r->t_end = status                 ? nevh_stepper_time(s)
               : isfinite(r->stopped) ? r->stopped
                                      : p->t_end;
    const char *why = o.work.over_limit        ? "it takes too long"
                      : status == NEVH_STOPPED ? nevh_energy_message(o.energy)
                                               : nevh_stepper_message(s);
    r->energy = nevh_energy_result(o.energy, 0);
    r->passed = nevh_energy_passed(o.energy, &r->passed_effect);
    r->steps = nevh_stepper_taken(s);
    r->counts = row_counts(s, o.work.before);
    r->over_limit = o.work.over_limit;
    set_status(p, r, status, why, nevh_stepper_time(s));
    observers_result(&o, p, r, why);
}

static bool is_refusal(int status) {
    return status == NEVH_ESTRUCT || status == NEVH_ENOGRAD ||
           status == NEVH_EINVAL;
}

static bool refused(row *r, const nevh_stepper *s) {
    int status = nevh_stepper_status(s);
    r->order =
        status ? nevh_integrator_order(r->scheme) : nevh_stepper_order(s);
    if (!status)
        return false;
    r->failed = !is_refusal(status);
    r->status = text_print(r->failed ? "failed: %s" : "refused: %s",
                           nevh_stepper_message(s));
    return true;
}

/* Sets the distance at which a scheme with a tolerance ends steps for observers: so
   long that the tolerance, not dt, limits its steps. If H reads the time it stays
   dt, so that changes within dt are seen. */
static void space_ends(const plan *p, row *r) {
    static const double limited = 0.5, longer = 4, fewest = 16;
    double longest = (p->t_end - p->run->t_start) / fewest, stopped;
    int each = nevh_integrator_gradients(r->scheme);
    if (r->tolerance == 0 || each == 0 || p->time || p->screening ||
        nevh_integrator_own_time(r->scheme))
        return;
    for (; longer * r->step <= longest; r->step *= longer) {
        nevh_stepper *s = row_stepper(p, r, false);
        uint64_t before = nevh_stepper_counts(s).gradients;
        int status = nevh_stepper_status(s);
        if (!status)
            status = plan_run(p, s, r->step, NULL, 0, &stopped);
        double taken = (double)(nevh_stepper_counts(s).gradients - before);
        double mean = (nevh_stepper_time(s) - p->run->t_start) * each / taken;
        row_stepper_keep(p, r, false, s);
        if (status || !(mean > limited * r->step))
            return;
    }
}

void row_run(const plan *p, row *r) {
    r->step = r->dt;
    space_ends(p, r);
    r->by_state = p->by_state;
    r->observable = p->observable;
    r->observed_order = r->state_error = r->observable_error = r->stopped =
        r->seconds = r->fastest = NAN;
    nevh_stepper *s = row_stepper(p, r, p->balance);
    if (!refused(r, s)) {
        r->native = nevh_stepper_native(s, NULL);
        run_observed(p, r, s);
        outcome_compare(p, r);
        if (!p->screening)
            row_follow(p, r);
        if (r->ran && p->diagnostics)
            diagnose_row(p, r);
        if (r->ran && r->energy.verdict == NEVH_UNSTABLE && !p->screening)
            unstable_since(p, r);
        if (r->ran && r->tolerance > 0)
            r->dt = mean_step(p, r);
    }
    r->work =
        nevh_counts_seconds(&r->counts, p->n, r->scheme, r->order, r->steps);
    row_stepper_keep(p, r, p->balance, s);
}

double row_end(const plan *p, const row *r) {
    double stopped = NAN;
    nevh_stepper *s = row_stepper(p, r, false);
    if (nevh_stepper_status(s) || plan_run(p, s, r->dt, NULL, 0, &stopped))
        stopped = p->run->t_start;
    row_stepper_keep(p, r, false, s);
    return isnan(stopped) ? p->t_end : stopped;
}

void row_finish(const plan *p, row *r) {
    row_follow(p, r);
    if (r->energy.verdict == NEVH_UNSTABLE)
        unstable_since(p, r);
}

int row_fails(const plan *p, const row *r) {
    tool_refuse("%s: %s with %s at dt = %.4g %s", p->name, r->integrator,
                r->gradient, r->dt, r->status);
    return TOOL_FAILED;
}
