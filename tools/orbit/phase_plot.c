/* nevh run --plot-kind phase: momenta over coordinates, or any column over
   another.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_plot_private.h"
#include <math.h>
#include <string.h>

enum { MOST_COORDINATES = 4, PHASE_TURNS = 20 };

/* x is x:p_x. */
static char *pairs_of(const options *o, const plan *p) {
    list names = {0};
    char *text = text_print("%s", "");
    if (o->columns)
        list_split(&names, o->columns);
    else
        for (size_t k = 0; k < p->n && k < MOST_COORDINATES; k++)
            list_add(&names, nevh_scene_coordinate(p->scene, k));
    for (size_t i = 0; i < names.count; i++) {
        const char *name = names.item[i], *comma = i ? "," : "";
        text_extend(&text, "%s%s", comma, name);
        if (!strchr(name, ':'))
            text_extend(&text, ":p_%s", name);
    }
    return text;
}

static int check_pairs(const column_panels *c) {
    size_t *count = tool_allocate(c->panels, sizeof *count);
    int status = TOOL_OK;
    for (size_t i = 0; i < c->columns.count; i++)
        count[c->panel[i]]++;
    for (size_t i = 0; !status && i < c->panels; i++)
        if (count[i] != 2)
            status = tool_refuse("--plot-kind phase takes --columns A:B, which "
                                 "draws B over A, or a coordinate alone");
    return status;
}

/* The period to take the column modulo; 0 where it stays within one. */
static double wrapping(const run_picture *picture, const column_panels *c,
                       size_t k) {
    double period = plan_period(&picture->plan, c->columns.item[k].name);
    picture_range e = picture_extent(picture, &k, 1);
    return e.high - e.low > period ? period : 0;
}

/* A line leaves the panel at one side, and comes in at the other. */
static void turn_over(plot *to, size_t series, const double from[],
                      const double at[], double old, double new) {
    plot_point(to, series, at[0] - old, at[1]);
    plot_break(to, series);
    plot_point(to, series, from[0] - new, from[1]);
}

static double shift_of(double q, double period) {
    return period > 0 ? period * floor(q / period + 0.5) : 0;
}

static void draw_orbit(plot *to, const orbit *o, size_t k, double period) {
    size_t series = plot_series(to, NULL);
    bool whole = o->rows.part == 1;
    double last = 0;
    if (o->integrator)
        plot_integrator(to, series, o->integrator);
    plot_style(to, series,
               !o->integrator ? PLOT_REFERENCE
               : whole        ? PLOT_TRAIL
                              : PLOT_DOTS);
    for (size_t i = 0; i < o->rows.count; i++) {
        const double *at = orbit_row(o, i) + k;
        double shift = shift_of(at[0], period);
        if (i && shift != last && whole)
            turn_over(to, series, orbit_row(o, i - 1) + k, at, last, shift);
        plot_point(to, series, at[0] - shift, at[1]);
        last = shift;
    }
    if (!o->rows.count || !o->integrator)
        return;
    const double *begin = orbit_row(o, 0) + k;
    size_t start = plot_series(to, NULL);
    plot_style(to, start, PLOT_START);
    plot_like(to, start, series);
    plot_point(to, start, begin[0] - shift_of(begin[0], period), begin[1]);
}

/* A row of panels. */
static void draw_panels(plot **to, run_picture *picture, const column_panels *c,
                        size_t number) {
    size_t k = 2 * number;
    char *x = column_label(&picture->plan, &c->columns.item[k]);
    char *y = column_label(&picture->plan, &c->columns.item[k + 1]);
    double period = wrapping(picture, c, k);
    size_t y_column = k + 1;
    picture_range across = picture_extent(picture, &k, 1);
    picture_range up = picture_extent(picture, &y_column, 1);
    picture_hold_measured(picture, c->columns.item[k].name,
                          c->columns.item[y_column].name, &across, &up);
    for (size_t i = 0; i < picture_columns(picture); i++) {
        char *heading = number ? NULL : picture_heading(picture, i);
        if (*to)
            plot_panel(*to, heading, x, y);
        else
            *to = plot_new(picture->plan.title, x, y);
        if (number + i == 0)
            plot_heading(*to, heading);
        if (period > 0)
            plot_span_x(*to, -period / 2, period / 2);
        else
            plot_span_x(*to, across.low, across.high);
        plot_span_y(*to, up.low, up.high);
        draw_orbit(*to, picture_orbit(picture, i), k, period);
        picture_measured(picture, *to, "measured", c->columns.item[k].name,
                         c->columns.item[k + 1].name, period);
    }
}

