/* nevh tests: compiled steps.  They give the bits of those that they stand for,
   or none.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "../support/native.h"
#include "elementary/elementary_list.h"
#include "kernels/adaptive_verlet_private.h"
#include "kernels/form_flow_private.h"
#include "kernels/tao_private.h"
#include "native/native_private.h"
#include <dlfcn.h>
#include <math.h>
#include <nevh/extend.h>

static bool is_implicit(const nevh_integrator *scheme) {
    return scheme->kernel == &nevh_gauss_kernel ||
           scheme->kernel == &nevh_lobatto_kernel ||
           scheme->kernel == &nevh_implicit_euler_kernel;
}

static bool compiles(const nevh_integrator *scheme) {
    return is_implicit(scheme) || scheme->kernel == &nevh_splitting_kernel ||
           scheme->kernel == &nevh_runge_kutta_kernel ||
           scheme->kernel == &nevh_nystrom_kernel ||
           scheme->kernel == &nevh__tao_kernel ||
           scheme->kernel == &nevh__parts_kernel ||
           scheme->kernel == &nevh__substeps_kernel ||
           scheme->kernel == &nevh__adaptive_verlet_kernel;
}

/* Scenes that ship, gradients by _i: every explicit scheme that is compiled on the
   first with exact ones, a quarter of them in turn on the others. */
static const char *const scenes[] = {
    "pendulum.nevh", "kepler.nevh",       "henon-heiles.nevh",
    "kapitza.nevh",  "figure-eight.nevh", "double-pendulum.nevh"};
enum { SCENES = sizeof scenes / sizeof *scenes };
static const struct {
    const char *gradient;
    bool portable;
} ways[] = {{"exact", false},   {"exact", true},         {"central2", false},
            {"central4", true}, {"complex-step", false}, {"central8", false}};
enum { WAYS = sizeof ways / sizeof *ways };

/* Of Nystroem methods one orbit alone is compiled; a scheme of implicit ones
   takes a scene in each of the ways, or in none. */
static bool is_left_out(const nevh_integrator *scheme, size_t i, size_t at,
                        int way, size_t width) {
    if (is_implicit(scheme))
        return (i + at + (size_t)way) % (2 * SCENES) != 0 ||
               strcmp(ways[way].gradient, "complex-step") == 0;
    return width > 1 && scheme->kernel == &nevh_nystrom_kernel;
}

/* Which of four schemes are compiled; turn above 3: all are. */
static void assert_scene(size_t at, int way, size_t width, size_t turn) {
    const char *file = scenes[at];
    nevh_scene *scene = read_shipped(file);
    size_t count = 0;
    for (size_t i = 0; nevh_integrators()[i]; i++) {
        const nevh_integrator *scheme = nevh_integrators()[i];
        if (!compiles(scheme) || is_left_out(scheme, i, at, way, width) ||
            (!is_implicit(scheme) && turn < 4 && i % 4 != turn))
            continue;
        pair x = pair_of(scene, scheme, nevh_gradient_named(ways[way].gradient),
                         ways[way].portable, cache, width);
        if (!nevh_stepper_status(x.plain)) {
            ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s, %s: %s",
                          file, scheme->name, x.why);
            ck_assert_int_eq(pair_run(&x, 0.003, 200), NEVH_OK);
            ck_assert_msg(pair_same(&x), "%s, %s, %s", file, scheme->name,
                          ways[way].gradient);
            /* Back, and each step looked at. */
            ck_assert_int_eq(pair_run(&x, -0.003, 1), NEVH_OK);
            ck_assert(pair_same(&x));
            count++;
        }
        pair_free(&x);
    }
    ck_assert(count >= (turn < 4 ? 1 : 2));
    nevh_scene_free(scene);
}

TEST_EACH(same_bits, WAYS) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    for (size_t i = 0; i < SCENES; i++)
        assert_scene(i, _i, 1, i || _i > 1 ? (i + (size_t)_i) % 4 : 4);
}

