/* nevh: the motion about a fixed centre.

   With ds = dt/|r|, r' = r.v at the start, and b = 2 mu/|r| - v^2, all orbits have

     t = |r| G1 + r' G2 + mu G3,   Gk(s) = s^k (1/k! - b s^2/(k + 2)! + ...)

   [R. H. Battin, An Introduction to the Mathematics and Methods of Astrodynamics,
   AIAA (1999), section 4.5; J. Wisdom, D. M. Hernandez, A fast and accurate universal
   Kepler solver without Stumpff series, MNRAS 453 (2015) 3015-3023].  t rises with
   s, whose bracket is kept; it is narrowed by the method of Laguerre and Conway
   [B. A. Conway, An improved algorithm due to Laguerre for the solution of Kepler's
   equation, Celest. Mech. 39 (1986) 199-211].

   Lagrange's coefficients then make the new state of the old one.  Where |r| is a
   small difference of large numbers, it is made of the pericentre instead, from
   which |r| is a sum of positive numbers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kepler_flow_private.h"
#include <stdbool.h>
#include <stddef.h>
#include <tgmath.h>

enum { MOST_TRIALS = 100, TERMS = 9 };
static const nevh__extended turn = 6.283185307179586476925L;
/* The step of a trial, by s: the next one has the last digits. */
static const nevh__extended close_enough = 1e-7;
static const nevh__extended rounding = sizeof(nevh__extended) > sizeof(double)
                                           ? 0x1p-62
                                           : 0x1p-51;

typedef struct {
    nevh__extended g0, g1, g2, g3;
} universal;

typedef struct {
    nevh__extended mu, r, slope, b; /* slope: d|r|/ds = r.v */
} orbit;

static universal series(nevh__extended b, nevh__extended s) {
    static const nevh__extended inverse[] = {1.0L / 2,
                                             1.0L / 6,
                                             1.0L / 24,
                                             1.0L / 120,
                                             1.0L / 720,
                                             1.0L / 5040,
                                             1.0L / 40320,
                                             1.0L / 362880,
                                             1.0L / 3628800,
                                             1.0L / 39916800,
                                             1.0L / 479001600,
                                             1.0L / 6227020800,
                                             1.0L / 87178291200,
                                             1.0L / 1307674368000,
                                             1.0L / 20922789888000,
                                             1.0L / 355687428096000,
                                             1.0L / 6402373705728000,
                                             1.0L / 121645100408832000};
    nevh__extended x = b * s * s, c2 = 0, c3 = 0;
    for (int k = 2 * TERMS - 1; k > 0; k -= 2) {
        c2 = inverse[k - 1] - x * c2;
        c3 = inverse[k] - x * c3;
    }
    nevh__extended g2 = s * s * c2, g3 = s * s * s * c3;
    return (universal){1 - b * g2, s - b * g3, g2, g3};
}

static universal functions(nevh__extended b, nevh__extended s) {
    if (fabs(b * s * s) < 0.5)
        return series(b, s);
    nevh__extended w = sqrt(fabs(b)), half = w * s / 2;
    nevh__extended more = b > 0 ? 0 : expm1(fabs(half));
    nevh__extended less = more / (1 + more);
    nevh__extended sine = b > 0 ? sin(half) : copysign(more + less, s) / 2;
    nevh__extended cosine = b > 0 ? cos(half) : 1 + more * less / 2;
    nevh__extended g1 = 2 * sine * cosine / w;
    nevh__extended g2 = 2 * sine * sine / fabs(b);
    return (universal){1 - b * g2, g1, g2, (s - g1) / b};
}

static nevh__extended solve(const orbit *o, nevh__extended t) {
    nevh__extended low = 0, high = o->b > 0 ? turn / sqrt(o->b) : INFINITY;
    nevh__extended s = t / o->r, bend = o->slope * s / (2 * o->r);
    if (fabs(bend) < 0.25 && s < high)
        s -= s * bend;
    else
        s = fmin(fmin(s, cbrt(6 * t / fabs(o->mu))), high / 2);
    for (int i = 0; i < MOST_TRIALS; i++) {
        universal g = functions(o->b, s);
        nevh__extended off = o->r * g.g1 + o->slope * g.g2 + o->mu * g.g3 - t;
        nevh__extended r = fabs(o->r * g.g0 + o->slope * g.g1 + o->mu * g.g2);
        nevh__extended dr = o->slope * g.g0 + (o->mu - o->b * o->r) * g.g1;
        nevh__extended next =
            s - 5 * off / (r + sqrt(fabs(16 * r * r - 20 * off * dr)));
        *(off < 0 ? &low : &high) = s;
        if (off == 0 || next == s)
            break;
        bool inside = next > low && next < high && off < t;
        if (!inside)
            next = high < INFINITY ? low + (high - low) / 2 : 2 * s;
        nevh__extended by = fabs(next - s);
        s = next;
        if (by <= (inside ? close_enough : rounding) * s)
            break;
    }
    return s;
}

