/* nevh tests: each entry of operations_private.h against itself: formulas of
   derivatives, the same by other operations, derivatives along a displacement,
   numbers of more digits and series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "expression/tape_inside_private.h"
#include "expression/wide_private.h"
#include <math.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <string.h>

static const struct {
    double a, b;
} places[] = {{0.37, 0.61}, {0.83, 0.24}, {1.7, 0.45}, {-0.52, 0.7}};
enum { PLACES = sizeof places / sizeof *places };

/* Formulas on numbers: nodes are places in an array. */
typedef struct {
    double value[64];
    int used;
} sheet;

static int put(sheet *s, double x) {
    s->value[s->used] = x;
    return s->used++;
}

static int put_number(void *data, double x) {
    return put(data, x);
}

static int put_operation(void *data, nevh__tape_operation f, int a, int b) {
    sheet *s = data;
    return put(s, nevh__operation_value(f, s->value[a], s->value[b]));
}

static double evaluate(const char *formula, double a, double b, double y) {
    sheet s = {.used = 0};
    const nevh__algebra numbers = {&s, put_number, put_operation};
    int of[3] = {put(&s, a), put(&s, b), put(&s, y)};
    return s.value[nevh__operation_build(formula, of, &numbers)];
}

/* What nevh__tape_along takes for granted of an entry. */
TEST_EACH(formulas_are_short_and_have_one_denominator, NEVH__OPERATION_COUNT) {
    const nevh__operation_traits *known = nevh__operation_of((unsigned)_i);
    nevh__derivative_text by[] = {known->by_a, known->by_b};
    const char *texts[] = {by[0].top,    by[0].bottom, by[1].top,
                           by[1].bottom, known->as,    known->edge};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        ck_assert(!texts[i] || strlen(texts[i]) < 64);
    ck_assert(!by[0].top || known->arity == 1 || by[1].top);
    ck_assert(!by[1].top || !by[0].bottom == !by[1].bottom);
    ck_assert(!by[1].bottom || strcmp(by[0].bottom, by[1].bottom) == 0);
    ck_assert(!by[1].top || strcmp(by[0].top, "0") != 0);
}

/* The node of a misspelt formula is none. */
TEST(formulas_of_unknown_words_fail) {
    sheet s = {.used = 0};
    const nevh__algebra numbers = {&s, put_number, put_operation};
    int of[3] = {put(&s, 1), put(&s, 2), put(&s, 3)};
    ck_assert_int_eq(nevh__operation_build("a sine", of, &numbers), -1);
    ck_assert_int_ge(nevh__operation_build("a sin", of, &numbers), 0);
}

static double derivative(nevh__derivative_text by, double a, double b,
                         double y) {
    double top = evaluate(by.top, a, b, y);
    return by.bottom ? top / evaluate(by.bottom, a, b, y) : top;
}

/* f(q, p), its gradient, and that of its derivative along (0.3, -0.7). */
static nevh__tape *tape_of(nevh__tape_operation f) {
    nevh__tape_builder *b = nevh__tape_builder_new();
    int q = nevh__tape_variable(b, NEVH__Q, 0);
    int p = nevh__tape_variable(b, NEVH__P, 0);
    return nevh__tape_finish(b, nevh__tape_apply(b, f, q, p), NULL);
}

/* Blocks have whole vectors. */
static void gradient_of(const nevh__tape *tape, const double q[2],
                        const double p[2], double dq[2], double dp[2]) {
    double t[NEVH__LANES] = {0}, x[2 * NEVH__LANES], z[2 * NEVH__LANES];
    double dx[2 * NEVH__LANES] = {0}, dz[2 * NEVH__LANES] = {0};
    for (size_t i = 0; i < 2 * NEVH__LANES; i++) {
        x[i] = q[i / NEVH__LANES];
        z[i] = p[i / NEVH__LANES];
    }
    nevh__tape_block_gradient(NEVH__LANES, t, x, z, NULL, tape, dx, dz);
    for (size_t i = 0; i < 2; i++) {
        dq[i] = dx[i * NEVH__LANES];
        dp[i] = dz[i * NEVH__LANES];
    }
}

static void assert_near(const nevh__operation_traits *f, const char *what,
                        double x, double y, double bound) {
    ck_assert_msg(fabs(x - y) <= bound * (1 + fabs(y)), "%s: %s: %.17g, %.17g",
                  f->name, what, x, y);
}

