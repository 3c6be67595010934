/* nevh tests: measurements, and how suites are run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "support.h"
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

int order_on(const problem *b, const nevh_integrator *scheme) {
    if (scheme == nevh_itoh_abe && b->n == 1 && b->separable)
        return 2;
    return nevh_integrator_order(scheme);
}

bool fits(const nevh_integrator *scheme, const problem *b) {
    unsigned needs = nevh_integrator_needs(scheme);
    return (b->separable || !(needs & NEVH_SEPARABLE)) &&
           (b->quadratic || !(needs & NEVH_QUADRATIC_KINETIC)) &&
           ((b->separable && b->quadratic) || !(needs & NEVH_PARTS));
}

double tolerance_for(const nevh_integrator *scheme) {
    return nevh_integrator_needs_tolerance(scheme) ? 1e-12 : 0;
}

nevh_stepper *planned(nevh_system *s, const problem *b,
                      const nevh_integrator *scheme, const nevh_gradient *g) {
    nevh_options options = {.gradient = g,
                            .t = b->t0,
                            .q = b->q,
                            .p = b->p,
                            .tolerance = tolerance_for(scheme)};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    ck_assert_msg(nevh_stepper_status(stepper) == NEVH_OK, "%s on %s: %s",
                  nevh_integrator_name(scheme), b->name,
                  nevh_stepper_message(stepper));
    return stepper;
}

/* Starting states side by side, taken along the problem's orbit, so that the
   sign changes of one orbit's error constant average out. */
enum { LANES = 12 };
typedef struct {
    size_t every; /* lanes that are run */
    double q[MOST_DOF * LANES], p[MOST_DOF * LANES];
} bundle;

static bundle start_of(const problem *b) {
    bundle z = {.every = 1};
    nevh_system *s = b->make();
    nevh_stepper *stepper = planned(s, b, nevh_gauss16, nevh_exact);
    double q[MOST_DOF], p[MOST_DOF], h = b->span / 4 / LANES;
    memcpy(q, b->q, sizeof q);
    memcpy(p, b->p, sizeof p);
    for (size_t lane = 0; lane < LANES; lane++) {
        for (size_t k = 0; k < b->n; k++) {
            z.q[k * LANES + lane] = q[k];
            z.p[k * LANES + lane] = p[k];
        }
        nevh_run(stepper, b->t0, h, 4, q, p, NULL, 0);
    }
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return z;
}

/* One lane of it by a stepper of width 1, whose steps take their own time. */
static bool run_lane(const problem *b, nevh_stepper *stepper, double steps,
                     size_t lane, bundle *z) {
    double q[MOST_DOF], p[MOST_DOF];
    for (size_t k = 0; k < b->n; k++) {
        q[k] = z->q[k * LANES + lane];
        p[k] = z->p[k * LANES + lane];
    }
    int status = nevh_run_until(stepper, b->t0, b->span / steps,
                                b->t0 + b->span, q, p, NULL, 0);
    for (size_t k = 0; k < b->n; k++) {
        z->q[k * LANES + lane] = q[k];
        z->p[k * LANES + lane] = p[k];
    }
    return status == NEVH_OK;
}

static bool run_lanes(const problem *b, const nevh_integrator *scheme,
                      const nevh_gradient *g, double steps, bundle *z) {
    nevh_system *s = b->make();
    nevh_stepper *stepper = planned(s, b, scheme, g);
    bool all = true;
    for (size_t lane = 0; all && lane < LANES; lane += z->every)
        all = run_lane(b, stepper, steps, lane, z);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return all;
}

/* The bundle after the problem's span; false where a step fails. */
static bool run_bundle(const problem *b, const nevh_integrator *scheme,
                       const nevh_gradient *g, double steps, bundle *z) {
    if (nevh_integrator_own_time(scheme))
        return run_lanes(b, scheme, g, steps, z);
    nevh_system *s = b->make();
    nevh_options options = {
        .gradient = g, .t = b->t0, .q = z->q, .p = z->p, .width = LANES};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    int status = nevh_run(stepper, b->t0, b->span / steps, (size_t)steps, z->q,
                          z->p, NULL, 0);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return status == NEVH_OK;
}

