/* nevh: the live page's module: the functions that its script calls.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "page.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int page_fail(page *g, int status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int used = vsnprintf(g->message, sizeof g->message, format, arguments);
    va_end(arguments);
    if (page_absent && used >= 0 && (size_t)used < sizeof g->message)
        snprintf(g->message + used, sizeof g->message - (size_t)used,
                 "\nThe page is without %s: nevh run has them.", page_absent);
    return g->status = status;
}

static void *take(size_t count, size_t size) {
    return count && count <= SIZE_MAX / 2 / size ? calloc(count, size) : NULL;
}

static void run_clear(page_run *r) {
    nevh_sections_free(r->finder);
    nevh_stepper_free(r->stepper);
    nevh_energy_free(r->energy);
    free(r->state);
    *r = (page_run){0};
}

/* What is borrowed from the scene ends with each change of it. */
static void forget(page *g) {
    for (size_t i = 0; i < PAGE_RUNS; i++)
        run_clear(&g->runs[i]);
    nevh_field_free(g->field);
    free(g->start);
    free(g->shown);
    free(g->text);
    free(g->points);
    g->field = NULL;
    g->start = g->shown = g->points = NULL;
    g->n_points = 0;
    g->text = NULL;
}

PAGE_EXPORT(page_take) void *page_take(size_t size) {
    return malloc(size);
}

PAGE_EXPORT(page_release) void page_release(void *memory) {
    free(memory);
}

PAGE_EXPORT(page_close) void page_close(page *g) {
    if (!g)
        return;
    forget(g);
    nevh_scene_free(g->scene);
    free(g);
}

/* A scene from its text; NULL when memory is out. */
PAGE_EXPORT(page_open) page *page_open(const char *name, const char *text) {
    page *g = calloc(1, sizeof *g);
    if (!g)
        return NULL;
    page_absent = NULL;
    g->scene = nevh_scene_parse(name, text);
    g->status = nevh_scene_status(g->scene);
    if (g->status)
        page_fail(g, g->status, "%s",
                  g->scene ? nevh_scene_message(g->scene) : "out of memory");
    return g;
}

PAGE_EXPORT(page_status) int page_status(const page *g) {
    return g->status;
}

PAGE_EXPORT(page_message) const char *page_message(const page *g) {
    return g->message;
}

/* '=' sets a parameter, '@' a start; '+' and '-' switch an effect. */
PAGE_EXPORT(page_change) int page_change(page *g, int mark, const char *text) {
    page_absent = NULL;
    forget(g);
    int status = mark == '='   ? nevh_scene_set(g->scene, text)
                 : mark == '@' ? nevh_scene_set_start(g->scene, text)
                               : nevh_scene_enable(g->scene, text, mark == '+');
    if (status)
        return page_fail(g, status, "%s", nevh_scene_message(g->scene));
    return g->status = NEVH_OK;
}

/* Where the scene says that it starts, and values of H. */
PAGE_EXPORT(page_begin) int page_begin(page *g) {
    nevh_options values = {.gradient_step = 1e-3, .portable = true};
    page_absent = NULL;
    forget(g);
    g->system = nevh_scene_system(g->scene);
    g->run = nevh_scene_run_settings(g->scene);
    if (!g->system || !g->run)
        return page_fail(g, nevh_scene_status(g->scene), "%s",
                         nevh_scene_message(g->scene));
    g->n = nevh_scene_dof(g->scene);
    g->balance = !(nevh_system_traits(g->system) & NEVH_AUTONOMOUS) ||
                 nevh_system_friction(g->system, NULL);
    g->start = take(2 * g->n, sizeof *g->start);
    if (!g->start)
        return page_fail(g, NEVH_ENOMEM, "out of memory");
    if (nevh_scene_start(g->scene, g->start, g->start + g->n))
        return page_fail(g, nevh_scene_status(g->scene), "%s",
                         nevh_scene_message(g->scene));
    g->field = nevh_field_new(g->system, &values);
    if (nevh_field_status(g->field))
        return page_fail(g, nevh_field_status(g->field), "%s",
                         nevh_field_message(g->field));
    return g->status = NEVH_OK;
}

PAGE_EXPORT(page_dof) size_t page_dof(const page *g) {
    return g->n;
}

/* 2n numbers, which the script may write to before page_race. */
PAGE_EXPORT(page_start) double *page_start(page *g) {
    return g->start;
}

/* The scene as JSON; "" when memory is out. */
PAGE_EXPORT(page_describe) const char *page_describe(page *g) {
    free(g->text);
    g->text = page_scene_text(g);
    return g->text ? g->text : "";
}

/* The sum over coordinates of the area that every by-th orbit encloses, in their
   order. */
