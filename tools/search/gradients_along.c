/* nevh gradients: errors and costs of one gradient along the orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradients_private.h"
#include "study.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 256 };

static int record(void *data, size_t step, double t, const double q[],
                  const double p[]) {
    orbit_states *o = data;
    if (step % o->every != 0 || o->count == STATES)
        return 0;
    size_t i = o->count++;
    o->t[i] = t;
    memcpy(o->q + i * o->n, q, o->n * sizeof *q);
    memcpy(o->p + i * o->n, p, o->n * sizeof *p);
    return nevh_field_value(o->field, 1, &t, q, p, &o->h[i]);
}

static orbit_states states_new(const plan *p, size_t steps) {
    return (orbit_states){.n = p->n,
                          .every = steps / (STATES - 1) + 1,
                          .t = tool_allocate(STATES, sizeof(double)),
                          .q = tool_allocate(STATES * p->n, sizeof(double)),
                          .p = tool_allocate(STATES * p->n, sizeof(double)),
                          .h = tool_allocate(STATES, sizeof(double)),
                          .field = plan_values(p)};
}

static const nevh_integrator *scheme_of(const gradients_job *c) {
    bool transformed;
    return plan_scheme(c->plan, c->integrator, &transformed);
}

static nevh_options gradient_options(const gradients_job *c,
                                     const char *gradient, double step) {
    const plan *p = c->plan;
    const nevh_integrator *scheme;
    nevh_options o = plan_scheme_options(p, c->integrator, gradient, &scheme);
    o.gradient_step = step;
    return o;
}

static void states_free(orbit_states *o) {
    tool_release(o->t);
    tool_release(o->q);
    tool_release(o->p);
    tool_release(o->h);
    nevh_field_free(o->field);
}

/* The orbit with that gradient, observed. */
static int follow(const gradients_job *c, const char *gradient, double step,
                  const nevh_observer *observer) {
    enum { RUNS = 6 }; /* with other half-spreads */
    nevh_options o = gradient_options(c, gradient, step);
    o.steps_foreseen = RUNS * (double)c->steps;
    nevh_stepper *s = nevh_stepper_new(c->plan->system, scheme_of(c), &o);
    plan_native_report(s);
    double *q = plan_state(c->plan), *p = q + c->plan->n;
    int status = nevh_stepper_status(s);
    if (!status)
        status = nevh_run(s, c->plan->run->t_start, c->dt, c->steps, q, p,
                          observer, 1);
    nevh_stepper_free(s);
    tool_release(q);
    return status;
}

static int evaluate(const gradients_job *c, nevh_field *f, size_t i,
                    double dq[], double dp[]) {
    size_t n = c->exact.n;
    return nevh_field_gradient(f, 1, &c->exact.t[i], c->exact.q + i * n,
                               c->exact.p + i * n, dq, dp);
}

/* Exact gradients at all states. */
static int evaluate_yardstick(gradients_job *c) {
    size_t n = c->exact.n;
    nevh_options o = gradient_options(c, c->yardstick, 0);
    nevh_field *f = nevh_field_new(c->plan->system, &o);
    int status = nevh_field_status(f);
    c->dq = tool_allocate(n * STATES, sizeof *c->dq);
    c->dp = tool_allocate(n * STATES, sizeof *c->dp);
    for (size_t i = 0; !status && i < c->exact.count; i++)
        status = evaluate(c, f, i, c->dq + i * n, c->dp + i * n);
    for (size_t k = 0; k < n * c->exact.count; k++)
        c->size = fmax(c->size, fmax(fabs(c->dq[k]), fabs(c->dp[k])));
    nevh_field_free(f);
    return status;
}

/* The largest at all states, relative; INFINITY where H fails, with a message
   of the field's. */
static double largest_error(const gradients_job *c, nevh_field *f) {
    size_t n = c->exact.n;
    double *dq = tool_allocate(n, sizeof *dq),
           *dp = tool_allocate(n, sizeof *dp), error = 0;
    for (size_t i = 0; i < c->exact.count && !isinf(error); i++) {
        if (evaluate(c, f, i, dq, dp))
            error = INFINITY;
        for (size_t k = 0; k < n && !isinf(error); k++) {
            error = fmax(error, fabs(dq[k] - c->dq[i * n + k]));
            error = fmax(error, fabs(dp[k] - c->dp[i * n + k]));
        }
    }
    tool_release(dq);
    tool_release(dp);
    return error / c->size;
}

static void errors_along(const gradients_job *c, nevh_field *f, finding *g) {
    nevh_counts before = nevh_field_counts(f);
    g->error = largest_error(c, f);
    g->good = !isinf(g->error);
    g->evaluations = (nevh_field_counts(f).hamiltonians - before.hamiltonians) /
                     (double)c->exact.count;
}

