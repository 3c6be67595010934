/* nevh tests: the integrator "taylor".  It takes formulas alone, so that what
   other suites assert of all schemes on functions in C stands here.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <float.h>
#include <math.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <stdlib.h>

#define KEPLER                                                                 \
    "[parameters]\nm = 1\nk = 1\na = 1\n[coordinates]\nx = 0.4*a\ny = 0\n"     \
    "p_y = 2*sqrt(k*m/a)\n[effects]\n"                                         \
    "H = (p_x^2 + p_y^2)/(2*m) - k/sqrt(x^2 + y^2)\n"
#define HENON_HEILES                                                           \
    "[coordinates]\nx = 0\ny = 0.1\np_x = 0.49\n[effects]\n"                   \
    "H = (p_x^2 + p_y^2 + x^2 + y^2)/2 + x^2*y - y^3/3\n"
#define DRIVEN                                                                 \
    "[coordinates]\nphi = 1\np_phi = 0.3\n[effects]\n"                         \
    "kinetic = p_phi^2/2\npush = -(2 + 0.7*sin(1.9*t))*cos(phi)\n"
#define DAMPED                                                                 \
    "[coordinates]\nx = 1\ny = -0.5\n[effects]\n"                              \
    "H = p_x^2/2 + p_y^2/6 + x^2 + y^4 + x*y\n[friction]\nair = all: 0.2\n"
#define TAIL "[run]\nt_end = 10\n"

typedef struct {
    nevh_scene *scene;
    const nevh_system *system;
    size_t n;
    double q[2], p[2];
} orbit;

static orbit orbit_of(const char *text) {
    orbit z;
    z.scene = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(z.scene), "%s\n%s",
                  nevh_scene_message(z.scene), text);
    z.system = nevh_scene_system(z.scene);
    z.n = nevh_scene_dof(z.scene);
    ck_assert_int_eq(nevh_scene_start(z.scene, z.q, z.p), NEVH_OK);
    return z;
}

static nevh_stepper *stepper_with(const orbit *z, const nevh_integrator *scheme,
                                  nevh_options o) {
    o.gradient = nevh_exact;
    o.q = z->q;
    o.p = z->p;
    nevh_stepper *m = nevh_stepper_new(z->system, scheme, &o);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    return m;
}

static nevh_stepper *stepper_of(const orbit *z, double tolerance) {
    return stepper_with(z, nevh_taylor, (nevh_options){.tolerance = tolerance});
}

/* Returns how many series it took. */
static uint64_t travel(orbit *z, nevh_stepper *m, double span, size_t steps) {
    int status =
        nevh_run(m, 0, span / (double)steps, steps, z->q, z->p, NULL, 0);
    ck_assert_msg(!status, "%s", nevh_stepper_message(m));
    return nevh_stepper_counts(m).gradients;
}

static double distance(const orbit *a, const orbit *b) {
    double sum = 0;
    for (size_t k = 0; k < a->n; k++)
        sum += pow(a->q[k] - b->q[k], 2) + pow(a->p[k] - b->p[k], 2);
    return sqrt(sum);
}

static void same_bits(const orbit *a, const orbit *b) {
    ck_assert_mem_eq(a->q, b->q, a->n * sizeof *a->q);
    ck_assert_mem_eq(a->p, b->p, a->n * sizeof *a->p);
}

static const char *const texts[] = {KEPLER TAIL, HENON_HEILES TAIL, DRIVEN TAIL,
                                    DAMPED TAIL};
static const double periods = 20 * 3.141592653589793;

/* By gauss16, but where there is friction, which it splits off. */
static void go_with_care(orbit *z, double span, bool damped) {
    nevh_stepper *m =
        stepper_with(z, damped ? nevh_dop853 : nevh_gauss16,
                     (nevh_options){.tolerance = damped ? 1e-15 : 0});
    travel(z, m, span, 4000);
    nevh_stepper_free(m);
}

