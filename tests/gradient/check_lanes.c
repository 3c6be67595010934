/* nevh tests: instances, lanes and blocks do not change a bit.
   SPDX-License-Identifier: GPL-3.0-or-later

   The system is a chain of N masses on anharmonic springs, shaken; its counts
   and the widths are such that blocks of 128 columns end in the middle of
   springs and lanes. */
#include "support.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 37, SPRINGS = N - 1, STATE = N * 200 };

static double chain_spring(double t, const double q[], const double p[],
                           const double c[], const void *params) {
    double d = q[1] - q[0];
    (void)t, (void)p, (void)params;
    return c[0] * d * d + c[1] * d * d * d * d;
}

static void spring_block(size_t width, const double t[], const double q[],
                         const double p[], const double c[], const void *params,
                         double h[]) {
    (void)t, (void)p, (void)params;
    ck_assert_uint_eq(width % 8, 0);
    for (size_t i = 0; i < width; i++) {
        double d = q[width + i] - q[i];
        ck_assert(c[i] > 0); /* padding is a state like the others */
        h[i] = c[i] * d * d + c[width + i] * d * d * d * d;
    }
}

static void spring_gradient(size_t width, const double t[], const double q[],
                            const double p[], const double c[],
                            const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    ck_assert_uint_eq(width % 8, 0);
    for (size_t i = 0; dq && i < width; i++) {
        double d = q[width + i] - q[i];
        dq[width + i] = 2 * c[i] * d + 4 * c[width + i] * d * d * d;
        dq[i] = -dq[width + i];
    }
}

static double mass(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)q, (void)params;
    return p[0] * p[0] / (2 * c[0]);
}

static void mass_gradient(size_t width, const double t[], const double q[],
                          const double p[], const double c[],
                          const void *params, double dq[], double dp[]) {
    (void)t, (void)q, (void)params, (void)dq;
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = p[i] / c[i];
}

static double shaking(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)c, (void)params;
    return sin(q[0] + 2 * t) + 0.1 * q[0] * p[0];
}

static void shaking_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dq[], double dp[]) {
    (void)c, (void)params;
    for (size_t i = 0; dq && i < width; i++)
        dq[i] = cos(q[i] + 2 * t[i]) + 0.1 * p[i];
    for (size_t i = 0; dp && i < width; i++)
        dp[i] = 0.1 * q[i];
}

/* The chain's terms, with tables that are filled in here. */
typedef struct {
    nevh_term spring, mass, shaking;
    size_t ends[2 * SPRINGS], masses[N], shaken[1];
    double k[2 * SPRINGS], m[N];
} chain;

static void fill_chain(chain *c) {
    for (size_t i = 0; i < N; i++) {
        c->masses[i] = i;
        c->m[i] = 1 + 0.13 * (double)(i % 5);
    }
    for (size_t i = 0; i < SPRINGS; i++) {
        c->ends[2 * i] = i;
        c->ends[2 * i + 1] = i + 1;
        c->k[2 * i] = 0.5 + 0.07 * (double)(i % 7);
        c->k[2 * i + 1] = 0.3 - 0.02 * (double)(i % 3);
    }
    c->shaken[0] = 11;
    c->spring = (nevh_term){"springs",
                            NULL,
                            2,
                            0,
                            2,
                            c->ends,
                            NULL,
                            c->k,
                            SPRINGS,
                            false,
                            chain_spring,
                            NULL,
                            spring_gradient,
                            NULL,
                            NULL,
                            NULL,
                            NULL,
                            false,
                            NULL};
    c->mass = (nevh_term){"masses",      NULL, 0,    1,     1,    NULL,
                          c->masses,     c->m, N,    false, mass, NULL,
                          mass_gradient, NULL, NULL, NULL,  NULL, false,
                          NULL};
    c->shaking = (nevh_term){
        "shaking", NULL, 1,    1,       0,    c->shaken,        c->shaken,
        NULL,      1,    true, shaking, NULL, shaking_gradient, NULL,
        NULL,      NULL, NULL, false,   NULL};
}

static nevh_system *system_of(const nevh_term terms[], size_t count) {
    nevh_system *s = nevh_system_new(N);
    for (size_t i = 0; i < count; i++)
        nevh_system_add(s, &terms[i]);
    ck_assert_msg(!nevh_system_status(s), "%s", nevh_system_message(s));
    return s;
}

