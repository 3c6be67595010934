/* nevh: instances of a term that are pairs of bodies.

   Their order is that of pairs of blocks of eight bodies.  Each pair of blocks begins
   with the bodies a and b whose places in their blocks are the same, in the order of
   a; then come those where the place of b is 1 further on, modulo 8, and so on to 7.
   The eight pairs of one such turn have eight first and eight second bodies.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PAIRS_PRIVATE_H
#define NEVH_PAIRS_PRIVATE_H

#include "system/system_private.h"

/* Coordinates of pairs: those of the first body and those of the second. */
typedef struct {
    size_t nq, count;
    const size_t *q;    /* count x nq */
    uint64_t of_second; /* bits: variables of the second body */
    size_t first;       /* a variable of the first body, */
    size_t second;      /* and one of the second */
    size_t origin;      /* the coordinate that these two are of body 0 */
    size_t bodies[2];   /* the first and the second go up to these */
    bool same;          /* some coordinates are read of both */
} nevh__pairs;

/* True if instances are pairs of enough bodies for blocks; np: momenta. */
bool nevh__pairs_find(nevh__pairs *, size_t nq, size_t np, size_t count,
                      const size_t q[]);
static inline size_t nevh__pairs_body(const nevh__pairs *x, size_t instance,
                                      bool second) {
    return x->q[instance * x->nq + (second ? x->second : x->first)] - x->origin;
}
/* The coordinate that is variable k of body 0. */
static inline size_t nevh__pairs_base(const nevh__pairs *x, size_t k) {
    return x->q[k] - nevh__pairs_body(x, 0, x->of_second >> k & 1);
}
/* The variable of the first body that stands for the same coordinates as variable k
   of the second; SIZE_MAX: none does. */
size_t nevh__pairs_partner(const nevh__pairs *, size_t k);
/* The place of an instance: of two blocks, how far they are turned, and a lane. */
size_t nevh__pairs_key(const nevh__pairs *, size_t instance);
/* True if keys rise, and in a block that is paired with itself each pair's second
   body is behind the first. */
bool nevh__pairs_are_turned(const nevh__pairs *);
/* The instances in the order of their keys; NULL when memory is out. */
size_t *nevh__pairs_order(const nevh__pairs *);

#endif
