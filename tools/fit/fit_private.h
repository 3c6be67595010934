/* nevh fit: what its files share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FIT_PRIVATE_H
#define NEVH_FIT_PRIVATE_H

#include "measured.h"

/* One varied number: a parameter, or where the motion starts. */
typedef struct {
    const char *name;
    bool start;          /* a coordinate, momentum or velocity */
    double first, scale; /* where it begins; what its changes are measured by */
    double value, error; /* fitted; error: one standard deviation */
    double low, high;    /* of 95 % of samples */
} varied;

typedef struct {
    plan *plan;
    const char *integrator;
    measured *data;
    double sigma; /* of all, where the data have none; 1: unknown */
    bool sigma_known;
    varied *item;
    size_t count, used;  /* used: points so far */
    size_t residuals;    /* used x columns */
    size_t orbits;       /* that were taken */
    char *why;           /* the last orbit failed; NULL */
    double *correlation; /* count x count */
    double chi_square, *rms;
    bool *undetermined; /* NULL: all are determined */
    char *direction;    /* the change that the data do not see */
    size_t iterations;
} fitting;

/* fit_orbit.c */
/* What is varied, and its values in the scene.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int fit_begin(fitting *, const options *);
/* The residuals, of `used` points in units of their deviations, of the orbit with
   these values, in units of their scales.
   returns  whether there is one; else `why` says more */
bool fit_orbit(fitting *, const double x[], double residual[]);

/* fit_solve.c
   returns  TOOL_OK, with values, errors and correlations; TOOL_FAILED where the
            iteration does not converge, an orbit fails (`why` says so) or
            numbers are not determined */
int fit_solve(fitting *);

#endif
