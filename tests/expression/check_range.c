/* nevh tests: ranges of operations over stretches of time: no value and no
   derivative lies outside, and no kink, jump or pole is passed unseen.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "support.h"
#include "expression/range_private.h"
#include "system/system_private.h"
#include <math.h>

static double random_between(uint64_t *random, double low, double high) {
    return low + (high - low) * (nevh__random(random) + 1) / 2;
}

/* Where the arguments of an operation are: those of poles and kinks too. */
static double any(uint64_t *random) {
    static const double odd[] = {0, 1, -1, 0.5, 2, -3};
    double x = random_between(random, -4, 4);
    return fabs(x) < 0.5 ? odd[(int)(12 * fabs(x))] : x;
}

typedef struct {
    double at, by; /* a straight line */
} line;

static double value(nevh__tape_operation f, line a, line b, double t) {
    return nevh__operation_value(f, a.at + a.by * t, b.at + b.by * t);
}

static nevh__range over(line a, double low, double high) {
    double x = a.at + a.by * low, y = a.at + a.by * high;
    return (nevh__range){fmin(x, y), fmax(x, y), a.by, a.by, 0};
}

static bool is_whole(nevh__range r) {
    return !isnan(r.low) && !isnan(r.high) && !isnan(r.down) && !isnan(r.up);
}

enum { TRIES = 4000, TIMES = 24 };

/* Of an operation on lines, over stretches of any length. */
static void check(nevh__tape_operation f, uint64_t *random) {
    bool two = nevh__operation_arguments(f) == 2;
    line a = {any(random), any(random)}, b = {any(random), 0};
    if (two && f != NEVH__MOD && f != NEVH__ECCENTRIC &&
        random_between(random, 0, 1) < 0.7)
        b.by = any(random);
    double low = random_between(random, -1, 1);
    double high = low + pow(10, random_between(random, -6, 0.5));
    nevh__range r =
        nevh__range_apply(f, over(a, low, high), over(b, low, high));
    double size = fmax(fabs(r.low), fabs(r.high)), room = 1e-12 * (1 + size);
    for (int i = 0; is_whole(r) && isfinite(size) && i <= TIMES; i++) {
        double t = low + (high - low) * i / TIMES, d = 1e-5 * (high - low);
        double y = value(f, a, b, t);
        if (isnan(y))
            continue;
        ck_assert_msg(y >= r.low - room && y <= r.high + room,
                      "%s(%g + %g t, %g + %g t) over %g ... %g: %g is not "
                      "within %g ... %g",
                      nevh__operation_name(f), a.at, a.by, b.at, b.by, low,
                      high, y, r.low, r.high);
        double slope = (value(f, a, b, t + d) - value(f, a, b, t)) / d;
        double loose = 1e-3 * (1 + fabs(slope)) + 1e-15 * (1 + fabs(y)) / d;
        if (i == TIMES || isnan(slope) || r.broken)
            continue;
        ck_assert_msg(slope >= r.down - loose && slope <= r.up + loose,
                      "%s(%g + %g t, %g + %g t) over %g ... %g: the derivative "
                      "%g is not within %g ... %g",
                      nevh__operation_name(f), a.at, a.by, b.at, b.by, low,
                      high, slope, r.down, r.up);
    }
}

TEST_EACH(nothing_is_out_of_range, NEVH__OPERATION_COUNT) {
    uint64_t random = 1;
    for (int i = 0; i < TRIES; i++)
        check((nevh__tape_operation)_i, &random);
}

/* Over ever shorter stretches ranges shrink to the value. */
TEST_EACH(ranges_shrink, NEVH__OPERATION_COUNT) {
    nevh__tape_operation f = (nevh__tape_operation)_i;
    line a = {f == NEVH__ACOSH ? 1.7 : 0.7, 0.13}, b = {0.3, 0};
    for (double length = 0.1; length > 1e-9; length /= 10) {
        nevh__range r =
            nevh__range_apply(f, over(a, 0, length), over(b, 0, length));
        ck_assert(r.broken == 0);
        if (f != NEVH__BESSEL_J0 && f != NEVH__BESSEL_J1) /* of bounds alone */
            ck_assert_double_lt(r.high - r.low, 10 * length + 1e-15);
    }
}

static const struct {
    nevh__tape_operation f;
    double low, high, second;
    unsigned broken;
} breaks[] = {
    {NEVH__ABS, -1, 1, 0, NEVH__KINK},      {NEVH__ABS, 0.1, 1, 0, 0},
    {NEVH__SIGN, -1, 1, 0, NEVH__KINK},     {NEVH__SIGN, -1, 0, 0, NEVH__KINK},
    {NEVH__FLOOR, 0.9, 1.1, 0, NEVH__KINK}, {NEVH__FLOOR, 1.1, 1.9, 0, 0},
    {NEVH__MOD, 0.6, 0.8, 0.7, NEVH__KINK}, {NEVH__MOD, 0.1, 0.6, 0.7, 0},
    {NEVH__MAX, -1, 1, 0.5, NEVH__KINK},    {NEVH__MIN, 0.6, 1, 0.5, 0},
    {NEVH__TAN, 1.5, 1.6, 0, NEVH__POLE},   {NEVH__TAN, 1.6, 4.7, 0, 0},
    {NEVH__LOG, 0, 1, 0, NEVH__POLE},       {NEVH__HYPOT, -1, 1, 0, NEVH__KINK},
    {NEVH__ATAN2, -1, 1, -1, NEVH__KINK},   {NEVH__ATAN2, -1, 1, 1, 0},
    {NEVH__POWER, -1, 1, -2, NEVH__POLE},   {NEVH__POWER, 1, 2, -2, 0},
};

TEST_EACH(breaks_are_told, sizeof breaks / sizeof *breaks) {
    nevh__range a = {breaks[_i].low, breaks[_i].high, 1, 1, 0};
    nevh__range b = {breaks[_i].second, breaks[_i].second, 0, 0, 0};
    ck_assert_uint_eq(nevh__range_apply(breaks[_i].f, a, b).broken,
                      breaks[_i].broken);
}

TEST(divisors_may_be_zero) {
    nevh__range one = {1, 1, 0, 0, 0}, b = {-1, 1, 1, 1, 0};
    ck_assert_uint_eq(nevh__range_apply(NEVH__DIVIDE, one, b).broken,
                      NEVH__POLE);
    b.low = 0.5;
    ck_assert_uint_eq(nevh__range_apply(NEVH__DIVIDE, one, b).broken, 0);
}
