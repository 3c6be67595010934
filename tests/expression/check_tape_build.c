/* nevh tests: what tapes are made of, long ones, and terms made of them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "expression/tape_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static nevh__tape_builder *b; /* of the test that runs */
static int x, y;              /* q[0], p[0] */

static void begin(void) {
    b = nevh__tape_builder_new();
    x = nevh__tape_variable(b, NEVH__Q, 0);
    y = nevh__tape_variable(b, NEVH__P, 0);
}

static int number(double value) {
    return nevh__tape_number(b, value);
}

static int apply(nevh__tape_operation of, int u, int v) {
    return nevh__tape_apply(b, of, u, v);
}

static nevh__tape *finish(int result) {
    int status;
    nevh__tape *tape = nevh__tape_finish(b, result, &status);
    ck_assert_int_eq(status, NEVH_OK);
    return tape;
}

static bool same_bits(double u, double v) {
    return isnan(u) ? isnan(v) : memcmp(&u, &v, sizeof u) == 0;
}

static const double specials[] = {
    0,   -0.0, 1,       -1,     2,     0.5,      -4,        3,       0.1,
    NAN, 1e-9, DBL_MIN, 5e-324, 1e308, INFINITY, -INFINITY, -1e-310, 0x1p-1022,
};
enum { SPECIALS = sizeof specials / sizeof *specials };

static int negated(int u) {
    return apply(NEVH__NEGATE, u, u);
}

/* One of u, -u, c*u, -(c*u). */
static int variant(int kind, int u) {
    int scaled = kind < 2 ? u : apply(NEVH__MULTIPLY, number(0.3), u);
    return kind % 2 ? negated(scaled) : scaled;
}

static double variant_value(int kind, double u) {
    double scaled = kind < 2 ? u : 0.3 * u;
    return kind % 2 ? -scaled : scaled;
}

/* a (of) b at all pairs of special numbers, either or none of them known as
   the tape is made: nothing that is rewritten changes a bit. */
TEST_EACH(rewriting_is_exact, 5 * 4 * 4) {
    nevh__tape_operation of =
        _i % 5 == 4 ? NEVH__NEGATE : (nevh__tape_operation)(_i % 5);
    int kind_a = _i / 5 % 4, kind_b = _i / 20;
    for (int k = 0; k < 3 * SPECIALS * SPECIALS; k++) {
        double u = specials[k / 3 % SPECIALS], v = specials[k / 3 / SPECIALS];
        begin();
        int a = variant(kind_a, k % 3 == 1 ? number(u) : x);
        int c = variant(kind_b, k % 3 == 2 ? number(v) : y);
        nevh__tape *tape = finish(negated(apply(of, a, c)));
        double is = nevh__tape_value(0, &u, &v, NULL, tape);
        double plain = -nevh__operation_value(of, variant_value(kind_a, u),
                                              variant_value(kind_b, v));
        ck_assert_msg(same_bits(is, plain), "%g %s %g: %g, not %g (%d)", u,
                      nevh__operation_name(of), v, is, plain, k % 3);
        nevh__tape_free(tape);
    }
}

TEST(nothing_is_kept_twice) {
    begin();
    int sum = apply(NEVH__ADD, x, y);
    ck_assert_int_eq(sum, apply(NEVH__ADD, y, x));
    ck_assert_int_eq(apply(NEVH__MULTIPLY, x, y), apply(NEVH__MULTIPLY, y, x));
    ck_assert_int_ne(apply(NEVH__SUBTRACT, x, y), apply(NEVH__SUBTRACT, y, x));
    ck_assert_int_ne(apply(NEVH__MIN, x, y), apply(NEVH__MIN, y, x));
    ck_assert_int_eq(x, nevh__tape_variable(b, NEVH__Q, 0));
    ck_assert_int_ne(x, y);
    ck_assert_int_eq(number(0.5), number(0.5));
    ck_assert_int_ne(number(0.0), number(-0.0));
    int sine = apply(NEVH__SIN, sum, -1);
    ck_assert_int_eq(sine, apply(NEVH__SIN, sum, x));
    for (double i = 0; i < 1000; i++) /* through the table's growth */
        apply(NEVH__COS, apply(NEVH__ADD, x, number(i)), -1);
    ck_assert_int_eq(sine, apply(NEVH__SIN, apply(NEVH__ADD, y, x), -1));
    ck_assert_int_eq(x, nevh__tape_variable(b, NEVH__Q, 0));
    ck_assert_int_eq(y, nevh__tape_variable(b, NEVH__P, 0));
    nevh__tape_abandon(b);
}

