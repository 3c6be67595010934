/* nevh tests: references of H that changes with time within a step, energies
   whose balance has jumps, solutions that end, steps past a pole.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "reference.h"

#define SPRING "K = p_x^2/2\nV = x^2/2\nD = "

/* From 0 to 12; `at`: where it breaks, so that a run may be cut there. */
static const struct {
    const char *effects;
    double at[3], h;
} drives[] = {
    {SPRING "-100*x*exp(-((t-7.77)/0.001)^2)", {7.7, 7.84, 12}, 2e-4},
    {SPRING "-x*100/(1+((t-3.2)/1e-3)^2)", {3.1, 3.3, 12}, 2e-4},
    {SPRING "-0.3*x*sign(t-5)", {5, 6, 12}, 0.02},
    {SPRING "-40*x*(sign(t-4)-sign(t-4.01))", {4, 4.01, 12}, 0.002},
    {SPRING "-0.5*x*max(0, 1-abs(t-6)/0.5)", {5.5, 6, 6.5}, 0.01},
    {SPRING "x^2*(sign(t-2)+1)", {2, 5, 12}, 0.01},
    {SPRING "-x*mod(t, 4)", {4, 8, 12}, 0.01},
    {SPRING "-0.3*x*cos(50*t)", {4, 8, 12}, 2e-3},
    {SPRING "0.1*p_x^2*floor(t/5)", {5, 10, 12}, 0.01},
    {SPRING "-x*tanh((t-6)/1e-3)", {5.9, 6.1, 12}, 2e-4},
};
enum { DRIVES = sizeof drives / sizeof *drives };

/* Steps of order 12 that end where H breaks. */
static void run_in_parts(const setup *s, int i, double end, double q[],
                         double p[]) {
    nevh_options o = {.gradient = nevh_exact, .q = s->q, .p = s->p};
    double t = 0;
    q[0] = s->q[0], p[0] = s->p[0];
    for (int k = 0; k < 4; k++) {
        double to = k < 3 ? fmin(drives[i].at[k], end) : end;
        nevh_stepper *stepper = nevh_stepper_new(s->system, nevh_gauss12, &o);
        size_t steps = (size_t)ceil((to - t) / drives[i].h);
        if (steps)
            ck_assert_int_eq(nevh_run(stepper, t, (to - t) / (double)steps,
                                      steps, q, p, NULL, 0),
                             NEVH_OK);
        nevh_stepper_free(stepper);
        t = to;
    }
}

TEST_EACH(references_see_what_changes_with_time, DRIVES) {
    orbit o = {"x = 1", drives[_i].effects, 0, 12};
    setup s = refer_to(&o, NULL);
    ck_assert_double_lt(nevh_reference_error(s.reference), 1e-11);
    for (int k = 1; k <= 6; k++) {
        double q, p, run_q, run_p;
        ck_assert_int_eq(nevh_reference_state(s.reference, 2 * k, &q, &p),
                         NEVH_OK);
        run_in_parts(&s, _i, 2 * k, &run_q, &run_p);
        ck_assert_double_eq_tol(q, run_q, 1e-9 * (1 + fabs(q)));
        ck_assert_double_eq_tol(p, run_p, 1e-9 * (1 + fabs(p)));
    }
    tear_down(&s);
}

/* Backwards, too. */
TEST(references_see_jumps_backwards) {
    const char effects[] = SPRING "-0.3*x*sign(t-5)";
    setup s = set_up("x = 1", effects);
    double q[2], p[2];
    refer(&s, NULL, 0, 8);
    ck_assert_int_eq(nevh_reference_state(s.reference, 8, q, p), NEVH_OK);
    nevh_reference *back = nevh_reference_new(s.system, NULL, 8, 0, q, p);
    ck_assert_int_eq(nevh_reference_state(back, 0, q + 1, p + 1), NEVH_OK);
    ck_assert_double_eq_tol(q[1], 1, 1e-13);
    ck_assert_double_eq_tol(p[1], 0, 1e-13);
    nevh_reference_free(back);
    tear_down(&s);
}

