/* nevh tests: references: which solutions are recognised, how accurate they
   are, and where they end.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "reference.h"
#include <float.h>
#include <stdio.h>
#include <string.h>

/* The largest difference at time t, over the ranges of `a`. */
static double difference(nevh_reference *a, nevh_reference *b, size_t n,
                         double t) {
    double x[2 * MOST], y[2 * MOST], most = 0;
    ck_assert_int_eq(nevh_reference_state(a, t, x, x + n), NEVH_OK);
    ck_assert_int_eq(nevh_reference_state(b, t, y, y + n), NEVH_OK);
    for (size_t k = 0; k < 2 * n; k++)
        most = fmax(most, fabs(x[k] - y[k]) / nevh_reference_range(a, k));
    return most;
}

/* Hamiltonians whose motion is known, in units from atoms to planets. */
static const struct {
    orbit orbit;
    const char *text;
} recognised[] = {
    {{"x = 1", "T = p_x^2/2\nV = x^2/2", 0, 100}, "exact solution (cosine)"},
    {{"x = 3, -2", "H = 7 + p_x^2/2.6 + 1.9*(x - 0.7)^2 - x/3", -3, 80},
     "exact solution (cosine)"},
    {{"x = 0, 3e-24", "T = p_x^2/3.3e-27\nV = 290*x^2", 0, 1e-12},
     "exact solution (cosine)"},
    {{"q = 2", "T = p_q^2/2\nV = -cos(q)", 0, 100},
     "exact solution (Jacobi sn)"},
    {{"q = 0.3, 7", "T = p_q^2/2.6\nV = 1e3 - 2.2*sin(q + 0.4)", 5, 95},
     "exact solution (Jacobi sn)"},
    {{"q = 1, -4e-34", "T = p_q^2/3.1e-46\nV = 2e-22*cos(q)", 0, 1e-10},
     "exact solution (Jacobi sn)"},
    {{"x = 0.4\ny = 0\np_y = 2", "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)", 0,
      100},
     "exact solution (Kepler's equation)"},
    {{"x = 1.2e11\ny = 3e10\nz = -4e10\np_x = 2e28\np_y = 1e29\np_z = 1.3e29",
      "T = (p_x^2 + p_y^2 + p_z^2)/1.2e25\n"
      "V = -7.9e44*(x^2 + y^2 + z^2)^(-1/2)",
      0, 1e8},
     "exact solution (Kepler's equation)"},
};
enum { RECOGNISED = sizeof recognised / sizeof *recognised };

/* What is recognised is also what a Gauss method finds. */
TEST_EACH(exact_solutions_are_recognised, RECOGNISED) {
    const orbit *o = &recognised[_i].orbit;
    setup a = refer_to(o, NULL), b = refer_to(o, nevh_gauss12);
    ck_assert_str_eq(nevh_reference_text(a.reference), recognised[_i].text);
    ck_assert(strncmp(nevh_reference_text(b.reference), "gauss12 at", 10) == 0);
    ck_assert_double_lt(nevh_reference_error(a.reference), 1e-11);
    ck_assert_double_lt(nevh_reference_error(b.reference), 2e-11);
    ck_assert_double_eq(nevh_reference_horizon(a.reference), INFINITY);
    for (int i = 0; i <= 50; i++) {
        double t = o->t1 - (o->t1 - o->t0) * i / 50;
        ck_assert_double_lt(difference(a.reference, b.reference, a.n, t),
                            3e-11);
    }
    tear_down(&a);
    tear_down(&b);
}

/* Exact solutions whose phase has too few digits in long double: series have
   more, where there are wide numbers, and take their place. */
static const orbit long_ones[] = {
    {"x = 0.1\ny = 0\np_y = sqrt(19)",
     "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)", 0, 628},
    {"q = 0\np_q = 8", "T = p_q^2/2\nV = -9.8*cos(q)", 0, 1000},
};

