/* nevh tests: series end where a function of H stops being analytic.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/certain.h>
#include <nevh/reference.h>
#include <nevh/scene.h>
#include <nevh/run.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    const char *start, *potential;
    double ends; /* where the orbit meets it; 0: nowhere */
} formula;

static const formula kinks[] = {
    {"x = 1", "sqrt(x^2)", 1.41421356},
    {"x = 1", "(x^2)^0.5", 1.41421356},
    {"x = 1", "hypot(x, 0)", 1.41421356},
    {"x = 1", "exp(0.5*log(x^2))", 1.41421356},
    {"x = 1", "acos(cos(x))", 1.41421356},
    {"x = 1, 3", "x^2/4 - 0.1*asin(sin(x))", 0.193355839},
    {"x = 1", "acosh(cosh(x))", 1.41421356},
    {"x = -1\ny = 0.5\np_y = -1", "(x^2 + y^2)/2 + 0.1*atan2(y, x)^2",
     0.527270287},
    {"x = 1", "(x^2)^1.5", 0.991492475},
    {"x = 1", "x^2/2 + (x^2)^0.7", 0.976616344},
    {"x = 1", "sqrt((x - 0.1)^2)", 1.34164079},
    {"x = 2", "(x^2)^1.25", 0.875040948},
    {"x = 1", "x^2/2 + cbrt(x)", 1.27412332},
    {"x = 1", "cbrt(x^2)", 1.6660811},
    {"x = 0, 2.5", "x^2/2 + 0.1*atan(tan(x))", 0.69124973},
    {"x = 0.7, -1.5", "x^2/2 + 0.2*atan(1/x)", 0.446243311},
    {"x = 1, -2", "x^2/2 + 0.1*sqrt(1/(1/x)^2)", 0.459018388},
    {"x = 1", "sqrt((1/x)^-2)", 1.41421356},
    {"x = 1", "sqrt(x^2)^3", 0.991492475},
    {"x = 1", "pow(x^2, 2.5)", 0.886521427},
    {"x = 0.5, -2", "x^2/2 + sqrt(x)^2", 0.231984263},
    {"x = 0.5, -2", "x^2/2 + exp(log(x))", 0.231984263},
    {"x = 0.5, -2", "x^2/2 + x^0.5*x^0.5", 0.231984263},
    {"x = 1, -1", "x^2/2 + 0.1*acos(1 - x^2/2)", 0.764218658},
    {"x = 1\ny = 0", "sqrt(x^2 + y^2)", 1.41421356},
    {"x = 1", "x^2/2 - x*sqrt((t - 1)^2)", 1},
    {"x = 1", "x^2/2 - 0.3*x*asin(sin(t))", 1.57079633},
    {"x = 1", "x^2/2 - 0.3*x*atan2(sin(t), cos(t))", 3.14159265},
    {"x = 1", "abs(x - 0.1)", 1.34164079},
    {"x = 1", "abs(x)^3", 0.991492475},
    {"x = 1", "sign(x)*x^2", 1.11072073},
    {"x = 1", "abs(x)^2.5", 1.04060492},
    {"x = -1", "x^2/2 + max(x, 0)^3", 1.57079633},
    {"x = 1", "x^2/2 + min(0, x)^2", 1.57079633},
    {"x = -1", "x^2/2 + max((x - 0.3)/2, 0)^2.5", 1.87548898},
    {"x = 1", "x + max(0.2 - x, 0)^1.5", 1.26491106},
    {"x = 0.1, 1", "x^2/2 + max(abs(x) - 0.5, 0)^2", 0.421067206},
    {"x = 1\ny = -0.5", "x^2/2 + y^2 + abs(x - y)^3", 0.528724721},
    {"x = 1\ny = 0.5", "x^2/2 + y^2 + max(x + 2*y - 0.1, 0)^2.5", 0.378462969},
    {"x = 1\ny = 0.2\np_y = 1", "x^2 + y^2 + cos(0.5*atan2(y, x))", 1.99185645},
    {"x = 1\ny = 0.2\np_y = 1",
     "x^2 + y^2 + cos(atan2(y, x)) + 0.1*atan2(y, x)^2", 2.13802585},
    {"x = 1", "x^2 + atan2(0, x)", 1.11072073},
    {"x = 1", "x^2 + x*atan2(0*x, cos(2*x))", 0.290972092},
    {"x = 1", "cbrt(x^4)", 1.27081963},
    {"x = 1", "sqrt(x^6)", 0.991492475},
    {"x = 0.3, 1", "(mod(x + 0.5, 1) - 0.5)^2", 0.217492541},
    {"x = 0.3, 1", "x*floor(2*x)", 0.2},
    {"x = 0.3, -1", "x^2/2 + cos(0.5*mod(x, 2*pi))", 0.293506156},
    /* a kink where mod(...) has an edge that is none */
    {"x = 0.3, -4", "cos(2*pi*mod(x, 1)) + abs(sin(3.141592653589793*x))",
     0.0771790295},
    {"x = 0.3, -1", "cos(mod(x, 2*pi)) + abs(sin(x/2))", 0.28772097},
    {"x = 0.3, -1", "cos(mod(x, 6.28318530718))", 0.30942975},
    {"x = 0.3, -1", "1e-9*cos(1e13*floor(x)) + x^2/2", 0.29145679},
    {"x = 0.3, 1", "x^2/2 + 1e-14*x*floor(x)", 0.987882738},
    {"x = 0.3, 1", "x^2/2 + sin(pi*x)*(-1)^floor(x)", 0.836121586},
    {"x = 2.7, 3", "x^2/2 + 0.1*sign(floor(x) - 3)", 0.105166123},
    {"x = 0.3, 1", "x^2/2 + 0.1*mod(floor(x), 2)", 0.987882738},
    {"x = 0.3004, 1", "x^2/2 + 0.1*tanh(floor(1000*x))", 0.000600054118},
    {"x = 0.3, 1", "x^2/2 + floor(x)/(1 + exp(200 - x))", 0.987882738},
    {"x = 0.3, 1",
     "x^2/2 + 0.3*(floor(x)*(1 + exp(-1e4*(x - 1)^2)) - floor(x))",
     0.987882738},
    {"x = 0.3, 1",
     "x^2/2 + 0.3*(floor(x)*(2 + tanh(1e3*(x - 2e5))) - floor(x))",
     0.987882738},
    {"x = 0.3, 1\ny = 0.2",
     "(x^2 + y^2)/2 + 0.1*(floor(x)*floor(y) + floor(x)*(floor(-y) + 1) + "
     "(floor(-x) + 1)*floor(y) + (floor(-x) + 1)*(floor(-y) + 1))",
     0.987882738},
};
/* The same operations off these places, or where they cancel. */
static const formula smooth[] = {
    {"x = 1", "sqrt(1 + x^2)", 0},
    {"x = 1", "x^2/2 + sqrt(1e-8 + x^2)", 0},
    {"x = 1", "hypot(x, 1)", 0},
    {"x = 1", "(1 + x^2)^1.5", 0},
    {"x = 1", "x^1.5 + 1/x", 0},
    {"x = 2", "x^2/2 - log(x)", 0},
    {"x = 1", "x*asin(x/3)", 0},
    {"x = 1", "x^2/2 + 0.1*acos(0.9*cos(x))", 0},
    {"x = 1", "x^2/2 + acosh(2 + x^2)", 0},
    {"x = 1", "x^2/2 + atanh(x/4)", 0},
    {"x = 1", "x^2/2 + cbrt(x + 5)", 0},
    {"x = 1", "tan(x/3)^2", 0},
    {"x = 1", "sqrt(x^2)^2/2", 0},
    {"x = 1\ny = 0", "hypot(x, y)^2/2", 0},
    {"x = -1\ny = 0.5\np_y = -1", "(x^2 + y^2)/2 + 0.1*atan2(y + 5, x)^2", 0},
    {"x = 1\ny = 0\np_y = 0.5", "-1/sqrt(x^2 + y^2)", 0},
    {"x = 2, -1.5", "sin(x)/x", 0},
    {"x = 1", "x^2/2 + sin(1/(2 + x))", 0},
    {"x = 1", "x^2/2 - x*sqrt(1 + t)*cos(t)", 0},
};
/* Two ways to write a function: one has operations with kinks or cuts. */
static const struct {
    const char *start, *potential, *plain;
} same[] = {
    {"x = 1", "abs(x)^4 + cos(abs(x)) + abs(x)^2", "x^4 + cos(x) + x^2"},
    {"x = 1", "cbrt(8*x^9)*x + cbrt(x^6)", "x^2 + 2*x^4"},
    {"x = 1", "sqrt(x^4)", "x^2"},
    {"x = 1", "(4*x^4)^1.5", "8*x^6"},
    {"x = 1", "x^2/2 + max(x - 5, 0)^2.5 + max((-5 - x)/0.1, 0)^1.5", "x^2/2"},
    {"x = 1", "50*x^2 + max((x + 5)/4, 0)^2.5", "50*x^2 + ((x + 5)/4)^2.5"},
    {"x = 1", "20*x^2 + (-min(-0.2*x - 1, 0))^2.5", "20*x^2 + (0.2*x + 1)^2.5"},
    {"x = 4", "x^2/2 + min(x - 5, 0)^2 + max(0.1, 1 + x^2)",
     "3*x^2/2 + (x - 5)^2"},
    {"x = 1", "x^2/2 - 3*abs(x + 3) + 1/abs(x - 3)", "x^2/2 - 3*x + 1/(3 - x)"},
    {"x = 1\ny = 0.2\np_y = 0.6",
     "x^2 + y^2 + 0.1*cos(3*atan2(y, x))*(x^2 + y^2)^1.5",
     "x^2 + y^2 + 0.1*(x^3 - 3*x*y^2)"},
    {"x = 1\ny = 0.2\np_y = 1",
     "x^2 + y^2 + 0.1*sin(atan2(y, x) - atan2(x, y))*(x^2 + y^2)",
     "x^2 + y^2 - 0.1*(x^2 - y^2)"},
    {"x = 0.3, 2", "cos(mod(x, 2*pi)) + sin(6*pi*mod(x + 0.2, 1))",
     "cos(x) + sin(6*pi*(x + 0.2))"},
    {"x = 0.3, 2",
     "tan(0.1*(x - floor(x)) + 0.1*floor(x))*x + "
     "cos(x + 2*pi*floor(x))",
     "x*tan(0.1*x) + cos(x)"},
    {"x = 0.3, 2", "cos(mod(x, 2*pi)/2)^2 + cos(mod(mod(x, 4*pi), 2*pi))",
     "cos(x/2)^2 + cos(x)"},
    {"x = 0.3, 1",
     "exp(-mod(x, 2*pi))*exp(mod(x, 2*pi))*cos(x) + (mod(x, 1) + floor(x))^2",
     "cos(x) + x^2"},
    {"x = 1", "abs(x)*abs(x) + cosh(abs(x))", "x^2 + cosh(x)"},
    {"x = 1\ny = 0.3", "x^2 + y^2 + cos(mod(x, 1e3*pi) - mod(y, 1e3*pi))",
     "x^2 + y^2 + cos(x - y)"},
    {"x = 0.3, 1", "cos(x - 2*pi*mod(t, 1)) + x^2/2*(-1)^(2*floor(t))",
     "cos(x - 2*pi*t) + x^2/2"},
};

