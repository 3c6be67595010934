/* nevh compare --plot: energy errors against time, a panel a dt.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/orbit.h"
#include "plot/energy_plot.h"
#include <math.h>

enum { MOST_PANELS = 9 };

/* True if the row is the first of its group with numbers. */
static bool begins(const row rows[], size_t i) {
    for (size_t k = i; k-- > 0 && rows[k].group == rows[i].group;)
        if (rows[k].ran)
            return false;
    return rows[i].ran;
}

static char *heading(const plan *p, const row *r) {
    char *dt = r->tolerance > 0 ? text_print("steps by tolerance")
                                : text_print("dt = %.4g%s", r->dt, p->unit);
    if (p->gradients.count > 1)
        text_extend(&dt, ", %s", r->gradient);
    return dt;
}

static void begin_panel(plot **to, const plan *p, const row *r) {
    char *text = heading(p, r);
    if (*to)
        energy_plot_panel(*to, p, text);
    else
        *to = energy_plot_new(p, p->title, text);
}

static void draw_row(plot *to, const plan *p, double turns, const row *r) {
    char *name = r->tolerance > 0 && p->tolerances > 1
                     ? text_print("%s, %g", r->integrator, r->tolerance)
                     : text_print("%s", r->integrator);
    energy_plot_add(to, p, turns, name, r->integrator, r->errors);
}

/* Adds to the words the rows that failed, which have no curve. */
static void note_failed(const plan *p, const row rows[], size_t count,
                        char **words) {
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        const row *r = &rows[i];
        if (!r->failed || r->ran)
            continue;
        text_extend(words, "%s%s, %s",
                    any       ? "; "
                    : **words ? "; failed: "
                              : "failed: ",
                    r->integrator, heading(p, r));
        any = true;
    }
}

/* The end of the axes: where the last run ended, if the scene's stop ended all. */
static double shown_end(const plan *p, const row rows[], size_t count) {
    double last = nevh_scene_stops(p->scene) ? p->run->t_start : p->t_end;
    for (size_t i = 0; i < count; i++) {
        double end = isnan(rows[i].stopped) ? p->t_end : rows[i].t_end;
        last = rows[i].ran && fabs(end - p->run->t_start) >
                                  fabs(last - p->run->t_start)
                   ? end
                   : last;
    }
    return last;
}

int compare_plot(const options *o, const plan *p, const row rows[],
                 size_t count) {
    plot *to = NULL;
    size_t panels = 0;
    plan shown = *p;
    double turns = orbit_turns_of(p);
    shown.t_end = shown_end(p, rows, count);
    for (size_t i = 0; i < count; i++) {
        panels += begins(rows, i);
        if (!rows[i].ran || panels > MOST_PANELS)
            continue;
        if (begins(rows, i))
            begin_panel(&to, p, &rows[i]);
        plot_span_x(to, p->run->t_start, shown.t_end);
        draw_row(to, p, turns, &rows[i]);
    }
    if (!to) {
        bool failed = false;
        for (size_t i = 0; i < count; i++)
            failed |= rows[i].failed;
        tool_refuse("there is nothing to plot: no row has numbers");
        return failed ? TOOL_FAILED : TOOL_USAGE;
    }
    plot_same_ranges(to, INFINITY);
    char *more = energy_plot_words(p, turns);
    note_failed(p, rows, count, &more);
    plot_note_run(to, &shown, NULL, more);
    return plot_write(to, o);
}
