/* nevh tests: the modified Hamiltonian is what its scheme keeps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <nevh/shadow.h>

enum { MOST = 2, ROUNDS = 4 };

/* A system by its formulas, and where it starts. */
typedef struct {
    const char *coordinates, *effects;
    double span, longest; /* of time, and step */
} orbit;

static const orbit pendulum = {"phi = 1.4",
                               "kinetic = p_phi^2/2.6\n"
                               "gravity = -2*cos(phi)\n",
                               20, 0.2};
static const orbit henon_heiles_at = {
    "x = 0.1\ny = -0.25\np_x = 0.31\np_y = 0.12",
    "kinetic = (p_x^2 + p_y^2)/2\n"
    "potential = (x^2 + y^2)/2 + x^2*y - y^3/3\n",
    40, 0.2};
static const orbit double_pendulum_at = {
    "phi1 = 0.9\nphi2 = 0.4",
    "kinetic = (p_phi1^2 + 2*p_phi2^2 - 2*p_phi1*p_phi2*cos(phi1 - phi2))"
    " / (2*(1 + sin(phi1 - phi2)^2))\n"
    "gravity = -9.8*(2*cos(phi1) + cos(phi2))\n",
    10, 0.04};
static const orbit relativistic_at = {"x = 0.5\ny = 0.2\np_x = 0.6\np_y = 0.9",
                                      "kinetic = sqrt(1 + p_x^2 + p_y^2)\n"
                                      "wells = -2*cos(x + y) - cos(y)\n",
                                      20, 0.2};

typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    double q[MOST], p[MOST];
    nevh_options options;
} setup;

static void set_up(setup *s, const char *coordinates, const char *rest) {
    *s = (setup){.scene = scene_with(coordinates, rest)};
    s->system = nevh_scene_system(s->scene);
    ck_assert_int_eq(nevh_scene_start(s->scene, s->q, s->p), NEVH_OK);
    s->options = (nevh_options){.q = s->q, .p = s->p, .gradient = nevh_exact};
}

static void tear_down(setup *s) {
    nevh_scene_free(s->scene);
}

/* Of a run of steps of h by a scheme until `span`, from the start, against the
   shadow of `of`. */
static nevh_shadow_report run_of(const setup *s, const nevh_integrator *of,
                                 const nevh_integrator *scheme, double h,
                                 double span) {
    double q[MOST], p[MOST];
    memcpy(q, s->q, sizeof q);
    memcpy(p, s->p, sizeof p);
    nevh_shadow *shadow = nevh_shadow_new(s->system, of, h, &s->options);
    ck_assert_str_eq(nevh_shadow_message(shadow), "");
    nevh_stepper *stepper = nevh_stepper_new(s->system, scheme, &s->options);
    ck_assert_str_eq(nevh_stepper_message(stepper), "");
    nevh_observer observer = {nevh_shadow_observe, shadow, 1};
    ck_assert_int_eq(nevh_run_until(stepper, 0, h, span, q, p, &observer, 1),
                     NEVH_OK);
    nevh_shadow_report r = nevh_shadow_result(shadow);
    nevh_stepper_free(stepper);
    nevh_shadow_free(shadow);
    return r;
}

static nevh_shadow_report run(const setup *s, const nevh_integrator *scheme,
                              double h, double span) {
    return run_of(s, scheme, scheme, h, span);
}

typedef struct {
    double energy, shadow; /* slopes */
    nevh_shadow_report finest;
} slopes;

static slopes measure(const orbit *o, const nevh_integrator *of,
                      const nevh_integrator *scheme) {
    double x[ROUNDS], energy[ROUNDS], shadow[ROUNDS];
    slopes measured;
    setup s;
    set_up(&s, o->coordinates, o->effects);
    for (int i = 0; i < ROUNDS; i++) {
        double h = o->longest / (1 << i);
        measured.finest = run_of(&s, of, scheme, h, o->span);
        x[i] = log(h);
        energy[i] = log(measured.finest.energy);
        shadow[i] = log(measured.finest.shadow);
    }
    measured.energy = slope_through(ROUNDS, x, energy);
    measured.shadow = slope_through(ROUNDS, x, shadow);
    tear_down(&s);
    return measured;
}

