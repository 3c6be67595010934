/* nevh tests: momenta that belong to initial velocities.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <stdio.h>

enum { MOST = 3 };

/* H of x, y, z at 1, 0.5, 2 and of the momenta given. */
static const struct {
    const char *h;
    size_t n;
    double p[MOST];
} cases[] = {
    {"sqrt(1 + (p_x + 8)^2 + p_y^2)", 2, {-7.93, 0.118}},
    {"sqrt(1 + (p_x + 8)^2 + p_y^2)", 2, {30, -20}},
    {"sqrt(1 + (p_x - 125)^2 + (p_y - 460)^2 + (p_z - 121)^2)",
     3,
     {125, 490, 122}},
    {"sqrt(1 + (p_x - 1e6)^2)", 1, {999998}},
    {"sqrt(1 + (p_x - y/2)^2 + (p_y + x/2)^2)", 2, {3, -2}},
    {"sqrt((3e8*p_x)^2 + (3e8*p_y)^2 + (9.1e-31*9e16)^2)", 2, {1e-21, -3e-22}},
    {"sqrt(1 + (p_x/1e-20 + 40)^2)", 1, {-39e-20}},
    {"sqrt(1 + p_x^2) + sqrt(4 + p_y^2) + 0.1*p_x*p_y", 2, {2, -5}},
    {"sqrt(1 + (p_x + 8)^2*(1 + y^2)) + p_y^2/2", 2, {-8.01, 2}},
    {"log(cosh(p_x - 20))", 1, {19}},
    {"cosh(p_x)", 1, {5}},
    {"cosh(p_x - 3) + p_y^2/2 + 0.3*p_x*p_y", 2, {4, -1}},
    {"p_x^4/4", 1, {-1e-3}},
    {"p_x^6/6 + p_y^6/6 + (p_x + p_y)^2/2", 2, {-2, 3}},
    {"abs(p_x)^1.5", 1, {9}},
    {"p_x*log(p_x)", 1, {3}},
    {"1 - cos(p_x)", 1, {1.2}},
    {"(p_x^2 + 2*p_y^2 - 2*p_x*p_y*cos(x - y))/(2*(1 + sin(x - y)^2))",
     2,
     {1, 2}},
    {"p_x^2/(2*9.1e-31)", 1, {1e-25}},
    {"(p_x + 0.3*y)^2/2 + (p_y - 0.3*x)^2/2", 2, {-0.15, 0.3}},
};
enum { CASES = sizeof cases / sizeof *cases };

static const char letters[] = "xyz";

static nevh_scene *scene_of(const char *h, size_t n, const double v[]) {
    static const double q[] = {1, 0.5, 2};
    char text[600], *at = text;
    at += sprintf(at, "[coordinates]\n");
    for (size_t k = 0; k < n; k++)
        at += sprintf(at, "%c = %.17g\n", letters[k], q[k]);
    for (size_t k = 0; v && k < n; k++)
        at += sprintf(at, "v_%c = %.17g\n", letters[k], v[k]);
    sprintf(at, "[effects]\nH = %s\n", h);
    return nevh_scene_parse("test", text);
}

/* dH/dp of a scene at its coordinates. */
static void velocities(nevh_scene *s, const double p[], double v[]) {
    const double q[] = {1, 0.5, 2};
    double dq[MOST], t = 0;
    nevh_options o = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_field *f = nevh_field_new(nevh_scene_system(s), &o);
    ck_assert_int_eq(nevh_field_gradient(f, 1, &t, q, p, dq, v), NEVH_OK);
    nevh_field_free(f);
}

