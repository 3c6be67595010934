/* nevh: Hamilton's equations for GSL's solvers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <float.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <nevh/gsl.h>

static int right_hand_side(double t, const double y[], double dydt[],
                           void *params) {
    nevh_field *f = params;
    size_t n = f->n;
    if (nevh_field_gradient(f, 1, &t, y, y + n, dydt + n, dydt))
        return GSL_EBADFUNC;
    for (size_t i = n; i < 2 * n; i++)
        dydt[i] = -dydt[i];
    return GSL_SUCCESS;
}

static double gsl_system_step(double x, double scale) {
    return exp2(round(log2(cbrt(DBL_EPSILON) * fmax(fabs(x), scale))));
}

static int column(nevh_field *f, double t, double y[], size_t j, double *dfdy) {
    size_t m = 2 * f->n;
    double *plus = y + m, *minus = plus + m, x = y[j];
    double h = gsl_system_step(x, f->scale[j]), above = x + h, below = x - h;
    y[j] = above;
    int status = right_hand_side(t, y, plus, f);
    y[j] = below;
    if (!status)
        status = right_hand_side(t, y, minus, f);
    y[j] = x;
    for (size_t i = 0; !status && i < m; i++)
        dfdy[i * m + j] = (plus[i] - minus[i]) / (above - below);
    return status;
}

static int time_derivative(nevh_field *f, double t, const double y[],
                           double dfdt[]) {
    size_t m = 2 * f->n;
    double *minus = f->jacobian + m, h = gsl_system_step(t, 1);
    int status = right_hand_side(t + h, y, dfdt, f);
    if (!status)
        status = right_hand_side(t - h, y, minus, f);
    for (size_t i = 0; !status && i < m; i++)
        dfdt[i] = (dfdt[i] - minus[i]) / ((t + h) - (t - h));
    return status;
}

static int jacobian(double t, const double y[], double *dfdy, double dfdt[],
                    void *params) {
    nevh_field *f = params;
    size_t m = 2 * f->n;
    int status = GSL_SUCCESS;
    for (size_t i = 0; i < m; i++) {
        f->jacobian[i] = y[i];
        dfdt[i] = 0;
    }
    for (size_t j = 0; !status && j < m; j++)
        status = column(f, t, f->jacobian, j, dfdy);
    if (!status && !(nevh_system_traits(f->system) & NEVH_AUTONOMOUS))
        status = time_derivative(f, t, y, dfdt);
    return status;
}

gsl_odeiv2_system nevh_gsl_system(nevh_field *f) {
    if (!f->jacobian)
        f->jacobian = nevh__array(6 * f->n, sizeof *f->jacobian);
    return (gsl_odeiv2_system){.function = right_hand_side,
                               .jacobian = f->jacobian ? jacobian : NULL,
                               .dimension = 2 * f->n,
                               .params = f};
}
