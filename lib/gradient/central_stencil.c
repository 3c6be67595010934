/* nevh: slopes from values at points that were laid out in stencil_plan.c.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/block_private.h"
#include "gradient/stencil_private.h"
#include "system/vector_private.h"
#include <math.h>
#include <nevh/body.h>
#include <string.h>

/* One state: each row is a number plus a row of shifts, padding and all, or one
   number an instance. */
NEVH__INLINE void shift_one(const nevh__stencil *s, bool alone,
                            const double *restrict x,
                            const size_t *restrict source,
                            const double *restrict shift,
                            double *restrict row) {
    if (alone) {
        double state = x[*source];
        NEVH_LANES(i, s->padded) {
            row[i] = state + shift[i];
        }
    } else
        NEVH_LANES(i, s->padded) {
            row[i] = x[source[i]] + shift[i];
        }
}

/* Whole vectors of states. */
NEVH__INLINE void shift_vectors(const nevh__stencil *s, size_t lanes,
                                size_t width, const double *x,
                                const size_t *source, const double *shift,
                                double *row) {
    for (size_t lane = 0; lane < lanes; lane += NEVH__IN_VECTOR)
        for (size_t i = 0; i < s->points;) {
            nevh__vector state =
                *(const nevh__vector *)(x + source[i] * width + lane);
            for (size_t end = s->until[i]; i < end; i += 2) { /* + and - */
                double *to = row + i * lanes + lane;
                *(nevh__vector *)to = state + shift[i];
                *(nevh__vector *)(to + lanes) = state + shift[i + 1];
            }
        }
}

/* The same by what each lane has for the variable's steps; other shifts are
   -0.  Apart, so that the others stay as they are. */
__attribute__((noinline)) static void shift_by_lane(const nevh_field *f,
                                                    const nevh__term_part *part,
                                                    size_t width, size_t lane,
                                                    size_t k, double *row) {
    const nevh__stencil *s = part->stencil;
    size_t lanes = part->lanes;
    for (const nevh__stencil_slope *x = s->slope; x < s->slope + s->slopes;
         x++) {
        if (x->k != k)
            continue;
        double *plus = row + x->first * lanes, *minus = plus + lanes;
        for (size_t i = 0; i < lanes; i++) {
            double delta = nevh__delta(f, part->term, s->instance[x->first], k,
                                       nevh__lane_of(f, width, lane + i));
            for (size_t j = 0; j < x->method->offsets; j++) {
                double move = (double)(j + 1) * delta;
                plus[2 * j * lanes + i] += move;
                minus[2 * j * lanes + i] -= move;
            }
        }
    }
}

/* Any number of states. */
NEVH__INLINE void shift_lanes(const nevh__stencil *s, size_t lanes,
                              size_t width, const double *x,
                              const size_t *source, const double *shift,
                              double *row) {
    for (size_t i = 0; i < s->points; i++, row += lanes)
        for (size_t lane = 0; lane < lanes; lane++)
            row[lane] = x[source[i] * width + lane] + shift[i];
}

/* The weighted slopes of the chords, nearest first, of each vector of lanes. */
NEVH__INLINE void add_slope(const nevh_gradient *method, size_t offsets,
                            size_t lanes, bool adds, const double *x,
                            const double *h, double *out, nevh__vector *bad) {
    for (size_t lane = 0; lane < lanes; lane += NEVH__IN_VECTOR) {
        nevh__vector sum = {0};
        for (size_t j = 0; j < offsets; j++) {
            size_t plus = 2 * j * lanes + lane, minus = plus + lanes;
            sum += method->weights[j] * ((*(const nevh__vector *)(h + plus) -
                                          *(const nevh__vector *)(h + minus)) /
                                         (*(const nevh__vector *)(x + plus) -
                                          *(const nevh__vector *)(x + minus)));
        }
        *bad += sum - sum;
        if (adds)
            sum += *(const nevh__vector *)(out + lane);
        *(nevh__vector *)(out + lane) = sum;
    }
}

