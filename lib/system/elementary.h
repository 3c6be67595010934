/* nevh: elementary functions that give the same bits on every machine.
   SPDX-License-Identifier: GPL-3.0-or-later

   Additions, products, quotients and square roots of IEEE doubles in one order,
   without fma and tables, rounded to nearest; no contraction.  One text serves the
   tape, number by number and in loops that become vector code, and compiled
   steps, which define REAL and so on for numbers and for vectors of them:

   REAL, BITS     a number, and its 64 bits as an unsigned integer
   BITS_OF(x), REAL_OF(b)
   PICK(c, x, y)  x where c, else y; both are taken
   EVERY(c)       a constant
   ONE(f)         the name of a function
   FAR(x, r, rest, turns)   what turn() returns where x is not small

   Arguments are reduced by sums of constants [W. J. Cody, W. Waite, Software
   Manual for the Elementary Functions (1980)], large ones by the digits of 2/pi
   [M. Payne, R. Hanek, SIGNUM Newsletter 18 (1983) 19-24]; results of which the
   leading part is a sum of two doubles [T. J. Dekker, Numer. Math. 18 (1971)
   224-242] are within 0.6 ulp, the others within 0.9. */
#ifndef NEVH_ELEMENTARY_H
#define NEVH_ELEMENTARY_H

#define TO_INTEGER 0x1.8p52 /* x + TO_INTEGER ends in the nearest integer */
#define ONE_BITS   0x3ff0000000000000u

NEVH__INLINE REAL ONE(fabs)(REAL x) {
    return REAL_OF(BITS_OF(x) & 0x7fffffffffffffffu);
}

/* x >= 0 with the sign of another number. */
NEVH__INLINE REAL ONE(signed)(REAL x, REAL like) {
    return REAL_OF(BITS_OF(x) | (BITS_OF(like) & 0x8000000000000000u));
}

/* The first 26 bits. */
NEVH__INLINE REAL ONE(head)(REAL x) {
    return REAL_OF(BITS_OF(x) & 0xfffffffff8000000u);
}

/* a b and its rounding error */
NEVH__INLINE REAL ONE(product)(REAL a, REAL b, REAL *low) {
    REAL p = a * b, ah = ONE(head)(a), bh = ONE(head)(b);
    REAL al = a - ah, bl = b - bh;
    *low = (((ah * bh - p) + ah * bl) + al * bh) + al * bl;
    return p;
}

/* a + b, |a| >= |b|, and its rounding error */
NEVH__INLINE REAL ONE(ordered_sum)(REAL a, REAL b, REAL *low) {
    REAL s = a + b;
    *low = (a - s) + b;
    return s;
}

/* The same, whichever is larger. */
NEVH__INLINE REAL ONE(sum)(REAL a, REAL b, REAL *low) {
    REAL s = a + b, part = s - a;
    *low = (a - (s - part)) + (b - part);
    return s;
}

/* (n + n_low)/(d + d_low) */
NEVH__INLINE REAL ONE(quotient)(REAL n, REAL n_low, REAL d, REAL d_low,
                                REAL *low) {
    REAL q = n / d, rest, p = ONE(product)(q, d, &rest);
    rest = ((((n - p) - rest) + n_low) - q * d_low) * (1 / d);
    *low = PICK(ONE(fabs)(q) < 0x1p-900, EVERY(0.0), rest);
    return q;
}

/* The root of x + x_low >= 0; x is not tiny. */
NEVH__INLINE REAL ONE(root)(REAL x, REAL x_low, REAL *low) {
    REAL r = ONE(sqrt)(x), rest, p = ONE(product)(r, r, &rest);
    REAL half = 0.5 / PICK(r > 0, r, EVERY(1.0));
    *low = (((x - p) - rest) + x_low) * half;
    return r;
}

