/* nevh sweep --picture: an outcome over what is varied.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "map.h"
#include "fit/measured.h"
#include "plot/plot.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MEMBERS = 1 << 24 };

struct map {
    options options; /* with --plot as --picture says */
    const plan *plan;
    const nevh_sweep *sweep;
    size_t members, varied, missing;
    double *values; /* members x (varied + 1): the last is the outcome */
    measured data;  /* of no points where there is none */
    double rms;     /* of the data less the outcome; NAN */
};

/* The values that a varied number takes, sorted, each once. */
typedef struct {
    size_t column, count;
    double *value;
} direction;

static bool names_picture(const char *file) {
    static const char *const kinds[] = {".svg", ".png", ".pdf"};
    size_t length = strlen(file);
    for (size_t i = 0; i < 3; i++)
        if (length > 4 && strcmp(file + length - 4, kinds[i]) == 0)
            return true;
    return false;
}

static int check_options(const options *o, const nevh_sweep *s) {
    size_t varied = nevh_sweep_varied(s), number = varied;
    while (number + 1 < nevh_sweep_columns(s) &&
           nevh_sweep_is_verdict(s, number))
        number++;
    if (nevh_sweep_columns(s) != varied + 1)
        return tool_refuse("--picture draws one outcome, and here are %zu: say "
                           "which, as --outcomes '%s'",
                           nevh_sweep_columns(s) - varied,
                           nevh_sweep_column(s, number));
    if (nevh_sweep_is_verdict(s, varied))
        return tool_refuse("--picture draws numbers, and a verdict is none");
    if (nevh_sweep_members(s) > MOST_MEMBERS)
        return tool_refuse("--picture draws %d members at most", MOST_MEMBERS);
    if (o->task || o->tasks)
        return tool_refuse("--picture draws all members: give it to --join");
    if (!names_picture(o->picture))
        return tool_refuse("--picture takes FILE.svg, FILE.png or FILE.pdf, "
                           "not \"%s\"",
                           o->picture);
    return TOOL_OK;
}

/* Columns are what is varied, and the outcome. */
static int read_data(map *m, const plan *p, const options *o) {
    list names = {0};
    for (size_t k = 0; k <= m->varied; k++)
        list_add(&names, nevh_sweep_column(m->sweep, k));
    return o->fit.data ? measured_read_named(&m->data, p, o, &names) : TOOL_OK;
}

int map_new(map **made, const options *o, const plan *p, const nevh_sweep *s) {
    *made = NULL;
    if (!o->picture && o->fit.data)
        return tool_refuse("--data is drawn over a --picture");
    if (!o->picture)
        return TOOL_OK;
    options as = *o;
    as.plot.file = o->picture;
    if (check_options(o, s) || plot_check(&as))
        return TOOL_USAGE;
    map *m = *made = tool_allocate(1, sizeof *m);
    m->options = as;
    m->plan = p;
    m->sweep = s;
    m->members = (size_t)nevh_sweep_members(s);
    m->varied = nevh_sweep_varied(s);
    m->values = tool_allocate(m->members * (m->varied + 1), sizeof *m->values);
    for (size_t i = 0; i < m->members * (m->varied + 1); i++)
        m->values[i] = NAN;
    m->rms = NAN;
    return read_data(m, p, o);
}

void map_take(map *m, uint64_t member, nevh_member_status status,
              const double values[]) {
    if (!m || member >= m->members)
        return;
    double *to = m->values + member * (m->varied + 1);
    memcpy(to, values, (m->varied + 1) * sizeof *to);
    if (status != NEVH_MEMBER_DONE)
        to[m->varied] = NAN;
}

static direction direction_of(const map *m, size_t column) {
    direction d = {column, 0, tool_allocate(m->members, sizeof(double))};
    size_t count = 0;
    for (size_t i = 0; i < m->members; i++) {
        double x = m->values[i * (m->varied + 1) + column];
        if (isfinite(x))
            d.value[count++] = x;
    }
    numbers_sort(d.value, count);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || d.value[i] > d.value[d.count - 1])
            d.value[d.count++] = d.value[i];
    return d;
}