TEST_EACH(series_replace_exact_solutions_of_too_few_digits,
          sizeof long_ones / sizeof *long_ones) {
    const orbit *o = &long_ones[_i];
    setup a = refer_to(o, NULL);
    nevh_reference_options finest = {.finest = true};
    nevh_reference *r =
        nevh_reference_with(a.system, &finest, o->t0, o->t1, a.q, a.p);
    double exact = nevh_reference_error(a.reference),
           own = nevh_reference_error(r);
    assert_says(nevh_reference_text(a.reference), "exact");
    ck_assert_double_gt(exact, 1e-14);
    ck_assert_double_lt(own, exact);
    if (LDBL_MANT_DIG == 64) {
        assert_says(nevh_reference_text(r), "taylor in ");
        ck_assert_double_le(own, 1e-15);
    }
    ck_assert_double_eq(nevh_reference_horizon(r), INFINITY);
    nevh_reference_free(r);
    tear_down(&a);
}

/* On the separatrix the phase of sn is lost; series end where theirs is. */
TEST(series_replace_exact_solutions_without_digits) {
    const orbit o = {"q = 0\np_q = 2", "T = p_q^2/2\nV = -cos(q)", 0, 60};
    setup a = refer_to(&o, NULL);
    double q, p, t = 15;
    ck_assert_int_eq(nevh_reference_status(a.reference), NEVH_OK);
    ck_assert_double_lt(nevh_reference_error(a.reference), 1e-9);
    ck_assert_double_lt(nevh_reference_horizon(a.reference), 60);
    ck_assert_int_eq(nevh_reference_state(a.reference, t, &q, &p), NEVH_OK);
    ck_assert_double_eq_tol(q, 2 * atan(sinh(t)), 1e-9);
    tear_down(&a);
}

/* Nearly the same, or no such motion. */
static const struct {
    const char *coordinates, *effects;
} near_misses[] = {
    {"q = 2", "T = p_q^2/2\nV = -cos(q) + 1e-9*q^4"},
    {"q = 2", "T = p_q^2/2\nV = -cos(1.0000001*q)"},
    {"q = 2", "T = p_q^2/2 + 1e-9*p_q^4\nV = -cos(q)"},
    {"q = 2", "T = p_q^2/2\nV = -cos(q)*(1 + 1e-9*cos(t))"},
    {"q = 2", "T = p_q^2/2\nV = -cos(q)\nW = 1e-9*p_q*q"},
    {"q = 0, 7", "T = p_q^2/2\nV = -cos(q) + 0.001*exp(-(q - 12)^2)"},
    {"q = 0, -7", "T = p_q^2/2\nV = -cos(q) + 0.001*exp(-(q + 12)^2)"},
    {"x = 1", "T = p_x^2/2\nV = x^2/2 + 1e-9*x^3"},
    {"x = 1", "T = sqrt(1e6 + p_x^2)\nV = x^2/2"},
    {"x = 1", "T = p_x^2/2\nV = x^2/2 + 1e-9*t*x"},
    {"x = 1", "T = p_x^2/2\nV = -x^2/2"},
    {"x = 1", "T = p_x^2/2\nV = x^2/2\n[friction]\ndrag = all: 1e-9"},
    {"x = 0.4\ny = 0\np_y = 2",
     "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y) - 1e-9/(x^2 + y^2)"},
    {"x = 0.4\ny = 0\np_y = 2",
     "T = (p_x^2 + p_y^2)/2\nV = -1/sqrt(x^2 + y^2 + 1e-9)"},
    {"x = 0.4\ny = 0\np_y = 2",
     "T = (p_x^2 + 1.00000001*p_y^2)/2\nV = -1/hypot(x, y)"},
    {"x = 0.4\ny = 0\np_y = 2.3", "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)"},
    {"x = 0.4\ny = 0\np_y = 0.7", "T = (p_x^2 + p_y^2)/2\nV = 1/hypot(x, y)"},
    {"x = 1\ny = 2", "T = (p_x^2 + p_y^2)/2\nV = (x^2 + y^2)/2"},
};
enum { NEAR_MISSES = sizeof near_misses / sizeof *near_misses };

