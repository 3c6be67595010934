/* nevh tests: three forms of a term from one body.
   SPDX-License-Identifier: GPL-3.0-or-later

   Each function that a body may call is a body here, of x = q[0] and y = p[0],
   together with its derivatives in long double. */
#include "support.h"
#include <nevh/body.h>
#include <float.h>
#include <math.h>
#include <string.h>

#define TINY 1e-100

#define OF_X(f, slope)                                                         \
    NEVH_BODY(of_##f, void, { return nevh_##f(nevh_q(0)); })                   \
    static long double f##_dx(long double x, long double y) {                  \
        (void)y;                                                               \
        return slope;                                                          \
    }
#define OF_XY(name, expression, slope_x, slope_y)                              \
    NEVH_BODY(of_##name, void, {                                               \
        nevh_num x = nevh_q(0), y = nevh_p(0);                                 \
        (void)y;                                                               \
        return expression;                                                     \
    })                                                                         \
    static long double name##_dx(long double x, long double y) {               \
        (void)x, (void)y;                                                      \
        return slope_x;                                                        \
    }                                                                          \
    static long double name##_dy(long double x, long double y) {               \
        (void)x, (void)y;                                                      \
        return slope_y;                                                        \
    }

OF_X(sin, cosl(x))
OF_X(cos, -sinl(x))
OF_X(tan, 1 / (cosl(x) * cosl(x)))
OF_X(asin, 1 / sqrtl((1 - x) * (1 + x)))
OF_X(acos, -1 / sqrtl((1 - x) * (1 + x)))
OF_X(atan, 1 / (1 + x * x))
OF_X(sinh, coshl(x))
OF_X(cosh, sinhl(x))
OF_X(tanh, 1 / (coshl(x) * coshl(x)))
OF_X(exp, expl(x))
OF_X(log, 1 / x)
OF_X(sqrt, 0.5L / sqrtl(x))
OF_X(cbrt, 1 / (3 * cbrtl(x) * cbrtl(x)))
OF_X(abs, x < 0 ? -1 : 1)
OF_XY(atan2, nevh_atan2(x, y), y / (x * x + y * y), -x / (x * x + y * y))
OF_XY(hypot, nevh_hypot(x, y), x / hypotl(x, y), y / hypotl(x, y))
OF_XY(pow, nevh_pow(x, y), y *powl(x, y - 1), powl(x, y) * logl(x))
OF_XY(min, nevh_min(x, y), x < y, !(x < y))
OF_XY(max, nevh_max(x, y), x > y, !(x > y))
/* One argument constant, or a whole power. */
OF_XY(atan2_right, nevh_atan2(x, 0.7), 0.7 / (x * x + 0.7 * 0.7), 0)
OF_XY(atan2_left, nevh_atan2(-0.7, x), 0.7 / (x * x + 0.7 * 0.7), 0)
OF_XY(hypot_3, nevh_hypot(x, 3), x / hypotl(x, 3), 0)
OF_XY(min_1, nevh_min(x, 1), x < 1, 0)
OF_XY(max_1, nevh_max(1, x), x > 1, 0)
OF_XY(power_minus_6, nevh_pow(x, -6), -6 * powl(x, -7), 0)
OF_XY(power_minus_2, nevh_pow(x, -2), -2 * powl(x, -3), 0)
OF_XY(power_minus_1, nevh_pow(x, -1), -1 / (x * x), 0)
OF_XY(power_1, nevh_pow(x, 1), 1, 0)
OF_XY(power_2, nevh_pow(x, 2), 2 * x, 0)
OF_XY(power_3, nevh_pow(x, 3), 3 * (x * x), 0)
OF_XY(power_4, nevh_pow(x, 4.0), 4 * (x * x * x), 0)
OF_XY(root, nevh_pow(x, 0.5), 0.5 / sqrtl(x), 0)
OF_XY(exponential, nevh_pow(2.5, x), logl(2.5L) * powl(2.5L, x), 0)
/* Arithmetic. */
OF_XY(product, x *y * 3, 3 * y, 3 * x)
OF_XY(quotient, x / y, 1 / y, -x / (y * y))
OF_XY(reciprocal, 2 / (x - 3 * y), -2 / ((x - 3 * y) * (x - 3 * y)),
      6 / ((x - 3 * y) * (x - 3 * y)))
