/* nevh: the motion of a normal mode.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/motion_private.h"
#include <float.h>
#include <math.h>

void nevh__normal_mode(long double w2, long double t, long double *x,
                       long double *v) {
    long double w = sqrtl(fabsl(w2)), wt = w * t, x0 = *x, v0 = *v;
    long double c = 1, s = t; /* s = sin(wt)/w */
    if (!(fabsl(wt) < 1 / LDBL_EPSILON)) {
        c = s = NAN;
    } else if (w2 > 0) {
        c = cosl(wt);
        s = sinl(wt) / w;
    } else if (w2 < 0) {
        c = coshl(wt);
        s = sinhl(wt) / w;
    }
    *x = x0 * c + v0 * s;
    *v = v0 * c - w2 * x0 * s;
}
