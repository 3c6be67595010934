/* nevh: the points of a term's central differences, laid out when planned.

   For a few orbits most time would go into bookkeeping, and into waiting for
   single numbers just written to be read back as vectors.  So the points of all
   variables and instances are made whole: each row is its variable plus a row
   of shifts, -0 where the variable is not moved (x + -0 is x to the last bit,
   also for -0).  A column is (point * lanes + lane); the points of one variable
   stand side by side, + before -, nearest first.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include "system/vector_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>

enum { MOST_VARIABLES = 16, MOST_SLOPES = 64 };

/* One variable of one instance. */
typedef struct {
    size_t instance, k;
    size_t target; /* of the half of the gradient that it belongs to */
    size_t first;  /* of its points */
    const nevh_gradient *method;
} slope;

/* What dH/dq, dH/dp or both of a term take. */
struct nevh__stencil {
    size_t slopes, points;
    size_t stride;     /* of the next two: points, padded */
    double *shift;     /* nv rows */
    size_t *source;    /* nv rows: what is shifted, of q or p */
    double *constants; /* nc rows of so many lanes; 0: of none yet */
    size_t lanes;
    slope slope[MOST_SLOPES];
};

/* Which of the three. */
static size_t part_of(const double dh_dq[], const double dh_dp[]) {
    return dh_dq && dh_dp ? 2 : dh_dp ? 1 : 0;
}

/* Those of one pass, instance by instance; false: there are too many. */
static bool list_pass(const nevh_field *f, const nevh__planned *term,
                      const nevh__pass *pass, size_t part, nevh__stencil *s) {
    const nevh_term *decl = &term->term->decl;
    size_t begin = part == 1 ? pass->first_p : pass->begin;
    size_t end = part == 0 ? pass->first_p : pass->end;
    for (size_t i = 0; i < decl->count; i++)
        for (size_t v = begin; v < end; v++) {
            if (s->slopes == MOST_SLOPES)
                return false;
            size_t k = term->vars[v];
            s->slope[s->slopes++] =
                (slope){i, k, nevh__index(term, i, k), s->points,
                        pass->pairs == 1 ? nevh_central2 : f->gradient};
            s->points += 2 * pass->pairs;
        }
    return true;
}

static void fill(const nevh__planned *term, nevh__stencil *s) {
    for (size_t i = 0; i < term->nv * s->stride; i++)
        s->shift[i] = -0.0;
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
        double delta = term->delta[x->instance * term->nv + x->k];
        for (size_t i = 0; i < 2 * x->method->offsets; i++) {
            double move = (double)(i / 2 + 1) * delta;
            s->shift[x->k * s->stride + x->first + i] = i % 2 ? -move : move;
            for (size_t k = 0; k < term->nv; k++)
                s->source[k * s->stride + x->first + i] =
                    nevh__index(term, x->instance, k);
        }
    }
    for (size_t k = 0; k < term->nv; k++)
        for (size_t i = s->points; i < s->stride; i++)
            s->source[k * s->stride + i] = s->source[k * s->stride];
}

void nevh__stencil_free(nevh__planned *term) {
    for (size_t part = 0; part < 3; part++) {
        nevh__stencil *s = term->stencil[part];
        if (!s)
            continue;
        free(s->shift);
        free(s->source);
        free(s->constants);
        free(s);
        term->stencil[part] = NULL;
    }
}

/* Returns false when memory is out; a part that is empty, or does not fit into
   one block, has no stencil, and goes the long way. */
static bool plan_part(const nevh_field *f, nevh__planned *term, size_t part) {
    const nevh_term *decl = &term->term->decl;
    nevh__stencil *s = nevh__array(1, sizeof *s);
    if (!s)
        return false;
    bool fits = term->nv <= MOST_VARIABLES &&
                list_pass(f, term, &term->pass[0], part, s) &&
                list_pass(f, term, &term->pass[1], part, s) && s->slopes > 0 &&
                s->points <= f->capacity;
    if (!fits) {
        free(s);
        return true;
    }
    term->stencil[part] = s;
    s->stride = nevh__padded(s->points);
    s->shift = nevh__array(term->nv * s->stride, sizeof *s->shift);
    s->source = nevh__array(term->nv * s->stride, sizeof *s->source);
    s->constants = nevh__array(decl->nc * f->capacity, sizeof *s->constants);
    if (!s->shift || !s->source || !s->constants)
        return false;
    fill(term, s);
    return true;
}

bool nevh__stencil_plan(const nevh_field *f, nevh__planned *term) {
    nevh__stencil_free(term);
    return plan_part(f, term, 0) && plan_part(f, term, 1) &&
           plan_part(f, term, 2);
}