TEST_EACH(error_falls_with_the_tolerance, 4) {
    orbit end = orbit_of(texts[_i]);
    go_with_care(&end, periods, _i == 3);
    double x[9], y[9];
    int count = 0;
    for (double tolerance = 1e-4; tolerance > 0.9e-11; tolerance /= 10) {
        orbit z = orbit_of(texts[_i]);
        nevh_stepper *m = stepper_of(&z, tolerance);
        travel(&z, m, periods, 3);
        x[count] = log(tolerance);
        y[count] = log(distance(&z, &end));
        ck_assert_msg(y[count] < x[count] + log(3e3), "%d, %g: %g", _i,
                      tolerance, exp(y[count]));
        count++;
        nevh_stepper_free(m);
        nevh_scene_free(z.scene);
    }
    double slope = slope_through(count, x, y);
    ck_assert_msg(slope > 0.7 && slope < 1.3, "%d: %.2f", _i, slope);
    nevh_scene_free(end.scene);
}

TEST_EACH(steps_do_not_change_the_orbit, 4) {
    orbit whole = orbit_of(texts[_i]), z = orbit_of(texts[_i]);
    nevh_stepper *m = stepper_of(&whole, 1e-12), *o = stepper_of(&z, 1e-12);
    uint64_t once = travel(&whole, m, periods, 4);
    uint64_t often = travel(&z, o, periods, 300);
    ck_assert(distance(&z, &whole) < (_i >= 2 ? 1e-8 : 1e-13));
    if (_i < 2) /* else series are as long as some steps */
        ck_assert_uint_le(often, once + 1);
    nevh_stepper_free(m);
    nevh_stepper_free(o);
    nevh_scene_free(whole.scene);
    nevh_scene_free(z.scene);
}

TEST_EACH(there_and_back, 3) {
    orbit z = orbit_of(texts[_i]), start = z;
    nevh_stepper *m = stepper_of(&z, 1e-14);
    for (int i = 0; i < 40; i++)
        ck_assert_int_eq(nevh_stepper_apply(m, 0.25 * i, 0.25, z.q, z.p), 0);
    ck_assert(distance(&z, &start) > 0.1);
    for (int i = 40; i > 0; i--)
        ck_assert_int_eq(nevh_stepper_apply(m, 0.25 * i, -0.25, z.q, z.p), 0);
    ck_assert(distance(&z, &start) < 1e-11);
    nevh_stepper_free(m);
    nevh_scene_free(z.scene);
}

/* By powers of two, to the last bit. */
TEST(units_do_not_matter) {
    orbit z = orbit_of(KEPLER TAIL);
    orbit other = orbit_of(KEPLER TAIL);
    ck_assert_int_eq(nevh_scene_set(other.scene, "m=8"), NEVH_OK);
    ck_assert_int_eq(nevh_scene_set(other.scene, "k=8*2^-6"), NEVH_OK);
    other.system = nevh_scene_system(other.scene);
    other.q[0] *= 0x1p20; /* times of 2^33: m l^3/t^2 = 8 2^-6 */
    other.p[1] *= 8 * 0x1p20 * 0x1p-33;
    nevh_stepper *m = stepper_of(&z, 1e-13), *o = stepper_of(&other, 1e-13);
    uint64_t count = travel(&z, m, periods, 7);
    ck_assert_uint_eq(travel(&other, o, periods * 0x1p33, 7), count);
    for (int i = 0; i < 2; i++) {
        ck_assert_double_eq(other.q[i], z.q[i] * 0x1p20);
        ck_assert_double_eq(other.p[i], z.p[i] * 8 * 0x1p20 * 0x1p-33);
    }
    nevh_stepper_free(m);
    nevh_stepper_free(o);
    nevh_scene_free(z.scene);
    nevh_scene_free(other.scene);
}

