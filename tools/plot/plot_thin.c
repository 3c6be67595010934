/* nevh: plots: curves and dots as far as a screen can show them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

/* Over the detail of a screen: plot_thin_error follows from them. */
static const double cell_of_detail = 2, dot_of_detail = 3;

static double part(double value, range r, bool log) {
    return log ? log10(value / r.low) / log10(r.high / r.low)
               : (value - r.low) / (r.high - r.low);
}

pair plot_in_pixels(const plot_screen *s, pair p) {
    return (pair){s->width * part(p.x, s->x, s->log_x),
                  s->height * part(p.y, s->y, s->log_y)};
}

/* Directions from a point through the circles of the tolerance round those after
   it, relative to the first that is farther away than that. [C. M. Williams, An
   efficient algorithm for the piecewise linear approximation of planar curves,
   Computer Graphics and Image Processing 8 (1978) 286-293] */
typedef struct {
    pair from, first;
    double low, high, farthest, tolerance;
} sleeve;

static sleeve sleeve_at(pair from, double tolerance) {
    return (sleeve){from, {0, 0}, -INFINITY, INFINITY, 0, tolerance};
}

/* True if a line to that point is near enough to all points before it. None of
   these is farther away, so that none is beyond its end. */
static bool sleeve_reaches(sleeve *v, pair to) {
    pair d = {to.x - v->from.x, to.y - v->from.y};
    double distance = hypot(d.x, d.y);
    if (distance <= v->tolerance)
        return v->farthest == 0;
    if (!(distance >= v->farthest && distance < INFINITY))
        return false;
    if (v->farthest == 0)
        v->first = d;
    double angle = atan2(v->first.x * d.y - v->first.y * d.x,
                         v->first.x * d.x + v->first.y * d.y);
    double half = asin(v->tolerance / distance);
    if (!(angle >= v->low && angle <= v->high))
        return false;
    v->low = fmax(v->low, angle - half);
    v->high = fmin(v->high, angle + half);
    v->farthest = distance;
    return true;
}

/* Thins a line without breaks. */
static size_t thin_line(const plot_screen *s, const pair from[], size_t count,
                        pair to[]) {
    size_t kept = 0, last = 0; /* that was kept */
    to[kept++] = from[0];
    pair before = plot_in_pixels(s, from[0]);
    sleeve v = sleeve_at(before, s->detail);
    for (size_t i = 1; i < count; i++) {
        pair at = plot_in_pixels(s, from[i]);
        if (!sleeve_reaches(&v, at)) {
            if (last < i - 1)
                to[kept++] = from[last = i - 1];
            v = sleeve_at(before, s->detail);
            if (!sleeve_reaches(&v, at)) {
                to[kept++] = from[last = i];
                v = sleeve_at(at, s->detail);
            }
        }
        before = at;
    }
    if (last < count - 1)
        to[kept++] = from[count - 1];
    return kept;
}

/* Cells of the panel in which something is drawn. */
typedef struct {
    const plot_screen *screen;
    double side;
    size_t columns, rows;
    bool *drawn;
} cells;

static cells cells_new(const plot_screen *s, double details) {
    double side = details * s->detail;
    cells c = {s, side, (size_t)(s->width / side) + 1,
               (size_t)(s->height / side) + 1, NULL};
    c.drawn = tool_allocate(c.columns * c.rows, sizeof *c.drawn);
    return c;
}

/* NULL: outside, where nothing is seen. */
static bool *cell_of(const cells *c, pair at) {
    if (!(at.x >= 0 && at.x <= c->screen->width && at.y >= 0 &&
          at.y <= c->screen->height))
        return NULL;
    return &c->drawn[(size_t)(at.y / c->side) * c->columns +
                     (size_t)(at.x / c->side)];
}

/* True if the line from a to b enters a cell that was empty; draws: marks its
   cells. */
static bool walk_line(const cells *c, pair a, pair b, bool draws) {
    double length = hypot(b.x - a.x, b.y - a.y);
    size_t count = (size_t)ceil(length / c->side);
    bool is_new = false;
    for (size_t i = 0; i <= count; i++) {
        double along = count ? (double)i / (double)count : 0;
        bool *drawn = cell_of(
            c, (pair){a.x + along * (b.x - a.x), a.y + along * (b.y - a.y)});
        is_new |= drawn && !*drawn;
        if (drawn && draws)
            *drawn = true;
    }
    return is_new;
}

