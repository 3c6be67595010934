/* nevh tests: an orbit has the same bits however it is taken.

   Alone, an orbit of a small system is repeated over a vector or has its stages
   side by side; point gradients are taken number by number, blocks in vectors,
   gradients are written in place where a width allows it, and terms that share
   variables are added up in place or variable by variable.  None of that may be
   seen in a result: the table is systems x schemes x widths x gradients.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "lanes.h"
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

enum { STEPS = 12, WIDEST = 16, MOST = 3 };

/* The same terms with and without gradients of one state, which are counted, as
   blocks are. */
static struct { size_t points, blocks; } calls;

static void wave_point(double t, const double q[], const double p[],
                       const double c[], const void *params, double dq[],
                       double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    calls.points++;
    if (dq)
        dq[0] = c[0] * sin(q[0]);
}

static void wave_block(size_t width, const double t[], const double q[],
                       const double p[], const double c[], const void *params,
                       double dq[], double dp[]) {
    calls.blocks++;
    wave_gradient(width, t, q, p, c, params, dq, dp);
}

static void kinetic_point(double t, const double q[], const double p[],
                          const double c[], const void *params, double dq[],
                          double dp[]) {
    (void)t, (void)q, (void)params, (void)dq;
    if (dp)
        dp[0] = p[0] / c[0];
}

static double pushed(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)p, (void)c, (void)params;
    return ((q[0] - q[1]) * t + q[1] * q[1] * t * t) / 16;
}

static void pushed_point(double t, const double q[], const double p[],
                         const double c[], const void *params, double dq[],
                         double dp[]) {
    (void)p, (void)c, (void)params, (void)dp;
    if (!dq)
        return;
    dq[0] = t / 16;
    dq[1] = (2 * q[1] * t * t - t) / 16;
}

static void pushed_block(size_t width, const double t[], const double q[],
                         const double p[], const double c[], const void *params,
                         double dq[], double dp[]) {
    (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        dq[i] = t[i] / 16;
        dq[width + i] = (2 * q[width + i] * t[i] * t[i] - t[i]) / 16;
    }
}

/* Terms on both coordinates, on one of them again, and on one momentum, with or
   without point gradients. */
enum { AGAIN = 1, RUBS = 2, PUSHED = 4, SHARED = 8, TURNED = 16 };
static bool with_points;

static nevh_system *of_terms(unsigned kind) {
    static const size_t all[] = {0, 1}, one[] = {1, 1}, turned[] = {1, 0};
    static const double c[] = {1.25, 0.75}, masses[] = {2, 3};
    nevh_system *s = nevh_system_new(2);
    nevh_term wave = {.effect = "waves",
                      .nq = 1,
                      .nc = 1,
                      .q = all,
                      .c = c,
                      .count = 2,
                      .value = wave_value,
                      .gradient = wave_block,
                      .point_gradient = with_points ? wave_point : NULL};
    nevh_term kinetic = {.effect = "kinetic",
                         .np = 1,
                         .nc = 1,
                         .p = all,
                         .c = masses,
                         .count = 2,
                         .value = mass_kinetic,
                         .gradient = mass_kinetic_gradient,
                         .point_gradient = with_points ? kinetic_point : NULL};
    nevh_term push = {.effect = "push",
                      .nq = 2,
                      .q = kind & TURNED ? turned : all,
                      .time = true,
                      .value = pushed,
                      .gradient = pushed_block,
                      .point_gradient = with_points ? pushed_point : NULL};
    ck_assert(!nevh_system_add(s, &wave) && !nevh_system_add(s, &kinetic));
    wave.q = kinetic.p = one;
    wave.count = kind & SHARED ? 2 : 1;
    kinetic.count = 1;
    if (kind & AGAIN)
        ck_assert(!nevh_system_add(s, &wave) && !nevh_system_add(s, &kinetic));
    if (kind & RUBS)
        ck_assert(
            !nevh_system_add_friction(s, "drag", (const double[]){0.3, 0.1}));
    if (kind & (PUSHED | TURNED))
        ck_assert(!nevh_system_add(s, &push));
    return s;
}