TEST_EACH(near_misses_are_refused, NEAR_MISSES) {
    setup s = set_up(near_misses[_i].coordinates, near_misses[_i].effects);
    refer(&s, NULL, 0, 3);
    ck_assert_ptr_null(strstr(nevh_reference_text(s.reference), "exact"));
    tear_down(&s);
}

/* An exact solution is not searched for where that takes longer than the run. */
TEST(long_sums_are_not_searched) {
    setup s = set_up("x = 1", "T = p_x^2/2\nV = sum(i = 1..20000, x^2)/40000");
    refer(&s, NULL, 0, 3);
    ck_assert_ptr_null(strstr(nevh_reference_text(s.reference), "exact"));
    tear_down(&s);
}

/* States of another program in quadruple precision, good to 20 digits and more;
   coordinates first.  H as a function has no exact gradient. */
static const struct {
    orbit orbit;
    bool exact;
    double state[2 * MOST];
} states[] = {
    {{"q = 2", "T = p_q^2/2\nV = -cos(q)", 0, 100},
     true,
     {1.982325653157030515982941, 0.1796407425909401978724921}},
    {{"x = 1", "T = p_x^2/2\nV = x^2/2", 0, 100},
     true,
     {0.8623188722876839341019385, 0.5063656411097587936565576}},
    {{"x = 0.4\ny = 0\np_y = 2", "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)", 0,
      100},
     true,
     {-0.1041832044342322840550464, -0.6947417155679742850149844,
      1.23617776268706369627367, 0.564623251085780902059137}},
    {{"x = 1 - 0.9\ny = 0\np_y = sqrt(19)",
      "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)", 0, 100},
     true,
     {-0.7506333330295163847347385, -0.4310000275773126803319831,
      1.142347674435544008437918, 0.07521912809634178298936333}},
    {{"a = pi/2\nb = 0",
      "T = (p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2))\n"
      "V = -9.8*(2*cos(a) + cos(b))",
      0, 10},
     false,
     {0.1137118256716568201221664, -2.223609077492791711139523,
      -3.802044137210631439898684, 1.721351498235191875262862}},
    {{"x = 0\ny = 0.1\np_x = 0.49057789051960615",
      "T = (p_x^2 + p_y^2)/2\nV = (x^2 + y^2)/2 + x^2*y - y^3/3", 0, 100},
     false,
     {0.1329957183343852788967454, 0.3760189573811590740470609,
      0.2953954457827294417819349, -0.1606396034768338961890406}},
};
enum { STATES = sizeof states / sizeof *states };

static double error_at_end(const setup *s, double t1, const double state[]) {
    double z[2 * MOST], most = 0;
    ck_assert_int_eq(nevh_reference_state(s->reference, t1, z, z + s->n),
                     NEVH_OK);
    for (size_t k = 0; k < 2 * s->n; k++)
        most = fmax(most, fabs(z[k] - state[k]) /
                              nevh_reference_range(s->reference, k));
    return most;
}

TEST_EACH(states_in_quadruple_precision, STATES) {
    setup s = refer_to(&states[_i].orbit, NULL);
    double error = error_at_end(&s, states[_i].orbit.t1, states[_i].state);
    bool exact = strncmp(nevh_reference_text(s.reference), "exact", 5) == 0;
    ck_assert_int_eq(exact, states[_i].exact);
    ck_assert_double_lt(error, 5e-13);
    ck_assert_double_le(error, nevh_reference_error(s.reference) + 1e-15);
    tear_down(&s);
}

/* Orbits that hang on a constant: at a rounding of it, they are off by no more
   than the own error. */
static const struct {
    orbit orbit;
    const char *more; /* effects, that make a constant larger by 1e-10 of it */
} sensitive[] = {
    {{"x = 0.1\ny = 0\np_y = sqrt(19)",
      "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)", 0, 100},
     "more = -1e-10/hypot(x, y)"},
    {{"x = 0.1\ny = 0\np_y = sqrt(19)",
      "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)", 0, 100},
     "more = 1e-10*(p_x^2 + p_y^2)/2"},
    {{"q = 0\np_q = 2 + 1e-4", "T = p_q^2/2\nV = -cos(q)", 0, 100},
     "more = -1e-10*cos(q)"},
    {{"q = pi - 1e-3", "T = p_q^2/2\nV = -cos(q)", 0, 100},
     "more = 1e-10*sin(q)"},
};
enum { SENSITIVE = sizeof sensitive / sizeof *sensitive };

