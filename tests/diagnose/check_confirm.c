/* nevh tests: the finer run of a question: how it is made, what it costs, and
   whether it is finer.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "reference.h"
#include <nevh/confirm.h>
#include <string.h>

#define KEPLER                                                                 \
    "x = 0.1\ny = 0\np_x = 0\np_y = sqrt(19)",                                 \
        "K = (p_x^2 + p_y^2)/2\nV = -1/sqrt(x^2 + y^2)"
#define PENDULUM  "x = 3\np_x = 0", "K = p_x^2/2\nV = -cos(x)"
#define VEE       "x = 1\np_x = 0", "K = p_x^2/2\nV = abs(x)"
#define STIFF     "x = 1\np_x = 0", "K = p_x^2/2\nV = 200*x^2 + x^4"
#define TURNING   "x = 1\np_x = 0", "K = p_x^2/2\nV = x^2/2 - 0.3*x*cos(1.3*t)"
#define STRETCHED "x = 1\np_x = 0", "K = p_x^2*(1 + x^2)/2\nV = x^2/2"

typedef struct {
    setup of;
    nevh_options options;
    nevh_finer *finer;
} question;

static void ask(question *a, const char *coordinates, const char *effects,
                nevh_finer_question q) {
    a->of = set_up(coordinates, effects);
    a->options =
        (nevh_options){.q = a->of.q, .p = a->of.p, .gradient = nevh_exact};
    a->options.tolerance = q.budget < 0 ? 1e-5 : 0;
    q.budget = fmax(q.budget, 0);
    q.options = &a->options;
    a->finer = nevh_finer_new(a->of.system, &q);
}

static void end(question *a) {
    nevh_finer_free(a->finer);
    nevh_scene_free(a->of.scene);
}

enum {
    TAYLOR = NEVH_FINER_TAYLOR,
    ADAPTIVE = NEVH_FINER_ADAPTIVE,
    STEPS = NEVH_FINER_STEPS
};

/* Taylor series where the formulas let them, else adaptive steps; the same scheme
   where those cost more than half the step does, or where nothing else will do. */
static const struct {
    const char *coordinates, *effects, *scheme;
    double dt;
    unsigned kinds;
    int kind;
} cases[] = {
    {KEPLER, "verlet", 0.001, 0, TAYLOR},
    {KEPLER, "verlet", 0.001, ADAPTIVE | STEPS, ADAPTIVE},
    {KEPLER, "verlet", 0.001, STEPS, STEPS},
    {PENDULUM, "verlet", 0.01, 0, TAYLOR},
    {PENDULUM, "euler", 0.01, STEPS, STEPS},
    {VEE, "verlet", 0.01, TAYLOR, NEVH_FINER_NONE},
    {VEE, "verlet", 0.001, TAYLOR | STEPS, STEPS},
    {STIFF, "verlet", 0.05, ADAPTIVE | STEPS, STEPS},
    {TURNING, "blanes-moan4", 0.01, 0, TAYLOR},
    {STRETCHED, "gauss4", 0.01, 0, TAYLOR},
};
TEST_EACH(kinds, sizeof cases / sizeof *cases) {
    const nevh_integrator *scheme = nevh_integrator_named(cases[_i].scheme);
    question a;
    ask(&a, cases[_i].coordinates, cases[_i].effects,
        (nevh_finer_question){.integrator = scheme,
                              .dt = cases[_i].dt,
                              .steps = 20000,
                              .kinds = cases[_i].kinds});
    ck_assert_msg((int)nevh_finer_how(a.finer) == cases[_i].kind, "%s: %d, %s",
                  cases[_i].effects, nevh_finer_how(a.finer),
                  nevh_finer_message(a.finer));
    bool made = cases[_i].kind != NEVH_FINER_NONE;
    ck_assert_int_eq(nevh_finer_status(a.finer) == NEVH_OK, made);
    ck_assert_int_eq(*nevh_finer_text(a.finer) != '\0', made);
    ck_assert_int_eq(*nevh_finer_message(a.finer) == '\0', made);
    ck_assert_int_eq(nevh_finer_stepper(a.finer) != NULL, made);
    if (cases[_i].kind == STEPS) {
        ck_assert_ptr_eq(nevh_finer_integrator(a.finer), scheme);
        ck_assert_double_eq(nevh_finer_dt(a.finer), cases[_i].dt / 2);
    } else if (made)
        ck_assert_double_ge(nevh_finer_dt(a.finer), cases[_i].dt);
    end(&a);
}

