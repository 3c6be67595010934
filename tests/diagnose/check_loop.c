/* nevh tests: areas that schemes carry along.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>

static const double radius = 0.3, at = 1;

/* A disc round (1, 0); in more degrees of freedom a circle in the plane of x and
   p_x. */
static int circle(void *data, size_t count, const double s[], double q[],
                  double p[]) {
    const double *other = data; /* y, p_y; or NULL */
    for (size_t i = 0; i < count; i++) {
        double angle = 2 * acos(-1) * s[i];
        q[i] = at + radius * cos(angle);
        p[i] = radius * sin(angle);
        if (other) {
            q[i] = radius / 2 * cos(angle);
            p[i] /= 2;
            q[count + i] = other[0];
            p[count + i] = other[1];
        }
    }
    return 0;
}

/* The square round (1, 0). */
static int square(void *data, size_t count, const double s[], double q[],
                  double p[]) {
    static const double x[] = {1, -1, -1, 1, 1}, y[] = {1, 1, -1, -1, 1};
    (void)data;
    for (size_t i = 0; i < count; i++) {
        int side = (int)(4 * s[i]);
        double rest = 4 * s[i] - side;
        q[i] = at + radius * (x[side] + rest * (x[side + 1] - x[side]));
        p[i] = radius * (y[side] + rest * (y[side + 1] - y[side]));
    }
    return 0;
}

static nevh_scene *pendulum(void) {
    return nevh_scene_parse("pendulum", "[coordinates]\nx = 1\n[effects]\n"
                                        "kinetic = p_x^2/2\n"
                                        "gravity = -cos(x)\n");
}

static nevh_scene *galaxy(void) {
    return nevh_scene_parse("galaxy", "[coordinates]\nx = 0.1\ny = 0.1\n"
                                      "[effects]\n"
                                      "kinetic = (p_x^2 + p_y^2)/2\n"
                                      "springs = (x^2 + y^2)/2\n"
                                      "cubic = x^2*y - y^3/3\n");
}

/* After 0 and `steps` steps of 0.1; exact gradients. */
static nevh_loop *carried(nevh_scene *s, const nevh_integrator *scheme,
                          nevh_loop_options is, size_t steps) {
    double q[2], p[2];
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_options o = {.gradient = nevh_exact,
                      .q = q,
                      .p = p,
                      .tolerance = tolerance_for(scheme)};
    is.h = 0.1;
    is.steps = (size_t[]){0, steps};
    is.times = 2;
    nevh_loop *l = nevh_loop_new(nevh_scene_system(s), scheme, &o, &is);
    nevh_loop_carry(l);
    return l;
}

/* The area at the end over the first. */
static double ratio(const nevh_loop *l) {
    ck_assert_int_eq(nevh_loop_status(l), NEVH_OK);
    nevh_loop_area first = nevh_loop_result(l, 0),
                   last = nevh_loop_result(l, 1);
    ck_assert_double_le(first.error, 1e-9 * first.area);
    ck_assert_double_le(last.error, 1e-9 * last.area);
    return last.area / first.area;
}

static nevh_loop_options disc = {.curve = circle};

TEST(areas_at_the_beginning_are_exact) {
    static const double corners[] = {0, 0.25, 0.5, 0.75};
    nevh_scene *s = pendulum();
    nevh_loop *l = carried(s, nevh_euler, disc, 1);
    double exact = acos(-1) * radius * radius;
    ck_assert_double_eq_tol(nevh_loop_result(l, 0).area, exact, 1e-14);
    ck_assert_double_eq(nevh_loop_result(l, 0).t, 0);
    ck_assert_double_eq(nevh_loop_result(l, 1).t, 0.1);
    nevh_loop_free(l);
    l = carried(s, nevh_euler,
                (nevh_loop_options){
                    .curve = square, .corners = corners, .n_corners = 4},
                1);
    ck_assert_double_eq_tol(nevh_loop_result(l, 0).area, 4 * radius * radius,
                            1e-14);
    ck_assert_uint_eq(nevh_loop_result(l, 0).points, 4 * 4 * 16);
    nevh_loop_free(l);
    nevh_scene_free(s);
}

TEST_EACH(symplectic_schemes_keep_the_area, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_symplectic(scheme) != NEVH_YES)
        skip_test("it does not say that it is symplectic");
    nevh_scene *s = pendulum();
    nevh_loop *l = carried(s, scheme, disc, 300);
    ck_assert_double_eq_tol(ratio(l), 1, 1e-11);
    nevh_loop_free(l);
    nevh_scene_free(s);
}