double gradient_error(const gradients_job *c, const char *gradient,
                      const double steps[]) {
    nevh_options o = gradient_options(c, gradient, 0);
    if (steps)
        o.gradient_steps = steps;
    nevh_field *f = nevh_field_new(c->plan->system, &o);
    double error = nevh_field_status(f) ? INFINITY : largest_error(c, f);
    nevh_field_free(f);
    return error;
}

/* The median of a few rounds, each of which goes on along the orbit. */
static double time_of(const gradients_job *c, nevh_field *f) {
    enum { ROUNDS_TIMED = 5, AT_ONCE = 16 };
    static const double enough = 2e-3; /* seconds a round */
    double seconds[ROUNDS_TIMED];
    double *out = tool_allocate(2 * c->exact.n, sizeof *out);
    size_t at = 0;
    for (int round = 0; round < ROUNDS_TIMED; round++) {
        double start = cpu_seconds(), now = start;
        size_t count = 0;
        do {
            for (int i = 0; i < AT_ONCE; i++, count++, at++)
                evaluate(c, f, at % c->exact.count, out, out + c->exact.n);
            now = cpu_seconds();
        } while (now - start < enough);
        seconds[round] = (now - start) / (double)count;
    }
    tool_release(out);
    return 1e9 * numbers_median(seconds, ROUNDS_TIMED);
}

/* The errors that planning expects of its differences, the worst of all variables. */
static void take_estimates(const gradients_job *c, nevh_field *f, finding *g) {
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report r = nevh_field_step_report(f, i);
        if (r.given)
            continue;
        g->truncation = fmax(g->truncation, r.truncation / c->size);
        g->rounding = fmax(g->rounding, r.rounding / c->size);
    }
}

/* The energy that errors of a gradient bring in along an orbit: with g = dH + e
   instead of dH, dH/dt = dH/dq e_p - dH/dp e_q.  Unlike the difference of two
   orbits that means something where orbits part. */
typedef struct {
    double rate, sum, most;
} influx;

typedef struct {
    nevh_field *exact;
    const finding *findings;
    influx *influx; /* of each */
    size_t count, n;
    double *gradient; /* dq, dp; the same of another: n each */
    bool begun;
    double t;
} inflow;

static int add_influx(inflow *f, influx *sum, nevh_field *other, double t,
                      const double q[], const double p[]) {
    size_t n = f->n;
    double *dq = f->gradient, *dp = dq + n, *gq = dp + n, *gp = gq + n;
    double rate = 0;
    int status = nevh_field_gradient(other, 1, &t, q, p, gq, gp);
    for (size_t k = 0; k < n; k++)
        rate += dq[k] * (gp[k] - dp[k]) - dp[k] * (gq[k] - dq[k]);
    if (f->begun)
        sum->sum += (rate + sum->rate) / 2 * (t - f->t);
    sum->most = status ? NAN : fmax(sum->most, fabs(sum->sum));
    sum->rate = rate;
    return status;
}

static int observe_influx(void *data, size_t step, double t, const double q[],
                          const double p[]) {
    inflow *f = data;
    (void)step;
    int status = nevh_field_gradient(f->exact, 1, &t, q, p, f->gradient,
                                     f->gradient + f->n);
    for (size_t i = 0; !status && i < f->count; i++)
        if (f->findings[i].good && isfinite(f->influx[i].most))
            add_influx(f, &f->influx[i], f->findings[i].field, t, q, p);
    f->begun = true, f->t = t;
    return status;
}

void gradients_influx(const gradients_job *c, finding findings[],
                      size_t count) {
    nevh_options o = gradient_options(c, c->yardstick, 0);
    size_t n = c->exact.n;
    inflow f = {.exact = nevh_field_new(c->plan->system, &o),
                .findings = findings,
                .influx = tool_allocate(count, sizeof(influx)),
                .count = count,
                .n = n,
                .gradient = tool_allocate(4 * n, sizeof(double))};
    int status =
        follow(c, c->yardstick, 0, &(nevh_observer){observe_influx, &f, 1});
    for (size_t i = 0; i < count; i++)
        findings[i].influx = status ? NAN : f.influx[i].most / c->scale;
    nevh_field_free(f.exact);
}

static double energy_along(const gradients_job *c, const finding *g) {
    orbit_states o = states_new(c->plan, c->steps);
    double most = 0;
    int status =
        follow(c, g->gradient, g->step, &(nevh_observer){record, &o, 1});
    for (size_t i = 0; i < o.count; i++)
        most = fmax(most, fabs(o.h[i] - o.h[0]) / c->scale);
    states_free(&o);
    return status || c->plan->balance ? NAN : most;
}