/* The remainder of the series is what is left: with any of its coefficients
   wrong the slope would be that of H. */
static void assert_slopes(const orbit *o, const nevh_integrator *scheme,
                          double of_energy, double of_shadow) {
    slopes is = measure(o, scheme, scheme);
    ck_assert_double_eq_tol(is.energy, of_energy, 0.15);
    ck_assert_double_eq_tol(is.shadow, of_shadow, 0.2);
    ck_assert(!is.finest.breaks_down);
}

TEST_EACH(shadow_of_the_midpoint_rule_has_slope_four, 4) {
    const orbit *const of[] = {&pendulum, &henon_heiles_at, &double_pendulum_at,
                               &relativistic_at};
    assert_slopes(of[_i], nevh_midpoint, 2, 4);
}

TEST_EACH(shadow_of_verlet_has_slope_four_in_both_orders, 6) {
    const orbit *const of[] = {&pendulum, &henon_heiles_at, &relativistic_at};
    assert_slopes(of[_i / 2], _i % 2 ? nevh_position_verlet : nevh_verlet, 2,
                  4);
}

TEST_EACH(shadow_of_general_verlet_has_slope_four, 3) {
    const orbit *const of[] = {&henon_heiles_at, &double_pendulum_at,
                               &relativistic_at};
    assert_slopes(of[_i], nevh_lobatto2, 2, 4);
}

TEST_EACH(shadow_of_symplectic_euler_has_slope_three, 6) {
    const orbit *const of[] = {&pendulum, &henon_heiles_at, &relativistic_at};
    assert_slopes(of[_i / 2],
                  _i % 2 ? nevh_symplectic_euler_b : nevh_symplectic_euler_a, 1,
                  3);
}

/* A hundred times flatter than H, at steps of a fiftieth of the fastest turn. */
TEST_EACH(shadow_is_a_hundred_times_flatter_than_energy, 4) {
    const orbit *const of[] = {&pendulum, &henon_heiles_at, &double_pendulum_at,
                               &pendulum};
    const double h[] = {0.05, 0.1, 0.01, 0.05};
    setup s;
    set_up(&s, of[_i]->coordinates, of[_i]->effects);
    nevh_shadow_report r =
        run(&s, _i < 3 ? nevh_midpoint : nevh_verlet, h[_i], 1000 * h[_i]);
    ck_assert_uint_eq(r.samples, 1001);
    ck_assert_double_gt(r.energy, 100 * r.shadow);
    ck_assert_double_gt(r.correction, r.shadow);
    ck_assert(!r.breaks_down);
    tear_down(&s);
}

/* (p^2 + q^2)/2 at one state, where all is known. */
TEST(shadow_of_the_oscillator_is_known) {
    static const struct {
        const nevh_integrator *const *scheme;
        double d, a, b;
    } of[] = {{&nevh_verlet, 0, 1. / 12, -1. / 24},
              {&nevh_position_verlet, 0, -1. / 24, 1. / 12},
              {&nevh_midpoint, 0, -1. / 24, -1. / 24},
              {&nevh_symplectic_euler_a, -1. / 2, 1. / 12, 1. / 12},
              {&nevh_symplectic_euler_b, 1. / 2, 1. / 12, 1. / 12}};
    double q = 0.6, p = 1.5, h = 0.3, energy, value;
    setup s;
    set_up(&s, "x = 0", "H = p_x^2/2 + x^2/2");
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        nevh_shadow *shadow =
            nevh_shadow_new(s.system, *of[i].scheme, h, &s.options);
        ck_assert_int_eq(nevh_shadow_order(shadow), of[i].d == 0 ? 4 : 3);
        ck_assert_int_eq(nevh_shadow_value(shadow, &q, &p, &energy, &value),
                         NEVH_OK);
        ck_assert_double_eq_tol(energy, (p * p + q * q) / 2, 1e-15);
        ck_assert_double_eq_tol(value,
                                energy + h * of[i].d * p * q +
                                    h * h * (of[i].a * p * p + of[i].b * q * q),
                                1e-15);
        nevh_shadow_free(shadow);
    }
    tear_down(&s);
}