TEST(identities) {
    double value;
    begin();
    ck_assert_int_eq(apply(NEVH__MULTIPLY, number(1), x), x);
    ck_assert_int_eq(apply(NEVH__DIVIDE, x, number(1)), x);
    ck_assert_int_eq(apply(NEVH__SUBTRACT, x, number(0)), x);
    ck_assert_int_eq(apply(NEVH__POWER, x, number(1)), x);
    ck_assert_int_eq(negated(negated(x)), x);
    ck_assert_int_eq(apply(NEVH__MULTIPLY, number(-1), x), negated(x));
    ck_assert_int_eq(apply(NEVH__ADD, x, negated(y)),
                     apply(NEVH__SUBTRACT, x, y));
    ck_assert_int_eq(apply(NEVH__DIVIDE, x, number(8)),
                     apply(NEVH__MULTIPLY, x, number(0.125)));
    ck_assert_int_eq(apply(NEVH__POWER, x, number(2)),
                     apply(NEVH__MULTIPLY, x, x));
    ck_assert_int_eq(apply(NEVH__POWER, x, number(0.5)),
                     apply(NEVH__SQRT, x, x));
    /* These are not the same for all numbers. */
    ck_assert_int_ne(apply(NEVH__ADD, x, number(0)), x);
    ck_assert(
        !nevh__tape_is_number(b, apply(NEVH__MULTIPLY, x, number(0)), &value));
    ck_assert(!nevh__tape_is_number(b, apply(NEVH__SUBTRACT, x, x), &value));
    /* Numbers are folded. */
    int folded = apply(NEVH__ATAN2, number(1), negated(number(2)));
    ck_assert(nevh__tape_is_number(b, folded, &value));
    ck_assert(value == atan2(1, -2));
    ck_assert(nevh__tape_is_number(b, apply(NEVH__POWER, x, number(0)), NULL));
    nevh__tape_abandon(b);
}

/* So many halves of an ulp, and those by which powl errs where long double is
   no more than double, as under valgrind. */
static double roundings(double count) {
    volatile long double one = 1;
    return (one + DBL_EPSILON / 64 != one ? count : count + 128) * DBL_EPSILON /
           2;
}

/* Half-integer powers: how exact they are, and how many operations. */
TEST_EACH(powers, 35) {
    double exponent = (_i - 17) / 2., whole = trunc(fabs(exponent));
    bool small = exponent == trunc(exponent) ? whole <= 8 : whole < 5;
    double rounded = fmax(whole, 1) + (exponent < 0) + 1;
    begin();
    nevh__tape *tape = finish(apply(NEVH__POWER, x, number(exponent)));
    ck_assert(small || nevh__tape_length(tape) == 1);
    for (int i = 0; i < 200; i++) {
        double at = exp(0.05 * (i - 100));
        if (i % 2 && exponent == trunc(exponent))
            at = -at;
        long double exact = powl(at, exponent);
        double is = nevh__tape_value(0, &at, NULL, NULL, tape);
        ck_assert_msg(fabsl(is - exact) <= roundings(rounded) * fabsl(exact),
                      "%.17g^%g = %.17g, not %.17Lg", at, exponent, is, exact);
    }
    nevh__tape_free(tape);
}

