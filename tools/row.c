/* nevh: one run of compare, watched, and once more for its time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "envelope.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double unstable_above = 1; /* as nevh_energy_report says */
static const double time_enough = 0.1;  /* seconds */
static const double time_in_a_hurry = 0.03;
enum { REPEATS = 5 };

typedef struct {
    const plan *plan;
    row *row;
    double *q, *p;
} work;

typedef struct {
    nevh_energy *energy;
    double since;
} watch;

/* Errors are asked for after every step, which costs more than a step may: this
   is for a run that is known to become unstable. */
static int stop_when_unstable(void *data, size_t step, double t,
                              const double q[], const double p[]) {
    watch *w = data;
    int status = nevh_energy_observe(w->energy, step, t, q, p);
    nevh_energy_report r = nevh_energy_result(w->energy, 0);
    if (!status && fabs(r.final) > unstable_above)
        return w->since = t, NEVH_STOPPED;
    return status;
}

nevh_stepper *row_stepper(const plan *p, const row *r, bool balance) {
    nevh_options o = plan_options(p, r->gradient);
    o.transform = plan_transform(p, r->integrator);
    o.tolerance = r->tolerance;
    o.balance = balance;
    return nevh_stepper_new(p->system, r->scheme, &o);
}

static nevh_stepper *new_stepper(const work *w, bool balance) {
    return row_stepper(w->plan, w->row, balance);
}

static void go_to_start(const work *w) {
    memcpy(w->q, w->plan->q, w->plan->n * sizeof *w->q);
    memcpy(w->p, w->plan->p, w->plan->n * sizeof *w->p);
}

static int run(const work *w, nevh_stepper *s, const nevh_observer observers[],
               size_t count, double *stopped) {
    go_to_start(w);
    return plan_run(w->plan, s, w->row->dt, w->q, w->p, observers, count,
                    stopped);
}

static int stop_after(void *data, size_t step, double t, const double q[],
                      const double p[]) {
    const size_t *steps = data;
    (void)t, (void)q, (void)p;
    return step < *steps ? NEVH_OK : NEVH_STOPPED;
}

/* As many steps as the run took that was watched, and nothing else. */
static void repeat(const work *w, nevh_stepper *s) {
    const plan *p = w->plan;
    row *r = w->row;
    go_to_start(w);
    nevh_run_until(s, p->run->t_start, r->dt, p->t_end, w->q, w->p,
                   &(nevh_observer){stop_after, &r->steps, r->steps},
                   isfinite(r->stopped));
}

static nevh_energy *new_energy(const work *w, const nevh_stepper *s) {
    nevh_options o = plan_options(w->plan, w->row->gradient);
    nevh_energy *energy = nevh_energy_new(w->plan->system, &o);
    if (w->plan->balance)
        nevh_energy_follow(energy, s);
    if (w->plan->run->energy_scale > 0)
        nevh_energy_set_scale(energy, w->plan->run->energy_scale);
    return energy;
}

static void unstable_since(work *w) {
    nevh_stepper *s = new_stepper(w, w->plan->balance);
    watch unstable = {new_energy(w, s), NAN};
    double stopped;
    run(w, s, &(nevh_observer){stop_when_unstable, &unstable, 1}, 1, &stopped);
    free(w->row->status);
    w->row->status = text_print("unstable: since t = %.9g", unstable.since);
    nevh_energy_free(unstable.energy);
    nevh_stepper_free(s);
}

static nevh_counts difference(nevh_counts a, nevh_counts b) {
    a.values -= b.values, a.gradients -= b.gradients, a.sweeps -= b.sweeps;
    a.newtons -= b.newtons, a.rescues -= b.rescues;
    a.hamiltonians -= b.hamiltonians;
    return a;
}

static void set_seconds(row *r, double seconds[], size_t count) {
    r->seconds = numbers_median(seconds, count);
    r->spread = (seconds[(3 * count) / 4] - seconds[count / 4]) / 2;
}

/* A few runs that nobody watches: as many as asked for, or until their time is
   enough. */
static void measure(const work *w, size_t repeats) {
    size_t most = repeats ? repeats : REPEATS, count = 0;
    double *seconds = tool_allocate(most, sizeof *seconds), sum = 0;
    nevh_stepper *s = new_stepper(w, false);
    nevh_counts before = nevh_stepper_counts(s);
    double enough = w->plan->hurried ? time_in_a_hurry : time_enough;
    while (count < most && (repeats || sum < enough)) {
        nevh_stepper_reset(s);
        double start = cpu_seconds();
        repeat(w, s);
        sum += seconds[count] = cpu_seconds() - start;
        if (count++ == 0)
            w->row->counts = difference(nevh_stepper_counts(s), before);
    }
    set_seconds(w->row, seconds, count);
    free(seconds);
    nevh_stepper_free(s);
}

/* Of gradients and values of formulas, as a processor of 2020 takes them, give
   or take a factor of two; an implicit step that Newton solves factors a matrix
   as well. */
double row_work(const plan *p, const nevh_counts *c, size_t steps) {
    double n = (double)p->n, m = 2 * n;
    double gradient = c->hamiltonians > 0 ? 100 : 250 + 40 * n;
    return 1e-9 *
           (gradient * (double)c->gradients + (100 + 40 * n) * c->hamiltonians +
            (50 + 10 * n) * (double)steps + m * m * m / 2 * (double)c->newtons);
}

