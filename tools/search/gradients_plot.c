/* nevh gradients --plot: errors over the step of the differences.

   Truncation falls with a power of the step, rounding grows as it gets shorter:
   a V, at the bottom of which the best step is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradients_private.h"
#include "study.h"
#include "plot/plot.h"
#include <math.h>
#include <string.h>

enum { LEAST = -13, MOST = 1, EACH = 6 }; /* powers of 10, points a decade */

typedef struct {
    const gradients_job *gradients_job;
    plot *to;
    double *size;  /* of each variable along the orbit, 2n */
    double unit;   /* steps are multiples of it */
    bool relative; /* to sizes, which differ much */
} drawing;

static double size_along(const orbit_states *o, const double values[],
                         size_t k) {
    double most = 0;
    for (size_t i = 0; i < o->count; i++)
        most = fmax(most, fabs(values[i * o->n + k]));
    return most;
}

/* Finds the size of each variable; one that rests has that of its kind. */
static void fill_sizes(drawing *d) {
    const orbit_states *o = &d->gradients_job->exact;
    double most[2] = {0, 0}, low = INFINITY, high = 0;
    for (size_t k = 0; k < 2 * o->n; k++) {
        const double *values = k < o->n ? o->q : o->p;
        d->size[k] = size_along(o, values, k % o->n);
        most[k >= o->n] = fmax(most[k >= o->n], d->size[k]);
    }
    for (size_t k = 0; k < 2 * o->n; k++) {
        double kind = most[k >= o->n];
        d->size[k] = d->size[k] > 0 ? d->size[k] : kind > 0 ? kind : 1;
        low = fmin(low, kind > 0 ? kind : high);
        high = fmax(high, kind);
    }
    d->relative = !(high < 1e3 * low) && low > 0;
    d->unit = high > 0 ? pow(10, round(log10(high))) : 1;
}

/* The error of the gradient in all variables. */
static double error_at(const drawing *d, const char *gradient, double x) {
    size_t n = d->gradients_job->exact.n;
    double *steps = tool_allocate(2 * n, sizeof *steps);
    for (size_t k = 0; k < 2 * n; k++)
        steps[k] = d->relative ? x * d->size[k] : x;
    double error = gradient_error(d->gradients_job, gradient, steps);
    tool_release(steps);
    return error;
}

static double place(const drawing *d, double x) {
    return d->relative ? x : x * d->unit;
}

/* The slope of the truncation, to the left of where it is seen: to the right are
   the curves of higher orders. */
static void draw_slope(const drawing *d, const char *gradient, double x,
                       double error) {
    static const double aside = 0.4, decades = 1.2;
    int order = nevh_gradient_order(nevh_gradient_named(gradient));
    size_t series = plot_series(d->to, text_print("slope %d", order));
    plot_style(d->to, series, PLOT_GUIDE);
    plot_point(d->to, series, aside * x, error);
    plot_point(d->to, series, aside * x * pow(10, -decades / order * 2),
               error * pow(10, -decades * 2));
}

static size_t draw_curve(const drawing *d, const char *gradient) {
    static const double useless = 10;
    static const int steepest = 4; /* of slopes that can be told apart */
    size_t series = plot_series(d->to, gradient);
    int order = nevh_gradient_order(nevh_gradient_named(gradient));
    double x_of_slope = NAN, error_of_slope = NAN;
    double largest = pow(10, -2 - order); /* lower, curves are farther apart */
    plot_style(d->to, series, PLOT_TRAIL);
    for (int i = LEAST * EACH; i <= MOST * EACH; i++) {
        double x = place(d, pow(10, (double)i / EACH));
        double error = error_at(d, gradient, x);
        if (error < useless)
            plot_point(d->to, series, x, error);
        if (error < largest && error > 1e-4 * largest)
            x_of_slope = x, error_of_slope = error;
    }
    if (order <= steepest && isfinite(x_of_slope) &&
        error_at(d, gradient, x_of_slope / 2) < error_of_slope / 2)
        draw_slope(d, gradient, x_of_slope, error_of_slope);
    return series;
}

/* With the steps that nevh chooses, over the shortest of them. */
static void draw_choice(const drawing *d, const char *gradient, size_t curve) {
    size_t series = plot_series(d->to, NULL);
    double step = gradient_own_step(d->gradients_job, gradient);
    double error = gradient_error(d->gradients_job, gradient, NULL);
    plot_style(d->to, series, PLOT_BOBS);
    plot_like(d->to, series, curve);
    plot_size(d->to, series, 0.5);
    if (!d->relative && isfinite(step))
        plot_point(d->to, series, step, error);
}

/* Draws the level of a method without steps; the axis would be long for an error
   far below rounding. */
static void draw_level(const drawing *d, const char *gradient) {
    static const double least = 1e-17;
    double error = gradient_error(d->gradients_job, gradient, NULL);
    char *name = error < least ? text_print("%s: below %g", gradient, least)
                               : text_print("%s", gradient);
    size_t series = plot_series(d->to, name);
    plot_style(d->to, series, PLOT_TRAIL);
    plot_dash(d->to, series, 1);
    for (int i = LEAST; i <= MOST; i += MOST - LEAST)
        plot_point(d->to, series, place(d, pow(10, i)),
                   error < least ? 0 : error);
}

static void draw_all(const drawing *d, const options *o) {
    for (size_t i = 0; nevh_gradients()[i]; i++) {
        const char *name = nevh_gradient_name(nevh_gradients()[i]);
        bool wanted = o->gradients.count == 0 || list_has(&o->gradients, name);
        bool yardstick = strcmp(name, d->gradients_job->yardstick) == 0;
        if (!wanted || !gradient_fits(d->gradients_job->plan, name, NULL))
            continue;
        if (strncmp(name, "central", 7) == 0)
            draw_choice(d, name, draw_curve(d, name));
        else if (!yardstick)
            draw_level(d, name);
    }
}

static char *words(const drawing *d) {
    const gradients_job *c = d->gradients_job;
    return text_print(
        "at %zu states of an orbit by %s, dt = %.4g%s; against "
        "the %s gradient, relative to its largest component%s",
        c->exact.count, c->integrator, c->dt, c->plan->unit, c->yardstick,
        d->relative ? ""
                    : "; discs: with a step for each variable, as "
                      "nevh chooses, over the shortest");
}

int gradients_plot(const options *o, const gradients_job *c) {
    const plan *p = c->plan;
    drawing d = {c, NULL, tool_allocate(2 * p->n, sizeof(double)), 1, false};
    fill_sizes(&d);
    d.to = plot_new(p->title,
                    d.relative ? "half-spread of the differences / size of "
                                 "the variable"
                               : "half-spread of the differences",
                    "largest error of the gradient");
    plot_log(d.to, true, true);
    draw_all(&d, o);
    plot_note(d.to, words(&d));
    return plot_write(d.to, o);
}
