/* nevh: Taylor coefficients in doubles.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

typedef double real;
typedef double stored;
#define NAMED(name)     name##_double
#define FUNCTION(f)     nevh_simd_##f
#define ROUNDED_DOWN(x) floor(x)
#define ROWS            1
#define VECTORS         NEVH_SIMD
#include "taylor/series_text.h"

NEVH__INLINE void store(series *s, size_t k) {
    const nevh__recurrence *r = s->of;
    double *a = s->rows_a + k * r->lanes, *b = s->rows_b + k * r->lanes;
    const double *value = s->value;
    double order = (double)k;
    NEVH_LANES(i, r->weighted) {
        a[i] = order * value[r->lane_a[i]];
    }
    NEVH__NO_ALIAS for (size_t i = r->weighted; i < r->lanes; i++) a[i] =
        value[r->lane_a[i]];
    NEVH__NO_ALIAS for (size_t i = 0; i < r->lanes; i++) b[i] =
        value[r->lane_b[i]];
}

/* Takes the products of the previous order last, so that the others need not wait
   for them. */
NEVH__INLINE void add_up(series *s, size_t k) {
    size_t lanes = s->of->lanes;
    for (size_t from = 0; from < lanes; from += NEVH__IN_VECTOR) {
        const double *x = s->rows_a + from, *y = s->rows_b + from;
        const double *a = x + 2 * lanes, *b = y + (k - 2) * lanes;
        nevh__vector even = {0}, odd = {0};
        size_t j = 2;
        for (; j + 2 < k; j += 2, a += 2 * lanes, b -= 2 * lanes) {
            even += NEVH__VECTOR_AT(a) * NEVH__VECTOR_AT(b);
            odd += NEVH__VECTOR_AT(a + lanes) * NEVH__VECTOR_AT(b - lanes);
        }
        if (j + 1 < k)
            even += NEVH__VECTOR_AT(a) * NEVH__VECTOR_AT(b);
        nevh__vector outer =
            NEVH__VECTOR_AT(x + lanes) * NEVH__VECTOR_AT(y + (k - 1) * lanes);
        if (k > 2)
            outer += NEVH__VECTOR_AT(x + (k - 1) * lanes) *
                     NEVH__VECTOR_AT(y + lanes);
        NEVH__VECTOR_AT(s->sum + from) = (even + odd) + outer;
    }
}
