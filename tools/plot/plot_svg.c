/* nevh: plots: the SVG that gnuplot wrote, in fewer bytes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Discs of one series, each an element of a hundred bytes: points of one path
   with round ends look the same. */
typedef struct {
    double x, y, radius;
    char colour[32];
} disc;

static bool disc_read(const char *line, disc *d) {
    int end = 0;
    return sscanf(line,
                  " <use xlink:href='#gpPt6' transform='translate(%lf,%lf) "
                  "scale(%lf)' color='%31[^']'/> %n",
                  &d->x, &d->y, &d->radius, d->colour, &end) == 4 &&
           end && line[end] == '\0';
}

static bool discs_match(const disc *a, const disc *b) {
    return a->radius == b->radius && strcmp(a->colour, b->colour) == 0;
}

/* Of one look, one after the other. */
typedef struct {
    disc *item;
    size_t count, room;
} discs;

static void discs_add(discs *d, const disc *next) {
    if (d->count == d->room)
        d->item =
            tool_enlarge(d->item, d->room = 2 * d->room + 64, sizeof *d->item);
    d->item[d->count++] = *next;
}

/* Near ones follow each other: by rows of a pixel. */
static int by_place(const void *a, const void *b) {
    const disc *one = a, *other = b;
    double rows = floor(one->y) - floor(other->y);
    return rows < 0 || (rows == 0 && one->x < other->x)   ? -1
           : rows > 0 || (rows == 0 && one->x > other->x) ? 1
                                                          : 0;
}

/* In tenths of a pixel, each from the one before. */
static void discs_put(discs *d, FILE *to) {
    if (!d->count)
        return;
    qsort(d->item, d->count, sizeof *d->item, by_place);
    fprintf(to,
            "\t<path transform='scale(.1)' fill='none' stroke='%s' "
            "stroke-width='%.1f' stroke-linecap='round' d='",
            d->item->colour, 20 * d->item->radius);
    int x = 0, y = 0;
    for (size_t i = 0; i < d->count; i++) {
        int right = (int)lround(10 * d->item[i].x) - x;
        int down = (int)lround(10 * d->item[i].y) - y;
        fprintf(to, "m%d%s%dh0%s", right, down < 0 ? "" : " ", down,
                i % 16 == 15 ? "\n" : "");
        x += right, y += down;
    }
    fputs("'/>\n", to);
    d->count = 0;
}

void plot_svg_shorten(FILE *from, FILE *to) {
    char *line = NULL;
    size_t room = 0;
    discs all = {NULL, 0, 0};
    disc next;
    rewind(from);
    while (getline(&line, &room, from) >= 0) {
        bool is_disc = disc_read(line, &next);
        if (!is_disc || (all.count && !discs_match(all.item, &next)))
            discs_put(&all, to);
        if (is_disc)
            discs_add(&all, &next);
        else
            fputs(line, to);
    }
    discs_put(&all, to);
    free(all.item);
    free(line);
}