/* y 2^n, n an integer up to about 2000 */
NEVH__INLINE REAL ONE(scaled)(REAL y, REAL n) {
    REAL half = n * 0.5 + TO_INTEGER;
    REAL other = (n - (half - TO_INTEGER)) + TO_INTEGER;
    return y * REAL_OF((BITS_OF(half) << 52) + ONE_BITS) *
           REAL_OF((BITS_OF(other) << 52) + ONE_BITS);
}

/* x >= 0 less the nearest multiple of pi/2.
   returns  that multiple, in the last bits; of r + rest in [-pi/4, pi/4] */
NEVH__INLINE BITS ONE(turn)(REAL x, REAL *r, REAL *rest) {
    REAL n = x * 0x1.45f306dc9c883p-1 + TO_INTEGER;
    BITS turns = BITS_OF(n);
    n = n - TO_INTEGER;
    REAL t = x - n * 0x1.921fb544p0, w = n * 0x1.0b4611a6p-34;
    REAL s = t - w, part = t - s;
    *r = s;
    *rest = ((t - (s + part)) + (part - w)) - n * 0x1.3198a2e037073p-69;
    FAR(x, r, rest, &turns);
    return turns;
}

/* (sin r - r)/r^3 and (cos r - 1 + r^2/2)/r^4, z = r^2 */
NEVH__INLINE REAL ONE(sine_rest)(REAL z, REAL z2) {
    return (-0x1.5555555555548p-3 + 0x1.111111110f7d0p-7 * z) +
           z2 * ((-0x1.a01a019bfdeefp-13 + 0x1.71de3567d4997p-19 * z) +
                 z2 * (-0x1.ae5e5a932a720p-26 + 0x1.5d8fd24497240p-33 * z));
}

NEVH__INLINE REAL ONE(cosine_rest)(REAL z, REAL z2) {
    return (0x1.555555555554bp-5 - 0x1.6c16c16c14f92p-10 * z) +
           z2 * ((0x1.a01a019c84559p-16 - 0x1.27e4f7eac8c43p-22 * z) +
                 z2 * (0x1.1ee9d7b76534cp-29 - 0x1.8fa49b3b1b7b1p-37 * z));
}

/* The sine, and the cosine. */
NEVH__INLINE REAL ONE(sincos)(REAL x, REAL *cosine) {
    REAL r, rest;
    BITS turns = ONE(turn)(ONE(fabs)(x), &r, &rest);
    REAL z = r * r, z2 = z * z, half = 0.5 * z, w = 1 - half;
    REAL s = r + (r * z * ONE(sine_rest)(z, z2) + rest * (w + z2 * 0x1.5p-5));
    REAL c = w + (((1 - w) - half) + (z2 * ONE(cosine_rest)(z, z2) -
                                      rest * (r - r * z * 0x1.5p-3)));
    BITS sign = ((turns & 2) << 62) ^ (BITS_OF(x) & 0x8000000000000000u);
    BITS other = (BITS_OF(s) ^ BITS_OF(c)) & (0 - (turns & 1));
    *cosine = REAL_OF(BITS_OF(c) ^ other ^ (((turns + 1) & 2) << 62));
    return REAL_OF(BITS_OF(s) ^ other ^ sign);
}

NEVH__INLINE REAL ONE(sin)(REAL x) {
    REAL cosine;
    return ONE(sincos)(x, &cosine);
}

NEVH__INLINE REAL ONE(cos)(REAL x) {
    REAL cosine;
    ONE(sincos)(x, &cosine);
    return cosine;
}

