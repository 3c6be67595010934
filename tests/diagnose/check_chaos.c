/* nevh tests: exponents, alignment indices and MEGNO, where they are known.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "system/system_private.h"
#include <math.h>
#include <nevh/chaos.h>
#include <nevh/scene.h>
#include <stdio.h>

enum { MOST = 4 };

typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    double q[MOST], p[MOST];
    nevh_options options;
    nevh_chaos_options of;
    nevh_chaos *chaos;
} setup;

static void set_up(setup *s, const char *coordinates, const char *rest,
                   const nevh_integrator *scheme, double dt) {
    *s = (setup){.scene = scene_with(coordinates, rest)};
    s->system = nevh_scene_system(s->scene);
    ck_assert_int_eq(nevh_scene_start(s->scene, s->q, s->p), NEVH_OK);
    s->options = (nevh_options){.q = s->q, .p = s->p};
    s->of = (nevh_chaos_options){
        .integrator = scheme, .options = &s->options, .dt = dt};
}

static void run(setup *s, double until) {
    s->chaos = nevh_chaos_new(s->system, &s->of);
    ck_assert_str_eq(nevh_chaos_message(s->chaos), "");
    ck_assert_int_eq(nevh_chaos_run(s->chaos, until), NEVH_OK);
}

static void tear_down(setup *s) {
    nevh_chaos_free(s->chaos);
    nevh_scene_free(s->scene);
}

static double exponent(const setup *s, size_t i) {
    double value = nevh_chaos_exponent(s->chaos, i, NULL);
    ck_assert(isfinite(value));
    return value;
}

static const char henon[] = "kinetic = (p_x^2 + p_y^2)/2\n"
                            "potential = (x^2 + y^2)/2 + x^2*y - y^3/3\n";

/* At energy 1/8. */
static void set_up_henon(setup *s, double y, const nevh_integrator *scheme,
                         double dt) {
    char start[200];
    double kinetic = 0.125 - y * y / 2 + y * y * y / 3;
    snprintf(start, sizeof start, "x = 0\ny = %.17g\np_x = %.17g\np_y = 0", y,
             sqrt(2 * kinetic));
    set_up(s, start, henon, scheme, dt);
}

/* H = p^2/2 - x^2/2 + p_y^2/2 + 2 y^2: a step of Verlet multiplies the unstable
   direction by the larger root of r^2 - (2 + h^2) r + 1, exactly. */
static void saddle(setup *s, const nevh_integrator *scheme) {
    set_up(s, "x = 0\ny = 0.1", "H = (p_x^2 + p_y^2)/2 - x^2/2 + 2*y^2", scheme,
           0.1);
    s->of.starts = 1;
    s->of.exponents = 4;
}

/* Displacements grow by e^1000, and so would those of lanes that only fill up a
   vector. */
TEST_EACH(no_lane_overflows, 2) {
    setup s;
    saddle(&s, nevh_verlet);
    s.of.exponents = _i ? 4 : 1;
    run(&s, 1000);
    ck_assert_double_eq_tol(exponent(&s, 0), 1, 0.01);
    tear_down(&s);
}

TEST(the_saddle_has_the_exponents_of_the_step_not_of_the_flow) {
    setup s;
    double h = 0.1, half = 1 + h * h / 2;
    double expected = log(half + sqrt(half * half - 1)) / h;
    saddle(&s, nevh_verlet);
    run(&s, 200);
    ck_assert(nevh_chaos_is_tangent(s.chaos, NULL));
    ck_assert_double_eq_tol(exponent(&s, 0), expected, 1e-10);
    ck_assert_double_eq_tol(exponent(&s, 3), -expected, 1e-10);
    ck_assert_double_eq_tol(exponent(&s, 1), 0, 0.01);
    ck_assert_double_gt(fabs(exponent(&s, 0) - 1), 1e-5);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_CHAOTIC);
    tear_down(&s);
}

TEST(the_largest_alone_is_that_of_all_exponents) {
    setup s;
    double h = 0.1, half = 1 + h * h / 2;
    double expected = log(half + sqrt(half * half - 1)) / h;
    saddle(&s, nevh_verlet);
    s.of.exponents = 1;
    run(&s, 200);
    ck_assert_double_eq_tol(exponent(&s, 0), expected, 1e-10);
    ck_assert(isnan(nevh_chaos_exponent(s.chaos, 1, NULL)));
    tear_down(&s);
}

