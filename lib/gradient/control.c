/* nevh: control of the size of GSL's steps.

   By the rule of gsl_odeiv2_control_scaled_new with a_y of 0 or 1 and a_dydt of
   0, to the bit.  That function reads through NULL where memory is out (GSL
   2.7); this control takes none.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/control_private.h"
#include <float.h>
#include <gsl/gsl_errno.h>
#include <math.h>

static double allowed(const nevh__control *c, size_t i, double y) {
    return c->relative * (c->by_size ? fabs(y) : 0) + c->absolute * c->scale[i];
}

static int adjust(void *state, size_t dimension, unsigned order,
                  const double y[], const double error[], const double slope[],
                  double *h) {
    const nevh__control *c = state;
    double worst = DBL_MIN;
    (void)slope;
    for (size_t i = 0; i < dimension; i++) {
        double part = fabs(error[i]) / fabs(allowed(c, i, y[i]));
        worst = part > worst ? part : worst;
    }
    if (worst > 1.1) {
        double by = 0.9 / pow(worst, 1.0 / order);
        *h *= by < 0.2 ? 0.2 : by;
        return GSL_ODEIV_HADJ_DEC;
    }
    if (worst < 0.5) {
        double by = 0.9 / pow(worst, 1 / (order + 1.0));
        *h *= by > 4.9 ? 4.9 : by < 1 ? 1 : by;
        return GSL_ODEIV_HADJ_INC;
    }
    return GSL_ODEIV_HADJ_NIL;
}

static int level(void *state, double y, double slope, double h, size_t i,
                 double *error) {
    (void)slope, (void)h;
    *error = allowed(state, i, y);
    return *error > 0 ? GSL_SUCCESS : GSL_ESANITY;
}

static int mind_no_driver(void *state, const gsl_odeiv2_driver *driver) {
    (void)state, (void)driver;
    return GSL_SUCCESS;
}

static const gsl_odeiv2_control_type type = {
    .name = "nevh",
    .hadjust = adjust,
    .errlevel = level,
    .set_driver = mind_no_driver,
};

void nevh__control_init(nevh__control *c) {
    c->gsl = (gsl_odeiv2_control){&type, c};
}
