/* nevh: the motion about a fixed centre.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_KEPLER_FLOW_PRIVATE_H
#define NEVH_KEPLER_FLOW_PRIVATE_H

#include "system/parts_private.h"

/* The flow of v^2/2 - mu/|r| over a time t of any sign; mu < 0 repels.
   r, v     the state, which is moved; NAN where r is 0 or mu is 0, or a number is not
            finite.  Energy and angular momentum are off by at most two roundings of
            doubles, those of kinetic and potential energy and of |r| |v| at either
            end; in long double, as near collisions differences are small.
   cost     about 0.4 microseconds; no memory */
void nevh__kepler_flow(double mu, double t, long double r[NEVH__SPACE],
                       long double v[NEVH__SPACE]);

#endif
