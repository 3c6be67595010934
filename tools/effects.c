/* nevh effects: what each effect reads and costs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What an effect reads, found with all others off. */
typedef struct {
    bool time, friction, coordinates, momenta;
} reads;

static reads what_it_reads(plan *p, size_t effect) {
    const nevh_system *s = p->system;
    reads r = {0};
    for (size_t i = 0; s && i < nevh_system_effect_count(s); i++) {
        char *name = text_print("%s", nevh_system_effect_name(s, i));
        if (nevh_scene_enable(p->scene, name, i == effect))
            s = NULL;
        else
            s = nevh_scene_system(p->scene);
        free(name);
    }
    if (!s)
        return r;
    nevh_options o = {.gradient_step = 1e-3, .q = p->q, .p = p->p};
    nevh_field *field = nevh_field_new(s, &o);
    r.time = !(nevh_system_traits(s) & NEVH_AUTONOMOUS);
    r.friction = nevh_system_friction(s, NULL);
    for (size_t i = 0; i < nevh_field_step_count(field); i++)
        *(nevh_field_step_report(field, i).momentum ? &r.momenta
                                                    : &r.coordinates) = true;
    nevh_field_free(field);
    p->system = s;
    return r;
}

static char *words(reads r) {
    char *text = text_print("%s%s%s", r.time ? "t, " : "",
                            r.coordinates ? "coordinates, " : "",
                            r.momenta ? "momenta, " : "");
    size_t length = strlen(text);
    if (length)
        text[length - 2] = 0;
    if (length || !r.friction)
        return text;
    free(text);
    return text_print("momenta (friction)");
}

typedef struct {
    double *values, sum;
    bool *on;
    size_t count;
} costs;

static int run(const plan *p, costs *c, list *notes) {
    const nevh_integrator *scheme;
    nevh_stepper *s = plan_first(p, &scheme);
    if (!s)
        return TOOL_USAGE;
    int status = nevh_run_until(s, p->run->t_start, p->dt[0], p->t_end, p->q,
                                p->p, NULL, 0);
    for (size_t i = 0; i < c->count; i++) {
        const char *name = nevh_system_effect_name(p->system, i);
        c->on[i] = nevh_system_effect_on(p->system, name);
        c->values[i] =
            (double)nevh_field_effect_values(nevh_stepper_field(s), name);
        c->sum += c->values[i];
    }
    list_print(notes,
               "evaluations of term instances by %s, dt = %g, gradient "
               "%s: the first of each that fits",
               nevh_integrator_name(scheme), p->dt[0], p->gradients.item[0]);
    if (status)
        list_print(notes, "the run failed: %s", nevh_stepper_message(s));
    nevh_stepper_free(s);
    return status ? TOOL_FAILED : TOOL_OK;
}

static void fill(plan *p, const costs *c, table *t) {
    table_column(t, "effect");
    table_column(t, "state");
    table_column(t, "reads");
    table_column(t, "evaluations");
    table_column(t, "share");
    for (size_t i = 0; i < c->count; i++) {
        char *name = text_print("%s", nevh_system_effect_name(p->system, i));
        char *reading = words(what_it_reads(p, i));
        table_text(t, name);
        table_text(t, c->on[i] ? "on" : "off");
        table_text(t, reading);
        table_number(t, c->values[i]);
        if (c->sum > 0)
            table_shown(t, "%.3f", c->values[i] / c->sum);
        else
            table_text(t, NULL);
        free(name);
        free(reading);
    }
}

static int effects_of(const options *o, plan *p) {
    page result = {.table = table_new()};
    size_t count = nevh_system_effect_count(p->system);
    costs c = {tool_allocate(count, sizeof *c.values), 0,
               tool_allocate(count, sizeof *c.on), count};
    plan_notes(p, &result.before);
    int status = run(p, &c, &result.before);
    if (status != TOOL_USAGE) {
        fill(p, &c, result.table);
        if (o->quiet && o->format == FORMAT_TABLE)
            list_free(&result.before);
        status = output_page(o, &result, status);
    }
    free(c.values);
    free(c.on);
    page_free(&result);
    return status;
}

int effects(const options *o) {
    plan p;
    int status = plan_make(&p, o);
    if (!status)
        status = effects_of(o, &p);
    plan_free(&p);
    return status;
}
