/* nevh: an orbit in long doubles.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/orbit_private.h"

typedef long double real;
#define NAMED(name) name##_long
#define FUNCTION(f) f##l
#define SHORTEST    1e-15
#include "taylor/orbit_text.h"
