/* nevh: Taylor coefficients in quad precision.

   What costs, the inner sums, is taken in pairs of doubles: their 106 bits are
   6e-33 of the terms.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/series_private.h"

#ifdef NEVH_QUADMATH
#include <quadmath.h>

typedef nevh__wide real;
typedef double stored;
#define NAMED(name)     name##_quad
#define FUNCTION(f)     f##q
#define ROUNDED_DOWN(x) floorq(x)
#define ROWS            2
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

NEVH_SIMD static void add_pairs(size_t lanes, size_t k, const double rows_a[],
                                const double rows_b[], nevh__dd sums[]) {
    for (size_t from = 0; from < lanes; from += NEVH__LANES)
        nevh__dd_sums(lanes, k, rows_a + from, rows_b + from, sums + from);
}

static void add_up(series *s, size_t k) {
    nevh__dd *sums = (nevh__dd *)s->rows_a; /* row 0 is not stored */
    add_pairs(s->of->lanes, k, s->rows_a, s->rows_b, sums);
    for (size_t i = 0; i < s->of->lanes; i++)
        s->sum[i] = (real)sums[i].high + sums[i].low;
}
#endif
