/* nevh: the inner sums of products of series, of all lanes, for one order.

   The text needs LANES, a multiple of 8, TOGETHER, lanes of a vector, and rows of operands
   of the orders below k.
   lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SERIES_SUMS_H
#define NEVH_SERIES_SUMS_H

typedef double series_lanes __attribute__((vector_size(8 * TOGETHER),
                                           aligned(8 * TOGETHER), may_alias));
#define LANES_AT(x) (*(series_lanes *)(x))

/* Products with an operand of order 1. */
INLINE series_lanes sum_outer(size k, const double *x, const double *y) {
    series_lanes outer = LANES_AT(x + LANES) * LANES_AT(y + (k - 1) * LANES);
    if (k > 2)
        outer += LANES_AT(x + (k - 1) * LANES) * LANES_AT(y + LANES);
    return outer;
}

#ifdef NEVH__TWO_ORDERS
/* Sums of an even order k and of the next one are taken together, so that what is loaded
   serves twice: all that does not end in an operand of order k is known.  That pays
   where lanes fill the nearest cache: 16 % of a series of six bodies. */
INLINE void sum_products(size k, const double *a, const double *b, double *s,
                         double *next) {
    for (size from = 0; from < LANES; from += TOGETHER) {
        const double *x = a + from, *y = b + from;
        if (k % 2 == 0) {
            const double *u = x + 2 * LANES, *v = y + (k - 1) * LANES;
            series_lanes even = {0}, odd = {0}, next_even = {0}, next_odd = {0};
            series_lanes last = k > 2 ? LANES_AT(v) : (series_lanes){0};
            size j = 2;
            for (; j + 2 < k; j += 2, u += 2 * LANES, v -= 2 * LANES) {
                series_lanes middle = LANES_AT(v - LANES);
                even += LANES_AT(u) * middle;
                next_even += LANES_AT(u) * last;
                last = LANES_AT(v - 2 * LANES);
                odd += LANES_AT(u + LANES) * last;
                next_odd += LANES_AT(u + LANES) * middle;
            }
            if (k > 2) {
                even += LANES_AT(u) * LANES_AT(v - LANES);
                next_even += LANES_AT(u) * last;
                next_odd += LANES_AT(u + LANES) * LANES_AT(v - LANES);
            }
            LANES_AT(s + from) = even + odd;
            LANES_AT(next + from) = next_even + next_odd;
        }
        LANES_AT(s + from) =
            LANES_AT((k % 2 ? next : s) + from) + sum_outer(k, x, y);
    }
}
#else
INLINE void sum_products(size k, const double *a, const double *b, double *s,
                         double *next) {
    (void)next;
    for (size from = 0; from < LANES; from += TOGETHER) {
        const double *x = a + from, *y = b + from;
        const double *u = x + 2 * LANES, *v = y + (k - 2) * LANES;
        series_lanes even = {0}, odd = {0};
        size j = 2;
        for (; j + 2 < k; j += 2, u += 2 * LANES, v -= 2 * LANES) {
            even += LANES_AT(u) * LANES_AT(v);
            odd += LANES_AT(u + LANES) * LANES_AT(v - LANES);
        }
        if (j + 1 < k)
            even += LANES_AT(u) * LANES_AT(v);
        LANES_AT(s + from) = (even + odd) + sum_outer(k, x, y);
    }
}
#endif

int nevh_native_series(const double *N, double t, const double *state,
                       double *rows, double *watched);

#endif
