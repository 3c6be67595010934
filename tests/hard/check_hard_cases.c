/* nevh tests: every hard case ends in what theory expects, by a judge that passes
   what is good, and nothing else.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard_judge.h"
#include "support.h"
#include <math.h>
#include <nevh/extend.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* What the cases ask of the rest of the tool. */
char *scene_file(const char *name) {
    const char *source = getenv("srcdir");
    return text_print("%s/scenes/%s.nevh", source ? source : ".", name);
}
nevh_options plan_options(const plan *p, const char *gradient) {
    (void)p, (void)gradient;
    return (nevh_options){0};
}
const nevh_system *plan_transform(const plan *p, const char *name) {
    (void)p, (void)name;
    return NULL;
}

static const char regular[] = "Henon-Heiles at 1/12";
static const char fine[] = "Henon-Heiles, small steps";
static const char planets[] = "outer planets";

static hard_verdict judged_with(const nevh_integrator *scheme,
                                const char *gradient, const hard_subject *s,
                                double budget) {
    hard_result r = {.scheme = scheme, .gradient = gradient};
    hard_begin("oscillator", scheme, 60);
    r.limit = nevh_stability_limit(scheme);
    hard_end();
    hard_run(s, budget, &r);
    hard_judge(s, &r);
    printf("%s, %s, %s: %s: %s\n", s->known.given.name,
           nevh_integrator_name(scheme), gradient, hard_verdict_name(r.verdict),
           r.happened);
    hard_result_free(&r);
    return r.verdict;
}

static void open_case(hard_subject *s, size_t i) {
    hard_known known = hard_known_at(i);
    ck_assert_int_eq(hard_open(s, &known), TOOL_OK);
}

static hard_verdict judged(const nevh_integrator *scheme, const char *name,
                           double budget) {
    size_t i = 0;
    while (strcmp(hard_known_at(i).given.name, name) != 0)
        ck_assert_ptr_nonnull(hard_known_at(++i).given.name);
    hard_subject s;
    open_case(&s, i);
    hard_verdict verdict = judged_with(scheme, "exact", &s, budget);
    hard_close(&s);
    return verdict;
}

static hard_verdict judge(const nevh_integrator *scheme, const char *name) {
    return judged(scheme, name, 1e6);
}

enum { CASES = 53 };

static void judge_case(int number, const nevh_integrator *const schemes[],
                       const char *const gradients[]) {
    hard_subject s;
    ck_assert_ptr_null(hard_known_at(CASES).given.name);
    open_case(&s, (size_t)number);
    for (; *gradients; gradients++)
        for (size_t i = 0; schemes[i]; i++)
            ck_assert_int_gt(judged_with(schemes[i], *gradients, &s, 1e6),
                             HARD_WRONG);
    hard_close(&s);
}

/* No case without a verdict, and none on a wrong orbit. */
TEST_EACH(every_case, CASES) {
    static const char *const gradients[] = {"central6", NULL};
    const nevh_integrator *const schemes[] = {nevh_verlet,          nevh_gauss4,
                                              nevh_gonzalez,        nevh_rk4,
                                              nevh_adaptive_verlet, NULL};
    judge_case(_i, schemes, gradients);
}

TEST_TAGGED(every_case_with_every_scheme, "slow", 0, CASES) {
    static const char *const gradients[] = {"central2", "central6", "exact",
                                            NULL};
    judge_case(_i, nevh_integrators(), gradients);
}

TEST_EACH(good_ones_pass, 4) {
    static const nevh_integrator *const *const schemes[] = {
        &nevh_verlet, &nevh_blanes_moan4, &nevh_gauss8, &nevh_tao4};
    ck_assert_int_eq(judge(*schemes[_i], regular), HARD_BOUNDED);
    ck_assert_int_eq(judge(*schemes[_i], fine), HARD_BOUNDED);
    ck_assert_int_eq(judge(*schemes[_i], planets), HARD_BOUNDED);
    ck_assert_int_eq(judge(nevh_rk4, "rotating pendulum"), HARD_DRIFTS);
}

/* One weight off: of order 1 then, though symplectic, so that the energy keeps
   in bounds all the same. */
static hard_verdict spoiled(const nevh_integrator *scheme, size_t which,
                            long double by, const char *name) {
    nevh_splitting splitting = *(const nevh_splitting *)scheme->table;
    nevh_integrator bad = *scheme;
    long double weights[40];
    ck_assert_uint_le(splitting.count, 40);
    memcpy(weights, splitting.weights, splitting.count * sizeof *weights);
    weights[which] += by;
    splitting.weights = weights;
    bad.table = &splitting;
    return judge(&bad, name);
}

