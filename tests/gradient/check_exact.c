/* nevh tests: derivatives without differences.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/extend.h>
#include <nevh/models.h>
#include <stdio.h>
#include <string.h>

/* H of two degrees of freedom that is singular at 0 and mixes all it reads. */
static double mixed(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)params;
    return c[0] * p[0] * p[0] / (q[0] * q[0]) + sin(q[1]) * p[0] +
           q[0] * q[1] * t;
}

/* The right gradient, and how it is spoiled, in instances of large c. */
typedef enum {
    RIGHT,
    SIGN,    /* of one coordinate's derivative */
    FACTOR,  /* in one momentum's */
    SWAPPED, /* two coordinates */
    FAR_OFF, /* wrong except near the usual state to plan at */
    SLIGHT   /* by 1e-4 */
} spoil;

static void mixed_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]) {
    const double *x = q, *y = q + width;
    for (size_t i = 0; i < width; i++) {
        const spoil how = c[i] > 0.85 ? *(const spoil *)params : RIGHT;
        double r2 = x[i] * x[i];
        double dx = -2 * c[i] * p[i] * p[i] / (r2 * x[i]) + y[i] * t[i];
        double dy = cos(y[i]) * p[i] + x[i] * t[i];
        if (how == FAR_OFF && fabs(y[i] - 0.4) > 0.05)
            dy += 0.1;
        if (dq) {
            dq[i] = how == SWAPPED ? dy : how == SLIGHT ? dx * 1.0001 : dx;
            dq[width + i] = how == SWAPPED ? dx : how == SIGN ? -dy : dy;
        }
        if (dp)
            dp[i] = (how == FACTOR ? 1 : 2) * c[i] * p[i] / r2 + sin(y[i]);
    }
}

/* The second instance of the second of two terms is tried; it reads q[2], q[1]
   and p[1] of three. */
static nevh_system *make_mixed(const spoil *how) {
    static const size_t q[] = {0, 1, 2, 1}, p[] = {0, 1};
    static const double c[] = {0.8, 0.9};
    static const spoil right = RIGHT;
    nevh_system *s = nevh_system_new(3);
    nevh_system_add(s, &(nevh_term){.effect = "good",
                                    .nq = 2,
                                    .np = 1,
                                    .nc = 1,
                                    .c = c,
                                    .time = true,
                                    .value = mixed,
                                    .gradient = mixed_gradient,
                                    .params = &right});
    nevh_system_add(s, &(nevh_term){.effect = "tried",
                                    .nq = 2,
                                    .np = 1,
                                    .nc = 1,
                                    .q = q,
                                    .p = p,
                                    .c = c,
                                    .count = 2,
                                    .time = true,
                                    .value = mixed,
                                    .gradient = mixed_gradient,
                                    .params = how});
    return s;
}

static nevh_field *planned_exact(const nevh_system *s, const double q[],
                                 const double p[]) {
    return nevh_field_new(
        s, &(nevh_options){.gradient = nevh_exact, .t = 0.7, .q = q, .p = p});
}

/* Planning states: usual, at rest, on the singularity, and none. */
static const struct {
    bool none;
    double q[3], p[3];
} starts[] = {
    {false, {0.9, 0.4, 1.1}, {0.5, 0.7, 0.3}},
    {false, {0.9, 0.4, 1.1}, {0, 0, 0}},
    {false, {0, 0.4, 0}, {0.5, 0.7, 0.3}},
    {false, {0, 0, 0}, {0, 0, 0}},
    {true, {0}, {0}},
};
enum { STARTS = sizeof starts / sizeof *starts };

static nevh_field *planned_at(const nevh_system *s, int i) {
    return planned_exact(s, starts[i].none ? NULL : starts[i].q,
                         starts[i].none ? NULL : starts[i].p);
}

static const char *const wrong_variable[] = {[SIGN] = "q[1]",
                                             [FACTOR] = "p[1]",
                                             [SWAPPED] = "q[",
                                             [FAR_OFF] = "q[1]",
                                             [SLIGHT] = "q[2]"};

