/* nevh effects --impact --plot: orbits with and without an effect.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "impact_private.h"
#include <math.h>

enum { TURNS = 12 }; /* of a curve that is not to be a band */

static double value(const trace *o, size_t k, size_t i) {
    return o->states[i * 2 * o->plan->n + k];
}

static double time_of(const trace *o, size_t i) {
    return o->plan->run->t_start + (double)(i * o->every) * o->plan->dt[0];
}

static size_t both_kept(const trace dense[2]) {
    return dense[0].kept < dense[1].kept ? dense[0].kept : dense[1].kept;
}

/* The coordinate that differs most, relative to its range; where none does, the
   first. */
static size_t find_coordinate(const trace dense[2]) {
    size_t found = 0, count = both_kept(dense);
    double largest = 0;
    for (size_t k = 0; k < dense->plan->n; k++) {
        double range = fmax(dense[0].high[k] - dense[0].low[k],
                            dense[1].high[k] - dense[1].low[k]);
        double gap = 0;
        for (size_t i = 0; i < count; i++)
            gap = fmax(gap,
                       fabs(value(&dense[0], k, i) - value(&dense[1], k, i)));
        if (range > 0 && gap > 1e-9 * range && gap / range > largest)
            largest = gap / range, found = k;
    }
    return found;
}

static bool rises(const trace *o, size_t k, size_t i) {
    return value(o, k, i) > value(o, k, i - 1);
}

/* States that the first turns take, or, from the end, the last: between extremes
   of the coordinate. */
static size_t count_turns(const trace *o, size_t k, bool from_end) {
    size_t extremes = 0, i = 2;
    for (; i < o->kept && extremes < 2 * TURNS; i++) {
        size_t at = from_end ? o->kept - i + 1 : i;
        extremes += rises(o, k, at) != rises(o, k, at - 1);
    }
    return i;
}

/* Limits the axis to the range of the orbit with the effect in these times, and 1.5
   times as much on either side: an orbit that leaves without it would make it flat. */
static void limit_values(plot *to, const trace *with, size_t k, double begin,
                         double end) {
    static const double more = 1.5;
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < with->kept; i++)
        if (time_of(with, i) >= begin && time_of(with, i) <= end) {
            low = fmin(low, value(with, k, i));
            high = fmax(high, value(with, k, i));
        }
    double room = more * (high - low);
    if (room > 0)
        plot_limit_y(to, low - room, high + room);
}

/* Times from the start, where the orbits part soon, else up to the end. */
static void choose_span(plot *to, const trace dense[2], size_t k,
                        const difference *d) {
    const trace *with = &dense[1];
    double begin = time_of(with, 0), end = time_of(with, with->kept - 1);
    double first = time_of(with, count_turns(with, k, false) - 1);
    size_t last = count_turns(with, k, true);
    if (d->since < first || first >= end)
        end = first;
    else
        begin = time_of(with, with->kept - last);
    plot_span_x(to, begin, end);
    limit_values(to, with, k, begin, end);
}

static void draw_orbit(plot *to, const trace *o, size_t k, const char *name,
                       plot_form form) {
    size_t series = plot_series(to, name);
    plot_style(to, series, form);
    for (size_t i = 0; i < o->kept; i++)
        plot_point(to, series, time_of(o, i), value(o, k, i));
}

static char *heading_of(const char *effect, const trace *without,
                        const difference *d) {
    for (size_t k = 0; k < without->plan->n; k++)
        if (without->high[k] > without->low[k])
            return d->largest < 0.01
                       ? text_print("%s: %.1e of the range", effect, d->largest)
                       : text_print("%s: %.0f %% of the range", effect,
                                    100 * d->largest);
    return text_print("%s: no coordinate moves without it", effect);
}

void impact_draw(plot **to, const plan *p, const char *effect,
                 const trace dense[2], const difference *d) {
    size_t k = find_coordinate(dense);
    const char *name = nevh_scene_coordinate(p->scene, k);
    char *x = plot_label(p, "t", "t"), *y = plot_label(p, name, name);
    char *heading = heading_of(effect, &dense[0], d);
    if (*to) {
        plot_panel(*to, heading, x, y);
    } else {
        *to = plot_new(p->title, x, y);
        plot_heading(*to, heading);
        plot_note(*to,
                  "With and without each effect; what changes most, and by "
                  "which part of its range; from the start, or, where that "
                  "shows no difference, up to the end.");
    }
    if (dense[1].kept > 2)
        choose_span(*to, dense, k, d);
    draw_orbit(*to, &dense[1], k, "with", PLOT_LINES);
    draw_orbit(*to, &dense[0], k, "without", PLOT_REFERENCE);
}
