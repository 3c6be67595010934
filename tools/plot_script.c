/* nevh: plots in the language of gnuplot.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    MARKS = 9, /* of a PLOT_MARKED line */
    FONT = 14
};

static void quote_letter(FILE *f, const char *c, size_t bytes) {
    if (bytes == 0)
        fputc('?', f);
    else if ((unsigned char)*c < ' ' || *c == 0x7f)
        fputc(' ', f);
    else if (*c == '\'')
        fputs("''", f);
    else
        fwrite(c, 1, bytes, f);
}

/* In single quotes gnuplot changes nothing, and runs nothing. */
static void quote(FILE *f, const char *text, size_t longest) {
    bool cut = plot_letters(text) > longest;
    size_t most = cut ? longest - 3 : longest;
    fputc('\'', f);
    while (*text && most--) {
        size_t bytes = plot_letter_bytes((const unsigned char *)text);
        quote_letter(f, text, bytes);
        text += bytes ? bytes : 1;
    }
    fputs(cut ? "...'" : "'", f);
}

static void quote_line(FILE *f, const char *before, const char *text,
                       double length) {
    fputs(before, f);
    quote(f, text ? text : "", (size_t)fmax(length, 8));
    fputs(" noenhanced\n", f);
}

static void print_terminal(FILE *f, const target *t, const layout *l) {
    double w = l->width, h = l->height;
    switch (t->medium) {
    case PLOT_SVG:
        fprintf(f,
                "set terminal svg size %g,%g dynamic enhanced font "
                "'sans-serif,%d' background '#ffffff'\n",
                w, h, FONT);
        break;
    case PLOT_PNG: /* of twice the size */
        fprintf(f,
                "set terminal pngcairo size %g,%g enhanced font "
                "'sans-serif,%d' fontscale 1.5 linewidth 2 pointscale 2 "
                "background '#ffffff'\n",
                2 * w, 2 * h, FONT); /* fonts: 96 pixels an inch */
        break;
    case PLOT_PDF:
        fprintf(f,
                "set terminal pdfcairo size %gin,%gin enhanced font "
                "'sans-serif,%d' fontscale 0.72 linewidth 1.5\n",
                w / 72, h / 72, FONT);
        break;
    case PLOT_TEXT:
        fprintf(f, "set terminal dumb nofeed size %g,%g enhanced %s\n", w, h,
                t->colours ? "ansi256" : "mono");
        break;
    case PLOT_SCREEN:
        break; /* gnuplot's default */
    }
}

/* A name that begins with | would be a command, with ~ a user's home, and one
   that a line cannot hold is left to the shell's redirection. */
static void print_output(FILE *f, const char *file) {
    for (const char *c = file; *c; c++)
        if ((unsigned char)*c < ' ')
            return;
    fputs("set output '", f);
    if (*file == '|' || *file == '~')
        fputs("./", f);
    for (const char *c = file; *c; c++)
        fputs(*c == '\'' ? "''" : (char[]){*c, 0}, f);
    fputs("'\n", f);
}

static void print_points(FILE *f, const series *s, size_t number) {
    fprintf(f, "$series%zu << EOD\n", number);
    for (size_t k = 0; k < s->count; k++)
        if (isnan(s->point[k].x))
            fputc('\n', f);
        else
            fprintf(f, "%.10g %.10g\n", s->point[k].x, s->point[k].y);
    fputs("EOD\n", f);
}

static void print_looks(FILE *f, const plot *p) {
    size_t looks = 0;
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].look >= looks)
            looks = p->series[i].look + 1;
    for (size_t k = 0; k < looks; k++)
        fprintf(f,
                "set linetype %zu linecolor rgb '%s' linewidth 1.5 dashtype %s "
                "pointtype %d pointsize 0.7\n",
                k + 1, colours[k % COLOURS], dashes[k % DASHES],
                markers[k % MARKERS]);
}

