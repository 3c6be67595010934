/* nevh: why a run became unstable, and what to do.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "trial_run.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 64 };
static const double unstable_above = 1; /* as nevh_energy_report says */
/* Parts of a turn, in a step, at which a nonlinear H throws an orbit out: of
   three and of four steps. */
static const double near_by = 0.06;

int largest_rates_observe(void *data, size_t step, double t, const double q[],
                          const double p[]) {
    largest_rates *fastest = data;
    double frequency, growth;
    (void)step;
    if (nevh_rates_at(fastest->rates, t, q, p, &frequency, &growth))
        return NEVH_OK;
    double rate = fmax(frequency, growth); /* of whatever kind */
    if (rate > fastest->rate)
        fastest->rate = rate, fastest->rate_at = t;
    if (frequency > fastest->frequency)
        fastest->frequency = frequency, fastest->frequency_at = t;
    return NEVH_OK;
}

int energy_limit_observe(void *data, size_t step, double t, const double q[],
                         const double p[]) {
    energy_limit *e = data;
    int status = nevh_energy_observe(e->energy, step, t, q, p);
    e->t = t;
    e->step = step;
    e->passed = !(fabs(nevh_energy_error(e->energy, 0)) <= e->limit);
    return status || !e->passed ? status : NEVH_STOPPED;
}

/* The turn of a step on an oscillator: the angle by which steps of h omega = x
   turn the phase. */
static const char *resonance(const nevh_integrator *scheme, double x) {
    double angle = nevh_stability_angle(scheme, x);
    if (fabs(angle - 2 * M_PI / 3) < near_by)
        return "three";
    return fabs(angle - M_PI / 2) < near_by ? "four" : NULL;
}

/* Limits of schemes of an extended phase space are known to 1/32. */
bool stability_exceeded(const nevh_integrator *scheme, double limit, double x) {
    bool extended = nevh_integrator_symplectic(scheme) == NEVH_EXTENDED;
    return x > (extended ? limit - 1. / 32 : limit);
}

/* True if the losses of so many steps, each below x^(order + 1), may add up to a part of
   the energy; what is lost in a few steps of a close encounter is another thing. */
static bool losses_add_up(const nevh_integrator *scheme, double x,
                          double steps) {
    static const double part = 0.01;
    return nevh_integrator_symplectic(scheme) == NEVH_NO &&
           steps * pow(x, nevh_integrator_order(scheme) + 1) > part;
}

static char *cause_at(const nevh_integrator *scheme, double limit, double x,
                      double steps, const char *where) {
    const char *name = nevh_integrator_name(scheme);
    if (limit > 0 && stability_exceeded(scheme, limit, x))
        return text_print("%s: %s is stable up to %.3g", where, name, limit);
    if (x > 1)
        return text_print("%s: a turn has %.2g steps", where, 2 * M_PI / x);
    return losses_add_up(scheme, x, steps)
               ? text_print("each step changes the energy a little, in one "
                            "direction; with omega dt = %.3g that is soon "
                            "large",
                            x)
               : NULL;
}

char *stability_cause(const nevh_integrator *scheme, double limit, double dt,
                      double span, const largest_rates *fastest) {
    double w = fastest->frequency, x = fabs(dt) * w;
    const char *turn = resonance(scheme, x);
    if (!(x > 0) || !isfinite(x))
        return NULL;
    char *where =
        text_print("omega dt = %.3g near t = %.4g, where the orbit is "
                   "fastest (omega = %.3g)",
                   x, fastest->frequency_at, w);
    char *text = cause_at(scheme, limit, x, span / fabs(dt), where);
    if (turn && (x <= limit))
        text_extend(&text, "%s%s%s steps make a turn: a resonance",
                    text ? "" : where, text ? "; " : ": ", turn);
    return text;
}

/* More often at the start, since a run may end soon. */
typedef struct {
    largest_rates *fastest;
    size_t next;
} start;

