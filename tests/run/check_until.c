/* nevh tests: runs until a given time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "setting.h"
#include <math.h>
#include <nevh/extend.h>
#include <stdlib.h>
#include <string.h>

/* What an observer is shown. */
enum { MOST_SHOWN = 80 };
typedef struct {
    size_t n, calls, steps[MOST_SHOWN], stop_at;
    double times[MOST_SHOWN];
    state states[MOST_SHOWN];
} album;
static const size_t never = (size_t)-1;

static int record(void *data, size_t step, double t, const double q[],
                  const double p[]) {
    album *a = data;
    ck_assert_uint_lt(a->calls, MOST_SHOWN);
    a->steps[a->calls] = step;
    a->times[a->calls] = t;
    memcpy(a->states[a->calls].q, q, a->n * sizeof *q);
    memcpy(a->states[a->calls].p, p, a->n * sizeof *p);
    a->calls++;
    return step == a->stop_at;
}

static album empty(const problem *b) {
    return (album){.n = b->n, .stop_at = never};
}

static const double h0 = 0.03;
static double step_of(int i) {
    return i % 2 ? -h0 : h0;
}

/* The last time is exactly the end, and steps are those of a run of that many.
   With h a little off, too. */
TEST_EACH(a_whole_number_of_steps, 2 * scheme_count()) {
    setting a = prepare(_i / 2);
    if (a.own_time) {
        put_away(&a);
        skip_test("it chooses its own times");
    }
    const double t0 = a.b->t0, h = step_of(_i), t_end = t0 + 7 * h;
    nevh_stepper *until = stepper_for(&a), *plain = stepper_for(&a);
    state x = start(a.b), y = x;
    album shown = empty(a.b), run = shown;
    nevh_observer watch = {record, &shown, 1}, other = {record, &run, 1};
    ck_assert_int_eq(
        nevh_run_until(until, t0, h * (1 + 4e-10), t_end, x.q, x.p, &watch, 1),
        NEVH_OK);
    nevh_run(plain, t0, (t_end - t0) / 7, 7, y.q, y.p, &other, 1);
    ck_assert_uint_eq(nevh_stepper_taken(until), 7);
    ck_assert_uint_eq(shown.calls, 8);
    ck_assert(shown.times[7] == t_end && nevh_stepper_time(until) == t_end);
    for (int i = 0; i < 7; i++)
        ck_assert(shown.times[i] == run.times[i]);
    assert_same_state(a.b, &x, &y);
    nevh_run(until, t_end, h, 5, x.q, x.p, NULL, 0);
    nevh_run(plain, t_end, h, 5, y.q, y.p, NULL, 0);
    assert_same_state(a.b, &x, &y);
    nevh_stepper_free(until);
    nevh_stepper_free(plain);
    put_away(&a);
}

