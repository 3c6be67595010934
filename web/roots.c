/* nevh: the live page's module has the method of Illinois in place of GSL's search
   for zeros, and no search for minima.

   Sections look for zeros within a step.  One that turns twice within a step, where
   they would look for a minimum, has no points there.
   [M. Dowell, P. Jarratt, A modified regula falsi method for computing the root of
   an equation, BIT 11 (1971) 168-174.]
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "page.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_poly.h>
#include <gsl/gsl_roots.h>
#include <math.h>
#include <stdlib.h>

static const double certain = 1e-14; /* of the first interval */

/* Values at both ends, weighted; the first length. */
typedef struct {
    double low, high, least;
} ends;

const gsl_root_fsolver_type *gsl_root_fsolver_brent;

gsl_root_fsolver *gsl_root_fsolver_alloc(const gsl_root_fsolver_type *type) {
    gsl_root_fsolver *s = calloc(1, sizeof *s + sizeof(ends));
    (void)type;
    if (s)
        s->state = s + 1;
    return s;
}

void gsl_root_fsolver_free(gsl_root_fsolver *s) {
    free(s);
}

int gsl_root_fsolver_set(gsl_root_fsolver *s, gsl_function *f, double low,
                         double high) {
    ends *x = s->state;
    s->function = f;
    s->root = s->x_lower = low;
    s->x_upper = high;
    *x = (ends){GSL_FN_EVAL(f, low), GSL_FN_EVAL(f, high),
                certain * (high - low)};
    return (x->low < 0) == (x->high < 0) ? GSL_EINVAL : GSL_SUCCESS;
}

int gsl_root_fsolver_iterate(gsl_root_fsolver *s) {
    ends *x = s->state;
    double next =
        s->x_upper - x->high * (s->x_upper - s->x_lower) / (x->high - x->low);
    double value = GSL_FN_EVAL(s->function, next);
    bool done = value == 0 || fabs(next - s->root) <= x->least;
    bool upper = (value < 0) == (x->high < 0);
    /* The end that stays counts half where the other one has moved twice. */
    if (s->root == (upper ? s->x_upper : s->x_lower))
        *(upper ? &x->low : &x->high) /= 2;
    *(upper ? &s->x_upper : &s->x_lower) = next;
    *(upper ? &x->high : &x->low) = value;
    s->root = next;
    if (done)
        s->x_lower = s->x_upper = next;
    return GSL_SUCCESS;
}

double gsl_root_fsolver_x_lower(const gsl_root_fsolver *s) {
    return s->x_lower;
}

double gsl_root_fsolver_x_upper(const gsl_root_fsolver *s) {
    return s->x_upper;
}

static gsl_min_fminimizer none;
const gsl_min_fminimizer_type *gsl_min_fminimizer_brent;
gsl_min_fminimizer *gsl_min_fminimizer_alloc(const gsl_min_fminimizer_type *t) {
    (void)t;
    return &none;
}
void gsl_min_fminimizer_free(gsl_min_fminimizer *s) {
    (void)s;
}
int gsl_min_fminimizer_set_with_values(gsl_min_fminimizer *s, gsl_function *f,
                                       double x, double f_x, double low,
                                       double f_low, double high,
                                       double f_high) {
    (void)s, (void)f, (void)x, (void)f_x;
    (void)low, (void)f_low, (void)high, (void)f_high;
    return GSL_EFAILED;
}
int gsl_min_fminimizer_iterate(gsl_min_fminimizer *s) {
    (void)s;
    return GSL_EFAILED;
}
double gsl_min_fminimizer_x_minimum(const gsl_min_fminimizer *s) {
    return s->x_minimum;
}
double gsl_min_fminimizer_f_minimum(const gsl_min_fminimizer *s) {
    return s->f_minimum;
}
double gsl_min_fminimizer_x_lower(const gsl_min_fminimizer *s) {
    return s->x_lower;
}
double gsl_min_fminimizer_x_upper(const gsl_min_fminimizer *s) {
    return s->x_upper;
}
int gsl_poly_solve_quadratic(double a, double b, double c, double *x0,
                             double *x1) {
    (void)a, (void)b, (void)c, (void)x0, (void)x1;
    return 0;
}
