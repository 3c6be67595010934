/* nevh run --plot: what the kinds of pictures share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUN_PLOT_PRIVATE_H
#define NEVH_RUN_PLOT_PRIVATE_H

#include "columns.h"
#include "fit/measured.h"
#include "orbit.h"
#include "plot/plot.h"

typedef struct {
    const options *options;
    plan plan; /* a copy, which may end earlier */
    orbits orbits;
    orbit
        reference; /* without an integrator; without rows where there is none */
    const row_times *rows; /* asked for by options; NULL: by the picture */
    measured data;         /* of no points where there are none */
    bool outside;          /* a panel leaves measured outliers out */
    bool quiet;            /* failures are not printed */
} run_picture;

/* The panels of --columns A:B,C: names that are joined share one. */
typedef struct {
    quantities columns;
    size_t *panel; /* of each column */
    size_t panels;
} column_panels;
/* returns  TOOL_OK, or TOOL_USAGE with the message printed */
int column_panels_read(column_panels *, const plan *, const char *text);

/* Measured points, of the columns with these names, over the panel.
   x, y    columns of the data; x: NULL for time
   period  that x is taken modulo; 0: none */
void picture_measured(const run_picture *, plot *, const char *name,
                      const char *x, const char *y, double period);

/* Runs of all; the worst of their statuses. */
int picture_follow(run_picture *, const row_times *, size_t columns,
                   orbit_fill *, void *data);
/* The same for columns, of which shadow_error needs to know whose run it is. */
int column_panels_follow(run_picture *, const row_times *, column_panels *);
/* Checks that some of the orbits have the shadow H that is shown: TOOL_OK, or
   TOOL_USAGE with the message printed. */
int column_panels_check(const run_picture *, column_panels *);
/* Ends a run that goes round often after about so many turns, unless its length
   was asked for; it is to be followed again then.
   returns  what is to be said of it; NULL: it stays */
enum { PICTURE_TURNS = 12 };
char *picture_cut(run_picture *, double turns, double wanted);
/* Title, and the note with what is said of orbits, and more; a plot is made
   with the labels. */
void picture_note(const run_picture *, plot *, const char *more);
/* The number of panels side by side. */
size_t picture_across(const run_picture *);
/* Which orbits ended early, and when, or "". */
char *picture_early(const run_picture *);

/* Finds the orbit of the reference, to which all are compared: exact, by Taylor series
   or by a finer run, until the end of the picture.
   returns  false where there is none */
bool picture_refer(run_picture *, size_t columns, orbit_fill *, void *data);
bool column_panels_refer(run_picture *, column_panels *);
/* A panel each: the reference first, if there is one. */
size_t picture_columns(const run_picture *);
const orbit *picture_orbit(const run_picture *, size_t column);
/* "exact solution", "verlet, ended at t = 3". */
char *picture_heading(const run_picture *, size_t column);

/* The range of these columns: that of the reference, or else of the first orbit, and of
   the others as far as they do not leave it by far; with a margin. */
typedef struct {
    double low, high;
} picture_range;
picture_range picture_extent(const run_picture *, const size_t columns[],
                             size_t count);

/* Widens the range so that no measured number of the column is cut off, but for
   outliers, which would stretch the axis; true where there are some, and `outside` is. */
bool picture_widen_measured(run_picture *, const char *column, picture_range *);
/* The same of the ranges of a panel where both columns were measured. */
void picture_hold_measured(run_picture *, const char *x, const char *y,
                           picture_range *across, picture_range *up);

/* Each makes a plot; NULL, with a message printed, where it cannot. */
#define PLOT_FUNCTION(name, draws, help) plot *plot_##name(run_picture *);
RUN_PLOTS(PLOT_FUNCTION)

#endif
