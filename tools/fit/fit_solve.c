/* nevh fit: nonlinear least squares, by GSL's Levenberg-Marquardt method.

   A fit to a long orbit has many local minima, where the model is a turn ahead.
   So it is made twice: from the first values, and by and by, from the first
   eighth of the points to all of them; the better of the two counts.

   Its orbits are then computed by a finer scheme, and it is made again, until that
   changes no number by more than a tenth of its error. */
#include "fit_private.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ITERATIONS = 100 };
static const double tolerance = 1e-9;  /* of the numbers, relative */
static const double difference = 6e-6; /* cube root of the rounding */
static const double least_size = 0.01; /* of a number, in its scale */
static const double no_orbit = 1e100;  /* residuals of a step too far */
static const double undetermined = 1e-6;
static const double no_effect = 1e-8; /* what rounding makes is below */

static gsl_vector *new_vector(size_t n) {
    return tool_owned(gsl_vector_alloc(n));
}

static gsl_matrix *new_matrix(size_t rows, size_t columns) {
    return tool_owned(gsl_matrix_alloc(rows, columns));
}

/* The model less the data, as GSL has it; a trial that has no orbit is worse than
   any that has. */
static int residuals(const gsl_vector *x, void *data, gsl_vector *r) {
    fitting *f = data;
    if (fit_orbit(f, x->data, r->data))
        gsl_vector_scale(r, -1);
    else
        gsl_vector_set_all(r, no_orbit);
    return GSL_SUCCESS;
}

/* Central differences. */
static int derivatives(const gsl_vector *x, void *data, gsl_matrix *j) {
    fitting *f = data;
    size_t n = f->residuals;
    double *at = tool_allocate(f->count + 2 * n, sizeof *at);
    double *after = at + f->count, *before = after + n;
    bool good = true;
    memcpy(at, x->data, f->count * sizeof *at);
    for (size_t k = 0; good && k < f->count; k++) {
        double h = difference * fmax(fabs(at[k]), least_size), middle = at[k];
        volatile double right = middle + h, left = middle - h;
        at[k] = right;
        good = fit_orbit(f, at, after);
        at[k] = left;
        good = good && fit_orbit(f, at, before);
        at[k] = middle;
        for (size_t i = 0; good && i < n; i++)
            gsl_matrix_set(j, i, k, (before[i] - after[i]) / (right - left));
    }
    free(at);
    return good ? GSL_SUCCESS : GSL_EFAILED;
}

/* Relative changes along a direction: "l by 1 % and g by 1 %", the first being 1;
   of numbers that are 0 there are none, and names alone are told. */
static void tell_direction(fitting *f, const gsl_vector *along) {
    static const double part_of_it = 0.03;
    double first = 0;
    bool relative = true;
    free(f->direction);
    f->direction = text_print("%s", "");
    for (size_t k = 0; k < f->count; k++) {
        double part = gsl_vector_get(along, k), size = f->item[k].value;
        f->undetermined[k] = fabs(part) > part_of_it * gsl_blas_dnrm2(along);
        if (!f->undetermined[k])
            continue;
        double change = part * f->item[k].scale / size;
        relative = relative && isfinite(change);
        first = first != 0 ? first : change;
        char *longer = text_print("%s%s%s by %.3g %%", f->direction,
                                  *f->direction ? " and " : "", f->item[k].name,
                                  change / first);
        free(f->direction);
        f->direction = longer;
    }
    if (!relative)
        *f->direction = '\0';
}

/* Whether all columns of the matrix, made as long as each other, are
   independent. */
static bool determined(fitting *f, const gsl_matrix *jacobian) {
    size_t p = f->count;
    gsl_matrix *a = new_matrix(f->residuals, p), *v = new_matrix(p, p);
    gsl_vector *s = new_vector(p), *work = new_vector(p);
    double *length = tool_allocate(p, sizeof *length), longest = 0;
    bool good = true;
    gsl_matrix_memcpy(a, jacobian);
    for (size_t k = 0; k < p; k++) {
        gsl_vector_view column = gsl_matrix_column(a, k);
        length[k] = gsl_blas_dnrm2(&column.vector);
        longest = fmax(longest, length[k]);
    }
    free(f->undetermined);
    f->undetermined = tool_allocate(p, sizeof *f->undetermined);
    for (size_t k = 0; k < p; k++) {
        gsl_vector_view column = gsl_matrix_column(a, k);
        bool none = !(length[k] > no_effect * longest);
        f->undetermined[k] = none;
        good = good && !none;
        if (!none)
            gsl_vector_scale(&column.vector, 1 / length[k]);
    }
    if (good) {
        gsl_linalg_SV_decomp(a, v, s, work);
        good = gsl_vector_get(s, p - 1) > undetermined * gsl_vector_get(s, 0);
        gsl_vector_view along = gsl_matrix_column(v, p - 1);
        for (size_t k = 0; !good && k < p; k++)
            *gsl_vector_ptr(&along.vector, k) /= length[k];
        if (!good)
            tell_direction(f, &along.vector);
    }
    if (good) {
        free(f->undetermined);
        f->undetermined = NULL;
    }
    gsl_matrix_free(a);
    gsl_matrix_free(v);
    gsl_vector_free(s);
    gsl_vector_free(work);
    free(length);
    return good;
}