static double largest_error(const setup *s, bool books) {
    nevh_options o = {
        .gradient = nevh_exact, .q = s->q, .p = s->p, .balance = true};
    nevh_stepper *stepper = nevh_stepper_new(s->system, nevh_gauss12, &o);
    nevh_energy *e = nevh_energy_new(s->system, NULL);
    nevh_timing *timing = nevh_timing_new(s->system, 0, 12, s->q, s->p);
    double q = s->q[0], p = s->p[0];
    ck_assert_int_eq(nevh_energy_follow(e, stepper), NEVH_OK);
    ck_assert_int_eq(nevh_energy_book(e, books ? timing : NULL), NEVH_OK);
    nevh_observer o1 = {nevh_energy_observe, e, 1};
    ck_assert_int_eq(nevh_run(stepper, 0, 0.01, 1200, &q, &p, &o1, 1), NEVH_OK);
    double most = nevh_energy_result(e, 0).max;
    nevh_energy_free(e);
    nevh_timing_free(timing);
    nevh_stepper_free(stepper);
    return most;
}

static const char *const jumps[] = {
    SPRING "-0.3*x*sign(t-5)",
    SPRING "x^2*(sign(t-2.003)+1)",
    SPRING "-x*mod(t, 4)",
    SPRING "0.1*p_x^2*floor(t/5)",
};

TEST_EACH(jumps_are_energy_from_outside, sizeof jumps / sizeof *jumps) {
    setup s = set_up("x = 1, 0.3", jumps[_i]);
    ck_assert_double_lt(largest_error(&s, true), 2e-3);
    ck_assert_double_gt(largest_error(&s, false), 2e-2);
    tear_down(&s);
}

/* Changes that steps pass over: the energy from outside is their integral. */
static const struct {
    const char *effects;
    double most; /* of the error */
} passed[] = {
    {SPRING "0.3*x*tanh((t-7.1)/1e-6)", 2e-3},
    {SPRING "0.3*x^2*(1+tanh((t-2.503)/1e-5))", 2e-2},
    {SPRING "3*x*exp(-((t-7.1)/0.0007)^2)", 5e-2},
    {SPRING "x*exp(-((t-4.2)/1e-4)^2) + x*exp(-((t-9.3)/2e-4)^2)", 1e-2},
    {SPRING "0.1*p_x^2*tanh((t-5.006)/1e-7)", 2e-3},
    {SPRING "0.2*x/(1 + exp((3.3-t)/1e-6))", 2e-3},
};

static nevh_energy_report report_of(const setup *s,
                                    const nevh_integrator *scheme, double h) {
    nevh_options o = {
        .gradient = nevh_exact, .q = s->q, .p = s->p, .balance = true};
    nevh_stepper *stepper = nevh_stepper_new(s->system, scheme, &o);
    nevh_energy *e = nevh_energy_new(s->system, NULL);
    nevh_timing *timing = nevh_timing_new(s->system, 0, 12, s->q, s->p);
    double q = s->q[0], p = s->p[0];
    nevh_energy_expect(e, stepper);
    nevh_energy_follow(e, stepper);
    ck_assert_int_eq(nevh_energy_book(e, timing), NEVH_OK);
    nevh_observer o1 = {nevh_energy_observe, e, 1};
    ck_assert_int_eq(
        nevh_run(stepper, 0, h, (size_t)rint(12 / h), &q, &p, &o1, 1), NEVH_OK);
    nevh_energy_report report = nevh_energy_result(e, 0);
    nevh_energy_free(e);
    nevh_timing_free(timing);
    nevh_stepper_free(stepper);
    return report;
}

TEST_EACH(passed_changes_are_energy_from_outside,
          sizeof passed / sizeof *passed) {
    setup s = set_up("x = 1, 0.3", passed[_i].effects);
    nevh_energy_report r = report_of(&s, nevh_gauss12, 0.01);
    ck_assert_double_lt(r.max, passed[_i].most);
    ck_assert_double_lt(report_of(&s, nevh_rk4, 0.01).max, passed[_i].most);
    tear_down(&s);
}

