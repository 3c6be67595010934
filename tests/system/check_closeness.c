/* nevh tests: the ready choices of s, by formulas and differences.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/transform.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 12, WIDTH = 5 };

/* A power of the distance (bodies 0), or of the closeness. */
typedef struct {
    size_t n, count, bodies, dimensions;
    double power;
} choice;

static const choice choices[] = {
    {1, 1, 0, 0, 1},   {2, 2, 0, 0, 1.5},    {3, 2, 0, 0, 0.5},
    {4, 3, 0, 0, -2},  {12, 12, 0, 0, 3},    {2, 0, 2, 1, 1},
    {6, 0, 3, 2, 1.5}, {12, 0, 4, 3, 2},     {6, 0, 2, 3, -1},
    {12, 0, 12, 1, 1}, {10, 0, 5, 2, 0.3333}};
enum { CHOICES = sizeof choices / sizeof *choices };

static nevh_system *make(const choice *a) {
    return a->bodies ? nevh_closeness_power(a->bodies, a->dimensions, a->power)
                     : nevh_distance_power(a->n, a->count, a->power);
}

static nevh_field *field_of(const nevh_system *s, const nevh_options *o) {
    nevh_field *f = nevh_field_new(s, o);
    ck_assert_msg(nevh_field_status(f) == NEVH_OK, "%s", nevh_field_message(f));
    return f;
}

/* Spread points, no two bodies alike. */
static void spread(const choice *a, double size, double q[]) {
    for (size_t k = 0; k < a->n; k++)
        q[k] = size * (sin(1 + 2.3 * (double)k) + 0.3 * (double)k);
}

static long double separation(const choice *a, const double q[], size_t i,
                              size_t j) {
    long double sum = 0;
    for (size_t k = 0; k < a->dimensions; k++) {
        long double d =
            (long double)q[i * a->dimensions + k] - q[j * a->dimensions + k];
        sum += d * d;
    }
    return sum;
}

/* |q|^power, or (sum of 1/r^2)^(-power/2); ds = its gradient. */
static long double formula(const choice *a, const double q[],
                           long double ds[]) {
    long double sum = 0;
    for (size_t k = 0; k < a->n; k++)
        ds[k] = 0;
    if (!a->bodies) {
        for (size_t k = 0; k < a->count; k++)
            sum += (long double)q[k] * q[k];
        for (size_t k = 0; k < a->count; k++)
            ds[k] = a->power * powl(sum, a->power / 2 - 1) * q[k];
        return powl(sum, a->power / 2);
    }
    for (size_t i = 0; i < a->bodies; i++)
        for (size_t j = i + 1; j < a->bodies; j++)
            sum += 1 / separation(a, q, i, j);
    long double slope = a->power * powl(sum, -a->power / 2 - 1);
    for (size_t i = 0; i < a->bodies; i++)
        for (size_t j = 0; j < a->bodies; j++)
            for (size_t k = 0; j != i && k < a->dimensions; k++) {
                size_t at = i * a->dimensions + k, to = j * a->dimensions + k;
                long double r2 = separation(a, q, i, j);
                ds[at] += slope * ((long double)q[at] - q[to]) / (r2 * r2);
            }
    return powl(sum, -a->power / 2);
}

static void assert_close(const char *what, double found, double expected,
                         double size) {
    ck_assert_msg(fabs(found - expected) <= 1e-13 * size, "%s: %g, not %g",
                  what, found, expected);
}

