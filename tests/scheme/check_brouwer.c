/* nevh tests: Brouwer's law.  Energy errors of rounding grow with the root of
   the number of steps, and in no direction, where the stages are solved to the
   last bit, sums are compensated and the coefficients are exactly symplectic;
   without any of these they do not.
   SPDX-License-Identifier: GPL-3.0-or-later

   The law is one of chance, so it is looked at over orbits side by side. */
#include "support.h"
#include "kernels/stage_sweeps_private.h"
#include "kernels/tableau_private.h"
#include <math.h>
#include <nevh/extend.h>
#include <string.h>

enum { LANES = 16, SHARE = 16 };

static nevh_system *make_kepler(void) {
    return gravity_system((const double[]){1, 1}, 1);
}

/* Semi-major axis 1, the eccentricity 0.6 in lane 0, a little less in others;
   q: n x width. */
static void start_kepler(size_t width, double q[], double p[]) {
    for (size_t i = 0; i < width; i++) {
        double e = 0.6 - 0.002 * (double)i;
        q[i] = 1 - e;
        q[width + i] = p[i] = 0;
        p[width + i] = sqrt((1 + e) / (1 - e));
    }
}

static nevh_system *make_pendulum(void) {
    static const nevh_pendulum params = {1, 1, 1};
    return nevh_pendulum_model->system(&params);
}

static void start_pendulum(size_t width, double q[], double p[]) {
    for (size_t i = 0; i < width; i++) {
        q[i] = 2 - 0.01 * (double)i;
        p[i] = 0;
    }
}

typedef struct {
    const nevh_integrator *const *scheme;
    nevh_system *(*make)(void);
    void (*start)(size_t width, double q[], double p[]);
    double h;
} orbits;

static const orbits all[] = {
    {&nevh_gauss12, make_pendulum, start_pendulum, 0.1},
    {&nevh_gauss16, make_pendulum, start_pendulum, 0.1},
    {&nevh_gauss12, make_kepler, start_kepler, 0.05},
    {&nevh_gauss16, make_kepler, start_kepler, 0.1}};
enum { ALL = sizeof all / sizeof *all };

/* Relative energy errors of `width` orbits: the root of their mean square
   after part of the steps and after all, their mean, and the largest. */
typedef struct {
    double early, late, mean, most;
} errors;

static double mean_square(const nevh_energy *e, size_t width, double *mean) {
    double sum = 0;
    *mean = 0;
    for (size_t lane = 0; lane < width; lane++) {
        double error = nevh_energy_result(e, lane).final;
        sum += error * error / (double)width;
        *mean += error / (double)width;
    }
    return sqrt(sum);
}

static errors errors_of(const orbits *o, const nevh_integrator *scheme,
                        size_t width, size_t steps) {
    double q[2 * LANES], p[2 * LANES];
    nevh_system *s = o->make();
    o->start(width, q, p);
    nevh_options options = {
        .gradient = nevh_exact, .q = q, .p = p, .width = width};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    nevh_energy *e = nevh_energy_new(s, &options);
    nevh_observer watch = {nevh_energy_observe, e, 100};
    size_t first = steps / SHARE;
    errors r = {0};
    ck_assert_int_eq(nevh_run(m, 0, o->h, first, q, p, &watch, 1), NEVH_OK);
    r.early = mean_square(e, width, &r.mean);
    ck_assert_int_eq(
        nevh_run(m, (double)first * o->h, o->h, steps - first, q, p, &watch, 1),
        NEVH_OK);
    r.late = mean_square(e, width, &r.mean);
    for (size_t lane = 0; lane < width; lane++)
        r.most = fmax(r.most, nevh_energy_result(e, lane).max);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
    return r;
}

enum { STEPS = 32000 };

/* Errors of either sign, that grow fourfold in sixteen times the steps. */
TEST_EACH(errors_walk_at_random, ALL) {
    const orbits *o = &all[_i];
    errors r = errors_of(o, *o->scheme, LANES, STEPS);
    ck_assert_msg(r.late < 7e-15 && r.late < 8 * r.early &&
                      fabs(r.mean) < 0.75 * r.late,
                  "%.2e, before %.2e, mean %.2e", r.late, r.early, r.mean);
}

