/* nevh: plots: what is in them, and what draws them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PLOT_PRIVATE_H
#define NEVH_PLOT_PRIVATE_H

#include "plot.h"

typedef struct {
    double low, high;
} range;

typedef struct {
    double x, y; /* NAN: a break */
} pair;

typedef struct {
    char *name; /* NULL: not in the legend */
    size_t panel, look, dash;
    plot_form form;
    double size; /* 1: as usual */
    size_t count;
    pair *point;
} series;

typedef struct {
    char *heading, *x, *y;
    bool log_x, log_y, equal;
    range span_x, span_y; /* NAN: found */
    range limit_y;
    double least_y; /* high over low, at least; 0: any */
} panel;

/* See plot_map. */
typedef struct {
    size_t columns, rows; /* 0: there is none */
    double *x, *y, *z;
    char *label;
    bool log; /* values span decades */
    range shown;
    /* True where values crowd: z are ranks from 0 to 1, of these at the quarters. */
    bool ranked;
    double quarter[5];
} field_map;

struct plot {
    char *title, *note;
    panel *panel;
    series *series;
    size_t panels, count; /* count: of series */
    bool stacked;
    double same_ranges; /* see plot_same_ranges; 0: never */
    field_map map;
    size_t beside; /* panels side by side; 0: chosen */
    size_t hidden; /* points that no logarithmic axis shows */
    plot *next;    /* see plot_then; NULL: none */
};

/* plot_range.c: what an axis of a panel shows: the points, with some room, or
   whole decades. */
range plot_range_x(const plot *, size_t panel);
range plot_range_y(const plot *, size_t panel);
/* Makes one of them longer, so that a unit has the same length on both where
   the panel is `width` by `height`. */
void plot_range_equal(range *x, range *y, double width, double height);

/* plot_ticks.c: marks along an axis, and the numbers at them. */
enum { PLOT_MOST_TICKS = 128 };
typedef struct {
    double at;
    bool minor;    /* short, without a number */
    char text[32]; /* enhanced; of `at` less base, over 10^power */
} tick;
typedef struct {
    bool log;
    range shown;
    int power;
    double base;
    size_t count;
    tick tick[PLOT_MOST_TICKS];
} axis;
/* About so many numbers, or as many as have room where letters of that number
   fit beside each other. */
axis plot_axis(range, bool log, double count, bool text);
axis plot_axis_across(range, bool log, double letters, bool text);
size_t plot_axis_letters(const axis *); /* of the longest number */
/* With power and base; NULL: no label. */
char *plot_axis_label(const axis *, const char *label, bool text);

/* plot_map.c */
/* Cividis [J. R. Nunez, C. R. Anderton, R. S. Renslow, PLoS ONE 13 (2018)
   e0199239]: its lightness grows evenly, also for those who see few colours. */
enum { PLOT_PALETTE = 6 };
extern const unsigned plot_palette[PLOT_PALETTE];
/* The cell of value i ends half way to its neighbours. */
range plot_map_cell(size_t count, const double x[], size_t i);
/* The place of a value between the ends of the scale, as a share. */
double plot_map_share(const field_map *, double z);
/* Replaces values by ranks where most are in a small part of the scale. */
void plot_map_rank(field_map *);
/* The numbers beside the colours. */
axis plot_map_axis(const field_map *, double count, bool text);
/* The data block $map of gnuplot, and how it is drawn: as pixels, where values
   are equal steps apart, else as cells. */
void plot_map_values(const field_map *, FILE *);
void plot_map_style(const field_map *, FILE *);

/* plot_script.c: the whole in the language of gnuplot. */
typedef enum {
    PLOT_SVG,
    PLOT_PNG,
    PLOT_PDF,
    PLOT_GIF,
    PLOT_TEXT,
    PLOT_SCREEN
} medium;
typedef struct {
    medium medium;
    size_t columns, lines; /* of PLOT_TEXT */
    bool colours;          /* of PLOT_TEXT */
    const char *file;      /* NULL: gnuplot's stdout */
    size_t most_bytes;     /* of SVG; 0: PLOT_MOST_BYTES */
    double scale;          /* pixels of PNG a pixel of the layout; 0: 2 */
    bool narrow; /* for a telephone: panels and legend one below the other */
} target;
void plot_script(const plot *, const target *, FILE *);

/* plot_layout.c */
enum {
    PLOT_LONGEST_NAME = 48,
    PLOT_FONT = 14,      /* pixels */
    PLOT_MOST_LINES = 18 /* of the title and the note */
};
/* Lengths in pixels, or in letters and lines of text. */
typedef struct {
    double width, height, letter, line, legend;
    double panel_width, panel_height;
    double left, right, top, bottom; /* around a panel */
    double title;                    /* with the note */
    size_t columns, rows;
    size_t title_lines, note_lines;
    double title_scale; /* of its letters */
    double small;      /* letters of the note, and of names in panels: pixels */
    bool legend_apart; /* it is longer than a panel */
    bool narrow;       /* the legend is below, labels of y axes above */
    double legend_height;
} layout;
/* The axes of a panel. */
typedef struct {
    axis x, y;
} axes;
axes plot_axes(const plot *, size_t panel, const layout *, bool text);
layout plot_lay_out(const plot *, const target *);
/* True if the legend shows this series for its name. */
bool plot_in_legend(const plot *, size_t series);
/* Bytes of the letter, as UTF-8 has them; 0 where it is none. */
size_t plot_letter_bytes(const unsigned char *);
size_t plot_letters(const char *text);
/* Upper left corners, from that of the picture. */
pair plot_panel_at(size_t number, const layout *);
pair plot_legend_at(const layout *);
/* The lines of the title and the note. */
typedef struct {
    const char *text;
    size_t bytes;
    bool cut, note;
    double middle, size; /* middle: from the top */
} text_line;
size_t plot_title_lines(const plot *, const layout *,
                        text_line lines[PLOT_MOST_LINES]);
