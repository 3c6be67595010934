/* nevh: interval arithmetic with derivatives [R. E. Moore, Methods and
   Applications of Interval Analysis, SIAM (1979)].
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/range_private.h"
#include "expression/tape_operations_private.h"
#include <math.h>

typedef struct {
    double low, high;
} interval;

static const interval all = {-INFINITY, INFINITY};

/* 0 times infinity is 0, as in the chain rule. */
static double range_product(double x, double y) {
    return x == 0 || y == 0 ? 0 : x * y;
}

static interval range_times(interval x, interval y) {
    double a = range_product(x.low, y.low), b = range_product(x.low, y.high);
    double c = range_product(x.high, y.low), d = range_product(x.high, y.high);
    return (interval){fmin(fmin(a, b), fmin(c, d)),
                      fmax(fmax(a, b), fmax(c, d))};
}

static interval range_plus(interval x, interval y) {
    interval sum = {x.low + y.low, x.high + y.high};
    return isnan(sum.low) || isnan(sum.high) ? all : sum;
}

static interval range_minus(interval x, interval y) {
    return range_plus(x, (interval){-y.high, -y.low});
}

static interval hull(double x, double y) {
    return (interval){fmin(x, y), fmax(x, y)};
}

static bool range_holds(interval x, double y) {
    return x.low <= y && y <= x.high;
}

static interval inverse(interval x) {
    if (x.low < 0 && x.high > 0)
        return all;
    double a = x.low == 0 ? INFINITY : 1 / x.low;
    double b = x.high == 0 ? -INFINITY : 1 / x.high;
    return hull(a, b);
}

static interval square(interval x) {
    double a = x.low * x.low, b = x.high * x.high;
    return range_holds(x, 0) ? (interval){0, fmax(a, b)} : hull(a, b);
}

static interval range_value_of(nevh__range x) {
    return (interval){x.low, x.high};
}

static interval range_slope_of(nevh__range x) {
    return (interval){x.down, x.up};
}

static nevh__range range_join(interval value, interval slope, unsigned broken) {
    return (nevh__range){value.low, value.high, slope.low, slope.high, broken};
}

static const double turn = 6.283185307179586, quarter = 1.5707963267948966;

/* The range of a periodic function with maxima at `top` and each turn after it. */
static interval wave(double (*f)(double), interval x, double top) {
    if (!(x.high - x.low < turn))
        return (interval){-1, 1};
    interval y = hull(f(x.low), f(x.high));
    double low = (x.low - top) / turn, high = (x.high - top) / turn;
    if (floor(high) > floor(low))
        y.high = 1;
    if (floor(high - 0.5) > floor(low - 0.5))
        y.low = -1;
    return y;
}

static interval cosine(interval x) {
    return wave(cos, x, 0);
}

static interval sine(interval x) {
    return wave(sin, x, quarter);
}

/* The range of a rising function, and of its derivative. */
static nevh__range rising(nevh__tape_operation f, interval x, interval by,
                          nevh__range a) {
    interval y = {nevh__operation_value(f, x.low, 0),
                  nevh__operation_value(f, x.high, 0)};
    return range_join(y, range_times(by, range_slope_of(a)), a.broken);
}

/* The part of an interval that lies in the domain of a function. */
static interval within(interval x, double low, double high) {
    if (x.high < low || x.low > high)
        return (interval){NAN, NAN};
    return (interval){fmax(x.low, low), fmin(x.high, high)};
}

static interval root(interval x) {
    return (interval){sqrt(x.low), sqrt(x.high)};
}

static interval plus_number(double c, interval x) {
    return (interval){c + x.low, c + x.high};
}

static nevh__range arc(nevh__tape_operation f, nevh__range a) {
    interval x = within(range_value_of(a), -1, 1);
    interval rest = range_minus((interval){1, 1}, square(x));
    rest.low = fmax(rest.low, 0);
    interval by = inverse(root(rest));
    if (f == NEVH__ASIN)
        return rising(f, x, by, a);
    return range_join(
        (interval){acos(x.high), acos(x.low)},
        range_times((interval){-by.high, -by.low}, range_slope_of(a)),
        a.broken);
}

