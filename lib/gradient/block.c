/* nevh: blocks of columns, filled and evaluated.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* One value for each lane, `copies` times for one group. */
static void spread(const nevh__block *b, size_t group, const double *from,
                   double *row) {
    row += group * b->copies * b->lanes;
    if (b->lanes == 1)
        for (size_t k = 0; k < b->copies; k++)
            row[k] = from[0];
    else
        for (size_t k = 0; k < b->copies; k++)
            memcpy(row + k * b->lanes, from, b->lanes * sizeof *row);
}

static void pad(const nevh__block *b, double *row) {
    for (size_t k = b->used; k < b->stride; k++)
        row[k] = row[0];
}

static void fill_group(nevh_field *f, const nevh__planned *term,
                       const nevh__block *b, size_t group) {
    size_t instance = (b->group + group) / b->per_instance, k = 0;
    for (; k < term->nv; k++) {
        const double *x = k < term->nq ? b->q : b->p;
        size_t i = nevh__index(term, instance, k);
        spread(b, group, x + i * b->width + b->lane, f->rows + k * b->stride);
    }
    const nevh_term *is = &term->term->is;
    for (size_t j = 0; j < is->nc; j++, k++) {
        double *row = f->rows + k * b->stride + group * b->copies * b->lanes;
        for (size_t column = 0; column < b->copies * b->lanes; column++)
            row[column] = is->c[instance * is->nc + j];
    }
    if (is->time)
        spread(b, group, b->t + b->lane, f->times);
}

static void fill(nevh_field *f, const nevh__planned *term, nevh__block *b) {
    const nevh_term *is = &term->term->is;
    b->used = b->groups * b->copies * b->lanes;
    b->stride = nevh__padded(b->used);
    for (size_t group = 0; group < b->groups; group++)
        fill_group(f, term, b, group);
    if (b->used == b->stride)
        return;
    for (size_t k = 0; k < term->nv + is->nc; k++)
        pad(b, f->rows + k * b->stride);
    if (is->time)
        pad(b, f->times);
}

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

bool nevh__block_next(nevh_field *f, const nevh__planned *term,
                      nevh__block *b) {
    size_t total = term->term->is.count * b->per_instance;
    b->group += b->groups;
    if (b->group >= total) {
        b->group = 0;
        b->lane += b->lanes;
    }
    if (b->lane >= b->until || total == 0)
        return false;
    b->lanes = smaller(f->capacity / b->copies, b->until - b->lane);
    b->groups = smaller(f->capacity / (b->copies * b->lanes), total - b->group);
    fill(f, term, b);
    return true;
}

/* " q[2] = 0.5" for each variable of a column, as far as there is room. */
static void describe(const nevh_field *f, const nevh__planned *term,
                     const nevh__block *b, size_t instance, size_t column,
                     char *text, size_t size) {
    size_t at = 0;
    text[0] = '\0';
    for (size_t k = 0; k < term->nv && k < 6 && at < size; k++) {
        int length =
            snprintf(text + at, size - at, "%s%c[%zu] = %.9g", k ? ", " : "",
                     k < term->nq ? 'q' : 'p', nevh__index(term, instance, k),
                     nevh__row(f, b, k)[column]);
        at += length > 0 ? (size_t)length : 0;
    }
    if (term->nv > 6 && at < size)
        snprintf(text + at, size - at, ", ...");
}

int nevh__block_fail(nevh_field *f, const nevh__planned *term,
                     const nevh__block *b, size_t column, const char *what,
                     double value) {
    const nevh_term *is = &term->term->is;
    size_t lane = b->lane + column % b->lanes;
    size_t group = column / (b->copies * b->lanes);
    size_t instance = (b->group + group) / b->per_instance;
    char where[200], which[80] = "";
    describe(f, term, b, instance, column, where, sizeof where);
    if (is->count > 1 || b->width > 1)
        snprintf(which, sizeof which, " (instance %zu, lane %zu)", instance,
                 lane);
    return nevh__fail(
        &f->report, NEVH_EDOM,
        "%sterm \"%s\" of effect \"%s\"%s is %g at t = %.9g, %s: keep the orbit "
        "away from there, or take a smaller step",
        what, is->name, is->effect, which, value, b->t[lane], where);
}

/* Whether all are finite: x - x is 0 then, and NaN otherwise. */
static bool all_finite(const double x[], size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += x[i] - x[i];
    return sum == 0;
}

int nevh__block_values(nevh_field *f, nevh__planned *term,
                       const nevh__block *b) {
    const double *q = f->rows, *p = q + term->nq * b->stride;
    const double *c = p + term->np * b->stride;
    const double *t = term->term->is.time ? f->times : f->zeros;
    nevh__term_values(term->term, f->portable, b->stride, b->used, t, q, p, c,
                      f->h, f->one);
    term->values += b->used;
    if (all_finite(f->h, b->used))
        return NEVH_OK;
    size_t column = 0;
    while (column + 1 < b->used && isfinite(f->h[column]))
        column++;
    return nevh__block_fail(f, term, b, column, "", f->h[column]);
}
