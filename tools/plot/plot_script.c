/* nevh: plots in the language of gnuplot.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FONT = 14 };

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
    case PLOT_GIF: /* so many hundredths of a second each frame */
        fprintf(f,
                "set terminal gif animate delay 6 loop 0 size %g,%g enhanced "
                "font 'sans,%d' fontscale 0.75 background '#ffffff'\n",
                w, h, FONT);
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

/* A name that begins with | would be a command, with ~ a user's home. */
static void print_output(FILE *f, const char *file) {
    fputs("set output \"", f);
    if (*file == '|' || *file == '~')
        fputs("./", f);
    for (const char *c = file; *c; c++)
        if ((unsigned char)*c < ' ' || strchr("\\\"`", *c))
            fprintf(f, "\\%03o", (unsigned char)*c);
        else
            fputc(*c, f);
    fputs("\"\n", f);
}

/* Cividis [J. R. Nunez, C. R. Anderton, R. S. Renslow, PLoS ONE 13 (2018)
   e0199239]: its lightness grows evenly, also for those who see few colours. */
static void print_map(FILE *f, const field_map *m, const layout *l) {
    fputs("set palette defined (0 '#00204D', 1 '#31446B', 2 '#666970', 3 "
          "'#958F78', 4 '#CBBA69', 5 '#FFEA46')\n"
          "set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor "
          "rgb '#999999' fillstyle pattern 4 noborder\n",
          f);
    fprintf(f, "set cbrange [%.12g:%.12g]\n%s", m->shown.low, m->shown.high,
            m->log ? "set logscale cb\nset format cb '10^{%T}'\n" : "");
    plot_quote_line(f, "set cblabel ", m->label, l->panel_height / l->letter,
                    " offset 0.5,0");
    double left = (l->left + l->panel_width + 2 * l->letter) / l->width;
    double top = 1 - (l->title + l->top) / l->height;
    fprintf(f, "set colorbox user origin %.6f,%.6f size %.6f,%.6f\n", left,
            top - l->panel_height / l->height, 2 * l->letter / l->width,
            l->panel_height / l->height);
    plot_map_values(m, f);
}

static void print_axis(FILE *f, char letter, const axis *a) {
    fprintf(f, "%s logscale %c\nset %crange [%.12g:%.12g]\n",
            a->log ? "set" : "unset", letter, letter, a->shown.low,
            a->shown.high);
    fprintf(f, a->count ? "set %ctics nomirror out (" : "unset %ctics\n",
            letter);
    for (size_t i = 0; i < a->count; i++)
        fprintf(f, "%s\"%s\" %.12g%s", i ? ", " : "", a->tick[i].text,
                a->tick[i].at, a->tick[i].minor ? " 1" : "");
    fputs(a->count ? ")\n" : "", f);
}

/* A third of so many letters is the name's at least; the unit, which begins with a
   factor, has the others.  To be freed. */
static char *shorter_label(const char *label, size_t letters) {
    const char *unit = strrchr(label, '(');
    size_t name = unit ? plot_letters(label) - plot_letters(unit) : 0;
    size_t least = letters / 3, unit_and_dots = plot_letters(label) - name + 4;
    size_t kept =
        letters > unit_and_dots + least ? letters - unit_and_dots : least;
    size_t bytes = 0;
    if (!unit || plot_letters(label) <= letters || name <= kept)
        return text_print("%s", label);
    while (kept--)
        bytes += plot_letter_bytes((const unsigned char *)label + bytes);
    return text_print("%.*s... %s", (int)bytes, label, unit);
}

/* Smaller where it has no room otherwise. */
static void print_label(FILE *f, const char *before, const char *label,
                        double room, const char *after) {
    static const double letter = 0.57, smallest = 0.75;
    double letters = fmax(label ? (double)plot_letters(label) : 0, 1);
    double size = fmin(fmax(room / (letter * FONT * letters), smallest), 1);
    double most = fmax(room / (letter * FONT * size), 8);
    char *text = shorter_label(label ? label : "", (size_t)most);
    char font[64];
    snprintf(font, sizeof font, " font ',%.3g'%s", size * FONT, after);
    plot_quote_line(f, before, text, most, font);
    free(text);
}

static double top_of(size_t number, const layout *l) {
    double row = (double)(number / l->columns);
    return l->height - l->title - l->top -
           row * (l->top + l->panel_height + l->bottom);
}

/* top  of the panel, of the picture's height */
static void print_y_label(FILE *f, const char *label, double top,
                          const layout *l) {
    double beside = l->panel_height + l->top + 0.8 * l->bottom;
    char place[64];
    snprintf(place, sizeof place, " at screen %.6f,%.6f left",
             l->letter / l->width, top + 1.2 * l->line / l->height);
    if (l->narrow)
        print_label(f, "set label ", label, l->width - 2 * l->letter, place);
    else
        print_label(f, "set ylabel ", label, beside, "");
}

/* Text has no letters that lie on their side. */
static void print_texts(FILE *f, const panel *on, const axes *a, double top,
                        const layout *l, bool text) {
    double width = l->panel_width + 2 * l->right;
    char *x = plot_axis_label(&a->x, on->x, text);
    char *y = plot_axis_label(&a->y, on->y, text);
    if (text) {
        plot_quote_line(f, "set xlabel ", x, l->panel_width, "");
        char *title =
            text_print("%s%s%s", y ? y : "", on->heading && y ? ", " : "",
                       on->heading ? on->heading : "");
        plot_quote_line(f, "set title ", title, l->panel_width + l->left, "");
        free(title);
    } else {
        print_label(f, "set xlabel ", x, width, " offset 0,0.5");
        print_y_label(f, y, top, l);
        print_label(f, "set title ", on->heading, width,
                    l->narrow ? " offset 0,0.4" : " offset 0,-0.5");
    }
    free(x);
    free(y);
}

