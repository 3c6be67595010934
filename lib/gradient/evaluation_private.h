/* nevh: a gradient is a planned evaluation.
   SPDX-License-Identifier: GPL-3.0-or-later

   Whoever takes a gradient many times at the same place in memory plans an
   evaluation, and runs it.  Evaluators are tried in order (evaluation.c); the
   first that is applicable plans it:

       exact_point      one state: a scalar function of each instance
       exact_block      whole vectors of states, whose rows are read and written
                        where they stand
       central_stencil  differences, whose points were laid out when planning
       term by term     what else there is, as nevh_field_gradient takes it:
                        exact_gather, complex_step, central_block

   Constants and buffers are made when planning and belong to the field, so
   that nothing is decided, filled anew or allocated while stepping. */
#ifndef NEVH_EVALUATION_PRIVATE_H
#define NEVH_EVALUATION_PRIVATE_H

#include "gradient/field_private.h"

enum { NEVH__MOST_PARTS = 8, NEVH__MOST_POINT_ROWS = 64 };

/* Rows of a half, at most that many, as bits. */
static inline uint64_t nevh__row_bits(size_t first, size_t count) {
    uint64_t low =
        count < NEVH__MOST_POINT_ROWS ? (UINT64_C(1) << count) - 1 : UINT64_MAX;
    return count ? low << first : 0;
}

/* A term's part of an evaluation, or that of one of its instances. */
typedef struct {
    nevh__planned *term;
    nevh_block_gradient_fn gradient;
    nevh_point_gradient_fn point;
    const void *params;
    size_t stride, size_q, size_p;
    const double *t, *q, *p, *c;
    double *dh_dq, *dh_dp; /* written by the term; NULL: not asked for */
    double *sum_q, *sum_p; /* what that is added to; NULL: it is there */
    bool sums;             /* any is added */
    const nevh__stencil *stencil;
    size_t lanes;        /* of each block of it */
    size_t pitch;        /* of constants, from a lane to the next; 0: they are
                            those of all blocks */
    bool adds_q, adds_p; /* its slopes, to what is there */
} nevh__term_part;

typedef struct nevh__evaluation {
    nevh_field *field;
    nevh__places at;
    size_t count;          /* of parts; 0: there is no such evaluation */
    bool exact;            /* by exact_point or exact_block */
    bool stencil;          /* by central_stencil */
    bool clear_q, clear_p; /* before stencils add to them */
    size_t width;          /* at.width */
    bool timed;            /* time is read, in all lanes */
    nevh__term_part terms[NEVH__MOST_PARTS];
    const double *inverse; /* n x width: of dH/dp alone, where T is that of
                              masses, what p is multiplied by; or NULL */
} nevh__evaluation;

typedef struct {
    /* Conditions on the field and the places. */
    bool (*applicable)(const nevh__evaluation *);
    /* Lists the parts; false: a condition on these is not met, or memory is
       out. */
    bool (*plan)(nevh__evaluation *);
} nevh__evaluator;

extern const nevh__evaluator nevh__exact_point, nevh__exact_block,
    nevh__central_stencil;

/* width is 1 or a multiple of NEVH__LANES, or any of differences; dh_dq or dh_dp may
   be NULL. */
nevh__evaluation nevh__evaluation_plan(nevh_field *, size_t width,
                                       const double t[], const double q[],
                                       const double p[], double dh_dq[],
                                       double dh_dp[]);
/* Adds what a part wrote beside its place. */
void nevh__evaluation_add(const nevh__term_part *);
/* Runs one by central_stencil: values are counted, and failures told. */
int nevh__central_stencil_run(const nevh__evaluation *);
/* Runs one that is exact, but looks at no result, and counts nothing: of width
   1, or of any. */
NEVH__INLINE void nevh__evaluation_run_points(const nevh__evaluation *c) {
    const nevh__term_part *x = c->terms;
    for (size_t left = c->count; left > 0; left--, x++) {
        x->point(*x->t, x->q, x->p, x->c, x->params, x->dh_dq, x->dh_dp);
        if (x->sums)
            nevh__evaluation_add(x);
    }
}
NEVH__INLINE void nevh__evaluation_run(const nevh__evaluation *c) {
    if (c->width == 1) {
        nevh__evaluation_run_points(c);
        return;
    }
    for (const nevh__term_part *x = c->terms; x < c->terms + c->count; x++) {
        x->gradient(x->stride, x->t, x->q, x->p, x->c, x->params, x->dh_dq,
                    x->dh_dp);
        if (x->sums)
            nevh__evaluation_add(x);
    }
}
/* A term's constants as blocks of all instances, or the points of a stencil,
   and `width` states have them.  Where lanes have their own: as many such blocks
   as `total` states fill.  NULL: there are none, or memory is out. */
const double *nevh__constants_plan(const nevh_field *, nevh__planned *,
                                   const nevh__stencil *, size_t width,
                                   size_t total);
/* Again, where lanes have other constants. */
void nevh__constants_fill(const nevh_field *, const nevh__planned *);
void nevh__evaluation_refresh(const nevh__evaluation *); /* one's alone */
void nevh__constants_free(struct nevh__constants *);
/* Columns of a stencil and a state; the instance of each. */
size_t nevh__stencil_points(const nevh__stencil *);
size_t nevh__stencil_instance(const nevh__stencil *, size_t point);

/* The evaluation of the field itself: nevh_field_gradient at one state. */
bool nevh__single_plan(nevh_field *); /* false: memory is out */
void nevh__single_free(struct nevh__single *);

#endif