OF_XY(either, nevh_real(x) > nevh_real(y) ? x * x : y, x > y ? 2 * x : 0,
      x > y ? 0 : 1)

typedef long double (*slope_fn)(long double x, long double y);

typedef struct {
    const char *name;
    nevh_term decl;
    double from[2], to[2]; /* of x and y */
    slope_fn dx, dy;
} function;

#define X(f, x0, x1)          FUNCTION(f, x0, x1, 0, 1, NULL)
#define XY(f, x0, x1, y0, y1) FUNCTION(f, x0, x1, y0, y1, f##_dy)
#define FUNCTION(f, x0, x1, y0, y1, slope_y)                                   \
    {                                                                          \
        .name = #f, .decl = {NEVH_FORMS(of_##f)}, .from = {x0, y0},            \
        .to = {x1, y1}, .dx = f##_dx, .dy = slope_y                            \
    }

static const function functions[] = {
    X(sin, -20, 20),
    X(cos, -20, 20),
    X(tan, -20, 20),
    X(asin, -1, 1),
    X(acos, -1, 1),
    X(atan, -9, 9),
    X(sinh, -9, 9),
    X(cosh, -9, 9),
    X(tanh, -9, 9),
    X(exp, -20, 20),
    X(log, 0, 9),
    X(sqrt, 0, 9),
    X(cbrt, -9, 9),
    X(abs, -2, 2),
    XY(atan2, -5, 5, -5, 5),
    XY(hypot, -5, 5, -5, 5),
    XY(pow, 0, 4, -4, 4),
    XY(min, -2, 2, -2, 2),
    XY(max, -2, 2, -2, 2),
    XY(atan2_right, -2, 2, 0, 1),
    XY(atan2_left, -2, 2, 0, 1),
    XY(hypot_3, -9, 9, 0, 1),
    XY(min_1, 0, 2, 0, 1),
    XY(max_1, 0, 2, 0, 1),
    XY(power_minus_6, -4, 4, 0, 1),
    XY(power_minus_2, -4, 4, 0, 1),
    XY(power_minus_1, -4, 4, 0, 1),
    XY(power_1, -4, 4, 0, 1),
    XY(power_2, -4, 4, 0, 1),
    XY(power_3, -4, 4, 0, 1),
    XY(power_4, -4, 4, 0, 1),
    XY(root, 0, 4, 0, 1),
    XY(exponential, -4, 4, 0, 1),
    XY(product, -2, 2, -2, 2),
    XY(quotient, -2, 2, -2, 2),
    XY(reciprocal, -2, 2, -2, 2),
    XY(either, -2, 2, -2, 2),
};
enum { FUNCTIONS = sizeof functions / sizeof *functions, WIDTH = 64 };

/* In [from, to). */
static double uniform(double from, double to) {
    static unsigned long long seed = 20240229;
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    return from + (to - from) * ((double)(seed >> 11) / 9007199254740992.0);
}

static void draw(const function *f, size_t count, double x[], double y[]) {
    for (size_t i = 0; i < count; i++) {
        x[i] = uniform(f->from[0], f->to[0]);
        y[i] = uniform(f->from[1], f->to[1]);
    }
}

static double value_at(const function *f, double x, double y) {
    return f->decl.value(0, &x, &y, NULL, NULL);
}

static const double no_time[WIDTH];

static void block_at(const function *f, size_t width, const double x[],
                     const double y[], double h[]) {
    f->decl.block(width, no_time, x, y, NULL, NULL, h);
}