NEVH__INLINE REAL ONE(tan)(REAL x) {
    REAL r, rest, z_low, low;
    BITS turns = ONE(turn)(ONE(fabs)(x), &r, &rest);
    REAL z = ONE(product)(r, r, &z_low), z2 = z * z, half = 0.5 * z;
    REAL w = 1 - half;
    REAL s_low = r * z * ONE(sine_rest)(z, z2) + rest * (w + z2 * 0x1.5p-5);
    REAL c_low = (((1 - w) - half) - 0.5 * z_low) +
                 (z2 * ONE(cosine_rest)(z, z2) - rest * (r - r * z * 0x1.5p-3));
    REAL s = ONE(ordered_sum)(r, s_low, &s_low);
    REAL c = ONE(ordered_sum)(w, c_low, &c_low);
    REAL q = ONE(quotient)(PICK((turns & 1) != 0, c, s),
                           PICK((turns & 1) != 0, c_low, s_low),
                           PICK((turns & 1) != 0, s, c),
                           PICK((turns & 1) != 0, s_low, c_low), &low);
    BITS sign = (turns << 63) ^ (BITS_OF(x) & 0x8000000000000000u);
    return REAL_OF(BITS_OF(q + low) ^ sign);
}

/* e^(x + x_low) = 2^n (high + low) */
NEVH__INLINE REAL ONE(exp_parts)(REAL x, REAL x_low, REAL *n, REAL *low) {
    *n = (x * 0x1.71547652b82fep0 + TO_INTEGER) - TO_INTEGER;
    REAL t = x - *n * 0x1.62e42fefa2p-1, w = *n * 0x1.9ef35793c7673p-41;
    REAL r = t - w, rest = ((t - r) - w) + x_low, z = r * r, high = 1 + r;
    REAL p = ((0.5 + 0x1.555555555555cp-3 * r) +
              z * (0x1.555555555555ep-5 + 0x1.111111110ebbbp-7 * r)) +
             z * z *
                 (((0x1.6c16c16c135a2p-10 + 0x1.a01a01b3b80b0p-13 * r) +
                   z * (0x1.a01a01b451721p-16 + 0x1.71ddef9b9c2d6p-19 * r)) +
                  z * z *
                      ((0x1.27e4bf35ee87fp-22 + 0x1.af6cbf0eb6d1ap-26 * r) +
                       z * 0x1.1f9de94c68dc2p-29));
    p = z * p;
    *low = (r - (high - 1)) + (p + rest * (high + p));
    return high;
}

NEVH__INLINE REAL ONE(exp)(REAL x) {
    REAL n, low;
    x = PICK(x < -800, EVERY(-800.0), x);
    x = PICK(x > 800, EVERY(800.0), x);
    REAL high = ONE(exp_parts)(x, EVERY(0.0), &n, &low);
    return ONE(scaled)(high + low, n);
}

/* x > 0 is 2^n times what is returned, which is in [sqrt(1/2), sqrt 2). */
NEVH__INLINE REAL ONE(mantissa)(REAL x, REAL *n) {
    REAL up = PICK(x < 0x1p-1022, EVERY(0x1p54), EVERY(1.0));
    BITS b = BITS_OF(x * up), e = (b + 0x95f619980c433u) >> 52;
    *n = (REAL_OF(e | 0x4330000000000000u) - (0x1p52 + 1023)) -
         PICK(x < 0x1p-1022, EVERY(54.0), EVERY(0.0));
    return REAL_OF(b - (e << 52) + ONE_BITS);
}

/* log(2^n (m + rest)) by s = (m - 1)/(m + 1): 2/3 of 3 s + s^3 + ... */
NEVH__INLINE REAL ONE(log_parts)(REAL m, REAL rest, REAL n, REAL *low) {
    REAL f = m - 1, d = ONE(head)(m + 1), d_low = (f - (d - 2)) + rest;
    REAL by = 1 / (m + 1), s_high = ONE(head)(f * by);
    REAL s_low = (((f - s_high * d) + rest) - s_high * d_low) * by;
    REAL s = s_high + s_low, z = s * s, z2 = z * z, q = s_high * s_high;
    REAL r =
        ((0x1.3333333333330p-1 + 0x1.b6db6db6dc84ep-2 * z) +
         z2 * (0x1.5555555420630p-2 + 0x1.1745d225b3f31p-2 * z)) +
        z2 * z2 *
            ((0x1.d89d14168b723p-3 + 0x1.99b10f9bf4459p-3 * z) +
             z2 * (0x1.66a6a5c1abdb1p-3 + 0x1.704c477c0edbfp-3 * z));
    r = z2 * r + s_low * (s_high + s);
    REAL t = ONE(head)(3 + q + r), t_low = r - ((t - 3) - q);
    REAL u = s_high * t, v = s_low * t + t_low * s;
    REAL p = ONE(head)(u + v), p_low = v - (p - u);
    REAL a = p * 0x1.555555p-1, b = n * 0x1.62e42fefa2p-1, sum = a + b;
    *low = (a - (sum - b)) + ((p * 0x1.5555555555555p-27 +
                               p_low * 0x1.5555555555555p-1) +
                              n * 0x1.9ef35793c7673p-41);
    return sum;
}

