/* nevh run --plot: what kinds of pictures share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/row.h"
#include "run_plot_private.h"
#include <math.h>
#include <string.h>

/* Columns. */

static int read_panel(column_panels *c, const char *names) {
    char *copy = text_print("%s", names), *rest = copy;
    int status = TOOL_OK;
    while (!status && rest) {
        char *colon = strchr(rest, ':');
        if (colon)
            *colon = '\0';
        status = columns_add(&c->columns, rest);
        if (!status)
            c->panel[c->columns.count - 1] = c->panels;
        rest = colon ? colon + 1 : NULL;
    }
    c->panels++;
    return status;
}

int column_panels_read(column_panels *c, const plan *p, const char *text) {
    list panels = {0};
    int status = TOOL_OK;
    list_split(&panels, text);
    *c = (column_panels){.columns = columns_new(p),
                         .panel =
                             tool_allocate(strlen(text) + 1, sizeof(size_t))};
    for (size_t i = 0; !status && i < panels.count; i++)
        status = read_panel(c, panels.item[i]);
    return status;
}

/* An orbit_fill; data are column_panels. */
static void fill_columns(void *data, double t, const double q[],
                         const double p[], double values[]) {
    columns_values(&((column_panels *)data)->columns, t, q, p, values);
}

/* Runs. */

int picture_follow(run_picture *picture, const row_times *times, size_t columns,
                   orbit_fill *fill, void *data) {
    int worst = TOOL_OK;
    for (size_t i = 0; i < picture->orbits.count; i++) {
        int status = orbit_follow(&picture->orbits.item[i], times, columns,
                                  fill, data, picture->quiet);
        worst = status > worst ? status : worst;
    }
    return worst;
}

int column_panels_follow(run_picture *picture, const row_times *times,
                         column_panels *c) {
    int worst = TOOL_OK;
    for (size_t i = 0; i < picture->orbits.count; i++) {
        orbit *o = &picture->orbits.item[i];
        columns_follow(&c->columns, o->integrator, o->plan.dt[0]);
        int status = orbit_follow(o, times, c->columns.count, fill_columns, c,
                                  picture->quiet);
        worst = status > worst ? status : worst;
    }
    return worst;
}

bool picture_refer(run_picture *picture, size_t columns, orbit_fill *fill,
                   void *data) {
    plan *p = &picture->plan;
    if (plan_reference(p, p->t_end) || !p->reference)
        return false;
    orbit *o = &picture->reference;
    o->plan = *p;
    o->name = text_print(
        "%s", strncmp(nevh_reference_text(p->reference), "exact", 5) == 0
                  ? "exact solution"
                  : "reference");
    return orbit_follow_reference(o, p->reference, columns, fill, data) > 1;
}

bool column_panels_refer(run_picture *picture, column_panels *c) {
    return picture_refer(picture, c->columns.count, fill_columns, c);
}

size_t picture_columns(const run_picture *picture) {
    return picture->orbits.count + (picture->reference.rows.count > 1);
}

size_t picture_across(const run_picture *picture) {
    size_t all = picture_columns(picture);
    return all > 4 ? 3 : all > 3 ? 2 : all;
}

const orbit *picture_orbit(const run_picture *picture, size_t column) {
    bool refers = picture->reference.rows.count > 1;
    return refers && column == 0 ? &picture->reference
                                 : &picture->orbits.item[column - refers];
}

char *picture_heading(const run_picture *picture, size_t column) {
    static const double rounding = 1e-9;
    const orbit *o = picture_orbit(picture, column);
    const char *name =
        o->integrator && picture->orbits.count == 1 ? o->integrator : o->name;
    double end = picture->plan.t_end;
    if (o->status || o->t < end - rounding * fabs(end))
        return text_print("%s, %s t = %.4g", name,
                          o->integrator ? "ended at" : "until", o->t);
    return text_print("%s", name);
}

static const double picture_room = 0.04; /* of a range, at either end */

static void widen(picture_range *e, const orbit *o, const size_t columns[],
                  size_t count) {
    for (size_t i = 0; i < o->rows.count; i++)
        for (size_t k = 0; k < count; k++) {
            double value = orbit_row(o, i)[columns[k]];
            if (isfinite(value)) {
                e->low = fmin(e->low, value);
                e->high = fmax(e->high, value);
            }
        }
}