/* The least squares solution of J x = d, or of its part that x does not explain,
   in d. */
static void explain(const gsl_matrix *jacobian, gsl_vector *d, gsl_matrix *c,
                    gsl_vector *x) {
    gsl_vector *slope = new_vector(x->size);
    gsl_multifit_nlinear_covar(jacobian, 0, c);
    gsl_blas_dgemv(CblasTrans, 1, jacobian, d, 0, slope);
    gsl_blas_dgemv(CblasNoTrans, 1, c, slope, 0, x);
    gsl_blas_dgemv(CblasNoTrans, -1, jacobian, x, 1, d);
    gsl_vector_free(slope);
}

/* Whether the step of Gauss and Newton lowers the squares by rounding alone: GSL's
   driver fails where the first values are the minimum. */
static bool at_minimum(const fitting *f,
                       const gsl_multifit_nlinear_workspace *w) {
    static const double part = 1e-5;
    gsl_matrix *c = new_matrix(f->count, f->count);
    gsl_vector *x = new_vector(f->count), *d = new_vector(f->residuals);
    gsl_vector_memcpy(d, gsl_multifit_nlinear_residual(w));
    double before = gsl_blas_dnrm2(d);
    bool exact = fit_is_rounding(f, before * before);
    explain(gsl_multifit_nlinear_jac(w), d, c, x);
    double gain = before - gsl_blas_dnrm2(d);
    gsl_matrix_free(c);
    gsl_vector_free(x);
    gsl_vector_free(d);
    return exact || gain <= part * part * before;
}

/* One fit to the first `used` points.
   x        in and out
   returns  0, and w holds the result; a status of GSL */
static int fit_part(fitting *f, size_t used, gsl_vector *x, double *chi_square,
                    gsl_multifit_nlinear_workspace **w) {
    gsl_multifit_nlinear_parameters how =
        gsl_multifit_nlinear_default_parameters();
    f->used = used;
    f->residuals = used * f->data->columns;
    gsl_multifit_nlinear_fdf what = {.f = residuals,
                                     .df = derivatives,
                                     .n = f->residuals,
                                     .p = f->count,
                                     .params = f};
    int info = 0;
    *w = tool_owned(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how,
                                               f->residuals, f->count));
    free(f->why);
    f->why = NULL;
    int status = gsl_multifit_nlinear_init(x, &what, *w);
    if (!status && f->why)
        status = GSL_EFAILED;
    if (!status)
        status = gsl_multifit_nlinear_driver(
            MOST_ITERATIONS, tolerance, tolerance, 0, NULL, NULL, &info, *w);
    f->iterations = gsl_multifit_nlinear_niter(*w);
    gsl_vector *r = gsl_multifit_nlinear_residual(*w);
    gsl_blas_ddot(r, r, chi_square);
    if (status == GSL_ENOPROG || /* rounding is all that is left */
        (status == GSL_EMAXITER && at_minimum(f, *w)))
        status = GSL_SUCCESS;
    if (status != GSL_EFAILED) { /* an orbit that failed was a trial's */
        free(f->why);
        f->why = NULL;
    }
    gsl_vector_memcpy(x, gsl_multifit_nlinear_position(*w));
    return status;
}

static void start_values(const fitting *f, gsl_vector *x) {
    for (size_t k = 0; k < f->count; k++)
        gsl_vector_set(x, k, f->item[k].first / f->item[k].scale);
}

/* By and by; parts that fail leave the values as they are. */
static void approach(fitting *f, gsl_vector *x) {
    gsl_vector *before = new_vector(f->count);
    start_values(f, x);
    for (size_t part = 8; part > 1; part /= 2) {
        gsl_multifit_nlinear_workspace *w;
        size_t used = f->data->points / part;
        double chi_square;
        if (used * f->data->columns < 2 * f->count + 2)
            continue;
        gsl_vector_memcpy(before, x);
        if (fit_part(f, used, x, &chi_square, &w) ||
            !determined(f, gsl_multifit_nlinear_jac(w)))
            gsl_vector_memcpy(x, before);
        free(f->undetermined);
        f->undetermined = NULL;
        gsl_multifit_nlinear_free(w);
    }
    gsl_vector_free(before);
}