/* Side by side, a quarter of the schemes; the complex step is not compiled. */
TEST_EACH(same_bits_of_lanes, WAYS) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    if (strcmp(ways[_i].gradient, "complex-step") == 0)
        skip_test("the complex step is not compiled for orbits side by side");
    share_cache();
    for (size_t i = 0; i < SCENES; i++)
        assert_scene(i, _i, i % 2 ? 8 : 32, (i + (size_t)_i) % 4);
}

/* Of three kinds of flows, with kicks and turns in between, and as they are planned alone and
   side by side.  _i: substeps; of 0 nothing is inner. */
TEST_EACH(parts_same_bits, 12) {
    static const size_t widths[] = {1, 8, 32};
    static const char text[] =
        "[coordinates]\nx = 0.9\ny = 0.4\nz = 0.1\nr = 1.2\ns = 0.2\nu = 0.3\np_x = "
        "0.3\np_z = 0.2\np_s = 0.8\n"
        "[effects]\nkinetic = (p_x^2 + p_y^2/3 + p_z^2 + p_r^2 + p_s^2)/2\n"
        "spring = 2*(x - y)^2 + 0.1*x\ncentre = -1/sqrt(r^2 + s^2)\n"
        "bond = 20*(hypot(x, z) - 1)^2\n"
        "slow = 0.1*x^4 + 0.2*cos(t + y)*r + z^2*s\n%s"
        "[parts]\nfast = kinetic, spring%s\n";
    static const char turn[] = "turn = 0.2*(u^2 + p_u^2)^2\n";
    char all[sizeof text + sizeof turn + 20];
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    snprintf(all, sizeof all, text, _i % 3 ? turn : "",
             _i % 2 ? ", bond" : ", centre");
    nevh_scene *scene = parsed(all);
    const nevh_integrator *schemes[] = {nevh_wisdom_holman, nevh_aba864};
    pair x = pair_of(scene, _i % 2 ? nevh_respa : schemes[_i / 2 % 2],
                     _i < 6 ? nevh_exact : nevh_central4, _i % 4 == 0, cache,
                     widths[_i % 3]);
    ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(pair_run(&x, i == 1 ? -0.02 : 0.03, i ? 7 : 90),
                         NEVH_OK);
        ck_assert(pair_same(&x));
    }
    ck_assert(nevh_stepper_native(x.native, NULL)); /* none differed */
    pair_free(&x);
    nevh_scene_free(scene);
}

/* Each function that formulas know, in V and, of time, where that is read. */
static const char *const functions[] = {
    "sin(x) + cos(x)*x", "tan(x/3)",        "asin(x/4)",
    "acos(x/4)",         "atan(x)*x",       "atan2(x, 2 + y)",
    "sinh(x) + cosh(y)", "tanh(x*y)",       "asinh(x)",
    "acosh(3 + x^2)",    "atanh(x/5)",      "exp(-x^2)",
    "log(4 + x)",        "log10(4 + x*y)",  "sqrt(2 + x)",
    "cbrt(3 + x)",       "hypot(x, y)",     "abs(x - 0.1)*y",
    "min(x, y)^2",       "max(x, 0.3*y)^2", "sign(x)*x^2",
    "mod(x, 0.7)",       "floor(x)*y",      "(2 + x^2)^1.7",
    "(1 + x^2)^(-3/2)",  "x^7/(1 + y^2)",   "-cos(x + 0.3*sin(2*t))",
    "x*sqrt(4 + y)*t"};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

static void assert_function(nevh_scene *scene, const nevh_integrator *scheme,
                            int way, size_t width) {
    pair x = pair_of(scene, scheme, nevh_gradient_named(ways[way].gradient),
                     ways[way].portable, cache, width);
    if (!nevh_stepper_status(x.plain)) {
        ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
        pair_run(&x, 0.05, 400);
        ck_assert_msg(pair_same(&x), "%s, %s", scheme->name,
                      ways[way].gradient);
    }
    pair_free(&x);
}

