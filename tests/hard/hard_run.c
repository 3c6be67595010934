/* nevh tests: hard cases: one case with one scheme and gradient, within a budget.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard_judge.h"
#include <float.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

static const double tolerance = 1e-9; /* of adaptive schemes */
static const double endless = 5e4;    /* evaluations of what has no end */
static const double unstable_above = 1;
/* Seconds of computing an evaluation of the budget, until a step is stuck. */
static const double patience = 5e-5;

typedef struct {
    nevh_energy *energy;
    const nevh_stepper *stepper;
    double budget;
    bool spent, unstable;
} guard;

/* Evaluations of H and of its gradient: the same on every machine. */
double hard_work(const nevh_stepper *m) {
    nevh_counts c = nevh_stepper_counts(m);
    return c.hamiltonians + (double)c.gradients;
}

static int watch(void *data, size_t step, double t, const double q[],
                 const double p[]) {
    guard *g = data;
    int status = nevh_energy_observe(g->energy, step, t, q, p);
    g->unstable = fabs(nevh_energy_error(g->energy, 0)) > unstable_above;
    g->spent = hard_work(g->stepper) > g->budget;
    return status ? status : g->spent ? (int)NEVH_STOPPED : NEVH_OK;
}

static nevh_options plan_with(const hard_subject *s, const hard_result *r) {
    nevh_options o = {.gradient = nevh_gradient_named(r->gradient),
                      .gradient_step = s->gradient_step,
                      .t = s->t,
                      .q = s->q,
                      .p = s->p,
                      .balance = s->balance};
    if (nevh_integrator_adaptive(r->scheme))
        o.tolerance = tolerance;
    return o;
}

/* What rounding alone may do to the energy, in values of H and in the state: a
   random walk. */
static double find_noise(const hard_subject *s, nevh_stepper *m, double steps) {
    double noise = 0;
    nevh_field_energy_floor(nevh_stepper_field(m), s->t, s->q, s->p, s->dt,
                            (size_t)steps, &noise);
    return 10 * noise / s->scale + 10 * s->rounding * sqrt(steps);
}

/* And what the gradient lacks, at its worst all along. */
static double find_floor(const hard_subject *s, nevh_stepper *m, double steps) {
    nevh_field *f = nevh_stepper_field(m);
    double rough = 0;
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report step = nevh_field_step_report(f, i);
        if (!step.given && step.size > 0)
            rough = fmax(rough, (step.truncation + step.rounding) / step.size);
    }
    return find_noise(s, m, steps) + (rough + 16 * DBL_EPSILON) * s->peak *
                                         fmax(1, steps * s->dt * s->pace);
}

static bool finite_state(const hard_subject *s, const double q[],
                         const double p[]) {
    for (size_t k = 0; k < s->n; k++)
        if (!isfinite(q[k]) || !isfinite(p[k]))
            return false;
    return true;
}

static void take(hard_result *r, const guard *g, nevh_stepper *m) {
    r->steps = nevh_stepper_taken(m);
    r->energy = nevh_energy_result(g->energy, 0);
    r->whole = !r->status;
    if (r->status == NEVH_STOPPED && g->spent)
        r->status = NEVH_OK;
    if (r->status == NEVH_STOPPED)
        r->status = nevh_energy_status(g->energy),
        r->reason = text_print("%s", nevh_energy_message(g->energy));
    else if (r->status)
        r->reason = text_print("%s", nevh_stepper_message(m));
}

static void integrate(const hard_subject *s, nevh_stepper *m,
                      const nevh_options *o, double budget, hard_result *r) {
    double *q = tool_allocate(s->n, sizeof *q);
    double *p = tool_allocate(s->n, sizeof *p);
    guard g = {.energy = nevh_energy_new(s->system, o),
               .stepper = m,
               .budget = budget};
    memcpy(q, s->q, s->n * sizeof *q);
    memcpy(p, s->p, s->n * sizeof *p);
    if (s->balance)
        nevh_energy_follow(g.energy, m);
    hard_state *state =
        hard_state_new(s, r, nevh_stepper_field(m), o->tolerance);
    nevh_observer observers[] = {
        {watch, &g, 1}, {hard_state_observe, state, hard_state_every(state)}};
    r->status = nevh_run_until(m, s->t, s->dt, s->t_end, q, p, observers,
                               state ? 2 : 1);
    take(r, &g, m);
    hard_state_take(state, r);
    r->sound = finite_state(s, q, p) && !isnan(r->energy.max) &&
               (!r->status || strlen(r->reason) > 10);
    nevh_energy_free(g.energy);
    tool_release(q);
    tool_release(p);
}

