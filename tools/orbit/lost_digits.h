/* nevh: orbits that outgrow their difference steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LOST_DIGITS_H
#define LOST_DIGITS_H

#include "experiment/plan.h"

/* Begins as 0: the largest |dH/dq| and |dH/dp| so far. */
typedef struct {
    double slope[2];
    bool begun;
} lost_digits;

/* True where the state of an orbit has outgrown its start, and rounding of values of
   H is more than 1e-6 of the gradient.  Steps that the user gives are not judged,
   nor orbits that have lost their energy. */
bool digits_are_lost(lost_digits *, const plan *, nevh_field *, double t,
                     const double q[], const double p[]);

extern const char digits_lost_why[];

#endif
