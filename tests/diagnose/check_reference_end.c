/* nevh tests: why a reference ends: chaos, a saddle, or steps that are too
   coarse; and where there is none.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/chaos.h>
#include <nevh/scene.h>
#include <string.h>

enum { MOST = 8 };

typedef struct {
    nevh_scene *scene;
    nevh_reference *reference;
} setup;

static setup refer(const char *coordinates, const char *effects, double t1,
                   const nevh_reference_options *o) {
    double q[MOST], p[MOST];
    setup s = {.scene = scene_with(coordinates, effects)};
    ck_assert_uint_le(nevh_scene_dof(s.scene), MOST);
    nevh_scene_start(s.scene, q, p);
    s.reference =
        nevh_reference_with(nevh_scene_system(s.scene), o, 0, t1, q, p);
    return s;
}

static void tear_down(setup *s) {
    nevh_reference_free(s->reference);
    nevh_scene_free(s->scene);
}

#define RODS                                                                   \
    "T = (p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2))\n"    \
    "V = -9.8*(2*cos(a) + cos(b))"
#define HEILES "T = (p_x^2 + p_y^2)/2\nV = (x^2 + y^2)/2 + x^2*y - y^3/3"

/* Of the chaotic ones, the exponents that are in the literature, or found by
   another program over 1e5 units of time, within a factor that the spread of
   finite times allows. */
static const struct {
    const char *coordinates, *effects;
    double t1;
    nevh_reference_end end;
    double exponent;
} ends[] = {
    {"a = 3\nb = 3", RODS, 200, NEVH_REFERENCE_CHAOS, 1.3},
    {"x = 0\ny = -0.25\np_x = 0.42", HEILES, 2000, NEVH_REFERENCE_CHAOS, 0.045},
    {"a = 1.1\nb = 0\np_b = 2.7746", RODS, 100, NEVH_REFERENCE_WHOLE, 0},
    {"x = 0\ny = 0.1\np_x = 0.2", HEILES, 2000, NEVH_REFERENCE_WHOLE, 0},
    /* Shear: neighbours separate in proportion to the time. */
    {"x = 1", "T = p_x^2/2\nV = x^4/4", 3000, NEVH_REFERENCE_WHOLE, 0},
    /* All grows alike. */
    {"x = 1", "T = p_x^2/2\nV = -x^2/2", 300, NEVH_REFERENCE_WHOLE, 0},
    {"x = 1", "T = p_x^2/2\nV = -exp(t)*x^2", 9, NEVH_REFERENCE_WHOLE, 0},
    {"x = 1", "T = p_x^2/2\nV = x/(t - 4.7)", 10, NEVH_REFERENCE_COARSE, 0},
    /* Into a saddle again and again: one degree of freedom is never chaotic. */
    {"x = 1e-14", "T = p_x^2/2\nV = -x^2/2 + x^4/4", 200,
     NEVH_REFERENCE_SENSITIVE, 0},
};
enum { ENDS = sizeof ends / sizeof *ends };

TEST_EACH(ends_have_reasons, ENDS) {
    setup s = refer(ends[_i].coordinates, ends[_i].effects, ends[_i].t1, NULL);
    ck_assert_str_eq(nevh_reference_message(s.reference), "");
    ck_assert_int_eq(nevh_reference_why(s.reference), ends[_i].end);
    bool whole = ends[_i].end == NEVH_REFERENCE_WHOLE;
    ck_assert_int_eq(nevh_reference_horizon(s.reference) == INFINITY, whole);
    double rate = nevh_reference_exponent(s.reference);
    if (whole || ends[_i].end == NEVH_REFERENCE_COARSE) {
        ck_assert(isnan(rate));
        ck_assert(isnan(nevh_reference_growth(s.reference)));
    } else {
        ck_assert_double_gt(nevh_reference_growth(s.reference), 1e4);
    }
    if (ends[_i].exponent > 0) {
        ck_assert_double_gt(rate, ends[_i].exponent / 2);
        ck_assert_double_lt(rate, ends[_i].exponent * 2);
    }
    if (whole)
        ck_assert_double_lt(nevh_reference_error(s.reference), 1e-9);
    tear_down(&s);
}

