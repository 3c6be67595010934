/* nevh: elementary functions of one number; those of near_sin(x) and so on, for loops
   that become vector code, take arguments of up to NEVH__NEAR.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ELEMENTARY_PRIVATE_H
#define NEVH_ELEMENTARY_PRIVATE_H

#include <nevh/simd.h>
#include <math.h>
#include <stdint.h>
#include "system/turn_far.h"

#define NEVH__NEAR       0x1p20
#define nevh__floor      floor
#define nevh__sqrt       nevh_simd_sqrt
#define nevh__near_sqrt  nevh_simd_sqrt
#define REAL             double
#define BITS             uint64_t
#define PICK(c, x, y)    ((c) ? (x) : (y))
#define EVERY(c)         (c)
#define BITS_OF(number)  (((union { double x; uint64_t bits; }){number}).bits)
#define REAL_OF(pattern) (((union { uint64_t bits; double x; }){pattern}).x)

#define ONE(f) nevh__##f
#define FAR(x, r, rest, turns)                                                 \
    do                                                                         \
        if (!((x) < NEVH__NEAR))                                               \
            *(turns) = nevh__turn_far(x, r, rest);                             \
    while (0)
#include "system/elementary.h"
#undef ONE
#undef FAR
#undef NEVH_ELEMENTARY_H
#define ONE(f)                 nevh__near_##f
#define FAR(x, r, rest, turns) (void)0
#include "system/elementary.h"

#undef ONE
#undef FAR
#undef REAL
#undef BITS
#undef PICK
#undef EVERY
#undef BITS_OF
#undef REAL_OF
#endif
