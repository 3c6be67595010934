/* nevh tests: stiff systems, whose fast oscillations are stepped over.
   SPDX-License-Identifier: GPL-3.0-or-later

   The spring of an elastic pendulum swings RATIO times as fast as the pendulum,
   and a step takes ten of its periods.  The orbit starts where the spring just
   holds the weight, from which it departs but slowly. */
#include "lanes.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI    3.14159265358979323846
#define RATIO 1e4
static const double angle = 1, ten_periods = 10 * 2 * PI / RATIO;
static const nevh_elastic_pendulum bead = {1, RATIO *RATIO, 1, 1};

/* In polar coordinates: H is not T(p) + V(q). */
static nevh_system *make_polar(void) {
    return nevh_elastic_pendulum_model->system(&bead);
}

static double spring(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    const double *k = params;
    double stretch = sqrt(q[0] * q[0] + q[1] * q[1]) - 1;
    (void)t, (void)p, (void)c;
    return *k / 2 * stretch * stretch + q[1];
}

static void spring_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    const double *k = params, *x = q, *y = q + width;
    (void)t, (void)p, (void)c, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        double r = sqrt(x[i] * x[i] + y[i] * y[i]), pull = *k * (r - 1) / r;
        dq[i] = pull * x[i];
        dq[width + i] = pull * y[i] + 1;
    }
}

/* The same in the plane, where it is. */
static nevh_system *make_plane(void) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &(nevh_term){.effect = "kinetic",
                                    .np = 2,
                                    .value = plane_kinetic,
                                    .gradient = plane_kinetic_gradient});
    nevh_system_add(s, &(nevh_term){.effect = "potential",
                                    .nq = 2,
                                    .value = spring,
                                    .gradient = spring_gradient,
                                    .params = &bead.k});
    return s;
}

static void start(bool polar, double q[2], double p[2]) {
    double r = 1 + cos(angle) / bead.k;
    p[0] = p[1] = 0;
    q[0] = polar ? r : r * sin(angle);
    q[1] = polar ? angle : -r * cos(angle);
}

typedef struct {
    int status;
    size_t taken;
    nevh_counts counts;
    nevh_energy_report energy;
    double q[2], p[2];
} outcome;

static outcome run(bool polar, const nevh_integrator *scheme,
                   const nevh_gradient *g, double h, size_t steps) {
    outcome o = {0};
    nevh_system *s = polar ? make_polar() : make_plane();
    start(polar, o.q, o.p);
    nevh_options options = {.gradient = g, .q = o.q, .p = o.p};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    o.status = nevh_run(m, 0, h, steps, o.q, o.p, &watch, 1);
    o.taken = nevh_stepper_taken(m);
    o.counts = nevh_stepper_counts(m);
    o.energy = nevh_energy_result(e, 0);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
    return o;
}

/* What is solved, with how much work, and how large the energy error is. */
typedef struct {
    bool polar;
    const nevh_integrator *const *scheme;
    double error, sweeps;
} expectation;
static const expectation expected[] = {
    {true, &nevh_midpoint, 8e-7, 7},     {true, &nevh_gauss4, 2e-12, 7},
    {true, &nevh_gauss8, 5e-13, 7},      {true, &nevh_gauss16, 5e-13, 8},
    {false, &nevh_midpoint, 2.2e-3, 14}, {false, &nevh_gauss4, 3e-6, 14},
    {false, &nevh_gauss8, 3e-6, 14},     {false, &nevh_gauss16, 3e-6, 14}};
enum { EXPECTED = sizeof expected / sizeof *expected, STEPS = 4000 };

/* Rounding of r moves the force by 1e8 epsilon, and with it the energy of a
   step by some 1e-11: what high orders leave is chance below that. */