/* Of the last, a term's coordinates do not stand as it wants them. */
#define OF_TERMS(kind, flags)                                                  \
    static nevh_system *make_##kind(void) {                                    \
        return of_terms(flags);                                                \
    }                                                                          \
    static const problem kind = {.name = #kind,                                \
                                 .n = 2,                                       \
                                 .separable = true,                            \
                                 .quadratic = true,                            \
                                 .span = 3.2,                                  \
                                 .fewest = 1,                                  \
                                 .q = {0.5, -1},                               \
                                 .p = {1, 0.25},                               \
                                 .make = make_##kind};
OF_TERMS(plain, 0)
OF_TERMS(again, AGAIN)
OF_TERMS(rubs, AGAIN | RUBS)
OF_TERMS(pushes, AGAIN | PUSHED)
OF_TERMS(shares, AGAIN | SHARED)
OF_TERMS(turns, AGAIN | TURNED)
static const problem *const of_points[] = {&plain,  &again,  &rubs,
                                           &pushes, &shares, &turns};
enum { OF_POINTS = sizeof of_points / sizeof *of_points };

static nevh_system *make_damped(void) {
    nevh_system *s = double_pendulum.make();
    ck_assert(
        !nevh_system_add_friction(s, "drag", (const double[]){0.21, 0.08}));
    return s;
}

/* All systems: the five problems, the last of them with friction, those of
   terms, and models. */
static int system_count(void) {
    return 6 + OF_POINTS + model_count();
}

static problem system_at(int i) {
    if (i < 5)
        return *problems[i];
    problem x = double_pendulum;
    x.make = make_damped;
    if (i < 6 + OF_POINTS)
        return i == 5 ? x : *of_points[i - 6];
    const nevh_model *model = nevh_models()[i - 6 - OF_POINTS];
    nevh_system *s = model->system(model->defaults);
    unsigned traits = nevh_system_traits(s);
    nevh_system_free(s);
    x = (problem){.name = model->name,
                  .n = model->n,
                  .separable = traits & NEVH_SEPARABLE,
                  .quadratic = traits & NEVH_QUADRATIC_KINETIC,
                  .span = 0.8,
                  .fewest = 5};
    for (size_t k = 0; k < x.n; k++) {
        x.q[k] = model->q[k] + 0.1;
        x.p[k] = model->p[k] - 0.2;
    }
    return x;
}

static nevh_system *make(const problem *x) {
    const nevh_model *model = nevh_model_named(x->name);
    return x->make ? x->make() : model->system(model->defaults);
}

/* From the first step on. */
static void count_calls(void) {
    calls.points = calls.blocks = 0;
}

/* Starts of lanes.  Where orbits that Kepler's centre is near lose energy,
   longer steps would end there. */
static many_orbits starts(const problem *x, size_t width, double q[],
                          double p[]) {
    for (size_t i = 0; i < x->n * width; i++) {
        q[i] = x->q[i / width] + 0.01 * (double)(i % width);
        p[i] = x->p[i / width] - 0.02 * (double)(i % width);
    }
    return (many_orbits){.n = x->n,
                         .width = width,
                         .steps = STEPS,
                         .t = x->t0,
                         .h = x->span / x->fewest / 16,
                         .q = q,
                         .p = p,
                         .planned = count_calls,
                         .jumps = true};
}

/* GSL takes orbits one after another, and implicit schemes may sweep the last
   one alone: that is one orbit. */
static bool takes_blocks(const nevh_integrator *scheme) {
    return scheme->explicit_form == NEVH_YES && !scheme->kernel->opaque;
}

TEST_EACH(alone_as_among_others, system_count() * scheme_count()) {
    static const size_t widths[] = {3, 8, WIDEST};
    const nevh_integrator *scheme = nevh_integrators()[_i / system_count()];
    const problem x = system_at(_i % system_count());
    if (!fits(scheme, &x) || nevh_integrator_own_time(scheme))
        skip_test("it does not fit, or takes one orbit at a time");
    with_points = true;
    nevh_system *s = make(&x);
    for (size_t i = 0; i < 6; i++) {
        double q[MOST_DOF * WIDEST], p[MOST_DOF * WIDEST];
        double end_q[MOST_DOF * WIDEST], end_p[MOST_DOF * WIDEST];
        nevh_options o = {.gradient = i % 2 ? nevh_central4 : nevh_exact,
                          .gradient_step = i % 2 ? 0x1p-9 : 0,
                          .scale = (const double[]){1, 1, 1, 1},
                          .tolerance = tolerance_for(scheme),
                          .binding = 2};
        many_orbits all = starts(&x, widths[i / 2], q, p);
        all.system = s;
        all.scheme = scheme;
        all.options = &o;
        many_orbits_run(&all, end_q, end_p);
        if (takes_blocks(scheme))
            ck_assert_uint_eq(calls.points, 0);
        ck_assert(end_q[all.width - 1] != end_q[0]);
        assert_alone(&all, 0, end_q, end_p);
        assert_alone(&all, all.width / 2, end_q, end_p);
    }
    nevh_system_free(s);
}

/* An orbit of terms that have gradients of one state, or blocks alone. */
static bool run_points(const nevh_integrator *scheme, const problem *kind,
                       bool points, size_t width, double z[4]) {
    double q[MOST_DOF * WIDEST], p[MOST_DOF * WIDEST];
    double end_q[MOST_DOF * WIDEST], end_p[MOST_DOF * WIDEST];
    nevh_options o = {.gradient = nevh_exact,
                      .scale = (const double[]){1, 1, 1, 1},
                      .tolerance = tolerance_for(scheme),
                      .binding = 2};
    with_points = points;
    many_orbits all = starts(kind, width, q, p);
    all.system = kind->make();
    all.scheme = scheme;
    all.options = &o;
    all.jumps = false;
    nevh_stepper *m = nevh_stepper_new(all.system, scheme, &o);
    bool planned = !nevh_stepper_status(m);
    nevh_stepper_free(m);
    if (planned && width > 1)
        many_orbits_run(&all, end_q, end_p);
    else if (planned)
        many_orbits_run_one(&all, 0, z, z + 2);
    nevh_system_free((nevh_system *)all.system);
    return planned;
}

TEST_EACH(points_as_blocks, OF_POINTS *scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / OF_POINTS];
    const problem *kind = of_points[_i % OF_POINTS];
    double with[4], without[4];
    if (!run_points(scheme, kind, true, 1, with))
        skip_test("it does not fit");
    ck_assert(run_points(scheme, kind, false, 1, without));
    ck_assert_uint_eq(calls.points, 0);
    ck_assert_mem_eq(with, without, sizeof with);
}

/* A splitting leaves blocks alone where each term has a point gradient, and
   takes them where there are many orbits. */
TEST_EACH(points_are_taken, OF_POINTS - 1) {
    double z[4];
    ck_assert(run_points(nevh_blanes_moan4, of_points[_i], true, 1, z));
    ck_assert_uint_eq(calls.blocks, 0);
    ck_assert_uint_gt(calls.points, 6 * STEPS);
    ck_assert(run_points(nevh_blanes_moan4, of_points[_i], true, 8, z));
    ck_assert_uint_gt(calls.blocks, 6 * STEPS);
    ck_assert_uint_eq(calls.points, 0);
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
    add_kinetic(s, 3, masses);
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
    add_kinetic(s, 1, mass);
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
    add_kinetic(s, 2, masses);
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