/* In units of the largest coordinate and momentum at the start. */
static void turn_back(const hard_subject *s, nevh_stepper *m, hard_result *r) {
    double largest = 0;
    double *scale = tool_allocate(2 * s->n, sizeof *scale);
    for (size_t k = 0; k < s->n; k++)
        largest = fmax(largest, fmax(fabs(s->q[k]), fabs(s->p[k])));
    for (size_t k = 0; k < 2 * s->n; k++)
        scale[k] = largest;
    nevh_stepper_reset(m);
    if (nevh_reversal_defect(m, s->t, s->dt, (size_t)r->asked, s->q, s->p,
                             scale, &r->defect))
        r->sound = false;
    tool_release(scale);
}

/* Where it is fastest, should the run have gone elsewhere than the case. */
static void find_pace(const hard_subject *s, const nevh_options *o,
                      hard_result *r) {
    nevh_options own = *o;
    own.gradient_step = s->own ? 0x1p-6 : o->gradient_step;
    largest_rates fastest =
        stability_rates(s->system, r->scheme, &own, 0, s->dt,
                        s->t + s->dt * fmin((double)r->steps + 1, r->asked));
    if (fastest.frequency > r->frequency)
        r->frequency = fastest.frequency, r->fastest_at = fastest.frequency_at;
}

static void run_planned(const hard_subject *s, nevh_stepper *m,
                        const nevh_options *o, double budget, hard_result *r) {
    bool stops = s->known.facts & HARD_ENDLESS;
    r->order = nevh_stepper_order(m);
    r->floor = find_floor(s, m, r->asked);
    r->state_floor = find_noise(s, m, fmin(r->asked, 1e4));
    integrate(s, m, o, stops ? fmin(budget, endless) : budget, r);
    if (s->known.facts & HARD_RETURN && !r->status)
        turn_back(s, m, r);
    if (!stops && o->tolerance == 0 &&
        (r->status || r->energy.max > unstable_above))
        find_pace(s, o, r);
}

/* A step that does not return cannot be taken back: the end, with its name. */
static char stuck[200];

static void tell_stuck(int signal) {
    (void)signal;
    _exit(write(STDERR_FILENO, stuck, strlen(stuck)) < 0 ? TOOL_USAGE
                                                         : TOOL_FAILED);
}

/* In seconds of this process, which others do not slow down; 0: none. */
static void set_alarm(double seconds) {
    double whole = floor(seconds);
    struct itimerval when = {
        .it_value = {(time_t)whole, (suseconds_t)(1e6 * (seconds - whole))}};
    setitimer(ITIMER_PROF, &when, NULL);
}

void hard_begin(const char *name, const nevh_integrator *scheme,
                double seconds) {
    snprintf(stuck, sizeof stuck, "nevh hard: %s, %s: a step does not return\n",
             name, nevh_integrator_name(scheme));
    signal(SIGPROF, tell_stuck);
    set_alarm(seconds);
}

void hard_end(void) {
    set_alarm(0);
}

void hard_run(const hard_subject *s, double budget, hard_result *r) {
    nevh_options o = plan_with(s, r);
    hard_orbit_follow(s, r->scheme);
    hard_begin(s->known.given.name, r->scheme, patience * budget);
    nevh_stepper *m = nevh_stepper_new(s->system, r->scheme, &o);
    r->status = nevh_stepper_status(m);
    r->planned = !r->status;
    r->asked = ceil((s->t_end - s->t) / s->dt * (1 - 1e-9));
    r->defect = r->state_error = r->state_bound = r->state_at = NAN;
    r->frequency = s->frequency;
    r->fastest_at = s->fastest_at;
    if (r->planned)
        run_planned(s, m, &o, budget, r);
    else
        r->reason = text_print("%s", nevh_stepper_message(m));
    nevh_stepper_free(m);
    hard_end();
}

void hard_result_free(hard_result *r) {
    tool_release(r->reason);
    tool_release(r->happened);
}