TEST(what_is_read) {
    begin();
    int t = nevh__tape_variable(b, NEVH__T, 0);
    int c = nevh__tape_variable(b, NEVH__C, 3);
    int q2 = nevh__tape_variable(b, NEVH__Q, 2);
    int bent = apply(NEVH__ABS, t, t), lost = apply(NEVH__ABS, q2, q2);
    int none = apply(NEVH__POWER, lost, number(0));
    int sum = apply(NEVH__MULTIPLY, c, apply(NEVH__ADD, bent, none));
    nevh__tape *tape = finish(apply(NEVH__ADD, sum, x));
    ck_assert(nevh__tape_reads(tape, NEVH__T, 0));
    ck_assert(nevh__tape_reads(tape, NEVH__Q, 0));
    ck_assert(nevh__tape_reads(tape, NEVH__C, 3));
    ck_assert(!nevh__tape_reads(tape, NEVH__C, 0));
    ck_assert(!nevh__tape_reads(tape, NEVH__Q, 2));
    ck_assert(!nevh__tape_reads(tape, NEVH__P, 0));
    ck_assert(!nevh__tape_reads(tape, NEVH__P, 7));
    ck_assert_uint_eq(nevh__tape_count(tape, NEVH__Q), 3);
    ck_assert_uint_eq(nevh__tape_count(tape, NEVH__P), 1);
    ck_assert_uint_eq(nevh__tape_count(tape, NEVH__C), 4);
    nevh_term term = {.effect = "H"};
    nevh__tape_shape(&term, tape);
    ck_assert(term.nq == 3 && term.np == 1 && term.nc == 4 && term.time);
    ck_assert(term.complex_value); /* t alone is under abs */
    ck_assert(term.block && term.gradient);
    nevh__tape_free(tape);
}

/* An even function takes the same of x as of abs(x), and has no kink. */
TEST(even_functions_need_no_abs) {
    const double even[] = {2, 4, 6, 10, -2};
    for (size_t i = 0; i < sizeof even / sizeof *even; i++) {
        begin();
        int size = apply(NEVH__ABS, x, x);
        ck_assert_int_eq(apply(NEVH__POWER, size, number(even[i])),
                         apply(NEVH__POWER, x, number(even[i])));
        ck_assert_int_ne(apply(NEVH__POWER, size, number(even[i] + 1)),
                         apply(NEVH__POWER, x, number(even[i] + 1)));
        nevh__tape_abandon(b);
    }
    begin();
    int size = apply(NEVH__ABS, x, x);
    ck_assert_int_eq(apply(NEVH__MULTIPLY, size, size),
                     apply(NEVH__MULTIPLY, x, x));
    ck_assert_int_eq(apply(NEVH__COS, size, -1), apply(NEVH__COS, x, -1));
    ck_assert_int_eq(apply(NEVH__COSH, size, -1), apply(NEVH__COSH, x, -1));
    ck_assert_int_eq(apply(NEVH__ABS, size, -1), size);
    ck_assert_int_ne(apply(NEVH__SIN, size, -1), apply(NEVH__SIN, x, -1));
    ck_assert_int_ne(apply(NEVH__CUBE, size, -1), apply(NEVH__CUBE, x, -1));
    nevh__tape_abandon(b);
}

TEST_EACH(kinks_are_told, 6) {
    static const nevh__tape_operation kinked[] = {
        NEVH__ABS, NEVH__MIN, NEVH__MAX, NEVH__SIGN, NEVH__MOD, NEVH__FLOOR};
    begin();
    nevh__tape *tape =
        finish(apply(NEVH__SIN, apply(kinked[_i], number(2), x), -1));
    nevh_term term = {.effect = "H"};
    nevh__tape_shape(&term, tape);
    ck_assert_int_eq(nevh__operation_arguments(kinked[_i]) == 1,
                     term.complex_value != NULL);
    nevh__tape_free(tape);
    begin();
    tape = finish(apply(NEVH__SIN, apply(kinked[_i], x, number(2)), -1));
    nevh__tape_shape(&term, tape);
    ck_assert(!term.complex_value);
    nevh__tape_free(tape);
}

/* Sine and cosine are one operation, dead ones none. */
TEST(lengths) {
    begin();
    int sine = apply(NEVH__SIN, x, -1), cosine = apply(NEVH__COS, x, -1);
    apply(NEVH__EXP, sine, -1);
    nevh__tape *tape = finish(apply(NEVH__MULTIPLY, sine, cosine));
    double at = 0.7, h = nevh__tape_value(0, &at, NULL, NULL, tape);
    ck_assert_uint_eq(nevh__tape_length(tape), 2);
    ck_assert_double_eq(h, sin(at) * cos(at));
    nevh__tape_free(tape);
    begin();
    sine = apply(NEVH__SIN, x, -1);
    apply(NEVH__COS, x, -1);
    tape = finish(negated(sine));
    ck_assert_uint_eq(nevh__tape_length(tape), 2);
    ck_assert_double_eq(nevh__tape_value(0, &at, NULL, NULL, tape), -sin(at));
    nevh__tape_free(tape);
    begin();
    tape = finish(x);
    ck_assert_uint_eq(nevh__tape_length(tape), 0);
    nevh__tape_free(tape);
}

