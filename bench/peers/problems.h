/* nevh: the problems on which it is measured against its peers, with the
   right-hand sides that a careful user of the peers would write: inline, for C
   and C++ alike.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_BENCH_PROBLEMS_H
#define NEVH_BENCH_PROBLEMS_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BODIES = 6, MOST_N = 3 * BODIES };

/* y: n coordinates, then n momenta. */
typedef struct {
    const char *name, *title;
    size_t n;
    bool separable; /* H = T(p) + V(q) */
    double t_end;
    double size; /* below which errors of tolerances are absolute */
    double start[2 * MOST_N], end[2 * MOST_N]; /* the latter: reference */
    int (*slopes)(double t, const double y[], double dy[], void *unused);
} problem;
extern const problem problems[];
extern const size_t problem_count;

/* The Sun, Jupiter, Saturn, Uranus, Neptune, Pluto, in solar masses; AU and
   days [E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration
   (2006), I.2.4]. */
static const double sun_gravity = 2.95912208286e-4;
static const double sun_masses[BODIES] = {
    1.00000597682,      0.000954786104043,  0.000285583733151,
    0.0000437273164546, 0.0000517759138449, 1 / 1.3e8};

static inline void pendulum_force(const double q[], double f[]) {
    f[0] = -sin(q[0]);
}

static inline void kepler_force(const double q[], double f[]) {
    double square = q[0] * q[0] + q[1] * q[1];
    double factor = -1 / (square * sqrt(square));
    f[0] = factor * q[0];
    f[1] = factor * q[1];
}

static inline void henon_heiles_force(const double q[], double f[]) {
    f[0] = -q[0] - 2 * q[0] * q[1];
    f[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
}

static inline void outer_sun_force(const double q[], double f[]) {
    for (int i = 0; i < 3 * BODIES; i++)
        f[i] = 0;
    for (int i = 1; i < BODIES; i++)
        for (int j = 0; j < i; j++) {
            double x = q[3 * i] - q[3 * j], y = q[3 * i + 1] - q[3 * j + 1];
            double z = q[3 * i + 2] - q[3 * j + 2];
            double square = x * x + y * y + z * z;
            double factor = sun_gravity * sun_masses[i] * sun_masses[j] /
                            (square * sqrt(square));
            f[3 * i] -= factor * x;
            f[3 * i + 1] -= factor * y;
            f[3 * i + 2] -= factor * z;
            f[3 * j] += factor * x;
            f[3 * j + 1] += factor * y;
            f[3 * j + 2] += factor * z;
        }
}

static inline void outer_sun_velocity(const double p[], double v[]) {
    static const double inverse[BODIES] = {
        1 / 1.00000597682,      1 / 0.000954786104043,  1 / 0.000285583733151,
        1 / 0.0000437273164546, 1 / 0.0000517759138449, 1.3e8};
    for (int i = 0; i < 3 * BODIES; i++)
        v[i] = inverse[i / 3] * p[i];
}

static inline void pendulum_velocity(const double p[], double v[]) {
    v[0] = p[0];
}
static inline void kepler_velocity(const double p[], double v[]) {
    v[0] = p[0];
    v[1] = p[1];
}
static inline void henon_heiles_velocity(const double p[], double v[]) {
    v[0] = p[0];
    v[1] = p[1];
}

/* m = l = 1; one sine and cosine of the difference serve both halves. */
static inline void double_pendulum_all(const double y[], double dy[]) {
    const double g = 9.8;
    double s = sin(y[0] - y[1]), c = cos(y[0] - y[1]), root = 1 + s * s;
    double form = y[2] * y[2] + 2 * y[3] * y[3] - 2 * y[2] * y[3] * c;
    double both = s * (y[2] * y[3] - form * c / root) / root;
    dy[0] = (y[2] - y[3] * c) / root;
    dy[1] = (2 * y[3] - y[2] * c) / root;
    dy[2] = -both - 2 * g * sin(y[0]);
    dy[3] = both - g * sin(y[1]);
}
static inline void pendulum_all(const double y[], double dy[]) {
    pendulum_velocity(y + 1, dy);
    pendulum_force(y, dy + 1);
}
static inline void kepler_all(const double y[], double dy[]) {
    kepler_velocity(y + 2, dy);
    kepler_force(y, dy + 2);
}
static inline void henon_heiles_all(const double y[], double dy[]) {
    henon_heiles_velocity(y + 2, dy);
    henon_heiles_force(y, dy + 2);
}
static inline void outer_sun_all(const double y[], double dy[]) {
    outer_sun_velocity(y + 3 * BODIES, dy);
    outer_sun_force(y, dy + 3 * BODIES);
}

/* X(name, n, title); in the order of `problems`. */
#define SEPARABLE_PROBLEMS(X)                                                  \
    X(pendulum, 1)                                                             \
    X(kepler, 2)                                                               \
    X(henon_heiles, 2)                                                         \
    X(outer_sun, 18)
enum { PENDULUM, DOUBLE_PENDULUM, KEPLER, HENON_HEILES, OUTER_SUN, PROBLEMS };

/* The largest difference from the reference state at the end, each in units of
   the range that its variable covers; ranges: 2n. */
double problem_error(const problem *, const double ranges[], const double y[]);

#ifdef __cplusplus
}
#endif
#endif
