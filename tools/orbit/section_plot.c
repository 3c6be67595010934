/* nevh section --plot: points.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/plot.h"
#include <math.h>
#include <string.h>

/* One of the numbers of all points. */
typedef struct {
    const double *number;
    size_t points, width;
    double period; /* 0: none */
    double begin;  /* of the period to show */
} column;

/* An angle that stays in one half turn is not to be cut there. */
static double find_begin(const column *c) {
    double *sorted = tool_allocate(c->points, sizeof *sorted);
    double begin = -c->period / 2;
    for (size_t k = 0; k < c->points; k++)
        sorted[k] = c->number[k * c->width];
    numbers_sort(sorted, c->points);
    for (size_t k = 1; k < c->points; k++)
        if (sorted[k] - sorted[k - 1] > c->period / 2)
            begin = (sorted[k] + sorted[k - 1]) / 2;
    return begin;
}

static column column_of(const plan *p, const char *name, size_t points,
                        const double numbers[], size_t width, size_t place) {
    column c = {numbers + place, points, width, plan_period(p, name), 0};
    if (c.period > 0 && points)
        c.begin = find_begin(&c);
    return c;
}

static double value(const column *c, size_t k) {
    static const double nothing = 1e-12; /* of a turn: rounding */
    double x = c->number[k * c->width];
    if (c->period > 0 && x < c->begin)
        x += c->period;
    return fabs(x) < nothing * c->period ? 0 : x;
}

/* A section of one degree of freedom holds what crosses at one value. */
static bool is_level(const column *c) {
    static const double nothing = 1e-9;
    double low = INFINITY, high = -INFINITY, size = c->period;
    for (size_t k = 0; k < c->points; k++) {
        double x = c->number[k * c->width];
        low = fmin(low, x);
        high = fmax(high, x);
        size = fmax(size, fabs(x));
    }
    return c->points > 1 && high - low <= nothing * fmax(size, 1e-6);
}

static size_t new_series(plot *to, const char *name, plot_form form,
                         const char *integrator) {
    size_t series = plot_series(to, name);
    plot_style(to, series, form);
    plot_set_look(to, series, plot_look_of_integrator(integrator));
    return series;
}

/* "swing: phi1 = 0, rising". */
static char *plane_of(const plan *p, const nevh_scene_section *decl) {
    if (decl->every > 0)
        return text_print("%s: every %.6g%s", decl->name, decl->every, p->unit);
    return text_print("%s: %s = %s%s", decl->name, decl->left, decl->right,
                      decl->direction > 0   ? ", rising"
                      : decl->direction < 0 ? ", falling"
                                            : "");
}

static void add_panel(plot **to, const plan *p, const nevh_scene_section *decl,
                      size_t points, const char *across, const char *up,
                      const char *own) {
    char *plane = plane_of(p, decl);
    char *heading =
        text_print(points ? "%s" : "%s; no points", own ? own : plane);
    char *x = plot_label(p, across, across), *y = plot_label(p, up, up);
    if (!*to) {
        *to = plot_new(p->title, x, y);
        plot_heading(*to, heading);
    } else
        plot_panel(*to, heading, x, y);
}

/* A series an orbit. */
static void draw_members(plot *to, const column *x, const column *y,
                         const size_t member[], const list *names) {
    size_t series = 0, members = x->points ? member[x->points - 1] + 1 : 0;
    for (size_t k = 0; k < x->points; k++) {
        for (size_t i = k ? member[k - 1] + 1 : 0; i <= member[k]; i++) {
            bool any = i == member[k]; /* others have no point, nor a name */
            series = plot_series(to, names && any ? names->item[i] : NULL);
            plot_member(to, series, i, members);
        }
        plot_point(to, series, value(x, k), value(y, k));
    }
}

/* The first item and the second; a single one, or one beside another that does
   not change, against the time. */
void section_plot(plot **to, const plan *p, const nevh_scene_section *decl,
                  size_t points, const double numbers[], const size_t member[],
                  const list *names, const char *heading,
                  const char *integrator) {
    bool two_ways = decl->direction == 0 && decl->every == 0 && !member;
    size_t width = 2 + decl->items, last = decl->items > 1 ? 1 : 0;
    column t = column_of(p, "t", points, numbers, width, 0);
    column first = column_of(p, decl->item[0], points, numbers, width, 2);
    column y = column_of(p, decl->item[last], points, numbers, width, 2 + last);
    bool level = last == 0 || is_level(&first);
    column x = level ? t : first;
    add_panel(to, p, decl, points, level ? "t" : decl->item[0],
              decl->item[last], heading);
    if (member) {
        draw_members(*to, &x, &y, member, names);
        return;
    }
    size_t rising =
        new_series(*to, two_ways ? "rising" : NULL, PLOT_DOTS, integrator);
    size_t falling =
        two_ways ? new_series(*to, "falling", PLOT_RINGS, integrator) : rising;
    for (size_t k = 0; k < points; k++)
        plot_point(*to, numbers[k * width + 1] < 0 ? falling : rising,
                   value(&x, k), value(&y, k));
}
