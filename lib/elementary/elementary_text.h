/* nevh: elementary functions that have the same bits on every machine.
   SPDX-License-Identifier: GPL-3.0-or-later

   Sums, products, quotients and square roots of IEEE 754 in one order, without
   fused operations: one number, vectors of any length, and other processors give
   the same.  Errors are below 1 ulp (tests/expression/check_elementary.c).  Where a rounding would
   cost that, numbers are pairs, of what is exactly known and a rest [Dekker, "A
   floating-point technique for extending the available precision", Numer. Math. 18
   (1971)].  Polynomials interpolate at Chebyshev's nodes.

   The text is included once for each kind of numbers, by elementary_number.h and
   elementary_lanes.h, which define

   NEVH__NUMBER   the type: double, or a vector of doubles
   NEVH__BITS     unsigned integers of the same size
   NEVH__E(f)     names
   and the functions that the kinds do not share: bits, number, less, choose, sqrt,
   mend.  NEVH__MAIN is what the functions are declared with.  NEVH__NO_CIRCLE and so
   on leave functions out. */
#ifndef NEVH_ELEMENTARY_TEXT_H /* never defined */

typedef struct {
    NEVH__NUMBER hi, lo;
} NEVH__PAIR;

NEVH__INLINE NEVH__NUMBER NEVH__E(all)(double x) {
    return (NEVH__NUMBER){0} + x;
}

NEVH__INLINE NEVH__NUMBER NEVH__E(size)(NEVH__NUMBER x) {
    return NEVH__E(number)(NEVH__E(bits)(x) & ~NEVH__ONE_SIGN);
}

/* x with the sign of y changed into that of the product. */
NEVH__INLINE NEVH__NUMBER NEVH__E(signed)(NEVH__NUMBER x, NEVH__NUMBER y) {
    return NEVH__E(number)(NEVH__E(bits)(x) ^
                           (NEVH__E(bits)(y) & NEVH__ONE_SIGN));
}

/* a + b and what it lost; quick: |a| >= |b| or a = 0. */
NEVH__INLINE NEVH__PAIR NEVH__E(quick)(NEVH__NUMBER a, NEVH__NUMBER b) {
    NEVH__NUMBER sum = a + b;
    return (NEVH__PAIR){sum, (a - sum) + b};
}

NEVH__INLINE NEVH__PAIR NEVH__E(sum)(NEVH__NUMBER a, NEVH__NUMBER b) {
    NEVH__NUMBER sum = a + b, part = sum - a;
    return (NEVH__PAIR){sum, (a - (sum - part)) + (b - part)};
}

