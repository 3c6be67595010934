/* nevh: a place and a velocity from orbital elements, in one kind of numbers.

   Before this is included are defined: real; NAMED(name), the name of a
   function; FUNCTION(f), a function of theirs as <math.h> has it;
   ECCENTRIC(M, e), the eccentric anomaly.
   SPDX-License-Identifier: GPL-3.0-or-later */

/* Two axes in the plane of the orbit, towards the pericentre and square to it,
   as far as coordinate k goes. */
static void NAMED(axes)(const real *x, size_t k, real *along, real *across) {
    real cos_w = FUNCTION(cos)(x[PERICENTRE]),
         sin_w = FUNCTION(sin)(x[PERICENTRE]);
    real cos_n = FUNCTION(cos)(x[NODE]), sin_n = FUNCTION(sin)(x[NODE]);
    real cos_i = FUNCTION(cos)(x[INCLINATION]),
         sin_i = FUNCTION(sin)(x[INCLINATION]);
    if (k == 0) {
        *along = cos_n * cos_w - sin_n * sin_w * cos_i;
        *across = -cos_n * sin_w - sin_n * cos_w * cos_i;
    } else if (k == 1) {
        *along = sin_n * cos_w + cos_n * sin_w * cos_i;
        *across = -sin_n * sin_w + cos_n * cos_w * cos_i;
    } else {
        *along = sin_w * sin_i;
        *across = cos_w * sin_i;
    }
}

/* 1 - e cos E and cos E - e by the half angle, so that they do not cancel where
   e is near 1. */
static void NAMED(place)(const real *x, size_t k, real *q, real *v) {
    real e = x[E], along, across;
    real anomaly = ECCENTRIC(x[MEAN_ANOMALY], e);
    real half = FUNCTION(sin)(anomaly / 2), sine = FUNCTION(sin)(anomaly),
         cosine = FUNCTION(cos)(anomaly);
    real round = FUNCTION(sqrt)((1 - e) * (1 + e));
    real speed = FUNCTION(sqrt)(x[MU] / x[A]) / ((1 - e) + 2 * e * half * half);
    NAMED(axes)(x, k, &along, &across);
    *q = x[A] * (((1 - e) - 2 * half * half) * along + round * sine * across);
    *v = speed * (round * cosine * across - sine * along);
}
