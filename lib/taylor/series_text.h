/* nevh: Taylor coefficients in one kind of numbers.

   Before this is included are defined: real, of which states are, and DOUBLE_DOUBLE
   where coefficients are not; stored, what rows are of; NAMED(name), the name of
   a function; FUNCTION(f), an elementary function of theirs; ROUNDED_DOWN(x); ROWS, numbers
   that a lane's operand takes in a row.  After it: how operands are stored in
   rows (store), and the inner sums of all lanes (add_up).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "taylor/number_text.h"
#include "taylor/series_private.h"
#include <math.h>
#include <stdlib.h>

struct NAMED(nevh__series) {
    const nevh__recurrence *of;
    size_t order;
    number *value;   /* the coefficients of the present order */
    number *slope;   /* 2n */
    number *a0, *b0; /* lanes: operands of order 0 */
    number *sum;     /* lanes */
    number *each;    /* by number: of inverses of what is divided by */
    number *numbers;
    number *gathered;        /* a few times the widest batch */
    number *inverse;         /* 1/k */
    number *rate;            /* unit/k */
    number unit;             /* of time, in which coefficients are */
    stored *rows_a, *rows_b; /* order x ROWS x lanes */
    double *watched;         /* order x n_watched */
    double off;              /* of functions, as nevh__series_away has it */
    void *memory;
};
typedef struct NAMED(nevh__series) series;

static void store(series *, size_t k);
static void add_up(series *, size_t k);

static void lay_out(nevh__arena *arena, void *data) {
    series *s = data;
    const nevh__recurrence *r = s->of;
    s->value = nevh__arena_take(arena, r->values, sizeof(number));
    s->slope = nevh__arena_take(arena, 2 * r->n, sizeof(number));
    s->a0 = nevh__arena_take(arena, r->lanes, sizeof(number));
    s->b0 = nevh__arena_take(arena, r->lanes, sizeof(number));
    s->sum = nevh__arena_take(arena, r->lanes, sizeof(number));
    s->each = nevh__arena_take(arena, r->values, sizeof(number));
    s->numbers = nevh__arena_take(arena, r->n_numbers, sizeof(number));
    s->gathered = nevh__arena_take(arena, NEVH__MOST_SUMMANDS * r->widest,
                                   sizeof(number));
    s->inverse = nevh__arena_take(arena, s->order + 1, sizeof(number));
    s->rate = nevh__arena_take(arena, s->order + 1, sizeof(number));
    s->watched =
        nevh__arena_take(arena, s->order * r->n_watched, sizeof(double));
    s->rows_a =
        nevh__arena_take(arena, s->order * ROWS * r->lanes, sizeof(stored));
    s->rows_b =
        nevh__arena_take(arena, s->order * ROWS * r->lanes, sizeof(stored));
}

void NAMED(nevh__series_free)(series *s) {
    if (!s)
        return;
    free(s->memory);
    free(s);
}

void NAMED(nevh__series_in)(series *s, double unit) {
    s->unit = narrow((real)unit);
    for (size_t k = 1; k <= s->order; k++)
        s->rate[k] = times(s->unit, s->inverse[k]);
}

void NAMED(nevh__series_away)(series *s, double by) {
    s->off = by;
}

series *NAMED(nevh__series_new)(const nevh__recurrence *r, size_t order) {
    series *s = nevh__array(1, sizeof *s);
    if (!s)
        return NULL;
    s->of = r;
    s->order = order;
    s->memory = nevh__arena_new(lay_out, s);
    if (!s->memory) {
        free(s);
        return NULL;
    }
    for (size_t i = 0; i < r->n_numbers; i++)
        s->numbers[i] = narrow((real)r->numbers[i]);
    for (size_t k = 1; k <= order; k++)
        s->inverse[k] = narrow((real)1 / (real)k);
    NAMED(nevh__series_in)(s, 1);
    return s;
}

/* The present values of a batch's operand. */
NEVH__INLINE const number *operand(const series *s, const nevh__batch *b,
                                   int which) {
    if (b->together[which])
        return s->value + b->operand[which];
    const uint32_t *index = s->of->index + b->operand[which];
    number *to = s->gathered + (size_t)which * s->of->widest;
    NEVH__NO_ALIAS for (size_t i = 0; i < b->count; i++) to[i] =
        s->value[index[i]];
    return to;
}