/* A logarithm y of x > 0, or what it is elsewhere. */
NEVH__INLINE REAL ONE(log_edges)(REAL x, REAL y) {
    y = PICK(x < INFINITY, y, x);
    y = PICK(x == 0, EVERY(-INFINITY), y);
    return PICK(x < 0, EVERY(NAN), y);
}

NEVH__INLINE REAL ONE(log)(REAL x) {
    REAL n, low, m = ONE(mantissa)(x, &n);
    REAL high = ONE(log_parts)(m, EVERY(0.0), n, &low);
    return ONE(log_edges)(x, high + low);
}

NEVH__INLINE REAL ONE(log10)(REAL x) {
    REAL n, low, m = ONE(mantissa)(x, &n);
    REAL high = ONE(log_parts)(m, EVERY(0.0), n, &low), h = ONE(head)(high);
    low = ((high - h) + low) * 0x1.bcb7b1526e50ep-2 + h * 0x1.49b9438ca9aaep-28;
    return ONE(log_edges)(x, h * 0x1.bcb7b1p-2 + low);
}

/* e^(y log x), y = y_high + y_low, x = 2^n m */
NEVH__INLINE REAL ONE(power)(REAL m, REAL n, REAL y, REAL y_low) {
    REAL low, rest, high = ONE(log_parts)(m, EVERY(0.0), n, &low);
    REAL p = ONE(product)(y, high, &rest);
    p = ONE(ordered_sum)(p, rest + (y * low + y_low * high), &rest);
    rest = PICK(ONE(fabs)(p) > 800, EVERY(0.0), rest);
    p = PICK(p < -800, EVERY(-800.0), p);
    p = PICK(p > 800, EVERY(800.0), p);
    REAL e = ONE(exp_parts)(p, rest, &n, &low);
    return ONE(scaled)(e + low, n);
}

NEVH__INLINE REAL ONE(pow)(REAL x, REAL y) {
    REAL n, ax = ONE(fabs)(x), ay = ONE(fabs)(y);
    REAL m = ONE(mantissa)(ax, &n), most = EVERY(0x1p66);
    REAL z = ONE(power)(m, n, PICK(ay > most, ONE(signed)(most, y), y),
                        EVERY(0.0));
    /* An integer y ends in its last bit. */
    REAL whole = PICK(ay < 0x1p52, ay + 0x1p52, ay);
    REAL off = PICK(ay < 0x1p52, whole - 0x1p52, ay) - ay;
    BITS odd = PICK(ay < 0x1p53, BITS_OF(whole) & 1, BITS_OF(ay) & 0);
    odd = PICK(off == 0, odd, odd & 0);
    z = PICK((ax == 0) | (ax == INFINITY),
             PICK((ax == 0) ^ (y < 0), EVERY(0.0), EVERY(INFINITY)), z);
    z = PICK((x < 0) & (off != 0) & (ax < INFINITY) & (ay < INFINITY), EVERY(NAN),
             z);
    z = REAL_OF(BITS_OF(z) | ((odd << 63) & BITS_OF(x)));
    z = PICK((x != x) | (y != y), x + y, z);
    return PICK((x == 1) | (y == 0), EVERY(1.0), z);
}

