/* nevh: one run of compare, with its observers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "envelope.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    const plan *plan;
    row *row;
    double *q, *p;
} row_job;

typedef struct {
    nevh_energy *energy;
    double limit, since;
} watch;

/* Errors are asked for after every step, which costs more than a step may: this
   is for a run that is known to become unstable. */
static int stop_when_unstable(void *data, size_t step, double t,
                              const double q[], const double p[]) {
    watch *w = data;
    int status = nevh_energy_observe(w->energy, step, t, q, p);
    if (!status && fabs(nevh_energy_error(w->energy, 0)) > w->limit)
        return w->since = t, NEVH_STOPPED;
    return status;
}

static void go_to_start(const row_job *w) {
    memcpy(w->q, w->plan->q, w->plan->n * sizeof *w->q);
    memcpy(w->p, w->plan->p, w->plan->n * sizeof *w->p);
}

static int run(const row_job *w, nevh_stepper *s,
               const nevh_observer observers[], size_t count, double *stopped) {
    go_to_start(w);
    return plan_run(w->plan, s, w->row->step, w->q, w->p, observers, count,
                    stopped);
}

nevh_energy *row_energy(const plan *p, const row *r, const nevh_stepper *s) {
    nevh_options o = plan_options(p, r->gradient);
    nevh_energy *energy = nevh_energy_new(p->system, &o);
    nevh_energy_expect(energy, s);
    if (p->balance)
        nevh_energy_follow(energy, s);
    if (p->balance && p->timing)
        nevh_energy_book(energy,
                         nevh_timing_whole(p->jumps) ? p->jumps : p->timing);
    plan_set_scale(p, energy);
    return energy;
}

/* The run itself, or what follows it. */
static void unstable_since(row_job *w) {
    bool balance = w->plan->balance;
    nevh_stepper *s = row_stepper(w->plan, w->row, balance);
    watch unstable = {row_energy(w->plan, w->row, s), w->row->energy.limit,
                      NAN};
    double stopped;
    run(w, s, &(nevh_observer){stop_when_unstable, &unstable, 1}, 1, &stopped);
    free(w->row->status);
    w->row->status =
        isnan(unstable.since)
            ? text_print("unstable: after t = %.9g", w->plan->t_end)
            : text_print("unstable: since t = %.9g", unstable.since);
    nevh_energy_free(unstable.energy);
    row_stepper_keep(w->plan, w->row, balance, s);
}

/* Values over instances, of which there is a whole number. */
nevh_counts row_counts(const nevh_stepper *s, nevh_counts before) {
    nevh_counts c = nevh_stepper_counts(s);
    double instances = round((double)c.values / c.hamiltonians);
    c.values -= before.values, c.gradients -= before.gradients;
    c.sweeps -= before.sweeps;
    c.newtons -= before.newtons, c.rescues -= before.rescues;
    if (c.hamiltonians > 0)
        c.hamiltonians = (double)c.values / instances;
    return c;
}

