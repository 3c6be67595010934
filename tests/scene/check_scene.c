/* nevh tests: what scenes mean.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene.h"
#include "support.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static nevh_scene *scene_of(const char *text) {
    nevh_scene *s = nevh_scene_parse("test", text);
    ck_assert_msg(nevh_scene_status(s) == NEVH_OK, "%s", nevh_scene_message(s));
    return s;
}

static double value_of(const nevh_system *system, double t, const double q[],
                       const double p[]) {
    double h = NAN;
    nevh_options options = {.gradient = nevh_exact, .t = t, .q = q, .p = p};
    nevh_field *field = nevh_field_new(system, &options);
    int status = nevh_field_value(field, 1, &t, q, p, &h);
    ck_assert_msg(!status, "%s", nevh_field_message(field));
    nevh_field_free(field);
    return h;
}

static double energy(nevh_scene *s, double t, const double q[],
                     const double p[]) {
    return value_of(nevh_scene_system(s), t, q, p);
}

static void assert_close(double a, double b) {
    ck_assert_msg(fabs(a - b) <= 1e-14 * (1 + fabs(b)), "%.17g, not %.17g", a,
                  b);
}

TEST(double_pendulum_has_its_energies) {
    nevh_scene *s = scene_of(shaken_pendulum);
    const nevh_model *model = nevh_double_pendulum_model;
    ck_assert_uint_eq(nevh_scene_dof(s), 2);
    for (int i = 0; i < 20; i++) {
        double q[] = {sin(i), 2 * cos(3 * i)}, p[] = {cos(i), 0.3 * i};
        assert_close(energy(s, 0.1 * i, q, p),
                     model->hamiltonian(0, q, p, model->defaults));
    }
    double q[2], p[2];
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    ck_assert(q[0] == PI / 2 && q[1] == 0 && p[0] == 0 && p[1] == 0);
    nevh_scene_free(s);
}

TEST(texts_and_names) {
    nevh_scene *s = scene_of(shaken_pendulum);
    ck_assert_str_eq(nevh_scene_title(s), "Double pendulum on a shaken pivot");
    ck_assert_str_eq(nevh_scene_source(s),
                     "Amoreira & Amoreira, Numerical Evolution");
    ck_assert_str_eq(nevh_scene_coordinate(s, 1), "phi2");
    ck_assert_ptr_null(nevh_scene_coordinate(s, 2));
    ck_assert_str_eq(nevh_scene_label(s, "energy"), "J");
    ck_assert_str_eq(nevh_scene_label(s, "phi1"), "rad");
    ck_assert_str_eq(nevh_scene_label(s, "phi2"), "");
    nevh_scene_free(s);
}

TEST(run_settings) {
    nevh_scene *s = scene_of(shaken_pendulum);
    const nevh_scene_run *run = nevh_scene_run_settings(s);
    ck_assert(run->t_start == 0 && fabs(run->t_end - 10 * PI) < 1e-13);
    ck_assert_uint_eq(run->dts, 2);
    ck_assert(run->dt[0] == 0.02 && run->dt[1] == 0.01);
    ck_assert_uint_eq(run->integrators, 5);
    ck_assert_str_eq(run->integrator[4], "gauss4+transform");
    ck_assert_uint_eq(run->gradients, 2);
    ck_assert_str_eq(run->gradient[1], "exact");
    ck_assert_str_eq(run->reference, "gauss12");
    ck_assert_uint_eq(run->tolerances, 3);
    ck_assert(run->tolerance[2] == 1e-12 && run->match_work);
    ck_assert(run->gradient_step == 0 && run->energy_scale == 0);
    double q[] = {1, 0.5}, p[] = {0, 0};
    assert_close(value_of(nevh_scene_transform(s), 0, q, p),
                 1 + sin(0.5) * sin(0.5));
    nevh_scene_free(s);
}

/* Of coordinates, then of momenta; 0 where it is to be found out. */
TEST(gradient_steps_by_name) {
    nevh_scene *s = scene_of(
        "[parameters]\nm[1..3] = 1, 2, 4\n"
        "[coordinates]\ny = 1\nx[1..3] = 1\n"
        "[effects]\nH = p_y^2 + sum(i = 1..3, p_x[i]^2 + x[i]^2*y^2)\n"
        "[run]\ngradient_step = x[2..3]: 1/4, p_x[i = 2..3]: m[i]/8, p_x[1]: 1/8, "
        "p_y: 0.5\n");
    const nevh_scene_run *run = nevh_scene_run_settings(s);
    const double steps[] = {0, 0, 0.25, 0.25, 0.5, 0.125, 0.25, 0.5};
    ck_assert(run->gradient_step == 0 && run->gradient_steps);
    for (int k = 0; k < 8; k++)
        ck_assert_msg(run->gradient_steps[k] == steps[k], "%d: %g", k,
                      run->gradient_steps[k]);
    nevh_scene_free(s);
    s = scene_of(shaken_pendulum);
    ck_assert_ptr_null(nevh_scene_run_settings(s)->gradient_steps);
    nevh_scene_free(s);
}

