/* nevh: the derivatives that terms bring, of any states: variables are gathered
   into the rows of a block, and slopes are added to what they belong to.

   Where all instances fit into one block, maps and constants lie ready.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression/tape_private.h"
#include "gradient/block_private.h"
#include "system/pairs_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

/* Terms that do not fit into one block need no maps. */
static bool exact_gather_plan_term(const nevh_field *f, nevh__planned *term,
                                   size_t uses[]) {
    const nevh_term *decl = &term->term->decl;
    size_t constants = decl->nc * f->capacity;
    nevh__pairs pairs;
    term->turned =
        nevh__pairs_find(&pairs, term->nq, term->np, decl->count, decl->q) &&
        nevh__pairs_are_turned(&pairs);
    term->turned |= term->members != NULL;
    if (decl->count > f->capacity)
        return true;
    if (constants &&
        !(term->gathered = nevh__array(constants, sizeof *term->gathered)))
        return false;
    term->mapped =
        nevh__scatter_map_init(&term->to_q, uses, term->nq, decl->count,
                               decl->q, term->turned) &&
        nevh__scatter_map_init(&term->to_p, uses, term->np, decl->count,
                               decl->p, term->members != NULL);
    return term->mapped;
}

bool nevh__exact_gather_plan(nevh_field *f) {
    bool q = false, p = false; /* whether a term has a share in them */
    size_t *uses = nevh__array(f->n, sizeof *uses);
    bool fine = uses;
    for (size_t i = 0; fine && i < f->n_pieces; i++) {
        nevh__planned *term = f->pieces[i];
        fine = exact_gather_plan_term(f, term, uses);
        size_t count = term->term->decl.count;
        if (!q && term->to_q.contiguous && term->nq * count == f->n)
            f->whole_q = term;
        if (!p && term->to_p.contiguous && term->np * count == f->n)
            f->whole_p = term;
        q |= term->nq > 0;
        p |= term->np > 0;
    }
    free(uses);
    return fine;
}

/* The constants of the last width are kept. */
static inline const double *exact_gather_constants(const nevh_field *f,
                                                   nevh__planned *term,
                                                   size_t width,
                                                   size_t stride) {
    const nevh_term *decl = &term->term->decl;
    size_t used = decl->count * width;
    if (term->gathered_width != width)
        for (size_t k = 0; k < decl->nc; k++)
            for (size_t i = 0; i < stride; i++)
                term->gathered[k * stride + i] =
                    nevh__constant(f, term, i < used ? i / width : 0, k,
                                   nevh__lane_of(f, width, i % width));
    term->gathered_width = width;
    return term->gathered;
}

static inline const double *exact_gather_times(nevh_field *f,
                                               const nevh_term *decl,
                                               const nevh__places *at,
                                               size_t stride) {
    size_t used = decl->count * at->width;
    if (!decl->time)
        return f->zeros;
    for (size_t i = 0; i < stride; i++)
        f->times[i] = at->t[i < used ? i % at->width : 0];
    return f->times;
}

/* Rows that stand as a block wants them are read where they are. */
static inline const double *rows(const nevh__scatter_map *map, size_t width,
                                 size_t stride, const double from[],
                                 double to[]) {
    if (map->contiguous && width % NEVH__LANES == 0)
        return from + map->source[0] * width;
    if (map->rows == 0)
        return to;
    nevh__gather(map, width, stride, from, to);
    return to;
}

/* 1: a number is not finite; 2: one is -0; or both. */
NEVH_SIMD static int64_t exact_gather_check(size_t size, const double x[]) {
    int64_t found[NEVH__LANES], all = 0;
    NEVH_LANES(lane, NEVH__LANES) {
        found[lane] = 0;
    }
    for (size_t i = 0; i < size; i += NEVH__LANES)
        NEVH_LANES(lane, NEVH__LANES) {
            int64_t bits;
            memcpy(&bits, &x[i + lane], sizeof bits);
            found[lane] |= x[i + lane] - x[i + lane] != 0 ? 1 : 0;
            found[lane] |= bits == INT64_MIN ? 2 : 0;
        }
    NEVH_LANES(lane, NEVH__LANES) {
        all |= found[lane];
    }
    return all;
}

/* Adds slopes, or leaves those that were written in place as if they had been
   added to 0; whether all are finite. */
static inline bool exact_gather_add(const nevh__scatter_map *map, size_t width,
                                    size_t stride, const double from[],
                                    double out[]) {
    if (from != out)
        return nevh__scatter(map, width, stride, from, out);
    int64_t found = exact_gather_check(map->rows * stride, out);
    for (size_t i = 0; found & 2 && i < map->rows * stride; i++)
        out[i] += 0;
    return !(found & 1);
}