/* Of one residual. */
static double variance(const fitting *f, double chi_square) {
    double least = fit_rounding(f), degrees = (double)(f->residuals - f->count);
    return f->sigma_known || f->data->sigma
               ? 1
               : fmax(chi_square, least * least) / degrees;
}

static void take_errors(fitting *f, const gsl_matrix *jacobian) {
    size_t p = f->count;
    double degrees = (double)(f->residuals - p);
    double scale = variance(f, f->chi_square);
    bool longer = f->evidence == FIT_WIDENED || f->evidence == FIT_EITHER;
    double wide = f->sigma_known || f->data->sigma
                      ? gsl_cdf_ugaussian_Pinv(0.975)
                      : gsl_cdf_tdist_Pinv(0.975, degrees);
    gsl_matrix *c = new_matrix(p, p);
    gsl_multifit_nlinear_covar(jacobian, 0, c);
    f->correlation = tool_allocate(p * p, sizeof *f->correlation);
    for (size_t k = 0; k < p; k++) {
        varied *v = &f->item[k];
        v->error = sqrt(scale * gsl_matrix_get(c, k, k)) * v->scale;
        double more = longer ? fabs(v->moved) : 0;
        v->low = v->value - wide * v->error - more;
        v->high = v->value + wide * v->error + more;
        for (size_t i = 0; i < p; i++)
            f->correlation[k * p + i] =
                gsl_matrix_get(c, k, i) /
                sqrt(gsl_matrix_get(c, k, k) * gsl_matrix_get(c, i, i));
    }
    gsl_matrix_free(c);
}

/* Of each column, in its own unit. */
static void take_rms(fitting *f, const gsl_vector *residual) {
    const measured *m = f->data;
    f->rms = tool_allocate(m->columns, sizeof *f->rms);
    for (size_t i = 0; i < f->residuals; i++) {
        double r =
            gsl_vector_get(residual, i) * (m->sigma ? m->sigma[i] : f->sigma);
        f->rms[i % m->columns] += r * r;
    }
    for (size_t k = 0; k < m->columns; k++)
        f->rms[k] = sqrt(f->rms[k] / (double)m->points);
}

static int take_result(fitting *f, const gsl_vector *x,
                       gsl_multifit_nlinear_workspace *w) {
    if (!determined(f, gsl_multifit_nlinear_jac(w)))
        return TOOL_FAILED;
    take_rms(f, gsl_multifit_nlinear_residual(w));
    take_errors(f, gsl_multifit_nlinear_jac(w));
    /* The plan is that of the result. */
    f->residual = tool_allocate(f->residuals, sizeof *f->residual);
    return fit_orbit(f, x->data, f->residual) ? TOOL_OK : TOOL_FAILED;
}

/* A fit to all points. */
typedef struct {
    gsl_vector *x;
    gsl_multifit_nlinear_workspace *w;
    double chi_square;
    int status;
    size_t iterations;
    char *why;
} attempt;

/* x  is taken over */
static attempt attempt_from(fitting *f, gsl_vector *x) {
    attempt a = {.x = x};
    a.status = fit_part(f, f->data->points, a.x, &a.chi_square, &a.w);
    a.iterations = f->iterations;
    a.why = f->why;
    f->why = NULL;
    return a;
}

static void attempt_free(attempt *a) {
    gsl_multifit_nlinear_free(a->w);
    gsl_vector_free(a->x);
    free(a->why);
}

/* The better of two; the other is freed. */
static attempt better(attempt a, attempt b) {
    bool second = !b.status && (a.status || b.chi_square < a.chi_square);
    attempt_free(second ? &a : &b);
    return second ? b : a;
}

static attempt attempt_all(fitting *f) {
    gsl_vector *x[2] = {new_vector(f->count), new_vector(f->count)};
    start_values(f, x[0]);
    attempt a = attempt_from(f, x[0]);
    approach(f, x[1]);
    return better(a, attempt_from(f, x[1]));
}

/* What orbits of another scheme change. */
typedef struct {
    bool orbit; /* there is one; else f->why */
    bool small; /* in numbers, and in residuals that numbers do not explain */
    bool far;   /* so much that the minimum may be another one */
} change;

