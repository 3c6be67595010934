/* nevh: an orbit in long doubles, where there is no quad precision.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"

#ifndef NEVH_QUADMATH
typedef long double real;
#define NAMED(name) name##_long
#define FUNCTION(f) f##l
#define SHORTEST    1e-15
#include "taylor/orbit_text.h"
#endif
