/* nevh report: choice of the orbits of the animation.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "animation_private.h"
#include "experiment/row.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Changes of the energy: `seen` is visible; above `lost` rk4 has left the orbit;
   below `kept` the other scheme keeps it. */
static const double seen = 0.15, lost = 1, kept = 0.1;
enum { MOST_FRAMES = 400, FEWEST_FRAMES = 60, BYTES_A_NUMBER = 5 };

typedef struct {
    const animation *animation;
    nevh_energy *energy;
    recording *recording;
} recorder;

static bool is_rod(nevh_scene_part part) {
    return strcmp(part.kind, "rod") == 0;
}

/* Rods first; NANs where formulas have no value. */
static void place(const animation *f, double t, const double q[],
                  const double p[], double to[]) {
    nevh_scene *s = f->plan->scene;
    size_t rod = 0, bob = 4 * f->rods;
    for (size_t i = 0; i < nevh_scene_part_count(s); i++) {
        nevh_scene_part part = nevh_scene_part_at(s, i);
        double values[4] = {NAN, NAN, NAN, NAN};
        size_t count = is_rod(part) ? 4 : 2, *at = is_rod(part) ? &rod : &bob;
        nevh_scene_part_values(s, i, t, q, p, values);
        memcpy(to + *at, values, count * sizeof *to);
        *at += count;
    }
}

static int record_state(void *data, size_t step, double t, const double q[],
                        const double p[]) {
    recorder *c = data;
    recording *r = c->recording;
    double *to = r->place + r->frames * r->columns;
    (void)step;
    if (r->frames > c->animation->most)
        return NEVH_STOPPED;
    place(c->animation, t, q, p, to);
    for (size_t k = 0; k < r->columns; k++)
        if (!isfinite(to[k]))
            return NEVH_STOPPED;
    r->error[r->frames++] = nevh_energy_error(c->energy, 0);
    return NEVH_OK;
}

static recording recording_new(const animation *f, const char *integrator) {
    recording r = {.integrator = integrator,
                   .columns = 4 * f->rods + 2 * f->bobs};
    r.place = tool_allocate((f->most + 1) * r.columns, sizeof *r.place);
    r.error = tool_allocate(f->most + 1, sizeof *r.error);
    return r;
}

static void run(const animation *f, nevh_stepper *s, recorder *c) {
    const plan *p = f->plan;
    double *q = plan_state(p), start = p->run->t_start;
    nevh_observer observers[] = {{nevh_energy_observe, c->energy, 1},
                                 {record_state, c, 1}};
    nevh_run_until(s, start, f->dt, start + (double)f->most * f->dt, q,
                   q + p->n, observers, 2);
}

/* Records a run, without frames if the scheme does not fit. */
static recording record(const animation *f, const char *integrator) {
    const plan *p = f->plan;
    bool transformed;
    row as = {.integrator = integrator,
              .gradient = p->gradients.item[0],
              .scheme = plan_scheme(p, integrator, &transformed),
              .dt = f->dt};
    recording r = recording_new(f, integrator);
    nevh_stepper *s = row_stepper(p, &as, p->balance);
    if (!nevh_stepper_status(s)) {
        recorder c = {f, row_energy(p, &as, s), &r};
        run(f, s, &c);
        nevh_energy_free(c.energy);
    }
    row_stepper_keep(p, &as, p->balance, s);
    return r;
}

static double worst(const recording *r) {
    double most = 0;
    for (size_t i = 0; i < r->frames; i++)
        most = fmax(most, fabs(r->error[i]));
    return most;
}

/* True if both run to the end, and rk4 has lost or gained energy that the other
   keeps. */
static bool shows_drift(const animation *f) {
    const recording *other = &f->recording[0], *rk4 = &f->recording[1];
    if (other->frames <= f->most || rk4->frames <= f->most)
        return false;
    double change = fabs(rk4->error[f->most]);
    return change >= seen && worst(rk4) <= lost && worst(other) < kept &&
           2 * worst(other) < change;
}

/* Rounds to three digits, as in commands printed. */
static double rounded(double dt) {
    char text[32];
    snprintf(text, sizeof text, "%.3g", dt);
    return strtod(text, NULL);
}

static void record_both(animation *f, const char *integrator, double dt) {
    f->dt = dt;
    f->recording[0] = record(f, integrator);
    f->recording[1] = record(f, "rk4");
}

static bool is_fit(const plan *p, const char *name) {
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, name, &transformed);
    return !transformed && !nevh_integrator_adaptive(scheme) &&
           !nevh_integrator_own_time(scheme) &&
           nevh_integrator_symplectic(scheme) == NEVH_YES && p->dts > 0;
}

static bool tries_step(animation *f, const char *integrator, double dt) {
    record_both(f, integrator, rounded(dt));
    return f->shows_drift = shows_drift(f);
}

static bool is_lost(const animation *f) {
    return f->recording[1].frames <= f->most || worst(&f->recording[1]) > lost;
}

/* Finds the shortest step, from dt on, that shows the drift of rk4.  If rk4 leaves
   the orbit from one step to the next, steps between them are tried.
   fits  out: true if the scheme takes steps */
static bool find_step(animation *f, const char *name, double dt, bool *fits) {
    enum { STEPS = 13, BETWEEN = 4 };
    const double factor = sqrt(2), little = pow(2, 0.5 / BETWEEN);
    bool before = true;
    for (int k = 0; k < STEPS; k++, dt *= factor) {
        if (tries_step(f, name, dt))
            return true;
        bool gone = is_lost(f), between = gone && !before;
        *fits |= f->recording[0].frames > 0;
        for (int j = 1; between && j < BETWEEN; j++)
            if (tries_step(f, name, dt / factor * pow(little, j)))
                return true;
        before = gone;
    }
    return false;
}

/* Chooses the first scheme, and the shortest step, that show the drift; else the
   scene's.
   returns  true if the errors of the scheme leave it on its orbit */
static bool choose(animation *f) {
    const plan *p = f->plan;
    const char *first = NULL;
    double dt = 0;
    for (size_t i = 0; i < p->dts; i++)
        dt = fmax(dt, p->dt[i]);
    for (size_t i = 0; i < p->integrators.count; i++) {
        const char *name = p->integrators.item[i];
        bool fits = false;
        if (is_fit(p, name) && find_step(f, name, dt, &fits))
            return true;
        first = !first && fits ? name : first;
    }
    if (!first)
        return false;
    record_both(f, first, rounded(dt));
    return worst(&f->recording[0]) < seen;
}

bool animation_make(animation *f, plan *p, size_t bytes) {
    *f = (animation){.plan = p};
    size_t parts = nevh_scene_part_count(p->scene);
    for (size_t i = 0; i < parts; i++)
        if (is_rod(nevh_scene_part_at(p->scene, i)))
            f->rods++;
        else
            f->bobs++;
    size_t frame = 2 * BYTES_A_NUMBER * (4 * f->rods + 2 * f->bobs);
    f->most =
        frame && bytes / frame < MOST_FRAMES ? bytes / frame : MOST_FRAMES;
    if (!parts || f->most < FEWEST_FRAMES || p->friction)
        return false;
    return choose(f) && f->recording[0].frames > 1 &&
           f->recording[1].frames > 1;
}
