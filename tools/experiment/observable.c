/* nevh: errors of an observable that the user names, against the reference.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <float.h>
#include <nevh/sweep.h>
#include <math.h>

/* As state errors are: so many times, not on one phase of every period. */
enum { TIMES = 1024 };
static const double golden = 0.6180339887498949;
static const double hardly = 1e-6; /* of its size: no range to speak of */

/* The i-th time, from 0 to 1. */
static double wanted(size_t i) {
    double turn = (double)i * golden;
    return i >= TIMES ? 1 : ((double)i + turn - floor(turn)) / TIMES;
}

static double value_at(const plan *p, double t, const double state[]) {
    double value;
    return nevh_scene_judged_value(p->scene, t, state, state + p->n, &value)
               ? NAN
               : value;
}

/* The effect of the reference's own error on the observable, variable by variable. */
static double own_error(const plan *p, double t, double state[]) {
    double value = value_at(p, t, state), sum = 0;
    double part = nevh_reference_error(p->reference);
    for (size_t k = 0; k < 2 * p->n; k++) {
        double kept = state[k];
        state[k] += part * nevh_reference_range(p->reference, k);
        sum += fabs(value_at(p, t, state) - value);
        state[k] = kept;
    }
    return sum;
}

static int no_value(const plan *p, double t) {
    tool_refuse("%s: --observable %s has no value at t = %.6g", p->name,
                p->observable, t);
    return TOOL_FAILED;
}

/* The outcome of a run; NAN: it has none.
   message  the scene's, where it fails */
static double outcome_of(const plan *p, const char *integrator,
                         const char *gradient, double dt, double tolerance) {
    double value = NAN;
    nevh_sweep_options is = {.gradient = nevh_gradient_named(gradient),
                             .gradient_step = p->gradient_step,
                             .dt = dt,
                             .t_end = p->t_end,
                             .tolerance = tolerance,
                             .portable = p->portable,
                             .native = NEVH_NATIVE_NEVER};
    is.integrator = plan_scheme(p, integrator, &is.transformed);
    is.transformed = plan_transform(p, integrator) != NULL;
    is.substeps = nevh_substeps_named(integrator);
    return nevh_scene_own_outcomes(p->scene, &is, &value, 1) ? NAN : value;
}

void outcome_compare(const plan *p, row *r) {
    if (!p->outcome || !r->ran)
        return;
    double value =
        outcome_of(p, r->integrator, r->gradient, r->step, r->tolerance);
    double error = fabs(value - p->outcome_value) / p->observable_scale;
    r->observable_error = isfinite(error) ? error : INFINITY;
}

/* Halves steps of a scheme of order 16 until halves differ no more. */
static int take_outcome(plan *p) {
    enum { HALVINGS = 12, WORSE = 2 };
    static const double fine = 1e-13, fair = 1e-6, most_steps = 3e5;
    int worse = 0; /* halves that are no nearer: rounding, or chaos */
    double h = plan_longest_dt(p), before = NAN, value = NAN;
    double least = INFINITY;
    const char *gradient = "exact";
    for (int i = 0; i < HALVINGS && worse < WORSE && !(least <= fine) &&
                    plan_steps(p, h) < most_steps;
         i++, h /= 2) {
        value = outcome_of(p, "gauss16", gradient, h, 0);
        if (isnan(value)) /* of terms without derivatives */
            value =
                outcome_of(p, "gauss16", gradient = p->gradients.item[0], h, 0);
        double apart = fabs(value - before) / fmax(fabs(value), DBL_MIN);
        before = value;
        worse = i < 2 || apart < least ? 0 : worse + 1;
        if (!(apart < least))
            continue;
        least = apart;
        p->outcome_value = value;
    }
    const char *why = nevh_scene_message(p->scene);
    if (!(least < fair)) {
        tool_refuse(
            "%s: --observable %s has no certain value until t = %.6g: %s",
            p->name, p->observable, p->t_end,
            *why           ? why
            : isnan(value) ? "what it waits for does not happen"
                           : "it depends on the step");
        return TOOL_FAILED;
    }
    p->observable_level = true;
    p->observable_error = fmax(least, DBL_EPSILON);
    p->observable_scale = fmax(fabs(p->outcome_value), DBL_MIN);
    return TOOL_OK;
}

int plan_observe(plan *p, const char *formula) {
    if (!p->reference) {
        tool_refuse("%s: no errors of --observable: %s", p->name,
                    p->no_reference);
        return TOOL_FAILED;
    }
    double low = INFINITY, high = -INFINITY, start = p->run->t_start;
    double none = NAN;
    p->observable = formula;
    p->observable_error = 0;
    p->outcome =
        outcome_named(formula) && nevh_scene_set_judged(p->scene, formula);
    if (p->outcome)
        return take_outcome(p);
    double *state = tool_allocate(2 * p->n, sizeof *state);
    for (size_t i = 0; i <= TIMES; i++) {
        double t = start + wanted(i) * (p->t_end - start);
        if (nevh_reference_state(p->reference, t, state, state + p->n))
            continue;
        double value = value_at(p, t, state);
        none = isfinite(value) || isfinite(none) ? none : t;
        low = fmin(low, value), high = fmax(high, value);
        if (i % 32 == 0)
            p->observable_error =
                fmax(p->observable_error, own_error(p, t, state));
    }
    double size = fmax(fabs(low), fabs(high));
    if (isfinite(none) || !isfinite(size))
        return no_value(p, none);
    p->observable_level = high - low <= hardly * size;
    p->observable_scale = p->observable_level ? size : high - low;
    if (p->observable_scale == 0)
        p->observable_scale = 1;
    p->observable_error /= p->observable_scale;
    return TOOL_OK;
}

void observable_notes(const plan *p, list *notes) {
    if (!p->observable)
        return;
    const char *unit = nevh_scene_label(p->scene, p->observable);
    if (p->outcome)
        list_print(notes,
                   "observable: %s, %.12g of gauss16, to %.0e; its errors are "
                   "divided by that",
                   p->observable, p->outcome_value, p->observable_error);
    else
        list_print(
            notes,
            "observable: %s; its errors are divided by its %s, %.6g%s%s%s",
            p->observable, p->observable_level ? "size" : "range",
            p->observable_scale, *unit ? " " : "", unit,
            p->observable_level ? " (it hardly changes)" : "");
}

void observable_show(table *t, const plan *p, const row *r) {
    if (r->ran && isfinite(r->observable_error))
        table_shown(t, "%.1e", r->observable_error);
    else
        state_show(t, p, r);
}

void observable_compare(observable *o, double t, const double q[],
                        const double p[], const double reference[]) {
    double value;
    if (o->plan->outcome)
        return;
    if (nevh_scene_judged_value(o->plan->scene, t, q, p, &value))
        value = NAN;
    double error = fabs(value - value_at(o->plan, t, reference)) /
                   o->plan->observable_scale;
    o->worst = fmax(o->worst, isfinite(error) ? error : INFINITY);
}
