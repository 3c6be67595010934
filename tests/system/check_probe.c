/* nevh tests: what is found out from values of H alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <string.h>

/* Each H differs from a plain pendulum in one respect. */
static double plain(double t, const double q[], const double p[],
                    const void *x) {
    (void)t, (void)x;
    return p[0] * p[0] / 2.6 - 1.7 * cos(q[0]);
}
static double mixed(double t, const double q[], const double p[],
                    const void *x) {
    return plain(t, q, p, x) + 1e-9 * p[0] * p[0] * q[0];
}
static double driven(double t, const double q[], const double p[],
                     const void *x) {
    return plain(t, q, p, x) + 1e-9 * sin(2 * t) * q[0];
}
static double fast_kinetic(double t, const double q[], const double p[],
                           const void *x) {
    (void)t, (void)x;
    return 3 * sqrt(1 + p[0] * p[0] / 9) - 1.7 * cos(q[0]);
}
static double one_way(double t, const double q[], const double p[],
                      const void *x) {
    return plain(t, q, p, x) + 1e-7 * p[0] + 1e-5 * q[0];
}
static double kinked(double t, const double q[], const double p[],
                     const void *x) {
    return plain(t, q, p, x) + 0.3 * fabs(q[0] - 0.15);
}
static double nowhere(double t, const double q[], const double p[],
                      const void *x) {
    (void)t, (void)q, (void)p, (void)x;
    return NAN;
}

typedef struct {
    nevh_value_fn H;
    nevh_question fails; /* NEVH_FINDINGS: none */
} trial;

static const trial trials[] = {
    {plain, NEVH_FINDINGS},        {mixed, NEVH_IS_SEPARABLE},
    {driven, NEVH_IS_AUTONOMOUS},  {fast_kinetic, NEVH_IS_QUADRATIC},
    {one_way, NEVH_IS_REVERSIBLE}, {kinked, NEVH_IS_SMOOTH},
};

/* With a state to plan at, at rest, and with none. */
TEST_EACH(answers, 3 * sizeof trials / sizeof *trials) {
    const trial *t = &trials[_i / 3];
    const double q[] = {1.1}, p[] = {_i % 3 == 1 ? 0 : 0.4};
    nevh_options given = {.q = q, .p = p};
    nevh_system *s = nevh_system_from(1, t->H, NULL);
    nevh_probe *b = nevh_probe_new(s, _i % 3 == 2 ? NULL : &given);
    ck_assert_int_eq(nevh_probe_status(b), NEVH_OK);
    for (nevh_question i = 0; i < NEVH_FINDINGS; i++) {
        nevh_finding f = nevh_probe_finding(b, i);
        ck_assert_msg(f.holds == (i != t->fails), "%d: %s, evidence %.2e", _i,
                      nevh_question_name(i), f.evidence);
        ck_assert(f.holds == (f.evidence <= f.limit));
        ck_assert(isfinite(f.evidence));
    }
    nevh_finding f = nevh_probe_finding(b, t->fails);
    if (t->fails < NEVH_FINDINGS)
        ck_assert(f.q && f.p && isfinite(f.q[0]) && isfinite(f.p[0]));
    nevh_probe_free(b);
    nevh_system_free(s);
}

/* The evidence can be checked at the state that comes with it. */
TEST(evidence_can_be_repeated) {
    nevh_system *s = nevh_system_from(1, one_way, NULL);
    nevh_probe *b = nevh_probe_new(s, NULL);
    nevh_finding f = nevh_probe_finding(b, NEVH_IS_REVERSIBLE);
    double back = -f.p[0];
    double one = one_way(f.t, f.q, f.p, NULL);
    double two = one_way(f.t, f.q, &back, NULL);
    ck_assert_double_eq_tol(fabs(one - two) / (fabs(one) + fabs(two)),
                            f.evidence, 1e-12);
    nevh_probe_free(b);
    nevh_system_free(s);
}

/* Turned back by a mirror: Hill's problem, a charge in a uniform field; with both
   coordinates odd none does. */
static double hill(double t, const double q[], const double p[],
                   const void *x) {
    double r = hypot(q[0], q[1]), slip = *(const double *)x;
    (void)t;
    return (p[0] * p[0] + p[1] * p[1]) / 2 + q[1] * p[0] - q[0] * p[1] -
           q[0] * q[0] + q[1] * q[1] / 2 - 1 / r + slip * (q[0] + q[1]);
}