TEST_EACH(velocities_are_turned_into_momenta, CASES) {
    size_t n = cases[_i].n;
    double v[MOST], q[MOST], p[MOST], reached[MOST], most = 0;
    nevh_scene *plain = scene_of(cases[_i].h, n, NULL);
    velocities(plain, cases[_i].p, v);
    nevh_scene *given = scene_of(cases[_i].h, n, v);
    ck_assert_msg(nevh_scene_start(given, q, p) == NEVH_OK, "%s: %s",
                  cases[_i].h, nevh_scene_message(given));
    velocities(plain, p, reached);
    for (size_t k = 0; k < n; k++)
        most = fmax(most, fabs(v[k]));
    for (size_t k = 0; k < n; k++)
        ck_assert_msg(fabs(reached[k] - v[k]) <= 1e-9 * most + 1e-15,
                      "%s: v_%c %g, %g", cases[_i].h, letters[k], reached[k],
                      v[k]);
    nevh_scene_free(plain);
    nevh_scene_free(given);
}

/* Momenta have too few digits for all of these: the velocity at rest is 55833. */
TEST(rounding_of_the_velocity_at_rest_is_no_reason) {
    static const double v[] = {-72.85056564572892, 0.001213330004682846};
    double q[MOST], p[MOST], reached[MOST];
    static const char h[] = "((p_x + 134*y)^2 + (p_y - 134*x)^2)/0.0048";
    nevh_scene *given = scene_of(h, 2, v);
    ck_assert_msg(nevh_scene_start(given, q, p) == NEVH_OK, "%s",
                  nevh_scene_message(given));
    velocities(given, p, reached);
    for (size_t k = 0; k < 2; k++)
        ck_assert_double_eq_tol(reached[k], v[k], 4e-11);
    nevh_scene_free(given);
}

/* What no momentum gives, and why. */
static const struct {
    const char *h;
    double v[MOST];
    size_t n;
    const char *why;
} impossible[] = {
    {"sqrt(1 + p_x^2)", {1.5}, 1, "v_x comes no closer to 1.5 than 1"},
    {"sqrt(1 + p_x^2)", {1}, 1, "a limit"},
    {"sqrt(1 + (p_x + 8)^2)", {1.2}, 1, "v_x comes no closer to 1.2 than 1"},
    {"sqrt(1 + (p_x - 8)^2)", {-1.2}, 1, "v_x comes no closer to -1.2 than -1"},
    {"sqrt(1 + (p_x + 8)^2 + p_y^2)",
     {1.2, 0},
     2,
     "v_x comes no closer to 1.2 than 1"},
    {"sqrt(1 + p_x^2 + p_y^2)", {0.8, -0.6}, 2, ""},
    {"sqrt(1 + (p_x + 8)^2)", {-1}, 1, "a limit"},
    {"p_x^2/(2*(x - 1))", {2}, 1, "effect \"H\" has no finite derivatives"},
    {"x^2", {2}, 1, "v_x comes no closer to 2 than 0"},
    {"(p_x + p_y)^2/2", {1, 2}, 2, "comes no closer"},
    {"2*abs(p_x)", {2}, 1, "momenta of any size"},
    {"hypot(p_x, p_y)", {0.6, 0.8}, 2, "momenta of any size"},
    {"1 - cos(p_x)", {1.25}, 1, "comes no closer to 1.25 than "},
};

TEST_EACH(what_no_momentum_gives_is_told,
          sizeof impossible / sizeof *impossible) {
    double q[MOST], p[MOST];
    nevh_scene *s =
        scene_of(impossible[_i].h, impossible[_i].n, impossible[_i].v);
    ck_assert_msg(nevh_scene_start(s, q, p) == NEVH_EMAXITER, "%s",
                  impossible[_i].h);
    if (!strstr(impossible[_i].why, "any size"))
        assert_says(nevh_scene_message(s), "no momenta were found");
    assert_says(nevh_scene_message(s), impossible[_i].why);
    nevh_scene_free(s);
}

/* What does not depend on momenta may be asked for as it is. */
TEST(velocities_that_are_there_at_rest_are_no_limit) {
    const double v[] = {3, 0.5};
    double q[MOST], p[MOST];
    nevh_scene *s = scene_of("3*p_x + p_y^2/2", 2, v);
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    ck_assert_double_eq(p[1], 0.5);
    nevh_scene_free(s);
}
