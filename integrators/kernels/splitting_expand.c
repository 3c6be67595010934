/* nevh: the operations of a splitting, from the weights that are given.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "splitting_private.h"

size_t nevh__splitting_operations(const nevh_splitting *table) {
    size_t given = table->count;
    if (table->pattern == NEVH_LISTED)
        return given + 2;
    return (table->pattern == NEVH_PALINDROME ? 2 : 4) * given + 3;
}

/* Operation i, which does not follow from the sums.  Where two Verlet steps
   meet, their halves are one operation. */
static long double weight(const nevh_splitting *table, size_t i) {
    const long double *given = table->weights;
    if (table->pattern != NEVH_COMPOSITION)
        return given[i];
    if (i % 2)
        return given[i / 2];
    return ((i ? given[i / 2 - 1] : 0) + given[i / 2]) / 2;
}

/* To one of the two. */
static void put(long double weight, size_t i, double rounded[],
                long double wide[]) {
    if (rounded)
        rounded[i] = (double)weight;
    else
        wide[i] = weight;
}

static void expand(const nevh_splitting *table, double rounded[],
                   long double wide[]) {
    size_t count = nevh__splitting_operations(table);
    bool mirrored = table->pattern != NEVH_LISTED;
    size_t end = mirrored ? (count + 1) / 2 : count;
    long double left[2] = {1, 1};
    for (size_t i = 0; i < end; i++) {
        long double times = mirrored && i + 1 < end ? 2 : 1;
        long double w = i + 2 < end ? weight(table, i) : left[i % 2] / times;
        left[i % 2] -= times * w;
        put(w, i, rounded, wide);
        if (mirrored)
            put(w, count - 1 - i, rounded, wide);
    }
}

/* In long double; rounded once. */
void nevh__splitting_expand(const nevh_splitting *table, double weights[]) {
    expand(table, weights, NULL);
}

void nevh__splitting_expand_wide(const nevh_splitting *table,
                                 long double weights[]) {
    expand(table, NULL, weights);
}
