/* nevh tests: references by Taylor series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "shipped.h"
#include <math.h>
#include <nevh/certain.h>
#include <nevh/reference.h>

/* The states of long doubles are those of quad precision, to what the reference
   says of itself. */
TEST(references_are_as_good_as_they_say) {
    static const struct {
        const char *scene;
        double t_end;
    } runs[] = {{"henon-heiles.nevh", 100},
                {"double-pendulum.nevh", 20},
                {"elastic-pendulum.nevh", 20},
                {"kapitza.nevh", 3}};
    for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
        nevh_scene *scene = read_shipped(runs[i].scene);
        const nevh_system *system = nevh_scene_system(scene);
        size_t n = nevh_scene_dof(scene);
        double q[4], p[4], t_end = runs[i].t_end;
        ck_assert_int_eq(nevh_scene_start(scene, q, p), NEVH_OK);
        nevh_reference *r = nevh_reference_new(system, NULL, 0, t_end, q, p);
        ck_assert_msg(!nevh_reference_status(r), "%s",
                      nevh_reference_message(r));
        assert_says(nevh_reference_text(r), "taylor in");
        ck_assert(nevh_reference_error(r) < 1e-10);
        nevh_certain *c = nevh_certain_new(system, 0, q, p, 18);
        if (nevh_certain_status(c))
            assert_says(nevh_certain_message(c), "libquadmath");
        for (double t = t_end / 3; t <= t_end; t += t_end / 3) {
            ck_assert_int_eq(nevh_reference_state(r, t, q, p), NEVH_OK);
            if (nevh_certain_go(c, t))
                continue;
            for (size_t k = 0; k < 2 * n; k++) {
                double value = k < n ? q[k] : p[k - n];
                double by = fabs(value - nevh_certain_value(c, k));
                double rounded = fabs(value) * 0x1p-52;
                ck_assert_msg(by <= nevh_reference_error(r) *
                                            nevh_reference_range(r, k) +
                                        rounded,
                              "%s, %zu at %g: %g", runs[i].scene, k, t, by);
            }
        }
        nevh_certain_free(c);
        nevh_reference_free(r);
        nevh_scene_free(scene);
    }
}

/* As nevh compare makes it, over a part of the scene's own run. */
static nevh_reference *whole_reference(nevh_scene *scene, double part) {
    const nevh_scene_run *run = nevh_scene_run_settings(scene);
    size_t n = nevh_scene_dof(scene);
    double *q = calloc(2 * n, sizeof *q), shortest = run->dt[0];
    size_t *kind = calloc(n, sizeof *kind);
    ck_assert_int_eq(nevh_scene_start(scene, q, q + n), NEVH_OK);
    for (size_t k = 0; k < n; k++)
        kind[k] = nevh_scene_array(scene, k);
    for (size_t i = 1; i < run->dts; i++)
        shortest = fmin(shortest, run->dt[i]);
    nevh_reference_options o = {.kind = kind, .longest = 4 * shortest};
    double end = run->t_start + part * (run->t_end - run->t_start);
    nevh_reference *r = nevh_reference_with(nevh_scene_system(scene), &o,
                                            run->t_start, end, q, q + n);
    ck_assert_msg(!nevh_reference_status(r), "%s", nevh_reference_message(r));
    free(kind);
    free(q);
    return r;
}

static bool has_pairs(void) {
    nevh_scene *scene = read_shipped("kepler.nevh");
    double q[2], p[2];
    ck_assert_int_eq(nevh_scene_start(scene, q, p), NEVH_OK);
    nevh_certain *c = nevh_certain_new(nevh_scene_system(scene), 0, q, p, 20);
    bool has = !nevh_certain_status(c);
    nevh_certain_free(c);
    nevh_scene_free(scene);
    return has;
}