NEVH__INLINE REAL ONE(cbrt)(REAL x) {
    REAL n, ax = ONE(fabs)(x), m = ONE(mantissa)(ax, &n);
    REAL z = ONE(power)(m, n, EVERY(0x1.5555555555555p-2),
                        EVERY(0x1.5555555555555p-56));
    return PICK((ax > 0) & (ax < INFINITY), ONE(signed)(z, x), x);
}

NEVH__INLINE REAL ONE(hypot)(REAL x, REAL y) {
    REAL ax = ONE(fabs)(x), ay = ONE(fabs)(y), a_low, b_low;
    REAL a = PICK(ax > ay, ax, ay), b = PICK(ax > ay, ay, ax);
    REAL by = PICK(a > 0x1p500, EVERY(0x1p-600), EVERY(1.0));
    by = PICK(a < 0x1p-400, EVERY(0x1p600), by);
    REAL back = PICK(a > 0x1p500, EVERY(0x1p600), EVERY(1.0));
    back = PICK(a < 0x1p-400, EVERY(0x1p-600), back);
    REAL a2 = ONE(product)(a * by, a * by, &a_low);
    REAL b2 = ONE(product)(b * by, b * by, &b_low);
    REAL z = ONE(sqrt)(a2 + (b2 + (a_low + b_low))) * back;
    z = PICK((x != x) | (y != y), x + y, z);
    return PICK((ax == INFINITY) | (ay == INFINITY), EVERY(INFINITY), z);
}

/* The angle of (x, y), y + y_low and x + x_low >= 0 and not both 0, by that of
   the nearest of 0, 1/2 and 1 to their ratio. */
NEVH__INLINE REAL ONE(angle)(REAL y, REAL y_low, REAL x, REAL x_low, REAL *low) {
    REAL a = PICK(y > x, x, y), a_low = PICK(y > x, x_low, y_low);
    REAL b = PICK(y > x, y, x), b_low = PICK(y > x, y_low, x_low);
    REAL c = PICK(a > 0.25 * b, EVERY(0.5), EVERY(0.0));
    REAL base = PICK(a > 0.25 * b, EVERY(0x1.dac670561bb4fp-2), EVERY(0.0));
    REAL less = PICK(a > 0.25 * b, EVERY(0x1.a2b7f222f65e2p-56), EVERY(0.0));
    c = PICK(a > 0.75 * b, EVERY(1.0), c);
    base = PICK(a > 0.75 * b, EVERY(0x1.921fb54442d18p-1), base);
    less = PICK(a > 0.75 * b, EVERY(0x1.1a62633145c07p-55), less);
    REAL n_low, d_low, q_low;
    REAL n = ONE(sum)(a, -c * b, &n_low), d = ONE(sum)(b, c * a, &d_low);
    n_low = n_low + (a_low - c * b_low);
    d_low = d_low + (b_low + c * a_low);
    REAL q = ONE(quotient)(n, n_low, d, d_low, &q_low);
    REAL z = q * q, z2 = z * z;
    REAL p = ((-0x1.5555555555553p-2 + 0x1.9999999998d92p-3 * z) +
              z2 * (-0x1.24924923eb184p-3 + 0x1.c71c71388db83p-4 * z)) +
             z2 * z2 *
                 ((-0x1.745cf4d5bde84p-4 + 0x1.3b0ea74b544f2p-4 * z) +
                  z2 * ((-0x1.109c2eff4352ap-4 + 0x1.d4fb290893bb4p-5 * z) -
                        z2 * 0x1.47ae7e8001b56p-5));
    REAL h = base + q, l = (q - (h - base)) + (less + (q_low + q * z * p));
    const REAL right = EVERY(0x1.921fb54442d18p0);
    REAL other = right - h;
    *low = PICK(y > x, ((right - other) - h) + (0x1.1a62633145c07p-54 - l), l);
    return PICK(y > x, other, h);
}