picture_range picture_extent(const run_picture *picture, const size_t columns[],
                             size_t count) {
    picture_range first = {INFINITY, -INFINITY}, all;
    widen(&first, picture_orbit(picture, 0), columns, count);
    all = first;
    for (size_t i = 1; i < picture_columns(picture); i++)
        widen(&all, picture_orbit(picture, i), columns, count);
    double far = (first.high - first.low) / 2;
    all.low = fmax(all.low, first.low - far);
    all.high = fmin(all.high, first.high + far);
    double more = all.high > all.low ? picture_room * (all.high - all.low) : 1;
    return (picture_range){all.low - more, all.high + more};
}

int column_panels_check(const run_picture *picture, column_panels *c) {
    for (size_t i = 0; i < picture->orbits.count; i++) {
        const orbit *o = &picture->orbits.item[i];
        if (!columns_follow(&c->columns, o->integrator, o->plan.dt[0]))
            return TOOL_OK;
    }
    return tool_refuse("--columns: shadow_error: %s",
                       nevh_shadow_message(c->columns.shadow));
}

/* 1, 2 or 5 times a power of ten that is not longer. */
static double rounded(double span) {
    double power = pow(10, floor(log10(span))), digits = span / power;
    return power * (digits >= 5 ? 5 : digits >= 2 ? 2 : 1);
}

char *picture_cut(run_picture *picture, double turns, double wanted) {
    const double most = 2.4 * wanted;
    double begin = picture->plan.run->t_start, whole = picture->plan.t_end;
    if (picture->options->t_end || picture->data.points || turns <= most)
        return NULL;
    picture->plan.t_end = begin + rounded((whole - begin) * wanted / turns);
    for (size_t i = 0; i < picture->orbits.count; i++)
        picture->orbits.item[i].plan.t_end = picture->plan.t_end;
    return text_print("a part of the run: --t-end %g shows all", whole);
}

/* Outliers are farther from the quartiles than three times what is between these: J. W.
   Tukey, Exploratory Data Analysis (1977), calls them "far out". */
bool picture_widen_measured(run_picture *picture, const char *column,
                            picture_range *r) {
    static const double far = 3;
    const measured *m = &picture->data;
    size_t k = measured_find(m, column), count = 0;
    bool outside = false;
    if (k == m->columns || !m->points)
        return false;
    double *sorted = tool_allocate(m->points, sizeof *sorted);
    for (size_t i = 0; i < m->points; i++)
        if (isfinite(m->value[i * m->columns + k]))
            sorted[count++] = m->value[i * m->columns + k];
    numbers_sort(sorted, count);
    double first = count ? sorted[count / 4] : 0;
    double third = count ? sorted[3 * count / 4] : 0;
    double low = fmin(r->low, first - far * (third - first));
    double high = fmax(r->high, third + far * (third - first));
    double more = picture_room * (r->high - r->low);
    for (size_t i = 0; i < count; i++)
        if (third > first && (sorted[i] < low || sorted[i] > high)) {
            outside = true;
        } else {
            r->low = fmin(r->low, sorted[i] - more);
            r->high = fmax(r->high, sorted[i] + more);
        }
    picture->outside |= outside;
    return outside;
}

void picture_hold_measured(run_picture *picture, const char *x, const char *y,
                           picture_range *across, picture_range *up) {
    const measured *m = &picture->data;
    if (measured_find(m, x) == m->columns || measured_find(m, y) == m->columns)
        return;
    picture_widen_measured(picture, x, across);
    picture_widen_measured(picture, y, up);
}

void picture_measured(const run_picture *picture, plot *to, const char *name,
                      const char *x, const char *y, double period) {
    const measured *m = &picture->data;
    size_t across = x ? measured_find(m, x) : 0, up = measured_find(m, y);
    if (!m->points || across == m->columns || up == m->columns)
        return;
    size_t series = plot_series(to, name);
    plot_style(to, series, PLOT_MEASURED);
    for (size_t i = 0; i < m->points; i++) {
        const double *value = m->value + i * m->columns;
        double at = x ? value[across] : m->t[i];
        if (period > 0)
            at -= period * floor(at / period + 0.5);
        plot_point(to, series, at, value[up]);
    }
}

