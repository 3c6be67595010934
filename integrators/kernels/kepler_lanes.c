/* nevh: the motion of eight bodies about centres, over short parts of their periods.

   As kepler_flow.c, in doubles and without branches: Kepler's equation is expanded for
   a first guess, and solved by two steps of Laguerre and Conway, or four.  Changes are made, so
   that their roundings are small where the step is.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kepler_flow_private.h"
#include "system/vector_private.h"
#include <math.h>

typedef struct {
    double mu, r, slope, b; /* as in kepler_flow.c */
} orbit;

typedef struct {
    double g0, g1, g2, g3;
} universal;

/* 1/2!, 1/3! ... */
static const double inverse[] = {1.0 / 2,
                                 1.0 / 6,
                                 1.0 / 24,
                                 1.0 / 120,
                                 1.0 / 720,
                                 1.0 / 5040,
                                 1.0 / 40320,
                                 1.0 / 362880,
                                 1.0 / 3628800,
                                 1.0 / 39916800,
                                 1.0 / 479001600,
                                 1.0 / 6227020800,
                                 1.0 / 87178291200,
                                 1.0 / 1307674368000,
                                 1.0 / 20922789888000,
                                 1.0 / 355687428096000,
                                 1.0 / 6402373705728000,
                                 1.0 / 121645100408832000,
                                 1.0 / 2432902008176640000,
                                 1.0 / 51090942171709440000.0};
enum { TERMS = sizeof inverse / sizeof *inverse };

/* For |b s^2| up to 4. */
NEVH__INLINE universal functions(double b, double s) {
    double x = b * s * s, c2 = inverse[TERMS - 2], c3 = inverse[TERMS - 1];
    NEVH_UNROLL
    for (int k = TERMS - 3; k > 0; k -= 2) {
        c2 = inverse[k - 1] - x * c2;
        c3 = inverse[k] - x * c3;
    }
    double g2 = s * s * c2, g3 = s * s * s * c3;
    return (universal){1 - b * g2, s - b * g3, g2, g3};
}

/* The change of s in a step of the iteration. */
NEVH__INLINE double correction(const orbit *o, const universal *g, double t) {
    double off = o->r * g->g1 + o->slope * g->g2 + o->mu * g->g3 - t;
    double r = o->r * g->g0 + o->slope * g->g1 + o->mu * g->g2;
    double dr = o->slope * g->g0 + (o->mu - o->b * o->r) * g->g1;
    return -5 * off / (r + nevh_simd_sqrt(fabs(16 * r * r - 20 * off * dr)));
}

/* The first terms of s as a series in t. */
NEVH__INLINE double first_guess(const orbit *o, double t) {
    double x = t / o->r, bend = o->slope * x / (2 * o->r);
    double next = (o->mu - o->b * o->r) * x * x / (6 * o->r);
    return x * (1 - bend + 2 * bend * bend - next);
}

/* 1 where s is exact to rounding and no differences are small. */
NEVH__INLINE double is_good(const orbit *o, const universal *g, double s,
                            double by, double now) {
    double parts = fabs(o->r * g->g0) + fabs(o->slope * g->g1);
    double pull = fabs(o->mu * g->g2);
    double size = parts + pull + fabs(by * now * 0x1p21) / fabs(s);
    bool fine = (size <= 2 * now) & (pull * pull <= 2 * o->r * now) &
                (fabs(o->b * s * s) <= 4);
    return fine ? 1 : 0;
}

/* Moves one of eight.  corrections: a constant */
NEVH__INLINE void take_lane(int corrections, size_t i, const double mu[],
                            double t, const double r[], const double v[],
                            double dr[], double dv[], double good[]) {
    enum { X = 0, Y = NEVH__LANES, Z = 2 * NEVH__LANES };
    double x = r[X + i], y = r[Y + i], z = r[Z + i];
    double u = v[X + i], w = v[Y + i], q = v[Z + i], by = 0;
    orbit o = {mu[i], nevh_simd_sqrt(x * x + y * y + z * z),
               x * u + y * w + z * q, 0};
    o.b = 2 * o.mu / o.r - (u * u + w * w + q * q);
    double s = first_guess(&o, t);
    universal g = functions(o.b, s);
    NEVH_UNROLL
    for (int k = 0; k < corrections; k++) {
        by = correction(&o, &g, t);
        s += by;
        g = functions(o.b, s);
    }
    double now = o.r * g.g0 + o.slope * g.g1 + o.mu * g.g2;
    double f = -o.mu * g.g2 / o.r, ahead = o.r * g.g1 + o.slope * g.g2;
    double turn = -o.mu * g.g1 / o.r / now, slower = -o.mu * g.g2 / now;
    dr[X + i] = f * x + ahead * u;
    dr[Y + i] = f * y + ahead * w;
    dr[Z + i] = f * z + ahead * q;
    dv[X + i] = turn * x + slower * u;
    dv[Y + i] = turn * y + slower * w;
    dv[Z + i] = turn * z + slower * q;
    good[i] = is_good(&o, &g, s, by, now);
}

NEVH_SIMD static void correct_twice(const double mu[], double t,
                                    const double r[], const double v[],
                                    double dr[], double dv[], double good[]) {
    NEVH_LANES(i, NEVH__LANES) {
        take_lane(2, i, mu, t, r, v, dr, dv, good);
    }
}

NEVH_SIMD static void correct_more(const double mu[], double t,
                                   const double r[], const double v[],
                                   double dr[], double dv[], double good[]) {
    NEVH_LANES(i, NEVH__LANES) {
        take_lane(4, i, mu, t, r, v, dr, dv, good);
    }
}

/* The versions of a function for vectors would be exported. */
void nevh__kepler_changes(const double mu[], double t, const double r[],
                          const double v[], double dr[], double dv[],
                          double good[]) {
    double fewest = 1;
    correct_twice(mu, t, r, v, dr, dv, good);
    for (size_t i = 0; i < NEVH__LANES; i++)
        fewest = good[i] < fewest ? good[i] : fewest;
    if (fewest == 0)
        correct_more(mu, t, r, v, dr, dv, good);
}
