/* nevh tests: one orbit takes ways of its own, and the same bits.

   Alone, an orbit of a small system is repeated over a vector or has its stages
   side by side; gradients are written in place where a width allows it.  None
   of that may be seen in a result.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <string.h>

enum { STEPS = 12, WIDEST = 16, MOST = 3 };

static nevh_stepper *plan(nevh_system *s, const problem *x,
                          const nevh_integrator *scheme, size_t width,
                          const double q[], const double p[]) {
    nevh_options options = {.gradient = nevh_exact,
                            .width = width,
                            .scale = (const double[]){1, 1, 1, 1},
                            .t = x->t0,
                            .q = q,
                            .p = p,
                            .tolerance = tolerance_for(scheme),
                            .binding = 2};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    ck_assert_int_eq(nevh_stepper_status(stepper), NEVH_OK);
    return stepper;
}

/* Lane `lane` of the problem's start. */
static void start(const problem *x, size_t lane, size_t width, size_t column,
                  double q[], double p[]) {
    for (size_t k = 0; k < x->n; k++) {
        q[k * width + column] = x->q[k] + 0.01 * (double)lane;
        p[k * width + column] = x->p[k] - 0.02 * (double)lane;
    }
}

static const size_t widths[] = {3, 8, 16};

TEST_EACH(alone_as_among_others, 5 * scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / 5];
    const problem *x = problems[_i % 5];
    /* Implicit Euler loses energy: longer steps end in Kepler's centre. */
    double h = x->span / x->fewest / 16;
    if (!fits(scheme, x) || nevh_integrator_own_time(scheme))
        skip_test("it does not fit, or takes one orbit at a time");
    nevh_system *s = x->make();
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        double q[MOST_DOF * WIDEST], p[MOST_DOF * WIDEST];
        double one_q[MOST_DOF], one_p[MOST_DOF];
        size_t width = widths[i];
        for (size_t lane = 0; lane < width; lane++)
            start(x, lane, width, lane, q, p);
        nevh_stepper *all = plan(s, x, scheme, width, q, p);
        ck_assert(!nevh_run(all, x->t0, h, STEPS, q, p, NULL, 0));
        for (size_t lane = 0; lane < width; lane += 2) {
            start(x, lane, 1, 0, one_q, one_p);
            nevh_stepper *one = plan(s, x, scheme, 1, one_q, one_p);
            ck_assert(!nevh_run(one, x->t0, h, STEPS, one_q, one_p, NULL, 0));
            for (size_t k = 0; k < x->n; k++) {
                ck_assert(q[k * width + lane] == one_q[k]);
                ck_assert(p[k * width + lane] == one_p[k]);
            }
            nevh_stepper_free(one);
        }
        nevh_stepper_free(all);
    }
    nevh_system_free(s);
}

static nevh_system *wavy(int kind) {
    nevh_system *s = nevh_system_new(MOST);
    static const size_t rising[] = {0, 1, 2}, falling[] = {2, 1, 0},
                        some[] = {1};
    static const double masses[] = {2, 3, 4};
    switch (kind) {
    case 0:
        add_waves(s, 3, rising);
        break;
    case 1:
        add_waves(s, 3, falling);
        break;
    case 2:
        add_waves(s, 1, some);
        break;
    case 3:
        add_waves(s, 3, rising);
        add_waves(s, 1, some);
        break;
    default:
        add_waves(s, 1, some);
        add_waves(s, 3, rising);
    }
    ck_assert(
        !nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                         .np = 1,
                                         .nc = 1,
                                         .p = rising,
                                         .c = masses,
                                         .count = 3,
                                         .value = mass_kinetic,
                                         .gradient = mass_kinetic_gradient}));
    return s;
}

