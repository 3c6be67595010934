/* nevh: control of the size of GSL's steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CONTROL_PRIVATE_H
#define NEVH_CONTROL_PRIVATE_H

#include <gsl/gsl_odeiv2.h>
#include <stdbool.h>

/* An error of y[i] is allowed to be absolute * scale[i] and, by_size,
   relative * |y[i]| in addition.  Filled in by its owner, who then calls
   nevh__control_init and passes &gsl on; it must stay where it is. */
typedef struct {
    double absolute, relative;
    bool by_size;
    const double *scale; /* borrowed */
    gsl_odeiv2_control gsl;
} nevh__control;
void nevh__control_init(nevh__control *);

#endif
