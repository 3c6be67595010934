/* nevh tests: starts from orbital elements.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define BODY                                                                   \
    "[effects]\nkinetic = (p_x^2 + p_y^2 + p_z^2)/(2*m)\n"                     \
    "gravity = -mu*m/sqrt(x^2 + y^2 + z^2)\n[run]\nt_end = 1\ndt = 0.1\n"

static const double degree = 0.017453292519943295;

/* a, e, inclination, node, pericentre, mean anomaly, mu */
static void start(const double e[7], double mass, double q[3], double v[3]) {
    char text[900];
    double p[3];
    snprintf(text, sizeof text,
             "[parameters]\nm = %.17g\nmu = %.17g\n[coordinates]\n"
             "x, y, z = elements(%.17g, %.17g, %.17g, %.17g, %.17g, %.17g, mu)"
             "\n" BODY,
             mass, e[6], e[0], e[1], e[2], e[3], e[4], e[5]);
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_str_eq(nevh_scene_message(s), "");
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    for (int k = 0; k < 3; k++)
        v[k] = p[k] / mass;
    nevh_scene_free(s);
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* D. A. Vallado, Fundamentals of Astrodynamics and Applications, example 2-5
   (RV2COE), the other way round: the true anomaly of 92.335 deg is turned into the mean one. */
TEST(published_state) {
    double e = 0.83285, half = tan(92.335 * degree / 2);
    double anomaly = 2 * atan(sqrt((1 - e) / (1 + e)) * half);
    const double elements[] = {11067.790 / (1 - e * e),
                               e,
                               87.87 * degree,
                               227.89 * degree,
                               53.38 * degree,
                               anomaly - e * sin(anomaly),
                               398600.4418};
    const double known_q[] = {6525.368, 6861.532, 6449.119};
    const double known_v[] = {4.902279, 5.533140, -1.975710};
    double q[3], v[3];
    start(elements, 2.5, q, v);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(q[k], known_q[k], 1e-3);
        ck_assert_double_eq_tol(v[k], known_v[k], 1e-6);
    }
}

/* The elements that a state has are those that it was made of: the energy says
   a, the angular momentum inclination and node, Laplace's vector e and the
   pericentre, Kepler's equation the mean anomaly. */
static void compare(const double e[7]) {
    double q[3], v[3], laplace[3], mu = e[6];
    start(e, 0.3, q, v);
    const double l[] = {q[1] * v[2] - q[2] * v[1], q[2] * v[0] - q[0] * v[2],
                        q[0] * v[1] - q[1] * v[0]};
    double r = sqrt(dot(q, q)), moment = sqrt(dot(l, l));
    double circular = sqrt(mu * e[0] * (1 - e[1]) * (1 + e[1]));
    double close = 1e-14 / (1 - e[1]);
    ck_assert_double_eq_tol(dot(v, v) / 2 - mu / r, -mu / (2 * e[0]),
                            close * mu / e[0]);
    ck_assert_double_eq_tol(moment, circular, close * circular);
    ck_assert_double_eq_tol(l[2] / moment, cos(e[2]), close);
    ck_assert_double_eq_tol(l[0] / moment, sin(e[2]) * sin(e[3]), close);
    ck_assert_double_eq_tol(l[1] / moment, -sin(e[2]) * cos(e[3]), close);
    laplace[0] = (v[1] * l[2] - v[2] * l[1]) / mu - q[0] / r;
    laplace[1] = (v[2] * l[0] - v[0] * l[2]) / mu - q[1] / r;
    laplace[2] = (v[0] * l[1] - v[1] * l[0]) / mu - q[2] / r;
    const double node[] = {cos(e[3]), sin(e[3]), 0};
    ck_assert_double_eq_tol(dot(laplace, laplace), e[1] * e[1], 10 * close);
    ck_assert_double_eq_tol(dot(laplace, node), e[1] * cos(e[4]), 10 * close);
    ck_assert_double_eq_tol(laplace[2], e[1] * sin(e[4]) * sin(e[2]),
                            10 * close);
    /* e sin E = q.v/sqrt(mu a); e cos E = 1 - r/a */
    double sine = dot(q, v) / sqrt(mu * e[0]), cosine = 1 - r / e[0];
    double mean = atan2(sine, cosine) - sine;
    ck_assert_double_eq_tol(sin(mean), sin(e[5]), 10 * close / e[1]);
    ck_assert_double_eq_tol(cos(mean), cos(e[5]), 10 * close / e[1]);
}

