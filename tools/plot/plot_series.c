/* nevh: series of plots in the language of gnuplot.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <stdlib.h>

/* M. Okabe, K. Ito, Color Universal Design (2008), but for yellow, which is
   lost on white; each with a dash and a marker of its own, for grey print. */
static const char *const colours[] = {"#0072B2", "#D55E00", "#009E73",
                                      "#CC79A7", "#000000", "#E69F00",
                                      "#56B4E9"};
static const char *const dashes[] = {"solid", "(12,5)", "(3,3)", "(14,4,3,4)",
                                     "(20,6)"};
static const int markers[] = {7, 5, 9, 13, 4, 6, 8, 12, 2};
enum {
    COLOURS = sizeof colours / sizeof *colours,
    DASHES = sizeof dashes / sizeof *dashes,
    MARKERS = sizeof markers / sizeof *markers,
    MARKS = 9 /* of a PLOT_MARKED line */
};

/* Where all points of a form matter, none is left out. */
static plot_thinning thinning_of(const plot *p, const series *s) {
    switch (s->form) {
    case PLOT_LINES:
        return p->colourful || s->look % DASHES == 0 ? THIN_SOLID : THIN_LINE;
    case PLOT_TRAIL:
        return s->dash % DASHES == 0 ? THIN_SOLID : THIN_LINE;
    case PLOT_BEHIND:
    case PLOT_LEVEL:
    case PLOT_SEPARATRIX:
        return THIN_SOLID;
    case PLOT_FILLED:
    case PLOT_HOLE:
        return THIN_LINE;
    case PLOT_POINTS:
    case PLOT_DOTS:
        return THIN_DOTS;
    default:
        return THIN_NONE;
    }
}

static plot_screen screen_of(const plot *p, size_t number, const layout *l) {
    axes a = plot_axes(p, number, l, false);
    return (plot_screen){a.x.shown, a.y.shown,      a.x.log,
                         a.y.log,   l->panel_width, l->panel_height};
}

static void print_points(FILE *f, const pair point[], size_t count) {
    for (size_t k = 0; k < count; k++)
        if (isnan(point[k].x))
            fputc('\n', f);
        else
            fprintf(f, "%.15g %.15g\n", point[k].x, point[k].y);
}

/* screens  of the panels; NULL: no point is left out */
static void print_data(FILE *f, const plot *p, size_t i,
                       const plot_screen *screens) {
    const series *s = &p->series[i];
    pair *seen = tool_allocate(2 * s->count, sizeof *seen);
    size_t count = screens ? plot_thin(&screens[s->panel], thinning_of(p, s),
                                       s->point, s->count, seen)
                           : 0;
    fprintf(f, "$series%zu << EOD\n", i + 1);
    print_points(f, screens ? seen : s->point, screens ? count : s->count);
    fputs("EOD\n", f);
    free(seen);
}

void plot_script_data(FILE *f, const plot *p, const layout *l, bool thins) {
    plot_screen *screens = tool_allocate(p->panels, sizeof *screens);
    for (size_t i = 0; i < p->panels && thins; i++)
        screens[i] = screen_of(p, i, l);
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].count)
            print_data(f, p, i, thins ? screens : NULL);
    free(screens);
}

/* Neighbours are far apart on the circle of hues, and differ in lightness. */
static void colour_of(const plot *p, size_t look, char text[16]) {
    static const double golden = 0.6180339887498949;
    if (!p->colourful) {
        snprintf(text, 16, "%s", colours[look % COLOURS]);
        return;
    }
    double light = 0.45 + 0.15 * (double)(look % 3);
    unsigned part[3];
    for (int i = 0; i < 3; i++) {
        double hue = fmod((double)look * golden + i / 3.0, 1);
        double wave = 0.5 + 0.5 * cos(2 * 3.141592653589793 * hue);
        part[i] = (unsigned)(255 * fmin(light * (0.25 + 1.25 * wave), 1));
    }
    snprintf(text, 16, "#%02X%02X%02X", part[0] & 255, part[1] & 255,
             part[2] & 255);
}

void plot_script_looks(FILE *f, const plot *p) {
    size_t looks = 0;
    char colour[16];
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].look >= looks)
            looks = p->series[i].look + 1;
    for (size_t k = 0; k < looks; k++) {
        colour_of(p, k, colour);
        fprintf(f,
                "set linetype %zu linecolor rgb '%s' linewidth 1.5 dashtype %s "
                "pointtype %d pointsize 0.7\n",
                k + 1, colour, p->colourful ? "solid" : dashes[k % DASHES],
                markers[k % MARKERS]);
    }
}

