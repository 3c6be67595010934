/* nevh: state errors: the reference of a plan, and how they are shown.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include "trial_run.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double a_few = 4; /* steps of rows, to one of the reference */

/* Why there is no reference, or NULL. */
static char *refusal(const plan *p, const char *name) {
    const char *text = nevh_reference_text(p->reference);
    if (tool_status(nevh_reference_status(p->reference)))
        return text_print("%s", nevh_reference_message(p->reference));
    if (name && strcmp(name, "exact") == 0 && strncmp(text, "exact", 5) != 0)
        return text_print("no exact solution of this H is known");
    return NULL;
}

static bool has_arrays(const plan *p) {
    bool any = false;
    for (size_t k = 0; k < p->n; k++)
        any |= nevh_scene_array(p->scene, k) != k;
    return any;
}

/* Elements of an array are of one kind. */
static nevh_reference *
make_reference(const plan *p, const nevh_integrator *scheme, double end) {
    size_t *kind = tool_allocate(p->n, sizeof *kind);
    for (size_t k = 0; k < p->n; k++)
        kind[k] = nevh_scene_array(p->scene, k);
    nevh_reference_options o = {.integrator = scheme,
                                .kind = kind,
                                .longest = a_few * plan_shortest_dt(p),
                                .finest = !p->run->reference};
    nevh_reference *made =
        nevh_reference_with(p->system, &o, p->run->t_start, end, p->q, p->p);
    return tool_owned(made);
}

int plan_reference(plan *p, double end) {
    const char *name = p->run->reference;
    const nevh_integrator *scheme = NULL;
    bool transformed = false;
    if (p->reference || p->no_reference)
        return TOOL_OK;
    if (name && strcmp(name, "exact") != 0)
        scheme = plan_scheme(p, name, &transformed);
    if (transformed)
        return tool_refuse("reference = %s: its steps must have the same "
                           "length; take it without +transform",
                           name);
    p->reference_end = end;
    p->reference = make_reference(p, scheme, end);
    p->no_reference = refusal(p, name);
    p->ends = nevh_reference_ends(p->reference);
    if (!p->no_reference)
        return TOOL_OK;
    nevh_reference_free(p->reference);
    p->reference = NULL;
    return TOOL_OK;
}

void plan_forget_reference(plan *p) {
    nevh_reference_free(p->reference);
    p->reference = NULL;
    p->no_reference = NULL;
}

/* True if the run goes on after the horizon of the reference. */
static bool is_beyond(const plan *p) {
    return p->reference &&
           p->reference_end > nevh_reference_horizon(p->reference);
}

static bool is_chaos(const plan *p) {
    return is_beyond(p) &&
           nevh_reference_why(p->reference) == NEVH_REFERENCE_CHAOS;
}

static void note_horizon(const plan *p, list *notes) {
    const nevh_reference *r = p->reference;
    const char *text = nevh_reference_text(r);
    double horizon = nevh_reference_horizon(r);
    if (is_chaos(p))
        list_print(
            notes,
            "predictability horizon t = %.4g: the motion is chaotic, and "
            "neighbours separate e-fold every %.3g.  State errors are given until "
            "then; after that no orbit can be computed (%s)",
            horizon, 1 / nevh_reference_exponent(r), text);
    else if (nevh_reference_why(r) == NEVH_REFERENCE_SENSITIVE)
        list_print(
            notes,
            "predictability horizon t = %.4g, no state errors after it: "
            "error growth: differences in the last digits have grown by %.0e, as at a "
            "saddle of H or in close encounters (%s)",
            horizon, nevh_reference_growth(r), text);
    else
        list_print(
            notes,
            "no state errors after t = %.4g: shorter steps of the "
            "reference do not reduce its error below 1e-3 there, or cost "
            "too much (%s)",
            horizon, text);
}

void state_notes(const plan *p, list *notes) {
    const char *text = nevh_reference_text(p->reference);
    bool is_exact = strncmp(text, "exact", 5) == 0;
    double error = nevh_reference_error(p->reference);
    char own[40] = "";
    if (error > 1e-15)
        snprintf(own, sizeof own, ", own error %.0e", error);
    if (p->no_reference)
        list_print(notes, "no state errors: %s", p->no_reference);
    else if (is_beyond(p))
        note_horizon(p, notes);
    else if (p->reference)
        list_print(notes,
                   "state error: largest difference from %s%s%s, divided by "
                   "the range of that variable%s",
                   is_exact ? "the " : "", text, is_exact ? own : "",
                   has_arrays(p) ? "; elements of an array share the widest"
                                 : "");
    if (!is_exact && strncmp(text, "taylor", 6) != 0)
        smoothness_notes(p, notes);
}