TEST_EACH(constants_are_in_the_own_error, SENSITIVE) {
    char effects[400];
    orbit off = sensitive[_i].orbit;
    snprintf(effects, sizeof effects, "%s\n%s", off.effects,
             sensitive[_i].more);
    off.effects = effects;
    setup a = refer_to(&sensitive[_i].orbit, NULL), b = refer_to(&off, NULL);
    ck_assert_ptr_nonnull(strstr(nevh_reference_text(b.reference), "exact"));
    double most = 0;
    for (int i = 1; i <= 50; i++)
        most = fmax(most, difference(a.reference, b.reference, a.n, 2. * i));
    double rounding = most / 1e-10 * (double)LDBL_EPSILON;
    double error = nevh_reference_error(a.reference);
    ck_assert_double_lt(rounding, error);
    ck_assert_double_lt(error, fmax(1000 * rounding, 2 * DBL_EPSILON));
    tear_down(&a);
    tear_down(&b);
}

/* Constants have the digits of long double: a series of 106 bits finds no
   more than both own errors, which differences of doubles would not keep. */
TEST_EACH(constants_have_more_digits_than_a_double, SENSITIVE) {
    const orbit *o = &sensitive[_i].orbit;
    setup a = refer_to(o, NULL), b = refer_to(o, nevh_taylor);
    double own = nevh_reference_error(a.reference) +
                 nevh_reference_error(b.reference) + DBL_EPSILON;
    ck_assert_int_eq(nevh_reference_status(b.reference), NEVH_OK);
    ck_assert_ptr_null(strstr(nevh_reference_text(b.reference), "exact"));
    ck_assert_double_lt(nevh_reference_error(a.reference), 1e-13);
    for (int i = 1; i <= 50; i++)
        ck_assert_double_le(difference(a.reference, b.reference, a.n, 2. * i),
                            own);
    tear_down(&a);
    tear_down(&b);
}

static double pendulum_value(double t, const double q[], const double p[],
                             const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 - cos(q[0]);
}

/* From values alone, by differences: for what its own error says. */
TEST(values_alone_are_enough) {
    nevh_system *system = nevh_system_from(1, pendulum_value, NULL);
    double q[] = {2}, p[] = {0};
    setup s = {.system = system, .n = 1};
    s.reference = nevh_reference_new(system, NULL, 0, 100, q, p);
    ck_assert_str_eq(nevh_reference_text(s.reference),
                     "exact solution (Jacobi sn)");
    double error = error_at_end(&s, 100, states[0].state);
    ck_assert_double_lt(error, 1e-12);
    ck_assert_double_le(error, nevh_reference_error(s.reference));
    nevh_reference_free(s.reference);
    nevh_system_free(system);
}

/* A run that is exact but for rounding, so that its checkpoints are put to
   the test: asked for in any order, near to steps and between them. */
TEST(states_come_in_any_order) {
    const orbit *o = &states[0].orbit;
    setup a = refer_to(o, NULL), b = refer_to(o, nevh_gauss16);
    for (size_t i = 0; i < 400; i++) {
        double t = fmod((double)i * 61.803398874989, 100);
        ck_assert_double_lt(difference(a.reference, b.reference, 1, t), 1e-11);
    }
    ck_assert_double_lt(difference(a.reference, b.reference, 1, 0), 1e-15);
    ck_assert_double_lt(difference(a.reference, b.reference, 1, 100), 1e-11);
    tear_down(&a);
    tear_down(&b);
}

