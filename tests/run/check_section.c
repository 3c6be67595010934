/* nevh tests: points of sections.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "section.h"

/* All of them, at their times, in their directions; whatever the step. */
TEST_EACH(an_oscillator_crosses_twice_a_period, 3) {
    static const double steps[] = {0.01, 0.3, 1.1};
    const nevh_section is[] = {{.value = coordinate},
                               {.value = coordinate, .direction = 1},
                               {.value = coordinate, .direction = -1}};
    orbit *o = on_circle(0, is, 3);
    enum { turns = 50 };
    ck_assert_int_eq(go(o, steps[_i], turns * 2 * pi), NEVH_OK);
    for (size_t section = 0; section < 3; section++) {
        const int only = is[section].direction;
        ck_assert_uint_eq(count_of(&o->found, section, 1),
                          only == -1 ? 0 : turns);
        ck_assert_uint_eq(count_of(&o->found, section, -1),
                          only == 1 ? 0 : turns);
    }
    for (size_t i = 0; i < o->found.count; i++) {
        const double t = pi / 2 + (double)(i / 2) * pi;
        ck_assert_double_eq_tol(o->found.at[i].t, t, 1e-11);
        ck_assert_double_le(fabs(o->found.at[i].q[0]), 1e-15);
        ck_assert(o->found.at[i].direction * o->found.at[i].p[0] > 0.99);
    }
    put_away(o);
}

/* A level just below the largest x is crossed twice within a step, one just
   above never; x turns anywhere within a step and close to its ends. */
TEST_EACH(touching_and_grazing, 12) {
    static const double distances[] = {1e-3, 1e-6, 1e-9, 1e-12};
    static const double steps[] = {0.9, 2 * pi / 8 * (1 + 1e-7), 0.05};
    const double d = distances[_i % 4], h = steps[_i / 4];
    double below = 1 - d, above = 1 + d;
    const nevh_section is[] = {{.value = coordinate, .data = &below},
                               {.value = coordinate, .data = &above},
                               {.value = momentum, .data = &above}};
    orbit *o = on_circle(1, is, 3);
    const int turns = h < 0.1 ? 20 : 100;
    ck_assert_int_eq(go(o, h, 1 + turns * 2 * pi), NEVH_OK);
    ck_assert_uint_eq(count_of(&o->found, 0, 1), turns);
    ck_assert_uint_eq(count_of(&o->found, 0, -1), turns);
    ck_assert_uint_eq(o->found.count, 2 * turns);
    const double apart = 2 * acos(below);
    for (int i = 0; i < turns; i++)
        ck_assert_double_eq_tol(o->found.at[2 * i + 1].t - o->found.at[2 * i].t,
                                apart, 1e-2 * apart + 1e-12);
    put_away(o);
}

/* A square is touched, a cube crossed, however flat. */
TEST_EACH(zeros_of_any_multiplicity, 4) {
    static const double powers[] = {2, 3, 4, 5};
    double power_of = powers[_i];
    const nevh_section is = {.value = power, .data = &power_of};
    orbit *o = on_circle(0, &is, 1);
    ck_assert_int_eq(go(o, 0.3, 20 * 2 * pi), NEVH_OK);
    ck_assert_uint_eq(o->found.count, _i % 2 ? 40 : 0);
    for (size_t i = 0; i < o->found.count; i++)
        ck_assert_double_eq_tol(o->found.at[i].q[0], 0.3, 1e-9);
    put_away(o);
}

static orbit *in_time(double t0, nevh_section_fn value, const double at[]) {
    const nevh_section is = {.value = value, .data = (void *)at};
    const double q = 0.4, p = 0.3;
    orbit *o = look_at(nevh_pendulum_model->system(&unit_pendulum), nevh_verlet,
                       &q, &p, &is, 1);
    o->t = t0;
    return o;
}

static void assert_times(const orbit *o, const double at[], double tolerance) {
    size_t count = 0;
    for (; !isnan(at[count]); count++) {
        ck_assert_uint_lt(count, o->found.count);
        ck_assert_double_le(fabs(o->found.at[count].t - at[count]), tolerance);
    }
    ck_assert_uint_eq(o->found.count, count);
}

TEST_EACH(two_and_three_within_one_step, 7) {
    static const double at[][4] = {{1.1, 1.3, NAN},       {1.01, 1.5, 1.99},
                                   {1.4, 1.5, 1.6},       {1.001, 1.002, NAN},
                                   {1.2, 1.2000001, NAN}, {0.5, 1.7, 1.9},
                                   {1.5, 1.99, 2.3}};
    double with_end[5] = {at[_i][0], at[_i][1],
                          isnan(at[_i][2]) ? NAN : at[_i][2], NAN, NAN};
    orbit *o = in_time(0, zeros, with_end);
    ck_assert_int_eq(go(o, 1, 4), NEVH_OK);
    assert_times(o, with_end, 1e-9);
    put_away(o);
}

