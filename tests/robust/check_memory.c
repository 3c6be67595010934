/* nevh tests: memory that is out, and steps that take none.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "memory.h"
#include "expression/tape_private.h"
#include <math.h>
#include <nevh/confirm.h>
#include <nevh/gsl.h>
#include <nevh/transform.h>

static double whole(double t, const double q[], const double p[],
                    const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2.6 + p[1] * p[1] / 2 - 1.7 * cos(q[0]) +
           sqrt(q[1]) * q[1];
}

static double kinetic(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return c[0] * p[0] * p[0];
}

static void kinetic_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)params, (void)dq;
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = 2 * c[i] * p[i];
}

static double cosine(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -1.7 * cos(q[0] - q[1]);
}

static void cosine_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)c, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        dq[i] = 1.7 * sin(q[i] - q[width + i]);
        dq[width + i] = -dq[i];
    }
}

static const size_t both[] = {0, 1};
static const double masses[] = {0.7, 0.3};
static const nevh_term terms[] = {
    {"kinetic", "T", 0, 1, 1, NULL, both, masses, 2, false, kinetic, NULL,
     kinetic_gradient, NULL, NULL, NULL, NULL, false, NULL},
    {"potential", NULL, 2, 0, 0, NULL, NULL, NULL, 1, false, cosine, NULL,
     cosine_gradient, NULL, NULL, NULL, NULL, false, NULL}};

static nevh_system *pendulums(void) {
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &terms[0]);
    nevh_system_add(s, &terms[1]);
    return s;
}

static int make_system(const setting *a) {
    (void)a;
    nevh_system *s = nevh_system_new(2);
    int status = nevh_system_status(s);
    strcpy(text, nevh_system_message(s));
    nevh_system_free(s);
    return status;
}

static int make_whole(const setting *a) {
    (void)a;
    nevh_system *s = nevh_system_from(2, whole, NULL);
    int status = nevh_system_status(s);
    strcpy(text, nevh_system_message(s));
    nevh_system_free(s);
    return status;
}

/* Adds to an effect that is there, and a new one. */
static int add_terms(const setting *a) {
    watching = false;
    (void)a;
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &terms[0]);
    watching = true;
    nevh_term more = terms[1];
    more.effect = "kinetic";
    int status = nevh_system_add(s, &more);
    size_t effects = nevh_system_effect_count(s);
    if (!status && (status = nevh_system_add(s, &terms[1])) != 0 &&
        nevh_system_effect_count(s) != effects)
        status = -1;
    if (status != nevh_system_status(s) ||
        (status && nevh_system_add(s, &terms[1]) != status))
        status = -1;
    strcpy(text, nevh_system_message(s));
    nevh_system_free(s);
    return status;
}

/* Friction of an effect that is new. */
static int add_friction(const setting *a) {
    static const double rates[] = {0.1, 0.2};
    (void)a;
    watching = false;
    nevh_system *s = nevh_system_new(2);
    nevh_system_add(s, &terms[0]);
    watching = true;
    int status = nevh_system_add_friction(s, "drag", rates);
    if (status != nevh_system_status(s) ||
        nevh_system_effect_count(s) != (status ? 1 : 2))
        status = -1;
    strcpy(text, nevh_system_message(s));
    nevh_system_free(s);
    return status;
}

static int make_field(const setting *a) {
    nevh_field *f = nevh_field_new(a->system, &a->options);
    int status = nevh_field_status(f);
    strcpy(text, nevh_field_message(f));
    nevh_field_free(f);
    return status;
}

static int make_stepper(const setting *a) {
    nevh_stepper *m = nevh_stepper_new(a->system, a->scheme, &a->options);
    int status = nevh_stepper_status(m);
    strcpy(text, nevh_stepper_message(m));
    nevh_stepper_free(m);
    return status;
}

static int copy_stepper(const setting *a) {
    nevh_stepper *m = nevh_stepper_copy(a->stepper);
    int status = nevh_stepper_status(m);
    strcpy(text, nevh_stepper_message(m));
    nevh_stepper_free(m);
    return status;
}

