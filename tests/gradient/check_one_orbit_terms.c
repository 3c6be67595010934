/* nevh tests: one orbit of an H of several terms.

   Terms that share variables are added up in place, or variable by variable, in
   ways that depend on how many lanes there are; none of that may be seen.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/extend.h>

enum { STEPS = 12, WIDTH = 8 };

static void add_kinetic(nevh_system *s, size_t count, const size_t *at) {
    static const double masses[] = {2, 3};
    ck_assert(
        !nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                         .np = 1,
                                         .nc = 1,
                                         .p = at,
                                         .c = masses,
                                         .count = count,
                                         .value = mass_kinetic,
                                         .gradient = mass_kinetic_gradient}));
}

/* Both halves of H are sums of two terms. */
static nevh_system *in_parts(bool friction) {
    static const size_t all[] = {0, 1}, one[] = {1};
    nevh_system *s = nevh_system_new(2);
    add_waves(s, 2, all);
    add_kinetic(s, 2, all);
    add_waves(s, 1, one);
    add_kinetic(s, 1, one);
    if (friction)
        ck_assert(
            !nevh_system_add_friction(s, "drag", (const double[]){0.3, 0.1}));
    return s;
}

static nevh_stepper *plan_parts(const nevh_system *s,
                                const nevh_integrator *scheme, size_t width) {
    static const double q[2 * WIDTH] = {0}, p[2 * WIDTH] = {0};
    return nevh_stepper_new(
        s, scheme,
        &(nevh_options){.gradient = nevh_exact,
                        .width = width,
                        .scale = (const double[]){1, 1, 1, 1},
                        .q = q,
                        .p = p,
                        .tolerance = tolerance_for(scheme),
                        .binding = 2});
}

/* The second half of the way by another stepper, which is told what the first
   one knows. */
static void go_in_two(const nevh_system *s, const nevh_integrator *scheme,
                      double q[], double p[]) {
    char saved[8192];
    nevh_stepper *first = plan_parts(s, scheme, 1);
    nevh_stepper *second = plan_parts(s, scheme, 1);
    size_t size = nevh_stepper_save_size(first);
    ck_assert(size <= sizeof saved);
    ck_assert(!nevh_run(first, 0, 0.2, STEPS / 2, q, p, NULL, 0));
    nevh_stepper_save(first, saved);
    ck_assert(!nevh_stepper_load(second, saved, size));
    ck_assert(!nevh_run(second, STEPS / 2 * 0.2, 0.2, STEPS - STEPS / 2, q, p,
                        NULL, 0));
    nevh_stepper_free(first);
    nevh_stepper_free(second);
}

TEST_EACH(in_parts_and_in_two, 2 * scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / 2];
    double q[2 * WIDTH], p[2 * WIDTH], one_q[] = {0.5, -1}, one_p[] = {1, 0.25};
    nevh_system *s = in_parts(_i % 2);
    nevh_stepper *all = plan_parts(s, scheme, WIDTH);
    ck_assert((nevh_stepper_status(all) != NEVH_OK) ==
              nevh_integrator_own_time(scheme));
    if (!nevh_integrator_own_time(scheme)) {
        for (size_t i = 0; i < 2 * WIDTH; i++) {
            q[i] = one_q[i / WIDTH] + (i % WIDTH == 5 ? 0 : 0.1);
            p[i] = one_p[i / WIDTH];
        }
        ck_assert(!nevh_run(all, 0, 0.2, STEPS / 2, q, p, NULL, 0));
        ck_assert(!nevh_run(all, STEPS / 2 * 0.2, 0.2, STEPS - STEPS / 2, q, p,
                            NULL, 0));
        go_in_two(s, scheme, one_q, one_p);
        for (size_t k = 0; k < 2; k++) {
            ck_assert(q[k * WIDTH + 5] == one_q[k]);
            ck_assert(p[k * WIDTH + 5] == one_p[k]);
        }
    }
    nevh_stepper_free(all);
    nevh_system_free(s);
}

static double bond(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    return -c[0] * cos(q[0] - q[1]);
}

static void bond_gradient(size_t width, const double t[], const double q[],
                          const double p[], const double c[],
                          const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        dq[i] = c[i] * sin(q[i] - q[width + i]);
        dq[width + i] = -dq[i];
    }
}

/* So many on one coordinate, and so unlike, that the order of a sum shows. */
static nevh_system *bonds(void) {
    static const size_t at[] = {0, 1, 1, 2, 2, 1, 1, 0, 2, 0};
    static const double c[] = {1.25, 0.7, 1e-3, 3.1, 0.9};
    nevh_system *s = nevh_system_new(3);
    ck_assert(!nevh_system_add(s, &(nevh_term){.effect = "bonds",
                                               .nq = 2,
                                               .nc = 1,
                                               .q = at,
                                               .c = c,
                                               .count = 5,
                                               .value = bond,
                                               .gradient = bond_gradient}));
    return s;
}

