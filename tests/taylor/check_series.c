/* nevh tests: Taylor coefficients of orbits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "formula.h"
#include "shipped.h"
#include "taylor/series_private.h"
#include <float.h>
#include <math.h>

enum { ORDER = 20, MOST = 2 * FORMULA_DOF };

typedef struct {
    nevh__names *names;
    formula_system s;
    nevh__recurrence *r;
    nevh__report report;
} planned_series;

static planned_series plan_of(const char *text, const double friction[]) {
    planned_series x = {.names = formula_names()};
    x.s = system_of(text, x.names, FORMULA_DOF);
    ck_assert_msg(!x.s.error.status, "%s: %s", text, x.s.error.text);
    x.r = nevh__recurrence_new(x.s.system, friction, false, &x.report);
    return x;
}

static void plan_done(planned_series *x) {
    nevh__recurrence_free(x->r);
    system_done(&x->s);
    nevh__names_free(x->names);
}

/* The state a time h after `state`, from one expansion. */
static void jump(const planned_series *x, double t, double h,
                 const double state[], double after[]) {
    double rows[(ORDER + 1) * MOST];
    nevh__series_double *s = nevh__series_new_double(x->r, ORDER);
    ck_assert(nevh__series_expand_double(s, t, state, rows));
    for (size_t i = 0; i < MOST; i++) {
        after[i] = rows[ORDER * MOST + i];
        for (size_t k = ORDER; k-- > 0;)
            after[i] = after[i] * h + rows[k * MOST + i];
    }
    nevh__series_free_double(s);
}

static double value_at(const planned_series *x, const double state[]) {
    double h = 0;
    for (size_t i = 0; i < x->s.system->n_terms; i++) {
        const nevh_term *is = &x->s.system->terms[i]->decl;
        double q[8], p[8];
        for (size_t k = 0; k < is->nq; k++)
            q[k] = state[is->q[k]];
        for (size_t k = 0; k < is->np; k++)
            p[k] = state[FORMULA_DOF + is->p[k]];
        h += is->value(0, q, p, is->c, is->params);
    }
    return h;
}

/* Of H = p_x + f(x), x = x0 + t, and p_x follows from H: all derivatives of f
   are in its series. */
