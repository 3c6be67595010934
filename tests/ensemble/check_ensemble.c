/* nevh tests: orbits side by side are the orbits taken alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MEMBERS = 21, COLUMNS = 2 * MOST_DOF + 6 };

/* Members around the problem's start; those from `until` on are not there. */
typedef struct {
    const problem *b;
    uint64_t next, until;
    bool backward; /* the last one first */
    size_t columns, told;
    double values[MEMBERS][COLUMNS];
    int status[MEMBERS];
    char message[200];
} members;

static void start_of(const problem *b, uint64_t member, double q[],
                     double p[]) {
    for (size_t k = 0; k < b->n; k++) {
        q[k] = b->q[k] * (1 + 0.005 * (double)member);
        p[k] = b->p[k] * (1 - 0.01 * (double)member);
    }
}

static bool next(void *data, uint64_t *member, double q[], double p[]) {
    members *m = data;
    if (m->next == m->until)
        return false;
    *member = m->backward ? m->until - 1 - m->next : m->next;
    m->next++;
    start_of(m->b, *member, q, p);
    return true;
}

static int done(void *data, const nevh_member_result *r) {
    members *m = data;
    m->status[r->member] = r->status;
    if (r->status)
        snprintf(m->message, sizeof m->message, "%s", r->message);
    memcpy(m->values[r->member], r->values, m->columns * sizeof(double));
    m->told++;
    return 0;
}

static void first_coordinate(const void *data, size_t width, const double t[],
                             const double q[], const double p[],
                             const double v[], double values[]) {
    const double *level = data;
    (void)t;
    (void)p;
    (void)v;
    for (size_t lane = 0; lane < width; lane++)
        values[lane] = q[lane] - *level;
}

static const double zero = 0;
static const nevh_quantity q0 = {.value = first_coordinate, .data = &zero};

static nevh_ensemble_options options_of(const problem *b, size_t width,
                                        const nevh_integrator *scheme,
                                        nevh_options *o) {
    *o = (nevh_options){.gradient = nevh_exact,
                        .q = b->q,
                        .p = b->p,
                        .t = b->t0,
                        .tolerance = tolerance_for(scheme)};
    double steps = 12 * b->fewest;
    return (nevh_ensemble_options){.integrator = scheme,
                                   .options = o,
                                   .t_start = b->t0,
                                   .t_end = b->t0 + b->span / 4,
                                   .dt = b->span / steps,
                                   .width = width};
}

/* Runs them; fails the test where the ensemble is refused. */
static members run(nevh_system *s, const nevh_ensemble_options *is,
                   const problem *b, bool backward) {
    members m = {.b = b, .until = MEMBERS, .backward = backward};
    nevh_ensemble *e = nevh_ensemble_new(s, is);
    ck_assert_str_eq(nevh_ensemble_message(e), "");
    m.columns = nevh_ensemble_columns(e);
    ck_assert_uint_le(m.columns, COLUMNS);
    ck_assert_int_eq(nevh_ensemble_run(e, next, done, &m), NEVH_OK);
    ck_assert_uint_eq(m.told, MEMBERS);
    nevh_ensemble_free(e);
    return m;
}

/* The state that nevh_run_until comes to, and its status. */
static int run_alone(nevh_system *s, const nevh_ensemble_options *is,
                     const problem *b, uint64_t member, double state[]) {
    nevh_stepper *stepper = nevh_stepper_new(s, is->integrator, is->options);
    double *q = state, *p = state + b->n;
    start_of(b, member, q, p);
    int status =
        nevh_run_until(stepper, is->t_start, is->dt, is->t_end, q, p, NULL, 0);
    nevh_stepper_free(stepper);
    return status;
}

