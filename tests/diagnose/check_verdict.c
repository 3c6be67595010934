/* nevh tests: the verdict on a run's energy, and the error of its slope.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "driven.h"
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <string.h>

static double coordinate(double t, const double q[], const double p[],
                         const void *params) {
    (void)t, (void)p, (void)params;
    return q[0];
}

static double phase;

/* The report on H0 = 1 with errors from `error`. */
static nevh_energy_report report_on(double (*error)(double), double end) {
    enum { SAMPLES = 20000 };
    nevh_system *s = nevh_system_from(1, coordinate, NULL);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    double p = 0;
    for (size_t i = 0; i <= SAMPLES; i++) {
        double t = (double)i * end / SAMPLES, q = 1 + (i ? error(t) : 0);
        ck_assert_int_eq(nevh_energy_observe(energy, i, t, &q, &p), NEVH_OK);
        ck_assert_double_eq(nevh_energy_error(energy, 0), q - 1);
    }
    nevh_energy_report r = nevh_energy_result(energy, 0);
    nevh_energy_free(energy);
    nevh_system_free(s);
    return r;
}

static double wave(double t) {
    return 1e-3 * sin(3 * t + phase);
}
static double hidden_loss(double t) {
    return wave(t) - 2e-6 * t;
}
static double beat(double t) {
    return 1e-6 * sin(0.001 * t) * cos(3 * t);
}
static double early_loss(double t) {
    return -0.5 * (1 - exp(-t)) + 1e-3 * cos(3 * t);
}
static double rough(double t) {
    return 2 * (1 - cos(t));
}

/* Values that are not independent: whatever the phase, and however many periods
   there are, the slope of a wave is no more than some of its own errors. */
TEST(slope_of_a_wave) {
    static const double ends[] = {20, 50, 111, 400, 1234, 5000};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        for (phase = 0; phase < 6; phase += 0.5) {
            nevh_energy_report r = report_on(wave, ends[i]);
            ck_assert_msg(fabs(r.drift) < 4 * r.drift_error,
                          "end %g, phase %g: %.2e +- %.1e", ends[i], phase,
                          r.drift, r.drift_error);
        }
    phase = 0;
}

TEST(slope_under_a_wave) {
    nevh_energy_report r = report_on(hidden_loss, 400);
    ck_assert_double_lt(r.last_fifth, 2 * r.first_fifth);
    ck_assert_double_gt(fabs(r.drift), 4 * r.drift_error);
    ck_assert_double_lt(fabs(r.drift + 2e-6), 4 * r.drift_error);
}

static nevh_verdict judge(nevh_energy_report r, nevh_theory theory,
                          double times) {
    r.theory = theory;
    return nevh_energy_verdict(&r, times);
}

/* The same data: what theory expects decides, or asks for more. */
TEST(theories) {
    nevh_energy_report r = report_on(hidden_loss, 400);
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_DRIFTS);
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 1), NEVH_BOUNDED);
    r = report_on(beat, 500);
    ck_assert_int_eq(judge(r, NEVH_THEORY_NONE, 1), r.verdict);
    ck_assert_int_ne(r.verdict, NEVH_BOUNDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 1), NEVH_UNDECIDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 1), NEVH_UNDECIDED);
    r = report_on(beat, 8000);
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 16), NEVH_BOUNDED);
    r = report_on(early_loss, 50);
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_DRIFTS);
    r = report_on(rough, 1000);
    ck_assert_double_gt(r.max, 3.9);
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 1), NEVH_UNDECIDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 16), NEVH_BOUNDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_UNSTABLE);
    ck_assert_str_eq(nevh_verdict_name(NEVH_UNDECIDED), "undecided");
}

static double peak, rest;
static double collision(double t) {
    double since = t - 30;
    return peak * exp(-since * since) + (since > 0 ? rest : 0);
}
/* A scheme that takes the collision apart again and again. */
static double collisions(double t) {
    double since = fmod(t, 60) - 30;
    return peak * exp(-since * since);
}

/* The energy of one collision is never made good, and the motion ends there: whether it
   is above the limit or part of it, no length of the run makes it bounded. */
