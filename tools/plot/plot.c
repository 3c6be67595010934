/* nevh: plots: panels, series and points.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

/* gnuplot computes with ranges. */
static const double largest = 1e300, smallest = 1e-300;

static char *copy(const char *text) {
    return text ? text_print("%s", text) : NULL;
}

plot *plot_new(const char *title, const char *x, const char *y) {
    plot *p = tool_allocate(1, sizeof *p);
    p->title = copy(title);
    plot_panel(p, NULL, x, y);
    return p;
}

void plot_panel(plot *p, const char *heading, const char *x, const char *y) {
    p->panel = tool_grown(p->panel, p->panels, sizeof *p->panel);
    p->panel[p->panels++] = (panel){.heading = copy(heading),
                                    .x = copy(x),
                                    .y = copy(y),
                                    .span_x = {NAN, NAN},
                                    .span_y = {NAN, NAN},
                                    .limit_y = {-largest, largest}};
}

void plot_note(plot *p, const char *text) {
    p->note = copy(text);
}

static panel *current(const plot *p) {
    return &p->panel[p->panels - 1];
}

void plot_heading(plot *p, const char *text) {
    current(p)->heading = copy(text);
}

void plot_log(plot *p, bool x, bool y) {
    current(p)->log_x = x;
    current(p)->log_y = y;
}

void plot_equal(plot *p) {
    current(p)->equal = true;
}

void plot_span_x(plot *p, double low, double high) {
    current(p)->span_x = (range){low, high};
}

void plot_stack(plot *p) {
    p->stacked = true;
}

static double *copy_of(const double values[], size_t count) {
    double *to = tool_allocate(count, sizeof *to);
    return memcpy(to, values, count * sizeof *to);
}

void plot_map(plot *p, size_t columns, const double x[], size_t rows,
              const double y[], const double z[], const char *label) {
    static const double decades = 1e3;
    range r = {INFINITY, -INFINITY};
    p->map = (field_map){columns,
                         rows,
                         copy_of(x, columns),
                         copy_of(y, rows),
                         copy_of(z, columns * rows),
                         copy(label),
                         .log = false};
    for (size_t i = 0; i < columns * rows; i++)
        if (isfinite(z[i])) {
            r.low = fmin(r.low, z[i]);
            r.high = fmax(r.high, z[i]);
        }
    p->map.log = r.low > 0 && r.high > decades * r.low;
    if (!(r.low < r.high))
        r = (range){r.low - fmax(fabs(r.low), 1) / 2,
                    r.high + fmax(fabs(r.high), 1) / 2};
    p->map.shown = r;
    plot_map_rank(&p->map);
    if (p->map.ranked)
        p->map.label = text_print("%s, by rank", label ? label : "");
}

void plot_then(plot *p, plot *next) {
    p->next = next;
}

void plot_columns(plot *p, size_t columns) {
    p->beside = columns;
}

void plot_span_y(plot *p, double low, double high) {
    current(p)->span_y = (range){low, high};
}

void plot_limit_y(plot *p, double low, double high) {
    current(p)->limit_y = (range){low, high};
}

void plot_least_y(plot *p, double factor) {
    current(p)->least_y = factor;
}

void plot_same_ranges(plot *p, double times) {
    p->same_ranges = times;
}

/* Finds the look of a series of the same name; else the first free one: in the
   panel for those without a name, in the plot for the others. */
static size_t find_look(const plot *p, const char *name) {
    static const bool grey[PLOT_GUIDE + 1] = {
        [PLOT_BEHIND] = true, [PLOT_REFERENCE] = true, [PLOT_RODS] = true,
        [PLOT_GUIDE] = true,  [PLOT_LEVEL] = true,     [PLOT_SEPARATRIX] = true,
        [PLOT_CENTRE] = true, [PLOT_SADDLE] = true,    [PLOT_MEASURED] = true,
    };
    size_t look = 0;
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (name && s->name && strcmp(name, s->name) == 0)
            return s->look;
        if (!grey[s->form] && (name || s->panel == p->panels - 1) &&
            look <= s->look)
            look = s->look + 1;
    }
    return look;
}

size_t plot_series(plot *p, const char *name) {
    size_t look = find_look(p, name);
    p->series = tool_grown(p->series, p->count, sizeof *p->series);
    p->series[p->count] = (series){
        .name = copy(name), .panel = p->panels - 1, .look = look, .size = 1};
    return p->count++;
}

void plot_style(plot *p, size_t number, plot_form form) {
    p->series[number].form = form;
}

void plot_size(plot *p, size_t number, double size) {
    p->series[number].size = size;
}

void plot_dash(plot *p, size_t number, size_t dash) {
    p->series[number].dash = dash;
}

void plot_like(plot *p, size_t number, size_t other) {
    p->series[number].look = p->series[other].look;
}

void plot_set_look(plot *p, size_t number, size_t look) {
    p->series[number].look = look;
}

enum { COLOURS = 8, BLACK = 4 }; /* see looks.h */

void plot_dash_apart(plot *p, size_t number) {
    size_t dash = 0;
    for (size_t i = 0; i < number; i++)
        dash += p->series[i].panel == p->series[number].panel &&
                p->series[i].form == p->series[number].form &&
                p->series[i].look % COLOURS == p->series[number].look % COLOURS;
    plot_dash(p, number, dash);
}

void plot_integrator(plot *p, size_t number, const char *name) {
    size_t look = plot_look_of_integrator(name);
    series *own = &p->series[number];
    for (bool taken = true; taken; look += taken ? COLOURS : 0) {
        taken = false;
        for (size_t i = 0; i < p->count && !taken; i++) {
            const series *s = &p->series[i];
            taken = i != number && s->look == look && own->name && s->name &&
                    strcmp(own->name, s->name) != 0;
        }
    }
    own->look = look;
}

void plot_member(plot *p, size_t number, size_t member, size_t members) {
    enum { MARKS = 2 };
    static const double usual = 0.6, least = 0.3;
    bool many = members > MARKS * COLOURS; /* rings would hide each other */
    double share = many ? (double)(MARKS * COLOURS) / (double)members : 1;
    bool ring = !many && member / COLOURS % 2;
    bool skips = members < COLOURS && member >= BLACK; /* the separatrix */
    plot_set_look(p, number, member % COLOURS + skips);
    plot_style(p, number, ring ? PLOT_RINGS : PLOT_DOTS);
    plot_size(p, number, fmax(least, usual * sqrt(share)));
}

static void add(series *s, pair point) {
    s->point = tool_grown(s->point, s->count, sizeof *s->point);
    s->point[s->count++] = point;
}

void plot_break(plot *p, size_t number) {
    series *s = &p->series[number];
    if (s->count && !isnan(s->point[s->count - 1].x))
        add(s, (pair){NAN, NAN});
}

static bool shown(const panel *on, double x, double y) {
    return (x > smallest || !on->log_x) && (y > smallest || !on->log_y);
}

void plot_point(plot *p, size_t number, double x, double y) {
    series *s = &p->series[number];
    if (!(fabs(x) < largest && fabs(y) < largest))
        plot_break(p, number);
    else if (shown(&p->panel[s->panel], x, y))
        add(s, (pair){x, y});
    else
        p->hidden++;
}
