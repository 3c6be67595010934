/* nevh: numbers by name.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <stdlib.h>
#include <string.h>

/* FNV-1a, http://www.isthe.com/chongo/tech/comp/fnv/ */
static size_t register_hash(const char *name) {
    uint64_t h = 0xcbf29ce484222325u;
    for (; *name; name++)
        h = (h ^ (unsigned char)*name) * 0x100000001b3u;
    return (size_t)(h ^ h >> 32);
}

/* The entry of a name, or the free one for it. */
static nevh__registered *entry_of(const nevh__register *x, const char *name) {
    size_t i = register_hash(name) & (x->capacity - 1);
    while (x->entries[i].name && strcmp(x->entries[i].name, name) != 0)
        i = (i + 1) & (x->capacity - 1);
    return &x->entries[i];
}

size_t nevh__register_find(const nevh__register *x, const char *name) {
    const nevh__registered *e = x->capacity && name ? entry_of(x, name) : NULL;
    return e && e->name ? e->at : SIZE_MAX;
}

bool nevh__register_reserve(nevh__register *x) {
    nevh__register larger = {.capacity = x->capacity ? 2 * x->capacity : 16};
    if (2 * (x->count + 1) <= x->capacity)
        return true;
    larger.entries = nevh__array(larger.capacity, sizeof *larger.entries);
    if (!larger.entries)
        return false;
    for (size_t i = 0; i < x->capacity; i++)
        if (x->entries[i].name)
            nevh__register_put(&larger, x->entries[i].name, x->entries[i].at);
    free(x->entries);
    *x = larger;
    return true;
}

void nevh__register_put(nevh__register *x, const char *name, size_t at) {
    *entry_of(x, name) = (nevh__registered){name, at};
    x->count++;
}
