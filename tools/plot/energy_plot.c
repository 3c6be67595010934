/* nevh: energy errors against time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "energy_plot.h"
#include <math.h>

static const double absurd = 100;     /* of an error relative to the energy */
static const double least_range = 30; /* a level error is a level line */
enum { MOST_POINTS = 300 };           /* of a line */

/* The number of points of a line: a period of the motion or more each, where the run has
   some periods, so that oscillations do not fill the panel. */
static size_t points_of(double turns) {
    static const double some = 10, half = 0.5; /* what a count may be above */
    return turns >= some ? (size_t)fmin(turns - half, MOST_POINTS)
                         : MOST_POINTS;
}

/* True if a point stands for several steps. */
static bool has_bins(const plan *p) {
    double shortest = INFINITY;
    for (size_t i = 0; i < p->dts; i++)
        shortest = fmin(shortest, p->dt[i]);
    return (p->t_end - p->run->t_start) / shortest > MOST_POINTS;
}

static const char *quantity(const plan *p) {
    return has_bins(p)  ? p->balance ? "largest |balance error| per bin"
                                     : "largest |energy error| per bin"
           : p->balance ? "|error of the balance|, relative"
                        : "|energy error|, relative";
}

const char *energy_plot_largest(const plan *p) {
    return p->balance ? "largest error of the balance, relative"
                      : "largest energy error, relative";
}

char *energy_plot_words(const plan *p, double turns) {
    const char *time = nevh_scene_label(p->scene, "t");
    double bin = (p->t_end - p->run->t_start) / (double)points_of(turns);
    char *scale = text_print("errors relative to %.4g%s", plan_energy_scale(p),
                             p->energy_unit);
    return has_bins(p) ? text_print("%s, the largest in each %.2g%s%s", scale,
                                    bin, *time ? " " : "", time)
                       : text_print("%s", scale);
}

static void set_axes(plot *to, const plan *p) {
    plot_log(to, false, true);
    plot_span_x(to, p->run->t_start, p->t_end);
    plot_limit_y(to, 0, absurd);
    plot_least_y(to, least_range);
}

plot *energy_plot_new(const plan *p, const char *title, const char *heading) {
    plot *to = plot_new(title, plot_label(p, "t", "t"), quantity(p));
    plot_heading(to, heading);
    set_axes(to, p);
    return to;
}

void energy_plot_panel(plot *to, const plan *p, const char *heading) {
    plot_panel(to, heading, plot_label(p, "t", "t"), quantity(p));
    set_axes(to, p);
}

/* Says where a line leaves the panel, and how far it goes. */
static void add_exit(plot *to, const char *integrator, const envelope *e) {
    double most = 0, left = NAN;
    for (size_t i = 0; i < ENVELOPE_PARTS; i++) {
        most = fmax(most, e->part[i].value);
        if (isnan(left) && e->part[i].value > absurd)
            left = e->part[i].t;
    }
    if (isnan(left))
        return;
    size_t series =
        plot_series(to, text_print("\u2191 %s: up to %.0e", integrator, most));
    plot_style(to, series, PLOT_GUIDE);
    plot_point(to, series, left, absurd / 2);
}

/* True if a bin begins after so many parts: a rest that is shorter belongs to the last. */
static bool is_first(size_t seen, size_t each, size_t parts) {
    return seen % each == 0 && (seen == 0 || parts - seen >= each);
}

/* The largest of a few parts each where there are many. */
void energy_plot_add(plot *to, const plan *p, double turns, const char *name,
                     const char *integrator, const envelope *e) {
    size_t parts = 0, last = 0, largest = 0, seen = 0,
           series = plot_series(to, name);
    plot_integrator(to, series, integrator);
    plot_style(to, series, name ? PLOT_MARKED : PLOT_LINES);
    for (size_t i = 0; i < ENVELOPE_PARTS; i++)
        if (e->part[i].value >= 0) {
            parts++;
            last = i;
        }
    /* A run that ends early has bins as long as those of the others. */
    size_t points = has_bins(p) ? points_of(turns) : MOST_POINTS;
    size_t whole =
        points < MOST_POINTS ? parts * ENVELOPE_PARTS / (last + 1) : parts;
    size_t each = (whole + points - 1) / points;
    for (size_t i = 0; i < ENVELOPE_PARTS; i++) {
        if (e->part[i].value < 0)
            continue;
        if (is_first(seen, each, parts) ||
            e->part[i].value > e->part[largest].value)
            largest = i;
        if (++seen == parts || is_first(seen, each, parts))
            plot_point(to, series, e->part[largest].t, e->part[largest].value);
    }
    add_exit(to, integrator, e);
}
