/* nevh: plots: SVG is written, other pictures are drawn by gnuplot.
   SPDX-License-Identifier: GPL-3.0-or-later

   Texts may hold anything: no shell and no gnuplot ever reads them as more than
   text.  Points that are not finite are left out and interrupt a line; where an
   axis is logarithmic, points that are not positive are left out. */
#ifndef NEVH_PLOT_H
#define NEVH_PLOT_H

#include "experiment/plan.h"

typedef struct plot plot;
typedef enum {
    PLOT_LINES,
    PLOT_TRAIL,      /* lines that are never dashed */
    PLOT_BEHIND,     /* a thick pale line */
    PLOT_REFERENCE,  /* a grey line */
    PLOT_MARKED,     /* lines with a marker here and there */
    PLOT_BOTH,       /* lines with a marker at each point */
    PLOT_POINTS,     /* markers */
    PLOT_MEASURED,   /* dark, with a mark that no integrator has */
    PLOT_DOTS,       /* the smaller the more they are */
    PLOT_RINGS,      /* such, but hollow */
    PLOT_RODS,       /* thick grey lines */
    PLOT_BOBS,       /* large discs */
    PLOT_GREY_BOBS,  /* such, grey */
    PLOT_START,      /* small circles */
    PLOT_LEVEL,      /* thin pale lines */
    PLOT_SEPARATRIX, /* a dark line */
    PLOT_CENTRE,     /* discs, dark */
    PLOT_SADDLE,     /* crosses, dark */
    PLOT_FILLED,     /* a closed line, and what it encloses in a pale colour */
    PLOT_HOLE,       /* a closed line, and what it encloses in white */
    PLOT_GUIDE /* a thin grey line with its name at the last point, and not in
                    the legend */
} plot_form;

/* A plot of one panel, the current one.  Labels come with their units; texts
   are copied, and NULL is none. */
plot *plot_new(const char *title, const char *x, const char *y);
/* Smaller, below the title: what was run, and how to read the picture. */
void plot_note(plot *, const char *text);
/* Adds a panel and makes it the current one. */
void plot_panel(plot *, const char *heading, const char *x, const char *y);
/* The heading of the current panel. */
void plot_heading(plot *, const char *text);

/* Settings of the current panel. */
void plot_log(plot *, bool x, bool y);
void plot_equal(plot *);                           /* as long on x as on y */
void plot_span_x(plot *, double low, double high); /* exactly this */
void plot_span_y(plot *, double low, double high);
void plot_limit_y(plot *, double low, double high); /* no more than this */
void plot_least_y(plot *, double factor); /* of a logarithmic axis: no less */
/* Panels of the same axes show the same ranges, but for those whose range is more than
   `times` as long as the median. */
void plot_same_ranges(plot *, double times);
/* The first panel is a map: values z[row*columns + column] at x[column], y[row],
   in colours that are lighter the larger they are, so that they read in grey, by
   rank where most are close together; hatched where they are NAN.  All are copied. */
void plot_map(plot *, size_t columns, const double x[], size_t rows,
              const double y[], const double z[], const char *label);
/* The look of an integrator, the same in all pictures, and its colour. */
size_t plot_look_of_integrator(const char *name);
const char *plot_colour_of(size_t look);
/* The series looks as this integrator does in all pictures; a second one of it in
   the picture, such as with another step, has the same colour. */
void plot_set_look(plot *, size_t series, size_t look);
void plot_integrator(plot *, size_t series, const char *name);
/* The series has the points of one orbit of several: up to 16 differ in colour, or in
   that dots are rings; more have small dots. */
void plot_member(plot *, size_t series, size_t member, size_t members);
/* So many panels side by side, small ones where they are many. */
void plot_columns(plot *, size_t columns);
/* Panels are wide, one below the other, over one axis. */
void plot_stack(plot *);

/* The next frame of an animation, which is owned from then on: of the same panels
   and ranges. */
void plot_then(plot *, plot *next);

/* A series of the current panel; returns its number.  Series of the same name
   look the same, and are in the legend once; NULL: not at all. */
size_t plot_series(plot *, const char *name);
void plot_style(plot *, size_t series, plot_form);
void plot_size(plot *, size_t series, double size); /* of its marks; 1: usual */
void plot_dash(plot *, size_t series, size_t dash); /* 0: none */
void plot_like(plot *, size_t series, size_t other); /* the same colour */
/* Another dash than those before it in the panel that have its colour. */
void plot_dash_apart(plot *, size_t series);
void plot_point(plot *, size_t series, double x, double y);
void plot_break(plot *, size_t series); /* the line ends */

/* plot_words.c */
/* "NAME (UNIT)", or "NAME, BODY (UNIT)" where [picture] names the body of a coordinate
   of an array, the unit being the scene's label of `of`, or, for a momentum
   without one, what follows from those of energy, t and the coordinate. */
char *plot_label(const plan *, const char *name, const char *of);
/* The name of bob number n of [picture]: its own, else "bob 1", or "body 1" where there
   are no rods; NULL: the only one, which has none. */
char *plot_bob_name(const nevh_scene *, size_t n);
/* Scheme, gradient and time.
   scheme  NULL: several, and all gradients are named
   more    NULL or "": nothing */
void plot_note_run(plot *, const plan *, const char *scheme, const char *more);
/* "verlet, dt = 0.1 s": the first dt or tolerance of the plan. */
char *plot_scheme(const plan *, const char *integrator);
/* "H = 0.125 J at the start". */
char *plot_energy_at_start(const plan *);

/* section_plot.c: a panel, the first making the plot.
      numbers  of each point t, direction, and the items of the section
   member   of each point, rising: which of the orbits it is of, a look each; NULL:
            all of one
   names    the key to the orbits; NULL: none
   heading  NULL: the section's name
   integrator  which made the points */
void section_plot(plot **, const plan *, const nevh_scene_section *,
                  size_t points, const double numbers[], const size_t member[],
                  const list *names, const char *heading,
                  const char *integrator);

bool plot_wanted(const options *); /* --plot or --keep-plot-script */
/* Checks what plot_write needs: a known ending, files that can be written, gnuplot
   unless the picture is SVG.  To be called before the long work, and before any
   output is opened.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int plot_check(const options *);
/* For commands that print rows: true if a picture replaces them, and no file or
   format was asked for. */
bool plot_replaces_rows(const options *);
/* Then, what was drawn, where that is in a file; points: 0 is not said. */
void plot_written_report(const options *, const plan *, const char *integrator,
                         size_t points);
/* True if the picture goes to a file, which is to be written before the rows are
   printed: a reader that stops early ends the program. */
bool plot_goes_first(const options *);
/* Draws to --plot and keeps the script as --keep-plot-script says.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int plot_write(plot *, const options *);

#endif
