/* nevh: the motion about a centre of attraction, on an ellipse.
   SPDX-License-Identifier: GPL-3.0-or-later

   Kepler's equation for the difference E of eccentric anomalies from the start,
   and the state by Lagrange's coefficients f and g [R. H. Battin, An
   Introduction to the Mathematics and Methods of Astrodynamics, AIAA (1999),
   sections 3.3 and 4.3]; no elements of the orbit are needed, which would be
   undefined for circles. */
#include "system/motion_private.h"
#include <float.h>
#include <math.h>

#define PI 3.141592653589793238462643383279502884L

enum { MOST_TRIALS = 100 };

/* E - ec sin E + es (1 - cos E) = M, where ec = e cos E0, es = e sin E0. */
typedef struct {
    long double ec, es, M;
} equation;

static long double ellipse_excess(const equation *k, long double E) {
    long double half = sinl(E / 2);
    return E - k->ec * sinl(E) + 2 * k->es * half * half - k->M;
}

static double ellipse_miss(double E, void *data) {
    return (double)ellipse_excess(data, E);
}

static double ellipse_solve(gsl_root_fsolver *solver, equation *k) {
    gsl_function f = {ellipse_miss, k};
    double M = (double)k->M, wide = (double)(2 * hypotl(k->ec, k->es)) + 1e-9;
    double root = M;
    int status = gsl_root_fsolver_set(solver, &f, M - wide, M + wide);
    for (int i = 0; !status && i < MOST_TRIALS; i++) {
        status = gsl_root_fsolver_iterate(solver);
        root = gsl_root_fsolver_root(solver);
        if (gsl_root_fsolver_x_upper(solver) -
                gsl_root_fsolver_x_lower(solver) <=
            4 * DBL_EPSILON * fabs(root))
            break;
    }
    return root;
}

static long double ellipse_dot(size_t n, const long double a[],
                               const long double b[]) {
    long double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

void nevh__ellipse(gsl_root_fsolver *solver, long double mu, long double t,
                   size_t n, long double r[], long double v[]) {
    long double r0 = sqrtl(ellipse_dot(n, r, r));
    long double a = 1 / (2 / r0 - ellipse_dot(n, v, v) / mu);
    long double rate = sqrtl(mu / a) / a, M = rate * t;
    long double f = NAN, g = NAN, df = NAN, dg = NAN;
    if (fabsl(M) < 1 / LDBL_EPSILON) {
        equation k = {.ec = 1 - r0 / a,
                      .es = ellipse_dot(n, r, v) / sqrtl(mu * a)};
        k.M = M - 2 * PI * rintl(M / (2 * PI));
        long double E = ellipse_solve(solver, &k), sine = sinl(E);
        long double half = sinl(E / 2), versine = 2 * half * half;
        long double r1 = a * (1 - k.ec * cosl(E) + k.es * sine);
        f = 1 - a / r0 * versine;
        g = (r0 / a * sine + k.es * versine) / rate;
        df = -rate * a * a / (r1 * r0) * sine;
        dg = 1 - a / r1 * versine;
    }
    for (size_t i = 0; i < n; i++) {
        long double ri = r[i], vi = v[i];
        r[i] = f * ri + g * vi;
        v[i] = df * ri + dg * vi;
    }
}
