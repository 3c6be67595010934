/* nevh: what the operations of a tape do.
   SPDX-License-Identifier: GPL-3.0-or-later

   What the entries of operations_private.h call, of doubles. */
#ifndef NEVH_TAPE_OPERATIONS_PRIVATE_H
#define NEVH_TAPE_OPERATIONS_PRIVATE_H

#include "expression/tape_private.h"
#include <nevh/body.h>
#include <float.h>

/* With NaN outside their domains, where GSL would abort. */
double nevh__bessel_j0(double x);
double nevh__bessel_j1(double x);
double nevh__bessel_j1_slope(double x);
double nevh__elliptic_k(double k);
double nevh__elliptic_e(double k);
double nevh__elliptic_k_slope(double k);
double nevh__elliptic_e_slope(double k);
/* The eccentric anomaly E of a mean one, and dE/dM; dE/de is sin E times that. */
double nevh__kepler(double mean, double e);
double nevh__kepler_slope(double anomaly, double e);

NEVH__INLINE double nevh__choose(bool first, double x, double y) {
    return first ? x : y;
}

NEVH__INLINE double nevh__sign(double x) {
    double sign = x > 0 ? 1 : x < 0 ? -1 : 0;
    return x != x ? x : sign;
}

NEVH__INLINE double nevh__mod(double x, double y) {
    double rest = fmod(x, y);
    return rest != 0 && (rest < 0) != (y < 0) ? rest + y : rest;
}

/* In the chain rule 0 times infinity is 0. */
NEVH__INLINE double nevh__chain(double x, double y) {
    double product = x * y;
    bool undecided = (product != product) & !isunordered(x, y);
    return undecided ? 0 : product;
}
#define NEVH__G(slope) nevh__chain(g, slope)
/* Multiples of g that are constants if g is one. */
#define NEVH__TWICE_G(slope)  nevh__chain(2 * g, slope)
#define NEVH__THRICE_G(slope) nevh__chain(3 * g, slope)

/* The defaults, for doubles. */
#define NEVH__F(f) nevh_simd_##f
#define NEVH__L(f) f
#define NEVH__H(f) nevh__##f
#define NEVH__S(f) nevh__##f

#endif