/* Momenta turned round are the same orbit backward in time. */
TEST(chaos_is_found_backward) {
    setup chaotic = refer("a = 3\nb = 3", RODS, -200, NULL);
    ck_assert_int_eq(nevh_reference_why(chaotic.reference),
                     NEVH_REFERENCE_CHAOS);
    ck_assert_double_gt(nevh_reference_growth(chaotic.reference), 1e4);
    ck_assert_double_gt(nevh_reference_exponent(chaotic.reference), 0.6);
    tear_down(&chaotic);
    setup regular = refer("a = 1.1\nb = 0\np_b = 2.7746", RODS, -100, NULL);
    ck_assert_int_eq(nevh_reference_why(regular.reference),
                     NEVH_REFERENCE_WHOLE);
    tear_down(&regular);
}

static nevh_chaos_finding find_towards(double t1, double p) {
    nevh_scene *scene = scene_with("x = 0\ny = -0.25", HEILES);
    double q[2] = {0, -0.25}, start[2] = {p, 0};
    nevh_options o = {.q = q, .p = start};
    nevh_chaos_finding f;
    ck_assert_int_eq(
        nevh_chaos_find(nevh_scene_system(scene), &o, 0, t1, 0, &f), NEVH_OK);
    nevh_scene_free(scene);
    return f;
}

TEST(growth_is_that_of_the_reversed_orbit) {
    nevh_chaos_finding back = find_towards(-400, 0.42);
    nevh_chaos_finding there = find_towards(400, -0.42);
    ck_assert_double_gt(back.growth, 2);
    ck_assert_double_eq_tol(back.growth, there.growth, 0.1);
    ck_assert_double_eq_tol(back.report.t, -there.report.t, 1);
    ck_assert_int_eq(back.report.verdict, there.report.verdict);
}

/* A run that does not see what rows see: with their step it does.  Of abs there is no
   series, which would see the wall. */
TEST(steps_are_no_longer_than_asked_for) {
    const char wall[] = "T = p_x^2/2\nV = 2*exp(-((abs(x) - 1.777)/0.0002)^2)";
    setup blind = refer("x = 0, 1", wall, 4, NULL);
    setup seeing = refer("x = 0, 1", wall, 4,
                         &(nevh_reference_options){.longest = 0.0002});
    double q, p;
    ck_assert_int_eq(nevh_reference_state(seeing.reference, 4, &q, &p),
                     NEVH_OK);
    ck_assert_double_eq_tol(p, -1, 1e-9);
    ck_assert_double_lt(nevh_reference_error(seeing.reference), 1e-9);
    /* What this guards against: the other goes through. */
    ck_assert_int_eq(nevh_reference_state(blind.reference, 4, &q, &p), NEVH_OK);
    ck_assert_double_eq_tol(p, 1, 1e-6);
    tear_down(&blind);
    tear_down(&seeing);
    seeing =
        refer("x = 0, 1", wall, 4, &(nevh_reference_options){.longest = -1});
    ck_assert_int_eq(nevh_reference_status(seeing.reference), NEVH_EINVAL);
    tear_down(&seeing);
}

/* Jumps of H that no derivative sees, of constant H and of others; the last are none,
   however steep. */
