/* nevh tests: what scenes show, draw, monitor and stop at.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene.h"
#include "support.h"
#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static nevh_scene *scene_of(const char *text) {
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(nevh_scene_status(s) == NEVH_OK, "%s", nevh_scene_message(s));
    return s;
}

static void assert_close(double a, double b) {
    ck_assert_msg(fabs(a - b) <= 1e-14 * (1 + fabs(b)), "%.17g, not %.17g", a,
                  b);
}

static const double Q[] = {0.7, -1.3}, P[] = {0.4, 2.5};

/* dH/dp of the double pendulum, written out. */
static double velocity_1(void) {
    double d = Q[0] - Q[1];
    return (P[0] - P[1] * cos(d)) / (1 + sin(d) * sin(d));
}

TEST(observables_at_a_state) {
    nevh_scene *s = scene_of(shaken_pendulum);
    static const char *const names[] = {"x1", "y1", "x2", "y2", "speed"};
    double x = sin(Q[0]), y = -cos(Q[0]), values[5];
    double expected[] = {x, y, x + sin(Q[1]), y - cos(Q[1]), velocity_1()};
    ck_assert_uint_eq(nevh_scene_shown_count(s, NEVH_OBSERVABLES), 5);
    ck_assert_int_eq(
        nevh_scene_shown_values(s, NEVH_OBSERVABLES, 3, Q, P, values), NEVH_OK);
    for (size_t i = 0; i < 5; i++) {
        ck_assert_str_eq(nevh_scene_shown_name(s, NEVH_OBSERVABLES, i),
                         names[i]);
        assert_close(values[i], expected[i]);
    }
    ck_assert_ptr_null(nevh_scene_shown_name(s, NEVH_OBSERVABLES, 5));
    nevh_scene_free(s);
}

static double only_observable(nevh_scene *s, double t) {
    double value = NAN;
    ck_assert_int_eq(
        nevh_scene_shown_values(s, NEVH_OBSERVABLES, t, Q, P, &value), NEVH_OK);
    return value;
}

TEST(velocities_are_those_of_effects_that_are_on) {
    nevh_scene *s =
        scene_of("[parameters]\nm = 2\n[coordinates]\nx = 0\n[effects]\n"
                 "kinetic = p_x^2/(2*m)\nfield = p_x*sin(t)\n"
                 "[observables]\nv = 10*v_x + t\n");
    assert_close(only_observable(s, 3), 10 * (0.4 / 2 + sin(3)) + 3);
    nevh_scene_enable(s, "field", false);
    assert_close(only_observable(s, 3), 10 * (0.4 / 2) + 3);
    nevh_scene_set(s, "m = 4");
    assert_close(only_observable(s, 3), 10 * (0.4 / 4) + 3);
    nevh_scene_enable(s, "field", true);
    assert_close(only_observable(s, 1), 10 * (0.4 / 4 + sin(1)) + 1);
    nevh_scene_free(s);
}

TEST(velocities_of_elements) {
    nevh_scene *s = scene_of(
        "[coordinates]\nx[1..2] = 0\n[effects]\n"
        "T = sum(i = 1..2, i*p_x[i]^2/2)\n"
        "[observables]\na = sum(i = 1..2, 10^i*v_x[i]) + x[1]*p_x[2]\n");
    assert_close(only_observable(s, 0), 10 * 0.4 + 100 * 5 + 0.7 * 2.5);
    nevh_scene_free(s);
}

TEST(an_effect_that_breaks_an_invariant_hides_it) {
    nevh_scene *s =
        scene_of("[coordinates]\nx = 0\ny = 0\n[effects]\n"
                 "T = p_x^2 + p_y^2\nU = x\nW = y\n[friction]\nd = all: 1\n"
                 "[invariants]\npx = p_x ; without U, d\n"
                 "py = p_y ; without W\nsum_of = x + y\n");
    double values[3];
    ck_assert_uint_eq(nevh_scene_shown_count(s, NEVH_INVARIANTS), 1);
    ck_assert_str_eq(nevh_scene_shown_name(s, NEVH_INVARIANTS, 0), "sum_of");
    nevh_scene_enable(s, "W", false);
    nevh_scene_enable(s, "U", false);
    ck_assert_uint_eq(nevh_scene_shown_count(s, NEVH_INVARIANTS), 2);
    nevh_scene_shown_values(s, NEVH_INVARIANTS, 0, Q, P, values);
    ck_assert(values[0] == 2.5 && fabs(values[1] + 0.6) < 1e-15);
    nevh_scene_enable(s, "d", false);
    ck_assert_uint_eq(nevh_scene_shown_count(s, NEVH_INVARIANTS), 3);
    ck_assert_str_eq(nevh_scene_shown_name(s, NEVH_INVARIANTS, 0), "px");
    nevh_scene_shown_values(s, NEVH_INVARIANTS, 0, Q, P, values);
    ck_assert(values[0] == 0.4);
    nevh_scene_free(s);
}

