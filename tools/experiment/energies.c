/* nevh: energies of effects and of bodies along a run, which the total energy
   may not show, against those along the reference: their means, so that a run
   that is late on the right orbit differs little.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "row.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Effects that are on, then bodies. */
struct energies {
    nevh_field *field; /* for values */
    size_t n, all, effects, bodies;
    size_t *effect; /* its number in the system */
    size_t *group;  /* n: the body of a coordinate; SIZE_MAX: of none */
    char **name;
    double *every;      /* energies of all effects */
    double *now, *then; /* energies along the run, and the reference */
    double *sum;        /* of their differences so far */
    double *size;       /* the largest |energy| along the reference */
    size_t compared;
};

static bool is_element(const plan *p, size_t k) {
    return strchr(nevh_scene_coordinate(p->scene, k), '[');
}

/* Elements of arrays with the same index make a body; with one alone there is
   nothing to be told apart. */
static void find_bodies(const plan *p, energies *s) {
    s->group = tool_allocate(p->n, sizeof *s->group);
    for (size_t k = 0; k < p->n; k++) {
        s->group[k] =
            is_element(p, k) ? k - nevh_scene_array(p->scene, k) : SIZE_MAX;
        if (is_element(p, k) && s->group[k] >= s->bodies)
            s->bodies = s->group[k] + 1;
    }
    if (s->bodies == 1)
        s->bodies = 0;
}

/* The name in [picture] of a body at one of its coordinates, or of the first of
   them. */
static char *name_of_body(const plan *p, const energies *s, size_t body) {
    const char *first = NULL;
    for (size_t k = 0; k < p->n; k++) {
        const char *own = nevh_scene_coordinate(p->scene, k);
        if (s->group[k] != body)
            continue;
        for (size_t i = 0; i < nevh_scene_part_count(p->scene); i++) {
            nevh_scene_part bob = nevh_scene_part_at(p->scene, i);
            if (bob.name && bob.count && strcmp(bob.item[0], own) == 0)
                return text_print("%s", bob.name);
        }
        first = first ? first : own;
    }
    return text_print("%s", first);
}

/* Finds the effects with terms, which friction has not; one alone is the energy. */
static void find_effects(const plan *p, energies *s) {
    s->all = nevh_system_effect_count(p->system);
    s->every = tool_allocate(s->all, sizeof *s->every);
    s->effect = tool_allocate(s->all, sizeof *s->effect);
    nevh_field_effects(s->field, p->run->t_start, p->q, p->p, s->every);
    for (size_t i = 0; i < s->all; i++)
        if (nevh_field_effect_values(s->field,
                                     nevh_system_effect_name(p->system, i)))
            s->effect[s->effects++] = i;
    if (s->effects == 1)
        s->effects = 0;
}

static void name_all(const plan *p, energies *s) {
    size_t count = s->effects + s->bodies;
    s->name = tool_allocate(count, sizeof *s->name);
    for (size_t i = 0; i < count; i++)
        s->name[i] =
            i < s->effects
                ? text_print("%s",
                             nevh_system_effect_name(p->system, s->effect[i]))
                : name_of_body(p, s, i - s->effects);
}

void plan_energies(plan *p) {
    energies *s = tool_allocate(1, sizeof *s);
    *s = (energies){.field = plan_values(p), .n = p->n};
    find_effects(p, s);
    find_bodies(p, s);
    name_all(p, s);
    size_t count = s->effects + s->bodies;
    s->now = tool_allocate(count, sizeof *s->now);
    s->then = tool_allocate(count, sizeof *s->then);
    s->sum = tool_allocate(count, sizeof *s->sum);
    s->size = tool_allocate(count, sizeof *s->size);
    p->energies = s;
}

void energies_free(energies *s) {
    if (!s)
        return;
    nevh_field_free(s->field);
}

void energies_begin(energies *s) {
    for (size_t i = 0; i < s->effects + s->bodies; i++)
        s->sum[i] = s->size[i] = 0;
    s->compared = 0;
}

