/* nevh fit: errors, and intervals of 95 %.

   Where the sum of squares is no paraboloid as far as the ends of the intervals that
   the errors make, an end is where the least sum with that number held has risen by as
   much (profile likelihood). */
#include "fit_private.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    fitting *fit;
    const gsl_vector *best;
    const gsl_matrix *c; /* covariance, of residuals of variance 1 */
    double least, rise;  /* of the sum of squares; its rise to an end */
    double lowest;       /* that was found on the way, */
    gsl_vector *lower;   /* where; NULL: none is below the least */
} profile;

enum { FARTHEST = 30 };
static const double small_part = 0.01; /* of a rise */

static double length_of(const fitting *f) {
    return f->sigma_known || f->data->sigma
               ? gsl_cdf_ugaussian_Pinv(0.975)
               : gsl_cdf_tdist_Pinv(0.975, (double)(f->residuals - f->count));
}

/* From the best to the end that errors make, in number k. */
static double step_to_end(const profile *p, size_t k) {
    return sqrt(p->rise * gsl_matrix_get(p->c, k, k));
}

/* The number i where number k is `step` off, by the covariance. */
static double along(const profile *p, size_t i, size_t k, double step) {
    return gsl_vector_get(p->best, i) +
           step * gsl_matrix_get(p->c, i, k) / gsl_matrix_get(p->c, k, k);
}

/* Above the least, in parts of the rise. */
static double risen(const profile *p, double sum) {
    return (sum - p->least) / p->rise;
}

static double sum_at(fitting *f, const double x[], double residual[]) {
    double sum = 0;
    if (!fit_orbit(f, x, residual))
        return INFINITY;
    for (size_t i = 0; i < f->residuals; i++)
        sum += residual[i] * residual[i];
    return sum;
}

/* True if sums at the ends of the intervals by errors are those of a paraboloid. */
static bool is_quadratic(const profile *p) {
    static const double part = 0.1;
    fitting *f = p->fit;
    double *x = tool_allocate(f->count, sizeof *x), worst = 0;
    double *residual = tool_allocate(f->residuals, sizeof *residual);
    for (size_t end = 0; worst <= part && end < 2 * f->count; end++) {
        double step = step_to_end(p, end / 2) * (end % 2 ? 1 : -1);
        for (size_t i = 0; i < f->count; i++)
            x[i] = along(p, i, end / 2, step);
        worst = fmax(worst, fabs(risen(p, sum_at(f, x, residual)) - 1));
    }
    return worst <= part;
}

/* A trial of number k, held `step` from the best. */
typedef struct {
    double step, root; /* of the rise, which grows evenly with the step */
    gsl_vector *free;  /* the other numbers */
} trial;

/* All numbers, of which a lower minimum is near. */
static void keep_lower(profile *p, size_t k, const trial *t, double sum) {
    p->lowest = sum;
    if (!p->lower)
        p->lower = fit_vector(p->fit->count);
    for (size_t i = 0, at = 0; i < p->fit->count; i++)
        gsl_vector_set(p->lower, i,
                       i == k ? gsl_vector_get(p->best, k) + t->step
                              : gsl_vector_get(t->free, at++));
}

/* The least sum there, from `free` as it is. */
static void try_step(profile *p, size_t k, trial *t) {
    fitting *f = p->fit;
    double sum = INFINITY;
    f->held = k;
    f->held_at = gsl_vector_get(p->best, k) + t->step;
    if (f->count == 1) {
        double *residual = tool_allocate(f->residuals, sizeof *residual);
        sum = sum_at(f, &f->held_at, residual);
        tool_release(residual);
    } else {
        gsl_multifit_nlinear_workspace *w;
        fit_minimise(f, f->data->points, t->free, &sum, &w);
        gsl_multifit_nlinear_free(w);
    }
    f->held = f->count;
    double rise = risen(p, sum);
    t->root = rise > 0 ? sqrt(rise) : 0;
    if (rise < -small_part && sum < p->lowest)
        keep_lower(p, k, t, sum);
}

/* Others move in proportion to the step from the best on. */
static void move_to(const profile *p, size_t k, trial *t, double step) {
    for (size_t i = 0, at = 0; i < p->fit->count; i++) {
        double best = gsl_vector_get(p->best, i);
        if (i == k)
            continue;
        double *x = gsl_vector_ptr(t->free, at++);
        *x = isfinite(t->root) ? best + (*x - best) * step / t->step
                               : along(p, i, k, step);
    }
    t->step = step;
}

