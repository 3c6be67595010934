/* nevh: special functions from GSL, and their derivatives.

   With D = (K - E)/k^2 the derivatives of the complete elliptic integrals,
   K' = k (K - D)/(1 - k^2) and E' = -k D, do not cancel at small k.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_operations_private.h"
#include <gsl/gsl_sf_bessel.h>
#include <gsl/gsl_sf_ellint.h>

/* Beyond it the phase of a Bessel function is noise. */
static const double farthest = 1 / DBL_EPSILON;

double nevh__bessel_j0(double x) {
    gsl_sf_result j;
    if (!(fabs(x) < farthest) || gsl_sf_bessel_J0_e(x, &j))
        return NAN;
    return j.val;
}

double nevh__bessel_j1(double x) {
    gsl_sf_result j;
    if (fabs(x) < DBL_EPSILON) /* where GSL reports underflow */
        return x / 2;
    if (!(fabs(x) < farthest) || gsl_sf_bessel_J1_e(x, &j))
        return NAN;
    return j.val;
}

double nevh__bessel_j1_slope(double x) {
    if (fabs(x) < DBL_EPSILON)
        return 0.5;
    return nevh__bessel_j0(x) - nevh__bessel_j1(x) / x;
}

/* The square may round to 1, which GSL refuses. */
static bool inside(double k) {
    return fabs(k) < 1 && k * k < 1;
}

double nevh__elliptic_k(double k) {
    gsl_sf_result integral;
    if (!inside(k) || gsl_sf_ellint_Kcomp_e(k, GSL_PREC_DOUBLE, &integral))
        return NAN;
    return integral.val;
}

double nevh__elliptic_e(double k) {
    gsl_sf_result integral;
    if (fabs(k) == 1)
        return 1;
    if (!inside(k) || gsl_sf_ellint_Ecomp_e(k, GSL_PREC_DOUBLE, &integral))
        return NAN;
    return integral.val;
}

/* D = (K - E)/k^2 */
static double elliptic_d(double k) {
    gsl_sf_result integral;
    if (!inside(k) || gsl_sf_ellint_Dcomp_e(k, GSL_PREC_DOUBLE, &integral))
        return NAN;
    return integral.val;
}

double nevh__elliptic_k_slope(double k) {
    return k * (nevh__elliptic_k(k) - elliptic_d(k)) / ((1 - k) * (1 + k));
}

double nevh__elliptic_e_slope(double k) {
    return -k * elliptic_d(k);
}