/* Where log|w| grows by l t, 2/t int t' dlog|w| is l t, and its mean l t/2.  A
   look that took the time of its beginning or of its end, half a unit away, would
   be off by 0.48. */
TEST(megno_weights_growth_by_the_time_in_the_middle) {
    setup s;
    double h = 0.5, half = 1 + h * h / 2, until = 200;
    double rate = log(half + sqrt(half * half - 1)) / h;
    saddle(&s, nevh_verlet);
    s.of.dt = h;
    s.of.exponents = 1;
    run(&s, until);
    ck_assert_double_eq_tol(exponent(&s, 0), rate, 1e-10);
    ck_assert_double_eq_tol(nevh_chaos_result(s.chaos).megno, rate * until / 2,
                            0.2);
    tear_down(&s);
}

TEST_EACH(differences_and_tangents_agree, 3) {
    const nevh_integrator *scheme[] = {nevh_verlet, nevh_gauss4, nevh_rk4};
    setup a, b;
    for (int i = 0; i < 2; i++) {
        setup *s = i ? &b : &a;
        set_up_henon(s, -0.1, scheme[_i], 0.1);
        s->of.exponents = 4;
        s->of.differences = i;
        run(s, 30);
    }
    const char *why;
    ck_assert(nevh_chaos_is_tangent(a.chaos, &why));
    ck_assert_str_eq(why, "");
    ck_assert(!nevh_chaos_is_tangent(b.chaos, &why));
    assert_says(why, "asked for");
    for (size_t i = 0; i < 4; i++)
        ck_assert_double_eq_tol(exponent(&a, i), exponent(&b, i), 1e-6);
    nevh_chaos_report x = nevh_chaos_result(a.chaos),
                      y = nevh_chaos_result(b.chaos);
    ck_assert_double_eq_tol(x.sali, y.sali, 1e-6);
    ck_assert_double_eq_tol(x.megno, y.megno, 1e-6);
    tear_down(&a);
    tear_down(&b);
}

/* T is no square of p, and reads q. */
TEST(tangents_of_coupled_kinetic_energies_are_those_of_differences) {
    double value[2];
    for (int k = 0; k < 2; k++) {
        setup s;
        set_up(&s, "x = 0.9\ny = -0.4\np_x = 0.7\np_y = 1.1",
               "kinetic = sqrt(1 + p_x^2 + p_x*p_y*cos(x - y) + 2*p_y^2)\n"
               "waves = -cos(x) - 2*cos(y)\n",
               nevh_gauss4, 0.05);
        s.of.differences = k;
        s.of.starts = 1;
        run(&s, 10);
        value[k] = exponent(&s, 0);
        tear_down(&s);
    }
    ck_assert_double_eq_tol(value[0], value[1], 1e-6);
}

/* The sum of the exponents of a symplectic map is 0 at any time, of one that
   keeps no volume it is not. */
TEST(exponents_of_a_symplectic_map_come_in_pairs) {
    setup s;
    set_up_henon(&s, -0.1, nevh_verlet, 0.1);
    s.of.exponents = 4;
    run(&s, 3000);
    double sum = 0;
    for (size_t i = 0; i < 4; i++)
        sum += exponent(&s, i);
    ck_assert_double_eq_tol(sum, 0, 1e-9);
    ck_assert_double_eq_tol(exponent(&s, 0) + exponent(&s, 3), 0, 3e-3);
    ck_assert_double_eq_tol(exponent(&s, 1) + exponent(&s, 2), 0, 3e-3);
    tear_down(&s);
    set_up_henon(&s, -0.1, nevh_euler, 0.01);
    s.of.exponents = 4;
    run(&s, 10);
    sum = 0;
    for (size_t i = 0; i < 4; i++)
        sum += exponent(&s, i);
    ck_assert_double_gt(fabs(sum), 1e-3);
    tear_down(&s);
}

/* dp/dt = -rate p: the exponents add up to -rate for each momentum. */
TEST(friction_is_the_sum_of_the_exponents) {
    setup s;
    set_up(&s, "x = 0.4\ny = 1.2",
           "kinetic = (p_x^2 + p_y^2)/2\n"
           "waves = -cos(x) - cos(y) - 0.5*cos(x - y)\n"
           "[friction]\ndamping = x: 0.3, y: 0.3\n",
           nevh_verlet, 0.05);
    ck_assert(nevh_system_friction(s.system, NULL));
    s.of.exponents = 4;
    run(&s, 30);
    double sum = 0;
    for (size_t i = 0; i < 4; i++)
        sum += exponent(&s, i);
    ck_assert_double_eq_tol(sum, -0.6, 1e-9);
    tear_down(&s);
}