TEST_EACH(functions_same_bits, FUNCTIONS) {
    char text[300];
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    snprintf(text, sizeof text,
             "[coordinates]\nx = 0.4, 0.3\ny = -0.7, 0.2\n[effects]\n"
             "T = p_x^2/2 + p_y^2/3 + p_x^4/50\nU = (x^2 + y^2)/2\nV = %s\n",
             functions[_i]);
    nevh_scene *scene = parsed(text);
    for (int way = 0; way < WAYS; way++)
        assert_function(scene, nevh_verlet, way, 1);
    assert_function(scene, nevh_verlet, 0, 8); /* in vectors */
    assert_function(scene, nevh_gauss4, 0, 1);
    nevh_scene_free(scene);
}

/* Steps that adapt: substeps that are rejected, cut short, or many of one
   step; back, step by step, and what is saved of them. */
static const nevh_integrator *const *const adaptive[] = {
    &nevh_dopri5, &nevh_dop853, &nevh_dprkn12};
enum { ADAPTIVE = sizeof adaptive / sizeof *adaptive };

static void assert_memory_same(const pair *x) {
    size_t size = nevh_stepper_save_size(x->plain);
    void *a = malloc(size), *b = malloc(size);
    nevh_stepper_save(x->plain, a);
    nevh_stepper_save(x->native, b);
    ck_assert_mem_eq(a, b, size);
    free(a);
    free(b);
}

static void assert_adapts(nevh_scene *scene, const nevh_integrator *scheme,
                          int way, double tolerance) {
    pair x = pair_under(scene, scheme, nevh_gradient_named(ways[way].gradient),
                        ways[way].portable, cache, 1, tolerance);
    ck_assert_int_eq(nevh_stepper_status(x.plain), NEVH_OK);
    ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s: %s", scheme->name,
                  x.why);
    static const double lengths[] = {0.9, -0.01, 3, 0.003};
    static const size_t steps[] = {12, 40, 2, 1};
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(pair_run(&x, lengths[i], steps[i]), NEVH_OK);
        ck_assert_msg(pair_same(&x), "%s, %s, h = %g", scheme->name,
                      ways[way].gradient, lengths[i]);
        assert_memory_same(&x);
    }
    pair_free(&x);
}

TEST_EACH(tolerance_same_bits, ADAPTIVE) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed(
        "[coordinates]\nx = 0.5, 0\ny = 0, 1.6\n[effects]\n"
        "T = (p_x^2 + 2*p_y^2)/2\nV = -1/sqrt(x^2 + y^2) + x*sin(t)/50\n");
    for (int way = _i % 2; way < WAYS; way += 2)
        assert_adapts(scene, *adaptive[_i], way, way % 2 ? 1e-6 : 1e-9);
    nevh_scene_free(scene);
    /* T_p(0) is not 0, and T takes two momenta together. */
    scene = parsed("[coordinates]\nx = 0.5, 0\ny = 0, 0.7\n[effects]\n"
                   "T = (p_x + p_y/2)^2/2 + p_y^2/2 + p_x/3\n"
                   "V = x^4/4 + x*y/5 + y^2\n");
    assert_adapts(scene, *adaptive[_i], _i % 2 ? 3 : 0, 1e-7);
    nevh_scene_free(scene);
}

/* Steps that choose their length: their times, what is kept of them, where the
   field vanishes, and where H ends. */
TEST_EACH(own_time_same_bits, 2) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    const nevh_integrator *scheme =
        _i ? nevh_naive_adaptive_verlet : nevh_adaptive_verlet;
    static const char *const texts[] = {
        "[coordinates]\nx = 0.2, 0\ny = 0, 2.9\n[effects]\n"
        "T = (p_x^2 + 2*p_y^2)/2\nV = -1/sqrt(x^2 + y^2) + x*sin(t)/50\n",
        "[coordinates]\nx = 0\n[effects]\nT = p_x^2/2\nV = -cos(x)\n",
        "[coordinates]\nx = 1, -1\n[effects]\nT = p_x^2/2\nV = sqrt(x - 0.2)\n"};
    for (int at = 0; at < 3; at++) {
        nevh_scene *scene = parsed(texts[at]);
        for (int way = at ? WAYS - 1 : 0; way < WAYS; way++) {
            pair x =
                pair_new(scene, scheme, nevh_gradient_named(ways[way].gradient),
                         ways[way].portable, cache);
            ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
            int status = pair_run(&x, 0.01, 3000);
            ck_assert_int_eq(status == NEVH_OK, at < 2);
            pair_run(&x, -0.02, 40);
            ck_assert_msg(pair_same(&x), "%d, %s", at, ways[way].gradient);
            ck_assert_double_eq(nevh_stepper_time(x.plain),
                                nevh_stepper_time(x.native));
            assert_memory_same(&x);
            pair_free(&x);
        }
        nevh_scene_free(scene);
    }
}

