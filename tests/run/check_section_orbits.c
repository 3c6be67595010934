/* nevh tests: sections of whole orbits, whatever the scheme and however they are run.
   What a section does within a step is in check_section.c.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "section.h"
#include <nevh/transform.h>

/* The value s into a step of h, by a stepper that knows nothing of it. */
typedef struct {
    orbit *o;
    double t, h, q, p;
    bool of_p;
} part;
static double after_part(const part *a, double s) {
    double q = a->q, p = a->p;
    nevh_stepper_reset(a->o->stepper);
    ck_assert_int_eq(nevh_stepper_apply(a->o->stepper, a->t, s * a->h, &q, &p),
                     NEVH_OK);
    return a->of_p ? p : q;
}

/* Where the value is largest, or 0 at an end; the step is looked at closely
   there. */
static double turn_of(const part *a) {
    enum { SAMPLES = 64 };
    double best = 0, most = after_part(a, 0), low = 0, high = 1;
    for (int i = 1; i <= SAMPLES; i++) {
        double s = (1 - cos(pi * i / SAMPLES)) / 2, value = after_part(a, s);
        if (value > most) {
            most = value;
            best = s;
            low = (1 - cos(pi * (i - 1) / SAMPLES)) / 2;
            high = (1 - cos(pi * (i + 1) / SAMPLES)) / 2;
        }
    }
    if (best == 0 || best == 1)
        return 0;
    while (high - low > 1e-7) {
        double left = low + (high - low) / 3, right = high - (high - low) / 3;
        if (after_part(a, left) > after_part(a, right))
            high = right;
        else
            low = left;
    }
    return low;
}

/* A level just below the turn is crossed twice in the step, wherever in it the
   turn is, and whatever the flow's slopes at its ends say of that, which are
   not quite the scheme's. */
TEST_EACH(turns_anywhere_in_a_step, 4) {
    static const double rates[] = {0.5};
    const bool of_p = _i % 2, damped = _i / 2;
    double level = 0;
    const nevh_section is = {.value = of_p ? momentum : coordinate,
                             .data = &level};
    const problem *b = &driven_pendulum;
    nevh_system *system = b->make();
    if (damped)
        nevh_system_add_friction(system, "drag", rates);
    orbit *o = look_at(system, nevh_verlet, b->q, b->p, &is, 1);
    int turns = 0, near = 0;
    double t = 0, h = 0.3;
    for (int i = 0; i < 3000; i++, t += h / 7) {
        double x = 0.001 * (i % 700), y = 0.0003 * i;
        part a = {o,
                  t,
                  h,
                  of_p ? y - 0.7 : x + 0.8,
                  of_p ? x + (damped ? 0.5 : 1) : y - 0.1,
                  of_p};
        double s = turn_of(&a), ends[] = {after_part(&a, 0), after_part(&a, 1)};
        double most = after_part(&a, s), least = fmax(ends[0], ends[1]);
        if (s == 0 || most - least < 1e-9)
            continue;
        level = (most + least) / 2;
        o->found.count = 0;
        nevh_stepper_reset(o->stepper);
        ck_assert(!nevh_sections_observe(o->sections, 0, t, &a.q, &a.p));
        nevh_stepper_apply(o->stepper, t, h, &a.q, &a.p);
        ck_assert_msg(!nevh_sections_observe(o->sections, 1, t + h, &a.q, &a.p),
                      "%s", nevh_sections_message(o->sections));
        ck_assert_msg(
            o->found.count == 2, "%zu at s = %g of step %d; ends %g %g most %g",
            o->found.count, s, i, ends[0] - most, ends[1] - most, most);
        turns++;
        near += s < 0.01 || s > 0.99;
    }
    ck_assert_msg(turns > 100 && near > 3, "%d turns, %d near ends", turns,
                  near);
    put_away(o);
}

/* A pendulum that swings to 2 and, after a push, goes round: only the multiples
   that it passes; a sawtooth's jumps and poles are none. */