static const char small[] = "[coordinates]\nx = 1\n[effects]\nH = p_x^2/2\n";

TEST(run_defaults) {
    nevh_scene *s = scene_of(small);
    const nevh_scene_run *run = nevh_scene_run_settings(s);
    ck_assert(run->t_start == 0 && isnan(run->t_end) && run->dts == 0);
    ck_assert(run->integrators == 0 && run->gradients == 1);
    ck_assert_str_eq(run->gradient[0], "central4");
    ck_assert(!run->reference && !run->transform && !run->match_work);
    ck_assert_ptr_null(nevh_scene_transform(s));
    ck_assert_str_eq(nevh_scene_title(s), "");
    nevh_scene_free(s);
}

/* shaking adds m l A w^2 cos(w t)(2 cos q1 + cos q2). */
TEST(effects_are_switched) {
    nevh_scene *s = scene_of(shaken_pendulum);
    double q[] = {0.3, -0.7}, p[] = {0.2, 0.5}, t = 0.11, rates[2];
    double without = energy(s, t, q, p);
    const nevh_system *system = nevh_scene_system(s);
    ck_assert(nevh_system_traits(system) & NEVH_AUTONOMOUS);
    ck_assert(!nevh_system_effect_on(system, "shaking"));
    ck_assert(!nevh_system_friction(system, rates));
    ck_assert_int_eq(nevh_scene_enable(s, "shaking", true), NEVH_OK);
    ck_assert_int_eq(nevh_scene_enable(s, "drag", true), NEVH_OK);
    assert_close(energy(s, t, q, p) - without,
                 40 * cos(20 * t) * (2 * cos(q[0]) + cos(q[1])));
    system = nevh_scene_system(s);
    ck_assert(!(nevh_system_traits(system) & NEVH_AUTONOMOUS));
    ck_assert(nevh_system_friction(system, rates));
    ck_assert(rates[0] == 0.05 && rates[1] == 0.05);
    ck_assert_int_eq(nevh_scene_enable(s, "gravity", false), NEVH_OK);
    ck_assert_int_eq(nevh_scene_set(s, "g = 1e9"), NEVH_OK);
    assert_close(energy(s, t, q, p),
                 without + 9.8 * (2 * cos(q[0]) + cos(q[1])) +
                     40 * cos(20 * t) * (2 * cos(q[0]) + cos(q[1])));
    ck_assert_int_eq(nevh_scene_enable(s, "gravty", true), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_scene_message(s), "mean gravity?"));
    nevh_scene_free(s);
}

TEST(parameters_are_set) {
    nevh_scene *s = scene_of("[parameters]\na = 2\nb = a^2\nN = 2\n"
                             "c[i = 1..N] = b*i\n"
                             "[coordinates]\nx[1..N] = a\n"
                             "[effects]\nV = sum(i = 1..N, c[i]*x[i]^2)\n"
                             "[run]\nt_end = b\n");
    double q[3], p[3];
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    assert_close(energy(s, 0, q, p), 4 * 4 + 8 * 4);
    ck_assert_int_eq(nevh_scene_set(s, "a=1+2"), NEVH_OK);
    ck_assert_int_eq(nevh_scene_set(s, "N=3"), NEVH_OK);
    ck_assert_uint_eq(nevh_scene_dof(s), 3);
    ck_assert_str_eq(nevh_scene_coordinate(s, 2), "x[3]");
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    assert_close(energy(s, 0, q, p), 9 * 9 * (1 + 2 + 3));
    ck_assert(nevh_scene_run_settings(s)->t_end == 9);
    ck_assert_int_eq(nevh_scene_set(s, "c = 1, 0.5"), NEVH_EINVAL);
    ck_assert_int_eq(nevh_scene_set(s, "a = 3/0"), NEVH_EDOM);
    ck_assert_int_eq(nevh_scene_set(s, "bb = 3"), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_scene_message(s), "did you mean b?"));
    ck_assert_ptr_nonnull(strstr(nevh_scene_message(s), "assignment:1:1:"));
    assert_close(energy(s, 0, q, p), 9 * 9 * (1 + 2 + 3));
    ck_assert_int_eq(nevh_scene_set(s, "b = 1"), NEVH_OK);
    assert_close(energy(s, 0, q, p), 9 * (1 + 2 + 3));
    nevh_scene_free(s);
}

