/* nevh: plots: what is in a panel, as SVG.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double radius = 5.25; /* of a mark of size 1: pixels */

/* The data of a path, which begins with M0 0: tenths of a pixel, each point from the
   one before. */
typedef struct {
    FILE *to;
    int x, y, first_x, first_y;
    size_t points;
} path;

/* In pixels, without a zero before the point. */
static void put_tenths(int number, bool apart, FILE *to) {
    int size = abs(number);
    fputs(number < 0 ? "-" : apart ? " " : "", to);
    if (size >= 10 || size == 0)
        fprintf(to, "%d", size / 10);
    if (size % 10)
        fprintf(to, ".%d", size % 10);
}

static void put_point(path *p, bool apart, pair at) {
    int x = (int)lround(10 * at.x), y = (int)lround(10 * at.y);
    if (++p->points % 16 == 0)
        fputc('\n', p->to);
    put_tenths(x - p->x, apart, p->to);
    put_tenths(y - p->y, true, p->to);
    p->x = x;
    p->y = y;
}

static bool is_at(const path *p, pair at) {
    return lround(10 * at.x) == p->x && lround(10 * at.y) == p->y;
}

static void path_move(path *p, pair at) {
    fputc('m', p->to);
    put_point(p, false, at);
    p->first_x = p->x;
    p->first_y = p->y;
}

/* After a move, and after a line, no letter is needed. */
static void path_line(path *p, pair at) {
    if (!is_at(p, at))
        put_point(p, true, at);
}

static void path_close(path *p) {
    fputc('z', p->to);
    p->x = p->first_x;
    p->y = p->first_y;
}

static pair placed(const plot_screen *s, pair at, pair point) {
    pair in = plot_in_pixels(s, point);
    return (pair){at.x + in.x, at.y + s->height - in.y};
}

static bool is_inside(const plot_screen *s, pair at, pair p) {
    return p.x >= at.x && p.x <= at.x + s->width && p.y >= at.y &&
           p.y <= at.y + s->height;
}

static void begin_line(FILE *f, const plot_look *l) {
    fprintf(f, "<path fill='none' stroke='%s' stroke-width='%g'", l->colour,
            l->width);
    for (int i = 0; l->dash[i] > 0; i++)
        fprintf(f, "%s%.3g", i ? " " : " stroke-dasharray='",
                l->dash[i] * l->width / 2);
    fprintf(f, "%s d='M0 0", l->dash[0] > 0 ? "'" : "");
}

static void put_line(FILE *f, const plot_look *l, const plot_screen *s, pair at,
                     const pair point[], size_t count) {
    path p = {.to = f};
    pair end = {at.x + s->width, at.y + s->height};
    begin_line(f, l);
    for (size_t k = 1; k < count; k++) {
        pair a = placed(s, at, point[k - 1]), b = placed(s, at, point[k]);
        if (!plot_clip(&a, &b, at, end))
            continue;
        if (!is_at(&p, a))
            path_move(&p, a);
        path_line(&p, b);
    }
    fputs("'/>\n", f);
}

/* Clips a closed polygon to one side of a line. [I. E. Sutherland, G. W. Hodgman,
   Reentrant polygon clipping, Communications of the ACM 17 (1974) 32-42]
   to  of a capacity of twice as many */
static size_t cut_polygon(const pair from[], size_t count, bool of_y,
                          double limit, double side, pair to[]) {
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        pair a = from[k ? k - 1 : count - 1], b = from[k];
        double before = side * ((of_y ? a.y : a.x) - limit);
        double after = side * ((of_y ? b.y : b.x) - limit);
        if ((before < 0) != (after < 0)) {
            double share = before / (before - after);
            to[kept++] =
                (pair){a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
        }
        if (after >= 0)
            to[kept++] = b;
    }
    return kept;
}

/* point  that of the polygon in pixels; has room for 16 times as many, and
          changes */
