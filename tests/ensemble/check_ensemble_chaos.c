/* nevh tests: outcomes that tell chaos are those of each orbit alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <nevh/chaos.h>
#include <nevh/ensemble.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <string.h>

enum { MEMBERS = 21, MOST_COLUMNS = 6 };

/* Pushed by the time where that is asked. */
static nevh_scene *scene_of(bool driven) {
    char text[600];
    snprintf(text, sizeof text,
             "[coordinates]\nx = 0\ny = 0\n[effects]\n"
             "kinetic = (p_x^2 + p_y^2)/2\n"
             "potential = (x^2 + y^2)/2 + x^2*y - y^3/3\n%s",
             driven ? "push = 0.01*x*cos(t)\n" : "");
    nevh_scene *scene = nevh_scene_parse("test", text);
    ck_assert_str_eq(nevh_scene_message(scene), "");
    return scene;
}

typedef struct {
    const nevh_integrator *scheme;
    double t_end;
    double escaping; /* y of member 7; NAN: it is like the others */
    const nevh_outcome *outcomes;
    size_t n_outcomes, columns, width;
    bool driven;
    nevh_quantity stop;
} setup;

typedef struct {
    const setup *of;
    uint64_t next;
    size_t told;
    int status[MEMBERS];
    char message[200];
    double row[MEMBERS][MOST_COLUMNS];
} results;

static void start(const setup *s, uint64_t i, double q[2], double p[2]) {
    q[0] = 0;
    q[1] =
        i == 7 && !isnan(s->escaping) ? s->escaping : -0.25 + 0.025 * (double)i;
    p[0] = 0.44;
    p[1] = 0.01;
}

static bool next(void *data, uint64_t *member, double q[], double p[]) {
    results *r = data;
    if (r->next == MEMBERS)
        return false;
    *member = r->next++;
    start(r->of, *member, q, p);
    return true;
}

static int done(void *data, const nevh_member_result *found) {
    results *r = data;
    r->told++;
    r->status[found->member] = found->status;
    if (found->status)
        snprintf(r->message, sizeof r->message, "%s", found->message);
    memcpy(r->row[found->member], found->values,
           r->of->columns * sizeof(double));
    return 0;
}

static const double dt = 0.2;
static const double plan_q[2] = {0, 0.1}, plan_p[2] = {0.49, 0};
static const nevh_options plan_at = {.q = plan_q, .p = plan_p};

static void run(const setup *s, results *r) {
    nevh_scene *scene = scene_of(s->driven);
    const nevh_system *system = nevh_scene_system(scene);
    nevh_ensemble_options is = {.integrator = s->scheme,
                                .options = &plan_at,
                                .t_end = s->t_end,
                                .dt = dt,
                                .width = s->width,
                                .outcomes = s->outcomes,
                                .n_outcomes = s->n_outcomes,
                                .stop = s->stop};
    nevh_ensemble *e = nevh_ensemble_new(system, &is);
    *r = (results){.of = s};
    ck_assert_str_eq(nevh_ensemble_message(e), "");
    ck_assert_uint_eq(nevh_ensemble_columns(e), s->columns);
    ck_assert_int_eq(nevh_ensemble_run(e, next, done, r), NEVH_OK);
    ck_assert_uint_eq(r->told, MEMBERS);
    nevh_ensemble_free(e);
    nevh_scene_free(scene);
}

/* lyapunov, sali, megno of nevh_chaos, until a time of each. */
static void run_alone(const setup *s, double until, uint64_t i,
                      nevh_chaos_verdict *verdict, double found[3]) {
    nevh_scene *scene = scene_of(s->driven);
    const nevh_system *system = nevh_scene_system(scene);
    nevh_chaos_options o = {
        .integrator = s->scheme, .options = &plan_at, .dt = dt, .starts = 1};
    nevh_chaos *c = nevh_chaos_new(system, &o);
    double q[2], p[2];
    start(s, i, q, p);
    ck_assert_str_eq(nevh_chaos_message(c), "");
    ck_assert_int_eq(nevh_chaos_restart(c, q, p, 0), NEVH_OK);
    ck_assert_int_eq(nevh_chaos_run(c, until), NEVH_OK);
    nevh_chaos_report report = nevh_chaos_result(c);
    *verdict = report.verdict;
    found[0] = nevh_chaos_exponent(c, 0, NULL);
    found[1] = report.sali;
    found[2] = report.megno;
    nevh_chaos_free(c);
    nevh_scene_free(scene);
}

static const nevh_outcome all_three[] = {{.kind = NEVH_OUTCOME_LYAPUNOV},
                                         {.kind = NEVH_OUTCOME_SALI},
                                         {.kind = NEVH_OUTCOME_MEGNO}};

