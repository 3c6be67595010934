/* nevh: which variables a part of a formula reads.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <stdlib.h>

typedef struct {
    uint64_t *hashes;
    size_t n, capacity;
    uint64_t stamp;
} set;

/* Collects variables; what has no memory is recorded as n = SIZE_MAX. */
static bool variables_add(set *s, uint64_t hash) {
    if (s->n == s->capacity) {
        size_t capacity = s->capacity ? 2 * s->capacity : 16;
        uint64_t *grown = nevh__grow(s->hashes, capacity, sizeof *grown);
        if (!grown)
            return false;
        s->hashes = grown;
        s->capacity = capacity;
    }
    s->hashes[s->n++] = hash;
    return true;
}

static bool variables_collect(set *s, nevh__expression *e) {
    bool fine = true;
    if (!e->reads || e->stamp == s->stamp)
        return true;
    e->stamp = s->stamp;
    if (e->form == NEVH__FORM_VARIABLE || e->form == NEVH__FORM_TIME)
        return variables_add(s, e->hash);
    for (size_t i = 0; fine && i < e->n; i++)
        fine = variables_collect(s, e->operands[i].of);
    return fine;
}

static int variables_compare(const void *a, const void *b) {
    uint64_t left = *(const uint64_t *)a, right = *(const uint64_t *)b;
    return (left > right) - (left < right);
}

bool nevh__variables_hash(nevh__parts *parts, const nevh__summand *s,
                          uint64_t *hash) {
    set all = {.stamp = ++parts->stamp};
    bool fine = true;
    for (size_t i = 0; fine && i < s->n; i++)
        fine = variables_collect(&all, s->factors[i].of);
    if (all.n)
        qsort(all.hashes, all.n, sizeof *all.hashes, variables_compare);
    *hash = 0;
    for (size_t i = 0; i < all.n; i++)
        if (i == 0 || all.hashes[i] != all.hashes[i - 1])
            *hash = (*hash ^ all.hashes[i]) * 0x9E3779B97F4A7C15u;
    free(all.hashes);
    return fine;
}