/* Between what is short of the end and what is beyond, or farther by what is left. */
static double next_step(const trial *inside, const trial *outside, double now) {
    static const double farther = 2, margin = 0.1;
    if (!outside->step)
        return now *
               fmin(farther, inside->root > 0 ? 1.05 / inside->root : farther);
    double gap = outside->step - inside->step;
    double part = isfinite(outside->root)
                      ? (1 - inside->root) / (outside->root - inside->root)
                      : 0.5;
    return inside->step + gap * fmin(fmax(part, margin), 1 - margin);
}

/* The end of number k on that side; INFINITY where there is none as far as
   FARTHEST of the steps that errors make. */
static double find_end(profile *p, size_t k, int side) {
    enum { MOST = 20 };
    static const double close = 0.01;
    double first = side * step_to_end(p, k);
    trial t = {.root = INFINITY, .free = fit_vector(p->fit->count)};
    trial inside = {0}, outside = {0};
    t.free->size = p->fit->count - 1;
    move_to(p, k, &t, first);
    for (int i = 0; i < MOST; i++) {
        try_step(p, k, &t);
        if (fabs(t.root - 1) < close)
            break;
        *(t.root < 1 ? &inside : &outside) = t;
        double next = next_step(&inside, &outside, t.step);
        if (fabs(next) > FARTHEST * fabs(first) ||
            fabs(next - t.step) < 1e-3 * fabs(t.step))
            break;
        move_to(p, k, &t, next);
    }
    gsl_vector_free(t.free);
    return t.root < 1 - close && !outside.step ? INFINITY : fabs(t.step);
}

static void take_profile(profile *p) {
    fitting *f = p->fit;
    double kept = f->tolerance;
    for (size_t k = 0; k < f->count; k++) /* so that sums are right to 1e-3 */
        f->tolerance =
            fmin(f->tolerance * 1e5,
                 fmax(f->tolerance, small_part * step_to_end(p, k) /
                                        fabs(gsl_vector_get(p->best, k))));
    for (size_t k = 0; k < f->count; k++) {
        varied *v = &f->item[k];
        v->low = v->value - find_end(p, k, -1) * v->scale;
        v->high = v->value + find_end(p, k, 1) * v->scale;
    }
    f->tolerance = kept;
}

static void take_linear(profile *p, double variance) {
    fitting *f = p->fit;
    size_t n = f->count;
    f->correlation = tool_allocate(n * n, sizeof *f->correlation);
    for (size_t k = 0; k < n; k++) {
        varied *v = &f->item[k];
        double square = gsl_matrix_get(p->c, k, k);
        v->error = sqrt(variance * square) * v->scale;
        v->low = v->value - step_to_end(p, k) * v->scale;
        v->high = v->value + step_to_end(p, k) * v->scale;
        for (size_t i = 0; i < n; i++)
            f->correlation[k * n + i] =
                gsl_matrix_get(p->c, k, i) /
                sqrt(square * gsl_matrix_get(p->c, i, i));
    }
}

double fit_variance(const fitting *f, double chi_square) {
    double least = FIT_ROUNDING * f->spread, rounding = fit_own_rounding(f);
    double degrees = (double)(f->residuals - f->count);
    double noise = f->sigma_known || f->data->sigma
                       ? 1
                       : fmax(chi_square, least * least) / degrees;
    return noise + rounding * rounding;
}

gsl_vector *fit_intervals(fitting *f, const gsl_vector *x,
                          const gsl_matrix *jacobian) {
    double variance = fit_variance(f, f->chi_square), wide = length_of(f);
    bool longer = f->evidence == FIT_WIDENED || f->evidence == FIT_EITHER;
    gsl_matrix *c = fit_matrix(f->count, f->count);
    profile p = {.fit = f,
                 .best = x,
                 .c = c,
                 .least = f->chi_square,
                 .lowest = f->chi_square,
                 .rise = wide * wide * variance};
    fit_covariance(jacobian, c);
    take_linear(&p, variance);
    f->profiled = !is_quadratic(&p);
    if (f->profiled)
        take_profile(&p);
    for (size_t k = 0; longer && k < f->count; k++) {
        f->item[k].low -= fabs(f->item[k].moved);
        f->item[k].high += fabs(f->item[k].moved);
    }
    gsl_matrix_free(c);
    return p.lower;
}

void fit_interval_words(const fitting *f, list *words) {
    list open = {0};
    for (size_t k = 0; k < f->count; k++)
        if (!(isfinite(f->item[k].low) && isfinite(f->item[k].high)))
            list_add(&open, f->item[k].name);
    if (f->profiled)
        list_add(words,
                 "Errors alone would make other intervals than the sum of "
                 "squares does, which is no paraboloid: ends are where it has "
                 "risen by as much, with the other numbers fitted again.");
    if (open.count) {
        char *names = list_joined(&open);
        list_print(words,
                   "The data set no end to the interval of %s: - where "
                   "there is none within %d errors.",
                   names, FARTHEST * 2);
    }
}