/* To the sign of a zero; and constants follow a width that changes. */
TEST_EACH(every_width_alike, 5) {
    static const size_t all[] = {1, 8, 2, 16, 9, 8};
    nevh_system *s = wavy(_i);
    nevh_field *f = nevh_field_new(
        s, &(nevh_options){.gradient = nevh_exact, .scale = NULL});
    double x[] = {-0., 0.5, -1}, y[] = {1.5, -0., 2};
    ck_assert_int_eq(nevh_field_status(f), NEVH_OK);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        double q[MOST * WIDEST], p[MOST * WIDEST], t[WIDEST] = {0};
        double g[2 * MOST * WIDEST], expected, *dp = g + MOST * all[i];
        for (size_t j = 0; j < MOST * all[i]; j++) {
            q[j] = x[j / all[i]];
            p[j] = y[j / all[i]];
            g[j] = dp[j] = 7; /* is overwritten */
        }
        bool both = i % 2;
        ck_assert(
            !nevh_field_gradient(f, all[i], t, q, p, g, both ? dp : NULL));
        if (!both)
            ck_assert(!nevh_field_gradient(f, all[i], t, q, p, NULL, dp));
        for (size_t j = 0; j < MOST * all[i]; j++) {
            size_t k = j / all[i];
            static const double c[] = {1.25, 0.75, 2.5}, m[] = {2, 3, 4};
            double weight = _i == 0 ? c[k] : _i == 1 ? c[2 - k] : 0;
            weight += _i >= 3 ? c[k] : 0;
            expected = weight * sin(x[k]);
            if (_i >= 2 && k == 1)
                expected += c[0] * sin(x[k]);
            ck_assert(g[j] == expected || fabs(g[j] - expected) < 1e-15);
            ck_assert(!(g[j] == 0 && signbit(g[j])));
            ck_assert(dp[j] == y[k] / m[k]);
            ck_assert(!(dp[j] == 0 && signbit(dp[j])));
        }
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

/* A force that is NaN beyond a wall; its value is not. */
static void walled(size_t width, const double t[], const double q[],
                   const double p[], const double c[], const void *params,
                   double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = q[i] > 1 ? NAN : sin(q[i]);
}
static double free_value(double t, const double q[], const double p[],
                         const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -cos(q[0]);
}

/* The message names the term, however the gradient was taken, and the state is
   the one before. */
TEST_EACH(failures_name_the_term, 4) {
    static const nevh_integrator *const *const schemes[] = {
        &nevh_verlet, &nevh_gauss16, &nevh_gauss6, &nevh_rk4};
    static const double mass[] = {2};
    const nevh_integrator *scheme = *schemes[_i];
    nevh_system *s = nevh_system_new(1);
    double q[] = {0.9}, p[] = {1};
    nevh_system_add(s, &(nevh_term){.effect = "wall",
                                    .nq = 1,
                                    .value = free_value,
                                    .gradient = walled});
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .c = mass,
                                    .value = mass_kinetic,
                                    .gradient = mass_kinetic_gradient});
    nevh_stepper *stepper =
        nevh_stepper_new(s, scheme,
                         &(nevh_options){.gradient = nevh_exact,
                                         .scale = (const double[]){0.01, 0.01},
                                         .q = (const double[]){0},
                                         .p = p});
    ck_assert_str_eq(nevh_stepper_message(stepper), "");
    ck_assert_int_eq(nevh_stepper_apply(stepper, 0, 0.5, q, p), NEVH_EDOM);
    ck_assert_ptr_nonnull(
        strstr(nevh_stepper_message(stepper), "a derivative of term \"wall\""));
    ck_assert(q[0] == 0.9 && p[0] == 1);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}

/* Ten steps, of which the field is asked for other states in between. */
static void run_asked(const nevh_integrator *scheme, double tolerance,
                      size_t asked, double q[], double p[]) {
    static const double masses[] = {2, 3};
    static const size_t all[] = {0, 1};
    nevh_system *s = nevh_system_new(2);
    add_waves(s, 2, all);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .p = all,
                                    .c = masses,
                                    .count = 2,
                                    .value = mass_kinetic,
                                    .gradient = mass_kinetic_gradient});
    nevh_stepper *stepper = nevh_stepper_new(
        s, scheme,
        &(nevh_options){.gradient = nevh_exact, .tolerance = tolerance});
    ck_assert_str_eq(nevh_stepper_message(stepper), "");
    for (size_t i = 0; i < 10; i++) {
        double t[WIDEST] = {0}, x[4 * WIDEST] = {0}, g[4 * WIDEST];
        ck_assert(!nevh_stepper_apply(stepper, 0.5 * (double)i, 0.5, q, p));
        if (asked)
            ck_assert(!nevh_field_gradient(nevh_stepper_field(stepper), asked,
                                           t, x, x + 2 * asked, g,
                                           g + 2 * asked));
    }
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}

/* What a stepper keeps ready does not hold for other widths. */
TEST_EACH(asking_in_between_changes_nothing, 6) {
    static const nevh_integrator *const *const schemes[] = {
        &nevh_verlet, &nevh_gauss6, &nevh_rk4,
        &nevh_dop853, &nevh_dopri5, &nevh_dprkn12};
    static const size_t asked[] = {1, 3, 8, 16};
    const nevh_integrator *scheme = *schemes[_i];
    double tolerance = scheme == nevh_dopri5 ? 1e-6 : 0;
    double q[] = {0.5, -1}, p[] = {1, 0.25};
    run_asked(scheme, tolerance, 0, q, p);
    for (size_t i = 0; i < sizeof asked / sizeof *asked; i++) {
        double other_q[] = {0.5, -1}, other_p[] = {1, 0.25};
        run_asked(scheme, tolerance, asked[i], other_q, other_p);
        ck_assert_mem_eq(q, other_q, sizeof q);
        ck_assert_mem_eq(p, other_p, sizeof p);
    }
}
