/* nevh: steps that are too long for some place of the orbit.

   Each scheme takes a few of its own steps from states of the orbit itself, and over the
   place where the orbit is fastest.  An energy error that it makes there is one that the
   run makes when it comes by.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "warnings.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 16, MOST_NAMES = 64 };
static const double large = 0.1; /* of the energy's scale */

/* Data that all trials use. */
typedef struct {
    const plan *plan;
    const trial_run *ahead;
    nevh_stepper *orbit; /* for the way to a first state */
    double scale;        /* of the energy */
    double *z;           /* 2n */
    double *reached; /* for each place: the largest |H| of those until then */
} passages;

/* The energies are those of the start, and these 0, where no drive changes H. */
static void find_reached(passages *w) {
    const trial_run *ahead = w->ahead;
    w->reached = tool_allocate(ahead->places, sizeof *w->reached);
    nevh_field *field = plan_values(w->plan);
    for (size_t k = 0; w->plan->time && k < ahead->places; k++) {
        const trial_place *at = &ahead->place[k];
        double h = 0;
        nevh_field_value(field, 1, &at->t, at->z, at->z + w->plan->n, &h);
        for (size_t i = 0; i < ahead->places; i++)
            if (ahead->place[i].t >= at->t && isfinite(h))
                w->reached[i] = fmax(w->reached[i], fabs(h));
    }
    nevh_field_free(field);
}

/* The state half the steps before the last place, at a whole number of steps from the
   start, as the run has it; other places as they are.
   t   out: its time
   returns  false: it was not reached */
static bool begin(const passages *w, size_t place, double reach, double *t) {
    const plan *p = w->plan;
    const trial_place *from = &w->ahead->place[place];
    double start = p->run->t_start;
    memcpy(w->z, from->z, 2 * p->n * sizeof *w->z);
    *t = from->t;
    if (place + 1 < w->ahead->places)
        return true;
    double dt = reach / STEPS,
           steps = floor((from->t - start) / dt) - STEPS / 2;
    *t = start + fmax(0, steps) * dt;
    return *t == from->t || !nevh_stepper_apply(w->orbit, from->t, *t - from->t,
                                                w->z, w->z + p->n);
}

/* The largest energy error of steps of dt from there, for as long as `reach`; INFINITY
   where one fails. */
static double error_at(const passages *w, const row *r, double dt, double reach,
                       size_t place) {
    const plan *p = w->plan;
    double t, error = 0;
    if (!begin(w, place, reach, &t))
        return 0;
    double end = p->run->t_start + w->ahead->length;
    double left = fmin(reach, end - t), *q = w->z, *m = w->z + p->n;
    size_t steps = (size_t)fmax(0, floor(left / dt * (1 + 1e-9)));
    nevh_stepper *s = row_stepper(p, r, p->balance);
    nevh_energy *energy = row_energy_unscaled(p, r, s);
    nevh_energy_set_scale(energy, fmax(w->scale, w->reached[place]));
    int status = nevh_stepper_status(s);
    if (!status && steps > 0) {
        status = nevh_run(s, t, dt, steps, q, m,
                          &(nevh_observer){nevh_energy_observe, energy, 1}, 1);
        error = status ? INFINITY : nevh_energy_result(energy, 0).max;
    }
    nevh_energy_free(energy);
    row_stepper_keep(p, r, p->balance, s);
    return error;
}

/* The worst of all places; `reach` as of error_at.
   place  out: the fastest one, if its error is large; else the first that is so, else the
          worst */
static double worst(const passages *w, const row *r, double dt, double reach,
                    size_t *place) {
    double most = 0;
    for (size_t k = w->ahead->places; k-- > 0;) {
        double error = error_at(w, r, dt, reach, k);
        if (error > most && !(most > large))
            *place = k;
        most = fmax(most, error);
    }
    return most;
}

/* Steps of one length that schemes have in common. */
typedef struct {
    const row *row[MOST_NAMES];
    size_t count, place; /* place: the worst of the first row */
    list names;
} group;

/* The first of halved steps with which all keep small errors; 0: none tried. */
static double step_that_resolves(const passages *w, const group *g) {
    enum { HALVINGS = 8 };
    static const double small = 0.01;
    double dt = g->row[0]->dt, reach = STEPS * dt;
    size_t i = 0, place;
    for (int k = 0; k < HALVINGS && i < g->count; k++) {
        dt /= 2;
        for (i = 0; i < g->count; i++)
            if (!(worst(w, g->row[i], dt, reach, &place) < small))
                break;
    }
    return i == g->count ? dt : 0;
}