/* However the product of number and step is rounded. */
TEST(the_last_time_is_exact) {
    const problem *b = &henon_heiles;
    nevh_system *s = b->make();
    nevh_stepper *m = planned(s, b, nevh_verlet, nevh_exact);
    for (int count = 1; count < 120; count++)
        for (int i = 0; i < 6; i++) {
            double t0 = i % 3 == 2 ? -2.7 : i % 3, h = i < 3 ? 0.1 : -1 / 7.0;
            double t_end = t0 + count * h;
            album shown = empty(b);
            nevh_observer watch = {record, &shown, 1000};
            state z = start(b);
            ck_assert_int_eq(
                nevh_run_until(m, t0, h, t_end, z.q, z.p, &watch, 1), NEVH_OK);
            ck_assert_uint_eq(nevh_stepper_taken(m), (size_t)count);
            ck_assert_uint_eq(shown.calls, 2);
            ck_assert(shown.times[1] == t_end);
        }
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* 1e-9 of the number of steps is where adjusting ends. */
TEST(nearly_whole_numbers) {
    static const struct {
        double steps;
        size_t taken;
    } spans[] = {{10 * (1 + 9e-10), 10},
                 {10 * (1 - 9e-10), 10},
                 {10 * (1 + 2e-9), 11},
                 {10 * (1 - 2e-9), 10},
                 {1 - 9e-10, 1},
                 {1 - 2e-9, 1},
                 {1e-12, 1},
                 {0.5, 1},
                 {1.5, 2},
                 {9.999, 10}};
    const problem *b = &henon_heiles;
    nevh_system *s = b->make();
    for (size_t i = 0; i < sizeof spans / sizeof *spans; i++) {
        nevh_stepper *m = planned(s, b, nevh_verlet, nevh_exact);
        nevh_stepper *plain = planned(s, b, nevh_verlet, nevh_exact);
        state x = start(b), y = x;
        double t_end = spans[i].steps * h0;
        ck_assert_int_eq(nevh_run_until(m, 0, h0, t_end, x.q, x.p, NULL, 0), 0);
        ck_assert_uint_eq(nevh_stepper_taken(m), spans[i].taken);
        double tau = 0;
        for (size_t k = 1; k < spans[i].taken; k++, tau += h0)
            nevh_stepper_apply(plain, tau, h0, y.q, y.p);
        nevh_stepper_apply(plain, tau, t_end - tau, y.q, y.p);
        for (size_t k = 0; k < b->n; k++) {
            ck_assert_double_eq_tol(x.q[k], y.q[k], 1e-13);
            ck_assert_double_eq_tol(x.p[k], y.p[k], 1e-13);
        }
        nevh_stepper_free(m);
        nevh_stepper_free(plain);
    }
    nevh_system_free(s);
}

/* The end between two steps: all before is nevh_run's orbit, on which the
   stepper stays; what follows is a step of a copy. */
TEST_EACH(an_end_between_steps, 2 * (scheme_count() + 1)) {
    enum { STEPS = 10, MORE = 6 };
    setting a = prepare(_i / 2);
    const double t0 = a.b->t0, h = step_of(_i);
    nevh_stepper *until = stepper_for(&a), *plain = stepper_for(&a);
    state x = start(a.b), y = x;
    album shown = empty(a.b), run = shown;
    nevh_observer watch = {record, &shown, 1}, other = {record, &run, 1};
    nevh_run(plain, t0, h, STEPS, y.q, y.p, &other, 1);
    double t = a.own_time ? nevh_stepper_time(plain) : t0 + STEPS * h;
    double t_end = t + 0.1 * (t - run.times[STEPS - 1]);
    nevh_stepper *copy = nevh_stepper_copy(plain);
    ck_assert_int_eq(nevh_run_until(until, t0, h, t_end, x.q, x.p, &watch, 1),
                     NEVH_OK);
    ck_assert_uint_eq(nevh_stepper_taken(until), STEPS + 1);
    ck_assert_uint_eq(shown.calls, STEPS + 2);
    for (size_t i = 0; i <= STEPS; i++) {
        ck_assert_uint_eq(shown.steps[i], i);
        ck_assert(shown.times[i] == run.times[i]);
        assert_same_state(a.b, &shown.states[i], &run.states[i]);
    }
    ck_assert(shown.steps[STEPS + 1] == STEPS + 1);
    ck_assert(shown.times[STEPS + 1] == t_end);
    assert_same_state(a.b, &shown.states[STEPS + 1], &x);
    ck_assert(nevh_stepper_time(until) == t);
    if (!a.own_time) {
        state z = y;
        nevh_stepper_apply(copy, t, t_end - t, z.q, z.p);
        assert_same_state(a.b, &x, &z);
    }
    x = y;
    shown.calls = run.calls = 0;
    nevh_run(until, t, h, MORE, x.q, x.p, &watch, 1);
    nevh_run(plain, t, h, MORE, y.q, y.p, &other, 1);
    assert_same_state(a.b, &x, &y);
    for (size_t i = 0; i <= MORE; i++)
        ck_assert(shown.times[i] == run.times[i]);
    nevh_stepper_free(until);
    nevh_stepper_free(plain);
    nevh_stepper_free(copy);
    put_away(&a);
}

/* An end within the first step from a state that is not the last one: nothing
   of the orbit before may be in it. */
TEST_EACH(a_short_way_after_a_jump, scheme_count() + 1) {
    setting a = prepare(_i);
    nevh_stepper *used = stepper_for(&a), *fresh = stepper_for(&a);
    state x = start(a.b), y;
    nevh_run(used, a.b->t0, h0, 10, x.q, x.p, NULL, 0);
    x = start(a.b);
    x.q[0] += 0.25;
    y = x;
    double t_end = a.b->t0 + 0.4 * h0;
    ck_assert_int_eq(
        nevh_run_until(used, a.b->t0, h0, t_end, x.q, x.p, NULL, 0), NEVH_OK);
    ck_assert_int_eq(
        nevh_run_until(fresh, a.b->t0, h0, t_end, y.q, y.p, NULL, 0), NEVH_OK);
    assert_same_state(a.b, &x, &y);
    ck_assert_uint_eq(nevh_stepper_taken(used), 1);
    ck_assert(nevh_stepper_time(used) == a.b->t0);
    nevh_stepper_free(used);
    nevh_stepper_free(fresh);
    put_away(&a);
}

static void assert_same_memory(const nevh_stepper *a, const nevh_stepper *b) {
    size_t size = nevh_stepper_save_size(a);
    char *one = malloc(size), *two = malloc(size);
    nevh_stepper_save(a, one);
    nevh_stepper_save(b, two);
    ck_assert_mem_eq(one, two, size);
    free(one);
    free(two);
}

/* What takes no step leaves the stepper where it was, even if asked from
   elsewhere. */
TEST_EACH(nothing_to_do_and_refusals, scheme_count() + 1) {
    static const double ends[][2] = {
        {h0, 0},        {h0, -1},         {-h0, 1},   {0, 1},
        {0, 0},         {NAN, 1},         {h0, NAN},  {h0, INFINITY},
        {INFINITY, 1},  {-h0, -INFINITY}, {1e-17, 1}, {1e-300, 1e300},
        {-1e-300, -1e8}};
    setting a = prepare(_i);
    nevh_stepper *m = stepper_for(&a), *plain = stepper_for(&a);
    album shown = empty(a.b);
    nevh_observer watch = {record, &shown, 1};
    state x = start(a.b), y = x;
    nevh_run(m, 0, h0, 7, x.q, x.p, NULL, 0);
    nevh_run(plain, 0, h0, 7, y.q, y.p, NULL, 0);
    const double t = nevh_stepper_time(m);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        state z = start(a.b), before = z;
        int status =
            nevh_run_until(m, 0, ends[i][0], ends[i][1], z.q, z.p, &watch, 1);
        ck_assert_msg(status == (i ? NEVH_EINVAL : NEVH_OK), "h = %g to %g: %d",
                      ends[i][0], ends[i][1], status);
        ck_assert_int_eq(nevh_stepper_status(m), status);
        ck_assert(!status || strlen(nevh_stepper_message(m)) > 20);
        ck_assert_uint_eq(nevh_stepper_taken(m), 0);
        ck_assert_uint_eq(shown.calls, 1);
        assert_same_state(a.b, &z, &before);
        ck_assert(nevh_stepper_time(m) == t);
    }
    assert_same_memory(m, plain);
    nevh_run(m, t, h0, 7, x.q, x.p, NULL, 0);
    nevh_run(plain, t, h0, 7, y.q, y.p, NULL, 0);
    assert_same_state(a.b, &x, &y);
    nevh_stepper_free(m);
    nevh_stepper_free(plain);
    put_away(&a);
}

