/* nevh tests: any bytes are a scene, or a message with a place.  What is
   written of a scene is that scene.  Bytes after a 0 assign to a parameter.
   SPDX-License-Identifier: GPL-3.0-or-later

   For libFuzzer; see run.sh. */
#include "fuzz.h"
#include <nevh/nevh.h>
#include <nevh/scene.h>

enum { MOST = 64 };

static bool same_numbers(const double a[], const double b[], size_t count) {
    for (size_t i = 0; i < count; i++)
        if (a[i] != b[i] && (a[i] == a[i] || b[i] == b[i]))
            return false;
    return true;
}

/* A few steps from where the scene begins. */
static void step(nevh_scene *s) {
    double q[MOST], p[MOST];
    if (nevh_scene_dof(s) > MOST || nevh_scene_start(s, q, p))
        return;
    nevh_options o = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_stepper *stepper =
        nevh_stepper_new(nevh_scene_system(s), nevh_midpoint, &o);
    int status = nevh_run(stepper, 0, 1e-3, 3, q, p, NULL, 0);
    for (size_t k = 0; !status && k < nevh_scene_dof(s); k++)
        insist(q[k] - q[k] == 0 && p[k] - p[k] == 0);
    insist(!status || *nevh_stepper_message(stepper));
    nevh_stepper_free(stepper);
}

/* All that formulas give at a state, in the order of the scene. */
typedef struct {
    double *number;
    size_t count;
} numbers;

static double *more(numbers *all, size_t count) {
    all->number =
        realloc(all->number, (all->count + count + 1) * sizeof *all->number);
    insist(all->number != NULL);
    double *from = all->number + all->count;
    for (size_t i = 0; i < count; i++)
        from[i] = -7;
    all->count += count;
    return from;
}

/* A status, which is a number like others; what failed says why. */
static void note(numbers *all, const nevh_scene *s, int status) {
    insist(!status || *nevh_scene_message(s));
    *more(all, 1) = status;
}

static void take_sections(numbers *all, nevh_scene *s, const double state[]) {
    size_t n = nevh_scene_dof(s);
    for (size_t i = 0; i < nevh_scene_section_count(s); i++) {
        const nevh_scene_section *one = nevh_scene_section_at(s, i);
        double *direction = more(all, 3);
        direction[0] = one->direction;
        direction[1] = one->every;
        direction[2] = one->period;
        note(all, s,
             nevh_scene_section_cross(s, i, 0.5, state, state + n,
                                      more(all, 1)));
        note(all, s,
             nevh_scene_section_items(s, i, 0.5, state, state + n,
                                      more(all, one->items)));
    }
    insist(nevh_scene_section_at(s, nevh_scene_section_count(s)) == NULL);
}

static void take_picture(numbers *all, nevh_scene *s, const double state[]) {
    size_t n = nevh_scene_dof(s);
    for (size_t i = 0; i < nevh_scene_part_count(s); i++) {
        nevh_scene_part part = nevh_scene_part_at(s, i);
        insist(part.kind != NULL);
        note(all, s,
             nevh_scene_part_values(s, i, 0.5, state, state + n,
                                    more(all, part.count)));
    }
}

static void take_shown(numbers *all, nevh_scene *s, nevh_shown which,
                       const double state[]) {
    size_t count = nevh_scene_shown_count(s, which);
    note(all, s,
         nevh_scene_shown_values(s, which, 0.5, state,
                                 state + nevh_scene_dof(s), more(all, count)));
}

static void take_stop(numbers *all, nevh_scene *s, const double state[]) {
    bool reached = false;
    note(all, s,
         nevh_scene_stop_reached(s, 0.5, state, state + nevh_scene_dof(s),
                                 &reached));
    *more(all, 1) = reached;
}