TEST(chaos_and_order_are_told_apart) {
    setup s;
    double error, value;
    set_up_henon(&s, -0.25, nevh_blanes_moan4, 0.2);
    run(&s, 4000);
    value = nevh_chaos_exponent(s.chaos, 0, &error);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_CHAOTIC);
    ck_assert_double_lt(fabs(value - 0.045), 3 * hypot(error, 0.002));
    ck_assert_double_lt(error, 0.01);
    ck_assert_double_lt(nevh_chaos_result(s.chaos).sali, 1e-8);
    tear_down(&s);
    set_up_henon(&s, 0.1, nevh_blanes_moan4, 0.2);
    run(&s, 1000);
    double early = exponent(&s, 0);
    ck_assert_int_eq(nevh_chaos_run(s.chaos, 8000), NEVH_OK);
    value = nevh_chaos_exponent(s.chaos, 0, &error);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_REGULAR);
    ck_assert_double_lt(fabs(value), error);
    ck_assert_double_lt(fabs(value), early / 4);
    ck_assert_double_eq_tol(nevh_chaos_result(s.chaos).megno, 2, 0.2);
    ck_assert_double_gt(nevh_chaos_result(s.chaos).sali, 1e-4);
    tear_down(&s);
}

/* Displacements grow exponentially, and there is no chaos: in a plane, at an
   equilibrium, on an escape, on a periodic orbit among tori.  Of the last two
   no more is asked for than that they are not called chaotic on the way. */
static const struct {
    const char *start, *hamiltonian;
    double until;
    bool certain;
} unstable[] = {
    {"x = pi", "H = p_x^2/2 - cos(x)", 20, true},
    {"x = 0\np_x = 2", "H = p_x^2/2 - cos(x)", 20, true},
    {"x = 0.1", "H = p_x^2/2 - x^2/2", 30, true},
    {"x = 0.1\ny = 0.3", "H = (p_x^2 + p_y^2)/2 - x^2/2 + y^2", 100, true},
    {"x = 1\np_x = 0.3", "H = p_x^2/2 + (1 + 0.4*cos(2*t))*x^2/2", 300, true},
    {"x = 0\ny = 0", "H = (p_x^2 + p_y^2)/2 - cos(x) + cos(y) - cos(x - y)", 60,
     true},
    {"x = 1.414213", "H = p_x^2/2 - x^2/2 + x^4/4", 100, false},
    {"x = 0\ny = 0.7\np_y = 0.3",
     "H = (p_x^2 + p_y^2 - x^2)/2 + x^4/4 + y^4/4 + y^2/2", 100, false},
};

TEST_EACH(instability_is_not_called_chaos, sizeof unstable / sizeof *unstable) {
    setup s;
    set_up(&s, unstable[_i].start, unstable[_i].hamiltonian, nevh_blanes_moan4,
           0.05);
    run(&s, unstable[_i].until);
    nevh_chaos_verdict verdict = nevh_chaos_result(s.chaos).verdict;
    ck_assert_int_ne(verdict, NEVH_CHAOTIC);
    if (unstable[_i].certain)
        ck_assert_int_eq(verdict, NEVH_UNSTABLE_ORBIT);
    tear_down(&s);
}

/* Where the curvature of H vanishes at the start, that is no measure of time. */
TEST(a_start_of_straight_forces_is_like_others) {
    setup s;
    double error, value;
    set_up(&s, "x = pi/2", "H = p_x^2/2 - cos(x)", nevh_blanes_moan4, 0.1);
    run(&s, 3000);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_REGULAR);
    tear_down(&s);
    set_up(&s, "x = pi/2\ny = pi/2",
           "H = (p_x^2 + 2*p_y^2 - 2*p_x*p_y*cos(x - y))/(2*(1 + sin(x - y)^2))"
           " - 9.8*(2*cos(x) + cos(y))",
           nevh_gauss4, 0.04);
    run(&s, 300);
    value = nevh_chaos_exponent(s.chaos, 0, &error);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_CHAOTIC);
    ck_assert_double_lt(fabs(value - 0.92), 2 * hypot(error, 0.015));
    ck_assert_int_eq(nevh_chaos_run(s.chaos, 800), NEVH_OK);
    tear_down(&s);
}

/* Steps that make Kepler's orbit chaotic, by omega dt = 0.5 and more at the
   pericentre, and those that do not.  Finer ones tell, and confirm what is true. */
