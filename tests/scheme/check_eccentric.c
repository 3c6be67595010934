/* nevh tests: orbits that come close, under steps that follow them.
   SPDX-License-Identifier: GPL-3.0-or-later

   Kepler's problem with unit masses and semi-major axis: a period is 2 pi. */
#include "support.h"
#include <math.h>
#include <nevh/transform.h>
#include <string.h>

static nevh_system *make_kepler(void) {
    return gravity_system((const double[]){1, 1}, 1);
}

static const double period = 6.283185307179586;

/* An orbit of some eccentricity from one of its ends, in so many nominal steps
   a period; power 0: no s. */
typedef struct {
    const nevh_integrator *scheme;
    const nevh_gradient *gradient;
    double power, e;
    bool from_pericentre;
    double steps, periods;
} orbit;

typedef struct {
    nevh_energy_report energy;
    double cost;   /* evaluations of H a period */
    double sweeps; /* of a step */
} result;

/* The sum of dt s0/s over a period; dt = r dE. */
static double nominal_period(const orbit *o, double r0) {
    enum { PARTS = 4000 };
    bool own = nevh_integrator_own_time(o->scheme) && o->power == 0;
    double sum = 0, power = own ? 1.5 : o->power;
    for (int i = 0; i < PARTS; i++) {
        double r = 1 - o->e * cos(period * (i + 0.5) / PARTS);
        sum += r * pow(r0 / r, power) * period / PARTS;
    }
    return sum;
}

static result follow(const orbit *o) {
    double e = o->from_pericentre ? o->e : -o->e, r0 = 1 - e;
    double q[] = {r0, 0}, p[] = {0, sqrt((1 + e) / (1 - e))};
    nevh_system *h = make_kepler();
    nevh_system *s = o->power != 0 ? nevh_distance_power(2, 2, o->power) : NULL;
    nevh_options options = {
        .gradient = o->gradient, .q = q, .p = p, .transform = s};
    nevh_stepper *m = nevh_stepper_new(h, o->scheme, &options);
    nevh_energy *energy = nevh_energy_new(h, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    ck_assert_msg(nevh_stepper_status(m) == NEVH_OK, "%s",
                  nevh_stepper_message(m));
    int status = nevh_run_until(m, 0, nominal_period(o, r0) / o->steps,
                                o->periods * period, q, p, &watch, 1);
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(m));
    result found = {nevh_energy_result(energy, 0),
                    nevh_stepper_counts(m).hamiltonians / o->periods,
                    (double)nevh_stepper_counts(m).sweeps /
                        (double)nevh_stepper_taken(m)};
    nevh_energy_free(energy);
    nevh_stepper_free(m);
    nevh_system_free(h);
    nevh_system_free(s);
    return found;
}

/* Errors at a few nominal steps a period: what was measured, rounded up. */
typedef struct {
    const nevh_integrator *const *scheme;
    double power, e, steps, error;
} level;
static const level levels[] = {{&nevh_gauss4, 1.5, 0.9, 60, 5e-5},
                               {&nevh_gauss4, 1, 0.9, 120, 1e-5},
                               {&nevh_gauss6, 1.5, 0.9, 40, 2e-7},
                               {&nevh_gauss6, 1, 0.99, 120, 1e-5},
                               {&nevh_gauss8, 1.5, 0.99, 60, 5e-10},
                               {&nevh_gauss8, 1, 0.9, 30, 1e-7},
                               {&nevh_adaptive_verlet, 1.5, 0.9, 300, 6e-3},
                               {&nevh_adaptive_verlet, 0, 0.9, 300, 1e-2}};
enum { LEVELS = sizeof levels / sizeof *levels };

/* Of differences of a potential that reaches 100. */
static const double noise = 2e-7;

static void stays_bounded(int i, double periods, bool exact) {
    const level *l = &levels[i / 2];
    orbit o = {*l->scheme, exact ? nevh_exact : nevh_central4,
               l->power,   l->e,
               i % 2,      l->steps,
               periods};
    nevh_energy_report r = follow(&o).energy;
    bool fine = exact ? r.verdict == NEVH_BOUNDED && r.max < l->error
                      : r.verdict != NEVH_DRIFTS && r.max < l->error + noise;
    ck_assert_msg(fine, "%s, s = r^%g, e = %g: %s, %.2e",
                  nevh_integrator_name(o.scheme), o.power, o.e,
                  nevh_verdict_name(r.verdict), r.max);
}

