/* nevh: numbers side by side, for code in which they must not go through
   memory.
   SPDX-License-Identifier: GPL-3.0-or-later

   In sums of several terms GCC keeps an array of lanes in memory, and one
   operation waits for the other to be stored; a vector it keeps in a register.
   Arithmetic is that of its lanes, on any processor. */
#ifndef NEVH_VECTOR_PRIVATE_H
#define NEVH_VECTOR_PRIVATE_H

#include "system/system_private.h"
#include <nevh/simd.h>

#ifdef __GNUC__
#define NEVH__HAS_VECTOR 1
typedef double nevh__vector
    __attribute__((vector_size(NEVH__LANES * sizeof(double)),
                   aligned(sizeof(double)), may_alias));
#else
typedef double nevh__vector;
#endif
/* Numbers that go through memory to functions and back had better not be stored
   one by one and loaded in pairs. */
#ifdef NEVH__VECTORS
#define NEVH__ONE_BY_ONE                                                       \
    __attribute__((optimize("O2", "no-tree-slp-vectorize", "fp-contract=off")))
#else
#define NEVH__ONE_BY_ONE
#endif
/* Before a loop whose rounds do not read what others write. */
#ifdef __GNUC__
#define NEVH__NO_ALIAS _Pragma("GCC ivdep")
#else
#define NEVH__NO_ALIAS
#endif
/* A part of room that is laid out. */
static inline double *nevh__take(double **from, size_t size) {
    double *taken = *from;
    *from += size;
    return taken;
}

/* Each of `count` numbers, over a vector of lanes; for functions in vectors,
   since stores in parts are slow to load as a whole. */
NEVH__INLINE void nevh__repeat(size_t count, const double from[], double to[]) {
    for (size_t k = 0; k < count; k++) {
        double x = from[k];
        NEVH_LANES(i, NEVH__LANES) {
            to[k * NEVH__LANES + i] = x;
        }
    }
}

enum { NEVH__IN_VECTOR = sizeof(nevh__vector) / sizeof(double) };

#endif