TEST_EACH(lanes_are_orbits, 4) {
    enum { W = 3 };
    orbit z[W];
    double q[2 * W], p[2 * W];
    for (int i = 0; i < W; i++) {
        z[i] = orbit_of(texts[_i]);
        z[i].q[0] += 0.1 * i;
        for (size_t k = 0; k < z[i].n; k++) {
            q[k * W + i] = z[i].q[k];
            p[k * W + i] = z[i].p[k];
        }
    }
    nevh_options o = {.gradient = nevh_exact, .width = W, .tolerance = 1e-11};
    nevh_stepper *m = nevh_stepper_new(z[0].system, nevh_taylor, &o);
    const double scale[] = {1, 1, 1, 1};
    nevh_stepper_free(m);
    o.scale = scale;
    m = nevh_stepper_new(z[0].system, nevh_taylor, &o);
    ck_assert_int_eq(nevh_run(m, 0, 0.7, 20, q, p, NULL, 0), NEVH_OK);
    o.width = 1;
    for (int i = 0; i < W; i++) {
        nevh_stepper *one = nevh_stepper_new(z[0].system, nevh_taylor, &o);
        ck_assert_int_eq(nevh_run(one, 0, 0.7, 20, z[i].q, z[i].p, NULL, 0),
                         NEVH_OK);
        for (size_t k = 0; k < z[i].n; k++) {
            ck_assert_double_eq(q[k * W + i], z[i].q[k]);
            ck_assert_double_eq(p[k * W + i], z[i].p[k]);
        }
        nevh_stepper_free(one);
    }
    nevh_stepper_free(m);
    for (int i = 0; i < W; i++)
        nevh_scene_free(z[i].scene);
}

/* The relative error of the energy, root mean square over the last periods. */
static double wandering(double e, double tolerance, int all, int last) {
    orbit z = orbit_of(KEPLER TAIL);
    z.q[0] = 1 - e;
    z.p[1] = sqrt((1 + e) / (1 - e));
    nevh_stepper *m = stepper_of(&z, tolerance);
    long double first = 0;
    double sum = 0, period = 2 * 3.141592653589793;
    for (int i = 0; i <= all; i++) {
        long double x = z.q[0], y = z.q[1], px = z.p[0], py = z.p[1];
        long double h = (px * px + py * py) / 2 - 1 / sqrtl(x * x + y * y);
        first = i ? first : h;
        if (i > all - last)
            sum += pow((double)(h / first - 1), 2) / last;
        if (i < all)
            travel(&z, m, period, 8);
    }
    nevh_stepper_free(m);
    nevh_scene_free(z.scene);
    return sum;
}

/* Below rounding, steps have errors of more digits than doubles have. */
TEST(errors_of_rounding_stay_small) {
    double fine = 0, coarse = 0;
    for (int i = 0; i < 4; i++) {
        fine += wandering(0.6 - 1e-3 * i, 1e-25, 600, 16) / 4;
        coarse += wandering(0.6 - 1e-3 * i, 3e-16, 600, 16) / 4;
    }
    ck_assert_msg(sqrt(fine) < 1.5e-15, "%.2e", sqrt(fine));
    ck_assert_msg(coarse > 16 * fine, "%.2e", sqrt(coarse));
}

static int upwards(void *data, double t, const double q[], const double p[],
                   double *value) {
    (void)data, (void)t, (void)p;
    *value = q[0];
    return 0;
}

static int count_point(void *points, const nevh_point *at) {
    (void)at;
    ++*(size_t *)points;
    return 0;
}

/* Evaluations for points of a section, besides one slope a step. */
static double spent_on_points(const nevh_integrator *scheme, double h,
                              size_t *points) {
    size_t steps = (size_t)(200 / h);
    orbit z = orbit_of(HENON_HEILES TAIL);
    nevh_stepper *m =
        stepper_with(&z, scheme, (nevh_options){.tolerance = 1e-12});
    *points = 0;
    nevh_sections *x = nevh_sections_new(m, &(nevh_section){.value = upwards},
                                         1, count_point, points);
    nevh_observer watch = {nevh_sections_observe, x, 1};
    ck_assert_int_eq(nevh_run(m, 0, h, steps, z.q, z.p, &watch, 1), NEVH_OK);
    double spent =
        (double)nevh_sections_counts(x).gradients - (double)steps - 1;
    nevh_sections_free(x);
    nevh_stepper_free(m);
    nevh_scene_free(z.scene);
    return spent;
}