TEST_EACH(bounded, 2 * LEVELS) {
    stays_bounded(_i, 30, true);
    stays_bounded(_i, 5, false);
}

TEST_TAGGED(bounded_for_long, "slow", 0, 2 * LEVELS) {
    stays_bounded(_i, 1000, true);
}

/* The same steps taken naively, and under a scheme that is not symplectic. */
TEST_EACH(contrast, 3) {
    static const nevh_integrator *const *schemes[] = {
        &nevh_naive_adaptive_verlet, &nevh_naive_adaptive_verlet, &nevh_rk4};
    static const double power[] = {1.5, 0, 1.5}, steps[] = {300, 300, 100};
    orbit o = {*schemes[_i], nevh_exact, power[_i], 0.9, false, steps[_i], 250};
    nevh_energy_report r = follow(&o).energy;
    bool drifts = o.scheme == nevh_rk4 || r.verdict == NEVH_DRIFTS;
    ck_assert_msg(drifts && r.last_fifth > 3 * r.first_fifth, "%s: %s",
                  nevh_integrator_name(o.scheme), nevh_verdict_name(r.verdict));
}

/* The work of a scheme under fixed steps, for an energy error no smaller than
   given: doubled steps until it is reached, and back by the order. */
static double work_of_fixed(const nevh_integrator *scheme, double e,
                            double error, double steps) {
    double order = nevh_integrator_order(scheme);
    for (;; steps *= 2) {
        orbit o = {scheme, nevh_central4, 0, e, false, steps, 2};
        result r = follow(&o);
        if (r.energy.max <= error)
            return r.cost * pow(r.energy.max / error, 1 / order);
    }
}

/* Evaluations of H, values only, for the same error of the energy. */
TEST_EACH(less_work_than_fixed_steps, 6) {
    static const struct {
        const nevh_integrator *const *scheme, *const *fixed;
        double power, e, steps, first, share;
    } races[] = {
        {&nevh_gauss4, &nevh_gauss4, 1.5, 0.9, 120, 1600, 0.25},
        {&nevh_gauss6, &nevh_gauss6, 1.5, 0.9, 90, 1600, 0.2},
        {&nevh_gauss8, &nevh_gauss8, 1.5, 0.9, 30, 800, 0.25},
        {&nevh_gauss6, &nevh_gauss6, 1, 0.99, 120, 12800, 0.05},
        {&nevh_adaptive_verlet, &nevh_verlet, 1.5, 0.9, 600, 8000, 0.15},
        {&nevh_adaptive_verlet, &nevh_verlet, 0, 0.9, 600, 8000, 0.4}};
    orbit o = {*races[_i].scheme,
               nevh_central4,
               races[_i].power,
               races[_i].e,
               false,
               races[_i].steps,
               2};
    result r = follow(&o);
    double fixed =
        work_of_fixed(*races[_i].fixed, o.e, r.energy.max, races[_i].first);
    ck_assert_msg(r.cost < races[_i].share * fixed, "%s: %.0f of %.0f",
                  nevh_integrator_name(o.scheme), r.cost, fixed);
}

/* The noise of differences is that of K: far from the start s may be much
   larger than there, or much smaller. */
TEST_EACH(noise_ends_the_iteration, 4) {
    orbit o = {nevh_gauss6, nevh_exact, 1.5, _i / 2 ? 0.99 : 0.9,
               _i % 2,      120,        5};
    result exact = follow(&o);
    o.gradient = nevh_central4;
    result differences = follow(&o);
    ck_assert_msg(differences.sweeps < 1.15 * exact.sweeps, "%.1f, %.1f exact",
                  differences.sweeps, exact.sweeps);
}

/* Two bodies whose closeness is s are Kepler's problem once more. */
static double attraction(double t, const double q[], const double p[],
                         const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -0.3 / hypot(q[2] - q[0], q[3] - q[1]);
}

