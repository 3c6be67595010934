/* nevh run --plot-kind time: columns against time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/row.h"
#include "run_plot_private.h"
#include <math.h>

enum { MOST_PANELS = 9, FEW_ROWS = 80 };

static void add_name(char **text, const char *prefix, const char *name) {
    text_extend(text, "%s%s%s", **text ? "," : "", prefix, name);
}

/* Coordinates and momenta where they are few, else what the scene shows, else
   the first coordinates; and the energy. */
static char *usual_names(const plan *p) {
    enum { FEW = 2, MOST = 4 };
    size_t shown = nevh_scene_shown_count(p->scene, NEVH_OBSERVABLES);
    bool all = p->n <= FEW;
    char *text = text_print("%s", "");
    for (size_t k = 0; k < p->n && k < MOST && (all || !shown); k++)
        add_name(&text, "", nevh_scene_coordinate(p->scene, k));
    for (size_t k = 0; k < p->n && all; k++)
        add_name(&text, "p_", nevh_scene_coordinate(p->scene, k));
    for (size_t i = 0; i < shown && i < MOST && !all; i++)
        add_name(&text, "",
                 nevh_scene_shown_name(p->scene, NEVH_OBSERVABLES, i));
    add_name(&text, "", "energy");
    return text;
}

/* Joins the names of measured columns. */
static char *joined(const list *names) {
    char *text = text_print("%s", "");
    for (size_t i = 0; i < names->count && i < MOST_PANELS; i++)
        add_name(&text, "", names->item[i]);
    return text;
}

static bool is_energy(const quantity *what) {
    return what->kind == COLUMN_ENERGY || what->kind == COLUMN_ENERGY_ERROR ||
           what->kind == COLUMN_SHADOW_ERROR;
}

static double most_turns(const orbit *o, const quantities *c) {
    double most = 0;
    for (size_t k = 0; k < c->count; k++)
        if (!is_energy(&c->item[k]))
            most = fmax(most, orbit_turns(o, k));
    return most;
}

static void follow(run_picture *picture, column_panels *c) {
    row_times dense = orbit_dense_times(&picture->plan);
    column_panels_follow(picture, picture->rows ? picture->rows : &dense, c);
}

/* A run that goes round so often that a curve would be a band is cut.
   returns  what is to be said of it */
static char *follow_and_cut(run_picture *picture, column_panels *c) {
    follow(picture, c);
    char *words =
        picture->rows
            ? NULL
            : picture_cut(picture,
                          most_turns(picture->orbits.item, &c->columns),
                          PICTURE_TURNS);
    if (words)
        follow(picture, c);
    return words ? words : text_print("%s", "");
}

static void draw_reference(plot *to, const orbit *o, size_t k, double base) {
    size_t series = plot_series(to, o->name);
    plot_style(to, series, PLOT_BEHIND);
    for (size_t i = 0; i < o->rows.count; i++)
        plot_point(to, series, orbit_row(o, i)[-1], orbit_row(o, i)[k] - base);
}

/* Which of the columns of its panel it is, and of how many. */
static size_t place_in_panel(const column_panels *c, size_t k, size_t *count) {
    size_t place = 0;
    *count = 0;
    for (size_t i = 0; i < c->columns.count; i++)
        if (c->panel[i] == c->panel[k]) {
            place += i < k;
            ++*count;
        }
    return place;
}

/* The value from which a column is drawn: the energy at the start, where its changes
   are too small beside it for the numbers of an axis and it has a panel of its own;
   else 0. */
static double base_of(const run_picture *picture, const column_panels *c,
                      size_t k) {
    static const double small = 1e-4;
    const orbits *all = &picture->orbits;
    size_t beside;
    place_in_panel(c, k, &beside);
    if (c->columns.item[k].kind != COLUMN_ENERGY || beside > 1 ||
        !all->item->rows.count || picture->data.points)
        return 0;
    double start = orbit_row(all->item, 0)[k], most = 0;
    for (size_t i = 0; i < all->count; i++)
        for (size_t j = 0; j < all->item[i].rows.count; j++)
            most = fmax(most, fabs(orbit_row(&all->item[i], j)[k] - start));
    bool begins = orbit_row(all->item, 0)[-1] == picture->plan.run->t_start;
    return begins && most > 0 && most < small * fabs(start) ? start : 0;
}

/* Several orbits differ by colour, and the columns of a panel by dashes; those
   of a single one by colour. */
static size_t new_series(plot *to, const run_picture *picture,
                         const column_panels *c, size_t k, size_t number,
                         bool exact) {
    size_t count, place = place_in_panel(c, k, &count);
    const orbit *o = &picture->orbits.item[number];
    bool several = picture->orbits.count > 1;
    bool named = several ? place == 0 : count == 1 && exact;
    const char *name = named                   ? o->name
                       : count > 1 && !several ? c->columns.item[k].name
                                               : NULL;
    size_t series = plot_series(to, name);
    if (several ? place == 0 : count == 1)
        plot_integrator(to, series, o->integrator);
    if (several && place > 0) {
        plot_like(to, series, series - place * picture->orbits.count);
        plot_dash(to, series, place);
    }
    return series;
}

/* Between steps a scheme is nearer to the orbit than at their ends: of the
   energy that would be teeth. */
static bool is_shown(const orbit *o, const quantity *what, double t) {
    static const double whole = 1e-6;
    double steps = (t - o->plan.run->t_start) / o->plan.dt[0];
    bool transformed;
    const nevh_integrator *scheme =
        plan_scheme(&o->plan, o->integrator, &transformed);
    return !is_energy(what) || transformed ||
           nevh_integrator_own_time(scheme) ||
           fabs(steps - round(steps)) < whole;
}

