/* nevh tests: systems of terms, their refusals and effects.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* c0 (1 + the sum of what is read, the k-th times k + 1). */
static double mixture(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)params;
    return c[0] * (1 + q[0] + 2 * q[1] + 3 * p[0]);
}

static double square(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return p[0] * p[0] / 2.6;
}

static double cosine(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -1.7 * cos(q[0]);
}

static const nevh_term kinetic = {
    .effect = "kinetic", .np = 1, .value = square};
static const nevh_term gravity = {
    .effect = "gravity", .nq = 1, .value = cosine};

static nevh_system *pendulum(void) {
    nevh_system *s = nevh_system_new(1);
    ck_assert_int_eq(nevh_system_add(s, &kinetic), NEVH_OK);
    ck_assert_int_eq(nevh_system_add(s, &gravity), NEVH_OK);
    return s;
}

/* A system with this error makes nothing that works. */
static void assert_useless(nevh_system *s, int status) {
    double z[8] = {0}, t = 0;
    nevh_field *f = nevh_field_new(s, NULL);
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, NULL);
    nevh_energy *e = nevh_energy_new(s, NULL);
    ck_assert(f && m && e);
    ck_assert_int_eq(nevh_field_status(f), status);
    ck_assert_str_eq(nevh_field_message(f), nevh_system_message(s));
    ck_assert_int_eq(nevh_field_gradient(f, 1, &t, z, z, z, z), status);
    ck_assert_int_eq(nevh_field_value(f, 1, &t, z, z, z), status);
    ck_assert_int_eq(nevh_stepper_status(m), status);
    ck_assert_str_eq(nevh_stepper_message(m), nevh_system_message(s));
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, z, z + 4), status);
    ck_assert_int_eq(nevh_run(m, 0, 0.1, 3, z, z + 4, NULL, 0), status);
    ck_assert_int_eq(nevh_energy_status(e), status);
    nevh_energy_free(e);
    nevh_stepper_free(m);
    nevh_field_free(f);
}

static const size_t too_large[] = {0, 1, 0, 3}, repeated[] = {0, 1, 2, 2};
static const double constants[] = {1, 2};
static const struct {
    nevh_term term;
    const char *words[4];
} refused[] = {
    {{"spring", NULL, 2, 0, 0, .q = too_large, .count = 2, .value = cosine},
     {"effect spring", "instance 1", "q[3]", "out of range"}},
    {{"spring", NULL, 0, 2, 0, .p = too_large, .count = 2, .value = cosine},
     {"effect spring", "instance 1", "p[3]", "out of range"}},
    {{"spring", NULL, 2, 0, 0, .q = repeated, .count = 2, .value = cosine},
     {"effect spring", "instance 1", "q[2]", "twice"}},
    {{"spring", NULL, 1, 2, 0, .p = repeated, .count = 2, .value = cosine},
     {"effect spring", "instance 1", "p[2]", "twice"}},
    {{"spring", NULL, 4, 0, 0, .value = cosine}, {"effect spring", "4 of q"}},
    {{"spring", NULL, 0, 5, 0, .value = cosine}, {"effect spring", "5 of p"}},
    {{"spring", NULL, 1, 0, 2, .value = cosine}, {"effect spring", "nc", "2"}},
    {{"spring", .nq = 1}, {"effect spring", "value or block"}},
    {{"", NULL, 1, .value = cosine}, {"name of its effect"}},
    {{NULL, NULL, 1, .value = cosine}, {"name of its effect"}},
    {{"spring", "kinetic", 1, .value = cosine},
     {"effect spring", "\"kinetic\"", "twice"}},
    {{"spring", "", 1, .value = cosine}, {"effect spring", "empty"}},
    {{"spring", NULL, 1, 0, 1, .c = constants, .count = SIZE_MAX / 4,
      .value = cosine},
     {"effect spring", "instances"}},
};
enum { REFUSED = sizeof refused / sizeof *refused };