TEST(spoiled_weights) {
    ck_assert_int_le(spoiled(nevh_blanes_moan4, 0, 1e-3L, fine), HARD_WRONG);
    ck_assert_int_le(spoiled(nevh_blanes_moan6, 2, 1e-3L, fine), HARD_WRONG);
    ck_assert_int_le(spoiled(nevh_forest_ruth, 0, 1e-3L, fine), HARD_WRONG);
    ck_assert_int_le(spoiled(nevh_yoshida6, 1, 1e-3L, fine), HARD_WRONG);
}

/* Verlet's with a first kick that is too long: sums are right, order is 1. */
TEST(spoiled_verlet) {
    static const long double weights[] = {0.6L};
    static const nevh_splitting splitting = {NEVH_KICK, NEVH_LISTED, 1,
                                             weights};
    nevh_integrator bad = *nevh_verlet;
    bad.table = &splitting;
    ck_assert_int_le(judge(&bad, fine), HARD_WRONG);
}

TEST(pretends_to_be_symplectic) {
    nevh_integrator bad = *nevh_rk4;
    bad.symplectic = bad.symmetric = NEVH_YES;
    ck_assert_int_le(judge(&bad, "rotating pendulum"), HARD_WRONG);
    ck_assert_int_le(judge(&bad, planets), HARD_WRONG);
}

/* Of another order than it says. */
TEST(pretends_to_be_accurate) {
    nevh_integrator bad = *nevh_midpoint;
    bad.order = 4;
    ck_assert_int_le(judge(&bad, fine), HARD_WRONG);
    bad = *nevh_verlet;
    bad.order = 4;
    ck_assert_int_le(judge(&bad, fine), HARD_WRONG);
}

typedef int step_fn(nevh_work *, double, double, double[], double[]);

static hard_verdict stepping(step_fn *step, const char *name, double budget) {
    nevh_kernel kernel = nevh_gauss_kernel;
    nevh_integrator bad = *nevh_gauss8;
    kernel.step = step;
    bad.kernel = &kernel;
    return judged(&bad, name, budget);
}

/* Exact energy, on an orbit that runs 1e-3 too fast. */
static int hurry(nevh_work *w, double t, double h, double q[], double p[]) {
    return nevh_gauss_kernel.step(w, t, h * (1 + 1e-3), q, p);
}

/* Forgets to move. */
static int rest(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)w, (void)t, (void)h, (void)q, (void)p;
    return NEVH_OK;
}

/* A part of each step is lost. */
static int leak(nevh_work *w, double t, double h, double q[], double p[]) {
    int status = nevh_gauss_kernel.step(w, t, h, q, p);
    p[0] *= 1 - 1e-6;
    return status;
}

static int give_nan(nevh_work *w, double t, double h, double q[], double p[]) {
    int status = nevh_gauss_kernel.step(w, t, h, q, p);
    if (t > 1)
        q[0] = NAN;
    return status;
}

static int give_infinity(nevh_work *w, double t, double h, double q[],
                         double p[]) {
    int status = nevh_gauss_kernel.step(w, t, h, q, p);
    if (t > 1)
        p[0] = INFINITY;
    return status;
}

static int give_up(nevh_work *w, double t, double h, double q[], double p[]) {
    (void)h, (void)q, (void)p;
    return t > 1 ? nevh_work_fail(w, NEVH_EMAXITER, "no reason to give up here")
                 : NEVH_OK;
}

static int explode(nevh_work *w, double t, double h, double q[], double p[]) {
    int status = nevh_gauss_kernel.step(w, t, h, q, p);
    q[0] *= 1.1;
    return status;
}

static int hang(nevh_work *w, double t, double h, double q[], double p[]) {
    volatile bool waits = t > 1; /* not while the limit of h is sought */
    while (waits)
        ;
    return nevh_gauss_kernel.step(w, t, h, q, p);
}

TEST_EACH(wrong_steps, 7) {
    static step_fn *const steps[] = {hurry,         rest,    leak,   give_nan,
                                     give_infinity, give_up, explode};
    ck_assert_int_le(stepping(steps[_i], regular, 1e6), HARD_WRONG);
    ck_assert_int_le(stepping(steps[_i], planets, 1e6), HARD_WRONG);
}

/* The energy alone would not have told. */
TEST(right_energy_on_a_wrong_orbit) {
    ck_assert_int_eq(stepping(hurry, regular, 1e6), HARD_WRONG);
    ck_assert_int_eq(stepping(rest, planets, 1e6), HARD_WRONG);
}

TEST(does_not_return) {
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        stepping(hang, regular, 2e4);
        _exit(TOOL_OK);
    }
    int status;
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFEXITED(status));
    ck_assert_int_eq(WEXITSTATUS(status), TOOL_FAILED);
}
