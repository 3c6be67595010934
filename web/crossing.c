/* nevh: the live page's module: points of a section along runs, and starts on it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "page.h"
#include <math.h>
#include <stdlib.h>

enum { MOST_ITEMS = 64, ROUNDS = 30 };

static int keep(void *data, const nevh_point *point) {
    page_run *r = data;
    page *g = r->page;
    double items[MOST_ITEMS];
    if (g->n_points == PAGE_POINTS)
        return 0;
    if (nevh_scene_section_items(g->scene, r->section, point->t, point->q,
                                 point->p, items))
        return 0;
    g->points[2 * g->n_points] = items[0];
    g->points[2 * g->n_points++ + 1] = items[1];
    return 0;
}

static int crossing(void *data, double t, const double q[], const double p[],
                    double *value) {
    const page_run *r = data;
    return nevh_scene_section_cross(r->page->scene, r->section, t, q, p, value);
}

/* Makes a run, before its first step, tell the points of a section. */
PAGE_EXPORT(page_watch) int page_watch(page *g, size_t slot, size_t section) {
    page_run *r = slot < PAGE_RUNS ? &g->runs[slot] : NULL;
    const nevh_scene_section *x = nevh_scene_section_at(g->scene, section);
    if (!r || !r->stepper || !x || x->items < 2 || x->items > MOST_ITEMS)
        return page_fail(g, NEVH_EINVAL, "there is no such section");
    if (!g->points)
        g->points = calloc(2 * PAGE_POINTS, sizeof *g->points);
    if (!g->points)
        return page_fail(g, NEVH_ENOMEM, "out of memory");
    r->section = section;
    nevh_section how = {.name = x->name,
                        .value = x->every > 0 ? NULL : crossing,
                        .data = r,
                        .direction = x->direction,
                        .period = x->period,
                        .every = x->every};
    nevh_sections_free(r->finder);
    r->finder = nevh_sections_new(r->stepper, &how, 1, keep, r);
    if (nevh_sections_status(r->finder))
        return page_fail(g, nevh_sections_status(r->finder), "%s",
                         nevh_sections_message(r->finder));
    double *q = r->state + PAGE_STATE;
    nevh_sections_observe(r->finder, 0, r->state[PAGE_T], q, q + g->n);
    return g->status = NEVH_OK;
}

/* Pairs of numbers, of the last steps of all runs. */
PAGE_EXPORT(page_points) const double *page_points(const page *g) {
    return g->points;
}

PAGE_EXPORT(page_point_count) size_t page_point_count(const page *g) {
    return g->n_points;
}

typedef struct {
    page *g;
    size_t section, j;
    double *z, energy;
} seed;

static double miss(const seed *x) {
    double value, t = x->g->run->t_start;
    return nevh_scene_section_cross(x->g->scene, x->section, t, x->z,
                                    x->z + x->g->n, &value)
               ? NAN
               : value;
}

static double excess(const seed *x, double momentum) {
    double value, t = x->g->run->t_start;
    x->z[x->g->n + x->j] = momentum;
    return nevh_field_value(x->g->field, 1, &t, x->z, x->z + x->g->n, &value)
               ? NAN
               : value - x->energy;
}

/* The coordinate at which the section is crossed, by secants. */
static bool find_coordinate(const seed *x) {
    double *q = &x->z[x->j], a = *q, f = miss(x),
           b = a + 1e-3 * fmax(1, fabs(a));
    for (int i = 0; i < ROUNDS && f != 0; i++) {
        *q = b;
        double g = miss(x), next = b - g * (b - a) / (g - f);
        if (g == 0 || !isfinite(next))
            return g == 0;
        a = b;
        f = g;
        b = next;
    }
    *q = a;
    return fabs(miss(x)) < 1e-9;
}

/* A momentum at which H is the energy, beyond `from`: on the side of `way`. */
static bool find_momentum(const seed *x, double from, double way) {
    double near = from, far = from + way, middle;
    for (int i = 0; i < 60 && excess(x, far) < 0; i++)
        far = from + 2 * (far - from);
    if (!(excess(x, near) <= 0) || !(excess(x, far) >= 0))
        return false;
    for (int i = 0;
         i < 100 && (middle = (near + far) / 2) != near && middle != far; i++)
        *(excess(x, middle) < 0 ? &near : &far) = middle;
    x->z[x->g->n + x->j] = near;
    return true;
}

/* The least of H in the momentum, that of a parabola. */
static double bottom(const seed *x) {
    double low = excess(x, -1), middle = excess(x, 0), high = excess(x, 1);
    double bend = low + high - 2 * middle;
    return bend > 0 ? (low - high) / (2 * bend) : 0;
}

/* The way in which the orbit of z crosses. */
static double direction(const seed *x, double *slope) {
    size_t n = x->g->n;
    double t = x->g->run->t_start, before = miss(x), length = 0, *z = x->z;
    if (nevh_field_gradient(x->g->field, 1, &t, z, z + n, slope, slope + n))
        return NAN;
    for (size_t i = 0; i < 2 * n; i++)
        length = fmax(length, fabs(slope[i]));
    for (size_t i = 0; i < n; i++)
        z[i] += 1e-6 / length * slope[n + i];
    double after = miss(x);
    for (size_t i = 0; i < n; i++)
        z[i] -= 1e-6 / length * slope[n + i];
    return after - before;
}

/* Of two coordinates: puts k and its momentum at a and b, and the other one on the
   section, so that H is `energy` and the orbit crosses in the section's direction.
   z  2n, in and out
   returns  NEVH_OK; a status where no orbit does */
PAGE_EXPORT(page_seed)
int page_seed(page *g, size_t section, size_t k, double a, double b,
              double energy, double *z) {
    const nevh_scene_section *s = nevh_scene_section_at(g->scene, section);
    double slope[4];
    if (!s || g->n != 2 || k > 1)
        return page_fail(g, NEVH_EINVAL, "there is no such section");
    seed x = {g, section, 1 - k, z, energy};
    z[k] = a;
    z[2 + k] = b;
    bool found = find_coordinate(&x);
    double from = bottom(&x);
    for (int way = 1; found && way >= -1; way -= 2)
        if (find_momentum(&x, from, way) &&
            (s->direction == 0 || direction(&x, slope) * s->direction > 0))
            return g->status = NEVH_OK;
    return page_fail(g, NEVH_EDOM,
                     "no orbit of the energy %.6g goes through there", energy);
}
