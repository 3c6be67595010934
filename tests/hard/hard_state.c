/* nevh tests: hard cases: whether a run is where it should be, not only its energy.

   Theory: the errors of all steps, of (h omega)^(order + 1) each, are carried
   along by the linearised flow and add up ["Lady Windermere's fan": E. Hairer,
   S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993),
   II.3].  Where the scheme has a Hamiltonian of its own, near H by
   (h omega)^order, or is reversible as the orbit is, they do not: it is the
   difference of a neighbouring orbit, which the flow carries along once, and of
   its frequencies [E. Hairer, C. Lubich, G. Wanner, Geometric Numerical
   Integration, X.3 and XI.3].  The flow is linearised at the orbit itself, and
   omega taken along it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard_judge.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 200, LOOKS = 100 };
/* Taylor's remainder at order 1, x^2/2 in a step; less at higher orders. */
static const double constant = 0.5;
static const double most_steps = 1e4;
/* Radians over which growth is found in seconds. */
static const double most_angle = 1e6;
static const double displaced = 1e-9; /* of the range of a variable */
/* What planning says of differences is an estimate. */
static const double doubt = 10;
/* Substeps that a tolerance may ask for, in a step or a turn. */
static const double substeps = 10;

/* An orbit as it should be, followed for some time. */
struct hard_orbit {
    nevh_reference *reference;
    const nevh_system *system;
    nevh_scene *scene; /* of systems that have no derivatives of their own */
    size_t n, count;
    double t_end, *t, *pace, *growth; /* growth: the largest so far */
    bool followed;                    /* growth is found */
    double *range;                    /* 2n */
};

static double distance(const hard_orbit *k, const double state[],
                       const double q[], const double p[]) {
    double most = 0;
    for (size_t i = 0; i < k->n; i++) {
        double dp = p[i] - state[k->n + i];
        most = fmax(most, fabs(q[i] - state[i]) / k->range[i]);
        most = fmax(most, fabs(dp) / k->range[k->n + i]);
    }
    return most;
}

/* Far from 0 the rounding of coordinates is noise in their slopes, of which steps that
   are asked for less become as short as can be. */
static nevh_stepper *fine(const hard_orbit *k, const hard_subject *s) {
    nevh_options o = {.gradient = nevh_exact, .q = s->q, .p = s->p, .t = s->t};
    o.tolerance = 1e-13;
    for (size_t i = 0; i < k->n; i++)
        if (k->range[i] > 0)
            o.tolerance = fmax(o.tolerance,
                               DBL_EPSILON / 10 * fabs(s->q[i]) / k->range[i]);
    return nevh_stepper_new(k->system, nevh_dop853, &o);
}

typedef struct {
    hard_orbit *orbit;
    double *state, *growth; /* growth: a sum over displacements */
} spread;

static int look(void *data, size_t step, double t, const double q[],
                const double p[]) {
    spread *d = data;
    const hard_orbit *k = d->orbit;
    if (nevh_reference_state(k->reference, t, d->state, d->state + k->n))
        return NEVH_OK;
    double most = distance(k, d->state, q, p);
    if (step < k->count)
        d->growth[step] += most / displaced;
    return NEVH_OK;
}

/* Of an orbit displaced in one variable. */
static int follow(spread *d, const hard_subject *s, nevh_stepper *m,
                  size_t variable) {
    hard_orbit *k = d->orbit;
    double *q = tool_allocate(2 * k->n, sizeof *q), *p = q + k->n;
    memcpy(q, s->q, k->n * sizeof *q);
    memcpy(p, s->p, k->n * sizeof *p);
    q[variable] += displaced * k->range[variable];
    nevh_stepper_reset(m);
    int status = nevh_run(m, s->t, (k->t_end - s->t) / SAMPLES, SAMPLES, q, p,
                          &(nevh_observer){look, d, 1}, 1);
    tool_release(q);
    return status;
}