static bool take(energies *s, double t, const double q[], const double p[],
                 double energy[]) {
    if (nevh_field_effects(s->field, t, q, p, s->every))
        return false;
    for (size_t i = 0; i < s->effects; i++)
        energy[i] = s->every[s->effect[i]];
    return !s->bodies || !nevh_field_groups(s->field, t, q, p, s->bodies,
                                            s->group, energy + s->effects);
}

void energies_compare(energies *s, double t, const double q[], const double p[],
                      const double reference[]) {
    bool known = take(s, t, reference, reference + s->n, s->then);
    bool finite = take(s, t, q, p, s->now);
    s->compared += known;
    for (size_t i = 0; known && i < s->effects + s->bodies; i++) {
        s->sum[i] += finite ? s->now[i] - s->then[i] : INFINITY;
        s->size[i] = fmax(s->size[i], fabs(s->then[i]));
    }
}

double *energies_result(const energies *s) {
    size_t count = s->effects + s->bodies;
    double *error = tool_allocate(count, sizeof *error);
    for (size_t i = 0; i < count; i++)
        error[i] = s->size[i] > 0
                       ? fabs(s->sum[i]) / (double)s->compared / s->size[i]
                       : NAN;
    return error;
}

/* The largest of the errors from `first` on; `end`: none is known. */
static size_t worst(const double error[], size_t first, size_t end) {
    size_t found = end;
    for (size_t i = first; i < end; i++)
        if (!isnan(error[i]) && (found == end || error[i] > error[found]))
            found = i;
    return found;
}

void energies_columns(table *t, const plan *p, bool is_table) {
    const energies *s = p->energies;
    for (size_t i = 0; s && i < s->effects; i++)
        table_column(t,
                     text_print(is_table ? "energy of\n%s" : "energy_error_%s",
                                s->name[i]));
    if (s && s->bodies) {
        table_column(t, is_table ? "energy of\na body" : "body_energy_error");
        table_column(t, is_table ? "which\nbody" : "worst_body");
    }
}

void energies_put(table *t, const plan *p, const row *r, bool is_table) {
    const energies *s = p->energies;
    void (*put)(table *, double) = is_table ? table_error : table_number;
    for (size_t i = 0; s && i < s->effects; i++)
        put(t, r->energies ? r->energies[i] : NAN);
    if (!s || !s->bodies)
        return;
    size_t end = s->effects + s->bodies;
    size_t at = r->energies ? worst(r->energies, s->effects, end) : end;
    put(t, at < end ? r->energies[at] : NAN);
    table_text(t, at < end ? s->name[at] : NULL);
}

void energies_notes(const plan *p, list *notes) {
    if (!p->energies || !(p->energies->effects + p->energies->bodies))
        return;
    list_add(notes,
             "energy of an effect: how far its mean over the run is from "
             "that of the reference, divided by its own largest size");
    if (p->energies->bodies)
        list_add(notes, "energy of a body: the same of all that reads "
                        "coordinates or momenta with its index");
}

char *energies_unseen(const plan *p, const row *r) {
    static const double large = 0.1, unseen = 0.1;
    const energies *s = p->energies;
    if (!s || !r->energies)
        return NULL;
    size_t end = s->effects + s->bodies, at = worst(r->energies, 0, end);
    if (at == end || !(r->energies[at] > large) ||
        !(r->energy.max < unseen * r->energies[at]))
        return NULL;
    return text_print("The energy of %s is off by %.2g %% of its size in the "
                      "mean over the run, where the total energy is off by "
                      "%.2g %% at most.",
                      s->name[at], 100 * r->energies[at], 100 * r->energy.max);
}

void energies_words(const plan *p, const row rows[], size_t count,
                    list *words) {
    for (size_t i = 0; i < count; i++) {
        char *unseen = energies_unseen(p, &rows[i]);
        if (!unseen)
            continue;
        char *text = text_print("%s at dt = %.4g: %s", rows[i].integrator,
                                rows[i].dt, unseen);
        if (!list_has(words, text)) /* another gradient may find the same */
            list_add(words, text);
    }
}
