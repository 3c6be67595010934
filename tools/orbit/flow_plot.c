/* nevh flow --plot: a panel an integrator, with its shapes at all times.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "flow.h"
#include "plot/plot.h"
#include <math.h>

enum { MOST_SHAPES = 6 };

/* The part of the plane that is drawn; shapes are moved by whole periods next to the
   middle. */
typedef struct {
    double middle, low_x, high_x, low_y, high_y;
} window;

/* A shape as it is drawn. */
typedef struct {
    double middle; /* NAN: there is none */
    bool drawn;    /* false: a thread that would cover the panel */
} outline;

typedef struct {
    const flow_job *job;
    outline *shapes; /* those of all times, row by row */
} picture;

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

static const outline *shape_of(const picture *f, const flow_row *r,
                               size_t time) {
    return &f->shapes[(size_t)(r - f->job->row) * f->job->times + time];
}

/* A whole number of periods that brings a shape next to the window's middle. */
static double shift_of(const picture *f, const outline *s, const window *w) {
    double period = nevh_scene_period(f->job->plan.scene, plane(f->job));
    double off = s->middle - w->middle;
    return period > 0 && !isnan(off) ? period * floor(off / period + 0.5) : 0;
}

/* A shape is drawn where its area is resolved, and its outline at most 12 times as long
   as the diagonal of what it covers, of a circle 2.2. */
static outline measured(const flow_job *j, const nevh_loop *l, size_t time) {
    static const double most = 12;
    window w = {0, INFINITY, -INFINITY, INFINITY, -INFINITY};
    double *q = tool_allocate(2 * j->plan.n, sizeof *q), *p = q + j->plan.n;
    double sum = 0, length = 0, last_x = NAN, last_y = NAN;
    size_t count = 0;
    for (; nevh_loop_shape(l, time, count, q, p); count++) {
        sum += q[plane(j)];
        widen(&w, q[plane(j)], p[plane(j)]);
    }
    double x = w.high_x - w.low_x, y = w.high_y - w.low_y;
    for (size_t k = 0; nevh_loop_shape(l, time, k, q, p); k++) {
        double step =
            hypot((q[plane(j)] - last_x) / x, (p[plane(j)] - last_y) / y);
        length += isnan(step) ? 0 : step;
        last_x = q[plane(j)];
        last_y = p[plane(j)];
    }
    nevh_loop_area at = nevh_loop_result(l, time);
    return (outline){sum / (double)count,
                     time == 0 || (flow_resolved(at) && !at.inside &&
                                   length / sqrt(2) <= most)};
}

static picture measure(const flow_job *j) {
    picture f = {j, tool_allocate(j->rows * j->times, sizeof *f.shapes)};
    for (size_t i = 0; i < j->rows * j->times; i++)
        f.shapes[i] = measured(j, j->row[i / j->times].loop, i % j->times);
    return f;
}

static bool keeps(const flow_job *j, const flow_row *r) {
    bool transformed;
    return nevh_integrator_symplectic(plan_scheme(&j->plan, r->integrator,
                                                  &transformed)) == NEVH_YES &&
           !isnan(nevh_loop_result(r->loop, 0).area);
}

static void widen_by(window *w, const picture *f, const flow_row *r,
                     size_t time) {
    static const double large = 4;
    const flow_job *j = f->job;
    const outline *s = shape_of(f, r, time);
    double ratio = nevh_loop_result(r->loop, time).area /
                   nevh_loop_result(r->loop, 0).area;
    if (!s->drawn || fabs(ratio) > large)
        return;
    double *q = tool_allocate(2 * j->plan.n, sizeof *q), *p = q + j->plan.n;
    double shift = shift_of(f, s, w);
    for (size_t k = 0; nevh_loop_shape(r->loop, time, k, q, p); k++)
        widen(w, q[plane(j)] - shift, p[plane(j)]);
}

/* The window holds the shapes of symplectic integrators, if there are any; others
   may leave it. Shapes that are much larger than at first are left out. */
static window find_window_at(const picture *f, double middle) {
    static const double margin = 0.08;
    const flow_job *j = f->job;
    window w = {middle, INFINITY, -INFINITY, INFINITY, -INFINITY};
    bool any = false;
    for (size_t i = 0; i < j->rows; i++)
        any = any || keeps(j, &j->row[i]);
    for (size_t i = 0; i < j->rows; i++)
        if (keeps(j, &j->row[i]) || !any)
            for (size_t time = 0; time < j->times; time++)
                widen_by(&w, f, &j->row[i], time);
    double x = margin * (w.high_x - w.low_x), y = margin * (w.high_y - w.low_y);
    w.low_x -= x;
    w.high_x += x;
    w.low_y -= y;
    w.high_y += y;
    return w;
}

