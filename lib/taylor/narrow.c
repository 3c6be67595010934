/* nevh: where the series of an orbit are shortest.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"
#include <math.h>

bool nevh__narrow_is(const nevh__narrow *x, double shorter) {
    return x->longest > shorter * x->shortest;
}

bool nevh__narrow_unlike(const nevh__narrow *x, const nevh__narrow *y) {
    static const double shorter = 8, grown = 8;
    static const double alike = 1.25; /* values at the ends of series */
    bool unlike = false;
    if (!x->over || !y->over)
        return false;
    for (size_t half = 0; half < 2; half++) {
        double a = x->most[half], b = y->most[half], before = x->before[half];
        unlike = unlike || (before > 0 && fmin(a, b) > grown * before &&
                            fmax(a, b) > alike * fmin(a, b));
    }
    return unlike && nevh__narrow_is(x, shorter) && nevh__narrow_is(y, shorter);
}