static const nevh_outcome everything[] = {
    {.kind = NEVH_OUTCOME_STATE},
    {.kind = NEVH_OUTCOME_ENERGY_ERROR},
    {.kind = NEVH_OUTCOME_VERDICT},
    {.kind = NEVH_OUTCOME_FIRST, .quantity = {first_coordinate, &zero, false}},
    {.kind = NEVH_OUTCOME_MEAN, .quantity = {first_coordinate, &zero, false}},
    {.kind = NEVH_OUTCOME_MAXIMUM,
     .quantity = {first_coordinate, &zero, false}},
    {.kind = NEVH_OUTCOME_TIME},
};

static void compare_widths(const problem *b, const nevh_integrator *scheme,
                           bool whole) {
    nevh_options o;
    nevh_ensemble_options is = options_of(b, 1, scheme, &o);
    nevh_system *s = b->make();
    bool balanced = nevh_system_traits(s) & NEVH_AUTONOMOUS;
    is.outcomes = everything;
    is.n_outcomes = balanced ? 7 : 1; /* not all schemes keep the balance */
    is.t_end += whole ? 0 : 0.3 * is.dt;
    members one = run(s, &is, b, false);
    for (uint64_t i = 0; i < MEMBERS; i++) {
        double state[2 * MOST_DOF];
        int status = run_alone(s, &is, b, i, state);
        ck_assert_int_eq(one.status[i], status);
        if (status == NEVH_OK)
            ck_assert_mem_eq(state, one.values[i], 2 * b->n * sizeof(double));
    }
    for (size_t width = 8; width <= 32; width *= 2) {
        is.width = width;
        members many = run(s, &is, b, width == 16);
        ck_assert_mem_eq(many.status, one.status, sizeof one.status);
        for (int i = 0; i < MEMBERS; i++)
            if (one.status[i] == NEVH_OK)
                ck_assert_mem_eq(many.values[i], one.values[i],
                                 sizeof one.values[i]);
    }
    nevh_system_free(s);
}

TEST_EACH(lanes_are_orbits_alone, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    bool any = false;
    for (int i = 0; problems[i]; i++)
        if (fits(scheme, problems[i])) {
            compare_widths(problems[i], scheme, i % 2);
            any = true;
        }
    ck_assert(any);
}

/* dq0/dt, which is zero where q0 turns. */
static void first_velocity(const void *data, size_t width, const double t[],
                           const double q[], const double p[], const double v[],
                           double values[]) {
    (void)data, (void)t, (void)q, (void)p;
    for (size_t lane = 0; lane < width; lane++)
        values[lane] = v[lane];
}

/* A level, many of them, and a level near which the value of some turns. */
TEST_EACH(crossings_are_those_of_orbits_alone, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    const problem *b = &henon_heiles; /* any scheme fits */
    double near_turn = 1.02 * b->q[0];
    const nevh_quantity speed = {.value = first_velocity, .velocities = true};
    const nevh_outcome crossings[] = {
        {.kind = NEVH_OUTCOME_CROSSINGS, .quantity = q0},
        {.kind = NEVH_OUTCOME_PERIOD, .quantity = q0, .modulus = 0.03},
        {.kind = NEVH_OUTCOME_PERIOD, .quantity = speed, .direction = -1},
        {.kind = NEVH_OUTCOME_CROSSINGS,
         .quantity = {first_coordinate, &near_turn, false}},
        {.kind = NEVH_OUTCOME_STATE},
    };
    nevh_options o;
    nevh_ensemble_options is = options_of(b, 1, scheme, &o);
    nevh_system *s = b->make();
    is.outcomes = crossings;
    is.n_outcomes = sizeof crossings / sizeof *crossings;
    is.dt *= 1.5;
    is.t_end = b->t0 + b->span;
    members one = run(s, &is, b, false);
    is.width = 8;
    members many = run(s, &is, b, true);
    ck_assert_mem_eq(many.status, one.status, sizeof one.status);
    ck_assert_mem_eq(many.values, one.values, sizeof one.values);
    double counted = 0;
    for (int i = 0; i < MEMBERS; i++)
        counted += one.status[i] ? 0 : one.values[i][0] + one.values[i][3];
    /* Euler's orbits go to infinity, through all levels at once. */
    ck_assert(counted > MEMBERS || one.status[0] == NEVH_EFAILED);
    nevh_system_free(s);
}

