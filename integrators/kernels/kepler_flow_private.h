/* nevh: the motion about a fixed centre.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_KEPLER_FLOW_PRIVATE_H
#define NEVH_KEPLER_FLOW_PRIVATE_H

#include "system/parts_private.h"

/* Near collisions differences are small.  WebAssembly has long double as software alone,
   25 kB of it. */
#ifdef __wasm__
typedef double nevh__extended;
#else
typedef long double nevh__extended;
#endif

/* The flow of v^2/2 - mu/|r| over a time t of any sign; mu < 0 repels.
   r, v     the state, which is moved; NAN where r is 0 or mu is 0, or a number is not
            finite.  Energy and angular momentum are off by at most two roundings of
            doubles, those of kinetic and potential energy and of |r| |v| at either
            end.
   cost     about 0.4 microseconds; no memory */
void nevh__kepler_flow(double mu, double t, nevh__extended r[NEVH__SPACE],
                       nevh__extended v[NEVH__SPACE]);

/* The changes of eight such states over the same time, in rows of eight numbers.
   good     out: 1, or 0 where the time is too long for this way, or differences of the
            result are small, so that nevh__kepler_flow is to be called
   cost     about 0.15 microseconds; no memory */
void nevh__kepler_changes(const double mu[], double t, const double r[],
                          const double v[], double dr[], double dv[],
                          double good[]);

#endif