/* On a singularity no length can be found, and a slight error not either. */
TEST_EACH(wrong_gradients_are_refused, STARTS *SLIGHT) {
    const spoil how = 1 + _i % SLIGHT;
    if (how == SLIGHT && starts[_i / SLIGHT].q[0] == 0 &&
        !starts[_i / SLIGHT].none)
        skip_test("at q = 0 a slight error is none");
    double q[] = {0.9, 0.4, 1.1}, p[] = {0.5, 0.7, 0.3}, t = 0.7, d[6];
    nevh_system *s = make_mixed(&how);
    nevh_field *f = planned_at(s, _i / SLIGHT);
    const char *message = nevh_field_message(f);
    ck_assert_msg(nevh_field_status(f) == NEVH_ENOGRAD, "%d at start %d: %s",
                  (int)how, _i / SLIGHT, message);
    assert_says(message, "\"tried\"");
    assert_says(message, wrong_variable[how]);
    ck_assert_int_eq(nevh_field_gradient(f, 1, &t, q, p, d, d + 3),
                     NEVH_ENOGRAD);
    nevh_field_free(f);
    nevh_stepper *m = nevh_stepper_new(
        s, nevh_gauss4,
        &(nevh_options){.gradient = nevh_exact, .q = q, .p = p});
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_ENOGRAD);
    ck_assert_int_eq(nevh_stepper_apply(m, 0.7, 0.1, q, p), NEVH_ENOGRAD);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* Both numbers: at the state given, the first that is tried. */
TEST(both_values_are_told) {
    const spoil how = SIGN;
    double right = cos(0.4) * 0.7 + 1.1 * 0.7;
    char number[40];
    nevh_system *s = make_mixed(&how);
    nevh_field *f = planned_at(s, 0);
    snprintf(number, sizeof number, "is %.6g", -right);
    assert_says(nevh_field_message(f), number);
    snprintf(number, sizeof number, "give %.6g", right);
    assert_says(nevh_field_message(f), number);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST_EACH(right_gradients_pass, STARTS) {
    const spoil how = RIGHT;
    nevh_system *s = make_mixed(&how);
    nevh_field *f = planned_at(s, _i);
    ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
    ck_assert_uint_eq(nevh_field_counts(f).values, 0);
    nevh_field_free(f);
    nevh_system_free(s);
}

/* A charge in a magnetic field, in units of l for lengths and s for momenta: what
   its gradient adds up is far larger than the sum where it is at rest. */
typedef struct {
    double field, unit, error; /* error: of the field, in the gradient alone */
} charge;

static double charge_value(double t, const double q[], const double p[],
                           const double c[], const void *params) {
    const charge *e = params;
    double u = p[0] + e->field * q[1] / 2, v = p[1] - e->field * q[0] / 2;
    (void)t, (void)c;
    return (u * u + v * v) / (2 * e->unit);
}

static void charge_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    const charge *e = params;
    double half = e->field * (1 + e->error) / 2;
    (void)t, (void)c;
    for (size_t i = 0; i < width; i++) {
        double u = (p[i] + q[width + i] * half) / e->unit;
        double v = (p[width + i] - q[i] * half) / e->unit;
        if (dq) {
            dq[i] = -v * half;
            dq[width + i] = u * half;
        }
        if (dp) {
            dp[i] = u;
            dp[width + i] = v;
        }
    }
}

static int status_of_charge(const charge *e, const double q[],
                            const double p[]) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &(nevh_term){.effect = "charge",
                                    .nq = 2,
                                    .np = 2,
                                    .value = charge_value,
                                    .gradient = charge_gradient,
                                    .params = e});
    nevh_field *f = planned_exact(s, q, p);
    int status = nevh_field_status(f);
    nevh_field_free(f);
    nevh_system_free(s);
    return status;
}

TEST(charges_at_rest_pass_and_wrong_fields_do_not) {
    for (int i = 0; i < 400; i++) {
        double unit = i % 4 ? 1 : exp2(-90 + i / 2);
        double field = 1.6 * sin(2.3 * i + 1) * unit;
        double x = sin(1.7 * i + 1), y = cos(3.1 * i);
        charge e = {field, unit, 0};
        const double q[] = {x, y}, p[] = {-field * y / 2, field * x / 2};
        ck_assert_msg(!status_of_charge(&e, q, p), "%a %a %a", field, x, y);
        e.error = i % 2 ? 1e-4 : -2;
        ck_assert_msg(status_of_charge(&e, q, p) == NEVH_ENOGRAD, "%a %a %a",
                      field, x, y);
    }
}

/* Short ripples of a wide well, the slope as it is and less by a part. */
static double rippled(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return q[0] * q[0] / 2 - 1e-4 * cos(1e3 * q[0]);
}

static void rippled_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dq[], double dp[]) {
    const double *factor = params;
    (void)t, (void)p, (void)c, (void)dp;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = *factor * (q[i] + 0.1 * sin(1e3 * q[i]));
}

