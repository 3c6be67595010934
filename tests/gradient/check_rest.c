/* nevh tests: orbits that start at rest at 0, in any units, and terms of H that are 0, or
   nearly so.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/reference.h>
#include <nevh/scene.h>
#include <stdio.h>

/* With parameters m, k, f, w near 1 times units. */
static const struct {
    const char *coordinates, *h;
    size_t n;
    bool separable;
} cases[] = {
    {"x = 0", "p_x^2/(2*m) + k*x^2/2 - f*x*cos(0.7*w*t)", 1, true},
    {"x = 0", "p_x^2/(2*m) + k*x^2/2 - f*x*sin(0.7*w*t)", 1, true},
    {"x = 0", "p_x^2/(2*m) - f*x*cos(3*w*t)", 1, true},
    {"x = 0", "p_x^2/(2*m) + k*x^2/2 - f*x", 1, true},
    {"x = 0", "p_x^2/(2*m)*(1 + 0.3*sin(w*t)) + k*x^2/2 - f*x", 1, true},
    {"x = 0", "p_x^2/(2*m) + k*(1 + 0.2*cos(2*w*t))*x^2/2 - f*x*w*t", 1, true},
    {"x = 0\ny = 0",
     "(p_x^2 + 3*p_y^2)/(2*m) + k*(x^2 + (x - y)^2)/2 - f*y*cos(w*t)", 2, true},
    {"x = 0\ny = 0", "((p_x + m*w*y/2)^2 + (p_y - m*w*x/2)^2)/(2*m) - f*x", 2,
     false},
    {"x = 0\ny = 0",
     "(p_x^2 + p_y^2)/(2*m) + w*(y*p_x - x*p_y) + k*(x^2 + y^2) - f*x", 2,
     false},
    {"x[1..6] = 0",
     "sum(i = 1..6, p_x[i]^2)/(2*m) + sum(i = 1..5, (x[i+1] - x[i])^2)*k/2 - "
     "f*x[1]*cos(w*t)",
     6, true},
    /* nearly at rest, in a strong field */
    {"x = 0\ny = 1e-5*f/(m*w^2)",
     "((p_x + m*w*y/2)^2 + (p_y - m*w*x/2)^2)/(2*m) - f*x", 2, false},
    {"x = 1e-7*f/k\ny = 0", "(p_x^2 + p_y^2)/(2*m) + k*(x^2 + x*y + y^2) - f*y",
     2, true},
};
enum { CASES = sizeof cases / sizeof *cases, MOST = 6 };

/* The state of a scene after 200 steps of h. */
static void take_steps(const char *text, const nevh_integrator *scheme,
                       const nevh_gradient *g, double h, double q[],
                       double p[]) {
    nevh_scene *scene = nevh_scene_parse("test", text);
    ck_assert_str_eq(nevh_scene_message(scene), "");
    ck_assert_int_eq(nevh_scene_start(scene, q, p), NEVH_OK);
    nevh_options o = {.gradient = g, .q = q, .p = p};
    nevh_stepper *s = nevh_stepper_new(nevh_scene_system(scene), scheme, &o);
    ck_assert_msg(!nevh_stepper_status(s), "%s", nevh_stepper_message(s));
    for (int i = 0; i < 200; i++)
        ck_assert_msg(nevh_stepper_apply(s, h * i, h, q, p) == NEVH_OK, "%s",
                      nevh_stepper_message(s));
    nevh_stepper_free(s);
    nevh_scene_free(scene);
}

/* The state after 200 steps of a tenth of the unit of time. */
static void follow(int which, const double unit[3], const nevh_gradient *g,
                   double q[], double p[]) {
    double length = unit[0], energy = unit[1], time = unit[2];
    char text[800];
    snprintf(text, sizeof text,
             "[parameters]\nm = %.17g\nk = %.17g\nf = %.17g\nw = %.17g\n"
             "[coordinates]\n%s\n[effects]\nH = %s\n",
             1.3 * energy * time * time / length / length,
             0.9 * energy / length / length, 0.7 * energy / length, 1.1 / time,
             cases[which].coordinates, cases[which].h);
    take_steps(text, cases[which].separable ? nevh_verlet : nevh_gauss4, g,
               0.1 * time, q, p);
}

static void assert_same(int which, const double unit[3],
                        const nevh_gradient *g) {
    double q[2][MOST], p[2][MOST], most[2] = {0};
    follow(which, unit, nevh_exact, q[0], p[0]);
    follow(which, unit, g, q[1], p[1]);
    for (size_t k = 0; k < cases[which].n; k++) {
        most[0] = fmax(most[0], fabs(q[0][k]));
        most[1] = fmax(most[1], fabs(p[0][k]));
    }
    for (size_t k = 0; k < cases[which].n; k++)
        ck_assert_msg(fabs(q[1][k] - q[0][k]) <= 1e-9 * most[0] &&
                          fabs(p[1][k] - p[0][k]) <= 1e-9 * most[1],
                      "%s in %g, %g, %g: %g, %g for %g, %g", cases[which].h,
                      unit[0], unit[1], unit[2], q[1][k], p[1][k], q[0][k],
                      p[0][k]);
}

