/* nevh: the stencil of a term with one instance, laid out when planned.

   For a few orbits most time would go into bookkeeping, and into waiting for
   single numbers just written to be read back as vectors.  So the points are
   made whole: each row is its variable plus a row of shifts, -0 where the
   variable is not moved (x + -0 is x to the last bit, also for -0).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <nevh/body.h>
#include <stdlib.h>

enum { MOST_VARIABLES = 16 };

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
    if (s->groups == 0 || s->used > f->capacity || term->nv > MOST_VARIABLES)
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

/* One lane: each row is a number plus a row of shifts, padding and all. */
NEVH_SIMD static void shift_one(size_t rows, size_t stride, const double *x,
                                const double *shift, double *row) {
    for (size_t k = 0; k < rows; k++, shift += stride, row += stride) {
        double value = x[k];
        NEVH_LANES(i, stride)
        row[i] = value + shift[i];
    }
}

/* Many: each point is a row of numbers plus a shift. */
NEVH_SIMD static void shift_many(size_t points, size_t lanes, const double *x,
                                 const double *shift, double *row) {
    for (size_t i = 0; i < points; i++, row += lanes)
        for (size_t lane = 0; lane < lanes; lane++)
            row[lane] = x[lane] + shift[i];
}

static void fill_one(nevh_field *f, const nevh__planned *term,
                     const nevh__block *b, const nevh__stencil *s) {
    const nevh_term *is = &term->term->is;
    const double *q = b->q + b->lane, *p = b->p + b->lane;
    double x[MOST_VARIABLES];
    for (size_t k = 0; k < term->nq; k++)
        x[k] = q[is->q[k] * b->width];
    for (size_t k = 0; k < term->np; k++)
        x[term->nq + k] = p[is->p[k] * b->width];
    shift_one(term->nv, s->stride, x, s->shift, f->rows);
}

static void fill_many(nevh_field *f, const nevh__planned *term,
                      const nevh__block *b, const nevh__stencil *s) {
    double *row = f->rows;
    for (size_t k = 0; k < term->nv; k++, row += b->stride) {
        const double *x = k < term->nq ? b->q : b->p;
        shift_many(s->used, b->lanes,
                   x + nevh__index(term, 0, k) * b->width + b->lane,
                   s->shift + k * s->stride, row);
        for (size_t i = b->used; i < b->stride; i++)
            row[i] = row[0];
    }
}

static void fill_times(const nevh__block *b, double *times) {
    for (size_t i = 0; i < b->stride; i++)
        times[i] = b->t[b->lane + i % b->lanes];
}

static void fill(nevh_field *f, const nevh__planned *term, const nevh__block *b,
                 const nevh__stencil *s) {
    const nevh_term *is = &term->term->is;
    double *row = f->rows + term->nv * b->stride;
    if (b->lanes == 1)
        fill_one(f, term, b, s);
    else
        fill_many(f, term, b, s);
    for (size_t k = 0; k < is->nc; k++, row += b->stride)
        for (size_t i = 0; i < b->stride; i++)
            row[i] = is->c[k];
    if (is->time)
        fill_times(b, f->times);
}

/* Lanes that fit into one block: all, or whole vectors of them. */
static void set_size(const nevh_field *f, const nevh__stencil *s,
                     nevh__block *b) {
    b->lanes = b->until - b->lane;
    if (b->lanes * s->used > f->capacity) {
        size_t most = f->capacity / s->used;
        b->lanes = most > NEVH__LANES ? most / NEVH__LANES * NEVH__LANES : most;
    }
    b->groups = s->groups;
    b->used = s->used * b->lanes;
    b->stride = nevh__padded(b->used);
}

static double *target(const nevh__planned *term, const nevh__block *b, size_t k,
                      double dh_dq[], double dh_dp[]) {
    const nevh_term *is = &term->term->is;
    double *out = k < term->nq ? dh_dq + is->q[k] * b->width
                               : dh_dp + is->p[k - term->nq] * b->width;
    return out + b->lane;
}

/* Both add the slopes of all groups, and return the first of them at which one
   is not finite; the number of groups if there is none. */
static size_t add_one(const nevh_field *f, const nevh__planned *term,
                      const nevh__block *b, const nevh__stencil *s,
                      const nevh_gradient *g, double dh_dq[], double dh_dp[]) {
    size_t groups = s->groups, bad = groups;
    for (size_t i = 0; i < groups; i++) {
        size_t k = s->vars[i];
        const double *x = f->rows + k * s->stride + i;
        double slope = nevh__chord_slope(g, groups, x, f->h + i);
        *target(term, b, k, dh_dq, dh_dp) += slope;
        bad = slope - slope != 0 && bad == groups ? i : bad;
    }
    return bad;
}

static size_t add_many(const nevh_field *f, const nevh__planned *term,
                       const nevh__block *b, const nevh__stencil *s,
                       const nevh_gradient *g, double dh_dq[], double dh_dp[]) {
    size_t apart = s->groups * b->lanes;
    for (size_t i = 0; i < s->groups; i++) {
        size_t k = s->vars[i], first = i * b->lanes;
        const double *x = f->rows + k * b->stride + first;
        if (nevh__add_slopes(g, apart, b->lanes, x, f->h + first,
                             target(term, b, k, dh_dq, dh_dp)))
            return i;
    }
    return s->groups;
}

int nevh__stencil_difference(nevh_field *f, nevh__planned *term,
                             const nevh__stencil *s, const nevh_gradient *g,
                             nevh__block *b, double dh_dq[], double dh_dp[]) {
    for (; b->lane < b->until; b->lane += b->lanes) {
        set_size(f, s, b);
        fill(f, term, b, s);
        nevh__block_evaluate(f, term, b);
        size_t bad = (b->lanes == 1 ? add_one : add_many)(f, term, b, s, g,
                                                          dh_dq, dh_dp);
        if (bad < s->groups)
            return nevh__central_fail(f, term, b, 0, s->vars[bad]);
    }
    return NEVH_OK;
}