TEST_EACH(refusal, REFUSED) {
    nevh_system *s = nevh_system_new(3);
    char first[400];
    ck_assert_int_eq(nevh_system_add(s, &kinetic), NEVH_OK);
    ck_assert_str_eq(nevh_system_message(s), "");
    ck_assert_int_eq(nevh_system_add(s, &refused[_i].term), NEVH_EINVAL);
    ck_assert_int_eq(nevh_system_status(s), NEVH_EINVAL);
    strcpy(first, nevh_system_message(s));
    for (int i = 0; i < 4 && refused[_i].words[i]; i++)
        assert_says(first, refused[_i].words[i]);
    ck_assert_int_eq(nevh_system_add(s, &gravity), NEVH_EINVAL);
    ck_assert_int_eq(nevh_system_enable(s, "kinetic", false), NEVH_EINVAL);
    ck_assert_str_eq(nevh_system_message(s), first);
    ck_assert_uint_eq(nevh_system_effect_count(s), 1);
    ck_assert(nevh_system_effect_on(s, "kinetic"));
    assert_useless(s, NEVH_EINVAL);
    nevh_system_free(s);
}

static double whole(double t, const double q[], const double p[],
                    const void *params) {
    (void)t, (void)params;
    return q[0] + p[0];
}

TEST(refused_at_birth) {
    nevh_system *made[] = {nevh_system_new(0), nevh_system_from(0, whole, NULL),
                           nevh_system_from(2, NULL, NULL),
                           nevh_system_new(SIZE_MAX)};
    const char *words[] = {"degrees of freedom", "degrees of freedom",
                           "H is NULL", "degrees of freedom"};
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(nevh_system_status(made[i]), NEVH_EINVAL);
        assert_says(nevh_system_message(made[i]), words[i]);
        ck_assert_int_eq(nevh_system_add(made[i], &kinetic), NEVH_EINVAL);
        assert_useless(made[i], NEVH_EINVAL);
        nevh_system_free(made[i]);
    }
    ck_assert_int_eq(nevh_system_status(NULL), NEVH_ENOMEM);
    ck_assert_str_ne(nevh_system_message(NULL), "");
    nevh_system_free(NULL);
}

TEST(unknown_effect) {
    nevh_system *s = pendulum();
    ck_assert(!nevh_system_effect_on(s, "drag"));
    ck_assert(!nevh_system_effect_on(s, NULL));
    ck_assert_int_eq(nevh_system_enable(s, "drag", true), NEVH_EINVAL);
    assert_says(nevh_system_message(s), "\"drag\"");
    assert_useless(s, NEVH_EINVAL);
    nevh_system_free(s);
}

