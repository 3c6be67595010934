/* nevh: exact gradients that are taken many times at the same place in memory.

   All that can be known beforehand is: a call is a list of terms to evaluate,
   the first of which writes each half, and others are added to it.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <nevh/body.h>

/* One half of what a term gives: it is written if it is the first, else to
   scratch, and added. */
static void direct(const nevh__planned *term, const nevh__planned *writer,
                   const size_t index[], size_t width, double *half,
                   double *scratch, double **written, double **sum) {
    *sum = term == writer ? NULL : half + index[0] * width;
    *written = term == writer ? half : scratch;
}

static bool add_term(nevh__call *c, nevh__planned *term, const double t[],
                     const double q[], const double p[]) {
    nevh_field *f = c->field;
    const nevh_term *is = &term->term->is;
    size_t width = c->width, stride = is->count * width;
    if (c->count == NEVH__MOST_CALLED || !term->straight ||
        stride > f->capacity || (is->time && is->count > 1))
        return false;
    nevh__called *x = &c->terms[c->count++];
    *x = (nevh__called){.term = term,
                        .gradient = is->gradient,
                        .params = is->params,
                        .stride = stride,
                        .t = is->time ? t : f->zeros,
                        .q = term->nq ? q + is->q[0] * width : q,
                        .p = term->np ? p + is->p[0] * width : p,
                        .c = term->constants};
    c->timed |= is->time;
    if (c->half[0] && term->nq) {
        x->size_q = stride * term->nq;
        direct(term, f->writer_q, is->q, width, c->half[0], f->slopes,
               &x->dh_dq, &x->sum_q);
    }
    if (c->half[1] && term->np) {
        x->size_p = stride * term->np;
        direct(term, f->writer_p, is->p, width, c->half[1],
               f->slopes + stride * term->nq, &x->dh_dp, &x->sum_p);
    }
    return true;
}

nevh__call nevh__call_plan(nevh_field *f, size_t width, const double t[],
                           const double q[], const double p[], double dh_dq[],
                           double dh_dp[]) {
    nevh__call c = {.field = f, .width = width, .half = {dh_dq, dh_dp}};
    if (f->gradient != nevh_exact || nevh__field_ready(f) ||
        width % NEVH__LANES || (dh_dq && !f->writer_q) ||
        (dh_dp && !f->writer_p))
        return (nevh__call){0};
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++)
        if (((dh_dq && term->nq) || (dh_dp && term->np)) &&
            !add_term(&c, term, t, q, p))
            return (nevh__call){0};
    return c;
}

bool nevh__call_renew(nevh__call *c) {
    if (!c->count || nevh__field_ready(c->field))
        return false;
    for (nevh__called *x = c->terms; x < c->terms + c->count; x++)
        nevh__lean_constants(x->term, c->width, x->stride);
    return true;
}

NEVH_SIMD static void add(size_t size, const double x[], double sum[]) {
    NEVH_LANES(i, size) {
        sum[i] += x[i];
    }
}

void nevh__call_add(const nevh__called *x) {
    if (x->sum_q)
        add(x->size_q, x->dh_dq, x->sum_q);
    if (x->sum_p)
        add(x->size_p, x->dh_dp, x->sum_p);
}

bool nevh__call_take(const nevh__call *c) {
    double sum = 0;
    nevh__call_run(c);
    for (size_t half = 0; half < 2; half++)
        for (size_t k = 0; c->half[half] && k < c->field->n; k++) {
            double x = c->half[half][k * c->width];
            sum += x - x;
        }
    if (sum != 0)
        return false;
    if (c->half[0])
        c->field->gradients++;
    return true;
}
