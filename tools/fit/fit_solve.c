/* nevh fit: nonlinear least squares, by GSL's Levenberg-Marquardt method.

   A fit to a long orbit has many local minima, where the model is a turn ahead.
   So it is made twice: from the first values, and by and by, from the first
   eighth of the points to all of them; the second counts where noise alone would not
   make it so much better.  Where both explain little of the data, it is made by and
   by from that of some values farther off which fits the beginning best.

   Its orbits are then computed by a finer scheme, and it is made again, until that
   changes no number by more than a tenth of its error. */
#include "fit_private.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

enum { EIGHTH = 8 };
static const double undetermined = 1e-6;
static const double no_effect = 1e-8; /* what rounding makes is below */

/* Relative changes along a direction: "l by 1 % and g by 1 %", the first being 1;
   of numbers that are 0 there are none, and names alone are told. */
static void describe_direction(fitting *f, const gsl_vector *along) {
    static const double part_of_it = 0.03;
    double first = 0;
    bool relative = true;
    f->direction = text_print("%s", "");
    for (size_t k = 0; k < f->count; k++) {
        double part = gsl_vector_get(along, k), size = f->item[k].value;
        f->undetermined[k] = fabs(part) > part_of_it * gsl_blas_dnrm2(along);
        if (!f->undetermined[k])
            continue;
        double change = part * f->item[k].scale / size;
        relative = relative && isfinite(change);
        first = first != 0 ? first : change;
        text_extend(&f->direction, "%s%s by %.3g %%",
                    *f->direction ? " and " : "", f->item[k].name,
                    change / first);
    }
    if (!relative)
        *f->direction = '\0';
}

/* True if all columns of the matrix, scaled to equal length, are independent. */
static bool determined(fitting *f, const gsl_matrix *jacobian) {
    size_t p = f->count;
    gsl_matrix *a = fit_matrix(f->residuals, p), *v = fit_matrix(p, p);
    gsl_vector *s = fit_vector(p), *work = fit_vector(p);
    double *length = tool_allocate(p, sizeof *length), longest = 0;
    bool good = true;
    gsl_matrix_memcpy(a, jacobian);
    for (size_t k = 0; k < p; k++) {
        gsl_vector_view column = gsl_matrix_column(a, k);
        length[k] = gsl_blas_dnrm2(&column.vector);
        longest = fmax(longest, length[k]);
    }
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
            describe_direction(f, &along.vector);
    }
    if (good)
        f->undetermined = NULL;
    gsl_matrix_free(a);
    gsl_matrix_free(v);
    gsl_vector_free(s);
    gsl_vector_free(work);
    tool_release(length);
    return good;
}

static void start_values(const fitting *f, gsl_vector *x) {
    for (size_t k = 0; k < f->count; k++)
        gsl_vector_set(x, k, f->item[k].first / f->item[k].scale);
}

/* Fits a part of the data; where that fails, leaves the values as they are.
   returns  the sum of squares for each number measured; infinity if it fails */
static double fit_part(fitting *f, size_t part, gsl_vector *x) {
    gsl_multifit_nlinear_workspace *w;
    size_t used = f->data->points / part;
    double chi_square;
    if (used * f->data->columns < 2 * f->count + 2)
        return INFINITY;
    gsl_vector *before = fit_vector_copy(x);
    bool failed = fit_minimise(f, used, x, &chi_square, &w) ||
                  !determined(f, gsl_multifit_nlinear_jac(w));
    if (failed)
        gsl_vector_memcpy(x, before);
    f->undetermined = NULL;
    gsl_multifit_nlinear_free(w);
    gsl_vector_free(before);
    return failed ? INFINITY : chi_square / (double)f->residuals;
}

/* Fits growing parts of the data. */
static void approach(fitting *f, gsl_vector *x) {
    for (size_t part = EIGHTH; part > 1; part /= 2)
        fit_part(f, part, x);
}

/* Values of which one number is farther off: those that fit the beginning best.
   returns  whether there are any */
static bool approach_from_afar(fitting *f, gsl_vector *x) {
    static const double changes[] = {-0.75, -0.5, -0.3, 0.4, 1, 3};
    enum { CHANGES = sizeof changes / sizeof *changes };
    double least = INFINITY;
    gsl_vector *from = fit_vector(f->count);
    for (size_t i = 0; i < f->count * CHANGES; i++) {
        start_values(f, from);
        double first = gsl_vector_get(from, i / CHANGES);
        gsl_vector_set(from, i / CHANGES,
                       first + changes[i % CHANGES] * (first ? first : 1));
        double squares = fit_part(f, EIGHTH, from);
        if (squares < least)
            gsl_vector_memcpy(x, from);
        least = fmin(least, squares);
    }
    gsl_vector_free(from);
    if (least < INFINITY)
        approach(f, x);
    return least < INFINITY;
}

/* Finds the root mean square of each column, in its own unit. */
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
    a.status = fit_minimise(f, f->data->points, a.x, &a.chi_square, &a.w);
    a.iterations = f->iterations;
    a.why = f->why;
    f->why = NULL;
    return a;
}

static void attempt_free(attempt *a) {
    gsl_multifit_nlinear_free(a->w);
    gsl_vector_free(a->x);
}