static void print_form(FILE *f, const series *s) {
    size_t number = s->look + 1;
    switch (s->form) {
    case PLOT_LINES:
        fprintf(f, " with lines linetype %zu", number);
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
        fprintf(f, " with points linetype %zu pointtype 7 pointsize 0.2",
                number);
        break;
    case PLOT_RODS:
        fputs(" with lines linecolor rgb '#777777' linewidth 4 dashtype solid",
              f);
        break;
    case PLOT_BOBS:
        fprintf(f, " with points linetype %zu pointtype 7 pointsize 2.2",
                number);
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
    quote(f, name, PLOT_LONGEST_NAME);
    fputs(" noenhanced", f);
}

/* A series without points is an entry of the legend at most. */
static void print_series(FILE *f, const plot *p, size_t i, bool here,
                         bool titled, size_t *printed) {
    bool drawn = here && p->series[i].count;
    if (!drawn && !titled)
        return;
    separate(f, printed);
    if (drawn)
        fprintf(f, "$series%zu using 1:2", i + 1);
    else
        fputs("NaN", f);
    print_form(f, &p->series[i]);
    print_name(f, titled ? p->series[i].name : NULL);
    if (drawn && p->series[i].form == PLOT_BOBS)
        fprintf(f,
                ", \\\n    $series%zu using 1:2 with points linecolor rgb "
                "'#000000' linewidth 1.5 pointtype 6 pointsize 2.2 notitle",
                i + 1);
}

static void print_plots(FILE *f, const plot *p, size_t number) {
    size_t printed = 0;
    for (size_t i = 0; i < p->count; i++)
        print_series(f, p, i, p->series[i].panel == number,
                     number == 0 && plot_in_legend(p, i), &printed);
    if (!printed)
        fputs("plot NaN notitle", f);
    fputc('\n', f);
}

static void print_decades(FILE *f, char axis, range r, double labels,
                          bool text) {
    double step = ceil(log10(r.high / r.low) / fmax(floor(labels), 1));
    fprintf(f,
            "set logscale %c\nset format %c '%s'\nset %ctics 1e%g nomirror "
            "out\nset m%ctics %d\n",
            axis, axis, text ? "1e%T" : "10^{%T}", axis, step, axis,
            log10(r.high / r.low) > 8 ? 1 : 10);
}

/* 1, 2 or 5 times a power of 10. */
static double round_step(double step) {
    double power = pow(10, floor(log10(step))), digits = step / power;
    return power * (digits <= 1 ? 1 : digits <= 2 ? 2 : digits <= 5 ? 5 : 10);
}

static void print_tics(FILE *f, char axis, range r, double labels, bool text) {
    fprintf(f,
            "unset logscale %c\nset format %c '%s'\nset %ctics %.3g nomirror "
            "out\nset m%ctics 1\n",
            axis, axis, text ? "%g" : "%h", axis,
            round_step((r.high - r.low) / fmax(labels, 2)), axis);
}

static void print_axis(FILE *f, char axis, bool log, range r, double labels,
                       bool text) {
    if (log)
        print_decades(f, axis, r, labels, text);
    else
        print_tics(f, axis, r, labels, text);
    fprintf(f, "set %crange [%.12g:%.12g]\n", axis, r.low, r.high);
}

/* Text has no letters that lie on their side. */
static void print_texts(FILE *f, const panel *on, const layout *l, bool text) {
    double width = l->panel_width / l->letter;
    const char *between = on->heading && on->y ? ", " : "";
    quote_line(f, "set xlabel ", on->x, width);
    if (!text) {
        quote_line(f, "set ylabel ", on->y, l->panel_height / l->letter);
        quote_line(f, "set title ", on->heading, width);
        return;
    }
    char *title = text_print("%s%s%s", on->y ? on->y : "", between,
                             on->heading ? on->heading : "");
    quote_line(f, "set title ", title, width + l->left);
    free(title);
}

static void print_axes(FILE *f, const plot *p, size_t number, const layout *l,
                       bool text) {
    const panel *on = &p->panel[number];
    range x = plot_range_x(p, number), y = plot_range_y(p, number);
    double letter = text ? 2 : 1; /* is as high as so many are wide */
    double lines = on->log_y ? 1.3 : 2;
    if (on->equal)
        plot_range_equal(&x, &y, l->panel_width, l->panel_height * letter);
    print_axis(f, 'x', on->log_x, x, l->panel_width / (7 * l->letter), text);
    print_axis(f, 'y', on->log_y, y, l->panel_height / (lines * l->line), text);
    print_texts(f, on, l, text);
}

static void print_place(FILE *f, size_t number, const layout *l) {
    double left = l->left + (double)(number % l->columns) *
                                (l->left + l->panel_width + l->right);
    double top =
        l->height - l->title - l->top -
        (double)(number / l->columns) * (l->top + l->panel_height + l->bottom);
    fprintf(f,
            "set lmargin at screen %.6f\nset rmargin at screen %.6f\n"
            "set tmargin at screen %.6f\nset bmargin at screen %.6f\n",
            left / l->width, (left + l->panel_width) / l->width,
            top / l->height, (top - l->panel_height) / l->height);
}

/* As large as it fits, but not too small. */
static void print_title(FILE *f, const char *title, const layout *l) {
    static const double letter = 0.63, smallest = 0.8, largest = 1.2;
    double fitting = l->width / (letter * FONT * (double)plot_letters(title));
    double scale = fmin(fmax(fitting, smallest), largest);
    double most =
        l->letter == 1 ? l->width : l->width / (letter * FONT * scale);
    fputs("set label 1 ", f);
    quote(f, title, (size_t)most);
    fprintf(f, " at screen 0.5,%.6f center noenhanced font ',%.3g'\n",
            1 - 0.55 * l->title / l->height, FONT * scale);
}

static void print_frame(FILE *f, const plot *p, const layout *l, bool text) {
    fputs("set encoding utf8\nset border 3 linecolor rgb '#555555'\n"
          "set tics textcolor rgb '#000000'\n",
          f);
    if (!text)
        fputs("set grid linetype 1 linecolor rgb '#dddddd' linewidth 0.5 "
              "dashtype solid, linetype 1 linecolor rgb '#dddddd' linewidth "
              "0.5 dashtype solid\n",
              f);
    if (l->legend > 0)
        fprintf(f,
                "set key at screen %.6f,%.6f left top vertical maxcols 1 Left "
                "reverse samplen %d spacing 1.2 noautotitle\n",
                (l->width - l->legend) / l->width,
                1 - (l->title + l->top) / l->height, text ? 3 : 2);
    else
        fputs("unset key\n", f);
    if (p->title && *p->title)
        print_title(f, p->title, l);
}

void plot_script(const plot *p, const target *t, FILE *f) {
    bool text = t->medium == PLOT_TEXT;
    layout l = plot_lay_out(p, t);
    print_terminal(f, t, &l);
    if (t->file)
        print_output(f, t->file);
    print_frame(f, p, &l, text);
    print_looks(f, p);
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].count)
            print_points(f, &p->series[i], i + 1);
    if (p->panels > 1)
        fputs("set multiplot\n", f);
    for (size_t i = 0; i < p->panels; i++) {
        print_place(f, i, &l);
        print_axes(f, p, i, &l, text);
        print_plots(f, p, i);
        if (i == 0)
            fputs("unset label 1\n", f);
    }
    if (p->panels > 1)
        fputs("unset multiplot\n", f);
}
