/* nevh report: which orbits a moving picture shows.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "film_private.h"
#include "experiment/row.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Changes of the energy: `seen` is visible; above `lost` rk4 has left the orbit;
   below `kept` the other scheme keeps it. */
static const double seen = 0.15, lost = 1, kept = 0.1;
enum { MOST_FRAMES = 400, FEWEST_FRAMES = 60, BYTES_A_NUMBER = 5 };

typedef struct {
    const film *film;
    nevh_energy *energy;
    reel *reel;
} camera;

static bool is_rod(nevh_scene_part part) {
    return strcmp(part.kind, "rod") == 0;
}

/* Rods first; NANs where formulas have no value. */
static void place(const film *f, double t, const double q[], const double p[],
                  double to[]) {
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

static int film_state(void *data, size_t step, double t, const double q[],
                      const double p[]) {
    camera *c = data;
    reel *r = c->reel;
    double *to = r->place + r->frames * r->columns;
    (void)step;
    if (r->frames > c->film->most)
        return NEVH_STOPPED;
    place(c->film, t, q, p, to);
    for (size_t k = 0; k < r->columns; k++)
        if (!isfinite(to[k]))
            return NEVH_STOPPED;
    r->error[r->frames++] = nevh_energy_error(c->energy, 0);
    return NEVH_OK;
}

static reel reel_new(const film *f, const char *integrator) {
    reel r = {.integrator = integrator, .columns = 4 * f->rods + 2 * f->bobs};
    r.place = tool_allocate((f->most + 1) * r.columns, sizeof *r.place);
    r.error = tool_allocate(f->most + 1, sizeof *r.error);
    return r;
}

static void reel_free(reel *r) {
    free(r->place);
    free(r->error);
}

static void run(const film *f, nevh_stepper *s, camera *c) {
    const plan *p = f->plan;
    double *q = tool_allocate(2 * p->n, sizeof *q), start = p->run->t_start;
    memcpy(q, p->q, p->n * sizeof *q);
    memcpy(q + p->n, p->p, p->n * sizeof *q);
    nevh_observer observers[] = {{nevh_energy_observe, c->energy, 1},
                                 {film_state, c, 1}};
    nevh_run_until(s, start, f->dt, start + (double)f->most * f->dt, q,
                   q + p->n, observers, 2);
    free(q);
}

/* Without frames where the scheme does not fit. */
static reel shoot(const film *f, const char *integrator) {
    const plan *p = f->plan;
    bool transformed;
    row as = {.integrator = integrator,
              .gradient = p->gradients.item[0],
              .scheme = plan_scheme(p, integrator, &transformed),
              .dt = f->dt};
    reel r = reel_new(f, integrator);
    nevh_stepper *s = row_stepper(p, &as, p->balance);
    if (!nevh_stepper_status(s)) {
        camera c = {f, row_energy(p, &as, s), &r};
        run(f, s, &c);
        nevh_energy_free(c.energy);
    }
    row_stepper_keep(p, &as, p->balance, s);
    return r;
}

static double worst(const reel *r) {
    double most = 0;
    for (size_t i = 0; i < r->frames; i++)
        most = fmax(most, fabs(r->error[i]));
    return most;
}

/* True if both run to the end, and rk4 has lost or gained energy that the other
   keeps. */
static bool is_telling(const film *f) {
    const reel *other = &f->reel[0], *rk4 = &f->reel[1];
    if (other->frames <= f->most || rk4->frames <= f->most)
        return false;
    double change = fabs(rk4->error[f->most]);
    return change >= seen && worst(rk4) <= lost && worst(other) < kept &&
           2 * worst(other) < change;
}

/* With three digits, as commands take it. */
static double rounded(double dt) {
    char text[32];
    snprintf(text, sizeof text, "%.3g", dt);
    return strtod(text, NULL);
}

static void shoot_both(film *f, const char *integrator, double dt) {
    f->dt = dt;
    reel_free(&f->reel[0]);
    reel_free(&f->reel[1]);
    f->reel[0] = shoot(f, integrator);
    f->reel[1] = shoot(f, "rk4");
}

static bool is_fit(const plan *p, const char *name) {
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, name, &transformed);
    return !transformed && !nevh_integrator_adaptive(scheme) &&
           !nevh_integrator_own_time(scheme) &&
           nevh_integrator_symplectic(scheme) == NEVH_YES && p->dts > 0;
}

static bool tells(film *f, const char *integrator, double dt) {
    shoot_both(f, integrator, rounded(dt));
    return f->tells = is_telling(f);
}

static bool is_lost(const film *f) {
    return f->reel[1].frames <= f->most || worst(&f->reel[1]) > lost;
}

/* The shortest step that tells, from dt on.  Where rk4 is lost from one step to
   the next, some between them are tried.
   fits  out, if so: the scheme takes steps */
static bool find_step(film *f, const char *name, double dt, bool *fits) {
    enum { STEPS = 13, BETWEEN = 4 };
    const double factor = sqrt(2), little = pow(2, 0.5 / BETWEEN);
    bool before = true;
    for (int k = 0; k < STEPS; k++, dt *= factor) {
        if (tells(f, name, dt))
            return true;
        bool gone = is_lost(f), between = gone && !before;
        *fits |= f->reel[0].frames > 0;
        for (int j = 1; between && j < BETWEEN; j++)
            if (tells(f, name, dt / factor * pow(little, j)))
                return true;
        before = gone;
    }
    return false;
}

/* The first scheme, and the shortest step, that tell; else the scene's.
   returns  whether its errors leave an orbit to be seen */
static bool choose(film *f) {
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
    shoot_both(f, first, rounded(dt));
    return worst(&f->reel[0]) < seen;
}

bool film_make(film *f, plan *p, size_t bytes) {
    *f = (film){.plan = p};
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
    return choose(f) && f->reel[0].frames > 1 && f->reel[1].frames > 1;
}

void film_free(film *f) {
    reel_free(&f->reel[0]);
    reel_free(&f->reel[1]);
}