TEST(two_bodies) {
    static const size_t momenta[] = {0, 1, 2, 3};
    static const double masses[] = {1, 1, 0.3, 0.3};
    const double q[] = {0, 0, 1.9, 0}, p[] = {0, 0, 0, 0.08};
    nevh_system *h = nevh_system_new(4);
    nevh_system *s = nevh_closeness_power(2, 2, 1.5);
    nevh_system_add(h, &(nevh_term){.effect = "kinetic",
                                    .np = 1,
                                    .nc = 1,
                                    .p = momenta,
                                    .c = masses,
                                    .count = 4,
                                    .value = mass_kinetic});
    nevh_system_add(
        h, &(nevh_term){.effect = "gravity", .nq = 4, .value = attraction});
    nevh_stepper *m = nevh_stepper_new(
        h, nevh_gauss6, &(nevh_options){.q = q, .p = p, .transform = s});
    nevh_energy *energy = nevh_energy_new(h, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    double x[4], y[4];
    memcpy(x, q, sizeof x);
    memcpy(y, p, sizeof y);
    ck_assert_msg(nevh_run_until(m, 0, 0.3, 60, x, y, &watch, 1) == NEVH_OK,
                  "%s", nevh_stepper_message(m));
    ck_assert_double_lt(nevh_energy_result(energy, 0).max, 1e-4);
    ck_assert_double_eq_tol(y[1] + y[3], 0.08, 1e-9);
    nevh_energy_free(energy);
    nevh_stepper_free(m);
    nevh_system_free(h);
    nevh_system_free(s);
}

/* Straight into the centre: steps shrink to nothing, and that is said. */
TEST_EACH(collision, 48) {
    static const nevh_integrator *const *schemes[] = {
        &nevh_midpoint, &nevh_gauss4,          &nevh_gauss8,
        &nevh_rk4,      &nevh_adaptive_verlet, &nevh_naive_adaptive_verlet};
    static const double powers[] = {1, 1.5, 2, 0};
    const nevh_integrator *scheme = *schemes[_i / 8];
    double power = powers[_i / 2 % 4];
    if (power == 0 && !nevh_integrator_own_time(scheme))
        skip_test("nothing shortens its steps");
    nevh_system *h = make_kepler();
    nevh_system *s = power != 0 ? nevh_distance_power(2, 2, power) : NULL;
    double q[] = {1, 0}, p[] = {0, 0};
    nevh_options o = {.gradient = _i % 2 ? nevh_central4 : nevh_exact,
                      .gradient_step = 1e-4,
                      .q = q,
                      .p = p,
                      .transform = s};
    nevh_stepper *m = nevh_stepper_new(h, scheme, &o);
    int status = nevh_run_until(m, 0, 0.01, 10, q, p, NULL, 0);
    ck_assert(isfinite(q[0]) && isfinite(p[0]));
    if (status == NEVH_OK) /* it jumped over the centre */
        ck_assert_uint_lt(nevh_stepper_taken(m), 1000000);
    else {
        ck_assert_msg(status == NEVH_EDOM || status == NEVH_EMAXITER, "%d: %s",
                      status, nevh_stepper_message(m));
        ck_assert(strlen(nevh_stepper_message(m)) > 20);
        ck_assert(nevh_stepper_time(m) < 10);
    }
    nevh_stepper_free(m);
    nevh_system_free(h);
    nevh_system_free(s);
}

/* Whatever h: an end, or a message. */
TEST_EACH(absurd_steps, 16) {
    static const double absurd[] = {3, 1e3, 1e300, 1e-300, -3, -1e150, 0.9};
    const problem *b = _i % 2 ? &kepler : &henon_heiles;
    const nevh_integrator *schemes[] = {nevh_adaptive_verlet,
                                        nevh_naive_adaptive_verlet, nevh_gauss4,
                                        nevh_midpoint};
    const nevh_integrator *scheme = schemes[_i / 4];
    bool own = nevh_integrator_own_time(scheme) && _i / 2 % 2;
    nevh_system *h = b->make();
    nevh_system *s = own ? NULL : nevh_distance_power(2, 2, 1.5);
    nevh_options o = {
        .gradient = nevh_exact, .q = b->q, .p = b->p, .transform = s};
    for (size_t i = 0; i < sizeof absurd / sizeof *absurd; i++) {
        nevh_stepper *m = nevh_stepper_new(h, scheme, &o);
        double q[] = {b->q[0], b->q[1]}, p[] = {b->p[0], b->p[1]};
        int status = nevh_run_until(m, 0, absurd[i], copysign(5, absurd[i]), q,
                                    p, NULL, 0);
        ck_assert_msg(status == NEVH_OK || status == NEVH_EDOM ||
                          status == NEVH_EMAXITER || status == NEVH_EINVAL,
                      "%d: %s", status, nevh_stepper_message(m));
        for (int k = 0; k < 2; k++)
            ck_assert(isfinite(q[k]) && isfinite(p[k]));
        nevh_stepper_free(m);
    }
    nevh_system_free(h);
    nevh_system_free(s);
}