static const struct {
    const char *start, *hamiltonian, *scheme;
    double dt, until;
    nevh_chaos_verdict steps, confirmed;
} confirmations[] = {
    {"x = 0.03\ny = 0\np_y = sqrt(1.97/0.03)",
     "H = (p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)", "gauss8", 0.0062, 400,
     NEVH_CHAOTIC, NEVH_UNRESOLVED},
    {"x = 0.4\ny = 0\np_y = 2", "H = (p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)",
     "gauss8", 0.05, 1500, NEVH_REGULAR, NEVH_REGULAR},
    {"x = 0\ny = -0.25\np_x = 0.42081",
     "H = (p_x^2 + p_y^2 + x^2 + y^2)/2"
     " + x^2*y - y^3/3",
     "blanes-moan4", 0.2, 3000, NEVH_CHAOTIC, NEVH_CHAOTIC},
};
TEST_EACH(finer_steps_tell_chaos_of_steps,
          sizeof confirmations / sizeof *confirmations) {
    setup s;
    nevh_chaos_confirmation c;
    set_up(&s, confirmations[_i].start, confirmations[_i].hamiltonian,
           nevh_integrator_named(confirmations[_i].scheme),
           confirmations[_i].dt);
    s.of.starts = 4;
    run(&s, confirmations[_i].until);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict,
                     confirmations[_i].steps);
    ck_assert_int_eq(nevh_chaos_confirm(s.chaos, 0, &c), NEVH_OK);
    ck_assert_int_eq(c.verdict, confirmations[_i].confirmed);
    ck_assert_int_eq(c.agrees, c.verdict != NEVH_UNRESOLVED);
    ck_assert_int_ne(c.how, NEVH_FINER_NONE);
    tear_down(&s);
}

/* H itself, by steps of its own: a factor that displacements have once, in a
   saddle or a close pass, or each time anew and back, is no exponent. */
static const struct {
    const char *start, *hamiltonian;
    double until;
    nevh_chaos_verdict verdict;
} findings[] = {
    {"x = 0.001\ny = 0\np_y = sqrt(1.999/0.001)",
     "H = (p_x^2 + p_y^2)/2 - 1/sqrt(x^2 + y^2)", 100, NEVH_EARLY},
    {"x = 1e-6\ny = 1", "H = (p_x^2 - x^2 + p_y^2 + 1.7*y^2)/2 + x^4/4", 150,
     NEVH_EARLY},
    {"x = 1e-6\ny = 1", "H = (p_x^2 - x^2 + p_y^2 + 1.7*y^2)/2 + x^4/4", 14,
     NEVH_EARLY},
    {"x = 0.3\ny = 0.1\np_x = 0.2", "H = (p_x^2 + p_y^2 + x^2 + 1.7*y^2)/2",
     1000, NEVH_REGULAR},
    {"x = 0.3\ny = 1\np_x = 0.2",
     "H = (p_x^2 + 1e6*x^2)/2 + p_y^2/2 + y^4/4 + 0.1*x^2*y^2", 1, NEVH_EARLY},
    {"x = 0\ny = -0.25\np_x = 0.42081",
     "H = (p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3", 2000, NEVH_CHAOTIC},
};
TEST_EACH(chaos_of_h_itself, sizeof findings / sizeof *findings) {
    setup s;
    nevh_chaos_finding f;
    set_up(&s, findings[_i].start, findings[_i].hamiltonian, nevh_verlet, 0.1);
    ck_assert_int_eq(
        nevh_chaos_find(s.system, &s.options, 0, findings[_i].until, 0, &f),
        NEVH_OK);
    ck_assert_msg(f.report.verdict == findings[_i].verdict, "%s: %s, %g +- %g",
                  findings[_i].hamiltonian,
                  nevh_chaos_verdict_name(f.report.verdict), f.exponent,
                  f.error);
    ck_assert_double_eq_tol(f.report.t, findings[_i].until, 1e-9);
    tear_down(&s);
}

/* The slowest motion decides how long a run must be for `regular`, not the
   fastest. */
TEST(slow_motion_is_waited_for) {
    setup s;
    set_up(&s, "x = 0.1\ny = 1\np_y = 0.2",
           "H = (p_x^2 + 1e4*x^2)/2 + p_y^2/2 + y^4/4 + 0.1*x^2*y^2",
           nevh_blanes_moan4, 0.005);
    run(&s, 10);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_EARLY);
    ck_assert_int_eq(nevh_chaos_run(s.chaos, 400), NEVH_OK);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_REGULAR);
    tear_down(&s);
}