static nevh__range tangent(nevh__range a) {
    static const double half_turn = 3.141592653589793;
    if (floor(a.high / half_turn + 0.5) > floor(a.low / half_turn + 0.5))
        return range_join(all, all, NEVH__POLE);
    interval y = {tan(a.low), tan(a.high)};
    return range_join(
        y, range_times(plus_number(1, square(y)), range_slope_of(a)), a.broken);
}

static nevh__range angle(nevh__range y, nevh__range x) {
    interval a = range_value_of(y), b = range_value_of(x);
    interval length = range_plus(square(a), square(b));
    interval by = range_times(range_minus(range_times(b, range_slope_of(y)),
                                          range_times(a, range_slope_of(x))),
                              inverse(length));
    if (range_holds(a, 0) && b.low <= 0)
        return range_join((interval){-2 * quarter, 2 * quarter}, all,
                          NEVH__KINK);
    interval near = hull(atan2(a.low, b.low), atan2(a.high, b.high));
    interval far = hull(atan2(a.low, b.high), atan2(a.high, b.low));
    return range_join(
        (interval){fmin(near.low, far.low), fmax(near.high, far.high)}, by,
        y.broken | x.broken);
}

static interval magnitude(interval x) {
    double a = fabs(x.low), b = fabs(x.high);
    return range_holds(x, 0) ? (interval){0, fmax(a, b)} : hull(a, b);
}

static nevh__range range_length(nevh__range a, nevh__range b) {
    interval x = magnitude(range_value_of(a)), y = magnitude(range_value_of(b));
    interval r = {hypot(x.low, y.low), hypot(x.high, y.high)};
    double most =
        hypot(fmax(fabs(a.down), fabs(a.up)), fmax(fabs(b.down), fabs(b.up)));
    interval by = range_times(
        range_plus(range_times(range_value_of(a), range_slope_of(a)),
                   range_times(range_value_of(b), range_slope_of(b))),
        inverse(r));
    by = (interval){fmax(by.low, -most), fmin(by.high, most)};
    return range_join(r, by,
                      a.broken | b.broken | (r.low == 0 ? NEVH__KINK : 0));
}

static nevh__range quotient(nevh__range a, nevh__range b) {
    interval x = range_value_of(b), by = inverse(x);
    bool pole = range_holds(x, 0);
    if (pole)
        return range_join(all, all, NEVH__POLE);
    interval y = range_times(range_value_of(a), by);
    return range_join(
        y,
        range_times(
            range_minus(range_slope_of(a), range_times(y, range_slope_of(b))),
            by),
        a.broken | b.broken);
}

static nevh__range range_multiplied(nevh__range a, nevh__range b) {
    interval x = range_value_of(a), y = range_value_of(b);
    return range_join(range_times(x, y),
                      range_plus(range_times(range_slope_of(a), y),
                                 range_times(x, range_slope_of(b))),
                      a.broken | b.broken);
}

/* x^n: rising or falling on either side of 0. */
static interval whole_power(interval x, double n) {
    if (n == 0)
        return (interval){1, 1};
    if (n < 0)
        return inverse(whole_power(x, -n));
    bool even = fmod(n, 2) == 0;
    interval y = even ? magnitude(x) : x;
    return (interval){pow(y.low, n), pow(y.high, n)};
}

static interval real_power(interval x, double n) {
    x = within(x, 0, INFINITY);
    return hull(pow(x.low, n), pow(x.high, n));
}

static nevh__range exponential(nevh__range a) {
    return rising(NEVH__EXP, range_value_of(a),
                  (interval){exp(a.low), exp(a.high)}, a);
}

static nevh__range logarithm(nevh__tape_operation f, nevh__range a) {
    interval x = within(range_value_of(a), 0, INFINITY), by = inverse(x);
    if (f == NEVH__LOG10)
        by = (interval){by.low / log(10), by.high / log(10)};
    nevh__range y = rising(f, x, by, a);
    y.broken |= x.low == 0 ? NEVH__POLE : 0;
    return y;
}

static nevh__range range_power(nevh__range a, nevh__range b) {
    double n = b.low;
    if (b.low != b.high)
        return exponential(range_multiplied(b, logarithm(NEVH__LOG, a)));
    interval x = range_value_of(a),
             (*of)(interval, double) = rint(n) == n ? whole_power : real_power;
    bool pole = n < 0 && range_holds(x, 0);
    interval by = range_times((interval){n, n}, of(x, n - 1));
    return range_join(pole ? all : of(x, n),
                      pole ? all : range_times(by, range_slope_of(a)),
                      a.broken | (pole ? NEVH__POLE : 0));
}