/* Orbits side by side adapt each on its own: their steps are not compiled. */
TEST(tolerance_of_lanes) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed(pendulum);
    pair x = pair_under(scene, nevh_dopri5, nevh_exact, false, cache, 8, 1e-6);
    ck_assert(!nevh_stepper_native(x.native, NULL));
    ck_assert_ptr_nonnull(strstr(x.why, "each on its own"));
    pair_free(&x);
    nevh_scene_free(scene);
}

/* Trials beyond the domain of H are the kernel's; where the orbit leaves it, or
   ends, both give up with the same words. */
TEST_EACH(tolerance_failures_same, 2 * ADAPTIVE) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed(_i % 2 ? "[coordinates]\nx = 1, 0\n[effects]\n"
                                        "T = p_x^2/2\nV = -x^4\n"
                                      : "[coordinates]\nx = 1, -1\n[effects]\n"
                                        "T = p_x^2/2\nV = sqrt(x - 0.2)\n");
    pair x =
        pair_under(scene, *adaptive[_i / 2],
                   _i % 4 ? nevh_central4 : nevh_exact, false, cache, 1, 1e-8);
    ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
    ck_assert_int_ne(pair_run(&x, 0.05, 1000), NEVH_OK);
    ck_assert(nevh_stepper_taken(x.native) > 3 && pair_same(&x));
    ck_assert(isfinite(x.b[0]) && isfinite(x.b[1]));
    pair_free(&x);
    nevh_scene_free(scene);
}

/* Friction, which Runge-Kutta methods have in their slopes and which stands
   around the steps of others; of one orbit and of many. */
TEST(friction_same_bits) {
    static const char damped[] =
        "[coordinates]\nx = 1, 0.2\ny = -0.5, 1\n[effects]\n"
        "T = (p_x^2 + 2*p_y^2)/2\nV = x^4/4 + y^2 + x*y*sin(t)/5\n"
        "[friction]\nair = x: 0.3, y: 0.1\n";
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed(damped);
    assert_adapts(scene, nevh_dopri5, 0, 1e-7);
    assert_adapts(scene, nevh_dop853, 3, 1e-7);
    const nevh_integrator *schemes[] = {nevh_rk4, nevh_verlet, nevh_dop853,
                                        nevh_tao4};
    for (size_t i = 0; i < 8; i++) {
        pair x = pair_of(scene, schemes[i % 4],
                         (i + i / 4) % 2 ? nevh_exact : nevh_central4, false,
                         cache, i < 4 ? 1 : 16);
        ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
        double before = x.b[x.n];
        ck_assert_int_eq(pair_run(&x, 0.02, 300), NEVH_OK);
        ck_assert(pair_same(&x) && x.b[x.n] != before);
        pair_free(&x);
    }
    nevh_scene_free(scene);
}

/* H leaves its domain: both stop at the same state, with the same words.  Slopes
   of logarithms are finite there. */
static const char *const leaving[] = {"sqrt(x - 0.2)", "log(x)", "0.3*log(x)",
                                      "log(x)/2.5", "-0.4*(2*log(1/x))"};
