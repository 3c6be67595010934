/* nevh tests: runs whose states at given times are kept.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "setting.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 7, TIMES = 9 };
/* In steps: on steps, between them, twice the same, and the end. */
static const double places[TIMES] = {0, 0, 0.25, 1, 2.5, 2.75, 2.75, 6.9, 7};

/* A setting, and times on a run of it, forward or backward. */
typedef struct {
    setting in;
    const problem *b;
    double h, t_end, times[TIMES];
} timed;

static timed prepare_times(int i) {
    timed a = {.in = prepare(i / 2)};
    a.b = a.in.b;
    a.t_end = a.b->t0 + (i % 2 ? -0.21 : 0.21);
    a.h = (a.t_end - a.b->t0) / STEPS;
    for (int k = 0; k < TIMES; k++)
        a.times[k] = a.b->t0 + places[k] * a.h;
    a.times[TIMES - 1] = a.t_end;
    return a;
}

static state kept_state(const problem *b, const double states[], size_t i) {
    state x = {0};
    for (size_t k = 0; k < b->n; k++) {
        x.q[k] = states[k * TIMES + i];
        x.p[k] = states[(b->n + k) * TIMES + i];
    }
    return x;
}

/* By whole steps where the time is that of one: the sum t0 + h is rounded. */
static void run_to_place(const timed *a, nevh_stepper *alone, size_t i,
                         state *x) {
    double t0 = a->b->t0;
    bool whole =
        !a->in.own_time && i < TIMES - 1 && places[i] == rint(places[i]);
    int status =
        whole
            ? nevh_run(alone, t0, a->h, (size_t)places[i], x->q, x->p, NULL, 0)
            : nevh_run_until(alone, t0, a->h, a->times[i], x->q, x->p, NULL, 0);
    ck_assert_int_eq(status, NEVH_OK);
}

/* Each state is that of a run which ends there, to the last bit, and the end
   that of a run which keeps nothing. */
TEST_EACH(states_are_those_of_runs_that_end_there, 2 * (scheme_count() + 1)) {
    timed a = prepare_times(_i);
    double states[2 * MOST_DOF * TIMES];
    size_t kept = 99;
    nevh_stepper *m = stepper_for(&a.in);
    state end = start(a.b);
    ck_assert_int_eq(nevh_run_at(m, a.b->t0, a.h, a.t_end, a.times, TIMES,
                                 states, &kept, end.q, end.p, NULL, 0),
                     NEVH_OK);
    ck_assert_uint_eq(kept, TIMES);
    for (size_t i = 0; i < TIMES; i++) {
        nevh_stepper *alone = stepper_for(&a.in);
        state x = start(a.b), y = kept_state(a.b, states, i);
        run_to_place(&a, alone, i, &x);
        assert_same_state(a.b, &x, &y);
        if (i == TIMES - 1) {
            assert_same_state(a.b, &x, &end);
            ck_assert_uint_eq(nevh_stepper_taken(m), nevh_stepper_taken(alone));
            ck_assert(nevh_stepper_time(m) == nevh_stepper_time(alone));
        }
        nevh_stepper_free(alone);
    }
    nevh_stepper_free(m);
    put_away(&a.in);
}

/* After a run that branched off often, the next one is that of a stepper which
   never did. */
TEST_EACH(memory_stays_with_the_orbit, 2 * (scheme_count() + 1)) {
    timed a = prepare_times(_i);
    double states[2 * MOST_DOF * TIMES];
    nevh_stepper *m = stepper_for(&a.in), *plain = stepper_for(&a.in);
    state x = start(a.b), y = x;
    nevh_run_at(m, a.b->t0, a.h, a.t_end, a.times, TIMES, states, NULL, x.q,
                x.p, NULL, 0);
    nevh_run_until(plain, a.b->t0, a.h, a.t_end, y.q, y.p, NULL, 0);
    nevh_run(m, nevh_stepper_time(m), a.h, 5, x.q, x.p, NULL, 0);
    nevh_run(plain, nevh_stepper_time(plain), a.h, 5, y.q, y.p, NULL, 0);
    assert_same_state(a.b, &x, &y);
    nevh_stepper_free(m);
    nevh_stepper_free(plain);
    put_away(&a.in);
}

static int stop_after_three(void *data, size_t step, double t, const double q[],
                            const double p[]) {
    (void)data, (void)t, (void)q, (void)p;
    return step == 3;
}

