/* nevh: an orbit in quad precision.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"

#ifdef NEVH_QUADMATH
#include <quadmath.h>

typedef nevh__wide real;
#define NAMED(name) name##_quad
#define FUNCTION(f) f##q
#define SHORTEST    1e-25
#include "taylor/orbit_text.h"
#endif
