/* nevh: pairs of bodies, and their order in blocks.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/pairs_private.h"
#include <stdlib.h>

/* Pairs, and pairs a body, from which on blocks pay. */
enum { FEWEST_PAIRS = 16, PAIRS_A_BODY = 2, MOST_VARIABLES = 64 };

static bool moves_with(const nevh__pairs *x, size_t k, size_t with) {
    for (size_t i = 1; i < x->count; i++)
        if (x->q[i * x->nq + k] - x->q[k] !=
            x->q[i * x->nq + with] - x->q[with])
            return false;
    return true;
}

static size_t pairs_distance(size_t a, size_t b) {
    return a > b ? a - b : b - a;
}

/* Sets which variables are of the second body, and that of them which is nearest to
   the first body's first. */
static bool pairs_divide(nevh__pairs *x) {
    size_t other = SIZE_MAX;
    for (size_t k = 0; k < x->nq; k++) {
        if (moves_with(x, k, 0))
            continue;
        if (other == SIZE_MAX)
            other = x->second = k;
        if (!moves_with(x, k, other))
            return false;
        x->of_second |= (uint64_t)1 << k;
        if (pairs_distance(x->q[k], x->q[0]) <
            pairs_distance(x->q[x->second], x->q[0]))
            x->second = k;
    }
    return other != SIZE_MAX;
}

/* The first body is that which comes first in the state. */
static void set_first(nevh__pairs *x) {
    size_t second = x->second;
    if (x->q[0] < x->q[second])
        return;
    x->of_second ^= UINT64_MAX >> (MOST_VARIABLES - x->nq);
    x->second = 0;
    x->first = second;
}

static void count_bodies(nevh__pairs *x) {
    x->origin = SIZE_MAX;
    for (size_t i = 0; i < x->count; i++) {
        size_t a = x->q[i * x->nq + x->first], b = x->q[i * x->nq + x->second];
        size_t least = a < b ? a : b;
        x->origin = least < x->origin ? least : x->origin;
    }
    for (size_t i = 0; i < x->count; i++)
        for (int half = 0; half < 2; half++) {
            size_t body = nevh__pairs_body(x, i, half);
            if (body >= x->bodies[half])
                x->bodies[half] = body + 1;
        }
}

/* True if no two variables share coordinates, but for one of each body that share
   all. */
static bool stand_apart(nevh__pairs *x, size_t span) {
    for (size_t k = 0; k < x->nq; k++)
        for (size_t j = 0; j < k; j++) {
            size_t gap =
                pairs_distance(nevh__pairs_base(x, k), nevh__pairs_base(x, j));
            bool alike = !((x->of_second >> k ^ x->of_second >> j) & 1);
            if (gap < span && (gap > 0 || alike))
                return false;
            x->same |= gap == 0;
        }
    return true;
}

bool nevh__pairs_find(nevh__pairs *x, size_t nq, size_t np, size_t count,
                      const size_t q[]) {
    *x = (nevh__pairs){.nq = nq, .count = count, .q = q};
    if (np || nq > MOST_VARIABLES || count < FEWEST_PAIRS || !pairs_divide(x))
        return false;
    set_first(x);
    count_bodies(x);
    size_t first = x->bodies[0], second = x->bodies[1];
    size_t span = first > second ? first : second;
    if (count < PAIRS_A_BODY * span || !stand_apart(x, span))
        return false;
    if (x->same)
        x->bodies[0] = x->bodies[1] = span;
    return true;
}

size_t nevh__pairs_partner(const nevh__pairs *x, size_t k) {
    for (size_t j = 0; x->of_second >> k & 1 && j < x->nq; j++)
        if (!(x->of_second >> j & 1) &&
            nevh__pairs_base(x, j) == nevh__pairs_base(x, k))
            return j;
    return SIZE_MAX;
}

size_t nevh__pairs_key(const nevh__pairs *x, size_t instance) {
    size_t a = nevh__pairs_body(x, instance, false),
           b = nevh__pairs_body(x, instance, true);
    size_t blocks = x->bodies[1] / NEVH__LANES + 1;
    size_t turn = (b + NEVH__LANES - a % NEVH__LANES) % NEVH__LANES;
    return ((a / NEVH__LANES * blocks + b / NEVH__LANES) * NEVH__LANES + turn) *
               NEVH__LANES +
           a % NEVH__LANES;
}

bool nevh__pairs_are_turned(const nevh__pairs *x) {
    for (size_t i = 0; i < x->count; i++) {
        size_t a = nevh__pairs_body(x, i, false),
               b = nevh__pairs_body(x, i, true);
        if (x->same && a / NEVH__LANES == b / NEVH__LANES && a >= b)
            return false;
        if (i > 0 && nevh__pairs_key(x, i) <= nevh__pairs_key(x, i - 1))
            return false;
    }
    return true;
}

typedef struct {
    size_t key, instance;
} keyed;

static int by_key(const void *a, const void *b) {
    const keyed *x = a, *y = b;
    return (x->key > y->key) - (x->key < y->key);
}

size_t *nevh__pairs_order(const nevh__pairs *x) {
    keyed *all = nevh__array(x->count, sizeof *all);
    size_t *order = nevh__array(x->count, sizeof *order);
    for (size_t i = 0; all && order && i < x->count; i++)
        all[i] = (keyed){nevh__pairs_key(x, i), i};
    if (all && order)
        qsort(all, x->count, sizeof *all, by_key);
    for (size_t i = 0; all && order && i < x->count; i++)
        order[i] = all[i].instance;
    if (!all) {
        free(order);
        order = NULL;
    }
    free(all);
    return order;
}