/* The value; *slope is the derivative in the direction (dx, dy). */
static double complex_at(const function *f, double x, double dx, double y,
                         double dy, double *slope) {
    const double q[1][2] = {{x, dx * TINY}}, p[1][2] = {{y, dy * TINY}};
    double h[2];
    f->decl.complex_value(0, q, p, NULL, NULL, h);
    *slope = h[1] / TINY;
    return h[0];
}

/* To the last bit. */
TEST_EACH(block_is_value, FUNCTIONS) {
    const function *f = &functions[_i];
    double x[WIDTH], y[WIDTH], h[WIDTH];
    for (int repeat = 0; repeat < 50; repeat++) {
        draw(f, WIDTH, x, y);
        block_at(f, WIDTH, x, y, h);
        for (int i = 0; i < WIDTH; i++) {
            double value = value_at(f, x[i], y[i]);
            ck_assert_msg(h[i] == value,
                          "%s(%.17g, %.17g) = %.17g, in a block %.17g", f->name,
                          x[i], y[i], value, h[i]);
        }
    }
}

/* Alone among numbers that take every other path, to the last bit. */
TEST_EACH(lanes_are_independent, FUNCTIONS) {
    static const double awkward[] = {0,     -0., INFINITY, NAN,
                                     1e300, -7., -1e22,    5e-324};
    const function *f = &functions[_i];
    double x[WIDTH], y[WIDTH], h[WIDTH], some_x[8], some_y[8], some_h[8];
    draw(f, WIDTH, x, y);
    block_at(f, WIDTH, x, y, h);
    for (int i = 0; i < 8 * WIDTH; i++) {
        int lane = i / WIDTH;
        for (int k = 0; k < 8; k++) {
            some_x[k] = awkward[(k + i) % 8];
            some_y[k] = awkward[(3 * k + i / 8) % 8];
        }
        some_x[lane] = x[i % WIDTH];
        some_y[lane] = y[i % WIDTH];
        block_at(f, 8, some_x, some_y, some_h);
        ck_assert_msg(memcmp(&some_h[lane], &h[i % WIDTH], sizeof *h) == 0,
                      "%s(%.17g, %.17g) depends on its neighbours", f->name,
                      some_x[lane], some_y[lane]);
    }
}

static void assert_slope(const function *f, slope_fn exact, double x, double dx,
                         double y, double dy) {
    double slope, value = complex_at(f, x, dx, y, dy, &slope);
    double right = (double)exact(x, y);
    ck_assert_msg(fabs(slope - right) <= 1e-14 * fabs(right),
                  "%s(%.17g, %.17g) has the slope %.17g, not %.17g", f->name, x,
                  y, right, slope);
    ck_assert_double_eq_tol(value, value_at(f, x, y),
                            2 * DBL_EPSILON * fabs(value));
}

TEST_EACH(complex_has_the_slope, FUNCTIONS) {
    const function *f = &functions[_i];
    for (int i = 0; i < 1000; i++) {
        double x, y;
        draw(f, 1, &x, &y);
        assert_slope(f, f->dx, x, 1, y, 0);
        if (f->dy)
            assert_slope(f, f->dy, x, 0, y, 1);
    }
}

/* Where functions end, turn, or have no derivative.  The slope is in the
   direction (dx, dy). */
