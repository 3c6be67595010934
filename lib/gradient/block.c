/* nevh: blocks of columns, filled and evaluated.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "system/print_private.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The first copy of a row whose entries are from[index[instance * step]] of
   each lane. */
static void fill_first(const nevh__block *b, const double *from,
                       const size_t *index, size_t step, double *row) {
    nevh__cursor at = nevh__first_group(b);
    for (size_t group = 0; group < b->groups; group++, row += b->lanes) {
        const double *x = from + index[at.instance * step] * b->width;
        if (b->lanes == 1)
            row[0] = x[b->lane];
        else
            memcpy(row, x + b->lane, b->lanes * sizeof *row);
        nevh__next_group(b, &at);
    }
}

/* The other copies, and the padding. */
static void fill_rest(const nevh__block *b, double *row) {
    size_t one = b->groups * b->lanes;
    for (size_t i = one; i < b->used; i += one)
        memcpy(row + i, row, one * sizeof *row);
    for (size_t i = b->used; i < b->stride; i++)
        row[i] = row[0];
}

static void fill_all(const nevh__block *b, double x, double *row) {
    for (const double *end = row + b->stride; row < end; row += NEVH__LANES)
        for (size_t i = 0; i < NEVH__LANES; i++)
            row[i] = x;
}

/* One instance, one lane: each row is one number. */
static void fill_one(nevh_field *f, const nevh__planned *term,
                     const nevh__block *b) {
    const nevh_term *decl = &term->term->decl;
    double *row = f->rows;
    for (size_t k = 0; k < term->nq; k++, row += b->stride)
        fill_all(b, b->q[decl->q[k] * b->width + b->lane], row);
    for (size_t k = 0; k < term->np; k++, row += b->stride)
        fill_all(b, b->p[decl->p[k] * b->width + b->lane], row);
    for (size_t k = 0; k < decl->nc; k++, row += b->stride)
        fill_all(b,
                 nevh__constant(f, term, 0, k,
                                nevh__lane_of(f, b->width, b->first + b->lane)),
                 row);
    if (decl->time)
        fill_all(b, b->t[b->lane], f->times);
}

static void fill_constants(const nevh_field *f, const nevh__planned *term,
                           const nevh__block *b, double *row) {
    const nevh_term *decl = &term->term->decl;
    for (size_t k = 0; k < decl->nc; k++, row += b->stride) {
        nevh__cursor at = nevh__first_group(b);
        for (size_t group = 0; group < b->groups; group++) {
            double *to = row + group * b->lanes;
            for (size_t lane = 0; lane < b->lanes && f->lanes; lane++)
                to[lane] = nevh__constant(
                    f, term, at.instance, k,
                    nevh__lane_of(f, b->width, b->first + b->lane + lane));
            for (size_t lane = 0; lane < b->lanes && !f->lanes; lane++)
                to[lane] = decl->c[at.instance * decl->nc + k];
            nevh__next_group(b, &at);
        }
        fill_rest(b, row);
    }
}

static void fill_many(nevh_field *f, const nevh__planned *term,
                      const nevh__block *b) {
    const nevh_term *decl = &term->term->decl;
    static const size_t zero = 0;
    double *row = f->rows;
    for (size_t k = 0; k < term->nq; k++, row += b->stride) {
        fill_first(b, b->q, decl->q + k, term->nq, row);
        fill_rest(b, row);
    }
    for (size_t k = 0; k < term->np; k++, row += b->stride) {
        fill_first(b, b->p, decl->p + k, term->np, row);
        fill_rest(b, row);
    }
    fill_constants(f, term, b, row);
    if (decl->time) {
        fill_first(b, b->t, &zero, 0, f->times);
        fill_rest(b, f->times);
    }
}

static size_t block_smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

/* As many lanes, and then groups, as there is room for.  Most often all; the
   comparison saves divisions. */
static void set_size(const nevh_field *f, nevh__block *b, size_t total) {
    size_t lanes = b->until - b->lane, groups = total - b->group;
    if (groups * b->copies * lanes > f->capacity) {
        lanes = block_smaller(f->capacity / b->copies, lanes);
        groups = block_smaller(f->capacity / (b->copies * lanes), groups);
    }
    b->lanes = lanes;
    b->groups = groups;
    b->used = groups * b->copies * lanes;
    b->stride = nevh__padded(b->used);
}