static bool draw_line(const cells *c, pair a, pair b) {
    const plot_screen *s = c->screen;
    return plot_clip(&a, &b, (pair){0, 0}, (pair){s->width, s->height}) &&
           walk_line(c, a, b, false) && walk_line(c, a, b, true);
}

/* Parts of a line where nothing is drawn yet. */
static size_t thin_drawn(const cells *c, const pair from[], size_t count,
                         bool first, pair to[]) {
    size_t kept = 0;
    bool on = false;
    for (size_t i = 1; i < count; i++) {
        bool was_on = on;
        on = draw_line(c, plot_in_pixels(c->screen, from[i - 1]),
                       plot_in_pixels(c->screen, from[i]));
        if (on && !was_on) {
            if (kept || !first)
                to[kept++] = (pair){NAN, NAN};
            to[kept++] = from[i - 1];
        }
        if (on)
            to[kept++] = from[i];
    }
    return kept;
}

static size_t run_length(const pair from[], size_t count) {
    size_t length = 0;
    while (length < count && !isnan(from[length].x))
        length++;
    return length;
}

static size_t thin_lines(const plot_screen *s, bool solid, const pair from[],
                         size_t count, pair to[]) {
    cells c = solid ? cells_new(s, cell_of_detail) : (cells){0};
    pair *line = tool_allocate(count, sizeof *line);
    size_t kept = 0, length;
    for (size_t i = 0; i < count; i += length + 1) {
        length = run_length(from + i, count - i);
        size_t points = length ? thin_line(s, from + i, length, line) : 0;
        if (points && solid) {
            kept += thin_drawn(&c, line, points, kept == 0, to + kept);
        } else if (points) {
            if (kept)
                to[kept++] = (pair){NAN, NAN};
            memcpy(to + kept, line, points * sizeof *to);
            kept += points;
        }
    }
    tool_release(line);
    tool_release(c.drawn);
    return kept;
}

/* A cell has one at most. */
static size_t thin_dots(const plot_screen *s, const pair from[], size_t count,
                        pair to[]) {
    cells c = cells_new(s, dot_of_detail);
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool *drawn = cell_of(&c, plot_in_pixels(s, from[i]));
        if (drawn && !*drawn) {
            *drawn = true;
            to[kept++] = from[i];
        }
    }
    tool_release(c.drawn);
    return kept;
}

double plot_thin_error(plot_thinning how, double detail) {
    double details = how == THIN_DOTS    ? sqrt(2) * dot_of_detail
                     : how == THIN_SOLID ? 1 + (sqrt(2) + 0.5) * cell_of_detail
                                         : 1;
    return details * detail;
}

size_t plot_thin(const plot_screen *s, plot_thinning how, const pair from[],
                 size_t count, pair to[]) {
    return how == THIN_DOTS ? thin_dots(s, from, count, to)
                            : thin_lines(s, how == THIN_SOLID, from, count, to);
}

/* Clips the line to one side of a limit: from and to, in units of its length,
   shrink. False if nothing remains. */
static bool clip(double along, double room, double *from, double *to) {
    if (along > 0)
        *to = fmin(*to, room / along);
    else if (along < 0)
        *from = fmax(*from, room / along);
    else if (room < 0)
        return false;
    return *from <= *to;
}

bool plot_clip(pair *a, pair *b, pair low, pair high) {
    double from = 0, to = 1, x = b->x - a->x, y = b->y - a->y;
    if (!isfinite(x) || !isfinite(y) || !clip(x, high.x - a->x, &from, &to) ||
        !clip(-x, a->x - low.x, &from, &to) ||
        !clip(y, high.y - a->y, &from, &to) ||
        !clip(-y, a->y - low.y, &from, &to))
        return false;
    if (to < 1)
        *b = (pair){a->x + to * x, a->y + to * y};
    if (from > 0)
        *a = (pair){a->x + from * x, a->y + from * y};
    return true;
}
