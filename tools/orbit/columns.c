/* nevh: what plots show of a state, by name.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "columns.h"
#include "plot/plot.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

quantities columns_new(const plan *p) {
    size_t count = nevh_scene_shown_count(p->scene, NEVH_OBSERVABLES);
    quantities c = {.plan = p,
                    .observed = tool_allocate(count, sizeof(double)),
                    .field = plan_values(p)};
    double t = p->run->t_start;
    if (nevh_field_value(c.field, 1, &t, p->q, p->p, &c.start))
        c.start = NAN;
    return c;
}

void columns_free(quantities *c) {
    nevh_field_free(c->field);
    nevh_shadow_free(c->shadow);
    for (size_t i = 0; i < c->count; i++)
        tool_release(c->item[i].name);
    tool_release(c->item);
    tool_release(c->observed);
}

static bool find_state(const plan *p, const char *name, quantity *column) {
    bool momentum = strncmp(name, "p_", 2) == 0;
    for (size_t k = 0; k < p->n; k++) {
        const char *coordinate = nevh_scene_coordinate(p->scene, k);
        column->index = k;
        column->kind = COLUMN_COORDINATE;
        if (strcmp(name, coordinate) == 0)
            return true;
        column->kind = COLUMN_MOMENTUM;
        if (momentum && strcmp(name + 2, coordinate) == 0)
            return true;
    }
    return false;
}

static bool find_other(const plan *p, const char *name, quantity *column) {
    static const struct {
        const char *name;
        column_kind kind;
    } known[] = {{"t", COLUMN_TIME},
                 {"energy", COLUMN_ENERGY},
                 {"energy_error", COLUMN_ENERGY_ERROR},
                 {"shadow_error", COLUMN_SHADOW_ERROR}};
    size_t count = nevh_scene_shown_count(p->scene, NEVH_OBSERVABLES);
    column->kind = COLUMN_OBSERVABLE;
    for (column->index = 0; column->index < count; column->index++)
        if (strcmp(name, nevh_scene_shown_name(p->scene, NEVH_OBSERVABLES,
                                               column->index)) == 0)
            return true;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        column->kind = known[i].kind;
        if (strcmp(name, known[i].name) == 0)
            return true;
    }
    return false;
}

static int refuse_name(const plan *p, const char *name) {
    list known = {0};
    list_split(&known, "t,energy,energy_error,shadow_error");
    for (size_t k = 0; k < p->n; k++) {
        list_add(&known, nevh_scene_coordinate(p->scene, k));
        list_print(&known, "p_%s", nevh_scene_coordinate(p->scene, k));
    }
    for (size_t i = 0; nevh_scene_shown_name(p->scene, NEVH_OBSERVABLES, i);
         i++)
        list_add(&known, nevh_scene_shown_name(p->scene, NEVH_OBSERVABLES, i));
    return tool_unknown("column", name, &known);
}

int columns_add(quantities *c, const char *name) {
    quantity is = {0};
    if (!find_state(c->plan, name, &is) && !find_other(c->plan, name, &is))
        return refuse_name(c->plan, name);
    if (is.kind == COLUMN_ENERGY_ERROR && c->plan->balance)
        return tool_refuse("energy_error: H of this scene changes with time or "
                           "friction; --plot-kind energy shows the error of "
                           "the balance");
    bool relative =
        is.kind == COLUMN_ENERGY_ERROR || is.kind == COLUMN_SHADOW_ERROR;
    if (relative && !(c->scale > 0))
        c->scale = plan_energy_scale(c->plan);
    c->item = tool_grown(c->item, c->count, sizeof *c->item);
    is.name = text_print("%s", name);
    c->item[c->count++] = is;
    return TOOL_OK;
}

static bool any(const quantities *c, column_kind low, column_kind high) {
    for (size_t i = 0; i < c->count; i++)
        if (c->item[i].kind >= low && c->item[i].kind <= high)
            return true;
    return false;
}

int columns_follow(quantities *c, const char *integrator, double dt) {
    const plan *p = c->plan;
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, integrator, &transformed);
    nevh_options o = plan_options(p, p->gradients.item[0]);
    if (!any(c, COLUMN_SHADOW_ERROR, COLUMN_SHADOW_ERROR))
        return NEVH_OK;
    o.transform = plan_transform(p, integrator);
    nevh_shadow_free(c->shadow);
    c->shadow = nevh_shadow_new(p->system, scheme, dt, &o);
    nevh_shadow_value(c->shadow, p->q, p->p, NULL, &c->shadow_start);
    return nevh_shadow_status(c->shadow);
}

static double shadow_error(quantities *c, const double q[], const double p[]) {
    double value;
    if (!c->shadow || nevh_shadow_value(c->shadow, q, p, NULL, &value))
        return NAN;
    return (value - c->shadow_start) / c->scale;
}

void columns_values(quantities *c, double t, const double q[], const double p[],
                    double values[]) {
    double energy = NAN;
    bool observed = any(c, COLUMN_OBSERVABLE, COLUMN_OBSERVABLE) &&
                    !nevh_scene_shown_values(c->plan->scene, NEVH_OBSERVABLES,
                                             t, q, p, c->observed);
    if (any(c, COLUMN_ENERGY, COLUMN_ENERGY_ERROR) &&
        nevh_field_value(c->field, 1, &t, q, p, &energy))
        energy = NAN;
    for (size_t i = 0; i < c->count; i++) {
        const quantity *column = &c->item[i];
        values[i] = column->kind == COLUMN_TIME         ? t
                    : column->kind == COLUMN_COORDINATE ? q[column->index]
                    : column->kind == COLUMN_MOMENTUM   ? p[column->index]
                    : column->kind == COLUMN_ENERGY     ? energy
                    : column->kind == COLUMN_ENERGY_ERROR
                        ? (energy - c->start) / c->scale
                    : column->kind == COLUMN_SHADOW_ERROR
                        ? shadow_error(c, q, p)
                    : observed ? c->observed[column->index]
                               : NAN;
    }
}

char *column_label(const plan *p, const quantity *c) {
    if (c->kind == COLUMN_ENERGY && p->balance)
        return plot_label(p, "energy, not conserved", c->name);
    return c->kind == COLUMN_ENERGY_ERROR ? text_print("energy error, relative")
           : c->kind == COLUMN_SHADOW_ERROR ? text_print("error of shadow H")
                                            : plot_label(p, c->name, c->name);
}
