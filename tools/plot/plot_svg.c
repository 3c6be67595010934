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

/* A line of the coordinates of a path, which goes on over several. */
typedef struct {
    bool open;
    char last; /* command; 0: none */
    int x, y;  /* tenths of a pixel */
} path;

/* In pixels, without a zero before the point. */
static void tenths_put(int number, bool apart, FILE *to) {
    int size = abs(number);
    fputs(number < 0 ? "-" : apart ? " " : "", to);
    if (size >= 10 || size == 0)
        fprintf(to, "%d", size / 10);
    if (size % 10)
        fprintf(to, ".%d", size % 10);
}

/* Lines go from the point before, in tenths of a pixel. */
static void point_put(path *p, char letter, double x, double y, FILE *to) {
    int right = (int)lround(10 * x), down = (int)lround(10 * y);
    bool line = letter == 'L', again = line && p->last == 'L';
    if (!again)
        fputc(line ? 'l' : 'M', to);
    tenths_put(line ? right - p->x : right, again, to);
    tenths_put(line ? down - p->y : down, true, to);
    *p = (path){true, letter, right, down};
}

static void path_put(path *p, const char *line, FILE *to) {
    char letter;
    double x, y;
    int length;
    while (*line && *line != '\'') {
        if (sscanf(line, "%c%lf,%lf %n", &letter, &x, &y, &length) == 3 &&
            (letter == 'M' || letter == 'L')) {
            point_put(p, letter, x, y, to);
            line += length;
        } else {
            p->last = 0;
            fputc(*line++, to);
        }
    }
    p->open = *line != '\'';
    fputs(p->open ? "\n" : line, to);
}

/* gnuplot leaves "]]>" of a title as it is, which no text of XML may have. */
static void text_put(const char *line, FILE *to) {
    static const char end[] = "]]>";
    for (const char *at; (at = strstr(line, end)); line = at + sizeof end - 1)
        fprintf(to, "%.*s]]&gt;", (int)(at - line), line);
    fputs(line, to);
}

/* Marks, which have names, are too small for that. */
static void line_put(path *p, const char *line, FILE *to) {
    static const char begin[] = " d='";
    const char *data = strstr(line, begin);
    if (p->open)
        path_put(p, line, to);
    else if (data && strstr(line, "<path stroke=") && !strstr(line, " id=")) {
        data += sizeof begin - 1;
        fwrite(line, 1, (size_t)(data - line), to);
        p->last = 0;
        path_put(p, data, to);
    } else if (strstr(line, "<text>"))
        text_put(line, to);
    else
        fputs(line, to);
}

/* The beginning of a group without what SVG takes anyway. */
static void group_put(const char *line, FILE *to) {
    static const char usual[] =
        " stroke-linecap=\"butt\" stroke-linejoin=\"miter\"";
    const char *at = strstr(line, usual);
    if (at)
        fprintf(to, "%.*s%s", (int)(at - line), line, at + sizeof usual - 1);
    else
        fputs(line, to);
}

void plot_svg_shorten(FILE *from, FILE *to) {
    char *line = NULL, *group = NULL; /* group: not yet written */
    size_t room = 0;
    path open = {false, 0, 0, 0};
    discs all = {NULL, 0, 0};
    disc next;
    rewind(from);
    while (getline(&line, &room, from) >= 0) {
        bool is_disc = disc_read(line, &next);
        bool is_empty = group && strcmp(line, "</g>\n") == 0;
        if (!is_disc || (all.count && !discs_match(all.item, &next)))
            discs_put(&all, to);
        if (group && !is_empty)
            group_put(group, to);
        free(group);
        group = NULL;
        if (is_disc)
            discs_add(&all, &next);
        else if (strncmp(line, "<g fill=", 8) == 0)
            group = text_print("%s", line);
        else if (!is_empty)
            line_put(&open, line, to);
    }
    discs_put(&all, to);
    free(all.item);
    free(group);
    free(line);
}

void plot_svg_copy(FILE *from, FILE *to) {
    char *line = NULL;
    size_t room = 0;
    rewind(from);
    while (getline(&line, &room, from) >= 0)
        if (strstr(line, "<text>"))
            text_put(line, to);
        else
            fputs(line, to);
    free(line);
}