/* From 1e-20 to 1e20. */
TEST_EACH(values_and_gradients, CHOICES) {
    const choice *a = &choices[_i];
    nevh_system *s = make(a);
    for (double size = 1e-20; size < 1e21; size *= 1e5) {
        double q[MOST], p[MOST] = {0}, dq[MOST], dp[MOST], value, t = 0;
        long double ds[MOST];
        spread(a, size, q);
        nevh_options o = {.gradient = nevh_exact, .q = q};
        nevh_field *f = field_of(s, &o);
        ck_assert_int_eq(nevh_field_value(f, 1, &t, q, p, &value), NEVH_OK);
        ck_assert_int_eq(nevh_field_gradient(f, 1, &t, q, p, dq, dp), NEVH_OK);
        double expected = (double)formula(a, q, ds), most = 0;
        assert_close("s", value, expected, expected);
        for (size_t k = 0; k < a->n; k++)
            most = fmax(most, fabs((double)ds[k]));
        for (size_t k = 0; k < a->n; k++) {
            assert_close("ds/dq", dq[k], (double)ds[k], most);
            ck_assert(dp[k] == 0);
        }
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

/* Which is not how the formula above was found. */
TEST_EACH(gradients_by_differences, CHOICES) {
    const choice *a = &choices[_i];
    nevh_system *s = make(a);
    double q[MOST], p[MOST] = {0}, exact[MOST], other[MOST], t = 0, most = 0;
    spread(a, 1, q);
    for (int i = 0; i < 2; i++) {
        nevh_options o = {.gradient = i ? nevh_central8 : nevh_exact, .q = q};
        nevh_field *f = field_of(s, &o);
        ck_assert_int_eq(
            nevh_field_gradient(f, 1, &t, q, p, i ? other : exact, NULL), 0);
        nevh_field_free(f);
    }
    for (size_t k = 0; k < a->n; k++)
        most = fmax(most, fabs(exact[k]));
    for (size_t k = 0; k < a->n; k++)
        ck_assert_double_eq_tol(exact[k], other[k], 1e-10 * most);
    nevh_system_free(s);
}

/* A lane is what it is alone. */
TEST_EACH(lanes, CHOICES) {
    const choice *a = &choices[_i];
    nevh_system *s = make(a);
    double q[MOST * WIDTH], p[MOST * WIDTH] = {0}, dq[MOST * WIDTH], h[WIDTH];
    double t[WIDTH] = {0}, start[MOST];
    spread(a, 1, start);
    nevh_options o = {.gradient = nevh_exact, .q = start};
    nevh_field *f = field_of(s, &o);
    for (size_t i = 0; i < a->n * WIDTH; i++)
        q[i] = start[i / WIDTH] * (1 + 0.1 * (double)(i % WIDTH));
    nevh_field_value(f, WIDTH, t, q, p, h);
    nevh_field_gradient(f, WIDTH, t, q, p, dq, NULL);
    for (size_t lane = 0; lane < WIDTH; lane++) {
        double x[MOST], dx[MOST], value;
        for (size_t k = 0; k < a->n; k++)
            x[k] = q[k * WIDTH + lane];
        nevh_field_value(f, 1, t, x, p, &value);
        nevh_field_gradient(f, 1, t, x, p, dx, NULL);
        ck_assert(value == h[lane]);
        for (size_t k = 0; k < a->n; k++)
            ck_assert(dx[k] == dq[k * WIDTH + lane]);
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

/* Two bodies: a power of their distance, whatever their places. */
TEST(two_bodies) {
    nevh_system *s = nevh_closeness_power(2, 3, 1.5);
    double q[] = {1, -2, 0.5, 4, 2, 0.5}, p[6] = {0}, t = 0, value;
    nevh_field *f = field_of(s, &(nevh_options){.q = q});
    nevh_field_value(f, 1, &t, q, p, &value);
    ck_assert_double_eq_tol(value, pow(5, 1.5), 1e-14);
    nevh_field_free(f);
    nevh_system_free(s);
}

/* Neither is smooth at q = 0, where a plan without a state looks around, over
   lengths that H has given. */
TEST_EACH(planned_without_a_state, CHOICES) {
    double scale[2 * MOST];
    nevh_system *s = make(&choices[_i]);
    for (size_t k = 0; k < 2 * MOST; k++)
        scale[k] = 1;
    nevh_options o = {.gradient = nevh_exact, .scale = scale};
    nevh_field_free(field_of(s, &o));
    nevh_system_free(s);
}

TEST(refusals) {
    nevh_system *refused[] = {nevh_distance_power(3, 0, 1),
                              nevh_distance_power(3, 4, 1),
                              nevh_distance_power(0, 0, 1),
                              nevh_distance_power(SIZE_MAX, SIZE_MAX, 1),
                              nevh_closeness_power(0, 3, 1),
                              nevh_closeness_power(1, 3, 1),
                              nevh_closeness_power(2, 0, 1),
                              nevh_closeness_power(SIZE_MAX / 2 + 2, 2, 1),
                              nevh_closeness_power(2, SIZE_MAX / 2 + 2, 1)};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        ck_assert_msg(nevh_system_status(refused[i]) == NEVH_EINVAL, "%zu", i);
        ck_assert(strlen(nevh_system_message(refused[i])) > 20);
        nevh_system_free(refused[i]);
    }
}