/* The last is differentiated as a map, the one before takes stages. */
TEST_EACH(members_are_orbits_alone, 8) {
    const nevh_integrator *const schemes[] = {nevh_verlet, nevh_rk4,
                                              nevh_gauss4, nevh_tao2};
    setup s = {.scheme = schemes[_i % 4],
               .t_end = 61.1,
               .escaping = NAN,
               .driven = _i >= 4,
               .outcomes = all_three,
               .n_outcomes = 3,
               .columns = 3};
    for (s.width = 1; s.width <= 32; s.width += 31) {
        results r;
        run(&s, &r);
        for (uint64_t i = 0; i < MEMBERS; i++) {
            double alone[3];
            nevh_chaos_verdict verdict;
            run_alone(&s, s.t_end, i, &verdict, alone);
            ck_assert_int_eq(r.status[i], NEVH_OK);
            ck_assert_mem_eq(r.row[i], alone, sizeof alone);
        }
    }
}

/* Beside other outcomes, and where an orbit stops: until then. */
static void passes(const void *data, size_t width, const double t[],
                   const double q[], const double p[], const double v[],
                   double values[]) {
    (void)data, (void)t, (void)p, (void)v;
    for (size_t i = 0; i < width; i++)
        values[i] = q[width + i] - 0.3;
}

TEST_EACH(they_stand_beside_others, 2) {
    static const nevh_outcome mixed[] = {{.kind = NEVH_OUTCOME_MEGNO},
                                         {.kind = NEVH_OUTCOME_STATE},
                                         {.kind = NEVH_OUTCOME_TIME}};
    setup s = {.scheme = nevh_verlet,
               .t_end = 40,
               .escaping = NAN,
               .outcomes = mixed,
               .n_outcomes = 3,
               .columns = 6};
    if (_i)
        s.stop = (nevh_quantity){.value = passes};
    results r;
    run(&s, &r);
    bool stopped = false;
    for (uint64_t i = 0; i < MEMBERS; i++) {
        double alone[3], t = r.row[i][5];
        nevh_chaos_verdict verdict;
        ck_assert(_i ? t <= 40 : t == 40);
        stopped |= t < 40;
        if (t == 0)
            continue;
        run_alone(&s, t, i, &verdict, alone);
        ck_assert(r.row[i][0] == alone[2]);
    }
    ck_assert(stopped == (_i == 1));
}

/* Chaos is where SALI has fallen below 1e-8, and nowhere else; an orbit ends
   there. */
TEST(verdicts_are_those_of_the_analysis) {
    static const nevh_outcome sali = {.kind = NEVH_OUTCOME_SALI};
    setup s = {.scheme = nevh_verlet,
               .t_end = 3000,
               .escaping = NAN,
               .outcomes = &sali,
               .n_outcomes = 1,
               .columns = 1};
    size_t chaotic = 0, regular = 0;
    results r;
    run(&s, &r);
    for (uint64_t i = 0; i < MEMBERS; i++) {
        double alone[3];
        nevh_chaos_verdict verdict;
        run_alone(&s, s.t_end, i, &verdict, alone);
        if (verdict == NEVH_CHAOTIC)
            ck_assert(r.row[i][0] < 1e-8 && r.row[i][0] > 1e-12);
        if (verdict == NEVH_REGULAR)
            ck_assert(r.row[i][0] > 1e-8);
        chaotic += verdict == NEVH_CHAOTIC;
        regular += verdict == NEVH_REGULAR;
    }
    ck_assert_uint_ge(chaotic, 4);
    ck_assert_uint_ge(regular, 4);
}

/* One that escapes fails, and changes none of its neighbours. */
TEST_EACH(failures_stop_no_neighbour, 2) {
    setup s = {.scheme = _i ? nevh_rk4 : nevh_verlet,
               .t_end = 61.1,
               .outcomes = all_three,
               .n_outcomes = 3,
               .columns = 3};
    results r, without;
    s.escaping = 9; /* far beyond the saddle */
    run(&s, &r);
    ck_assert_int_eq(r.status[7], NEVH_EDOM);
    ck_assert(strlen(r.message) > 20);
    for (size_t k = 0; k < 3; k++)
        ck_assert(isnan(r.row[7][k]));
    s.escaping = NAN;
    run(&s, &without);
    for (uint64_t i = 0; i < MEMBERS; i++)
        if (i != 7)
            ck_assert_mem_eq(r.row[i], without.row[i], 3 * sizeof(double));
}

TEST(schemes_that_choose_their_steps_are_refused) {
    nevh_scene *scene = scene_of(false);
    const nevh_system *system = nevh_scene_system(scene);
    nevh_ensemble_options is = {.integrator = nevh_adaptive_verlet,
                                .options = &plan_at,
                                .t_end = 1,
                                .dt = dt,
                                .outcomes = all_three,
                                .n_outcomes = 3};
    nevh_ensemble *e = nevh_ensemble_new(system, &is);
    ck_assert_int_eq(nevh_ensemble_status(e), NEVH_ESTRUCT);
    ck_assert_ptr_nonnull(
        strstr(nevh_ensemble_message(e), "take a scheme of fixed steps"));
    nevh_ensemble_free(e);
    nevh_scene_free(scene);
}