TEST_EACH(steps_of_ten_fast_periods, 2 * EXPECTED) {
    const expectation *x = &expected[_i / 2];
    outcome o = run(x->polar, *x->scheme, _i % 2 ? NULL : nevh_exact,
                    ten_periods, STEPS);
    double sweeps = (double)o.counts.sweeps / STEPS;
    ck_assert_int_eq(o.status, NEVH_OK);
    ck_assert_uint_eq(o.counts.newtons, STEPS);
    ck_assert_uint_eq(o.counts.rescues, 0);
    ck_assert_msg(sweeps < x->sweeps, "%g sweeps a step", sweeps);
    ck_assert_msg(o.energy.max < x->error, "%.2e", o.energy.max);
    ck_assert(o.energy.last_fifth < 2 * o.energy.first_fifth ||
              o.energy.max < 1e-11);
}

/* The explicit scheme is stable for h omega < 2, and says so above, with
   numbers as long as there are any; of Lobatto's pairs, the same is true. */
TEST_EACH(explicit_steps_end, 2) {
    const nevh_integrator *const schemes[] = {nevh_verlet, nevh_lobatto2};
    outcome o = run(false, schemes[_i], nevh_exact, 1.9 / RATIO, STEPS);
    ck_assert_int_eq(o.status, NEVH_OK);
    ck_assert_double_lt(o.energy.max, 1e-4);
    const double far[] = {2.1 / RATIO, ten_periods};
    for (int i = 0; i < 2; i++) {
        o = run(false, schemes[_i], nevh_exact, far[i], STEPS);
        ck_assert_int_eq(o.energy.verdict, NEVH_UNSTABLE);
        ck_assert(isfinite(o.energy.max));
        ck_assert(o.status == NEVH_OK || o.status == NEVH_EDOM ||
                  o.status == NEVH_STOPPED);
        for (int k = 0; k < 2; k++)
            ck_assert(isfinite(o.q[k]) && isfinite(o.p[k]));
    }
}

/* A string of N beads between stiff springs, weakly tied to their places. */
enum { N = 24 };
static const double stiffness = 9e6;

static double chain(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    double h = 0, before = 0;
    (void)t, (void)p, (void)c, (void)params;
    for (size_t k = 0; k < N; before = q[k++]) {
        double d = q[k] - before;
        h += stiffness / 2 * d * d + d * d * d * d / 4 - cos(q[k]);
    }
    return h;
}

static void chain_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        for (size_t k = 0; k < N; k++)
            dq[k * width + i] = sin(q[k * width + i]);
        for (size_t k = 0; k < N; k++) {
            double before = k ? q[(k - 1) * width + i] : 0;
            double d = q[k * width + i] - before;
            double pull = stiffness * d + d * d * d;
            dq[k * width + i] += pull;
            if (k)
                dq[(k - 1) * width + i] -= pull;
        }
    }
}

static nevh_system *make_chain(size_t n) {
    nevh_system *s = nevh_system_new(n);
    double *masses = malloc(n * sizeof *masses);
    for (size_t k = 0; k < n; k++)
        masses[k] = 1;
    add_kinetic(s, n, masses);
    nevh_system_add(s, &(nevh_term){.effect = "springs",
                                    .nq = N,
                                    .value = chain,
                                    .gradient = chain_gradient});
    free(masses);
    return s;
}

