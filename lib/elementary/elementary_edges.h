/* nevh: elementary functions of one number where they are not ordinary: large angles,
   zeros, infinities.  elementary_number.h includes it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ELEMENTARY_EDGES_H
#define NEVH_ELEMENTARY_EDGES_H

#ifndef NEVH__NO_CIRCLE
/* 2/pi, after two words of nothing. */
static const uint32_t nevh__one_per_quarter[] = {
    0x00000000, 0x00000000, 0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0,
    0xdb629599, 0x3c439041, 0xfe5163ab, 0xdebbc561, 0xb7246e3a, 0x424dd2e0,
    0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484,
    0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4, 0x9c845f8b, 0xbdf9283b,
    0x1ff897ff, 0xde05980f, 0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7,
    0x4f463f66, 0x9e5fea2d, 0x7527bac7, 0xebe5f17b, 0x3d0739f7, 0x8a5292ea,
    0x6bfb5fb1, 0x1f8d5d08, 0x56033046, 0xfc7b6bab};

/* x minus so many quarters of a turn, of any finite x from NEVH__ONE_FAR on [Payne, Hanek,
   "Radian reduction for trigonometric functions", SIGNUM Newsl. 18 (1983)]: of
   x 2/pi 192 bits, from the twos on. */
static NEVH__RARE nevh__one_pair nevh__one_turned_far(double x,
                                                      uint64_t *quarters) {
    enum { WORDS = 6 };
    const uint64_t word = 0xffffffffu;
    uint64_t bits = nevh__one_bits(x), sum[WORDS] = {0};
    uint64_t f = (bits & NEVH__ONE_FRACTION) | (NEVH__ONE_FRACTION + 1);
    size_t from = (size_t)(bits >> 52 & 0x7ff) - 1013;
    for (size_t i = 0; i < WORDS; i++) {
        const uint32_t *two = nevh__one_per_quarter + from / 32 + i;
        uint64_t part = ((uint64_t)two[0] << 32 | two[1]) << from % 32 >> 32;
        uint64_t low = part * (f & word), high = part * (f >> 32);
        sum[i] += low & word;
        if (i > 0)
            sum[i - 1] += (low >> 32) + (high & word);
        if (i > 1)
            sum[i - 2] += high >> 32;
    }
    for (size_t i = WORDS; i-- > 1; sum[i] &= word)
        sum[i - 1] += sum[i] >> 32;
    uint64_t turns = (sum[0] & word) >> 30, back = sum[0] >> 29 & 1;
    nevh__one_pair y = {0, 0};
    sum[0] &= word >> 2;
    for (size_t i = 0; i < WORDS; i++) {
        uint64_t one = back ? ~sum[i] & (i ? word : word >> 2) : sum[i];
        double unit = nevh__one_number((uint64_t)(1023 - 30 - 32 * i) << 52);
        nevh__one_pair next = nevh__one_sum(y.hi, (double)one * unit);
        y = (nevh__one_pair){next.hi, y.lo + next.lo};
    }
    y = nevh__one_quick(y.hi, y.lo);
    nevh__one_pair p = nevh__one_product(y.hi, NEVH__ONE_QUARTER[4]);
    p.lo += y.hi * NEVH__ONE_QUARTER[5] + y.lo * NEVH__ONE_QUARTER[4];
    p = nevh__one_quick(p.hi, p.lo);
    bool minus = x < 0;
    *quarters = minus ? -(turns + back) : turns + back;
    return back != minus ? (nevh__one_pair){-p.hi, -p.lo} : p;
}

/* The sine of x and so many quarters of a turn more. */
static NEVH__RARE double nevh__one_circle_far(double x, uint64_t more) {
    uint64_t quarters;
    if (!(nevh__one_size(x) < INFINITY))
        return NAN;
    nevh__one_pair near = nevh__one_turned_far(x, &quarters);
    return nevh__one_circle(near, quarters + more);
}

static NEVH__RARE double nevh__one_sin_far(double x) {
    return nevh__one_circle_far(x, 0);
}

static NEVH__RARE double nevh__one_cos_far(double x) {
    return nevh__one_circle_far(x, 1);
}

static NEVH__RARE double nevh__one_tan_far(double x) {
    uint64_t quarters;
    if (!(nevh__one_size(x) < INFINITY))
        return NAN;
    nevh__one_pair near = nevh__one_turned_far(x, &quarters);
    return nevh__one_tan_near(near, quarters);
}
#endif

#ifndef NEVH__NO_POWERS
/* Powers of 0, of infinity and of negative numbers, and what infinite powers are. */
static NEVH__RARE double nevh__one_pow_edge(double x, double y) {
    double size = nevh__one_size(x);
    if (y == 0 || x == 1)
        return 1;
    if (x != x || y != y)
        return NAN;
    double half = 0.5 * y;
    bool whole = floor(y) == y, even = floor(half) == half;
    bool infinite = nevh__one_size(y) == INFINITY;
    if (infinite && size == 1)
        return 1;
    if (x < 0 && size < INFINITY && !whole)
        return NAN;
    double value = infinite || size == 0 || size == INFINITY
                       ? ((size > 1) == (y > 0) ? INFINITY : 0)
                       : nevh__one_pow_near(size, y);
    bool minus = nevh__one_bits(x) >> 63 && whole && !even;
    return minus ? -value : value;
}
#endif

#ifndef NEVH__NO_ARCS
/* Quotients that are too large or too small, and numbers whose squares overflow. */
static NEVH__RARE double nevh__one_atan2_edge(double y, double x) {
    double a = nevh__one_size(y), b = nevh__one_size(x), angle;
    bool left = nevh__one_bits(x) >> 63;
    if (x != x || y != y)
        return NAN;
    if (a == b && (a == 0 || a == INFINITY))
        angle = a == 0 ? 0 : 0.5 * NEVH__ONE_QUARTER[4];
    else if (a > b * 0x1p100 || a == INFINITY)
        angle = NEVH__ONE_QUARTER[4];
    else if (b > a * 0x1p100 || b == INFINITY)
        angle = left ? 0 : a / b;
    else {
        double unit = a > 1 ? 0x1p-600 : 0x1p600;
        return nevh__one_signed(
            nevh__one_atan2_near(a * unit, b * unit, -(uint64_t)left), y);
    }
    if (left && angle < NEVH__ONE_QUARTER[4])
        angle =
            angle > 0 ? 1.5 * NEVH__ONE_QUARTER[4] : 2 * NEVH__ONE_QUARTER[4];
    return nevh__one_signed(angle, y);
}
#endif

#ifndef NEVH__NO_ROOTS
static NEVH__RARE double nevh__one_hypot_edge(double x, double y) {
    double a = nevh__one_size(x), b = nevh__one_size(y);
    if (a == INFINITY || b == INFINITY)
        return INFINITY;
    if (a == 0 || b == 0 || a != a || b != b)
        return a + b;
    double unit = a + b > 1 ? 0x1p-600 : 0x1p600;
    return nevh__one_hypot_near(a * unit, b * unit) / unit;
}
#endif

#endif
