/* nevh tests: compiled Taylor series give the bits of those that are not.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/scene.h>
#include <stdlib.h>

enum { MOST = 36, WIDTH = 3 };

#define SIX_BODIES                                                             \
    "[parameters]\nN = 6\n[coordinates]\nx[i = 1..N] = i*cos(i)\n"             \
    "y[i = 1..N] = i*sin(i)\nz[i = 1..N] = 0.1*i\n"                            \
    "p_x[i = 1..N] = -sin(i)/sqrt(i)\np_y[i = 1..N] = cos(i)/sqrt(i)\n"        \
    "[effects]\n"                                                              \
    "T = sum(i = 1..N, (p_x[i]^2 + p_y[i]^2 + p_z[i]^2)/2)\n"                  \
    "V = -sum(i = 1..N, j = i + 1..N, 0.1/sqrt((x[i] - x[j])^2 + "             \
    "(y[i] - y[j])^2 + (z[i] - z[j])^2))\n"

/* Every operation that has a recurrence, of states and of time. */
static const char *const scenes[] = {
    "[coordinates]\nx = 0.4, 0.3\ny = -0.7, 0.2\n[effects]\n"
    "T = p_x^2/2 + p_y^2/3 + p_x^4/50\nU = (x^2 + y^2)/2\n"
    "A = (sin(x) + cos(x)*x + tan(x/9) + asin(x/4) + acos(y/4) + atan(x)*x)/9\n"
    "B = (atan2(x, 4 + y) + sinh(x) + cosh(y) + tanh(x*y) + asinh(x))/9\n",
    "[coordinates]\nx = 0.4, 0.3\ny = -0.7, 0.2\n[effects]\n"
    "T = p_x^2/2 + p_y^2/3\nU = (x^2 + y^2)/2\n"
    "A = (acosh(3 + x^2) + atanh(x/5) + exp(-x^2) + log(4 + x) + cbrt(3 + x))/9\n"
    "B = (log10(4 + x*y) + sqrt(4 + x) + hypot(x - 4, y) + (2 + x^2)^1.7)/9\n"
    "C = (1 + x^2)^(-3/2) + (3 + y)^(-1/2) + x^7/(1 + y^2)\n"
    "[friction]\nair = x: 0.3, y: 0.1\n",
    "[parameters]\nN = 8\n[coordinates]\n"
    "x[i = 1..N] = sin(1.7*i)/3\np_x[i = 1..N] = cos(2.9*i)/3\n[effects]\n"
    "T = sum(i = 1..N, p_x[i]^2/2)\n"
    "V = sum(i = 1..N - 1, (x[i + 1] - x[i])^2/2 + (x[i + 1] - x[i])^4/4)\n"
    "D = -x[1]*cos(t)/9 + 1/(5 + t)\n",
    /* Products enough for sums of two orders at a time; of an even order, and of
       an odd one. */
    SIX_BODIES, SIX_BODIES};
enum { SCENES = sizeof scenes / sizeof *scenes };

typedef struct {
    nevh_scene *scene;
    size_t n; /* numbers of q, and of p */
    double start[2 * MOST], state[2][2 * MOST];
    nevh_stepper *stepper[2]; /* the second is compiled */
    const char *why;
} setup;

static void set_up(setup *s, const char *text, double tolerance, size_t width) {
    *s = (setup){.scene = nevh_scene_parse("test", text)};
    ck_assert_str_eq(nevh_scene_message(s->scene), "");
    size_t dof = nevh_scene_dof(s->scene);
    double q[MOST], p[MOST];
    ck_assert_int_eq(nevh_scene_start(s->scene, q, p), NEVH_OK);
    s->n = dof * width;
    for (size_t i = 0; i < s->n; i++) {
        s->start[i] = q[i / width] * (1 + 0.01 * (double)(i % width));
        s->start[s->n + i] = p[i / width];
    }
    for (int k = 0; k < 2; k++) {
        nevh_options o = {.q = s->start,
                          .p = s->start + s->n,
                          .width = width,
                          .tolerance = tolerance,
                          .native_cache = "",
                          .native = k ? NEVH_NATIVE_ALWAYS : NEVH_NATIVE_NEVER};
        s->stepper[k] =
            nevh_stepper_new(nevh_scene_system(s->scene), nevh_taylor, &o);
        ck_assert_str_eq(nevh_stepper_message(s->stepper[k]), "");
        memcpy(s->state[k], s->start, sizeof s->start);
    }
    ck_assert(!nevh_stepper_native(s->stepper[0], NULL));
    nevh_stepper_native(s->stepper[1], &s->why);
}

