/* nevh check: what can be said of a scene before it is run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "experiment/conserved.h"
#include "experiment/trial_run.h"
#include "orbit/warnings.h"
#include "parts_words.h"
#include <math.h>
#include <nevh/extend.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* words   what follows, or "" */
static void finding_note(nevh_question question, const nevh_finding *f,
                         bool holds, const char *words, list *notes) {
    list_print(notes, "  %-24s %-3s  %.1e  %.1e%s%s",
               nevh_question_name(question), holds ? "yes" : "no", f->evidence,
               f->limit, *words ? "  " : "", words);
}

static void finding_notes(const nevh_probe *probe, nevh_question question,
                          list *notes) {
    nevh_finding f = nevh_probe_finding(probe, question);
    bool has_term = f.term && (!f.holds || question == NEVH_IS_REVERSIBLE);
    finding_note(question, &f, f.holds, has_term ? f.term : "", notes);
}

/* On the orbit a Taylor series knows better than differences beside it. */
static smoothness smoothness_finding(const plan *p, const nevh_probe *probe,
                                     list *notes) {
    char *why = NULL;
    smoothness on_way = smoothness_on_way(p, &why);
    nevh_finding f = nevh_probe_finding(probe, NEVH_IS_SMOOTH);
    bool timed = !(nevh_system_traits(p->system) & NEVH_AUTONOMOUS);
    bool agree =
        on_way == SMOOTHNESS_UNKNOWN || (on_way == SMOOTHNESS_ALL) == f.holds;
    if (agree && !(f.holds && timed))
        finding_notes(probe, NEVH_IS_SMOOTH, notes);
    else
        finding_note(NEVH_IS_SMOOTH, &f, f.holds == agree,
                     agree ? "in q and p" : "on the orbit, by a Taylor series",
                     notes);
    if (why)
        list_print(notes, "  (%s)", why);
    return on_way;
}

/* Tells whether H is smooth on its way, if that was asked. */
static smoothness probe_notes(const plan *p, list *notes) {
    enum { SHOWN = 8 };
    smoothness on_way = SMOOTHNESS_UNKNOWN;
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_probe *probe = nevh_probe_new(p->system, &o);
    if (nevh_probe_status(probe)) {
        list_print(notes, "H could not be probed: %s",
                   nevh_probe_message(probe));
    } else {
        const double *lengths = nevh_probe_lengths(probe);
        list_add(notes, "Properties of H, tested numerically: largest "
                        "deviation, and the deviation that rounding explains");
        for (int i = 0; i < NEVH_FINDINGS; i++)
            if (i == NEVH_IS_SMOOTH)
                on_way = smoothness_finding(p, probe, notes);
            else
                finding_notes(probe, (nevh_question)i, notes);
        list_add(notes, "Lengths over which H varies:");
        for (size_t k = 0; k < p->n && k < SHOWN; k++)
            list_print(notes, "  %s: %.2g, p_%s: %.2g",
                       nevh_scene_coordinate(p->scene, k), lengths[k],
                       nevh_scene_coordinate(p->scene, k), lengths[p->n + k]);
        if (p->n > SHOWN)
            list_print(notes, "  and %zu more", p->n - SHOWN);
    }
    nevh_probe_free(probe);
    return on_way;
}

static void energy_notes(const plan *p, list *notes) {
    nevh_field *field = plan_values(p);
    double h = NAN, t = p->run->t_start;
    nevh_field_value(field, 1, &t, p->q, p->p, &h);
    list_print(notes, "%zu degree%s of freedom, H = %.9g at the start", p->n,
               p->n == 1 ? "" : "s", h);
    nevh_field_free(field);
}

static void note_table(const nevh_integrator *scheme, list *notes) {
    nevh_scheme_facts x;
    char missing[300], kinetic[80] = "";
    if (nevh_integrator_facts(scheme, &x)) {
        list_print(notes, "  %s: order %d, composed of steps of tao2",
                   nevh_integrator_name(scheme), nevh_integrator_order(scheme));
        return;
    }
    if (x.any_kinetic < x.order)
        snprintf(kinetic, sizeof kinetic, " (%d where T is not quadratic in p)",
                 x.any_kinetic);
    nevh_scheme_shortfall(&x, missing, sizeof missing);
    list_print(notes, "  %s: order %d%s%s%s%s%s%s",
               nevh_integrator_name(scheme), x.order,
               x.needed_for ? "" : " or more", kinetic,
               x.symmetric ? ", symmetric" : ", not symmetric",
               x.symplectic ? ", symplectic" : ", not symplectic",
               x.needed_for ? "; " : "", missing);
}

/* Facts that follow from the tables of [integrator NAME]. */
static void note_tables(const plan *p, list *notes) {
    const nevh_integrator *scheme;
    for (size_t i = 0; (scheme = nevh_scene_integrator(p->scene, i)); i++) {
        if (i == 0)
            list_add(notes, "The scene's own integrators, by the algebra of "
                            "their tables:");
        note_table(scheme, notes);
    }
}