TEST(many_stiff_springs) {
    nevh_system *s = make_chain(N);
    double q[N], p[N], h = 3 * 2 * PI / sqrt(stiffness);
    for (size_t k = 0; k < N; k++) {
        q[k] = 0.1 * (double)(k + 1) / N;
        p[k] = 0.3 * sin((double)k + 1);
    }
    nevh_options options = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_stepper *m = nevh_stepper_new(s, nevh_gauss4, &options);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    ck_assert_int_eq(nevh_run(m, 0, h, 1000, q, p, &watch, 1), NEVH_OK);
    nevh_counts c = nevh_stepper_counts(m);
    ck_assert_uint_eq(c.newtons, 1000);
    ck_assert_uint_eq(c.rescues, 0);
    ck_assert_uint_le(c.sweeps, 8 * 1000);
    ck_assert_double_lt(nevh_energy_result(e, 0).max, 1e-8);
    ck_assert_int_eq(nevh_energy_result(e, 0).verdict, NEVH_BOUNDED);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Beyond 1024 unknowns no matrices are made, and the verdict says so. */
TEST(too_large_for_matrices) {
    enum { MANY = 513 };
    static double q[MANY], p[MANY];
    nevh_system *s = make_chain(MANY);
    q[3] = 0.1;
    nevh_options options = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_stepper *m = nevh_stepper_new(s, nevh_midpoint, &options);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.01, q, p), NEVH_EMAXITER);
    assert_says(nevh_stepper_message(m), "too large");
    ck_assert_uint_eq(nevh_stepper_counts(m).newtons, 0);
    ck_assert_double_eq(q[3], 0.1);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 1e-4, q, p), NEVH_OK);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* A harmonic oscillator: 200 steps of h omega as given, then 200 of 0.1. */
static nevh_counts counts_at(double h, nevh_counts *soft) {
    static const nevh_oscillator params = {1, 1};
    nevh_system *s = nevh_oscillator_model->system(&params);
    nevh_options options = {.gradient = nevh_exact};
    nevh_stepper *m = nevh_stepper_new(s, nevh_midpoint, &options);
    double q = 1, p = 0;
    ck_assert_int_eq(nevh_run(m, 0, h, 200, &q, &p, NULL, 0), NEVH_OK);
    nevh_counts c = nevh_stepper_counts(m);
    ck_assert_int_eq(nevh_run(m, 200 * h, 0.1, 200, &q, &p, NULL, 0), NEVH_OK);
    *soft = nevh_stepper_counts(m);
    soft->newtons -= c.newtons;
    nevh_stepper_free(m);
    nevh_system_free(s);
    return c;
}

/* The contraction decides: (h omega / 2)^2 a sweep for the midpoint rule.  At
   0.8, a hundred sweeps and more would go on each step.  Where that has passed,
   sweeps are tried again before long. */
TEST(newton_where_it_is_cheaper) {
    nevh_counts soft, c = counts_at(0.9, &soft);
    ck_assert_uint_eq(c.newtons + soft.newtons, 0);
    c = counts_at(1.79, &soft);
    ck_assert_uint_eq(c.newtons, 200);
    ck_assert_uint_le(c.sweeps, 6 * 200);
    ck_assert_uint_eq(c.rescues, 0);
    ck_assert_uint_le(soft.newtons, 50);
}

/* Coupled springs with all kinds of terms but those that `mixed` adds. */
static double momenta(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2 + 0.3 * p[0] * p[1] + p[1] * p[1] / 3;
}

static double coordinates(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return 5 * q[0] * q[0] + 3 * q[0] * q[1] + 7 * q[1] * q[1];
}

static double products(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)t, (void)c, (void)params;
    return 0.9 * q[0] * p[1] - 0.4 * q[1] * p[1];
}

static nevh_system *make_linear(bool mixed) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(
        s, &(nevh_term){.effect = "momenta", .np = 2, .value = momenta});
    nevh_system_add(
        s,
        &(nevh_term){.effect = "coordinates", .nq = 2, .value = coordinates});
    nevh_system_add(
        s, &(nevh_term){
               .effect = "products", .nq = 2, .np = 2, .value = products});
    nevh_system_enable(s, "products", mixed);
    return s;
}

static const nevh_integrator *const *const schemes[] = {
    &nevh_midpoint, &nevh_gauss4, &nevh_gauss8, &nevh_lobatto4, &nevh_lobatto6};
static const double wide[] = {0.9, 2, 5, 0.9, 2}; /* steps */
enum { SCHEMES = sizeof schemes / sizeof *schemes, FEW = 5 };