/* The same, or pi less that angle. */
NEVH__INLINE REAL ONE(half_turn)(REAL h, REAL low, REAL sign) {
    REAL pi = EVERY(0x1.921fb54442d18p1), other = pi - h;
    return PICK((BITS_OF(sign) >> 63) != 0,
                other + (((pi - other) - h) + (0x1.1a62633145c07p-53 - low)),
                h + low);
}

NEVH__INLINE REAL ONE(atan2)(REAL y, REAL x) {
    REAL a = ONE(fabs)(y), b = ONE(fabs)(x), low;
    REAL most = PICK(a > b, a, b), by = EVERY(1.0);
    REAL a_far = PICK(a == INFINITY, EVERY(1.0), EVERY(0.0));
    REAL b_far = PICK(b == INFINITY, EVERY(1.0), EVERY(0.0));
    by = PICK(most > 0x1p1000, EVERY(0.25), by);
    by = PICK(most < 0x1p-500, EVERY(0x1p500), by);
    a = PICK(most == INFINITY, a_far, a * by);
    b = PICK(most == INFINITY, b_far, b * by);
    b = PICK(most == 0, EVERY(1.0), b);
    REAL h = ONE(angle)(a, EVERY(0.0), b, EVERY(0.0), &low);
    REAL z = ONE(signed)(ONE(half_turn)(h, low, x), y);
    return PICK((x != x) | (y != y), x + y, z);
}

NEVH__INLINE REAL ONE(atan)(REAL x) {
    REAL a = ONE(fabs)(x), low;
    /* Beyond it the angle is the right one, rounded. */
    a = PICK(a > 0x1p60, EVERY(0x1p60), a);
    REAL h = ONE(angle)(a, EVERY(0.0), EVERY(1.0), EVERY(0.0), &low);
    return ONE(signed)(h + low, x);
}

/* sqrt(c + d x^2) of c, d = 1 or -1 */
NEVH__INLINE REAL ONE(leg)(REAL x, double c, double d, REAL *low) {
    REAL x2_low, v_low, x2 = ONE(product)(x, x, &x2_low);
    REAL v = ONE(sum)(EVERY(c), d * x2, &v_low);
    return ONE(root)(v, v_low + d * x2_low, low);
}

NEVH__INLINE REAL ONE(asin)(REAL x) {
    REAL a = ONE(fabs)(x), low, l, r = ONE(leg)(a, 1, -1, &low);
    REAL h = ONE(angle)(a, EVERY(0.0), r, low, &l);
    return ONE(signed)(h + l, x);
}

NEVH__INLINE REAL ONE(acos)(REAL x) {
    REAL a = ONE(fabs)(x), low, l, r = ONE(leg)(a, 1, -1, &low);
    REAL h = ONE(angle)(r, low, a, EVERY(0.0), &l);
    return ONE(half_turn)(h, l, x);
}

/* cosh x = 2^n (c + c_low), sinh x = 2^n (s + s_low), x >= 0 */
NEVH__INLINE REAL ONE(hyperbolic)(REAL x, REAL *n, REAL *c, REAL *c_low,
                                  REAL *s_low) {
    REAL m, low, rest;
    x = PICK(x > 800, EVERY(800.0), x);
    REAL high = ONE(exp_parts)(x, EVERY(0.0), &m, &low);
    high = ONE(ordered_sum)(high, low, &low);
    REAL q = 1 / high;
    REAL p = ONE(product)(q, high, &rest);
    REAL q_low = (((1 - p) - rest) - q * low) * q;
    REAL least = PICK(m > 60, EVERY(60.0), m) + TO_INTEGER;
    REAL by = REAL_OF(ONE_BITS - (BITS_OF(least) << 53));
    q = q * by;
    q_low = q_low * by;
    REAL s = high - q;
    *c = high + q;
    *c_low = (q - (*c - high)) + (low + q_low);
    *s_low = ((high - s) - q) + (low - q_low);
    *n = m - 1;
    /* Near 0 the two cancel. */
    REAL z = x * x, z2 = z * z, y = PICK(m > 0, x, x + x);
    REAL odd = y * z *
               ((0x1.5555555555555p-3 + 0x1.1111111111157p-7 * z) +
                z2 * ((0x1.a01a019ffddd2p-13 + 0x1.71de3aa9297d2p-19 * z) +
                      z2 * (0x1.ae635a9844d9ep-26 + 0x1.6299036a59f2cp-33 * z)));
    *s_low = PICK(x < 0.5, odd, *s_low);
    return PICK(x < 0.5, y, s);
}

