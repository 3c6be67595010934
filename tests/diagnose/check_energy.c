/* nevh tests: the energy observer.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <string.h>

/* H = q: what is shown to the observer is the series of energies itself. */
static double coordinate(double t, const double q[], const double p[],
                         const void *params) {
    (void)t, (void)p, (void)params;
    return q[0];
}

enum { SAMPLES = 20000 };

/* The report on H0 = 1 with errors from `error`. */
static nevh_energy_report report_on(double (*error)(double), double dt) {
    nevh_system *s = nevh_system_from(1, coordinate, NULL);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    double p = 0;
    for (size_t i = 0; i <= SAMPLES; i++) {
        double t = 5 + (double)i * dt, q = 1 + (i ? error(t - 5) : 0);
        ck_assert_int_eq(nevh_energy_observe(energy, i, t, &q, &p), NEVH_OK);
    }
    nevh_energy_report r = nevh_energy_result(energy, 0);
    nevh_energy_free(energy);
    nevh_system_free(s);
    return r;
}

static double steady(double t) {
    return 3e-6 * t;
}
static double steady_loss_with_ripple(double t) {
    return -3e-6 * t + 5e-4 * sin(7 * t);
}
static double ripple(double t) {
    return 1e-3 * sin(3 * t) * sin(0.013 * t);
}
static double explosion(double t) {
    return exp(0.1 * (t - 150));
}

/* As rounding errors pile up: with the root of time, in no direction. */
static double walk(double t) {
    return 1e-9 * sqrt(t) * sin(3 * t) * cos(0.05 * t);
}

TEST(slope_of_a_line) {
    nevh_energy_report r = report_on(steady, 0.01);
    ck_assert_double_eq_tol(r.drift, 3e-6, 1e-12);
    ck_assert_double_eq_tol(r.max, 6e-4, 1e-12);
    ck_assert_double_eq_tol(r.final, 6e-4, 1e-12);
    ck_assert_double_eq_tol(r.rms, 6e-4 / sqrt(3), 1e-7);
    ck_assert_double_gt(r.straightness, 0.999);
    ck_assert_uint_eq(r.samples, SAMPLES + 1);
    ck_assert_double_eq(r.initial, 1);
    ck_assert_double_eq(r.scale, 1);
    r = report_on(steady, -0.01); /* backwards */
    ck_assert_double_eq_tol(r.drift, 3e-6, 1e-12);
}

TEST(verdicts) {
    ck_assert_int_eq(report_on(steady, 0.01).verdict, NEVH_DRIFTS);
    ck_assert_int_eq(report_on(steady_loss_with_ripple, 0.1).verdict,
                     NEVH_DRIFTS);
    ck_assert_int_eq(report_on(ripple, 0.1).verdict, NEVH_BOUNDED);
    ck_assert_int_eq(report_on(explosion, 0.01).verdict, NEVH_UNSTABLE);
    ck_assert_int_eq(report_on(walk, 0.1).verdict, NEVH_RANDOM_WALK);
    ck_assert_str_eq(nevh_verdict_name(NEVH_RANDOM_WALK), "random-walk");
    ck_assert_str_eq(nevh_verdict_name((nevh_verdict)17), "unknown");
}

/* H = T + V + constant with H0 as the parameters say. */
typedef struct {
    double kinetic, potential, constant;
} parts;

static double kinetic(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)c;
    return ((const parts *)params)->kinetic * p[0];
}
static double potential(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    (void)t, (void)p, (void)c;
    return ((const parts *)params)->potential * q[0];
}
static double constant(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)t, (void)q, (void)p, (void)c;
    return ((const parts *)params)->constant;
}

static nevh_energy_report scale_of(parts h) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(
        s, &(nevh_term){
               .effect = "kinetic", .np = 1, .value = kinetic, .params = &h});
    nevh_system_add(s, &(nevh_term){.effect = "potential",
                                    .nq = 1,
                                    .value = potential,
                                    .params = &h});
    nevh_system_add(
        s,
        &(nevh_term){.effect = "potential", .value = constant, .params = &h});
    nevh_energy *energy = nevh_energy_new(s, NULL);
    double q = 1, p = 1;
    ck_assert_int_eq(nevh_energy_observe(energy, 0, 0, &q, &p), NEVH_OK);
    nevh_energy_report r = nevh_energy_result(energy, 0);
    nevh_energy_free(energy);
    nevh_system_free(s);
    return r;
}

TEST(scale_rule) {
    nevh_energy_report r = scale_of((parts){3, -5, 0});
    ck_assert_double_eq(r.scale, 2);
    ck_assert_double_eq(r.initial, -2);
    r = scale_of((parts){3, -5, 1e6}); /* what reads nothing is left out */
    ck_assert_double_eq(r.scale, 2);
    ck_assert_double_eq(r.initial, 1e6 - 2);
    r = scale_of((parts){3, -3, 0}); /* cancelled: the largest effect */
    ck_assert_double_eq(r.scale, 3);
    r = scale_of((parts){3, -3.000001, 0});
    ck_assert_double_eq(r.scale, 3.000001);
    r = scale_of((parts){3, -3.00001, 0});
    ck_assert_double_eq_tol(r.scale, 1e-5, 1e-14);
    r = scale_of((parts){0, 0, 0});
    ck_assert_double_eq(r.scale, 1);
}