/* Points are drawn where both columns of a panel were measured. */
static int check_measured(const run_picture *picture, const column_panels *c) {
    const measured *m = &picture->data;
    for (size_t k = 0; k + 1 < c->columns.count; k += 2)
        if (measured_find(m, c->columns.item[k].name) < m->columns &&
            measured_find(m, c->columns.item[k + 1].name) < m->columns)
            return TOOL_OK;
    return m->points ? tool_refuse("--data %s has no two columns that "
                                   "--plot-kind phase draws over each other: "
                                   "--columns A:B says which, or --plot-kind "
                                   "time",
                                   m->file)
                     : TOOL_OK;
}

static char *note_text(const run_picture *picture, const char *cut) {
    const plan *p = &picture->plan;
    char *energy = plot_energy_at_start(p), *others = text_print("%s", "");
    if (p->n > MOST_COORDINATES && !picture->options->columns) {
        others = text_print("; the first %d of %zu coordinates: --columns "
                            "chooses others",
                            MOST_COORDINATES, p->n);
    }
    return text_print("circle: the start; %s%s%s%s", energy, others,
                      cut ? "; " : "", cut ? cut : "");
}

/* True if a column is known of schemes alone. */
static bool has_shadow(const quantities *c) {
    bool any = false;
    for (size_t k = 0; k < c->count; k++)
        any |= c->item[k].kind == COLUMN_SHADOW_ERROR;
    return any;
}

static void follow(run_picture *picture, column_panels *c) {
    row_times dense = orbit_dense_times(&picture->plan);
    column_panels_follow(picture, &dense, c);
}

/* The number of turns of the slowest panel that moves. */
static double least_turns(const orbit *o, size_t panels) {
    double least = INFINITY;
    for (size_t k = 0; k < 2 * panels; k += 2) {
        double turns = fmax(orbit_turns(o, k), orbit_turns(o, k + 1));
        least = turns > 0 ? fmin(least, turns) : least;
    }
    return isfinite(least) ? least : 0;
}

/* Some twenty turns, or fewer of which all steps are kept, so that they are lines
   and not dots. */
static double turns_wanted(const orbit *o, double turns) {
    static const double fewest = 5;
    double kept = turns * o->rows.part;
    return o->rows.part < 1 && kept > fewest ? fmin(kept, PHASE_TURNS)
                                             : PHASE_TURNS;
}

/* A curve that does not close would fill an area: its run is cut.
   returns  what is to be said of it */
static char *follow_and_cut(run_picture *picture, column_panels *c) {
    const plan *p = &picture->plan;
    bool closes =
        p->n == 1 &&
        (nevh_system_traits(nevh_scene_system(p->scene)) & NEVH_AUTONOMOUS);
    follow(picture, c);
    const orbit *first = picture->orbits.item;
    double turns = least_turns(first, c->panels);
    char *words =
        closes ? NULL : picture_cut(picture, turns, turns_wanted(first, turns));
    if (words)
        follow(picture, c);
    return words;
}

plot *plot_phase(run_picture *picture) {
    column_panels c = {0};
    plot *to = NULL;
    char *names = pairs_of(picture->options, &picture->plan);
    if (!column_panels_read(&c, &picture->plan, names) && !check_pairs(&c) &&
        !check_measured(picture, &c) && !column_panels_check(picture, &c)) {
        char *cut = follow_and_cut(picture, &c);
        if (!has_shadow(&c.columns))
            column_panels_refer(picture, &c);
        for (size_t i = 0; i < c.panels; i++)
            draw_panels(&to, picture, &c, i);
        plot_columns(to, c.panels > 1 ? picture_columns(picture)
                                      : picture_across(picture));
        picture_note(picture, to, note_text(picture, cut));
    }
    columns_free(&c.columns);
    return to;
}
