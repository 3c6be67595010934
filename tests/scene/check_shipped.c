/* nevh tests: scenes that ship are the systems that they say.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "shipped.h"
#include <float.h>
#include <math.h>
#include <time.h>

/* In [-1, 1). */
static double uniform(void) {
    static unsigned long long seed = 20240301;
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(seed >> 11) / 4503599627370496.0 - 1;
}

/* Parameters of high entropy, in the order of the model's structure. */
static const struct {
    const char *model, *scene, *parameters;
    double values[5];
} pairs[] = {
    {"harmonic-oscillator", "oscillator", "m k", {1.37, 5.23}},
    {"harmonic-oscillator", "oscillator-paper", "m k", {1.37, 5.23}},
    {"pendulum", "pendulum", "m l g", {1.37, 0.83, 9.81}},
    {"pendulum", "pendulum-separatrix", "m l g", {1.37, 0.83, 9.81}},
    {"pendulum", "pendulum-rotating", "m l g", {1.37, 0.83, 9.81}},
    {"double-pendulum", "double-pendulum", "m l g", {1.37, 0.83, 9.81}},
    {"double-pendulum", "double-pendulum-regular", "m l g", {1.37, 0.83, 9.81}},
    {"double-pendulum", "double-pendulum-chaotic", "m l g", {1.37, 0.83, 9.81}},
    {"double-pendulum-as-printed",
     "double-pendulum-as-printed",
     "m l g",
     {1.37, 0.83, 9.81}},
    {"elastic-pendulum",
     "elastic-pendulum",
     "m k l g",
     {1.37, 31.3, 0.83, 9.81}},
    {"coupled-oscillators",
     "coupled-oscillators",
     "m1 m2 k1 k2 k",
     {1.37, 0.61, 2.3, 7.1, 0.77}},
};
enum { PAIRS = sizeof pairs / sizeof *pairs };

typedef struct {
    nevh_scene *scene;
    nevh_system *made;
    nevh_field *of_scene, *of_model;
    double params[5], q[MOST_DOF], p[MOST_DOF];
    size_t n;
} pair;

static nevh_field *field_of(const nevh_system *system) {
    nevh_field *f =
        nevh_field_new(system, &(nevh_options){.gradient = nevh_exact});
    ck_assert_str_eq(nevh_field_message(f), "");
    return f;
}

static void set_parameters(pair *both, int i) {
    char names[40], text[80];
    strcpy(names, pairs[i].parameters);
    int k = 0;
    for (char *name = strtok(names, " "); name; name = strtok(NULL, " "), k++) {
        snprintf(text, sizeof text, "%s = %.17g", name, pairs[i].values[k]);
        ck_assert_msg(!nevh_scene_set(both->scene, text), "%s",
                      nevh_scene_message(both->scene));
        both->params[k] = pairs[i].values[k];
    }
}

static void open_pair(pair *both, int i) {
    char file[80];
    const nevh_model *model = nevh_model_named(pairs[i].model);
    snprintf(file, sizeof file, "%s.nevh", pairs[i].scene);
    *both = (pair){.scene = read_shipped(file), .n = model->n};
    set_parameters(both, i);
    both->made = model->system(both->params);
    both->of_scene = field_of(nevh_scene_system(both->scene));
    both->of_model = field_of(both->made);
    ck_assert_uint_eq(nevh_scene_dof(both->scene), model->n);
    ck_assert_int_eq(nevh_scene_start(both->scene, both->q, both->p), NEVH_OK);
}

static void close_pair(pair *both) {
    nevh_field_free(both->of_scene);
    nevh_field_free(both->of_model);
    nevh_system_free(both->made);
    nevh_scene_free(both->scene);
}

