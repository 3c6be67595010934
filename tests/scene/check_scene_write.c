/* nevh tests: what is written is the scene.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene.h"
#include "shipped.h"

static nevh_scene *scene_of(const char *text) {
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(!nevh_scene_status(s), "%s", nevh_scene_message(s));
    return s;
}

static nevh_scene *written(const nevh_scene *s) {
    char *text = nevh_scene_write(s, NULL);
    ck_assert_ptr_nonnull(text);
    nevh_scene *copy = scene_of(text);
    free(text);
    return copy;
}

/* Twenty steps of the midpoint rule; *status says how it went. */
static double *orbit(nevh_scene *s, int *status) {
    size_t n = nevh_scene_dof(s);
    double *q = malloc(2 * n * sizeof *q), dt = 0.01;
    const nevh_scene_run *run = nevh_scene_run_settings(s);
    *status = nevh_scene_start(s, q, q + n);
    nevh_options o = {.gradient = nevh_exact, .q = q, .p = q + n};
    nevh_stepper *by =
        nevh_stepper_new(nevh_scene_system(s), nevh_midpoint, &o);
    *status |= nevh_run(by, run->t_start, run->dts ? run->dt[0] : dt, 20, q,
                        q + n, NULL, 0);
    nevh_stepper_free(by);
    return q;
}

static void assert_same_effects(nevh_scene *a, nevh_scene *b) {
    const nevh_system *x = nevh_scene_system(a), *y = nevh_scene_system(b);
    ck_assert_uint_eq(nevh_system_effect_count(x), nevh_system_effect_count(y));
    for (size_t i = 0; i < nevh_system_effect_count(x); i++) {
        const char *name = nevh_system_effect_name(x, i);
        ck_assert_str_eq(name, nevh_system_effect_name(y, i));
        ck_assert_msg(nevh_system_effect_on(x, name) ==
                          nevh_system_effect_on(y, name),
                      "%s", name);
    }
}

static bool same_number(double a, double b) {
    return a == b || (a != a && b != b);
}

static void assert_same_run(nevh_scene *a, nevh_scene *b) {
    const nevh_scene_run *x = nevh_scene_run_settings(a),
                         *y = nevh_scene_run_settings(b);
    ck_assert(x->t_start == y->t_start && same_number(x->t_end, y->t_end));
    ck_assert(x->dts == y->dts && x->integrators == y->integrators &&
              x->gradients == y->gradients && x->tolerances == y->tolerances);
    for (size_t i = 0; i < x->dts; i++)
        ck_assert(x->dt[i] == y->dt[i]);
    for (size_t i = 0; i < x->integrators; i++)
        ck_assert_str_eq(x->integrator[i], y->integrator[i]);
    ck_assert(x->gradient_step == y->gradient_step &&
              x->energy_scale == y->energy_scale &&
              x->match_work == y->match_work);
}

static void assert_same(nevh_scene *a, nevh_scene *b) {
    int status[2];
    assert_same_effects(a, b);
    assert_same_run(a, b);
    double *x = orbit(a, &status[0]), *y = orbit(b, &status[1]);
    ck_assert_int_eq(status[0], status[1]);
    ck_assert_uint_eq(nevh_scene_dof(a), nevh_scene_dof(b));
    ck_assert(!memcmp(x, y, 2 * nevh_scene_dof(a) * sizeof *x));
    free(x);
    free(y);
}

static void assert_round_trip(nevh_scene *s) {
    nevh_scene *copy = written(s);
    char *once = nevh_scene_write(s, NULL),
         *twice = nevh_scene_write(copy, NULL);
    assert_same(s, copy);
    ck_assert_str_eq(once, twice);
    free(once);
    free(twice);
    nevh_scene_free(copy);
}

/* Every scene that ships: as it is, and with each effect switched. */
TEST_EACH(shipped_scenes, find_shipped()) {
    nevh_scene *s = read_shipped(shipped[_i]);
    assert_round_trip(s);
    const nevh_system *system = nevh_scene_system(s);
    for (size_t i = 0; i < nevh_system_effect_count(system); i++) {
        const char *name = nevh_system_effect_name(system, i);
        bool on = nevh_system_effect_on(system, name);
        nevh_scene_enable(s, name, !on);
        assert_round_trip(s);
        nevh_scene_enable(s, name, on);
    }
    nevh_scene_free(s);
}

static void set(nevh_scene *s, const char *assignment) {
    ck_assert_msg(!nevh_scene_set(s, assignment), "%s", nevh_scene_message(s));
}