/* The address of a variable's derivative, from a lane on; adds: it is added there. */
NEVH__INLINE double *place_of(const nevh__term_part *part,
                              const nevh__places *at,
                              const nevh__stencil_slope *x, size_t lane,
                              bool *adds) {
    bool momentum = x->k >= part->term->nq;
    *adds = momentum ? part->adds_p : part->adds_q;
    return (momentum ? at->dh_dp : at->dh_dq) + x->target * at->width + lane;
}

/* The slopes of whole vectors of states; whether all are finite. */
NEVH__INLINE bool add_vectors(const nevh_field *f, const nevh__term_part *part,
                              const nevh__places *at, size_t lane) {
    const nevh__stencil *s = part->stencil;
    size_t lanes = part->lanes;
    nevh__vector bad = {0};
    double sum = 0;
    for (const nevh__stencil_slope *x = s->slope; x < s->slope + s->slopes;
         x++) {
        const double *from = f->rows + x->k * part->stride + x->first * lanes;
        const double *h = f->h + x->first * lanes;
        bool adds;
        double *out = place_of(part, at, x, lane, &adds);
        size_t offsets = x->method->offsets;
        if (offsets == 1)
            add_slope(x->method, 1, lanes, adds, from, h, out, &bad);
        else if (offsets == 2)
            add_slope(x->method, 2, lanes, adds, from, h, out, &bad);
        else
            add_slope(x->method, offsets, lanes, adds, from, h, out, &bad);
    }
    for (size_t i = 0; i < NEVH__IN_VECTOR; i++)
        sum += ((const double *)&bad)[i];
    return sum == 0;
}

/* For a few states, one after the other, as nevh__add_slopes. */
NEVH__INLINE bool add_few(const nevh_gradient *method, size_t lanes, bool adds,
                          const double *x, const double *h, double *out) {
    double bad = 0;
    for (size_t lane = 0; lane < lanes; lane++) {
        double sum = nevh__chord_slope(method, lanes, x + lane, h + lane);
        out[lane] = (adds ? out[lane] : 0) + sum;
        bad += sum - sum;
    }
    return bad != 0;
}

static bool add_many(const nevh_gradient *method, size_t lanes, bool adds,
                     const double *x, const double *h, double *out) {
    if (!adds)
        memset(out, 0, lanes * sizeof *out);
    return nevh__add_slopes(method, lanes, lanes, x, h, out);
}

/* For any number of states. */
NEVH__INLINE bool add_lanes(const nevh_field *f, const nevh__term_part *part,
                            const nevh__places *at, size_t lane) {
    const nevh__stencil *s = part->stencil;
    size_t lanes = part->lanes;
    bool bad = false;
    for (const nevh__stencil_slope *x = s->slope; x < s->slope + s->slopes;
         x++) {
        const double *from = f->rows + x->k * part->stride + x->first * lanes;
        const double *h = f->h + x->first * lanes;
        bool adds;
        double *out = place_of(part, at, x, lane, &adds);
        bad |= lanes < NEVH__LANES
                   ? add_few(x->method, lanes, adds, from, h, out)
                   : add_many(x->method, lanes, adds, from, h, out);
    }
    return !bad;
}

NEVH__INLINE bool add_one(const nevh_field *f, const nevh__term_part *part,
                          const nevh__places *at, size_t lane) {
    const nevh__stencil *s = part->stencil;
    double bad = 0;
    for (const nevh__stencil_slope *x = s->slope; x < s->slope + s->slopes;
         x++) {
        const double *from = f->rows + x->k * part->stride + x->first;
        double sum = nevh__chord_slope(x->method, 1, from, f->h + x->first);
        bool adds;
        double *out = place_of(part, at, x, lane, &adds);
        *out = adds ? *out + sum : sum;
        bad += sum - sum;
    }
    return bad == 0;
}

typedef enum { ONE, VECTORS, LANES } layout;

