/* nevh fit: the error of the scheme beside that of the data.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit_private.h"
#include <math.h>
#include <string.h>

static bool is_dop853(const char *integrator) {
    return strcmp(integrator, "dop853") == 0;
}

/* The scheme that nevh_finer finds for the orbit as it is planned now. */
static bool ask_finer(const fitting *f, nevh_finer_kind kind,
                      fit_scheme *finer) {
    const char *name = f->now.integrator;
    nevh_finer *found = plan_finer(f->plan, name, kind);
    bool good = !nevh_finer_status(found);
    if (good && kind != NEVH_FINER_STEPS)
        name = nevh_integrator_name(nevh_finer_integrator(found));
    if (good)
        *finer = (fit_scheme){name, nevh_finer_dt(found),
                              nevh_finer_options(found)->tolerance};
    nevh_finer_free(found);
    return good;
}

bool fit_scheme_finer(const fitting *f, size_t level, bool stepwise,
                      fit_scheme *finer) {
    enum { LEVELS = 2, HALVES = 6 };
    bool by_steps = stepwise || level || is_dop853(f->now.integrator);
    return level < (stepwise ? HALVES : LEVELS) &&
           ask_finer(f, by_steps ? NEVH_FINER_STEPS : NEVH_FINER_ADAPTIVE,
                     finer);
}

bool fit_is_given(const fitting *f) {
    return strcmp(f->now.integrator, f->given.integrator) == 0 &&
           f->now.dt == f->given.dt && f->now.tolerance == f->given.tolerance;
}

double fit_own_rounding(const fitting *f) {
    static const double safety = 3; /* it is another one in each orbit */
    return safety * f->rounding;
}

double fit_rounding(const fitting *f) {
    return fmax(FIT_ROUNDING * f->spread, fit_own_rounding(f));
}

bool fit_is_rounding(const fitting *f, double chi_square) {
    return sqrt(chi_square) <= fit_rounding(f);
}

/* Exchanges the gradients of orbits and those that were asked for, if others. */
static void exchange_gradients(fitting *f) {
    list own = f->plan->gradients;
    if (f->asked.count) {
        f->plan->gradients = f->asked;
        f->asked = own;
    }
}

bool fit_leaves(const fitting *f, double part, double chi_square) {
    return f->spread > 0 && sqrt(chi_square) > part * f->spread;
}

static double length_between(const double a[], const double b[], size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(sum);
}

void fit_find_rounding(fitting *f, const double x[]) {
    enum { DIGITS = 2, TRIALS = 2 * DIGITS + 1 };
    static const double last_digit = 4e-16;
    size_t n = f->residuals;
    double *r = tool_allocate(2 * n + f->count, sizeof *r), *other = r + n;
    double *at = other + n;
    bool good = fit_orbit(f, x, r);
    f->rounding = 0;
    for (int i = 0; good && i < TRIALS; i++) {
        double by = (i - DIGITS) * last_digit; /* 0: the gradients alone */
        for (size_t k = 0; k < f->count; k++)
            at[k] = x[k] != 0 ? x[k] * (1 + by) : by;
        if (by == 0)
            exchange_gradients(f);
        if (fit_orbit(f, at, other))
            f->rounding = fmax(f->rounding, length_between(r, other, n));
        if (by == 0)
            exchange_gradients(f);
    }
}

bool fit_is_chaotic(const fitting *f) {
    static const double most = 0.1;
    return f->spread > 0 && f->rounding > most * f->spread;
}

void fit_scheme_words(const fitting *f, list *words) {
    const char *scheme = f->given.integrator, *worst = f->item[f->worst].name;
    char *tolerance = is_dop853(f->now.integrator)
                          ? text_print(", tolerance %.2g", f->now.tolerance)
                          : text_print("%s", "");
    if (f->evidence == FIT_UNCHECKED)
        list_print(words,
                   "The error of %s with dt = %.4g could not be checked: %s.  "
                   "The intervals do not count it.",
                   scheme, f->given.dt,
                   f->unchecked ? f->unchecked : "there is no finer scheme");
    else if (f->evidence == FIT_GIVEN)
        list_print(
            words,
            "The residuals are rounding, as those of a more exact orbit "
            "are not: %s with dt = %.4g made the data, and the intervals "
            "do not count its error, which is %.2g of %s.",
            scheme, f->given.dt, fabs(f->item[f->worst].moved), worst);
    else if (fit_is_given(f))
        list_print(words,
                   "The error of %s with dt = %.4g changes %s by %.2g of its "
                   "error, other numbers by less.",
                   scheme, f->given.dt, worst, f->worst_part);
    else
        list_print(words,
                   "The error of %s with dt = %.4g would change %s by %.2g of "
                   "its errors: fitted with %s, dt = %.4g%s.",
                   scheme, f->given.dt, worst, f->worst_part, f->now.integrator,
                   f->now.dt, tolerance);
    if (f->evidence == FIT_WIDENED)
        list_print(words,
                   "Its own error is not small beside the noise: the intervals "
                   "are longer by what the last refinement changed.");
    if (f->evidence == FIT_EITHER)
        list_print(
            words,
            "The residuals of either are rounding: these data do not tell "
            "their orbits apart, and the intervals hold the numbers of "
            "both.");
}

/* Sums of squares, and of products of neighbours. */
static double neighbours(const fitting *f, const double residual[], size_t k) {
    size_t columns = f->data->columns;
    double squares = 0, products = 0;
    for (size_t i = 0; i < f->data->points; i++) {
        double r = residual[i * columns + k];
        squares += r * r;
        products += i ? r * residual[(i - 1) * columns + k] : 0;
    }
    return squares > 0 ? products / squares : 0;
}

bool fit_residual_words(const fitting *f, const double residual[],
                        list *words) {
    enum { FEWEST = 20 };
    static const double chance = 4; /* deviations */
    size_t before = words->count;
    for (size_t k = 0; k < f->data->columns; k++) {
        double alike = neighbours(f, residual, k);
        if (f->data->points >= FEWEST && !fit_is_rounding(f, f->chi_square) &&
            alike > chance / sqrt((double)f->data->points))
            list_print(words,
                       "Neighbouring residuals of %s are alike (correlation "
                       "%.2f), as noise is not: the scene lacks an effect, the "
                       "fit is in another minimum, or points share their "
                       "errors.  The intervals are too short then.",
                       f->data->names.item[k], alike);
    }
    return words->count > before;
}