static const double bob_size = 2.2;

static double dot_size(size_t count) {
    static const double largest = 0.8, smallest = 0.15;
    return fmax(fmin(largest * pow(50 / (double)(count + 1), 0.3), largest),
                smallest);
}

static void print_form(FILE *f, const series *s, bool text) {
    size_t number = s->look + 1;
    switch (s->form) {
    case PLOT_LINES:
        fprintf(f, " with lines linetype %zu", number);
        break;
    case PLOT_TRAIL:
        fprintf(f, " with lines linetype %zu dashtype %s", number,
                dashes[s->dash % DASHES]);
        break;
    case PLOT_BEHIND:
        fputs(" with lines linecolor rgb '#bbbbbb' linewidth 5 dashtype solid",
              f);
        break;
    case PLOT_FILLED:
        fprintf(f,
                " with filledcurves closed linetype %zu linewidth 0.8 "
                "fillstyle %s border",
                number, text ? "empty" : "transparent solid 0.45");
        break;
    case PLOT_HOLE:
        fprintf(f,
                " with filledcurves closed linetype %zu linewidth 0.8 "
                "linecolor rgb '#ffffff' fillstyle %s border linecolor rgb "
                "'#555555'",
                number, text ? "empty" : "solid 1");
        break;
    case PLOT_LEVEL:
        fputs(" with lines linecolor rgb '#bbbbbb' linewidth 0.7 dashtype "
              "solid",
              f);
        break;
    case PLOT_SEPARATRIX:
        fputs(" with lines linecolor rgb '#000000' linewidth 1.3 dashtype "
              "solid",
              f);
        break;
    case PLOT_CENTRE:
        fputs(" with points linecolor rgb '#000000' pointtype 7 pointsize 0.8",
              f);
        break;
    case PLOT_SADDLE:
        fputs(" with points linecolor rgb '#000000' linewidth 2 pointtype 2 "
              "pointsize 1.1",
              f);
        break;
    case PLOT_START:
        fprintf(f,
                " with points linetype %zu linewidth 1.5 pointtype 6 pointsize "
                "%.2f",
                number, 1.2 * s->size);
        break;
    case PLOT_MARKED:
        fprintf(f, " with linespoints linetype %zu pointinterval %zu", number,
                s->count / MARKS + 1 + s->look);
        break;
    case PLOT_BOTH:
        fprintf(f, " with linespoints linetype %zu", number);
        break;
    case PLOT_POINTS:
        fprintf(f, " with points linetype %zu", number);
        break;
    case PLOT_DOTS:
        fprintf(f, " with points linetype %zu pointtype 7 pointsize %.2f",
                number, dot_size(s->count) * s->size);
        break;
    case PLOT_RODS:
        fputs(" with lines linecolor rgb '#777777' linewidth 4 dashtype solid",
              f);
        break;
    case PLOT_GUIDE:
        fputs(" with lines linecolor rgb '#999999' linewidth 1 dashtype solid",
              f);
        break;
    case PLOT_BOBS:
        fprintf(f, " with points linetype %zu pointtype 7 pointsize %.2f",
                number, bob_size * s->size);
        break;
    }
}

static void separate(FILE *f, size_t *printed) {
    fputs((*printed)++ ? ", \\\n    " : "plot ", f);
}

static void print_name(FILE *f, const char *name) {
    if (!name) {
        fputs(" notitle", f);
        return;
    }
    fputs(" title ", f);
    plot_quote(f, name, PLOT_LONGEST_NAME);
    fputs(" noenhanced", f);
}

/* A series without points is an entry of the legend at most; letters are too
   coarse for guides. */
static void print_series(FILE *f, const plot *p, size_t i, bool here,
                         bool titled, bool text, size_t *printed) {
    bool drawn = here && p->series[i].count;
    if (text &&
        (p->series[i].form == PLOT_GUIDE || p->series[i].form == PLOT_LEVEL))
        return;
    if (!drawn && !titled)
        return;
    separate(f, printed);
    if (drawn)
        fprintf(f, "$series%zu using 1:2", i + 1);
    else
        fputs("NaN", f);
    print_form(f, &p->series[i], text);
    print_name(f, titled ? p->series[i].name : NULL);
    if (drawn && p->series[i].form == PLOT_BOBS)
        fprintf(f,
                ", \\\n    $series%zu using 1:2 with points linecolor rgb "
                "'#000000' linewidth 1.5 pointtype 6 pointsize %.2f notitle",
                i + 1, bob_size * p->series[i].size);
}

typedef struct {
    double left, right, middle; /* pixels */
} guide_name;