NEVH__INLINE REAL ONE(sinh)(REAL x) {
    REAL n, c, c_low, low;
    REAL s = ONE(hyperbolic)(ONE(fabs)(x), &n, &c, &c_low, &low);
    return ONE(signed)(ONE(scaled)(s + low, n), x);
}

NEVH__INLINE REAL ONE(cosh)(REAL x) {
    REAL n, c, c_low, low;
    ONE(hyperbolic)(ONE(fabs)(x), &n, &c, &c_low, &low);
    return ONE(scaled)(c + c_low, n);
}

NEVH__INLINE REAL ONE(tanh)(REAL x) {
    REAL n, c, c_low, s_low, low;
    REAL s = ONE(hyperbolic)(ONE(fabs)(x), &n, &c, &c_low, &s_low);
    s = ONE(ordered_sum)(s, s_low, &s_low);
    REAL q = ONE(quotient)(s, s_low, c, c_low, &low);
    return ONE(signed)(q + low, x);
}

/* log(x + sqrt(x^2 + c)), x >= 0, c = 1 or -1 */
NEVH__INLINE REAL ONE(area)(REAL x, double c) {
    REAL n, low, rest, near = PICK(x > 0x1p30, EVERY(1.0), x);
    REAL r = ONE(leg)(near, c, 1, &low), t = ONE(sum)(r, near, &rest);
    t = PICK(x > 0x1p30, x, t);
    REAL m = ONE(mantissa)(t, &n);
    rest = PICK(x > 0x1p30, EVERY(0.0), (rest + low) * (m / t));
    n = n + PICK(x > 0x1p30, EVERY(1.0), EVERY(0.0));
    REAL high = ONE(log_parts)(m, rest, n, &low);
    return PICK(x < INFINITY, high + low, x);
}

NEVH__INLINE REAL ONE(asinh)(REAL x) {
    REAL a = ONE(fabs)(x), a2 = a * a;
    REAL z = PICK(a < 0x1p-13,
                  a - a * a2 * (0x1.5555555555555p-3 - 0x1.3333333333333p-4 * a2),
                  ONE(area)(a, 1));
    return ONE(signed)(z, x);
}

NEVH__INLINE REAL ONE(acosh)(REAL x) {
    REAL z = ONE(area)(PICK(x > 1, x, EVERY(1.0)), -1);
    return PICK(x < 1, EVERY(NAN), PICK(x != x, x, z));
}

NEVH__INLINE REAL ONE(atanh)(REAL x) {
    REAL a = ONE(fabs)(x), a2 = a * a, b = PICK(a < 1, a, EVERY(0.0)), n, low;
    REAL up = 1 + b, down = 1 - b;
    REAL q = ONE(quotient)(up, b - (up - 1), down, (1 - down) - b, &low);
    REAL m = ONE(mantissa)(q, &n);
    REAL high = ONE(log_parts)(m, low * (m / q), n, &low);
    REAL z = PICK(a < 0x1p-13,
                  a + a * a2 * (0x1.5555555555555p-2 + 0x1.999999999999ap-3 * a2),
                  0.5 * (high + low));
    z = PICK(a == 1, EVERY(INFINITY), z);
    return PICK(a > 1, EVERY(NAN), PICK(x != x, x, ONE(signed)(z, x)));
}

#undef TO_INTEGER
#undef ONE_BITS

#endif