/* Of one function in C, by differences of its values. */
static double henon(double t, const double q[], const double p[],
                    const void *params) {
    (void)t, (void)params;
    return (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1]) / 2 +
           q[0] * q[0] * q[1] - q[1] * q[1] * q[1] / 3;
}

TEST(shadow_from_values_alone_is_that_of_formulas) {
    setup s;
    set_up(&s, henon_heiles_at.coordinates, henon_heiles_at.effects);
    nevh_system *own = nevh_system_from(2, henon, NULL);
    nevh_options o = {.q = s.q, .p = s.p};
    nevh_shadow *a = nevh_shadow_new(s.system, nevh_verlet, 0.1, &o),
                *b = nevh_shadow_new(own, nevh_verlet, 0.1, &o);
    double energy, first, second;
    ck_assert_str_eq(nevh_shadow_message(b), "");
    ck_assert_int_eq(nevh_shadow_value(a, s.q, s.p, &energy, &first), NEVH_OK);
    ck_assert_int_eq(nevh_shadow_value(b, s.q, s.p, NULL, &second), NEVH_OK);
    ck_assert_double_eq_tol(first, second, 1e-11);
    ck_assert_double_gt(fabs(first - energy), 1e-5);
    nevh_shadow_free(a);
    nevh_shadow_free(b);
    nevh_system_free(own);
    tear_down(&s);
}

/* At a fifth of a turn there is nothing left of it. */
TEST(shadow_breaks_down_at_large_steps) {
    setup s;
    set_up(&s, pendulum.coordinates, pendulum.effects);
    ck_assert(!run(&s, nevh_verlet, 0.2, 40).breaks_down);
    nevh_shadow_report r = run(&s, nevh_verlet, 1.4, 140);
    ck_assert(r.breaks_down);
    ck_assert_double_gt(r.shadow, r.energy / 4);
    tear_down(&s);
}

/* The midpoint rule keeps a quadratic H: both are level, but for rounding. */
TEST(shadow_does_not_break_down_at_rounding) {
    setup s;
    set_up(&s, "x = 1.1", "H = p_x^2/2 + 3*x^2/2");
    nevh_shadow_report r = run(&s, nevh_midpoint, 0.25, 50);
    ck_assert_double_lt(r.shadow, r.rounding);
    ck_assert(!r.breaks_down);
    ck_assert_double_gt(r.correction, 1e-3);
    tear_down(&s);
}

/* Steps of other schemes do not keep it: of second order their shadows differ
   from it by h^2, and those of RK4 keep H itself better. */
TEST_EACH(runs_of_others_do_not_keep_the_shadow, 3) {
    const nevh_integrator *const others[] = {nevh_verlet, nevh_rk4,
                                             nevh_gauss4};
    slopes is = measure(&pendulum, nevh_midpoint, others[_i]);
    ck_assert_double_eq_tol(is.shadow, 2, 0.2);
    ck_assert(is.finest.breaks_down);
}

/* A shorter step to the end has another shadow. */
TEST(a_shorter_last_step_does_not_count) {
    setup s;
    set_up(&s, pendulum.coordinates, pendulum.effects);
    nevh_shadow_report whole = run(&s, nevh_verlet, 0.1, 5),
                       more = run(&s, nevh_verlet, 0.1, 5.03);
    ck_assert_uint_eq(whole.samples, 51);
    ck_assert_uint_eq(more.samples, 51);
    ck_assert_double_eq_tol(more.shadow, whole.shadow, 1e-15);
    tear_down(&s);
}