static int observe_early(void *data, size_t step, double t, const double q[],
                         const double p[]) {
    start *s = data;
    if (step < s->next)
        return NEVH_OK;
    s->next = step + step / 4 + 1;
    return largest_rates_observe(s->fastest, step, t, q, p);
}

largest_rates stability_rates(const nevh_system *system,
                              const nevh_integrator *scheme,
                              const nevh_options *o, double scale, double dt,
                              double t_end) {
    size_t n = nevh_system_dof(system);
    nevh_stepper *s = nevh_stepper_new(system, scheme, o);
    double *q = tool_allocate(n, sizeof *q), *p = tool_allocate(n, sizeof *p);
    nevh_options own = *o;
    own.gradient = NULL;
    own.gradient_step = 0;
    energy_limit e = {nevh_energy_new(system, o), .limit = unstable_above};
    largest_rates fastest = {.rates = nevh_rates_new(system, &own)};
    start early = {&fastest, 1};
    size_t every = (size_t)fmin(1e9, fabs((t_end - o->t) / dt) / SAMPLES);
    if (o->balance)
        nevh_energy_follow(e.energy, s);
    if (scale > 0)
        nevh_energy_set_scale(e.energy, scale);
    for (size_t k = 0; k < n; k++)
        q[k] = o->q[k], p[k] = o->p[k];
    nevh_run_until(s, o->t, dt, t_end, q, p,
                   (nevh_observer[]){{largest_rates_observe, &fastest, every},
                                     {observe_early, &early, 1},
                                     {energy_limit_observe, &e, 1}},
                   3);
    nevh_rates_free(fastest.rates);
    nevh_energy_free(e.energy);
    nevh_stepper_free(s);
    tool_release(q);
    tool_release(p);
    return fastest;
}

/* True if it is the first unstable row of its integrator and dt. */
static bool is_first(const row rows[], size_t i) {
    for (size_t k = 0; k < i; k++)
        if (rows[k].scheme == rows[i].scheme && rows[k].dt == rows[i].dt &&
            rows[k].ran && rows[k].energy.verdict == NEVH_UNSTABLE)
            return false;
    return true;
}

static char *cause_of(const plan *p, const row *r) {
    nevh_options o = plan_options(p, r->gradient);
    o.transform = plan_transform(p, r->integrator);
    o.tolerance = r->tolerance;
    o.balance = p->balance;
    largest_rates fastest = stability_rates(p->system, r->scheme, &o,
                                            r->energy.scale, r->dt, p->t_end);
    double limit = nevh_stability_limit(r->scheme);
    double x = fabs(r->dt) * fastest.frequency;
    char *cause = stability_cause(r->scheme, limit, r->dt,
                                  p->t_end - p->run->t_start, &fastest);
    if (cause && p->friction && x <= 1 &&
        !stability_exceeded(r->scheme, limit, x))
        text_extend(&cause, ", or dt is too long for a rate of friction");
    return cause;
}

/* All rows from there on that the same is to be said of; their causes go. */
static void cause_words(const row rows[], size_t count, char *causes[],
                        size_t first, list *words) {
    list names = {0};
    char *cause = causes[first];
    for (size_t i = first; i < count; i++) {
        if (!causes[i] || rows[i].dt != rows[first].dt ||
            strcmp(causes[i], cause) != 0)
            continue;
        list_add(&names, rows[i].integrator);
        causes[i] = NULL;
    }
    list_print(words, "%s at dt = %.4g: %s.", list_joined(&names),
               rows[first].dt, cause);
}

void stability_words(const plan *p, const row rows[], size_t count,
                     list *words) {
    char **causes = tool_allocate(count, sizeof *causes);
    for (size_t i = 0; i < count; i++)
        if (rows[i].ran && rows[i].energy.verdict == NEVH_UNSTABLE &&
            rows[i].tolerance == 0 && is_first(rows, i))
            causes[i] = cause_of(p, &rows[i]);
    for (size_t i = 0; i < count; i++)
        if (causes[i])
            cause_words(rows, count, causes, i, words);
}