/* First and last once, and every so many in between. */
TEST(observers_and_their_turns) {
    static const struct {
        double steps;
        size_t every, calls, shown[6];
    } turns[] = {{10.4, 4, 4, {0, 4, 8, 11}},
                 {10, 4, 4, {0, 4, 8, 10}},
                 {8, 4, 3, {0, 4, 8}},
                 {8.5, 4, 4, {0, 4, 8, 9}},
                 {7.5, 4, 3, {0, 4, 8}},
                 {0.5, 4, 2, {0, 1}},
                 {0, 4, 1, {0}},
                 {3, 100, 2, {0, 3}},
                 {2.5, 0, 4, {0, 1, 2, 3}}};
    nevh_system *s = driven_pendulum.make();
    nevh_stepper *m = planned(s, &driven_pendulum, nevh_verlet, nevh_exact);
    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
        album shown = empty(&driven_pendulum);
        nevh_observer watch = {record, &shown, turns[i].every};
        state z = start(&driven_pendulum);
        double t_end = 0.3 + turns[i].steps * h0;
        ck_assert_int_eq(nevh_run_until(m, 0.3, h0, t_end, z.q, z.p, &watch, 1),
                         NEVH_OK);
        ck_assert_uint_eq(shown.calls, turns[i].calls);
        for (size_t k = 0; k < shown.calls; k++)
            ck_assert_uint_eq(shown.steps[k], turns[i].shown[k]);
        ck_assert(shown.times[shown.calls - 1] == t_end);
        assert_same_state(&driven_pendulum, &shown.states[shown.calls - 1], &z);
    }
    nevh_stepper_free(m);
    nevh_system_free(s);
}