/* Orbits that end at different times: free lanes take the next ones. */
TEST(orbits_end_when_all_is_known) {
    const problem *b = &henon_heiles;
    nevh_options o;
    nevh_ensemble_options is = options_of(b, 1, nevh_gauss6, &o);
    nevh_system *s = b->make();
    nevh_outcome first = {.kind = NEVH_OUTCOME_FIRST, .quantity = q0};
    nevh_outcome both[] = {first, {.kind = NEVH_OUTCOME_TIME}};
    is.outcomes = &first;
    is.n_outcomes = 1;
    is.t_end = b->t0 + b->span;
    members one = run(s, &is, b, false);
    is.width = 8;
    members many = run(s, &is, b, true);
    ck_assert_mem_eq(many.values, one.values, sizeof one.values);
    is.outcomes = both;
    is.n_outcomes = 2;
    many = run(s, &is, b, false);
    for (int i = 0; i < MEMBERS; i++) {
        ck_assert_mem_eq(many.values[i], one.values[i], sizeof(double));
        ck_assert_double_eq(many.values[i][1], is.t_end);
    }
    nevh_system_free(s);
}

/* An oscillator, x = cos(t): above a level just below 1 around 2 pi, between
   two steps, and never above 1. */
static double spring(double t, const double q[], const double p[],
                     const void *params) {
    (void)t;
    (void)params;
    return (p[0] * p[0] + q[0] * q[0]) / 2;
}

static const problem oscillator = {
    .name = "oscillator", .n = 1, .q = {0}, .p = {-1}};

TEST_EACH(what_holds_between_steps_is_found, 3) {
    const double pi = acos(-1), levels[] = {0.5, 0.9999, 1.0001};
    nevh_system *s = nevh_system_from(1, spring, NULL);
    nevh_options o = {0};
    nevh_outcome first = {.kind = NEVH_OUTCOME_FIRST,
                          .quantity = {first_coordinate, &levels[_i], false}};
    nevh_ensemble_options is = {.integrator = nevh_gauss12,
                                .options = &o,
                                .t_end = 20,
                                .dt = 0.37,
                                .width = 8,
                                .outcomes = &first,
                                .n_outcomes = 1};
    members m = {.b = &oscillator, .until = 1};
    nevh_ensemble *e = nevh_ensemble_new(s, &is);
    m.columns = 1;
    ck_assert_int_eq(nevh_ensemble_run(e, next, done, &m), NEVH_OK);
    /* x = -sin t rises to 1 at 3 pi / 2 */
    if (levels[_i] > 1)
        ck_assert_double_nan(m.values[0][0]);
    else
        ck_assert_double_eq_tol(m.values[0][0], 1.5 * pi - acos(levels[_i]),
                                1e-9);
    nevh_ensemble_free(e);
    nevh_system_free(s);
}

/* H is not defined below 0: some members fall there, the others must not
   notice. */
static double fall(double t, const double q[], const double p[],
                   const void *params) {
    (void)t;
    (void)params;
    return p[0] * p[0] / 2 + q[0] + 0 * sqrt(q[0]);
}

static const problem falling = {.name = "falling", .n = 1, .q = {1}, .p = {2}};

static void counted_coordinate(const void *data, size_t width, const double t[],
                               const double q[], const double p[],
                               const double v[], double values[]) {
    size_t *calls = *(size_t *const *)data;
    ++*calls;
    first_coordinate(&zero, width, t, q, p, v, values);
}

/* What is asked for at the end is evaluated there, and is what it is beside an
   outcome of all steps. */
