/* nevh: Taylor coefficients in long doubles, which have eleven bits more on many
   processors.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

typedef long double real;
typedef long double stored;
#define NAMED(name)     name##_long
#define FUNCTION(f)     f##l
#define ROUNDED_DOWN(x) floorl(x)
#define ROWS            1
#define VECTORS
#include "taylor/series_text.h"

static void store(series *s, size_t k) {
    const nevh__recurrence *r = s->of;
    real *a = s->rows_a + k * r->lanes, *b = s->rows_b + k * r->lanes;
    for (size_t i = 0; i < r->lanes; i++) {
        a[i] = s->value[r->lane_a[i]] * (i < r->weighted ? (real)k : 1);
        b[i] = s->value[r->lane_b[i]];
    }
}

/* Lanes beyond those in use hold only zeros, and are left alone. */
static void add_lanes(series *s, size_t k, size_t from, size_t until) {
    size_t lanes = s->of->lanes;
    for (size_t i = from; i < until; i++) {
        const real *a = s->rows_a + i + lanes;
        const real *b = s->rows_b + i + (k - 1) * lanes;
        real sum = 0;
        for (size_t j = 1; j < k; j++, a += lanes, b -= lanes)
            sum += *a * *b;
        s->sum[i] = sum;
    }
}

static void add_up(series *s, size_t k) {
    const nevh__recurrence *r = s->of;
    add_lanes(s, k, 0, r->used[0]);
    add_lanes(s, k, r->weighted, r->weighted + r->used[1]);
}
