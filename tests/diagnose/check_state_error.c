/* nevh tests: state errors: of arrays, by variable, and far from t = 0.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <string.h>

enum { MOST = 64 };

typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    size_t n, kind[MOST];
    double q[MOST], p[MOST];
    nevh_reference *reference;
} setup;

static setup set_up(const char *text) {
    setup s = {.scene = nevh_scene_parse("test", text)};
    ck_assert_str_eq(nevh_scene_message(s.scene), "");
    s.system = nevh_scene_system(s.scene);
    s.n = nevh_scene_dof(s.scene);
    ck_assert_uint_le(s.n, MOST);
    nevh_scene_start(s.scene, s.q, s.p);
    for (size_t k = 0; k < s.n; k++)
        s.kind[k] = nevh_scene_array(s.scene, k);
    return s;
}

static void refer(setup *s, bool kinds, double t0, double t1) {
    nevh_reference_options o = {.kind = kinds ? s->kind : NULL};
    s->reference = nevh_reference_with(s->system, &o, t0, t1, s->q, s->p);
    ck_assert_str_eq(nevh_reference_message(s->reference), "");
}

static void tear_down(setup *s) {
    nevh_reference_free(s->reference);
    nevh_scene_free(s->scene);
}

/* Watches a run; the caller frees what it saw. */
static nevh_state_error *watch(const setup *s, const nevh_integrator *scheme,
                               bool follow, double t0, double t1, double h) {
    double q[MOST], p[MOST];
    nevh_options o = {.gradient = nevh_exact, .t = t0, .q = s->q, .p = s->p};
    nevh_stepper *stepper = nevh_stepper_new(s->system, scheme, &o);
    nevh_state_error *error = nevh_state_error_new(s->reference);
    if (follow)
        nevh_state_error_follow(error, stepper);
    memcpy(q, s->q, sizeof q);
    memcpy(p, s->p, sizeof p);
    ck_assert_int_eq(
        nevh_run_until(stepper, t0, h, t1, q, p,
                       &(nevh_observer){nevh_state_error_observe, error, 1}, 1),
        NEVH_OK);
    nevh_stepper_free(stepper);
    return error;
}

static double error_of_run(const setup *s, const nevh_integrator *scheme,
                           bool follow, double t0, double t1, double h) {
    nevh_state_error *e = watch(s, scheme, follow, t0, t1, h);
    double result = nevh_state_error_result(e);
    nevh_state_error_free(e);
    return result;
}

/* H does not read t: the orbit is the same to the bit, and so is its error,
   with whole steps or a shorter last one. */
static const double beginnings[] = {-7.3, 2460000, 1e9, 1e12};
TEST_EACH(errors_late_on_the_clock, sizeof beginnings / sizeof *beginnings) {
    static const char duffing[] =
        "[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x^2/2 + x^4/4\n";
    static const double h[] = {0.05, 0.0513};
    double t0 = beginnings[_i];
    for (int i = 0; i < 2; i++) {
        setup zero = set_up(duffing), late = set_up(duffing);
        refer(&zero, false, 0, 10);
        refer(&late, false, t0, t0 + 10);
        double error = error_of_run(&zero, nevh_gauss8, true, 0, 10, h[i]);
        ck_assert_double_lt(error, 1e-13);
        ck_assert_double_lt(
            error_of_run(&late, nevh_gauss8, true, t0, t0 + 10, h[i]), 1e-13);
        tear_down(&zero);
        tear_down(&late);
    }
}

/* At the times as they are rounded it is not; and a scheme's own error stays
   what it is. */
TEST(rounded_times_are_other_times) {
    setup s = set_up(
        "[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x^2/2 + x^4/4\n");
    refer(&s, false, 1e9, 1e9 + 10);
    double by_clock = error_of_run(&s, nevh_gauss8, false, 1e9, 1e9 + 10, 0.05);
    ck_assert_double_gt(by_clock, 1e-9);
    double verlet = error_of_run(&s, nevh_verlet, true, 1e9, 1e9 + 10, 0.05);
    tear_down(&s);
    s = set_up(
        "[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x^2/2 + x^4/4\n");
    refer(&s, false, 0, 10);
    ck_assert_double_eq_tol(
        verlet, error_of_run(&s, nevh_verlet, true, 0, 10, 0.05), 1e-9);
    ck_assert_double_gt(verlet, 1e-3);
    tear_down(&s);
}

TEST(arrays_of_a_scene) {
    setup s = set_up("[coordinates]\na = 1\nx[1..3] = 0\nb = 2\ny[1..2] = 1\n"
                     "[effects]\nK = p_a^2/2 + p_b^2/2\n");
    const size_t first[] = {0, 1, 1, 1, 4, 5, 5, 7};
    for (size_t k = 0; k < 8; k++)
        ck_assert_uint_eq(nevh_scene_array(s.scene, k), first[k]);
    ck_assert_uint_eq(nevh_scene_array(NULL, 3), 3);
    nevh_scene_free(s.scene);
}

static const char wave[] =
    "[parameters]\nN = 64\n[coordinates]\nx[i = 1..N] = exp(-((i - 20)/3)^2)\n"
    "[effects]\nK = sum(i = 1..N, p_x[i]^2/2)\n"
    "V = sum(i = 1..N-1, (x[i+1] - x[i])^2/2) + x[1]^2/2 + x[N]^2/2\n";