static const char chain[] =
    "[parameters]\nN = 32\nalpha = 0.25\nm[i = 1..N] = 1 + i/N\n"
    "[coordinates]\nx[i = 1..N] = sin(pi*i/(N + 1))\np_x[1..N] = 0.5\n"
    "[effects]\n"
    "kinetic = sum(i = 1..N, p_x[i]^2/(2*m[i]))\n"
    "springs = x[1]^2/2 + sum(i = 1..N-1, (x[i+1] - x[i])^2/2) + x[N]^2/2\n"
    "cubic   = alpha/3*sum(i = 1..N-1, (x[i+1] - x[i])^3)\n"
    "[friction]\ndrag = x[1]: 0.5, x[2..N-1]: 0, x[i = N..N]: i/100\n"
    "[labels]\nx = mm\n";

static double chain_energy(const double q[], const double p[]) {
    double h = q[0] * q[0] / 2 + q[31] * q[31] / 2;
    for (int i = 0; i < 32; i++)
        h += p[i] * p[i] / (2 * (1 + (i + 1) / 32.));
    for (int i = 0; i < 31; i++) {
        double d = q[i + 1] - q[i];
        h += d * d / 2 + 0.25 / 3 * d * d * d;
    }
    return h;
}

/* Reading is linear in the text. */
TEST(long_lists) {
    enum { COUNT = 40000 };
    static char text[COUNT * 8 + 200];
    char *to = text + sprintf(text, "[coordinates]\nx[1..%d] = 0", COUNT);
    for (int i = 1; i < COUNT; i++)
        to += sprintf(to, ", %d", i);
    sprintf(to, "\n[effects]\nV = sum(i = 1..%d, x[i])\n", COUNT);
    static double q[COUNT], p[COUNT];
    nevh_scene *s = scene_of(text);
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    for (int i = 0; i < COUNT; i++)
        ck_assert(q[i] == i && p[i] == 0);
    nevh_scene_free(s);
}

TEST(arrays) {
    nevh_scene *s = scene_of(chain);
    double q[32], p[32], rates[32];
    ck_assert_uint_eq(nevh_scene_dof(s), 32);
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    for (int i = 0; i < 32; i++) {
        assert_close(q[i], sin(PI * (i + 1) / 33));
        ck_assert(p[i] == 0.5);
    }
    assert_close(energy(s, 0, q, p), chain_energy(q, p));
    ck_assert(nevh_system_friction(nevh_scene_system(s), rates));
    ck_assert(rates[0] == 0.5 && rates[1] == 0 && rates[30] == 0 &&
              rates[31] == 0.32);
    ck_assert_str_eq(nevh_scene_coordinate(s, 31), "x[32]");
    ck_assert_str_eq(nevh_scene_label(s, "x[32]"), "mm");
    ck_assert(nevh_system_traits(nevh_scene_system(s)) & NEVH_SEPARABLE);
    nevh_scene_free(s);
}

static void start_at(nevh_scene *s, const char *assignment) {
    ck_assert_msg(!nevh_scene_set_start(s, assignment), "%s: %s", assignment,
                  nevh_scene_message(s));
}

/* A start from outside is that of the scene in which the line stands. */
TEST(starts_from_outside) {
    nevh_scene *s = scene_of(chain);
    double q[32], p[32];
    start_at(s, "x = 0");
    start_at(s, "x[i = 2..4] = i/2");
    start_at(s, "p_x[1..2] = 3, 4");
    start_at(s, "x[32] = 7");
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    for (int i = 0; i < 32; i++) {
        double x = i >= 1 && i <= 3 ? (i + 1) / 2.0 : i == 31 ? 7 : 0;
        ck_assert(q[i] == x && p[i] == (i == 0 ? 3 : i == 1 ? 4 : 0.5));
    }
    nevh_scene_free(s);
}

