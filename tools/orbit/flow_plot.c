/* nevh flow --plot: the shapes, side by side.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "flow.h"
#include "plot/plot.h"
#include <math.h>
#include <stdlib.h>

enum { MOST_COLUMNS = 6 };

typedef struct {
    double low_x, high_x, low_y, high_y;
} window;

static void widen(window *w, double x, double y) {
    w->low_x = fmin(w->low_x, x);
    w->high_x = fmax(w->high_x, x);
    w->low_y = fmin(w->low_y, y);
    w->high_y = fmax(w->high_y, y);
}

/* The coordinate that is drawn: that of the shape's plane. */
static size_t plane(const flow_job *j) {
    return j->shape.kind == FLOW_LOOP ? 0 : j->shape.k;
}

/* A whole number of periods that brings the middle of a shape next to 0. */
static double shift_of(const flow_job *j, const nevh_loop *l, size_t time) {
    double period = nevh_scene_period(j->plan.scene, plane(j));
    double sum = 0, *q = tool_allocate(j->plan.n, sizeof *q);
    size_t count = 0;
    for (; nevh_loop_shape(l, time, count, q, NULL); count++)
        sum += q[plane(j)];
    free(q);
    return period > 0 && count
               ? period * floor(sum / (double)count / period + 0.5)
               : 0;
}

static bool keeps(const flow_job *j, const flow_row *r) {
    bool transformed;
    return nevh_integrator_symplectic(plan_scheme(&j->plan, r->integrator,
                                                  &transformed)) == NEVH_YES &&
           !isnan(nevh_loop_result(r->loop, 0).area);
}

/* The window holds the shapes of symplectic integrators, if there are any; others
   may leave it. Shapes that are much larger than at first are left out. */
static window find_window(const flow_job *j) {
    static const double large = 4;
    window w = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    double *q = tool_allocate(2 * j->plan.n, sizeof *q), *p = q + j->plan.n;
    bool any = false;
    for (size_t i = 0; i < j->rows; i++)
        any = any || keeps(j, &j->row[i]);
    for (size_t i = 0; i < j->rows; i++)
        if (keeps(j, &j->row[i]) || !any)
            for (size_t time = 0; time < j->times; time++) {
                const nevh_loop *l = j->row[i].loop;
                nevh_loop_area at = nevh_loop_result(l, time);
                if (time &&
                    (isnan(at.area) || !flow_resolved(at) || at.inside ||
                     fabs(at.area / nevh_loop_result(l, 0).area) > large))
                    continue;
                double shift = shift_of(j, l, time);
                for (size_t k = 0; nevh_loop_shape(l, time, k, q, p); k++)
                    widen(&w, q[plane(j)] - shift, p[plane(j)]);
            }
    free(q);
    double x = 0.04 * (w.high_x - w.low_x), y = 0.04 * (w.high_y - w.low_y);
    w.low_x -= x;
    w.high_x += x;
    w.low_y -= y;
    w.high_y += y;
    return w;
}

/* Draws the outline, interrupted where neighbouring points are far apart. */
static void draw_outline(plot *to, const flow_job *j, const nevh_loop *l,
                         size_t time, double shift, plot_form form,
                         const window *w) {
    static const double far = 0.25; /* of the window */
    size_t series = plot_series(to, NULL), count = 0;
    double *q = tool_allocate(2 * j->plan.n, sizeof *q), *p = q + j->plan.n;
    double last_x = NAN, last_y = NAN;
    plot_style(to, series, form);
    for (; nevh_loop_shape(l, time, count, q, p); count++) {
        double x = q[plane(j)] - shift, y = p[plane(j)];
        if (form == PLOT_TRAIL &&
            (fabs(x - last_x) > far * (w->high_x - w->low_x) ||
             fabs(y - last_y) > far * (w->high_y - w->low_y)))
            plot_break(to, series);
        plot_point(to, series, x, y);
        last_x = x;
        last_y = y;
    }
    if (form == PLOT_TRAIL && nevh_loop_shape(l, time, 0, q, p))
        plot_point(to, series, q[plane(j)] - shift, p[plane(j)]);
    free(q);
}