/* Both below 2^990. */
NEVH__INLINE NEVH__PAIR NEVH__E(product)(NEVH__NUMBER a, NEVH__NUMBER b) {
    const double half = 0x1p27 + 1;
    NEVH__NUMBER product = a * b, t = half * a, u = half * b;
    NEVH__NUMBER a1 = t - (t - a), a2 = a - a1, b1 = u - (u - b), b2 = b - b1;
    return (NEVH__PAIR){product,
                        ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

/* sum_i c[i] x^i, at most 16 of them: neighbours are joined, and again [Estrin]. */
NEVH__INLINE NEVH__NUMBER NEVH__E(polynomial)(const double c[], size_t count,
                                              NEVH__NUMBER x) {
    NEVH__NUMBER part[8];
    NEVH__UNROLLED
    for (size_t i = 0; i < count / 2; i++)
        part[i] = c[2 * i] + x * c[2 * i + 1];
    if (count % 2)
        part[count / 2] = NEVH__E(all)(c[count - 1]);
    count = (count + 1) / 2;
    NEVH__UNROLLED
    for (int level = 0; level < 3; level++) {
        x = x * x;
        NEVH__UNROLLED
        for (size_t i = 0; i < count / 2; i++)
            part[i] = part[2 * i] + x * part[2 * i + 1];
        if (count % 2)
            part[count / 2] = part[count - 1];
        count = (count + 1) / 2;
    }
    return part[0];
}
#define NEVH__ONE_POLYNOMIAL(c, x)                                             \
    NEVH__E(polynomial)(c, sizeof(c) / sizeof *(c), x)

/* The quotient of pairs. */
NEVH__INLINE NEVH__NUMBER NEVH__E(quotient)(NEVH__PAIR a, NEVH__PAIR b) {
    NEVH__NUMBER q = a.hi / b.hi;
    NEVH__PAIR p = NEVH__E(product)(q, b.hi);
    return q + (((a.hi - p.hi) - p.lo) + (a.lo - q * b.lo)) / b.hi;
}

/* The root of a pair, as a pair. */
NEVH__INLINE NEVH__PAIR NEVH__E(root_of)(NEVH__PAIR x) {
    NEVH__NUMBER r = NEVH__E(sqrt)(x.hi);
    NEVH__PAIR square = NEVH__E(product)(r, r);
    return (NEVH__PAIR){r, (((x.hi - square.hi) - square.lo) + x.lo) / (r + r)};
}

/* x 2^power, |power| <= 2000. */
NEVH__INLINE NEVH__NUMBER NEVH__E(scaled)(NEVH__NUMBER x, NEVH__NUMBER power) {
    NEVH__NUMBER part = 0.5 * power + NEVH__ONE_ROUND;
    NEVH__NUMBER rest = (power - (part - NEVH__ONE_ROUND)) + NEVH__ONE_ROUND;
    return x * NEVH__E(number)((NEVH__E(bits)(part) + 1023) << 52) *
           NEVH__E(number)((NEVH__E(bits)(rest) + 1023) << 52);
}

/* Between -most and most; what is not a number remains. */
NEVH__INLINE NEVH__NUMBER NEVH__E(within)(NEVH__NUMBER x, double most) {
    x = NEVH__E(choose)(NEVH__E(less)(NEVH__E(all)(most), x),
                        NEVH__E(all)(most), x);
    return NEVH__E(choose)(NEVH__E(less)(x, NEVH__E(all)(-most)),
                           NEVH__E(all)(-most), x);
}

#ifndef NEVH__NO_CIRCLE
/* Sine, cosine, tangent. */

/* x minus so many quarters of a turn, |x| < NEVH__ONE_FAR.  Where a difference is smaller
   than what is taken from it, it is exact. */
NEVH__INLINE NEVH__PAIR NEVH__E(turned)(NEVH__NUMBER x, NEVH__BITS *quarters) {
    NEVH__NUMBER turns = x * (1 / NEVH__ONE_QUARTER[4]) + NEVH__ONE_ROUND;
    *quarters = NEVH__E(bits)(turns);
    turns = turns - NEVH__ONE_ROUND;
    NEVH__NUMBER near = x - turns * NEVH__ONE_QUARTER[0];
    NEVH__PAIR a = NEVH__E(quick)(near, -(turns * NEVH__ONE_QUARTER[1]));
    NEVH__PAIR b = NEVH__E(quick)(a.hi, -(turns * NEVH__ONE_QUARTER[2]));
    b.lo = (a.lo + b.lo) - turns * NEVH__ONE_QUARTER[3];
    return b;
}

NEVH__INLINE NEVH__PAIR NEVH__E(sine_near)(NEVH__PAIR x) {
    NEVH__NUMBER z = x.hi * x.hi;
    NEVH__NUMBER more = x.hi * z * NEVH__ONE_POLYNOMIAL(nevh__one_sine, z);
    return NEVH__E(quick)(x.hi, more + (x.lo - 0.5 * z * x.lo));
}

NEVH__INLINE NEVH__PAIR NEVH__E(cosine_near)(NEVH__PAIR x) {
    NEVH__NUMBER z = x.hi * x.hi, half = 0.5 * z, first = 1 - half;
    NEVH__NUMBER more = z * z * NEVH__ONE_POLYNOMIAL(nevh__one_cosine, z);
    return NEVH__E(quick)(first, ((1 - first) - half) + (more - x.hi * x.lo));
}

/* The sine of x and so many quarters of a turn: that of x or its cosine, by one
   polynomial. */
NEVH__INLINE NEVH__NUMBER NEVH__E(circle)(NEVH__PAIR x, NEVH__BITS quarters) {
    NEVH__BITS odd = -(quarters & 1);
    NEVH__NUMBER z = x.hi * x.hi, half = 0.5 * z, first = 1 - half;
    NEVH__NUMBER hi = NEVH__E(choose)(odd, first, x.hi);
    NEVH__NUMBER lo = NEVH__E(choose)(odd, ((1 - first) - half) - x.hi * x.lo,
                                      x.lo - half * x.lo);
    NEVH__NUMBER scale = z * NEVH__E(choose)(odd, z, x.hi), c[7], z2 = z * z;
    NEVH__UNROLLED
    for (size_t i = 0; i < 7; i++)
        c[i] = NEVH__E(choose)(odd, NEVH__E(all)(nevh__one_cosine[i]),
                               NEVH__E(all)(nevh__one_sine[i]));
    NEVH__NUMBER sum = ((c[0] + z * c[1]) + z2 * (c[2] + z * c[3])) +
                       z2 * z2 * ((c[4] + z * c[5]) + z2 * c[6]);
    NEVH__NUMBER y = hi + (scale * sum + lo);
    return NEVH__E(number)(NEVH__E(bits)(y) ^ ((quarters & 2) << 62));
}

NEVH__MAIN NEVH__NUMBER NEVH__E(sin)(NEVH__NUMBER x) {
    NEVH__BITS quarters;
    NEVH__PAIR near = NEVH__E(turned)(x, &quarters);
    NEVH__NUMBER y = NEVH__E(circle)(near, quarters), size = NEVH__E(size)(x);
    y = NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(NEVH__ONE_LITTLE)), x,
                        y);
    return NEVH__E(mend)(NEVH__E(less)(size, NEVH__E(all)(NEVH__ONE_FAR)), y, x,
                         nevh__one_sin_far);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(cos)(NEVH__NUMBER x) {
    NEVH__BITS quarters;
    NEVH__PAIR near = NEVH__E(turned)(x, &quarters);
    NEVH__NUMBER y = NEVH__E(circle)(near, quarters + 1);
    return NEVH__E(mend)(
        NEVH__E(less)(NEVH__E(size)(x), NEVH__E(all)(NEVH__ONE_FAR)), y, x,
        nevh__one_cos_far);
}

NEVH__INLINE NEVH__NUMBER NEVH__E(tan_near)(NEVH__PAIR near,
                                            NEVH__BITS quarters) {
    NEVH__PAIR sine = NEVH__E(sine_near)(near), a, b;
    NEVH__PAIR cosine = NEVH__E(cosine_near)(near);
    NEVH__PAIR z = NEVH__E(product)(near.hi, near.hi);
    NEVH__NUMBER lost = NEVH__E(product)(near.hi, z.hi).lo + near.hi * z.lo;
    sine.lo = sine.lo + lost * nevh__one_sine[0];
    cosine.lo = cosine.lo - 0.5 * z.lo;
    NEVH__BITS odd = -(quarters & 1);
    a.hi = NEVH__E(choose)(odd, cosine.hi, sine.hi);
    a.lo = NEVH__E(choose)(odd, cosine.lo, sine.lo);
    b.hi = NEVH__E(choose)(odd, -sine.hi, cosine.hi);
    b.lo = NEVH__E(choose)(odd, -sine.lo, cosine.lo);
    return NEVH__E(quotient)(a, b);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(tan)(NEVH__NUMBER x) {
    NEVH__BITS quarters;
    NEVH__PAIR near = NEVH__E(turned)(x, &quarters);
    NEVH__NUMBER y = NEVH__E(tan_near)(near, quarters);
    NEVH__NUMBER size = NEVH__E(size)(x);
    y = NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(NEVH__ONE_LITTLE)), x,
                        y);
    return NEVH__E(mend)(NEVH__E(less)(size, NEVH__E(all)(NEVH__ONE_FAR)), y, x,
                         nevh__one_tan_far);
}
#endif