/* Each lane has what it would have alone, to the last bit. */
TEST_EACH(sums_in_one_order, 4) {
    static const size_t widths[] = {1, 3, 8, 16};
    enum { STATES = 40 };
    size_t width = widths[_i];
    nevh_system *s = bonds();
    nevh_field *f = nevh_field_new(s, &(nevh_options){.gradient = nevh_exact});
    ck_assert_int_eq(nevh_field_status(f), NEVH_OK);
    for (int state = 0; state < STATES; state++) {
        double t[16] = {0}, q[48], p[48] = {0}, g[48], x[3];
        for (size_t k = 0; k < 3; k++)
            x[k] = sin(1.7 * state + (double)k);
        for (size_t i = 0; i < 3 * width; i++)
            q[i] = x[i / width] + (i % width == width - 1 ? 0 : 0.01);
        double a = sin(x[0] - x[1]), b = sin(x[1] - x[2]);
        double c = sin(x[2] - x[1]), d = sin(x[1] - x[0]);
        double second = 0.7 * b + 3.1 * d - 1.25 * a - 1e-3 * c;
        ck_assert(!nevh_field_gradient(f, width, t, q, p, g, NULL));
        ck_assert(g[2 * width - 1] == second);
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

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

/* Of the last, a term's coordinates do not stand as it wants them. */
enum kind { PLAIN, RUBS, PUSHED, SHARED, TURNED, KINDS };

/* Terms on both coordinates, on one of them again, and on one momentum. */
static nevh_system *of_points(enum kind kind, bool points) {
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
                      .point_gradient = points ? wave_point : NULL};
    nevh_term kinetic = {.effect = "kinetic",
                         .np = 1,
                         .nc = 1,
                         .p = all,
                         .c = masses,
                         .count = 2,
                         .value = mass_kinetic,
                         .gradient = mass_kinetic_gradient,
                         .point_gradient = points ? kinetic_point : NULL};
    nevh_term push = {.effect = "push",
                      .nq = 2,
                      .q = kind == TURNED ? turned : all,
                      .time = true,
                      .value = pushed,
                      .gradient = pushed_block,
                      .point_gradient = points ? pushed_point : NULL};
    ck_assert(!nevh_system_add(s, &wave) && !nevh_system_add(s, &kinetic));
    wave.q = kinetic.p = one;
    wave.count = kind == SHARED ? 2 : 1;
    kinetic.count = 1;
    if (kind != PLAIN)
        ck_assert(!nevh_system_add(s, &wave) && !nevh_system_add(s, &kinetic));
    if (kind == RUBS)
        ck_assert(
            !nevh_system_add_friction(s, "drag", (const double[]){0.3, 0.1}));
    if (kind == PUSHED || kind == TURNED)
        ck_assert(!nevh_system_add(s, &push));
    return s;
}

/* Whether a scheme takes that H; lane 5 of eight, or the only one, to x. */
static bool run_points(const nevh_integrator *scheme, enum kind kind,
                       bool points, size_t width, double x[4]) {
    static const double start[] = {0.5, -1, 1, 0.25};
    double z[4 * WIDTH], *p = z + 2 * width;
    size_t lane = width == 1 ? 0 : 5;
    nevh_system *s = of_points(kind, points);
    nevh_stepper *stepper = plan_parts(s, scheme, width);
    bool planned = !nevh_stepper_status(stepper);
    for (size_t i = 0; i < 4 * width; i++)
        z[i] = start[i / width] + (i % width == lane ? 0 : 0.1);
    calls.points = calls.blocks = 0;
    if (planned) {
        nevh_run(stepper, 0, 0.2, STEPS, z, p, NULL, 0);
        ck_assert_str_eq(nevh_stepper_message(stepper), "");
    }
    for (size_t k = 0; k < 4; k++)
        x[k] = z[k * width + lane];
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return planned;
}

TEST_EACH(points_as_blocks, KINDS *scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / KINDS];
    enum kind kind = _i % KINDS;
    double with[4], without[4], among[4];
    if (!run_points(scheme, kind, true, 1, with))
        skip_test("it does not fit");
    ck_assert(run_points(scheme, kind, false, 1, without));
    ck_assert_uint_eq(calls.points, 0);
    ck_assert_mem_eq(with, without, sizeof with);
    if (run_points(scheme, kind, true, WIDTH, among)) {
        ck_assert_mem_eq(with, among, sizeof with);
        /* GSL takes orbits one after another, and implicit schemes may sweep
           the last one alone: that is one orbit. */
        if (scheme->explicit_form == NEVH_YES && !scheme->kernel->opaque)
            ck_assert_uint_eq(calls.points, 0);
    }
}

/* A splitting leaves blocks alone where each term has a point gradient, and
   takes them where there are many orbits. */
TEST_EACH(points_are_taken, TURNED) {
    double x[4];
    ck_assert(run_points(nevh_blanes_moan4, _i, true, 1, x));
    ck_assert_uint_eq(calls.blocks, 0);
    ck_assert_uint_gt(calls.points, 6 * STEPS);
    ck_assert(run_points(nevh_blanes_moan4, _i, true, WIDTH, x));
    ck_assert_uint_gt(calls.blocks, 6 * STEPS);
    ck_assert_uint_eq(calls.points, 0);
}
