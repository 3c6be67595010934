/* nevh tests: effects of one formula are evaluated together, and nobody sees it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 40, SPRINGS = 90, FAR = 30, WIDEST = 600 };

/* Springs between other bodies and of other numbers each, among which kinetic
   energies stand, then a term of another formula, and springs again; bodies have
   up to six of them. */
static nevh_scene *lattice(void) {
    static char text[40000];
    char *to = text;
    to += sprintf(to,
                  "[coordinates]\nx[i = 1..%d] = sin(i)\n"
                  "[effects]\n",
                  N);
    for (int i = 0; i < SPRINGS + FAR; i++) {
        int a = i % N + 1, b = (7 * i + 3) % N + 1;
        if (i == SPRINGS)
            to += sprintf(to, "cut = cos(x[1] + x[2])\n");
        to += sprintf(to, "s%d = %.17g*(x[%d] - x[%d])^2*cos(t)\n", i,
                      0.3 + 0.01 * (i % 5), a, a == b ? b % N + 1 : b);
        if (i < N)
            to +=
                sprintf(to, "k%d = p_x[%d]^2/%d\n", i, i + 1, 3 + 2 * (i % 3));
    }
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

/* A chain whose springs and wells stand by turns, and then both in no order, some of
   them between bodies far apart. */
static nevh_scene *chain(bool tangled) {
    static char text[40000];
    uint64_t seed = 5;
    char *to = text;
    to += sprintf(to, "[coordinates]\nx[i = 1..%d] = sin(i)\n[effects]\n", N);
    for (int i = 1; i < N; i++) {
        int a = i, b = i + 1;
        bool first = true; /* the spring */
        if (tangled) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            a = (int)(seed >> 40) % N + 1;
            b = a % N + 1 + (int)(seed >> 33) % 2 * (a < N / 2 ? 7 : 0);
            first = seed >> 63;
        }
        for (int part = 0; part < 2; part++)
            to += part == first
                      ? sprintf(to, "w%d = %.17g*x[%d]^4 + p_x[%d]^2/2\n", i,
                                0.2 + 0.01 * (i % 3), a, i)
                      : sprintf(to, "s%d = %.17g*(x[%d] - x[%d])^2*cos(t)\n", i,
                                0.3 + 0.01 * (i % 5), a, b);
    }
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

static nevh_field *field_of(const nevh_system *s, const nevh_gradient *g,
                            size_t width) {
    nevh_options o = {.gradient = g, .gradient_step = 0x1p-8, .width = width};
    nevh_field *f = nevh_field_new(s, &o);
    ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
    return f;
}

static void fill(size_t width, double t[], double q[], double p[]) {
    for (size_t i = 0; i < width; i++)
        t[i] = 0.3 + 0.01 * (double)i;
    for (size_t i = 0; i < N * width; i++) {
        q[i] = sin(1 + 0.7 * (double)i);
        p[i] = cos(2 + 1.3 * (double)i);
    }
}

static const nevh_gradient *const *const gradients[] = {
    &nevh_exact, &nevh_central2, &nevh_central4, &nevh_complex_step};
static const size_t widths[] = {1, 5, 8, WIDEST};
enum { WIDTHS = sizeof widths / sizeof *widths };

/* One effect after another, added up. */
static void take_alone(nevh_scene *s, const nevh_gradient *g, size_t width,
                       const double t[], const double q[], const double p[],
                       double sum[]) {
    const nevh_system *system = nevh_scene_system(s);
    double *slope = calloc(2 * N * width, sizeof *slope);
    size_t count = nevh_system_effect_count(system);
    for (size_t on = 0; on < count; on++) {
        for (size_t i = 0; i < count; i++)
            nevh_scene_enable(s, nevh_system_effect_name(system, i), i == on);
        nevh_field *f = field_of(system, g, width);
        ck_assert_int_eq(
            nevh_field_gradient(f, width, t, q, p, slope, slope + N * width),
            NEVH_OK);
        for (size_t i = 0; i < 2 * N * width; i++)
            sum[i] += slope[i];
        nevh_field_free(f);
    }
    for (size_t i = 0; i < count; i++)
        nevh_scene_enable(s, nevh_system_effect_name(system, i), true);
    free(slope);
}

TEST_EACH(sums_have_the_bits_of_terms_one_by_one,
          3 * WIDTHS * sizeof gradients / sizeof *gradients) {
    const nevh_gradient *g = *gradients[_i / (3 * WIDTHS)];
    size_t width = widths[_i % WIDTHS], size = N * width;
    int form = _i / WIDTHS % 3;
    nevh_scene *s = form == 0 ? lattice() : chain(form == 2);
    double *x = calloc(6 * size + width, sizeof *x), *t = x + 6 * size;
    fill(width, t, x, x + size);
    take_alone(s, g, width, t, x, x + size, x + 2 * size);
    nevh_field *f = field_of(nevh_scene_system(s), g, width);
    ck_assert_int_eq(nevh_field_gradient(f, width, t, x, x + size, x + 4 * size,
                                         x + 5 * size),
                     NEVH_OK);
    for (size_t i = 0; i < 2 * size; i++)
        ck_assert_msg(x[2 * size + i] == x[4 * size + i],
                      "%zu of width %zu: %.17g, not %.17g", i, width,
                      x[4 * size + i], x[2 * size + i]);
    nevh_field_free(f);
    nevh_scene_free(s);
    free(x);
}

/* Springs, kinetic energies, what is between springs, and those after it. */
TEST(neighbours_are_one_piece) {
    nevh_scene *s = lattice();
    nevh_field *f = field_of(nevh_scene_system(s), nevh_exact, 1);
    ck_assert_uint_lt(nevh_field_pieces(f), 8);
    nevh_field_free(f);
    nevh_scene_free(s);
}

/* Springs, wells and kinetic energies. */
TEST(terms_by_turns_are_pieces) {
    nevh_scene *s = chain(false);
    nevh_field *f = field_of(nevh_scene_system(s), nevh_exact, 1);
    ck_assert_uint_eq(nevh_field_pieces(f), 3);
    nevh_field_free(f);
    nevh_scene_free(s);
}

/* As many for each effect as where it is alone. */
TEST(evaluations_are_counted_for_each_effect) {
    nevh_scene *s = lattice();
    double t, q[N], p[N], slope[2 * N];
    fill(1, &t, q, p);
    nevh_field *f = field_of(nevh_scene_system(s), nevh_central4, 1);
    nevh_field_gradient(f, 1, &t, q, p, slope, slope + N);
    uint64_t spring = nevh_field_effect_values(f, "s0");
    ck_assert_uint_gt(spring, 0);
    ck_assert_uint_eq(nevh_field_effect_values(f, "s77"), spring);
    ck_assert_uint_eq(nevh_field_effect_values(f, "s100"), spring);
    ck_assert_uint_eq(nevh_field_effect_values(f, "k3"), 4);
    nevh_field_free(f);
    nevh_scene_free(s);
}

/* Differences of the first lengths, or the orbit, have no value there. */
TEST_EACH(the_effect_that_fails_is_named, 2) {
    static char text[2000];
    char *to = text;
    double t = 0, q[N], p[N] = {0}, slope[2 * N];
    to += sprintf(to, "[coordinates]\nx[1..%d] = 1\n[effects]\n", N);
    for (int i = 0; i < N; i++) {
        to += sprintf(to, "w%d = %d*log(x[%d])\n", i, i + 2, i + 1);
        q[i] = i == 17 ? -1 : 1;
    }
    nevh_scene *s = nevh_scene_parse("test", text);
    nevh_field *f =
        field_of(nevh_scene_system(s), _i ? nevh_central4 : nevh_exact, 1);
    ck_assert_uint_eq(nevh_field_pieces(f), 1);
    ck_assert_int_eq(nevh_field_gradient(f, 1, &t, q, p, slope, slope + N),
                     NEVH_EDOM);
    ck_assert_msg(strstr(nevh_field_message(f), "effect \"w17\"") != NULL, "%s",
                  nevh_field_message(f));
    nevh_field_free(f);
    nevh_scene_free(s);
}

static size_t values_asked;

static double asked(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    values_asked++;
    return q[0] * q[0] + cos(q[1]);
}

static void asked_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        dq[i] = 2 * q[i];
        dq[width + i] = -sin(q[width + i]);
    }
}

static size_t asked_to_plan(const double scale[]) {
    static const size_t which[] = {0, 1};
    static const double q[] = {0.3, 0.4}, p[] = {0.1, 0.2};
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &(nevh_term){.effect = "well",
                                    .name = "well",
                                    .count = 1,
                                    .nq = 2,
                                    .q = which,
                                    .value = asked,
                                    .gradient = asked_gradient});
    nevh_options o = {
        .gradient = nevh_exact, .scale = scale, .q = q, .p = p, .width = 1};
    values_asked = 0;
    nevh_field *f = nevh_field_new(s, &o);
    ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
    nevh_field_free(f);
    nevh_system_free(s);
    return values_asked;
}

/* Planning of exact gradients asks for values to compare with, and for lengths. */
TEST(lengths_that_are_given_are_not_looked_for) {
    static const double scale[] = {1, 1, 1, 1};
    ck_assert_uint_lt(asked_to_plan(scale), asked_to_plan(NULL) / 2);
}