enum {
    SAME = sizeof same / sizeof *same,
    KINKS = sizeof kinks / sizeof *kinks,
    SMOOTH = sizeof smooth / sizeof *smooth
};

static nevh_scene *scene_of(const formula *f) {
    char text[400];
    bool two = strchr(f->start, 'y');
    snprintf(text, sizeof text,
             "[coordinates]\n%s\n[effects]\nT = %s\nV = %s\n", f->start,
             two ? "(p_x^2 + p_y^2)/2" : "p_x^2/2", f->potential);
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

static bool has_quad(const nevh_certain *c) {
    if (nevh_certain_status(c))
        assert_says(nevh_certain_message(c), "libquadmath");
    return !nevh_certain_status(c);
}

/* Up to there all digits, and behind it none: in both arithmetics. */
TEST_EACH(certain_states_end_at_kinks, 2 * KINKS) {
    const formula *f = &kinks[_i / 2];
    nevh_scene *s = scene_of(f);
    nevh_certain *c = nevh_scene_certain(s, _i % 2 ? 30 : 20);
    if (has_quad(c)) {
        ck_assert_int_eq(nevh_certain_go(c, 0.9 * f->ends), NEVH_OK);
        ck_assert_int_ge(nevh_certain_digits(c, 0), 15);
        ck_assert_int_eq(nevh_certain_go(c, 1.1 * f->ends), NEVH_EDOM);
        assert_says(nevh_certain_message(c), "is not analytic there");
    }
    nevh_certain_free(c);
    nevh_scene_free(s);
}

TEST_EACH(certain_states_of_smooth_formulas_do_not, SMOOTH) {
    nevh_scene *s = scene_of(&smooth[_i]);
    nevh_certain *c = nevh_scene_certain(s, 24);
    if (has_quad(c)) {
        ck_assert_msg(!nevh_certain_go(c, 5), "%s: %s", smooth[_i].potential,
                      nevh_certain_message(c));
        ck_assert_int_ge(nevh_certain_digits(c, 0), 23);
    }
    nevh_certain_free(c);
    nevh_scene_free(s);
}

TEST_EACH(both_ways_to_write_a_function_have_the_same_digits, SAME) {
    const formula two[] = {{same[_i].start, same[_i].potential, 0},
                           {same[_i].start, same[_i].plain, 0}};
    char *text[2] = {0};
    for (int i = 0; i < 2; i++) {
        nevh_scene *s = scene_of(&two[i]);
        nevh_certain *c = nevh_scene_certain(s, 24);
        if (has_quad(c)) {
            ck_assert_msg(!nevh_certain_go(c, 12), "%s: %s", two[i].potential,
                          nevh_certain_message(c));
            ck_assert_int_ge(nevh_certain_digits(c, 0), 23);
            text[i] = nevh_certain_text(c, 0);
        }
        nevh_certain_free(c);
        nevh_scene_free(s);
    }
    if (text[0] && text[1])
        ck_assert_msg(strncmp(text[0], text[1], 22) == 0, "%s: %s, not %s",
                      two[0].potential, text[0], text[1]);
    free(text[0]);
    free(text[1]);
}

/* Steps from 0 to `until`; the last status, and the time of the last state. */
static int run(nevh_scene *s, nevh_native_use native, double until, double *t) {
    double q[2], p[2], h = until / 50;
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_options o = {.tolerance = 1e-12,
                      .gradient = nevh_exact,
                      .native = native,
                      .steps_foreseen = 50,
                      .q = q,
                      .p = p};
    nevh_stepper *x = nevh_stepper_new(nevh_scene_system(s), nevh_taylor, &o);
    int status = nevh_stepper_status(x);
    if (status) { /* runs of other schemes go on there */
        ck_assert_int_eq(status, NEVH_ESTRUCT);
        assert_says(nevh_stepper_message(x), "(...) is not analytic");
        nevh_stepper_free(x);
        return status;
    }
    for (int i = 0; !status && i < 50; i++) {
        double before[] = {q[0], p[0]};
        status = nevh_stepper_apply(x, i * h, h, q, p);
        *t = (i + !status) * h;
        if (status) {
            assert_says(nevh_stepper_message(x), "is not analytic there");
            ck_assert(q[0] == before[0] && p[0] == before[1]);
        }
    }
    nevh_stepper_free(x);
    return status;
}

static bool is_told_by_name(const formula *f) {
    static const char *const names[] = {"abs(",  "min(", "max(",
                                        "sign(", "mod(", "floor("};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strstr(f->potential, names[i]))
            return true;
    return false;
}

