/* nevh: the analysis of chaos is planned.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include "diagnose/energy_private.h"
#include "run/stepper_private.h"
#include <fenv.h>
#include <math.h>
#include <nevh/diagnose.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    STARTS = 8,
    MOST_LANES = 1 << 16,
    LOOKS_A_PERIOD = 24,
    MOST_STRIDE = 64, /* steps */
    STATES_NEAR = 7
};

static int chaos_check(nevh_chaos *c, const nevh_chaos_options *o) {
    size_t most = 2 * c->n;
    if (!o->options || !o->options->q || !o->options->p)
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "chaos: there is no state to start from");
    if (!o->integrator)
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "the integrator is NULL: is its name spelt right?");
    if (!(c->dt > 0) || !isfinite(c->dt) || !isfinite(c->t_start))
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "chaos: a step of %g from t = %g is none", o->dt,
                          c->t_start);
    if (c->exponents > most)
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "chaos: %zu exponents, but there are %zu",
                          c->exponents, most);
    if (c->deviations + c->of_members < 2 || c->deviations > most)
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "chaos: %zu displacements, but it takes 2 ... %zu",
                          c->deviations, most);
    if (c->starts > MOST_LANES / most / 4)
        return nevh__fail(&c->report, NEVH_EINVAL,
                          "chaos: %zu starts are too many", c->starts);
    if (o->options->transform)
        return nevh__fail(&c->report, NEVH_ESTRUCT,
                          "chaos: a transform of time makes steps depend on "
                          "the state");
    return NEVH_OK;
}

static int check_scheme(nevh_chaos *c, const nevh_integrator *scheme) {
    if (scheme->own_time)
        return nevh__fail(&c->report, NEVH_ESTRUCT,
                          "chaos: %s chooses its steps by the state, so that "
                          "neighbouring orbits take other ones; take a scheme "
                          "of fixed steps",
                          scheme->name);
    return NEVH_OK;
}

/* Lengths, and the refusals of the scheme, come from a stepper of H. */
static int plan_lengths(nevh_chaos *c, const nevh_integrator *scheme) {
    nevh_options o = c->options;
    o.native = NEVH_NATIVE_NEVER; /* it takes no steps */
    nevh_stepper *s = nevh_stepper_new(c->system, scheme, &o);
    if (!s)
        return nevh__no_memory(&c->report);
    if (nevh_stepper_status(s) || nevh_work_find_scale(&s->work))
        nevh__fail_as(&c->report, &s->report);
    else
        memcpy(c->own + 2 * c->n, s->work.scale,
               2 * c->n * sizeof *s->work.scale);
    nevh_stepper_free(s);
    c->options.scale = c->own + 2 * c->n;
    return c->report.status;
}

/* The rate at which displacements rotate, or grow, at a state; 0 if it is unknown. */
static double rate_at(const nevh_chaos *c, nevh_rates *r, const double z[]) {
    double frequency = 0, growth = 0;
    if (nevh_rates_at(r, c->t_start, z, z + c->n, &frequency, &growth))
        return 0;
    double rate = fmax(frequency, isfinite(growth) ? growth : 0);
    return isfinite(rate) ? rate : 0;
}

/* The median of states that are a length of H away: forces may be straight where
   the orbit starts, as those of a pendulum at a right angle. */
static double rate_near(const nevh_chaos *c, nevh_rates *r) {
    double rates[STATES_NEAR];
    uint64_t random = 1;
    for (size_t i = 0; i < STATES_NEAR; i++) {
        for (size_t k = 0; k < 2 * c->n; k++)
            c->place[k] =
                c->own[k] + c->options.scale[k] * nevh__random(&random);
        double rate = rate_at(c, r, c->place);
        size_t at = i;
        for (; at > 0 && rates[at - 1] > rate; at--)
            rates[at] = rates[at - 1];
        rates[at] = rate;
    }
    return rates[STATES_NEAR / 2];
}

/* Time in which the fastest motion turns once, or grows by exp(2 pi). */
static int plan_period(nevh_chaos *c) {
    nevh_options o = c->options;
    o.gradient = NULL;
    nevh_rates *r = nevh_rates_new(c->system, &o);
    if (!r)
        return nevh__no_memory(&c->report);
    double rate = fmax(rate_at(c, r, c->own), rate_near(c, r) / 2);
    nevh_rates_free(r);
    c->period = rate > 0 ? 2 * acos(-1) / rate : 8 * c->dt;
    c->turn = (size_t)fmax(1, fmin(1e6, c->period / c->dt));
    c->first_stride =
        (size_t)fmax(1, fmin(MOST_STRIDE, c->period / c->dt / LOOKS_A_PERIOD));
    return NEVH_OK;
}

