/* nevh: the parts of terms that read t.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TIMING_PARTS_PRIVATE_H
#define NEVH_TIMING_PARTS_PRIVATE_H

#include "expression/range_private.h"
#include "expression/tape_inside_private.h"

/* A node of the graph, or a term that is sampled. */
typedef struct {
    bool pure;   /* reads t alone */
    bool outer;  /* what uses it reads q or p, too */
    bool turned; /* the argument of a sine or cosine */
    size_t effect;
} nevh__time_part;

enum { NEVH__MOST_SAMPLED = 16 };

/* All terms in one graph, q, p and constants being numbers; zeros at first. */
typedef struct {
    const nevh_system *system;
    const double *q, *p;
    const double *from, *to; /* NULL: q and p stay as they are */
    nevh__tape_builder *graph;
    nevh__time_part *part; /* by node, then by what is sampled */
    nevh__range *range;
    size_t nodes, count, capacity;
    struct nevh__time_sampled {
        const nevh_term *term;
        size_t instance, effect;
    } sampled[NEVH__MOST_SAMPLED];
    size_t n_sampled;
    size_t tried; /* instances, for jumps */
    double *gathered;
    bool whole;  /* nothing was left out, or is only sampled */
    bool failed; /* memory is out */
} nevh__time_parts;

void nevh__time_parts_init(nevh__time_parts *, const nevh_system *,
                           const double q[], const double p[]);
/* All terms that are formulas, on the straight line between two states, 2n + 1
   each: q, p, t.  Stretches are parts of the line, from 0 to 1. */
void nevh__time_parts_init_between(nevh__time_parts *, const nevh_system *,
                                   const double from[], const double to[]);
void nevh__time_parts_clear(nevh__time_parts *);
/* The ranges of all parts over a stretch of time. */
void nevh__time_parts_over(nevh__time_parts *, double low, double high);
/* True if terms of an effect differ before and after a time, at the state or at others
   around it: parts that jump may be read in whole periods, or cancel.  True without trial
   where there were too many. */
bool nevh__time_parts_jump(nevh__time_parts *, size_t effect, double before,
                           double after);

#endif
