/* nevh: exact gradients where each term fits into one block, as it does in
   small systems.

   Constants lie ready.  Where a term's rows stand in the caller's arrays just
   as a block wants them, they are read in place, and where it is the first of
   the terms to write them, and writes all, they are written in place.  All
   else is as in exact.c, operation by operation: the same bits.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <nevh/body.h>
#include <string.h>

/* Instances that a state repeated over a vector may have: more of them cost
   more than to collect one vector of instances. */
enum { MOST_REPEATED = 2, MOST_ROWS = 8 };

/* Whether variable k of instance i is number i + k: one row after another, in
   a block of one instance or of one variable. */
static bool straight(const size_t index[], size_t variables, size_t count) {
    if (variables != 1 && count != 1)
        return false;
    for (size_t i = 0; i < variables * count; i++)
        if (index[i] != index[0] + i)
            return false;
    return variables > 0;
}

/* The first term that reads some coordinate, or momentum, if it reads all of
   them straight; NULL: there is none. */
static const nevh__planned *writer(const nevh_field *f, bool momenta) {
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__planned *term = &f->terms[i];
        size_t all = (momenta ? term->np : term->nq) * term->term->decl.count;
        if (all == 0)
            continue;
        bool whole = momenta ? term->straight_p : term->straight_q;
        return whole && all == f->n ? term : NULL;
    }
    return NULL;
}

/* The writer, if no other term reads a coordinate, or momentum. */
static nevh__planned *sole(nevh_field *f, bool momenta) {
    nevh__planned *found = NULL;
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++) {
        if (!(momenta ? term->np : term->nq))
            continue;
        if (found || !term->straight)
            return NULL;
        found = term;
    }
    return found == (momenta ? f->writer_p : f->writer_q) ? found : NULL;
}

/* What is not evaluated in one block has no use for it. */
static bool wire(const nevh_field *f, nevh__planned *term) {
    const nevh_term *decl = &term->term->decl;
    if (decl->count > f->capacity)
        return true;
    return nevh__wiring_plan(&term->to_q, f->n, term->nq, decl->count,
                             decl->q) &&
           nevh__wiring_plan(&term->to_p, f->n, term->np, decl->count, decl->p);
}

bool nevh__lean_plan(nevh_field *f) {
    bool repeats = true;
    f->most_instances = 0;
    for (size_t i = 0; i < f->n_terms; i++) {
        nevh__planned *term = &f->terms[i];
        const nevh_term *decl = &term->term->decl;
        term->straight_q = straight(decl->q, term->nq, decl->count);
        term->straight_p = straight(decl->p, term->np, decl->count);
        term->straight =
            (term->straight_q || !term->nq) && (term->straight_p || !term->np);
        if (decl->count > f->most_instances)
            f->most_instances = decl->count;
        repeats &= decl->count <= MOST_REPEATED && term->straight;
        if (!wire(f, term))
            return false;
        if (decl->nc && !(term->constants = nevh__array(decl->nc * f->capacity,
                                                        sizeof(double))))
            return false;
    }
    f->repeats = repeats && f->n <= MOST_ROWS;
    f->writer_q = writer(f, false);
    f->writer_p = writer(f, true);
    f->sole_q = sole(f, false);
    f->sole_p = sole(f, true);
    return true;
}

/* Instances side by side, each with its lanes, in rows of `stride`; padding
   repeats column 0. */
NEVH_SIMD static void collect(size_t rows, size_t count, size_t width,
                              size_t stride, const size_t index[],
                              const double from[], double to[]) {
    for (size_t k = 0; k < rows; k++, to += stride) {
        double *column = to;
        for (size_t i = 0; i < count; i++, column += width) {
            const double *x = from + index[i * rows + k] * width;
            for (size_t lane = 0; lane < width; lane++)
                column[lane] = x[lane];
        }
        for (; column < to + stride; column++)
            *column = *to;
    }
}

/* The same for whole vectors of lanes. */
NEVH_SIMD static void collect_vectors(size_t rows, size_t count, size_t width,
                                      const size_t index[], const double from[],
                                      double to[]) {
    for (size_t k = 0; k < rows; k++)
        for (size_t i = 0; i < count; i++, to += width) {
            const double *x = from + index[i * rows + k] * width;
            NEVH_LANES(lane, width) {
                to[lane] = x[lane];
            }
        }
}

/* The same for one instance and lane: a number fills a vector. */
NEVH_SIMD static void repeat(size_t rows, const size_t index[],
                             const double from[], double to[]) {
    for (size_t k = 0; k < rows; k++, to += NEVH__LANES) {
        double x = from[index[k]];
        NEVH_LANES(lane, NEVH__LANES) {
            to[lane] = x;
        }
    }
}