TEST(starts_of_momenta_and_velocities) {
    nevh_scene *s = scene_of("[parameters]\nm = 4\n[coordinates]\nx = 1, 8\n"
                             "y = 0\nv_y = 3\n[effects]\n"
                             "kinetic = p_x^2/(2*m) + p_y^2/(2*m)\n");
    double q[2], p[2];
    start_at(s, "v_x = m/8");
    start_at(s, "p_y = 1");
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    ck_assert(p[1] == 1 && q[0] == 1);
    assert_close(p[0], 2);
    ck_assert_int_eq(nevh_scene_set(s, "m = 2"), NEVH_OK);
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    assert_close(p[0], 0.5);
    nevh_scene_free(s);
}

/* What is refused leaves the scene as it was, and says what it looked for. */
TEST(wrong_starts) {
    static const struct {
        const char *text, *message;
    } wrong[] = {{"fhi1 = 1", "did you mean phi1"},
                 {"m = 1", "there is no coordinate, momentum"},
                 {"phi1 = 1, 2", "takes 1 value"},
                 {"phi1[2] = 1", "no such elements"},
                 {"phi1 = phi2", "only parameters"},
                 {"phi1", "NAME = VALUE"}};
    nevh_scene *s = scene_of(shaken_pendulum);
    uint64_t digest = nevh_scene_digest(s);
    double q[2], p[2];
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ck_assert_int_eq(nevh_scene_set_start(s, wrong[i].text), NEVH_EINVAL);
        ck_assert_msg(strstr(nevh_scene_message(s), wrong[i].message), "%s",
                      nevh_scene_message(s));
    }
    ck_assert(nevh_scene_digest(s) == digest);
    ck_assert_int_eq(nevh_scene_start(s, q, p), NEVH_OK);
    ck_assert(q[0] == PI / 2);
    start_at(s, "phi1 = 1");
    ck_assert(nevh_scene_digest(s) != digest);
    nevh_scene_free(s);
}

TEST(numbers_of_parameters) {
    nevh_scene *s = scene_of(shaken_pendulum);
    double number = 0;
    ck_assert_int_eq(nevh_scene_number(s, "3*pi/w", &number), NEVH_OK);
    assert_close(number, 3 * PI / 20);
    ck_assert_int_eq(nevh_scene_number(s, "3*phi1", &number), NEVH_EINVAL);
    ck_assert_int_eq(nevh_scene_number(s, "", &number), NEVH_EINVAL);
    ck_assert_int_eq(nevh_scene_number(s, "sqrt(-w)", &number), NEVH_EDOM);
    nevh_scene_free(s);
}

/* Momenta of very different size, coupled, and one that is given itself. */
TEST(velocities) {
    nevh_scene *s = scene_of(
        "[parameters]\nm = 1e-27\nc = 3e8\n"
        "[coordinates]\nx = 0\nv_x = -2.5e8\ny = 1, 2\nz = 0.5\nv_z = 3\n"
        "a = 0.4\nb = 1\nv_a = 1.5\nv_b = -0.5\nr = 0\nv_r = 0\n"
        "[effects]\nfast = sqrt(m^2*c^4 + p_x^2*c^2)\n"
        "slow = p_y^2/2 + p_y*p_z/5 + (p_z - y)^2/7\n"
        "bent = (p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - "
        "b)^2)) + p_b^4/9\n"
        "rest = p_r^2/2\n");
    double q[6], p[6], v[6];
    int status = nevh_scene_start(s, q, p);
    ck_assert_msg(!status, "%s", nevh_scene_message(s));
    double e = p[0] * 3e8, sine = sin(q[3] - q[4]), cosine = cos(q[3] - q[4]);
    v[0] = e * 3e8 / hypot(e, 1e-27 * 9e16);
    v[1] = p[1] + p[2] / 5;
    v[2] = p[1] / 5 + 2 * (p[2] - q[1]) / 7;
    v[3] = (p[3] - p[4] * cosine) / (1 + sine * sine);
    v[4] = (2 * p[4] - p[3] * cosine) / (1 + sine * sine) +
           4 * p[4] * p[4] * p[4] / 9;
    v[5] = p[5];
    double wanted[] = {-2.5e8, 2 + p[2] / 5, 3, 1.5, -0.5, 0};
    for (int k = 0; k < 6; k++)
        ck_assert_msg(fabs(v[k] - wanted[k]) <= 1e-10 * fabs(wanted[k]),
                      "%d: %g, not %g (p %g)", k, v[k], wanted[k], p[k]);
    ck_assert(p[1] == 2);
    assert_close(p[0] / (-2.5e8 * 1e-27 / sqrt(1 - 6.25 / 9)), 1);
    nevh_scene_free(s);
}