/* Momenta that decay are energy that goes, beside what changes come to. */
TEST(passed_changes_leave_friction) {
    setup s = set_up("x = 1, 0.3", SPRING "0.3*x*tanh((t-7.1)/1e-6)\n"
                                          "[friction]\ndrag = x: 0.5");
    ck_assert_double_lt(report_of(&s, nevh_gauss12, 0.01).max, 2e-3);
    tear_down(&s);
}

/* A chirp that steps lose says nothing of the scheme; one that is too weak to
   matter leaves it its verdict. */
TEST(verdicts_are_not_of_what_steps_pass_over) {
    setup s = set_up("x = 1, 0.3", SPRING "0.3*x*cos(t^2*40)");
    nevh_energy_report r = report_of(&s, nevh_rk4, 0.05);
    ck_assert(nevh_energy_passes_over(&r));
    ck_assert_int_eq(r.verdict, NEVH_UNDECIDED);
    tear_down(&s);
    s = set_up("x = 1, 0.3", SPRING "1e-14*x*cos(t^2*40)");
    r = report_of(&s, nevh_rk4, 0.05);
    ck_assert(!nevh_energy_passes_over(&r));
    ck_assert_int_eq(r.verdict, NEVH_DRIFTS);
    tear_down(&s);
    s = set_up("x = 1, 0.3", SPRING "0.3*x*cos(t)");
    r = report_of(&s, nevh_rk4, 0.05);
    ck_assert_double_eq(r.missed, 0);
    tear_down(&s);
}

#define PLANE "K = (p_x^2 + p_y^2)/2\nV = "
/* When solutions end; NAN: they do not, but some come close. */
static const struct {
    const char *coordinates, *effects;
    double t1, ends;
} ends[] = {
    {"x = -1", "H = p_x^2/2 - x^3/3", 20, 5.15194603},
    {"x = 1", "H = p_x^2/2 - x^4", 20, 0.92703734},
    {"x = 1", "H = p_x^2/2 - 1/x", 20, 1.11072073},
    {"x = 1", "H = p_x^2/2 - exp(x)", 20, 1.34737233},
    {"x = 1", "H = p_x^2/2 + log(x)", 20, 1.25331414},
    {"x = 1", "H = p_x^2/2 - 1/x^2", 20, 0.70710678},
    {"x = 2\ny = 0", PLANE "-1/sqrt(x^2 + y^2)", 20, 3.14159265},
    {"x = 0.5\ny = 0.5", PLANE "-(x^2 + y^2)^2", 20, 1.31102878},
    {"x = 0\ny = 0\nu = 1\nv = 0",
     "K = (p_x^2 + p_y^2 + p_u^2 + p_v^2)/2\nV = -1/hypot(x - u, y - v)", 20,
     0.78539816},
    {"x = 1", "H = p_x^2/2 - x^2/2", 100, NAN},
    {"x = 1", "H = p_x^2/2 - x^4/4 + x^6/1e6", 100, NAN},
    {"x = 1", "H = p_x^2/2 + (x^2)^(2/3)", 10, NAN},
    {"x = 1\ny = 0, 1e-3", PLANE "-1/sqrt(x^2 + y^2)", 8, NAN},
    {"x = 1\ny = 0, 1e-6", PLANE "-1/sqrt(x^2 + y^2)", 3, NAN},
    {"x = 1", "H = p_x^2/2 + 1e-6/x + x", 8, NAN},
    {"x = 1", "H = p_x^2/2 - x^2*cos(3*t)", 50, NAN},
    {"x = 3", "H = p_x^2/2 + exp(-10*x) + x", 20, NAN},
    {"x = 1", "H = p_x^2/2 - x^1.5", 50, NAN},
    /* x = 1/((t - 1)^2 + 1/x(0) - 1) */
    {"x = 1", "K = -2*(t - 1)*p_x*x^2", 3, 1},
    {"x = 1, 0.5", "K = -2*(t - 1)*p_x*x^2", 3, 1},
    {"x = 1", "K = -4*(t - 1)^3*p_x*x^2", 3, 1},
    {"x = 1 - 1e-13", "K = -2*(t - 1)*p_x*x^2", 3, NAN},
};