TEST(one_jump_that_stays) {
    static const struct {
        double peak, rest;
        nevh_verdict verdict;
    } jumps[] = {
        {39, 3.8, NEVH_UNSTABLE}, {7, 1.1, NEVH_UNSTABLE},
        {0, 20, NEVH_UNSTABLE},   {39, 0.1, NEVH_UNSTABLE},
        {0, 0.5, NEVH_UNDECIDED}, {0.02, 0.3, NEVH_UNDECIDED},
        {0, 0.01, NEVH_BOUNDED},  {39, 1e-3, NEVH_BOUNDED},
    };
    for (size_t i = 0; i < sizeof jumps / sizeof *jumps; i++) {
        peak = jumps[i].peak;
        rest = jumps[i].rest;
        nevh_energy_report r = report_on(collision, 4000);
        ck_assert_msg(judge(r, NEVH_THEORY_KEEPS, 64) == jumps[i].verdict,
                      "%g, %g: %s", peak, rest,
                      nevh_verdict_name(judge(r, NEVH_THEORY_KEEPS, 64)));
        ck_assert_int_eq(nevh_energy_stays(&r), 0);
        r.theory = NEVH_THEORY_KEEPS;
        ck_assert_int_eq(nevh_energy_stays(&r), peak < 1 && rest > 0.03);
        peak = jumps[i].peak + jumps[i].rest;
        r = report_on(collisions, 4000);
        ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 64), NEVH_BOUNDED);
    }
}

static double loss(double t) {
    return -2e-6 * t;
}
static double growing_wave(double t) {
    return 1e-3 * sin(0.1 * t) + 1e-6 * t;
}

/* One jump is told from a line, from a wave and from a level error. */
TEST(a_jump_is_no_line) {
    peak = 0;
    rest = -0.2;
    nevh_energy_report r = report_on(collision, 90);
    ck_assert_double_gt(r.jump, 0.98);
    ck_assert_double_lt(fabs(r.jump_t - 30), 1);
    ck_assert_double_lt(r.straightness, 0.8);
    r = report_on(loss, 400);
    ck_assert_double_lt(fabs(r.jump - 0.75), 0.01);
    r = report_on(growing_wave, 400);
    ck_assert_double_lt(r.jump, 0.5);
    r = report_on(wave, 400);
    ck_assert_double_lt(r.jump, 0.5);
}

/* Nothing was seen: nothing is said. */
TEST(nothing_seen) {
    nevh_system *s = nevh_system_from(1, coordinate, NULL);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_energy_report none = {0};
    ck_assert_int_eq(nevh_energy_result(e, 0).verdict, NEVH_UNDECIDED);
    ck_assert_int_eq(nevh_energy_result(NULL, 0).verdict, NEVH_UNDECIDED);
    ck_assert_int_eq(nevh_energy_verdict(&none, 1), NEVH_UNDECIDED);
    ck_assert_int_eq(nevh_energy_verdict(&none, INFINITY), NEVH_UNDECIDED);
    nevh_energy_free(e);
    nevh_system_free(s);
}

/* A drift that theory knows of, and that rounding hides, is not kept. */
TEST(drift_below_rounding) {
    nevh_energy_report r = report_on(wave, 400);
    r.rounding = 2 * r.max;
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 1), NEVH_BOUNDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_UNDECIDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, INFINITY), NEVH_UNDECIDED);
}

/* Errors that grow as the energies met do, and such that grow by themselves. */
TEST(growth_of_the_motion) {
    nevh_energy_report r = {.samples = 1000,
                            .max = 1e3,
                            .rms = 1e2,
                            .first_fifth = 1e-3,
                            .last_fifth = 1e3,
                            .limit = 1e5,
                            .met = 1e6,
                            .rate = {0.5, 0.5, 0.5},
                            .early = 1e-3,
                            .grown = 1e6,
                            .relative = {1e-3, 1e-3}};
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_UNDECIDED);
    r.relative[1] = 1e-2;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_RANDOM_WALK);
    r.rate[0] = 3; /* faster than any drift */
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_UNDECIDED);
}

/* Energies that a drive raises beyond all drift, and a small part of them lost; not
   where the loss is the growth, nor after one close encounter. */
TEST(loss_of_a_motion_that_grows) {
    const nevh_energy_report grows = {.samples = 1000,
                                      .max = 1e8,
                                      .first_fifth = 1e-3,
                                      .last_fifth = 1e8,
                                      .limit = 1,
                                      .met = 1e14,
                                      .rate = {40, 45, 50},
                                      .early = 1e-3,
                                      .grown = 1e10,
                                      .relative = {1e-7, 1e-6}};
    nevh_energy_report r = grows;
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_UNDECIDED);
    r.relative[1] = 0.9;
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_UNSTABLE);
    r = grows;
    r.rate[2] = 0.1;
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_UNSTABLE);
    r = grows;
    r.grown = 1;
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 1), NEVH_UNSTABLE);
}

/* A resonance, whose energies grow with the square of the time, and the error with
   them or faster; and energies that grow unsteadily. */
