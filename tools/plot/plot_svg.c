/* nevh: plots: the SVG that gnuplot wrote, in fewer bytes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
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

/* Closes the path of the last disc. */
static void end_path(bool *open, FILE *to) {
    if (*open)
        fputs("'/>\n", to);
    *open = false;
}

static void put_disc(const disc *d, bool goes_on, FILE *to) {
    if (!goes_on)
        fprintf(to,
                "\t<path fill='none' stroke='%s' stroke-width='%.2f' "
                "stroke-linecap='round' d='",
                d->colour, 2 * d->radius);
    fprintf(to, "%sM%.2f,%.2fh0", goes_on ? "\n" : "", d->x, d->y);
}

void plot_svg_shorten(FILE *from, FILE *to) {
    char *line = NULL;
    size_t room = 0;
    disc last = {0}, next;
    bool open = false;
    rewind(from);
    while (getline(&line, &room, from) >= 0) {
        if (disc_read(line, &next)) {
            bool goes_on = open && discs_match(&last, &next);
            if (!goes_on)
                end_path(&open, to);
            put_disc(&next, goes_on, to);
            last = next, open = true;
            continue;
        }
        end_path(&open, to);
        fputs(line, to);
    }
    end_path(&open, to);
    free(line);
}
