/* nevh fit: what its files share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FIT_PRIVATE_H
#define NEVH_FIT_PRIVATE_H

#include "measured.h"
#include <gsl/gsl_multifit_nlinear.h>

/* One varied number: a parameter, or where the motion starts. */
typedef struct {
    const char *name;
    bool start;          /* a coordinate, momentum or velocity */
    double first, scale; /* where it begins; what its changes are measured by */
    double value, error; /* fitted; error: one standard deviation */
    double low, high;    /* of 95 % of samples; infinite: no end was found */
    double moved;        /* by the last change of the scheme */
} varied;

#define FIT_ROUNDING 1e-9 /* of the spread of the data */

/* The scheme of the orbits. */
typedef struct {
    const char *integrator;
    double dt, tolerance;
} fit_scheme;

/* The effect of the scheme's error, beside the errors of the numbers. */
typedef enum {
    FIT_UNCHECKED, /* no finer orbit; `unchecked` says why */
    FIT_SMALL,
    FIT_WIDENED, /* the intervals are longer by `moved` */
    FIT_GIVEN,   /* the given scheme made the data */
    FIT_EITHER   /* it may have; longer by `moved`, too */
} fit_evidence;

typedef struct {
    plan *plan;
    fit_scheme given, now; /* the plan points to dt and tolerance of `now` */
    fit_evidence evidence;
    char *unchecked;
    size_t worst;      /* the number that the given scheme changes most, */
    double worst_part; /* by that many of its errors */
    measured *data;
    double sigma; /* of all, where the data have none; 1: unknown */
    bool sigma_known;
    varied *item;
    size_t count, used;  /* used: points so far */
    size_t held;         /* a number that is not varied now; count: none */
    double held_at;      /* in its scale */
    double tolerance;    /* of a minimum's numbers, relative */
    double difference;   /* of numbers, relative, for derivatives */
    double fastest;      /* frequency of a drive that the data show */
    bool profiled;       /* low and high are by refits */
    size_t residuals;    /* used x columns */
    uint64_t cost, most; /* gradients of an orbit; most: allowed, 0: any */
    char *why;           /* the last orbit failed; NULL */
    double *correlation; /* count x count */
    double chi_square, *rms;
    double spread;      /* of the data about their means, in such units */
    double rounding;    /* what it changes of an orbit, in such units */
    list asked;         /* gradients, where orbits have others; else empty */
    double *residual;   /* of the result, in units of their deviations */
    bool *undetermined; /* NULL: all are determined */
    char *direction;    /* the change that the data do not see */
    size_t iterations;
} fitting;

/* fit_orbit.c */
/* Finds the numbers that are varied, and their values in the scene.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int fit_begin(fitting *, const options *);
/* The residuals, of `used` points in units of their deviations, of the orbit with
   these values, in units of their scales.
   returns  whether there is one; else `why` says more */
bool fit_orbit(fitting *, const double x[], double residual[]);
/* Warns where the orbit that was found turns between the points. */
void fit_sparse_words(fitting *, list *words);

/* fit_scheme.c: orbits of smaller errors than those of now.
   level    from 0 on: dop853, then its smaller tolerances; with `stepwise`, shorter
            steps of the scheme of now
   returns  false where there is none */
bool fit_scheme_finer(const fitting *, size_t level, bool stepwise,
                      fit_scheme *);
/* Residuals of this length and below are rounding, from which errors are not to be
   had: they are those of this length. */
double fit_rounding(const fitting *);
double fit_own_rounding(const fitting *); /* the part that orbits have */
bool fit_is_rounding(const fitting *, double chi_square);
/* True if residuals have more than that part of the spread of the data. */
bool fit_leaves(const fitting *, double part, double chi_square);
/* Finds the change of the orbit by rounding: the last digits of the numbers, and
   the gradients that were asked for in place of exact ones. */
void fit_find_rounding(fitting *, const double x[]);
/* True if that is so much that the orbit does not determine the numbers. */
bool fit_is_chaotic(const fitting *);
bool fit_is_given(const fitting *); /* whether the scheme is */
void fit_scheme_words(const fitting *, list *words);
/* Warns if neighbouring residuals of a column are alike, which noise is not.
   returns  whether they are */
bool fit_residual_words(const fitting *, const double residual[], list *words);

/* fit_minimise.c */
gsl_vector *fit_vector(size_t n);
gsl_vector *fit_vector_copy(const gsl_vector *);
gsl_matrix *fit_matrix(size_t rows, size_t columns);
/* One fit to the first `used` points.
   x        in and out; all numbers but the one that is held
   w        out: the result, to be freed
   returns  0; a status of GSL */
int fit_minimise(fitting *, size_t used, gsl_vector *x, double *chi_square,
                 gsl_multifit_nlinear_workspace **w);
/* As gsl_multifit_nlinear_covar, which crashes where memory is out. */
void fit_covariance(const gsl_matrix *jacobian, gsl_matrix *c);
/* The least squares solution of J x = d, its part that x does not explain in d, and
   the covariance c of x where residuals have variance 1. */
void fit_explain(const gsl_matrix *jacobian, gsl_vector *d, gsl_matrix *c,
                 gsl_vector *x);

/* fit_interval.c */
double fit_variance(const fitting *, double chi_square); /* of a residual */
/* Errors, intervals and correlations of the numbers x.
   returns  NULL; else numbers whose sum of squares is lower, to be freed */
gsl_vector *fit_intervals(fitting *, const gsl_vector *x,
                          const gsl_matrix *jacobian);

/* Intervals that errors do not make. */
void fit_interval_words(const fitting *, list *words);

/* fit_solve.c
   returns  TOOL_OK, with values, errors and correlations; TOOL_FAILED where the
            iteration does not converge, an orbit fails (`why` says so) or
            numbers are not determined */
int fit_solve(fitting *);

#endif