/* The mean over all steps tried, those too long for the tolerance included. */
static double mean_step(const row_job *w) {
    int each = nevh_integrator_gradients(w->row->scheme);
    double evaluations = (double)w->row->counts.gradients;
    if (each == 0 || evaluations == 0)
        return w->row->dt;
    return (w->row->t_end - w->plan->run->t_start) * each / evaluations;
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

static void run_observed(row_job *w, nevh_stepper *s) {
    row *r = w->row;
    work_watch wait = {w->plan, r->scheme, s, nevh_stepper_counts(s), false};
    nevh_energy *energy = row_energy(w->plan, w->row, s);
    nevh_state_error *state = nevh_state_error_new(w->plan->reference);
    invariants *kept = w->plan->diagnostics ? invariants_new(w->plan) : NULL;
    nevh_shadow *shadow = row_shadow(w->plan, r);
    observable shown = {w->plan, 0};
    nevh_observer observers[7] = {{nevh_energy_observe, energy, 1}};
    energy_trace trace = {r->errors, energy};
    size_t count = 1;
    if (state)
        nevh_state_error_follow(state, s);
    if (state && (w->plan->observable || w->plan->energies))
        nevh_state_error_hand(state, compare_pair, &shown);
    if (w->plan->energies)
        energies_begin(w->plan->energies);
    if (r->errors)
        observers[count++] = (nevh_observer){energy_trace_observe, &trace, 1};
    if (state)
        observers[count++] =
            (nevh_observer){nevh_state_error_observe, state, 1};
    if (kept)
        observers[count++] = (nevh_observer){invariants_observe, kept, 1};
    if (shadow)
        observers[count++] = (nevh_observer){shadow_observe, shadow, 1};
    bound_watch keeps = {r->error_bound, energy, state, &shown};
    double steps = (w->plan->t_end - w->plan->run->t_start) / r->step;
    if (r->error_bound)
        observers[count++] = (nevh_observer){observe_error_bound, &keeps,
                                             1 + (size_t)(steps / LOOKS)};
    if (w->plan->work_limit > 0)
        observers[count++] =
            (nevh_observer){observe_work, &wait, w->plan->n < 8 ? 8 : 1};
    double begin = cpu_seconds();
    int status = run(w, s, observers, count, &r->stopped);
    r->observed_seconds = cpu_seconds() - begin;
    r->t_end = status                 ? nevh_stepper_time(s)
               : isfinite(r->stopped) ? r->stopped
                                      : w->plan->t_end;
    const char *why = wait.over_limit          ? "it takes too long"
                      : status == NEVH_STOPPED ? nevh_energy_message(energy)
                                               : nevh_stepper_message(s);
    r->energy = nevh_energy_result(energy, 0);
    r->passed = nevh_energy_passed(energy, &r->passed_effect);
    r->steps = nevh_stepper_taken(s);
    r->counts = row_counts(s, wait.before);
    r->over_limit = wait.over_limit;
    r->ran = !r->over_limit && (!status || r->energy.verdict == NEVH_UNSTABLE);
    r->failed = !r->ran;
    r->broken = status && r->ran;
    char *ends = ends_text(w->plan, w->plan->ends);
    r->status = status ? text_print("failed: %s (after t = %.9g)",
                                    ends ? ends : why, nevh_stepper_time(s))
                       : text_print("ok");
    free(ends);
    r->state_error = state_error_of(w->plan, r, state);
    if (state && isnan(r->state_error))
        explain_unknown(w->plan, r, why);
    r->observable_error = isnan(r->state_error) ? NAN : shown.worst;
    if (w->plan->energies && r->ran && !isnan(r->state_error))
        r->energies = energies_result(w->plan->energies);
    r->changes = kept ? invariants_result(kept) : NULL;
    if (!nevh_shadow_status(shadow))
        r->shadow = nevh_shadow_result(shadow);
    nevh_shadow_free(shadow);
    nevh_state_error_free(state);
    nevh_energy_free(energy);
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

static row_job row_job_new(const plan *p, row *r) {
    return (row_job){p, r, tool_allocate(p->n, sizeof(double)),
                     tool_allocate(p->n, sizeof(double))};
}

static void row_job_free(row_job *w) {
    free(w->q);
    free(w->p);
}

/* Sets the distance at which a scheme with a tolerance ends steps for observers: so
   long that the tolerance, not dt, limits its steps. If H reads the time it stays
   dt, so that changes within dt are seen. */
static void space_ends(row_job *w) {
    static const double limited = 0.5, longer = 4, fewest = 16;
    row *r = w->row;
    const plan *p = w->plan;
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
            status = run(w, s, NULL, 0, &stopped);
        double taken = (double)(nevh_stepper_counts(s).gradients - before);
        double mean = (nevh_stepper_time(s) - p->run->t_start) * each / taken;
        row_stepper_keep(p, r, false, s);
        if (status || !(mean > limited * r->step))
            return;
    }
}

void row_run(const plan *p, row *r) {
    row_job w = row_job_new(p, r);
    r->step = r->dt;
    space_ends(&w);
    r->observable = p->observable;
    r->observed_order = r->state_error = r->observable_error = r->stopped =
        r->seconds = NAN;
    nevh_stepper *s = row_stepper(p, r, p->balance);
    if (!refused(r, s)) {
        r->native = nevh_stepper_native(s, NULL);
        run_observed(&w, s);
        if (!p->screening)
            row_follow(p, r);
        if (r->ran && p->diagnostics)
            diagnose_row(p, r);
        if (r->ran && r->energy.verdict == NEVH_UNSTABLE && !p->screening)
            unstable_since(&w);
        if (r->ran && r->tolerance > 0)
            r->dt = mean_step(&w);
    }
    r->work =
        nevh_counts_seconds(&r->counts, p->n, r->scheme, r->order, r->steps);
    row_stepper_keep(p, r, p->balance, s);
    row_job_free(&w);
}

double row_end(const plan *p, const row *r) {
    double stopped = NAN;
    row copy = *r;
    row_job w = row_job_new(p, &copy);
    nevh_stepper *s = row_stepper(p, r, false);
    if (nevh_stepper_status(s) || run(&w, s, NULL, 0, &stopped))
        stopped = p->run->t_start;
    row_stepper_keep(p, r, false, s);
    row_job_free(&w);
    return isnan(stopped) ? p->t_end : stopped;
}

void row_finish(const plan *p, row *r) {
    row_job w = row_job_new(p, r);
    row_follow(p, r);
    if (r->energy.verdict == NEVH_UNSTABLE)
        unstable_since(&w);
    row_job_free(&w);
}

int row_fails(const plan *p, const row *r) {
    tool_refuse("%s: %s with %s at dt = %.4g %s", p->name, r->integrator,
                r->gradient, r->dt, r->status);
    return TOOL_FAILED;
}
