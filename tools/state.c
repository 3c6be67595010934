/* nevh: state errors: the reference of a plan, and how they are shown.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double out_of_step = 0.5;

/* Why there is no reference, or NULL. */
static char *refusal(const plan *p, const char *name) {
    const char *text = nevh_reference_text(p->reference);
    if (!p->reference)
        return text_print("out of memory");
    if (nevh_reference_status(p->reference))
        return text_print("%s", nevh_reference_message(p->reference));
    if (name && strcmp(name, "exact") == 0 && strncmp(text, "exact", 5) != 0)
        return text_print("no exact solution of this H is known");
    return NULL;
}

/* Elements of an array are of one kind. */
static nevh_reference *
make_reference(const plan *p, const nevh_integrator *scheme, double end) {
    size_t *kind = tool_allocate(p->n, sizeof *kind);
    for (size_t k = 0; k < p->n; k++)
        kind[k] = nevh_scene_array(p->scene, k);
    nevh_reference_options o = {.integrator = scheme, .kind = kind};
    nevh_reference *made =
        nevh_reference_with(p->system, &o, p->run->t_start, end, p->q, p->p);
    free(kind);
    return made;
}

int plan_reference(plan *p, double end) {
    const char *name = p->run->reference;
    const nevh_integrator *scheme = NULL;
    bool transformed = false;
    if (p->reference || p->no_reference)
        return TOOL_OK;
    if (name && strcmp(name, "exact") != 0)
        scheme = plan_scheme(name, &transformed);
    if (transformed)
        return tool_refuse("reference = %s: its steps must have the same "
                           "length; take it without +transform",
                           name);
    p->reference_end = end;
    p->reference = make_reference(p, scheme, end);
    p->no_reference = refusal(p, name);
    if (!p->no_reference)
        return TOOL_OK;
    nevh_reference_free(p->reference);
    p->reference = NULL;
    return TOOL_OK;
}

static bool is_chaos(const plan *p) {
    return p->reference &&
           p->reference_end > nevh_reference_horizon(p->reference);
}

void state_notes(const plan *p, list *notes) {
    const char *text = nevh_reference_text(p->reference);
    if (p->no_reference)
        list_print(notes, "no state errors: %s", p->no_reference);
    else if (is_chaos(p))
        list_print(notes,
                   "state errors mean nothing after t = %.4g, where orbits "
                   "that differ in the last digits have separated (%s)",
                   nevh_reference_horizon(p->reference), text);
    else if (p->reference)
        list_print(notes, "state error against %s%s%s",
                   strncmp(text, "exact", 5) == 0 ? "the " : "", text,
                   ", the largest over coordinates and momenta, over the range "
                   "of each");
}

bool state_out_of_step(const row *r) {
    return r->ran && r->state_error > out_of_step;
}

void state_show(table *t, const plan *p, const row *r) {
    if (!p->reference || !r->ran)
        table_text(t, NULL);
    else if (state_out_of_step(r))
        table_shown(t, "out of step");
    else if (is_chaos(p))
        table_shown(t, "meaningless");
    else if (isnan(r->state_error))
        table_text(t, NULL);
    else
        table_shown(t, "%.0e", r->state_error);
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

void state_words(const row rows[], size_t count, list *words) {
    list names = names_out_of_step(rows, count);
    char *text = list_joined(&names);
    if (names.count)
        list_print(
            words,
            "Bounded energy is not an accurate orbit: %s %s out of step.", text,
            names.count == 1 ? "is" : "are");
    list_free(&names);
    free(text);
}