static const struct {
    const char *function;
    double x, dx, y, dy, value, slope;
} points[] = {
    {"sqrt", 0, 0, 0, 0, 0, 0},
    {"sqrt", 0, 1, 0, 0, 0, INFINITY},
    {"sqrt", 1e-300, 1, 0, 0, 1e-150, 5e149},
    {"sqrt", -1, 1, 0, 0, NAN, NAN},
    {"cbrt", 0, 0, 0, 0, 0, 0},
    {"cbrt", 0, 1, 0, 0, 0, INFINITY},
    {"cbrt", -8, 1, 0, 0, -2, 1. / 12},
    {"log", 0, 0, 0, 0, -INFINITY, 0},
    {"log", -1, 1, 0, 0, NAN, -1},
    {"exp", -INFINITY, 1, 0, 0, 0, 0},
    {"asin", 1 - 0x1p-30, 1, 0, 0, 1.5707531684220182, 23170.475011315586},
    {"acos", 1 - 0x1p-30, 1, 0, 0, 4.315837287850502e-05, -23170.475011315586},
    {"asin", 1, 0, 0, 0, 1.5707963267948966, 0},
    {"asin", 1, 1, 0, 0, 1.5707963267948966, INFINITY},
    {"acos", 1, 1, 0, 0, 0, -INFINITY},
    {"tanh", 30, 1, 0, 0, 1, 3.5026043050786084e-26},
    {"tanh", -400, 1, 0, 0, -1, 0},
    {"abs", 0, 1, 0, 0, 0, 1},
    {"abs", -3, 1, 0, 0, 3, -1},
    {"abs", -3, -2, 0, 0, 3, 2},
    {"atan2", 1, 1, 1, 0, 0.7853981633974483, 0.5},
    {"atan2", 1, 1, -1, 0, 2.356194490192345, -0.5},
    {"atan2", -1, 1, -1, 0, -2.356194490192345, -0.5},
    {"atan2", -1, 1, 1, 0, -0.7853981633974483, 0.5},
    {"atan2", 1, 0, 1, 1, 0.7853981633974483, -0.5},
    {"atan2", 1, 0, -1, 1, 2.356194490192345, -0.5},
    {"atan2", -1, 0, -1, 1, -2.356194490192345, 0.5},
    {"atan2", 0, 1, -2, 0, 3.141592653589793, -0.5},
    {"atan2", 2, 0, 0, 1, 1.5707963267948966, -0.5},
    {"atan2", 0, 0, 0, 0, 0, 0},
    {"atan2", 1e-200, 1, 1e-200, 0, 0.7853981633974483, 5e199},
    {"hypot", 0, 0, 0, 0, 0, 0},
    {"hypot", 3, 1, 4, 1, 5, 1.4},
    {"hypot", 3e200, 1, -4e200, 0, 5e200, 0.6},
    {"pow", 0, 1, 0, 0, 1, 0},
    {"pow", 0, 1, 1, 0, 0, 1},
    {"pow", 0, 1, 2, 0, 0, 0},
    {"pow", 0, 0, 2, 1, 0, 0},
    {"pow", 0, 1, 0.5, 0, 0, INFINITY},
    {"pow", -2, 1, 3, 0, -8, 12},
    {"pow", -2, 1, -3, 0, -0.125, -0.1875},
    {"pow", -2, 1, 0.5, 0, NAN, NAN},
    {"pow", 4, 1, -1.5, 0, 0.125, -0.046875},
    {"pow", 1e-200, 1, 2, 0, 0, 2e-200},
    {"power_2", -3, 1, 0, 0, 9, -6},
    {"power_2", 0, 1, 0, 0, 0, 0},
    {"power_3", -3, 1, 0, 0, -27, 27},
    {"power_4", -3, 1, 0, 0, 81, -108},
    {"power_minus_1", -4, 1, 0, 0, -0.25, -0.0625},
    {"power_minus_2", -2, 1, 0, 0, 0.25, 0.25},
    {"power_minus_6", -1, 1, 0, 0, 1, 6},
    {"min", 1, 1, 2, 0, 1, 1},
    {"min", 1, 0, 2, 1, 1, 0},
    {"min", NAN, 0, 2, 0, NAN, 0},
    {"min", 2, 0, NAN, 0, NAN, 0},
    {"max", 1, 1, 2, 0, 2, 0},
    {"max", 1, 0, 2, 1, 2, 1},
    {"max", NAN, 0, 2, 0, NAN, 0},
    {"max", 2, 0, NAN, 0, NAN, 0},
    {"quotient", 1e200, 1, 1e200, 0, 1, 1e-200},
    {"quotient", 1e-70, 0, 1e-70, 1, 1, -1e70},
    {"either", 2, 1, 1, 0, 4, 4},
    {"either", 1, 0, 2, 1, 2, 1},
};
enum { POINTS = sizeof points / sizeof *points };