/* At the start, on the way, and at the end, whole or not. */
TEST_EACH(an_observer_stops_the_run, scheme_count() + 1) {
    setting a = prepare(_i);
    for (size_t stop_at = 0; stop_at < 12; stop_at += stop_at < 10 ? 5 : 1) {
        nevh_stepper *m = stepper_for(&a), *plain = stepper_for(&a);
        album shown = empty(a.b), run = shown;
        nevh_observer watch = {record, &shown, 1}, other = {record, &run, 1};
        state x = start(a.b), y = x;
        nevh_run(plain, a.b->t0, h0, 11, y.q, y.p, &other, 1);
        double t_end = (run.times[10] + run.times[11]) / 2;
        shown.stop_at = stop_at;
        ck_assert_int_eq(
            nevh_run_until(m, a.b->t0, h0, t_end, x.q, x.p, &watch, 1),
            NEVH_STOPPED);
        ck_assert_uint_eq(nevh_stepper_taken(m), stop_at);
        ck_assert_uint_eq(shown.calls, stop_at + 1);
        assert_same_state(a.b, &shown.states[stop_at], &x);
        if (stop_at < 11)
            assert_same_state(a.b, &run.states[stop_at], &x);
        nevh_stepper_free(m);
        nevh_stepper_free(plain);
    }
    put_away(&a);
}

/* A spring that is not defined beyond a time of the user's choosing. */
static double last_time;
static double breaking(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)p, (void)c, (void)params;
    return t > last_time ? NAN : (1 + t) * (q[0] * q[0] / 2 - cos(q[0]));
}

static nevh_system *breaking_spring(void) {
    nevh_system *s = nevh_system_new(1);
    nevh_system_add(s, &(nevh_term){.effect = "T",
                                    .np = 1,
                                    .nc = 1,
                                    .c = (const double[]){1.3},
                                    .value = mass_kinetic});
    nevh_system_add(
        s,
        &(nevh_term){.effect = "V", .nq = 1, .time = true, .value = breaking});
    return s;
}

/* The last good state is kept, with the memory that belongs to it. */
TEST_EACH(a_branch_off_that_fails, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_needs_tolerance(scheme))
        skip_test("it steps beyond the end of a step");
    nevh_system *s = breaking_spring();
    nevh_stepper *m = nevh_stepper_new(s, scheme, NULL);
    nevh_stepper *plain = nevh_stepper_new(s, scheme, NULL);
    album shown = {.n = 1, .stop_at = never}, run = shown;
    nevh_observer watch = {record, &shown, 1}, other = {record, &run, 1};
    double x[] = {0.7, 0.2}, y[] = {0.7, 0.2};
    last_time = INFINITY;
    nevh_run(plain, 0, h0, 5, y, y + 1, &other, 1);
    double t = nevh_stepper_time(plain), part = t - run.times[4];
    /* Just beyond t, where the step that would pass the end still can. */
    bool own = nevh_integrator_own_time(scheme);
    last_time = own ? t + 0.5 * part : t;
    int status = nevh_run_until(m, 0, h0, t + 0.9 * part, x, x + 1, &watch, 1);
    if (status == NEVH_OK) /* it takes no slope but where the step begins */
        ck_assert(nevh_integrator_explicit(scheme) == NEVH_YES &&
                  (nevh_integrator_order(scheme) == 1 || scheme->multistep));
    else if (nevh_stepper_taken(m) == 4) /* it looks beyond its steps' ends */
        ck_assert(nevh_integrator_order(scheme) > 2 &&
                  nevh_integrator_explicit(scheme) == NEVH_YES);
    else {
        ck_assert_int_eq(status, NEVH_EDOM);
        ck_assert(strlen(nevh_stepper_message(m)) > 20);
        ck_assert_uint_eq(nevh_stepper_taken(m), 5);
        ck_assert_uint_eq(shown.calls, 6);
        ck_assert_mem_eq(x, y, sizeof x);
        last_time = INFINITY;
        ck_assert(nevh_stepper_time(m) == t);
        nevh_run(m, t, h0, 5, x, x + 1, NULL, 0);
        nevh_run(plain, t, h0, 5, y, y + 1, NULL, 0);
        ck_assert_mem_eq(x, y, sizeof x);
        ck_assert(nevh_stepper_time(m) == nevh_stepper_time(plain));
    }
    nevh_stepper_free(m);
    nevh_stepper_free(plain);
    nevh_system_free(s);
}