TEST_EACH(failures_same, sizeof leaving / sizeof *leaving) {
    static const char *const gradients[] = {"exact", "central4",
                                            "complex-step"};
    char text[100];
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    snprintf(text, sizeof text,
             "[coordinates]\nx = 1, -1\n[effects]\nT = p_x^2/2\nV = %s\n",
             leaving[_i]);
    nevh_scene *scene = parsed(text);
    for (size_t i = 0; i < 6; i++) {
        pair x = pair_new(scene,
                          i < 3   ? nevh_verlet
                          : i < 5 ? nevh_gauss6
                                  : nevh_tao4,
                          nevh_gradient_named(gradients[i % 3]), false, cache);
        ck_assert(nevh_stepper_native(x.native, NULL));
        ck_assert_int_eq(pair_run(&x, 0.01, 1000), NEVH_EDOM);
        ck_assert(nevh_stepper_taken(x.native) > 10 && pair_same(&x));
        ck_assert(isfinite(x.b[0]) && isfinite(x.b[1]));
        pair_free(&x);
    }
    nevh_scene_free(scene);
}

/* One orbit of many leaves it: none has gone further than the others. */
TEST(failure_of_a_lane) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed("[coordinates]\nx = 1, -1\n[effects]\n"
                               "T = p_x^2/2\nV = sqrt(x - 0.2)\n");
    pair x = pair_of(scene, nevh_verlet, nevh_exact, false, cache, 32);
    ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
    ck_assert_int_eq(pair_run(&x, 0.01, 1000), NEVH_EDOM);
    ck_assert(nevh_stepper_taken(x.native) > 10 && pair_same(&x));
    for (size_t i = 0; i < 2 * x.n; i++)
        ck_assert(isfinite(x.b[i]));
    pair_free(&x);
    nevh_scene_free(scene);
}

/* Orbits beside one that starts afresh keep their last slopes, which were taken
   at a time that rounds otherwise. */
TEST(a_neighbours_jump_changes_nothing) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed("[coordinates]\nx = 0.5\n[effects]\n"
                               "T = p_x^2/2\nV = (1 + sin(t)/3)*x^4\n");
    pair x = pair_of(scene, nevh_verlet, nevh_exact, false, cache, 8);
    ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
    for (size_t i = 0; i < 12; i++) {
        double t = 0.2 * (double)(6 * i);
        ck_assert(!nevh_run(x.plain, t, 0.2, 6, x.a, x.a + 8, NULL, 0));
        ck_assert(!nevh_run(x.native, t, 0.2, 6, x.b, x.b + 8, NULL, 0));
        ck_assert(pair_same(&x));
        x.a[7] = x.b[7] = 0.5;
    }
    pair_free(&x);
    nevh_scene_free(scene);
}

/* 0 times infinity is 0 in the chain rule: such a step is the tape's. */
TEST(chain_rule) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed("[coordinates]\nx = 0, 0\ny = 1, 0.3\n"
                               "[effects]\nT = (p_x^2 + p_y^2)/2\n"
                               "V = x*sqrt(x) + y^2/2\n");
    pair x = pair_new(scene, nevh_verlet, nevh_exact, false, cache);
    ck_assert(nevh_stepper_native(x.native, NULL));
    ck_assert_int_eq(pair_run(&x, 0.01, 500), NEVH_OK);
    ck_assert(pair_same(&x) && x.b[1] != 1);
    pair_free(&x);
    nevh_scene_free(scene);
}

/* Elementary functions of the text have the library's bits, of one number, of four and
   of eight. */
typedef struct {
    const char *name;
    double (*one)(double), (*two)(double, double);
} elementary;

static double drawn(double most) {
    double x = exp((rand() / (RAND_MAX + 1.0) - 0.5) * 2 * log(most));
    return rand() % 2 ? x : -x;
}

