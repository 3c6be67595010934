/* nevh fit: the orbit of varied numbers, at the times of the data.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_start(const plan *p, const char *name) {
    if (strncmp(name, "p_", 2) == 0 || strncmp(name, "v_", 2) == 0)
        name += 2;
    for (size_t k = 0; k < p->n; k++)
        if (strcmp(name, nevh_scene_coordinate(p->scene, k)) == 0)
            return true;
    return false;
}

/* Reads the first value from the scene; assignments may change its run settings. */
static int first_value(fitting *f, varied *v, const options *o) {
    plan *p = f->plan;
    double t = nevh_scene_run_settings(p->scene)->t_start;
    v->start = is_start(p, v->name);
    if (!v->start)
        return scene_number(p->scene, o, v->name, &v->first);
    if (nevh_scene_set_judged(p->scene, v->name) ||
        nevh_scene_judged_value(p->scene, t, p->q, p->p, &v->first))
        return scene_report(p->scene, o);
    return TOOL_OK;
}

/* A setting tells a parameter that can be changed from one that cannot. */
static int assign(fitting *f, const varied *v, double value) {
    nevh_scene *s = f->plan->scene;
    char *text = text_print("%s=%.17g", v->name, value);
    int status =
        v->start ? nevh_scene_set_start(s, text) : nevh_scene_set(s, text);
    tool_release(text);
    return status;
}

/* The plan of the scene as it is now. */
static int renew(plan *p) {
    p->system = nevh_scene_system(p->scene);
    p->run = nevh_scene_run_settings(p->scene);
    if (p->gradient_steps)
        p->gradient_steps = p->run->gradient_steps;
    return nevh_scene_start(p->scene, p->q, p->p);
}

/* The largest frequency of the drives; its effect. */
static double drive_of(const plan *p, const char **effect) {
    nevh_timing *timing =
        nevh_timing_new(p->system, p->run->t_start, p->t_end, p->q, p->p);
    double frequency = nevh_timing_frequency(tool_owned(timing), effect);
    nevh_timing_free(timing);
    return frequency;
}

/* Half a turn between the two points that are nearest: faster drives look like
   slower ones.  Infinite where the first values have such. */
static double fastest_of(const fitting *f) {
    static const double half_turn = 3.141592653589793;
    const measured *m = f->data;
    double gap = m->points ? m->t[m->points - 1] : 0, rounding = 1e-12 * gap;
    const char *effect;
    for (size_t i = 1; i < m->points; i++)
        if (m->t[i] - m->t[i - 1] > rounding)
            gap = fmin(gap, m->t[i] - m->t[i - 1]);
    double fastest = gap > 0 ? half_turn / gap : INFINITY;
    return f->plan->time && drive_of(f->plan, &effect) < fastest ? fastest
                                                                 : INFINITY;
}

/* One more name of --vary. */
static int add_varied(fitting *f, const char *name, const options *o) {
    varied *v = &f->item[f->count++];
    v->name = text_print("%s", name);
    for (size_t k = 0; k + 1 < f->count; k++)
        if (strcmp(name, f->item[k].name) == 0)
            return tool_refuse("--vary: %s stands there twice", name);
    if (strchr(name, '='))
        return tool_refuse("--vary of nevh fit takes names alone: what "
                           "%s begins with is given by --set or --start",
                           name);
    if (first_value(f, v, o))
        return TOOL_USAGE;
    v->value = v->first;
    v->scale = v->first != 0 ? fabs(v->first) : 1;
    return assign(f, v, v->first)
               ? tool_refuse("--vary %s: %s", name,
                             nevh_scene_message(f->plan->scene))
               : TOOL_OK;
}

int fit_begin(fitting *f, const options *o) {
    list names = {0};
    int status = TOOL_OK;
    for (size_t i = 0; i < o->vary.count; i++)
        list_split(&names, o->vary.item[i]);
    f->item = tool_allocate(names.count, sizeof *f->item);
    for (size_t i = 0; !status && i < names.count; i++)
        status = add_varied(f, names.item[i], o);
    f->held = f->count;
    if (!status && renew(f->plan))
        status = scene_report(f->plan->scene, o);
    f->fastest = status ? INFINITY : fastest_of(f);
    return status;
}

typedef struct {
    fitting *fitting;
    quantities columns;
    double *values, *residual;
    size_t point;
} comparison;

/* At each point in turn. */
static int compare_point(void *data, double t, const double q[],
                         const double p[]) {
    comparison *c = data;
    const fitting *f = c->fitting;
    const measured *m = f->data;
    columns_values(&c->columns, t, q, p, c->values);
    for (size_t k = 0; k < m->columns; k++) {
        size_t i = c->point * m->columns + k;
        c->residual[i] = measured_residual(m, c->point, k, c->values[k]) /
                         (m->sigma ? m->sigma[i] : f->sigma);
        if (!isfinite(c->residual[i]))
            return TOOL_FAILED;
    }
    c->point++;
    return TOOL_OK;
}

static bool fails(fitting *f, const char *why) {
    f->why = text_print("%s", why);
    return false;
}

typedef struct {
    const nevh_stepper *stepper;
    uint64_t most; /* gradients; 0: any */
} budget;

static int check_budget(void *data) {
    const budget *b = data;
    uint64_t taken = nevh_stepper_counts(b->stepper).gradients;
    return b->most && taken > b->most ? TOOL_FAILED : TOOL_OK;
}

