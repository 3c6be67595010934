/* nevh: an orbit in quad precision whose series are pairs of doubles.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"

#ifdef NEVH_QUADMATH
#include <quadmath.h>

typedef nevh__wide real;
#define NAMED(name) name##_dd
#define FUNCTION(f) f##q
#define SHORTEST    1e-15
#define DOUBLE_DOUBLE
#include "taylor/orbit_text.h"
#endif