typedef struct {
    list names, reasons; /* reasons[i] is why names[i] do not fit */
} refusals;

/* The message without the scheme's name and the schemes to take instead, which
   are the rest of the table. */
static char *reason(const char *scheme, const char *message) {
    size_t own = strlen(scheme);
    if (strncmp(message, scheme, own) == 0 && message[own] == ' ')
        message += own + 1;
    const char *end = strstr(message, "; schemes that fit");
    size_t length = end ? (size_t)(end - message) : strlen(message);
    return text_print("%.*s", (int)length, message);
}

/* The number of a reason; that of reasons: it is a new one. */
static size_t find_reason(const refusals *r, const char *why) {
    size_t i = 0;
    while (i < r->reasons.count && strcmp(r->reasons.item[i], why) != 0)
        i++;
    return i;
}

static bool is_refusal(const refusals *r, const char *scheme,
                       const char *message) {
    char *why = reason(scheme, message);
    bool known = find_reason(r, why) < r->reasons.count;
    return known;
}

static void add_refusal(refusals *r, const char *scheme, const char *message) {
    char *why = reason(scheme, message);
    size_t i = find_reason(r, why);
    if (i == r->reasons.count) {
        list_add(&r->reasons, why);
        list_add(&r->names, scheme);
    } else {
        r->names.item[i] = text_print("%s, %s", r->names.item[i], scheme);
    }
}

/* "unstable", and by how much where no step is stable; NULL: nothing. */
static char *prediction(const plan *p, const nevh_integrator *scheme,
                        const trial_run *ahead, double limit) {
    double x = p->dt[0] * ahead->frequency;
    double growth = limit == 0 ? nevh_stability_growth(scheme, x) : NAN;
    const char *verdict =
        growth == 1 ? NULL : trial_run_verdict(ahead, limit, p->dt[0]);
    if (growth >= 2)
        return text_print("unstable: amplitude times %.3g a period", growth);
    if (growth > 1)
        return text_print("unstable: amplitude +%.2g %% a period",
                          100 * (growth - 1));
    return verdict ? text_print("%s", verdict) : NULL;
}

/* dt times the fastest frequency, of the motion or of a drive, against what the
   scheme bears of the motion's. */
static void add_trial_run(const plan *p, const nevh_integrator *scheme,
                          bool fits, bool why, const trial_run *ahead,
                          table *t) {
    double limit = fits ? nevh_stability_limit(scheme) : NAN;
    double x = fits ? p->dt[0] * fmax(ahead->frequency, ahead->drive) : NAN;
    if (!why && limit == 0)
        table_text(t, "never");
    else if (isfinite(limit))
        table_shown(t, "%.3g", limit);
    else
        table_text(t, isinf(limit) ? "any step" : NULL);
    if (x > 0)
        table_shown(t, "%.3g", x);
    else
        table_text(t, NULL);
    bool exact = nevh_integrator_needs(scheme) & NEVH_PARTS; /* at any step */
    char *text = fits && !exact ? prediction(p, scheme, ahead, limit) : NULL;
    table_text(t, text);
}

/* The table and the words below it. */
typedef struct {
    const plan *plan;
    const trial_run *ahead;
    bool why, all; /* reasons as a column; all rows, not the plan's alone */
    table *table;
    refusals refused;
    list others;                   /* that fit */
    const nevh_integrator *fitted; /* the last of them */
} fitting;

static bool is_planned(const plan *p, const nevh_integrator *scheme) {
    bool transformed;
    for (size_t i = 0; i < p->integrators.count; i++)
        if (plan_scheme(p, p->integrators.item[i], &transformed) == scheme)
            return true;
    return false;
}

static bool is_own(const plan *p, const nevh_integrator *scheme) {
    const nevh_integrator *own;
    for (size_t i = 0; (own = nevh_scene_integrator(p->scene, i)); i++)
        if (own == scheme)
            return true;
    return false;
}

/* And of the scene's own the first condition that fails. */
static void add_claims(const plan *p, const nevh_integrator *scheme, table *t) {
    nevh_scheme_facts x;
    char missing[300] = "";
    table_text(t, nevh_claim_name(nevh_integrator_symplectic(scheme)));
    table_text(t, nevh_claim_name(nevh_integrator_symmetric(scheme)));
    if (is_own(p, scheme) && !nevh_integrator_facts(scheme, &x))
        nevh_scheme_shortfall(&x, missing, sizeof missing);
    table_text(t, *missing ? missing : NULL);
}