static double area(const page *g, const page_run *r, size_t by) {
    double sum = 0, lost = 0;
    const double *q = r->state + PAGE_STATE, *p = q + g->n * r->width;
    for (size_t k = 0; k < g->n; k++)
        for (size_t i = 0; i < r->width; i += by) {
            size_t a = k * r->width + i;
            size_t b = k * r->width + (i + by) % r->width;
            double term = (p[a] + p[b]) * (q[a] - q[b]) / 2 - lost;
            double next = sum + term;
            lost = next - sum - term;
            sum = next;
        }
    return sum;
}

/* Of one orbit, the energy error, and points of a section. */
static int watch(void *run, size_t step, double t, const double q[],
                 const double p[]) {
    page_run *r = run;
    if (!nevh_energy_observe(r->energy, r->steps + step, t, q, p))
        r->state[PAGE_ERROR] = nevh_energy_error(r->energy, 0);
    r->state[PAGE_MOST] = fmax(r->state[PAGE_MOST], fabs(r->state[PAGE_ERROR]));
    return r->finder ? nevh_sections_observe(r->finder, step, t, q, p) : 0;
}

/* One orbit has an energy; many have their area instead, and its change where every
   second orbit is left out. */
static void observe(page *g, page_run *r) {
    double *q = r->state + PAGE_STATE, *p = q + g->n * r->width;
    double t = r->state[PAGE_T];
    if (r->width > 1) {
        r->state[PAGE_ENERGY] = area(g, r, 1);
        r->state[PAGE_ERROR] = area(g, r, 2) - area(g, r, 1);
        return;
    }
    if (nevh_field_value(g->field, 1, &t, q, p, &r->state[PAGE_ENERGY]))
        r->state[PAGE_ENERGY] = NAN;
}

static int run_plan(page *g, page_run *r, const char *gradient,
                    double tolerance) {
    double *q = r->state + PAGE_STATE, *p = q + g->n * r->width;
    bool own_time = nevh_integrator_own_time(r->scheme);
    nevh_options o = {
        .gradient = nevh_gradient_named(gradient),
        .gradient_step = g->run->gradient_step,
        .gradient_steps = g->run->gradient_steps,
        .t = g->run->t_start,
        .q = q,
        .p = p,
        .width = r->width,
        .portable = true,
        .balance = g->balance && r->width == 1,
        .tolerance = nevh_integrator_adaptive(r->scheme) ? tolerance : 0,
        .transform = own_time ? nevh_scene_transform(g->scene) : NULL};
    r->stepper = nevh_stepper_new(g->system, r->scheme, &o);
    if (nevh_stepper_status(r->stepper))
        return page_fail(g, nevh_stepper_status(r->stepper), "%s",
                         nevh_stepper_message(r->stepper));
    r->energy = nevh_energy_new(g->system, &o);
    if (g->run->energy_scale > 0)
        nevh_energy_set_scale(r->energy, g->run->energy_scale);
    if (o.balance)
        nevh_energy_follow(r->energy, r->stepper);
    if (nevh_energy_status(r->energy))
        return page_fail(g, nevh_energy_status(r->energy), "%s",
                         nevh_energy_message(r->energy));
    return NEVH_OK;
}

static page_run *run_at(page *g, size_t slot) {
    return slot < PAGE_RUNS ? &g->runs[slot] : NULL;
}

PAGE_EXPORT(page_leave) void page_leave(page *g, size_t slot) {
    if (slot < PAGE_RUNS)
        run_clear(&g->runs[slot]);
}

/* Puts the orbits of a run where they start. */
static void place_orbits(const page *g, page_run *r, size_t k, double dq,
                         double dp) {
    double *z = r->state + PAGE_STATE;
    size_t width = r->width;
    for (size_t j = 0; j < 2 * g->n; j++)
        for (size_t i = 0; i < width; i++)
            z[j * width + i] = g->start[j];
    for (size_t i = 0; width > 1 && i < width; i++) {
        double angle = 2 * M_PI * (double)i / (double)width;
        z[k * width + i] += dq * cos(angle);
        z[(g->n + k) * width + i] += dp * sin(angle);
    }
    r->state[PAGE_T] = g->run->t_start;
}

/* A scheme from the start on; `width` orbits stand on a circle around it, in
   the plane of coordinate k, whose radii are dq and dp: 1 is the start itself.
 */