/* As a scheme, compiled or not: it stops with the state before. */
TEST_EACH(steps_end_at_kinks, KINKS) {
    const formula *f = &kinks[_i];
    nevh_scene *s = scene_of(f);
    double until = 1.1 * f->ends, t = 0, compiled = 0;
    int status = run(s, NEVH_NATIVE_NEVER, until, &t);
    if (is_told_by_name(f)) {
        ck_assert_int_eq(status, NEVH_ESTRUCT);
        nevh_scene_free(s);
        return;
    }
    ck_assert_int_eq(status, NEVH_EDOM);
    ck_assert(t < f->ends && t > f->ends - 0.05 * until);
    if (_i % 9 == 0) { /* compilers take their time */
        status = run(s, NEVH_NATIVE_ALWAYS, until, &compiled);
        ck_assert_int_eq(status, NEVH_EDOM);
        ck_assert(compiled == t);
    }
    nevh_scene_free(s);
}

TEST_EACH(steps_of_smooth_formulas_do_not, SMOOTH) {
    nevh_scene *s = scene_of(&smooth[_i]);
    double t = 0;
    ck_assert_int_eq(run(s, NEVH_NATIVE_NEVER, 5, &t), NEVH_OK);
    nevh_scene_free(s);
}

static int smooth_until(const formula *f, double until, char why[200]) {
    nevh_scene *s = scene_of(f);
    double q[2], p[2];
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    int status =
        nevh_solution_smooth(nevh_scene_system(s), 0, until, q, p, why, 200);
    nevh_scene_free(s);
    return status;
}