static const nevh_term rippled_term = {.effect = "rippled",
                                       .nq = 1,
                                       .value = rippled,
                                       .gradient = rippled_gradient};

/* Of (exp(x) - 1 - x)/x^2, which cancels, by 1e-3 less. */
static double cancelling(double t, const double q[], const double p[],
                         const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return (exp(q[0]) - 1 - q[0]) / (q[0] * q[0]);
}

static void cancelling_gradient(size_t width, const double t[],
                                const double q[], const double p[],
                                const double c[], const void *params,
                                double dq[], double dp[]) {
    const double *factor = params;
    (void)t, (void)p, (void)c, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        double x = q[i], e = exp(x);
        dq[i] = *factor * ((e - 1) / (x * x) - 2 * (e - 1 - x) / (x * x * x));
    }
}

static const nevh_term cancelling_term = {.effect = "cancelling",
                                          .nq = 1,
                                          .value = cancelling,
                                          .gradient = cancelling_gradient};

static int status_of(nevh_term term, double factor, double at) {
    nevh_system *s = nevh_system_new(1);
    term.params = &factor;
    nevh_system_add(s, &term);
    nevh_field *f = planned_exact(s, &at, (const double[]){0});
    int status = nevh_field_status(f);
    nevh_field_free(f);
    nevh_system_free(s);
    return status;
}

TEST(formulas_that_cancel_pass_and_wrong_slopes_do_not) {
    for (double at = 2e-4; at < 3; at *= 1.37)
        ck_assert_msg(!status_of(cancelling_term, 1, at), "%g", at);
    for (double at = 0.01; at < 3; at *= 1.37)
        ck_assert_msg(status_of(cancelling_term, 0.999, at) == NEVH_ENOGRAD,
                      "%g", at);
}

TEST(ripples_pass_and_wrong_slopes_do_not) {
    for (double at = 4; at < 100; at *= 1.07) {
        ck_assert_msg(!status_of(rippled_term, 1, at), "%g", at);
        ck_assert_msg(status_of(rippled_term, 0.2, at) == NEVH_ENOGRAD, "%g",
                      at);
    }
}

/* Formulas that cancel near 0, until nothing but rounding is left of them; and some
   whose derivative is computed from squares that no double holds. */
static const char *const cancel[] = {
    "(exp(x)-1-x)/x^2", "(1-cos(x))/x^2",       "(x-sin(x))/x^3",
    "(cosh(x)-1)/x",    "log(1+x)/x",           "(tan(x)-x)/x^3",
    "((1+x)^5-1)/x",    "(1e6+x)^2-1e12-2e6*x", "1/(exp(-300*x)+exp(300*x))",
    "3/cosh(200*x)^2"};
enum { CANCEL = sizeof cancel / sizeof *cancel };

TEST_EACH(exact_gradients_of_formulas_that_cancel_pass, CANCEL) {
    for (double x = 1e-10; x < 3; x *= 1.31) {
        char text[200];
        double p = 0;
        snprintf(text, sizeof text,
                 "[coordinates]\nx = %.17g\n[effects]\nK = p_x^2/2\nV = %s\n",
                 x, cancel[_i]);
        nevh_scene *scene = nevh_scene_parse("test", text);
        nevh_field *f = planned_exact(nevh_scene_system(scene), &x, &p);
        ck_assert_msg(!nevh_field_status(f), "%g: %s", x,
                      nevh_field_message(f));
        nevh_field_free(f);
        nevh_scene_free(scene);
    }
}

/* On all models and problems, at their own states and around zero. */
TEST(right_gradients_of_models_pass) {
    for (const nevh_model *const *m = nevh_models(); *m; m++) {
        nevh_system *s = (*m)->system((*m)->defaults);
        nevh_field *f = planned_exact(s, (*m)->q, (*m)->p);
        nevh_field *zero = planned_exact(s, NULL, NULL);
        ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
        ck_assert_msg(!nevh_field_status(zero), "%s", nevh_field_message(zero));
        nevh_field_free(f);
        nevh_field_free(zero);
        nevh_system_free(s);
    }
    for (int i = 0; problems[i]; i++) {
        nevh_system *s = problems[i]->make();
        nevh_field *f = planned_exact(s, problems[i]->q, problems[i]->p);
        ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
        nevh_field_free(f);
        nevh_system_free(s);
    }
}

