/* nevh tests: a header of lib/native/steps as it stands, with what it needs of a
   scene.  STEPS: its name; FAMILY_*: whose.
   SPDX-License-Identifier: GPL-3.0-or-later */
#if defined FAMILY_DRIVER && !defined NEVH__FOR_READERS
/* Of what formulas have before them. */
typedef __SIZE_TYPE__ size;
#define INLINE static inline
#define CONST  __attribute__((const))
typedef double wide __attribute__((vector_size(64), aligned(8)));
extern double fabs(double) CONST;
#include "native/steps/compiled_needs.h"
#define TABLE(b) (N + (b))
#else
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#ifdef FAMILY_DRIVER
#include "native/steps/program_needs.h"
#else
#include "system/vector_private.h"
#ifdef NEVH__FOR_READERS
#define NEVH__COMPILED(...)
static const double SCALES[4] = {1, 1, 1, 1};
#else
#define NEVH__COMPILED(...) __VA_ARGS__
#define SCALES              (N + 7)
size_t nevh_native_steps(const double *N, double *W, double *T,
                         size_t operations, double t0, double h, size_t from,
                         size_t steps, double *Q, double *P, double *M,
                         size_t *counted, double *room);
#endif

#ifdef FAMILY_IMPLICIT
typedef nevh__vector slope_number;
#else
typedef nevh__number slope_number;
#endif
#endif
#endif

#ifdef FAMILY_DRIVER
#ifdef NEVH__WIDE
enum { LANES = 8 };
#else
enum { LANES = 1 };
#endif
enum {
    ONE = 2,
    GROUP = 1,
    DOF = ONE * GROUP,
    WIDTH = LANES,
    BLOCKS = 1,
    KEPT = DOF,
    COUNT = DOF * LANES,
    ROWS_BEFORE = 3
};
#ifdef NEVH__FOR_READERS
static inline double take_step(double t, double h, double *y, double *lost,
                               double *kept) {
    (void)lost, (void)kept;
    return t + h * y[0];
}
#else
size_t nevh_native_steps(const double *N, double *W, double *T,
                         size_t operations, double t0, double h, size_t from,
                         size_t steps, double *Q, double *P, double *M,
                         size_t *counted, double *room);
static inline nevh__number take_step(const double *N, double *W, double *T,
                                     size_t operations, double t, double h,
                                     nevh__number *y, nevh__number *lost,
                                     nevh__number *kept, nevh__number *room) {
    (void)N, (void)W, (void)T, (void)operations, (void)room, (void)lost;
    y[0] += t + h;
    return kept[0] - kept[0];
}
static inline nevh__number take_first(const double *N, const double *T,
                                      double t, double h, const nevh__number *y,
                                      const nevh__number *lost,
                                      nevh__number *kept, nevh__number *room) {
    (void)N, (void)T, (void)room, (void)lost;
    kept[0] = y[0] + t + h;
    return kept[0] - kept[0];
}
#endif
#else
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

#include STEPS
#if !defined NEVH__FOR_READERS && !defined FAMILY_ADAPTIVE_VERLET &&           \
    !defined FAMILY_DRIVER && !defined FAMILY_TAO
#include "native/steps/entry.h"
#endif