/* And where not a step was taken, the memory of the orbit before. */
TEST_EACH(a_first_branch_off_that_fails, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    if (nevh_integrator_needs_tolerance(scheme))
        skip_test("it steps beyond the end of a step");
    nevh_system *s = breaking_spring();
    nevh_stepper *m = nevh_stepper_new(s, scheme, NULL);
    nevh_stepper *plain = nevh_stepper_new(s, scheme, NULL);
    double x[] = {0.7, 0.2}, y[] = {0.7, 0.2}, z[] = {0.9, 0.1};
    last_time = INFINITY;
    nevh_run(m, 0, h0, 5, x, x + 1, NULL, 0);
    nevh_run(plain, 0, h0, 5, y, y + 1, NULL, 0);
    double t = nevh_stepper_time(plain);
    last_time = 7;
    int status = nevh_run_until(m, 7, h0, 7 + 0.9 * h0, z, z + 1, NULL, 0);
    if (status) {
        ck_assert_int_eq(status, NEVH_EDOM);
        ck_assert(z[0] == 0.9 && z[1] == 0.1);
        ck_assert_uint_eq(nevh_stepper_taken(m), 0);
        ck_assert(nevh_stepper_time(m) == t);
        last_time = INFINITY;
        nevh_run(m, t, h0, 5, x, x + 1, NULL, 0);
        nevh_run(plain, t, h0, 5, y, y + 1, NULL, 0);
        ck_assert_mem_eq(x, y, sizeof x);
    } else
        ck_assert_int_eq(nevh_integrator_order(scheme), 1);
    nevh_stepper_free(m);
    nevh_stepper_free(plain);
    nevh_system_free(s);
}

static double distance(const problem *b, const state *x, const state *y) {
    double most = 0;
    for (size_t k = 0; k < b->n; k++)
        most =
            fmax(most, fmax(fabs(x->q[k] - y->q[k]), fabs(x->p[k] - y->p[k])));
    return most;
}

static state state_at(const problem *b, const nevh_integrator *scheme, double h,
                      double t_end) {
    nevh_system *s = b->make();
    nevh_stepper *m = planned(s, b, scheme, nevh_exact);
    state z = start(b);
    int status = nevh_run_until(m, b->t0, h, t_end, z.q, z.p, NULL, 0);
    ck_assert_msg(status == NEVH_OK, "%s: %s", nevh_integrator_name(scheme),
                  nevh_stepper_message(m));
    nevh_stepper_free(m);
    nevh_system_free(s);
    return z;
}

/* Steps of half the length are better by 2^order or nothing but rounding, at an
   end that is no step; forwards and backwards.  A last step to another time
   would be an error of order 0. */
TEST_EACH(the_state_at_the_end, 2 * scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / 2];
    if (nevh_integrator_needs_tolerance(scheme))
        skip_test("its error does not fall with h");
    for (const problem *const *b = problems; *b; b++) {
        if (!fits(scheme, *b))
            continue;
        double sign = _i % 2 ? -1 : 1, h = sign * 0.00673;
        double t_end = (*b)->t0 + sign * 2.011;
        double gain = pow(2, fmin(nevh_integrator_order(scheme), 4));
        state exact = state_at(*b, nevh_gauss16, h / 2, t_end);
        state z = state_at(*b, scheme, h, t_end);
        double first = distance(*b, &z, &exact);
        z = state_at(*b, scheme, h / 2, t_end);
        double second = distance(*b, &z, &exact);
        ck_assert_msg(second <= 1.5 * first / gain || second < 1e-11,
                      "%s on %s: %.2e, then %.2e", nevh_integrator_name(scheme),
                      (*b)->name, first, second);
        ck_assert_double_lt(second, gain > 2 ? 0.1 : 2);
    }
}