/* About 0, or about the start, where the shapes then are closer together. */
static window find_window(const picture *f) {
    window w = find_window_at(f, 0);
    double start = NAN;
    for (size_t i = 0; i < f->job->rows && isnan(start); i++)
        start = shape_of(f, &f->job->row[i], 0)->middle;
    if (!isnan(start)) {
        window other = find_window_at(f, start);
        if (other.high_x - other.low_x < 0.99 * (w.high_x - w.low_x))
            w = other;
    }
    return w;
}

static size_t new_series(plot *to, const flow_row *r, plot_form form) {
    size_t series = plot_series(to, NULL);
    plot_style(to, series, form);
    plot_set_look(to, series, plot_look_of_integrator(r->integrator));
    return series;
}

/* Draws the outline, interrupted where neighbouring points are far apart. */
static void draw_outline(plot *to, const flow_job *j, const nevh_loop *l,
                         size_t time, size_t series, double shift,
                         const window *w) {
    static const double far = 0.25; /* of the window */
    bool closed = j->plan.n == 1;
    size_t count = 0;
    double *q = tool_allocate(2 * j->plan.n, sizeof *q), *p = q + j->plan.n;
    double last_x = NAN, last_y = NAN;
    for (; nevh_loop_shape(l, time, count, q, p); count++) {
        double x = q[plane(j)] - shift, y = p[plane(j)];
        if (!closed && (fabs(x - last_x) > far * (w->high_x - w->low_x) ||
                        fabs(y - last_y) > far * (w->high_y - w->low_y)))
            plot_break(to, series);
        plot_point(to, series, x, y);
        last_x = x;
        last_y = y;
    }
    if (!closed && nevh_loop_shape(l, time, 0, q, p))
        plot_point(to, series, q[plane(j)] - shift, p[plane(j)]);
}

/* Names the time at the right end of the shape, where that is in the window;
   returns whether any of it is. */
static bool name_time(plot *to, const flow_job *j, const nevh_loop *l,
                      size_t time, double shift, const window *w) {
    double *q = tool_allocate(2 * j->plan.n, sizeof *q), *p = q + j->plan.n;
    double right = -INFINITY, up = 0;
    for (size_t k = 0; nevh_loop_shape(l, time, k, q, p); k++) {
        double x = q[plane(j)] - shift, y = p[plane(j)];
        if (x > right && x >= w->low_x && x <= w->high_x && y >= w->low_y &&
            y <= w->high_y) {
            right = x;
            up = y;
        }
    }
    if (!isfinite(right))
        return false;
    size_t series =
        plot_series(to, text_print("t = %.4g%s", nevh_loop_result(l, time).t,
                                   j->plan.unit));
    plot_style(to, series, PLOT_GUIDE);
    plot_point(to, series, right, up);
    return true;
}

static void draw_shape(plot *to, const flow_job *j, const flow_row *r,
                       size_t time, double shift, const window *w) {
    plot_form form = j->plan.n == 1 ? PLOT_FILLED : PLOT_TRAIL;
    draw_outline(to, j, r->loop, time, new_series(to, r, form), shift, w);
    for (int i = 0; i < FLOW_EYES; i++)
        if (r->eye[i])
            draw_outline(to, j, r->eye[i], time, new_series(to, r, PLOT_HOLE),
                         shift, w);
}

/* Digits after the point that tell a ratio from 1: four of its own, or two of the
   difference. */
static int digits_from_1(double ratio) {
    double apart = fabs(ratio - 1);
    int own = (int)fmin(fmax(3 - floor(log10(fabs(ratio) + 1e-9)), 0), 9);
    return apart > 0 ? (int)fmin(fmax(own, 1 - floor(log10(apart))), 12) : own;
}

static char *ratio_text(double ratio) {
    static const double small = 1e-4, large = 1e6;
    return fabs(ratio) < small || fabs(ratio) >= large
               ? text_print("%.4g", ratio)
               : text_print("%.*f", digits_from_1(ratio), ratio);
}

/* The last time of which the area is known; 0: none but the first. */
static size_t last_known(const flow_job *j, const flow_row *r) {
    size_t last = 0;
    for (size_t i = 1; i < j->times; i++) {
        nevh_loop_area at = nevh_loop_result(r->loop, i);
        last = !isnan(at.area) && flow_resolved(at) ? i : last;
    }
    return last;
}

/* The change of the area by the scheme, as far as that is known. */
static char *area_words(const flow_job *j, const flow_row *r) {
    static const double nothing = 5e-7;
    double first = nevh_loop_result(r->loop, 0).area, worst = 0;
    nevh_loop_area last = nevh_loop_result(r->loop, last_known(j, r));
    for (size_t i = 1; i < j->times; i++) {
        nevh_loop_area at = nevh_loop_result(r->loop, i);
        if (!isnan(at.area) && flow_resolved(at))
            worst = fmax(worst, fabs(at.area / first - 1));
    }
    /* The sum is kept, not the area of the plane that is drawn. */
    const char *area = j->plan.n > 1 ? "sum of areas" : "area";
    if (!last_known(j, r))
        return text_print("area unresolved");
    if (worst < nothing)
        return text_print("%s kept until t = %.4g%s", area, last.t,
                          j->plan.unit);
    return text_print("%s \303\227 %s until t = %.4g%s", area,
                      ratio_text(last.area / first), last.t, j->plan.unit);
}