nevh__stencil *nevh__stencil_for(const nevh__planned *term,
                                 const double dh_dq[], const double dh_dp[]) {
    return term->stencil[part_of(dh_dq, dh_dp)];
}

/* Where the states are, and which of them are taken: `lanes` from `lane` on,
   in columns of so many. */
typedef struct {
    size_t width, lane, lanes, stride;
    const double *t, *q, *p;
    double *dh_dq, *dh_dp;
} request;

/* One lane: each row is a number plus a row of shifts, padding and all; */
NEVH_SIMD static void shift_one(size_t stride, double x,
                                const double *restrict shift,
                                double *restrict row) {
    NEVH_LANES(i, stride) {
        row[i] = x + shift[i];
    }
}

/* or one number an instance; */
NEVH_SIMD static void shift_each(size_t stride, const double *restrict x,
                                 const size_t *restrict source,
                                 const double *restrict shift,
                                 double *restrict row) {
    NEVH_LANES(i, stride) {
        row[i] = x[source[i]] + shift[i];
    }
}

/* many: each point is a row of numbers plus a shift; whole vectors of lanes, */
NEVH_SIMD static void shift_vectors(size_t points, size_t lanes, size_t width,
                                    const double *x, const size_t *source,
                                    const double *shift, double *row) {
    for (size_t lane = 0; lane < lanes; lane += NEVH__IN_VECTOR) {
        size_t last = source[0];
        nevh__vector state = *(const nevh__vector *)(x + last * width + lane);
        for (size_t i = 0; i < points; i++) {
            if (source[i] != last) {
                last = source[i];
                state = *(const nevh__vector *)(x + last * width + lane);
            }
            *(nevh__vector *)(row + i * lanes + lane) = state + shift[i];
        }
    }
}

/* or any. */
NEVH_SIMD static void shift_many(size_t points, size_t lanes, size_t width,
                                 const double *x, const size_t *source,
                                 const double *shift, double *row) {
    for (size_t i = 0; i < points; i++, row += lanes)
        for (size_t lane = 0; lane < lanes; lane++)
            row[lane] = x[source[i] * width + lane] + shift[i];
}

static void fill_rows(nevh_field *f, const nevh__planned *term,
                      const nevh__stencil *s, const request *r) {
    double *row = f->rows;
    bool alone = term->term->decl.count == 1;
    for (size_t k = 0; k < term->nv; k++, row += r->stride) {
        const double *x = (k < term->nq ? r->q : r->p) + r->lane;
        const double *shift = s->shift + k * s->stride;
        const size_t *source = s->source + k * s->stride;
        if (r->width == 1 && alone)
            shift_one(s->stride, x[*source], shift, row);
        else if (r->width == 1)
            shift_each(s->stride, x, source, shift, row);
        else {
            (r->lanes % NEVH__LANES ? shift_many : shift_vectors)(
                s->points, r->lanes, r->width, x, source, shift, row);
            for (size_t i = s->points * r->lanes; i < r->stride; i++)
                row[i] = row[0];
        }
    }
}

static void fill_times(const request *r, double *times) {
    for (size_t i = 0; i < r->stride; i++)
        times[i] = r->t[r->lane + i % r->lanes];
}

/* Made anew only where other lanes are asked for. */
static void fill_constants(const nevh__planned *term, nevh__stencil *s,
                           const request *r) {
    const nevh_term *decl = &term->term->decl;
    double *row = s->constants;
    for (size_t k = 0; k < decl->nc; k++, row += r->stride) {
        for (size_t i = 0; i < r->stride; i++)
            row[i] = decl->c[k];
        for (const slope *x = s->slope; x < s->slope + s->slopes; x++)
            for (size_t i = 0; i < 2 * x->method->offsets * r->lanes; i++)
                row[x->first * r->lanes + i] =
                    decl->c[x->instance * decl->nc + k];
    }
    s->lanes = r->lanes;
}

/* Adds the slopes; whether all are finite. */
static bool add_one(const nevh_field *f, const nevh__stencil *s, size_t nq,
                    const request *r) {
    double bad = 0;
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
        const double *at = f->rows + x->k * r->stride + x->first;
        double one = nevh__chord_slope(x->method, 1, at, f->h + x->first);
        (x->k < nq ? r->dh_dq : r->dh_dp)[x->target * r->width + r->lane] +=
            one;
        bad += one - one;
    }
    return bad == 0;
}

