/* nevh tests: problems.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define EACH(lane) for (size_t lane = 0; lane < width; lane++)

double mass_kinetic(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return p[0] * p[0] / (2 * c[0]);
}

double plane_kinetic(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return (p[0] * p[0] + p[1] * p[1]) / 2;
}

void plane_kinetic_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)c, (void)params, (void)dq;
    for (size_t i = 0; dp && i < 2 * width; i++)
        dp[i] = p[i];
}

void mass_kinetic_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)params, (void)dq;
    if (dp)
        EACH(i) dp[i] = p[i] / c[i];
}

double wave_value(double t, const double q[], const double p[],
                  const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    return -c[0] * cos(q[0]);
}

void wave_gradient(size_t width, const double t[], const double q[],
                   const double p[], const double c[], const void *params,
                   double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = c[i] * sin(q[i]);
}

void add_waves(nevh_system *s, size_t count, const size_t *at) {
    static const double c[] = {1.25, 0.75, 2.5};
    ck_assert(!nevh_system_add(s, &(nevh_term){.effect = "waves",
                                               .nq = 1,
                                               .nc = 1,
                                               .q = at,
                                               .c = c,
                                               .count = count,
                                               .value = wave_value,
                                               .gradient = wave_gradient}));
}

static const double unequal_masses[] = {1.3, 2.1};

void add_kinetic(nevh_system *s, size_t n, const double masses[]) {
    size_t *momenta = calloc(n, sizeof *momenta);
    for (size_t i = 0; i < n; i++)
        momenta[i] = i;
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .p = momenta,
                                    .c = masses,
                                    .count = n,
                                    .value = mass_kinetic,
                                    .gradient = mass_kinetic_gradient});
    free(momenta);
}

static nevh_system *with_potential(size_t n, bool time, nevh_term_fn value,
                                   nevh_block_gradient_fn gradient) {
    nevh_system *s = nevh_system_new(n);
    add_kinetic(s, n, unequal_masses);
    nevh_system_add(s, &(nevh_term){.effect = "potential",
                                    .nq = n,
                                    .time = time,
                                    .value = value,
                                    .gradient = gradient});
    return s;
}

/* A pendulum whose gravity is shaken: time must be right in every stage. */
double driven_value(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)p, (void)c, (void)params;
    return -(2 + 0.7 * sin(1.9 * t)) * cos(q[0]);
}

void driven_gradient(size_t width, const double t[], const double q[],
                     const double p[], const double c[], const void *params,
                     double dq[], double dp[]) {
    (void)p, (void)c, (void)params, (void)dp;
    if (dq)
        EACH(i) dq[i] = (2 + 0.7 * sin(1.9 * t[i])) * sin(q[i]);
}

static nevh_system *make_driven(void) {
    return with_potential(1, true, driven_value, driven_gradient);
}

double gravity_value(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    return -c[0] / sqrt(q[0] * q[0] + q[1] * q[1]);
}

/* The cube of r may be out of range where the slope is not. */
void gravity_gradient(size_t width, const double t[], const double q[],
                      const double p[], const double c[], const void *params,
                      double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    const double *x = q, *y = q + width;
    if (dq)
        EACH(i) {
            double r = sqrt(x[i] * x[i] + y[i] * y[i]);
            dq[i] = c[i] / r / r * (x[i] / r);
            dq[width + i] = c[i] / r / r * (y[i] / r);
        }
}

nevh_system *gravity_system(const double masses[2], double pull) {
    nevh_system *s = nevh_system_new(2);
    add_kinetic(s, 2, masses);
    nevh_system_add(s, &(nevh_term){.effect = "gravity",
                                    .nq = 2,
                                    .nc = 1,
                                    .c = &pull,
                                    .value = gravity_value,
                                    .gradient = gravity_gradient});
    return s;
}

static nevh_system *make_kepler(void) {
    return gravity_system(unequal_masses, 1.3);
}

static double henon(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    double x = q[0], y = q[1];
    return (x * x + y * y) / 2 + x * x * y - y * y * y / 3;
}

static void henon_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    const double *x = q, *y = q + width;
    if (dq)
        EACH(i) {
            dq[i] = x[i] + 2 * x[i] * y[i];
            dq[width + i] = y[i] + x[i] * x[i] - y[i] * y[i];
        }
}

static nevh_system *make_henon_heiles(void) {
    return with_potential(2, false, henon, henon_gradient);
}

/* A T that is neither quadratic nor a sum over the coordinates. */
static double fast(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return sqrt(1.5 + p[0] * p[0] + 0.6 * p[0] * p[1] + p[1] * p[1]);
}

static void fast_gradient(size_t width, const double t[], const double q[],
                          const double p[], const double c[],
                          const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)c, (void)params, (void)dq;
    const double *x = p, *y = p + width;
    if (dp)
        EACH(i) {
            double root =
                sqrt(1.5 + x[i] * x[i] + 0.6 * x[i] * y[i] + y[i] * y[i]);
            dp[i] = (x[i] + 0.3 * y[i]) / root;
            dp[width + i] = (0.3 * x[i] + y[i]) / root;
        }
}

static nevh_system *make_relativistic(void) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 2,
                                    .value = fast,
                                    .gradient = fast_gradient});
    nevh_system_add(s, &(nevh_term){.effect = "potential",
                                    .nq = 2,
                                    .value = henon,
                                    .gradient = henon_gradient});
    return s;
}

static nevh_system *make_double_pendulum(void) {
    static const nevh_double_pendulum params = {1.2, 0.9, 9.8};
    return nevh_double_pendulum_model->system(&params);
}

const problem driven_pendulum = {
    .name = "driven pendulum",
    .n = 1,
    .separable = true,
    .quadratic = true,
    .t0 = 0.3,
    .span = 10,
    .fewest = 5,
    .q = {0.9},
    .p = {0.3},
    .make = make_driven,
};
const problem kepler = {
    .name = "Kepler",
    .n = 2,
    .separable = true,
    .quadratic = true,
    .span = 5,
    .fewest = 6,
    .q = {0.7, 0.1},
    .p = {0.1, 1.6},
    .make = make_kepler,
};
const problem henon_heiles = {
    .name = "Henon-Heiles",
    .n = 2,
    .separable = true,
    .quadratic = true,
    .span = 24,
    .fewest = 8,
    .q = {0.31, -0.22},
    .p = {0.27, 0.33},
    .make = make_henon_heiles,
};
const problem relativistic = {
    .name = "relativistic",
    .n = 2,
    .separable = true,
    .span = 10,
    .fewest = 5,
    .q = {0.21, -0.12},
    .p = {0.35, 0.22},
    .make = make_relativistic,
};
const problem double_pendulum = {
    .name = "double pendulum",
    .n = 2,
    .span = 3,
    .fewest = 8,
    .q = {0.5, 0.9},
    .p = {1.2, 0.4},
    .make = make_double_pendulum,
};
const problem *const problems[] = {&driven_pendulum, &kepler,
                                   &henon_heiles,    &relativistic,
                                   &double_pendulum, NULL};

nevh_scene *scene_with(const char *coordinates, const char *rest) {
    char text[2000];
    snprintf(text, sizeof text, "[coordinates]\n%s\n[effects]\n%s\n",
             coordinates, rest);
    nevh_scene *scene = nevh_scene_parse("test", text);
    ck_assert_str_eq(nevh_scene_message(scene), "");
    return scene;
}
