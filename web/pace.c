/* nevh: the live page's module: how long steps may be.

   A step h is stable on an oscillator of frequency w up to a limit of h w that
   is the scheme's own.  The fastest w is looked for along the orbit: the
   largest eigenvalue of the linearised motion, by the power method, whose two
   steps turn a pair of imaginary eigenvalues into one real one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "page.h"
#include "lesson.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POWERS = 24, STATES = 40, STRIDE = 8, MOST_NUMBERS = 400 };
static const double spread = 1e-4; /* of the lengths */

typedef struct {
    nevh_field *field;
    const double *length; /* 2n */
    size_t n;
    double *trial, *slope, *v; /* 2n each */
} pace;

/* v = J H'' v, in units of the lengths; its norm, 0 where H ends. */
static double multiply(pace *x, double t, const double z[]) {
    size_t n = x->n, m = 2 * n;
    double *up = x->slope, *down = up + m, norm = 0;
    for (int way = 0; way < 2; way++) {
        double *to = way ? down : up, by = way ? -spread : spread;
        for (size_t i = 0; i < m; i++)
            x->trial[i] = z[i] + by * x->length[i] * x->v[i];
        if (nevh_field_gradient(x->field, 1, &t, x->trial, x->trial + n, to,
                                to + n))
            return 0;
    }
    for (size_t i = 0; i < m; i++) {
        size_t j = i < n ? i + n : i - n;
        double change = (up[j] - down[j]) / (2 * spread);
        x->v[i] = (i < n ? change : -change) / x->length[i];
        norm += x->v[i] * x->v[i];
    }
    return sqrt(norm);
}

static double rate_at(pace *x, double t, const double z[]) {
    double rate = 0;
    for (size_t i = 0; i < 2 * x->n; i++)
        x->v[i] = 1 + 0.1 * (double)(i % 7);
    for (int i = 0; i < POWERS; i++) {
        double first = multiply(x, t, z);
        for (size_t j = 0; first > 0 && j < 2 * x->n; j++)
            x->v[j] /= first;
        double second = first > 0 ? multiply(x, t, z) : 0;
        if (!(second > 0) || !isfinite(second))
            return 0;
        for (size_t j = 0; j < 2 * x->n; j++)
            x->v[j] /= second;
        rate = sqrt(first) * sqrt(second);
    }
    return rate;
}

/* The fastest along some steps of h from a state z, which it moves. */
static double fastest(pace *x, nevh_stepper *s, double t0, double h,
                      double *z) {
    size_t states = MOST_NUMBERS / x->n;
    double most = rate_at(x, t0, z);
    states = states > STATES ? STATES : states;
    for (size_t i = 0; s && i < states; i++) {
        double t = t0 + h * (double)(i * STRIDE);
        if (nevh_run(s, t, h, STRIDE, z, z + x->n, NULL, 0))
            break;
        most = fmax(most, rate_at(x, t + h * STRIDE, z));
    }
    return most;
}

/* The largest frequency, or rate of growth, from the start on along steps of h;
   0 where it is not found. */
PAGE_EXPORT(page_fastest) double page_fastest(page *g, double h) {
    size_t m = 2 * g->n;
    nevh_options o = {.gradient = nevh_exact,
                      .t = g->run->t_start,
                      .q = g->start,
                      .p = g->start + g->n};
    nevh_probe *probe = nevh_probe_new(g->system, &o);
    nevh_stepper *s =
        nevh_stepper_new(g->system, nevh_integrator_named("gauss4"), &o);
    double *memory = calloc(5 * m, sizeof *memory), most = 0;
    pace x = {.field = nevh_field_new(g->system, &o), .n = g->n};
    if (memory && !nevh_probe_status(probe) && !nevh_field_status(x.field)) {
        x.length = nevh_probe_lengths(probe);
        x.trial = memory + m;
        x.slope = memory + 2 * m;
        x.v = memory + 4 * m;
        memcpy(memory, g->start, m * sizeof *memory);
        most = fastest(&x, nevh_stepper_status(s) ? NULL : s, o.t, h, memory);
    }
    nevh_field_free(x.field);
    nevh_stepper_free(s);
    nevh_probe_free(probe);
    free(memory);
    return most;
}

/* The length over which H varies with a coordinate i < n, or a momentum; NAN
   where that is not found. */
PAGE_EXPORT(page_length) double page_length(const page *g, size_t i) {
    nevh_options o = {
        .t = g->run->t_start, .q = g->start, .p = g->start + g->n};
    nevh_probe *probe = nevh_probe_new(g->system, &o);
    double length =
        nevh_probe_status(probe) ? NAN : nevh_probe_lengths(probe)[i];
    nevh_probe_free(probe);
    return length;
}

/* As nevh_stability_limit; NAN where there is no such scheme. */
PAGE_EXPORT(page_limit) double page_limit(page *g, const char *scheme) {
    const nevh_integrator *x = nevh_scene_integrator_named(g->scene, scheme);
    return x ? nevh_stability_limit(x) : NAN;
}

/* The step and speed at which two schemes part, as JSON. */
PAGE_EXPORT(page_lesson)
const char *page_lesson(page *g, const char *kept, const char *other,
                        const char *gradient) {
    const char *names[] = {kept, other};
    free(g->text);
    g->text = malloc(LESSON_TEXT);
    if (!g->text)
        return "";
    lesson_find(g->scene, names, 2, gradient, g->start, lesson_usual(g->scene),
                400000 / (g->n + 1), g->text);
    return g->text;
}
