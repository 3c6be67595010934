/* nevh tests: dH/dt by differences, in any unit of time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <string.h>

/* u is the unit, the numbers are those of a
   pendulum of frequency about 1. */
typedef struct {
    double u;
    double (*f)(double x); /* of t/u */
} clockwork;

static double wave(double x) {
    return cos(1.7 * x);
}
static double wave_slope(double x) {
    return -1.7 * sin(1.7 * x);
}
static double ramp(double x) {
    return 3 - 0.2 * x;
}
static double ramp_slope(double x) {
    (void)x;
    return -0.2;
}
static double parabola(double x) {
    return 0.3 * x * x - x;
}
static double parabola_slope(double x) {
    return 0.6 * x - 1;
}
static double pulse(double x) {
    return exp(-(x - 3) * (x - 3));
}
static double pulse_slope(double x) {
    return -2 * (x - 3) * pulse(x);
}
static double overtone(double x) {
    return sin(x) + 0.1 * sin(37 * x);
}
static double overtone_slope(double x) {
    return cos(x) + 3.7 * cos(37 * x);
}
/* A difference over a whole number sees nothing, nor does one from its top. */
static double tick(double x) {
    return cos(2 * 3.14159265358979323846 * x);
}
static double tick_slope(double x) {
    return -2 * 3.14159265358979323846 * sin(2 * 3.14159265358979323846 * x);
}
static double fixed(double x) {
    (void)x;
    return 5;
}
static double zero(double x) {
    (void)x;
    return 0;
}
static const struct {
    double (*f)(double), (*slope)(double);
} clocks[] = {{wave, wave_slope},
              {ramp, ramp_slope},
              {parabola, parabola_slope},
              {pulse, pulse_slope},
              {overtone, overtone_slope},
              {tick, tick_slope},
              {fixed, zero}};
enum { CLOCKS = sizeof clocks / sizeof *clocks };

static double by_clock(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    const clockwork *w = params;
    (void)p;
    return c[0] * w->f(t / w->u) * q[0] / (w->u * w->u);
}

static double still(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    const clockwork *w = params;
    (void)t, (void)p, (void)c;
    return -cos(q[0]) / (w->u * w->u);
}

static double half_square(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2;
}