/* What has a tolerance gets a smaller one. */
TEST(tolerances) {
    question a;
    ask(&a, KEPLER,
        (nevh_finer_question){.integrator = nevh_dopri5,
                              .dt = 0.1,
                              .steps = 1000,
                              .kinds = STEPS,
                              .budget = -1});
    ck_assert_int_eq(nevh_finer_how(a.finer), STEPS);
    ck_assert_double_eq(nevh_finer_dt(a.finer), 0.1);
    ck_assert_double_lt(nevh_finer_options(a.finer)->tolerance, 1e-6);
    end(&a);
}

/* After one turn Kepler's orbit is where it was: the question's steps are off, and
   a finer run is not.  It ends there, or where its budget does. */
TEST(finer_runs_are_finer) {
    static const unsigned ways[] = {TAYLOR, ADAPTIVE, STEPS};
    double turn = 2 * acos(-1), h = turn / 4000;
    for (int i = 0; i < 3; i++) {
        question a;
        ask(&a, KEPLER,
            (nevh_finer_question){.integrator = nevh_verlet,
                                  .dt = h,
                                  .steps = 4000,
                                  .kinds = ways[i],
                                  .budget = 4});
        double q[MOST], p[MOST], reached = 0, coarse_q[MOST], coarse_p[MOST];
        memcpy(q, a.of.q, sizeof q);
        memcpy(p, a.of.p, sizeof p);
        memcpy(coarse_q, q, sizeof q);
        memcpy(coarse_p, p, sizeof p);
        ck_assert_int_eq(nevh_finer_run(a.finer, turn, q, p, NULL, 0, &reached),
                         NEVH_OK);
        ck_assert_double_eq_tol(reached, turn, 1e-12);
        nevh_stepper *s =
            nevh_stepper_new(a.of.system, nevh_verlet, &a.options);
        ck_assert_int_eq(nevh_run(s, 0, h, 4000, coarse_q, coarse_p, NULL, 0),
                         NEVH_OK);
        double off = hypot(q[0] - 0.1, q[1]);
        double coarse = hypot(coarse_q[0] - 0.1, coarse_q[1]);
        ck_assert_double_lt(off, ways[i] == STEPS ? coarse / 3 : 1e-7);
        nevh_stepper_free(s);
        end(&a);
    }
}

/* Half of the cost of the run is a quarter of its time at half the step, and the
   run is stopped there; it was said before. */
TEST(budgets_are_kept) {
    static const double budgets[] = {0, 0.5, 1, 2};
    for (int i = 0; i < 4; i++) {
        question a;
        ask(&a, PENDULUM,
            (nevh_finer_question){.integrator = nevh_verlet,
                                  .dt = 0.05,
                                  .steps = 40000,
                                  .kinds = STEPS,
                                  .budget = budgets[i]});
        double q[MOST] = {3}, p[MOST] = {0}, reached = 0;
        double part = fmax(budgets[i], i ? 0 : 0.5) / 2;
        int status = nevh_finer_run(a.finer, 2000, q, p, NULL, 0, &reached);
        ck_assert_double_eq_tol(reached / 2000, part, 0.05);
        ck_assert_double_eq_tol(nevh_finer_part(a.finer), part, 0.05);
        if (part < 1)
            ck_assert_int_eq(status, NEVH_STOPPED);
        end(&a);
    }
}

TEST(questions_that_are_none) {
    static const double q[1] = {1}, p[1] = {0};
    const nevh_options some = {.q = q, .p = p};
    const nevh_finer_question wrong[] = {
        {.options = &some, .dt = 0.1, .steps = 10},
        {.integrator = nevh_verlet, .dt = 0.1, .steps = 10},
        {.integrator = nevh_verlet, .options = &some, .steps = 10},
        {.integrator = nevh_verlet, .options = &some, .dt = 0.1},
        {.integrator = nevh_verlet, .options = &some, .dt = NAN, .steps = 1},
    };
    setup of = set_up(PENDULUM);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        nevh_finer *f = nevh_finer_new(of.system, &wrong[i]);
        double x[1], y[1];
        ck_assert_int_eq(nevh_finer_status(f), NEVH_EINVAL);
        ck_assert_int_eq(nevh_finer_run(f, 1, x, y, NULL, 0, NULL),
                         NEVH_EINVAL);
        nevh_finer_free(f);
    }
    nevh_scene_free(of.scene);
}

TEST(values_that_agree) {
    ck_assert(nevh_agree(1, 0.1, 1.3, 0.05));
    ck_assert(nevh_agree(1, 0, 1, 0));
    ck_assert(!nevh_agree(1, 0.1, 1.4, 0.05));
    ck_assert(!nevh_agree(1, INFINITY, 1, 0.1));
    ck_assert(!nevh_agree(NAN, 0.1, 1, 0.1));
}