TEST_EACH(kinks_on_the_way_are_found, KINKS) {
    const formula *f = &kinks[_i];
    char why[200] = "";
    ck_assert_int_eq(smooth_until(f, 0.95 * f->ends, why), NEVH_OK);
    ck_assert_str_eq(why, "");
    ck_assert_int_eq(smooth_until(f, 1.5 * f->ends, why), NEVH_EDOM);
    assert_says(why, is_told_by_name(f) ? "\"V\" is not analytic there"
                                        : "is not analytic there");
}

TEST_EACH(smooth_formulas_have_no_kinks_on_the_way, SMOOTH + SAME) {
    char why[200] = "";
    const formula two = {_i < SMOOTH ? "" : same[_i - SMOOTH].start,
                         _i < SMOOTH ? "" : same[_i - SMOOTH].potential, 0};
    const formula *f = _i < SMOOTH ? &smooth[_i] : &two;
    ck_assert_msg(smooth_until(f, 12, why) == NEVH_OK, "%s: %s", f->potential,
                  why);
}

/* A start at the kink, and at rest there. */
TEST_EACH(kinks_at_the_start_are_found, 4) {
    static const formula at[] = {{"x = 0, 1", "abs(x)^3", 0},
                                 {"x = 0", "abs(x)^3 - 0.3*x*cos(t)", 0},
                                 {"x = 0.5, -1", "max(2*x - 1, 0)^2.5", 0},
                                 {"x = 0", "x^2 + max(x, 0)^3", 0}};
    char why[200] = "";
    ck_assert_int_eq(smooth_until(&at[_i], 5, why), NEVH_EDOM);
    assert_says(why, "at the start, t = 0: ");
}

/* What others are compared with is no series then. */
TEST_EACH(references_are_other_runs_then, KINKS) {
    const formula *f = &kinks[_i];
    nevh_scene *s = scene_of(f);
    double q[2], p[2];
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_reference *r =
        nevh_reference_new(nevh_scene_system(s), NULL, 0, 1.5 * f->ends, q, p);
    ck_assert(strstr(nevh_reference_text(r), "taylor") == NULL);
    nevh_reference_free(r);
    nevh_scene_free(s);
}
