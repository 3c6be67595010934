/* nevh: terms are evaluated in blocks of states.
   SPDX-License-Identifier: GPL-3.0-or-later

   Every kernel works on blocks.  A *column* is one point at which a term is
   evaluated; columns stand side by side in rows, one row a variable that the
   term reads:

       column = (copy * groups + group) * lanes + lane

   where a group is an instance (values, exact gradients: one copy) or a
   variable of an instance (differences: one copy a stencil point).  Blocks
   are padded to whole vectors; the padding repeats column 0. */
#ifndef NEVH_BLOCK_PRIVATE_H
#define NEVH_BLOCK_PRIVATE_H

#include "gradient/field_private.h"

/* Terms are evaluated in blocks of at most so many columns, and of fewer where
   a term reads so much that the rows would leave the cache. */
enum {
    NEVH__COLUMNS = 512,
    NEVH__FEWEST_COLUMNS = 64,
    NEVH__BLOCK_SIZE = 16384
};

/* The states, and the part of them in a block.  The first eight members are given;
   nevh__block_next sets the rest. */
typedef struct {
    size_t width; /* of q and p: the distance between their rows */
    size_t until; /* lanes to be done */
    size_t first; /* the lane that q and p begin with, of constants */
    const double *t, *q, *p;
    size_t copies;        /* columns of a group and lane */
    size_t per_instance;  /* groups an instance has */
    size_t lane, lanes;   /* the lanes of this block */
    size_t group, groups; /* and its groups */
    size_t used, stride;  /* columns; the same padded: the rows' length */
} nevh__block;

/* A group as a variable of an instance. */
typedef struct {
    size_t instance, v; /* v < per_instance */
} nevh__cursor;

static inline nevh__cursor nevh__first_group(const nevh__block *b) {
    if (b->group == 0)
        return (nevh__cursor){0, 0};
    return (nevh__cursor){b->group / b->per_instance,
                          b->group % b->per_instance};
}
static inline void nevh__next_group(const nevh__block *b, nevh__cursor *c) {
    if (++c->v == b->per_instance)
        *c = (nevh__cursor){c->instance + 1, 0};
}

/* Fills rows and times for the next block of a term; false after the last. */
bool nevh__block_next(nevh_field *, const nevh__planned *, nevh__block *);
/* Evaluates the term on the filled block, and counts. */
void nevh__block_evaluate(nevh_field *, nevh__planned *, const nevh__block *);
/* The same, and checks that every value is finite. */
int nevh__block_values(nevh_field *, nevh__planned *, const nevh__block *);
/* NEVH_OK if every value is finite. */
int nevh__block_check(nevh_field *, const nevh__planned *, const nevh__block *);
/* Records that something of a term ("", "a derivative of ") is not finite in
   a column. */
int nevh__block_fail(nevh_field *, const nevh__planned *, const nevh__block *,
                     size_t column, const char *what, double value);
/* The same of a point of the difference by variable k, so far from the orbit, or
   of the orbit, where it has no value either. */
int nevh__fail_outside(nevh_field *, nevh__planned *, const nevh__block *,
                       size_t column, size_t instance, size_t k, double reach);

/* All lanes of states side by side. */
static inline nevh__block nevh__block_over(size_t width, const double t[],
                                           const double q[], const double p[],
                                           size_t copies, size_t per_instance) {
    return (nevh__block){.width = width,
                         .until = width,
                         .t = t,
                         .q = q,
                         .p = p,
                         .copies = copies,
                         .per_instance = per_instance};
}

static inline const double *nevh__row(const nevh_field *f, const nevh__block *b,
                                      size_t k) {
    return f->rows + k * b->stride;
}
/* The derivative from values at x +- j delta, copies being `apart` from each
   other: + before -, nearest first. */
static inline double nevh__chord_slope(const nevh_gradient *g, size_t apart,
                                       const double *x, const double *h) {
    double slope = 0;
    for (size_t j = 0; j < g->offsets; j++) {
        size_t plus = 2 * j * apart, minus = plus + apart;
        slope += g->weights[j] * ((h[plus] - h[minus]) / (x[plus] - x[minus]));
    }
    return slope;
}
/* Adds the weighted chord slopes of one group to `out`, a value a lane; copies
   are `apart` from each other.  Returns whether one is not finite. */
bool nevh__add_slopes(const nevh_gradient *, size_t apart, size_t lanes,
                      const double *x, const double *h, double *out);
/* Tells what is not finite in a block of differences: a value, or else the
   derivative by variable k of an instance, of that lane. */
int nevh__central_fail(nevh_field *, nevh__planned *, const nevh__block *,
                       size_t lane, size_t instance, size_t k);

#endif