TEST(no_crossing_at_jumps) {
    const nevh_section is[] = {{.value = coordinate, .period = 2 * pi},
                               {.value = sawtooth},
                               {.value = pole}};
    orbit *swings = pendulum(&unit_pendulum, 2, 0, is, 3);
    orbit *turns = pendulum(&unit_pendulum, 0.1, 2.1, is, 3);
    ck_assert_int_eq(go(swings, 0.3, 200), NEVH_OK);
    size_t count = count_of(&swings->found, 0, 1);
    ck_assert_uint_gt(count, 20);
    ck_assert_uint_eq(count_of(&swings->found, 1, 1), count);
    ck_assert_uint_eq(swings->found.count,
                      count_of(&swings->found, 0, -1) * 2 + count * 2);
    ck_assert_int_eq(go(turns, 0.3, 200), NEVH_OK);
    count = count_of(&turns->found, 0, 1);
    ck_assert_uint_eq(count, (size_t)(turns->q[0] / (2 * pi)));
    ck_assert_uint_eq(count_of(&turns->found, 1, 1), count);
    ck_assert_uint_eq(turns->found.count, 2 * count);
    put_away(swings);
    put_away(turns);
}

/* Points of a coarse orbit against sign changes along a fine one, for sections
   all over the range, some of which the orbit only just reaches. */
enum { COMB = 60 };
TEST(none_is_missed) {
    static double levels[COMB];
    static int last[COMB];
    nevh_section is[COMB];
    size_t changes[COMB] = {0};
    for (int i = 0; i < COMB; i++) {
        levels[i] = -0.6 + 1.2 * (i + 0.37) / COMB;
        is[i] = (nevh_section){.value = second, .data = &levels[i]};
    }
    orbit *coarse = of_problem(&henon_heiles, nevh_gauss16, is, COMB);
    orbit *fine = of_problem(&henon_heiles, nevh_blanes_moan6, NULL, 0);
    const double span = 100, t0 = coarse->t;
    ck_assert_int_eq(go(coarse, 0.8, t0 + span), NEVH_OK);
    for (int step = 0; step <= 20000; step++) {
        for (int i = 0; i < COMB; i++) {
            int side = fine->q[1] > levels[i] ? 1 : -1;
            changes[i] += step > 0 && side != last[i];
            last[i] = side;
        }
        nevh_stepper_apply(fine->stepper, t0 + step * span / 20000,
                           span / 20000, fine->q, fine->p);
    }
    size_t met = 0;
    for (size_t i = 0; i < COMB; i++) {
        ck_assert_uint_eq(count_of(&coarse->found, i, 1) +
                              count_of(&coarse->found, i, -1),
                          changes[i]);
        met += changes[i] > 0;
    }
    ck_assert_uint_gt(met, 20);
    for (size_t i = 1; i < coarse->found.count; i++)
        ck_assert(coarse->found.at[i].t >= coarse->found.at[i - 1].t);
    put_away(coarse);
    put_away(fine);
}

/* The largest difference of the points to those of a better orbit, in units of
   what the states themselves differ by at the end of each of ten spans. */
static double worst_of(const orbit *a, const orbit *b) {
    double worst = 0;
    ck_assert_uint_eq(a->found.count, b->found.count);
    for (size_t i = 0; i < a->found.count; i++) {
        ck_assert_int_eq(a->found.at[i].direction, b->found.at[i].direction);
        worst = fmax(worst, fabs(a->found.at[i].q[1] - b->found.at[i].q[1]));
        worst = fmax(worst, fabs(a->found.at[i].p[1] - b->found.at[i].p[1]));
    }
    return worst;
}

