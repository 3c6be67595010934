/* nevh tests: the motion about a centre.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/kepler_flow_private.h"
#include "support.h"
#include <float.h>
#include <math.h>

typedef struct {
    double mu, t;
    long double r[3], v[3];
} motion;

static void move(motion *x, double t) {
    nevh__kepler_flow(x->mu, t, x->r, x->v);
    for (int i = 0; i < 3; i++) {
        x->r[i] = (double)x->r[i];
        x->v[i] = (double)x->v[i];
    }
}

static double between(uint64_t *random, double low, double high) {
    return low + (nevh__random(random) + 1) / 2 * (high - low);
}

/* e of all sizes, and of 1 by as little as 1e-9. */
static double eccentricity(uint64_t *random, bool repels) {
    double kind = between(random, 0, 1), off = between(random, -9, 0);
    return repels       ? 1 + pow(10, off)
           : kind < 0.3 ? between(random, 0, 1)
           : kind < 0.6 ? 1 - pow(10, off)
           : kind < 0.7 ? 1
           : kind < 0.9 ? 1 + pow(10, off)
                        : 1 + pow(10, between(random, 0, 3));
}

/* On an orbit of eccentricity e, anywhere and in any direction. */
static motion random_motion(uint64_t *random) {
    motion x = {.mu = between(random, 0, 1) < 0.1 ? -1 : 1};
    double e = eccentricity(random, x.mu < 0), a[3], b[3], ab = 0;
    double least = pow(10, between(random, -3, 3));
    double p = least * (e + x.mu), far = 3.14159;
    if (e >= 1)
        far = (1 - 1e-6) * acos(-x.mu / e);
    double angle = between(random, -far, far);
    double distance = p / (e * cos(angle) + x.mu);
    double out = e * sin(angle) / sqrt(p), across = sqrt(p) / distance;
    for (int i = 0; i < 3; i++) {
        a[i] = nevh__random(random);
        b[i] = nevh__random(random);
    }
    double length = hypot(hypot(a[0], a[1]), a[2]);
    for (int i = 0; i < 3; i++)
        ab += (a[i] /= length) * b[i];
    for (int i = 0; i < 3; i++)
        b[i] -= ab * a[i];
    length = hypot(hypot(b[0], b[1]), b[2]);
    for (int i = 0; i < 3; i++) {
        x.r[i] = distance * a[i];
        x.v[i] = out * a[i] + across * b[i] / length;
        x.r[i] = (double)x.r[i];
        x.v[i] = (double)x.v[i];
    }
    x.t = pow(distance, 1.5) * pow(10, between(random, -4, 3));
    x.t = copysign(x.t, nevh__random(random));
    return x;
}

/* Energy and angular momentum, and what their rounding goes by. */
typedef struct {
    long double energy, parts, spin[3], length;
} invariants;

static invariants invariants_of(const motion *x) {
    long double rr = 0, vv = 0;
    invariants a = {0};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        rr += x->r[i] * x->r[i];
        vv += x->v[i] * x->v[i];
        a.spin[i] = x->r[j] * x->v[k] - x->r[k] * x->v[j];
    }
    a.energy = vv / 2 - x->mu / sqrtl(rr);
    a.parts = vv / 2 + 1 / sqrtl(rr);
    a.length = sqrtl(rr * vv);
    return a;
}

static double roundings_between(const motion *x, const motion *y) {
    invariants a = invariants_of(x), b = invariants_of(y);
    long double size = 0;
    for (int i = 0; i < 3; i++)
        size = hypotl(size, b.spin[i] - a.spin[i]);
    long double off = fabsl(b.energy - a.energy) / fmaxl(a.parts, b.parts);
    return (double)fmaxl(off, size / fmaxl(a.length, b.length)) / DBL_EPSILON;
}

static void assert_invariant(int count, uint64_t random) {
    for (int i = 0; i < count; i++) {
        motion x = random_motion(&random), y = x;
        move(&y, x.t);
        ck_assert_double_le(roundings_between(&x, &y), 1.5);
    }
}

TEST(invariants_are_kept) {
    assert_invariant(30000, 1);
}

TEST_TAGGED(invariants_are_kept_by_all, "slow", 0, 100) {
    assert_invariant(100000, (uint64_t)_i + 2);
}

/* Of a = 1 and mu = 1, at the eccentric anomaly: an ellipse, and a hyperbola. */
static motion place(long double e, long double anomaly, long double *mean) {
    motion x = {.mu = 1};
    bool open = e > 1;
    long double c = open ? coshl(anomaly) : cosl(anomaly);
    long double s = open ? sinhl(anomaly) : sinl(anomaly), sign = open ? -1 : 1;
    long double b = sqrtl(fabsl(1 - e * e)), r = sign * (1 - e * c);
    x.r[0] = sign * (c - e);
    x.r[1] = b * s;
    x.v[0] = -s / r;
    x.v[1] = b * c / r;
    *mean = sign * (anomaly - e * s);
    return x;
}

/* Times follow from the equations of Kepler; also over several periods. */
TEST_EACH(orbits_are_known, 6 * 4) {
    static const double all[] = {0, 0.2, 0.9, 0.9999, 1.0001, 7};
    static const double to[] = {-2.5, 0.701, 1.5, 6};
    double e = all[_i / 4];
    long double since, until;
    motion x = place(e, 0.7L, &since), y = place(e, to[_i % 4], &until);
    nevh__kepler_flow(1, (double)(until - since), x.r, x.v);
    for (int i = 0; i < 3; i++) {
        ck_assert_ldouble_eq_tol(x.r[i], y.r[i], 2e-14L * (1 + fabsl(y.r[i])));
        ck_assert_ldouble_eq_tol(x.v[i], y.v[i],
                                 1e-10L * fabsl(y.v[i]) + 2e-14L);
    }
}

/* A parabola of pericentre 1: y^2 = 4 (1 - x), y = 2 d, t = sqrt(2) (d + d^3/3). */
TEST(parabola) {
    motion x = {.mu = 1, .r = {1}, .v = {0, sqrtl(2)}};
    const double d = 1.7;
    nevh__kepler_flow(1, sqrt(2) * (d + d * d * d / 3), x.r, x.v);
    ck_assert_ldouble_eq_tol(x.r[0], 1 - d * d, 1e-14);
    ck_assert_ldouble_eq_tol(x.r[1], 2 * d, 1e-14);
}

/* Through the centre along a line, and back after a period. */
TEST(collision) {
    motion x = {.mu = 1, .r = {1, 2, 2}, .v = {0}};
    const double period = 6.283185307179586477 * pow(1.5, 1.5);
    move(&x, period / 3);
    ck_assert_ldouble_gt(x.r[0], 0);
    ck_assert_ldouble_eq_tol(x.r[1], 2 * x.r[0], 1e-14);
    move(&x, period * 2 / 3);
    ck_assert_ldouble_eq_tol(x.r[0], 1, 1e-13);
    ck_assert_ldouble_eq_tol(x.v[0], 0, 1e-12);
}

/* Nothing is told of what is at the centre, without a force or not finite. */
TEST_EACH(no_motion, 4) {
    static const double mu[] = {1, 1, 1, NAN}, at[] = {0, 1, INFINITY, 1},
                        t[] = {1, INFINITY, 1, 1};
    motion x = {.r = {at[_i]}, .v = {0, 1}};
    nevh__kepler_flow(mu[_i], t[_i], x.r, x.v);
    ck_assert(!isfinite(x.r[0]) || !isfinite(x.v[0]));
}