static int make_energy(const setting *a) {
    nevh_energy *e = nevh_energy_new(a->system, &(nevh_options){.width = 3});
    int status = nevh_energy_status(e);
    strcpy(text, nevh_energy_message(e));
    nevh_energy_free(e);
    return status;
}

static int first_angle(void *data, double t, const double q[], const double p[],
                       double *value) {
    (void)data, (void)t, (void)p;
    *value = q[0];
    return NEVH_OK;
}
static int count_point(void *data, const nevh_point *point) {
    (void)point;
    ++*(size_t *)data;
    return 0;
}
static nevh_sections *sections_of(const nevh_stepper *m, size_t *points) {
    const nevh_section is[] = {{.name = "swing", .value = first_angle},
                               {.name = "clock", .every = 0.11}};
    return nevh_sections_new(m, is, 2, count_point, points);
}

static int make_sections(const setting *a) {
    nevh_sections *x = sections_of(a->stepper, NULL);
    int status = nevh_sections_status(x);
    strcpy(text, nevh_sections_message(x));
    nevh_sections_free(x);
    return status;
}

static int find_defects(const setting *a) {
    double defect, q[] = {0.3, 0.5}, p[] = {0.7, 1.1};
    strcpy(text, "out of memory");
    int status =
        nevh_symplecticity_defect(a->stepper, 0, 0.1, q, p, NULL, &defect);
    return status ? status
                  : nevh_reversal_defect(a->stepper, 0, 0.1, 3, q, p, NULL,
                                         &defect);
}

/* A tape whose nodes outgrow the builder's first room. */
static int make_tape(const setting *a) {
    (void)a;
    int status;
    nevh__tape_builder *b = nevh__tape_builder_new();
    int h = nevh__tape_variable(b, NEVH__Q, 0);
    for (double i = 0; i < 50; i++)
        h = nevh__tape_apply(b, NEVH__ADD, h, nevh__tape_number(b, i));
    nevh__tape_free(nevh__tape_finish(b, h, &status));
    strcpy(text, nevh_status_text(status));
    return status;
}

static int make_closeness(const setting *a) {
    (void)a;
    nevh_system *s = nevh_closeness_power(2, 1, 1);
    int status = nevh_system_status(s);
    strcpy(text, nevh_system_message(s));
    nevh_system_free(s);
    return status;
}

/* Any kind; none takes the place of one that memory has no room for. */
static int make_finer(const setting *a) {
    nevh_finer *f = nevh_finer_new(
        a->system, &(nevh_finer_question){.integrator = a->scheme,
                                          .options = &a->options,
                                          .dt = 0.1,
                                          .steps = 20});
    int status = nevh_finer_status(f);
    strcpy(text, f ? nevh_finer_message(f) : "out of memory");
    nevh_finer_free(f);
    return f ? status : (int)NEVH_ENOMEM;
}

/* To an end between two steps; a state far from the stepper's own. */
static int run_until(const setting *a) {
    double q[] = {0.3, 0.5}, p[] = {0.7, 1.1};
    int status = nevh_run_until(a->stepper, 0, 0.1, 0.33, q, p, NULL, 0);
    strcpy(text, nevh_stepper_message(a->stepper));
    if (status && (q[0] != 0.3 || p[1] != 1.1))
        status = -1;
    return status;
}

TEST(systems) {
    const setting none = {0};
    ck_assert_uint_ge(starve(make_system, &none), 1);
    ck_assert_uint_ge(starve(make_whole, &none), 5);
    ck_assert_uint_ge(starve(add_terms, &none), 9);
    ck_assert_uint_ge(starve(add_friction, &none), 4);
}

TEST_EACH(fields, 5) {
    nevh_system *s = pendulums();
    setting a = {
        .system = s,
        .options = {.gradient = _i == 4 ? nevh_exact : nevh_gradients()[_i]}};
    ck_assert_uint_ge(starve(make_field, &a), 9);
    ck_assert_uint_ge(starve(make_energy, &a), 6);
    nevh_system_free(s);
}

static const double start_q[] = {1.7, 0.4}, start_p[] = {0.3, 0.5};
static const double ones[] = {1, 1, 1, 1}, steps[] = {1e-3, 1e-3, 0, 1e-3};