static size_t place_of(const direction *d, double x) {
    const double *found =
        bsearch(&x, d->value, d->count, sizeof x, numbers_compare);
    return found ? (size_t)(found - d->value) : d->count;
}

/* Half a cell more at either end. */
static void span(const direction *d, double *low, double *high) {
    const double *x = d->value, *last = x + d->count - 1;
    *low = x[0] - (x[1] - x[0]) / 2;
    *high = last[0] + (last[0] - last[-1]) / 2;
}

/* The unit of a column "NAME(...)" that is an outcome. */
static nevh_outcome_unit unit_of_column(const map *m, size_t column) {
    const char *name = nevh_sweep_column(m->sweep, column);
    char *word = text_print("%.*s", (int)strcspn(name, "("), name);
    int kind = column < m->varied ? -1 : nevh_outcome_find(word);
    return kind < 0 ? NEVH_UNIT_NONE : nevh_outcomes()[kind]->unit;
}

/* "frequency(x) (rad/s)" */
static char *label_of(const map *m, size_t column) {
    const char *name = nevh_sweep_column(m->sweep, column);
    const char *t = nevh_scene_label(m->plan->scene, "t");
    nevh_outcome_unit unit = unit_of_column(m, column);
    if (unit == NEVH_UNIT_FREQUENCY || unit == NEVH_UNIT_RATE)
        return *t ? text_print("%s (%s/%s)", name,
                               unit == NEVH_UNIT_RATE ? "1" : "rad", t)
                  : text_print("%s", name);
    const char *inner = name + strcspn(name, "(");
    char *of = unit == NEVH_UNIT_TIME ? text_print("t")
               : unit == NEVH_UNIT_OF_FORMULA
                   ? text_print("%.*s", (int)strcspn(inner, ")") - 1, inner + 1)
                   : text_print("%s", name);
    return plot_label(m->plan, name, of);
}

/* Two directions whose values are combined, each pair once, or one alone, whose
   number is taken twice. */
static bool choose_pair(const map *m, const direction *all, size_t pair[2]) {
    for (size_t a = 0; a < m->varied; a++)
        for (size_t b = a + 1; b < m->varied; b++)
            if (all[a].count > 1 && all[b].count > 1 &&
                all[a].count * all[b].count == m->members) {
                pair[0] = a;
                pair[1] = b;
                return true;
            }
    for (size_t a = 0; a < m->varied; a++)
        if (all[a].count == m->members && m->members > 1) {
            pair[0] = pair[1] = a;
            return true;
        }
    return false;
}

static bool find_directions(const map *m, direction found[2], size_t *count) {
    size_t pair[2];
    direction *all = tool_allocate(m->varied, sizeof *all);
    for (size_t k = 0; k < m->varied; k++)
        all[k] = direction_of(m, k);
    bool any = choose_pair(m, all, pair);
    *count = !any ? 0 : pair[0] == pair[1] ? 1 : 2;
    for (size_t k = 0; k < m->varied; k++)
        if (any && (k == pair[0] || k == pair[1]))
            found[k == pair[0] ? 0 : 1] = all[k];
    return any;
}

static int draw_measured(map *m, plot *to, const char *x, const char *y,
                         const char *name) {
    measured *d = &m->data;
    size_t column = measured_find(d, x), row = measured_find(d, y);
    if (!d->points)
        return TOOL_OK;
    if (column == d->columns || row == d->columns)
        return tool_refuse("--data %s: the picture takes columns %s and %s",
                           d->file, x, y);
    size_t series = plot_series(to, name);
    plot_style(to, series, PLOT_MEASURED);
    for (size_t i = 0; i < d->points; i++)
        plot_point(to, series, d->value[i * d->columns + column],
                   d->value[i * d->columns + row]);
    return TOOL_OK;
}

/* The outcome between the members on either side; NAN outside. */
static double interpolated(const direction *d, const double outcome[],
                           double x) {
    for (size_t k = 0; k + 1 < d->count; k++)
        if (x >= d->value[k] && x <= d->value[k + 1])
            return outcome[k] + (outcome[k + 1] - outcome[k]) *
                                    (x - d->value[k]) /
                                    (d->value[k + 1] - d->value[k]);
    return NAN;
}

