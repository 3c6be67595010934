/* nevh: the cells of a map.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>

const unsigned plot_palette[PLOT_PALETTE] = {0x00204D, 0x31446B, 0x666970,
                                             0x958F78, 0xCBBA69, 0xFFEA46};

/* True if values are equally spaced, as pixels are. */
static bool is_even(size_t count, const double x[]) {
    static const double rounding = 1e-6;
    double length = (x[count - 1] - x[0]) / (double)(count - 1);
    for (size_t i = 0; i < count; i++)
        if (fabs(x[i] - x[0] - length * (double)i) >
            rounding * length * (double)count)
            return false;
    return true;
}

static bool is_image(const field_map *m) {
    return is_even(m->columns, m->x) && is_even(m->rows, m->y);
}

range plot_map_cell(size_t count, const double x[], size_t i) {
    double below = i ? x[i] - x[i - 1] : x[1] - x[0];
    double above = i + 1 < count ? x[i + 1] - x[i] : below;
    return (range){x[i] - below / 2, x[i] + above / 2};
}

static void print_cell(FILE *f, size_t count, const double x[], size_t i) {
    range r = plot_map_cell(count, x, i);
    fprintf(f, " %.15g %.15g", r.low, r.high);
}

void plot_map_values(const field_map *m, FILE *f) {
    bool image = is_image(m);
    fputs("$map << EOD\n", f);
    for (size_t i = 0; i < m->columns * m->rows; i++) {
        size_t column = i % m->columns, row = i / m->columns;
        if (!image && !isfinite(m->z[i]))
            continue;
        fprintf(f, "%.15g %.15g ", m->x[column], m->y[row]);
        fprintf(f, isfinite(m->z[i]) ? "%.9g" : "NaN", m->z[i]);
        if (!image) {
            print_cell(f, m->columns, m->x, column);
            print_cell(f, m->rows, m->y, row);
        }
        fputc('\n', f);
    }
    fputs("EOD\n", f);
}

void plot_map_style(const field_map *m, FILE *f) {
    fputs(is_image(m) ? "$map using 1:2:3 with image notitle"
                      : "$map using 1:2:4:5:6:7:3 with boxxyerror fillstyle "
                        "solid noborder linecolor palette notitle",
          f);
}