TEST(elements_are_those_of_the_state) {
    for (int i = 0; i < 60; i++) {
        uint64_t at = (uint64_t)i;
        double e = i < 10 ? 1 - pow(10, -i / 2.) : nevh_uniform_at(1, "e", at);
        const double elements[] = {exp(nevh_normal_at(1, "a", at)),
                                   e > 0 ? e : 0.001,
                                   3.1 * nevh_uniform_at(1, "i", at),
                                   6.2 * nevh_uniform_at(1, "node", at),
                                   6.2 * nevh_uniform_at(1, "w", at),
                                   6.2 * nevh_uniform_at(1, "M", at),
                                   exp(3 * nevh_normal_at(1, "mu", at))};
        compare(elements);
    }
}

#define PAIR                                                                   \
    "[parameters]\nN = 2\nm[1..N] = 1, 3\na[1..N] = 1, 4\ne = 0.5\n"           \
    "[coordinates]\nx[i = 1..N], y[i = 1..N] = "                               \
    "elements(a[i], e, 0, 0, 0, 0, 2)\n[effects]\n"                            \
    "kinetic = sum(i = 1..N, (p_x[i]^2 + p_y[i]^2)/(2*m[i]))\n"                \
    "gravity = sum(i = 1..N, -2*m[i]/sqrt(x[i]^2 + y[i]^2))\n"                 \
    "[run]\nt_end = 1\ndt = 0.1\n"

/* At pericentre: q = a (1 - e), v = sqrt(mu (1 + e)/(1 - e)/a). */
TEST(arrays_take_elements) {
    nevh_scene *s = nevh_scene_parse("test", PAIR);
    double q[4], p[4];
    ck_assert_str_eq(nevh_scene_message(s), "");
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    for (int i = 0; i < 2; i++) {
        double a = i ? 4 : 1, m = i ? 3 : 1;
        ck_assert_double_eq_tol(q[i], a / 2, 1e-15);
        ck_assert_double_eq(q[2 + i], 0);
        ck_assert_double_eq(p[i], 0);
        ck_assert_double_eq_tol(p[2 + i], m * sqrt(6 / a), 1e-14);
    }
    /* A scene that is written is the same one, and each line is there once. */
    char *text = nevh_scene_write(s, NULL);
    ck_assert_str_eq(text, PAIR);
    free(text);
    nevh_scene_free(s);
}

static const struct {
    const char *line, *says;
} wrong[] = {
    {"x, y, z = elements(1, 1.2, 0, 0, 0, 0, 1)", "e is 1.2"},
    {"x, y, z = elements(1, 1, 0, 0, 0, 0, 1)", "of ellipses"},
    {"x, y, z = elements(1, -0.1, 0, 0, 0, 0, 1)", "of ellipses"},
    {"x, y, z = elements(-1, 0.1, 0, 0, 0, 0, 1)", "above 0, not -1"},
    {"x, y, z = elements(1, 0.1, 0, 0, 0, 0, 0)", "mu"},
    {"x, y, z = elements(1, 0.1, 0, 0, 0, 0)", "x, y, z = elements(a, e"},
    {"x, y, z = 1, 2, 3", "x, y, z = elements(a, e"},
    {"x = elements(1, 0.1, 0, 0, 0, 0, 1)\ny = 0\nz = 0", "x, y, z ="},
    {"x, y, z = elements(1, 0.1, 0, 0, 0, M, 1)", "M is not known"},
    {"x, y, z, w = elements(1, 0.1, 0, 0, 0, 0, 1)", "no more than 3"},
    {"x, , z = elements(1, 0.1, 0, 0, 0, 0, 1)", "a name is missing"},
    {"x, y = elements(1, 0.1, 0.2, 0, 0, 0, 1)\nz = 0", "inclination is 0"},
    {"x, y, z = elements(1, 0.1, 0, 0, 0, 0, 1)\np_x = 1", "already"},
    {"x, y, x = elements(1, 0.1, 0, 0, 0, 0, 1)", "x"},
    {"x, y, z", "\"=\" is missing"},
};

TEST_EACH(wrong_elements_are_refused, sizeof wrong / sizeof *wrong) {
    char text[900];
    snprintf(text, sizeof text,
             "[parameters]\nm = 1\nmu = 1\n[coordinates]\n%s\n" BODY,
             wrong[_i].line);
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_int_ne(nevh_scene_status(s), NEVH_OK);
    assert_says(nevh_scene_message(s), wrong[_i].says);
    assert_says(nevh_scene_message(s), "test:");
    nevh_scene_free(s);
}