/* All instances in one block; whether all is finite. */
static inline bool take_block(nevh_field *f, nevh__planned *term,
                              const nevh__places *at) {
    const nevh_term *decl = &term->term->decl;
    size_t width = at->width, stride = nevh__padded(decl->count * width);
    double *slopes_q = f->slopes, *slopes_p = slopes_q + term->nq * stride;
    const double *q = rows(&term->to_q, width, stride, at->q, f->rows);
    const double *p =
        rows(&term->to_p, width, stride, at->p, f->rows + term->nq * stride);
    bool of_q = at->dh_dq && term->nq, of_p = at->dh_dp && term->np;
    bool in_place = width % NEVH__LANES == 0; /* see nevh__writes */
    if (of_q && in_place && term == f->whole_q)
        slopes_q = at->dh_dq;
    if (of_p && in_place && term == f->whole_p)
        slopes_p = at->dh_dp;
    decl->gradient(stride, exact_gather_times(f, decl, at, stride), q, p,
                   exact_gather_constants(f, term, width, stride), decl->params,
                   at->dh_dq ? slopes_q : NULL, at->dh_dp ? slopes_p : NULL);
    bool finite = !of_q || exact_gather_add(&term->to_q, width, stride,
                                            slopes_q, at->dh_dq);
    return (!of_p || exact_gather_add(&term->to_p, width, stride, slopes_p,
                                      at->dh_dp)) &&
           finite;
}

/* Adds what some groups of a block give to a variable; whether all is finite. */
static bool add_groups(const nevh__planned *term, const nevh__block *b,
                       size_t k, size_t from, size_t until, const double *row,
                       double *out) {
    double bad = 0;
    row += from * b->lanes;
    for (size_t group = from; group < until; group++) {
        size_t i = nevh__index(term, b->group + group, k);
        double *to = out + i * b->width + b->lane;
        for (size_t lane = 0; lane < b->lanes; lane++, row++) {
            to[lane] += *row;
            bad += *row - *row;
        }
    }
    return bad == 0;
}

/* The same of one lane, instance by instance. */
static bool add_in_turn(const nevh_field *f, const nevh__planned *term,
                        const nevh__block *b, size_t first, size_t last,
                        const nevh__places *at) {
    double bad = 0;
    for (size_t group = 0; group < b->groups; group++)
        for (size_t k = first; k < last; k++) {
            size_t i = nevh__index(term, b->group + group, k);
            double x = f->slopes[k * b->stride + group];
            (k < term->nq ? at->dh_dq : at->dh_dp)[i * b->width + b->lane] += x;
            bad += x - x;
        }
    return bad == 0;
}

static int exact_gather_fail(nevh_field *f, const nevh__planned *term,
                             const nevh__block *b, const double *row) {
    size_t column = 0;
    while (column + 1 < b->used && isfinite(row[column]))
        column++;
    return nevh__block_fail(f, term, b, column, "a derivative of ",
                            row[column]);
}

/* A block of some instances, or lanes. */
static int exact_gather_take_part(nevh_field *f, nevh__planned *term,
                                  const nevh__block *b,
                                  const nevh__places *at) {
    const nevh_term *decl = &term->term->decl;
    const double *q = f->rows, *p = q + term->nq * b->stride;
    const double *c = p + term->np * b->stride;
    double *slopes_p = f->slopes + term->nq * b->stride;
    decl->gradient(b->stride, decl->time ? f->times : f->zeros, q, p, c,
                   decl->params, at->dh_dq ? f->slopes : NULL,
                   at->dh_dp ? slopes_p : NULL);
    size_t first = at->dh_dq ? 0 : term->nq,
           last = at->dh_dp ? term->nv : term->nq;
    if (term->turned && b->lanes == 1 &&
        add_in_turn(f, term, b, first, last, at))
        return NEVH_OK;
    size_t each = term->turned ? 1 : b->groups;
    for (size_t from = 0; from < b->groups; from += each)
        for (size_t k = first; k < last; k++) {
            const double *row = f->slopes + k * b->stride;
            if (!add_groups(term, b, k, from, from + each, row,
                            k < term->nq ? at->dh_dq : at->dh_dp))
                return exact_gather_fail(f, term, b, row);
        }
    return NEVH_OK;
}

static int take_parts(nevh_field *f, nevh__planned *term,
                      const nevh__places *at) {
    nevh__block b = nevh__block_over(at->width, at->t, at->q, at->p, 1, 1);
    int status = NEVH_OK;
    while (!status && nevh__block_next(f, term, &b))
        status = exact_gather_take_part(f, term, &b, at);
    return status;
}

/* A block that is not finite is taken again, in parts that tell where. */
int nevh__gradient_exact(nevh_field *f, nevh__planned *term,
                         const nevh__places *at) {
    bool fits =
        term->mapped && term->term->decl.count * at->width <= f->capacity;
    return fits && take_block(f, term, at) ? NEVH_OK : take_parts(f, term, at);
}