/* Back in time. */
TEST(backwards) {
    const nevh_integrator *const by[] = {NULL, nevh_gauss12};
    for (int i = 0; i < 2; i++) {
        setup s = set_up("q = 1.982325653157030516, 0.1796407425909401979",
                         "T = p_q^2/2\nV = -cos(q)");
        refer(&s, by[i], 100, 0);
        double start[] = {2, 0};
        ck_assert_double_lt(error_at_end(&s, 0, start), 1e-12);
        ck_assert_double_eq(nevh_reference_horizon(s.reference), -INFINITY);
        tear_down(&s);
    }
}

TEST(ranges) {
    setup s = refer_to(&recognised[6].orbit, NULL);
    /* e = 0.6: x from 0.4 to -1.6, |y| up to sqrt(1 - e^2); p_y from 2 at the
       near end to -0.5, |p_x| up to 1/sqrt(1 - e^2). */
    const double known[] = {2, 1.6, 2.5, 2.5};
    for (size_t k = 0; k < 4; k++)
        ck_assert_double_eq_tol(nevh_reference_range(s.reference, k), known[k],
                                1e-4 * known[k]);
    tear_down(&s);
    /* z does not move. */
    s = set_up("x = 0.4\ny = 0\nz = 0\np_y = 2",
               "T = (p_x^2 + p_y^2 + p_z^2)/2\nV = -1/sqrt(x^2 + y^2 + z^2)");
    refer(&s, NULL, 0, 100);
    ck_assert_double_eq(nevh_reference_range(s.reference, 2),
                        nevh_reference_range(s.reference, 0));
    ck_assert_double_eq(nevh_reference_range(s.reference, 5),
                        fmax(nevh_reference_range(s.reference, 3),
                             nevh_reference_range(s.reference, 4)));
    tear_down(&s);
    /* Nothing does. */
    s = set_up("x = 0", "T = p_x^2/2\nV = x^2/2");
    refer(&s, NULL, 0, 100);
    ck_assert_double_eq(nevh_reference_range(s.reference, 0), 1);
    tear_down(&s);
}

/* The chaotic one separates, wherever it is to end and whatever the method; a
   regular one does not. */
TEST(chaos_has_a_horizon) {
    const orbit chaos = {"a = 3\nb = 3", RODS, 0, 500};
    const orbit regular = {"a = 1.1\nb = 0\np_b = 2.7746", RODS, 0, 100};
    setup s = refer_to(&chaos, NULL);
    double t = nevh_reference_horizon(s.reference), z[4];
    ck_assert_double_gt(t, 20);
    ck_assert_double_lt(t, 45);
    ck_assert_ptr_nonnull(strstr(nevh_reference_text(s.reference), "chaos"));
    ck_assert_int_eq(nevh_reference_state(s.reference, t, z, z + 2), NEVH_OK);
    ck_assert_int_eq(nevh_reference_state(s.reference, t + 0.1, z, z + 2),
                     NEVH_EDOM);
    setup other = set_up(chaos.coordinates, chaos.effects);
    refer(&other, nevh_gauss16, 0, 80);
    double ratio = nevh_reference_horizon(other.reference) / t;
    ck_assert_double_gt(ratio, 0.7);
    ck_assert_double_lt(ratio, 1.4);
    /* Well before, they are the same orbit. */
    ck_assert_double_lt(difference(s.reference, other.reference, 2, t / 4),
                        1e-9);
    tear_down(&other);
    tear_down(&s);
    s = refer_to(&regular, NULL);
    ck_assert_double_eq(nevh_reference_horizon(s.reference), INFINITY);
    ck_assert_double_lt(nevh_reference_error(s.reference), 1e-9);
    tear_down(&s);
}

/* A comet that comes near only after a while: steps that are good at its start
   are not, and that is no chaos. */
TEST(a_close_pass_is_no_chaos) {
    setup s = set_up("x = -1.95\ny = 0\np_y = 0.05/sqrt(0.0975)",
                     "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)");
    refer(&s, nevh_gauss12, 0, 20);
    setup exact = set_up("x = -1.95\ny = 0\np_y = 0.05/sqrt(0.0975)",
                         "T = (p_x^2 + p_y^2)/2\nV = -1/hypot(x, y)");
    refer(&exact, NULL, 0, 20);
    ck_assert_double_eq(nevh_reference_horizon(s.reference), INFINITY);
    ck_assert_double_lt(difference(exact.reference, s.reference, 2, 20), 1e-9);
    tear_down(&s);
    tear_down(&exact);
}

