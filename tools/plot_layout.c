/* nevh: plots: where panels and legends are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

size_t plot_letter_bytes(const unsigned char *c) {
    size_t more = *c >= 0xf0 && *c < 0xf5   ? 3
                  : *c >= 0xe0 && *c < 0xf0 ? 2
                  : *c >= 0xc2 && *c < 0xe0 ? 1
                                            : 0;
    if (*c >= 0x80 && more == 0)
        return 0;
    for (size_t i = 1; i <= more; i++)
        if ((c[i] & 0xc0) != 0x80)
            return 0;
    return more + 1;
}

size_t plot_letters(const char *text) {
    size_t count = 0;
    for (const char *c = text; *c; count++) {
        size_t bytes = plot_letter_bytes((const unsigned char *)c);
        c += bytes ? bytes : 1;
    }
    return count;
}

static bool is_namesake(const plot *p, size_t i) {
    for (size_t k = 0; k < i; k++)
        if (p->series[k].name && p->series[i].name &&
            strcmp(p->series[k].name, p->series[i].name) == 0)
            return true;
    return false;
}

bool plot_in_legend(const plot *p, size_t i) {
    return p->series[i].name && !is_namesake(p, i);
}

static size_t legend_lines(const plot *p, size_t *longest) {
    size_t lines = 0;
    *longest = 0;
    for (size_t i = 0; i < p->count; i++)
        if (plot_in_legend(p, i)) {
            size_t length = plot_letters(p->series[i].name);
            *longest = length > *longest ? length : *longest;
            lines++;
        }
    if (*longest > PLOT_LONGEST_NAME)
        *longest = PLOT_LONGEST_NAME;
    return lines;
}

static bool has_headings(const plot *p) {
    for (size_t i = 0; i < p->panels; i++)
        if (p->panel[i].heading)
            return true;
    return false;
}

/* As the picture is. */
static void shape_panel(layout *l, const plot *p) {
    static const double width = 560;
    range x = plot_range_x(p, 0), y = plot_range_y(p, 0);
    double height = width * (y.high - y.low) / (x.high - x.low);
    l->panel_width = width;
    l->panel_height = fmin(fmax(height, 0.4 * width), width);
}

static void choose_panels(layout *l, const plot *p, const target *t) {
    static const struct {
        size_t columns;
        double width, height;
    } few[] = {{1, 640, 420}, {2, 400, 320}, {3, 320, 280}, {2, 400, 280}},
      many = {3, 300, 230};
    size_t last = sizeof few / sizeof *few;
    l->columns = p->panels > last ? many.columns : few[p->panels - 1].columns;
    l->panel_width = p->panels > last ? many.width : few[p->panels - 1].width;
    l->panel_height =
        p->panels > last ? many.height : few[p->panels - 1].height;
    if (p->panels == 1 && p->panel->equal)
        shape_panel(l, p);
    if (t->medium == PLOT_TEXT) {
        double beside = l->left + l->right + l->legend;
        l->columns = 1;
        l->panel_width = fmax((double)t->columns - beside, 20);
        l->panel_height = fmin(fmax(floor(l->panel_width / 3), 10),
                               fmax((double)t->lines - 7, 10));
    }
    l->rows = (p->panels + l->columns - 1) / l->columns;
}

layout plot_lay_out(const plot *p, const target *t) {
    bool text = t->medium == PLOT_TEXT;
    size_t longest, lines = legend_lines(p, &longest);
    layout l = {.letter = text ? 1 : 8, .line = text ? 1 : 18};
    l.legend = lines ? l.letter * (double)(longest + 8) : 0;
    l.left = (text ? 9 : 12) * l.letter;
    l.right = 3 * l.letter;
    l.top = (text || has_headings(p) ? 1.7 : 0.5) * l.line;
    l.bottom = (text ? 3 : 4) * l.line;
    l.title = (p->title && *p->title ? 2.3 : 0.5) * l.line;
    choose_panels(&l, p, t);
    l.width = (l.left + l.panel_width + l.right) * (double)l.columns + l.legend;
    l.height = (l.top + l.panel_height + l.bottom) * (double)l.rows + l.title;
    l.height = fmax(l.height, l.title + l.top + l.line * (double)(lines + 2));
    l.width = ceil(l.width); /* gnuplot takes whole pixels */
    l.height = ceil(l.height);
    return l;
}