static bool follow(fitting *f, nevh_stepper *s, double residual[]) {
    static const volatile sig_atomic_t no_signal;
    const measured *m = f->data;
    comparison c = {.fitting = f,
                    .columns = columns_new(f->plan),
                    .values = tool_allocate(m->columns, sizeof(double)),
                    .residual = residual};
    for (size_t k = 0; k < m->columns; k++)
        columns_add(&c.columns, m->names.item[k]);
    row_times times = measured_times(m);
    times.count = f->used;
    f->plan->t_end = m->t[f->used - 1];
    trajectory *r = trajectory_new(
        f->plan, f->now.integrator, s, &times,
        (row_output){.take = compare_point, .data = &c, .mute = true});
    budget b = {s, f->most};
    trajectory_follow(r, &(trajectory_watch){.signal = &no_signal,
                                             .save = check_budget,
                                             .data = &b});
    f->cost = nevh_stepper_counts(s).gradients;
    bool dear = check_budget(&b) != TOOL_OK;
    int status = nevh_stepper_status(s);
    bool whole = c.point == f->used && !dear;
    if (dear)
        fails(f, "it takes too many steps");
    else if (!whole && status && status != NEVH_STOPPED)
        fails(f, nevh_stepper_message(s));
    else if (!whole)
        fails(f, "the orbit ends before the data, or is not finite");
    trajectory_free(r);
    columns_free(&c.columns);
    tool_release(c.values);
    return whole;
}

/* Looked at where numbers are far from the first ones. */
static bool is_too_fast(fitting *f, const double x[]) {
    static const double far = 1.2;
    const char *effect = "";
    bool look = false;
    for (size_t i = 0; i < f->count; i++)
        look = look || fabs(x[i]) > far;
    double drive =
        look && isfinite(f->fastest) ? drive_of(f->plan, &effect) : 0;
    if (!(drive > f->fastest))
        return false;
    f->why = text_print("%s has the frequency %.4g, and these points show "
                        "none above %.4g",
                        effect, drive, f->fastest);
    return true;
}

bool fit_orbit(fitting *f, const double x[], double residual[]) {
    for (size_t i = 0; i < f->count; i++)
        if (assign(f, &f->item[i], x[i] * f->item[i].scale))
            return fails(f, nevh_scene_message(f->plan->scene));
    if (renew(f->plan))
        return fails(f, nevh_scene_message(f->plan->scene));
    if (is_too_fast(f, x))
        return false;
    nevh_stepper *s = plan_stepper(f->plan, f->now.integrator);
    bool good = nevh_stepper_status(s) ? fails(f, nevh_stepper_message(s))
                                       : follow(f, s, residual);
    nevh_stepper_free(s);
    return good;
}

/* Turns of columns: they go back by more than a hundredth of the measured range. */
typedef struct {
    quantities columns;
    double *value, *extreme, *width; /* columns each */
    int *way;
    size_t *turns;
} turning;

static int count_turns(void *data, double t, const double q[],
                       const double p[]) {
    turning *w = data;
    columns_values(&w->columns, t, q, p, w->value);
    for (size_t k = 0; k < w->columns.count; k++) {
        double moved = w->value[k] - w->extreme[k];
        int way = moved > 0 ? 1 : -1;
        if (fabs(moved) <= w->width[k] && way != w->way[k])
            continue;
        w->turns[k] += way == -w->way[k];
        w->way[k] = way;
        w->extreme[k] = w->value[k];
    }
    return TOOL_OK;
}

static void turning_begin(turning *w, const fitting *f) {
    static const double part = 0.01;
    const measured *m = f->data;
    size_t n = m->columns;
    *w = (turning){.columns = columns_new(f->plan)};
    w->value = tool_allocate(3 * n, sizeof *w->value);
    w->extreme = w->value + n, w->width = w->extreme + n;
    w->way = tool_allocate(n, sizeof *w->way);
    w->turns = tool_allocate(n, sizeof *w->turns);
    for (size_t k = 0; k < n; k++) {
        double low = m->value[k], high = low;
        columns_add(&w->columns, m->names.item[k]);
        for (size_t i = 0; i < m->points; i++) {
            low = fmin(low, m->value[i * n + k]);
            high = fmax(high, m->value[i * n + k]);
        }
        w->extreme[k] = low;
        w->width[k] = part * (high - low);
    }
}

static void turning_end(turning *w) {
    columns_free(&w->columns);
}

/* All steps of the orbit with the numbers that were found. */
static bool turn(fitting *f, turning *w) {
    static const volatile sig_atomic_t no_signal;
    for (size_t i = 0; i < f->count; i++)
        if (assign(f, &f->item[i], f->item[i].value))
            return false;
    nevh_stepper *s =
        renew(f->plan) ? NULL : plan_stepper(f->plan, f->now.integrator);
    bool good = s && !nevh_stepper_status(s);
    f->plan->t_end = f->data->t[f->data->points - 1];
    if (good) {
        trajectory *r = trajectory_new(
            f->plan, f->now.integrator, s,
            &(row_times){.by = BY_STEPS, .every = 1},
            (row_output){.take = count_turns, .data = w, .mute = true});
        trajectory_follow(r, &(trajectory_watch){.signal = &no_signal});
        trajectory_free(r);
    }
    nevh_stepper_free(s);
    return good;
}

void fit_sparse_words(fitting *f, list *words) {
    const measured *m = f->data;
    turning w;
    turning_begin(&w, f);
    bool followed = turn(f, &w);
    for (size_t k = 0; followed && k < m->columns; k++)
        if (w.turns[k] >= m->points) {
            list_print(words,
                       "%s turns %zu times between %zu points, which lie "
                       "farther apart than half a period: an orbit of another "
                       "frequency may pass through them as well.  Take more "
                       "points, or begin where the frequency is known.",
                       m->names.item[k], w.turns[k], m->points);
            break;
        }
    turning_end(&w);
}