/* Of whole vectors of lanes. */
NEVH_SIMD static bool add_vectors(const nevh_field *f, const nevh__stencil *s,
                                  size_t nq, const request *r) {
    size_t lanes = r->lanes;
    nevh__vector bad = {0};
    double sum = 0;
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
        const double *at = f->rows + x->k * r->stride + x->first * lanes;
        const double *h = f->h + x->first * lanes;
        double *out =
            (x->k < nq ? r->dh_dq : r->dh_dp) + x->target * r->width + r->lane;
        for (size_t lane = 0; lane < lanes; lane += NEVH__IN_VECTOR) {
            nevh__vector one = {0};
            for (size_t j = 0; j < x->method->offsets; j++) {
                size_t plus = 2 * j * lanes + lane, minus = plus + lanes;
                one += x->method->weights[j] *
                       ((*(const nevh__vector *)(h + plus) -
                         *(const nevh__vector *)(h + minus)) /
                        (*(const nevh__vector *)(at + plus) -
                         *(const nevh__vector *)(at + minus)));
            }
            *(nevh__vector *)(out + lane) += one;
            bad += one - one;
        }
    }
    for (size_t i = 0; i < NEVH__IN_VECTOR; i++)
        sum += ((const double *)&bad)[i];
    return sum == 0;
}

static bool add_many(const nevh_field *f, const nevh__stencil *s, size_t nq,
                     const request *r) {
    bool bad = false;
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
        size_t first = x->first * r->lanes;
        double *out = x->k < nq ? r->dh_dq : r->dh_dp;
        bad |= nevh__add_slopes(
            x->method, r->lanes, r->lanes, f->rows + x->k * r->stride + first,
            f->h + first, out + x->target * r->width + r->lane);
    }
    return !bad;
}

/* Lanes of a block: all or, where they do not fit into one, whole vectors of
   them, as many in each block, so that constants stay. */
static size_t lanes_in_block(const nevh_field *f, const nevh__stencil *s,
                             size_t lanes) {
    size_t most = f->capacity / s->points;
    if (lanes <= most)
        return lanes;
    if (most < NEVH__LANES)
        return most;
    most -= most % NEVH__LANES;
    return nevh__padded((lanes + (lanes - 1) / most) /
                        ((lanes - 1) / most + 1));
}

/* Tells what is not finite: a value, or else the first such slope. */
static int fail(nevh_field *f, const nevh__planned *term,
                const nevh__stencil *s, const request *r) {
    size_t column = 0, used = s->points * r->lanes;
    nevh__block b = nevh__block_over(r->width, r->t, r->q, r->p, 1, 1);
    while (column + 1 < used && f->h[column] - f->h[column] == 0)
        column++;
    size_t point = column / r->lanes;
    const slope *x = s->slope;
    while (x + 1 < s->slope + s->slopes && x[1].first <= point)
        x++;
    b.lane = r->lane;
    b.lanes = r->lanes;
    b.groups = s->points; /* of a point, so that the instance comes out */
    b.group = x->instance - point;
    b.used = used;
    b.stride = r->stride;
    if (f->h[column] - f->h[column] == 0)
        return nevh__central_fail(f, term, &b, s->slope->instance, s->slope->k);
    /* A point that is not shifted in any variable is the orbit's. */
    double reach = s->shift[x->k * s->stride + point];
    return reach == 0 ? nevh__block_fail(f, term, &b, column, "", f->h[column])
                      : nevh__fail_outside(f, term, &b, column, x->instance,
                                           x->k, fabs(reach));
}

int nevh__stencil_difference(nevh_field *f, nevh__planned *term,
                             nevh__stencil *s, size_t width, const double t[],
                             const double q[], const double p[], double dh_dq[],
                             double dh_dp[]) {
    const nevh_term *decl = &term->term->decl;
    size_t lanes = lanes_in_block(f, s, width);
    request r = {.width = width, .t = t, .q = q, .p = p};
    r.dh_dq = dh_dq;
    r.dh_dp = dh_dp;
    for (; r.lane < width; r.lane += r.lanes) {
        r.lanes = width - r.lane < lanes ? width - r.lane : lanes;
        r.stride = nevh__padded(s->points * r.lanes);
        fill_rows(f, term, s, &r);
        if (decl->time)
            fill_times(&r, f->times);
        if (s->lanes != r.lanes)
            fill_constants(term, s, &r);
        nevh__term_values(term->term, f->portable, r.stride,
                          s->points * r.lanes, decl->time ? f->times : f->zeros,
                          f->rows, f->rows + term->nq * r.stride, s->constants,
                          f->h, f->one);
        bool finite =
            (r.lanes == 1            ? add_one
             : r.lanes % NEVH__LANES ? add_many
                                     : add_vectors)(f, s, term->nq, &r);
        term->values += s->points * r.lanes;
        if (!finite)
            return fail(f, term, s, &r);
    }
    return NEVH_OK;
}
