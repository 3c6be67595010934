/* nevh: Taylor coefficients in pairs of doubles, of states in quad precision.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/series_private.h"

#ifdef NEVH_QUADMATH
#include <quadmath.h>

typedef nevh__wide real;
typedef double stored;
#define NAMED(name)     name##_dd
#define FUNCTION(f)     f##q
#define ROUNDED_DOWN(x) floorq(x)
#define ROWS            2
#define DOUBLE_DOUBLE
#define VECTORS NEVH_SIMD
#include "taylor/series_text.h"

NEVH__INLINE void store(series *s, size_t k) {
    const nevh__recurrence *r = s->of;
    double *a = s->rows_a + ROWS * k * r->lanes;
    double *b = s->rows_b + ROWS * k * r->lanes;
    number order = narrow((real)k);
    for (size_t i = 0; i < r->lanes; i++) {
        number x = s->value[r->lane_a[i]], y = s->value[r->lane_b[i]];
        x = i < r->weighted ? times(order, x) : x;
        a[i] = x.high;
        a[r->lanes + i] = x.low;
        b[i] = y.high;
        b[r->lanes + i] = y.low;
    }
}

NEVH__INLINE void add_up(series *s, size_t k) {
    size_t lanes = s->of->lanes;
    for (size_t from = 0; from < lanes; from += NEVH__LANES)
        nevh__dd_sums(lanes, k, s->rows_a + from, s->rows_b + from,
                      s->sum + from);
}
#endif