TEST(a_short_run_says_nothing) {
    setup s;
    set_up_henon(&s, -0.25, nevh_verlet, 0.1);
    run(&s, 20);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_EARLY);
    tear_down(&s);
}

/* GALI_k of states in the tests of ChaosTools, x = 0. */
TEST_EACH(volumes_fall_in_chaos_alone, 3) {
    static const double states[3][2] = {
        {0.295456, 0.407308431}, {0.483, 0.278980390}, {-0.25, 0.42081}};
    char start[200];
    setup s;
    snprintf(start, sizeof start, "x = 0\ny = %.17g\np_x = %.17g\np_y = 0",
             states[_i][0], states[_i][1]);
    set_up(&s, start, henon, nevh_blanes_moan4, 0.1);
    s.of.deviations = 4;
    s.of.starts = 1;
    run(&s, 1000);
    if (_i < 2) {
        ck_assert_double_gt(nevh_chaos_gali(s.chaos, 2), 0.01);
        ck_assert_double_gt(nevh_chaos_gali(s.chaos, 4), 1e-10);
    } else
        ck_assert_double_lt(nevh_chaos_gali(s.chaos, 2), 1e-12);
    ck_assert(isnan(nevh_chaos_gali(s.chaos, 5)));
    tear_down(&s);
}

TEST(a_run_may_be_cut_and_begun_again) {
    setup a, b;
    set_up_henon(&a, -0.1, nevh_verlet, 0.1);
    set_up_henon(&b, -0.1, nevh_verlet, 0.1);
    run(&a, 100);
    run(&b, 40);
    ck_assert_int_eq(nevh_chaos_restart(b.chaos, b.q, b.p, 0), NEVH_OK);
    ck_assert_int_eq(nevh_chaos_result(b.chaos).verdict, NEVH_EARLY);
    for (double t = 10; t <= 100; t += 10)
        ck_assert_int_eq(nevh_chaos_run(b.chaos, t), NEVH_OK);
    ck_assert_double_eq_tol(exponent(&a, 0), exponent(&b, 0), 1e-9);
    tear_down(&a);
    tear_down(&b);
}

/* Every function of formulas, beside differences of its gradient. */
TEST(tangents_of_all_functions_are_those_of_differences) {
    static const char *const bends[] = {"sin(x)*cos(y)",
                                        "tan(x/3)",
                                        "asin(x/4)*acos(y/4)",
                                        "atan(x) + atan2(x + 3, y + 2)",
                                        "sinh(x/2) + cosh(y/2)",
                                        "tanh(x)*asinh(y)",
                                        "acosh(3 + x) + atanh(y/5)",
                                        "exp(x/2)*log(3 + y)",
                                        "log10(4 + x*y)",
                                        "sqrt(4 + x)*cbrt(5 + y)",
                                        "hypot(x + 3, y)",
                                        "abs(x + 3)*x^2",
                                        "min(x^2, y + 4) + max(y^2, x - 5)",
                                        "(3 + x)^(1 + y/5)",
                                        "mod(x + 7, 20)^2",
                                        "floor(x/9)*y",
                                        "bessel_j0(x + 3)",
                                        "elliptic_k((x + 2)/9)",
                                        "kepler(2 + x, 0.3 + y/9)",
                                        "x^2/(3 + y)"};
    for (size_t i = 0; i < sizeof bends / sizeof *bends; i++) {
        char rest[300];
        double value[2];
        snprintf(rest, sizeof rest,
                 "kinetic = (p_x^2 + p_y^2)/2\nwell = x^2 + 1.5*y^2\n"
                 "bend = 0.2*(%s)\n",
                 bends[i]);
        for (int k = 0; k < 2; k++) {
            setup s;
            set_up(&s, "x = 0.7\ny = 0.4", rest, nevh_verlet, 0.05);
            s.of.differences = k;
            s.of.starts = 1;
            run(&s, 10);
            ck_assert_int_eq(nevh_chaos_is_tangent(s.chaos, NULL), !k);
            value[k] = exponent(&s, 0);
            tear_down(&s);
        }
        ck_assert_msg(fabs(value[0] - value[1]) < 1e-8, "%s: %.12g, %.12g",
                      bends[i], value[0], value[1]);
    }
}

