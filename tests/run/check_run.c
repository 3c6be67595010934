/* nevh tests: steppers, their memory, and the driver.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A problem that the scheme fits, with time in it where possible. */
static const problem *problem_for(const nevh_integrator *scheme) {
    return nevh_integrator_needs(scheme) ? &driven_pendulum : &double_pendulum;
}

typedef struct {
    size_t calls, last_step, stop_at;
    double t0, h;
    bool own_time;
} log_book;

/* Times are t0 + i h to the last bit, unless they are the scheme's own. */
static int record(void *data, size_t step, double t, const double q[],
                  const double p[]) {
    log_book *book = data;
    (void)q, (void)p;
    book->calls++;
    book->last_step = step;
    ck_assert(book->own_time || t == book->t0 + (double)step * book->h);
    return book->stop_at && step == book->stop_at;
}

/* With or without friction; whether the scheme takes it. */
static bool go(const nevh_integrator *scheme, bool friction,
               const nevh_observer watch[], size_t count, state *x) {
    const problem *b = problem_for(scheme);
    if (friction && nevh_integrator_own_time(scheme))
        return false;
    nevh_system *s = b->make();
    if (friction)
        nevh_system_add_friction(s, "drag", (const double[]){0.2, 0.1});
    nevh_stepper *m = planned(s, b, scheme, nevh_central4);
    *x = start(b);
    ck_assert(!nevh_run(m, b->t0, 0.01, 100, x->q, x->p, watch, count));
    nevh_stepper_free(m);
    nevh_system_free(s);
    return true;
}

/* Looked at in each step, in some, or not at all. */
TEST_EACH(watching_changes_nothing, 2 * scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i / 2];
    const problem *b = problem_for(scheme);
    nevh_system *s = b->make();
    nevh_energy *energy = nevh_energy_new(s, NULL);
    log_book often = {
        .t0 = b->t0, .h = 0.01, .own_time = nevh_integrator_own_time(scheme)};
    log_book fifth = often, seventh = often;
    nevh_observer watch[] = {{nevh_energy_observe, energy, 1},
                             {record, &often, 7}};
    nevh_observer two[] = {{record, &fifth, 5}, {record, &seventh, 7}};
    state x, y, z;
    bool goes = go(scheme, _i % 2, NULL, 0, &x);
    if (goes) {
        ck_assert(go(scheme, _i % 2, watch, 2, &y));
        ck_assert(go(scheme, _i % 2, two, 2, &z));
        assert_same_state(b, &x, &y);
        assert_same_state(b, &x, &z);
        ck_assert_uint_eq(often.calls, 1 + 14 + 1);
        ck_assert_uint_eq(fifth.calls, 1 + 20);
        ck_assert_uint_eq(seventh.calls, 1 + 14 + 1);
        ck_assert_uint_eq(often.last_step, 100);
        ck_assert_uint_eq(seventh.last_step, 100);
    }
    nevh_energy_free(energy);
    nevh_system_free(s);
    if (!goes)
        skip_test("friction is refused");
}

/* One run, two runs in a row, and single steps are the same orbit. */
TEST_EACH(pieces_make_the_whole, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double h = 0.0078125; /* so that t0 + i h is the sum of steps */
    nevh_system *s = b->make();
    nevh_stepper *stepper[3];
    state z[3];
    for (int k = 0; k < 3; k++) {
        stepper[k] = planned(s, b, scheme, nevh_central2);
        z[k] = start(b);
    }
    nevh_run(stepper[0], 0.25, h, 60, z[0].q, z[0].p, NULL, 0);
    nevh_run(stepper[1], 0.25, h, 25, z[1].q, z[1].p, NULL, 0);
    double t = time_on(stepper[1], scheme, 0.25 + 25 * h);
    nevh_run(stepper[1], t, h, 35, z[1].q, z[1].p, NULL, 0);
    nevh_stepper_apply(stepper[2], 0.25, h, z[2].q, z[2].p);
    for (int i = 1; i < 60; i++) {
        t = time_on(stepper[2], scheme, 0.25 + i * h);
        nevh_stepper_apply(stepper[2], t, h, z[2].q, z[2].p);
    }
    assert_same_state(b, &z[0], &z[1]);
    assert_same_state(b, &z[0], &z[2]);
    for (int k = 0; k < 3; k++)
        nevh_stepper_free(stepper[k]);
    nevh_system_free(s);
}