/* Of all steps tried, those that were too long for the tolerance included. */
static double mean_step(const work *w) {
    int each = nevh_integrator_gradients(w->row->scheme);
    double evaluations = (double)w->row->counts.gradients;
    if (each == 0 || evaluations == 0)
        return w->row->dt;
    return (w->row->t_end - w->plan->run->t_start) * each / evaluations;
}

/* Whoever waits for a row no longer than its work is as much as that. */
typedef struct {
    const plan *plan;
    const nevh_stepper *stepper;
    nevh_counts before;
    bool late;
} patience;

static int mind_work(void *data, size_t step, double t, const double q[],
                     const double p[]) {
    patience *wait = data;
    nevh_counts c =
        difference(nevh_stepper_counts(wait->stepper), wait->before);
    (void)t, (void)q, (void)p;
    wait->late = row_work(wait->plan, &c, step) > wait->plan->patience;
    return wait->late ? NEVH_STOPPED : NEVH_OK;
}

/* The reference is compared with at times that are spread over the whole run:
   one that stopped early met too few of them. */
static bool compares_states(const plan *p, const row *r) {
    static const double least = 1. / 32;
    double span = p->reference_end - p->run->t_start;
    return r->t_end - p->run->t_start >= least * span;
}

static void watched(work *w, nevh_stepper *s) {
    row *r = w->row;
    patience wait = {w->plan, s, nevh_stepper_counts(s), false};
    nevh_energy *energy = new_energy(w, s);
    nevh_state_error *state = nevh_state_error_new(w->plan->reference);
    invariants *kept = w->plan->diagnostics ? invariants_new(w->plan) : NULL;
    nevh_observer observers[5] = {{nevh_energy_observe, energy, 1}};
    energy_trace trace = {r->errors, energy};
    size_t count = 1;
    if (r->errors)
        observers[count++] = (nevh_observer){energy_trace_observe, &trace, 1};
    if (state)
        observers[count++] =
            (nevh_observer){nevh_state_error_observe, state, 1};
    if (kept)
        observers[count++] = (nevh_observer){invariants_observe, kept, 1};
    if (w->plan->patience > 0)
        observers[count++] =
            (nevh_observer){mind_work, &wait, w->plan->n < 8 ? 8 : 1};
    int status = run(w, s, observers, count, &r->stopped);
    r->t_end = isfinite(r->stopped) ? r->stopped : w->plan->t_end;
    const char *why = wait.late                ? "it takes too long"
                      : status == NEVH_STOPPED ? nevh_energy_message(energy)
                                               : nevh_stepper_message(s);
    r->energy = nevh_energy_result(energy, 0);
    r->steps = nevh_stepper_taken(s);
    r->counts = difference(nevh_stepper_counts(s), wait.before);
    r->late = wait.late;
    r->ran = !r->late && (!status || r->energy.verdict == NEVH_UNSTABLE);
    r->failed = !r->ran;
    r->status = status ? text_print("failed: %s", why) : text_print("ok");
    r->state_error =
        compares_states(w->plan, r) ? nevh_state_error_result(state) : NAN;
    r->changes = kept ? invariants_result(kept) : NULL;
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

static work work_new(const plan *p, row *r) {
    return (work){p, r, tool_allocate(p->n, sizeof(double)),
                  tool_allocate(p->n, sizeof(double))};
}

static void work_free(work *w) {
    free(w->q);
    free(w->p);
}

void row_run(const plan *p, row *r) {
    work w = work_new(p, r);
    r->observed_order = r->state_error = r->stopped = r->seconds = NAN;
    nevh_stepper *s = new_stepper(&w, p->balance);
    if (!refused(r, s)) {
        watched(&w, s);
        if (r->ran && !p->hurried)
            measure(&w, p->repeats);
        if (r->ran && p->diagnostics)
            diagnose_row(p, r);
        if (r->ran && r->energy.verdict == NEVH_UNSTABLE && !p->hurried)
            unstable_since(&w);
        if (r->ran && r->tolerance > 0)
            r->dt = mean_step(&w);
    }
    r->work = row_work(p, &r->counts, r->steps);
    nevh_stepper_free(s);
    work_free(&w);
}

double row_end(const plan *p, const row *r) {
    double stopped = NAN;
    row copy = *r;
    work w = work_new(p, &copy);
    nevh_stepper *s = new_stepper(&w, false);
    if (nevh_stepper_status(s) || run(&w, s, NULL, 0, &stopped))
        stopped = p->run->t_start;
    nevh_stepper_free(s);
    work_free(&w);
    return isnan(stopped) ? p->t_end : stopped;
}

void row_finish(const plan *p, row *r, double dt, size_t repeats) {
    double mean = r->dt;
    work w = work_new(p, r);
    r->dt = dt;
    measure(&w, repeats);
    if (r->energy.verdict == NEVH_UNSTABLE)
        unstable_since(&w);
    r->dt = mean;
    work_free(&w);
}

double row_seconds(const plan *p, const row *r, double dt) {
    row again = *r;
    work w = work_new(p, &again);
    again.dt = dt;
    measure(&w, 1);
    work_free(&w);
    return again.seconds;
}