/* The same H as formulas, and in C with derivatives and without. */
TEST(terms_in_c_have_the_tangents_of_formulas) {
    const problem *b = &henon_heiles;
    nevh_system *s = b->make(), *bare = nevh_system_new(b->n);
    nevh_options o = {.q = b->q, .p = b->p};
    double value[3];
    for (size_t i = 0; i < s->n_terms; i++) {
        nevh_term term = s->terms[i]->decl;
        term.name = NULL;
        term.gradient = NULL;
        term.point_gradient = NULL;
        ck_assert_int_eq(nevh_system_add(bare, &term), NEVH_OK);
    }
    for (int i = 0; i < 3; i++) {
        nevh_chaos_options of = {.integrator = nevh_verlet,
                                 .options = &o,
                                 .dt = 0.05,
                                 .starts = 1,
                                 .differences = i == 2};
        nevh_chaos *c = nevh_chaos_new(i == 1 ? bare : s, &of);
        ck_assert_str_eq(nevh_chaos_message(c), "");
        ck_assert_int_eq(nevh_chaos_is_tangent(c, NULL), i < 2);
        ck_assert_int_eq(nevh_chaos_run(c, 20), NEVH_OK);
        value[i] = nevh_chaos_exponent(c, 0, NULL);
        nevh_chaos_free(c);
    }
    ck_assert_double_eq_tol(value[0], value[1], 1e-7);
    ck_assert_double_eq_tol(value[0], value[2], 1e-7);
    nevh_system_free(s);
    nevh_system_free(bare);
}

TEST(what_cannot_be_is_refused) {
    setup s;
    set_up_henon(&s, -0.1, nevh_verlet, 0.1);
    struct {
        nevh_chaos_options of;
        const char *says;
    } cases[] = {
        {{.integrator = NULL, .options = &s.options, .dt = 0.1}, "NULL"},
        {{.integrator = nevh_verlet, .dt = 0.1}, "no state"},
        {{.integrator = nevh_verlet, .options = &s.options}, "step of 0"},
        {{.integrator = nevh_verlet, .options = &s.options, .dt = -INFINITY},
         "step of -inf"},
        {{.integrator = nevh_verlet,
          .options = &s.options,
          .dt = 0.1,
          .exponents = 5},
         "5 exponents, but there are 4"},
        {{.integrator = nevh_verlet,
          .options = &s.options,
          .dt = 0.1,
          .deviations = 1},
         "2 ... 4"},
        {{.integrator = nevh_verlet,
          .options = &s.options,
          .dt = 0.1,
          .starts = 1u << 30},
         "too many"},
        {{.integrator = nevh_adaptive_verlet, .options = &s.options, .dt = 0.1},
         "chooses its steps"},
        {{.integrator = nevh_taylor, .options = &s.options, .dt = 0.1},
         "tolerance"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nevh_chaos *c = nevh_chaos_new(s.system, &cases[i].of);
        ck_assert_int_ne(nevh_chaos_status(c), NEVH_OK);
        assert_says(nevh_chaos_message(c), cases[i].says);
        ck_assert_int_ne(nevh_chaos_run(c, 1), NEVH_OK);
        ck_assert(isnan(nevh_chaos_exponent(c, 0, NULL)));
        nevh_chaos_free(c);
    }
    tear_down(&s);
}

/* Over the saddle and away: the message says when. */
TEST(an_orbit_that_escapes_says_when) {
    setup s;
    set_up(&s, "x = 0.5\ny = 3", henon, nevh_verlet, 0.1);
    s.chaos = nevh_chaos_new(s.system, &s.of);
    ck_assert_str_eq(nevh_chaos_message(s.chaos), "");
    ck_assert_int_ne(nevh_chaos_run(s.chaos, 1000), NEVH_OK);
    ck_assert_str_ne(nevh_chaos_message(s.chaos), "");
    ck_assert_int_ne(nevh_chaos_run(s.chaos, 2000), NEVH_OK);
    ck_assert_int_eq(nevh_chaos_result(s.chaos).verdict, NEVH_EARLY);
    tear_down(&s);
}

TEST(names_of_verdicts) {
    ck_assert_str_eq(nevh_chaos_verdict_name(NEVH_CHAOTIC), "chaotic");
    ck_assert_str_eq(nevh_chaos_verdict_name(NEVH_REGULAR), "regular");
    ck_assert_str_eq(nevh_chaos_verdict_name(NEVH_UNSTABLE_ORBIT), "unstable");
    ck_assert_str_eq(nevh_chaos_verdict_name((nevh_chaos_verdict)9), "unknown");
}
