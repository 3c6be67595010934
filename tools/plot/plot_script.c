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

static void print_all_data(FILE *f, const plot *p, const layout *l,
                           bool thins) {
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

static void print_looks(FILE *f, const plot *p) {
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

/* Names at the ends of guides. */
static void print_guides(FILE *f, const plot *p, size_t number) {
    for (size_t i = 0; i < p->count; i++) {
        const series *s = &p->series[i];
        if (s->panel != number || s->form != PLOT_GUIDE || !s->count)
            continue;
        fputs("set label ", f);
        plot_quote(f, s->name, PLOT_LONGEST_NAME);
        fprintf(f,
                " at %.10g,%.10g left offset 0.5,0 noenhanced "
                "textcolor rgb '#777777' font ',%d'\n",
                s->point[s->count - 1].x, s->point[s->count - 1].y,
                PLOT_NOTE_FONT);
    }
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

static void print_plots(FILE *f, const plot *p, size_t number, bool legend,
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

/* As long as the panel and what is above and below it, if need be smaller. */
static void print_y_label(FILE *f, const char *label, const layout *l) {
    static const double letter = 0.57, smallest = 0.75;
    double room = l->panel_height + l->top + 0.8 * l->bottom;
    double letters = fmax(label ? (double)plot_letters(label) : 0, 1);
    double size = fmin(fmax(room / (letter * FONT * letters), smallest), 1);
    char font[32];
    snprintf(font, sizeof font, " font ',%.3g'", size * FONT);
    plot_quote_line(f, "set ylabel ", label, room / (letter * FONT * size),
                    font);
}

/* Text has no letters that lie on their side. */
static void print_texts(FILE *f, const panel *on, const axes *a,
                        const layout *l, bool text) {
    double width = l->panel_width / l->letter;
    char *x = plot_axis_label(&a->x, on->x, text);
    char *y = plot_axis_label(&a->y, on->y, text);
    plot_quote_line(f, "set xlabel ", x, width, text ? "" : " offset 0,0.5");
    if (text) {
        char *title =
            text_print("%s%s%s", y ? y : "", on->heading && y ? ", " : "",
                       on->heading ? on->heading : "");
        plot_quote_line(f, "set title ", title, width + l->left, "");
        free(title);
    } else {
        print_y_label(f, y, l);
        plot_quote_line(f, "set title ", on->heading, width, " offset 0,-0.5");
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
    print_texts(f, &on, &a, l, text);
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

static void print_key(FILE *f, const layout *l, bool text) {
    fprintf(f,
            "set key at screen %.6f,%.6f left top vertical maxcols 1 Left "
            "reverse samplen %d spacing 1.2 noautotitle\n",
            (l->width - l->legend) / l->width,
            1 - (l->title + l->top) / l->height, text ? 3 : 2);
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
            (l->width - l->legend) / l->width,
            1 - (l->title + l->top) / l->height);
    fputs("unset logscale\nunset border\nunset tics\nunset label\n"
          "set xlabel ''\nset ylabel ''\nset title ''\n"
          "set xrange [0:1]\nset yrange [0:1]\n",
          f);
    print_key(f, l, text);
    print_plots(f, p, p->panels, true, text);
}

static void print_picture(FILE *f, const plot *p, const layout *l, bool text,
                          bool on_page) {
    bool apart = l->legend > 0 && l->legend_apart;
    bool several = p->panels > 1 || apart;
    print_frame(f, p, l, text);
    print_looks(f, p);
    print_all_data(f, p, l, on_page);
    if (p->map.columns)
        print_map(f, &p->map, l);
    if (several)
        fputs("set multiplot\n", f);
    for (size_t i = 0; i < p->panels; i++) {
        bool legend = i == 0 && l->legend > 0 && !apart;
        if (i)
            fputs("unset label\n", f);
        if (!text)
            print_guides(f, p, i);
        print_place(f, i, l);
        print_axes(f, p, i, l, text);
        fputs("unset key\n", f);
        if (legend)
            print_key(f, l, text);
        print_plots(f, p, i, legend, text);
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
