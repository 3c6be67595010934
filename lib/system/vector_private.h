/* nevh: numbers side by side, for code in which they must not go through
   memory.
   SPDX-License-Identifier: GPL-3.0-or-later

   In sums of several terms GCC keeps an array of lanes in memory, and one
   operation waits for the other to be stored; a vector it keeps in a register,
   unless it is longer than those of the processor: so two of them are a block of
   lanes, and processors with AVX keep them, too.
   Arithmetic is that of its lanes, on any processor.

   This header needs <nevh/simd.h> and the C library alone. */
#ifndef NEVH_VECTOR_PRIVATE_H
#define NEVH_VECTOR_PRIVATE_H

#include <nevh/simd.h>
#include <stdbool.h>

/* Block callbacks always get a multiple of this many lanes. */
#define NEVH__LANES 8

#ifdef __GNUC__
#define NEVH__HAS_VECTOR 1
typedef double nevh__vector
    __attribute__((vector_size(NEVH__LANES / 2 * sizeof(double)),
                   aligned(sizeof(double)), may_alias));
#else
typedef double nevh__vector;
#endif
/* The element of rows in explicit steps, one orbit each; in compiled steps it may
   be a vector of several orbits. */
typedef double nevh__number;
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
/* Before a loop whose count is a constant in steps that are compiled for one
   scheme. */
#define NEVH__KNOWN_COUNT
/* Element by element, `lanes` (a constant that divides size) at a time. */
#define NEVH__EACH(i, lanes, size)                                             \
    for (size_t i##_from = 0; i##_from < (size); i##_from += (lanes))          \
    NEVH__NO_ALIAS for (size_t i = i##_from; i != i##_from + (lanes); i++)

/* The rounding error of sum = a + b, exactly, whichever is larger. */
NEVH__INLINE double nevh__roundoff(double sum, double a, double b) {
    double part = sum - a;
    return (a - (sum - part)) + (b - part);
}

NEVH__INLINE double nevh__sum_lanes(const double x[NEVH__LANES]) {
    return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

/* True if any number of two arrays is not finite: x - x is then NaN, and so is the
   sum. */
NEVH__INLINE bool nevh__not_finite(size_t lanes, size_t size, const double x[],
                                   const double y[]) {
    double bad[NEVH__LANES] = {0};
    for (size_t from = 0; from < size; from += lanes)
        for (size_t i = 0; i < lanes; i++)
            bad[i] += (x[from + i] - x[from + i]) + (y[from + i] - y[from + i]);
    return (lanes == 1 ? bad[0] : nevh__sum_lanes(bad)) != 0;
}

/* A part of room that is laid out. */
static inline double *nevh__take(double **from, size_t size) {
    double *taken = *from;
    *from += size;
    return taken;
}

/* Each of `count` numbers, over a vector of lanes; for functions in vectors,
   since stores in parts are slow to load as a whole. */
NEVH__INLINE void nevh__broadcast(size_t count, const double from[],
                                  double to[]) {
    for (size_t k = 0; k < count; k++) {
        double x = from[k];
        NEVH_LANES(i, NEVH__LANES) {
            to[k * NEVH__LANES + i] = x;
        }
    }
}

/* The vector that begins there. */
#define NEVH__VECTOR_AT(x) (*(nevh__vector *)(x))
enum { NEVH__IN_VECTOR = sizeof(nevh__vector) / sizeof(double) };

#endif
