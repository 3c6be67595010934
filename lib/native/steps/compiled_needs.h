/* nevh: what kernels' texts need as steps are compiled, behind what formulas do.

   NEVH__WIDE: numbers are vectors of orbits; NEVH__SIDE_BY_SIDE: there are some;
   NEVH__STAGES: steps are implicit; NEVH__LOOPS: over instances.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COMPILED_NEEDS_H
#define NEVH_COMPILED_NEEDS_H

#ifdef NEVH__LOOPS
#define NEVH_UNROLL
#else
#define NEVH_UNROLL _Pragma("GCC unroll 16")
#endif

#define NEVH__KNOWN_COUNT NEVH_UNROLL
#define NEVH__EACH(i, lanes, size)                                             \
    NEVH_UNROLL for (size_t i = 0; i < (size); i += (lanes))
#define NEVH__COMPILED(...) __VA_ARGS__
/* Rows of a step: on the stack, or where a state is long in the room that it is
   handed; and the last arguments of its slopes. */
#ifdef NEVH__LOOPS
#define NEVH__ROWS(name, from, rows)                                           \
    nevh__number *name = room + (from) * (size_t)DOF
#define NEVH__WHOLE , 0, 8 * DOF
#else
#define NEVH__ROWS(name, from, rows) nevh__number name[(rows)*DOF]
#define NEVH__WHOLE
#endif

#ifdef NEVH__WIDE
/* Numbers that are not finite are found once for all blocks. */
typedef wide nevh__number, nevh__vector;
INLINE wide nevh__roundoff(wide sum, wide a, wide b) {
    wide part = sum - a;
    return (a - (sum - part)) + (b - part);
}

INLINE bool nevh__not_finite(size_t lanes, size_t size, const wide *x,
                             const wide *y) {
    (void)lanes, (void)size, (void)x, (void)y;
    return false;
}
#else
typedef double nevh__number;
#ifdef NEVH__SIDE_BY_SIDE
INLINE double nevh__roundoff(double sum, double a, double b) {
    double part = sum - a;
    return (a - (sum - part)) + (b - part);
}
#else
/* The rounding error of the larger one of a and b follows in two operations instead
   of six, which all wait for one another; it is exact in both ways. */
static __attribute__((noinline, cold)) double
rare_roundoff(double sum, double a, double b) {
    return a - (sum - b);
}
INLINE double nevh__roundoff(double sum, double a, double b) {
    if (__builtin_expect(!(fabs(a) >= fabs(b)), 0))
        return rare_roundoff(sum, a, b);
    return b - (sum - a);
}
#endif
#endif

#ifdef NEVH__STAGES
/* Numbers, and vectors of what stands side by side. */
typedef wide nevh__vector;
#define NEVH__ONE_SHAPE
#define NEVH__VECTOR_AT(x) (*(nevh__vector *)(x))
enum { NEVH__IN_VECTOR = sizeof(wide) / sizeof(double), NEVH__LANES = 8 };
#define NEVH_LANES(i, width)                                                   \
    for (size_t i##_from = 0; i##_from < (width); i##_from += 8)               \
    _Pragma("GCC ivdep") for (size_t i = i##_from; i != i##_from + 8; i++)
extern double fma(double, double, double) CONST;
INLINE double nevh__sum_lanes(const double *x) {
    return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}
#else
#define NEVH__VECTOR_AT(x) (*(x))
enum { NEVH__IN_VECTOR = 1 };
#endif

#if defined NEVH__STAGES || defined NEVH__WIDE
INLINE bool is_bad(wide bad) {
#ifdef NEVH__FOUR_TOGETHER
    return (bad[0] + bad[1]) + (bad[2] + bad[3]) != 0;
#else
    return ((bad[0] + bad[1]) + (bad[2] + bad[3])) +
               ((bad[4] + bad[5]) + (bad[6] + bad[7])) !=
           0;
#endif
}
#else
typedef double nevh__vector;
INLINE bool nevh__not_finite(size_t lanes, size_t size, const double *x,
                             const double *y) {
    double bad = 0;
    NEVH__EACH(i, lanes, size) {
        bad += (x[i] - x[i]) + (y[i] - y[i]);
    }
    return bad != 0;
}

INLINE bool is_bad(double bad) {
    return bad != 0;
}
#endif

/* A number of all orbits, where it is that of a block. */
#ifdef NEVH__GROUPS
#define AT(x, row, b)                                                          \
    (*(nevh__number *)((x) + ((row) / DOF * ONE + (row) % ONE) * WIDTH +       \
                       ((b)*GROUP + (row) % DOF / ONE) * LANES))
#else
#define AT(x, row, b) (*(nevh__number *)((x) + (row)*WIDTH + (b)*LANES))
#endif

#endif