/* Adds slopes to what they belong to; whether one is not finite. */
NEVH_SIMD static bool scatter(size_t rows, size_t count, size_t width,
                              size_t stride, const size_t index[],
                              const double from[], double out[]) {
    int64_t bad = 0;
    for (size_t k = 0; k < rows; k++)
        for (size_t i = 0; i < count; i++) {
            double *to = out + index[i * rows + k] * width;
            const double *x = from + k * stride + i * width;
            for (size_t lane = 0; lane < width; lane++) {
                to[lane] += x[lane];
                bad |= x[lane] - x[lane] != 0;
            }
        }
    return bad != 0;
}

/* 1: a number is not finite; 2: one is -0; or both. */
NEVH_SIMD static int64_t check(size_t size, const double x[]) {
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

/* Slopes that were written in place, as if added to 0. */
static bool settle(size_t size, double out[]) {
    int64_t found = check(size, out);
    for (size_t i = 0; found & 2 && i < size; i++)
        out[i] += 0;
    return found & 1;
}

static void fill_constants(nevh__planned *term, size_t width, size_t stride) {
    const nevh_term *decl = &term->term->decl;
    for (size_t k = 0; k < decl->nc; k++)
        for (size_t i = 0; i < stride; i++) {
            size_t instance = i < decl->count * width ? i / width : 0;
            term->constants[k * stride + i] = decl->c[instance * decl->nc + k];
        }
    term->constants_width = width;
}

const double *nevh__lean_constants(nevh__planned *term, size_t width,
                                   size_t stride) {
    if (term->constants_width != width)
        fill_constants(term, width, stride);
    return term->constants;
}

/* The gradient under way. */
typedef struct {
    size_t width;
    bool vectors;  /* lanes fill them */
    bool trusting; /* results are looked at later */
    const double *t, *q, *p;
    double *dh_dq, *dh_dp;
} request;

static const double *times(nevh_field *f, const nevh_term *decl,
                           const request *r, size_t stride) {
    if (!decl->time)
        return f->zeros;
    if (r->vectors && decl->count == 1)
        return r->t;
    for (size_t i = 0; i < stride; i++)
        f->times[i] = r->t[i < decl->count * r->width ? i % r->width : 0];
    return f->times;
}

static const double *rows(const request *r, const nevh__wiring *x,
                          bool in_place, size_t stride, const size_t index[],
                          const double from[], double to[]) {
    if (in_place && r->vectors)
        return from + index[0] * r->width;
    if (r->vectors)
        collect_vectors(x->rows, x->count, r->width, index, from, to);
    else if (x->count * r->width == 1)
        repeat(x->rows, index, from, to);
    else if (r->width == 1)
        nevh__wiring_collect(x, from, to);
    else
        collect(x->rows, x->count, r->width, stride, index, from, to);
    return to;
}

static bool add(const request *r, const nevh__wiring *x, size_t stride,
                const size_t index[], const double from[], double out[]) {
    if (from == out && r->trusting)
        return false;
    if (from == out)
        return settle(x->count * x->rows * r->width, out);
    if (r->vectors)
        return !nevh__wiring_add_vectors(x, r->width, from, out);
    if (r->width == 1)
        return !nevh__wiring_add(x, from, out);
    return scatter(x->rows, x->count, r->width, stride, index, from, out);
}

/* A term whose rows all stand in place. */
static inline bool evaluate_in_place(nevh_field *f, nevh__planned *term,
                                     const request *r) {
    const nevh_term *decl = &term->term->decl;
    size_t stride = decl->count * r->width;
    double *out_q = f->slopes, *out_p = f->slopes + term->nq * stride;
    const double *q = r->q, *p = r->p, *t = f->zeros;
    if (term->nq)
        q += decl->q[0] * r->width;
    if (term->np)
        p += decl->p[0] * r->width;
    if (term == f->writer_q)
        out_q = r->dh_dq;
    if (term == f->writer_p)
        out_p = r->dh_dp;
    if (decl->time)
        t = times(f, decl, r, stride);
    decl->gradient(stride, t, q, p,
                   nevh__lean_constants(term, r->width, stride), decl->params,
                   r->dh_dq ? out_q : NULL, r->dh_dp ? out_p : NULL);
    bool bad = false;
    if (r->dh_dq && term->nq)
        bad |= add(r, &term->to_q, stride, decl->q, out_q, r->dh_dq);
    if (r->dh_dp && term->np)
        bad |= add(r, &term->to_p, stride, decl->p, out_p, r->dh_dp);
    return bad;
}

/* The only term of a half, to it; whether all is finite. */
static inline bool write(nevh_field *f, nevh__planned *term, const request *r,
                         size_t variables, double *out) {
    const nevh_term *decl = &term->term->decl;
    size_t stride = decl->count * r->width;
    decl->gradient(stride, decl->time ? times(f, decl, r, stride) : f->zeros,
                   term->nq ? r->q + decl->q[0] * r->width : r->q,
                   term->np ? r->p + decl->p[0] * r->width : r->p,
                   nevh__lean_constants(term, r->width, stride), decl->params,
                   r->dh_dq, r->dh_dp);
    return !settle(variables * stride, out);
}

static bool evaluate(nevh_field *f, nevh__planned *term, const request *r) {
    const nevh_term *decl = &term->term->decl;
    size_t stride = nevh__padded(decl->count * r->width);
    double *to_p = f->rows + term->nq * stride;
    double *slopes_q = f->slopes, *slopes_p = f->slopes + term->nq * stride;
    const double *q =
        rows(r, &term->to_q, term->straight_q, stride, decl->q, r->q, f->rows);
    const double *p =
        rows(r, &term->to_p, term->straight_p, stride, decl->p, r->p, to_p);
    if (r->vectors && term == f->writer_q && r->dh_dq)
        slopes_q = r->dh_dq;
    if (r->vectors && term == f->writer_p && r->dh_dp)
        slopes_p = r->dh_dp;
    decl->gradient(stride, times(f, decl, r, stride), q, p,
                   nevh__lean_constants(term, r->width, stride), decl->params,
                   r->dh_dq ? slopes_q : NULL, r->dh_dp ? slopes_p : NULL);
    bool bad = false;
    if (r->dh_dq && term->nq)
        bad |= add(r, &term->to_q, stride, decl->q, slopes_q, r->dh_dq);
    if (r->dh_dp && term->np)
        bad |= add(r, &term->to_p, stride, decl->p, slopes_p, r->dh_dp);
    return bad;
}

static bool evaluate_all(nevh_field *f, const request *r) {
    size_t size = f->n * r->width * sizeof *r->q;
    bool bad = false;
    if (r->dh_dq && !(r->vectors && f->writer_q))
        memset(r->dh_dq, 0, size);
    if (r->dh_dp && !(r->vectors && f->writer_p))
        memset(r->dh_dp, 0, size);
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++)
        if ((r->dh_dq && term->nq) || (r->dh_dp && term->np))
            bad |= r->vectors && term->straight ? evaluate_in_place(f, term, r)
                                                : evaluate(f, term, r);
    return !bad;
}