static void find_growth(hard_orbit *k, const hard_subject *s) {
    spread d = {k, tool_allocate(2 * k->n, sizeof(double)),
                tool_allocate(k->count, sizeof(double))};
    nevh_stepper *m = fine(k, s);
    double angle = s->pace * (k->t_end - s->t);
    bool lost = nevh_stepper_status(m) || angle > most_angle;
    for (size_t i = 0; !lost && i < 2 * k->n; i++)
        lost = follow(&d, s, m, i);
    for (size_t i = 0; i < k->count; i++)
        k->growth[i] =
            lost ? INFINITY : fmax(d.growth[i], i ? k->growth[i - 1] : 1);
    nevh_stepper_free(m);
    tool_release(d.state);
    tool_release(d.growth);
}

void hard_orbit_follow(const hard_subject *s, const nevh_integrator *scheme) {
    hard_orbit *k = s->orbit;
    bool returns = s->known.facts & HARD_RETURN;
    if (!k || k->followed ||
        (s->dt * k->pace[0] > 1 && !returns &&
         !nevh_integrator_adaptive(scheme)))
        return;
    find_growth(k, s);
    k->followed = true;
}

/* Of what H does by itself: gradients at the start, at the times of the track.
   A sine of amplitude a, a range of 2 a, has slopes of up to a omega. */
static double find_drive(const hard_orbit *k, const hard_subject *s) {
    nevh_options o = {.gradient = nevh_exact, .q = s->q, .p = s->p, .t = s->t};
    nevh_field *f = nevh_field_new(k->system, &o);
    double *g = tool_allocate(5 * k->n, sizeof *g), drive = 0;
    double *low = g + 2 * k->n, *high = low + k->n, *steepest = high + k->n;
    double dt = 1e-3 * s->dt;
    for (size_t i = 0; i < k->count; i++) {
        double t[] = {k->t[i], k->t[i] + dt};
        for (int m = 0; m < 2; m++)
            nevh_field_gradient(f, 1, &t[m], s->q, s->p, g + (size_t)m * k->n,
                                NULL);
        for (size_t j = 0; j < k->n; j++) {
            low[j] = i ? fmin(low[j], g[j]) : g[j];
            high[j] = i ? fmax(high[j], g[j]) : g[j];
            steepest[j] = fmax(steepest[j], fabs(g[k->n + j] - g[j]) / dt);
        }
    }
    for (size_t j = 0; j < k->n; j++)
        if (high[j] > low[j])
            drive = fmax(drive, 2 * steepest[j] / (high[j] - low[j]));
    nevh_field_free(f);
    tool_release(g);
    return drive;
}

/* Of what the orbit meets: derivatives along it come from its own turning, from
   time and from friction, whose rates add up. */
static double find_outside(const hard_orbit *k, const hard_subject *s) {
    double *rates = tool_allocate(k->n, sizeof *rates), most = 0;
    nevh_system_friction(k->system, rates);
    for (size_t i = 0; i < k->n; i++)
        most = fmax(most, rates[i]);
    tool_release(rates);
    bool driven = !(nevh_system_traits(k->system) & NEVH_AUTONOMOUS);
    return most + (driven ? find_drive(k, s) : 0);
}

static void find_pace(hard_orbit *k, const hard_subject *s) {
    double *at = tool_allocate(2 * k->n, sizeof *at), growth;
    double outside = find_outside(k, s);
    nevh_options o = {.t = s->t, .q = s->q, .p = s->p};
    nevh_rates *rates = nevh_rates_new(k->system, &o);
    for (size_t i = 0; i < k->count; i++) {
        k->pace[i] = INFINITY;
        if (nevh_reference_state(k->reference, k->t[i], at, at + k->n) ||
            nevh_rates_at(rates, k->t[i], at, at + k->n, &k->pace[i], &growth))
            continue;
        k->pace[i] = fmax(k->pace[i], growth) + outside;
    }
    nevh_rates_free(rates);
    tool_release(at);
}

/* The orbits of H given as values alone are those of the same H in formulas. */
static void choose_system(hard_orbit *k, const hard_subject *s) {
    k->system = s->system;
    k->n = s->n;
    if (!s->own)
        return;
    k->scene = hard_scene("hard/pendulum-modulus");
    k->system = nevh_scene_system(k->scene);
}

