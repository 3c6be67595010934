/* nevh: ready choices of s for the time transform.
   SPDX-License-Identifier: GPL-3.0-or-later

   Both are powers of a sum over a term's coordinates; the constants of the
   instance say which: the power, and the coordinates of a body. */
#include <nevh/simd.h>
#include <math.h>
#include <nevh/transform.h>
#include <stdint.h>

static double distance_squared(size_t width, const double q[], size_t count) {
    double sum = 0;
    for (size_t k = 0; k < count; k++)
        sum += q[k * width] * q[k * width];
    return sum;
}

static void distance_block(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double h[]) {
    (void)t, (void)p, (void)params;
    for (size_t i = 0; i < width; i++) {
        size_t count = (size_t)c[width + i];
        h[i] = nevh_simd_pow(distance_squared(width, q + i, count), c[i] / 2);
    }
}

static void distance_gradient(size_t width, const double t[], const double q[],
                              const double p[], const double c[],
                              const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        size_t count = (size_t)c[width + i];
        double sum = distance_squared(width, q + i, count);
        double slope = c[i] * nevh_simd_pow(sum, c[i] / 2 - 1);
        for (size_t k = 0; k < count; k++)
            dq[k * width + i] = slope * q[k * width + i];
    }
}

nevh_system *nevh_distance_power(size_t n, size_t count, double power) {
    nevh_system *s = nevh_system_new(n);
    const double c[] = {power, (double)count};
    if (s)
        nevh_system_add(s, &(nevh_term){.effect = "distance",
                                        .nq = count ? count : n + 1,
                                        .nc = 2,
                                        .c = c,
                                        .block = distance_block,
                                        .gradient = distance_gradient});
    return s;
}

/* The bodies of one column: `bodies` of `dimensions` coordinates each. */
typedef struct {
    size_t width, bodies, dimensions;
    const double *q;
} column;

static double pair_squared(const column *b, size_t i, size_t j) {
    double sum = 0;
    for (size_t k = 0; k < b->dimensions; k++) {
        double d = b->q[(i * b->dimensions + k) * b->width] -
                   b->q[(j * b->dimensions + k) * b->width];
        sum += d * d;
    }
    return sum;
}

static double closeness_closeness(const column *b) {
    double sum = 0;
    for (size_t i = 0; i < b->bodies; i++)
        for (size_t j = 0; j < i; j++)
            sum += 1 / pair_squared(b, i, j);
    return sum;
}

static column column_at(size_t width, const double q[], const double c[],
                        size_t i) {
    return (column){width, (size_t)c[width + i], (size_t)c[2 * width + i],
                    q + i};
}

static void closeness_block(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double h[]) {
    (void)t, (void)p, (void)params;
    for (size_t i = 0; i < width; i++) {
        column b = column_at(width, q, c, i);
        h[i] = nevh_simd_pow(closeness_closeness(&b), -c[i] / 2);
    }
}

/* Adds what one pair contributes to the gradient of closeness, times slope. */
static void add_pair(const column *b, size_t i, size_t j, double slope,
                     double dq[]) {
    double squared = pair_squared(b, i, j);
    for (size_t k = 0; k < b->dimensions; k++) {
        size_t at_i = (i * b->dimensions + k) * b->width;
        size_t at_j = (j * b->dimensions + k) * b->width;
        double one = -2 * slope * (b->q[at_i] - b->q[at_j]) / squared / squared;
        dq[at_i] += one;
        dq[at_j] -= one;
    }
}

static void closeness_gradient(size_t width, const double t[], const double q[],
                               const double p[], const double c[],
                               const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        column b = column_at(width, q, c, i);
        double slope =
            -c[i] / 2 * nevh_simd_pow(closeness_closeness(&b), -c[i] / 2 - 1);
        for (size_t k = 0; k < b.bodies * b.dimensions; k++)
            dq[k * width + i] = 0;
        for (size_t j = 0; j < b.bodies; j++)
            for (size_t k = 0; k < j; k++)
                add_pair(&b, j, k, slope, dq + i);
    }
}

nevh_system *nevh_closeness_power(size_t bodies, size_t dimensions,
                                  double power) {
    bool sane = bodies > 1 && dimensions <= SIZE_MAX / bodies;
    size_t n = sane ? bodies * dimensions : 0;
    nevh_system *s = nevh_system_new(n);
    const double c[] = {power, (double)bodies, (double)dimensions};
    if (s)
        nevh_system_add(s, &(nevh_term){.effect = "closeness",
                                        .nq = n,
                                        .nc = 3,
                                        .c = c,
                                        .block = closeness_block,
                                        .gradient = closeness_gradient});
    return s;
}