static void draw_orbit(plot *to, const run_picture *picture,
                       const column_panels *c, size_t k, size_t number,
                       bool exact) {
    const orbit *o = &picture->orbits.item[number];
    size_t series = new_series(to, picture, c, k, number, exact);
    bool few = picture->rows && o->rows.count <= FEW_ROWS;
    double base = base_of(picture, c, k);
    plot_style(to, series,
               o->rows.part < 1 ? PLOT_DOTS
               : !few           ? PLOT_TRAIL
               : exact          ? PLOT_POINTS
                                : PLOT_BOTH);
    size_t count;
    place_in_panel(c, k, &count);
    if (count == 1)
        plot_dash_apart(to, series);
    for (size_t i = 0; i < o->rows.count; i++) {
        const double *at = orbit_row(o, i);
        if (picture->rows || is_shown(o, &c->columns.item[k], at[-1]))
            plot_point(to, series, at[-1], at[k] - base);
    }
}

/* The label of a panel: the names of its columns. */
static char *panel_label(const run_picture *picture, const column_panels *c,
                         size_t panel) {
    static const char *const dashes[] = {"", " dashed", " dotted",
                                         " dash-dotted", " long dashes"};
    bool several = picture->orbits.count > 1;
    char *text = NULL;
    for (size_t k = 0; k < c->columns.count; k++) {
        if (c->panel[k] != panel)
            continue;
        size_t count, place = place_in_panel(c, k, &count);
        const quantity *what = &c->columns.item[k];
        char *label =
            base_of(picture, c, k) != 0
                ? plot_label(&picture->plan, "energy change", what->name)
                : column_label(&picture->plan, what);
        text_extend(&text, "%s%s%s", text ? ", " : "", label,
                    several && place < 5 ? dashes[place] : "");
    }
    return text;
}

/* Before the end of the run where all have ended early. */
static double last_time(const run_picture *picture) {
    const nevh_scene_run *run = picture->plan.run;
    double end = picture->plan.t_end, last = run->t_start;
    bool early = true;
    for (size_t i = 0; i < picture->orbits.count; i++) {
        const orbit *o = &picture->orbits.item[i];
        early = early && o->status;
        last =
            fabs(o->t - run->t_start) > fabs(last - run->t_start) ? o->t : last;
    }
    return early && last != run->t_start ? last : end;
}

/* Outliers do not stretch the axis of what the panel shows. */
static void limit_measured(plot *to, run_picture *picture,
                           const column_panels *c, size_t panel) {
    bool outside = false;
    picture_range all = {INFINITY, -INFINITY};
    for (size_t k = 0; k < c->columns.count; k++) {
        if (c->panel[k] != panel)
            continue;
        picture_range shown = picture_extent(picture, &k, 1);
        outside |=
            picture_widen_measured(picture, c->columns.item[k].name, &shown);
        all.low = fmin(all.low, shown.low);
        all.high = fmax(all.high, shown.high);
    }
    if (outside)
        plot_limit_y(to, all.low, all.high);
}

static void draw_panel(plot **to, run_picture *picture, column_panels *c,
                       size_t panel, bool exact) {
    char *x = plot_label(&picture->plan, "t", "t");
    char *y = panel_label(picture, c, panel);
    if (panel)
        plot_panel(*to, NULL, x, y);
    else
        *to = plot_new(picture->plan.title, x, y);
    plot_span_x(*to, picture->plan.run->t_start, last_time(picture));
    for (size_t k = 0; k < c->columns.count && exact; k++)
        if (c->panel[k] == panel &&
            c->columns.item[k].kind != COLUMN_SHADOW_ERROR)
            draw_reference(*to, &picture->reference, k, base_of(picture, c, k));
    for (size_t k = 0; k < c->columns.count; k++)
        for (size_t i = 0; i < picture->orbits.count && c->panel[k] == panel;
             i++)
            draw_orbit(*to, picture, c, k, i, exact);
    limit_measured(*to, picture, c, panel);
    for (size_t k = 0; k < c->columns.count; k++) {
        size_t count;
        place_in_panel(c, k, &count);
        const char *column = c->columns.item[k].name;
        char *name = count > 1 ? text_print("measured %s", column)
                               : text_print("measured");
        if (c->panel[k] == panel)
            picture_measured(picture, *to, name, NULL, column, 0);
    }
}

plot *plot_time(run_picture *picture) {
    column_panels c = {0};
    plot *to = NULL;
    char *names = picture->options->columns
                      ? text_print("%s", picture->options->columns)
                  : picture->data.points ? joined(&picture->data.names)
                                         : usual_names(&picture->plan);
    int status = column_panels_read(&c, &picture->plan, names);
    if (!status && c.panels > MOST_PANELS)
        status = tool_refuse("--columns: %d panels at most, not %zu; names "
                             "joined as A:B share one",
                             MOST_PANELS, c.panels);
    if (!status)
        status = column_panels_check(picture, &c);
    if (!status) {
        char *more = follow_and_cut(picture, &c);
        bool exact = column_panels_refer(picture, &c);
        for (size_t i = 0; i < c.panels; i++)
            draw_panel(&to, picture, &c, i, exact);
        plot_stack(to);
        char *early = picture_early(picture);
        text_extend(&more, "%s%s", *more && *early ? "; " : "", early);
        picture_note(picture, to, more);
    }
    columns_free(&c.columns);
    return to;
}