static nevh_system *whole_chain(bool block) {
    chain c;
    fill_chain(&c);
    if (block) {
        c.spring.value = NULL;
        c.spring.block = spring_block;
    }
    return system_of((nevh_term[]){c.spring, c.mass, c.shaking}, 3);
}

/* With a step given: the same for all fields, whatever the terms. */
static nevh_field *field_of(const nevh_system *s, const nevh_gradient *g) {
    int order = nevh_gradient_order(g ? g : nevh_central4);
    double step = pow(DBL_EPSILON, 1. / (order + 1));
    nevh_options o = {.gradient = g, .gradient_step = exp2(round(log2(step)))};
    nevh_field *f = nevh_field_new(s, &o);
    ck_assert_msg(!nevh_field_status(f), "%s", nevh_field_message(f));
    return f;
}

/* States, each lane another one; the same number for the same lane. */
typedef struct {
    double t[200], q[STATE], p[STATE], dq[STATE], dp[STATE], h[200];
} states;

static void fill_states(states *z, size_t first, size_t width) {
    for (size_t lane = 0; lane < width; lane++) {
        double x = (double)(first + lane);
        z->t[lane] = 0.01 * x;
        for (size_t k = 0; k < N; k++) {
            z->q[k * width + lane] = sin(1.7 * (double)k + x);
            z->p[k * width + lane] = cos(0.9 * (double)k * x) + 0.2;
        }
    }
}

static void evaluate(nevh_field *f, size_t width, states *z) {
    ck_assert_int_eq(
        nevh_field_gradient(f, width, z->t, z->q, z->p, z->dq, z->dp), NEVH_OK);
    ck_assert_int_eq(nevh_field_value(f, width, z->t, z->q, z->p, z->h),
                     NEVH_OK);
}

/* The gradient and value of a new system at one state. */
static states *evaluated(nevh_system *s, const nevh_gradient *g) {
    states *z = calloc(1, sizeof *z);
    nevh_field *f = field_of(s, g);
    fill_states(z, 5, 1);
    evaluate(f, 1, z);
    nevh_field_free(f);
    nevh_system_free(s);
    return z;
}

static void assert_same(states *a, states *b, double tolerance) {
    for (size_t k = 0; k < N; k++) {
        ck_assert_double_le(fabs(a->dq[k] - b->dq[k]), tolerance);
        ck_assert_double_le(fabs(a->dp[k] - b->dp[k]), tolerance);
    }
    ck_assert_double_le(fabs(a->h[0] - b->h[0]), tolerance);
    free(a);
    free(b);
}

/* The differences, then exact. */
static const nevh_gradient *method(int i) {
    return i < 4 ? nevh_gradients()[i] : nevh_exact;
}