PAGE_EXPORT(page_race)
int page_race(page *g, size_t slot, const char *scheme, const char *gradient,
              double h, double tolerance, size_t width, size_t k, double dq,
              double dp) {
    page_run *r = run_at(g, slot);
    page_absent = NULL;
    if (!r || !g->start || width < 1 || width > 4096 || k >= g->n)
        return page_fail(g, NEVH_EINVAL, "there is no such run");
    run_clear(r);
    r->scheme = nevh_scene_integrator_named(g->scene, scheme);
    r->page = g;
    r->width = width;
    r->h = h;
    if (!r->scheme || !nevh_gradient_named(gradient))
        return page_fail(g, NEVH_EINVAL, "there is no %s with %s", scheme,
                         gradient);
    if (!isfinite(h) || h == 0)
        return page_fail(g, NEVH_EINVAL, "a step of %g leads nowhere", h);
    r->state = take(PAGE_STATE + 2 * g->n * width, sizeof *r->state);
    if (!r->state)
        return page_fail(g, NEVH_ENOMEM, "out of memory");
    place_orbits(g, r, k, dq, dp);
    r->status = run_plan(g, r, gradient, tolerance);
    if (r->status)
        return run_clear(r), g->status;
    observe(g, r);
    double *z = r->state + PAGE_STATE;
    if (width == 1)
        watch(r, 0, r->state[PAGE_T], z, z + g->n);
    return g->status = NEVH_OK;
}

/* That nothing but time tells chunks of steps from single ones. */
static int step(page *g, page_run *r, size_t steps) {
    double *q = r->state + PAGE_STATE, *p = q + g->n * r->width;
    double t0 = g->run->t_start;
    nevh_observer watcher = {.observe = watch, .data = r};
    size_t watchers = r->width == 1;
    int status = NEVH_OK;
    if (nevh_integrator_own_time(r->scheme)) {
        status = nevh_run(r->stepper, r->state[PAGE_T], r->h, steps, q, p,
                          &watcher, watchers);
        r->steps += nevh_stepper_taken(r->stepper);
        r->state[PAGE_T] = nevh_stepper_time(r->stepper);
        return status;
    }
    if (!g->balance) {
        double t = t0 + (double)r->steps * r->h;
        status = nevh_run(r->stepper, t, r->h, steps, q, p, &watcher, watchers);
        r->steps += nevh_stepper_taken(r->stepper);
    }
    for (size_t i = 0; g->balance && !status && i < steps; i++) {
        double t = t0 + (double)r->steps * r->h;
        status = nevh_stepper_apply(r->stepper, t, r->h, q, p);
        r->steps += !status;
        if (!status && watchers)
            status = watch(r, 0, t0 + (double)r->steps * r->h, q, p);
    }
    r->state[PAGE_T] = t0 + (double)r->steps * r->h;
    return status;
}

/* Steps of a run.  Returns 0 or its status, which ends it: the state is the
   last good one. */
PAGE_EXPORT(page_advance)
int page_advance(page *g, size_t slot, size_t steps) {
    page_run *r = run_at(g, slot);
    if (!r || !r->stepper)
        return NEVH_EINVAL;
    if (r->status)
        return r->status;
    r->state[PAGE_MOST] = 0;
    g->n_points = 0;
    r->status = step(g, r, steps);
    if (r->status)
        page_fail(g, r->status, "%s stopped at t = %.6g: %s",
                  nevh_integrator_name(r->scheme), r->state[PAGE_T],
                  nevh_stepper_message(r->stepper));
    observe(g, r);
    return r->status;
}

/* NULL: there is no such run. */
PAGE_EXPORT(page_state) double *page_state(page *g, size_t slot) {
    page_run *r = run_at(g, slot);
    return r ? r->state : NULL;
}

/* Numbers of all parts of the picture at a state, one after the other. */
PAGE_EXPORT(page_picture)
const double *page_picture(page *g, double t, const double *state) {
    size_t parts = nevh_scene_part_count(g->scene), count = 0;
    for (size_t i = 0; i < parts; i++)
        count += nevh_scene_part_at(g->scene, i).count;
    free(g->shown);
    g->shown = take(count + 1, sizeof *g->shown);
    count = 0;
    for (size_t i = 0; g->shown && i < parts; i++) {
        nevh_scene_part_values(g->scene, i, t, state, state + g->n,
                               g->shown + count);
        count += nevh_scene_part_at(g->scene, i).count;
    }
    return g->shown;
}

/* H over the plane of coordinate k and its momentum, through a state, nx x ny
   values by rows; NAN outside of its domain.  NULL when memory is out. */
PAGE_EXPORT(page_levels)
const double *page_levels(page *g, const double *state, size_t k, double q0,
                          double q1, double p0, double p1, size_t nx,
                          size_t ny) {
    double t = g->run->t_start, *z;
    free(g->shown);
    g->shown = take(nx * ny + 2 * g->n, sizeof *g->shown);
    if (!g->shown)
        return NULL;
    z = g->shown + nx * ny;
    memcpy(z, state, 2 * g->n * sizeof *z);
    for (size_t j = 0; j < ny; j++)
        for (size_t i = 0; i < nx; i++) {
            double *h = &g->shown[j * nx + i];
            z[k] = q0 + (q1 - q0) * (double)i / (double)(nx - 1);
            z[g->n + k] = p0 + (p1 - p0) * (double)j / (double)(ny - 1);
            if (nevh_field_value(g->field, 1, &t, z, z + g->n, h))
                *h = NAN;
        }
    return g->shown;
}