/* Names the value at fault: a drive that is faster than the motion, or the motion where
   it is fastest; else the place alone. */
static char *fault(const passages *w, const group *g) {
    const plan *p = w->plan;
    const trial_run *ahead = w->ahead;
    double dt = g->row[0]->dt, t = ahead->place[g->place].t;
    if (ahead->drive > ahead->rate)
        return text_print("%s changes with time at omega = %.3g%s, in %.2g "
                          "steps a period",
                          ahead->driver, ahead->drive, p->per_unit,
                          2 * M_PI / (ahead->drive * dt));
    return text_print("the orbit changes at a rate of %s%.3g%s %s t = %.4g%s, "
                      "rate dt = %.3g",
                      g->place + 1 == ahead->places ? "" : "up to ",
                      ahead->rate, p->per_unit,
                      g->place + 1 == ahead->places ? "near" : "after", t,
                      p->unit, ahead->rate * dt);
}

static void warn(const passages *w, const group *g, list *words) {
    const plan *p = w->plan;
    double dt = step_that_resolves(w, g);
    char *advice =
        dt > 0 ? text_print("; dt = %.3g%s keeps it below 1 %%", dt, p->unit)
               : text_print("%s", "");
    list_print(words,
               "dt = %.4g%s is too long for %s: %s; the energy error of %d "
               "steps on the orbit is above 10 %%%s",
               g->row[0]->dt, p->unit, list_joined(&g->names), fault(w, g),
               STEPS, advice);
}

static bool is_tried(const plan *p, const row *r) {
    return r->tolerance == 0 && !nevh_integrator_own_time(r->scheme) &&
           !plan_transform(p, r->integrator) &&
           (!r->ran ||
            (r->energy.max > large && r->energy.verdict != NEVH_UNSTABLE));
}

/* All rows of one gradient and dt from the first on. */
static group group_of(const passages *w, const row rows[], size_t count,
                      size_t first) {
    group g = {0};
    for (size_t i = first; i < count && g.count < MOST_NAMES; i++) {
        size_t place = 0;
        const row *r = &rows[i];
        if (r->group != rows[first].group || !is_tried(w->plan, r) ||
            !(worst(w, r, r->dt, STEPS * r->dt, &place) > large))
            continue;
        g.place = g.count ? g.place : place;
        g.row[g.count++] = r;
        list_add(&g.names, r->integrator);
    }
    return g;
}

static void warn_of(const plan *p, const trial_run *ahead, const row rows[],
                    size_t count, list *found) {
    static const double tolerance = 1e-10;
    nevh_options o = plan_options(p, "exact");
    o.gradient_step = 0;
    o.tolerance = tolerance;
    passages w = {.plan = p,
                  .ahead = ahead,
                  .orbit = nevh_stepper_new(p->system, nevh_dop853, &o),
                  .scale = plan_energy_scale(p),
                  .z = tool_allocate(2 * p->n, sizeof *w.z)};
    bool known = !nevh_stepper_status(w.orbit) && !ahead->failure;
    find_reached(&w);
    for (size_t i = 0; known && i < count; i++) {
        if (i > 0 && rows[i].group == rows[i - 1].group)
            continue;
        group g = group_of(&w, rows, count, i);
        if (g.count)
            warn(&w, &g, found);
    }
    nevh_stepper_free(w.orbit);
}

static void passage_warnings(const plan *p, const trial_run *ahead,
                             const row rows[], size_t count, list *found) {
    trial_run own;
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any = any || is_tried(p, &rows[i]);
    if (!any)
        return;
    if (!ahead)
        own = trial_run_new(p, false);
    warn_of(p, ahead ? ahead : &own, rows, count, found);
}

list warnings_of(const plan *p, const trial_run *ahead, const row rows[],
                 size_t count) {
    list found = {0};
    passage_warnings(p, ahead, rows, count, &found);
    saddle_warnings(p, rows, count, &found);
    return found;
}

void warnings_words(const plan *p, const trial_run *ahead, const row rows[],
                    size_t count, list *words) {
    list found = warnings_of(p, ahead, rows, count);
    for (size_t i = 0; i < found.count; i++)
        list_print(words, "Warning: %s.", found.item[i]);
}
