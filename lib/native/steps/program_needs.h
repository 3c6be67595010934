/* nevh: what kernels' texts need in programs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PROGRAM_NEEDS_H
#define NEVH_PROGRAM_NEEDS_H

/* Element by element. */
#define NEVH__EACH(i, lanes, size) for (size_t i = 0; i < (size); i += (lanes))

/* The rounding error of sum = a + b. */
static double nevh__roundoff(double sum, double a, double b) {
    double part = sum - a;
    return (a - (sum - part)) + (b - part);
}

#ifdef NEVH__FINITE
static bool nevh__not_finite(size_t lanes, size_t size, const double *x,
                             const double *y) {
    double bad = 0;
    NEVH__EACH(i, lanes, size) {
        bad += (x[i] - x[i]) + (y[i] - y[i]);
    }
    return bad != 0;
}
#endif

#ifdef NEVH__SUMS
#define NEVH__VECTOR_AT(x) (*(x))
enum { NEVH__IN_VECTOR = 1 };
typedef double nevh__vector;
#endif

#ifdef NEVH__STAGES
enum { NEVH__LANES = 1 };
#define NEVH_LANES(i, width) for (size_t i = 0; i < (width); i++)

static double nevh__sum_lanes(const double *x) {
    return x[0];
}

static bool is_bad(double bad) {
    return bad != 0;
}
#endif

#endif