hard_orbit *hard_orbit_new(const hard_subject *s) {
    double span = fmin(s->t_end - s->t, most_steps * s->dt);
    if (span > 1e200 || s->known.facts & HARD_KINK)
        return NULL;
    hard_orbit *k = tool_allocate(1, sizeof *k);
    choose_system(k, s);
    k->t_end = s->t + span;
    k->reference =
        nevh_reference_new(k->system, NULL, s->t, k->t_end, s->q, s->p);
    k->count = SAMPLES + 1;
    k->range = tool_allocate(2 * k->n, sizeof *k->range);
    for (size_t i = 0; i < 2 * k->n; i++)
        k->range[i] = s->known.facts & HARD_REST
                          ? 1
                          : nevh_reference_range(k->reference, i);
    k->t = tool_allocate(3 * k->count, sizeof *k->t);
    k->pace = k->t + k->count;
    k->growth = k->pace + k->count;
    for (size_t i = 0; i < k->count; i++) {
        k->t[i] = i < SAMPLES ? s->t + span * (double)i / SAMPLES : k->t_end;
        k->growth[i] = INFINITY;
    }
    if (nevh_reference_status(k->reference)) {
        hard_orbit_free(k);
        return NULL;
    }
    find_pace(k, s);
    return k;
}

void hard_orbit_free(hard_orbit *k) {
    if (!k)
        return;
    nevh_reference_free(k->reference);
    nevh_scene_free(k->scene);
    tool_release(k->range);
    tool_release(k->t);
    tool_release(k);
}

struct hard_state {
    const hard_orbit *orbit;
    size_t every;
    double *bound, *state;
    double error, allowed, t, share; /* where share = error/allowed is most */
};

/* Tao's copies are bound by omega = 3 times the largest frequency w of a run,
   and turn by 2 omega [M. Tao, Phys. Rev. E 94 (2016) 043303]: remainders
   (7 h w)^(r+1)/(r+1)! instead of (h w)^(r+1). */
double hard_haste(const hard_result *r) {
    bool bound = nevh_integrator_symplectic(r->scheme) == NEVH_EXTENDED &&
                 !nevh_integrator_own_time(r->scheme);
    int order = nevh_integrator_order(r->scheme);
    return bound ? pow(7, order) / tgamma(order + 2) : 1;
}

/* Of fixed steps. */
static void allow_steps(hard_state *w, const hard_subject *s,
                        const hard_result *r) {
    const hard_orbit *k = w->orbit;
    double turns = 0, most = 0, order = r->order, haste = hard_haste(r);
    for (size_t i = 0; i < k->count; i++) {
        double rate = fmax(k->pace[i], k->pace[i ? i - 1 : 0]);
        double time = i ? k->t[i] - k->t[i - 1] : 0;
        if (haste > 1)
            rate = fmax(rate, s->pace);
        most = fmax(most, s->dt * rate);
        turns += pow(s->dt * rate, order) * rate * time / (2 * M_PI);
        double once = pow(most, order);
        double error = hard_keeps(r) ? turns + once * k->growth[i]
                                     : (turns + once) * k->growth[i];
        w->bound[i] = constant * haste * error;
        if (most > 1)
            w->bound[i] = INFINITY;
    }
}

/* Tolerances are relative to coordinates and momenta, not to their ranges. */
static void allow_tolerance(hard_state *w, const hard_subject *s,
                            double tolerance) {
    const hard_orbit *k = w->orbit;
    double size = 1;
    for (size_t i = 0; i < k->n; i++) {
        size = fmax(size, 1 + fabs(s->q[i]) / k->range[i]);
        size = fmax(size, 1 + fabs(s->p[i]) / k->range[k->n + i]);
    }
    for (size_t i = 0; i < k->count; i++) {
        double time = k->t[i] - s->t;
        w->bound[i] = tolerance * size * k->growth[i] * substeps *
                      (1 + time * fmax(1 / s->dt, s->pace));
    }
}

