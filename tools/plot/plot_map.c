/* nevh: the cells of a map.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>

const unsigned plot_palette[PLOT_PALETTE] = {0x00204D, 0x31446B, 0x666970,
                                             0x958F78, 0xCBBA69, 0xFFEA46};

double plot_map_share(const field_map *m, double z) {
    range r = m->shown;
    return m->log ? log(z / r.low) / log(r.high / r.low)
                  : (z - r.low) / (r.high - r.low);
}

enum { BINS = 1000 }; /* of the scale */

static size_t bin_of(const field_map *m, double z) {
    return (size_t)fmin(fmax(plot_map_share(m, z), 0) * BINS, BINS - 1);
}

static double value_of(const field_map *m, double share) {
    range r = m->shown;
    return m->log ? r.low * pow(r.high / r.low, share)
                  : r.low + share * (r.high - r.low);
}

/* True if most values are in a small part of the scale, and more than a few differ. */
static bool is_crowded(const size_t count[BINS], size_t all) {
    static const double most = 0.5;
    enum { FEW = 12, PART = BINS / 5 };
    size_t within = 0, fullest = 0, differ = 0;
    for (size_t i = 0; i < BINS; i++) {
        differ += count[i] > 0;
        within += count[i];
        within -= i >= PART ? count[i - PART] : 0;
        fullest = within > fullest ? within : fullest;
    }
    return differ > FEW && (double)fullest > most * (double)all;
}

/* Ranks of the parts of the scale, in which no part counts for more than a twentieth
   of the values: those that are equal take no colours from the others. */
static void find_ranks(const size_t count[BINS], size_t all,
                       double rank[BINS]) {
    double limit = fmax((double)all / 20, 1), sum = 0;
    for (size_t i = 0; i < BINS; i++) {
        double more = fmin((double)count[i], limit);
        rank[i] = sum + more / 2;
        sum += more;
    }
    double first = -1, last = 0;
    for (size_t i = 0; i < BINS; i++)
        if (count[i]) {
            first = first < 0 ? rank[i] : first;
            last = rank[i];
        }
    for (size_t i = 0; i < BINS; i++)
        rank[i] = (rank[i] - first) / (last - first);
}

void plot_map_rank(field_map *m) {
    size_t count[BINS] = {0}, all = 0, cells = m->columns * m->rows;
    double rank[BINS];
    for (size_t i = 0; i < cells; i++)
        if (isfinite(m->z[i])) {
            count[bin_of(m, m->z[i])]++;
            all++;
        }
    if (!is_crowded(count, all))
        return;
    find_ranks(count, all, rank);
    for (size_t i = 0; i < cells; i++)
        if (isfinite(m->z[i]))
            m->z[i] = rank[bin_of(m, m->z[i])];
    for (size_t k = 0, i = 0; k < 5; k++) {
        while (i + 1 < BINS && (!count[i] || rank[i] < 0.25 * (double)k - 1e-9))
            i++;
        m->quarter[k] = value_of(m, ((double)i + 0.5) / BINS);
    }
    m->quarter[0] = m->shown.low;
    m->quarter[4] = m->shown.high;
    m->ranked = true;
    m->log = false;
    m->shown = (range){0, 1};
}

axis plot_map_axis(const field_map *m, double count, bool text) {
    axis a = {.shown = m->shown};
    if (!m->ranked)
        return plot_axis(m->shown, m->log, count, text);
    for (a.count = 0; a.count < 5; a.count++) {
        tick *t = &a.tick[a.count];
        *t = (tick){.at = 0.25 * (double)a.count};
        snprintf(t->text, sizeof t->text, "%.3g", m->quarter[a.count]);
    }
    return a;
}

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
