/* nevh: motions in closed form, on by a time of any sign.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_MOTION_PRIVATE_H
#define NEVH_MOTION_PRIVATE_H

#include <gsl/gsl_roots.h>
#include <stddef.h>

/* All of them give NaN when t is so long that not one digit of the phase would
   be known. */

/* One normal mode, x'' = -w2 x with w2 of any sign. */
void nevh__normal_mode(long double w2, long double t, long double *x,
                       long double *v);

/* H = p^2/(2 inertia) - weight cos q; inertia and weight not 0. */
void nevh__swing(long double t, long double inertia, long double weight,
                 long double *q, long double *p);

/* r'' = -mu r/|r|^3 in `n` dimensions, on an ellipse: mu > 0, |v|^2/2 < mu/|r|
   and an angular momentum that is not 0.
   solver  one of bracketing type */
void nevh__ellipse(gsl_root_fsolver *solver, long double mu, long double t,
                   size_t n, long double r[], long double v[]);

#endif
