/* nevh: whether what the scene calls invariants is conserved.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "conserved.h"
#include "row.h"
#include <math.h>
#include <stdlib.h>

enum { MOST_STEPS = 2000, MOST_GRADIENTS = 1000000 };

/* Steps of dt may be many of dop853's. */
static int stop_costly(void *data, size_t step, double t, const double q[],
                       const double p[]) {
    const nevh_stepper *s = data;
    (void)step, (void)t, (void)q, (void)p;
    return nevh_stepper_counts(s).gradients > MOST_GRADIENTS;
}

/* With exact gradients, where there are such: noise of differences above the tolerance
   would ask for up to a million substeps a step. */
static nevh_stepper *stepper_of(const plan *p) {
    char exact[] = "exact", *item[] = {exact};
    plan with = *p;
    with.gradients = (list){.item = item, .count = 1};
    nevh_stepper *s = plan_stepper(&with, "dop853");
    if (nevh_stepper_status(s) != NEVH_ENOGRAD)
        return s;
    nevh_stepper_free(s);
    return plan_stepper(p, "dop853");
}

/* Their largest changes on an orbit by dop853; NULL: it fails, or costs too much. */
static double *changes(const plan *p, double t_end, double tolerance) {
    plan trial = *p;
    double stopped;
    trial.t_end = t_end;
    trial.tolerance = &tolerance;
    trial.tolerances = 1;
    trial.native = NEVH_NATIVE_NEVER;
    nevh_stepper *s = stepper_of(&trial);
    invariants *kept = invariants_new(&trial);
    nevh_observer observers[] = {{invariants_observe, kept, 1},
                                 {stop_costly, s, 1}};
    bool good = !nevh_stepper_status(s) &&
                !plan_run(&trial, s, p->dt[0], observers, 2, &stopped);
    double *change = invariants_result(kept);
    nevh_stepper_free(s);
    return good ? change : NULL;
}

/* Measures the size of invariants at states near the start; out, `count`. A change
   far below it is rounding. */
static bool measure(const plan *p, size_t count, double size[]) {
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_probe *probe = nevh_probe_new(p->system, &o);
    double *state = tool_allocate(2 * p->n + count, sizeof *state);
    double *now = state + 2 * p->n;
    bool good = !nevh_probe_status(probe);
    for (int side = 0; good && side < 4; side++) {
        const double *length = nevh_probe_lengths(probe);
        for (size_t k = 0; k < 2 * p->n; k++) {
            double start = k < p->n ? p->q[k] : p->p[k - p->n];
            double sign = (side + k) % 2 ? 1 : -0.5;
            state[k] = start + (side ? sign * length[k] : 0) / 4;
        }
        if (nevh_scene_shown_values(p->scene, NEVH_INVARIANTS, p->run->t_start,
                                    state, state + p->n, now))
            continue;
        for (size_t i = 0; i < count; i++)
            size[i] = isfinite(now[i]) ? fmax(size[i], fabs(now[i])) : size[i];
    }
    nevh_probe_free(probe);
    return good;
}

/* returns  whether it is known */
static bool changed_notes(const plan *p, list *notes, bool *followed) {
    static const double coarse = 1e-7, fine = 1e-11, rounding = 1e-9;
    size_t count = nevh_scene_shown_count(p->scene, NEVH_INVARIANTS);
    double most = p->run->t_start + MOST_STEPS * p->dt[0];
    double t_end = fmin(p->t_end, most);
    double *size = tool_allocate(count, sizeof *size);
    double *one = changes(p, t_end, coarse), *two = changes(p, t_end, fine);
    *followed = one && two;
    bool known = one && two && measure(p, count, size);
    for (size_t i = 0; known && i < count; i++)
        if (two[i] > 0.5 * one[i] && two[i] > rounding * size[i])
            list_print(notes,
                       "%s of [invariants] is not conserved: it changes by "
                       "%.3g until t = %.4g%s, and by %.3g where errors of "
                       "steps are 10000 times smaller.",
                       nevh_scene_shown_name(p->scene, NEVH_INVARIANTS, i),
                       one[i], t_end, p->unit, two[i]);
    return known;
}

void conserved_warn(const plan *p, list *notes) {
    bool followed;
    if (nevh_scene_shown_count(p->scene, NEVH_INVARIANTS))
        changed_notes(p, notes, &followed);
}

void conserved_words(const plan *p, list *notes) {
    bool followed;
    if (nevh_scene_shown_count(p->scene, NEVH_INVARIANTS) &&
        !changed_notes(p, notes, &followed))
        list_add(notes, followed ? "[invariants] were not checked: their sizes "
                                   "near the start are not known."
                                 : "[invariants] were not checked: dop853 "
                                   "does not follow this orbit, or not with "
                                   "so little work.");
}