static void add_row(fitting *f, const nevh_integrator *scheme,
                    const nevh_stepper *s) {
    int status = nevh_stepper_status(s);
    table_text(f->table, nevh_integrator_name(scheme));
    table_number(f->table, status ? nevh_integrator_order(scheme)
                                  : nevh_stepper_order(s));
    table_text(f->table, status ? "no" : "yes");
    if (f->why)
        table_text(f->table, status ? nevh_stepper_message(s) : NULL);
    add_trial_run(f->plan, scheme, !status, f->why, f->ahead, f->table);
    if (f->why)
        add_claims(f->plan, scheme, f->table);
}

/* Schemes of one kernel and of the same needs fit alike. */
static bool fits_as_last(const fitting *f, const nevh_integrator *scheme) {
    return f->fitted && f->fitted->kernel == scheme->kernel &&
           f->fitted->needs == scheme->needs &&
           f->fitted->needs_tolerance == scheme->needs_tolerance;
}

static void add_scheme(fitting *f, const nevh_integrator *scheme) {
    const plan *p = f->plan;
    nevh_options o = plan_options(p, p->gradients.item[0]);
    const char *name = nevh_integrator_name(scheme);
    bool chosen = o.gradient_step == 0, shown = f->all || is_planned(p, scheme);
    if (!shown && fits_as_last(f, scheme)) {
        list_add(&f->others, name);
        return;
    }
    if (chosen)
        o.gradient_step = 1e-3; /* nothing is run: no need to choose it */
    if (nevh_integrator_needs_tolerance(scheme))
        o.tolerance = 1e-6;
    nevh_stepper *s = nevh_stepper_new(p->system, scheme, &o);
    if (chosen && nevh_stepper_status(s) && /* masses are by differences */
        !is_refusal(&f->refused, name, nevh_stepper_message(s))) {
        nevh_stepper_free(s);
        o.gradient_step = 0;
        s = nevh_stepper_new(p->system, scheme, &o);
    }
    int status = nevh_stepper_status(s);
    if (shown)
        add_row(f, scheme, s);
    else if (!status)
        list_add(&f->others, name);
    if (!status)
        f->fitted = scheme;
    else
        add_refusal(&f->refused, name, nevh_stepper_message(s));
    nevh_stepper_free(s);
}

static void other_words(const fitting *f, list *words) {
    list_add(words,
             "stable below: the largest omega dt at which the steps of a small "
             "oscillation stay bounded (never: they grow at any); of large "
             "ones, resonances may end it earlier.  Empty where the integrator "
             "chooses its own steps.");
    char *others = list_joined(&f->others);
    if (*others)
        list_print(words, "Also fit (--all shows them): %s.", others);
    for (size_t i = 0; i < f->refused.names.count; i++)
        list_print(words, "Do not fit: %s: %s", f->refused.names.item[i],
                   f->refused.reasons.item[i]);
}

/* Reasons are a column where programs read, and below the table where people
   do. */
static void add_schemes(fitting *f, page *result) {
    table_titles(f->table, f->why ? check_command.columns
                                  : "integrator,order,fits,stable\nbelow,"
                                    "omega dt,");
    const nevh_integrator *scheme;
    for (size_t i = 0; (scheme = plan_scheme_at(f->plan, i)); i++)
        add_scheme(f, scheme);
    if (!f->why)
        other_words(f, &result->after);
}

static int check_plan(const options *o, const plan *p) {
    page result = {.table = table_new()};
    bool is_table = o->format == FORMAT_TABLE;
    trial_run ahead = trial_run_new(p, true);
    if (!o->quiet || !is_table) {
        plan_notes(p, &result.before);
        plan_note_digits(p, &p->integrators, &result.before);
        energy_notes(p, &result.before);
        ahead.rough = probe_notes(p, &result.before) == SMOOTHNESS_NONE;
        trial_run_words(p, &ahead, &result.before);
        row_list rows = rows_of(p);
        warnings_words(p, &ahead, rows.row, rows.count, &result.before);
        conserved_words(p, &result.before);
        parts_words(p, &result.before);
        note_tables(p, &result.before);
    }
    add_schemes(&(fitting){.plan = p,
                           .ahead = &ahead,
                           .why = !is_table,
                           .all = !is_table || o->all,
                           .table = result.table},
                &result);
    if (o->quiet && is_table)
        result.after = (list){0};
    int status = output_page(o, &result, TOOL_OK);
    return status;
}

static int check(const options *o) {
    plan p;
    int status = plan_make(&p, o);
    if (!status && o->file)
        status = output_check(o->file);
    if (!status)
        status = check_plan(o, &p);
    plan_free(&p);
    return status;
}

const command check_command = {
    .name = "check",
    .operand = "SCENE",
    .brief = "mistakes in the scene, properties of H, what fits",
    .help =
        "mistakes in the scene file, properties of H, and which integrators fit",
    .examples = "check double-pendulum --t-end 20\n"
                "check pendulum --all",
    .options = "SCENE STEPS TABLE all",
    .columns = "integrator,order,fits,why,stable_below,h_omega,"
               "prediction,symplectic,symmetric,shortfall",
    .run = check,
};