/* They are roots of the series that is there: of the one before a step, or of
   that after it.  A step of several series takes those between once a point. */
TEST(section_points_take_no_series) {
    size_t points, others;
    double sub_steps = spent_on_points(nevh_gauss8, 0.1, &others);
    ck_assert_uint_ge(others, 50);
    ck_assert_msg(sub_steps > 20 * (double)others, "%g", sub_steps);
    for (int i = 1; i <= 5; i++) {
        double spent = spent_on_points(nevh_taylor, 0.1 * i, &points);
        ck_assert_uint_eq(points, others);
        ck_assert_msg(spent == 0, "h = 0.%d: %g of %zu", i, spent, points);
    }
    double spent = spent_on_points(nevh_taylor, 4, &points);
    ck_assert_uint_eq(points, others);
    ck_assert_msg(spent < 8 * (double)points, "%g of %zu", spent, points);
}

/* What a tolerance is relative to is found by a coarse run. */
TEST(orbits_do_not_depend_on_the_gradient) {
    static const char *const names[] = {"central2", "central8", "complex-step"};
    orbit z = orbit_of(KEPLER TAIL), same, other;
    same = other = z;
    nevh_options o = {.tolerance = 1e-9, .q = z.q, .p = z.p};
    nevh_stepper *m = stepper_with(&z, nevh_taylor, o);
    travel(&same, m, 1, 3);
    nevh_stepper_free(m);
    for (size_t i = 0; i < 3; i++) {
        o.gradient = nevh_gradient_named(names[i]);
        o.gradient_step = i ? 0 : 0.5; /* given: nothing is tried */
        orbit x = z;
        m = nevh_stepper_new(z.system, nevh_taylor, &o);
        travel(&x, m, 1, 3);
        same_bits(&same, &x);
        nevh_stepper_free(m);
    }
    o.scale = (const double[]){8, 8, 8, 8};
    m = nevh_stepper_new(z.system, nevh_taylor, &o);
    travel(&other, m, 1, 3);
    ck_assert(distance(&other, &same) > 0); /* lengths do count */
    nevh_stepper_free(m);
    nevh_scene_free(z.scene);
}

TEST(memory_is_saved_and_copied) {
    orbit z = orbit_of(KEPLER TAIL), saved, copied;
    nevh_stepper *m = stepper_of(&z, 1e-13), *other = stepper_of(&z, 1e-13);
    travel(&z, m, 10.1, 13);
    saved = copied = z;
    size_t size = nevh_stepper_save_size(m);
    void *buffer = malloc(size);
    nevh_stepper_save(m, buffer);
    nevh_stepper *copy = nevh_stepper_copy(m);
    ck_assert_int_eq(nevh_stepper_load(other, buffer, size), NEVH_OK);
    for (int i = 0; i < 9; i++) {
        double t = 10.1 + 0.3 * i;
        ck_assert_int_eq(nevh_stepper_apply(m, t, 0.3, z.q, z.p), 0);
        ck_assert_int_eq(nevh_stepper_apply(other, t, 0.3, saved.q, saved.p),
                         0);
        ck_assert_int_eq(nevh_stepper_apply(copy, t, 0.3, copied.q, copied.p),
                         0);
    }
    same_bits(&z, &saved);
    same_bits(&z, &copied);
    nevh_stepper_free(m);
    nevh_stepper_free(other);
    nevh_stepper_free(copy);
    nevh_scene_free(z.scene);
    free(buffer);
}