#ifndef NEVH__NO_POWERS
/* Exponentials, logarithms and powers. */

/* exp(x.hi + x.lo) over 2^power, |x.hi| < 2000. */
NEVH__INLINE NEVH__PAIR NEVH__E(exp_near)(NEVH__PAIR x, NEVH__NUMBER *power) {
    NEVH__NUMBER twos =
        (x.hi * (1 / NEVH__ONE_LN2[2]) + NEVH__ONE_ROUND) - NEVH__ONE_ROUND;
    NEVH__PAIR near = NEVH__E(sum)(x.hi - twos * NEVH__ONE_LN2[0],
                                   x.lo - twos * NEVH__ONE_LN2[1]);
    NEVH__NUMBER r = near.hi;
    NEVH__NUMBER more = r * r * NEVH__ONE_POLYNOMIAL(nevh__one_exponential, r);
    NEVH__PAIR rest = NEVH__E(quick)(r, more + (near.lo + near.lo * r));
    NEVH__PAIR y = NEVH__E(quick)(NEVH__E(all)(1), rest.hi);
    *power = twos;
    return NEVH__E(quick)(y.hi, y.lo + rest.lo);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(exp)(NEVH__NUMBER x) {
    NEVH__NUMBER power;
    NEVH__PAIR in = {NEVH__E(within)(x, NEVH__ONE_STEEP), NEVH__E(all)(0)};
    NEVH__PAIR y = NEVH__E(exp_near)(in, &power);
    return NEVH__E(scaled)(y.hi, power);
}

/* x > 0 over a power of two, from sqrt(1/2) to sqrt(2). */
NEVH__INLINE NEVH__NUMBER NEVH__E(mantissa)(NEVH__NUMBER x,
                                            NEVH__NUMBER *power) {
    NEVH__BITS tiny = NEVH__E(less)(x, NEVH__E(all)(0x1p-1022));
    x = NEVH__E(choose)(tiny, x * 0x1p54, x);
    NEVH__BITS bits = NEVH__E(bits)(x) + (NEVH__ONE_BITS - NEVH__ONE_ROOT);
    NEVH__NUMBER twos =
        NEVH__E(number)((bits >> 52) | NEVH__ONE_SHIFTED) - (0x1p52 + 1023);
    *power = NEVH__E(choose)(tiny, twos - 54, twos);
    return NEVH__E(number)((bits & NEVH__ONE_FRACTION) + NEVH__ONE_ROOT);
}

/* log(m 2^power), to 2^-65 of it. */
NEVH__INLINE NEVH__PAIR NEVH__E(log_near)(NEVH__NUMBER m, NEVH__NUMBER power) {
    NEVH__NUMBER f = m - 1;
    NEVH__PAIR sum = NEVH__E(quick)(NEVH__E(all)(2), f);
    NEVH__NUMBER s = f / sum.hi;
    NEVH__PAIR p = NEVH__E(product)(s, sum.hi);
    NEVH__NUMBER rest = (((f - p.hi) - p.lo) - s * sum.lo) / sum.hi;
    NEVH__PAIR z = NEVH__E(product)(s, s);
    z.lo = z.lo + 2 * s * rest;
    NEVH__PAIR c = NEVH__E(quick)(
        NEVH__E(all)(NEVH__ONE_TWO_THIRDS[0]),
        z.hi * NEVH__ONE_POLYNOMIAL(nevh__one_logarithm_rest, z.hi));
    c.lo = c.lo + NEVH__ONE_TWO_THIRDS[1];
    NEVH__PAIR u = NEVH__E(product)(z.hi, c.hi);
    u.lo = u.lo + (z.hi * c.lo + z.lo * c.hi);
    NEVH__PAIR w = NEVH__E(product)(s, u.hi);
    w.lo = w.lo + (s * u.lo + rest * u.hi);
    NEVH__PAIR y = NEVH__E(quick)(2 * s, w.hi);
    y.lo = y.lo + (2 * rest + w.lo);
    NEVH__PAIR all = NEVH__E(sum)(power * NEVH__ONE_LN2[0], y.hi);
    return NEVH__E(quick)(all.hi, all.lo + (y.lo + power * NEVH__ONE_LN2[1]));
}

/* Logarithms of 0, of infinity and of negative numbers. */
NEVH__INLINE NEVH__NUMBER NEVH__E(log_edges)(NEVH__NUMBER x, NEVH__NUMBER y) {
    NEVH__NUMBER none = NEVH__E(all)(0);
    y = NEVH__E(choose)(NEVH__E(less)(x, NEVH__E(all)(INFINITY)), y, x);
    y = NEVH__E(choose)(
        NEVH__E(less)(none, NEVH__E(size)(x)), y,
        NEVH__E(choose)(NEVH__E(less)(-NEVH__E(size)(x), NEVH__E(all)(1)),
                        NEVH__E(all)(-INFINITY), x));
    return NEVH__E(choose)(NEVH__E(less)(x, none), NEVH__E(all)(NAN), y);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(log)(NEVH__NUMBER x) {
    NEVH__NUMBER power, f = NEVH__E(mantissa)(x, &power) - 1;
    NEVH__NUMBER s = f / (2 + f), z = s * s, half = 0.5 * f * f;
    NEVH__NUMBER more = z * NEVH__ONE_POLYNOMIAL(nevh__one_logarithm, z);
    NEVH__NUMBER y =
        power * NEVH__ONE_LN2[0] -
        ((half - (s * (half + more) + power * NEVH__ONE_LN2[1])) - f);
    return NEVH__E(log_edges)(x, y);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(log10)(NEVH__NUMBER x) {
    NEVH__NUMBER power, m = NEVH__E(mantissa)(x, &power);
    NEVH__PAIR y = NEVH__E(log_near)(m, power);
    NEVH__PAIR p = NEVH__E(product)(y.hi, NEVH__E(all)(NEVH__ONE_PER_LN10[0]));
    return NEVH__E(log_edges)(x,
                              p.hi + (p.lo + (y.lo * NEVH__ONE_PER_LN10[0] +
                                              y.hi * NEVH__ONE_PER_LN10[1])));
}

/* The logarithm of a pair whose first number is from 0.5 on. */
NEVH__INLINE NEVH__PAIR NEVH__E(log_of)(NEVH__PAIR x) {
    NEVH__NUMBER power, m = NEVH__E(mantissa)(x.hi, &power);
    NEVH__PAIR y = NEVH__E(log_near)(m, power);
    return NEVH__E(quick)(y.hi, y.lo + x.lo / x.hi);
}

/* x^y of positive numbers; beyond 2^80 all y are alike. */
NEVH__INLINE NEVH__NUMBER NEVH__E(pow_near)(NEVH__NUMBER x, NEVH__NUMBER y) {
    NEVH__NUMBER power, m = NEVH__E(mantissa)(x, &power);
    NEVH__PAIR l = NEVH__E(log_near)(m, power);
    y = NEVH__E(within)(y, 0x1p80);
    NEVH__PAIR p = NEVH__E(product)(l.hi, y);
    p.lo = p.lo + l.lo * y;
    p = NEVH__E(quick)(p.hi, p.lo);
    NEVH__BITS fair =
        NEVH__E(less)(NEVH__E(size)(p.hi), NEVH__E(all)(NEVH__ONE_STEEP));
    p.hi = NEVH__E(within)(p.hi, NEVH__ONE_STEEP);
    p.lo = NEVH__E(choose)(fair, p.lo, NEVH__E(all)(0));
    p = NEVH__E(exp_near)(p, &power);
    return NEVH__E(scaled)(p.hi, power);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(pow)(NEVH__NUMBER x, NEVH__NUMBER y) {
    NEVH__NUMBER infinite = NEVH__E(all)(INFINITY);
    NEVH__BITS plain = NEVH__E(less)(NEVH__E(all)(0), x) &
                       NEVH__E(less)(x, infinite) &
                       NEVH__E(less)(NEVH__E(size)(y), infinite);
    return NEVH__E(mend_two)(plain, NEVH__E(pow_near)(x, y), x, y,
                             nevh__one_pow_edge);
}
#endif

#ifndef NEVH__NO_HYPERBOLIC
/* Hyperbolic functions. */

/* The sine of |x| < 1. */
NEVH__INLINE NEVH__PAIR NEVH__E(sinh_near)(NEVH__NUMBER x) {
    NEVH__NUMBER z = x * x;
    return NEVH__E(quick)(x,
                          x * z * NEVH__ONE_POLYNOMIAL(nevh__one_sinh_rest, z));
}

NEVH__INLINE NEVH__PAIR NEVH__E(cosh_near)(NEVH__NUMBER x) {
    NEVH__NUMBER z = x * x, half = 0.5 * z, first = 1 + half;
    NEVH__NUMBER more = z * z * NEVH__ONE_POLYNOMIAL(nevh__one_cosh_rest, z);
    return NEVH__E(quick)(first, ((1 - first) + half) + more);
}

/* Half of exp(x), x > 0. */
NEVH__INLINE NEVH__PAIR NEVH__E(half_exp)(NEVH__NUMBER x) {
    NEVH__NUMBER power;
    NEVH__PAIR in = {NEVH__E(within)(x, NEVH__ONE_STEEP), NEVH__E(all)(0)};
    NEVH__PAIR y = NEVH__E(exp_near)(in, &power);
    return (NEVH__PAIR){NEVH__E(scaled)(y.hi, power - 1),
                        NEVH__E(scaled)(y.lo, power - 1)};
}

/* e + other, which is small beside it. */
NEVH__INLINE NEVH__NUMBER NEVH__E(beside)(NEVH__PAIR e, NEVH__NUMBER other) {
    NEVH__NUMBER y = e.hi + other, rest = (e.hi - y) + other;
    NEVH__BITS finite = NEVH__E(less)(y, NEVH__E(all)(INFINITY));
    return NEVH__E(choose)(finite, y + (rest + e.lo), y);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(sinh)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x);
    NEVH__PAIR e = NEVH__E(half_exp)(size);
    NEVH__NUMBER y = NEVH__E(beside)(e, -(0.25 / e.hi));
    NEVH__BITS near = NEVH__E(less)(size, NEVH__E(all)(1));
    return NEVH__E(choose)(near, NEVH__E(sinh_near)(x).hi,
                           NEVH__E(signed)(y, x));
}

NEVH__MAIN NEVH__NUMBER NEVH__E(cosh)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x);
    NEVH__PAIR e = NEVH__E(half_exp)(size);
    NEVH__BITS near = NEVH__E(less)(size, NEVH__E(all)(1));
    return NEVH__E(choose)(near, NEVH__E(cosh_near)(x).hi,
                           NEVH__E(beside)(e, 0.25 / e.hi));
}

NEVH__MAIN NEVH__NUMBER NEVH__E(tanh)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x), power;
    NEVH__PAIR in = {2 * NEVH__E(within)(size, 20), NEVH__E(all)(0)};
    NEVH__PAIR e = NEVH__E(exp_near)(in, &power);
    NEVH__PAIR below =
        NEVH__E(sum)(NEVH__E(scaled)(e.hi, power), NEVH__E(all)(1));
    below.lo = below.lo + NEVH__E(scaled)(e.lo, power);
    NEVH__PAIR two = {NEVH__E(all)(2), NEVH__E(all)(0)};
    NEVH__NUMBER far = 1 - NEVH__E(quotient)(two, below);
    NEVH__NUMBER near =
        NEVH__E(quotient)(NEVH__E(sinh_near)(x), NEVH__E(cosh_near)(x));
    near = NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(NEVH__ONE_LITTLE)),
                           x, near);
    return NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(1)), near,
                           NEVH__E(signed)(far, x));
}