TEST(resonance) {
    nevh_energy_report r = {.samples = 1000,
                            .max = 0.25,
                            .rms = 0.1,
                            .first_fifth = 1e-2,
                            .last_fifth = 0.25,
                            .limit = 1e3,
                            .met = 1e4,
                            .rate = {1.98, 1.98, 1.98},
                            .early = 4e-3,
                            .grown = 25,
                            .relative = {1e-5, 1e-5}};
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_UNDECIDED);
    r.rate[0] = r.rate[1] = r.rate[2] = 0.98;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_UNDECIDED);
    r.relative[1] = 1e-4;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_RANDOM_WALK);
    r.relative[1] = 1e-5;
    r.rate[1] = 0.3;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_RANDOM_WALK);
}

/* A drive that pulls the motion along; a large error is below its energies. */
TEST(pulled_along) {
    nevh_energy_report r = {.samples = 1000,
                            .max = 1200,
                            .first_fifth = 240,
                            .last_fifth = 1200,
                            .limit = 280,
                            .met = 2800,
                            .rate = {0.99, 1, 1.07},
                            .early = 150,
                            .grown = 5.3,
                            .relative = {0.56, 0.53}};
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_UNDECIDED);
    r.relative[0] = r.relative[1] = 1.2;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, INFINITY), NEVH_UNSTABLE);
}

/* Energies that have doubled, and an error below them; no error of a run whose
   energies are those of the start, nor one that grows faster. */
TEST(lifted_above_the_start) {
    nevh_energy_report r = {.samples = 721,
                            .max = 1.5,
                            .first_fifth = 0.67,
                            .last_fifth = 1.5,
                            .limit = 1,
                            .met = 2,
                            .rate = {1.1, 0.14, -0.03},
                            .early = 0.67,
                            .grown = 2,
                            .relative = {0.67, 0.76}};
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_UNDECIDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 16), NEVH_UNSTABLE);
    r.relative[0] = 0.2;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_UNSTABLE);
    r.relative[0] = 0.67;
    r.grown = 1;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_UNSTABLE);
}

/* A walk that leans to one side is no drift where theory expects none. */
TEST(leaning_walk) {
    nevh_energy_report r = {.samples = 20000,
                            .max = 1e-3,
                            .first_fifth = 2e-4,
                            .last_fifth = 1e-3,
                            .limit = 1,
                            .met = 1,
                            .rate = {1, 0.9, 0.8},
                            .early = 1e-4,
                            .grown = 1,
                            .span = 1000,
                            .drift = 8e-7,
                            .drift_error = 1e-7,
                            .straightness = 0.7};
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_RANDOM_WALK);
    ck_assert_int_eq(judge(r, NEVH_THEORY_ROUGH, 16), NEVH_RANDOM_WALK);
    ck_assert_int_eq(judge(r, NEVH_THEORY_LOSES, 16), NEVH_DRIFTS);
    r.straightness = 0.97;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_DRIFTS);
    /* Of rounding: a straight line is neither. */
    r.rounding = 1e-4;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_RANDOM_WALK);
    r.straightness = 0.999;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_UNDECIDED);
    r.rounding = 1e-2;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_UNDECIDED);
    r.straightness = 0.7;
    ck_assert_int_eq(judge(r, NEVH_THEORY_OPEN, 16), NEVH_RANDOM_WALK);
}

/* An error far above all energies is not left open when no run is longer. */
TEST(far_above_the_energies) {
    nevh_energy_report r = {.samples = 1000,
                            .max = 590,
                            .first_fifth = 500,
                            .last_fifth = 590,
                            .limit = 1,
                            .early = 500};
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, 1), NEVH_UNDECIDED);
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, INFINITY), NEVH_UNSTABLE);
    r.rounding = 1e3;
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, INFINITY), NEVH_UNDECIDED);
    r.limit = 1e3;
    ck_assert_int_eq(judge(r, NEVH_THEORY_KEEPS, INFINITY), NEVH_BOUNDED);
}

static nevh_theory theory_of(const problem *b, const nevh_integrator *scheme) {
    nevh_system *s = b->make();
    nevh_stepper *m = nevh_stepper_new(
        s, scheme,
        &(nevh_options){.gradient = nevh_central4, .q = b->q, .p = b->p});
    nevh_energy *e = nevh_energy_new(s, NULL);
    state z = start(b);
    ck_assert_msg(!nevh_energy_expect(e, m), "%s", nevh_energy_message(e));
    nevh_energy_observe(e, 0, 0, z.q, z.p);
    nevh_theory theory = nevh_energy_result(e, 0).theory;
    ck_assert_int_eq(nevh_energy_expect(e, m), NEVH_EINVAL); /* too late */
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
    return theory;
}