/* Where every option is given, a whole H has to be probed. */
TEST_EACH(steppers, 2 * scheme_count()) {
    if (nevh_integrator_needs(nevh_integrators()[_i / 2]) & NEVH_PARTS)
        skip_test("one function of all has no parts");
    nevh_system *s = nevh_system_from(2, whole, NULL);
    setting a = {.system = s, .scheme = nevh_integrators()[_i / 2]};
    a.options =
        (nevh_options){.gradient_steps = steps,
                       .scale = _i % 2 ? ones : NULL,
                       .q = start_q,
                       .p = start_p,
                       .tolerance = _i % 2 ? tolerance_for(a.scheme) : 1e-6};
    ck_assert_uint_ge(starve(make_stepper, &a), 15);
    a.stepper = nevh_stepper_new(s, a.scheme, &a.options);
    ck_assert_uint_ge(starve(copy_stepper, &a), 15);
    ck_assert_uint_ge(starve(make_sections, &a), 25);
    nevh_stepper_free(a.stepper);
    nevh_system_free(s);
}

/* With friction and a balance, of a term that may read t ... */
TEST_EACH(balanced_steppers, scheme_count()) {
    static const double rates[] = {0.1, 0.2};
    nevh_system *s = nevh_system_from(2, whole, NULL);
    nevh_system_add_friction(s, "drag", rates);
    setting a = {.system = s, .scheme = nevh_integrators()[_i]};
    a.options =
        (nevh_options){.gradient_step = 1e-3, .q = start_q, .p = start_p};
    a.options.tolerance = tolerance_for(a.scheme);
    a.options.balance = true;
    a.stepper = nevh_stepper_new(s, a.scheme, &a.options);
    bool fits = nevh_stepper_status(a.stepper) != NEVH_ESTRUCT;
    if (fits) {
        ck_assert_uint_ge(starve(make_stepper, &a), 30);
        ck_assert_uint_ge(starve(copy_stepper, &a), 30);
    }
    nevh_stepper_free(a.stepper);
    nevh_system_free(s);
    if (!fits)
        skip_test("the scheme does not fit");
}

/* ... and takes no more when it steps. */
TEST_EACH(balanced_steps_take_no_memory, scheme_count()) {
    static const double rates[] = {0.1, 0.2};
    const nevh_integrator *scheme = nevh_integrators()[_i];
    nevh_system *s = nevh_system_from(2, whole, NULL);
    nevh_system_add_friction(s, "drag", rates);
    nevh_options o = {.q = start_q,
                      .p = start_p,
                      .tolerance = tolerance_for(scheme),
                      .balance = true};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    nevh_energy *e = nevh_energy_new(s, NULL);
    nevh_observer energy = {nevh_energy_observe, e, 1};
    double q[] = {1.7, 0.4}, p[] = {0.3, 0.5};
    int status = nevh_stepper_status(m);
    bool fits = status != NEVH_ESTRUCT;
    if (fits) {
        status = nevh_energy_follow(e, m);
        watch(0);
        status |= nevh_run(m, 0, 0.01, 20, q, p, &energy, 1);
        watching = false;
        ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(m));
        ck_assert_uint_eq(requests, 0);
    }
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
    if (!fits)
        skip_test("the scheme does not fit");
}

TEST(defects) {
    nevh_system *s = pendulums();
    setting a = {.system = s,
                 .stepper = nevh_stepper_new(s, nevh_gauss4, NULL)};
    ck_assert_uint_ge(starve(find_defects, &a), 4);
    nevh_stepper_free(a.stepper);
    nevh_system_free(s);
}

TEST_EACH(finer_runs, 2) {
    const nevh_integrator *schemes[] = {nevh_gauss4, nevh_dopri5};
    nevh_system *s = pendulums();
    setting a = {.system = s, .scheme = schemes[_i]};
    a.options = (nevh_options){.gradient = nevh_exact,
                               .tolerance = tolerance_for(a.scheme),
                               .q = start_q,
                               .p = start_p};
    ck_assert_uint_ge(starve(make_finer, &a), 15);
    nevh_system_free(s);
}

