/* nevh tests: fast effects in substeps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <stdio.h>

enum { N = 2, WIDTH = 3 };
typedef struct {
    double q[N], p[N];
} state;
static const state start = {{0.9, 0.5}, {0.3, -0.2}};

/* A bond, whose motion is not known, in a well. */
static nevh_scene *new_scene(const char *parts) {
    char text[400];
    snprintf(text, sizeof text,
             "[effects]\nkinetic = p_x^2/2 + p_y^2/3\n"
             "bond = 20*(hypot(x, y) - 1)^2\n"
             "well = 0.3*x^4 + 0.2*x^2*y + 0.5*y^4*(1 + 0.3*cos(t))\n%s"
             "[run]\nt_end = 1\n",
             parts);
    return scene_with("x = 0.9, 0.3\ny = 0.5, -0.2\n", text);
}
static const char fast[] = "[parts]\nfast = kinetic, bond\n";

static nevh_stepper *stepper_of(nevh_scene *s, const nevh_integrator *scheme,
                                size_t substeps, const nevh_gradient *gradient,
                                size_t width) {
    nevh_options o = {
        .gradient = gradient, .width = width, .substeps = substeps};
    nevh_stepper *stepper = nevh_stepper_new(nevh_scene_system(s), scheme, &o);
    ck_assert_str_eq(nevh_stepper_message(stepper), "");
    return stepper;
}

static state orbit_of(const nevh_integrator *scheme, size_t substeps, double h,
                      size_t steps) {
    state x = start;
    nevh_scene *s = new_scene(fast);
    nevh_stepper *stepper = stepper_of(s, scheme, substeps, nevh_exact, 1);
    ck_assert(!nevh_run(stepper, 0, h, steps, x.q, x.p, NULL, 0));
    nevh_stepper_free(stepper);
    nevh_scene_free(s);
    return x;
}

static double distance(const state *a, const state *b) {
    return hypot(hypot(a->q[0] - b->q[0], a->q[1] - b->q[1]),
                 hypot(a->p[0] - b->p[0], a->p[1] - b->p[1]));
}

/* -h dV/dq of the slow part. */
static void kick(nevh_field *slow, double t, double h, state *x) {
    double slope[N];
    ck_assert(!nevh_field_gradient(slow, 1, &t, x->q, x->p, slope, NULL));
    for (int k = 0; k < N; k++)
        x->p[k] -= h * slope[k];
}

/* A step is half a kick, steps of Verlet's, and half a kick. */
TEST_EACH(a_step_is_its_parts, 4) {
    static const size_t substeps[] = {1, 2, 5, 0};
    size_t n = substeps[_i] ? substeps[_i] : 8;
    double h = 0.1, t = 0;
    state x = start, y = orbit_of(nevh_respa, substeps[_i], h, 10);
    nevh_scene *all = new_scene(""), *others = new_scene("");
    nevh_scene_enable(all, "well", false);
    nevh_scene_enable(others, "bond", false);
    nevh_stepper *inner = stepper_of(all, nevh_verlet, 0, nevh_exact, 1);
    nevh_options o = {.gradient = nevh_exact};
    nevh_field *slow = nevh_field_new(nevh_scene_system(others), &o);
    for (int i = 0; i < 10; i++, t = i * h) {
        kick(slow, t, h / 2, &x);
        nevh_run(inner, t, h / (double)n, n, x.q, x.p, NULL, 0);
        kick(slow, t + h, h / 2, &x);
    }
    ck_assert_double_lt(distance(&x, &y), 1e-14);
    nevh_stepper_free(inner);
    nevh_field_free(slow);
    nevh_scene_free(all);
    nevh_scene_free(others);
}

TEST_EACH(order, 3) {
    size_t substeps = (size_t)1 << (2 * _i);
    double error[2];
    state exact = orbit_of(nevh_gauss20, 0, 1.0 / 64, 64);
    for (int i = 0; i < 2; i++) {
        int steps = 64 << i;
        state x = orbit_of(nevh_respa, substeps, 1.0 / steps, (size_t)steps);
        error[i] = distance(&x, &exact);
    }
    ck_assert_double_eq_tol(log2(error[0] / error[1]), 2, 0.05);
}

/* The slow part is evaluated once a step, the fast one once a substep. */
TEST(evaluations) {
    enum { STEPS = 50, SUBSTEPS = 4 };
    state x = start;
    nevh_scene *s = new_scene(fast);
    nevh_stepper *m = stepper_of(s, nevh_respa, SUBSTEPS, nevh_central2, 1);
    nevh_field *f = nevh_stepper_field(m);
    uint64_t values[2][2];
    for (int i = 0; i < 2; i++) {
        nevh_run(m, i * 0.02, 0.02, i ? STEPS : 1, x.q, x.p, NULL, 0);
        values[i][0] = nevh_field_effect_values(f, "bond");
        values[i][1] = nevh_field_effect_values(f, "well");
    }
    ck_assert_uint_eq(values[0][0] % (SUBSTEPS + 1), 0);
    ck_assert_uint_eq(values[0][1] % 2, 0);
    ck_assert_uint_eq(values[1][0] - values[0][0],
                      values[0][0] / (SUBSTEPS + 1) * SUBSTEPS * STEPS);
    ck_assert_uint_eq(values[1][1] - values[0][1], values[0][1] / 2 * STEPS);
    nevh_stepper_free(m);
    nevh_scene_free(s);
}

