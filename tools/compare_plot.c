/* nevh compare --plot: energy errors against time, a panel a dt.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "envelope.h"
#include "plot.h"
#include <stdlib.h>

static const double absurd = 100; /* of an error relative to the energy */
enum { MOST_PANELS = 9, MOST_POINTS = 300 };

/* Whether the row begins a group of rows with numbers. */
static bool begins(const row rows[], size_t i) {
    for (size_t k = i; k-- > 0 && rows[k].group == rows[i].group;)
        if (rows[k].ran)
            return false;
    return rows[i].ran;
}

static char *heading(const plan *p, const row *r) {
    const char *unit = nevh_scene_label(p->scene, "t");
    char *dt =
        r->tolerance > 0
            ? text_print("steps by tolerance")
            : text_print(*unit ? "dt = %.4g %s" : "dt = %.4g%s", r->dt, unit);
    if (p->gradients.count < 2)
        return dt;
    char *both = text_print("%s, %s", dt, r->gradient);
    free(dt);
    return both;
}

static const char *what(const plan *p) {
    return p->balance ? "|error of the balance|, relative"
                      : "|energy error|, relative";
}

static void begin_panel(plot *to, const plan *p, const row *r, size_t panels) {
    char *x = plot_label(p, "t", "t"), *text = heading(p, r);
    if (panels)
        plot_panel(to, text, x, what(p));
    else
        plot_heading(to, text);
    plot_log(to, false, true);
    plot_span_x(to, p->run->t_start, p->t_end);
    plot_limit_y(to, 0, absurd);
    free(text);
    free(x);
}

/* The largest of a few parts each where there are many, so that oscillations
   do not fill the panel. */
static void draw_envelope(plot *to, size_t series, const envelope *e) {
    size_t parts = 0, largest = 0, seen = 0;
    for (size_t i = 0; i < ENVELOPE_PARTS; i++)
        parts += e->part[i].value >= 0;
    size_t each = parts / MOST_POINTS + 1;
    for (size_t i = 0; i < ENVELOPE_PARTS; i++) {
        if (e->part[i].value < 0)
            continue;
        if (seen++ % each == 0 || e->part[i].value > e->part[largest].value)
            largest = i;
        if (seen % each == 0 || seen == parts)
            plot_point(to, series, e->part[largest].t, e->part[largest].value);
    }
}

static void draw_row(plot *to, const plan *p, const row *r) {
    char *name = r->tolerance > 0 && p->tolerances > 1
                     ? text_print("%s, %g", r->integrator, r->tolerance)
                     : text_print("%s", r->integrator);
    size_t series = plot_series(to, name);
    plot_style(to, series, PLOT_MARKED);
    draw_envelope(to, series, r->errors);
    free(name);
}

int compare_plot(const options *o, const plan *p, const row rows[],
                 size_t count) {
    const char *title = nevh_scene_title(p->scene);
    char *x = plot_label(p, "t", "t");
    plot *to = plot_new(*title ? title : p->name, x, what(p));
    size_t panels = 0;
    for (size_t i = 0; i < count && panels <= MOST_PANELS; i++) {
        if (begins(rows, i) && panels++ < MOST_PANELS)
            begin_panel(to, p, &rows[i], panels - 1);
        if (rows[i].ran && panels <= MOST_PANELS)
            draw_row(to, p, &rows[i]);
    }
    plot_same_ranges(to);
    int status = plot_write(to, o);
    plot_free(to);
    free(x);
    return status;
}