static void print_axes(FILE *f, const plot *p, size_t number, const layout *l,
                       bool text) {
    axes a = plot_axes(p, number, l, text);
    print_axis(f, 'x', &a.x);
    print_axis(f, 'y', &a.y);
    panel on = p->panel[number];
    if (p->stacked && number + 1 < p->panels)
        on.x = NULL;
    print_texts(f, &on, &a, top_of(number, l) / l->height, l, text);
}

static void print_place(FILE *f, size_t number, const layout *l) {
    double left = l->left + (double)(number % l->columns) *
                                (l->left + l->panel_width + l->right);
    double top = top_of(number, l);
    fprintf(f,
            "set lmargin at screen %.6f\nset rmargin at screen %.6f\n"
            "set tmargin at screen %.6f\nset bmargin at screen %.6f\n",
            left / l->width, (left + l->panel_width) / l->width,
            top / l->height, (top - l->panel_height) / l->height);
}

/* A line in the middle, so many lines from the top. */
static void print_line(FILE *f, const char *text, size_t bytes, bool cut,
                       double line, const layout *l, const char *font) {
    fputs("set label ", f);
    plot_quote_part(f, text, bytes, cut ? " ..." : "");
    fprintf(f, " at screen 0.5,%.6f center noenhanced %s\n",
            1 - line * l->line / l->height, font);
}

static void print_lines(FILE *f, const char *text, size_t letters, size_t lines,
                        double first, double apart, const layout *l,
                        const char *font) {
    for (size_t i = 0; i < lines; i++) {
        size_t bytes = plot_line_bytes(text, letters);
        bool cut = i + 1 == lines && text[bytes];
        print_line(f, text, bytes, cut, first + apart * (double)i, l, font);
        text += bytes;
        text += *text == ' ';
    }
}

static void print_title(FILE *f, const plot *p, const layout *l) {
    bool text = l->letter == 1;
    double apart = text ? 1 : 1.2;
    double begin =
        p->title && *p->title ? 0.9 + apart * (double)l->title_lines : 0;
    char font[80];
    snprintf(font, sizeof font, "font ',%.3g'", FONT * l->title_scale);
    print_lines(f, p->title, plot_title_letters(l), l->title_lines, 1.1, apart,
                l, font);
    snprintf(font, sizeof font, "textcolor rgb '#444444' font ',%d'",
             PLOT_NOTE_FONT);
    print_lines(f, p->note, plot_note_letters(l), l->note_lines, begin,
                text ? 1 : 0.95, l, font);
}

static double legend_top(const layout *l) {
    return l->narrow ? l->legend_height / l->height
                     : 1 - (l->title + l->top) / l->height;
}

static void print_key(FILE *f, const layout *l, bool text) {
    fprintf(f,
            "set key at screen %.6f,%.6f left top vertical maxcols 1 Left "
            "reverse samplen %d spacing 1.2 noautotitle\n",
            l->narrow ? l->letter / l->width
                      : (l->width - l->legend) / l->width,
            legend_top(l), text ? 3 : 2);
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
    print_title(f, p, l);
}

/* A panel of the whole height, in which nothing is but the legend: gnuplot
   leaves out entries that are below a panel. */
static void print_legend(FILE *f, const plot *p, const layout *l, bool text) {
    fprintf(f,
            "set lmargin at screen %.6f\nset rmargin at screen 1\n"
            "set tmargin at screen %.6f\nset bmargin at screen 0\n",
            l->narrow ? 0 : (l->width - l->legend) / l->width, legend_top(l));
    fputs("unset logscale\nunset border\nunset tics\nunset label\n"
          "set xlabel ''\nset ylabel ''\nset title ''\n"
          "set xrange [0:1]\nset yrange [0:1]\n",
          f);
    print_key(f, l, text);
    plot_script_series(f, p, p->panels, true, text);
}

static void print_picture(FILE *f, const plot *p, const layout *l, bool text,
                          bool on_page) {
    bool apart = l->legend + l->legend_height > 0 && l->legend_apart;
    bool several = p->panels > 1 || apart;
    print_frame(f, p, l, text);
    plot_script_looks(f, p);
    plot_script_data(f, p, l, on_page);
    if (p->map.columns)
        print_map(f, &p->map, l);
    if (several)
        fputs("set multiplot\n", f);
    for (size_t i = 0; i < p->panels; i++) {
        bool legend = i == 0 && l->legend > 0 && !apart;
        if (i)
            fputs("unset label\n", f);
        if (!text)
            plot_script_guides(f, p, i, l);
        print_place(f, i, l);
        print_axes(f, p, i, l, text);
        fputs("unset key\n", f);
        if (legend)
            print_key(f, l, text);
        plot_script_series(f, p, i, legend, text);
    }
    if (apart)
        print_legend(f, p, l, text);
    if (several)
        fputs("unset multiplot\n", f);
}

void plot_script(const plot *p, const target *t, FILE *f) {
    layout l = plot_lay_out(p, t);
    print_terminal(f, t, &l);
    if (t->file)
        print_output(f, t->file);
    bool text = t->medium == PLOT_TEXT;
    for (; p; p = p->next) {
        print_picture(f, p, &l, text, t->on_page);
        if (p->next)
            fputs("unset label\n", f);
    }
}
