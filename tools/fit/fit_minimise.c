/* nevh fit: one minimum of the sum of squares, by GSL's Levenberg-Marquardt method.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit_private.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlin.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_ITERATIONS = 100 };
static const double least_size = 0.01; /* of a number, in its scale */
static const double no_orbit = 1e100;  /* residuals of a step too far */

gsl_vector *fit_vector(size_t n) {
    return tool_owned(gsl_vector_alloc(n));
}

gsl_matrix *fit_matrix(size_t rows, size_t columns) {
    return tool_owned(gsl_matrix_alloc(rows, columns));
}

gsl_vector *fit_vector_copy(const gsl_vector *x) {
    gsl_vector *copy = fit_vector(x->size);
    gsl_vector_memcpy(copy, x);
    return copy;
}

/* All numbers, of those that are free. */
static double *complete(const fitting *f, const gsl_vector *x) {
    double *all = tool_allocate(f->count, sizeof *all);
    for (size_t k = 0, i = 0; k < f->count; k++)
        all[k] = k == f->held ? f->held_at : gsl_vector_get(x, i++);
    return all;
}

/* The model less the data, as GSL has it; a trial that has no orbit is worse than
   any that has. */
static int residuals(const gsl_vector *x, void *data, gsl_vector *r) {
    fitting *f = data;
    double *at = complete(f, x);
    if (fit_orbit(f, at, r->data))
        gsl_vector_scale(r, -1);
    else
        gsl_vector_set_all(r, no_orbit);
    tool_release(at);
    return GSL_SUCCESS;
}

/* Central differences. */
static int derivatives(const gsl_vector *x, void *data, gsl_matrix *j) {
    fitting *f = data;
    size_t n = f->residuals;
    double *at = complete(f, x), *after = tool_allocate(2 * n, sizeof *after);
    double *before = after + n;
    bool good = true;
    for (size_t k = 0, column = 0; good && k < f->count; k++) {
        double h = f->difference * fmax(fabs(at[k]), least_size);
        double middle = at[k];
        volatile double right = middle + h, left = middle - h;
        if (k == f->held)
            continue;
        at[k] = right;
        good = fit_orbit(f, at, after);
        at[k] = left;
        good = good && fit_orbit(f, at, before);
        at[k] = middle;
        for (size_t i = 0; good && i < n; i++)
            gsl_matrix_set(j, i, column,
                           (before[i] - after[i]) / (right - left));
        column++;
    }
    tool_release(at);
    tool_release(after);
    return good ? GSL_SUCCESS : GSL_EFAILED;
}

void fit_covariance(const gsl_matrix *jacobian, gsl_matrix *c) {
    size_t columns = jacobian->size2;
    size_t least = columns < jacobian->size1 ? columns : jacobian->size1;
    gsl_matrix *r = fit_matrix(jacobian->size1, columns);
    gsl_vector *tau = fit_vector(least), *norm = fit_vector(columns);
    gsl_permutation *order = tool_owned(gsl_permutation_alloc(columns));
    int sign;
    gsl_matrix_memcpy(r, jacobian);
    gsl_linalg_QRPT_decomp(r, tau, order, &sign, norm);
    gsl_multifit_covar_QRPT(r, order, 0, c);
    gsl_matrix_free(r);
    gsl_vector_free(tau);
    gsl_vector_free(norm);
    gsl_permutation_free(order);
}

void fit_explain(const gsl_matrix *jacobian, gsl_vector *d, gsl_matrix *c,
                 gsl_vector *x) {
    gsl_vector *slope = fit_vector(x->size);
    fit_covariance(jacobian, c);
    gsl_blas_dgemv(CblasTrans, 1, jacobian, d, 0, slope);
    gsl_blas_dgemv(CblasNoTrans, 1, c, slope, 0, x);
    gsl_blas_dgemv(CblasNoTrans, -1, jacobian, x, 1, d);
    gsl_vector_free(slope);
}

/* True if a step of Gauss and Newton lowers the squares by rounding alone: GSL's
   driver fails if the first values are the minimum. */
static bool at_minimum(const fitting *f,
                       const gsl_multifit_nlinear_workspace *w) {
    static const double part = 1e-5;
    size_t free = f->count - (f->held < f->count);
    gsl_matrix *c = fit_matrix(free, free);
    gsl_vector *x = fit_vector(free), *d = fit_vector(f->residuals);
    gsl_vector_memcpy(d, gsl_multifit_nlinear_residual(w));
    double before = gsl_blas_dnrm2(d);
    bool exact = fit_is_rounding(f, before * before);
    fit_explain(gsl_multifit_nlinear_jac(w), d, c, x);
    double gain = before - gsl_blas_dnrm2(d);
    gsl_matrix_free(c);
    gsl_vector_free(x);
    gsl_vector_free(d);
    return exact || gain <= part * part * before;
}

int fit_minimise(fitting *f, size_t used, gsl_vector *x, double *chi_square,
                 gsl_multifit_nlinear_workspace **w) {
    gsl_multifit_nlinear_parameters how =
        gsl_multifit_nlinear_default_parameters();
    f->used = used;
    f->residuals = used * f->data->columns;
    gsl_multifit_nlinear_fdf what = {.f = residuals,
                                     .df = derivatives,
                                     .n = f->residuals,
                                     .p = x->size,
                                     .params = f};
    int info = 0;
    *w = tool_owned(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how,
                                               f->residuals, x->size));
    f->why = NULL;
    int status = gsl_multifit_nlinear_init(x, &what, *w);
    if (!status && f->why)
        status = GSL_EFAILED;
    if (!status)
        status =
            gsl_multifit_nlinear_driver(MOST_ITERATIONS, f->tolerance,
                                        f->tolerance, 0, NULL, NULL, &info, *w);
    f->iterations = gsl_multifit_nlinear_niter(*w);
    gsl_vector *r = gsl_multifit_nlinear_residual(*w);
    gsl_blas_ddot(r, r, chi_square);
    if (status == GSL_ENOPROG || /* rounding is all that is left */
        (status == GSL_EMAXITER && at_minimum(f, *w)))
        status = GSL_SUCCESS;
    if (status != GSL_EFAILED) /* an orbit that failed was a trial's */
        f->why = NULL;
    gsl_vector_memcpy(x, gsl_multifit_nlinear_position(*w));
    return status;
}