/* The complex step.  A pendulum that is shaken, and Kepler's problem. */

static double shaken(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)params;
    return p[0] * p[0] / (2 * c[0]) - c[1] * (1 + 0.3 * sin(t)) * cos(q[0]);
}

/* Where the imaginary part is below rounding, its cosh is 1. */
static void shaken_complex(double t, const double q[][2], const double p[][2],
                           const double c[], const void *params, double h[2]) {
    double weight = c[1] * (1 + 0.3 * sin(t));
    (void)params;
    h[0] = p[0][0] * p[0][0] / (2 * c[0]) - weight * cos(q[0][0]);
    h[1] = p[0][0] * p[0][1] / c[0] + weight * sin(q[0][0]) * sinh(q[0][1]);
}

static void shaken_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)params;
    for (size_t i = 0; i < width; i++) {
        if (dq)
            dq[i] = c[width + i] * (1 + 0.3 * sin(t[i])) * sin(q[i]);
        if (dp)
            dp[i] = p[i] / c[i];
    }
}

/* What planning asks for: typical lengths take a coarse run. */

static double bob_value(double t, const double q[], const double p[],
                        const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -cos(q[0]);
}

static void bob_gradient(size_t width, const double t[], const double q[],
                         const double p[], const double c[], const void *params,
                         double dq[], double dp[]) {
    const size_t *counter = params;
    (void)t, (void)p, (void)c, (void)dp;
    ++*(size_t *)counter;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = sin(q[i]);
}

static double half_square(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2;
}

static void half_square_slope(size_t width, const double t[], const double q[],
                              const double p[], const double c[],
                              const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)c, (void)params, (void)dq;
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = p[i];
}

/* Gradients of the bob that planning takes. */
static size_t asked_by(const nevh_integrator *scheme, const double scale[]) {
    size_t counter = 0;
    static const size_t first = 0;
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.name = "bob",
                                    .effect = "bob",
                                    .nq = 1,
                                    .q = &first,
                                    .value = bob_value,
                                    .gradient = bob_gradient,
                                    .params = &counter});
    nevh_system_add(s, &(nevh_term){.name = "kinetic",
                                    .effect = "kinetic",
                                    .np = 1,
                                    .p = &first,
                                    .value = half_square,
                                    .gradient = half_square_slope});
    nevh_options o = {.gradient = nevh_exact,
                      .tolerance = 1e-6,
                      .scale = scale,
                      .q = (const double[]){1},
                      .p = (const double[]){0}};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    ck_assert_uint_eq(nevh_stepper_counts(m).gradients, 0);
    nevh_stepper_free(m);
    nevh_system_free(s);
    return counter;
}

TEST(lengths_are_found_for_schemes_that_read_them) {
    static const double ones[] = {1, 1};
    const nevh_integrator *blind[] = {nevh_verlet, nevh_blanes_moan4, nevh_rk4,
                                      nevh_euler};
    const nevh_integrator *reads[] = {nevh_midpoint, nevh_gauss8, nevh_dopri5,
                                      nevh_gonzalez, nevh_tao2};
    size_t none = asked_by(nevh_verlet, ones);
    for (size_t i = 0; i < sizeof blind / sizeof *blind; i++)
        ck_assert_uint_le(asked_by(blind[i], NULL), none + 16);
    for (size_t i = 0; i < sizeof reads / sizeof *reads; i++)
        ck_assert_msg(asked_by(reads[i], NULL) > none + 200, "%s: %zu",
                      nevh_integrator_name(reads[i]), asked_by(reads[i], NULL));
}

/* A swing shows its sizes in a few steps of the 240. */
TEST(the_pilot_for_scales_ends_once_sizes_settle) {
    static const double ones[] = {1, 1};
    size_t none = asked_by(nevh_dop853, ones);
    ck_assert_uint_lt(asked_by(nevh_dop853, NULL), none + 500);
}

/* A kernel that only finds its scales. */
static double scales[8];

static int note_scales(nevh_work *w) {
    int status = nevh_work_find_scale(w);
    if (!status)
        memcpy(scales, w->scale, 2 * w->n * sizeof *scales);
    return status;
}

static const nevh_kernel only_scales = {.plan = note_scales};
static const nevh_integrator scales_of = {
    .name = "scales", .order = 1, .kernel = &only_scales};

