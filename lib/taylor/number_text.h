/* nevh: the numbers that coefficients are: real, or where DOUBLE_DOUBLE is defined pairs
   of doubles, real being what they are made of and turned into.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/dd_private.h"

#ifdef DOUBLE_DOUBLE
typedef nevh__dd number;

NEVH__INLINE number narrow(real x) {
    double high = (double)x;
    return (number){high, (double)(x - high)};
}

NEVH__INLINE real widen(number x) {
    return (real)x.high + x.low;
}

NEVH__INLINE long double lengthen(number x) {
    return (long double)x.high + x.low;
}

NEVH__INLINE double shorten(number x) {
    return x.high;
}

NEVH__INLINE number plus(number x, number y) {
    return nevh__dd_add(x, y);
}

NEVH__INLINE number minus(number x, number y) {
    return nevh__dd_add(x, (number){-y.high, -y.low});
}

NEVH__INLINE number times(number x, number y) {
    return nevh__dd_multiply(x, y);
}
#else
typedef real number;

NEVH__INLINE number narrow(real x) {
    return x;
}

NEVH__INLINE real widen(number x) {
    return x;
}

NEVH__INLINE long double lengthen(number x) {
    return (long double)x;
}

NEVH__INLINE double shorten(number x) {
    return (double)x;
}

NEVH__INLINE number plus(number x, number y) {
    return x + y;
}

NEVH__INLINE number minus(number x, number y) {
    return x - y;
}

NEVH__INLINE number times(number x, number y) {
    return x * y;
}
#endif