static bool has_one_integrator(const orbits *all) {
    bool same = true;
    for (size_t i = 1; i < all->count; i++)
        same =
            same && strcmp(all->item[i].integrator, all->item->integrator) == 0;
    return same;
}

char *picture_early(const run_picture *picture) {
    char *text = text_print("%s", "");
    for (size_t i = 0; i < picture->orbits.count; i++) {
        const orbit *o = &picture->orbits.item[i];
        if (o->status)
            text_extend(&text, "%s%s ended at t = %.4g%s", *text ? "; " : "",
                        picture->orbits.count > 1 ? o->name : o->integrator,
                        o->t, picture->plan.unit);
    }
    return text;
}

void picture_note(const run_picture *picture, plot *to, const char *more) {
    const orbits *all = &picture->orbits;
    char *scheme =
        all->count == 1 ? plot_scheme(&all->item->plan, all->item->integrator)
        : picture->plan.dts == 1 || picture->options->dt.count <= 1
            ? text_print("dt = %.4g%s", picture->plan.dt[0], picture->plan.unit)
        : has_one_integrator(all) ? text_print("%s", all->item->integrator)
                                  : NULL;
    char *others = list_joined(&all->left_out);
    char *text = text_print("%s%s%s", *others ? "not drawn: " : "", others,
                            *others && *more ? "; " : "");
    text_extend(&text, "%s", more);
    if (picture->outside)
        text_extend(&text, "%smeasured outliers are outside",
                    *text ? "; " : "");
    plot_note_run(to, &picture->plan, scheme, text);
}

/* Kinds. */

enum { RUN, COLUMNS, PICTURE };
#define PLOT_ROW(name, draws, help) [PLOT_KIND_##name] = {plot_##name, draws},
static const struct {
    plot *(*draw)(run_picture *);
    int draws;
} kinds[] = {[PLOT_USUAL] = {plot_phase, COLUMNS}, RUN_PLOTS(PLOT_ROW)};

static int check_kind(const options *o, const plan *p) {
    bool columns = kinds[o->plot.kind].draws == COLUMNS;
    if (o->fit.data && plot_wanted(o) && !columns)
        return tool_refuse("--data is drawn over --plot-kind time or phase");
    if (o->columns && !(plot_wanted(o) && columns))
        return tool_refuse("--columns is for --plot with --plot-kind time or "
                           "phase");
    if (plot_wanted(o) && kinds[o->plot.kind].draws == PICTURE &&
        nevh_scene_part_count(p->scene) == 0)
        return tool_refuse("%s: the scene has no [picture] to plot, as: bob = "
                           "x, y",
                           p->name);
    return TOOL_OK;
}

int run_plot_check(const options *o, const plan *p) {
    options as = *o;
    as.file = o->resume ? o->resume : o->file;
    as.format = plot_replaces_rows(o)       ? FORMAT_TABLE
                : option_given(o, "format") ? o->format
                                            : FORMAT_CSV;
    return check_kind(o, p) ? TOOL_USAGE : plot_check(&as);
}

static size_t points_of(const run_picture *picture) {
    return picture->orbits.count ? picture->orbits.item[0].rows.seen : 0;
}

static int worst_status(const run_picture *picture) {
    int worst = TOOL_OK;
    for (size_t i = 0; i < picture->orbits.count; i++)
        worst = picture->orbits.item[i].status > worst
                    ? picture->orbits.item[i].status
                    : worst;
    return worst;
}

int run_plot(const options *o, const plan *p, const char *integrator,
             const row_times *rows) {
    run_picture picture = {.options = o,
                           .plan = *p,
                           .orbits = orbits_new(o, p, integrator),
                           .rows = o->every || o->samples || o->at.count ? rows
                                                                         : NULL,
                           .quiet = !plot_replaces_rows(o)};
    if (o->fit.data && measured_read(&picture.data, p, o, NULL))
        return TOOL_USAGE;
    measured_bound(&picture.data, &picture.plan, o);
    plot *to = kinds[o->plot.kind].draw(&picture);
    int status = to ? plot_write(to, o) : TOOL_USAGE;
    if (!status) {
        plot_written_report(o, &picture.orbits.item->plan,
                            picture.orbits.item->integrator,
                            points_of(&picture));
        status = worst_status(&picture);
    }
    if (picture.plan.reference != p->reference)
        nevh_reference_free(picture.plan.reference);
    return status;
}
