/* nevh tests: a header of lib/native/steps as it stands, with what it needs of a
   scene.  HEADER: its name; FAMILY_*: whose.
   SPDX-License-Identifier: GPL-3.0-or-later */
#if defined FAMILY_FORMULAS || defined FAMILY_SPLITTING ||                     \
    defined FAMILY_RUNGE_KUTTA || defined FAMILY_NYSTROM ||                    \
    defined FAMILY_PARTS
#define STANDS_ALONE
#endif
#if (defined FAMILY_DRIVER || defined STANDS_ALONE) &&                         \
    !defined NEVH__FOR_READERS
/* In place of what the library has. */
#define NEVH_VECTOR_PRIVATE_H
#define NEVH_SIMD_H
#include "native/steps/compiled_formulas.h"
#include "native/steps/formula_needs.h"
#ifdef NEVH__LOOPS
#include "native/steps/loop_needs.h"
#endif
#include "native/steps/compiled_needs.h"
#include "native/steps/steps_call.h"
#define TABLE(b) (N + (b))
#else
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined FAMILY_DRIVER || defined STANDS_ALONE
#define NEVH_VECTOR_PRIVATE_H
#define NEVH_SIMD_H
#define NEVH__COMPILED(...)
#define NEVH__INLINE static
#define NEVH__KNOWN_COUNT
#define NEVH_UNROLL
typedef double nevh__number;
#include "native/steps/program_needs.h"
#else
#include "system/vector_private.h"
#ifdef NEVH__FOR_READERS
#define NEVH__COMPILED(...)
static const double SCALES[4] = {1, 1, 1, 1};
#else
#define NEVH__COMPILED(...) __VA_ARGS__
#define SCALES              (N + 7)
#include "native/steps/steps_call.h"
size_t nevh_native_steps(const nevh__steps_call *);
#endif

#ifdef FAMILY_IMPLICIT
typedef nevh__vector slope_number;
#else
typedef nevh__number slope_number;
#endif
#endif
#endif

#if defined FAMILY_DRIVER || defined STANDS_ALONE
#ifdef NEVH__WIDE
enum { LANES = sizeof(wide) / sizeof(double) };
#else
enum { LANES = 1 };
#endif
enum {
    ONE = 2,
    GROUP = 1,
    DOF = ONE * GROUP,
    WIDTH = LANES,
    BLOCKS = 1,
    COUNT = DOF * LANES,
    ROWS_BEFORE = 3
};
#endif
#ifdef FAMILY_DRIVER
enum { KEPT = DOF };
#ifdef NEVH__FOR_READERS
static inline double take_step(double t, double h, double *y, double *lost,
                               double *kept) {
    (void)lost, (void)kept;
    return t + h * y[0];
}
#else
size_t nevh_native_steps(const nevh__steps_call *);
static inline nevh__number take_step(const nevh__steps_call *c, const double *N,
                                     double t, nevh__number *y,
                                     nevh__number *lost, nevh__number *kept,
                                     nevh__number *room) {
    (void)N, (void)room, (void)lost;
    y[0] += t + c->h;
    return kept[0] - kept[0];
}
static inline nevh__number take_first(const nevh__steps_call *c,
                                      const double *N, const nevh__number *y,
                                      const nevh__number *lost,
                                      nevh__number *kept, nevh__number *room) {
    double t = c->t0, h = c->h;
    (void)N, (void)room, (void)lost;
    kept[0] = y[0] + t + h;
    return kept[0] - kept[0];
}
#endif
#elif !defined STANDS_ALONE
enum { DOF = 2 };

/* H = (p^2 + q^2)/2. */
static inline slope_number
kick_slope(NEVH__COMPILED(const double *N, ) slope_number t,
           const slope_number *q, const slope_number *p, slope_number *slope) {
    NEVH__COMPILED((void)N;)
    (void)p;
    for (size_t k = 0; k < DOF; k++)
        slope[k] = q[k];
    return t - t;
}