/* The points of all variables, of all lanes from `lane` on. */
NEVH__INLINE void place_points(nevh_field *f, const nevh__term_part *part,
                               const nevh__places *at, size_t lane,
                               layout shape) {
    const nevh__stencil *s = part->stencil;
    const nevh__planned *term = part->term;
    size_t used = s->points * part->lanes;
    double *row = f->rows;
    for (size_t k = 0; k < term->nv; k++, row += part->stride) {
        const double *x = (k < term->nq ? at->q : at->p) + lane;
        const double *shift = s->shift + k * s->padded;
        const size_t *source = s->source + k * s->padded;
        if (shape == ONE)
            shift_one(s, term->term->decl.count == 1, x, source, shift, row);
        else if (shape == VECTORS)
            shift_vectors(s, part->lanes, at->width, x, source, shift, row);
        else
            shift_lanes(s, part->lanes, at->width, x, source, shift, row);
        if (f->lanes && shape != ONE)
            shift_by_lane(f, part, at->width, lane, k, row);
        for (size_t i = used; shape == LANES && i < part->stride; i++)
            row[i] = row[0];
    }
}

/* A block of the points of all lanes from `lane` on, their values, and the
   slopes; whether all are finite. */
NEVH__INLINE bool take(nevh_field *f, const nevh__term_part *part,
                       const nevh__places *at, size_t lane, layout shape) {
    nevh__planned *term = part->term;
    bool time = term->term->decl.time;
    size_t used = part->stencil->points * part->lanes;
    place_points(f, part, at, lane, shape);
    for (size_t i = 0; time && i < part->stride; i++)
        f->times[i] = at->t[lane + (shape == ONE ? 0 : i % part->lanes)];
    const double *c = part->pitch ? part->c + lane * part->pitch : part->c;
    nevh__term_values(term->term, f->portable, part->stride, used,
                      time ? f->times : f->zeros, f->rows,
                      f->rows + term->nq * part->stride, c, f->h, f->one);
    term->values += used;
    return shape == ONE       ? add_one(f, part, at, lane)
           : shape == VECTORS ? add_vectors(f, part, at, lane)
                              : add_lanes(f, part, at, lane);
}

NEVH_SIMD static bool take_one(nevh_field *f, const nevh__term_part *part,
                               const nevh__places *at) {
    return take(f, part, at, 0, ONE);
}

NEVH_SIMD static bool take_vectors(nevh_field *f, const nevh__term_part *part,
                                   const nevh__places *at, size_t lane) {
    return take(f, part, at, lane, VECTORS);
}

NEVH_SIMD static bool take_lanes(nevh_field *f, const nevh__term_part *part,
                                 const nevh__places *at, size_t lane) {
    return take(f, part, at, lane, LANES);
}

/* The first slope that is not finite, of values that are. */
static int fail_slope(nevh_field *f, const nevh__term_part *part,
                      const nevh__block *b) {
    const nevh__stencil *s = part->stencil;
    for (const nevh__stencil_slope *x = s->slope; x < s->slope + s->slopes; x++)
        for (size_t i = 0; i < part->lanes; i++) {
            size_t at = x->first * part->lanes + i;
            double slope = nevh__chord_slope(x->method, part->lanes,
                                             f->rows + x->k * part->stride + at,
                                             f->h + at);
            if (slope - slope != 0)
                return nevh__central_fail(f, part->term, b, b->lane + i,
                                          s->instance[x->first], x->k);
        }
    return nevh__central_fail(f, part->term, b, b->lane, s->instance[0],
                              s->slope->k);
}