/* One observation, at the start. */
static double scale_of_scene(const char *coordinates, const char *effects) {
    nevh_scene *scene = scene_with(coordinates, effects);
    double q[4], p[4];
    ck_assert_int_eq(nevh_scene_start(scene, q, p), NEVH_OK);
    nevh_energy *e = nevh_energy_new(nevh_scene_system(scene), NULL);
    ck_assert_int_eq(nevh_energy_observe(e, 0, 0, q, p), NEVH_OK);
    double scale = nevh_energy_result(e, 0).scale;
    nevh_energy_free(e);
    nevh_scene_free(scene);
    return scale;
}

/* From rest at 0 the energies are those of the motion: scenes in pairs that move
   alike. */
static const struct {
    const char *coordinates[2], *effects[2];
    double least, most;
} motions[] = {
    {{"x = 0", "x = 0"},
     {"H = p_x^2/2 + x^2/2\nD = -1e-6*x*cos(1.3*t)",
      "H = p_x^2/2 + 2*sin(x/2)^2\nD = -1e-6*x*cos(1.3*t)"},
     1e-12,
     2e-11},
};

TEST_EACH(scale_is_of_the_motion, sizeof motions / sizeof *motions) {
    double one =
        scale_of_scene(motions[_i].coordinates[0], motions[_i].effects[0]);
    double other =
        scale_of_scene(motions[_i].coordinates[1], motions[_i].effects[1]);
    ck_assert_double_gt(one, motions[_i].least);
    ck_assert_double_lt(one, motions[_i].most);
    ck_assert_double_eq_tol(one, other, 0.1 * one);
}

/* Large motions keep |H0|. */
TEST(scale_of_large_motions) {
    ck_assert_double_eq(
        scale_of_scene("x = 1\ny = 0, 1",
                       "T = (p_x^2 + p_y^2)/2\nV = -1/sqrt(x^2 + y^2)"),
        0.5);
    ck_assert_double_eq_tol(scale_of_scene("x = 1", "H = p_x^2/2 - cos(x)"),
                            cos(1), 1e-15);
}

/* A scale that is given replaces the one that is found; none but a positive
   number is taken. */
TEST(given_scale) {
    nevh_system *s = nevh_system_from(1, coordinate, NULL);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    double p = 0, first = 1, second = 1.5;
    ck_assert_int_eq(nevh_energy_set_scale(energy, 4), NEVH_OK);
    nevh_energy_observe(energy, 0, 0, &first, &p);
    nevh_energy_observe(energy, 1, 1, &second, &p);
    ck_assert_double_eq(nevh_energy_result(energy, 0).scale, 4);
    ck_assert_double_eq(nevh_energy_result(energy, 0).final, 0.125);
    nevh_energy_free(energy);
    const double wrong[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        energy = nevh_energy_new(s, NULL);
        ck_assert_int_eq(nevh_energy_set_scale(energy, wrong[i]), NEVH_EINVAL);
        ck_assert_ptr_nonnull(strstr(nevh_energy_message(energy), "scale"));
        nevh_energy_free(energy);
    }
    nevh_system_free(s);
}

/* Each lane has its own series. */
TEST(lanes) {
    nevh_system *s = nevh_system_from(1, coordinate, NULL);
    nevh_energy *energy = nevh_energy_new(s, &(nevh_options){.width = 2});
    double p[2] = {0, 0}, first[2] = {1, 4}, second[2] = {1.5, 3};
    nevh_energy_observe(energy, 0, 0, first, p);
    nevh_energy_observe(energy, 1, 1, second, p);
    ck_assert_double_eq(nevh_energy_result(energy, 0).final, 0.5);
    ck_assert_double_eq(nevh_energy_result(energy, 1).final, -0.25);
    ck_assert_uint_eq(nevh_energy_result(energy, 2).samples, 0);
    nevh_energy_free(energy);
    nevh_system_free(s);
}

static double root(double t, const double q[], const double p[],
                   const void *params) {
    (void)t, (void)p, (void)params;
    return sqrt(q[0]);
}

TEST(failures) {
    nevh_system *s = nevh_system_from(1, root, NULL);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    double good = 4, bad = -1, p = 0;
    ck_assert_uint_eq(nevh_energy_result(energy, 0).samples, 0);
    ck_assert_int_eq(nevh_energy_observe(energy, 0, 0, &good, &p), NEVH_OK);
    ck_assert_int_eq(nevh_energy_observe(energy, 1, 1, &bad, &p), NEVH_EDOM);
    ck_assert_int_eq(nevh_energy_status(energy), NEVH_EDOM);
    ck_assert_ptr_nonnull(strstr(nevh_energy_message(energy), "\"H\""));
    ck_assert_double_eq(nevh_energy_result(energy, 0).max, 0);
    nevh_energy_free(energy);
    nevh_system_free(s);
    nevh_system *none = nevh_system_new(0);
    energy = nevh_energy_new(none, NULL);
    ck_assert_int_eq(nevh_energy_status(energy), NEVH_EINVAL);
    nevh_energy_free(energy);
    nevh_energy_free(NULL);
    nevh_system_free(none);
}

/* Effects switched after the observer was made are noticed. */
TEST(stale) {
    nevh_system *s = henon_heiles.make();
    nevh_energy *energy = nevh_energy_new(s, NULL);
    nevh_system_enable(s, "potential", false);
    ck_assert_int_eq(
        nevh_energy_observe(energy, 0, 0, henon_heiles.q, henon_heiles.p),
        NEVH_ESTALE);
    nevh_energy_free(energy);
    nevh_system_free(s);
}