static inline slope_number
drift_slope(NEVH__COMPILED(const double *N, ) slope_number t,
            const slope_number *q, const slope_number *p, slope_number *slope) {
    (void)q;
    return kick_slope(NEVH__COMPILED(N, ) t, p, q, slope);
}

#endif

#ifdef STANDS_ALONE
/* H = (p^2 + q^2)/2: as above, of one orbit, of several, and of a state that is
   long. */
#ifdef NEVH__FOR_READERS
#define SLOPE_OF(name, from)                                                   \
    static double name(double t, const double *q, const double *p,             \
                       double *slope) {                                        \
        (void)q, (void)p;                                                      \
        for (size_t k = 0; k < DOF; k++)                                       \
            slope[k] = from[k];                                                \
        return t - t;                                                          \
    }
#elif defined NEVH__LOOPS
#define SLOPE_OF(name, from)                                                   \
    static double name(const double *N, double t, const wide *q,               \
                       const wide *p, wide *slope, size_t first,               \
                       size_t past) {                                          \
        (void)N, (void)q, (void)p;                                             \
        for (size_t k = first / 8; k < past / 8; k++)                          \
            slope[k] = from[k];                                                \
        return t - t;                                                          \
    }
#else
#define SLOPE_OF(name, from)                                                   \
    static nevh__number name(const double *N, double t, const nevh__number *q, \
                             const nevh__number *p, nevh__number *slope) {     \
        (void)N, (void)q, (void)p;                                             \
        for (size_t k = 0; k < ONE; k++)                                       \
            slope[k] = from[k] + t;                                            \
        return q[0] - q[0];                                                    \
    }
#endif
SLOPE_OF(kick_slope, q)
SLOPE_OF(drift_slope, p)
#ifdef FAMILY_PARTS
enum { KEPT_ROWS = 2 };
SLOPE_OF(inner_slope, q)
#endif
#endif

#ifdef FAMILY_SPLITTING
enum { OPERATIONS = 3, KICKS_FIRST = true, KEEPS = true };
#ifdef NEVH__FOR_READERS
static double W[OPERATIONS] = {0.5, 1, 0.5}, T[OPERATIONS] = {0, 0.5, 1};
#elif defined NEVH__LOOPS
static const size_t lags[] = {1, 2, 3};
enum {
    PART = 16,
    PARTS = 1,
    GROUPS = 3,
    AT_ONCE = 2,
    IN_WORK = 3,
    WINDOW = DOF,
    IN_FIRST = 1,
    LAST_AT = 2,
    IN_LAST = 1,
    KICK_REACHES = true,
    DRIFT_REACHES = false,
    READS_Q = true,
    READS_P = true,
    kick_before = 1,
    drift_before = 1
};
static wide kick_vector(const double *N, double t, const wide *y, size_t k,
                        wide *before, wide *bad) {
    (void)N, (void)k;
    *bad += t - t;
    *before = *y;
    return *y;
}
#define kick_at      kick_vector
#define drift_vector kick_vector
#define drift_at     kick_vector
#endif
#ifndef NEVH__FOR_READERS
#include "native/steps/splitting_first.h"
#endif
#endif

#if defined FAMILY_RUNGE_KUTTA || defined FAMILY_NYSTROM
#include "kernels/stage_sums_private.h"
enum { STAGES = 2, DIAGONAL = true, MOVES = true };
static double weights_1[] = {1};
static size_t offsets_1[] = {0};
static const nevh__sum sums[STAGES + 4] = {{NULL, 1, weights_1, offsets_1}};
static const double times[STAGES] = {0, 1};
static const nevh__number RATES[DOF], AT_REST[DOF], INVERSE[DOF];
#define NEVH__EACH_STAGE(take) take(0) take(1)
#endif