/* asinh(x) is log(1 + d), d = x + x^2/(1 + sqrt(1 + x^2)). */
NEVH__MAIN NEVH__NUMBER NEVH__E(asinh)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x), power;
    NEVH__NUMBER a = NEVH__E(within)(size, 0x1p30);
    NEVH__PAIR square = NEVH__E(product)(a, a);
    NEVH__PAIR one = NEVH__E(sum)(square.hi, NEVH__E(all)(1));
    one.lo = one.lo + square.lo;
    NEVH__PAIR root = NEVH__E(root_of)(one);
    NEVH__PAIR below = NEVH__E(sum)(root.hi, NEVH__E(all)(1));
    below.lo = below.lo + root.lo;
    NEVH__PAIR d = NEVH__E(sum)(a, NEVH__E(quotient)(square, below));
    NEVH__PAIR all = NEVH__E(sum)(NEVH__E(all)(1), d.hi);
    all = NEVH__E(quick)(all.hi, all.lo + d.lo);
    NEVH__NUMBER y = NEVH__E(log_of)(all).hi;
    NEVH__NUMBER m = NEVH__E(mantissa)(size, &power);
    NEVH__NUMBER far = NEVH__E(log_near)(m, power + 1).hi;
    y = NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(0x1p30)), y, far);
    y = NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(INFINITY)), y, size);
    y = NEVH__E(signed)(y, x);
    return NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(NEVH__ONE_LITTLE)),
                           x, y);
}