TEST(others_do_not) {
    const nevh_integrator *const schemes[] = {nevh_rk4, nevh_heun, nevh_rk3};
    nevh_scene *s = pendulum();
    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++) {
        nevh_loop *l = carried(s, schemes[i], disc, 300);
        ck_assert_double_gt(fabs(ratio(l) - 1), 1e-7);
        nevh_loop_free(l);
    }
    nevh_scene_free(s);
}

TEST(verlet_keeps_the_area_for_1000_steps) {
    nevh_scene *s = pendulum();
    nevh_loop *l = carried(s, nevh_verlet, disc, 1000);
    ck_assert_double_eq_tol(ratio(l), 1, 1e-9);
    nevh_loop_free(l);
    nevh_scene_free(s);
}

typedef struct {
    size_t orbits;
    double *rest; /* of circle */
} counter;

static int counted_circle(void *data, size_t count, const double s[],
                          double q[], double p[]) {
    counter *c = data;
    c->orbits += count;
    return circle(c->rest, count, s, q, p);
}

/* Panels that are too rough for halves are not cut into halves. */
TEST(few_orbits_are_carried_for_nothing) {
    counter c = {0, NULL};
    nevh_scene *s = pendulum();
    nevh_loop *l =
        carried(s, nevh_verlet,
                (nevh_loop_options){.curve = counted_circle, .data = &c}, 4000);
    size_t points = nevh_loop_result(l, 1).points;
    ck_assert_double_eq_tol(ratio(l), 1, 1e-9);
    ck_assert_uint_le(2 * c.orbits, 3 * points);
    nevh_loop_free(l);
    nevh_scene_free(s);
}

/* The sum over both planes, on Henon and Heiles' potential. */
TEST(symplectic_schemes_keep_the_sum_of_areas) {
    static double rest[] = {0.1, 0.2};
    nevh_loop_options is = {.curve = circle, .data = rest};
    nevh_scene *s = galaxy();
    nevh_loop *l = carried(s, nevh_verlet, is, 1000);
    ck_assert_double_eq_tol(ratio(l), 1, 1e-9);
    nevh_loop_free(l);
    l = carried(s, nevh_gauss4, is, 300);
    ck_assert_double_eq_tol(ratio(l), 1, 1e-11);
    nevh_loop_free(l);
    l = carried(s, nevh_euler, is, 100);
    ck_assert_double_gt(ratio(l), 2);
    nevh_loop_free(l);
    nevh_scene_free(s);
}

/* A step of either Euler scheme from (x, p), and the determinant of its
   derivative: 1 + h^2 cos x at its beginning, or 1 over that at its end. */
static double euler(double h, double *x, double *p) {
    double determinant = 1 + h * h * cos(*x), velocity = *p;
    *p -= h * sin(*x);
    *x += h * velocity;
    return determinant;
}
static double implicit_euler(double h, double *x, double *p) {
    double end = *x;
    for (int i = 0; i < 6; i++) /* end = x + h (p - h sin(end)) */
        end -= (end - *x - h * (*p - h * sin(end))) / (1 + h * h * cos(end));
    *p -= h * sin(end);
    *x = end;
    return 1 / (1 + h * h * cos(end));
}

/* The mean over the disc of the determinant of all steps: midpoint rule in r^2,
   and in the angle. */
static double theory(double (*step)(double, double *, double *), size_t steps) {
    enum { RINGS = 40, ANGLES = 100 };
    double sum = 0;
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < ANGLES; k++) {
            double r = radius * sqrt((i + 0.5) / RINGS);
            double angle = 2 * acos(-1) * k / ANGLES, product = 1;
            double x = at + r * cos(angle), p = r * sin(angle);
            for (size_t j = 0; j < steps; j++)
                product *= step(0.1, &x, &p);
            sum += product;
        }
    return sum / (RINGS * ANGLES);
}

/* The curve of Euler's method passes the saddle again and again, and is soon
   stretched beyond what points resolve. */
static void assert_follows_theory(const nevh_integrator *scheme, size_t steps,
                                  double exact, double tolerance, bool inside) {
    nevh_scene *s = pendulum();
    nevh_loop *l = carried(s, scheme, disc, steps);
    ck_assert_int_eq(nevh_loop_status(l), NEVH_OK);
    nevh_loop_area first = nevh_loop_result(l, 0),
                   last = nevh_loop_result(l, 1);
    ck_assert_double_eq_tol(last.area / first.area / exact, 1, tolerance);
    ck_assert_double_le(last.error, tolerance * last.area);
    ck_assert_int_eq(last.inside, inside);
    nevh_loop_free(l);
    nevh_scene_free(s);
}