/* A label that is smaller, or shorter, where it has no room otherwise: a third of
   the letters is the name's at least; the unit, which begins with a factor, has the
   others.
   size  out: of its letters */
char *plot_fit_label(const char *label, double room, double *size);

/* plot_thin.c: fewer points, which look the same on a panel of that size. */
typedef struct {
    range x, y;
    bool log_x, log_y;
    double width, height; /* pixels */
    double detail;        /* what is smaller is not shown: pixels */
} plot_screen;
typedef enum {
    THIN_LINE,
    THIN_SOLID, /* also: no part that lies over another of the series */
    THIN_DOTS   /* none that lies over another */
} plot_thinning;
/* The largest distance, in pixels, from a point left out, within the panel, to the
   line that is drawn. */
double plot_thin_error(plot_thinning, double detail);
/* to  has room for twice as many; points of `from`, and breaks
   returns  how many they are */
size_t plot_thin(const plot_screen *, plot_thinning, const pair from[],
                 size_t count, pair to[]);
pair plot_in_pixels(const plot_screen *, pair);
/* Clips the line from a to b to a rectangle; false if it is outside. */
bool plot_clip(pair *a, pair *b, pair low, pair high);
plot_screen plot_screen_of(const plot *, size_t panel, const layout *);

/* plot_forms.c: how series look. */
#define PLOT_USUAL_SIZE 0.7
enum { /* as gnuplot numbers them: from squares on one more is filled */
       PLOT_PLUS = 1,
       PLOT_CROSS = 2,
       PLOT_SQUARE = 4,
       PLOT_CIRCLE = 6,
       PLOT_DISC,
       PLOT_TRIANGLE,
       PLOT_DIAMOND = 12
};
typedef double plot_dash_lengths[5]; /* line, gap ..., 0; of a width of 2 */
typedef struct {
    char colour[16];
    bool own;     /* the colour is that of the look */
    double width; /* of the line; 0: none */
    const double *dash;
    int mark;         /* 0: none */
    double size;      /* of the mark, as gnuplot has it */
    size_t every;     /* so many points have a mark */
    double opacity;   /* of what is enclosed; 0: not filled */
    const char *edge; /* colour round what is filled; NULL: the same */
    bool many;        /* marks over others need not be drawn */
} plot_look;
plot_look plot_look_of(const plot *, const series *);
const double *plot_look_dash(size_t look);
int plot_look_mark(size_t look);

/* plot_guides.c: names at the ends of the guides of a panel, in its pixels.
   names    has room for as many as there are series
   returns  how many have a place */
typedef struct {
    double left, right, middle;
    double letter; /* its size */
    const char *text;
    bool far; /* from the point that it names: a line joins them, */
    pair from, to;
} guide_name;
size_t plot_guide_names(const plot *, size_t panel, const layout *,
                        guide_name names[]);

/* plot_series.c: looks, points and curves in the language of gnuplot. */
void plot_script_looks(FILE *, const plot *);
void plot_script_data(FILE *, const plot *);
void plot_script_guides(FILE *, const plot *, size_t number, const layout *);
/* The curves of a panel, with the legend of the whole plot if need be. */
void plot_script_series(FILE *, const plot *, size_t number, bool legend,
                        bool text);

/* plot_quote.c: a text in double quotes: its first `bytes`, and `more`; at most
   so many letters; with a command around it. */
void plot_quote_part(FILE *, const char *text, size_t bytes, const char *more);
void plot_quote(FILE *, const char *text, size_t longest);
char *plot_shortened(const char *text, size_t longest);
void plot_quote_line(FILE *, const char *before, const char *text,
                     double length, const char *after);

/* plot_svg.c: the whole as SVG, of no more bytes than a page can bear: detail goes
   before. */
enum { PLOT_MOST_BYTES = 400000 };
void plot_svg(const plot *, const target *, FILE *);

/* plot_svg_series.c: what is in a panel.
   at  its upper left corner */
void plot_svg_series(FILE *, const plot *, const series *, const plot_screen *,
                     pair at);
/* A line of the legend that begins there. */
void plot_svg_sample(FILE *, const plot *, const series *, pair at);
void plot_svg_map(FILE *, const field_map *, const plot_screen *, pair at);
void plot_svg_palette(FILE *, double left, double top, double height);

/* plot_gnuplot.c: gnuplot --version, and a script to be drawn to a file.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int gnuplot_check(void);
int gnuplot_draw(FILE *script, FILE *drawing, medium);

#endif