/* The first, which is nearer to the first values, unless the second is lower by what
   noise does not make: where there are many minima, the lowest is often another one
   than that of the truth.  The other is freed. */
static attempt better(const fitting *f, attempt a, attempt b) {
    static const double beyond_noise = 16; /* four standard deviations */
    double by = beyond_noise * fit_variance(f, b.chi_square);
    bool second = !b.status && (a.status || b.chi_square < a.chi_square - by);
    attempt_free(second ? &a : &b);
    return second ? b : a;
}

static attempt attempt_all(fitting *f) {
    static const double much = 0.5;
    gsl_vector *x[2] = {fit_vector(f->count), fit_vector(f->count)};
    start_values(f, x[0]);
    start_values(f, x[1]);
    attempt a = attempt_from(f, x[0]);
    approach(f, x[1]);
    a = better(f, a, attempt_from(f, x[1]));
    if (!a.status && !fit_leaves(f, much, a.chi_square))
        return a;
    gsl_vector *afar = fit_vector(f->count);
    if (approach_from_afar(f, afar))
        return better(f, a, attempt_from(f, afar));
    gsl_vector_free(afar);
    return a;
}

/* The change by orbits of another scheme. */
typedef struct {
    bool orbit; /* there is one; else f->why */
    bool small; /* in numbers, and in residuals that numbers do not explain */
    bool far;   /* so much that the minimum may be another one */
} change;

static void judge_change(fitting *f, const attempt *a, gsl_vector *d,
                         change *result) {
    static const double part = 0.1, phase = 0.1;
    gsl_matrix *c = fit_matrix(f->count, f->count);
    gsl_vector *x = fit_vector(f->count);
    double s = fit_variance(f, a->chi_square), all = gsl_blas_dnrm2(d),
           worst = 0;
    double level = fmax(sqrt(a->chi_square), fit_rounding(f));
    fit_explain(gsl_multifit_nlinear_jac(a->w), d, c, x);
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
    gsl_vector *d = fit_vector(f->residuals);
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

/* Levels of smaller errors, until the next one changes nothing.
   stepwise  as fit_scheme_finer has it
   returns   false where a level has no orbit, or there is none */
static bool refine(fitting *f, attempt *a, bool stepwise) {
    fit_scheme finer;
    size_t level = 0;
    for (; fit_scheme_finer(f, level, stepwise, &finer); level++) {
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
        attempt b = attempt_from(f, fit_vector_copy(a->x));
        attempt_free(a);
        *a = c.far || b.status ? better(f, b, attempt_all(f)) : b;
        if (a->status)
            return true;
    }
    return level > 0;
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
    *a = attempt_from(f, fit_vector_copy(x));
}

static void check_scheme(fitting *f, attempt *a) {
    static const uint64_t dearer = 300, least = 100000;
    gsl_vector *x = fit_vector_copy(a->x);
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

static void take_values(fitting *f, const attempt *a) {
    f->chi_square = a->chi_square;
    f->iterations = a->iterations;
    for (size_t k = 0; k < f->count; k++)
        f->item[k].value = gsl_vector_get(a->x, k) * f->item[k].scale;
}

/* True if it is so near that it is the same minimum. */
static bool is_same(const fitting *f, const attempt *a) {
    static const double near = 2; /* errors */
    bool same = !a->status;
    for (size_t k = 0; k < f->count; k++) {
        const varied *v = &f->item[k];
        double x = gsl_vector_get(a->x, k) * v->scale;
        same = same && fabs(x - v->value) <= near * v->error;
    }
    return same;
}

/* From lower sums that were found on the way to the ends of intervals, which are
   taken over.
   returns  whether they lead to numbers that are better */
static bool improve(fitting *f, attempt *a, gsl_vector *lower) {
    attempt b = attempt_from(f, lower), before = *a;
    if (is_same(f, &b)) {
        attempt_free(a);
        *a = b;
    } else
        *a = better(f, *a, b);
    return a->x != before.x;
}

static int take_result(fitting *f, attempt *a) {
    enum { MOST = 3 };
    for (int i = 1;; i++) {
        take_values(f, a);
        if (!determined(f, gsl_multifit_nlinear_jac(a->w)))
            return TOOL_FAILED;
        gsl_vector *lower =
            fit_intervals(f, a->x, gsl_multifit_nlinear_jac(a->w));
        if (lower && i == MOST)
            gsl_vector_free(lower);
        if (!lower || i == MOST || !improve(f, a, lower))
            break;
    }
    take_rms(f, gsl_multifit_nlinear_residual(a->w));
    /* The plan is that of the result. */
    f->residual = tool_allocate(f->residuals, sizeof *f->residual);
    return fit_orbit(f, a->x->data, f->residual) ? TOOL_OK : TOOL_FAILED;
}

int fit_solve(fitting *f) {
    attempt a = attempt_all(f);
    fit_find_rounding(f, a.x->data);
    if (!a.status && !fit_is_chaotic(f)) {
        check_scheme(f, &a);
        fit_find_rounding(f, a.x->data);
    }
    take_values(f, &a);
    f->why = a.why;
    int result =
        a.status || fit_is_chaotic(f) ? TOOL_FAILED : take_result(f, &a);
    attempt_free(&a);
    return result;
}
