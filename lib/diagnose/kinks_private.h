/* nevh: kinks and jumps of H where an orbit goes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_KINKS_PRIVATE_H
#define NEVH_KINKS_PRIVATE_H

#include "gradient/field_private.h"

/* Searches the straight line between two states for a kink or a jump of H, or of
   its slope, with values of H alone.
   from, to  2n each, coordinates first
   largest   the sum of terms' |values| that the orbit met: places above it are not
             where the orbit goes
   slopes    jumps of H and of its slope alone count, not those of its curvature
   room      2n
   returns   whether there is one; not where H is not finite */
bool nevh__kink_between(nevh_field *, double t, const double from[],
                        const double to[], double largest, bool slopes,
                        double room[]);

/* True if a variable rests at a state and H has a kink in it there: more than one orbit
   may go on from there.
   room  4n */
bool nevh__kink_at_rest(nevh_field *, double t, const double z[],
                        double room[]);

#endif