/* Where equations are linear, Newton's matrix is exact and one sweep solves
   them, whatever the units; two more find that out. */
TEST_EACH(linear_stages_in_one_sweep, 4 * SCHEMES) {
    static const double odd[] = {1, 64, 0.5, 4};
    nevh_system *s = make_linear(_i % 2);
    nevh_options options = {.gradient = nevh_central2,
                            .gradient_step = 1,
                            .scale = _i / 2 % 2 ? odd : NULL};
    nevh_stepper *m = nevh_stepper_new(s, *schemes[_i / 4], &options);
    double q[] = {1, -0.4}, p[] = {0.3, 0.7};
    ck_assert_int_eq(nevh_run(m, 0, wide[_i / 4], FEW, q, p, NULL, 0), NEVH_OK);
    nevh_counts c = nevh_stepper_counts(m);
    ck_assert_uint_eq(c.newtons, FEW);
    ck_assert_uint_eq(c.rescues, 0);
    ck_assert_msg(c.sweeps <= 50, "%s: %lu sweeps",
                  nevh_integrator_name(*schemes[_i / 4]),
                  (unsigned long)c.sweeps);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* How long Newton's iteration goes first is part of the memory: a run that is
   copied or resumed goes on bit for bit, with the same work. */
TEST_EACH(memory_of_newton, EXPECTED) {
    const nevh_integrator *scheme = *expected[_i].scheme;
    bool polar = expected[_i].polar;
    nevh_system *s = polar ? make_polar() : make_plane();
    double q[2], p[2], x[2], y[2];
    start(polar, q, p);
    nevh_options options = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    nevh_stepper *loaded = nevh_stepper_new(s, scheme, &options);
    nevh_run(m, 0, ten_periods, 77, q, p, NULL, 0);
    uint64_t before = nevh_stepper_counts(m).sweeps;
    size_t size = nevh_stepper_save_size(m);
    void *saved = malloc(size);
    nevh_stepper_save(m, saved);
    ck_assert_int_eq(nevh_stepper_load(loaded, saved, size), NEVH_OK);
    nevh_stepper *others[] = {nevh_stepper_copy(m), loaded};
    double t = 77 * ten_periods, start_q[2], start_p[2];
    memcpy(start_q, q, sizeof q);
    memcpy(start_p, p, sizeof p);
    nevh_run(m, t, ten_periods, 60, q, p, NULL, 0);
    for (int i = 0; i < 2; i++) {
        memcpy(x, start_q, sizeof q);
        memcpy(y, start_p, sizeof p);
        nevh_run(others[i], t, ten_periods, 60, x, y, NULL, 0);
        ck_assert_mem_eq(x, q, sizeof q);
        ck_assert_mem_eq(y, p, sizeof p);
        ck_assert_uint_eq(nevh_stepper_counts(others[i]).sweeps,
                          nevh_stepper_counts(m).sweeps - before);
        nevh_stepper_free(others[i]);
    }
    free(saved);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Lanes are stiff each for itself. */
TEST_EACH(stiff_lanes_are_alone, EXPECTED) {
    enum { MANY = 70 };
    bool polar = expected[_i].polar;
    nevh_system *s = polar ? make_polar() : make_plane();
    const nevh_options o = {.gradient = nevh_exact,
                            .scale = (const double[]){1, 1, 1, 1}};
    double q[6], p[6], x[2], y[2];
    start(polar, x, y);
    for (size_t i = 0; i < 6; i++) {
        q[i] = x[i / 3] * (1 + 1e-5 * (double)(i % 3));
        p[i] = y[i / 3];
    }
    nevh_counts counts = assert_lanes_are_alone(
        &(many_orbits){s, *expected[_i].scheme, &o, 2, 3, MANY, 0, ten_periods,
                       q, p, false, NULL});
    ck_assert_uint_eq(counts.newtons, 3 * MANY);
    nevh_system_free(s);
}