static void assert_slope(size_t kind, double u, double from) {
    const clockwork w = {u, clocks[kind].f};
    const double constants[] = {1, 0.5, -0.25};
    const size_t one[] = {0, 0, 0};
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(
        s, &(nevh_term){.effect = "kinetic", .np = 1, .value = half_square});
    nevh_system_add(
        s, &(nevh_term){
               .effect = "gravity", .nq = 1, .value = still, .params = &w});
    nevh_system_add(s, &(nevh_term){.effect = "clock",
                                    .nq = 1,
                                    .nc = 1,
                                    .q = one,
                                    .c = constants,
                                    .count = 3,
                                    .time = true,
                                    .value = by_clock,
                                    .params = &w});
    double q = 0.9, p = 0.3 / u, worst = 0, size = 0;
    nevh_options o = {.t = from * u, .q = &q, .p = &p};
    nevh_field *f = nevh_field_new(s, &o);
    nevh__time_step steps[3];
    memset(steps, 0, sizeof steps);
    ck_assert_int_eq(nevh__field_plan_time(f, &o, steps), NEVH_OK);
    ck_assert(!steps[0].method && !steps[1].method && steps[2].method);
    for (int i = 0; i < 200; i++) {
        double x = from + 0.0713 * i, t = x * u, slope = 0;
        double exact = 1.25 * clocks[kind].slope(x) * q / u / u / u;
        ck_assert_int_eq(
            nevh__field_time_slope(f, 2, &steps[2], 1, &t, &q, &p, &slope),
            NEVH_OK);
        worst = fmax(worst, fabs(slope - exact));
        size = fmax(size, fabs(exact));
    }
    ck_assert_msg(worst <= 1e-11 * size, "clock %zu, unit %g, from %g: %.1e",
                  kind, u, from, worst / size);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST_EACH(time_derivative, 3) {
    const double units[] = {1, 1e-15, 1e12};
    for (size_t kind = 0; kind < CLOCKS; kind++) {
        assert_slope(kind, units[_i], 0);
        assert_slope(kind, units[_i], 2.3);
        assert_slope(kind, units[_i], -0.7);
    }
}

/* dH/dt of a formula of x = 2 and t; NAN where it cannot be told. */
static double slope_of(const char *formula, double t0, double t) {
    char text[300];
    double q = 2, p = 0, slope = 0;
    snprintf(text, sizeof text,
             "[coordinates]\nx = 2\n[effects]\nK = p_x^2/2\nV = %s\n", formula);
    nevh_scene *scene = nevh_scene_parse("test", text);
    ck_assert_str_eq(nevh_scene_message(scene), "");
    nevh_options o = {.t = t0, .q = &q, .p = &p};
    nevh_field *f = nevh_field_new(nevh_scene_system(scene), &o);
    nevh__time_step steps[8] = {0};
    ck_assert_int_eq(nevh__field_plan_time(f, &o, steps), NEVH_OK);
    for (size_t i = 0; i < f->n_terms; i++)
        if (steps[i].method &&
            nevh__field_time_slope(f, i, &steps[i], 1, &t, &q, &p, &slope))
            slope = NAN;
    nevh_field_free(f);
    nevh_scene_free(scene);
    return slope;
}

static const struct {
    const char *formula;
    double t, slope;
} formulas[] = {
    {"x*cos(3*t)^2", 0.4, -2 * 3 * 0.67546318055115095},
    {"x*t^1.5", 0, 0},
    {"x*t^1.5", 4, 6},
    {"x^2*exp(-t/2)", 0, -2},
    {"sin(x)*t^3 - t/x + abs(t - 7)", 1, 3 * 0.90929742682568170 - 1.5},
    {"sum(i = 1..3, x*t^i)", 2, 2 * (1 + 4 + 12)},
};
enum { FORMULAS = sizeof formulas / sizeof *formulas };

/* Formulas know it to rounding, also where H ends: t^1.5 has no t < 0. */
TEST_EACH(formulas_know_their_time_derivative, FORMULAS) {
    double t = formulas[_i].t, slope = formulas[_i].slope;
    ck_assert_double_eq_tol(slope_of(formulas[_i].formula, t, t), slope,
                            4e-15 * fmax(1, fabs(slope)));
}

/* Where it is infinite a difference on the side where H is does; it is finite,
   but not the derivative.  Where there is neither side there is none. */
TEST(infinite_time_derivatives) {
    double slope = slope_of("x*sqrt(t)", 0, 0);
    ck_assert(isfinite(slope));
    ck_assert_double_gt(slope, 1);
    ck_assert_double_lt(slope_of("x*sqrt(-t)", 0, 0), -1);
    ck_assert_double_eq_tol(slope_of("x*sqrt(t)", 0, 4), 0.5, 1e-14);
    ck_assert(isnan(slope_of("x*sqrt(t)", 1, -1)));
}

static double ends_term(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    (void)c, (void)params;
    return (p[0] * p[0] + q[0] * q[0]) / 2 + q[0] * t * t * sqrt(t);
}

/* A function that knows no derivative: to the side where it has values. */
TEST(differences_to_one_side) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(
        s,
        &(nevh_term){
            .effect = "H", .nq = 1, .np = 1, .time = true, .value = ends_term});
    double q = 2, p = 0.5, slope = 0, t = 0;
    nevh_options o = {.q = &q, .p = &p};
    nevh_field *f = nevh_field_new(s, &o);
    nevh__time_step step = {0};
    ck_assert_int_eq(nevh__field_plan_time(f, &o, &step), NEVH_OK);
    ck_assert_int_eq(nevh__field_time_slope(f, 0, &step, 1, &t, &q, &p, &slope),
                     NEVH_OK);
    ck_assert_double_lt(fabs(slope), 0.1); /* 0, by differences of t^2.5 */
    t = -1;
    ck_assert_int_eq(nevh__field_time_slope(f, 0, &step, 1, &t, &q, &p, &slope),
                     NEVH_EDOM);
    ck_assert_ptr_nonnull(strstr(nevh_field_message(f), "time derivative"));
    nevh_field_free(f);
    nevh_system_free(s);
}