TEST(implicit_euler_shrinks_as_theory_says) {
    assert_follows_theory(nevh_implicit_euler, 1000,
                          theory(implicit_euler, 1000), 1e-3, false);
}

TEST(euler_grows_as_theory_says) {
    assert_follows_theory(nevh_euler, 200, theory(euler, 200), 1e-3, false);
}

TEST(euler_is_seen_from_the_inside) {
    assert_follows_theory(nevh_euler, 1000, theory(euler, 1000), 1e-2, true);
}

/* A curve that is not resolved, where there is no inside to look at. */
TEST(what_is_not_resolved_is_told) {
    static double rest[] = {0.1, 0.2};
    nevh_loop_options is = {.curve = circle, .data = rest, .most_points = 64};
    nevh_scene *s = galaxy();
    nevh_loop *l = carried(s, nevh_verlet, is, 1000);
    nevh_loop_area last = nevh_loop_result(l, 1);
    ck_assert_uint_eq(last.points, 64);
    ck_assert_double_gt(last.error, 1e-6 * last.area);
    ck_assert_double_gt(last.error,
                        fabs(last.area - nevh_loop_result(l, 0).area));
    nevh_loop_free(l);
    nevh_scene_free(s);
}

/* Where even the most points do not give an area, no more are carried along than show
   that, and few of them for nothing. */
TEST(areas_out_of_reach_take_few_orbits) {
    enum { MOST = 2048 };
    static const size_t steps[] = {4000, 400};
    double rest[] = {0.1, 0.35};
    nevh_scene *s = galaxy();
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        counter c = {0, rest};
        nevh_loop_options is = {
            .curve = counted_circle, .data = &c, .most_points = MOST};
        nevh_loop *l = carried(s, nevh_verlet, is, steps[i]);
        nevh_loop_area last = nevh_loop_result(l, 1);
        bool resolved = last.error <= 1e-9 * last.area;
        ck_assert_int_eq(resolved, steps[i] == 400);
        ck_assert_uint_lt(last.points, MOST);
        ck_assert_uint_le(2 * c.orbits, 3 * last.points);
        nevh_loop_free(l);
    }
    nevh_scene_free(s);
}

/* All points at one place. */
static int point(void *data, size_t count, const double s[], double q[],
                 double p[]) {
    (void)data, (void)s;
    for (size_t i = 0; i < count; i++)
        q[i] = p[i] = 1;
    return 0;
}
static int refusing(void *data, size_t count, const double s[], double q[],
                    double p[]) {
    (void)data, (void)count, (void)s, (void)q, (void)p;
    return 1;
}

TEST(loops_that_make_no_sense_are_refused) {
    static const double falling[] = {0.5, 0.25};
    nevh_scene *s = pendulum();
    struct {
        nevh_loop_options is;
        int status;
    } bad[] = {
        {{.curve = NULL}, NEVH_EINVAL},
        {{.curve = point}, NEVH_EINVAL},
        {{.curve = refusing}, NEVH_EFAILED},
        {{.curve = circle, .corners = falling, .n_corners = 2}, NEVH_EINVAL},
        {{.curve = circle, .n_corners = 2}, NEVH_EINVAL},
        {{.curve = circle, .t0 = NAN}, NEVH_EINVAL}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        nevh_loop *l = carried(s, nevh_verlet, bad[i].is, 10);
        ck_assert_int_eq(nevh_loop_status(l), bad[i].status);
        ck_assert_str_ne(nevh_loop_message(l), "");
        ck_assert_double_nan(nevh_loop_result(l, 0).area);
        nevh_loop_free(l);
    }
    nevh_loop *l = carried(s, nevh_adaptive_verlet, disc, 10);
    ck_assert_int_eq(nevh_loop_status(l), NEVH_ESTRUCT);
    assert_says(nevh_loop_message(l), "times of its own");
    nevh_loop_free(l);
    nevh_scene_free(s);
}

/* Points that leave the domain of H: the areas before stay. */
TEST(a_step_that_fails_leaves_the_areas_before) {
    nevh_scene *s = nevh_scene_parse("edge", "[coordinates]\nx = 1\n[effects]\n"
                                             "kinetic = p_x^2/2\n"
                                             "push = -x - sqrt(9 - x)\n");
    nevh_loop *l = carried(s, nevh_verlet, disc, 100);
    ck_assert_int_eq(nevh_loop_status(l), NEVH_EDOM);
    assert_says(nevh_loop_message(l), "failed before t = 10");
    ck_assert_double_gt(nevh_loop_result(l, 0).area, 0.28);
    ck_assert_double_nan(nevh_loop_result(l, 1).area);
    nevh_loop_free(l);
    nevh_scene_free(s);
}