/* Zeros on steps count once, with the very state of the orbit, also where it
   ends; where it begins they do not count, even if it only begins there to
   rounding. */
TEST(zeros_on_steps) {
    static const double at[] = {0.75, 1.25, 1.5, 2.75, NAN};
    orbit *o = in_time(0, zeros, at), *plain = in_time(0, zeros, at);
    for (int i = 1; i <= 3; i++)
        ck_assert_int_eq(nevh_stepper_apply(plain->stepper, (i - 1) * 0.25,
                                            0.25, plain->q, plain->p),
                         NEVH_OK);
    ck_assert_int_eq(go(o, 0.25, 2.75), NEVH_OK);
    assert_times(o, at, 0);
    ck_assert(o->found.at[0].q[0] == plain->q[0] &&
              o->found.at[0].p[0] == plain->p[0]);
    ck_assert_int_eq(go(o, 0.25, 4), NEVH_OK);
    ck_assert_uint_eq(o->found.count, 4);
    put_away(o);
    put_away(plain);
}

TEST_EACH(a_start_on_a_zero, 3) {
    static const double starts[] = {0.75, 0.75 - 1e-16, 0.75 + 1e-16};
    static const double at[] = {0.75, 1.3, NAN};
    orbit *o = in_time(starts[_i], zeros, at);
    ck_assert_int_eq(go(o, 0.25, 3), NEVH_OK);
    assert_times(o, at + 1, 1e-12);
    put_away(o);
}

TEST(zeros_that_touch_on_steps) {
    static const double touched[] = {0.75, 0.75, NAN},
                        flat_cube[] = {0.75, 0.75, 0.75, NAN};
    static const double none[] = {NAN}, one[] = {0.75, NAN}, end[] = {1, NAN};
    orbit *o = in_time(0, zeros, touched);
    ck_assert_int_eq(go(o, 0.25, 2), NEVH_OK);
    assert_times(o, none, 0);
    put_away(o);
    o = in_time(0, zeros, flat_cube);
    ck_assert_int_eq(go(o, 0.25, 2), NEVH_OK);
    assert_times(o, one, 0);
    put_away(o);
    o = in_time(0, flat, NULL);
    ck_assert_int_eq(go(o, 0.25, 2), NEVH_OK);
    assert_times(o, end, 0);
    put_away(o);
}

/* A free rotor passes several multiples of the period in a step, forward and
   backward; what rises, rises with t. */
TEST_EACH(multiples_of_a_period, 4) {
    const double turn = 2 * pi, p = _i < 2 ? 20 : -20, h = _i % 2 ? -1 : 1;
    const nevh_section is[] = {
        {.value = coordinate, .period = turn},
        {.value = coordinate, .period = turn, .direction = 1}};
    orbit *o = pendulum(&rotor, 1, p, is, 2);
    ck_assert_int_eq(go(o, h, 30.5 * h), NEVH_OK);
    const double end = 1 + p * 30.5 * h;
    const size_t count = (size_t)fabs(floor(end / turn));
    ck_assert_uint_eq(count_of(&o->found, 0, p > 0 ? 1 : -1), count);
    ck_assert_uint_eq(count_of(&o->found, 1, 1), p > 0 ? count : 0);
    ck_assert_uint_eq(o->found.count, p > 0 ? 2 * count : count);
    for (size_t i = 0; i < o->found.count; i++) {
        ck_assert_double_le(fabs(remainder(o->found.at[i].q[0], turn)), 1e-12);
        ck_assert_double_eq_tol(o->found.at[i].t, (o->found.at[i].q[0] - 1) / p,
                                1e-12);
    }
    put_away(o);
}

/* Just below 3 periods of 1.3 at t = 1, by less than division can tell. */
TEST(a_step_just_before_a_multiple) {
    double slope = nextafter(3 * 1.3, 0);
    const nevh_section is = {
        .value = proportional, .data = &slope, .period = 1.3};
    orbit *o = on_circle(0, &is, 1);
    ck_assert(slope < 3 * 1.3 && slope / 1.3 >= 3);
    ck_assert_int_eq(go(o, 0.25, 1.5), NEVH_OK);
    ck_assert_uint_eq(o->found.count, 4);
    ck_assert_double_eq_tol(o->found.at[2].t, 1, 1e-12);
    put_away(o);
}

/* A value that is not a number, or fails, stops the run and says which. */
TEST_EACH(values_that_fail, 2) {
    static int statuses[] = {NEVH_OK, NEVH_EFAILED};
    const nevh_section is = {
        .name = "broken", .value = breaking, .data = &statuses[_i]};
    orbit *o = on_circle(0, &is, 1);
    ck_assert_int_eq(go(o, 0.3, 10), NEVH_STOPPED);
    ck_assert_int_eq(nevh_sections_status(o->sections),
                     _i ? NEVH_EFAILED : NEVH_EDOM);
    ck_assert_ptr_nonnull(
        strstr(nevh_sections_message(o->sections), "section broken"));
    ck_assert_ptr_nonnull(
        strstr(nevh_sections_message(o->sections), "t = 1.2"));
    ck_assert_double_eq_tol(o->q[0], cos(1.2), 1e-9);
    put_away(o);
}