static void assert_refused(const nevh_system *s, const nevh_integrator *scheme,
                           double h, const nevh_options *o, int status,
                           const char *word) {
    nevh_shadow *shadow = nevh_shadow_new(s, scheme, h, o);
    double q[MOST] = {0.1, 0.1}, p[MOST] = {0}, value;
    ck_assert_int_eq(nevh_shadow_status(shadow), status);
    assert_says(nevh_shadow_message(shadow), word);
    ck_assert_int_eq(nevh_shadow_order(shadow), 0);
    ck_assert_int_eq(nevh_shadow_value(shadow, q, p, NULL, &value), status);
    ck_assert_int_eq(nevh_shadow_observe(shadow, 0, 0, q, p), status);
    ck_assert_uint_eq(nevh_shadow_result(shadow).samples, 0);
    nevh_shadow_free(shadow);
}

TEST(refusals_of_the_shadow_say_why) {
    setup s, driven;
    set_up(&s, pendulum.coordinates, pendulum.effects);
    const nevh_options *o = &s.options;
    assert_refused(s.system, nevh_rk4, 0.1, o, NEVH_ESTRUCT, "not for rk4");
    assert_refused(s.system, NULL, 0.1, o, NEVH_EINVAL, "NULL");
    assert_refused(s.system, nevh_verlet, 0, o, NEVH_EINVAL, "step of 0");
    assert_refused(s.system, nevh_verlet, NAN, o, NEVH_EINVAL, "step of");
    nevh_options timed = s.options;
    timed.transform = s.system;
    assert_refused(s.system, nevh_midpoint, 0.1, &timed, NEVH_ESTRUCT,
                   "transform of time");
    set_up(&driven, "x = 0.1", "kinetic = p_x^2/2\nshaking = x^2*cos(t)");
    assert_refused(driven.system, nevh_verlet, 0.1, &driven.options,
                   NEVH_ESTRUCT, "\"shaking\" changes with t");
    tear_down(&driven);
    set_up(&driven, "x = 0.1",
           "kinetic = p_x^2/2\nspring = x^2\n[friction]\ndrag = x: 0.1");
    assert_refused(driven.system, nevh_verlet, 0.1, &driven.options,
                   NEVH_ESTRUCT, "friction");
    tear_down(&driven);
    tear_down(&s);
}

/* Where H is not finite. */
TEST(shadow_of_no_value_is_an_error) {
    setup s;
    set_up(&s, "x = 0.5", "kinetic = p_x^2/2\nwell = log(x)");
    nevh_shadow *shadow =
        nevh_shadow_new(s.system, nevh_verlet, 0.1, &s.options);
    double q = -1, p = 0, value;
    ck_assert_int_eq(nevh_shadow_value(shadow, &q, &p, NULL, &value),
                     NEVH_EDOM);
    ck_assert_int_eq(nevh_shadow_status(shadow), NEVH_EDOM);
    q = 0.5;
    ck_assert_int_eq(nevh_shadow_value(shadow, &q, &p, NULL, &value), NEVH_OK);
    ck_assert_str_eq(nevh_shadow_message(shadow), "");
    nevh_shadow_free(shadow);
    tear_down(&s);
}

TEST(shadow_of_nothing) {
    double x = 0;
    ck_assert_ptr_null(nevh_shadow_new(NULL, nevh_verlet, 0.1, NULL));
    ck_assert_int_eq(nevh_shadow_status(NULL), NEVH_ENOMEM);
    ck_assert_str_eq(nevh_shadow_message(NULL), "out of memory");
    ck_assert_int_eq(nevh_shadow_order(NULL), 0);
    ck_assert_int_eq(nevh_shadow_value(NULL, &x, &x, NULL, NULL), NEVH_EINVAL);
    ck_assert_int_eq(nevh_shadow_observe(NULL, 0, 0, &x, &x), NEVH_EINVAL);
    ck_assert_uint_eq(nevh_shadow_result(NULL).samples, 0);
    nevh_shadow_free(NULL);
}