static void judge_change(fitting *f, const attempt *a, gsl_vector *d,
                         change *result) {
    static const double part = 0.1, phase = 0.1;
    gsl_matrix *c = new_matrix(f->count, f->count);
    gsl_vector *x = new_vector(f->count);
    double s = variance(f, a->chi_square), all = gsl_blas_dnrm2(d), worst = 0;
    double level = fmax(sqrt(a->chi_square), fit_rounding(f));
    explain(gsl_multifit_nlinear_jac(a->w), d, c, x);
    for (size_t k = 0; k < f->count; k++) {
        double moved = -gsl_vector_get(x, k);
        double error = sqrt(s * gsl_matrix_get(c, k, k));
        double of_error = moved != 0 ? fabs(moved) / error : 0;
        f->item[k].moved = moved * f->item[k].scale;
        if (!(of_error <= worst)) {
            worst = of_error;
            f->worst = f->evidence == FIT_UNCHECKED ? k : f->worst;
        }
    }
    if (f->evidence == FIT_UNCHECKED)
        f->worst_part = worst;
    result->small = worst < part && gsl_blas_dnrm2(d) <= part * level;
    result->far = all > phase * f->spread;
    gsl_matrix_free(c);
    gsl_vector_free(x);
}

/* The plan computes orbits by `finer` afterwards. */
static change compare_scheme(fitting *f, const attempt *a,
                             const fit_scheme *finer) {
    change result = {0};
    gsl_vector *d = new_vector(f->residuals);
    f->now = *finer;
    result.orbit = fit_orbit(f, a->x->data, d->data);
    if (result.orbit) {
        gsl_vector_scale(d, -1);
        gsl_vector_sub(d, gsl_multifit_nlinear_residual(a->w));
        judge_change(f, a, d, &result);
    }
    gsl_vector_free(d);
    return result;
}

static gsl_vector *copy_vector(const gsl_vector *x) {
    gsl_vector *copy = new_vector(x->size);
    gsl_vector_memcpy(copy, x);
    return copy;
}

/* Levels of smaller errors, until the next one changes nothing.
   stepwise  as fit_scheme_finer has it
   returns   false where a level has no orbit */
static bool refine(fitting *f, attempt *a, bool stepwise) {
    fit_scheme finer;
    for (size_t level = 0; fit_scheme_finer(f, level, stepwise, &finer);
         level++) {
        fit_scheme before = f->now;
        if (!determined(f, gsl_multifit_nlinear_jac(a->w)))
            return true;
        change c = compare_scheme(f, a, &finer);
        if (!c.orbit || c.small)
            f->now = before;
        if (!c.orbit)
            return false;
        f->evidence = c.small ? FIT_SMALL : FIT_WIDENED;
        if (c.small)
            return true;
        attempt b = attempt_from(f, copy_vector(a->x));
        attempt_free(a);
        *a = c.far || b.status ? better(b, attempt_all(f)) : b;
        if (a->status)
            return true;
    }
    return true;
}

/* Data that the given scheme itself made: its residuals are rounding, and those of
   more exact orbits are not; or both are.
   x, chi_square  of the given scheme */
static void weigh_given(fitting *f, attempt *a, const gsl_vector *x,
                        double chi_square) {
    if (fit_is_given(f) || !fit_is_rounding(f, chi_square))
        return;
    for (size_t k = 0; !a->status && k < f->count; k++)
        f->item[k].moved =
            (gsl_vector_get(a->x, k) - gsl_vector_get(x, k)) * f->item[k].scale;
    bool either = !a->status && fit_is_rounding(f, a->chi_square);
    f->evidence = either ? FIT_EITHER : FIT_GIVEN;
    if (either)
        return;
    f->now = f->given;
    attempt_free(a);
    *a = attempt_from(f, copy_vector(x));
}

static void check_scheme(fitting *f, attempt *a) {
    static const uint64_t dearer = 300, least = 100000;
    gsl_vector *x = copy_vector(a->x);
    double chi_square = a->chi_square;
    f->most = dearer * f->cost + least;
    if (!refine(f, a, false) && f->evidence == FIT_UNCHECKED)
        if (!refine(f, a, true)) {
            f->unchecked = f->why;
            f->why = NULL;
        }
    weigh_given(f, a, x, chi_square);
    gsl_vector_free(x);
    f->most = 0;
}

int fit_solve(fitting *f) {
    attempt a = attempt_all(f);
    if (!a.status)
        check_scheme(f, &a);
    f->chi_square = a.chi_square;
    f->iterations = a.iterations;
    for (size_t k = 0; k < f->count; k++)
        f->item[k].value = gsl_vector_get(a.x, k) * f->item[k].scale;
    free(f->why);
    f->why = a.why;
    a.why = NULL;
    int result = a.status ? TOOL_FAILED : take_result(f, a.x, a.w);
    attempt_free(&a);
    return result;
}