/* acosh(1 + u) is log(1 + d), d = u + sqrt(u (2 + u)). */
NEVH__MAIN NEVH__NUMBER NEVH__E(acosh)(NEVH__NUMBER x) {
    NEVH__NUMBER u = NEVH__E(within)(x, 0x1p30) - 1, power;
    NEVH__PAIR square = NEVH__E(product)(u, u);
    NEVH__PAIR all = NEVH__E(sum)(square.hi, 2 * u);
    all.lo = all.lo + square.lo;
    NEVH__PAIR root = NEVH__E(root_of)(all);
    root.lo = NEVH__E(choose)(NEVH__E(less)(NEVH__E(all)(0), u), root.lo,
                              NEVH__E(all)(0));
    NEVH__PAIR d = NEVH__E(sum)(u, root.hi);
    d.lo = d.lo + root.lo;
    all = NEVH__E(sum)(NEVH__E(all)(1), d.hi);
    all = NEVH__E(quick)(all.hi, all.lo + d.lo);
    NEVH__NUMBER y = NEVH__E(log_of)(all).hi;
    NEVH__NUMBER m = NEVH__E(mantissa)(x, &power);
    NEVH__NUMBER far = NEVH__E(log_near)(m, power + 1).hi;
    y = NEVH__E(choose)(NEVH__E(less)(x, NEVH__E(all)(0x1p30)), y, far);
    y = NEVH__E(choose)(NEVH__E(less)(x, NEVH__E(all)(INFINITY)), y, x);
    return NEVH__E(choose)(NEVH__E(less)(x, NEVH__E(all)(1)), NEVH__E(all)(NAN),
                           y);
}