TEST(tapes) {
    const setting none = {0};
    ck_assert_uint_ge(starve(make_tape, &none), 14);
}

/* Time of its own: under a transform, and by the step. */
TEST_EACH(transforms_and_runs, 4) {
    const nevh_integrator *schemes[] = {nevh_gauss4, nevh_rk4,
                                        nevh_adaptive_verlet, nevh_verlet};
    const setting none = {0};
    nevh_system *s = pendulums(), *closeness = nevh_closeness_power(2, 1, 1);
    setting a = {.system = s, .scheme = schemes[_i]};
    a.options = (nevh_options){
        .q = start_q, .p = start_p, .transform = _i < 3 ? closeness : NULL};
    ck_assert_uint_ge(starve(make_closeness, &none), 3);
    ck_assert_uint_ge(starve(make_stepper, &a), 15);
    a.stepper = nevh_stepper_new(s, a.scheme, &a.options);
    ck_assert_uint_ge(starve(copy_stepper, &a), 15);
    ck_assert_uint_eq(starve(run_until, &a), 1);
    nevh_stepper_free(a.stepper);
    nevh_system_free(s);
    nevh_system_free(closeness);
}

/* Under a transform. */
TEST_EACH(transformed_steps_take_no_memory, 3) {
    const nevh_integrator *schemes[] = {nevh_gauss4, nevh_rk4,
                                        nevh_adaptive_verlet};
    nevh_system *s = pendulums(), *closeness = nevh_closeness_power(2, 1, 1);
    nevh_options o = {.q = start_q, .p = start_p, .transform = closeness};
    nevh_stepper *m = nevh_stepper_new(s, schemes[_i], &o);
    double q[] = {1.7, 0.4}, p[] = {0.3, 0.5};
    watch(0);
    int status = nevh_run(m, 0, 0.01, 50, q, p, NULL, 0);
    watching = false;
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(m));
    ck_assert_uint_eq(requests, 0);
    nevh_stepper_free(m);
    nevh_system_free(s);
    nevh_system_free(closeness);
}

TEST_EACH(steps_take_no_memory, 3 * scheme_count()) {
    const nevh_gradient *gradients[] = {nevh_central2, nevh_central8,
                                        nevh_exact};
    const nevh_integrator *scheme = nevh_integrators()[_i / 3];
    nevh_system *s = pendulums();
    nevh_options o = {.gradient = gradients[_i % 3],
                      .q = start_q,
                      .p = start_p,
                      .tolerance = tolerance_for(scheme)};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &o);
    nevh_energy *e = nevh_energy_new(s, NULL);
    size_t points = 0;
    nevh_sections *x = sections_of(m, &points);
    nevh_observer watchers[] = {{nevh_energy_observe, e, 1},
                                {nevh_sections_observe, x, 1}};
    double q[] = {1.7, 0.4}, p[] = {0.3, 0.5};
    /* Where h is nominal, the longest steps are several of it. */
    const double h = nevh_integrator_own_time(scheme) ? 0.02 : 0.05;
    int status = 0;
    ck_assert(m && e);
    watch(0);
    for (int i = 0; i < 100; i++)
        status |= nevh_stepper_apply(m, h * i, h, q, p);
    status |= nevh_run(m, 5, h, 100, q, p, watchers, 2);
    nevh_stepper_reset(m);
    status |= nevh_run(m, 10, -h, 10, q, p, watchers, 2);
    watching = false;
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(m));
    ck_assert_uint_eq(requests, 0);
    ck_assert_uint_gt(nevh_energy_result(e, 0).samples, 100);
    ck_assert_uint_gt(points, 10);
    nevh_sections_free(x);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* GSL's solvers without a Jacobian, where there is no room for one. */
TEST(gsl_system_without_memory) {
    nevh_system *s = pendulums();
    nevh_field *f = nevh_field_new(s, NULL);
    watch(1);
    gsl_odeiv2_system without = nevh_gsl_system(f);
    watching = false;
    ck_assert(!without.jacobian && without.function);
    ck_assert(nevh_gsl_system(f).jacobian);
    nevh_field_free(f);
    nevh_system_free(s);
}