static double energy_at(const orbit *z, double t) {
    double h;
    nevh_field *f = nevh_field_new(z->system, NULL);
    ck_assert_int_eq(nevh_field_value(f, 1, &t, z->q, z->p, &h), NEVH_OK);
    nevh_field_free(f);
    return h;
}

/* H less what came in from outside, by force and by friction. */
TEST_RANGE(balance_is_kept, 2, 4) {
    orbit z = orbit_of(texts[_i]);
    double before = energy_at(&z, 0);
    nevh_stepper *m = stepper_with(
        &z, nevh_taylor, (nevh_options){.tolerance = 1e-14, .balance = true});
    travel(&z, m, 20, 37);
    double gain = nevh_stepper_gain(m, 0);
    ck_assert(fabs(gain) > 0.01);
    ck_assert_double_eq_tol(energy_at(&z, 20) - before, gain, 1e-12);
    nevh_stepper_free(m);
    nevh_scene_free(z.scene);
}

/* Into the centre. */
TEST(failures_leave_the_state) {
    orbit z = orbit_of("[coordinates]\nx = 1\np_x = -0.1\n[effects]\n"
                       "H = p_x^2/2 - 1/x\n" TAIL);
    nevh_stepper *m = stepper_of(&z, 1e-10);
    orbit before = z;
    ck_assert_int_ne(nevh_stepper_apply(m, 0, 5, z.q, z.p), NEVH_OK);
    assert_says(nevh_stepper_message(m), "t = 1.0184"); /* where it ends */
    same_bits(&z, &before);
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z.q, z.p), NEVH_OK);
    z.q[0] = 0;
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z.q, z.p), NEVH_EDOM);
    assert_says(nevh_stepper_message(m), "t = 0");
    nevh_stepper_free(m);
    nevh_scene_free(z.scene);
}

static void assert_refused(const nevh_system *s, nevh_options o, int status,
                           const char *word) {
    nevh_stepper *m = nevh_stepper_new(s, nevh_taylor, &o);
    ck_assert_int_eq(nevh_stepper_status(m), status);
    assert_says(nevh_stepper_message(m), word);
    nevh_stepper_free(m);
}

TEST(refusals_say_why) {
    orbit z = orbit_of(KEPLER TAIL);
    nevh_options o = {.tolerance = 1e-9};
    assert_refused(z.system, (nevh_options){0}, NEVH_EINVAL, "tolerance");
    nevh_system *s = kepler.make();
    assert_refused(s, o, NEVH_ESTRUCT, "in C");
    o.transform = s;
    assert_refused(z.system, o, NEVH_ESTRUCT, "taylor");
    nevh_system_free(s);
    nevh_scene_free(z.scene);
    z = orbit_of("[coordinates]\nx = 1\n[effects]\nkinetic = p_x^2/2\n"
                 "wall = abs(x)\n" TAIL);
    o.transform = NULL;
    assert_refused(z.system, o, NEVH_ESTRUCT, "\"wall\"");
    nevh_scene_free(z.scene);
}

/* Rounding alone is left [D. Brouwer, On the accumulation of errors in
   numerical integration, Astron. J. 46 (1937) 149-153]: over 5000 periods
   within a few times the square root of the number of series, each by half an
   ulp; a drift of as much would be 300 times that. */
TEST(energy_walks_at_random) {
    orbit z = orbit_of(KEPLER TAIL);
    double before = energy_at(&z, 0), most = 0;
    nevh_stepper *m = stepper_of(&z, 1e-18);
    for (int i = 0; i < 50; i++) {
        ck_assert_int_eq(
            nevh_run(m, periods * 10 * i, periods, 10, z.q, z.p, NULL, 0),
            NEVH_OK);
        most = fmax(most, fabs(energy_at(&z, 0) / before - 1));
    }
    ck_assert_msg(most < 6e-14, "%g", most);
    nevh_stepper_free(m);
    nevh_scene_free(z.scene);
}
