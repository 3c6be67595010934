/* nevh: plots in the language of gnuplot.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>
#include <string.h>

static void print_terminal(FILE *f, const target *t, const layout *l) {
    double w = l->width, h = l->height, scale = t->scale > 0 ? t->scale : 2;
    switch (t->medium) {
    case PLOT_SVG:
        fprintf(f,
                "set terminal svg size %g,%g dynamic enhanced font "
                "'sans-serif,%d' background '#ffffff'\n",
                w, h, PLOT_FONT);
        break;
    case PLOT_PNG:
        fprintf(f,
                "set terminal pngcairo size %g,%g enhanced font "
                "'sans-serif,%d' fontscale %g linewidth %g pointscale %g "
                "background '#ffffff'\n",
                floor(scale * w), floor(scale * h), PLOT_FONT,
                0.75 * scale, /* 96 pixels an inch */
                scale, scale);
        break;
    case PLOT_GIF: /* so many hundredths of a second each frame */
        fprintf(f,
                "set terminal gif animate optimize delay 7 loop 0 size %g,%g "
                "enhanced "
                "font 'sans,%d' fontscale 0.6 background '#ffffff'\n",
                floor(0.7 * w), floor(0.7 * h), PLOT_FONT);
        break;
    case PLOT_PDF:
        fprintf(f,
                "set terminal pdfcairo size %gin,%gin enhanced font "
                "'sans-serif,%d' fontscale 0.72 linewidth 1.5\n",
                w / 72, h / 72, PLOT_FONT);
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

static void print_axis(FILE *f, const char *letters, const axis *a,
                       bool numbers) {
    fprintf(f, "%s logscale %s\nset %srange [%.12g:%.12g]\n",
            a->log ? "set" : "unset", letters, letters, a->shown.low,
            a->shown.high);
    fprintf(f, a->count ? "set %stics nomirror out (" : "unset %stics\n",
            letters);
    for (size_t i = 0; i < a->count; i++)
        fprintf(f, "%s\"%s\" %.12g%s", i ? ", " : "",
                numbers ? a->tick[i].text : "", a->tick[i].at,
                a->tick[i].minor ? " 1" : "");
    fputs(a->count ? ")\n" : "", f);
}

static void print_map(FILE *f, const field_map *m, const layout *l) {
    for (size_t i = 0; i < PLOT_PALETTE; i++)
        fprintf(f, "%s%zu '#%06X'", i ? ", " : "set palette defined (", i,
                plot_palette[i]);
    fputs(
        ")\nset object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor "
        "rgb '#999999' fillstyle pattern 4 noborder\n",
        f);
    axis a = plot_map_axis(m, l->panel_height / (2 * l->line), l->letter == 1);
    char *label = plot_axis_label(&a, m->label, l->letter == 1);
    print_axis(f, "cb", &a, true);
    plot_quote_line(f, "set cblabel ", label, l->panel_height / l->letter,
                    " offset 0.5,0");
    double left = (l->left + l->panel_width + 2 * l->letter) / l->width;
    double top = 1 - (l->title + l->top) / l->height;
    fprintf(f, "set colorbox user origin %.6f,%.6f size %.6f,%.6f\n", left,
            top - l->panel_height / l->height, 2 * l->letter / l->width,
            l->panel_height / l->height);
    plot_map_values(m, f);
}

static void print_label(FILE *f, const char *before, const char *label,
                        double room, const char *after) {
    double size;
    char font[64], *text = plot_fit_label(label, room, &size);
    snprintf(font, sizeof font, " font ',%.3g'%s", size, after);
    plot_quote_line(f, before, text, (double)plot_letters(text), font);
}

