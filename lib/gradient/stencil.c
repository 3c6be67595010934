/* nevh: the stencil of a term with one instance, laid out when planned.

   For a single orbit most time would go into bookkeeping, and into waiting for
   single numbers just written to be read back as vectors.  So the points are
   made whole: each row is its variable plus a row of shifts, -0 where the
   variable is not moved (x + -0 is x to the last bit, also for -0).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <nevh/body.h>
#include <stdlib.h>

/* Which part of a pass a stencil is for. */
static size_t part_of(const double dh_dq[], const double dh_dp[]) {
    return dh_dq && dh_dp ? 2 : dh_dp ? 1 : 0;
}

static void fill_shift(const nevh__planned *term, const nevh__pass *pass,
                       nevh__stencil *s, double *shift) {
    for (size_t i = 0; i < term->nv * s->stride; i++)
        shift[i] = -0.0;
    for (size_t g = 0; g < s->groups; g++) {
        size_t k = s->vars[g];
        double *row = shift + k * s->stride + g;
        for (size_t j = 0; j < pass->pairs; j++) {
            double move = (double)(j + 1) * term->delta[k];
            row[2 * j * s->groups] = move;
            row[(2 * j + 1) * s->groups] = -move;
        }
    }
}

/* Returns false when memory is out; a part that is empty or does not fit into
   one block is left without shifts, and goes the long way. */
static bool plan_part(const nevh_field *f, const nevh__planned *term,
                      const nevh__pass *pass, size_t part, nevh__stencil *s) {
    size_t begin = part == 1 ? pass->first_p : pass->begin;
    size_t end = part == 0 ? pass->first_p : pass->end;
    s->vars = term->vars + begin;
    s->groups = end - begin;
    s->pairs = pass->pairs;
    s->used = 2 * s->groups * s->pairs;
    s->stride = nevh__padded(s->used);
    if (s->groups == 0 || s->used > f->capacity || term->nv > 16)
        return true;
    s->shift = nevh__array(term->nv * s->stride, sizeof *s->shift);
    if (!s->shift)
        return false;
    fill_shift(term, pass, s, s->shift);
    return true;
}

bool nevh__stencil_plan(const nevh_field *f, nevh__planned *term) {
    if (term->term->is.count != 1)
        return true;
    for (size_t i = 0; i < 2; i++)
        for (size_t part = 0; part < 3; part++)
            if (!plan_part(f, term, &term->pass[i], part,
                           &term->stencil[i][part]))
                return false;
    return true;
}

void nevh__stencil_free(nevh__planned *term) {
    for (size_t i = 0; i < 2; i++)
        for (size_t part = 0; part < 3; part++)
            free(term->stencil[i][part].shift);
}

const nevh__stencil *nevh__stencil_for(const nevh__planned *term, int pass,
                                       const double dh_dq[],
                                       const double dh_dp[]) {
    const nevh__stencil *s = &term->stencil[pass][part_of(dh_dq, dh_dp)];
    return s->shift ? s : NULL;
}

NEVH_SIMD static void add_shift(size_t stride, double x, const double *shift,
                                double *row) {
    NEVH_LANES(i, stride)
    row[i] = x + shift[i];
}

static void fill(nevh_field *f, const nevh__planned *term, const nevh__block *b,
                 const nevh__stencil *s) {
    const nevh_term *is = &term->term->is;
    const double *shift = s->shift;
    double *row = f->rows;
    size_t stride = s->stride;
    for (size_t k = 0; k < term->nq; k++, row += stride, shift += stride)
        add_shift(stride, b->q[is->q[k]], shift, row);
    for (size_t k = 0; k < term->np; k++, row += stride, shift += stride)
        add_shift(stride, b->p[is->p[k]], shift, row);
    for (size_t k = 0; k < is->nc; k++, row += stride)
        for (size_t i = 0; i < stride; i++)
            row[i] = is->c[k];
    for (size_t i = 0; is->time && i < stride; i++)
        f->times[i] = b->t[0];
}

int nevh__stencil_difference(nevh_field *f, nevh__planned *term,
                             const nevh__stencil *s, const nevh_gradient *g,
                             nevh__block *b, double dh_dq[], double dh_dp[]) {
    b->lanes = 1;
    b->groups = s->groups;
    b->used = s->used;
    b->stride = s->stride;
    fill(f, term, b, s);
    nevh__block_evaluate(f, term, b);
    const nevh_term *is = &term->term->is;
    for (size_t i = 0; i < s->groups; i++) {
        size_t k = s->vars[i];
        const double *x = f->rows + k * s->stride + i, *h = f->h + i;
        double slope = 0;
        for (size_t j = 0; j < s->pairs; j++) {
            size_t plus = 2 * j * s->groups, minus = plus + s->groups;
            slope +=
                g->weights[j] * ((h[plus] - h[minus]) / (x[plus] - x[minus]));
        }
        if (k < term->nq)
            dh_dq[is->q[k]] += slope;
        else
            dh_dp[is->p[k - term->nq]] += slope;
        if (slope - slope != 0)
            return nevh__central_fail(f, term, b, 0, k);
    }
    return NEVH_OK;
}