TEST(what_theory_knows) {
    ck_assert_int_eq(theory_of(&henon_heiles, nevh_verlet), NEVH_THEORY_KEEPS);
    ck_assert_int_eq(theory_of(&henon_heiles, nevh_gonzalez),
                     NEVH_THEORY_KEEPS);
    ck_assert_int_eq(theory_of(&henon_heiles, nevh_rk4), NEVH_THEORY_LOSES);
    ck_assert_int_eq(theory_of(&henon_heiles, nevh_euler), NEVH_THEORY_LOSES);
    ck_assert_int_eq(theory_of(&driven_pendulum, nevh_verlet),
                     NEVH_THEORY_OPEN);
    ck_assert_int_eq(theory_of(&driven_pendulum, nevh_rk4), NEVH_THEORY_LOSES);
}

static nevh_theory theory_in_scene(const char *effects,
                                   const nevh_integrator *scheme) {
    nevh_scene *scene = scene_with("x = 1\ny = 2", effects);
    const nevh_system *s = nevh_scene_system(scene);
    double q[2], p[2];
    nevh_scene_start(scene, q, p);
    nevh_stepper *m =
        nevh_stepper_new(s, scheme, &(nevh_options){.q = q, .p = p});
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert_msg(!nevh_energy_expect(e, m), "%s", nevh_energy_message(e));
    nevh_energy_observe(e, 0, 0, q, p);
    nevh_theory theory = nevh_energy_result(e, 0).theory;
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_scene_free(scene);
    return theory;
}

/* Kinks and jumps of formulas, in coordinates or momenta, leave no modified
   energy; such of numbers or of time alone are none. */
TEST(kinks) {
    static const char *const rough[] = {
        "K = (p_x^2+p_y^2)/2\nV = abs(x)+y^2",
        "K = (p_x^2+p_y^2)/2\nV = x^2+floor(y)",
        "K = (p_x^2+p_y^2)/2\nV = max(x, y)^2",
        "K = (p_x^2+p_y^2)/2\nV = mod(x, 1)*(1-mod(x, 1))",
        "K = abs(p_x)+p_y^2/2\nV = x^2+y^2"};
    static const char *const smooth[] = {
        "K = (p_x^2+p_y^2)/2\nV = abs(-2)*x^2+y^4",
        "K = (p_x^2+p_y^2)/2\nV = exp(x)+hypot(x, y)"};
    for (size_t i = 0; i < sizeof rough / sizeof *rough; i++) {
        ck_assert_int_eq(theory_in_scene(rough[i], nevh_verlet),
                         NEVH_THEORY_ROUGH);
        ck_assert_int_eq(theory_in_scene(rough[i], nevh_rk4),
                         NEVH_THEORY_LOSES);
    }
    for (size_t i = 0; i < sizeof smooth / sizeof *smooth; i++)
        ck_assert_int_eq(theory_in_scene(smooth[i], nevh_verlet),
                         NEVH_THEORY_KEEPS);
    ck_assert_int_eq(theory_in_scene("K = (p_x^2+p_y^2)/2\nV = "
                                     "x^2+y^2+x*abs(sin(t))",
                                     nevh_verlet),
                     NEVH_THEORY_OPEN);
}

/* A stepper of another system tells nothing of this one. */
TEST(another_system) {
    nevh_system *s = henon_heiles.make(), *other = henon_heiles.make();
    nevh_stepper *m = nevh_stepper_new(other, nevh_verlet, NULL);
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert_int_eq(nevh_energy_expect(e, m), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_energy_message(e), "another system"));
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(other);
    nevh_system_free(s);
}

/* A stepper that was refused tells nothing. */
TEST(refused) {
    nevh_system *s = henon_heiles.make();
    nevh_stepper *m = nevh_stepper_new(s, NULL, NULL);
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert_int_eq(nevh_energy_expect(e, m), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_energy_message(e), "refused"));
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Energies met far above those at the start: what rounding makes of these is no
   drift.  H = p^2/2 - x^2/2 from x = 1, by its exact solution, rounded. */
static double kinetic(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2;
}
static double hill(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -q[0] * q[0] / 2;
}

TEST(rounding_of_what_is_met) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.np = 1, .value = kinetic, .effect = "K"});
    nevh_system_add(s, &(nevh_term){.nq = 1, .value = hill, .effect = "V"});
    nevh_energy *e = nevh_energy_new(s, NULL);
    for (size_t i = 0; i <= 600; i++) {
        double t = (double)i / 40, q = cosh(t), p = sinh(t);
        ck_assert_int_eq(nevh_energy_observe(e, i, t, &q, &p), NEVH_OK);
    }
    nevh_energy_report r = nevh_energy_result(e, 0);
    ck_assert_double_gt(r.max, 1e-5);
    ck_assert_double_lt(r.max, r.rounding);
    ck_assert_double_lt(r.rounding, 1e5 * r.max);
    ck_assert_int_ne(r.verdict, NEVH_DRIFTS);
    ck_assert_int_ne(r.verdict, NEVH_UNSTABLE);
    nevh_energy_free(e);
    nevh_system_free(s);
}