static void assert_written(const nevh_scene *s, const char *line, bool there) {
    char *text = nevh_scene_write(s, NULL);
    ck_assert_msg(!strstr(text, line) != there, "%s\nin\n%s", line, text);
    free(text);
}

TEST(changes_stay) {
    nevh_scene *s = scene_of(shaken_pendulum);
    assert_written(s, "g = 9.8      # m/s^2\n", true);
    set(s, "g = 1.5");
    set(s, "g = 3.7 + m/10  # Mars");
    set(s, "w=0.1+0.2");
    nevh_scene_enable(s, "shaking", true);
    nevh_scene_enable(s, "kinetic", true);
    assert_written(s, "g = 3.7 + m/10      # m/s^2\n", true);
    assert_written(s, "w = 0.1+0.2       # rad/s\n", true);
    assert_written(
        s,
        "\neffects = kinetic, gravity, shaking   # which are on; omitted: all",
        true);
    assert_written(s, "Mars", false);
    assert_round_trip(s);
    nevh_scene_free(s);
}

/* What failed to be set is not written. */
TEST(failures_leave_no_trace) {
    nevh_scene *s = scene_of(shaken_pendulum);
    char *before = nevh_scene_write(s, NULL);
    ck_assert(nevh_scene_set(s, "g = 1/0"));
    ck_assert(nevh_scene_set(s, "gg = 1"));
    ck_assert(nevh_scene_set(s, "g = 1\n+ 2"));
    ck_assert(nevh_scene_enable(s, "wind", true));
    char *after = nevh_scene_write(s, NULL);
    ck_assert_str_eq(before, after);
    free(before);
    free(after);
    nevh_scene_free(s);
    s = nevh_scene_parse("test", "[effects]\n");
    ck_assert_ptr_null(nevh_scene_write(s, NULL));
    nevh_scene_free(s);
}

static const char chain[] = "[parameters]\nN = 3\n"
                            "c[i = 1..N] = i # by index\n"
                            "m[ j=1..N ]=2*j\n"
                            "[coordinates]\nx[i = 1..N] = c[i]/m[i]\n"
                            "[effects]\nT = sum(i = 1..N, p_x[i]^2/m[i])\n"
                            "V = sum(i = 1..N, c[i]*x[i]^2)";

TEST(arrays_are_lists_then) {
    nevh_scene *s = scene_of(chain);
    set(s, "c = 1/3, 2, 7");
    set(s, "m = 5");
    assert_written(s, "c[1..N] = 1/3, 2, 7 # by index\n", true);
    assert_written(s, "m[1..N ]=5\n", true);
    assert_round_trip(s);
    set(s, "m = 3");
    set(s, "c = 0.1");
    set(s, "N = 5");
    assert_round_trip(s);
    nevh_scene_free(s);
}

/* A scene without [scene], and with one but without effects; none on. */
TEST(choices_are_added) {
    nevh_scene *s = scene_of(chain);
    nevh_scene_enable(s, "V", false);
    assert_written(s, "[scene]\neffects = T\n\n[parameters]\n", true);
    assert_round_trip(s);
    nevh_scene_enable(s, "T", false);
    assert_written(s, "effects = none\n", true);
    assert_round_trip(s);
    nevh_scene_enable(s, "T", true);
    nevh_scene_enable(s, "V", true);
    assert_written(s, "effects", true);
    assert_written(s, "[scene]", false);
    nevh_scene_free(s);
    s = scene_of("\xEF\xBB\xBF[scene]\r\ntitle = T # x\r\n# end\r\n"
                 "[coordinates]\r\nx = 1\r\n[effects]\r\nA = x\r\nB = p_x^2");
    nevh_scene_enable(s, "A", false);
    assert_written(s, "[scene]\ntitle = T # x\neffects = B\n# end\n", true);
    assert_round_trip(s);
    nevh_scene_free(s);
}

/* However many of them end a line, or the text. */
TEST(carriages_do_not_count) {
    nevh_scene *s = scene_of("[coordinates]\r\r\nx = 1\r\r\r\n"
                             "[effects]\r\nA = x^2 + p_x^2\r\r\r");
    char *text = nevh_scene_write(s, NULL);
    nevh_scene *copy = scene_of(text);
    char *again = nevh_scene_write(copy, NULL);
    ck_assert_str_eq(text, again);
    ck_assert_ptr_null(strchr(text, '\r'));
    free(text);
    free(again);
    nevh_scene_free(copy);
    nevh_scene_free(s);
}
