/* nevh tests: problems that can reveal an error, and measurements.
   SPDX-License-Identifier: GPL-3.0-or-later

   All problems are nonlinear, coupled where they can be, and have masses other
   than 1; an oscillator would hide half of the order conditions. */
#ifndef NEVH_TESTS_SUPPORT_H
#define NEVH_TESTS_SUPPORT_H

#include <check.h>
#include <nevh/nevh.h>
#include <stddef.h>
#include <string.h>

/* That a message has some words. */
#define assert_says(message, word)                                             \
    ck_assert_msg(strstr(message, word), "no \"%s\" in: %s", word, message)

enum { MOST_DOF = 2 };

typedef struct {
    const char *name;
    size_t n;
    bool separable, quadratic; /* T(p) + V(q); T quadratic */
    double t0, span;           /* where slopes are measured */
    double fewest; /* steps over that span that begin to make sense */
    double q[MOST_DOF], p[MOST_DOF];
    nevh_system *(*make)(void); /* terms with value, block and gradient */
} problem;

/* p^2/(2m), the mass being the instance's constant; a nevh_term_fn and its
   nevh_block_gradient_fn. */
double mass_kinetic(double t, const double q[], const double p[],
                    const double c[], const void *params);
void mass_kinetic_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dq[], double dp[]);
/* These of the momenta 0 to n - 1, as the term "kinetic". */
void add_kinetic(nevh_system *, size_t n, const double masses[]);
/* The same of two unit masses in one term. */
double plane_kinetic(double t, const double q[], const double p[],
                     const double c[], const void *params);
void plane_kinetic_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]);
/* -(2 + 0.7 sin(1.9 t)) cos(q): the potential of driven_pendulum. */
double driven_value(double t, const double q[], const double p[],
                    const double c[], const void *params);
void driven_gradient(size_t width, const double t[], const double q[],
                     const double p[], const double c[], const void *params,
                     double dq[], double dp[]);
/* -c/|q| in the plane. */
double gravity_value(double t, const double q[], const double p[],
                     const double c[], const void *params);
void gravity_gradient(size_t width, const double t[], const double q[],
                      const double p[], const double c[], const void *params,
                      double dq[], double dp[]);
/* -c cos(q), and up to three of them over the coordinates that are given, as a
   term. */
double wave_value(double t, const double q[], const double p[],
                  const double c[], const void *params);
void wave_gradient(size_t width, const double t[], const double q[],
                   const double p[], const double c[], const void *params,
                   double dq[], double dp[]);
void add_waves(nevh_system *, size_t count, const size_t *at);

/* A scene of lines of [coordinates] and [effects], after which other sections may
   follow; fails the test where it cannot be read. */
nevh_scene *scene_with(const char *coordinates, const char *rest);

/* Attraction by pull/|q| in the plane, with exact gradients. */
nevh_system *gravity_system(const double masses[2], double pull);

extern const problem driven_pendulum, kepler, henon_heiles, relativistic,
    double_pendulum;
/* The five of them, ended by NULL. */
extern const problem *const problems[];

/* Whether a scheme takes the problem's H. */
bool fits(const nevh_integrator *, const problem *);
/* The tolerance to plan with: 0, or a tight one for schemes that need one. */
double tolerance_for(const nevh_integrator *);
/* The order of a scheme on a problem: its own, but for Itoh and Abe's where H
   is a sum of functions of one variable each.  Coordinate increments do not
   depend on the order of the coordinates there, and the scheme is its own
   adjoint. */
int order_on(const problem *, const nevh_integrator *);
/* A stepper on a new system of the problem; fails the test when refused. */
nevh_stepper *planned(nevh_system *, const problem *, const nevh_integrator *,
                      const nevh_gradient *);
/* The order at which the state's error (root mean square over a few orbits)
   falls over at least four step sizes, by least squares; the reference is
   gauss16 at a small step. */
double measured_order(const problem *, const nevh_integrator *,
                      const nevh_gradient *);
/* Energy errors of `steps` steps of h, with exact gradients where g is NULL. */
nevh_energy_report energy_of(const problem *, const nevh_integrator *,
                             const nevh_gradient *g, double h, size_t steps);
/* The time to go on from, t + h by the clock: the stepper's own where its
   scheme has its own time. */
double time_on(const nevh_stepper *, const nevh_integrator *, double t);
/* The slope of a straight line through points. */
double slope_through(int count, const double x[], const double y[]);
/* Numbers of registered schemes, of those that take functions in C, as the
   problems have them (others come last: tests/taylor has them), and of
   models. */
int registered_count(void);
int scheme_count(void);
int model_count(void);
/* Ends a test that does not apply to its case. */
#define skip_test(why)                                                         \
    do {                                                                       \
        ck_assert_msg(true, why);                                              \
        return;                                                                \
    } while (0)

/* A test registers itself where it stands: TEST(name) { ... }.  support.c has
   main, which runs all tests of a program, in the order of their lines.  A test
   that neither asserts nor skips is a failure; skips are counted and printed.
   TEST_EACH runs it with _i from 0 to count - 1, TEST_RANGE from `from` to
   until - 1, both evaluated when main begins; TEST_TAGGED gives a tag, such as
   "slow", which make check leaves out.  TEST_ALSO adds further runs. */
typedef struct test_entry {
    const TTest *const *test;
    const char *tag;
    int line, from, (*until)(void);
    struct test_entry *next;
} test_entry;
void register_test(test_entry *);
#define TEST(name)                    TEST_TAGGED(name, NULL, 0, 1)
#define TEST_EACH(name, count)        TEST_TAGGED(name, NULL, 0, count)
#define TEST_RANGE(name, from, until) TEST_TAGGED(name, NULL, from, until)
#define TEST_TAGGED(name, tag, from, until)                                    \
    static const TTest *name;                                                  \
    TEST_ENTRY(name, __LINE__, tag, from, until)                               \
    START_TEST(name)
#define TEST_ALSO(name, tag, from, until)                                      \
    TEST_ENTRY(name, __LINE__, tag, from, until)
#define TEST_ENTRY(name, line, tag, from, until)                               \
    TEST_ENTRY_AT(name, line, tag, from, until)
#define TEST_ENTRY_AT(name, line, tag, from, until)                            \
    static int name##_until_##line(void) {                                     \
        return (int)(until);                                                   \
    }                                                                          \
    __attribute__((constructor)) static void name##_register_##line(void) {    \
        static test_entry entry = {                                            \
            &name, tag, line, from, name##_until_##line, NULL};                \
        register_test(&entry);                                                 \
    }

#endif