NEVH__INLINE void add_summands(const series *s, const nevh__batch *b) {
    number *restrict y = s->value + b->first;
    size_t count = b->count;
    const number *c = s->numbers + b->number, *x = operand(s, b, 0);
    const number *d = c + count, *z;
    switch (b->arity) {
    case 1:
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            times(c[i], x[i]);
        return;
    case 2:
        z = operand(s, b, 1);
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            plus(times(c[i], x[i]), times(d[i], z[i]));
        return;
    default:
        z = operand(s, b, 1);
        const number *e = d + count, *u = operand(s, b, 2);
        if (b->arity == 3) {
            NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] = plus(
                plus(times(c[i], x[i]), times(d[i], z[i])), times(e[i], u[i]));
            return;
        }
        const number *f = e + count, *v = operand(s, b, 3);
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            plus(plus(times(c[i], x[i]), times(d[i], z[i])),
                 plus(times(e[i], u[i]), times(f[i], v[i])));
    }
}

/* Functions that a graph calls; others are made of them. */
#define CASE(kind, identifier, name, arity, value, by_a, by_b, ...)            \
    CASE_##kind(identifier, value)
#define CASE_ARITHMETIC(identifier, value)
#define CASE_SPECIAL(identifier, value)
#define CASE_GSL(identifier, value)
#define CASE_KINK(identifier, value)
#define CASE_FUNCTION(identifier, value)                                       \
    case NEVH__##identifier:                                                   \
        return value;
#define NEVH__F(f) FUNCTION(f)
#define NEVH__L(f) FUNCTION(f)
static real function(const nevh__batch *batch, real a, real b) {
    switch (batch->function) {
        NEVH__OPERATIONS(CASE)
    case NEVH__SIGN:
        return (real)((a > 0) - (a < 0));
    case NEVH__FLOOR:
        return ROUNDED_DOWN(a);
    default: /* NEVH__NOTHING */
        return 0;
    }
}

static real power(real x, real exponent) {
    if (exponent == (real)-1.5)
        return 1 / (x * FUNCTION(sqrt)(x));
    if (exponent == (real)-0.5)
        return 1 / FUNCTION(sqrt)(x);
    return FUNCTION(pow)(x, exponent);
}

/* True of functions whose values are whole numbers. */
static bool is_whole(unsigned function) {
    return function == NEVH__SIGN || function == NEVH__FLOOR ||
           function == NEVH__NOTHING;
}

/* A function's value, which is off by another part for each node. */
static number rounded_value(const series *s, size_t node, real y) {
    double part = (double)(node * 0x9E3779B9u % 255) / 127 - 1;
    return narrow(s->off == 0 ? y : y + y * (real)(s->off * part));
}

/* Order 0. */
static void begin_batch(const series *s, const nevh__batch *b) {
    number *y = s->value + b->first, *each = s->each + b->first;
    const number *x = operand(s, b, 0), *z;
    const number *c = s->numbers + b->number;
    real root;
    switch (b->kind) {
    case NEVH__BATCH_SUM:
        add_summands(s, b);
        break;
    case NEVH__BATCH_MULTIPLY:
        z = operand(s, b, 1);
        for (size_t i = 0; i < b->count; i++)
            y[i] = times(x[i], z[i]);
        break;
    case NEVH__BATCH_INVERT:
        for (size_t i = 0; i < b->count; i++) {
            y[i] = narrow(1 / widen(x[i]));
            each[i] = times(narrow(-1), y[i]);
        }
        break;
    case NEVH__BATCH_ROOT:
        for (size_t i = 0; i < b->count; i++) {
            root = FUNCTION(sqrt)(widen(x[i]));
            y[i] = narrow(root);
            each[i] = narrow((real)0.5 / root);
        }
        break;
    case NEVH__BATCH_POWER:
        for (size_t i = 0; i < b->count; i++) {
            y[i] =
                rounded_value(s, b->first + i, power(widen(x[i]), widen(c[i])));
            each[i] = narrow(1 / widen(x[i]));
        }
        break;
    default:
        z = b->arity > 1 ? operand(s, b, 1) : x;
        for (size_t i = 0; i < b->count; i++)
            y[i] = is_whole(b->function)
                       ? narrow(function(b, widen(x[i]), widen(z[i])))
                       : rounded_value(s, b->first + i,
                                       function(b, widen(x[i]), widen(z[i])));
    }
}