/* What hardly moves is measured by what does: the wave's error is that of the
   wave, not that of masses which it has not reached. */
TEST(elements_of_an_array_share_a_range) {
    setup s = set_up(wave);
    refer(&s, true, 0, 20);
    double together = error_of_run(&s, nevh_verlet, true, 0, 20, 0.1);
    ck_assert_double_gt(together, 1e-3);
    ck_assert_double_lt(together, 4e-3);
    for (size_t k = 1; k < s.n; k++)
        ck_assert_double_eq(nevh_reference_range(s.reference, k),
                            nevh_reference_range(s.reference, 0));
    ck_assert_double_lt(nevh_reference_own_range(s.reference, 63),
                        1e-2 * nevh_reference_range(s.reference, 63));
    nevh_reference_free(s.reference);
    refer(&s, false, 0, 20);
    ck_assert_double_gt(error_of_run(&s, nevh_verlet, true, 0, 20, 0.1),
                        20 * together);
    tear_down(&s);
}

static const char toda[] =
    "[parameters]\nN = 40\n[coordinates]\nx[1..N] = 0\n"
    "p_x[i = 1..N] = 2*max(0, 1 - abs(i - 20))\n"
    "[effects]\nK = sum(i = 1..N, p_x[i]^2/2)\n"
    "V = sum(i = 1..N-1, exp(x[i] - x[i+1]) - 1) + x[N] - x[1]\n";

/* All orbits of Toda's chain are regular. */
TEST(a_regular_chain_is_not_chaotic) {
    setup s = set_up(toda);
    refer(&s, true, 0, 30);
    ck_assert_double_eq(nevh_reference_horizon(s.reference), INFINITY);
    ck_assert_double_lt(nevh_reference_error(s.reference), 1e-10);
    ck_assert_double_lt(error_of_run(&s, nevh_gauss4, true, 0, 30, 0.05), 1e-5);
    tear_down(&s);
}

/* The largest difference of each, and none of the others'. */
TEST(differences_by_variable) {
    setup s = set_up("[coordinates]\nx = 1\ny = 3\n[effects]\n"
                     "K = (p_x^2 + p_y^2)/2\nV = x^2/2 + y^2/2\n");
    refer(&s, false, 0, 10);
    nevh_state_error *e = nevh_state_error_new(s.reference);
    ck_assert(isnan(nevh_state_error_of(e, 0)));
    for (size_t i = 0; i <= 10; i++) {
        double t = (double)i, off = i == 4 ? 0.25 : 0;
        double q[] = {cos(t), 3 * cos(t) + off};
        double p[] = {-sin(t) - off / 8, -3 * sin(t)};
        nevh_state_error_observe(e, i, t, q, p);
    }
    const double known[] = {0, 0.25, 0.03125, 0};
    for (size_t k = 0; k < 4; k++)
        ck_assert_double_eq_tol(nevh_state_error_of(e, k), known[k], 1e-10);
    ck_assert(isnan(nevh_state_error_of(e, 4)));
    ck_assert(isnan(nevh_state_error_of(NULL, 0)));
    ck_assert_double_eq_tol(nevh_state_error_result(e), 0.25 / 6, 5e-4);
    nevh_state_error_free(e);
    tear_down(&s);
}

typedef struct {
    size_t count;
    double worst, last;
} gaps;

static void measure(void *data, double t, const double q[], const double p[],
                    const double reference[]) {
    gaps *g = data;
    g->count++;
    g->last = t;
    g->worst = fmax(g->worst, fabs(q[0] - reference[0]));
    g->worst = fmax(g->worst, fabs(p[0] - reference[1]));
}

/* Both states of a pair are of the same time, late on the clock, too: 1e-9 of
   a time that is 1e9 later is nothing beside 1e-7, its last digit. */
TEST(pairs_are_handed_on) {
    setup s = set_up(
        "[coordinates]\nx = 1\n[effects]\nK = p_x^2/2\nV = x^2/2 + x^4/4\n");
    const double t0 = 1e9, t1 = t0 + 10;
    double q[MOST], p[MOST];
    gaps seen = {0, 0, 0};
    nevh_options o = {.gradient = nevh_exact, .t = t0, .q = s.q, .p = s.p};
    refer(&s, false, t0, t1);
    nevh_stepper *stepper = nevh_stepper_new(s.system, nevh_gauss8, &o);
    nevh_state_error *e = nevh_state_error_new(s.reference);
    nevh_state_error_follow(e, stepper);
    nevh_state_error_hand(e, measure, &seen);
    memcpy(q, s.q, sizeof q);
    memcpy(p, s.p, sizeof p);
    ck_assert_int_eq(
        nevh_run_until(stepper, t0, 0.05, t1, q, p,
                       &(nevh_observer){nevh_state_error_observe, e, 1}, 1),
        NEVH_OK);
    ck_assert_uint_gt(seen.count, 100);
    ck_assert_double_eq(seen.last, t1);
    ck_assert_double_gt(seen.worst, 0);
    ck_assert_double_lt(seen.worst, 1e-12);
    size_t before = seen.count;
    nevh_state_error_hand(e, NULL, NULL);
    nevh_state_error_observe(e, 200, t1, q, p);
    ck_assert_uint_eq(seen.count, before);
    nevh_state_error_free(e);
    nevh_stepper_free(stepper);
    tear_down(&s);
}