static bool is_shown(const flow_job *j, const nevh_loop *l, size_t time,
                     const window *w) {
    double *q = tool_allocate(2 * j->plan.n, sizeof *q), *p = q + j->plan.n;
    double shift = shift_of(j, l, time);
    bool shown = false;
    for (size_t k = 0; !shown && nevh_loop_shape(l, time, k, q, p); k++) {
        double x = q[plane(j)] - shift, y = p[plane(j)];
        shown =
            x >= w->low_x && x <= w->high_x && y >= w->low_y && y <= w->high_y;
    }
    free(q);
    return shown;
}

static char *heading_of(const flow_job *j, const flow_row *r, size_t time,
                        bool named, const window *w) {
    nevh_loop_area at = nevh_loop_result(r->loop, time);
    double ratio = at.area / nevh_loop_result(r->loop, 0).area;
    char *area = isnan(at.area) ? text_print("failed")
                 : !flow_resolved(at) && !at.inside
                     ? text_print("area unresolved")
                 : fabs(ratio - 1) < 5e-7 ? text_print("area 1")
                                          : text_print("area %.4g", ratio);
    const char *where =
        isnan(at.area) || is_shown(j, r->loop, time, w) ? "" : ", outside";
    char *text =
        named ? text_print("%s, t = %.4g%s", r->integrator, at.t, j->plan.unit)
              : text_print("t = %.4g%s, %s%s", at.t, j->plan.unit, area, where);
    free(area);
    return text;
}

static void draw_panel(plot **to, const flow_job *j, const flow_row *r,
                       size_t time, bool named, const window *w) {
    const char *name = nevh_scene_coordinate(j->plan.scene, plane(j));
    char *momentum = text_print("p_%s", name);
    char *x = plot_label(&j->plan, name, name);
    char *y = plot_label(&j->plan, momentum, momentum);
    char *heading = heading_of(j, r, time, named, w);
    nevh_loop_area at = nevh_loop_result(r->loop, time);
    if (*to) {
        plot_panel(*to, heading, x, y);
    } else {
        *to = plot_new(j->plan.title, x, y);
        plot_heading(*to, heading);
    }
    plot_span_x(*to, w->low_x, w->high_x);
    plot_span_y(*to, w->low_y, w->high_y);
    double shift = shift_of(j, r->loop, time);
    draw_outline(*to, j, r->loop, time, shift,
                 flow_resolved(at) && !at.inside && j->plan.n == 1 ? PLOT_FILLED
                                                                   : PLOT_TRAIL,
                 w);
    for (int i = 0; i < FLOW_EYES; i++)
        if (r->eye[i] && flow_resolved(at) && !at.inside)
            draw_outline(*to, j, r->eye[i], time, shift, PLOT_HOLE, w);
    free(momentum);
    free(x);
    free(y);
    free(heading);
}

int flow_plot(const flow_job *j, const options *o) {
    plot *to = NULL;
    window w = find_window(j);
    size_t every = (j->times + MOST_COLUMNS - 1) / MOST_COLUMNS, columns = 0;
    for (size_t i = 0; i < j->rows; i++) {
        if (isnan(nevh_loop_result(j->row[i].loop, 0).area))
            continue; /* refused */
        columns = 0;
        for (size_t time = 0; time < j->times; time += every, columns++)
            draw_panel(&to, j, &j->row[i], time, columns == 0, &w);
    }
    if (!to)
        return tool_refuse("nothing to plot: no integrator fits");
    plot_columns(to, columns);
    char *more = text_print("%s; area 1: that at the start", j->shape.text);
    plot_note_run(to, &j->plan, NULL, more);
    free(more);
    int drawn = plot_write(to, o);
    plot_free(to);
    return drawn;
}