/* Without operations: a variable of each kind, and a number. */
TEST_EACH(mere_variables, 5) {
    double t[24], none[24] = {0}, h[24], dq[24], dp[24];
    for (int i = 0; i < 24; i++)
        t[i] = i - 13;
    begin();
    int node =
        _i < 4 ? nevh__tape_variable(b, (nevh__variable)_i, 0) : number(4);
    nevh__tape *tape = finish(node);
    nevh__tape_block(24, _i == 0 ? t : none, _i == 1 ? t : none,
                     _i == 2 ? t : none, _i == 3 ? t : none, tape, h);
    nevh__tape_block_gradient(24, none, t, t, none, tape, dq, dp);
    ck_assert_double_eq(h[17], 4);
    ck_assert_double_eq(dq[17], _i == 1);
    ck_assert_double_eq(dp[17], _i == 2);
    for (int v = 0; v < NEVH__VARIABLES; v++)
        ck_assert_int_eq(nevh__tape_reads(tape, (nevh__variable)v, 0), v == _i);
    nevh__tape_free(tape);
}

/* Where a branch is not taken, its derivative may be infinite. */
TEST(what_does_not_matter) {
    double at[8] = {0}, dq[8], dp[8];
    begin();
    int root = apply(NEVH__SQRT, x, x), one = number(1);
    int both = apply(NEVH__ADD, apply(NEVH__MAX, root, one),
                     apply(NEVH__MULTIPLY, x, root));
    nevh__tape *tape = finish(apply(
        NEVH__ADD, both, apply(NEVH__SQRT, apply(NEVH__MULTIPLY, x, x), -1)));
    nevh__tape_block_gradient(8, at, at, at, NULL, tape, dq, dp);
    ck_assert_double_eq(dq[5], 0);
    ck_assert_double_eq(dp[5], 0);
    nevh__tape_free(tape);
}

/* Every sine is used twice, the second time after all of them. */
static int crowd(int count) {
    begin();
    int sum = number(0), again = sum;
    for (int i = 0; i < count; i++)
        sum = apply(NEVH__ADD, sum,
                    apply(NEVH__SIN, nevh__tape_variable(b, NEVH__Q, i), -1));
    for (int i = 0; i < count; i++) {
        int sine = apply(NEVH__SIN, nevh__tape_variable(b, NEVH__Q, i), -1);
        again = apply(NEVH__ADD, again, apply(NEVH__MULTIPLY, sum, sine));
    }
    return again;
}

TEST(too_much) {
    int status = NEVH_OK, last = crowd(NEVH__TAPE_LIVE + 2);
    ck_assert_ptr_null(nevh__tape_finish(b, last, &status));
    ck_assert_int_eq(status, NEVH_EINVAL);
    last = crowd(NEVH__TAPE_LIVE - 5);
    nevh__tape_free(finish(last));
    begin();
    last = x;
    for (int i = 0; i <= NEVH__TAPE_LENGTH; i++)
        last = apply(NEVH__ADD, last, y);
    ck_assert_ptr_null(nevh__tape_finish(b, last, &status));
    ck_assert_int_eq(status, NEVH_EINVAL);
}

TEST(failures_are_handed_on) {
    int status = NEVH_OK;
    b = NULL;
    ck_assert_int_eq(number(1), -1);
    ck_assert_int_eq(nevh__tape_variable(b, NEVH__Q, 0), -1);
    ck_assert_int_eq(apply(NEVH__ADD, -1, -1), -1);
    ck_assert(!nevh__tape_is_number(b, -1, NULL));
    ck_assert_ptr_null(nevh__tape_finish(b, -1, &status));
    ck_assert_int_eq(status, NEVH_ENOMEM);
    nevh__tape_abandon(NULL);
    nevh__tape_free(NULL);
    begin();
    ck_assert_int_eq(nevh__tape_variable(b, NEVH__Q, SIZE_MAX), -1);
    ck_assert_int_eq(number(1), -1);
    ck_assert_ptr_null(nevh__tape_finish(b, x, NULL));
}