/* Gradients that terms bring, where they do. */
static int chaos_plan_field(nevh_chaos *c) {
    nevh_options o = c->options;
    for (int i = 0; i < 2; i++) {
        o.gradient = i ? c->options.gradient : nevh_exact;
        nevh_field_free(c->field);
        c->field = nevh_field_new(c->system, &o);
        if (!c->field)
            return nevh__no_memory(&c->report);
        if (nevh_field_status(c->field) != NEVH_ENOGRAD)
            break;
    }
    if (nevh_field_status(c->field))
        return nevh__fail(&c->report, nevh_field_status(c->field), "%s",
                          nevh_field_message(c->field));
    c->options.gradient = o.gradient;
    return NEVH_OK;
}

/* A stepper of so many lanes, which are all planned for the same state: rows of
   coordinates, then of momenta. */
static int plan_stepper(nevh_chaos *c, const nevh_system *system, size_t rows,
                        const double state[], const double scale[],
                        const nevh_integrator *scheme, nevh__report *report) {
    nevh_options o = c->options;
    o.width = c->width;
    o.scale = scale;
    o.gradient_steps = NULL;
    o.balance = false;
    for (size_t i = 0; i < rows * c->width; i++) {
        c->q[i] = state[i / c->width];
        c->p[i] = state[rows + i / c->width];
    }
    o.q = c->q;
    o.p = c->p;
    nevh_stepper *s = nevh_stepper_new(system, scheme, &o);
    if (!s)
        return nevh__no_memory(report);
    if (nevh_stepper_status(s)) {
        nevh__fail_as(report, &s->report);
        nevh_stepper_free(s);
        return report->status;
    }
    c->stepper = s;
    return NEVH_OK;
}

static int plan_tangent(nevh_chaos *c, const nevh_integrator *scheme,
                        nevh__report *report) {
    size_t n = c->n;
    double *state = nevh__array(8 * n, sizeof *state), *scale = state + 4 * n;
    if (!state)
        return nevh__no_memory(report);
    for (size_t k = 0; k < n; k++) {
        state[k] = c->own[k];
        state[3 * n + k] = c->own[n + k];
        state[n + k] = scale[k] = scale[n + k] = c->options.scale[k];
        state[2 * n + k] = scale[2 * n + k] = scale[3 * n + k] =
            c->options.scale[n + k];
    }
    nevh_options kept = c->options;
    c->variational = nevh__variational_new(c->system, c->options.scale, report);
    c->options.gradient = nevh_exact;
    if (c->variational)
        plan_stepper(c, c->variational->system, 2 * n, state, scale, scheme,
                     report);
    c->options = kept;
    free(state);
    return report->status;
}

/* True if a step of the variational system is the derivative of a step. */
static bool is_natural(const nevh_integrator *scheme) {
    return scheme->symplectic != NEVH_EXTENDED &&
           scheme->preserves_energy != NEVH_YES && !scheme->kernel->opaque;
}

static void set_lanes(nevh_chaos *c, bool tangent) {
    size_t vectors = nevh__chaos_vectors(c);
    c->tangent = tangent;
    c->lanes = tangent ? vectors : 2 * vectors + 1;
    c->width = nevh__padded(c->starts * c->lanes);
}

static int plan_walk(nevh_chaos *c, const nevh_integrator *scheme,
                     bool differences) {
    nevh__report why = {0};
    if (!is_natural(scheme))
        snprintf(c->why, sizeof c->why,
                 "a step of %s on the variational equations is not its own "
                 "derivative",
                 scheme->name);
    else if (differences)
        snprintf(c->why, sizeof c->why, "differences were asked for");
    else {
        set_lanes(c, true);
        if (!plan_tangent(c, scheme, &why))
            return NEVH_OK;
        if (why.status == NEVH_ENOMEM)
            return nevh__fail_as(&c->report, &why);
        snprintf(c->why, sizeof c->why, "%.*s", (int)sizeof c->why - 1,
                 why.text);
    }
    set_lanes(c, false);
    return plan_stepper(c, c->system, c->n, c->own, c->options.scale, scheme,
                        &c->report);
}

static void lay_out_start(nevh__arena *a, const nevh_chaos *c,
                          nevh__chaos_start *s) {
    size_t vectors = nevh__chaos_vectors(c);
    s->w = nevh__arena_take(a, vectors * 2 * c->n, sizeof *s->w);
    s->norm = nevh__arena_take(a, vectors, sizeof *s->norm);
    s->log =
        nevh__arena_take(a, nevh__chaos_logs(c) * NEVH__BINS, sizeof *s->log);
    s->gali = nevh__arena_take(a, c->deviations + 1, sizeof *s->gali);
    s->first = nevh__arena_take(a, 2 * c->n, sizeof *s->first);
    s->course = nevh__arena_take(a, 2 * c->n, sizeof *s->course);
}

