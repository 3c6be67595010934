/* nevh tests: series end where a function of H stops being analytic.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/certain.h>
#include <nevh/reference.h>
#include <nevh/scene.h>
#include <nevh/run.h>
#include <stdio.h>

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
enum {
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
    ck_assert_msg(!status, "%s", nevh_stepper_message(x));
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

/* As a scheme, compiled or not: it stops with the state before. */
TEST_EACH(steps_end_at_kinks, KINKS) {
    const formula *f = &kinks[_i];
    nevh_scene *s = scene_of(f);
    double until = 1.1 * f->ends, t = 0, compiled = 0;
    int status = run(s, NEVH_NATIVE_NEVER, until, &t);
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