/* A copy branches off and leaves the first alone; a saved memory continues bit
   for bit in another stepper; without the memory the last bits differ. */
TEST_EACH(memory_can_be_kept, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    const double h = 0.02;
    nevh_system *s = b->make();
    nevh_stepper *first = planned(s, b, scheme, nevh_central4);
    nevh_stepper *other = planned(s, b, scheme, nevh_central4);
    state x = start(b);
    nevh_run(first, b->t0, h, 40, x.q, x.p, NULL, 0);
    double t1 = time_on(first, scheme, b->t0 + 40 * h);
    state y = x, z = x, branch = x;
    size_t size = nevh_stepper_save_size(first);
    void *buffer = malloc(size);
    nevh_stepper_save(first, buffer);
    nevh_stepper *copy = nevh_stepper_copy(first);
    nevh_run(copy, t1, h / 3, 5, branch.q, branch.p, NULL, 0);
    nevh_run(first, t1, h, 40, x.q, x.p, NULL, 0);
    ck_assert_int_eq(nevh_stepper_load(other, buffer, size), NEVH_OK);
    nevh_run(other, t1, h, 40, y.q, y.p, NULL, 0);
    assert_same_state(b, &x, &y);
    ck_assert_int_eq(nevh_stepper_load(copy, buffer, size), NEVH_OK);
    nevh_run(copy, t1, h, 40, z.q, z.p, NULL, 0);
    assert_same_state(b, &x, &z);
    ck_assert_int_eq(nevh_stepper_load(other, buffer, size - 1), NEVH_EINVAL);
    memset(buffer, 1, size);
    ck_assert_int_eq(nevh_stepper_load(other, buffer, size), NEVH_EINVAL);
    free(buffer);
    nevh_stepper_free(first);
    nevh_stepper_free(other);
    nevh_stepper_free(copy);
    nevh_system_free(s);
}

/* A stepper that is moved to another state starts afresh there. */
TEST_EACH(jumps_start_afresh, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    nevh_system *s = b->make();
    nevh_stepper *used = planned(s, b, scheme, nevh_central4);
    nevh_stepper *fresh = planned(s, b, scheme, nevh_central4);
    state x = start(b), y;
    nevh_run(used, b->t0, 0.02, 30, x.q, x.p, NULL, 0);
    x.q[0] += 0.125;
    y = x;
    nevh_run(used, b->t0 + 0.6, 0.02, 30, x.q, x.p, NULL, 0);
    nevh_run(fresh, b->t0 + 0.6, 0.02, 30, y.q, y.p, NULL, 0);
    assert_same_state(b, &x, &y);
    nevh_stepper_free(used);
    nevh_stepper_free(fresh);
    nevh_system_free(s);
}

TEST_EACH(own_time_takes_one_orbit, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = problem_for(scheme);
    if (!nevh_integrator_own_time(scheme))
        skip_test("it takes orbits side by side");
    nevh_system *s = b->make();
    nevh_options options = {.width = 2};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    ck_assert_int_eq(nevh_stepper_status(m), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_stepper_message(m), "one orbit"));
    nevh_stepper_free(m);
    nevh_system_free(s);
}

TEST(an_observer_stops_the_run) {
    const problem *b = &henon_heiles;
    nevh_system *s = b->make();
    nevh_stepper *stepper = planned(s, b, nevh_verlet, nevh_exact);
    log_book book = {.stop_at = 12, .t0 = 1, .h = -0.05};
    nevh_observer watch = {record, &book, 1};
    state x = start(b), y = start(b);
    int status = nevh_run(stepper, 1, -0.05, 40, x.q, x.p, &watch, 1);
    ck_assert_int_eq(status, NEVH_STOPPED);
    ck_assert_uint_eq(nevh_stepper_taken(stepper), 12);
    ck_assert_int_gt((int)strlen(nevh_stepper_message(stepper)), 0);
    nevh_stepper_reset(stepper);
    nevh_run(stepper, 1, -0.05, 12, y.q, y.p, NULL, 0);
    assert_same_state(b, &x, &y);
    ck_assert_int_eq(nevh_run(stepper, 0, 1, 0, x.q, x.p, &watch, 0), NEVH_OK);
    assert_same_state(b, &x, &y);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
}
