/* nevh tests: kinks of functions in C, and of formulas that do not name them, leave no
   modified energy.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene.h"
#include "support.h"
#include <math.h>
#include <stdio.h>

typedef double (*potential)(double x, double y);

static double henon(double x, double y) {
    return (x * x + y * y) / 2 + x * x * y - y * y * y / 3;
}
static double waves(double x, double y) {
    return -cos(x) - 0.3 * cos(y - 40 * x);
}
static double gravity(double x, double y) {
    return -1 / hypot(x, y);
}
static double spring(double x, double y) {
    return pow(hypot(x, y) - 1, 2);
}
static double steep(double x, double y) {
    return log(cosh(20 * x)) / 20 + exp(3 * y) + exp(-3 * y);
}
static double wedges(double x, double y) {
    return fabs(x) + fabs(y) + (x - y) * (x - y) / 2;
}
static double backlash(double x, double y) {
    return pow(fmax(fabs(x) - 0.5, 0), 2) + y * y;
}
static double root(double x, double y) {
    return sqrt(x * x) + y * y;
}
static double stairs(double x, double y) {
    return floor(4 * x) / 100 + x * x + y * y;
}
/* Straight lines between the values of x^2 at tenths. */
static double table(double x, double y) {
    double low = floor(10 * x) / 10;
    return low * low + (2 * low + 0.1) * (x - low) + y * y;
}

typedef struct {
    const char *name;
    potential potential;
    double q[2], p[2], dt;
    bool rough;
} subject;

static const subject subjects[] = {
    {"henon", henon, {0.1, 0.2}, {0.3, 0.1}, 0.1, false},
    {"waves", waves, {1, 0.5}, {0.2, 2}, 0.02, false},
    {"gravity", gravity, {1.9, 0}, {0, 0.16}, 1e-4, false},
    {"spring", spring, {1, 0.1}, {0.1, 0.3}, 0.1, false},
    {"steep", steep, {1, 0.1}, {0.1, 0.3}, 0.01, false},
    {"wedges", wedges, {1, 0.3}, {0, 0}, 0.15, true},
    {"backlash", backlash, {1.5, 0.3}, {0, 0}, 0.1, true},
    {"root", root, {1, 0.3}, {0.4, 0}, 0.1, true},
    {"stairs", stairs, {1, 0.3}, {0.4, 0}, 0.1, true},
    {"table", table, {1, 0.3}, {0.4, 0}, 0.1, true}};
enum { SUBJECTS = sizeof subjects / sizeof *subjects };

static double value(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)p, (void)c;
    return ((const subject *)params)->potential(q[0], q[1]);
}

static nevh_system *system_of(const subject *s) {
    nevh_system *made = nevh_system_new(2);
    add_kinetic(made, 2, (double[]){1, 1});
    nevh_system_add(
        made, &(nevh_term){
                  .effect = "potential", .nq = 2, .value = value, .params = s});
    return made;
}

/* The report on a run, and, if times > 1, on that which settles its verdict. */
static nevh_energy_report report_on(const subject *s, const nevh_system *system,
                                    const nevh_integrator *scheme, size_t width,
                                    size_t steps, bool settle) {
    double q[8], p[8];
    for (size_t k = 0; k < 2 * width; k++)
        q[k] = s->q[k / width], p[k] = s->p[k / width];
    nevh_stepper *m = nevh_stepper_new(
        system, scheme, &(nevh_options){.width = width, .q = q, .p = p});
    nevh_energy *e = nevh_energy_new(system, &(nevh_options){.width = width});
    nevh_observer o = {nevh_energy_observe, e, 1};
    ck_assert_msg(!nevh_energy_expect(e, m), "%s", nevh_energy_message(e));
    int status = nevh_run(m, 0, s->dt, steps, q, p, &o, 1);
    ck_assert_msg(status == NEVH_OK, "%s", nevh_stepper_message(m));
    nevh_energy_report r = nevh_energy_result(e, width - 1);
    nevh_energy_free(e);
    if (settle) {
        e = nevh_energy_new(system, NULL);
        nevh_energy_expect(e, m);
        nevh_judged_run run = {.h = s->dt,
                               .t_end = (double)steps * s->dt,
                               .q = s->q,
                               .p = s->p,
                               .seconds = 0.02};
        ck_assert_int_eq(nevh_verdict_settle(m, e, &run, &r), NEVH_OK);
        nevh_energy_free(e);
    }
    nevh_stepper_free(m);
    return r;
}

TEST_EACH(functions_in_c, SUBJECTS) {
    const subject *s = &subjects[_i];
    for (size_t width = 1; width <= 3; width++) {
        nevh_system *system = system_of(s);
        nevh_theory theory =
            report_on(s, system, width == 2 ? nevh_midpoint : nevh_verlet,
                      width, 1000, false)
                .theory;
        ck_assert_msg(theory ==
                          (s->rough ? NEVH_THEORY_ROUGH : NEVH_THEORY_KEEPS),
                      "%s, %zu orbits: %d", s->name, width, theory);
        nevh_system_free(system);
    }
}

/* What is bounded for a while and then grows is not called bounded; smooth ones are. */
TEST(verdicts) {
    for (size_t i = 0; i < SUBJECTS; i++) {
        const subject *s = &subjects[i];
        if (s->potential != wedges && s->rough)
            continue;
        nevh_system *system = system_of(s);
        for (int k = 0; k < 2; k++) {
            const nevh_integrator *scheme = k ? nevh_gauss6 : nevh_gauss8;
            nevh_verdict said =
                report_on(s, system, scheme, 1, 400, true).verdict;
            ck_assert_msg((said == NEVH_BOUNDED) == !s->rough, "%s, %s: %s",
                          s->name, nevh_integrator_name(scheme),
                          nevh_verdict_name(said));
        }
        nevh_system_free(system);
    }
}

/* Formulas whose kinks have no name. */
TEST(formulas) {
    static const struct {
        const char *potential;
        bool rough;
    } of[] = {{"sqrt(x^2)+y^2", true},         {"(x^2)^0.5+y^2", true},
              {"hypot(x,0)+y^2", true},        {"acos(cos(3*x))+x^2+y^2", true},
              {"exp(0.5*log(x^2))+y^2", true}, {"acosh(cosh(x))+y^2", true},
              {"hypot(x,y)^3+x*y", false},     {"sqrt(1+x^2)+y^2", false},
              {"log(3+x)+x^4+y^2", false},     {"(3+x)^1.5+x^4+y^2", false}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        char effects[120];
        snprintf(effects, sizeof effects, "K = (p_x^2+p_y^2)/2\nV = %s",
                 of[i].potential);
        nevh_scene *scene = scene_with("x = 1\ny = 0.3", effects);
        subject s = {.q = {1, 0.3}, .p = {0, 0.2}, .dt = 0.05};
        nevh_energy_report r = report_on(&s, nevh_scene_system(scene),
                                         nevh_verlet, 1, 1000, false);
        ck_assert_msg(r.theory ==
                          (of[i].rough ? NEVH_THEORY_ROUGH : NEVH_THEORY_KEEPS),
                      "%s: %d", of[i].potential, r.theory);
        nevh_scene_free(scene);
    }
}