TEST(a_run_that_is_stopped_keeps_what_came_before) {
    timed a = prepare_times(2 * 2);
    double states[2 * MOST_DOF * TIMES];
    size_t kept;
    nevh_observer stop = {stop_after_three, NULL, 1};
    nevh_stepper *m = stepper_for(&a.in);
    state x = start(a.b);
    ck_assert_int_eq(nevh_run_at(m, a.b->t0, a.h, a.t_end, a.times, TIMES,
                                 states, &kept, x.q, x.p, &stop, 1),
                     NEVH_STOPPED);
    ck_assert_uint_eq(kept, 7); /* those before step 3 */
    nevh_stepper_free(m);
    put_away(&a.in);
}

TEST(times_out_of_order_or_outside_are_refused) {
    static const double wrong[][3] = {{0.05, 0.02, 0.06},
                                      {-0.01, 0.02, 0.03},
                                      {0.01, 0.02, 0.3},
                                      {0.01, NAN, 0.02}};
    timed a = prepare_times(2 * 2);
    double states[2 * MOST_DOF * 3], t0 = a.b->t0;
    nevh_stepper *m = stepper_for(&a.in);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        size_t kept = 99;
        state x = start(a.b), before = x;
        double times[3] = {t0 + wrong[i][0], t0 + wrong[i][1],
                           t0 + wrong[i][2]};
        ck_assert_int_eq(nevh_run_at(m, t0, a.h, a.t_end, times, 3, states,
                                     &kept, x.q, x.p, NULL, 0),
                         NEVH_EINVAL);
        ck_assert(strstr(nevh_stepper_message(m), "not between"));
        ck_assert_uint_eq(kept, 0);
        assert_same_state(a.b, &x, &before);
    }
    nevh_stepper_free(m);
    put_away(&a.in);
}

/* What a run of nevh_orbit calls: the states of its samples. */
typedef struct {
    const timed *a;
    double t[TIMES];
    state x[TIMES];
    size_t count, stop_at;
} samples;

static int take_sample(void *data, size_t i, double t, const double q[],
                       const double p[]) {
    samples *s = data;
    ck_assert_uint_lt(i, TIMES);
    s->t[i] = t;
    for (size_t k = 0; k < s->a->b->n; k++) {
        s->x[i].q[k] = q[k];
        s->x[i].p[k] = p[k];
    }
    s->count++;
    return i + 1 == s->stop_at;
}

/* Saves the run after some steps, and ends it. */
typedef struct {
    nevh_stepper *stepper;
    size_t at, step, samples;
    const samples *taken;
    double t;
    state x;
    size_t n;
    void *memory;
} saver;

static int save(void *data, size_t step, double t, const double q[],
                const double p[]) {
    saver *s = data;
    if (step != s->at)
        return 0;
    s->step = step;
    s->samples = s->taken->count;
    s->t = t;
    for (size_t k = 0; k < s->n; k++) {
        s->x.q[k] = q[k];
        s->x.p[k] = p[k];
    }
    nevh_stepper_save(s->stepper, s->memory);
    return 1;
}

static int do_nothing(void *data, size_t step, double t, const double q[],
                      const double p[]) {
    (void)data, (void)step, (void)t, (void)q, (void)p;
    return 0;
}

static nevh_orbit orbit_of(const timed *a, samples *s) {
    return (nevh_orbit){.t0 = a->b->t0,
                        .h = a->h,
                        .t_end = a->t_end,
                        .times = a->times,
                        .n_times = TIMES,
                        .sample = take_sample,
                        .sample_data = s};
}

/* A run that an observer saves and ends is continued by another stepper: all
   samples and the end are those of a run without a break. */