bool nevh__block_next(nevh_field *f, const nevh__planned *term,
                      nevh__block *b) {
    size_t total = term->term->decl.count * b->per_instance;
    b->group += b->groups;
    if (b->group >= total) {
        b->group = 0;
        b->lane += b->lanes;
    }
    if (b->lane >= b->until || total == 0)
        return false;
    set_size(f, b, total);
    if (b->lanes == 1 && term->term->decl.count == 1)
        fill_one(f, term, b);
    else
        fill_many(f, term, b);
    return true;
}

/* "t = 2, q[2] = 0.5": what a term reads in a column, as far as there is room. A
   kernel passes no time to a term that does not read it. */
static void block_describe(const nevh_field *f, const nevh__planned *term,
                           const nevh__block *b, size_t instance, size_t column,
                           char *text, size_t size) {
    size_t at = 0;
    text[0] = '\0';
    if (term->term->decl.time)
        at = (size_t)nevh__print(text, size, "t = %.9g",
                                 b->t[b->lane + column % b->lanes]);
    for (size_t k = 0; k < term->nv && k < 6 && at < size; k++) {
        char name[NEVH__VARIABLE];
        nevh__variable_name(f->system, k >= term->nq,
                            nevh__index(term, instance, k), name);
        int length =
            nevh__print(text + at, size - at, "%s%s = %.9g", at ? ", " : "",
                        name, nevh__row(f, b, k)[column]);
        at += length > 0 ? (size_t)length : 0;
    }
    if (term->nv > 6 && at < size)
        snprintf(text + at, size - at, ", ...");
}

/* True if squares and products of the variables would soon overflow. */
static bool is_beyond(const nevh_field *f, const nevh__planned *term,
                      const nevh__block *b, size_t column) {
    const double vast = 1e100;
    for (size_t k = 0; k < term->nv; k++)
        if (!(fabs(nevh__row(f, b, k)[column]) < vast))
            return true;
    return false;
}

int nevh__block_fail(nevh_field *f, const nevh__planned *term,
                     const nevh__block *b, size_t column, const char *what,
                     double value) {
    const nevh_term *decl = &term->term->decl;
    size_t lane = b->lane + column % b->lanes;
    size_t group = column % (b->groups * b->lanes) / b->lanes;
    size_t instance = (b->group + group) / b->per_instance;
    char where[240], which[80] = "";
    block_describe(f, term, b, instance, column, where, sizeof where);
    if (!f->system->names && (decl->count > 1 || b->width > 1))
        snprintf(which, sizeof which, " (instance %zu, lane %zu)", instance,
                 lane);
    if (is_beyond(f, term, b, column))
        return nevh__fail(
            &f->report, NEVH_EDOM,
            "the orbit has grown beyond all numbers: term \"%s\" of effect "
            "\"%s\"%s has no value at %s: end the run before, or take a "
            "smaller step where steps make it grow",
            decl->name, decl->effect, which, where);
    return nevh__fail(
        &f->report, NEVH_EDOM,
        "%sterm \"%s\" of effect \"%s\"%s is %g at %s: keep the orbit away "
        "from there, or take a smaller step",
        what, decl->name, decl->effect, which,
        isnan(value) ? fabs(value) : value, where);
}

/* True if all are finite: x - x is then 0, else NaN. */
static bool block_all_finite(const double x[], size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += x[i] - x[i];
    return sum == 0;
}

void nevh__block_evaluate(nevh_field *f, nevh__planned *term,
                          const nevh__block *b) {
    const double *q = f->rows, *p = q + term->nq * b->stride;
    const double *c = p + term->np * b->stride;
    const double *t = term->term->decl.time ? f->times : f->zeros;
    nevh__term_values(term->term, f->portable, b->stride, b->used, t, q, p, c,
                      f->h, f->one);
    term->values += b->used;
}

int nevh__block_check(nevh_field *f, const nevh__planned *term,
                      const nevh__block *b) {
    if (block_all_finite(f->h, b->used))
        return NEVH_OK;
    size_t column = 0;
    while (column + 1 < b->used && isfinite(f->h[column]))
        column++;
    return nevh__block_fail(f, term, b, column, "", f->h[column]);
}

int nevh__block_values(nevh_field *f, nevh__planned *term,
                       const nevh__block *b) {
    nevh__block_evaluate(f, term, b);
    return nevh__block_check(f, term, b);
}