/* Text has no letters that lie on their side. */
static void print_texts(FILE *f, const panel *on, const axes *a,
                        const layout *l, bool text) {
    double width = l->panel_width + 2 * l->right;
    double height = l->panel_height + l->top + 0.8 * l->bottom;
    char *x = plot_axis_label(&a->x, on->x, text);
    char *y = plot_axis_label(&a->y, on->y, text);
    if (text) {
        plot_quote_line(f, "set xlabel ", x, l->panel_width, "");
        char *title =
            text_print("%s%s%s", y ? y : "", on->heading && y ? ", " : "",
                       on->heading ? on->heading : "");
        plot_quote_line(f, "set title ", title, l->panel_width + l->left, "");
    } else {
        print_label(f, "set xlabel ", x, width, " offset 0,0.5");
        print_label(f, "set ylabel ", y, height, "");
        print_label(f, "set title ", on->heading, width, " offset 0,-0.5");
    }
}

static void print_axes(FILE *f, const plot *p, size_t number, const layout *l,
                       bool text) {
    axes a = plot_axes(p, number, l, text);
    panel on = p->panel[number];
    bool above = p->stacked && number + 1 < p->panels;
    print_axis(f, "x", &a.x, text || !above);
    print_axis(f, "y", &a.y, true);
    if (above)
        on.x = NULL;
    print_texts(f, &on, &a, l, text);
}

static void print_place(FILE *f, size_t number, const layout *l) {
    pair at = plot_panel_at(number, l);
    fprintf(f,
            "set lmargin at screen %.6f\nset rmargin at screen %.6f\n"
            "set tmargin at screen %.6f\nset bmargin at screen %.6f\n",
            at.x / l->width, (at.x + l->panel_width) / l->width,
            1 - at.y / l->height, 1 - (at.y + l->panel_height) / l->height);
}

static void print_title(FILE *f, const plot *p, const layout *l) {
    text_line lines[PLOT_MOST_LINES];
    size_t count = plot_title_lines(p, l, lines);
    for (size_t i = 0; i < count; i++) {
        fputs("set label ", f);
        plot_quote_part(f, lines[i].text, lines[i].bytes,
                        lines[i].cut ? " ..." : "");
        fprintf(f, " at screen 0.5,%.6f center noenhanced %sfont ',%.3g'\n",
                1 - lines[i].middle / l->height,
                lines[i].note ? "textcolor rgb '#444444' " : "", lines[i].size);
    }
}

static void print_key(FILE *f, const layout *l, bool text) {
    fprintf(f,
            "set key at screen %.6f,%.6f left top vertical maxcols 1 Left "
            "reverse samplen %d spacing 1.2 noautotitle\n",
            plot_legend_at(l).x / l->width, 1 - plot_legend_at(l).y / l->height,
            text ? 3 : 2);
}

/* Neither letters nor frames of an animation have a grid. */
static void print_frame(FILE *f, const plot *p, const layout *l, bool grid) {
    fputs("set encoding utf8\nset border 3 linecolor rgb '#555555'\n"
          "set tics textcolor rgb '#000000'\n",
          f);
    if (grid)
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
            plot_legend_at(l).x / l->width,
            1 - plot_legend_at(l).y / l->height);
    fputs("unset logscale\nunset border\nunset tics\nunset label\nunset arrow\n"
          "set xlabel ''\nset ylabel ''\nset title ''\n"
          "set xrange [0:1]\nset yrange [0:1]\n",
          f);
    print_key(f, l, text);
    plot_script_series(f, p, p->panels, true, text);
}

static void print_picture(FILE *f, const plot *p, const layout *l, bool text,
                          bool grid) {
    bool apart = l->legend + l->legend_height > 0 && l->legend_apart;
    bool several = p->panels > 1 || apart;
    print_frame(f, p, l, grid);
    plot_script_looks(f, p);
    plot_script_data(f, p);
    if (p->map.columns)
        print_map(f, &p->map, l);
    if (several)
        fputs("set multiplot\n", f);
    for (size_t i = 0; i < p->panels; i++) {
        bool legend = i == 0 && l->legend > 0 && !apart;
        if (i)
            fputs("unset label\nunset arrow\n", f);
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
        print_picture(f, p, &l, text, !text && t->medium != PLOT_GIF);
        if (p->next)
            fputs("unset label\nunset arrow\n", f);
    }
}