/* At the start, or, where there is none, at some state. */
static numbers all_of(nevh_scene *s) {
    numbers all = {0};
    size_t n = nevh_scene_dof(s);
    double state[2 * MOST] = {0.3, 0.5, -0.2};
    note(&all, s, nevh_scene_start(s, state, state + n));
    memcpy(more(&all, 2 * n), state, 2 * n * sizeof *state);
    for (size_t k = 0; k < n; k++)
        *more(&all, 1) = nevh_scene_period(s, k);
    take_shown(&all, s, NEVH_OBSERVABLES, state);
    take_shown(&all, s, NEVH_INVARIANTS, state);
    take_sections(&all, s, state);
    take_picture(&all, s, state);
    take_stop(&all, s, state);
    return all;
}

static void insist_on_effects(const nevh_system *a, const nevh_system *b) {
    insist(nevh_system_traits(a) == nevh_system_traits(b));
    insist(nevh_system_effect_count(a) == nevh_system_effect_count(b));
    for (size_t i = 0; i < nevh_system_effect_count(a); i++) {
        const char *name = nevh_system_effect_name(a, i);
        insist(!strcmp(name, nevh_system_effect_name(b, i)));
        insist(nevh_system_effect_on(a, name) ==
               nevh_system_effect_on(b, name));
    }
}

static void insist_on_names(const nevh_scene *a, const nevh_scene *b,
                            nevh_shown which) {
    insist(nevh_scene_shown_count(a, which) ==
           nevh_scene_shown_count(b, which));
    for (size_t i = 0; i < nevh_scene_shown_count(a, which); i++)
        insist(!strcmp(nevh_scene_shown_name(a, which, i),
                       nevh_scene_shown_name(b, which, i)));
}

static void insist_on_same(nevh_scene *a, nevh_scene *b) {
    insist(nevh_scene_dof(a) == nevh_scene_dof(b));
    insist_on_effects(nevh_scene_system(a), nevh_scene_system(b));
    insist_on_names(a, b, NEVH_OBSERVABLES);
    insist_on_names(a, b, NEVH_INVARIANTS);
    insist((nevh_scene_transform(a) == NULL) ==
           (nevh_scene_transform(b) == NULL));
    if (nevh_scene_dof(a) > MOST)
        return;
    numbers x = all_of(a), y = all_of(b);
    insist(x.count == y.count && same_numbers(x.number, y.number, x.count));
    free(x.number);
    free(y.number);
}

static void write_and_read(nevh_scene *s) {
    char *text = nevh_scene_write(s, NULL);
    insist(text != NULL);
    nevh_scene *copy = nevh_scene_parse("written", text);
    if (nevh_scene_status(copy))
        printf("%s\n%s\n", nevh_scene_message(copy), text);
    insist(!nevh_scene_status(copy));
    insist_on_same(s, copy);
    char *again = nevh_scene_write(copy, NULL);
    insist(!strcmp(text, again));
    free(again);
    free(text);
    nevh_scene_free(copy);
}

static void change(nevh_scene *s, const char *assignment) {
    const nevh_system *system = nevh_scene_system(s);
    if (system && nevh_system_effect_count(system)) {
        char name[256];
        snprintf(name, sizeof name, "%s", nevh_system_effect_name(system, 0));
        nevh_scene_enable(s, name, !nevh_system_effect_on(system, name));
    }
    int status = nevh_scene_set(s, assignment);
    insist(!status || *nevh_scene_message(s));
    nevh_scene_set(s, "m = 2/g");
    nevh_scene_enable(s, "gravity", false);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    char *text = fuzz_text(bytes, size);
    size_t length = strlen(text);
    nevh_scene *s = nevh_scene_parse("f", text);
    int status = nevh_scene_status(s);
    insist(!status || strstr(nevh_scene_message(s), ": error: ") != NULL ||
           status == NEVH_ENOMEM);
    insist((status != 0) == (nevh_scene_system(s) == NULL));
    if (!status) {
        step(s);
        write_and_read(s);
    }
    change(s, length < size ? text + length + 1 : "g = 1");
    if (!status)
        write_and_read(s);
    nevh_scene_free(s);
    free(text);
    return 0;
}