/* Every so many times has a shape. */
static size_t every_of(const flow_job *j) {
    return (j->times + MOST_SHAPES - 1) / MOST_SHAPES;
}

size_t flow_drawn_times(const flow_job *j, const flow_row *r) {
    size_t every = every_of(j), drawn = 0;
    for (size_t i = 0; i < j->times; i += every)
        if (flow_resolved(nevh_loop_result(r->loop, i)) &&
            measured(j, r->loop, i).drawn)
            drawn = i + 1;
    return drawn;
}

/* The time of the last shape of a panel. */
static double last_drawn(const picture *f, const flow_row *r) {
    size_t every = every_of(f->job), last = 0;
    for (size_t time = 0; time < f->job->times; time += every)
        last = shape_of(f, r, time)->drawn ? time : last;
    return f->job->time[last];
}

/* The same of all panels. */
static double last_of_all(const picture *f) {
    const flow_job *j = f->job;
    double last = j->time[0];
    for (size_t i = 0; i < j->rows; i++)
        if (!isnan(nevh_loop_result(j->row[i].loop, 0).area))
            last = fmax(last, last_drawn(f, &j->row[i]));
    return last;
}

static bool has_one_dt(const flow_job *j) {
    return j->rows < 2 || j->row[0].dt == j->row[j->rows - 1].dt;
}

static char *heading_of(const picture *f, const flow_row *r, bool outside) {
    const flow_job *j = f->job;
    char *area = area_words(j, r), *dt = NULL, *until = NULL;
    bool whole = !isnan(nevh_loop_result(r->loop, j->times - 1).area),
         any = !isnan(nevh_loop_result(r->loop, 1).area);
    if (last_drawn(f, r) < last_of_all(f) &&
        last_drawn(f, r) != j->time[last_known(j, r)])
        until = text_print(", drawn until t = %.4g%s", last_drawn(f, r),
                           j->plan.unit);
    if (!has_one_dt(j))
        dt = text_print(", dt = %.4g%s", r->dt, j->plan.unit);
    return text_print("%s%s: %s%s%s%s", r->integrator, dt ? dt : "",
                      whole || any ? area : "failed",
                      any && !whole ? ", then failed" : "", until ? until : "",
                      outside ? ", outside" : "");
}

static void begin_panel(plot **to, const flow_job *j, const window *w) {
    const char *name = nevh_scene_coordinate(j->plan.scene, plane(j));
    char *momentum = text_print("p_%s", name);
    char *x = plot_label(&j->plan, name, name);
    char *y = plot_label(&j->plan, momentum, momentum);
    if (*to)
        plot_panel(*to, NULL, x, y);
    else
        *to = plot_new(j->plan.title, x, y);
    plot_span_x(*to, w->low_x, w->high_x);
    plot_span_y(*to, w->low_y, w->high_y);
}

/* Later shapes are longer: they are behind.
   returns  how many are left out */
static size_t draw_panel(plot **to, const picture *f, const flow_row *r,
                         const window *w) {
    const flow_job *j = f->job;
    size_t every = every_of(j), left_out = 0;
    bool outside = false;
    begin_panel(to, j, w);
    for (size_t k = (j->times - 1) / every + 1; k-- > 0;) {
        const outline *s = shape_of(f, r, k * every);
        double shift = shift_of(f, s, w);
        if (s->drawn) {
            draw_shape(*to, j, r, k * every, shift, w);
            outside |= !name_time(*to, j, r->loop, k * every, shift, w);
        } else
            left_out++;
    }
    plot_heading(*to, heading_of(f, r, outside));
    return left_out;
}

/* The time that is named is that of the last shape. */
static void note(plot *to, const picture *f, size_t left_out) {
    const flow_job *j = f->job;
    plan shown = j->plan;
    shown.t_end = last_of_all(f);
    char *dt = has_one_dt(j)
                   ? text_print("dt = %.4g%s", j->row[0].dt, j->plan.unit)
                   : NULL;
    char *more = text_print(
        "%s at the times named; area over the first%s%s", j->shape.text,
        j->plan.n > 1 ? ", summed over all planes, of which one is drawn" : "",
        left_out ? "; shapes that are long threads are not drawn" : "");
    plot_note_run(to, &shown, dt, more);
}

int flow_plot(const flow_job *j, const options *o) {
    plot *to = NULL;
    picture f = measure(j);
    window w = find_window(&f);
    size_t left_out = 0;
    for (size_t i = 0; i < j->rows; i++) {
        if (isnan(nevh_loop_result(j->row[i].loop, 0).area))
            continue; /* refused */
        left_out += draw_panel(&to, &f, &j->row[i], &w);
    }
    if (to)
        note(to, &f, left_out);
    if (!to)
        return tool_refuse("nothing to plot: no integrator fits");
    return plot_write(to, o);
}
