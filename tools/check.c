/* nevh check: what can be said of a scene before it is run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "pace.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void tell_finding(const nevh_probe *probe, nevh_question question,
                         list *notes) {
    nevh_finding f = nevh_probe_finding(probe, question);
    list_print(notes, "  %-24s %-3s  %.1e  %.1e%s%s",
               nevh_question_name(question), f.holds ? "yes" : "no", f.evidence,
               f.limit, f.term && !f.holds ? "  " : "",
               f.term && !f.holds ? f.term : "");
}

static void tell_probes(const plan *p, list *notes) {
    enum { SHOWN = 8 };
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_probe *probe = nevh_probe_new(p->system, &o);
    if (nevh_probe_status(probe)) {
        list_print(notes, "H could not be probed: %s",
                   nevh_probe_message(probe));
    } else {
        const double *lengths = nevh_probe_lengths(probe);
        list_add(notes,
                 "From values of H (largest violation met, and what rounding "
                 "would allow):");
        for (int i = 0; i < NEVH_FINDINGS; i++)
            tell_finding(probe, (nevh_question)i, notes);
        list_add(notes, "Lengths over which H varies:");
        for (size_t k = 0; k < p->n && k < SHOWN; k++)
            list_print(notes, "  %s: %.2g, p_%s: %.2g",
                       nevh_scene_coordinate(p->scene, k), lengths[k],
                       nevh_scene_coordinate(p->scene, k), lengths[p->n + k]);
        if (p->n > SHOWN)
            list_print(notes, "  and %zu more", p->n - SHOWN);
    }
    nevh_probe_free(probe);
}

static void tell_state(const plan *p, list *notes) {
    nevh_options o = plan_options(p, p->gradients.item[0]);
    o.gradient = nevh_central2;
    o.gradient_step = 1e-3; /* unused: H alone is asked for */
    nevh_field *field = nevh_field_new(p->system, &o);
    double h = NAN, t = p->run->t_start;
    nevh_field_value(field, 1, &t, p->q, p->p, &h);
    list_print(notes, "%zu degree%s of freedom, H = %.9g at the start", p->n,
               p->n == 1 ? "" : "s", h);
    nevh_field_free(field);
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

static void add_refusal(refusals *r, const char *scheme, const char *message) {
    char *why = reason(scheme, message);
    size_t i = 0;
    while (i < r->reasons.count && strcmp(r->reasons.item[i], why) != 0)
        i++;
    if (i == r->reasons.count) {
        list_add(&r->reasons, why);
        list_add(&r->names, scheme);
    } else {
        char *longer = text_print("%s, %s", r->names.item[i], scheme);
        free(r->names.item[i]);
        r->names.item[i] = longer;
    }
    free(why);
}

/* dt times the fastest frequency, against what the scheme bears. */
static void add_preflight(const plan *p, const nevh_integrator *scheme,
                          bool fits, const preflight *ahead, table *t) {
    double limit = fits ? nevh_stability_limit(scheme) : NAN;
    double x = fits ? p->dt[0] * ahead->frequency : NAN;
    if (isfinite(limit))
        table_shown(t, "%.3g", limit);
    else
        table_text(t, isinf(limit) ? "-" : NULL);
    if (x > 0)
        table_shown(t, "%.3g", x);
    else
        table_text(t, NULL);
    table_text(t, fits ? preflight_verdict(limit, x) : NULL);
}

static void add_scheme(const plan *p, const nevh_integrator *scheme, bool why,
                       const preflight *ahead, table *t, refusals *r) {
    nevh_options o = plan_options(p, p->gradients.item[0]);
    const char *name = nevh_integrator_name(scheme);
    if (o.gradient_step == 0)
        o.gradient_step = 1e-3; /* nothing is run: no need to choose it */
    if (nevh_integrator_needs_tolerance(scheme))
        o.tolerance = 1e-6;
    nevh_stepper *s = nevh_stepper_new(p->system, scheme, &o);
    int status = nevh_stepper_status(s);
    table_text(t, name);
    table_number(t, status ? nevh_integrator_order(scheme)
                           : nevh_stepper_order(s));
    table_text(t, status ? "no" : "yes");
    if (why)
        table_text(t, status ? nevh_stepper_message(s) : NULL);
    add_preflight(p, scheme, !status, ahead, t);
    if (status)
        add_refusal(r, name, nevh_stepper_message(s));
    nevh_stepper_free(s);
}

/* Reasons are a column where programs read, and below the table where people
   do. */
static void add_schemes(const plan *p, bool why, const preflight *ahead,
                        page *result) {
    static const char *const columns[] = {"integrator", "order", "fits", "why"};
    refusals r = {0};
    for (size_t i = 0; i < (why ? 4 : 3); i++)
        table_column(result->table, columns[i]);
    table_column(result->table, why ? "stable_below" : "stable\nbelow");
    table_column(result->table, why ? "h_omega" : "h w");
    table_column(result->table, why ? "preflight" : "");
    for (size_t i = 0; nevh_integrators()[i]; i++)
        add_scheme(p, nevh_integrators()[i], why, ahead, result->table, &r);
    for (size_t i = 0; !why && i < r.names.count; i++) {
        list_print(&result->after, "%s: %s", r.names.item[i],
                   r.reasons.item[i]);
    }
    list_free(&r.names);
    list_free(&r.reasons);
}

static int check_plan(const options *o, const plan *p) {
    page result = {.table = table_new()};
    bool is_table = o->format == FORMAT_TABLE;
    preflight ahead = preflight_fly(p);
    if (!o->quiet || !is_table) {
        plan_notes(p, &result.before);
        tell_state(p, &result.before);
        tell_probes(p, &result.before);
        preflight_words(p, &ahead, &result.before);
    }
    add_schemes(p, !is_table, &ahead, &result);
    free(ahead.failure);
    int status = output_page(o, &result, TOOL_OK);
    page_free(&result);
    return status;
}

int check(const options *o) {
    plan p;
    int status = plan_make(&p, o);
    if (!status)
        status = check_plan(o, &p);
    plan_free(&p);
    return status;
}