static void chaos_lay_out(nevh__arena *a, void *chaos) {
    nevh_chaos *c = chaos;
    size_t lanes = c->starts * (2 * nevh__chaos_vectors(c) + 1);
    size_t rows = 2 * c->n * nevh__padded(lanes);
    c->own = nevh__arena_take(a, 4 * c->n, sizeof *c->own);
    c->q = nevh__arena_take(a, rows, sizeof *c->q);
    c->p = nevh__arena_take(a, rows, sizeof *c->p);
    c->slope = nevh__arena_take(a, 2 * c->n, sizeof *c->slope);
    c->marked = nevh__arena_take(a, 6 * c->n, sizeof *c->marked);
    c->place =
        nevh__arena_take(a, 2 * c->n * (c->deviations + 1), sizeof *c->place);
    for (size_t i = 0; i < c->starts; i++)
        lay_out_start(a, c, &c->start[i]);
}

static int chaos_plan_memory(nevh_chaos *c) {
    c->start = nevh__array(c->starts, sizeof *c->start);
    c->memory = c->start ? nevh__arena_new(chaos_lay_out, c) : NULL;
    return c->memory ? NEVH_OK : nevh__no_memory(&c->report);
}

static int chaos_plan(nevh_chaos *c, const nevh_chaos_options *o) {
    size_t n = c->n;
    int status = chaos_check(c, o);
    if (!status)
        status = chaos_plan_memory(c);
    if (status)
        return status;
    c->options = *o->options;
    c->options.width = 1;
    memcpy(c->own, c->options.q, n * sizeof *c->own);
    memcpy(c->own + n, c->options.p, n * sizeof *c->own);
    c->options.q = c->own;
    c->options.p = c->own + n;
    status = chaos_plan_field(c);
    if (!status)
        status = plan_lengths(c, o->integrator);
    if (!status)
        status = check_scheme(c, o->integrator);
    if (!status)
        status = plan_period(c);
    if (!status)
        status = plan_walk(c, o->integrator, o->differences);
    return status ? status : nevh__chaos_begin(c);
}

static nevh_chaos *chaos_make(const nevh_system *system,
                              const nevh_chaos_options *o, bool of_members) {
    nevh_chaos *c = system && o ? nevh__array(1, sizeof *c) : NULL;
    if (!c)
        return NULL;
    c->system = system;
    c->of_members = of_members;
    c->searches = !of_members && nevh__theory_doubts(system);
    c->integrator = o->integrator;
    c->n = system->n;
    c->starts = o->starts ? o->starts : STARTS;
    c->exponents = o->exponents ? o->exponents : 1;
    c->deviations = o->deviations ? o->deviations : 2;
    c->frame = c->exponents > 1 ? c->exponents : 0;
    c->t_start = o->t_start;
    c->dt = fabs(o->dt);
    c->way = o->dt < 0 ? -1 : 1;
    c->seed = o->seed;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = nevh_system_status(system);
    if (status)
        nevh__fail_as(&c->report, &system->report);
    else
        status = chaos_plan(c, o);
    fesetenv(&own);
    c->planned = !status;
    return c;
}

nevh_chaos *nevh_chaos_new(const nevh_system *system,
                           const nevh_chaos_options *o) {
    return chaos_make(system, o, false);
}

nevh_chaos *nevh__chaos_of_members(const nevh_system *system,
                                   const nevh_chaos_options *o) {
    return chaos_make(system, o, true);
}

void nevh_chaos_free(nevh_chaos *c) {
    if (!c)
        return;
    nevh__chaos_batch_free(c->batch);
    nevh_stepper_free(c->stepper);
    nevh__variational_free(c->variational);
    nevh_field_free(c->field);
    free(c->start);
    free(c->memory);
    free(c);
}

int nevh_chaos_restart(nevh_chaos *c, const double q[], const double p[],
                       uint64_t seed) {
    if (!c || !q || !p)
        return NEVH_EINVAL;
    if (!c->planned)
        return c->report.status;
    memcpy(c->own, q, c->n * sizeof *q);
    memcpy(c->own + c->n, p, c->n * sizeof *p);
    c->seed = seed;
    c->report = (nevh__report){0};
    return nevh__chaos_begin(c);
}

NEVH__REPORTS(chaos)

nevh_counts nevh_chaos_counts(const nevh_chaos *c) {
    return nevh_stepper_counts(c ? c->stepper : NULL);
}

bool nevh_chaos_is_tangent(const nevh_chaos *c, const char **why) {
    if (why)
        *why = c ? c->why : "";
    return c && c->tangent;
}