TEST_EACH(lanes_are_alone, 10) {
    static const size_t widths[] = {1, 3, 8, 17, 200};
    nevh_system *s = whole_chain(_i >= 5);
    nevh_field *f = field_of(s, method(_i % 5));
    states *many = calloc(1, sizeof *many), *one = calloc(1, sizeof *one);
    for (int w = 0; w < 5; w++) {
        size_t width = widths[w];
        fill_states(many, 0, width);
        evaluate(f, width, many);
        for (size_t lane = 0; lane < width; lane++) {
            fill_states(one, lane, 1);
            evaluate(f, 1, one);
            ck_assert(many->h[lane] == one->h[0]);
            for (size_t k = 0; k < N; k++) {
                ck_assert(many->dq[k * width + lane] == one->dq[k]);
                ck_assert(many->dp[k * width + lane] == one->dp[k]);
            }
        }
    }
    free(many);
    free(one);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST_EACH(block_is_value, 5) {
    assert_same(evaluated(whole_chain(false), method(_i)),
                evaluated(whole_chain(true), method(_i)), 0);
}

/* Springs added one by one are the springs of one table. */
TEST_EACH(instances_are_terms, 5) {
    nevh_term terms[SPRINGS + 2];
    chain c;
    fill_chain(&c);
    for (size_t i = 0; i < SPRINGS; i++) {
        terms[i] = c.spring;
        terms[i].q += 2 * i;
        terms[i].c += 2 * i;
        terms[i].count = 1;
    }
    terms[SPRINGS] = c.mass;
    terms[SPRINGS + 1] = c.shaking;
    assert_same(evaluated(system_of(terms, SPRINGS + 2), method(_i)),
                evaluated(whole_chain(false), method(_i)), 0);
}

static double whole(double t, const double q[], const double p[],
                    const void *params) {
    const chain *c = params;
    double h = shaking(t, q + 11, p + 11, NULL, NULL);
    for (size_t i = 0; i < SPRINGS; i++)
        h += chain_spring(t, q + i, p, c->k + 2 * i, NULL);
    for (size_t i = 0; i < N; i++)
        h += mass(t, q, p + i, c->m + i, NULL);
    return h;
}

/* So are they in one function, but for the rounding of a larger sum. */
TEST_EACH(terms_are_the_whole, 4) {
    static const double accuracy[] = {2e-8, 1e-10, 2e-11, 1e-11};
    chain c;
    fill_chain(&c);
    states *exact = evaluated(whole_chain(false), nevh_exact);
    states *copy = malloc(sizeof *copy);
    *copy = *exact;
    assert_same(evaluated(nevh_system_from(N, whole, &c), method(_i)), exact,
                accuracy[_i]);
    assert_same(evaluated(whole_chain(false), method(_i)), copy, accuracy[_i]);
}

/* Reads more than it needs. */
static double wide(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    return chain_spring(t, q + 4, p, c, params);
}

TEST_EACH(sparse_is_wide, 4) {
    chain c;
    fill_chain(&c);
    nevh_term sparse = c.spring, all = c.spring;
    sparse.q = (const size_t[]){4, 5};
    all.q = NULL;
    all.nq = all.np = N;
    all.value = wide;
    sparse.count = all.count = 1;
    assert_same(evaluated(system_of(&sparse, 1), method(_i)),
                evaluated(system_of(&all, 1), method(_i)), 0);
}

TEST_EACH(outputs_not_wanted, 4) {
    const nevh_gradient *g = method(_i);
    nevh_system *s = whole_chain(_i % 2);
    nevh_field *f = field_of(s, g), *part = field_of(s, g);
    states *z = calloc(1, sizeof *z);
    double dq[3 * N], dp[3 * N];
    fill_states(z, 0, 3);
    evaluate(f, 3, z);
    memset(dq, 255, sizeof dq);
    memset(dp, 255, sizeof dp);
    nevh_field_gradient(part, 3, z->t, z->q, z->p, NULL, NULL);
    ck_assert_uint_eq(nevh_field_counts(part).values, 0);
    nevh_field_gradient(part, 3, z->t, z->q, z->p, dq, NULL);
    uint64_t each = 3 * (uint64_t)nevh_gradient_order(g);
    ck_assert_uint_eq(nevh_field_counts(part).values, each * (2 * SPRINGS + 1));
    ck_assert_uint_eq(nevh_field_counts(part).gradients, 3);
    nevh_field_gradient(part, 3, z->t, z->q, z->p, NULL, dp);
    ck_assert_uint_eq(nevh_field_counts(part).values,
                      each * (2 * SPRINGS + 1 + N + 1));
    ck_assert_uint_eq(nevh_field_counts(part).gradients, 3);
    ck_assert_uint_eq(nevh_field_effect_values(part, "springs"),
                      each * 2 * SPRINGS);
    ck_assert_uint_eq(nevh_field_effect_values(part, "none"), 0);
    ck_assert_double_eq(nevh_field_counts(part).hamiltonians * (2 * N),
                        (double)nevh_field_counts(part).values);
    ck_assert_mem_eq(dq, z->dq, sizeof dq);
    ck_assert_mem_eq(dp, z->dp, sizeof dp);
    free(z);
    nevh_field_free(part);
    nevh_field_free(f);
    nevh_system_free(s);
}

static size_t calls;

static double counted(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    calls++;
    return shaking(t, q, p, c, params);
}

static double never(double t, const double q[], const double p[],
                    const double c[], const void *params) {
    (void)t, (void)q, (void)p, (void)c, (void)params;
    ck_abort_msg("value is called where there is a block");
}

/* Padding is neither counted nor put before a value function; what has a block
   is never evaluated through its value. */
TEST_EACH(padding_is_not_counted, 4) {
    chain c;
    fill_chain(&c);
    c.spring.value = never;
    c.spring.block = spring_block;
    c.shaking.value = counted;
    nevh_system *s = system_of((nevh_term[]){c.spring, c.shaking}, 2);
    states *z = calloc(1, sizeof *z);
    for (size_t width = 1; width < 20; width += 3) {
        nevh_field *f = field_of(s, method(_i));
        uint64_t each = width * (2 * (uint64_t)nevh_gradient_order(method(_i)));
        calls = 0;
        fill_states(z, 0, width);
        evaluate(f, width, z);
        ck_assert_uint_eq(calls, each + width);
        ck_assert_uint_eq(nevh_field_effect_values(f, "shaking"), calls);
        ck_assert_uint_eq(nevh_field_effect_values(f, "springs"),
                          SPRINGS * (each + width));
        ck_assert_uint_eq(nevh_field_counts(f).values,
                          (SPRINGS + 1) * (each + width));
        nevh_field_free(f);
    }
    free(z);
    nevh_system_free(s);
}

TEST_EACH(effects_sum_to_the_value, 2) {
    nevh_system *s = whole_chain(_i);
    states *z = calloc(1, sizeof *z);
    nevh_field *f = field_of(s, NULL);
    double h[] = {-1, -1, -1};
    fill_states(z, 3, 1);
    evaluate(f, 1, z);
    ck_assert_int_eq(nevh_field_effects(f, z->t[0], z->q, z->p, h), NEVH_OK);
    ck_assert(h[0] != 0 && h[1] != 0 && h[2] != 0);
    ck_assert_double_eq_tol(h[0] + h[1] + h[2], z->h[0], 1e-13);
    nevh_field_free(f);
    nevh_system_enable(s, "masses", false);
    f = field_of(s, NULL);
    ck_assert_int_eq(nevh_field_effects(f, z->t[0], z->q, z->p, h), NEVH_OK);
    ck_assert_double_eq(h[1], 0);
    evaluate(f, 1, z);
    ck_assert_double_eq_tol(h[0] + h[2], z->h[0], 1e-13);
    free(z);
    nevh_field_free(f);
    nevh_system_free(s);
}

static double bond(double t, const double q[], const double p[],
                   const double c[], const void *params) {
    (void)t, (void)p, (void)params;
    return -c[0] * cos(q[0] - q[1]);
}

static void bond_gradient(size_t width, const double t[], const double q[],
                          const double p[], const double c[],
                          const void *params, double dq[], double dp[]) {
    (void)t, (void)p, (void)params, (void)dp;
    for (size_t i = 0; dq && i < width; i++) {
        dq[i] = c[i] * sin(q[i] - q[width + i]);
        dq[width + i] = -dq[i];
    }
}

/* So many on one coordinate, and so unlike, that the order of a sum shows. */
static nevh_system *bonds(void) {
    static const size_t at[] = {0, 1, 1, 2, 2, 1, 1, 0, 2, 0};
    static const double c[] = {1.25, 0.7, 1e-3, 3.1, 0.9};
    nevh_system *s = nevh_system_new(3);
    ck_assert(!nevh_system_add(s, &(nevh_term){.effect = "bonds",
                                               .nq = 2,
                                               .nc = 1,
                                               .q = at,
                                               .c = c,
                                               .count = 5,
                                               .value = bond,
                                               .gradient = bond_gradient}));
    return s;
}

/* Each lane has what it would have alone, to the last bit. */
TEST_EACH(sums_in_one_order, 4) {
    static const size_t widths[] = {1, 3, 8, 16};
    enum { STATES = 40 };
    size_t width = widths[_i];
    nevh_system *s = bonds();
    nevh_field *f = nevh_field_new(s, &(nevh_options){.gradient = nevh_exact});
    ck_assert_int_eq(nevh_field_status(f), NEVH_OK);
    for (int state = 0; state < STATES; state++) {
        double t[16] = {0}, q[48], p[48] = {0}, g[48], x[3];
        for (size_t k = 0; k < 3; k++)
            x[k] = sin(1.7 * state + (double)k);
        for (size_t i = 0; i < 3 * width; i++)
            q[i] = x[i / width] + (i % width == width - 1 ? 0 : 0.01);
        double a = sin(x[0] - x[1]), b = sin(x[1] - x[2]);
        double c = sin(x[2] - x[1]), d = sin(x[1] - x[0]);
        double second = 0.7 * b + 3.1 * d - 1.25 * a - 1e-3 * c;
        ck_assert(!nevh_field_gradient(f, width, t, q, p, g, NULL));
        ck_assert(g[2 * width - 1] == second);
    }
    nevh_field_free(f);
    nevh_system_free(s);
}