static void try_derivatives(nevh__tape_operation f, double a, double b) {
    const nevh__operation_traits *known = nevh__operation_of(f);
    double y = nevh__operation_value(f, a, b), dq[2], dp[2];
    if (!isfinite(y))
        return;
    nevh__tape *tape = tape_of(f);
    gradient_of(tape, (double[]){a, 0}, (double[]){b, 0}, dq, dp);
    if (known->by_a.top)
        assert_near(known, "by a", derivative(known->by_a, a, b, y), dq[0],
                    1e-14);
    ck_assert(!known->by_a.top || known->arity == 1 || known->by_b.top);
    if (known->by_b.top)
        assert_near(known, "by b", derivative(known->by_b, a, b, y), dp[0],
                    1e-14);
    if (known->as)
        assert_near(known, "the same", evaluate(known->as, a, b, y), y, 1e-15);
    assert_near(known, "wide", (double)nevh__operation_wide(f, a, b), y, 1e-14);
    nevh__tape_free(tape);
}

TEST_EACH(derivatives_and_values, NEVH__OPERATION_COUNT) {
    for (int i = 0; i < PLACES; i++)
        try_derivatives((nevh__tape_operation)_i, places[i].a, places[i].b);
}

/* The gradient of the derivative along a displacement, by differences. */
static void try_along(nevh__tape_operation f, double a, double b) {
    static const double d[2] = {0.3, -0.7}, h = 1e-5;
    const nevh__operation_traits *known = nevh__operation_of(f);
    int status;
    nevh__tape *tape = tape_of(f), *along = nevh__tape_along(tape, &status);
    ck_assert_int_eq(status, known->by_a.top ? NEVH_OK : NEVH_ENOGRAD);
    double dq[2], dp[2], up[2], down[2];
    if (along) {
        gradient_of(along, (double[]){a, d[0]}, (double[]){b, d[1]}, dq, dp);
        gradient_of(tape, (double[]){a + h * d[0], 0},
                    (double[]){b + h * d[1], 0}, up, dp);
        gradient_of(tape, (double[]){a - h * d[0], 0},
                    (double[]){b - h * d[1], 0}, down, dp);
        double second = (up[0] - down[0]) / (2 * h);
        if (isfinite(second))
            assert_near(known, "second derivative", dq[0], second, 1e-7);
    }
    nevh__tape_free(tape);
    nevh__tape_free(along);
}

TEST_EACH(second_derivatives, NEVH__OPERATION_COUNT) {
    for (int i = 0; i < PLACES; i++)
        try_along((nevh__tape_operation)_i, places[i].a, places[i].b);
}

/* x' = 1 in H = p + f(x, ...), so that p falls as f grows: the series of f. */
static void try_series(nevh__tape_operation f, double a) {
    static const double h = 0.05, b = 0.4, slope = 0.3;
    const nevh__operation_traits *known = nevh__operation_of(f);
    double end = nevh__operation_value(f, a + h, b + slope * (a + h));
    double y = nevh__operation_value(f, a, b + slope * a);
    char text[200], second[40] = "";
    if (known->arity == 2)
        snprintf(second, sizeof second, ", %g + %g*x", b, slope);
    snprintf(text, sizeof text,
             "[coordinates]\nx = %.17g\n[effects]\nH = p_x + %s(x%s)\n", a,
             known->name, second);
    ck_assert_int_ge(known->arity, 1);
    if (known->kind != NEVH__KIND_FUNCTION || !isfinite(y) || !isfinite(end))
        return;
    nevh_scene *s = nevh_scene_parse("test", text);
    double q, p;
    ck_assert_msg(!nevh_scene_start(s, &q, &p), "%s", nevh_scene_message(s));
    nevh_options o = {
        .gradient = nevh_exact, .tolerance = 1e-16, .q = &q, .p = &p};
    nevh_stepper *m = nevh_stepper_new(nevh_scene_system(s), nevh_taylor, &o);
    ck_assert_msg(!nevh_stepper_status(m), "%s", nevh_stepper_message(m));
    ck_assert_msg(!nevh_run(m, 0, h, 1, &q, &p, NULL, 0), "%s: %s", known->name,
                  nevh_stepper_message(m));
    assert_near(known, "series", -p, end - y, 1e-14);
    nevh_stepper_free(m);
    nevh_scene_free(s);
}

TEST_EACH(series, NEVH__OPERATION_COUNT) {
    for (int i = 0; i < PLACES; i++)
        try_series((nevh__tape_operation)_i, places[i].a);
}