/* One that fails at the start, and one that fails in between: beyond x = 0.999
   there is no value. */
static int edge(void *data, double t, const double q[], const double p[],
                double *value) {
    (void)data, (void)t, (void)p;
    *value = sqrt(0.999 - q[0]) - 0.01;
    return NEVH_OK;
}
TEST(values_that_fail_within_a_step) {
    const nevh_section is = {.value = edge};
    orbit *o = on_circle(-0.5, &is, 1);
    ck_assert_int_eq(go(o, 1, 0.5), NEVH_STOPPED);
    ck_assert_int_eq(nevh_sections_status(o->sections), NEVH_EDOM);
    ck_assert_ptr_nonnull(
        strstr(nevh_sections_message(o->sections), "section 0"));
    put_away(o);
    o = on_circle(0, &is, 1);
    ck_assert_int_eq(go(o, 0.1, 1), NEVH_STOPPED);
    ck_assert_ptr_nonnull(strstr(nevh_sections_message(o->sections), "t = 0"));
    put_away(o);
}

TEST(a_point_may_stop_the_run) {
    const nevh_section is = {.value = coordinate};
    orbit *o = on_circle(0, &is, 1);
    o->found.stop_at = 3;
    ck_assert_int_eq(go(o, 0.3, 100), NEVH_STOPPED);
    ck_assert_int_eq(nevh_sections_status(o->sections), NEVH_STOPPED);
    ck_assert_uint_eq(o->found.count, 3);
    ck_assert_uint_eq(nevh_stepper_taken(o->stepper), 27);
    put_away(o);
}

TEST_EACH(sections_that_make_no_sense, 7) {
    const nevh_section wrong[] = {
        {.every = 0},
        {.every = -1},
        {.every = INFINITY},
        {.value = coordinate, .every = 1},
        {.value = coordinate, .direction = 2},
        {.value = coordinate, .period = -1},
        {.value = coordinate, .period = NAN},
    };
    orbit *o = on_circle(0, NULL, 0);
    nevh_sections *x = nevh_sections_new(o->stepper, &wrong[_i], 1, record, o);
    nevh_observer observer = {nevh_sections_observe, x, 1};
    ck_assert_int_eq(nevh_sections_status(x), NEVH_EINVAL);
    ck_assert_ptr_nonnull(strstr(nevh_sections_message(x), "section 0"));
    ck_assert_int_eq(nevh_run(o->stepper, 0, 0.1, 3, o->q, o->p, &observer, 1),
                     NEVH_STOPPED);
    nevh_sections_free(x);
    put_away(o);
}

TEST(refusals) {
    const nevh_section is = {.value = coordinate};
    const double pair[] = {1, 1};
    nevh_system *s = nevh_oscillator_model->system(&unit_spring);
    nevh_options options = {.q = pair, .p = pair, .width = 2};
    nevh_stepper *two = nevh_stepper_new(s, nevh_verlet, &options);
    nevh_stepper *none = nevh_stepper_new(s, NULL, NULL);
    nevh_sections *x = nevh_sections_new(two, &is, 1, record, NULL);
    nevh_sections *y = nevh_sections_new(none, &is, 1, record, NULL);
    ck_assert_int_eq(nevh_sections_status(x), NEVH_EINVAL);
    ck_assert_int_eq(nevh_sections_status(y), NEVH_EINVAL);
    ck_assert_str_eq(nevh_sections_message(y), nevh_stepper_message(none));
    ck_assert_int_eq(nevh_sections_status(NULL), NEVH_ENOMEM);
    nevh_sections_free(NULL);
    nevh_sections_free(x);
    nevh_sections_free(y);
    nevh_stepper_free(two);
    nevh_stepper_free(none);
    nevh_system_free(s);
    orbit *o = on_circle(0, &is, 1);
    o->observer.every = 2;
    ck_assert_int_eq(go(o, 0.1, 1), NEVH_STOPPED);
    ck_assert_int_eq(nevh_sections_status(o->sections), NEVH_EINVAL);
    put_away(o);
}

/* Periods without number in a step end in a message, not in a search without
   end. */
TEST(too_many_periods) {
    const nevh_section is = {.value = coordinate, .period = 1e-300};
    orbit *o = on_circle(0, &is, 1);
    ck_assert_int_eq(go(o, 0.1, 1), NEVH_STOPPED);
    ck_assert_int_eq(nevh_sections_status(o->sections), NEVH_EFAILED);
    put_away(o);
}