static double distance(const problem *b, const bundle *x, const bundle *y) {
    double sum = 0;
    for (size_t i = 0; i < b->n * LANES; i += x->every)
        sum += (x->q[i] - y->q[i]) * (x->q[i] - y->q[i]) +
               (x->p[i] - y->p[i]) * (x->p[i] - y->p[i]);
    return sqrt(sum / (double)LANES);
}

/* A log-log line. */
enum { POINTS = 40, STRETCH = 5 };
typedef struct {
    int count;
    double x[POINTS], y[POINTS];
} line;

/* The slope through a few neighbouring points; their scatter by reference. */
static double slope(int points, const double x[], const double y[],
                    double *scatter) {
    double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
    for (int i = 0; i < points; i++) {
        mx += x[i] / points;
        my += y[i] / points;
    }
    for (int i = 0; i < points; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
        yy += (y[i] - my) * (y[i] - my);
    }
    *scatter = yy - xy * xy / xx;
    return xy / xx;
}

/* Of the straightest stretch: large steps do not follow the power law yet, small
   ones are lost in rounding, and both scatter. */
static double straightest(const line *l, int stretch) {
    double best = INFINITY, found = NAN, scatter;
    for (int i = 0; i + stretch <= l->count; i++) {
        double one = slope(stretch, l->x + i, l->y + i, &scatter);
        if (scatter < best) {
            best = scatter;
            found = one;
        }
    }
    return found;
}

/* Orders 9 and 10 follow their power law only just above rounding. */
static double least_error(int order) {
    if (order <= 5)
        return order == 5 ? 1e-11 : 1e-9;
    return order <= 8 || order > 10 ? 1e-13 : 1e-14;
}

double measured_order(const problem *b, const nevh_integrator *scheme,
                      const nevh_gradient *g) {
    const int order = nevh_integrator_order(scheme);
    const double above = order == 1   ? 2e-1
                         : order == 2 ? 1e-3
                         : order <= 8 ? 1e-4
                                      : 1e-6;
    const double below = least_error(order);
    const double factor = fmin(1.6, pow(10, 0.5 / order));
    const int most = order == 1 ? STRETCH + 3 : order == 2 ? STRETCH : POINTS;
    bundle z, start = start_of(b), reference = start;
    start.every = nevh_integrator_own_time(scheme) ? 3 : 1;
    ck_assert(run_bundle(b, nevh_gauss16, nevh_exact, 400, &reference));
    line l = {0};
    for (double steps = b->fewest; steps < 4e5 && l.count < most;
         steps = fmax(steps * factor, steps + 1)) {
        double count = round(steps), error = INFINITY;
        z = start;
        if (run_bundle(b, scheme, g, count, &z))
            error = distance(b, &z, &reference);
        if (error < below)
            break;
        if (error < above) {
            l.x[l.count] = -log(count);
            l.y[l.count++] = log(error);
        }
    }
    ck_assert_msg(l.count >= (order <= 10 ? STRETCH : 4),
                  "%s on %s: only %d points", nevh_integrator_name(scheme),
                  b->name, l.count);
    return straightest(&l, order <= 10 ? STRETCH : l.count);
}

nevh_energy_report energy_of(const problem *b, const nevh_integrator *scheme,
                             const nevh_gradient *g, double h, size_t steps) {
    nevh_system *s = b->make();
    nevh_stepper *stepper = planned(s, b, scheme, g ? g : nevh_exact);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    double q[MOST_DOF], p[MOST_DOF];
    for (size_t k = 0; k < b->n; k++) {
        q[k] = b->q[k];
        p[k] = b->p[k];
    }
    int status = nevh_run(stepper, b->t0, h, steps, q, p, &watch, 1);
    ck_assert_msg(status == NEVH_OK, "%s on %s: %s",
                  nevh_integrator_name(scheme), b->name,
                  nevh_stepper_message(stepper));
    nevh_energy_report report = nevh_energy_result(energy, 0);
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return report;
}

double time_on(const nevh_stepper *m, const nevh_integrator *scheme, double t) {
    return nevh_integrator_own_time(scheme) ? nevh_stepper_time(m) : t;
}