static double size_of(const double x[], size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

/* The sum of what the effects amount to. */
static double energy_size(const pair *both, const double q[],
                          const double p[]) {
    double h[8] = {0}, sum = 0;
    nevh_field_effects(both->of_scene, 0, q, p, h);
    for (int i = 0; i < 8; i++)
        sum += fabs(h[i]);
    return sum;
}

static void assert_same_energy(const pair *both, const double q[],
                               const double p[]) {
    double t = 0, a, b;
    ck_assert_int_eq(nevh_field_value(both->of_scene, 1, &t, q, p, &a),
                     NEVH_OK);
    ck_assert_int_eq(nevh_field_value(both->of_model, 1, &t, q, p, &b),
                     NEVH_OK);
    ck_assert_msg(fabs(a - b) <= 8 * DBL_EPSILON * energy_size(both, q, p),
                  "%.17g, not %.17g", a, b);
}

TEST_EACH(scene_is_the_model, PAIRS) {
    pair both;
    open_pair(&both, _i);
    for (int j = 0; j < 200; j++) {
        double q[MOST_DOF], p[MOST_DOF], t = 0;
        double a[2 * MOST_DOF], b[2 * MOST_DOF];
        for (size_t k = 0; k < both.n; k++) {
            q[k] = both.q[k] + 0.9 * uniform();
            p[k] = both.p[k] + 5 * uniform();
        }
        assert_same_energy(&both, q, p);
        nevh_field_gradient(both.of_scene, 1, &t, q, p, a, a + both.n);
        nevh_field_gradient(both.of_model, 1, &t, q, p, b, b + both.n);
        double size = size_of(b, 2 * both.n) + energy_size(&both, q, p);
        for (size_t k = 0; k < 2 * both.n; k++)
            ck_assert_msg(fabs(a[k] - b[k]) <= 16 * DBL_EPSILON * size,
                          "component %zu: %.17g, not %.17g", k, a[k], b[k]);
    }
    close_pair(&both);
}

static int observe_energies(void *data, size_t step, double t, const double q[],
                            const double p[]) {
    (void)step, (void)t;
    assert_same_energy(data, q, p);
    return 0;
}

/* Along one orbit, and to the same end by both. */
TEST_EACH(orbits_are_those_of_the_model, PAIRS) {
    pair both;
    open_pair(&both, _i);
    double q[2][MOST_DOF], p[2][MOST_DOF];
    const nevh_system *systems[] = {nevh_scene_system(both.scene), both.made};
    for (int j = 0; j < 2; j++) {
        nevh_options o = {.gradient = nevh_exact, .q = both.q, .p = both.p};
        nevh_stepper *s = nevh_stepper_new(systems[j], nevh_gauss6, &o);
        ck_assert_str_eq(nevh_stepper_message(s), "");
        memcpy(q[j], both.q, sizeof both.q);
        memcpy(p[j], both.p, sizeof both.p);
        ck_assert_int_eq(nevh_run(s, 0, 0.01, 300, q[j], p[j],
                                  &(nevh_observer){observe_energies, &both, 1},
                                  1),
                         NEVH_OK);
        nevh_stepper_free(s);
    }
    for (size_t k = 0; k < both.n; k++) {
        ck_assert_double_eq_tol(q[0][k], q[1][k], 1e-10);
        ck_assert_double_eq_tol(p[0][k], p[1][k], 1e-10);
    }
    close_pair(&both);
}

/* The Sun and Pluto after 100000 days in quadruple precision, by a Gauss method
   of order 16: coordinates. */
static const double sun[] = {0.6197224011858143216, -0.2483636156271377760,
                             -0.1245068149012286598};
static const double pluto[] = {14.12135343202440495, -28.71152633143566509,
                               -13.07958855928588185};

TEST(outer_solar_system_gets_there) {
    nevh_scene *s = read_shipped("outer-solar-system.nevh");
    double q[18], p[18];
    ck_assert_uint_eq(nevh_scene_dof(s), 18);
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_options o = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_stepper *by = nevh_stepper_new(nevh_scene_system(s), nevh_gauss12, &o);
    ck_assert_int_eq(nevh_run(by, 0, 100, 1000, q, p, NULL, 0), NEVH_OK);
    for (int k = 0; k < 3; k++) { /* x[1..6], y[1..6], z[1..6] */
        ck_assert_double_eq_tol(q[6 * k], sun[k], 1e-11);
        ck_assert_double_eq_tol(q[6 * k + 5], pluto[k], 1e-11);
    }
    nevh_stepper_free(by);
    nevh_scene_free(s);
}

static void orbit_elements(const double r[3], const double v[3], double GM,
                           double *a, double *tilt) {
    double distance = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    double speed2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    double lx = r[1] * v[2] - r[2] * v[1], ly = r[2] * v[0] - r[0] * v[2],
           lz = r[0] * v[1] - r[1] * v[0];
    *a = 1 / (2 / distance - speed2 / GM);
    *tilt = acos(lz / sqrt(lx * lx + ly * ly + lz * lz));
}

/* The Moon's orbit about the Earth, and the Earth's about the Sun. */
TEST(sun_earth_moon_start_as_they_are) {
    nevh_scene *s = read_shipped("sun-earth-moon.nevh");
    double q[9], p[9], v[9], r[3], w[3], a, tilt, t = 0;
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_field *f = field_of(nevh_scene_system(s));
    nevh_field_gradient(f, 1, &t, q, p, NULL, v);
    double GM = 4 * acos(-1) * acos(-1), earth = GM / 332946.05;
    for (int k = 0; k < 3; k++) {
        r[k] = q[3 * k + 2] - q[3 * k + 1];
        w[k] = v[3 * k + 2] - v[3 * k + 1];
        ck_assert_double_eq_tol(p[3 * k] + p[3 * k + 1] + p[3 * k + 2], 0,
                                1e-18);
    }
    orbit_elements(r, w, earth * 1.01230002, &a, &tilt);
    ck_assert_double_eq_tol(a * 149597870.7, 384400, 1e-4);
    ck_assert_double_eq_tol(tilt * 180 / acos(-1), 5.145, 1e-9);
    ck_assert_double_eq_tol(q[1] - q[0], 0.98328991, 5e-5);
    nevh_field_free(f);
    nevh_scene_free(s);
}

static void integrate(nevh_scene *s, double t, double q[2]) {
    double p[2];
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_options o = {.gradient = nevh_exact,
                      .q = q,
                      .p = p,
                      .transform = nevh_scene_transform(s)};
    nevh_stepper *by = nevh_stepper_new(nevh_scene_system(s), nevh_gauss8, &o);
    ck_assert_int_eq(nevh_run_until(by, 0, 0.2, t, q, p, NULL, 0), NEVH_OK);
    nevh_stepper_free(by);
}

/* A full turn, 75.3 years, past the Sun at 0.586 AU. */
TEST(halley_returns) {
    nevh_scene *s = read_shipped("earth-halley.nevh");
    double period = pow(17.834, 1.5), q[2];
    integrate(s, period / 2, q);
    ck_assert_double_eq_tol(hypot(q[0], q[1]), 17.834 * (1 - 0.96714), 1e-7);
    integrate(s, period, q);
    ck_assert_double_eq_tol(q[0], -17.834 * (1 + 0.96714), 1e-7);
    nevh_scene_free(s);
}

/* The Earth, which only pulls where the comet comes by, moves energy; the
   balance knows by how much. */
TEST(passages_are_balanced) {
    nevh_scene *s = read_shipped("earth-halley.nevh");
    ck_assert_int_eq(nevh_scene_enable(s, "earth", true), NEVH_OK);
    double q[2], p[2];
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    nevh_options o = {.gradient = nevh_exact,
                      .q = q,
                      .p = p,
                      .tolerance = 1e-10,
                      .balance = true};
    const nevh_system *system = nevh_scene_system(s);
    nevh_stepper *by = nevh_stepper_new(system, nevh_dop853, &o);
    nevh_energy *energy = nevh_energy_new(system, &o);
    nevh_energy_follow(energy, by);
    ck_assert_int_eq(
        nevh_run_until(by, 0, 0.2, 302, q, p,
                       &(nevh_observer){nevh_energy_observe, energy, 1}, 1),
        NEVH_OK);
    ck_assert_double_le(nevh_energy_result(energy, 0).max, 1e-7);
    nevh_energy_free(energy);
    nevh_stepper_free(by);
    nevh_scene_free(s);
}

/* k = sin(start/2), energy above the bottom over that at the top. */
TEST(separatrix_is_near) {
    nevh_scene *s = read_shipped("pendulum-separatrix.nevh");
    double q, p;
    ck_assert_int_eq(nevh_scene_start(s, &q, &p), NEVH_OK);
    ck_assert_double_eq_tol(q, 3.0521424792523257, 1e-15);
    ck_assert(p == 0);
    nevh_scene_free(s);
}

/* CPU seconds to read a chain, to plan for it, also for a scheme that asks what
   kind of T it has, and to take some steps. */
static double chain_seconds(int masses) {
    char text[40];
    clock_t start = clock();
    nevh_scene *s = read_shipped("fput-1000.nevh");
    snprintf(text, sizeof text, "N = %d", masses);
    ck_assert_int_eq(nevh_scene_set(s, text), NEVH_OK);
    size_t n = nevh_scene_dof(s);
    double *q = calloc(2 * n, sizeof *q);
    ck_assert_int_eq(nevh_scene_start(s, q, q + n), NEVH_OK);
    nevh_options o = {.gradient_step = 0.1, .q = q, .p = q + n};
    nevh_stepper *by = nevh_stepper_new(nevh_scene_system(s), nevh_verlet, &o);
    ck_assert_int_eq(nevh_run(by, 0, 0.25, 40, q, q + n, NULL, 0), NEVH_OK);
    nevh_stepper_free(by);
    by = nevh_stepper_new(nevh_scene_system(s), nevh_rkn6b, &o);
    ck_assert_int_eq(nevh_stepper_status(by), NEVH_OK);
    nevh_stepper_free(by);
    nevh_scene_free(s);
    free(q);
    return (double)(clock() - start) / CLOCKS_PER_SEC;
}

/* The best of some: other processes share the caches. */
static double least_seconds(int masses) {
    double least = INFINITY;
    for (int i = 0; i < 3; i++)
        least = fmin(least, chain_seconds(masses));
    return least;
}

TEST_TAGGED(long_chains_cost_in_proportion, "slow", 0, 1) {
    double short_one = least_seconds(10000), long_one = least_seconds(100000);
    ck_assert_msg(long_one < 20 * short_one, "%g s, but %g s of 10 times more",
                  short_one, long_one);
    ck_assert_double_lt(long_one, 30);
}

/* Numbers that the tape works out are those that were worked out before. */
TEST(exact_systems_are_those_of_the_scenes) {
    find_shipped();
    for (size_t i = 0; i < n_shipped; i++) {
        nevh_scene *s = read_shipped(shipped[i]);
        size_t n = nevh_scene_dof(s);
        double *z = calloc(6 * n, sizeof *z), *a = z + 2 * n, *b = z + 4 * n;
        double t = 0.3;
        ck_assert_int_eq(nevh_scene_start(s, z, z + n), NEVH_OK);
        const nevh_system *exact = nevh_scene_exact_system(s);
        ck_assert_msg(exact, "%s", nevh_scene_message(s));
        ck_assert_ptr_eq(nevh_scene_exact_system(s), exact);
        nevh_field *f[2] = {field_of(nevh_scene_system(s)), field_of(exact)};
        nevh_field_gradient(f[0], 1, &t, z, z + n, a, a + n);
        nevh_field_gradient(f[1], 1, &t, z, z + n, b, b + n);
        double size = size_of(a, 2 * n);
        for (size_t k = 0; k < 2 * n; k++)
            ck_assert_msg(fabs(a[k] - b[k]) <= 64 * DBL_EPSILON * size,
                          "%s, component %zu: %.17g, not %.17g", shipped[i], k,
                          b[k], a[k]);
        nevh_field_free(f[0]);
        nevh_field_free(f[1]);
        free(z);
        nevh_scene_free(s);
    }
}

/* Each has what a student needs. */
TEST(scenes_are_complete) {
    find_shipped();
    for (size_t i = 0; i < n_shipped; i++) {
        nevh_scene *s = read_shipped(shipped[i]);
        const nevh_scene_run *run = nevh_scene_run_settings(s);
        ck_assert_msg(*nevh_scene_title(s) && *nevh_scene_source(s), "%s",
                      shipped[i]);
        ck_assert_msg(run->dts && run->t_end > run->t_start, "%s", shipped[i]);
        ck_assert_msg(run->integrators >= 3, "%s", shipped[i]);
        nevh_scene_free(s);
    }
    ck_assert_uint_ge(n_shipped, 25);
}
