/* nevh: names in a tree get their meanings.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RESOLVE_PRIVATE_H
#define NEVH_RESOLVE_PRIVATE_H

#include "expression/formula_inside_private.h"

/* The context of a name. */
typedef struct {
    unsigned allowed;
    bool in_index;
    const nevh__index *at;
    const nevh__bound *bound;
    const char *definition; /* NULL: in the formula itself */
} nevh__place;

typedef struct {
    const nevh__names *names;
    nevh__place in;
    nevh__expression **definitions; /* by entry, NULL: not yet; where
                                     one was met */
    bool *open;                     /* by entry: being resolved */
    unsigned depth, slots;
    nevh__pool *pool;
    nevh__scope scope; /* its error is everybody's */
} nevh__resolver;

/* Each returns NULL on error. */

/* The formats take a and b in turn; the name is the first. */
void *nevh__resolver_fail(nevh__resolver *, const nevh__syntax_node *,
                          size_t length, const char *format, const char *a,
                          const char *b);
void *nevh__resolver_fail_name(nevh__resolver *, const nevh__syntax_node *,
                               const char *format, const char *b);

/* An expression with n operands to be filled in. */
nevh__expression *nevh__expression_new(nevh__resolver *, nevh__form,
                                       const nevh__syntax_node *, size_t n);
/* Sets what follows from its operands. */
nevh__expression *nevh__expression_finish(nevh__resolver *, nevh__expression *);
nevh__expression *nevh__expression_number(nevh__resolver *,
                                          const nevh__syntax_node *, double);

nevh__expression *nevh__resolve_node(nevh__resolver *,
                                     const nevh__syntax_node *);
/* The same as an index or an end of a range. */
nevh__expression *nevh__resolve_index(nevh__resolver *,
                                      const nevh__syntax_node *);
/* A name or an element. */
nevh__expression *nevh__resolve_name(nevh__resolver *,
                                     const nevh__syntax_node *);

#endif