/* Points of two schemes agree to the error of the worse one's states. */
TEST_EACH(points_are_as_good_as_states, 7) {
    static const struct {
        const nevh_integrator *const *scheme;
        double h;
    } rough[] = {{&nevh_verlet, 0.1},    {&nevh_verlet, 0.02},
                 {&nevh_midpoint, 0.05}, {&nevh_blanes_moan4, 0.2},
                 {&nevh_gauss6, 0.3},    {&nevh_rk4, 0.1},
                 {&nevh_gauss8, 0.2}};
    const nevh_section is = {.value = coordinate, .direction = 1};
    orbit *good = of_problem(&henon_heiles, nevh_gauss16, &is, 1);
    orbit *a = of_problem(&henon_heiles, *rough[_i].scheme, &is, 1);
    const double t0 = a->t;
    double error = 0;
    for (int span = 1; span <= 25; span++) {
        ck_assert_int_eq(go(good, 0.25, t0 + 2 * span), NEVH_OK);
        ck_assert_int_eq(go(a, rough[_i].h, t0 + 2 * span), NEVH_OK);
        for (int k = 0; k < 2; k++) {
            error = fmax(error, fabs(a->q[k] - good->q[k]));
            error = fmax(error, fabs(a->p[k] - good->p[k]));
        }
    }
    ck_assert_uint_ge(a->found.count, 5);
    const double worst = worst_of(a, good);
    ck_assert_double_le(worst, 3 * error);
    ck_assert_double_ge(worst, error / 300);
    for (size_t i = 0; i < a->found.count; i++)
        ck_assert_double_le(fabs(a->found.at[i].q[0]), 1e-16);
    put_away(good);
    put_away(a);
}

/* A scheme on a problem that it fits, with time in it where possible; the last
   is gauss4 under a transform. */
static int setting_count(void) {
    return scheme_count() + 1;
}
static nevh_stepper *stepper_on(int i, nevh_system **system,
                                nevh_system **transform, const problem **b) {
    bool transformed = i == scheme_count();
    const nevh_integrator *scheme =
        transformed ? nevh_gauss4 : nevh_integrators()[i];
    *b = transformed || !fits(scheme, &double_pendulum) ? &driven_pendulum
                                                        : &double_pendulum;
    *b = transformed ? &henon_heiles : *b;
    *transform = transformed ? nevh_distance_power(2, 2, 0.5) : NULL;
    *system = (*b)->make();
    nevh_options options = {.t = (*b)->t0,
                            .q = (*b)->q,
                            .p = (*b)->p,
                            .tolerance = tolerance_for(scheme),
                            .transform = *transform};
    nevh_stepper *s = nevh_stepper_new(*system, scheme, &options);
    ck_assert_msg(!nevh_stepper_status(s), "%s", nevh_stepper_message(s));
    return s;
}

/* No orbit changes when it is looked at; points are on the section, and those
   in time where they are due, of every scheme. */
