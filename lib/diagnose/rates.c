/* nevh: how fast small displacements from an orbit turn round and grow.

   z' = J H''(z) dz: the eigenvalues of J H'', H'' by sixth-order differences of
   the gradient.  Of large systems the largest one alone, by the power method.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <fenv.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <nevh/diagnose.h>
#include <nevh/probe.h>
#include <stdlib.h>
#include <string.h>

static const double weights[3] = {1.5, -0.6, 0.1};
static const double spread = 0x1p-8;               /* of the lengths */
enum { MOST_DENSE = 96, POWERS = 60, SHRINK = 8 }; /* variables; products */

struct nevh_rates {
    nevh_field *field;
    nevh__report report;
    size_t n;
    bool planned, dense;
    double *length;                     /* 2n, and of all that follows */
    double *state, *slope;              /* 2n each */
    double *direction, *column, *trial; /* 2n each */
    gsl_matrix *matrix;
    gsl_vector *balance;
    gsl_vector_complex *values;
    gsl_eigen_nonsymm_workspace *work;
};

static int plan_lengths(nevh_rates *r, const nevh_system *s,
                        const nevh_options *o) {
    nevh_probe *probe = o->scale ? NULL : nevh_probe_new(s, o);
    int status = o->scale ? NEVH_OK : nevh_probe_status(probe);
    if (status)
        nevh__fail(&r->report, status, "%s", nevh_probe_message(probe));
    else
        memcpy(r->length, o->scale ? o->scale : nevh_probe_lengths(probe),
               2 * r->n * sizeof *r->length);
    nevh_probe_free(probe);
    return status;
}

/* Exact derivatives where all terms bring them. */
static int rates_plan_field(nevh_rates *r, const nevh_system *s,
                            const nevh_options *given) {
    nevh_options o = *given;
    o.width = 1;
    o.scale = r->length;
    if (!given->gradient) {
        o.gradient = nevh_exact;
        r->field = nevh_field_new(s, &o);
        if (nevh_field_status(r->field) != NEVH_ENOGRAD)
            return nevh_field_status(r->field);
        nevh_field_free(r->field);
        o.gradient = nevh_central6;
    }
    r->field = nevh_field_new(s, &o);
    return nevh_field_status(r->field);
}

/* GSL would abort where its memory is out: nevh asks first. */
static bool plan_dense(nevh_rates *r) {
    size_t m = 2 * r->n;
    void *ask = nevh__array(2 * m * m + 16 * m, sizeof(double));
    free(ask);
    if (!ask)
        return false;
    r->matrix = gsl_matrix_alloc(m, m);
    r->balance = gsl_vector_alloc(m);
    r->values = gsl_vector_complex_alloc(m);
    r->work = gsl_eigen_nonsymm_alloc(m);
    if (!r->matrix || !r->balance || !r->values || !r->work)
        return false;
    gsl_eigen_nonsymm_params(0, 0, r->work);
    return true;
}

static bool plan_buffers(nevh_rates *r) {
    size_t m = 2 * r->n;
    r->length = nevh__array(6 * m, sizeof(double));
    if (!r->length)
        return false;
    r->state = r->length + m;
    r->slope = r->state + m;
    r->direction = r->slope + m;
    r->column = r->direction + m;
    r->trial = r->column + m;
    r->dense = m <= MOST_DENSE;
    return !r->dense || plan_dense(r);
}

nevh_rates *nevh_rates_new(const nevh_system *s, const nevh_options *options) {
    static const nevh_options defaults;
    const nevh_options *o = options ? options : &defaults;
    nevh_rates *r = nevh__array(1, sizeof *r);
    if (!r)
        return NULL;
    int status = nevh_system_status(s);
    if (status) {
        nevh__fail(&r->report, status, "%s", nevh_system_message(s));
        return r;
    }
    r->n = nevh_system_dof(s);
    if (!plan_buffers(r))
        nevh__no_memory(&r->report);
    else if (!plan_lengths(r, s, o) && !rates_plan_field(r, s, o))
        r->planned = true;
    if (r->field && nevh_field_status(r->field))
        nevh__fail(&r->report, nevh_field_status(r->field), "%s",
                   nevh_field_message(r->field));
    return r;
}

void nevh_rates_free(nevh_rates *r) {
    if (!r)
        return;
    nevh_field_free(r->field);
    gsl_matrix_free(r->matrix);
    gsl_vector_free(r->balance);
    gsl_vector_complex_free(r->values);
    if (r->work)
        gsl_eigen_nonsymm_free(r->work);
    free(r->length);
    free(r);
}

NEVH__REPORTS(rates)

static int slope_at(nevh_rates *r, double t, const double z[]) {
    return nevh_field_gradient(r->field, 1, &t, z, z + r->n, r->slope,
                               r->slope + r->n);
}

/* column = J H'' d, all in units of the lengths, for a displacement of part
   `by` of d. */