/* n numbers, each in the first lane of its row. */
static bool take_first(size_t n, const double *row, double *out) {
    double sum = 0;
    for (size_t k = 0; k < n; k++, row += NEVH__LANES) {
        out[k] = 0 + *row;
        sum += *row - *row;
    }
    return sum == 0;
}

/* One state, repeated over a vector. */
static bool evaluate_repeated(nevh_field *f, const double *t, const double q[],
                              const double p[], double dh_dq[],
                              double dh_dp[]) {
    enum { SIZE = MOST_ROWS * NEVH__LANES };
    _Alignas(NEVH__LANES * sizeof(double)) double all[4 * SIZE + NEVH__LANES];
    double *half[] = {all, all + SIZE, all + 2 * SIZE, all + 3 * SIZE};
    double *time = all + 4 * SIZE;
    request r = {.width = NEVH__LANES,
                 .vectors = true,
                 .trusting = true,
                 .t = time,
                 .q = half[0],
                 .p = half[1],
                 .dh_dq = dh_dq ? half[2] : NULL,
                 .dh_dp = dh_dp ? half[3] : NULL};
    static const size_t indices[] = {0, 1, 2, 3, 4, 5, 6, 7};
    repeat(f->n, indices, q, half[0]);
    repeat(f->n, indices, p, half[1]);
    repeat(1, indices, t, time);
    return evaluate_all(f, &r) &&
           (!dh_dq || take_first(f->n, half[2], dh_dq)) &&
           (!dh_dp || take_first(f->n, half[3], dh_dp));
}

bool nevh__gradient_lean(nevh_field *f, size_t width, const double t[],
                         const double q[], const double p[], double dh_dq[],
                         double dh_dp[]) {
    request r = {width, width % NEVH__LANES == 0, false, t, q, p, dh_dq, dh_dp};
    if (f->gradient != nevh_exact || f->most_instances * width > f->capacity)
        return false;
    if (width == 1 && f->repeats)
        return evaluate_repeated(f, t, q, p, dh_dq, dh_dp);
    if (r.vectors && !dh_dp && f->sole_q)
        return write(f, f->sole_q, &r, f->sole_q->nq, dh_dq);
    if (r.vectors && !dh_dq && f->sole_p)
        return write(f, f->sole_p, &r, f->sole_p->np, dh_dp);
    return evaluate_all(f, &r);
}