/* What differences error, per unit of time: of dH/dq in p, of dH/dp in q. */
static double find_gradient_error(const hard_orbit *k, nevh_field *f) {
    double *error = tool_allocate(2 * k->n, sizeof *error), most = 0;
    for (size_t i = 0; i < nevh_field_step_count(f); i++) {
        nevh_step_report step = nevh_field_step_report(f, i);
        size_t moved = step.index + (step.momentum ? 0 : k->n);
        if (!step.given)
            error[moved] += step.truncation + step.rounding;
    }
    for (size_t i = 0; i < 2 * k->n; i++)
        most = fmax(most, error[i] / k->range[i]);
    tool_release(error);
    return doubt * most;
}

/* What does not come from the steps' length.  Increments have a rounding of
   some epsilon of the state each, the solution of stages of 1e-14. */
static void allow_rest(hard_state *w, const hard_subject *s,
                       const hard_result *r, nevh_field *f) {
    const hard_orbit *k = w->orbit;
    double error = find_gradient_error(k, f);
    for (size_t i = 0; i < k->count; i++) {
        double time = k->t[i] - s->t;
        double rest = r->state_floor + error * time + 1e-14 * time / s->dt;
        w->bound[i] +=
            rest * k->growth[i] + 10 * nevh_reference_error(k->reference);
        if (w->bound[i] > 0.5) /* half of the orbit's size: no longer linear */
            w->bound[i] = INFINITY;
    }
}

/* Increments of the state take the place of a gradient's steps, and go down to
   0, where noise in H is divided by them. */
static bool divides_noise(const hard_subject *s, const hard_result *r) {
    return s->known.facts & HARD_NOISE &&
           nevh_integrator_preserves_energy(r->scheme) == NEVH_YES &&
           nevh_integrator_sweep_gradients(r->scheme) == 0;
}

hard_state *hard_state_new(const hard_subject *s, const hard_result *r,
                           nevh_field *f, double tolerance) {
    if (!s->orbit || divides_noise(s, r))
        return NULL;
    hard_state *w = tool_allocate(1, sizeof *w);
    w->orbit = s->orbit;
    double steps = (s->orbit->t_end - s->t) / s->dt;
    w->every = (size_t)fmax(1, steps / LOOKS);
    w->bound = tool_allocate(s->orbit->count, sizeof *w->bound);
    w->state = tool_allocate(2 * s->n, sizeof *w->state);
    w->error = w->allowed = w->t = NAN;
    w->share = -1;
    if (nevh_integrator_adaptive(r->scheme))
        allow_tolerance(w, s, tolerance);
    else
        allow_steps(w, s, r);
    allow_rest(w, s, r, f);
    return w;
}

double hard_orbit_growth(const hard_orbit *k) {
    return k ? k->growth[k->count - 1] : NAN;
}

size_t hard_state_every(const hard_state *w) {
    return w ? w->every : 0;
}

int hard_state_observe(void *state, size_t step, double t, const double q[],
                       const double p[]) {
    hard_state *w = state;
    const hard_orbit *k = w->orbit;
    double start = k->t[0], span = k->t_end - start;
    if (step == 0 || t > k->t_end ||
        nevh_reference_state(k->reference, t, w->state, w->state + k->n))
        return NEVH_OK;
    double allowed =
        w->bound[(size_t)ceil((t - start) / span * SAMPLES * (1 - 1e-12))];
    double error = distance(k, w->state, q, p);
    if (isfinite(allowed) && error / allowed > w->share)
        w->error = error, w->allowed = allowed, w->t = t,
        w->share = error / allowed;
    return NEVH_OK;
}

void hard_state_take(hard_state *w, hard_result *r) {
    r->state_error = w ? w->error : NAN;
    r->state_bound = w ? w->allowed : NAN;
    r->state_at = w ? w->t : NAN;
    if (!w)
        return;
    tool_release(w->bound);
    tool_release(w->state);
    tool_release(w);
}