static bool is_covered(const guide_name *all, size_t count,
                       const guide_name *one) {
    for (size_t i = 0; i < count; i++)
        if (one->left < all[i].right && all[i].left < one->right &&
            fabs(one->middle - all[i].middle) < 1.2 * PLOT_NOTE_FONT)
            return true;
    return false;
}

/* Whether a part of the line from a to b is on that side of a limit, as far as from
   and to, which shrink: shares of the line. */
static bool clip(double along, double room, double *from, double *to) {
    if (along > 0)
        *to = fmin(*to, room / along);
    else if (along < 0)
        *from = fmax(*from, room / along);
    else if (room < 0)
        return false;
    return *from <= *to;
}

static bool is_crossed_by(const guide_name *one, pair a, pair b) {
    const double half = 0.6 * PLOT_NOTE_FONT;
    double from = 0, to = 1, x = b.x - a.x, y = b.y - a.y;
    return isfinite(x) && isfinite(y) &&
           clip(x, one->right - a.x, &from, &to) &&
           clip(-x, a.x - one->left, &from, &to) &&
           clip(y, one->middle + half - a.y, &from, &to) &&
           clip(-y, a.y - one->middle + half, &from, &to);
}

/* By a curve of the panel, or another guide. */
static bool is_crossed(const plot *p, const series *guide,
                       const plot_screen *on, const guide_name *one) {
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s == guide || s->panel != guide->panel)
            continue;
        for (size_t k = 1; k < s->count; k++)
            if (is_crossed_by(one, plot_in_pixels(on, s->point[k - 1]),
                              plot_in_pixels(on, s->point[k])))
                return true;
    }
    return false;
}

/* Beside the guide, from its end on, so that it is within the picture and over no
   other, nor, if need be, over a curve; false where it has no place. */
static bool place_beside(const plot *p, const series *s, const plot_screen *on,
                         double right, bool apart, const guide_name *others,
                         size_t count, guide_name *to) {
    enum { PLACES = 10, AWAY = 4 };
    static const double sides[] = {4, -4, 14, -14, 24, -24, 34, -34, 44, -44};
    enum { SIDES = sizeof sides / sizeof *sides };
    pair first = plot_in_pixels(on, s->point[0]);
    pair last = plot_in_pixels(on, s->point[s->count - 1]);
    double width = 0.6 * PLOT_NOTE_FONT * (double)plot_letters(s->name);
    for (size_t i = 0; i < (apart ? SIDES : 1); i++)
        for (int k = 0; k < PLACES; k++) {
            double share = (double)k / PLACES;
            double x = last.x + share * (first.x - last.x) + sides[i] -
                       (sides[i] < 0 ? width : 0);
            double y = last.y + share * (first.y - last.y);
            *to = (guide_name){x, x + width, y};
            bool within = x > AWAY && y > AWAY && y < on->height - AWAY;
            if (to->right < right && !is_covered(others, count, to) &&
                (!apart || (within && !is_crossed(p, s, on, to))))
                return true;
        }
    return false;
}

static bool place_name(const plot *p, const series *s, const plot_screen *on,
                       double right, const guide_name *others, size_t count,
                       guide_name *to) {
    return place_beside(p, s, on, right, true, others, count, to) ||
           place_beside(p, s, on, right, false, others, count, to);
}

void plot_script_guides(FILE *f, const plot *p, size_t number,
                        const layout *l) {
    plot_screen on = screen_of(p, number, l);
    guide_name *names = tool_allocate(p->count + 1, sizeof *names);
    size_t count = 0;
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s->panel != number || s->form != PLOT_GUIDE || !s->count)
            continue;
        guide_name *to = &names[count];
        if (!place_name(p, s, &on, on.width + l->right, names, count, to))
            continue;
        count++;
        fputs("set label ", f);
        plot_quote(f, s->name, PLOT_LONGEST_NAME);
        fprintf(f,
                " at graph %.6f,%.6f left noenhanced "
                "textcolor rgb '#777777' font ',%d'\n",
                to->left / on.width, to->middle / on.height, PLOT_NOTE_FONT);
    }
    free(names);
}

void plot_script_series(FILE *f, const plot *p, size_t number, bool legend,
                        bool text) {
    size_t printed = 0;
    if (number == 0 && p->map.columns) {
        separate(f, &printed);
        plot_map_style(&p->map, f);
    }
    for (size_t i = 0; i < p->count; i++)
        print_series(f, p, i, p->series[i].panel == number,
                     legend && plot_in_legend(p, i), text, &printed);
    if (!printed)
        fputs("plot NaN notitle", f);
    fputc('\n', f);
}