/* The differences to quad precision, in ranges, at some times. */
static double true_error(nevh_scene *scene, nevh_reference *r, double end) {
    enum { TIMES = 3 };
    size_t n = nevh_scene_dof(scene);
    double start = nevh_scene_run_settings(scene)->t_start, most = 0;
    double *q = calloc(2 * n, sizeof *q);
    ck_assert_int_eq(nevh_scene_start(scene, q, q + n), NEVH_OK);
    int digits = isfinite(nevh_reference_horizon(r)) ? 30 : 22;
    nevh_certain *c =
        nevh_certain_new(nevh_scene_system(scene), start, q, q + n, digits);
    for (int i = 1; i <= TIMES; i++) {
        double t = start + (end - start) * i / TIMES;
        ck_assert_int_eq(nevh_certain_go(c, t), NEVH_OK);
        ck_assert_int_eq(nevh_reference_state(r, t, q, q + n), NEVH_OK);
        for (size_t k = 0; k < 2 * n; k++) {
            double by = fabs(q[k] - nevh_certain_value(c, k));
            /* Both are rounded. */
            by -= fabs(q[k]) * 0x1p-52 + nevh_certain_error(c, k);
            most = fmax(most, by / nevh_reference_range(r, k));
        }
    }
    nevh_certain_free(c);
    free(q);
    return most;
}

/* Of its own run, or of a part; where chaos ends it, until then. */
static void assert_certified(const char *name, double part) {
    nevh_scene *scene = read_shipped(name);
    nevh_reference *r = whole_reference(scene, part);
    const nevh_scene_run *run = nevh_scene_run_settings(scene);
    double end = run->t_start + part * (run->t_end - run->t_start);
    double error = nevh_reference_error(r);
    ck_assert_msg(error <= 1e-15, "%s: %s", name, nevh_reference_text(r));
    end = fmin(end, nevh_reference_horizon(r));
    double is = true_error(scene, r, end);
    ck_assert_msg(is <= error, "%s: %g, not %g", name, is, error);
    nevh_reference_free(r);
    nevh_scene_free(scene);
}

/* Each was above 1e-15 in long doubles. */
static const struct {
    const char *scene;
    double part; /* that takes no second in quad precision */
} certified[] = {{"double-pendulum-as-printed.nevh", 1},
                 {"sun-earth-moon.nevh", 0.25},
                 {"figure-eight.nevh", 0.2},
                 {"kapitza.nevh", 0.2},
                 {"henon-heiles-chaotic.nevh", 1},
                 {"fput-1000.nevh", 0.03}};
enum { CERTIFIED = sizeof certified / sizeof *certified };

TEST_EACH(references_are_certified, CERTIFIED) {
    if (!has_pairs())
        skip_test("no libquadmath");
    assert_certified(certified[_i].scene, certified[_i].part);
}

/* All that have a series and take one. */
TEST_TAGGED(shipped_references_are_certified, "slow", 0, find_shipped()) {
    if (!has_pairs())
        skip_test("no libquadmath");
    nevh_scene *scene = read_shipped(shipped[_i]);
    nevh_reference *r = whole_reference(scene, 1);
    bool exact = strncmp(nevh_reference_text(r), "exact", 5) == 0;
    nevh_reference_free(r);
    nevh_scene_free(scene);
    if (exact)
        skip_test("an exact solution");
    assert_certified(shipped[_i], 1);
}

/* Too many coefficients to be kept are taken again: the states are the same, in
   any order of times. */
TEST(states_do_not_depend_on_what_is_kept) {
    nevh_scene *scene = read_shipped("fput-1000.nevh");
    nevh_reference *few = whole_reference(scene, 0.1);
    nevh_reference *many = whole_reference(scene, 0.5);
    enum { DOF = 1000 };
    static double a[2 * DOF], b[2 * DOF];
    static const double times[] = {9.7, 0.3, 4.2, 4.3, 0};
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        double t = times[i];
        ck_assert_int_eq(nevh_reference_state(few, t, a, a + DOF), NEVH_OK);
        ck_assert_int_eq(nevh_reference_state(many, t, b, b + DOF), NEVH_OK);
        for (size_t k = 0; k < 2 * DOF; k++)
            ck_assert_double_eq_tol(a[k], b[k], 3e-16);
    }
    nevh_reference_free(few);
    nevh_reference_free(many);
    nevh_scene_free(scene);
}

/* What series would cost is said of what takes their place. */
TEST_TAGGED(costly_references_say_so, "slow", 0, 1) {
    if (!has_pairs())
        skip_test("no libquadmath");
    nevh_scene *scene = read_shipped("sun-earth-moon.nevh");
    nevh_reference *r = whole_reference(scene, 13);
    ck_assert_double_gt(nevh_reference_error(r), 1e-15);
    assert_says(nevh_reference_text(r), "gauss12 at dt");
    assert_says(nevh_reference_text(r), "Taylor series cost too much");
    nevh_reference_free(r);
    nevh_scene_free(scene);
}
