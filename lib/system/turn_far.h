/* nevh: multiples of pi/2 less large numbers, by the digits of 2/pi.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TURN_FAR_H
#define NEVH_TURN_FAR_H

/* Words of 32 binary digits of 2/pi. */
static const unsigned nevh__digits_of_turns[] = {
    0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041,
    0xfe5163ab, 0xdebbc561, 0xb7246e3a, 0x424dd2e0, 0x06492eea, 0x09d1921c,
    0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484, 0xe99c7026, 0xb45f7e41,
    0x3991d639, 0x835339f4, 0x9c845f8b, 0xbdf9283b, 0x1ff897ff, 0xde05980f,
    0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d,
    0x7527bac7, 0xebe5f17b, 0x3d0739f7, 0x8a5292ea, 0x6bfb5fb1, 0x1f8d5d08,
    0x56033046, 0xfc7b6bab, 0xf0cfbc20,
};

/* Of 2/pi, 32 digits from one on; 0 is the first, before which there are zeros. */
static __attribute__((cold, unused)) unsigned nevh__turn_word(int at) {
    const unsigned *digits = nevh__digits_of_turns + (at < 0 ? 0 : at / 32);
    if (at < 0)
        return at <= -32 ? 0 : digits[0] >> -at;
    return (unsigned)(((unsigned long long)digits[0] << 32 | digits[1]) >>
                      (32 - at % 32));
}

enum { NEVH__TURN_WORDS = 6 };
/* x 2/pi modulo 4, in units of 2^-190: digits of 2/pi that make multiples of 4 are
   left out.  Low words come first. */
static __attribute__((cold, unused)) void
nevh__turn_fraction(double x, unsigned fraction[NEVH__TURN_WORDS]) {
    enum { OFFSET = 1077 };
    union {
        double x;
        unsigned long long bits;
    } u = {x};
    const unsigned long long m =
        (u.bits & 0xfffffffffffffu) | 0x10000000000000u;
    const unsigned long long part[2] = {m & 0xffffffffu, m >> 32};
    for (int i = 0; i < NEVH__TURN_WORDS; i++)
        fraction[i] = 0;
    for (int i = 0; i < NEVH__TURN_WORDS; i++) {
        unsigned long long carry = 0, word = nevh__turn_word(
            (int)(u.bits >> 52) - OFFSET + 32 * (NEVH__TURN_WORDS - 1 - i));
        for (int k = 0; k < 2 && i + k < NEVH__TURN_WORDS; k++) {
            carry += fraction[i + k] + word * part[k];
            fraction[i + k] = (unsigned)carry;
            carry >>= 32;
        }
        if (i + 2 < NEVH__TURN_WORDS)
            fraction[i + 2] = (unsigned)carry;
    }
}

/* x >= 2^20 less the nearest multiple of pi/2; as turn() of elementary.h. */
static __attribute__((noinline, cold, unused)) unsigned long long
nevh__turn_far(double x, double *r, double *rest) {
    unsigned fraction[NEVH__TURN_WORDS], *last = fraction + NEVH__TURN_WORDS - 1;
    double sign = 1, high = 0, low = 0, unit = 0x1p-30;
    *r = *rest = x - x;
    if (!(x - x == 0))
        return 0;
    nevh__turn_fraction(x, fraction);
    unsigned long long turns = *last >> 30, carry = 1;
    if (*last >> 29 & 1) { /* rounded up */
        turns++;
        sign = -1;
        for (int i = 0; i < NEVH__TURN_WORDS; i++, carry >>= 32) {
            carry += (unsigned)~fraction[i];
            fraction[i] = (unsigned)carry;
        }
    }
    *last &= 0x3fffffffu;
    for (int i = NEVH__TURN_WORDS; i-- > 0; unit *= 0x1p-32) {
        double term = fraction[i] * unit, sum = high + term;
        low += (high - sum) + term;
        high = sum;
    }
    double s = high * 0x1.921fb54442d18p0, h = high * 0x1p27 + high;
    h -= h - high;
    low = (((h * 0x1.921fb54p0 - s) + h * 0x1.10b46p-30) +
           (high - h) * 0x1.921fb54442d18p0) +
          (high * 0x1.1a62633145c07p-54 + low * 0x1.921fb54442d18p0);
    *r = sign * (s + low);
    *rest = sign * ((s - *r * sign) + low);
    return turns;
}

#endif
