/* nevh: series of plots in the language of gnuplot.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <math.h>

static void print_data(FILE *f, const series *s) {
    for (size_t k = 0; k < s->count; k++)
        if (isnan(s->point[k].x))
            fputc('\n', f);
        else
            fprintf(f, "%.15g %.15g\n", s->point[k].x, s->point[k].y);
}

void plot_script_data(FILE *f, const plot *p) {
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].count) {
            fprintf(f, "$series%zu << EOD\n", i + 1);
            print_data(f, &p->series[i]);
            fputs("EOD\n", f);
        }
}

static void print_dash(FILE *f, const double dash[]) {
    fputs(dash[0] > 0 ? " dashtype (" : " dashtype solid", f);
    for (int i = 0; dash[i] > 0; i++)
        fprintf(f, dash[i + 1] > 0 ? "%g," : "%g)", dash[i]);
}

void plot_script_looks(FILE *f, const plot *p) {
    size_t looks = 0;
    for (size_t i = 0; i < p->count; i++)
        if (p->series[i].look >= looks)
            looks = p->series[i].look + 1;
    for (size_t k = 0; k < looks; k++) {
        fprintf(f, "set linetype %zu linecolor rgb '%s' linewidth 1.5", k + 1,
                plot_colour_of(k));
        print_dash(f, plot_look_dash(k));
        fprintf(f, " pointtype %d pointsize %g\n", plot_look_mark(k),
                PLOT_USUAL_SIZE);
    }
}

static void print_points(FILE *f, const plot_look *l) {
    fprintf(f, " pointtype %d pointsize %.2f", l->mark, l->size);
    if (l->every > 1)
        fprintf(f, " pointinterval %zu", l->every);
}

static void print_look(FILE *f, const series *s, const plot_look *l,
                       bool text) {
    fprintf(f, " with %s linetype %zu",
            l->opacity > 0 ? "filledcurves closed"
            : !l->mark     ? "lines"
            : l->width > 0 ? "linespoints"
                           : "points",
            s->look + 1);
    if (!l->own)
        fprintf(f, " linecolor rgb '%s'", l->colour);
    if (l->width > 0) {
        fprintf(f, " linewidth %g", l->width);
        print_dash(f, l->dash);
    }
    if (l->mark)
        print_points(f, l);
    if (l->opacity > 0 && text)
        fputs(" fillstyle empty border", f);
    else if (l->opacity > 0)
        fprintf(f, " fillstyle transparent solid %g border", l->opacity);
    if (l->opacity > 0 && l->edge)
        fprintf(f, " linecolor rgb '%s'", l->edge);
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

/* Draws a series, or with data NULL an entry of the legend alone. */
static void print_one(FILE *f, const series *s, const plot_look *l,
                      const char *data, const char *name, bool text) {
    fputs(data ? data : "NaN", f);
    print_look(f, s, l, text);
    print_name(f, name);
}

/* A series without points is an entry of the legend at most; letters are too
   coarse for guides.  Dots of the legend are large enough to be seen. */
static void print_series(FILE *f, const plot *p, size_t i, bool here,
                         bool titled, bool text, size_t *printed) {
    const series *s = &p->series[i];
    bool drawn = here && s->count;
    if (text && (s->form == PLOT_GUIDE || s->form == PLOT_LEVEL))
        return;
    plot_look look = plot_look_of(p, s), in_legend = look;
    if (in_legend.mark)
        in_legend.size = fmax(in_legend.size, PLOT_USUAL_SIZE);
    bool together = drawn && in_legend.size <= look.size;
    if (drawn) {
        char data[48];
        snprintf(data, sizeof data, "$series%zu using 1:2", i + 1);
        separate(f, printed);
        print_one(f, s, &look, data, titled && together ? s->name : NULL, text);
    }
    if (titled && !together) {
        separate(f, printed);
        print_one(f, s, &in_legend, NULL, s->name, text);
    }
    if (drawn && look.mark && look.edge)
        fprintf(f,
                ", \\\n    $series%zu using 1:2 with points linecolor rgb "
                "'%s' linewidth 1.5 pointtype %d pointsize %.2f notitle",
                i + 1, look.edge, look.mark - 1, look.size);
}

void plot_script_guides(FILE *f, const plot *p, size_t number,
                        const layout *l) {
    guide_name *names = tool_allocate(p->count + 1, sizeof *names);
    size_t count = plot_guide_names(p, number, l, names);
    for (size_t i = 0; i < count; i++) {
        fputs("set label ", f);
        plot_quote(f, names[i].text, PLOT_LONGEST_NAME);
        fprintf(f,
                " at graph %.6f,%.6f left noenhanced "
                "textcolor rgb '#777777' font ',%.3g'\n",
                names[i].left / l->panel_width,
                names[i].middle / l->panel_height, names[i].letter);
        if (names[i].far)
            fprintf(f,
                    "set arrow from graph %.6f,%.6f to graph %.6f,%.6f nohead "
                    "linecolor rgb '#999999' linewidth 0.8\n",
                    names[i].from.x / l->panel_width,
                    names[i].from.y / l->panel_height,
                    names[i].to.x / l->panel_width,
                    names[i].to.y / l->panel_height);
    }
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
