/* nevh: the inner sums of products of series, of all lanes, for one order.

   The text needs LANES, a multiple of 8, and rows of operands of the orders below k.
   lib/native hands it to the C compiler.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SERIES_SUMS_H
#define NEVH_SERIES_SUMS_H

typedef double eight __attribute__((vector_size(64), aligned(64), may_alias));
#define EIGHT(x) (*(eight *)(x))

/* Products with an operand of order 1. */
INLINE eight sum_outer(size k, const double *x, const double *y) {
    eight outer = EIGHT(x + LANES) * EIGHT(y + (k - 1) * LANES);
    if (k > 2)
        outer += EIGHT(x + (k - 1) * LANES) * EIGHT(y + LANES);
    return outer;
}

#ifdef NEVH__TWO_ORDERS
/* Sums of an even order k and of the next one are taken together, so that what is loaded
   serves twice: all that does not end in an operand of order k is known.  That pays
   where lanes fill the nearest cache: 16 % of a series of six bodies. */
INLINE void sum_products(size k, const double *a, const double *b, double *s,
                         double *next) {
    for (size from = 0; from < LANES; from += 8) {
        const double *x = a + from, *y = b + from;
        if (k % 2 == 0) {
            const double *u = x + 2 * LANES, *v = y + (k - 1) * LANES;
            eight even = {0}, odd = {0}, next_even = {0}, next_odd = {0};
            eight last = k > 2 ? EIGHT(v) : (eight){0};
            size j = 2;
            for (; j + 2 < k; j += 2, u += 2 * LANES, v -= 2 * LANES) {
                eight middle = EIGHT(v - LANES);
                even += EIGHT(u) * middle;
                next_even += EIGHT(u) * last;
                last = EIGHT(v - 2 * LANES);
                odd += EIGHT(u + LANES) * last;
                next_odd += EIGHT(u + LANES) * middle;
            }
            if (k > 2) {
                even += EIGHT(u) * EIGHT(v - LANES);
                next_even += EIGHT(u) * last;
                next_odd += EIGHT(u + LANES) * EIGHT(v - LANES);
            }
            EIGHT(s + from) = even + odd;
            EIGHT(next + from) = next_even + next_odd;
        }
        EIGHT(s + from) = EIGHT((k % 2 ? next : s) + from) + sum_outer(k, x, y);
    }
}
#else
INLINE void sum_products(size k, const double *a, const double *b, double *s,
                         double *next) {
    (void)next;
    for (size from = 0; from < LANES; from += 8) {
        const double *x = a + from, *y = b + from;
        const double *u = x + 2 * LANES, *v = y + (k - 2) * LANES;
        eight even = {0}, odd = {0};
        size j = 2;
        for (; j + 2 < k; j += 2, u += 2 * LANES, v -= 2 * LANES) {
            even += EIGHT(u) * EIGHT(v);
            odd += EIGHT(u + LANES) * EIGHT(v - LANES);
        }
        if (j + 1 < k)
            even += EIGHT(u) * EIGHT(v);
        EIGHT(s + from) = (even + odd) + sum_outer(k, x, y);
    }
}
#endif

int nevh_native_series(const double *N, double t, const double *state,
                       double *rows, double *watched);

#endif
