/* nevh: Taylor coefficients in quad precision.

   What costs, the inner sums, is taken in pairs of doubles: their 106 bits are
   6e-33 of the terms.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/series_private.h"

#ifdef NEVH_QUADMATH
#include <quadmath.h>

typedef nevh__wide real;
typedef double stored;
#define NAMED(name) name##_quad
#define FUNCTION(f) f##q
#define ROWS        2
#define VECTORS
#include "taylor/series_text.h"

static void split(real x, double *high, double *low) {
    *high = (double)x;
    *low = (double)(x - *high);
}

static void store(series *s, size_t k) {
    const nevh__recurrence *r = s->of;
    double *a = s->rows_a + ROWS * k * r->lanes;
    double *b = s->rows_b + ROWS * k * r->lanes;
    for (size_t i = 0; i < r->lanes; i++) {
        real x = s->value[r->lane_a[i]];
        split(i < r->weighted ? (real)k * x : x, a + i, a + r->lanes + i);
        split(s->value[r->lane_b[i]], b + i, b + r->lanes + i);
    }
}

/* The sum of products of pairs (a, a_low) and (b, b_low), for eight lanes: high
   parts are added exactly, what is lost is summed up [T. Ogita, S. M. Rump, S.
   Oishi, Accurate sum and dot product, SIAM J. Sci. Comput. 26 (2005)
   1955-1988]. */
NEVH_SIMD static void add_pairs(size_t lanes, size_t k, const double rows_a[],
                                const double rows_b[], double high[],
                                double low[]) {
    for (size_t from = 0; from < lanes; from += NEVH__LANES) {
        double sum[NEVH__LANES] = {0}, rest[NEVH__LANES] = {0};
        for (size_t j = 1; j < k; j++) {
            const double *a = rows_a + ROWS * j * lanes + from;
            const double *b = rows_b + ROWS * (k - j) * lanes + from;
            for (size_t i = 0; i < NEVH__LANES; i++) {
                double product = a[i] * b[i];
                double lost = __builtin_fma(a[i], b[i], -product);
                double next = sum[i] + product;
                lost += nevh__roundoff(next, sum[i], product);
                sum[i] = next;
                rest[i] += lost + (a[i] * b[lanes + i] + a[lanes + i] * b[i]);
            }
        }
        for (size_t i = 0; i < NEVH__LANES; i++) {
            high[from + i] = sum[i];
            low[from + i] = rest[i];
        }
    }
}

static void add_up(series *s, size_t k) {
    size_t lanes = s->of->lanes;
    double *high = s->rows_a, *low = high + lanes; /* row 0 is not stored */
    add_pairs(lanes, k, s->rows_a, s->rows_b, high, low);
    for (size_t i = 0; i < lanes; i++)
        s->sum[i] = (real)high[i] + low[i];
}
#endif