TEST_EACH(solutions_end, sizeof ends / sizeof *ends) {
    setup s = set_up(ends[_i].coordinates, ends[_i].effects);
    double t = nevh_solution_ends(s.system, 0, ends[_i].t1, s.q, s.p);
    if (isnan(ends[_i].ends))
        ck_assert_msg(isnan(t), "%s ends at %g", ends[_i].effects, t);
    else
        ck_assert_double_eq_tol(t, ends[_i].ends, 1e-6);
    tear_down(&s);
}

TEST(references_say_that_solutions_end) {
    setup s = set_up("x = -1", "H = p_x^2/2 - x^3/3");
    nevh_reference *r = nevh_reference_new(s.system, NULL, 0, 20, s.q, s.p);
    ck_assert_double_eq_tol(nevh_reference_ends(r), 5.15194603, 1e-6);
    nevh_reference_free(r);
    r = nevh_reference_new(s.system, NULL, 0, 5, s.q, s.p);
    ck_assert(isnan(nevh_reference_ends(r)));
    ck_assert_int_eq(nevh_reference_status(r), NEVH_OK);
    nevh_reference_free(r);
    tear_down(&s);
    s = set_up("x = 1", "K = -2*(t - 1)*p_x*x^2");
    r = nevh_reference_new(s.system, NULL, 0, 3, s.q, s.p);
    ck_assert_double_eq_tol(nevh_reference_ends(r), 1, 1e-6);
    nevh_reference_free(r);
    tear_down(&s);
}

/* Whether a run of verlet passes a pole, by its steps. */
static const struct {
    const char *coordinates, *effects;
    double h, t1;
    bool passes;
} poles[] = {
    {"x = 1", "K = p_x^2/2\nV = -1/x", 0.1, 10, true},
    {"x = 1, -3", "K = p_x^2/2\nV = 1e-3/x", 0.05, 1, true},
    {"x = 1, -3", "K = p_x^2/2\nV = 1e-3/x", 1e-5, 1, false},
    {"x = 1, 5", "K = p_x^2/2\nV = 1e-2/sin(x)", 0.1, 3, true},
    {"x = 1, 0.1", "K = p_x^2/2\nV = 1/sin(x)^2", 0.01, 20, false},
    {"x = 0.2, -9", "K = p_x^2/2\nV = 1e-4/x^2", 0.1, 1, true},
    {"x = 0, 9", "K = p_x^2/2\nV = 1e-3*tan(x)", 0.1, 2, true},
    {"x = 1\ny = 0, 1", PLANE "-1/sqrt(x^2 + y^2)", 0.5, 50, false},
    {"x = 1\ny = 0, 0.2", PLANE "-1/hypot(x, y)", 0.2, 50, false},
    {"a = 3\nb = 3", RODS, 0.05, 50, false},
};

TEST_EACH(steps_past_poles_are_found, sizeof poles / sizeof *poles) {
    setup s = set_up(poles[_i].coordinates, poles[_i].effects);
    bool separable = nevh_system_traits(s.system) & NEVH_SEPARABLE;
    nevh_options o = {.gradient = nevh_exact, .q = s.q, .p = s.p};
    nevh_stepper *stepper =
        nevh_stepper_new(s.system, separable ? nevh_verlet : nevh_rk4, &o);
    nevh_energy *e = nevh_energy_new(s.system, NULL);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    const char *effect = "";
    nevh_run(stepper, 0, poles[_i].h, (size_t)(poles[_i].t1 / poles[_i].h), s.q,
             s.p, &watch, 1);
    double t = nevh_energy_passed(e, &effect);
    ck_assert_int_eq(!isnan(t), poles[_i].passes);
    ck_assert_str_eq(effect, poles[_i].passes ? "V" : "");
    nevh_energy_free(e);
    nevh_stepper_free(stepper);
    tear_down(&s);
}