TEST_EACH(ends_alone_are_not_watched, 2) {
    const problem *b = &henon_heiles;
    size_t calls = 0, *counter = &calls;
    const nevh_quantity counted = {.value = counted_coordinate,
                                   .data = &counter};
    const nevh_outcome outcomes[] = {
        {.kind = NEVH_OUTCOME_LAST, .quantity = counted},
        {.kind = NEVH_OUTCOME_STATE},
        {.kind = NEVH_OUTCOME_TIME},
        {.kind = NEVH_OUTCOME_MAXIMUM, .quantity = q0}};
    nevh_options o;
    nevh_ensemble_options is = options_of(b, 8, nevh_verlet, &o);
    is.t_end -= _i * 0.3 * is.dt; /* whole steps, or not */
    is.outcomes = outcomes;
    is.n_outcomes = sizeof outcomes / sizeof *outcomes;
    nevh_system *s = b->make();
    members watched = run(s, &is, b, false);
    size_t all = calls;
    calls = 0;
    is.n_outcomes--;
    members ends = run(s, &is, b, false);
    nevh_system_free(s);
    ck_assert_uint_gt(all, 40);
    ck_assert_msg(calls <= 4 * MEMBERS / 8, "%zu of %zu", calls, all);
    for (size_t i = 0; i < MEMBERS; i++)
        for (size_t k = 0; k < ends.columns; k++)
            ck_assert(ends.values[i][k] == watched.values[i][k]);
}

TEST(failures_stop_no_neighbour) {
    nevh_system *s = nevh_system_from(1, fall, NULL);
    nevh_options o = {.q = falling.q, .p = falling.p, .gradient_step = 1e-3};
    nevh_outcome outcomes[] = {{.kind = NEVH_OUTCOME_STATE},
                               {.kind = NEVH_OUTCOME_ENERGY_ERROR}};
    nevh_ensemble_options is = {.integrator = nevh_gauss4,
                                .options = &o,
                                .t_end = 4.2,
                                .dt = 0.1,
                                .width = 1,
                                .outcomes = outcomes,
                                .n_outcomes = 2};
    members one = run(s, &is, &falling, false);
    is.width = 8;
    members many = run(s, &is, &falling, true);
    int failed = 0;
    for (int i = 0; i < MEMBERS; i++) {
        failed += many.status[i] != NEVH_OK;
        ck_assert_int_eq(many.status[i], one.status[i]);
        if (many.status[i])
            ck_assert_double_nan(many.values[i][0]);
    }
    ck_assert_int_gt(failed, 2);
    ck_assert_int_lt(failed, MEMBERS - 2);
    assert_says(many.message, " is nan at t = ");
    for (int i = 0; i < MEMBERS; i++)
        for (size_t k = 0; k < 3 && !one.status[i]; k++)
            ck_assert_mem_eq(&many.values[i][k], &one.values[i][k],
                             sizeof(double));
    nevh_system_free(s);
}

TEST(nonsense_is_refused) {
    nevh_system *s = henon_heiles.make();
    nevh_outcome none = {.kind = NEVH_OUTCOME_FIRST};
    nevh_ensemble_options is = {.integrator = nevh_verlet,
                                .t_end = 1,
                                .dt = 0.1,
                                .n_outcomes = 1,
                                .outcomes = &none};
    nevh_ensemble *e = nevh_ensemble_new(s, &is);
    ck_assert_int_eq(nevh_ensemble_status(e), NEVH_EINVAL);
    assert_says(nevh_ensemble_message(e), "quantity");
    ck_assert_int_eq(nevh_ensemble_run(e, next, done, NULL), NEVH_EINVAL);
    nevh_ensemble_free(e);
    is.dt = 0;
    e = nevh_ensemble_new(s, &is);
    ck_assert_int_eq(nevh_ensemble_status(e), NEVH_EINVAL);
    nevh_ensemble_free(e);
    is.dt = 0.1;
    for (int kind = -1; kind < 2000; kind += 2000) { /* there are none */
        is.outcomes = &(nevh_outcome){.kind = kind, .quantity = q0};
        e = nevh_ensemble_new(s, &is);
        ck_assert_int_eq(nevh_ensemble_status(e), NEVH_EINVAL);
        assert_says(nevh_ensemble_message(e), "no known kind");
        nevh_ensemble_free(e);
    }
    is.integrator = nevh_adaptive_verlet;
    is.outcomes = &(nevh_outcome){.kind = NEVH_OUTCOME_FREQUENCY,
                                  .quantity = {first_coordinate, &zero, false}};
    e = nevh_ensemble_new(s, &is);
    ck_assert_int_eq(nevh_ensemble_status(e), NEVH_EINVAL);
    assert_says(nevh_ensemble_message(e), "samples at equal times");
    nevh_ensemble_free(e);
    is.integrator = NULL;
    e = nevh_ensemble_new(s, &is);
    ck_assert_int_eq(nevh_ensemble_status(e), NEVH_EINVAL);
    nevh_ensemble_free(e);
    nevh_system_free(s);
    nevh_ensemble_free(NULL);
    ck_assert_int_eq(nevh_ensemble_status(NULL), NEVH_ENOMEM);
}

