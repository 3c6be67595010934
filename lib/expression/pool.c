/* nevh: memory that is freed as a whole.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/formula_inside_private.h"
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Sizes of the first chunk and of the largest; each is twice as large as the one
   before. */
enum { FEWEST = 512, MOST = 16 << 10 };

struct nevh__chunk {
    struct nevh__chunk *next;
    size_t used, size;
    max_align_t bytes[];
};

static struct nevh__chunk *new_chunk(nevh__pool *pool, size_t bytes) {
    size_t size = pool->chunks ? 2 * pool->chunks->size : FEWEST;
    size = size < MOST ? size : MOST;
    size = size > bytes ? size : bytes;
    struct nevh__chunk *chunk = nevh__array(1, sizeof *chunk + size);
    if (!chunk)
        return NULL;
    chunk->next = pool->chunks;
    chunk->size = size;
    return pool->chunks = chunk;
}

void *nevh__pool_take(nevh__pool *pool, size_t count, size_t size) {
    const size_t unit = sizeof(max_align_t);
    if (count > (SIZE_MAX / 2 - unit) / size)
        return NULL;
    size_t bytes = (count * size + unit - 1) / unit * unit;
    struct nevh__chunk *chunk = pool->chunks;
    if (!chunk || chunk->size - chunk->used < bytes)
        chunk = new_chunk(pool, bytes);
    if (!chunk)
        return NULL;
    void *taken = (char *)chunk->bytes + chunk->used;
    chunk->used += bytes;
    return taken;
}

char *nevh__pool_keep(nevh__pool *pool, char *text) {
    char *kept = text ? nevh__pool_take(pool, strlen(text) + 1, 1) : NULL;
    if (kept)
        strcpy(kept, text);
    free(text);
    return kept;
}

void nevh__pool_free(nevh__pool *pool) {
    while (pool->chunks) {
        struct nevh__chunk *next = pool->chunks->next;
        free(pool->chunks);
        pool->chunks = next;
    }
}