TEST(sections_of_a_scene) {
    nevh_scene *s = scene_of(shaken_pendulum);
    double value, items[2];
    ck_assert_uint_eq(nevh_scene_section_count(s), 2);
    const nevh_scene_section *swing = nevh_scene_section_at(s, 0);
    ck_assert_str_eq(swing->name, "swing");
    ck_assert(swing->direction == 1 && swing->every == 0);
    ck_assert(swing->period == 2 * PI && swing->items == 2);
    ck_assert_str_eq(swing->item[1], "p_phi2");
    ck_assert(!nevh_scene_section_cross(s, 0, 0, Q, P, &value));
    ck_assert(value == Q[0]);
    ck_assert(!nevh_scene_section_items(s, 0, 0, Q, P, items));
    ck_assert(items[0] == Q[1] && items[1] == P[1]);
    const nevh_scene_section *strobe = nevh_scene_section_at(s, 1);
    assert_close(strobe->every, 2 * PI / 20);
    ck_assert(strobe->period == strobe->every && strobe->direction == 1);
    ck_assert(!nevh_scene_section_cross(s, 1, 7, Q, P, &value) && value == 7);
    ck_assert_ptr_null(nevh_scene_section_at(s, 2));
    ck_assert_int_eq(nevh_scene_section_cross(s, 2, 0, Q, P, &value),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_scene_section_items(s, 2, 0, Q, P, items),
                     NEVH_EINVAL);
    nevh_scene_free(s);
}

TEST(crossings_of_all_kinds) {
    nevh_scene *s = scene_of(
        "[parameters]\nk = 2\n[coordinates]\n"
        "x[1..2] = 0 ; period 3\n[effects]\nT = p_x[1]^2 + p_x[2]^2\n"
        "[sections]\na = when x[k] = x[1]^2, falling: t, v_x[2]\n"
        "b = when x[1] + 0 = 1, both: x[1]\nc = when p_x[1] = 1, rising: t\n"
        "d = every k: t\n[run]\nt_start = 5\n");
    double value, items[2];
    ck_assert(nevh_scene_section_at(s, 0)->period == 3);
    ck_assert(nevh_scene_section_at(s, 0)->direction == -1);
    ck_assert(!nevh_scene_section_cross(s, 0, 0, Q, P, &value));
    assert_close(value, Q[1] - Q[0] * Q[0]);
    ck_assert(!nevh_scene_section_items(s, 0, 9, Q, P, items));
    ck_assert(items[0] == 9 && items[1] == 2 * P[1]);
    ck_assert(nevh_scene_section_at(s, 1)->period == 0);
    ck_assert(nevh_scene_section_at(s, 1)->direction == 0);
    ck_assert(nevh_scene_section_at(s, 2)->period == 0);
    ck_assert(!nevh_scene_section_cross(s, 3, 9, Q, P, &value) && value == 4);
    nevh_scene_set(s, "k = 1");
    ck_assert(!nevh_scene_section_cross(s, 0, 0, Q, P, &value));
    assert_close(value, Q[0] - Q[0] * Q[0]);
    ck_assert(nevh_scene_section_at(s, 3)->every == 1);
    nevh_scene_free(s);
}

TEST(a_strobe_needs_time) {
    nevh_scene *s =
        nevh_scene_parse("test", "[coordinates]\nx = 0\n[effects]\nT = p_x^2\n"
                                 "[sections]\na = every 1 - 1: x\n");
    ck_assert_ptr_nonnull(strstr(nevh_scene_message(s),
                                 "test:6:11: error: this must be greater"));
    ck_assert_ptr_null(nevh_scene_section_at(s, 0));
    nevh_scene_free(s);
}

TEST(parts_have_names_and_texts) {
    nevh_scene *s = nevh_scene_parse(
        "test", "[coordinates]\nx = 0\n[effects]\nT = p_x^2\n[picture]\n"
                "bob = x, 2*x ; name The Moon \nrod = 0, 0, x, x\n");
    ck_assert_str_eq(nevh_scene_part_at(s, 0).name, "The Moon");
    ck_assert_str_eq(nevh_scene_part_at(s, 0).item[0], "x");
    ck_assert_str_eq(nevh_scene_part_at(s, 0).item[1], "2*x");
    ck_assert_uint_eq(nevh_scene_part_at(s, 0).count, 2);
    ck_assert_ptr_null(nevh_scene_part_at(s, 1).name);
    ck_assert_str_eq(nevh_scene_part_at(s, 1).item[3], "x");
    nevh_scene_free(s);
}

TEST(parts_of_the_picture) {
    nevh_scene *s = scene_of(shaken_pendulum);
    double values[4], x = sin(Q[0]), y = -cos(Q[0]);
    ck_assert_uint_eq(nevh_scene_part_count(s), 4);
    ck_assert_str_eq(nevh_scene_part_at(s, 1).kind, "rod");
    ck_assert_str_eq(nevh_scene_part_at(s, 2).kind, "bob");
    ck_assert_uint_eq(nevh_scene_part_at(s, 2).count, 2);
    ck_assert_ptr_null(nevh_scene_part_at(s, 4).kind);
    ck_assert(!nevh_scene_part_values(s, 1, 0, Q, P, values));
    ck_assert_uint_eq(nevh_scene_part_at(s, 1).count, 4);
    assert_close(values[0], x);
    assert_close(values[1], y);
    assert_close(values[2], x + sin(Q[1]));
    assert_close(values[3], y - cos(Q[1]));
    ck_assert_int_eq(nevh_scene_part_values(s, 4, 0, Q, P, values),
                     NEVH_EINVAL);
    nevh_scene_free(s);
}