/* More steps than checkpoints are kept: a chain in one of its modes. */
TEST(long_runs_keep_every_other_checkpoint) {
    enum { N = 400 };
    char text[400];
    static double q[N], p[N];
    double w = 2 * sin(acos(-1) * 300 / (2 * (N + 1)));
    snprintf(text, sizeof text,
             "[coordinates]\nx[i = 1..%d] = sin(300*pi*i/%d)\n[effects]\n"
             "T = sum(i = 1..%d, p_x[i]^2/2)\n"
             "V = x[1]^2/2 + x[%d]^2/2 + sum(i = 1..%d, (x[i+1] - x[i])^2/2)\n",
             N, N + 1, N, N, N - 1);
    setup s = {.scene = nevh_scene_parse("chain", text), .n = N};
    ck_assert_str_eq(nevh_scene_message(s.scene), "");
    s.system = nevh_scene_system(s.scene);
    nevh_scene_start(s.scene, q, p);
    s.reference = nevh_reference_new(s.system, NULL, 0, 100, q, p);
    ck_assert_str_eq(nevh_reference_message(s.reference), "");
    for (int i = 0; i < 20; i++) {
        double t = fmod(i * 61.803398875, 100);
        ck_assert_int_eq(nevh_reference_state(s.reference, t, q, p), NEVH_OK);
        for (int k = 0; k < N; k++) {
            double shape = sin(acos(-1) * 300 * (k + 1) / (N + 1));
            ck_assert_double_eq_tol(q[k], shape * cos(w * t), 1e-9);
        }
    }
    tear_down(&s);
}

TEST(bad_input) {
    setup s = set_up("x = 1", "T = p_x^2/2\nV = x^4/4");
    double q, p, bad = NAN;
    const double ends[] = {0, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        nevh_reference *r =
            nevh_reference_new(s.system, NULL, 0, ends[i], s.q, s.p);
        ck_assert_int_eq(nevh_reference_status(r), NEVH_EINVAL);
        ck_assert_str_eq(nevh_reference_text(r), "");
        ck_assert_int_eq(nevh_reference_state(r, 0, &q, &p), NEVH_EINVAL);
        nevh_reference_free(r);
    }
    nevh_reference *r = nevh_reference_new(s.system, NULL, 0, 1, &bad, s.p);
    ck_assert_int_eq(nevh_reference_status(r), NEVH_EINVAL);
    nevh_reference_free(r);
    r = nevh_reference_new(s.system, nevh_adaptive_verlet, 0, 1, s.q, s.p);
    ck_assert_int_eq(nevh_reference_status(r), NEVH_EINVAL);
    nevh_reference_free(r);
    refer(&s, NULL, 0, 1);
    ck_assert_int_eq(nevh_reference_state(s.reference, 1.1, &q, &p),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_reference_state(s.reference, -0.1, &q, &p),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_reference_state(s.reference, NAN, &q, &p),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_reference_state(s.reference, 1, &q, &p), NEVH_OK);
    ck_assert_int_eq(nevh_reference_status(s.reference), NEVH_OK);
    tear_down(&s);
    ck_assert_int_eq(nevh_reference_status(NULL), NEVH_ENOMEM);
    nevh_reference_free(NULL);
    nevh_state_error_free(NULL);
}

/* What cannot be stepped has no reference: the ball falls into the centre. */
TEST(failures_are_told) {
    setup s = set_up("x = 1", "T = p_x^2/2\nV = -1/abs(x)");
    s.reference = nevh_reference_new(s.system, NULL, 0, 2, s.q, s.p);
    ck_assert_int_ne(nevh_reference_status(s.reference), NEVH_OK);
    ck_assert_str_ne(nevh_reference_message(s.reference), "");
    ck_assert_str_eq(nevh_reference_text(s.reference), "");
    tear_down(&s);
}