double slope_through(int count, const double x[], const double y[]) {
    double mx = 0, my = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; i++) {
        mx += x[i] / count;
        my += y[i] / count;
    }
    for (int i = 0; i < count; i++) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
    }
    return xy / xx;
}

int registered_count(void) {
    int count = 0;
    while (nevh_integrators()[count])
        count++;
    return count;
}

int scheme_count(void) {
    int count = registered_count();
    while (nevh_integrator_needs_formulas(nevh_integrators()[count - 1]))
        count--;
    return count;
}

int model_count(void) {
    int count = 0;
    while (nevh_models()[count])
        count++;
    return count;
}

/* The line of the sources at which a test was seen last, or "". */
static void last_line(TestResult *result, char text[256]) {
    FILE *file = tr_lfile(result) ? fopen(tr_lfile(result), "r") : NULL;
    text[0] = 0;
    for (int i = 0; file && i < tr_lno(result); i++)
        if (!fgets(text, 256, file))
            text[0] = 0;
    if (file)
        fclose(file);
}

/* Check passes a test that returns without an assertion.  Such a test was seen
   last at its TEST, and one that skips at its skip_test. */
static bool asserted(TestResult *result, int *skips) {
    char text[256];
    if (tr_rtype(result) != CK_PASS)
        return true;
    last_line(result, text);
    *skips += strstr(text, "skip_test(") != NULL;
    if (strncmp(text, "TEST", 4) != 0)
        return true;
    printf("%s:%d: a test asserted nothing: %s", tr_lfile(result),
           tr_lno(result), text);
    return false;
}

static test_entry *registered;

void register_test(test_entry *entry) {
    test_entry **at = &registered;
    while (*at && (*at)->line < entry->line)
        at = &(*at)->next;
    entry->next = *at;
    *at = entry;
}

/* Seconds that a test may take where all are in one process; 0: Check's timer
   ends those that have a process each. */
static unsigned limit;

static void limit_test(void) {
    if (limit == 0)
        return;
    signal(SIGALRM, SIG_DFL); /* Check's handler would kill the process group */
    alarm(limit);
}

static void add_test(Suite *suite, const test_entry *entry) {
    TCase *cases = tcase_create((*entry->test)->name);
    if (entry->tag)
        tcase_set_tags(cases, entry->tag);
    tcase_add_checked_fixture(cases, limit_test, NULL);
    tcase_add_loop_test(cases, *entry->test, entry->from, entry->until());
    suite_add_tcase(suite, cases);
}

static int run(SRunner *runner) {
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner), skips = 0;
    TestResult **results = srunner_results(runner);
    for (int i = 0; i < srunner_ntests_run(runner); i++)
        failed += !asserted(results[i], &skips);
    free(results);
    srunner_free(runner);
    if (skips)
        printf("skipped: %d\n", skips);
    return failed;
}

/* What the process of all tests returns at its end; neither is the status of a
   test that ends it, or of a sanitizer. */
enum { ALL_PASSED = 93, SOME_FAILED = 94 };

/* Runs all tests in one process, since a process each is most of the time of
   short ones.  Returns its status, or -1 where a signal ended it. */
static int run_together(SRunner *runner) {
    const char *seconds = getenv("CK_DEFAULT_TIMEOUT");
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        limit = seconds ? (unsigned)atoi(seconds) : 4;
        srunner_set_fork_status(runner, CK_NOFORK);
        exit(run(runner) == 0 ? ALL_PASSED : SOME_FAILED);
    }
    int status;
    if (child < 0 || waitpid(child, &status, 0) < 0 || !WIFEXITED(status))
        return -1;
    return WEXITSTATUS(status);
}

int main(int argc, char **argv) {
    (void)argc;
    const char *slash = strrchr(argv[0], '/');
    Suite *suite = suite_create(slash ? slash + 1 : argv[0]);
    for (const test_entry *entry = registered; entry; entry = entry->next)
        add_test(suite, entry);
    SRunner *runner = srunner_create(suite);
    if (getenv("CK_FORK"))
        return run(runner) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
    int status = run_together(runner);
    if (status == ALL_PASSED)
        return EXIT_SUCCESS;
    if (status != SOME_FAILED) {
        puts("A test ended the process of all tests; now each has its own.");
        run(runner);
    }
    return EXIT_FAILURE;
}