static void tear_down(setup *s) {
    nevh_stepper_free(s->stepper[0]);
    nevh_stepper_free(s->stepper[1]);
    nevh_scene_free(s->scene);
}

static void run(setup *s, double h, size_t steps) {
    for (int k = 0; k < 2; k++)
        ck_assert_int_eq(nevh_run(s->stepper[k], 0, h, steps, s->state[k],
                                  s->state[k] + s->n, NULL, 0),
                         NEVH_OK);
    ck_assert_mem_eq(s->state[0], s->state[1], sizeof s->start);
    ck_assert_mem_ne(s->state[0], s->start, s->n * sizeof(double));
    nevh_counts a = nevh_stepper_counts(s->stepper[0]),
                b = nevh_stepper_counts(s->stepper[1]);
    ck_assert_uint_eq(a.gradients, b.gradients);
}

/* Where there is no compiler. */
static bool compiles(const setup *s) {
    bool native = nevh_stepper_native(s->stepper[1], NULL);
    ck_assert_msg(native || strstr(s->why, "no C compiler"), "%s", s->why);
    return native;
}

TEST_EACH(compiled_series_have_the_same_bits, SCENES) {
    setup s;
    set_up(&s, scenes[_i], _i % 2 ? 1e-8 : 1e-15, 1);
    if (compiles(&s)) {
        run(&s, 0.1, 30);
        run(&s, -0.7, 3);
    }
    tear_down(&s);
}

TEST(compiled_series_of_orbits_side_by_side_have_the_same_bits) {
    setup s;
    set_up(&s, scenes[0], 1e-12, WIDTH);
    if (compiles(&s))
        run(&s, 0.5, 6);
    tear_down(&s);
}

/* Both stop at the same state, with the same words. */
TEST(compiled_series_fail_alike) {
    setup s;
    set_up(&s,
           "[coordinates]\nx = 0.5, -1\n[effects]\n"
           "T = p_x^2/2\nV = -1/sqrt(x)\n",
           1e-12, 1);
    for (int k = 0; k < 2; k++)
        ck_assert_int_ne(nevh_run(s.stepper[k], 0, 0.1, 100, s.state[k],
                                  s.state[k] + 1, NULL, 0),
                         NEVH_OK);
    ck_assert_str_eq(nevh_stepper_message(s.stepper[0]),
                     nevh_stepper_message(s.stepper[1]));
    ck_assert_mem_eq(s.state[0], s.state[1], sizeof s.start);
    tear_down(&s);
}

/* Too many operations for a compiler: the series are taken all the same. */
TEST(large_series_are_not_compiled) {
    setup s;
    set_up(&s,
           "[parameters]\nN = 12\n[coordinates]\nx[i = 1..N] = i/9\n"
           "[effects]\nT = sum(i = 1..N, p_x[i]^2/2)\n"
           "V = sum(i = 1..N, j = 1..N, k = 1..N, "
           "sin(x[i] - x[j]/2 + x[k]/3)/N^3)\n",
           1e-6, 1);
    ck_assert(!nevh_stepper_native(s.stepper[1], NULL));
    assert_says(s.why, "too many operations");
    run(&s, 0.1, 1);
    tear_down(&s);
}

TEST(series_have_no_program) {
    setup s;
    const char *const names[] = {"x", "y"};
    set_up(&s, scenes[0], 1e-9, 1);
    nevh_program program = {.names = names, .h = 0.1, .t_end = 0.3, .every = 1};
    ck_assert_ptr_null(nevh_stepper_program(s.stepper[0], &program));
    assert_says(nevh_stepper_message(s.stepper[0]), "only splitting");
    tear_down(&s);
}
