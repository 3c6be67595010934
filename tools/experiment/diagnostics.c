/* nevh compare --diagnostics: what a step does to phase space, how it was
   solved, and what became of the invariants.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <string.h>

/* The cost of the first grows with n, its memory with n^2. */
enum { MOST_DOF = 16, REVERSED_STEPS = 100 };

struct invariants {
    nevh_scene *scene;
    size_t count;
    bool begun;
    double *first, *now, *change;
};

invariants *invariants_new(const plan *p) {
    size_t count = nevh_scene_shown_count(p->scene, NEVH_INVARIANTS);
    invariants *v = tool_allocate(1, sizeof *v);
    *v = (invariants){.scene = p->scene,
                      .count = count,
                      .first = tool_allocate(count, sizeof(double)),
                      .now = tool_allocate(count, sizeof(double)),
                      .change = tool_allocate(count, sizeof(double))};
    return v;
}

int invariants_observe(void *data, size_t step, double t, const double q[],
                       const double p[]) {
    invariants *v = data;
    (void)step;
    if (v->count == 0)
        return NEVH_OK;
    nevh_scene_shown_values(v->scene, NEVH_INVARIANTS, t, q, p, v->now);
    if (!v->begun)
        memcpy(v->first, v->now, v->count * sizeof *v->now);
    v->begun = true;
    for (size_t i = 0; i < v->count; i++) {
        double change = fabs(v->now[i] - v->first[i]);
        v->change[i] = change <= v->change[i] ? v->change[i] : change;
    }
    return NEVH_OK;
}

double *invariants_result(invariants *v) {
    double *change = v->change;
    tool_release(v->first);
    tool_release(v->now);
    tool_release(v);
    return change;
}

/* A part of the ranges of the reference, where there is one. */
static void set_scale(const plan *p, double part, double scale[]) {
    for (size_t k = 0; k < 2 * p->n; k++)
        scale[k] =
            part * (p->reference ? nevh_reference_range(p->reference, k) : 1);
}

/* Diagnoses the first steps. The derivative of the first one is taken over a small
   part of the ranges: orbits may begin where H varies most. */
void diagnose_row(const plan *p, row *r) {
    double t = p->run->t_start, *scale = tool_allocate(2 * p->n, sizeof *scale);
    size_t steps = r->steps < REVERSED_STEPS ? r->steps : REVERSED_STEPS;
    nevh_stepper *s = row_stepper(p, r, false);
    r->symplecticity_error = r->reversal_error = NAN;
    set_scale(p, 1. / 16, scale);
    if (p->n <= MOST_DOF)
        nevh_symplecticity_defect(s, t, r->dt, p->q, p->p, scale,
                                  &r->symplecticity_error);
    set_scale(p, 1, scale);
    nevh_reversal_defect(s, t, r->dt, steps, p->q, p->p, scale,
                         &r->reversal_error);
    row_stepper_keep(p, r, false, s);
    tool_release(scale);
}

static const char *const names[] = {
    "symplecticity_error", "reversal_error", "newtons", "rescues",
    "drift_error",         "straightness"};
static const char *const shown[] = {"symplecticity\nerror", "reversal\nerror",
                                    "Newton\nsteps", "shadow H\nerror"};

void diagnostics_columns(table *t, const plan *p, bool is_table) {
    size_t count = nevh_scene_shown_count(p->scene, NEVH_INVARIANTS);
    size_t most =
        is_table ? sizeof shown / sizeof *shown : sizeof names / sizeof *names;
    for (size_t i = 0; p->diagnostics && i < most; i++)
        table_column(t, is_table ? shown[i] : names[i]);
    for (size_t i = 0; p->diagnostics && i < count; i++) {
        const char *name = nevh_scene_shown_name(p->scene, NEVH_INVARIANTS, i);
        char *title =
            text_print(is_table ? "change of\n%s" : "change_%s", name);
        table_column(t, title);
    }
}

void diagnostics_record(table *t, const plan *p, const row *r) {
    size_t count = nevh_scene_shown_count(p->scene, NEVH_INVARIANTS);
    const double values[] = {
        r->symplecticity_error,    r->reversal_error,
        (double)r->counts.newtons, (double)r->counts.rescues,
        r->energy.drift_error,     r->energy.straightness};
    for (size_t i = 0; p->diagnostics && i < sizeof values / sizeof *values;
         i++)
        table_number(t, r->ran ? values[i] : NAN);
    for (size_t i = 0; p->diagnostics && i < count; i++)
        table_number(t, r->ran ? r->changes[i] : NAN);
}

void diagnostics_show(table *t, const plan *p, const row *r) {
    size_t count = nevh_scene_shown_count(p->scene, NEVH_INVARIANTS);
    if (!p->diagnostics)
        return;
    table_error(t, r->ran ? r->symplecticity_error : NAN);
    table_error(t, r->ran ? r->reversal_error : NAN);
    if (r->ran)
        table_shown(t, "%.0f", (double)r->counts.newtons);
    else
        table_text(t, NULL);
    shadow_show(t, r);
    for (size_t i = 0; i < count; i++)
        table_error(t, r->ran ? r->changes[i] : NAN);
}