static void find_scales(const nevh_model *model, const nevh_gradient *gradient,
                        const double q[], const double p[]) {
    nevh_system *s = model->system(model->defaults);
    nevh_stepper *m = nevh_stepper_new(
        s, &scales_of, &(nevh_options){.gradient = gradient, .q = q, .p = p});
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(scales_are_the_same_for_exact_gradients_and_differences) {
    for (const nevh_model *const *m = nevh_models(); *m; m++) {
        double exact[8];
        find_scales(*m, nevh_exact, (*m)->q, (*m)->p);
        memcpy(exact, scales, sizeof exact);
        find_scales(*m, nevh_central4, (*m)->q, (*m)->p);
        for (size_t i = 0; i < 2 * (*m)->n; i++)
            ck_assert_msg(fabs(scales[i] / exact[i] - 1) < 1e-3,
                          "%s, %zu: %g, %g", (*m)->name, i, scales[i],
                          exact[i]);
    }
}

/* The pendulum stands nearly upright for long, where p is far below its size. */
TEST(the_pilot_for_scales_waits_until_the_orbit_sets_out) {
    for (double off = 0.1; off > 1e-12; off /= 10)
        for (int i = 0; i < 2; i++) {
            find_scales(nevh_pendulum_model, i ? nevh_central4 : nevh_exact,
                        (const double[]){3.141592653589793 - off},
                        (const double[]){0});
            ck_assert_msg(scales[1] > 1, "%g: %g", off, scales[1]);
        }
}

static double kepler_value(double t, const double q[], const double p[],
                           const double c[], const void *params) {
    (void)t, (void)params;
    return (p[0] * p[0] + p[1] * p[1]) / (2 * c[0]) -
           1 / sqrt(q[0] * q[0] + q[1] * q[1]);
}

/* 1/sqrt(z) is 1/r (1 - i Im z / (2 r^2)). */
static void kepler_complex(double t, const double q[][2], const double p[][2],
                           const double c[], const void *params, double h[2]) {
    double r2 = q[0][0] * q[0][0] + q[1][0] * q[1][0], r = sqrt(r2);
    double cross = q[0][0] * q[0][1] + q[1][0] * q[1][1];
    (void)t, (void)params;
    h[0] = (p[0][0] * p[0][0] + p[1][0] * p[1][0]) / (2 * c[0]) - 1 / r;
    h[1] = (p[0][0] * p[0][1] + p[1][0] * p[1][1]) / c[0] + cross / (r2 * r);
}

static void kepler_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)params;
    for (size_t i = 0; i < width; i++) {
        double r2 = q[i] * q[i] + q[width + i] * q[width + i];
        for (size_t k = i; dq && k < 2 * width; k += width)
            dq[k] = q[k] / (r2 * sqrt(r2));
        for (size_t k = i; dp && k < 2 * width; k += width)
            dp[k] = p[k] / c[i];
    }
}

/* Five shaken pendula, of constants of their own, and two planets. */
enum { N = 9, PENDULA = 5, WIDEST = 200 };

static nevh_system *make_zoo(void) {
    static const size_t five[] = {0, 2, 4, 6, 8}, two[] = {1, 3, 5, 7};
    static const double c[] = {1,   2,   1.5, 3,   0.7, 2,
                               0.4, 1.1, 2,   1.9, 1.3, 0.6};
    nevh_system *s = nevh_system_new(N);
    nevh_system_add(s, &(nevh_term){.effect = "pendula",
                                    .nq = 1,
                                    .np = 1,
                                    .nc = 2,
                                    .q = five,
                                    .p = five,
                                    .c = c,
                                    .count = PENDULA,
                                    .time = true,
                                    .value = shaken,
                                    .gradient = shaken_gradient,
                                    .complex_value = shaken_complex});
    nevh_system_add(s, &(nevh_term){.effect = "planets",
                                    .nq = 2,
                                    .np = 2,
                                    .nc = 1,
                                    .q = two,
                                    .p = two,
                                    .c = c + 10,
                                    .count = 2,
                                    .value = kepler_value,
                                    .gradient = kepler_gradient,
                                    .complex_value = kepler_complex});
    return s;
}

static double zoo_t[WIDEST], zoo_q[N * WIDEST], zoo_p[N * WIDEST];

static void set_zoo(size_t width) {
    for (size_t lane = 0; lane < width; lane++) {
        zoo_t[lane] = 0.1 * (double)lane;
        for (size_t k = 0; k < N; k++) {
            double x = (double)(lane * N + k);
            zoo_q[k * width + lane] = 0.3 + 2 * fabs(sin(1.7 * x));
            zoo_p[k * width + lane] = 1.3 * cos(2.3 * x);
        }
    }
}

