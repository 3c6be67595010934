/* nevh tests: series hold no longer than H is what they say, where a part of it is
   too small to be seen where they begin.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/certain.h>
#include <nevh/run.h>
#include <nevh/scene.h>
#include <stdio.h>

/* x at a time, by gauss8 with steps of 1e-4. */
typedef struct {
    const char *start, *potential;
    double t, x;
} orbit;

static const orbit orbits[] = {
    /* saturated */
    {"x = 1, 0.1", "x*tanh(100*x)", 5, 0.7078410619995},
    {"x = 1, 0.1", "x + 4*x/(1 + exp(200*x))", 5, -35.25114571691},
    {"x = 50, -1", "log(1 + exp(-40*x))", 100, 49.9389577013520},
    /* an exponential, below the least double or not */
    {"x = 1, 0.1", "x^2/2 + 5*exp(-((x - 0.2)/0.01)^2)", 5, 0.863857535959},
    {"x = 2, 0", "exp(-1000*x) + x", 6, 0.00416245558538},
    {"x = 100, -1", "(1 - exp(-10*x))^2", 200, 100.040546510811},
    {"x = 1000, -1", "1000*exp(-x)/x", 2000, 1009.28513640858},
    {"x = 1, 0.1", "x^2/2 + 3/cosh(400*(x - 0.3))^2", 5, 0.991924563925},
    {"x = 2, 0", "x^2/2 + 2^(-1000*x)", 8, 0.273180076631},
    {"x = 0, 1", "sinh(x^40)^2", 8, -0.0405462906099},
    /* of more orders than the series has, or of few of them */
    {"x = 0, 1", "x^100", 5, 0.972227197297},
    {"x = 0.1, 1", "(x/2)^200", 5, -1.086276870299},
    {"x = 0, 1", "x^10*x^20*x^10*x^30", 8, -0.0769538149478},
    {"x = 0, 1", "x^20", 5, 0.871961487168},
    {"x = 0, 1", "x^12", 5, 0.800601861962},
    {"x = 0, 1", "x^10", 5, 0.768727469496},
    {"x = 0, 1", "x^4", 5, 0.576198523564},
    /* poles that are far */
    {"x = 1000, -1", "x^-24", 2000, 1001.937162149651},
    {"x = 1000, -1", "1/x^12", 2000, 1001.8633178548},
    /* walls that are thin and low from afar */
    {"x = 1, -0.3", "x^2/2 + 1/(1 + ((x - 0.5)/1e-4)^12)", 5, 0.558542148986},
    {"x = 1, -0.3", "x^2/2 + 1/(1 + ((x - 0.5)/1e-6)^8)", 5, 0.558864122906},
    {"x = 1, -0.3", "x^2/2 + 1/(1 + ((x - 0.5)/1e-6)^2)^4", 5, 0.558866684981},
    {"x = 1, -0.3", "x^2/2 + cos(atan((x - 0.5)/1e-6))^40", 5, 0.558866792254},
    {"x = 1, 0", "x^2/2 + (1/(1 + ((x - 0.3)/1e-5)^2))^2", 2, 0.8616886591},
    {"x = 1, 0", "x^2/2 + 1/(1 + ((x - 0.3)/1e-6)^2)", 2, 0.861688381203},
    {"x = 1, 0", "x^2/2 + (1 + ((x - 0.3)/1e-6)^2)^-1", 2, 0.861688381203},
    /* no pole: it cancels */
    {"x = 1, 1", "-sin(x)/x", 10, -2.08341831134797},
};
enum { ORBITS = sizeof orbits / sizeof *orbits };

static nevh_scene *scene_of(const orbit *o) {
    char text[400];
    snprintf(text, sizeof text,
             "[coordinates]\n%s\n[effects]\nT = p_x^2/2\nV = %s\n", o->start,
             o->potential);
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

static void assert_close(const orbit *o, double x, double allowed) {
    ck_assert_msg(fabs(x - o->x) <= allowed * fmax(fabs(o->x), 1),
                  "%s: x(%g) = %.15g instead of %.15g", o->potential, o->t, x,
                  o->x);
}

/* In both arithmetics. */
TEST_EACH(certain_states_see_what_is_small_at_first, 2 * ORBITS) {
    const orbit *o = &orbits[_i / 2];
    nevh_scene *s = scene_of(o);
    nevh_certain *c = nevh_scene_certain(s, _i % 2 ? 30 : 20);
    if (nevh_certain_status(c))
        assert_says(nevh_certain_message(c), "libquadmath");
    else {
        ck_assert_msg(!nevh_certain_go(c, o->t), "%s: %s", o->potential,
                      nevh_certain_message(c));
        ck_assert_int_ge(nevh_certain_digits(c, 0), 15);
        assert_close(o, nevh_certain_value(c, 0), 1e-11);
    }
    nevh_certain_free(c);
    nevh_scene_free(s);
}

TEST_EACH(steps_see_what_is_small_at_first, ORBITS) {
    enum { STEPS = 50 };
    const orbit *o = &orbits[_i];
    nevh_scene *s = scene_of(o);
    double q, p, h = o->t / STEPS;
    ck_assert_int_eq(nevh_scene_start(s, &q, &p), NEVH_OK);
    nevh_options options = {.tolerance = 1e-14,
                            .gradient = nevh_exact,
                            .steps_foreseen = STEPS,
                            .q = &q,
                            .p = &p};
    nevh_stepper *x =
        nevh_stepper_new(nevh_scene_system(s), nevh_taylor, &options);
    for (int i = 0; i < STEPS; i++)
        ck_assert_msg(!nevh_stepper_apply(x, i * h, h, &q, &p), "%s: %s",
                      o->potential, nevh_stepper_message(x));
    assert_close(o, q, 1e-8);
    nevh_stepper_free(x);
    nevh_scene_free(s);
}