/* Constants are numbers in programs that were compiled before. */
TEST(constants_are_places_in_the_list) {
    static const char *const names[] = {[NEVH_OUTCOME_STATE] = "state",
                                        [NEVH_OUTCOME_TIME] = "t",
                                        [NEVH_OUTCOME_ENERGY_ERROR] =
                                            "energy_error",
                                        [NEVH_OUTCOME_VERDICT] = "verdict",
                                        [NEVH_OUTCOME_FIRST] = "first",
                                        [NEVH_OUTCOME_LAST] = "last",
                                        [NEVH_OUTCOME_MINIMUM] = "min",
                                        [NEVH_OUTCOME_MAXIMUM] = "max",
                                        [NEVH_OUTCOME_MEAN] = "mean",
                                        [NEVH_OUTCOME_CROSSINGS] = "crossings",
                                        [NEVH_OUTCOME_PERIOD] = "period",
                                        [NEVH_OUTCOME_FREQUENCY] = "frequency",
                                        [NEVH_OUTCOME_LYAPUNOV] = "lyapunov",
                                        [NEVH_OUTCOME_SALI] = "sali",
                                        [NEVH_OUTCOME_MEGNO] = "megno"};
    ck_assert_int_eq(NEVH_OUTCOME_MEGNO, 14);
    for (int kind = 0; kind <= NEVH_OUTCOME_MEGNO; kind++)
        ck_assert_int_eq(nevh_outcome_find(names[kind]), kind);
    for (int kind = 0; nevh_outcomes()[kind]; kind++) {
        const nevh_outcome_info *info = nevh_outcomes()[kind];
        ck_assert_int_eq(nevh_outcome_find(info->name), kind);
        ck_assert_str_ne(info->help, "");
    }
    ck_assert_int_eq(nevh_outcome_find("men"), -1);
    ck_assert_int_eq(nevh_outcome_find(NULL), -1);
}

/* A system that changes after planning is noticed. */
TEST(changed_system_is_refused) {
    const problem *b = &henon_heiles;
    nevh_system *s = b->make();
    nevh_options o;
    nevh_ensemble_options is = options_of(b, 8, nevh_verlet, &o);
    members m = {.b = b, .until = 1};
    nevh_ensemble *e = nevh_ensemble_new(s, &is);
    ck_assert_str_eq(nevh_ensemble_message(e), "");
    nevh_system_enable(s, nevh_system_effect_name(s, 0), false);
    ck_assert_int_eq(nevh_ensemble_run(e, next, done, &m), NEVH_ESTALE);
    ck_assert_uint_eq(m.told, 0);
    nevh_ensemble_free(e);
    nevh_system_free(s);
}

TEST(options_are_asked_for) {
    nevh_system *s = nevh_system_new(1);
    ck_assert_ptr_null(nevh_ensemble_new(s, NULL));
    nevh_system_free(s);
}