/* No velocity depends on its own momentum alone; many instances. */
TEST(velocities_of_others) {
    nevh_scene *s =
        scene_of("[coordinates]\nx[1..11] = 0\nv_x[i = 1..11] = i/7\n"
                 "u = 0\nv_u = 2\nw = 0\nv_w = -0.5\n"
                 "[effects]\nT = sum(i = 1..11, j = 1..11, p_x[i]*p_x[j]) + "
                 "sum(i = 1..11, i*p_x[i]^2)\nO = p_u*p_w + p_u^3/5\n");
    double q[13], p[13], sum = 0;
    int status = nevh_scene_start(s, q, p);
    ck_assert_msg(!status, "%s", nevh_scene_message(s));
    for (int i = 0; i < 11; i++)
        sum += p[i];
    for (int i = 1; i <= 11; i++)
        assert_close(2 * sum + 2 * i * p[i - 1], i / 7.);
    assert_close(p[11], -0.5);
    assert_close(p[12], 2 - 0.6 * 0.25);
    nevh_scene_free(s);
}

/* Too many for a dense solver. */
TEST(velocities_of_many) {
    nevh_scene *s =
        scene_of("[coordinates]\nx[1..3000] = 0\nv_x[i = 1..3000] = i\n"
                 "[effects]\nT = sum(i = 1..3000, i^2*sqrt(1 + p_x[i]^2))\n");
    static double q[3000], p[3000];
    int status = nevh_scene_start(s, q, p);
    ck_assert_int_eq(status, NEVH_EMAXITER); /* v_x[1] = 1 is the limit */
    nevh_scene_free(s);
    s = scene_of("[coordinates]\nx[1..3000] = 0\nv_x[i = 1..3000] = i/2\n"
                 "[effects]\nT = sum(i = 1..3000, i^2*sqrt(1 + p_x[i]^2))\n");
    status = nevh_scene_start(s, q, p);
    ck_assert_msg(!status, "%s", nevh_scene_message(s));
    for (int i = 1; i <= 3000; i++)
        assert_close(i * p[i - 1] / sqrt(1 + p[i - 1] * p[i - 1]), 0.5);
    nevh_scene_free(s);
}

TEST(velocities_of_a_chain) {
    nevh_scene *s = scene_of(moving_chain);
    double q[4], p[4], c = cos(0) / 3;
    int status = nevh_scene_start(s, q, p);
    ck_assert_msg(!status, "%s", nevh_scene_message(s));
    assert_close(p[0] / (4 / 3.) + c * p[3], 0.2);
    assert_close(p[1] / (5 / 3.), 0.4);
    assert_close(p[2] / 2, 0.6);
    assert_close(p[3] / sqrt(1 + p[3] * p[3]) + c * p[0], -0.3);
    nevh_scene_free(s);
}

TEST(velocities_out_of_reach) {
    nevh_scene *s = scene_of("[coordinates]\nx = 0\nv_x = 2\n"
                             "[effects]\nT = sqrt(1 + p_x^2)\n");
    double q, p;
    ck_assert_int_eq(nevh_scene_start(s, &q, &p), NEVH_EMAXITER);
    ck_assert_ptr_nonnull(strstr(nevh_scene_message(s), "test:3:1: error:"));
    ck_assert_int_eq(nevh_scene_status(s), NEVH_EMAXITER);
    ck_assert_int_eq(nevh_scene_enable(s, "T", true), NEVH_OK);
    ck_assert_str_eq(nevh_scene_message(s), "");
    nevh_scene_free(s);
}

/* The same, whatever ends the lines. */
TEST(ends_of_lines) {
    char text[sizeof shaken_pendulum * 2 + 3] = "\xEF\xBB\xBF", *to = text + 3;
    for (const char *at = shaken_pendulum; *at; at++) {
        if (*at == '\n')
            *to++ = '\r';
        *to++ = *at;
    }
    to[-2] = '\0';
    nevh_scene *s = scene_of(text), *same = scene_of(shaken_pendulum);
    double q[] = {1, 2}, p[] = {3, 4};
    ck_assert(energy(s, 0, q, p) == energy(same, 0, q, p));
    ck_assert_str_eq(nevh_scene_title(s), nevh_scene_title(same));
    ck_assert_str_eq(nevh_scene_run_settings(s)->reference, "gauss12");
    nevh_scene_free(s);
    nevh_scene_free(same);
}
