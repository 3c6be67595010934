/* nevh: measured points, as --data names them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_MEASURED_H
#define NEVH_MEASURED_H

#include "orbit/columns.h"
#include "orbit/trajectory.h"

/* A CSV file: lines that begin with # are left out, a header line, then a row a
   point.  The column t, columns of coordinates, momenta (p_NAME) and observables,
   in units of the scene, and standard deviations: sigma_NAME of one of them,
   sigma of all. */
typedef struct {
    const char *file;
    list names, left_out; /* left_out: columns that the scene does not know */
    size_t points, columns;
    double *t;      /* points; sorted */
    double *value;  /* points x columns */
    double *sigma;  /* the same; NULL: none is given */
    double *period; /* columns; 0: none */
    size_t late;    /* points after the end, which are left out */
} measured;
/* Reads what --data names.
   only     the columns to take, as --columns has them; NULL: all that the scene
            knows
   returns  TOOL_OK, or TOOL_USAGE with the message printed, which names line and
            column */
int measured_read(measured *, const plan *, const options *, const char *only);
/* As measured_read, for columns of other names, without t. */
int measured_read_named(measured *, const plan *, const options *,
                        const list *names);
/* The number of a column; `columns` where there is none of that name. */
size_t measured_find(const measured *, const char *name);
/* The measured value less `model`; for an angle the smallest of all turns. */
double measured_residual(const measured *, size_t point, size_t column,
                         double model);
/* The plan ends at the last of the points, those of --t-end left out. */
void measured_bound(measured *, plan *, const options *);
row_times measured_times(const measured *);

/* Residuals of rows at the measured times, one by one. */
typedef struct {
    const measured *data;
    quantities columns;
    double *model, *squares; /* columns each */
    size_t next;             /* the point that is due */
} residuals_of_rows;
void residuals_begin(residuals_of_rows *, const measured *, const plan *);
void residuals_end(residuals_of_rows *);
/* NAN where the time is not that of the point that is due. */
void residuals_take(residuals_of_rows *, double t, const double q[],
                    const double p[], double residual[]);
/* "rms of the residuals of x: 0.004 m (121 points)", a line each. */
void residuals_words(const residuals_of_rows *, const plan *, list *words);
/* "120 points of x, y in FILE"; what was left out, a line each. */
void measured_note(const measured *, list *notes);

#endif