/* atanh(x) is log(1 + 2x/(1 - x))/2. */
NEVH__MAIN NEVH__NUMBER NEVH__E(atanh)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x), one = NEVH__E(all)(1);
    NEVH__PAIR below = NEVH__E(quick)(one, -size);
    NEVH__NUMBER q = 2 * size / below.hi;
    NEVH__PAIR p = NEVH__E(product)(q, below.hi);
    NEVH__NUMBER rest = (((2 * size - p.hi) - p.lo) - q * below.lo) / below.hi;
    NEVH__PAIR all = NEVH__E(sum)(one, q);
    all = NEVH__E(quick)(all.hi, all.lo + rest);
    NEVH__NUMBER y = NEVH__E(signed)(0.5 * NEVH__E(log_of)(all).hi, x);
    y = NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(NEVH__ONE_LITTLE)), x,
                        y);
    y = NEVH__E(choose)(NEVH__E(less)(size, one), y, x / (1 - size));
    return NEVH__E(choose)(NEVH__E(less)(one, size), NEVH__E(all)(NAN), y);
}
#endif

#ifndef NEVH__NO_ARCS
/* Inverse circular functions. */

/* c quarters of a turn less x, c = 1 or 2. */
NEVH__INLINE NEVH__NUMBER NEVH__E(less_than_quarters)(double c, NEVH__PAIR x) {
    NEVH__PAIR y =
        NEVH__E(quick)(NEVH__E(all)(c * NEVH__ONE_QUARTER[4]), -x.hi);
    return y.hi + (y.lo + (c * NEVH__ONE_QUARTER[5] - x.lo));
}

