/* nevh: plots: the cells of a map, as SVG.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <stdlib.h>

enum { LEVELS = 96, NO_LEVEL = 255 };

static unsigned colour_of(int level) {
    double at = (double)level / (LEVELS - 1) * (PLOT_PALETTE - 1);
    int below = (int)fmin(floor(at), PLOT_PALETTE - 2);
    unsigned colour = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        double from = plot_palette[below] >> shift & 255;
        double to = plot_palette[below + 1] >> shift & 255;
        colour =
            colour << 8 | (unsigned)lround(from + (at - below) * (to - from));
    }
    return colour;
}

/* Rows or columns of cells, or of several that a screen does not tell apart. */
typedef struct {
    size_t count;
    size_t *of;         /* which one is shown */
    double *low, *high; /* pixels */
} bands;

static double limited(double value, double most) {
    return value > 0 ? fmin(value, most) : 0;
}

static bands bands_new(const plot_screen *s, size_t count, const double x[],
                       bool up) {
    static const double least = 10; /* details */
    double length = up ? s->height : s->width;
    size_t shown = (size_t)fmax(floor(length / (least * s->detail)), 1);
    bands b = {.count = count < shown ? count : shown};
    b.of = tool_allocate(b.count, sizeof *b.of);
    b.low = tool_allocate(2 * b.count, sizeof *b.low);
    b.high = b.low + b.count;
    for (size_t i = 0; i < b.count; i++) {
        size_t first = i * count / b.count;
        size_t last = (i + 1) * count / b.count - 1;
        double low = plot_map_cell(count, x, first).low;
        double high = plot_map_cell(count, x, last).high;
        pair from = plot_in_pixels(s, (pair){low, low});
        pair to = plot_in_pixels(s, (pair){high, high});
        b.of[i] = (first + last) / 2;
        b.low[i] = limited(up ? from.y : from.x, length);
        b.high[i] = limited(up ? to.y : to.x, length);
    }
    return b;
}

static void bands_free(bands *b) {
    tool_release(b->of);
    tool_release(b->low);
}

static unsigned char level_of(const field_map *m, double z) {
    return isfinite(z) ? (unsigned char)limited(
                             floor(plot_map_share(m, z) * LEVELS), LEVELS - 1)
                       : NO_LEVEL;
}

static unsigned char *levels_new(const field_map *m, const bands *columns,
                                 const bands *rows, bool *hatched) {
    unsigned char *level = tool_allocate(columns->count * rows->count, 1);
    for (size_t i = 0; i < columns->count * rows->count; i++) {
        size_t column = columns->of[i % columns->count];
        size_t row = rows->of[i / columns->count];
        level[i] = level_of(m, m->z[row * m->columns + column]);
        *hatched |= level[i] == NO_LEVEL;
    }
    return level;
}

/* Lines as high as a row, which reach a little over their neighbours: nothing shows
   between.
   open    whether the path is
   height  of its lines, in tenths, as all numbers; out */
typedef struct {
    FILE *to;
    unsigned colour;
    bool open;
    int height, x, y;
} lines;

static void lines_put(lines *l, double low, double high, double y,
                      double height) {
    enum { OVER = 3 };
    int high_by = (int)lround(10 * height) + OVER;
    int x = (int)lround(10 * low), right = (int)lround(10 * high) + OVER;
    int down = (int)lround(10 * y);
    if (!l->open || abs(high_by - l->height) > 1) {
        fprintf(l->to, "%s<path stroke='#%06X' stroke-width='%d' d='M%d %d",
                l->open ? "'/>\n" : "", l->colour, high_by, x, down);
        l->height = high_by;
    } else
        fprintf(l->to, "m%d%s%d", x - l->x, down < l->y ? "" : " ",
                down - l->y);
    fprintf(l->to, "h%d", right - x);
    l->open = true;
    l->x = right;
    l->y = down;
}

static void put_level(FILE *f, int level, const unsigned char of[],
                      const bands *columns, const bands *rows, double bottom,
                      double left) {
    lines l = {.to = f, .colour = colour_of(level)};
    for (size_t k = 0; k < rows->count; k++)
        for (size_t i = 0, next; i < columns->count; i = next + 1) {
            const unsigned char *row = of + k * columns->count;
            next = i;
            if (row[i] != level)
                continue;
            while (next + 1 < columns->count && row[next + 1] == level)
                next++;
            lines_put(&l, left + columns->low[i], left + columns->high[next],
                      bottom - (rows->low[k] + rows->high[k]) / 2,
                      rows->high[k] - rows->low[k]);
        }
    fputs(l.open ? "'/>\n" : "", f);
}

static void put_hatch(FILE *f, const plot_screen *s, pair at) {
    static const double apart = 8;
    fputs("<path fill='none' stroke='#999999' d='", f);
    for (double x = apart - s->height; x < s->width; x += apart) {
        pair a = {at.x + x, at.y}, b = {at.x + x + s->height, at.y + s->height};
        if (plot_clip(&a, &b, at, (pair){at.x + s->width, at.y + s->height}))
            fprintf(f, "M%.1f %.1fL%.1f %.1f", a.x, a.y, b.x, b.y);
    }
    fputs("'/>\n", f);
}

void plot_svg_map(FILE *f, const field_map *m, const plot_screen *s, pair at) {
    bands columns = bands_new(s, m->columns, m->x, false);
    bands rows = bands_new(s, m->rows, m->y, true);
    bool hatched = false;
    unsigned char *level = levels_new(m, &columns, &rows, &hatched);
    if (hatched)
        put_hatch(f, s, at);
    fputs(
        "<g transform='scale(.1)' fill='none' shape-rendering='crispEdges'>\n",
        f);
    for (int i = 0; i < LEVELS; i++)
        put_level(f, i, level, &columns, &rows, at.y + s->height, at.x);
    fputs("</g>\n", f);
    tool_release(level);
    bands_free(&columns);
    bands_free(&rows);
}

void plot_svg_palette(FILE *f, double left, double top, double height) {
    static const double width = 16;
    double step = height / LEVELS;
    fputs("<g shape-rendering='crispEdges'>\n", f);
    for (int i = 0; i < LEVELS; i++)
        fprintf(f, "<path fill='#%06X' d='M%g %.1fh%gv%.1fh%gz'/>\n",
                colour_of(i), left, top + height - (i + 1) * step, width,
                step + (i ? 0.3 : 0), -width);
    fputs("</g>\n", f);
}