static const function *named(const char *name) {
    size_t i = 0;
    while (strcmp(functions[i].name, name) != 0)
        ck_assert_uint_lt(++i, FUNCTIONS);
    return &functions[i];
}

static bool agree(double a, double b) {
    if (isnan(b) || isinf(b))
        return isnan(b) ? isnan(a) : a == b;
    return fabs(a - b) <= 4 * DBL_EPSILON * fabs(b);
}

TEST_EACH(special_points, POINTS) {
    const function *f = named(points[_i].function);
    double x = points[_i].x, y = points[_i].y, value = points[_i].value;
    double many_x[8], many_y[8], h[8], slope;
    for (int i = 0; i < 8; i++) {
        many_x[i] = x;
        many_y[i] = y;
    }
    block_at(f, 8, many_x, many_y, h);
    double real = complex_at(f, x, points[_i].dx, y, points[_i].dy, &slope);
    ck_assert_msg(agree(value_at(f, x, y), value) && agree(h[0], value) &&
                      agree(real, value) && agree(slope, points[_i].slope),
                  "%s(%g, %g) = %g, block %g, complex %g slope %g", f->name, x,
                  y, value_at(f, x, y), h[0], real, slope);
}

/* All that a body can read, a loop, and a whole term in a system. */
typedef struct {
    double weights[3], limit;
} parameters;

NEVH_BODY(everything, parameters, {
    nevh_num sum = 0, gap = nevh_q(0) - nevh_q(2);
    NEVH_UNROLL for (int k = 0; k < 3; k++) {
        sum += params->weights[k] * nevh_q(k) * nevh_p(k) / nevh_c(k);
    }
    nevh_num bound = nevh_max(gap, params->limit) * nevh_cos(2 * nevh_t);
    return nevh_exp(-sum * sum) + bound * nevh_sin(nevh_t);
})

static double plain(double t, const double q[], const double p[],
                    const double c[], const parameters *a) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += a->weights[k] * q[k] * p[k] / c[k];
    double bound = fmax(q[0] - q[2], a->limit) * cos(2 * t);
    return exp(-sum * sum) + bound * sin(t);
}

static const parameters mine = {{0.7, -1.3, 2.1}, 0.2};
static const double constants[] = {1.1, 2.3, 0.9};

TEST(forms_of_everything) {
    double t[8], q[24], p[24], c[24], h[8];
    for (int i = 0; i < 24; i++) {
        t[i % 8] = uniform(0, 9);
        q[i] = uniform(-1, 1);
        p[i] = uniform(-1, 1);
        c[i] = uniform(0.9, 2.3);
    }
    everything_block(8, t, q, p, c, &mine, h);
    for (int i = 0; i < 8; i++) {
        double one_q[] = {q[i], q[8 + i], q[16 + i]};
        double one_p[] = {p[i], p[8 + i], p[16 + i]};
        double one_c[] = {c[i], c[8 + i], c[16 + i]};
        double right = plain(t[i], one_q, one_p, one_c, &mine);
        double value = everything_value(t[i], one_q, one_p, one_c, &mine);
        ck_assert_double_eq_tol(h[i], right, 2e-15);
        ck_assert_double_eq_tol(value, right, 2e-15);
    }
}

/* A product that cancels would show whether it was joined with a sum. */
NEVH_BODY(arithmetic, void, {
    nevh_num area = nevh_q(0) * nevh_p(1) - nevh_q(1) * nevh_p(0);
    nevh_num size = nevh_sqrt(nevh_max(nevh_abs(area), 0.01));
    return nevh_min(area, nevh_pow(nevh_q(0), 2) - 0.1) / size;
})