/* What the caller hands over may be changed and freed at once. */
TEST(tables_are_copied) {
    size_t *q = malloc(4 * sizeof *q), *p = malloc(2 * sizeof *p);
    double *c = malloc(2 * sizeof *c);
    char *name = malloc(4), *effect = malloc(4);
    memcpy(q, (size_t[]){2, 0, 1, 2}, 4 * sizeof *q);
    memcpy(p, (size_t[]){1, 2}, 2 * sizeof *p);
    memcpy(c, (double[]){1.5, -0.25}, 2 * sizeof *c);
    strcpy(name, "one");
    strcpy(effect, "two");
    nevh_system *s = nevh_system_new(3);
    nevh_system_add(
        s, &(nevh_term){effect, name, 2, 1, 1, q, p, c, 2, .value = mixture});
    memset(q, 0, 4 * sizeof *q);
    memset(p, 0, 2 * sizeof *p);
    memset(c, 0, 2 * sizeof *c);
    name[0] = effect[0] = 'x';
    free(q), free(p), free(c), free(name), free(effect);
    nevh_field *f = nevh_field_new(s, NULL);
    double t = 0, x[] = {0.3, 0.5, 0.7}, y[] = {1.1, 1.3, 1.7}, h;
    ck_assert_int_eq(nevh_field_value(f, 1, &t, x, y, &h), NEVH_OK);
    ck_assert_double_eq_tol(h, 1.5 * 6.2 - 0.25 * 8, 1e-14);
    ck_assert_str_eq(nevh_system_effect_name(s, 0), "two");
    ck_assert(nevh_field_step(f, "one", 1, 1) > 0);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST(automatic_names) {
    nevh_system *s = nevh_system_new(4);
    const char *names[] = {NULL, "a 2", NULL, NULL};
    const char *expected[] = {"a", "a 2", "a 3", "a 4"};
    for (size_t i = 0; i < 4; i++)
        nevh_system_add(s, &(nevh_term){.effect = "a",
                                        .name = names[i],
                                        .nq = 1,
                                        .q = &i,
                                        .value = cosine});
    ck_assert_int_eq(nevh_system_status(s), NEVH_OK);
    ck_assert_uint_eq(nevh_system_effect_count(s), 1);
    nevh_field *f = nevh_field_new(s, NULL);
    for (size_t name = 0; name < 4; name++)
        for (size_t i = 0; i < 8; i++)
            ck_assert((nevh_field_step(f, expected[name], 0, i) > 0) ==
                      (i == name));
    nevh_field_free(f);
    nevh_system_free(s);
}

/* The time to add a term does not grow with their number: comparing each name
   with all others would take hours here, and the test's limit ends it. */
TEST(many_terms_of_one_effect) {
    enum { MANY = 200000 };
    nevh_system *s = nevh_system_new(1);
    for (int i = 0; i < MANY; i++)
        ck_assert_int_eq(nevh_system_add(s, &gravity), NEVH_OK);
    ck_assert_uint_eq(nevh_system_effect_count(s), 1);
    nevh_system_free(s);
}

TEST(effects_group_terms) {
    nevh_system *s = pendulum();
    double t = 0, q = 0.4, p = 0.9, h[2];
    nevh_system_add(
        s, &(nevh_term){
               .effect = "kinetic", .name = "more", .np = 1, .value = square});
    ck_assert_uint_eq(nevh_system_dof(s), 1);
    ck_assert_uint_eq(nevh_system_effect_count(s), 2);
    ck_assert_str_eq(nevh_system_effect_name(s, 0), "kinetic");
    ck_assert_str_eq(nevh_system_effect_name(s, 1), "gravity");
    ck_assert_ptr_null(nevh_system_effect_name(s, 2));
    for (int on = 1; on >= 0; on--) {
        ck_assert_int_eq(nevh_system_enable(s, "kinetic", on), NEVH_OK);
        ck_assert_int_eq(nevh_system_effect_on(s, "kinetic"), on);
        ck_assert(nevh_system_effect_on(s, "gravity"));
        nevh_system_add(s, &kinetic); /* joins its effect, on or off */
        nevh_field *f = nevh_field_new(s, NULL);
        ck_assert_int_eq(nevh_field_effects(f, t, &q, &p, h), NEVH_OK);
        ck_assert_double_eq_tol(h[0], on ? 3 * 0.81 / 2.6 : 0, 1e-15);
        ck_assert_double_eq(h[1], -1.7 * cos(0.4));
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

static double spring(double t, const double q[], const double p[],
                     const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    return c[0] * (q[0] - q[1]) * (q[0] - q[1]);
}
static double kinetic_of(double t, const double q[], const double p[],
                         const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return c[0] * p[0] * p[0];
}
static double product(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)c, (void)params;
    return q[0] * q[1] * p[0];
}

/* Three masses, a spring between neighbours, and what reads mass 0 twice: what
   reads two groups counts for both, and once for each. */
TEST(energies_of_groups) {
    const size_t pairs[] = {0, 1, 1, 2}, both[] = {0, 1}, own[] = {0, 1, 2};
    const double k[] = {2, 3}, m[] = {1, 10, 100};
    const double q[] = {0.5, 2, 3}, p[] = {7, 0.1, 0.3};
    nevh_system *s = nevh_system_new(3);
    nevh_system_add(s, &(nevh_term){"springs", .nq = 2, .nc = 1, .q = pairs,
                                    .c = k, .count = 2, .value = spring});
    nevh_system_add(s, &(nevh_term){"kinetic", .np = 1, .nc = 1, .p = own,
                                    .c = m, .count = 3, .value = kinetic_of});
    nevh_system_add(s, &(nevh_term){"mixed", .nq = 2, .np = 1, .q = both,
                                    .p = both, .value = product});
    const double T[] = {49, 0.1, 9}, V[] = {4.5, 3}, mixed = 7;
    double h[3];
    for (int on = 1; on >= 0; on--) {
        nevh_system_enable(s, "springs", on);
        nevh_field *f = nevh_field_new(s, NULL);
        ck_assert_int_eq(nevh_field_groups(f, 0, q, p, 3, own, h), NEVH_OK);
        ck_assert_double_eq_tol(h[0], T[0] + on * V[0] + mixed, 1e-13);
        ck_assert_double_eq_tol(h[1], T[1] + on * (V[0] + V[1]) + mixed, 1e-13);
        ck_assert_double_eq_tol(h[2], T[2] + on * V[1], 1e-13);
        ck_assert_int_eq(
            nevh_field_groups(f, 0, q, p, 2, (size_t[]){1, SIZE_MAX, 1}, h),
            NEVH_OK);
        ck_assert_double_eq(h[0], 0);
        ck_assert_double_eq_tol(h[1], T[0] + T[2] + on * (V[0] + V[1]) + mixed,
                                1e-13);
        nevh_field_free(f);
    }
    nevh_system_free(s);
}

static int change_nothing(nevh_system *s) {
    return nevh_system_enable(s, "gravity", true);
}
static int switch_off(nevh_system *s) {
    return nevh_system_enable(s, "gravity", false);
}
/* Off and on again is a change, too: what was planned does not come back. */
static int switch_off_and_on(nevh_system *s) {
    return switch_off(s) || change_nothing(s);
}
static int add_term(nevh_system *s) {
    return nevh_system_add(s, &gravity);
}

TEST_EACH(stale, 4) {
    int (*const changes[])(nevh_system *) = {change_nothing, switch_off,
                                             switch_off_and_on, add_term};
    const int status = _i ? NEVH_ESTALE : NEVH_OK;
    nevh_system *s = pendulum();
    nevh_field *f = nevh_field_new(s, NULL);
    nevh_stepper *m = nevh_stepper_new(s, nevh_verlet, NULL);
    nevh_stepper *other = nevh_stepper_new(s, nevh_gauss4, NULL);
    double t = 0, q = 0.4, p = 0.9, h[2], x = q, y = p;
    ck_assert_int_eq(nevh_stepper_apply(m, 0, 0.1, &q, &p), NEVH_OK);
    ck_assert_int_eq(changes[_i](s), NEVH_OK);
    nevh_stepper *copy = nevh_stepper_copy(m);
    double q1 = q, p1 = p, q2 = q, p2 = p;
    ck_assert_int_eq(nevh_field_gradient(f, 1, &t, &q, &p, h, NULL), status);
    ck_assert_int_eq(nevh_field_value(f, 1, &t, &q, &p, h), status);
    ck_assert_int_eq(nevh_field_effects(f, t, &q, &p, h), status);
    ck_assert_int_eq(nevh_stepper_apply(m, 0.1, 0.1, &q1, &p1), status);
    ck_assert_int_eq(nevh_stepper_apply(copy, 0.1, 0.1, &q2, &p2), status);
    ck_assert_int_eq(nevh_run(other, 0, 0.1, 3, &x, &y, NULL, 0), status);
    ck_assert_int_eq(nevh_stepper_status(m), status);
    ck_assert_int_eq(nevh_stepper_status(other), status);
    if (status) {
        assert_says(nevh_stepper_message(m), "new stepper");
        assert_says(nevh_field_message(f), "new stepper");
        ck_assert(q1 == q && p1 == p && q2 == q && p2 == p);
        ck_assert(x == 0.4 && y == 0.9);
    }
    nevh_stepper_free(m);
    nevh_stepper_free(copy);
    nevh_stepper_free(other);
    nevh_field_free(f);
    nevh_system_free(s);
}

/* A term gets what it declares, in the order it declares; time only if it
   reads it, whatever the others read. */
static double gathered(double t, const double q[], const double p[],
                       const double c[], const void *params) {
    (void)params;
    return t + q[0] + 10 * q[1] + 100 * p[0] + 1000 * c[0];
}

static void gathered_block(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double h[]) {
    for (size_t i = 0; i < width; i++) {
        double z[] = {q[i], q[width + i], p[i], c[i]};
        h[i] = gathered(t[i], z, z + 2, z + 3, params);
    }
}

static double clock_value(double t, const double q[], const double p[],
                          const double c[], const void *params) {
    (void)q, (void)p, (void)c, (void)params;
    return 0 * t;
}

TEST_EACH(handed_what_is_read, 4) {
    const bool block = _i & 1, time = _i & 2;
    static const size_t q[] = {3, 1, 0, 4}, p[] = {4, 2};
    static const double c[] = {7, -7};
    nevh_term term = {"a", NULL, 2, 1, 1, q, p, c, 2, .time = time};
    term.value = block ? NULL : gathered;
    term.block = block ? gathered_block : NULL;
    nevh_system *s = nevh_system_new(5);
    nevh_system_add(
        s, &(nevh_term){.effect = "clock", .time = true, .value = clock_value});
    ck_assert_int_eq(nevh_system_add(s, &term), NEVH_OK);
    nevh_field *f = nevh_field_new(s, &(nevh_options){.gradient_step = 0.5});
    const double x[] = {1, 2, 3, 4, 5}, y[] = {6, 7, 8, 9, 11}, t = 0.25;
    double h, dq[5], dp[5];
    ck_assert_int_eq(nevh_field_value(f, 1, &t, x, y, &h), NEVH_OK);
    ck_assert_double_eq(h, (4 + 20 + 1100) + (1 + 50 + 800) + time * 0.5);
    ck_assert_int_eq(nevh_field_gradient(f, 1, &t, x, y, dq, dp), NEVH_OK);
    const double expected[] = {1, 10, 0, 1, 10, 0, 0, 100, 0, 100};
    for (int i = 0; i < 5; i++) {
        ck_assert_double_eq_tol(dq[i], expected[i], 1e-10);
        ck_assert_double_eq_tol(dp[i], expected[5 + i], 1e-10);
    }
    nevh_field_free(f);
    nevh_system_free(s);
}

/* Reads everything, so that a trace of it would be seen everywhere. */
static double counted(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)c;
    ++**(size_t *const *)params;
    return 0.3 * sin(q[0] * p[0] + t);
}

static void run_scheme(nevh_system *s, const nevh_integrator *scheme,
                       double z[2], nevh_counts *counts) {
    nevh_options options = {.tolerance = tolerance_for(scheme)};
    nevh_stepper *m = nevh_stepper_new(s, scheme, &options);
    z[0] = 0.7;
    z[1] = 0.4;
    ck_assert_int_eq(nevh_run(m, 0, 0.1, 20, z, z + 1, NULL, 0), NEVH_OK);
    *counts = nevh_stepper_counts(m);
    nevh_stepper_free(m);
}

/* What is off costs nothing and leaves no trace. */
TEST_EACH(off_is_off, scheme_count()) {
    const nevh_integrator *scheme = nevh_integrators()[_i];
    size_t calls = 0, *params = &calls;
    nevh_system *without = pendulum(), *with = nevh_system_new(1);
    const nevh_term off = {.effect = "off",
                           .nq = 1,
                           .np = 1,
                           .time = true,
                           .value = counted,
                           .params = &params};
    nevh_system_add(with, &off);
    nevh_system_add(with, &kinetic);
    nevh_system_add(with, &off);
    nevh_system_add(with, &gravity);
    nevh_system_enable(with, "off", false);
    double z[2], other[2];
    nevh_counts counts, others;
    run_scheme(without, scheme, z, &counts);
    run_scheme(with, scheme, other, &others);
    ck_assert_uint_eq(calls, 0);
    ck_assert_mem_eq(z, other, sizeof z);
    ck_assert_mem_eq(&counts, &others, sizeof counts);
    ck_assert(counts.values > 0 && z[0] != 0.7);
    nevh_system_enable(with, "off", true);
    nevh_stepper *m = nevh_stepper_new(with, nevh_midpoint, NULL);
    nevh_stepper_apply(m, 0, 0.1, other, other + 1);
    ck_assert_uint_gt(calls, 0);
    nevh_stepper_free(m);
    nevh_system_free(with);
    nevh_system_free(without);
}

/* Sizes that overflow are no memory, and no endless loop. */
TEST_EACH(widths_that_overflow, 3) {
    nevh_system *s = nevh_system_new(4);
    static const size_t widths[] = {SIZE_MAX, SIZE_MAX / 2 + 1, SIZE_MAX / 8};
    nevh_options o = {.width = widths[_i]};
    ck_assert_ptr_null(nevh_stepper_new(s, nevh_verlet, &o));
    ck_assert_ptr_null(nevh_field_new(s, &o));
    nevh_system_free(s);
}