TEST_EACH(every_scheme_the_same_orbit, setting_count()) {
    const problem *b;
    nevh_system *system, *transform;
    nevh_stepper *seen = stepper_on(_i, &system, &transform, &b);
    nevh_stepper *alone = nevh_stepper_copy(seen);
    double level = b->q[0] + 0.02, q[2][MOST_DOF], p[2][MOST_DOF];
    const double every = 0.17;
    const nevh_section is[] = {{.value = coordinate, .data = &level},
                               {.every = every}};
    album found = {.n = b->n};
    nevh_sections *x = nevh_sections_new(seen, is, 2, record, &found);
    nevh_observer observer = {nevh_sections_observe, x, 1};
    for (int i = 0; i < 2; i++) {
        memcpy(q[i], b->q, sizeof q[i]);
        memcpy(p[i], b->p, sizeof p[i]);
    }
    const double t0 = b->t0, ends[] = {t0, t0 + 3.1, t0 + 7.013};
    for (int i = 1; i < 3; i++) {
        nevh_run_until(alone, ends[i - 1], 0.05, ends[i], q[0], p[0], NULL, 0);
        ck_assert_int_eq(nevh_run_until(seen, ends[i - 1], 0.05, ends[i], q[1],
                                        p[1], &observer, 1),
                         NEVH_OK);
        ck_assert_mem_eq(q[0], q[1], b->n * sizeof(double));
        ck_assert_mem_eq(p[0], p[1], b->n * sizeof(double));
    }
    ck_assert(nevh_stepper_counts(alone).values ==
              nevh_stepper_counts(seen).values);
    ck_assert_uint_gt(nevh_sections_counts(x).values, 0);
    ck_assert_uint_eq(count_of(&found, 1, 0), 41);
    ck_assert_uint_ge(found.count, 42);
    size_t strobes = 0;
    for (size_t i = 0; i < found.count; i++)
        if (found.at[i].section == 0)
            ck_assert_double_eq_tol(found.at[i].q[0], level, 1e-12);
        else
            ck_assert(found.at[i].t == t0 + (double)++strobes * every);
    for (size_t i = 2; i < found.count; i += 5) {
        if (found.at[i].t > ends[1])
            break;
        memcpy(q[0], b->q, sizeof q[0]);
        memcpy(p[0], b->p, sizeof p[0]);
        nevh_stepper_reset(alone);
        ck_assert_int_eq(
            nevh_run_until(alone, t0, 0.05, found.at[i].t, q[0], p[0], NULL, 0),
            NEVH_OK);
        for (size_t k = 0; k < b->n; k++) {
            ck_assert_double_eq_tol(q[0][k], found.at[i].q[k], 1e-9);
            ck_assert_double_eq_tol(p[0][k], found.at[i].p[k], 1e-9);
        }
    }
    nevh_sections_free(x);
    nevh_stepper_free(seen);
    nevh_stepper_free(alone);
    nevh_system_free(system);
    nevh_system_free(transform);
}

/* Those of a run that ends there, bit for bit; on a step, between steps, and
   several within one. */
TEST_EACH(strobes_are_states, 4) {
    static const double every[] = {0.125, 0.3, 0.01, 0.375};
    const nevh_section is = {.every = every[_i]};
    const problem *b = &driven_pendulum;
    orbit *o = of_problem(b, nevh_verlet, &is, 1);
    const double t0 = o->t, h = 0.125;
    ck_assert_int_eq(go(o, h, t0 + 3), NEVH_OK);
    ck_assert_uint_eq(o->found.count, (size_t)(3 / every[_i] + 1e-9));
    for (size_t i = 0; i < o->found.count; i++) {
        const double t = t0 + (double)(i + 1) * every[_i];
        nevh_stepper *s = planned(o->system, b, nevh_verlet, nevh_exact);
        double q = b->q[0], p = b->p[0];
        nevh_run_until(s, t0, h, t, &q, &p, NULL, 0);
        ck_assert(o->found.at[i].t == t);
        ck_assert_double_eq_tol(o->found.at[i].q[0], q, 1e-15);
        ck_assert_double_eq_tol(o->found.at[i].p[0], p, 1e-15);
        nevh_stepper_free(s);
    }
    put_away(o);
}

/* By the clock 0.1 + 0.1 + 0.1 is not 0.3, and both are met. */
TEST(strobes_on_steps) {
    const nevh_section is[] = {{.every = 0.1}, {.every = 0.3}};
    const double start[] = {0.4, 0.3};
    double q = start[0], p = start[1];
    orbit *o = look_at(nevh_pendulum_model->system(&unit_pendulum), nevh_verlet,
                       &start[0], &start[1], is, 2);
    nevh_stepper *plain = nevh_stepper_copy(o->stepper);
    ck_assert_int_eq(go(o, 0.1, 0.3), NEVH_OK);
    nevh_run_until(plain, 0, 0.1, 0.3, &q, &p, NULL, 0);
    ck_assert_uint_eq(o->found.count, 4);
    for (int i = 2; i < 4; i++)
        ck_assert(o->found.at[i].q[0] == q && o->found.at[i].p[0] == p);
    put_away(o);
    o = look_at(nevh_pendulum_model->system(&unit_pendulum), nevh_verlet,
                &start[0], &start[1], is, 2);
    ck_assert_int_eq(
        nevh_run(o->stepper, 0, 0.1, 4, o->q, o->p, &o->observer, 1), NEVH_OK);
    ck_assert_uint_eq(o->found.count, 5);
    for (int i = 2; i < 4; i++)
        ck_assert(o->found.at[i].q[0] == q && o->found.at[i].p[0] == p);
    nevh_stepper_free(plain);
    put_away(o);
}