/* Planned around zero, where 1/r drowns the momenta: that must not make their
   derivatives wrong ones. */
TEST_RANGE(complex_equals_exact, 1, WIDEST + 1) {
    const size_t width = (size_t)_i;
    static double d[2 * N * WIDEST], e[2 * N * WIDEST];
    nevh_system *s = make_zoo();
    nevh_field *f =
        nevh_field_new(s, &(nevh_options){.gradient = nevh_complex_step});
    nevh_field *exact =
        nevh_field_new(s, &(nevh_options){.gradient = nevh_exact});
    size_t size = N * width;
    set_zoo(width);
    ck_assert(!nevh_field_gradient(f, width, zoo_t, zoo_q, zoo_p, d, d + size));
    ck_assert(
        !nevh_field_gradient(exact, width, zoo_t, zoo_q, zoo_p, e, e + size));
    for (size_t i = 0; i < 2 * size; i++)
        ck_assert_double_eq_tol(d[i], e[i], 1e-14 * fmax(1, fabs(e[i])));
    /* One value a variable; none of them for what is not asked for. */
    const size_t both = 2 * PENDULA + 2 * 4, half = both / 2;
    ck_assert_uint_eq(nevh_field_counts(f).values, both * width);
    ck_assert_uint_eq(nevh_field_effect_values(f, "planets"), 8 * width);
    nevh_field_gradient(f, width, zoo_t, zoo_q, zoo_p, d, NULL);
    nevh_field_gradient(f, width, zoo_t, zoo_q, zoo_p, NULL, d + size);
    ck_assert_uint_eq(nevh_field_counts(f).values, (both + 2 * half) * width);
    nevh_field_free(f);
    nevh_field_free(exact);
    nevh_system_free(s);
}

/* Each lane as if it were alone, to the last bit, with either method. */
TEST_EACH(lanes_agree, 8) {
    static const size_t widths[] = {1, 3, 17, 200};
    const size_t width = widths[_i / 2];
    const nevh_gradient *g = _i % 2 ? nevh_exact : nevh_complex_step;
    static double d[2 * N * WIDEST];
    double q[N], p[N], one[2 * N];
    nevh_system *s = make_zoo();
    nevh_field *f = nevh_field_new(s, &(nevh_options){.gradient = g});
    set_zoo(width);
    ck_assert(
        !nevh_field_gradient(f, width, zoo_t, zoo_q, zoo_p, d, d + N * width));
    for (size_t lane = 0; lane < width; lane++) {
        for (size_t k = 0; k < N; k++) {
            q[k] = zoo_q[k * width + lane];
            p[k] = zoo_p[k * width + lane];
        }
        ck_assert(!nevh_field_gradient(f, 1, &zoo_t[lane], q, p, one, one + N));
        for (size_t k = 0; k < 2 * N; k++)
            ck_assert(d[k * width + lane] == one[k]);
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST(complex_failures) {
    nevh_system *s = make_zoo();
    const nevh_options o = {.gradient = nevh_complex_step};
    nevh_field *f = nevh_field_new(s, &o);
    double d[N];
    set_zoo(1);
    zoo_q[5] = zoo_q[7] = 0; /* the second planet in the sun */
    ck_assert_int_eq(nevh_field_gradient(f, 1, zoo_t, zoo_q, zoo_p, d, NULL),
                     NEVH_EDOM);
    assert_says(nevh_field_message(f), "\"planets\"");
    assert_says(nevh_field_message(f), "instance 1");
    set_zoo(1);
    ck_assert(!nevh_field_gradient(f, 1, zoo_t, zoo_q, zoo_p, d, NULL));
    nevh_field_free(f);
    nevh_system_add(s, &(nevh_term){.effect = "bare",
                                    .nq = 1,
                                    .np = 1,
                                    .nc = 2,
                                    .c = (const double[]){1, 1},
                                    .value = shaken});
    f = nevh_field_new(s, &o);
    ck_assert_int_eq(nevh_field_status(f), NEVH_ENOGRAD);
    assert_says(nevh_field_message(f), "\"bare\"");
    assert_says(nevh_field_message(f), "complex form");
    nevh_field_free(f);
    nevh_system_enable(s, "bare", false);
    f = nevh_field_new(s, &o);
    ck_assert_int_eq(nevh_field_status(f), NEVH_OK);
    nevh_field_free(f);
    nevh_system_free(s);
}