TEST(mirrors_turn_orbits_back) {
    static const double q[] = {0.4, 0.3}, p[] = {0.2, 1.1};
    nevh_options o = {.q = q, .p = p};
    for (int i = 0; i < 2; i++) {
        double slip = i * 1e-6;
        nevh_system *s = nevh_system_from(2, hill, &slip);
        nevh_probe *b = nevh_probe_new(s, &o);
        nevh_finding f = nevh_probe_finding(b, NEVH_IS_REVERSIBLE);
        ck_assert(f.holds == !i);
        if (!i)
            ck_assert_str_eq(f.term, "(q[0], p[1]) -> -(q[0], p[1])");
        nevh_probe_free(b);
        nevh_system_free(s);
    }
}

/* Two bodies on a spring: their centre is free, a double eigenvalue of 0. */
static double free_pair(double t, const double q[], const double p[],
                        const void *x) {
    (void)t, (void)x;
    return p[0] * p[0] / 2.6 + p[1] * p[1] / 5.8 + 1.7 * cosh(q[0] - q[1]);
}

TEST_EACH(rates_of_rounding_are_none, 8) {
    const double q[] = {0.37 + _i, 0.3 + _i}, p[] = {0.1 * _i, 0.2};
    double frequency, growth;
    nevh_options o = {.q = q, .p = p};
    nevh_system *s = nevh_system_from(2, free_pair, NULL);
    nevh_rates *r = nevh_rates_new(s, &o);
    ck_assert_int_eq(nevh_rates_at(r, 0, q, p, &frequency, &growth), NEVH_OK);
    ck_assert_double_eq_tol(
        frequency, sqrt(1.7 * cosh(q[0] - q[1]) * (1 / 1.3 + 1 / 2.9)), 1e-6);
    ck_assert_double_eq(growth, 0);
    nevh_rates_free(r);
    nevh_system_free(s);
}

/* Whatever the units. */
TEST_EACH(lengths, 2) {
    const double metre = _i ? 1e-10 : 1e11, mass = _i ? 1e-27 : 1e30;
    nevh_pendulum rod = {mass, metre, 9.8 * metre};
    nevh_system *s = nevh_pendulum_model->system(&rod);
    const double q[] = {2}, p[] = {0};
    nevh_options o = {.q = q, .p = p};
    nevh_probe *b = nevh_probe_new(s, &o);
    ck_assert_int_eq(nevh_probe_status(b), NEVH_OK);
    const double *length = nevh_probe_lengths(b);
    double momentum = mass * metre * metre * sqrt(9.8);
    ck_assert_double_ge(length[0], 0.25);
    ck_assert_double_le(length[0], 4);
    ck_assert_double_ge(length[1], momentum / 8);
    ck_assert_double_le(length[1], momentum * 8);
    nevh_probe_free(b);
    nevh_system_free(s);
}

TEST(terms_are_named) {
    nevh_system *s = double_pendulum.make();
    nevh_options o = {.q = double_pendulum.q, .p = double_pendulum.p};
    nevh_probe *b = nevh_probe_new(s, &o);
    nevh_finding f = nevh_probe_finding(b, NEVH_IS_SEPARABLE);
    ck_assert(!f.holds);
    ck_assert_str_eq(f.term, "kinetic");
    ck_assert(nevh_probe_finding(b, NEVH_IS_QUADRATIC).holds);
    ck_assert(nevh_probe_finding(b, NEVH_IS_REVERSIBLE).holds);
    nevh_probe_free(b);
    nevh_system_free(s);
}

TEST(failures) {
    nevh_system *s = nevh_system_from(1, nowhere, NULL);
    nevh_probe *b = nevh_probe_new(s, NULL);
    ck_assert_int_eq(nevh_probe_status(b), NEVH_EDOM);
    ck_assert_ptr_nonnull(strstr(nevh_probe_message(b), "not finite"));
    nevh_probe_free(b);
    nevh_system_free(s);
    s = nevh_system_new(0);
    b = nevh_probe_new(s, NULL);
    ck_assert_int_eq(nevh_probe_status(b), NEVH_EINVAL);
    ck_assert(!nevh_probe_finding(b, NEVH_IS_SMOOTH).holds);
    ck_assert(!nevh_probe_finding(b, NEVH_FINDINGS).holds);
    ck_assert_str_eq(nevh_question_name(NEVH_FINDINGS), "unknown");
    nevh_probe_free(b);
    nevh_probe_free(NULL);
    nevh_system_free(s);
}