TEST_EACH(saved_runs_continue, 2 * (scheme_count() + 1)) {
    timed a = prepare_times(_i);
    nevh_stepper *m = stepper_for(&a.in), *other = stepper_for(&a.in);
    samples whole = {.a = &a}, parts = whole;
    state x = start(a.b), y = x;
    nevh_orbit one = orbit_of(&a, &whole), two = orbit_of(&a, &parts);
    ck_assert_int_eq(nevh_orbit_run(m, &one, x.q, x.p), NEVH_OK);
    saver s = {.stepper = other,
               .at = 2,
               .taken = &parts,
               .n = a.b->n,
               .memory = malloc(nevh_stepper_save_size(other))};
    nevh_observer observer = {save, &s, 1};
    two.observers = &observer;
    two.n_observers = 1;
    ck_assert_int_eq(nevh_orbit_run(other, &two, y.q, y.p), NEVH_STOPPED);
    ck_assert_uint_eq(s.step, 2);
    nevh_stepper_free(other);
    other = stepper_for(&a.in);
    ck_assert_int_eq(
        nevh_stepper_load(other, s.memory, nevh_stepper_save_size(other)),
        NEVH_OK);
    two.n_observers = 0;
    two.steps_before = s.step;
    two.samples_before = s.samples;
    two.t_before = s.t;
    ck_assert_int_eq(nevh_orbit_run(other, &two, s.x.q, s.x.p), NEVH_OK);
    ck_assert_uint_eq(nevh_stepper_taken(other), nevh_stepper_taken(m));
    assert_same_state(a.b, &x, &s.x);
    for (size_t i = 0; i < TIMES; i++) {
        ck_assert(whole.t[i] == a.times[i] && parts.t[i] == a.times[i]);
        assert_same_state(a.b, &whole.x[i], &parts.x[i]);
    }
    free(s.memory);
    nevh_stepper_free(m);
    nevh_stepper_free(other);
    put_away(&a.in);
}

/* Long runs with few samples, which take steps in batches. */
TEST_EACH(samples_at_equal_distances, 2 * (scheme_count() + 1)) {
    timed a = prepare_times(_i);
    enum { SPAN = 40 };
    double h = a.h, t0 = a.b->t0, t_end = t0 + SPAN * 0.99 * h;
    nevh_stepper *m = stepper_for(&a.in), *n = stepper_for(&a.in);
    samples s = {.a = &a};
    double times[3] = {t0, t0 + (t_end - t0) * 0.5, t_end};
    double states[2 * MOST_DOF * 3];
    state x = start(a.b), y = x;
    nevh_orbit o = {.t0 = t0,
                    .h = h,
                    .t_end = t_end,
                    .n_times = 3,
                    .sample = take_sample,
                    .sample_data = &s};
    int status = nevh_orbit_run(m, &o, x.q, x.p);
    nevh_observer each = {do_nothing, NULL, 1};
    ck_assert_int_eq(nevh_run_at(n, t0, h, t_end, times, 3, states, NULL, y.q,
                                 y.p, &each, 1),
                     status);
    assert_same_state(a.b, &x, &y);
    ck_assert(status || s.count == 3);
    for (size_t i = 0; i < s.count; i++)
        for (size_t k = 0; k < a.b->n; k++) {
            ck_assert(s.t[i] == times[i]);
            ck_assert(s.x[i].q[k] == states[k * 3 + i]);
            ck_assert(s.x[i].p[k] == states[(a.b->n + k) * 3 + i]);
        }
    nevh_stepper_free(m);
    nevh_stepper_free(n);
    put_away(&a.in);
}

TEST(a_sample_ends_a_run) {
    timed a = prepare_times(2 * 2);
    nevh_stepper *m = stepper_for(&a.in);
    samples s = {.a = &a, .stop_at = 5};
    state x = start(a.b);
    nevh_orbit o = orbit_of(&a, &s);
    ck_assert_int_eq(nevh_orbit_run(m, &o, x.q, x.p), NEVH_STOPPED);
    ck_assert_uint_eq(s.count, 5);
    ck_assert_uint_eq(nevh_stepper_taken(m), 2);
    ck_assert(
        strstr(nevh_stepper_message(m), "sample 4 stopped the run at t = "));
    o.n_times = 1;
    o.times = NULL;
    ck_assert_int_eq(nevh_orbit_run(m, &o, x.q, x.p), NEVH_EINVAL);
    nevh_stepper_free(m);
    put_away(&a.in);
}

/* Of a run that is over there is nothing left to do, also where its end lies between
   steps. */
TEST_EACH(runs_that_are_over_end_at_once, 2 * (scheme_count() + 1)) {
    timed a = prepare_times(_i);
    double t_end = a.b->t0 + 2.5 * a.h;
    nevh_stepper *m = stepper_for(&a.in);
    state x = start(a.b), y;
    nevh_orbit o = {.t0 = a.b->t0, .h = a.h, .t_end = t_end};
    ck_assert_int_eq(nevh_orbit_run(m, &o, x.q, x.p), NEVH_OK);
    o.steps_before = nevh_stepper_taken(m);
    o.t_before = t_end;
    y = x;
    ck_assert_int_eq(nevh_orbit_run(m, &o, y.q, y.p), NEVH_OK);
    assert_same_state(a.b, &x, &y);
    ck_assert_uint_eq(nevh_stepper_taken(m), o.steps_before);
    nevh_stepper_free(m);
    put_away(&a.in);
}