/* The range of the maximum of two; a kink if either can be the larger. */
static nevh__range range_larger(nevh__range a, nevh__range b) {
    bool same = a.low == b.high && b.low == a.high;
    if (a.low > b.high || same)
        return a;
    if (b.low > a.high)
        return b;
    return (nevh__range){fmax(a.low, b.low), fmax(a.high, b.high),
                         fmin(a.down, b.down), fmax(a.up, b.up), NEVH__KINK};
}

static nevh__range negative(nevh__range a) {
    return (nevh__range){-a.high, -a.low, -a.up, -a.down, a.broken};
}

static nevh__range stair(double low, double high, nevh__range a) {
    bool level = low == high;
    return range_join((interval){low, high}, level ? (interval){0, 0} : all,
                      a.broken | (level ? 0 : NEVH__KINK));
}

static nevh__range remainder_of(nevh__range a, nevh__range b) {
    double y = b.low;
    if (y != b.high || y == 0)
        return range_join(all, all, NEVH__KINK);
    double low = floor(a.low / y), high = floor(a.high / y);
    if (low != high)
        return range_join(hull(0, y), all, NEVH__KINK);
    return range_join((interval){a.low - low * y, a.high - low * y},
                      range_slope_of(a), a.broken);
}

static nevh__range absolute(nevh__range a) {
    interval y = magnitude(range_value_of(a));
    if (a.low > 0 || a.low == a.high)
        return a.low < 0 ? negative(a) : a;
    if (a.high < 0)
        return negative(a);
    double most = fmax(fabs(a.down), fabs(a.up));
    return range_join(y, (interval){-most, most}, NEVH__KINK);
}

/* The eccentric anomaly of a mean one. */
static nevh__range anomaly(nevh__range a, nevh__range b) {
    double e = b.low;
    if (b.low != b.high)
        return range_join(range_plus(range_value_of(a), (interval){-1, 1}), all,
                          a.broken | b.broken);
    interval y = {nevh__kepler(a.low, e), nevh__kepler(a.high, e)};
    interval c = cosine(y);
    interval by = inverse((interval){1 - e * c.high, 1 - e * c.low});
    return range_join(y, range_times(by, range_slope_of(a)), a.broken);
}

/* Even functions of 0 <= |x| < 1, one of which rises. */
static nevh__range range_elliptic(nevh__tape_operation f, nevh__range a) {
    interval x = within(magnitude(range_value_of(a)), 0, 1);
    bool up = f == NEVH__ELLIPTIC_K;
    double (*slope)(double) =
        up ? nevh__elliptic_k_slope : nevh__elliptic_e_slope;
    double most = fmax(fabs(slope(x.low)), fabs(slope(x.high)));
    double first = nevh__operation_value(f, x.low, 0);
    if (x.high == 1)
        return range_join(up ? (interval){first, INFINITY}
                             : (interval){1, first},
                          all, a.broken);
    return range_join(hull(nevh__operation_value(f, x.low, 0),
                           nevh__operation_value(f, x.high, 0)),
                      range_times((interval){-most, most}, range_slope_of(a)),
                      a.broken);
}

static nevh__range special(nevh__tape_operation f, nevh__range a) {
    switch (f) {
    case NEVH__BESSEL_J0:
    case NEVH__BESSEL_J1:
        return range_join((interval){-1, 1},
                          range_times((interval){-0.6, 0.6}, range_slope_of(a)),
                          a.broken);
    case NEVH__ELLIPTIC_K:
    case NEVH__ELLIPTIC_E:
        return range_elliptic(f, a);
    default: /* nothing is known of it */
        return range_join(all, all, a.broken);
    }
}

