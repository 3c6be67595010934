/* nevh: the live page's module has Fehlberg's pair of orders 4 and 5 in place
   of GSL's, under the names that the library calls.

   A short orbit by that pair shows a field where to try its difference steps.
   These are powers of two, which the last digits of that orbit do not change.
   [E. Fehlberg, Low-order classical Runge-Kutta formulas with stepsize control,
   NASA TR R-315 (1969), table III.]
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "page.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <stdlib.h>
#include <string.h>

enum { STAGES = 6, MOST_TRIALS = 100 };
static const double c[STAGES] = {0, 1. / 4, 3. / 8, 12. / 13, 1, 1. / 2};
static const double a[STAGES][STAGES] = {
    {0},
    {1. / 4},
    {3. / 32, 9. / 32},
    {1932. / 2197, -7200. / 2197, 7296. / 2197},
    {439. / 216, -8, 3680. / 513, -845. / 4104},
    {-8. / 27, 2, -3544. / 2565, 1859. / 4104, -11. / 40},
};
static const double b[STAGES] = {16. / 135,      0,        6656. / 12825,
                                 28561. / 56430, -9. / 50, 2. / 55};
/* b less the weights of order 4. */
static const double d[STAGES] = {1. / 360,       0,       -128. / 4275,
                                 -2197. / 75240, 1. / 50, 2. / 55};

static const gsl_odeiv2_step_type fehlberg = {.name = "rkf45"};
const gsl_odeiv2_step_type *gsl_odeiv2_step_rkf45 = &fehlberg;
const gsl_odeiv2_step_type *gsl_odeiv2_step_rk8pd, *gsl_odeiv2_step_msadams;

gsl_odeiv2_step *gsl_odeiv2_step_alloc(const gsl_odeiv2_step_type *type,
                                       size_t n) {
    gsl_odeiv2_step *s = type ? calloc(1, sizeof *s) : NULL;
    if (!s)
        return NULL;
    *s = (gsl_odeiv2_step){.type = type, .dimension = n};
    s->state = calloc((STAGES + 3) * n, sizeof(double));
    if (s->state)
        return s;
    free(s);
    return NULL;
}

void gsl_odeiv2_step_free(gsl_odeiv2_step *s) {
    if (s)
        free(s->state);
    free(s);
}

gsl_odeiv2_evolve *gsl_odeiv2_evolve_alloc(size_t n) {
    gsl_odeiv2_evolve *e = calloc(1, sizeof *e);
    if (e)
        e->dimension = n;
    return e;
}

int gsl_odeiv2_evolve_reset(gsl_odeiv2_evolve *e) {
    (void)e;
    return GSL_SUCCESS;
}

void gsl_odeiv2_evolve_free(gsl_odeiv2_evolve *e) {
    free(e);
}

/* to = y + h times the sum of weighted slopes; y may be NULL: zeros. */
static void combine(size_t n, const double y[], double h, const double weight[],
                    const double *slope, double to[]) {
    for (size_t i = 0; i < n; i++) {
        double sum = 0;
        for (size_t j = 0; j < STAGES; j++)
            sum += weight[j] * slope[j * n + i];
        to[i] = (y ? y[i] : 0) + h * sum;
    }
}

static int try_step(const gsl_odeiv2_system *system, size_t n, double t,
                    double h, const double y[], double *slope, double *next,
                    double *error) {
    int status = GSL_SUCCESS;
    memset(slope, 0, STAGES * n * sizeof *slope);
    for (size_t j = 0; !status && j < STAGES; j++) {
        combine(n, y, h, a[j], slope, next);
        status =
            system->function(t + c[j] * h, next, slope + j * n, system->params);
    }
    combine(n, y, h, b, slope, next);
    combine(n, NULL, h, d, slope, error);
    return status;
}

/* One step of h, without slopes at its ends. */
int gsl_odeiv2_step_apply(gsl_odeiv2_step *step, double t, double h, double y[],
                          double yerr[], const double dydt_in[],
                          double dydt_out[], const gsl_odeiv2_system *system) {
    size_t n = step->dimension;
    double *slope = step->state, *next = slope + STAGES * n;
    (void)dydt_in, (void)dydt_out;
    int status = try_step(system, n, t, h, y, slope, next, yerr);
    if (!status)
        memcpy(y, next, n * sizeof *y);
    return status;
}

/* One step, as long as the control allows; *h is that of the next. */
int gsl_odeiv2_evolve_apply(gsl_odeiv2_evolve *e, gsl_odeiv2_control *control,
                            gsl_odeiv2_step *step,
                            const gsl_odeiv2_system *system, double *t,
                            double t1, double *h, double y[]) {
    size_t n = e->dimension;
    double *slope = step->state, *next = slope + STAGES * n, *error = next + n;
    (void)t1;
    for (int i = 0; i < MOST_TRIALS && *t + *h != *t; i++) {
        double taken = *h;
        int status = try_step(system, n, *t, taken, y, slope, next, error);
        if (status == GSL_EBADFUNC)
            return status;
        if (status) {
            *h /= 2;
            continue;
        }
        if (control->type->hadjust(control->state, n, 5, next, error, slope,
                                   h) == GSL_ODEIV_HADJ_DEC)
            continue;
        memcpy(y, next, n * sizeof *y);
        *t += taken;
        return GSL_SUCCESS;
    }
    return GSL_FAILURE;
}