/* Units of length, energy and time near 1e-30 ... 1e30. */
TEST_EACH(orbits_from_rest_do_not_depend_on_units, CASES) {
    static const int powers[] = {0, -100, -50, -27, 27, 50, 100};
    for (size_t i = 0; i < sizeof powers / sizeof *powers; i++)
        for (int which = 0; which < (i ? 3 : 1); which++) {
            double unit[3] = {1, 1, 1};
            unit[which] = ldexp(1, powers[i]);
            assert_same(_i, unit, nevh_central4);
        }
    assert_same(_i, (const double[]){0x1p-465, 0x1p-930, 1}, nevh_central4);
    assert_same(_i, (const double[]){0x1p-100, 0x1p80, 0x1p-60}, nevh_central8);
    assert_same(_i, (const double[]){0x1p90, 0x1p-80, 0x1p60}, nevh_central2);
}

/* Beside an oscillator: terms that vary nowhere, but overflow, or hardly vary. */
static const char *const vanishing[] = {
    "0*x^4",           "0*x^3",         "0*x",         "0*exp(x)",
    "0*(x^2 + y^2)^2", "0*p_x^4",       "1e-20*x^4",   "1e-30*cos(x)",
    "1e-40*x^4",       "x^2/2 + 0*x^6", "1e-18*exp(y)"};
enum { VANISHING = sizeof vanishing / sizeof *vanishing };

TEST_EACH(terms_that_vanish_change_nothing, 3 * VANISHING) {
    static const nevh_gradient *const *const differences[] = {
        &nevh_central2, &nevh_central4, &nevh_central8};
    char text[400];
    double q[2][2], p[2][2];
    snprintf(text, sizeof text,
             "[coordinates]\nx = 1\ny = 0.5, 0.9\n[effects]\n"
             "K = (p_x^2 + p_y^2)/2\nV = x^2/2 + y^2\nQ = %s\n",
             vanishing[_i / 3]);
    take_steps(text, nevh_verlet, nevh_exact, 0.05, q[0], p[0]);
    take_steps(text, nevh_verlet, *differences[_i % 3], 0.05, q[1], p[1]);
    for (int k = 0; k < 2; k++)
        ck_assert_msg(fabs(q[1][k] - q[0][k]) < 1e-12 &&
                          fabs(p[1][k] - p[0][k]) < 1e-12,
                      "%s: %.17g, %.17g for %.17g, %.17g", vanishing[_i / 3],
                      q[1][k], p[1][k], q[0][k], p[0][k]);
}

/* Starts at rest at 0, or nearly so: fields without a size, orbits that leave as exp(t),
   and H that is straight in a variable. */
static const struct {
    const char *start, *h;
} falls[] = {
    {"x = 0\np_x = 1e-8\ny = 0", "(p_x^2 + p_y^2)/2 + 9.8*y"},
    {"x = 0\np_x = 1e-6\ny = 0", "(p_x^2 + p_y^2)/2 + 9.8*y"},
    {"x = 0\ny = 0", "(p_x^2 + p_y^2)/2 + x + y^2/2 + x*y"},
    {"x = 0\ny = 0", "(p_x^2 + p_y^2)/2 + x*exp(y) + y^2/2"},
    {"x = 0\ny = 0", "(p_x^2 + p_y^2)/2 + x*(2 + y)"},
    {"x = 0\ny = 0", "(p_x^2 + p_y^2)/2 + sin(x) + x*y"},
    {"x = 0\ny = 0.1", "(p_x^2 + p_y^2)/2 + x*cos(y)"},
};
enum { FALLS = sizeof falls / sizeof *falls };

TEST_EACH(falls_from_rest_are_those_of_exact_gradients, FALLS) {
    static const nevh_gradient *const *const differences[] = {&nevh_central2,
                                                              &nevh_central8};
    char text[400];
    double q[2][2], p[2][2];
    snprintf(text, sizeof text, "[coordinates]\n%s\n[effects]\nH = %s\n",
             falls[_i].start, falls[_i].h);
    take_steps(text, nevh_verlet, nevh_exact, 0.005, q[0], p[0]);
    for (size_t i = 0; i < 2; i++) {
        take_steps(text, nevh_verlet, *differences[i], 0.005, q[1], p[1]);
        for (int k = 0; k < 2; k++)
            ck_assert_msg(fabs(q[1][k] - q[0][k]) < 1e-8 &&
                              fabs(p[1][k] - p[0][k]) < 1e-8,
                          "%s: %.17g, %.17g for %.17g, %.17g", falls[_i].h,
                          q[1][k], p[1][k], q[0][k], p[0][k]);
    }
}