static void compare_elementary(const elementary *f, void *library) {
    enum { SIDE = 8, DRAWS = 5000 };
    static const double special[] = {0,   -0.,       INFINITY, -INFINITY,
                                     NAN, 0x1p-1074, 1,        -1};
    void (*take)(const double *, const double *, double *);
    double x[SIDE], y[SIDE], z[3 * SIDE];
    *(void **)&take = dlsym(library, f->name);
    ck_assert(take);
    for (int k = 0; k < DRAWS; k++) {
        double most = k % 4 ? k % 4 == 1 ? 1e3 : 10 : 1e300;
        for (int i = 0; i < SIDE; i++) {
            x[i] = k < SIDE ? special[i] : drawn(most);
            y[i] = k < SIDE ? special[(i + k) % SIDE] : drawn(most);
        }
        take(x, y, z);
        for (int i = 0; i < 3 * SIDE; i++) {
            double a = x[i % SIDE], b = y[i % SIDE];
            double want = f->one ? f->one(a) : f->two(a, b);
            ck_assert_msg((isnan(want) && isnan(z[i])) ||
                              !memcmp(&want, &z[i], sizeof want),
                          "%s(%.17g, %.17g): %.17g, by way %d %.17g", f->name,
                          a, b, want, i / SIDE, z[i]);
        }
    }
}

/* Types, what functions begin with, how many numbers, and where results begin. */
static const char *const ways_of_lanes[][4] = {
    {"double", "nevh__one_", "1", "0"},
    {"few", "few_", "4", "8"},
    {"wide", "wide_", "8", "16"}};

TEST(elementary_same_bits) {
#define ONE(name, f, family) {"take_" #f, nevh_simd_##name, NULL},
#define TWO(name, f, family) {"take_" #f, NULL, nevh_simd_##name},
    const elementary tried[] = {NEVH__EACH_ONE(ONE) NEVH__EACH_TWO(TWO)};
#undef ONE
#undef TWO
    const size_t count = sizeof tried / sizeof *tried;
    char why[NEVH__WHY_NATIVE] = "";
    if (!has_compiler())
        skip_test("there is no C compiler");
    nevh__writer steps = {.width = 1};
    nevh__write(&steps, "int nevh_native_steps;\n");
    for (size_t i = 0; i < count; i++) {
        const char *name = tried[i].name + strlen("take_");
        bool two = tried[i].two;
        nevh__elementary_call(&steps, &nevh__four, name);
        nevh__elementary_call(&steps, &nevh__eight, name);
        nevh__write(&steps,
                    "void take_%s(const double *x, const double *y, "
                    "double *z) {\n(void)y;\n",
                    name);
        for (int way = 0; way < 3; way++)
            nevh__write_filled(
                &steps,
                two ? "for (int i = 0; i < 8; i += $4) *($1 *)(z + $5 + i) = "
                      "$2$3(*(const $1 *)(x + i), *(const $1 *)(y + i));\n"
                    : "for (int i = 0; i < 8; i += $4) *($1 *)(z + $5 + i) = "
                      "$2$3(*(const $1 *)(x + i));\n",
                (const char *const[]){
                    ways_of_lanes[way][0], ways_of_lanes[way][1], name,
                    ways_of_lanes[way][2], ways_of_lanes[way][3]});
        nevh__write(&steps, "}\n");
    }
    nevh__write_prelude(&steps);
    void *library = nevh__native_load(steps.text, "", 120, why);
    ck_assert_msg(library, "%s", why);
    for (size_t i = 0; i < count; i++)
        compare_elementary(&tried[i], library);
    dlclose(library);
    nevh__writer_free(&steps);
}

/* Sweeps that do not get on are left to the kernel, and so are steps that
   Newton's iteration takes first; compiled ones go on after them, or
   the equations have no solution. */
