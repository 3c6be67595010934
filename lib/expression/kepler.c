/* nevh: Kepler's equation, E - e sin E = M, for ellipses.

   For M in (0, pi] the left side rises and is convex, so that Newton's steps
   from above come down to the solution; they end where one no longer does.
   (1 - e) E + e (E - sin E), a sum of positive parts, does not cancel where e is
   near 1 and E is small.  The start is the least of four upper bounds; the third
   since (E - sin E)/E^3 falls from 1/6 to 1/pi^2 on the way to pi.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_operations_private.h"

enum { MOST_STEPS = 100, TERMS = 14 };
static const double pi = 3.14159265358979323846;
/* 2 pi as a sum. */
static const double turn = 6.283185307179586232,
                    turn_rest = 2.449293598294706e-16;
static const double farthest = 1e15; /* beyond it M is noise */

/* x - sin x, by the sine's series where the two are close. */
static double less_sine(double x) {
    double sum = 0;
    if (x > 2)
        return x - nevh_simd_sin(x);
    for (int k = TERMS; k > 0; k--)
        sum = x * x / (double)(2 * k * (2 * k + 1)) * (1 - sum);
    return x * sum;
}

/* 1 - e cos E */
static double radius(double anomaly, double e) {
    double s = nevh_simd_sin(anomaly / 2);
    return (1 - e) + 2 * e * s * s;
}

static double kepler_solve(double mean, double e) {
    double x = fmin(fmin(mean + e, pi), mean / (1 - e));
    if (e > 0)
        x = fmin(x, nevh_simd_cbrt(pi * pi * mean / e));
    for (int i = 0; i < MOST_STEPS; i++) {
        double over = (1 - e) * x + e * less_sine(x) - mean;
        double next = x - over / radius(x, e);
        if (!(next < x && next > 0))
            break;
        x = next;
    }
    return x;
}

double nevh__kepler(double mean, double e) {
    if (!(e >= 0 && e < 1 && fabs(mean) <= farthest))
        return NAN;
    double turns = rint(mean / turn);
    double rest = fma(-turns, turn_rest, fma(-turns, turn, mean));
    if (rest == 0 || e == 0)
        return mean;
    return copysign(kepler_solve(fmin(fabs(rest), pi), e), rest) + turns * turn;
}

double nevh__kepler_slope(double anomaly, double e) {
    return 1 / radius(anomaly, e);
}