bool state_out_of_step(const row *r) {
    return r->ran && r->state_error > STATE_OUT_OF_STEP;
}

void state_show(table *t, const plan *p, const row *r) {
    if (!p->reference || !r->ran)
        table_text(t, NULL);
    else if (state_out_of_step(r))
        table_shown(t, "> 50 %%");
    else if (is_chaos(p))
        table_shown(t, "chaos");
    else if (is_beyond(p))
        table_shown(t, "unknown");
    else if (isnan(r->state_error))
        table_text(t, NULL);
    else
        table_shown(t, "%.0e", r->state_error);
}

static bool any_out_of_step(const row rows[], size_t count) {
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any = any || state_out_of_step(&rows[i]);
    return any;
}

static list names_out_of_step(const row rows[], size_t count) {
    list names = {0};
    for (size_t i = 0; i < count; i++)
        if (state_out_of_step(&rows[i]) &&
            rows[i].energy.verdict == NEVH_BOUNDED &&
            !list_has(&names, rows[i].integrator))
            list_add(&names, rows[i].integrator);
    return names;
}

/* The first row that ran whose state error is unknown for no reason given
   elsewhere. */
static const row *first_unknown(const plan *p, const row rows[], size_t count) {
    for (size_t i = 0; i < count && p->reference && !is_beyond(p); i++)
        if (rows[i].ran && isnan(rows[i].state_error))
            return &rows[i];
    return NULL;
}

static void explain_unknown(const plan *p, const row rows[], size_t count,
                            list *words) {
    const row *unknown = first_unknown(p, rows, count);
    if (unknown && *unknown->state_unknown)
        list_print(words, "%s at dt = %.4g has no state error: %s.",
                   unknown->integrator, unknown->dt, unknown->state_unknown);
}

/* True if H does not change within its lengths from the start on, up to rounding. */
static bool is_flat(const plan *p, nevh_probe *probe, nevh_field *exact) {
    static const double rounding = 1e-13; /* of the energy */
    double scale = plan_energy_scale(p), t = p->run->t_start;
    double *slope = tool_allocate(2 * p->n, sizeof *slope);
    bool flat =
        !nevh_probe_status(probe) &&
        !nevh_field_gradient(exact, 1, &t, p->q, p->p, slope, slope + p->n);
    const double *lengths = flat ? nevh_probe_lengths(probe) : NULL;
    for (size_t k = 0; flat && k < 2 * p->n; k++)
        flat = fabs(slope[k]) * lengths[k] <= rounding * scale;
    return flat;
}

/* True if the orbit rests where it starts, but for rounding that grows. */
static bool starts_at_rest(const plan *p) {
    if (!(nevh_system_traits(p->system) & NEVH_AUTONOMOUS))
        return false;
    nevh_options o = plan_options(p, "exact");
    o.gradient_step = 0;
    nevh_probe *probe = nevh_probe_new(p->system, &o);
    nevh_field *exact = nevh_field_new(p->system, &o);
    bool rests = is_flat(p, probe, exact);
    nevh_probe_free(probe);
    nevh_field_free(exact);
    return rests;
}

static void explain_out_of_step(const row rows[], size_t count, list *words) {
    list names = names_out_of_step(rows, count);
    char *text = list_joined(&names);
    if (names.count)
        list_print(words,
                   "Bounded energy does not mean an accurate orbit: the "
                   "%s of %s %s wrong.",
                   names.count == 1 ? "phase" : "phases", text,
                   names.count == 1 ? "is" : "are");
    list_add(words, "State error > 50 %: the computed position no longer has "
                    "to do with the true one.");
}

void state_words(const plan *p, const row rows[], size_t count, list *words) {
    bool out_of_step = any_out_of_step(rows, count);
    if (out_of_step && starts_at_rest(p))
        list_add(words,
                 "The orbit starts at rest at an unstable equilibrium, up to "
                 "rounding: what moves is rounding that grows, of which state "
                 "errors are parts.  They say nothing of the integrators.");
    else if (out_of_step)
        explain_out_of_step(rows, count, words);
    explain_unknown(p, rows, count, words);
}