static void put_polygon(FILE *f, const plot_look *l, const plot_screen *s,
                        pair at, pair point[], size_t count) {
    path p = {.to = f};
    pair *other = tool_allocate(16 * count, sizeof *other);
    count = cut_polygon(point, count, false, at.x, 1, other);
    count = cut_polygon(other, count, false, at.x + s->width, -1, point);
    count = cut_polygon(point, count, true, at.y, 1, other);
    count = cut_polygon(other, count, true, at.y + s->height, -1, point);
    tool_release(other);
    if (!count)
        return;
    fprintf(f,
            "<path fill='%s' fill-opacity='%g' stroke='%s' stroke-width='%g' "
            "d='M0 0",
            l->colour, l->opacity, l->edge ? l->edge : l->colour, l->width);
    path_move(&p, point[0]);
    for (size_t k = 1; k < count; k++)
        path_line(&p, point[k]);
    path_close(&p);
    fputs("'/>\n", f);
}

static void put_areas(FILE *f, const plot_look *l, const plot_screen *s,
                      pair at, const pair point[], size_t count) {
    pair *polygon = tool_allocate(16 * count, sizeof *polygon);
    size_t points = 0;
    for (size_t k = 0; k <= count; k++)
        if (k < count && !isnan(point[k].x))
            polygon[points++] = placed(s, at, point[k]);
        else {
            put_polygon(f, l, s, at, polygon, points);
            points = 0;
        }
    tool_release(polygon);
}

/* Near ones follow each other: by rows of a pixel. */
static int by_place(const void *a, const void *b) {
    const pair *one = a, *other = b;
    double rows = floor(one->y) - floor(other->y);
    return rows < 0 || (rows == 0 && one->x < other->x)   ? -1
           : rows > 0 || (rows == 0 && one->x > other->x) ? 1
                                                          : 0;
}

/* Lines of no length with round ends. */
static void put_discs(FILE *f, const char *colour, double size,
                      const pair point[], size_t count) {
    path p = {.to = f};
    fprintf(f,
            "<path fill='none' stroke='%s' stroke-width='%.2f' "
            "stroke-linecap='round' d='M0 0",
            colour, 2 * radius * size);
    for (size_t k = 0; k < count; k++) {
        path_move(&p, point[k]);
        fputs("h0", f);
    }
    fputs("'/>\n", f);
}