static void cross(const nevh__extended a[], const nevh__extended b[],
                  nevh__extended product[]) {
    for (size_t i = 0; i < NEVH__SPACE; i++) {
        size_t j = (i + 1) % NEVH__SPACE, k = (i + 2) % NEVH__SPACE;
        product[i] = a[j] * b[k] - a[k] * b[j];
    }
}

static nevh__extended dot(const nevh__extended a[], const nevh__extended b[]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* s from the pericentre to the start; size: of mu times the eccentricity. */
static nevh__extended since_pericentre(const orbit *o, nevh__extended size) {
    nevh__extended w = sqrt(fabs(o->b)), sine = w * o->slope / size;
    if (w == 0)
        return o->slope / size;
    return o->b > 0 ? atan2(sine, (o->mu - o->b * o->r) / size) / w
                    : asinh(sine) / w;
}

/* In place of the old state: `axis` is towards the pericentre. */
static void from_pericentre(const orbit *o, nevh__extended s,
                            nevh__extended r[], nevh__extended v[]) {
    nevh__extended spin[NEVH__SPACE], axis[NEVH__SPACE], across[NEVH__SPACE];
    cross(r, v, spin);
    cross(v, spin, axis);
    for (size_t i = 0; i < NEVH__SPACE; i++)
        axis[i] -= o->mu * r[i] / o->r;
    nevh__extended size = sqrt(dot(axis, axis));
    cross(spin, axis, across);
    universal g = functions(o->b, since_pericentre(o, size) + s);
    nevh__extended least =
        o->mu > 0 ? dot(spin, spin) / (o->mu + size) : (o->mu - size) / o->b;
    nevh__extended now = least + size * g.g2;
    for (size_t i = 0; i < NEVH__SPACE; i++) {
        r[i] = ((least - o->mu * g.g2) * axis[i] + g.g1 * across[i]) / size;
        v[i] = (g.g0 * across[i] - o->mu * g.g1 * axis[i]) / (size * now);
    }
}

static orbit orbit_of(nevh__extended mu, const nevh__extended r[],
                      const nevh__extended v[]) {
    orbit o = {.mu = mu, .r = sqrt(dot(r, r)), .slope = dot(r, v)};
    o.b = 2 * mu / o.r - dot(v, v);
    return o;
}

/* Whole periods are left out. */
static nevh__extended solve_either_way(const orbit *o, nevh__extended t) {
    if (o->b > 0) {
        nevh__extended period = turn * (o->mu / o->b) / sqrt(o->b);
        t -= period * rint(t / period);
    }
    orbit back = *o;
    back.slope = -o->slope;
    return t > 0 ? solve(o, t) : t < 0 ? -solve(&back, -t) : t;
}

/* True if Lagrange's coefficients are small differences of large numbers, and there
   is a pericentre. */
static bool cancels(const orbit *o, const universal *g, nevh__extended now) {
    static const nevh__extended most = 2, least_eccentricity = 0.1;
    nevh__extended parts = fabs(o->r * g->g0) + fabs(o->slope * g->g1);
    nevh__extended pull = fabs(o->mu * g->g2), e = 1 - o->b * o->r / o->mu;
    e = e * e + o->b * (o->slope / o->mu) * (o->slope / o->mu);
    return !(parts + pull <= most * now && pull * pull <= most * o->r * now) &&
           !(o->b > 0 && e < least_eccentricity * least_eccentricity);
}

/* In place of the old state, by Lagrange's coefficients. */
static void from_start(const orbit *o, const universal *g, nevh__extended now,
                       nevh__extended r[], nevh__extended v[]) {
    for (size_t i = 0; i < NEVH__SPACE; i++) {
        nevh__extended at = r[i], speed = v[i], pull = o->mu * g->g2;
        r[i] += (o->r * g->g1 + o->slope * g->g2) * speed - pull / o->r * at;
        v[i] -= (o->mu * g->g1 / o->r * at + pull * speed) / now;
    }
}

void nevh__kepler_flow(double mu, double t, nevh__extended r[NEVH__SPACE],
                       nevh__extended v[NEVH__SPACE]) {
    orbit o = orbit_of(mu, r, v);
    nevh__extended s = solve_either_way(&o, t);
    universal g = functions(o.b, s);
    nevh__extended now = o.r * g.g0 + o.slope * g.g1 + o.mu * g.g2;
    if (cancels(&o, &g, now))
        from_pericentre(&o, s, r, v);
    else
        from_start(&o, &g, now, r, v);
}