/* Order k, from the inner sums. */
NEVH__INLINE void next_batch(const series *s, const nevh__batch *b, size_t k) {
    size_t count = b->count;
    number *restrict y = s->value + b->first;
    const number *each = s->each + b->first;
    if (b->kind == NEVH__BATCH_SUM) {
        add_summands(s, b);
        return;
    }
    const number *x = operand(s, b, 0), *z;
    const number *c = s->numbers + b->number, *sum = s->sum + b->lane;
    const number *a0 = s->a0 + b->lane, *b0 = s->b0 + b->lane;
    number order = narrow((real)k), inverse = s->inverse[k];
    switch (b->kind) {
    case NEVH__BATCH_MULTIPLY:
        z = operand(s, b, 1);
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            plus(sum[i], plus(times(a0[i], z[i]), times(x[i], b0[i])));
        break;
    case NEVH__BATCH_INVERT: /* x y = 1 */
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            times(plus(sum[i], times(x[i], b0[i])), each[i]);
        break;
    case NEVH__BATCH_ROOT: /* y y = x */
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            times(minus(x[i], sum[i]), each[i]);
        break;
    case NEVH__BATCH_POWER: { /* x y' = c y x' */
        const number *plain = s->sum + b->also;
        b0 = s->b0 + b->also;
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            times(minus(times(plus(c[i], narrow(1)),
                              plus(times(sum[i], inverse), times(x[i], b0[i]))),
                        plus(plain[i], times(x[i], b0[i]))),
                  each[i]);
        break;
    }
    default: /* y' = slope x' */
        NEVH__NO_ALIAS for (size_t i = 0; i < count; i++) y[i] =
            times(c[i], times(plus(sum[i], times(times(order, x[i]), b0[i])),
                              inverse));
        break;
    }
}

/* Keeps order k of the nodes that may meet edges of domains. */
NEVH__INLINE void note_watched(const series *s, size_t k) {
    const nevh__recurrence *r = s->of;
    double *to = s->watched + k * r->n_watched;
    for (size_t i = 0; i < r->n_watched; i++)
        to[i] = shorten(s->value[r->watched[i]]);
}

const double *NAMED(nevh__series_watched)(const series *s) {
    return s->watched;
}

/* Coefficients of order k of the state, from slopes of order k - 1. */
NEVH__INLINE void advance(series *s, size_t k, number row[]) {
    const nevh__recurrence *r = s->of;
    const number *factor = s->numbers + r->slope_number;
    size_t n = 2 * r->n;
    for (size_t i = 0; i < n; i++)
        row[i] = times(times(factor[i], s->value[r->slope[i]]), s->rate[k]);
    for (size_t i = 0; i < n; i++)
        s->value[i] = row[i];
    s->value[n] = k == 1 ? s->unit : narrow(0);
    if (k == 1)
        for (size_t i = 0; i < r->n_constants; i++)
            s->value[r->first_constant + i] = narrow(0);
}

/* Order 0 of everything. */
static void begin(series *s, real t, const real state[], number row[]) {
    const nevh__recurrence *r = s->of;
    for (size_t i = 0; i < 2 * r->n; i++)
        row[i] = s->value[i] = narrow(state[i]);
    s->value[2 * r->n] = narrow(t);
    for (size_t i = 0; i < r->n_constants; i++)
        s->value[r->first_constant + i] = s->numbers[i];
    for (size_t i = 0; i < r->n_batches; i++)
        begin_batch(s, &r->batches[i]);
    note_watched(s, 0);
    for (size_t i = 0; i < r->lanes; i++) {
        s->a0[i] = s->value[r->lane_a[i]];
        s->b0[i] = s->value[r->lane_b[i]];
    }
}

VECTORS static void go_on(series *s, number rows[]) {
    const nevh__recurrence *r = s->of;
    size_t each = 2 * r->n;
    for (size_t k = 1; k < s->order; k++) {
        advance(s, k, rows + k * each);
        if (k > 1)
            add_up(s, k);
        for (size_t i = 0; i < r->n_batches; i++)
            next_batch(s, &r->batches[i], k);
        note_watched(s, k);
        store(s, k);
    }
    advance(s, s->order, rows + s->order * each);
}

bool NAMED(nevh__series_expand)(series *s, real t, const real state[],
                                number rows[]) {
    size_t each = 2 * s->of->n;
    begin(s, t, state, rows);
    for (size_t i = 0; i < s->of->lanes; i++)
        s->sum[i] = narrow(0);
    go_on(s, rows);
    const number *last = rows + s->order * each;
    number bad = narrow(0);
    for (size_t i = 0; i < each; i++)
        bad = plus(bad, minus(last[i], last[i]));
    return widen(bad) == 0;
}

double NAMED(nevh__series_largest)(series *s, real t, const real state[],
                                   number row[]) {
    double most = 0;
    begin(s, t, state, row);
    for (size_t i = 0; i < s->of->values; i++)
        most = fmax(most, fabs(shorten(s->value[i])));
    return most;
}