/* The mean over some states: where the orbit rests nothing is noisy. */
static double floor_along(const gradients_job *c, nevh_field *f) {
    size_t n = c->exact.n, apart = c->exact.count / 16 + 1, count = 0;
    double sum = 0, one;
    for (size_t i = 0; i < c->exact.count; i += apart, count++) {
        if (nevh_field_energy_floor(f, c->exact.t[i], c->exact.q + i * n,
                                    c->exact.p + i * n, c->dt, c->steps, &one))
            return NAN;
        sum += one * one;
    }
    return sqrt(sum / (double)count) / c->scale;
}

finding gradient_find(const gradients_job *c, const char *gradient,
                      double step) {
    finding g = {
        .gradient = gradient, .step = step, .good = true, .floor = NAN};
    nevh_options o = gradient_options(c, gradient, step);
    nevh_field *f = nevh_field_new(c->plan->system, &o);
    g.good = !nevh_field_status(f);
    if (g.good)
        errors_along(c, f, &g);
    g.why = text_print("%s", g.good ? "" : nevh_field_message(f));
    if (g.good) {
        take_estimates(c, f, &g);
        g.nanoseconds = time_of(c, f);
        g.energy = energy_along(c, &g);
        g.floor = floor_along(c, f);
    }
    g.field = f;
    return g;
}

/* The shortest of those that differences of full order have chosen. */
double gradient_own_step(const gradients_job *c, const char *gradient) {
    nevh_options o = gradient_options(c, gradient, 0);
    nevh_field *f = nevh_field_new(c->plan->system, &o);
    double shortest = INFINITY;
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report r = nevh_field_step_report(f, i);
        if (r.order == nevh_gradient_order(o.gradient) && !r.blind)
            shortest = fmin(shortest, r.step);
    }
    nevh_field_free(f);
    return shortest;
}

/* The exact gradient, or the most exact that there is. */
static const char *find_yardstick(const plan *p) {
    static const char *const names[] = {"exact", "complex-step", "central8"};
    for (size_t i = 0; i < 2; i++)
        if (gradient_fits(p, names[i], NULL))
            return names[i];
    return names[2];
}

/* The work of a step with differences, from a pilot of a few steps. */
static double step_work(const gradients_job *c) {
    enum { PILOT = 32 };
    nevh_options o = gradient_options(c, "central4", 0);
    nevh_stepper *s = nevh_stepper_new(c->plan->system, scheme_of(c), &o);
    size_t n = c->plan->n;
    double *state = plan_state(c->plan);
    nevh_counts before = nevh_stepper_counts(s);
    int status = nevh_run(s, c->plan->run->t_start, c->dt, PILOT, state,
                          state + n, NULL, 0);
    nevh_counts spent = row_counts(s, before);
    int order = nevh_stepper_order(s);
    double work =
        nevh_counts_seconds(&spent, c->plan->n, scheme_of(c), order, PILOT) /
        PILOT;
    nevh_stepper_free(s);
    return status ? 0 : work;
}

/* Up to the end of the run, or to where it stops, or as far as the runs of all
   gradients and steps come in about a second. */
static void choose_steps(gradients_job *c) {
    enum { RUNS = 40 };
    static const double most = 2e4, least = 256, budget = 1.2;
    const plan *p = c->plan;
    double steps = round((p->t_end - p->run->t_start) / c->dt);
    double few = fmax(budget / (RUNS * step_work(c)), least);
    stop s = {.scene = p->scene};
    c->steps = (size_t)fmin(fmax(steps, 1), fmin(few, most));
    if (nevh_scene_stops(p->scene))
        follow(c, c->yardstick, 0, &(nevh_observer){stop_observe, &s, 1});
    if (s.reached && s.step > 0)
        c->steps = s.step;
}

int gradients_job_make(gradients_job *c, const plan *p) {
    if (!plan_fits(p, &c->integrator))
        return TOOL_USAGE;
    c->plan = p;
    c->dt = p->dt[p->dts - 1];
    c->scale = plan_energy_scale(p);
    c->yardstick = find_yardstick(p);
    choose_steps(c);
    c->exact = states_new(p, c->steps);
    if (!follow(c, c->yardstick, 0, &(nevh_observer){record, &c->exact, 1}) &&
        !evaluate_yardstick(c))
        return TOOL_OK;
    char *why = plan_why(p, "another integrator or a shorter dt may not");
    tool_refuse("%s: %s at dt = %g fails on this orbit: %s", p->name,
                c->integrator, c->dt, why);
    return TOOL_FAILED;
}
