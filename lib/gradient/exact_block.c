/* nevh: exact gradients of whole vectors of states, in place.

   The rows of a term's block are read where the states are, and written where
   the gradient goes by the first term that has a share in it; the slopes of
   others are added.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "gradient/evaluation_private.h"
#include <nevh/body.h>

/* Instances that a state repeated over a vector may have, and variables: more
   of them cost more than to gather one vector of instances. */
enum { MOST_BROADCAST = 2, MOST_ROWS = 8 };

/* True if the rows of all variables are consecutive in the state, as in a block. */
static bool stands(const nevh__planned *term) {
    const nevh_term *decl = &term->term->decl;
    return (!term->nq || nevh__contiguous(decl->q, term->nq, decl->count)) &&
           (!term->np || nevh__contiguous(decl->p, term->np, decl->count));
}

bool nevh__exact_block_broadcasts(const nevh_field *f) {
    for (size_t i = 0; i < f->n_terms; i++)
        if (f->terms[i].term->decl.count > MOST_BROADCAST ||
            !stands(&f->terms[i]))
            return false;
    return f->n <= MOST_ROWS;
}

static bool exact_block_applicable(const nevh__evaluation *e) {
    const nevh_field *f = e->field;
    if (f->gradient != nevh_exact)
        return false; /* terms need not bring derivatives */
    if (e->width % NEVH__LANES)
        return false; /* nothing may be written beyond the rows */
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__planned *term = &f->terms[i];
        const nevh_term *decl = &term->term->decl;
        if (!nevh__wanted(f, &e->at, term))
            continue;
        if (!stands(term))
            return false; /* variables would have to be gathered */
        if (decl->count * e->width > f->capacity)
            return false; /* slopes that are added have no more room */
        if (decl->time && decl->count > 1)
            return false; /* the row of times is one state's */
    }
    return true;
}

/* All of a half stands for its rows where these are too many for bits. */
static uint64_t exact_block_rows_of(const nevh__evaluation *e, size_t first,
                                    size_t count) {
    return e->field->n > NEVH__MOST_POINT_ROWS ? UINT64_MAX
                                               : nevh__row_bits(first, count);
}

/* Chooses where a part writes one half of the gradient: in place if no part has
   written there, else beside it, to be added.  False if parts have written only
   some of its rows. */
static bool exact_block_direct(const nevh__evaluation *e, size_t first,
                               size_t size, uint64_t *there, double *half,
                               double *beside, double **written, double **sum) {
    uint64_t here = exact_block_rows_of(e, first, size / e->width),
             met = *there & here;
    *written = met ? beside : half + first * e->width;
    *sum = met ? half + first * e->width : NULL;
    *there |= here;
    bool counted = e->field->n <= NEVH__MOST_POINT_ROWS;
    return met ? met == here : counted || size == e->field->n * e->width;
}

static bool exact_block_add_part(nevh__evaluation *e, nevh__planned *term,
                                 uint64_t there[2]) {
    nevh_field *f = e->field;
    const nevh_term *decl = &term->term->decl;
    size_t width = e->width, stride = decl->count * width;
    double *slopes_p = f->slopes + stride * term->nq;
    if (e->count == NEVH__MOST_PARTS)
        return false;
    nevh__term_part *x = &e->terms[e->count++];
    *x = (nevh__term_part){
        .term = term,
        .gradient = decl->gradient,
        .params = decl->params,
        .stride = stride,
        .t = decl->time ? e->at.t : f->zeros,
        .q = term->nq ? e->at.q + decl->q[0] * width : e->at.q,
        .p = term->np ? e->at.p + decl->p[0] * width : e->at.p,
        .c = nevh__constants_plan(f, term, NULL, width, width)};
    bool known = !decl->nc || x->c;
    f->starved |= !known;
    e->timed |= decl->time;
    if (e->at.dh_dq && term->nq) {
        x->size_q = stride * term->nq;
        known &=
            exact_block_direct(e, decl->q[0], x->size_q, &there[0], e->at.dh_dq,
                               f->slopes, &x->dh_dq, &x->sum_q);
    }
    if (e->at.dh_dp && term->np) {
        x->size_p = stride * term->np;
        known &=
            exact_block_direct(e, decl->p[0], x->size_p, &there[1], e->at.dh_dp,
                               slopes_p, &x->dh_dp, &x->sum_p);
    }
    x->sums = x->sum_q || x->sum_p;
    return known;
}

static bool exact_block_plan(nevh__evaluation *e) {
    nevh_field *f = e->field;
    uint64_t there[2] = {0, 0}, all = exact_block_rows_of(e, 0, f->n);
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++)
        if (nevh__wanted(f, &e->at, term) &&
            !exact_block_add_part(e, term, there))
            return false;
    return (!e->at.dh_dq || there[0] == all) &&
           (!e->at.dh_dp || there[1] == all);
}

const nevh__evaluator nevh__exact_block = {exact_block_applicable,
                                           exact_block_plan};
