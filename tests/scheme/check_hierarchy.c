/* nevh tests: bodies that move about one another, in steps by parts.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard.h"
#include "kernels/kepler_flow_private.h"
#include "support.h"
#include "system/system_private.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PLANE = 2, SPACE = 3, MOST = 9 };

/* Three bodies; the start, the pairs and what else there is are the caller's. */
static nevh_scene *bodies(int space, const char *numbers, const char *pull,
                          const char *more) {
    char text[1500];
    bool deep = space == SPACE;
    snprintf(text, sizeof text,
             "[parameters]\n%s[effects]\nkinetic = sum(i = 1..3, "
             "(p_x[i]^2 + p_y[i]^2%s)/(2*m[i]))\n"
             "gravity = -sum(i = 1..3, j = i+1..3, m[i]*m[j]*%s(x[i] - "
             "x[j])^2 + (y[i] - y[j])^2%s))\n%s[run]\nt_end = 1\n",
             numbers, deep ? " + p_z[i]^2" : "", pull,
             deep ? " + (z[i] - z[j])^2" : "", more);
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

static const char
    newton[] = "1/sqrt(",
    plane_start[] =
        "[coordinates]\nx[1..3] = 0.1, 1.1, -1.6\ny[1..3] = 0, 0.05, 0.3\n"
        "v_x[1..3] = 0, -0.1, -0.1\nv_y[1..3] = 0, 1.05, -0.7\n",
    space_start[] = "z[1..3] = 0, 0.02, -0.1\nv_z[1..3] = 0, 0.1, 0.03\n";

/* Two planets of masses e and e/2 about a star. */
static nevh_scene *planets(int space, double e) {
    char numbers[600];
    snprintf(numbers, sizeof numbers, "e = %.17g\nm[1..3] = 1, e, e/2\n%s%s", e,
             plane_start, space == SPACE ? space_start : "");
    return bodies(space, numbers, newton, "");
}

/* Of the coordinates, from the same system by Gauss's method. */
static double error_after(nevh_scene *(*scene)(int, double), int space,
                          double e, const nevh_integrator *scheme, double h,
                          size_t steps) {
    orbit x = begin(scene(space, e), scheme);
    orbit y = begin(scene(space, e), nevh_gauss20);
    double worst = 0;
    ck_assert(!nevh_run(x.stepper, 0, h, steps, x.q, x.p, NULL, 0));
    ck_assert(!nevh_run(y.stepper, 0, h / 16, 16 * steps, y.q, y.p, NULL, 0));
    for (size_t k = 0; k < x.n; k++)
        worst = fmax(worst, fabs(x.q[k] - y.q[k]));
    end(&x);
    end(&y);
    return worst;
}

static const struct {
    const nevh_integrator *const *scheme;
    double order; /* of h in the part of the error that is linear in e */
    double e;
} known[] = {
    {&nevh_wisdom_holman, 2, 1e-5},
    {&nevh_saba2, 4, 1e-5},
    {&nevh_saba3, 6, 1e-6},
};
enum { KNOWN = sizeof known / sizeof *known };

/* Errors fall with the planets' masses, and with the published power of h. */
TEST_EACH(errors_are_those_of_small_masses, KNOWN * 2) {
    const nevh_integrator *scheme = *known[_i / 2].scheme;
    int space = _i % 2 ? SPACE : PLANE;
    const double e = known[_i / 2].e, h = 1;
    double at = error_after(planets, space, e, scheme, h, 4);
    double heavier = error_after(planets, space, 2 * e, scheme, h, 4);
    double shorter = error_after(planets, space, e, scheme, h / 2, 8);
    ck_assert_double_eq_tol(heavier / at, 2, 0.05);
    ck_assert_double_eq_tol(log2(at / shorter), known[_i / 2].order, 0.5);
}

/* Of masses 2 and 3; names do not tell what belongs together. */
static nevh_scene *two(int space, double charge) {
    char text[900];
    bool deep = space == SPACE;
    snprintf(text, sizeof text,
             "[coordinates]\na = 0.3\nb = -0.2\nc = 1\nd = 0.1\n%s"
             "p_a = 0.6\np_b = -1.2\np_c = -0.6\np_d = 1.5\n[effects]\n"
             "kinetic = (p_a^2 + p_b^2%s)/4 + (p_c^2 + p_d^2%s)/6\n"
             "pull = -%.17g/sqrt((a - c)^2 + (b - d)^2%s)\n"
             "[run]\nt_end = 1\n",
             deep ? "e = 0.4\nf = 0\np_e = 0.3\np_f = -0.1\n" : "",
             deep ? " + p_e^2" : "", deep ? " + p_f^2" : "", charge,
             deep ? " + (f - e)^2" : "");
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

/* Steps of any length: also several periods, and of bodies that repel each other. */
TEST_EACH(two_bodies_are_exact, 3 * 2) {
    static const double charge[] = {2, 0.8, -1};
    int space = _i % 2 ? SPACE : PLANE;
    ck_assert_double_le(
        error_after(two, space, charge[_i / 2], nevh_wisdom_holman, 2.5, 3),
        1e-12);
    ck_assert_double_ge(
        error_after(two, space, charge[_i / 2], nevh_verlet, 0.5, 3), 1e-3);
}

static const struct {
    const char *numbers, *pull, *more, *found;
} hierarchies[] = {
    {"m[1..3] = 1, 1e-3, 1e-3\n", newton, "", "((x[1], x[2]), x[3])"},
    {"m[1..3] = 1e-3, 1, 2e-3\n", newton, "", "((x[2], x[1]), x[3])"},
    {"m[1..3] = 1, 1e-3, 1e-3\n", newton, "[parts]\nslow = gravity\n", ""},
    {"m[1..3] = 1, 1, 2.5\n", newton, "",
     "they differ by half and more from the motion of pairs about one another"},
    {"m[1..3] = 1, 1, 1\n", newton, "[parts]\nfast = kinetic, gravity\n",
     "((x[1], x[2]), x[3])"},
    {"m[1..3] = 1, 1e-3, 1e-3\n", "1/(", "", ""},
    {"m[1..3] = 1, 1e-3, 1e-3\n", "1/sqrt(1e-9 + ", "", ""},
};
enum { HIERARCHIES = sizeof hierarchies / sizeof *hierarchies };

TEST_EACH(pairs_are_found, HIERARCHIES) {
    char numbers[400], text[100], shorter[8];
    snprintf(numbers, sizeof numbers, "%s%s", hierarchies[_i].numbers,
             plane_start);
    orbit x = begin(
        bodies(PLANE, numbers, hierarchies[_i].pull, hierarchies[_i].more),
        nevh_saba2);
    size_t pairs = nevh_stepper_hierarchy(x.stepper, text, sizeof text, NULL);
    ck_assert_str_eq(text, hierarchies[_i].found);
    ck_assert_uint_eq(pairs, *text == '(' ? 2 : 0);
    ck_assert_uint_eq(nevh_stepper_hierarchy(x.stepper, shorter, 8, NULL),
                      pairs);
    ck_assert(strncmp(text, shorter, 7) == 0 && strlen(shorter) <= 7);
    end(&x);
}

/* Attractions that no hierarchy can have say why. */
TEST_EACH(reasons, 5) {
    static const struct {
        const char *effects, *why;
    } cases[] = {
        {"K = (p_a^2 + p_b^2)/2 + (p_c^2 + p_d^2 + p_e^2 + p_f^2)/2e-3\n"
         "pull = -1/hypot(a - c, b - d) - 1e-3/hypot(a - e, b - f)\n",
         "((a, c), e)"},
        {"K = (p_a^2 + p_b^2)/2 + (p_c^2 + p_d^2 + p_e^2 + p_f^2)/2e-3\n"
         "pull = -1/hypot(a - c, b - d) - 1e-3/hypot(a - f, b - e) - "
         "1e-6/hypot(c - e, d - f)\n",
         "coordinates of bodies do not come in one order"},
        {"K = (p_a^2 + 2*p_b^2 + p_c^2 + p_d^2)/2 + (p_e^2 + p_f^2)/2\n"
         "pull = -1/hypot(a - c, b - d)\n",
         "a body has other masses in other directions"},
        {"K = (p_a^2 + p_b^2 + p_c^2 + p_d^2)/2 + (p_e^2 + p_f^2)/2\n"
         "turn = 0.1*(a*p_b - b*p_a)\npull = -1/hypot(a - c, b - d)\n",
         "other terms of A move their coordinates"},
        {"K = (p_a^2 + p_b^2 + p_c^2 + p_d^2)/2 + (p_e^2 + p_f^2)/2\n"
         "pull = 1/(0.1 + hypot(a - c, b - d))\nspring = e^2 + f^2\n",
         ""},
    };
    char text[600], why[100];
    snprintf(text, sizeof text,
             "[coordinates]\na = 0\nb = 0\nc = 1\nd = 0\ne = 0\nf = -3\n"
             "v_d = 1\nv_e = 0.5\n[effects]\n%s[run]\nt_end = 1\n",
             cases[_i].effects);
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    orbit x = begin(s, nevh_saba2);
    nevh_stepper_hierarchy(x.stepper, why, sizeof why, NULL);
    ck_assert_str_eq(why, cases[_i].why);
    end(&x);
}

/* A light body that falls through the centre of mass of two stars: attractions stay in
   kicks, and errors fall with the step; not if it is to be fast. */
TEST(centres_of_groups_are_avoided) {
    static const char start[] =
        "m[1..3] = 1, 1, 1e-6\n[coordinates]\nx[1..3] = 0.5, -0.5, 0\n"
        "y[1..3] = 0\nz[1..3] = 0, 0, 2.5\nv_x[1..3] = 0\n"
        "v_y[1..3] = 1, -1, 0\nv_z[1..3] = 0\n";
    const char *const more[] = {"", "[parts]\nfast = kinetic, gravity\n"};
    for (int fast = 0; fast < 2; fast++) {
        orbit x = begin(bodies(SPACE, start, newton, more[fast]), nevh_aba864);
        orbit y = begin(bodies(SPACE, start, newton, ""), nevh_gauss12);
        nevh_run(x.stepper, 0, 0.02, 500, x.q, x.p, NULL, 0);
        ck_assert(!nevh_run(y.stepper, 0, 0.01, 1000, y.q, y.p, NULL, 0));
        ck_assert(fast == !(fabs(x.q[8] - y.q[8]) < 1e-6));
        ck_assert_uint_eq(nevh_stepper_hierarchy(x.stepper, NULL, 0, NULL),
                          fast ? 2 : 0);
        end(&x);
        end(&y);
    }
}

/* Of three charges two are neutral together; one of three has no charge. */
TEST(neutral_bodies_are_seen) {
    static const char *const charges[] = {"1, -1, 1", "1, -0.01, 0"};
    for (int i = 0; i < 2; i++) {
        char numbers[600];
        bool whole;
        snprintf(numbers, sizeof numbers,
                 "m[1..3] = 1, 1e-2, 1e-2\nc[1..3] = %s\n%s", charges[i],
                 plane_start);
        nevh_scene *s =
            bodies(PLANE, numbers, "0*c[1]*1/sqrt(",
                   "pull = sum(i = 1..3, j = i+1..3, "
                   "c[i]*c[j]/sqrt((x[i] - x[j])^2 + (y[i] - "
                   "y[j])^2))\n[parts]\nfast = kinetic, gravity, pull\n");
        orbit x = begin(s, nevh_saba2);
        ck_assert_uint_ge(nevh_stepper_hierarchy(x.stepper, NULL, 0, &whole),
                          1);
        ck_assert_int_eq(whole, i == 1);
        end(&x);
    }
}

/* A moon moves about its planet. */
TEST(moons_are_found) {
    char text[100];
    orbit x = begin(
        bodies(PLANE,
               "m[1..3] = 1, 1e-6, 1e-3\n[coordinates]\nx[1..3] = 0, "
               "1.01, 1\ny[1..3] = 0\nv_x[1..3] = 0\nv_y[1..3] = 0, 1.3, 1\n",
               newton, ""),
        nevh_saba2);
    nevh_stepper_hierarchy(x.stepper, text, sizeof text, NULL);
    ck_assert_str_eq(text, "(x[1], (x[3], x[2]))");
    end(&x);
}

/* Without the forces that A has; with those of a third body, and of nothing else. */
TEST(kicks_are_what_is_left) {
    double slope[MOST], most = 0, all[MOST], of_all = 0, t = 0;
    orbit x = begin(planets(SPACE, 1e-3), nevh_saba4);
    orbit y = begin(two(SPACE, 2), nevh_saba4);
    ck_assert(!nevh_stepper_kick(x.stepper, 0, x.q, x.p, slope));
    ck_assert(!nevh_field_gradient(nevh_stepper_field(x.stepper), 1, &t, x.q,
                                   x.p, all, NULL));
    for (size_t k = 0; k < x.n; k++) {
        most = fmax(most, fabs(slope[k]));
        of_all = fmax(of_all, fabs(all[k]));
    }
    ck_assert_double_lt(most, 2e-3 * of_all);
    ck_assert_double_gt(most, 1e-5 * of_all);
    ck_assert(!nevh_stepper_kick(y.stepper, 0, y.q, y.p, slope));
    for (size_t k = 0; k < y.n; k++)
        ck_assert_double_eq_tol(slope[k], 0, 1e-14);
    end(&x);
    end(&y);
}

/* Orbits side by side have the bits of one. */
TEST(lanes_are_those_of_one) {
    enum { WIDTH = 8 };
    double q[MOST * WIDTH], p[MOST * WIDTH];
    orbit x = begin(planets(SPACE, 1e-3), nevh_aba864);
    nevh_options o = {.gradient = nevh_exact, .width = WIDTH, .q = q, .p = p};
    for (size_t k = 0; k < x.n; k++)
        for (size_t lane = 0; lane < WIDTH; lane++) {
            q[k * WIDTH + lane] = x.q[k];
            p[k * WIDTH + lane] = x.p[k] * (1 + 0.01 * (double)lane);
        }
    nevh_stepper *s =
        nevh_stepper_new(nevh_scene_system(x.scene), nevh_aba864, &o);
    ck_assert(!nevh_run(s, 0, 0.3, 20, q, p, NULL, 0));
    ck_assert(!nevh_run(x.stepper, 0, 0.3, 20, x.q, x.p, NULL, 0));
    for (size_t k = 0; k < x.n; k++) {
        ck_assert(q[k * WIDTH] == x.q[k] && p[k * WIDTH] == x.p[k]);
        ck_assert(q[k * WIDTH + 1] != x.q[k]);
    }
    nevh_stepper_free(s);
    end(&x);
}

/* Eight at a time, over a part of the period, with the errors of one by itself. */
TEST(eight_are_moved_alike) {
    enum { ROWS = SPACE * NEVH__LANES };
    double mu[NEVH__LANES], r[ROWS], v[ROWS], dr[ROWS], dv[ROWS],
        good[NEVH__LANES];
    uint64_t random = 3;
    size_t taken = 0;
    for (int trial = 0; trial < 4000; trial++) {
        double t = nevh__random(&random);
        for (size_t i = 0; i < ROWS; i++) {
            r[i] = nevh__random(&random);
            v[i] = nevh__random(&random);
        }
        for (size_t i = 0; i < NEVH__LANES; i++)
            mu[i] = nevh__random(&random);
        nevh__kepler_changes(mu, t, r, v, dr, dv, good);
        for (size_t i = 0; i < NEVH__LANES; i++) {
            nevh__extended at[SPACE], speed[SPACE], size = 0, fast = 0;
            for (size_t k = 0; k < SPACE; k++) {
                at[k] = r[k * NEVH__LANES + i];
                speed[k] = v[k * NEVH__LANES + i];
            }
            nevh__kepler_flow(mu[i], t, at, speed);
            for (size_t k = 0; k < SPACE; k++) {
                size += at[k] * at[k];
                fast += speed[k] * speed[k];
            }
            taken += good[i] == 1;
            for (size_t k = 0; k < SPACE && good[i] == 1; k++) {
                size_t j = k * NEVH__LANES + i;
                nevh__extended far = dr[j] - (at[k] - r[j]);
                nevh__extended off = dv[j] - (speed[k] - v[j]);
                ck_assert_ldouble_le(fabsl(far), 1e-14L * sqrtl(size));
                ck_assert_ldouble_le(fabsl(off), 1e-14L * sqrtl(fast));
            }
        }
    }
    ck_assert_uint_gt(taken, 4000 * NEVH__LANES / 2);
}
