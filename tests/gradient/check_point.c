/* nevh tests: the gradient of one state is that of a block, to the last bit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include <nevh/body.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { STATES = 4096, LANES = 8, MOST = 3 };

/* In [from, to). */
static double uniform(double from, double to) {
    static unsigned long long seed = 20240301;
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return from + (to - from) * ((double)(seed >> 11) / 9007199254740992.0);
}

static bool same(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

/* A body as a term that only its gradients are taken of. */
#define OF_X(f)                                                                \
    NEVH_GRADIENT(of_##f, void, { nevh_dh_dq(0) = nevh_##f(nevh_q(0)); })
#define OF_XY(name, expression)                                                \
    NEVH_GRADIENT(of_##name, void, {                                           \
        double x = nevh_q(0), y = nevh_p(0);                                   \
        nevh_dh_dq(0) = expression;                                            \
        nevh_dh_dp(0) = x - y;                                                 \
    })
OF_X(sin)
OF_X(cos)
OF_X(tan)
OF_X(asin)
OF_X(acos)
OF_X(atan)
OF_X(sinh)
OF_X(cosh)
OF_X(tanh)
OF_X(exp)
OF_X(log)
OF_X(sqrt)
OF_X(cbrt)
OF_X(abs)
OF_XY(atan2, nevh_atan2(x, y))
OF_XY(hypot, nevh_hypot(x, y))
OF_XY(pow, nevh_pow(x, y))
OF_XY(min, nevh_min(x, y))
OF_XY(max, nevh_max(x, y))
OF_XY(atan2_right, nevh_atan2(x, 0.7))
OF_XY(atan2_left, nevh_atan2(-0.7, x))
OF_XY(power_minus_6, nevh_pow(x, -6) + y)
OF_XY(power_minus_2, nevh_pow(x, -2) + y)
OF_XY(power_4, nevh_pow(x, 4) + y)
OF_XY(root, nevh_pow(x, 0.5) + y)
OF_XY(exponential, nevh_pow(2.5, x) + y)
OF_XY(quotient, x / y)
OF_XY(cancelling, x *x - 3 * (y * x))
OF_XY(either, x > y ? x * x : y)
OF_XY(nested, nevh_sin(nevh_cos(x) + nevh_exp(-y * y)))

typedef struct {
    double weights[MOST];
    int turns;
} parameters;

/* Arguments that are the same in all lanes. */
NEVH_GRADIENT(of_params, parameters, {
    nevh_dh_dq(0) = nevh_sin(0.37 * params->turns) * nevh_q(0);
    nevh_dh_dp(0) = nevh_exp(params->weights[0]) *
                    nevh_pow(params->weights[2], params->weights[1]);
})

/* All that a body may read; a loop; halves that share what is dear. */
NEVH_GRADIENT(everything, parameters, {
    double sum = 0;
    NEVH_UNROLL for (int k = 0; k < MOST; k++) {
        sum += params->weights[k] * nevh_q(k) * nevh_p(k) / nevh_c(k);
    }
    double wave = nevh_sin(sum + nevh_t) * nevh_cos(2 * nevh_t);
    NEVH_UNROLL for (int k = 0; k < MOST; k++) {
        double part = params->weights[k] / nevh_c(k) * wave;
        nevh_dh_dq(k) = part * nevh_p(k);
        nevh_dh_dp(k) = part * nevh_q(k);
    }
})

typedef struct {
    const char *name;
    nevh_block_gradient_fn gradient;
    nevh_point_gradient_fn point;
    size_t nq, np;
    double from, to;
} function;

#define X(f, x0, x1)                                                           \
    {.name = #f,                                                               \
     .gradient = of_##f##_gradient,                                            \
     .point = of_##f##_point_gradient,                                         \
     .nq = 1,                                                                  \
     .np = 0,                                                                  \
     .from = x0,                                                               \
     .to = x1},
#define XY(f, x0, x1)                                                          \
    {.name = #f,                                                               \
     .gradient = of_##f##_gradient,                                            \
     .point = of_##f##_point_gradient,                                         \
     .nq = 1,                                                                  \
     .np = 1,                                                                  \
     .from = x0,                                                               \
     .to = x1},
static const function functions[] = {
    /* clang-format off */
    X(sin, -20, 20) X(cos, -20, 20) X(tan, -20, 20) X(asin, -1.1, 1.1)
    X(acos, -1.1, 1.1) X(atan, -9, 9) X(sinh, -9, 9) X(cosh, -9, 9)
    X(tanh, -9, 9) X(exp, -20, 20) X(log, -1, 9) X(sqrt, -1, 9) X(cbrt, -9, 9)
    X(abs, -2, 2) XY(atan2, -5, 5) XY(hypot, -5, 5) XY(pow, -1, 4)
    XY(min, -2, 2) XY(max, -2, 2) XY(atan2_right, -2, 2) XY(atan2_left, -2, 2)
    XY(power_minus_6, -4, 4) XY(power_minus_2, -4, 4) XY(power_4, -4, 4)
    XY(root, -1, 4) XY(exponential, -4, 4) XY(quotient, -2, 2)
    XY(params, -2, 2) XY(cancelling, -2, 2) XY(either, -2, 2) XY(nested, -9, 9)
    /* clang-format on */
    {"everything", everything_gradient, everything_point_gradient, MOST, MOST,
     -2, 2},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

static parameters mine = {.weights = {0.7, -1.3, 2.1}};

static void equal(const function *f, char kind, size_t k, double point,
                  double block) {
    ck_assert_msg(same(point, block), "%s: d%c[%zu] is %a, in a block %a",
                  f->name, kind, k, point, block);
}

/* Eight states at once, and one by one, where a half may not be wanted; numbers
   that are not written stay NAN. */
static void compare(const function *f, const double x[], bool of_q, bool of_p) {
    enum { SIZE = MOST * LANES };
    const double *q = x, *p = q + SIZE, *c = p + SIZE, *t = c + SIZE;
    double dq[SIZE], dp[SIZE];
    f->gradient(LANES, t, q, p, c, &mine, of_q ? dq : NULL, of_p ? dp : NULL);
    for (size_t i = 0; i < LANES; i++) {
        double one[3][MOST], one_q[MOST] = {NAN}, one_p[MOST] = {NAN};
        for (size_t k = 0; k < MOST; k++) {
            one[0][k] = q[k * LANES + i];
            one[1][k] = p[k * LANES + i];
            one[2][k] = c[k * LANES + i];
        }
        f->point(t[i], one[0], one[1], one[2], &mine, of_q ? one_q : NULL,
                 of_p ? one_p : NULL);
        for (size_t k = 0; of_q && k < f->nq; k++)
            equal(f, 'q', k, one_q[k], dq[k * LANES + i]);
        for (size_t k = 0; of_p && k < f->np; k++)
            equal(f, 'p', k, one_p[k], dp[k * LANES + i]);
        if ((!of_q && !isnan(one_q[0])) || (!of_p && !isnan(one_p[0])))
            ck_abort_msg("%s writes what is not wanted", f->name);
    }
}

TEST_EACH(point_is_block, FUNCTIONS) {
    const function *f = &functions[_i];
    for (int state = 0; state < STATES; state += LANES) {
        double x[(3 * MOST + 1) * LANES];
        for (size_t i = 0; i < sizeof x / sizeof *x; i++)
            x[i] = uniform(f->from, f->to);
        if (state == 0) {
            x[0] = x[MOST * LANES] = 0;
            x[1] = -0.;
            x[2] = INFINITY;
            x[3] = NAN;
        }
        mine.turns = state;
        compare(f, x, true, false);
        compare(f, x, true, true);
        compare(f, x, false, true);
    }
}

/* Point gradients of q0 sin(q1) + p0^2, of which only the first is right. */
NEVH_BODY(right, void,
          { return nevh_q(0) * nevh_sin(nevh_q(1)) + nevh_p(0) * nevh_p(0); })
NEVH_GRADIENT(right, void, {
    nevh_dh_dq(0) = nevh_sin(nevh_q(1));
    nevh_dh_dq(1) = nevh_q(0) * nevh_cos(nevh_q(1));
    nevh_dh_dp(0) = 2 * nevh_p(0);
})

#define POINT(name)                                                            \
    static void name(double t, const double q[], const double p[],             \
                     const double c[], const void *params, double dq[],        \
                     double dp[])

POINT(off_by_a_bit) {
    right_point_gradient(t, q, p, c, params, dq, dp);
    if (dq)
        dq[1] = nextafter(dq[1], 9);
}

POINT(off_alone) {
    right_point_gradient(t, q, p, c, params, dq, dp);
    if (dp && !dq)
        dp[0] = nextafter(dp[0], 9);
}

POINT(wrong_half) {
    double both[2];
    right_point_gradient(t, q, p, c, params, both, NULL);
    if (dp)
        dp[0] = both[0];
    if (dq)
        dq[0] = 2 * p[0];
}

/* In one state of 16. */
POINT(seldom_off) {
    uint64_t bits;
    right_point_gradient(t, q, p, c, params, dq, dp);
    memcpy(&bits, &q[1], sizeof bits);
    if (dq && (bits >> 20) % 16 == 5)
        dq[0] = nextafter(dq[0], 9);
}

POINT(late) {
    right_point_gradient(t, q, p, c, params, dq, dp);
    if (dp && t > 0)
        dp[0] = nextafter(dp[0], 9);
}

POINT(nothing) {
    (void)t, (void)q, (void)p, (void)c, (void)params, (void)dq, (void)dp;
}

/* Only that sine is libm's: in nearly all states it is the same. */
POINT(other_sine) {
    right_point_gradient(t, q, p, c, params, dq, dp);
    if (dq)
        dq[0] = sin(q[1]);
}

static const struct {
    nevh_point_gradient_fn point;
    const char *at; /* NULL: it is right */
} points[] = {{right_point_gradient, NULL}, {off_by_a_bit, "q[1] is "},
              {off_alone, "p[0] is "},      {wrong_half, "q[0] is "},
              {nothing, "q[0] is nan"},     {seldom_off, "q[0] is "},
              {late, "p[0] is "},           {other_sine, "q[0] is "}};
enum { POINTS = sizeof points / sizeof *points };

TEST_EACH(unlike_points_are_refused, POINTS) {
    nevh_system *s = nevh_system_new(2);
    const nevh_term term = {.effect = "mixed",
                            .name = "wrong",
                            .nq = 2,
                            .np = 1,
                            .time = true,
                            NEVH_FORMS(right),
                            .gradient = right_gradient,
                            .point_gradient = points[_i].point};
    ck_assert_int_eq(nevh_system_add(s, &term), NEVH_OK);
    const nevh_options options = {.gradient = nevh_exact,
                                  .q = (const double[]){0.5, 0.3},
                                  .p = (const double[]){0.7, 0}};
    nevh_field *f = nevh_field_new(s, &options);
    const char *message = nevh_field_message(f), *at = points[_i].at;
    ck_assert_int_eq(nevh_field_status(f), at ? NEVH_ENOGRAD : NEVH_OK);
    if (at) {
        ck_assert_ptr_nonnull(strstr(message,
                                     "point gradient of term \"wrong\" "
                                     "of effect \"mixed\""));
        ck_assert_msg(strstr(message, at) != NULL, "%s", message);
        ck_assert_ptr_nonnull(strstr(message, "that of a block is"));
    }
    nevh_field_free(f);
    /* Differences do not ask for it. */
    f = nevh_field_new(s, NULL);
    ck_assert_int_eq(nevh_field_status(f), NEVH_OK);
    nevh_field_free(f);
    nevh_system_free(s);
}

TEST(points_need_blocks) {
    nevh_system *s = nevh_system_new(2);
    nevh_term term = {.effect = "mixed",
                      .nq = 2,
                      .np = 1,
                      NEVH_FORMS(right),
                      .point_gradient = right_point_gradient};
    ck_assert_int_eq(nevh_system_add(s, &term), NEVH_EINVAL);
    ck_assert_str_eq(nevh_system_message(s), "effect mixed: a point gradient "
                                             "needs a gradient beside it, for "
                                             "blocks");
    nevh_system_free(s);
}