/* atan(x.hi + x.lo), x.hi >= 0: that of the nearest of 0, 1/2, 1, 3/2 and infinity,
   and of the angle in between. */
NEVH__INLINE NEVH__PAIR NEVH__E(atan_near)(NEVH__PAIR x) {
    NEVH__NUMBER a = x.hi, up = a, below = NEVH__E(all)(1);
    NEVH__NUMBER hi = NEVH__E(all)(0), lo = hi;
    NEVH__UNROLLED
    for (size_t i = 0; i < 3; i++) {
        const double *c = nevh__one_arc[i];
        NEVH__BITS above = ~NEVH__E(less)(a, NEVH__E(all)(c[0]));
        up = NEVH__E(choose)(above, a * c[2] - c[3], up);
        below = NEVH__E(choose)(above, c[2] + a * c[3], below);
        hi = NEVH__E(choose)(above, NEVH__E(all)(c[4]), hi);
        lo = NEVH__E(choose)(above, NEVH__E(all)(c[5]), lo);
    }
    NEVH__BITS far = ~NEVH__E(less)(a, NEVH__E(all)(nevh__one_arc[3][0]));
    up = NEVH__E(choose)(far, NEVH__E(all)(-1), up);
    below = NEVH__E(choose)(far, a, below);
    hi = NEVH__E(choose)(far, NEVH__E(all)(nevh__one_arc[3][4]), hi);
    lo = NEVH__E(choose)(far, NEVH__E(all)(nevh__one_arc[3][5]), lo);
    NEVH__NUMBER t = up / below, z = t * t;
    NEVH__NUMBER more = t * z * NEVH__ONE_POLYNOMIAL(nevh__one_arctangent, z);
    NEVH__PAIR y = NEVH__E(sum)(hi, t);
    return NEVH__E(quick)(y.hi, y.lo + (more + (lo + x.lo / (1 + a * a))));
}

NEVH__MAIN NEVH__NUMBER NEVH__E(atan)(NEVH__NUMBER x) {
    NEVH__PAIR size = {NEVH__E(size)(x), NEVH__E(all)(0)};
    return NEVH__E(signed)(NEVH__E(atan_near)(size).hi, x);
}

/* Positive numbers whose quotient is from 2^-100 to 2^100. */
NEVH__INLINE NEVH__NUMBER NEVH__E(atan2_near)(NEVH__NUMBER y, NEVH__NUMBER x,
                                              NEVH__BITS left) {
    NEVH__PAIR q = {y / x, y};
    NEVH__PAIR p = NEVH__E(product)(q.hi, x);
    q.lo = ((y - p.hi) - p.lo) / x;
    NEVH__PAIR a = NEVH__E(atan_near)(q);
    return NEVH__E(choose)(left, NEVH__E(less_than_quarters)(2, a), a.hi);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(atan2)(NEVH__NUMBER y, NEVH__NUMBER x) {
    NEVH__NUMBER a = NEVH__E(size)(y), b = NEVH__E(size)(x);
    NEVH__NUMBER most = NEVH__E(all)(0x1p450), least = NEVH__E(all)(0x1p-450);
    NEVH__NUMBER wide = NEVH__E(all)(0x1p100);
    NEVH__BITS plain = NEVH__E(less)(a, most) & NEVH__E(less)(b, most) &
                       NEVH__E(less)(least, a) & NEVH__E(less)(least, b) &
                       NEVH__E(less)(a, b * wide) & NEVH__E(less)(b, a * wide);
    NEVH__BITS left = NEVH__E(less)(x, NEVH__E(all)(0));
    return NEVH__E(mend_two)(
        plain, NEVH__E(signed)(NEVH__E(atan2_near)(a, b, left), y), y, x,
        nevh__one_atan2_edge);
}

/* asin(s) = s + more of s = x, or of s = sqrt((1 - |x|)/2), of which pi/2 - 2 asin(s)
   is asin(|x|). */
NEVH__INLINE NEVH__PAIR NEVH__E(asin_near)(NEVH__NUMBER size,
                                           NEVH__BITS inner) {
    NEVH__NUMBER w = NEVH__E(choose)(inner, size * size, 0.5 * (1 - size));
    NEVH__PAIR root = NEVH__E(root_of)((NEVH__PAIR){w, NEVH__E(all)(0)});
    NEVH__BITS some = NEVH__E(less)(NEVH__E(all)(0), w) & ~inner;
    NEVH__NUMBER s = NEVH__E(choose)(inner, size, root.hi);
    NEVH__NUMBER rest = NEVH__E(choose)(some, root.lo, NEVH__E(all)(0));
    NEVH__NUMBER more = s * (w * NEVH__ONE_POLYNOMIAL(nevh__one_arcsine, w));
    return NEVH__E(quick)(s, rest + more);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(asin)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x);
    NEVH__BITS inner = NEVH__E(less)(size, NEVH__E(all)(0.5));
    NEVH__PAIR a = NEVH__E(asin_near)(size, inner);
    NEVH__PAIR twice = {2 * a.hi, 2 * a.lo};
    NEVH__NUMBER outer = NEVH__E(less_than_quarters)(1, twice);
    return NEVH__E(signed)(NEVH__E(choose)(inner, a.hi, outer), x);
}

