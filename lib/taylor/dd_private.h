/* nevh: double-double numbers: sums of two doubles, of which the low one is at
   most half a unit in the last place of the high one.  They have 106 bits, in a
   tenth of the time that quad precision takes, and go into vectors.

   Errors are below 3 and 5 units of 2^-106 [M. Joldes, J.-M. Muller, V. Popescu,
   Tight and rigorous error bounds for basic building blocks of double-word
   arithmetic, ACM Trans. Math. Softw. 44 (2017) 15res, algorithms 6 and 10].
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_DD_PRIVATE_H
#define NEVH_DD_PRIVATE_H

#include "system/vector_private.h"

typedef struct {
    double high, low;
} nevh__dd;

/* The sum of two doubles, the first of which is not smaller. */
NEVH__INLINE nevh__dd nevh__dd_of(double large, double small) {
    double sum = large + small;
    return (nevh__dd){sum, small - (sum - large)};
}

NEVH__INLINE nevh__dd nevh__dd_add(nevh__dd x, nevh__dd y) {
    double high = x.high + y.high, low = x.low + y.low;
    double high_lost = nevh__roundoff(high, x.high, y.high);
    double low_lost = nevh__roundoff(low, x.low, y.low);
    nevh__dd sum = nevh__dd_of(high, high_lost + low);
    return nevh__dd_of(sum.high, low_lost + sum.low);
}

NEVH__INLINE nevh__dd nevh__dd_multiply(nevh__dd x, nevh__dd y) {
    double product = x.high * y.high;
    double lost = __builtin_fma(x.high, y.high, -product);
    return nevh__dd_of(product, lost + (x.high * y.low + x.low * y.high));
}

/* Sums over j from 1 to k - 1 of products of pairs in row j of a and row k - j of
   b, for eight lanes.  Rows are two of `lanes` doubles: high and low parts.  High
   parts are added exactly, what is lost is summed up [T. Ogita, S. M. Rump, S.
   Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005)
   1955-1988]. */
NEVH__INLINE void nevh__dd_sums(size_t lanes, size_t k, const double a[],
                                const double b[], nevh__dd sums[]) {
    double sum[NEVH__LANES] = {0}, rest[NEVH__LANES] = {0};
    for (size_t j = 1; j < k; j++) {
        const double *x = a + 2 * j * lanes, *y = b + 2 * (k - j) * lanes;
        for (size_t i = 0; i < NEVH__LANES; i++) {
            double product = x[i] * y[i];
            double lost = __builtin_fma(x[i], y[i], -product);
            double next = sum[i] + product;
            lost += nevh__roundoff(next, sum[i], product);
            sum[i] = next;
            rest[i] += lost + (x[i] * y[lanes + i] + x[lanes + i] * y[i]);
        }
    }
    for (size_t i = 0; i < NEVH__LANES; i++)
        sums[i] = nevh__dd_of(sum[i], rest[i]);
}

#endif