static const struct {
    int mark;
    size_t points;
    double at[4][2];
} shapes[] = {
    {PLOT_SQUARE, 4, {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}},
    {PLOT_TRIANGLE, 3, {{0, -1.33}, {-1.33, 0.67}, {1.33, 0.67}}},
    {PLOT_DIAMOND, 4, {{0, -1.41}, {1.41, 0}, {0, 1.41}, {-1.41, 0}}},
    {PLOT_PLUS, 4, {{-1.3, 0}, {1.3, 0}, {0, -1.3}, {0, 1.3}}},
    {PLOT_CROSS, 4, {{-1, -1}, {1, 1}, {-1, 1}, {1, -1}}},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static pair corner(pair middle, const double at[2], double size) {
    return (pair){middle.x + radius * size * at[0],
                  middle.y + radius * size * at[1]};
}

static void put_mark(path *p, int mark, double size, pair at) {
    size_t i = 0;
    bool open = mark <= PLOT_CROSS; /* two lines */
    while (i < SHAPES && shapes[i].mark != (open ? mark : mark / 2 * 2))
        i++;
    if (i == SHAPES) { /* a circle */
        double r = round(20 * radius * size) / 20;
        path_move(p, (pair){at.x - r, at.y});
        fprintf(p->to, "a%g %g 0 1 0 %g 0a%g %g 0 1 0 %g 0z", r, r, 2 * r, r, r,
                -2 * r);
        return;
    }
    path_move(p, corner(at, shapes[i].at[0], size));
    for (size_t k = 1; k < shapes[i].points; k++)
        if (open && k == 2)
            path_move(p, corner(at, shapes[i].at[k], size));
        else
            path_line(p, corner(at, shapes[i].at[k], size));
    if (!open)
        path_close(p);
}

static void put_marks(FILE *f, const char *colour, int mark, double size,
                      const pair point[], size_t count) {
    static const double width = 1;
    path p = {.to = f};
    if (mark == PLOT_DISC) {
        put_discs(f, colour, size, point, count);
        return;
    }
    if (mark > PLOT_CROSS && mark % 2)
        fprintf(f, "<path fill='%s' d='M0 0", colour);
    else
        fprintf(f, "<path fill='none' stroke='%s' stroke-width='%g' d='M0 0",
                colour, size > 1 ? 1.5 * width : width);
    for (size_t k = 0; k < count; k++)
        put_mark(&p, mark, size, point[k]);
    fputs("'/>\n", f);
}

static void put_all_marks(FILE *f, const plot_look *l, const pair point[],
                          size_t count) {
    if (!count)
        return;
    put_marks(f, l->colour, l->mark, l->size, point, count);
    if (l->edge)
        put_marks(f, l->edge, l->mark - 1, l->size, point, count);
}

/* Marks one point of every l->every, if it is in the panel. */
static void mark_points(FILE *f, const plot_look *l, const plot_screen *s,
                        pair at, const pair point[], size_t count) {
    pair *marks = tool_allocate(count, sizeof *marks);
    size_t kept = 0;
    for (size_t k = 0; k < count; k += l->every) {
        pair mark = placed(s, at, point[k]);
        if (!isnan(point[k].x) && is_inside(s, at, mark))
            marks[kept++] = mark;
    }
    if (l->many)
        qsort(marks, kept, sizeof *marks, by_place);
    put_all_marks(f, l, marks, kept);
    tool_release(marks);
}

void plot_svg_series(FILE *f, const plot *p, const series *s,
                     const plot_screen *on, pair at) {
    plot_look l = plot_look_of(p, s);
    plot_thinning how = l.many                           ? THIN_DOTS
                        : l.opacity > 0 || l.dash[0] > 0 ? THIN_LINE
                                                         : THIN_SOLID;
    static const double fine = 0.3; /* of few lines, which stay smooth */
    plot_screen screen = *on;
    if (s->form == PLOT_SEPARATRIX || s->form == PLOT_LEVEL)
        screen.detail = fmin(screen.detail, fine);
    pair *seen = tool_allocate(2 * s->count, sizeof *seen);
    size_t count = plot_thin(&screen, how, s->point, s->count, seen);
    if (l.opacity > 0)
        put_areas(f, &l, on, at, seen, count);
    else if (l.width > 0)
        put_line(f, &l, on, at, seen, count);
    if (l.mark && l.many)
        mark_points(f, &l, on, at, seen, count);
    else if (l.mark)
        mark_points(f, &l, on, at, s->point, s->count);
    tool_release(seen);
}

void plot_svg_sample(FILE *f, const plot *p, const series *s, pair at) {
    static const double long_by = 30, high_by = 12;
    plot_look l = plot_look_of(p, s);
    l.size = fmax(l.size, PLOT_USUAL_SIZE);
    pair middle = {at.x + long_by / 2, at.y};
    if (l.opacity > 0) {
        fprintf(f,
                "<path fill='%s' fill-opacity='%g' stroke='%s' d='M%.1f "
                "%.1fh%gv%gh%gz'/>\n",
                l.colour, l.opacity, l.edge ? l.edge : l.colour, at.x,
                at.y - high_by / 2, long_by, high_by, -long_by);
    } else if (l.width > 0) {
        begin_line(f, &l);
        fprintf(f, "M%.1f %.1fh%g'/>\n", at.x, at.y, long_by);
    }
    if (l.mark)
        put_all_marks(f, &l, &middle, 1);
}