NEVH__MAIN NEVH__NUMBER NEVH__E(acos)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x);
    NEVH__BITS inner = NEVH__E(less)(size, NEVH__E(all)(0.5));
    NEVH__PAIR a = NEVH__E(asin_near)(size, inner);
    NEVH__PAIR twice = {2 * a.hi, 2 * a.lo};
    NEVH__PAIR turned = {NEVH__E(signed)(a.hi, x), NEVH__E(signed)(a.lo, x)};
    NEVH__BITS left = NEVH__E(less)(x, NEVH__E(all)(0));
    NEVH__NUMBER outer =
        NEVH__E(choose)(left, NEVH__E(less_than_quarters)(2, twice), twice.hi);
    return NEVH__E(choose)(inner, NEVH__E(less_than_quarters)(1, turned),
                           outer);
}
#endif

#ifndef NEVH__NO_ROOTS
/* Roots. */

/* The root of m = x over 8^k, which is from 1 to 8, by Newton's method; the last
   step is by a root that is short enough for its square to be exact. */
NEVH__MAIN NEVH__NUMBER NEVH__E(cbrt)(NEVH__NUMBER x) {
    NEVH__NUMBER size = NEVH__E(size)(x), none = NEVH__E(all)(0);
    NEVH__BITS tiny = NEVH__E(less)(size, NEVH__E(all)(0x1p-1022));
    NEVH__NUMBER a = NEVH__E(choose)(tiny, size * 0x1p54, size);
    NEVH__BITS bits = NEVH__E(bits)(a);
    NEVH__NUMBER twos =
        NEVH__E(number)((bits >> 52) | NEVH__ONE_SHIFTED) - (0x1p52 + 1023);
    NEVH__NUMBER third = (twos - 1) * (1 / 3.0) + NEVH__ONE_ROUND;
    third = third - NEVH__ONE_ROUND;
    NEVH__NUMBER m =
        NEVH__E(number)((bits & NEVH__ONE_FRACTION) | NEVH__ONE_BITS);
    m = NEVH__E(scaled)(m, twos - 3 * third);
    NEVH__NUMBER t = NEVH__ONE_POLYNOMIAL(nevh__one_cube_root, m);
    for (int i = 0; i < 2; i++)
        t = t - (t * t * t - m) / (3 * (t * t));
    t = NEVH__E(number)((NEVH__E(bits)(t) + NEVH__ONE_HALF_SHORT) &
                        NEVH__ONE_SHORT);
    NEVH__NUMBER r = m / (t * t);
    t = t + t * ((r - t) / (t + t + r));
    t = NEVH__E(scaled)(t, NEVH__E(choose)(tiny, third - 18, third));
    t = NEVH__E(choose)(NEVH__E(less)(size, NEVH__E(all)(INFINITY)), t, size);
    t = NEVH__E(choose)(NEVH__E(less)(none, size), t, size);
    return NEVH__E(signed)(t, x);
}

NEVH__INLINE NEVH__NUMBER NEVH__E(hypot_near)(NEVH__NUMBER x, NEVH__NUMBER y) {
    NEVH__PAIR a = NEVH__E(product)(x, x), b = NEVH__E(product)(y, y);
    NEVH__PAIR all = NEVH__E(sum)(a.hi, b.hi);
    all.lo = all.lo + (a.lo + b.lo);
    NEVH__PAIR root = NEVH__E(root_of)(all);
    return root.hi + root.lo;
}

NEVH__MAIN NEVH__NUMBER NEVH__E(hypot)(NEVH__NUMBER x, NEVH__NUMBER y) {
    NEVH__NUMBER sum = NEVH__E(size)(x) + NEVH__E(size)(y);
    NEVH__BITS plain = NEVH__E(less)(sum, NEVH__E(all)(0x1p450)) &
                       NEVH__E(less)(NEVH__E(all)(0x1p-400), sum);
    return NEVH__E(mend_two)(plain, NEVH__E(hypot_near)(x, y), x, y,
                             nevh__one_hypot_edge);
}
#endif

#ifndef NEVH__FOR_READERS
#undef NEVH__ONE_POLYNOMIAL
#undef NEVH__NUMBER
#undef NEVH__BITS
#undef NEVH__PAIR
#undef NEVH__E
#endif

#endif
