/* nevh: the part of a step that ends at a given time.
   SPDX-License-Identifier: GPL-3.0-or-later

   The text needs fabs and a function of the includer; branch.c compiles it,
   lib/native writes it into programs. */
#ifndef NEVH_FRACTION_PRIVATE_H
#define NEVH_FRACTION_PRIVATE_H

#include "system/vector_private.h"
#include <math.h>

/* The includer's: the time that a fraction of the step takes, less the time that
   is due, both in units of the time of the whole step; NAN: it cannot be taken. */
struct nevh__fraction_owner;
NEVH__INLINE double nevh__fraction_miss(struct nevh__fraction_owner *o,
                                        double fraction);

/* The fraction after which the time is due, 0 < due < 1: false position, where an
   end of the bracket that remains counts half [M. Dowell, P. Jarratt, A modified
   regula falsi method, BIT 11 (1971) 168-174].  NAN: a fraction cannot be
   taken. */
NEVH__INLINE double nevh__fraction_find(struct nevh__fraction_owner *o,
                                        double due) {
    double low = 0, high = 1, at_low = -due, at_high = 1 - due;
    double best = due, least = 1;
    int side = 0, trials = 100;
    while (trials-- > 0 && least > 0 && high - low > 0x1p-50 * high) {
        double x = low + (high - low) * (at_low / (at_low - at_high));
        if (!(x > low && x < high))
            x = low + (high - low) / 2;
        double miss = nevh__fraction_miss(o, x);
        if (!(fabs(miss) < INFINITY))
            return NAN;
        if (fabs(miss) < least) {
            least = fabs(miss);
            best = x;
        }
        if (miss < 0) {
            low = x;
            at_low = miss;
            at_high /= side < 0 ? 2 : 1;
            side = -1;
        } else {
            high = x;
            at_high = miss;
            at_low /= side > 0 ? 2 : 1;
            side = 1;
        }
    }
    return best;
}

#endif