static int rates_differentiate(nevh_rates *r, double t, const double d[],
                               double by) {
    size_t n = r->n, m = 2 * n;
    int status = NEVH_OK;
    memset(r->column, 0, m * sizeof *r->column);
    for (int c = 0; !status && c < 6; c++) {
        double move = (c / 2 + 1) * (c % 2 ? -by : by);
        for (size_t i = 0; i < m; i++)
            r->trial[i] = r->state[i] + move * d[i] * r->length[i];
        status = slope_at(r, t, r->trial);
        for (size_t i = 0; !status && i < m; i++)
            r->column[i] += weights[c / 2] / (2 * move) *
                            (i < n ? r->slope[i + n] : -r->slope[i - n]) /
                            r->length[i];
    }
    return status;
}

/* Nearer to an edge of H's domain with smaller displacements. */
static int rates_derivative(nevh_rates *r, double t, const double d[]) {
    int status = rates_differentiate(r, t, d, spread);
    for (int i = 1; status == NEVH_EDOM && i < SHRINK; i++)
        status = rates_differentiate(r, t, d, ldexp(spread, -4 * i));
    for (size_t i = 0; !status && i < 2 * r->n; i++)
        if (!isfinite(r->column[i]))
            status = NEVH_EDOM;
    return status;
}

/* GSL's QR algorithm multiplies elements with each other, and does not converge
   where the products underflow or overflow.  So the matrix is balanced, divided
   by its largest element, and cleared of elements that are far below the
   rounding of that one.
   returns  what eigenvalues are to be multiplied with; 0: all are 0 */
static double tame(gsl_matrix *a, gsl_vector *balance) {
    static const double negligible = 0x1p-200;
    gsl_linalg_balance_matrix(a, balance);
    double largest = fmax(gsl_matrix_max(a), -gsl_matrix_min(a));
    for (size_t i = 0; largest > 0 && i < a->size1; i++)
        for (size_t j = 0; j < a->size2; j++) {
            double part = gsl_matrix_get(a, i, j) / largest;
            gsl_matrix_set(a, i, j, fabs(part) < negligible ? 0 : part);
        }
    return largest;
}

/* Double eigenvalues of 0, as of free motion, are moved by the root of what rounding
   and differences do to the matrix, whose largest element is 1. */
static const double rounding = 1e-6;

static int by_eigenvalues(nevh_rates *r, double t, double *frequency,
                          double *growth) {
    size_t m = 2 * r->n;
    double *d = r->direction;
    for (size_t j = 0; j < m; j++) {
        memset(d, 0, m * sizeof *d);
        d[j] = 1;
        int status = rates_derivative(r, t, d);
        if (status)
            return status;
        for (size_t i = 0; i < m; i++)
            gsl_matrix_set(r->matrix, i, j, r->column[i]);
    }
    double scale = tame(r->matrix, r->balance);
    if (!isfinite(scale))
        return NEVH_EDOM;
    if (scale > 0 && gsl_eigen_nonsymm(r->matrix, r->values, r->work))
        return NEVH_EFAILED;
    for (size_t i = 0; scale > 0 && i < m; i++) {
        gsl_complex value = gsl_vector_complex_get(r->values, i);
        *frequency = fmax(*frequency, fabs(GSL_IMAG(value)));
        *growth = fmax(*growth, GSL_REAL(value));
    }
    *frequency = *frequency > rounding ? scale * *frequency : 0;
    *growth = *growth > rounding ? scale * *growth : 0;
    return NEVH_OK;
}

/* Two products a turn, since a pair of imaginary eigenvalues turns d round. */
static int by_powers(nevh_rates *r, double t, double *frequency,
                     double *growth) {
    size_t m = 2 * r->n;
    double *d = r->direction;
    uint64_t random = 1;
    for (size_t i = 0; i < m; i++)
        d[i] = nevh__random(&random);
    double turn = 1;
    for (int k = 0; k < POWERS; k++) {
        int status = rates_derivative(r, t, d);
        if (status)
            return status;
        double size = 0;
        for (size_t i = 0; i < m; i++)
            size += r->column[i] * r->column[i];
        size = sqrt(size);
        if (!(size > 0))
            return NEVH_OK;
        for (size_t i = 0; i < m; i++)
            d[i] = r->column[i] / size;
        if (k > 0)
            *frequency = sqrt(turn * size);
        turn = size;
    }
    *growth = NAN;
    return NEVH_OK;
}

int nevh_rates_at(nevh_rates *r, double t, const double q[], const double p[],
                  double *frequency, double *growth) {
    if (!r || !r->planned)
        return nevh_rates_status(r);
    memcpy(r->state, q, r->n * sizeof *q);
    memcpy(r->state + r->n, p, r->n * sizeof *p);
    *frequency = *growth = 0;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status =
        (r->dense ? by_eigenvalues : by_powers)(r, t, frequency, growth);
    fesetenv(&own);
    return status;
}