/* Tells what is not finite: a value, or else the first such slope. */
static int central_stencil_fail(nevh_field *f, const nevh__term_part *part,
                                const nevh__places *at, size_t lane) {
    const nevh__stencil *s = part->stencil;
    size_t column = 0, used = s->points * part->lanes;
    nevh__block b = nevh__block_over(at->width, at->t, at->q, at->p, 1, 1);
    while (column + 1 < used && f->h[column] - f->h[column] == 0)
        column++;
    size_t point = column / part->lanes, instance = s->instance[point];
    const nevh__stencil_slope *x = s->slope;
    while (x + 1 < s->slope + s->slopes && x[1].first <= point)
        x++;
    b.lane = lane;
    b.lanes = part->lanes;
    b.groups = s->points; /* of a point, so that the instance comes out */
    b.group = instance - point;
    b.used = used;
    b.stride = part->stride;
    if (f->h[column] - f->h[column] == 0)
        return fail_slope(f, part, &b);
    /* A point that is not shifted in any variable is the orbit's. */
    double reach = s->shift[x->k * s->padded + point];
    return reach == 0
               ? nevh__block_fail(f, part->term, &b, column, "", f->h[column])
               : nevh__fail_outside(f, part->term, &b, column, instance, x->k,
                                    fabs(reach));
}

int nevh__central_stencil_run(const nevh__evaluation *e) {
    nevh_field *f = e->field;
    size_t size = f->n * e->width * sizeof(double);
    if (e->clear_q)
        memset(e->at.dh_dq, 0, size);
    if (e->clear_p)
        memset(e->at.dh_dp, 0, size);
    for (const nevh__term_part *x = e->terms; x < e->terms + e->count; x++) {
        if (e->width == 1 && !take_one(f, x, &e->at))
            return central_stencil_fail(f, x, &e->at, 0);
        bool vectors = x->lanes % NEVH__LANES == 0;
        for (size_t lane = 0; lane < e->width && e->width > 1; lane += x->lanes)
            if (!(vectors ? take_vectors : take_lanes)(f, x, &e->at, lane))
                return central_stencil_fail(f, x, &e->at, lane);
    }
    return NEVH_OK;
}

/* Any places: constants are filled where other lanes are asked for, or lanes
   have their own. */
static const double *central_stencil_constants(const nevh_field *f,
                                               const nevh__planned *term,
                                               nevh__stencil *s, size_t width,
                                               size_t lane, size_t lanes,
                                               size_t stride) {
    size_t size = term->term->decl.nc * stride;
    for (size_t i = 0; (s->lanes != lanes || f->lanes) && i < size; i++) {
        size_t point = i % stride / lanes;
        size_t instance = s->instance[point < s->points ? point : 0];
        s->constants[i] =
            nevh__constant(f, term, instance, i / stride,
                           nevh__lane_of(f, width, lane + i % stride % lanes));
    }
    s->lanes = lanes;
    return s->constants;
}

/* All lanes, or as many vectors of them in each block as may be. */
static size_t lanes_in_block(const nevh_field *f, const nevh__stencil *s,
                             size_t lanes) {
    if (lanes == 1)
        return 1;
    size_t most = f->capacity / s->points;
    if (lanes <= most)
        return lanes;
    if (most < NEVH__LANES)
        return most;
    most -= most % NEVH__LANES;
    return nevh__padded((lanes + (lanes - 1) / most) /
                        ((lanes - 1) / most + 1));
}

int nevh__gradient_central(nevh_field *f, nevh__planned *term,
                           const nevh__places *at) {
    nevh__stencil *s = term->stencil[nevh__part_of(at)];
    if (!s)
        return nevh__central_blocks(f, term, at);
    size_t most = lanes_in_block(f, s, at->width);
    nevh__term_part x = {.term = term,
                         .stencil = s,
                         .adds_q = term != f->whole_q,
                         .adds_p = term != f->whole_p};
    for (size_t lane = 0; lane < at->width; lane += x.lanes) {
        x.lanes = at->width - lane < most ? at->width - lane : most;
        x.stride = nevh__padded(s->points * x.lanes);
        x.c = central_stencil_constants(f, term, s, at->width, lane, x.lanes,
                                        x.stride);
        bool finite = at->width == 1 && !f->lanes ? take_one(f, &x, at)
                      : x.lanes % NEVH__LANES     ? take_lanes(f, &x, at, lane)
                                              : take_vectors(f, &x, at, lane);
        if (!finite)
            return central_stencil_fail(f, &x, at, lane);
    }
    return NEVH_OK;
}
