/* nevh: which of a number of things are connected?
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FOREST_PRIVATE_H
#define NEVH_FOREST_PRIVATE_H

#include "system/system_private.h"

/* Things that are connected have one root, the first of them.
   up       of each thing one before it that it is connected to, or itself; at first itself */
static inline size_t nevh__forest_root(size_t up[], size_t i) {
    while (up[i] != i)
        i = up[i] = up[up[i]];
    return i;
}

static inline void nevh__forest_join(size_t up[], size_t i, size_t j) {
    i = nevh__forest_root(up, i);
    j = nevh__forest_root(up, j);
    up[i > j ? i : j] = i > j ? j : i;
}

/* Returns for each coordinate the first one that terms connect it to, by coordinates or
   momenta, while they are on; to be freed; NULL: memory is out. */
size_t *nevh__components(const nevh_system *);

#endif