TEST(arithmetic_is_the_same_to_the_bit) {
    double q[2 * WIDTH], p[2 * WIDTH], h[WIDTH];
    for (int i = 0; i < 2 * WIDTH; i++) {
        q[i] = uniform(-1, 1);
        p[i] = uniform(-1, 1);
    }
    arithmetic_block(WIDTH, no_time, q, p, NULL, NULL, h);
    for (int i = 0; i < WIDTH; i++) {
        double value =
            arithmetic_value(0, (double[]){q[i], q[WIDTH + i]},
                             (double[]){p[i], p[WIDTH + i]}, NULL, NULL);
        ck_assert_msg(memcmp(&value, &h[i], sizeof value) == 0,
                      "lane %d is %.17g, alone %.17g", i, h[i], value);
    }
}

static double largest_difference(const double a[], const double b[], int n) {
    double most = 0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

TEST(everything_in_a_system) {
    nevh_term term = {.effect = "all",
                      .nq = 3,
                      .np = 3,
                      .nc = 3,
                      .c = constants,
                      .time = true,
                      .params = &mine,
                      NEVH_FORMS(everything)};
    nevh_system *sys = nevh_system_new(3);
    ck_assert_int_eq(nevh_system_add(sys, &term), NEVH_OK);
    const nevh_gradient *const by[] = {nevh_complex_step, nevh_central8};
    double t = 0.4, q[] = {0.3, -0.5, 0.7}, p[] = {0.2, 0.9, -0.4}, g[2][6];
    for (int i = 0; i < 2; i++) {
        nevh_options options = {.gradient = by[i], .gradient_step = 1. / 128};
        nevh_field *field = nevh_field_new(sys, &options);
        ck_assert_int_eq(
            nevh_field_gradient(field, 1, &t, q, p, g[i], g[i] + 3), NEVH_OK);
        nevh_field_free(field);
    }
    ck_assert_double_lt(largest_difference(g[0], g[1], 6), 1e-11);
    nevh_system_free(sys);
}

/* Gradients of one effect of a model by complex step and by formula. */
static void compare_gradients(nevh_system *sys, const nevh_model *model) {
    const nevh_gradient *const by[] = {nevh_exact, nevh_complex_step};
    enum { SIZE = MOST_DOF * 32 };
    static const double zeros[2 * SIZE];
    double t[32] = {0}, q[SIZE], p[SIZE], g[2][2 * SIZE] = {{0}};
    for (size_t i = 0; i < model->n * 32; i++) {
        q[i] = model->q[i / 32] + uniform(-0.9, 0.9);
        p[i] = model->p[i / 32] + uniform(-5, 5);
    }
    for (int i = 0; i < 2; i++) {
        nevh_options options = {.gradient = by[i]};
        nevh_field *field = nevh_field_new(sys, &options);
        ck_assert_int_eq(
            nevh_field_gradient(field, 32, t, q, p, g[i], g[i] + SIZE),
            NEVH_OK);
        nevh_field_free(field);
    }
    double size = largest_difference(g[0], zeros, 2 * SIZE);
    ck_assert_double_gt(size, 0);
    ck_assert_double_le(largest_difference(g[0], g[1], 2 * SIZE), 1e-14 * size);
}

TEST_EACH(complex_step_of_models, model_count()) {
    const nevh_model *model = nevh_models()[_i];
    nevh_system *sys = model->system(model->defaults);
    size_t effects = nevh_system_effect_count(sys);
    for (size_t on = 0; on < effects; on++) {
        for (size_t i = 0; i < effects; i++)
            nevh_system_enable(sys, nevh_system_effect_name(sys, i), i == on);
        compare_gradients(sys, model);
    }
    nevh_system_free(sys);
}