/* A run that begins at the same state, but at another time, is another. */
TEST(the_same_state_at_another_time) {
    const nevh_section is = {.every = 0.7};
    orbit *o = on_circle(0, &is, 1);
    ck_assert_int_eq(go(o, 0.1, 1), NEVH_OK);
    o->t = 10;
    ck_assert_int_eq(go(o, 0.1, 11), NEVH_OK);
    ck_assert_uint_eq(o->found.count, 2);
    ck_assert_double_eq(o->found.at[1].t, 10.7);
    put_away(o);
}

/* Forward and backward again: the same points, in the same directions. */
TEST(backward_the_same_points) {
    const nevh_section is = {.value = coordinate, .direction = 1};
    orbit *o = of_problem(&henon_heiles, nevh_gauss8, &is, 1);
    const double t0 = o->t, t_end = t0 + 40.3;
    ck_assert_int_eq(go(o, 0.1, t_end), NEVH_OK);
    const size_t count = o->found.count;
    ck_assert_uint_ge(count, 5);
    ck_assert_int_eq(go(o, -0.1, t0), NEVH_OK);
    ck_assert_uint_eq(o->found.count, 2 * count);
    for (size_t i = 0; i < count; i++) {
        size_t back = 2 * count - 1 - i;
        ck_assert_int_eq(o->found.at[back].direction, 1);
        ck_assert_double_eq_tol(o->found.at[back].t, o->found.at[i].t, 1e-9);
        ck_assert_double_eq_tol(o->found.at[back].q[1], o->found.at[i].q[1],
                                1e-9);
    }
    put_away(o);
}

/* In pieces, one of which ends at a point, as in one run. */
TEST(runs_that_go_on) {
    const nevh_section is[] = {{.value = coordinate}, {.every = 0.7}};
    orbit *whole = of_problem(&henon_heiles, nevh_gauss8, is, 2);
    orbit *parts = of_problem(&henon_heiles, nevh_gauss8, is, 2);
    const double t0 = whole->t;
    ck_assert_int_eq(go(whole, 0.1, t0 + 60), NEVH_OK);
    size_t crossing = 9;
    while (whole->found.at[crossing].section != 0 ||
           whole->found.at[crossing].t < t0 + 20)
        crossing++;
    const double ends[] = {1.1, 7, 7 + 1e-9, 13.37};
    for (size_t i = 0; i < 4; i++)
        ck_assert_int_eq(go(parts, 0.1, t0 + ends[i]), NEVH_OK);
    while (parts->t < whole->found.at[crossing].t - 0.05)
        ck_assert_int_eq(go(parts, 0.1, parts->t + 0.05), NEVH_OK);
    ck_assert_int_eq(go(parts, 0.1, whole->found.at[crossing].t), NEVH_OK);
    ck_assert_int_eq(go(parts, 0.1, t0 + 60), NEVH_OK);
    ck_assert_uint_eq(parts->found.count, whole->found.count);
    for (size_t i = 0; i < whole->found.count; i++) {
        ck_assert_uint_eq(parts->found.at[i].section,
                          whole->found.at[i].section);
        ck_assert_double_eq_tol(parts->found.at[i].t, whole->found.at[i].t,
                                1e-9);
    }
    put_away(whole);
    put_away(parts);
}
