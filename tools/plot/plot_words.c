/* nevh: plots: titles, notes and units.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A word, to which others can be written as factors. */
static bool is_plain(const char *unit) {
    return *unit && !strpbrk(unit, " /*^()");
}

/* "M L/T" of an energy "M L^2/T^2"; NULL where it is not of that form. */
static char *unit_of_parts(const char *energy, const char *length,
                           const char *time) {
    char *ends = text_print("%s^2/%s^2", length, time);
    size_t all = strlen(energy), end = strlen(ends);
    bool fits = all > end && energy[all - end - 1] == ' ' &&
                strcmp(energy + all - end, ends) == 0;
    return fits
               ? text_print("%.*s%s/%s", (int)(all - end), energy, length, time)
               : NULL;
}

/* The unit that makes p dq/dt an energy; an angle counts as a number. */
static char *momentum_unit(const plan *p, const char *coordinate) {
    const char *energy = nevh_scene_label(p->scene, "energy");
    const char *time = nevh_scene_label(p->scene, "t");
    const char *length = nevh_scene_label(p->scene, coordinate);
    bool angle = strcmp(length, "rad") == 0;
    if (!is_plain(time) || !is_plain(length))
        return text_print("%s", "");
    if (!is_plain(energy)) {
        char *parts = angle ? NULL : unit_of_parts(energy, length, time);
        return parts ? parts : text_print("%s", "");
    }
    return angle ? text_print("%s %s", energy, time)
                 : text_print("%s %s/%s", energy, time, length);
}

static char *unit_of(const plan *p, const char *name) {
    const char *label = nevh_scene_label(p->scene, name);
    return *label || strncmp(name, "p_", 2) != 0 ? text_print("%s", label)
                                                 : momentum_unit(p, name + 2);
}

/* The name that [picture] gives the body of a coordinate of an array; "". */
static const char *body_of(const plan *p, const char *coordinate) {
    if (!strchr(coordinate, '['))
        return "";
    for (size_t i = 0; i < nevh_scene_part_count(p->scene); i++) {
        nevh_scene_part part = nevh_scene_part_at(p->scene, i);
        for (size_t k = 0; part.name && k < part.count; k++)
            if (strcmp(part.item[k], coordinate) == 0)
                return part.name;
    }
    return "";
}

char *plot_label(const plan *p, const char *name, const char *of) {
    char *unit = unit_of(p, of);
    const char *body = body_of(p, name);
    return text_print(*unit ? "%s%s%s (%s)" : "%s%s%s%s", name,
                      *body ? ", " : "", body, unit);
}

static char *joined(const list *parts) {
    char *text = text_print("%s", "");
    for (size_t i = 0; i < parts->count; i++) {
        char *longer =
            text_print("%s%s%s", text, i ? "; " : "", parts->item[i]);
        text = longer;
    }
    return text;
}

void plot_note_run(plot *to, const plan *p, const char *scheme,
                   const char *more) {
    const char *unit = nevh_scene_label(p->scene, "t");
    list parts = {0};
    char *gradients = list_joined(&p->gradients);
    if (scheme)
        list_add(&parts, scheme);
    list_print(&parts, "gradient %s",
               scheme ? p->gradients.item[0] : gradients);
    list_print(&parts, "t = %.6g ... %.6g%s%s", p->run->t_start, p->t_end,
               *unit ? " " : "", unit);
    if (more && *more)
        list_add(&parts, more);
    plot_note(to, joined(&parts));
}

char *plot_bob_name(const nevh_scene *s, size_t n) {
    const char *given = NULL;
    size_t parts = nevh_scene_part_count(s), bobs = 0;
    for (size_t i = 0; i < parts; i++) {
        nevh_scene_part part = nevh_scene_part_at(s, i);
        if (strcmp(part.kind, "bob") == 0 && bobs++ == n)
            given = part.name;
    }
    return given          ? text_print("%s", given)
           : bobs < 2     ? NULL
           : bobs < parts ? text_print("bob %zu", n + 1)
                          : text_print("body %zu", n + 1);
}

char *plot_scheme(const plan *p, const char *integrator) {
    const char *unit = nevh_scene_label(p->scene, "t");
    bool transformed;
    if (nevh_integrator_adaptive(plan_scheme(p, integrator, &transformed)) &&
        p->tolerances)
        return text_print("%s, tolerance %.4g", integrator, p->tolerance[0]);
    return text_print("%s, dt = %.4g%s%s", integrator, p->dt[0],
                      *unit ? " " : "", unit);
}

char *plot_energy_at_start(const plan *p) {
    nevh_options values = {.gradient_step = 1e-3, .portable = p->portable};
    nevh_field *f = nevh_field_new(p->system, &values);
    const char *unit = nevh_scene_label(p->scene, "energy");
    double t = p->run->t_start, energy;
    int status = nevh_field_value(f, 1, &t, p->q, p->p, &energy);
    nevh_field_free(f);
    return status ? text_print("%s", "")
                  : text_print("H = %.6g%s%s at the start", energy,
                               *unit ? " " : "", unit);
}