/* A momentum whose square underflows, or nearly so. */
TEST(momenta_may_be_nearly_zero) {
    static const double least[] = {1e-150, 1e-155, 1e-163, 1e-170, 1e-250};
    for (size_t i = 0; i < sizeof least / sizeof *least; i++) {
        char text[200];
        double q[2], p[2];
        snprintf(text, sizeof text,
                 "[coordinates]\nx = 1, %g\n[effects]\nK = p_x^2/2\n"
                 "V = x^2/2\n",
                 least[i]);
        take_steps(text, nevh_verlet, nevh_exact, 0.05, &q[0], &p[0]);
        take_steps(text, nevh_verlet, nevh_central2, 0.05, &q[1], &p[1]);
        ck_assert_double_eq_tol(q[1], q[0], 1e-12);
        ck_assert_double_eq_tol(p[1], p[0], 1e-12);
    }
}

/* Angles from 0 in units in which the arguments of waves are all rounding at a first
   guess of 1. */
static const char *const waves[] = {"-cos(x/u)", "-2*cos(x/u) - cos(y/u)",
                                    "-cos(x/u - y/u)*(2 + sin(x/u))",
                                    "2*sin(x/u/2)^2 - 0.3*cos(3*y/u)"};
enum { WAVES = sizeof waves / sizeof *waves };

TEST_EACH(waves_of_any_length, WAVES) {
    static const int powers[] = {-100, -73, -41, -20, 0, 50};
    for (size_t i = 0; i < sizeof powers / sizeof *powers; i++) {
        double q[2][2], p[2][2], u = ldexp(1, powers[i]);
        char text[600];
        snprintf(text, sizeof text,
                 "[parameters]\nu = %.17g\n[coordinates]\nx = 0, 0.9/u\n"
                 "y = 0, 0.4/u\n[effects]\nK = (p_x^2 + p_y^2)*u^2/2\nV = %s\n",
                 u, waves[_i]);
        take_steps(text, nevh_verlet, nevh_exact, 0.05, q[0], p[0]);
        take_steps(text, nevh_verlet, nevh_central4, 0.05, q[1], p[1]);
        for (int k = 0; k < 2; k++)
            ck_assert_msg(fabs(q[1][k] - q[0][k]) < 1e-9 * u &&
                              fabs(p[1][k] - p[0][k]) < 1e-9 / u,
                          "%s, u = %g: %.17g, %.17g for %.17g, %.17g",
                          waves[_i], u, q[1][k], p[1][k], q[0][k], p[0][k]);
    }
}

/* Coordinates that no term connects, one far smaller than the other: both are moved as by
   exact gradients, and each has its own range. */
static const struct {
    const char *start, *v;
} apart[] = {
    {"x = u\ny = 0.7", "x^2/2 + y^2/2"},
    {"x = 0, u\ny = 0.7", "x^2/2 - x*u*cos(0.7*t) + y^4/4"},
    {"x = 0\ny = 0", "x^2/2 - x*u*cos(0.7*t) + y^2/2 - y*cos(0.9*t)"},
    {"x = u\ny = 0", "x^2/2 + y^2/2 - y*cos(0.9*t)"},
    {"x = u\ny = 0, 1", "x^2/2 + 0.1*x^3/u - cos(y)"},
};
enum { APART = sizeof apart / sizeof *apart };

TEST_EACH(uncoupled_coordinates_have_their_sizes, APART) {
    static const double sizes[] = {1e-18, 1e-9, 1e12, 1e20};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        double q[2][2], p[2][2], u = sizes[i];
        char text[400];
        snprintf(text, sizeof text,
                 "[parameters]\nu = %g\n[coordinates]\n%s\n[effects]\n"
                 "K = (p_x^2 + p_y^2)/2\nV = %s\n",
                 u, apart[_i].start, apart[_i].v);
        take_steps(text, nevh_verlet, nevh_exact, 0.05, q[0], p[0]);
        take_steps(text, nevh_verlet, nevh_central4, 0.05, q[1], p[1]);
        for (int k = 0; k < 2; k++)
            ck_assert_msg(fabs(q[1][k] - q[0][k]) < 1e-9 * (k ? 1 : u) &&
                              fabs(p[1][k] - p[0][k]) < 1e-9 * (k ? 1 : u),
                          "%s, u = %g: %.17g, %.17g for %.17g, %.17g",
                          apart[_i].v, u, q[1][k], p[1][k], q[0][k], p[0][k]);
        nevh_scene *scene = nevh_scene_parse("test", text);
        double start[4];
        nevh_scene_start(scene, start, start + 2);
        nevh_reference *r = nevh_reference_new(nevh_scene_system(scene), NULL,
                                               0, 10, start, start + 2);
        ck_assert_double_lt(nevh_reference_range(r, 0), 10 * u);
        ck_assert_double_gt(nevh_reference_range(r, 0), u / 5);
        nevh_reference_free(r);
        nevh_scene_free(scene);
    }
}
