/* nevh tests: hard cases: a case made ready, and what its orbit is like.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard_judge.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 200 };
static const double most_work = 1e6;

nevh_scene *hard_scene(const char *name) {
    char *file = scene_file(name);
    nevh_scene *scene = file ? nevh_scene_read(file) : NULL;
    tool_release(file);
    return scene;
}

static int change(nevh_scene *scene, const char *settings) {
    char *copy = text_print("%s", settings), *rest = copy;
    int status = NEVH_OK;
    for (char *one; !status && (one = strsep(&rest, ";"));)
        status = nevh_scene_set(scene, one + strspn(one, " "));
    tool_release(copy);
    return status;
}

static int open_scene(hard_subject *s) {
    const hard_case *c = &s->known.given;
    s->scene = hard_scene(c->scene);
    if (!s->scene)
        return tool_refuse("scene %s of the hard cases not found", c->scene);
    if (!nevh_scene_status(s->scene) && c->settings)
        change(s->scene, c->settings);
    if (nevh_scene_status(s->scene))
        return tool_refuse("%s", nevh_scene_message(s->scene));
    const nevh_scene_run *run = nevh_scene_run_settings(s->scene);
    s->system = nevh_scene_system(s->scene);
    s->t = run->t_start;
    s->dt = run->dt[0];
    s->t_end = run->t_end;
    if ((c->dt && nevh_scene_number(s->scene, c->dt, &s->dt)) ||
        (c->t_end && nevh_scene_number(s->scene, c->t_end, &s->t_end)))
        return tool_refuse("%s", nevh_scene_message(s->scene));
    s->gradient_step = run->gradient_step;
    return TOOL_OK;
}

static void make_own(hard_subject *s) {
    s->system = s->own = s->known.make();
    s->dt = atof(s->known.given.dt);
    s->t_end = atof(s->known.given.t_end);
}

static void start(hard_subject *s) {
    s->n = nevh_system_dof(s->system);
    s->q = tool_allocate(s->n, sizeof *s->q);
    s->p = tool_allocate(s->n, sizeof *s->p);
    if (s->scene)
        nevh_scene_start(s->scene, s->q, s->p);
    else
        s->q[0] = 1;
    s->balance = nevh_system_friction(s->system, NULL) ||
                 !(nevh_system_traits(s->system) & NEVH_AUTONOMOUS);
}

typedef struct {
    hard_subject *subject;
    largest_rates fastest;
    nevh_field *field;
    double *effects, *slope, largest, rounding;
    const nevh_stepper *stepper;
} survey;

/* What H changes by where the state is off by its rounding. */
static void look_at_rounding(survey *s, double t, const double q[],
                             const double p[]) {
    size_t n = s->subject->n;
    double sum =
        s->subject->balance ? fabs(t) * s->fastest.rate * s->largest : 0;
    if (nevh_field_gradient(s->field, 1, &t, q, p, s->slope, s->slope + n))
        return;
    for (size_t k = 0; k < n; k++)
        sum += fabs(q[k] * s->slope[k]) + fabs(p[k] * s->slope[n + k]);
    s->rounding = fmax(s->rounding, DBL_EPSILON * sum);
}

static int look(void *data, size_t step, double t, const double q[],
                const double p[]) {
    survey *s = data;
    size_t count = nevh_system_effect_count(s->subject->system);
    largest_rates_observe(&s->fastest, step, t, q, p);
    if (!nevh_field_effects(s->field, t, q, p, s->effects))
        for (size_t i = 0; i < count; i++)
            s->largest = fmax(s->largest, fabs(s->effects[i]));
    look_at_rounding(s, t, q, p);
    return hard_work(s->stepper) > most_work ? (int)NEVH_STOPPED : NEVH_OK;
}

/* Along the orbit of a method of order 8 with control of its steps, as far as
   it gets. */
static void integrate(hard_subject *s, survey *v, const nevh_options *o) {
    nevh_options own = *o;
    own.tolerance = 1e-9;
    nevh_stepper *m = nevh_stepper_new(s->system, nevh_dop853, &own);
    v->stepper = m;
    double *q = tool_allocate(s->n, sizeof *q);
    double *p = tool_allocate(s->n, sizeof *p);
    memcpy(q, s->q, s->n * sizeof *q);
    memcpy(p, s->p, s->n * sizeof *p);
    double span = fmin(s->t_end - s->t, 1e4 * s->dt);
    if (span > 1e200) /* nothing can be followed over such a time */
        span = 10;
    nevh_run(m, s->t, span / SAMPLES, SAMPLES, q, p,
             &(nevh_observer){look, v, 1}, 1);
    nevh_stepper_free(m);
    tool_release(q);
    tool_release(p);
}

static double energy_scale(const hard_subject *s, const nevh_options *o) {
    nevh_energy *e = nevh_energy_new(s->system, o);
    nevh_energy_observe(e, 0, s->t, s->q, s->p);
    double scale = nevh_energy_result(e, 0).scale;
    nevh_energy_free(e);
    return scale;
}

static void explore(hard_subject *s) {
    nevh_options o = {.t = s->t, .q = s->q, .p = s->p};
    o.gradient = s->own ? nevh_central4 : nevh_exact;
    o.gradient_step = s->own ? 0x1p-6 : 0;
    survey v = {.subject = s, .field = nevh_field_new(s->system, &o)};
    v.effects =
        tool_allocate(nevh_system_effect_count(s->system), sizeof(double));
    v.slope = tool_allocate(2 * s->n, sizeof(double));
    v.fastest.rates = nevh_rates_new(s->system, &o);
    integrate(s, &v, &o);
    s->frequency = v.fastest.frequency;
    s->fastest_at = v.fastest.frequency_at;
    s->pace = v.fastest.rate;
    s->scale = energy_scale(s, &o);
    s->peak = fmax(1, v.largest / s->scale);
    s->rounding = v.rounding / s->scale;
    if (s->own) /* its offset is nothing that the orbit exchanges */
        s->peak = 1;
    nevh_rates_free(v.fastest.rates);
    nevh_field_free(v.field);
    tool_release(v.effects);
    tool_release(v.slope);
}

int hard_open(hard_subject *s, const hard_known *known) {
    *s = (hard_subject){.known = *known};
    if (known->given.scene && open_scene(s)) {
        hard_close(s);
        return TOOL_USAGE;
    }
    if (!known->given.scene)
        make_own(s);
    start(s);
    explore(s);
    s->orbit = hard_orbit_new(s);
    return TOOL_OK;
}

void hard_close(hard_subject *s) {
    hard_orbit_free(s->orbit);
    nevh_system_free(s->own);
    nevh_scene_free(s->scene);
    tool_release(s->q);
    tool_release(s->p);
}