static nevh__range hyperbolic(nevh__tape_operation f, nevh__range a) {
    interval x = range_value_of(a), y;
    switch (f) {
    case NEVH__SINH:
        y = magnitude(x);
        return rising(f, x, (interval){cosh(y.low), cosh(y.high)}, a);
    case NEVH__COSH:
        y = magnitude(x);
        return range_join((interval){cosh(y.low), cosh(y.high)},
                          range_times((interval){sinh(x.low), sinh(x.high)},
                                      range_slope_of(a)),
                          a.broken);
    case NEVH__TANH:
        y = square((interval){tanh(x.low), tanh(x.high)});
        return rising(f, x, (interval){1 - y.high, 1 - y.low}, a);
    case NEVH__ASINH:
        return rising(f, x, inverse(root(plus_number(1, square(x)))), a);
    case NEVH__ACOSH:
        x = within(x, 1, INFINITY);
        return rising(f, x, inverse(root(plus_number(-1, square(x)))), a);
    case NEVH__ATANH:
        x = within(x, -1, 1);
        return rising(f, x, inverse(range_minus((interval){1, 1}, square(x))),
                      a);
    default:
        return special(f, a);
    }
}

static nevh__range trigonometric(nevh__tape_operation f, nevh__range a) {
    interval x = range_value_of(a), y;
    switch (f) {
    case NEVH__SIN:
        return range_join(sine(x), range_times(cosine(x), range_slope_of(a)),
                          a.broken);
    case NEVH__COS:
        y = sine(x);
        return range_join(
            cosine(x),
            range_times((interval){-y.high, -y.low}, range_slope_of(a)),
            a.broken);
    case NEVH__TAN:
        return tangent(a);
    case NEVH__ATAN:
        return rising(f, x, inverse(plus_number(1, square(x))), a);
    case NEVH__ASIN:
    case NEVH__ACOS:
        return arc(f, a);
    default:
        return hyperbolic(f, a);
    }
}

static nevh__range of_one(nevh__tape_operation f, nevh__range a) {
    interval x = range_value_of(a), y;
    switch (f) {
    case NEVH__NEGATE:
        return negative(a);
    case NEVH__SQUARE:
        return range_join(
            square(x),
            range_times((interval){2 * x.low, 2 * x.high}, range_slope_of(a)),
            a.broken);
    case NEVH__CUBE:
        y = square(x);
        return rising(f, x, (interval){3 * y.low, 3 * y.high}, a);
    case NEVH__EXP:
        return exponential(a);
    case NEVH__LOG:
    case NEVH__LOG10:
        return logarithm(f, a);
    case NEVH__SQRT:
        x = within(x, 0, INFINITY);
        y = inverse(root(x));
        return rising(f, x, (interval){y.low / 2, y.high / 2}, a);
    case NEVH__CBRT:
        y = inverse(square((interval){cbrt(x.low), cbrt(x.high)}));
        return rising(f, x, (interval){y.low / 3, y.high / 3}, a);
    case NEVH__ABS:
        return absolute(a);
    case NEVH__SIGN:
        return stair(nevh__sign(a.low), nevh__sign(a.high), a);
    case NEVH__FLOOR:
        return stair(floor(a.low), floor(a.high), a);
    default:
        return trigonometric(f, a);
    }
}

static nevh__range of_two(nevh__tape_operation f, nevh__range a,
                          nevh__range b) {
    unsigned broken = a.broken | b.broken;
    switch (f) {
    case NEVH__ADD:
        return range_join(range_plus(range_value_of(a), range_value_of(b)),
                          range_plus(range_slope_of(a), range_slope_of(b)),
                          broken);
    case NEVH__SUBTRACT:
        return of_two(NEVH__ADD, a, negative(b));
    case NEVH__MULTIPLY:
        return range_multiplied(a, b);
    case NEVH__DIVIDE:
        return quotient(a, b);
    case NEVH__POWER:
        return range_power(a, b);
    case NEVH__ATAN2:
        return angle(a, b);
    case NEVH__HYPOT:
        return range_length(a, b);
    case NEVH__MAX:
        return range_larger(a, b);
    case NEVH__MIN:
        return negative(range_larger(negative(a), negative(b)));
    case NEVH__MOD:
        return remainder_of(a, b);
    case NEVH__ECCENTRIC:
        return anomaly(a, b);
    default:
        return range_join(all, all, broken);
    }
}

nevh__range nevh__range_apply(nevh__tape_operation f, nevh__range a,
                              nevh__range b) {
    return nevh__operation_arguments(f) == 1 ? of_one(f, a) : of_two(f, a, b);
}
