/* nevh: where orbits with certain digits start.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CERTAIN_PRIVATE_H
#define NEVH_CERTAIN_PRIVATE_H

#include "taylor/orbit_private.h"
#include <nevh/certain.h>

typedef struct {
    const nevh_system *system;
    nevh__wide t;
    const nevh__wide *q, *p; /* n each */
    const nevh__wide *rates; /* n, of friction; NULL: there is none */
} nevh__certain_start;

/* As nevh_certain_new, of numbers with more digits, which are copied.
   other  the same, as far away as rounding may have moved what was computed; the
          system as long as the first */
nevh_certain *nevh__certain_from(const nevh__certain_start *,
                                 const nevh__certain_start *other, int digits);

#endif