TEST(periods_of_coordinates) {
    nevh_scene *s = scene_of(moving_chain);
    ck_assert(nevh_scene_period(s, 0) == 0 && nevh_scene_period(s, 3) == 4);
    ck_assert(nevh_scene_period(s, 4) == 0);
    nevh_scene_free(s);
}

static bool stops_at(nevh_scene *s, double x) {
    bool reached;
    double p = 0;
    ck_assert_int_eq(nevh_scene_stop_reached(s, 0, &x, &p, &reached), NEVH_OK);
    return reached;
}

#define PARTICLE "[coordinates]\nx = 0\n[effects]\nT = p_x^2\n[run]\n"
TEST(stops_below_and_above) {
    nevh_scene *none = scene_of(PARTICLE);
    ck_assert(!nevh_scene_stops(none) && !stops_at(none, 1));
    ck_assert_ptr_null(nevh_scene_stop_text(none));
    nevh_scene *below = scene_of(PARTICLE "stop = x^2 < 1/4");
    ck_assert_str_eq(nevh_scene_stop_text(below), "x^2 < 1/4");
    ck_assert(nevh_scene_stops(below) && !stops_at(below, 0.5));
    ck_assert(stops_at(below, -0.499) && !stops_at(below, NAN));
    nevh_scene *above = scene_of(PARTICLE "stop = x^2 > 1/4");
    ck_assert(!stops_at(above, 0.5) && stops_at(above, -0.501));
    nevh_scene_free(none);
    nevh_scene_free(below);
    nevh_scene_free(above);
}

TEST(nothing_in_a_scene_that_was_not_read) {
    nevh_scene *s = nevh_scene_parse("test", "nonsense");
    double value;
    bool reached;
    ck_assert_uint_eq(nevh_scene_shown_count(s, NEVH_OBSERVABLES), 0);
    ck_assert_uint_eq(nevh_scene_section_count(s), 0);
    ck_assert_uint_eq(nevh_scene_part_count(s), 0);
    ck_assert(!nevh_scene_stops(s) && nevh_scene_period(s, 0) == 0);
    ck_assert_int_eq(
        nevh_scene_shown_values(s, NEVH_INVARIANTS, 0, Q, P, &value),
        NEVH_EINVAL);
    ck_assert_int_eq(nevh_scene_section_cross(s, 0, 0, Q, P, &value),
                     NEVH_EINVAL);
    ck_assert_int_eq(nevh_scene_stop_reached(s, 0, Q, P, &reached),
                     NEVH_EINVAL);
    nevh_scene_free(s);
}

/* The element that a section asks for may be set. */
TEST(an_element_that_is_not_there) {
    nevh_scene *s = scene_of("[parameters]\nk = 1\n[coordinates]\n"
                             "x[1..2] = 0 ; period 3\n[effects]\nT = x[1]^2\n"
                             "[sections]\nc = when x[k] = 0, both: t\n");
    double value;
    ck_assert_int_eq(nevh_scene_set(s, "k = 3"), NEVH_EINVAL);
    ck_assert(nevh_scene_section_at(s, 0)->period == 3);
    ck_assert(!nevh_scene_section_cross(s, 0, 0, Q, P, &value));
    ck_assert(value == Q[0]);
    nevh_scene_free(s);
}

static uint64_t digest_of(const char *text, const char *off, const char *set) {
    nevh_scene *s = scene_of(text);
    if (off)
        nevh_scene_enable(s, off, false);
    if (set)
        nevh_scene_set(s, set);
    uint64_t digest = nevh_scene_digest(s);
    nevh_scene_free(s);
    return digest;
}

#define SPRING   "[coordinates]\nx = 1\n[effects]\nT = p_x^2\n"
#define STRENGTH "[parameters]\nk = 1\n"
TEST(digests_tell_scenes_apart) {
    uint64_t one = digest_of(STRENGTH SPRING "V = k*x^2\n", NULL, NULL);
    ck_assert(digest_of("# a comment\n" STRENGTH SPRING "V  =  k*x^2 # more\n",
                        NULL, NULL) == one);
    ck_assert(digest_of(STRENGTH SPRING "V = k*x^3\n", NULL, NULL) != one);
    ck_assert(digest_of(STRENGTH SPRING "W = k*x^2\n", NULL, NULL) != one);
    ck_assert(digest_of(STRENGTH SPRING "V = k*x^2\n", "V", NULL) != one);
    ck_assert(digest_of(STRENGTH SPRING "V = k*x^2\n", NULL, "k = 2") != one);
    ck_assert(digest_of(STRENGTH SPRING "V = k*x^2\n[run]\ndt = 1\n", NULL,
                        NULL) != one);
}