static void take_rms(map *m, const direction *d, const double outcome[]) {
    const measured *all = &m->data;
    size_t x = measured_find(all, nevh_sweep_column(m->sweep, d->column));
    size_t y = measured_find(all, nevh_sweep_column(m->sweep, m->varied));
    double sum = 0, count = 0;
    for (size_t i = 0; i < all->points; i++) {
        const double *at = all->value + i * all->columns;
        double r = at[y] - interpolated(d, outcome, at[x]);
        sum += isnan(r) ? 0 : r * r;
        count += !isnan(r);
    }
    m->rms = sqrt(sum / count);
}

static plot *draw_line(map *m, const direction *d) {
    plot *to = plot_new(m->plan->title, label_of(m, d->column),
                        label_of(m, m->varied));
    size_t series = plot_series(to, m->data.points ? "computed" : NULL),
           *order = tool_allocate(m->members, sizeof *order);
    double *outcome = tool_allocate(m->members, sizeof *outcome);
    plot_style(to, series, m->members <= 100 ? PLOT_BOTH : PLOT_TRAIL);
    for (size_t i = 0; i < m->members; i++)
        order[place_of(d, m->values[i * (m->varied + 1) + d->column])] = i;
    for (size_t k = 0; k < d->count; k++) {
        double value = m->values[order[k] * (m->varied + 1) + m->varied];
        m->missing += isnan(value);
        plot_point(to, series, d->value[k], value);
        outcome[k] = value;
    }
    if (draw_measured(m, to, nevh_sweep_column(m->sweep, d->column),
                      nevh_sweep_column(m->sweep, m->varied), "measured"))
        to = NULL;
    else if (m->data.points)
        take_rms(m, d, outcome);
    return to;
}

static plot *draw_map(map *m, const direction d[2]) {
    char *z = label_of(m, m->varied);
    plot *to = plot_new(m->plan->title, label_of(m, d[0].column),
                        label_of(m, d[1].column));
    double *values = tool_allocate(m->members, sizeof *values), low, high;
    for (size_t i = 0; i < m->members; i++)
        values[i] = NAN;
    for (size_t i = 0; i < m->members; i++) {
        const double *from = m->values + i * (m->varied + 1);
        size_t column = place_of(&d[0], from[d[0].column]);
        size_t row = place_of(&d[1], from[d[1].column]);
        if (column < d[0].count && row < d[1].count)
            values[row * d[0].count + column] = from[m->varied];
    }
    for (size_t i = 0; i < m->members; i++)
        m->missing += isnan(values[i]);
    plot_map(to, d[0].count, d[0].value, d[1].count, d[1].value, values, z);
    span(&d[0], &low, &high);
    plot_span_x(to, low, high);
    span(&d[1], &low, &high);
    plot_span_y(to, low, high);
    if (draw_measured(m, to, nevh_sweep_column(m->sweep, d[0].column),
                      nevh_sweep_column(m->sweep, d[1].column), NULL))
        to = NULL;
    return to;
}

static int refuse_directions(const map *m) {
    char *names = text_print("%s", "");
    for (size_t k = 0; k < m->varied; k++)
        text_extend(&names, "%s%s", k ? ", " : "",
                    nevh_sweep_column(m->sweep, k));
    return tool_refuse(
        "--picture draws an outcome over one direction, or two whose values "
        "are combined, as range(A, B, N) gives them: not over %s",
        names);
}

int map_draw(map *m, const char *integrator) {
    direction d[2];
    size_t count;
    if (!m)
        return TOOL_OK;
    if (!find_directions(m, d, &count))
        return refuse_directions(m);
    plot *to = count == 2 ? draw_map(m, d) : draw_line(m, &d[0]);
    if (!to)
        return TOOL_USAGE;
    char *more =
        m->missing ? text_print("%zu orbits, %zu without a value%s", m->members,
                                m->missing, count == 2 ? " (hatched)" : "")
        : isnan(m->rms) ? text_print("%zu orbits", m->members)
                        : text_print("%zu orbits; rms of the residuals: %.3g",
                                     m->members, m->rms);
    plot_note_run(to, m->plan, plot_scheme(m->plan, integrator), more);
    return m->missing == m->members
               ? tool_refuse("nothing to draw: no member has a value")
               : plot_write(to, &m->options);
}