static const struct {
    const char *f;
    double x;
} functions[] = {
    {"sin(x)", 0.7},
    {"cos(x)*x", 0.7},
    {"tan(x)", 0.4},
    {"asin(x)", 0.2},
    {"acos(x)", -0.3},
    {"atan(x)", 0.6},
    {"atan2(sin(x) + x, 1.5 + x*cos(x))", 0.3},
    {"atan2(x, -2 - x)", 0.4},
    {"sinh(x)", 0.7},
    {"cosh(x)", -0.7},
    {"tanh(x)", 0.3},
    {"asinh(x)", 0.8},
    {"acosh(x)", 2.7},
    {"atanh(x)", 0.2},
    {"exp(x)", 0.3},
    {"ln(x)", 1.7},
    {"log10(x)", 1.7},
    {"sqrt(x)", 1.9},
    {"cbrt(x)", -1.9},
    {"hypot(x, 1 + x)", 0.4},
    {"1/x", 2.2},
    {"x/(1 + x^2)", 0.4},
    {"x^7 - 2*x^12", 0.3},
    {"x^-3", 2.3},
    {"x^2.5", 1.7},
    {"x^-1.5", 2.1},
    {"x^0.3", 1.9},
    {"x^x", 1.8},
    {"2^x", 0.6},
    {"x*sqrt(x)/(x^2*sqrt(x))", 1.8},
    {"sin(cos(x^2)/(2 + exp(-x)))", 0.5},
    {"3", 0.5},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

TEST_EACH(function_has_its_series, FUNCTIONS) {
    char text[200];
    const double h = 0.1;
    snprintf(text, sizeof text, "p_x + %s", functions[_i].f);
    planned_series x = plan_of(text, NULL);
    ck_assert_msg(x.r != NULL, "%s: %s", text, x.report.text);
    double state[MOST] = {functions[_i].x}, after[MOST];
    double before = value_at(&x, state);
    jump(&x, 0, h, state, after);
    ck_assert_double_eq_tol(after[0], state[0] + h, DBL_EPSILON * 4);
    double change = value_at(&x, after) - before;
    ck_assert_msg(fabs(change) < 40 * DBL_EPSILON * (1 + fabs(before)),
                  "%s: H changes by %g", text, change);
    ck_assert(strstr(text, "+ 3") || fabs(after[FORMULA_DOF]) > 1e-3);
    plan_done(&x);
}

#ifdef NEVH_QUADMATH
static void jump_quad(const planned_series *x, nevh__wide h,
                      const nevh__wide state[], nevh__wide after[]) {
    enum { HIGH = 50 };
    nevh__wide rows[(HIGH + 1) * MOST];
    nevh__series_quad *s = nevh__series_new_quad(x->r, HIGH);
    ck_assert(nevh__series_expand_quad(s, 0, state, rows));
    for (size_t i = 0; i < MOST; i++) {
        after[i] = rows[HIGH * MOST + i];
        for (size_t k = HIGH; k-- > 0;)
            after[i] = after[i] * h + rows[k * MOST + i];
    }
    nevh__series_free_quad(s);
}

/* One jump is two of half its length, and what doubles say. */
TEST_EACH(quad_series_hold_thirty_digits, FUNCTIONS) {
    char text[200];
    const nevh__wide h = (nevh__wide)0x1p-5;
    snprintf(text, sizeof text, "p_x + %s", functions[_i].f);
    planned_series x = plan_of(text, NULL);
    nevh__wide state[MOST] = {functions[_i].x}, whole[MOST], half[MOST];
    double start[MOST] = {functions[_i].x}, near[MOST];
    jump_quad(&x, h, state, whole);
    jump_quad(&x, h / 2, state, half);
    jump_quad(&x, h / 2, half, half);
    double apart = (double)(whole[FORMULA_DOF] - half[FORMULA_DOF]);
    ck_assert_msg(fabs(apart) < 1e-30, "%s: %g", text, apart);
    jump(&x, 0, (double)h, start, near);
    ck_assert_double_eq_tol((double)whole[FORMULA_DOF], near[FORMULA_DOF],
                            4e-14);
    plan_done(&x);
}

/* Pairs of doubles have the coefficients of quad precision, in any unit of
   time. */
TEST_EACH(pair_series_are_quad_series, FUNCTIONS) {
    enum { HIGH = 30, SIZE = (HIGH + 1) * MOST };
    char text[200];
    snprintf(text, sizeof text, "p_x + %s", functions[_i].f);
    planned_series x = plan_of(text, NULL);
    nevh__wide state[MOST] = {functions[_i].x}, wide[SIZE];
    nevh__dd pairs[SIZE], scaled[SIZE];
    nevh__series_quad *quad = nevh__series_new_quad(x.r, HIGH);
    nevh__series_dd *pair = nevh__series_new_dd(x.r, HIGH);
    ck_assert(nevh__series_expand_quad(quad, 0, state, wide));
    ck_assert(nevh__series_expand_dd(pair, 0, state, pairs));
    nevh__series_in_dd(pair, 0x1p-10);
    ck_assert(nevh__series_expand_dd(pair, 0, state, scaled));
    double most = 1;
    for (int i = 0; i < SIZE; i++) {
        int k = i / MOST;
        double by = (double)(pairs[i].high - wide[i] + pairs[i].low);
        most = fmax(most, fabs((double)wide[i]));
        ck_assert_msg(fabs(by) < 1e-29 * most, "%s, order %d: %g of %g", text,
                      k, by, most);
        ck_assert_double_eq(scaled[i].high, ldexp(pairs[i].high, -10 * k));
        ck_assert_double_eq(scaled[i].low, ldexp(pairs[i].low, -10 * k));
    }
    nevh__series_free_quad(quad);
    nevh__series_free_dd(pair);
    plan_done(&x);
}
#endif

TEST(time_and_friction_have_their_series) {
    planned_series x = plan_of("p_x*cos(t) + p_y*t^2", NULL);
    double state[MOST] = {0.2, 0.3, .0}, after[MOST];
    state[FORMULA_DOF] = 1.25;
    jump(&x, 0.5, 0.3, state, after);
    ck_assert_double_eq_tol(after[0], 0.2 + sin(0.8) - sin(0.5), 1e-15);
    ck_assert_double_eq_tol(after[1], 0.3 + (0.512 - 0.125) / 3, 1e-15);
    ck_assert_double_eq(after[FORMULA_DOF], 1.25);
    plan_done(&x);
    const double rates[FORMULA_DOF] = {0.4};
    x = plan_of("p_x^2/2", rates);
    jump(&x, 0, 0.7, state, after);
    ck_assert_double_eq_tol(after[FORMULA_DOF], 1.25 * exp(-0.28), 1e-15);
    ck_assert_double_eq_tol(after[0], 0.2 + 1.25 * (1 - exp(-0.28)) / 0.4,
                            1e-15);
    plan_done(&x);
}

/* Terms with instances, some of them more than a batch's summands. */
TEST(a_chain_keeps_its_energy) {
    planned_series x = plan_of(
        "sum(i = 1..4, p_q[i]^2/(2*w[i])) - sum(i = 1..3, j = i+1..4, "
        "w[i]*w[j]/sqrt(1 + (q[i] - q[j])^2)) + (q[1] + q[2] + q[3] + q[4] + x "
        "+ y)^2/9 + p_x^2/2 + p_y^2/2 + cos(all - x)",
        NULL);
    double state[MOST] = {0.1, -0.2, 0.4, 1.1, -0.7, 0.3, 0.5, 0.2, -0.6, 1, 2},
           after[MOST], back[MOST];
    ck_assert_msg(x.r != NULL, "%s", x.report.text);
    jump(&x, 0, 0.05, state, after);
    jump(&x, 0, -0.05, after, back);
    for (size_t i = 0; i < MOST; i++) {
        ck_assert_double_eq_tol(back[i], state[i], 1e-14);
        ck_assert(fabs(after[i] - state[i]) > 1e-4);
    }
    plan_done(&x);
}

/* As kinks of coordinates are. */
TEST(kinks_of_time_are_edges) {
    static const char *const formulas[] = {"x*abs(t - 1)", "x*max(1, t)",
                                           "sign(t)*x", "x*mod(t, 2)",
                                           "floor(t)*x"};
    for (size_t i = 0; i < sizeof formulas / sizeof *formulas; i++) {
        planned_series x = plan_of(formulas[i], NULL);
        ck_assert_msg(x.r != NULL, "%s", x.report.text);
        ck_assert(nevh__domain_kink(x.r) != SIZE_MAX);
        plan_done(&x);
    }
}

TEST(what_has_no_series_is_refused) {
    static const char *const formulas[][2] = {
        {"x*bessel_j0(t)", "bessel_j0"},
        {"bessel_j0(x)", "bessel_j0"},
        {"elliptic_k(x)", "elliptic_k"},
        {"kepler(x, 0.5)", "kepler"},
    };
    for (size_t i = 0; i < sizeof formulas / sizeof *formulas; i++) {
        planned_series x = plan_of(formulas[i][0], NULL);
        ck_assert_msg(x.r == NULL, "%s", formulas[i][0]);
        ck_assert_int_eq(x.report.status, NEVH_ESTRUCT);
        assert_says(x.report.text, formulas[i][1]);
        assert_says(x.report.text, "\"H\"");
        plan_done(&x);
    }
    /* Of a number, and with edges that orbits see. */
    static const char *const known[] = {"x*abs(m)",  "abs(x)",    "min(x, p_x)",
                                        "max(1, x)", "sign(x)*x", "mod(x, 2)",
                                        "floor(x)*x"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        planned_series x = plan_of(known[i], NULL);
        ck_assert_msg(x.r != NULL, "%s", x.report.text);
        plan_done(&x);
    }
    nevh__report report = {0};
    nevh_system *s = double_pendulum.make();
    ck_assert_ptr_null(nevh__recurrence_new(s, NULL, false, &report));
    assert_says(report.text, "in C");
    nevh_system_free(s);
}

TEST(singular_points_are_told) {
    planned_series x = plan_of("1/x + sqrt(y)*p_x", NULL);
    double state[MOST] = {0, 1}, rows[(ORDER + 1) * MOST];
    nevh__series_double *s = nevh__series_new_double(x.r, ORDER);
    ck_assert(!nevh__series_expand_double(s, 0, state, rows));
    state[0] = 1;
    ck_assert(nevh__series_expand_double(s, 0, state, rows));
    state[1] = 0;
    state[FORMULA_DOF] = 1;
    ck_assert(!nevh__series_expand_double(s, 0, state, rows));
    nevh__series_free_double(s);
    plan_done(&x);
}

/* The coefficients of order 1 are the gradient's, in another order of sums. */
TEST_EACH(first_coefficients_are_the_gradient, find_shipped()) {
    nevh_scene *scene = read_shipped(shipped[_i]);
    size_t n = nevh_scene_dof(scene);
    const nevh_system *system = nevh_scene_system(scene);
    double *state = calloc(8 * n, sizeof *state), *rows = state + 2 * n;
    double *slope = rows + 4 * n, rate;
    ck_assert_int_eq(nevh_scene_start(scene, state, state + n), NEVH_OK);
    for (size_t k = 0; k < 2 * n; k++)
        state[k] += 1e-3 * (double)(k % 7);
    nevh__report report = {0};
    nevh__recurrence *r = nevh__recurrence_new(system, NULL, false, &report);
    ck_assert_msg(r != NULL, "%s: %s", shipped[_i], report.text);
    nevh__series_double *s = nevh__series_new_double(r, 1);
    ck_assert(nevh__series_expand_double(s, 0.3, state, rows));
    nevh_field *field =
        nevh_field_new(system, &(nevh_options){.gradient = nevh_exact});
    double t = 0.3;
    ck_assert_int_eq(
        nevh_field_gradient(field, 1, &t, state, state + n, slope + n, slope),
        NEVH_OK);
    for (size_t k = 0; k < 2 * n; k++) {
        rate = k < n ? slope[k] : -slope[k];
        ck_assert_msg(fabs(rows[2 * n + k] - rate) < 1e-13 * (1 + fabs(rate)),
                      "%s, %zu: %.17g, not %.17g", shipped[_i], k,
                      rows[2 * n + k], rate);
    }
    nevh_field_free(field);
    nevh__series_free_double(s);
    nevh__recurrence_free(r);
    nevh_scene_free(scene);
    free(state);
}