/* A million steps and more of one orbit. */
static void check_one(const orbits *o, size_t steps, double most) {
    errors r = errors_of(o, *o->scheme, 1, steps);
    ck_assert_msg(r.most <= most, "%.2e", r.most);
}

TEST_RANGE(a_million_steps, 1, 2) {
    check_one(&all[_i], 1000000, 3e-14);
}
TEST_ALSO(a_million_steps, "slow", 0, ALL)

TEST_TAGGED(ten_million_steps, "slow", 0, ALL) {
    check_one(&all[_i], 10000000, _i < 2 ? 5e-14 : 1e-13);
}

/* Schemes of which something is taken away. */
static errors errors_without(const orbits *o, const nevh_kernel *kernel) {
    nevh_integrator i = **o->scheme;
    i.kernel = kernel;
    return errors_of(o, &i, LANES, STEPS);
}

static int step_without_compensation(nevh_work *w, double t, double h,
                                     double q[], double p[]) {
    int status = nevh_gauss_kernel.step(w, t, h, q, p);
    memset(w->memory, 0, 2 * w->size * sizeof *w->memory);
    return status;
}

TEST_EACH(sums_without_compensation, 1) {
    nevh_kernel kernel = nevh_gauss_kernel;
    kernel.step = step_without_compensation;
    errors r = errors_without(&all[_i], &kernel);
    ck_assert_msg(r.late > 1.4e-14, "%.2e", r.late);
}

/* mu = a / b, both rounded, as they stand in tables. */
static int plan_rounded(nevh_work *w) {
    int status = nevh_gauss_kernel.plan(w);
    if (status)
        return status;
    const struct {
        nevh__tableau *tableau;
        nevh__stage_weights *weights;
    } *g = w->plan;
    nevh__tableau *a = g->tableau;
    for (size_t m = 0; m < a->stages * a->stages; m++)
        a->mu_q[m] = a->mu_p[m] = a->a_q[m] / a->b[m / a->stages];
    nevh__stage_weights_take(g->weights, a);
    return NEVH_OK;
}

/* All orbits lose energy, the more the longer. */
TEST_EACH(rounded_coefficients_drift, 1) {
    nevh_kernel kernel = nevh_gauss_kernel;
    kernel.plan = plan_rounded;
    errors r = errors_without(&all[_i], &kernel);
    ck_assert_msg(fabs(r.mean) > 0.9 * r.late && r.late > 5e-15,
                  "%.2e, mean %.2e", r.late, r.mean);
}
TEST_ALSO(rounded_coefficients_drift, NULL, 2, 3)

/* The state is q + compensation, in the stages as in the sum: a step is the same
   wherever the point is set. */
static int step_with_compensation(nevh_work *w, double t, double h, double q[],
                                  double p[]) {
    w->memory[0] = 0.25;
    w->memory[1] = -0.125;
    return nevh_gauss_kernel.step(w, t, h, q, p);
}

TEST(compensation_is_part_of_the_state) {
    nevh_kernel kernel = nevh_gauss_kernel;
    kernel.step = step_with_compensation;
    nevh_integrator split = *nevh_gauss8;
    split.kernel = &kernel;
    nevh_system *s = make_pendulum();
    nevh_options options = {.gradient = nevh_exact};
    nevh_stepper *carried = nevh_stepper_new(s, &split, &options);
    nevh_stepper *plain = nevh_stepper_new(s, nevh_gauss8, &options);
    double q[] = {1, 1.25}, p[] = {0.5, 0.375};
    ck_assert_int_eq(nevh_stepper_apply(carried, 0, 0.1, q, p), NEVH_OK);
    ck_assert_int_eq(nevh_stepper_apply(plain, 0, 0.1, q + 1, p + 1), NEVH_OK);
    ck_assert_double_eq_tol(q[0], q[1], 4e-16);
    ck_assert_double_eq_tol(p[0], p[1], 4e-16);
    nevh_stepper_free(carried);
    nevh_stepper_free(plain);
    nevh_system_free(s);
}
