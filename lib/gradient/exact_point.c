/* nevh: exact gradients of one state, instance by instance, in numbers.

   Numbers that were stored one by one wait long to be loaded as a vector, so
   that a function of numbers takes half to a quarter of the time of a block.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/evaluation_private.h"

static bool exact_point_applicable(const nevh__evaluation *e) {
    const nevh_field *f = e->field;
    if (f->gradient != nevh_exact)
        return false; /* terms need not bring derivatives */
    if (e->width != 1)
        return false; /* such functions take one state */
    if (f->lanes)
        return false; /* its constants are a lane's */
    if (f->n > NEVH__MOST_POINT_ROWS)
        return false; /* rows are counted as bits, and calls are for few */
    for (size_t i = 0; i < f->n_terms; i++)
        if (nevh__wanted(f, &e->at, &f->terms[i]) &&
            !f->terms[i].term->decl.point_gradient)
            return false; /* it brings blocks alone */
    return true;
}

/* One half of what an instance gives: written if nothing is there, added if
   something is everywhere, and else there is no way. */
static bool exact_point_direct(uint64_t *there, uint64_t here, double *half,
                               double *beside, double **written, double **sum) {
    uint64_t met = *there & here;
    *sum = met ? half : NULL;
    *written = met ? beside : half;
    *there |= here;
    return !met || met == here;
}

static bool exact_point_add_part(nevh__evaluation *e, nevh__planned *term,
                                 size_t instance, uint64_t there[2]) {
    const nevh_term *decl = &term->term->decl;
    const size_t *all_q = decl->q + instance * term->nq;
    const size_t *all_p = decl->p + instance * term->np;
    size_t q = term->nq ? all_q[0] : 0, p = term->np ? all_p[0] : 0;
    if (e->count == NEVH__MOST_PARTS ||
        (term->nq && !nevh__contiguous(all_q, term->nq, 1)) ||
        (term->np && !nevh__contiguous(all_p, term->np, 1)))
        return false;
    nevh__term_part *x = &e->terms[e->count++];
    *x =
        (nevh__term_part){.term = term,
                          .point = decl->point_gradient,
                          .params = decl->params,
                          .size_q = e->at.dh_dq ? term->nq : 0,
                          .size_p = e->at.dh_dp ? term->np : 0,
                          .t = decl->time ? e->at.t : e->field->zeros,
                          .q = e->at.q + q,
                          .p = e->at.p + p,
                          .c = decl->nc ? decl->c + instance * decl->nc : NULL};
    double *beside = e->field->slopes;
    bool known = true;
    if (x->size_q)
        known &=
            exact_point_direct(&there[0], nevh__row_bits(q, x->size_q),
                               e->at.dh_dq + q, beside, &x->dh_dq, &x->sum_q);
    if (x->size_p)
        known &= exact_point_direct(&there[1], nevh__row_bits(p, x->size_p),
                                    e->at.dh_dp + p, beside + term->nq,
                                    &x->dh_dp, &x->sum_p);
    x->sums = x->sum_q || x->sum_p;
    e->timed |= decl->time;
    return known;
}

static bool exact_point_plan(nevh__evaluation *e) {
    nevh_field *f = e->field;
    uint64_t there[2] = {0, 0}, all = nevh__row_bits(0, f->n);
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++)
        for (size_t i = 0;
             nevh__wanted(f, &e->at, term) && i < term->term->decl.count; i++)
            if (!exact_point_add_part(e, term, i, there))
                return false;
    return (!e->at.dh_dq || there[0] == all) &&
           (!e->at.dh_dp || there[1] == all);
}

const nevh__evaluator nevh__exact_point = {exact_point_applicable,
                                           exact_point_plan};