static const struct {
    const char *effects;
    bool jumps;
    const char *text;
} jumps[] = {
    {"T = p_x^2/2\nV = sign(x)", true, "by 2 near t = 0.333333"},
    {"T = p_x^2/2\nV = x^2/2 + x^4/4\nW = 1e-6*floor(x)", true, "effect \"W\""},
    {"T = p_x^2/2 + 0.1*sign(p_x - 2.5)\nV = x^2/2", true, "effect \"T\""},
    {"T = p_x^2/2\nV = x^2/2 + 0.3*x/abs(x)\nD = 0.1*x*cos(t)", true,
     "by 0.6 near t = 0.3"},
    {"T = p_x^2/2\nV = x^2/2 + 0.3*tanh(1/x)\nD = 0.1*x*cos(t)", true,
     "effect \"V\""},
    {"T = p_x^2/2\nV = 0.3*x/abs(x)\n[friction]\nV = all: 0.1", true,
     "effect \"V\""},
    {"T = p_x^2/2\nV = x^2/2 + max(x, 0)^5\nD = 0.1*x*cos(t)", false, ""},
    {"T = p_x^2/2\nV = x^2/2 + tanh(20*x)\nD = 0.1*x*cos(t)", false, ""},
    {"T = p_x^2/2\nV = tanh(20*x)", false, ""},
    {"T = p_x^2/2\nV = 1e12 + x^2/2 + x^4/4", false, ""},
    {"T = p_x^2/2\nV = x^2/2 + x^4/4\nW = 1e-6*max(x, 0)^5", false, ""},
};
enum { JUMPS = sizeof jumps / sizeof *jumps };

TEST_EACH(jumps_are_found, JUMPS) {
    setup s = refer("x = -1, 3", jumps[_i].effects, 10, NULL);
    const char *message = nevh_reference_message(s.reference);
    if (jumps[_i].jumps) {
        ck_assert_int_eq(nevh_reference_status(s.reference), NEVH_EDOM);
        ck_assert_ptr_nonnull(strstr(message, "H jumps"));
        ck_assert_ptr_nonnull(strstr(message, jumps[_i].text));
        ck_assert_str_eq(nevh_reference_text(s.reference), "");
    } else {
        ck_assert_str_eq(message, "");
        ck_assert_double_lt(nevh_reference_error(s.reference), 1e-9);
    }
    tear_down(&s);
}

/* From rest on a kink more than one orbit may go on: runs agree on one of them. */
static const struct {
    const char *start, *effects;
    bool rests;
} edges[] = {
    {"x = 1", "T = p_x^2/2\nV = (x - floor(x) - 0.5)^2", true},
    {"x = 1", "T = p_x^2/2\nV = (x - 1)^2 - abs(x - 1)", true},
    {"x = 0, 1e-9", "T = p_x^2/2 + abs(p_x - 1e-9)\nV = x^4", true},
    {"x = 1, 0.5", "T = p_x^2/2\nV = abs(x - 1) + x^2/8", false},
    {"x = 1, 1e-6", "T = p_x^2/2\nV = (x - 1)^2 - abs(x - 1)", false},
    {"x = 0.01", "T = p_x^2/2\nV = 1 - cos(x) + 0*bessel_j0(x)", false},
    {"x = 1.001", "T = p_x^2/2\nV = abs(x - 1) + x^2/8", false},
};

TEST_EACH(rest_on_a_kink_is_refused, sizeof edges / sizeof *edges) {
    setup s = refer(edges[_i].start, edges[_i].effects, 0.5, NULL);
    const char *message = nevh_reference_message(s.reference);
    ck_assert_msg(!strstr(message, "starts at rest on a kink") ==
                      !edges[_i].rests,
                  "%s", message);
    tear_down(&s);
}

/* A scheme of low order: as good as can be afforded, and it says how good. */
TEST(poor_schemes_are_poor_references) {
    nevh_reference_options o = {.integrator = nevh_euler};
    double q, p;
    setup s = refer("x = 1", "T = p_x^2/2\nV = x^2/2 + x^4/4", 10, &o);
    setup good = refer("x = 1", "T = p_x^2/2\nV = x^2/2 + x^4/4", 10, NULL);
    ck_assert_str_eq(nevh_reference_message(s.reference), "");
    ck_assert_int_eq(nevh_reference_why(s.reference), NEVH_REFERENCE_WHOLE);
    double own = nevh_reference_error(s.reference), x;
    ck_assert_double_lt(own, 1e-3);
    nevh_reference_state(s.reference, 10, &q, &p);
    nevh_reference_state(good.reference, 10, &x, &p);
    double off = fabs(q - x) / nevh_reference_range(good.reference, 0);
    ck_assert_double_gt(off, 1e-8);
    ck_assert_double_lt(off, 3 * own);
    tear_down(&s);
    tear_down(&good);
}