#ifdef FAMILY_ADAPTIVE
enum { KEEPS = true, COARSE = true };
static const double POWER = 5, TOLERANCE = 1e-8, FIRST_PART = 1e-3;
static inline double take_first(NEVH__COMPILED(const double *N, ) double t,
                                double h, double *y, double *lost,
                                double *first) {
    (void)h, (void)lost;
    return kick_slope(NEVH__COMPILED(N, ) t, y, y + DOF, first) +
           drift_slope(NEVH__COMPILED(N, ) t, y, y + DOF, first + DOF);
}
static inline double take_trial(NEVH__COMPILED(const double *N, ) double t,
                                double h, double *y, double *lost,
                                double *first, double *ahead, double *change,
                                double *error, double *coarse) {
    for (size_t k = 0; k < 2 * DOF; k++)
        change[k] = error[k] = coarse[k] = h * first[k];
    return take_first(NEVH__COMPILED(N, ) t, h, y, lost, ahead);
}
#endif
#ifdef FAMILY_ADAPTIVE_VERLET
static const double UNIT_Q = 1, UNIT_P = 1, LEAST_RATE = 1e-9;
#ifdef NEVH__FOR_READERS
#include "run/fraction_private.h"
#endif
#endif
#ifdef FAMILY_TAO
enum { PARTS = 3 };
static const double WEIGHTS[1] = {1.35}, RATIOS[DOF] = {1, 2}, OMEGA = 10;
#endif
#ifdef FAMILY_IMPLICIT
#define NEVH__ONE_SHAPE
#define TABLE(b) (N + (b))
enum {
    STAGES = 2,
    ROW = NEVH__LANES,
    FIRST = 0,
    PAST = 2,
    APART = NEVH__LANES,
    SCALES_APART = 1,
    STRIDE = STAGES * NEVH__LANES,
    FEW = 0,
    PARTITIONED = false,
    NOISY = true,
    NEWTON = false,
    WIDTH = NEVH__LANES,
    BLOCKS = 1
};
static const double mu_q[STAGES * ROW], mu_p[STAGES * ROW];
static const double guess[STAGES * ROW], long_guess[PAST * STAGES * ROW];
static const double nodes[ROW], weights[STAGES] = {0.5, 0.5};
static const size_t order[STAGES] = {0, 1};
static inline bool is_bad(nevh__vector bad) {
    return bad[0] != 0;
}
static inline double worst_noise(NEVH__COMPILED(const double *N, ) double t,
                                 const double *y, const double *scale,
                                 double *bad) {
    NEVH__COMPILED((void)N;)
    *bad += t - t;
    return y[0] / scale[0];
}
#endif

#ifdef FAMILY_FORMULAS
#ifdef NEVH__FOR_READERS
enum { SWEEPS_AT = 2 };
static const double T0 = 0, T_END = 1, STEP = 0.1, ENERGY_SCALE = 1;
static const size_t STEPS = 10, EVERY = 2;
static const char *const TITLES[] = {"t,x", ",p_x"};
static const char METHOD[] = "verlet,exact";
static double energy(double t, const double *q, const double *p) {
    return t + q[0] + p[0];
}
#ifdef NEVH__OWN_TIME
static size_t advance(double *t, double t_end, double h, size_t steps,
                      double *q, double *p, double *memory) {
    *t = t_end + h * (q[0] + p[0] + memory[0]);
    return steps;
}
#else
static size_t advance(double t0, double h, size_t from, size_t steps, double *q,
                      double *p, double *memory) {
    q[0] = p[0] + memory[0] + t0 + (double)from * h;
    return steps;
}
#endif
#endif
#endif

#include HEADER
#if defined STANDS_ALONE && !defined NEVH__ADAPTS && !defined FAMILY_FORMULAS
#if !defined FAMILY_SPLITTING && !defined FAMILY_PARTS
enum { KEPT = DOF };
#define take_first(c, N, y, lost, kept, room) ((nevh__number){0})
#endif
#if defined NEVH__LOOPS && !defined NEVH__FOR_READERS
#include "native/steps/long_driver.h"
#else
#include "native/steps/block_driver.h"
#endif
#endif
#if !defined NEVH__FOR_READERS && !defined FAMILY_ADAPTIVE_VERLET &&           \
    !defined FAMILY_DRIVER && !defined FAMILY_TAO && !defined STANDS_ALONE
#include "native/steps/entry.h"
#endif