TEST_EACH(rescue_same_bits, 8) {
    static const char eccentric[] =
        "[coordinates]\nx = 0.1, 0\ny = 0, 4.359\n[effects]\n"
        "T = (p_x^2 + p_y^2)/2\nV = -1/sqrt(x^2 + y^2)\n";
    static const char stiff[] =
        "[coordinates]\nx = 1\ny = 0.1\n[effects]\n"
        "T = (p_x^2 + p_y^2)/2\nV = 20000*(sqrt(x^2 + y^2) - 1)^2 - x\n";
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed(_i < 4 || _i > 5 ? eccentric : stiff);
    pair x = pair_of(scene, _i < 4 || _i > 5 ? nevh_gauss8 : nevh_gauss16,
                     _i % 2 ? nevh_central4 : nevh_exact, _i % 2 == 0, cache,
                     _i > 5 ? 16 : 1);
    ck_assert_msg(nevh_stepper_native(x.native, NULL), "%s", x.why);
    double h = _i < 2 || _i > 5 ? 0.115248 : _i < 4 ? 0.161 : 0.03;
    ck_assert_int_eq(pair_run(&x, h, 2000),
                     _i < 2 || _i > 3 ? NEVH_OK : NEVH_EMAXITER);
    nevh_counts counts = nevh_stepper_counts(x.native);
    ck_assert(pair_same(&x) && counts.newtons > 0 && counts.newtons < 1000);
    pair_free(&x);
    nevh_scene_free(scene);
}

/* Memory that one has saved the other goes on with. */
TEST_EACH(memory_is_shared, 3) {
    if (!has_compiler())
        skip_test("there is no C compiler");
    share_cache();
    nevh_scene *scene = parsed(pendulum);
    const nevh_integrator *schemes[] = {nevh_forest_ruth, nevh_gauss8,
                                        nevh_tao4};
    pair x = pair_new(scene, schemes[_i], nevh_exact, false, cache);
    ck_assert_int_eq(pair_run(&x, 0.1, 500), NEVH_OK);
    size_t size = nevh_stepper_save_size(x.plain);
    void *saved = malloc(size), *other = malloc(size);
    nevh_stepper_save(x.plain, saved);
    nevh_stepper_save(x.native, other);
    ck_assert_mem_eq(saved, other, size);
    ck_assert_int_eq(nevh_stepper_load(x.native, saved, size), NEVH_OK);
    ck_assert_int_eq(nevh_stepper_apply(x.plain, 50, 0.1, x.a, x.a + 1), 0);
    ck_assert_int_eq(nevh_stepper_apply(x.native, 50, 0.1, x.b, x.b + 1), 0);
    ck_assert_mem_eq(x.a, x.b, 2 * sizeof(double));
    /* A jump forgets both. */
    x.a[0] = x.b[0] = 0.5;
    ck_assert_int_eq(pair_run(&x, 0.1, 50), NEVH_OK);
    ck_assert_mem_eq(x.a, x.b, 2 * sizeof(double));
    free(saved);
    free(other);
    pair_free(&x);
    nevh_scene_free(scene);
}

/* No word of a scene is in what is compiled, nor any of its numbers. */
TEST(names_stay_out) {
    static const char hostile[] =
        "[scene]\ntitle = \"); system(\"rm -rf /\"); //\n"
        "[parameters]\nasm = 1234.5\n__attribute__ = 2\nmain = 3\n"
        "[coordinates]\nsystem = 1, 0.2\nφ_include = 0.5\n"
        "[effects]\nexit = p_system^2/asm + p_φ_include^2/main\n"
        "abort = __attribute__*(1 - cos(system)) + φ_include^2/2\n";
    static const char *const words[] = {"system", "exit",          "abort",
                                        "asm",    "attribute__ =", "main",
                                        "φ",      "1234",          "rm -rf"};
    nevh_scene *scene = parsed(hostile);
    nevh_options o = {.gradient = nevh_exact};
    nevh_stepper *s =
        nevh_stepper_new(nevh_scene_system(scene), nevh_verlet, &o);
    ck_assert_int_eq(nevh_stepper_status(s), NEVH_OK);
    nevh_work w = {.integrator = nevh_verlet,
                   .field = nevh_stepper_field(s),
                   .n = 2,
                   .width = 1};
    nevh_options none = {0};
    nevh__writer text = {0};
    w.options = &none;
    ck_assert(nevh__native_write(&text, &w));
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        ck_assert_msg(!strstr(text.text, words[i]), "%s", words[i]);
    ck_assert(strstr(text.text, "cos"));
    nevh__writer_free(&text);
    nevh_stepper_free(s);
    nevh_scene_free(scene);
}