TEST(symplectic_and_reversible) {
    const double scale[2 * N] = {1, 1, 1, 1};
    double defect;
    nevh_scene *s = new_scene(fast);
    nevh_stepper *m = stepper_of(s, nevh_respa, 6, nevh_exact, 1);
    ck_assert(!nevh_symplecticity_defect(m, 0, 0.2, start.q, start.p, scale,
                                         &defect));
    ck_assert_double_lt(defect, 1e-9);
    ck_assert(!nevh_reversal_defect(m, 0, 0.2, 100, start.q, start.p, scale,
                                    &defect));
    ck_assert_double_lt(defect, 1e-12);
    nevh_stepper_free(m);
    nevh_scene_free(s);
}

/* Each lane is the orbit that it is alone, also where one starts afresh. */
TEST(lanes) {
    double q[N * WIDTH], p[N * WIDTH], h = 0.07;
    nevh_scene *s = new_scene(fast);
    nevh_stepper *all = stepper_of(s, nevh_respa, 3, nevh_exact, WIDTH);
    for (size_t i = 0; i < N * WIDTH; i++) {
        q[i] = start.q[i / WIDTH] + 0.1 * (double)(i % WIDTH);
        p[i] = start.p[i / WIDTH];
    }
    nevh_run(all, 0, h, 5, q, p, NULL, 0);
    q[1] += 0.1;
    nevh_run(all, 5 * h, h, 5, q, p, NULL, 0);
    for (size_t lane = 0; lane < WIDTH; lane++) {
        nevh_stepper *one = stepper_of(s, nevh_respa, 3, nevh_exact, 1);
        state x = start;
        x.q[0] += 0.1 * (double)lane;
        x.q[1] += 0.1 * (double)lane;
        nevh_run(one, 0, h, 5, x.q, x.p, NULL, 0);
        x.q[0] += lane == 1 ? 0.1 : 0;
        nevh_run(one, 5 * h, h, 5, x.q, x.p, NULL, 0);
        for (size_t k = 0; k < N; k++) {
            ck_assert(q[k * WIDTH + lane] == x.q[k]);
            ck_assert(p[k * WIDTH + lane] == x.p[k]);
        }
        nevh_stepper_free(one);
    }
    nevh_stepper_free(all);
    nevh_scene_free(s);
}

/* Charges on a chain of stiff bonds, whose period is at least pi/20.  Returns the
   largest error of the energy over so many parts of it a step. */
static double chain_error(double part) {
    enum { BEADS = 8, STEPS = 4000 };
    nevh_scene *s = scene_with(
        "x[i = 1..8] = 1.02*i\ny[i = 1..8] = 0.3*sin(i)\n",
        "[effects]\nkinetic = sum(i = 1..8, (p_x[i]^2 + p_y[i]^2)/2)\n"
        "bonds = sum(i = 1..7, "
        "200*(hypot(x[i+1] - x[i], y[i+1] - y[i]) - 1)^2)\n"
        "charges = sum(i = 1..8, j = i+1..8, 4/hypot(x[i] - x[j], y[i] - "
        "y[j]))\n[parts]\nfast = kinetic, bonds\n[run]\nt_end = 1\n");
    double q[2 * BEADS], p[2 * BEADS];
    nevh_scene_start(s, q, p);
    nevh_stepper *m = stepper_of(s, nevh_respa, 16, nevh_exact, 1);
    nevh_energy *energy = nevh_energy_new(nevh_scene_system(s), NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    double h = part * acos(-1) / 20;
    int status = nevh_run(m, 0, h, STEPS, q, p, &watch, 1);
    double most = status ? INFINITY : nevh_energy_result(energy, 0).max;
    nevh_energy_free(energy);
    nevh_stepper_free(m);
    nevh_scene_free(s);
    return most;
}

/* Energies are bounded while steps are well below half a period of the bonds; near
   it, kicks are in step with them. */
TEST(resonance) {
    double below = chain_error(0.2), near = chain_error(0.51);
    ck_assert_msg(below < 0.05 && near > 10 * below, "%g, %g", below, near);
}

TEST_EACH(refusals, 3) {
    static const struct {
        const char *parts, *words;
        size_t substeps;
    } wrong[] = {
        {"[parts]\nfast = kinetic, well\n",
         "\"well\" is to be fast and reads the time", 8},
        {"[parts]\nslow = kinetic\n",
         "\"kinetic\" is to be slow and reads momenta", 8},
        {fast, "10001 substeps, where at most 10000 are possible", 10001},
    };
    nevh_scene *s = new_scene(wrong[_i].parts);
    nevh_options o = {.substeps = wrong[_i].substeps};
    nevh_stepper *m = nevh_stepper_new(nevh_scene_system(s), nevh_respa, &o);
    assert_says(nevh_stepper_message(m), wrong[_i].words);
    nevh_stepper_free(m);
    nevh_scene_free(s);
}

TEST(names) {
    ck_assert_uint_eq(nevh_substeps_named("respa+16"), 16);
    ck_assert_uint_eq(nevh_substeps_named("respa+transform"), 0);
    ck_assert_uint_eq(nevh_substeps_named("respa+16x"), 0);
    ck_assert_uint_eq(nevh_substeps_named("gauss+16"), 0);
    ck_assert_uint_eq(nevh_substeps_named("respa+"), 0);
    ck_assert_uint_eq(nevh_substeps_named("respa"), 0);
    ck_assert_uint_eq(nevh_substeps_named(NULL), 0);
}
