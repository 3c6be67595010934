/* nevh: central differences whose points are laid out when planned.

   For a few orbits most time would go into bookkeeping, and into waiting for
   single numbers just written to be read back as vectors.  So the points of all
   variables and instances of a term are made whole: each row is its variable
   plus a row of shifts, -0 where the variable is not moved (x + -0 is x to the
   last bit, also for -0).  A column is (point * lanes + lane); the points of
   one variable stand side by side, + before -, nearest first.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/evaluation_private.h"
#include "system/vector_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_VARIABLES = 16, MOST_SLOPES = 64 };

/* The difference by one variable of one instance. */
typedef struct {
    size_t k;      /* the variable */
    size_t target; /* row of the half of the gradient that it belongs to */
    size_t first;  /* of its points */
    const nevh_gradient *method;
} slope;

/* What dH/dq, dH/dp or both of a term take. */
struct nevh__stencil {
    size_t points, padded;
    double *shift;     /* nv x padded */
    size_t *source;    /* nv x padded: what is shifted, of q or p */
    size_t *until;     /* points: where those of the same instance end */
    size_t *instance;  /* points */
    double *constants; /* of any places: nc rows of so many lanes */
    size_t lanes;      /* 0: of none yet */
    size_t slopes;
    slope slope[MOST_SLOPES];
};

size_t nevh__stencil_points(const nevh__stencil *s) {
    return s->points;
}

size_t nevh__stencil_instance(const nevh__stencil *s, size_t point) {
    return s->instance[point];
}

/* What a pass of a term has of the halves asked for. */
typedef struct {
    size_t begin, end;
} range;

static range vars_of(const nevh__pass *pass, size_t part) {
    return (range){part == 1 ? pass->first_p : pass->begin,
                   part == 0 ? pass->first_p : pass->end};
}

static void list_pass(const nevh_field *f, const nevh__planned *term,
                      const nevh__pass *pass, size_t part, nevh__stencil *s) {
    range r = vars_of(pass, part);
    for (size_t i = 0; i < term->term->decl.count; i++) {
        size_t from = s->points;
        for (size_t v = r.begin; v < r.end; v++) {
            size_t k = term->vars[v];
            double delta = term->delta[i * term->nv + k];
            s->slope[s->slopes++] =
                (slope){k, nevh__index(term, i, k), s->points,
                        pass->pairs == 1 ? nevh_central2 : f->gradient};
            for (size_t j = 0; j < 2 * pass->pairs; j++) {
                double move = (double)(j / 2 + 1) * delta;
                s->shift[k * s->padded + s->points++] = j % 2 ? -move : move;
            }
        }
        for (size_t at = from; at < s->points; at++) {
            s->until[at] = s->points;
            s->instance[at] = i;
            for (size_t k = 0; k < term->nv; k++)
                s->source[k * s->padded + at] = nevh__index(term, i, k);
        }
    }
}

/* Padding repeats the first column. */
static void fill(const nevh_field *f, const nevh__planned *term, size_t part,
                 nevh__stencil *s) {
    s->points = 0;
    for (size_t i = 0; i < term->nv * s->padded; i++)
        s->shift[i] = -0.0;
    list_pass(f, term, &term->pass[0], part, s);
    list_pass(f, term, &term->pass[1], part, s);
    for (size_t k = 0; k < term->nv; k++)
        for (size_t i = s->points; i < s->padded; i++)
            s->source[k * s->padded + i] = s->source[k * s->padded];
}

static size_t count_points(const nevh__planned *term, size_t part,
                           size_t *slopes) {
    size_t points = *slopes = 0;
    for (const nevh__pass *pass = term->pass; pass < term->pass + 2; pass++) {
        range r = vars_of(pass, part);
        size_t count = (r.end - r.begin) * term->term->decl.count;
        *slopes += count;
        points += count * 2 * pass->pairs;
    }
    return points;
}

/* Returns false when memory is out. */
static bool plan_part(const nevh_field *f, nevh__planned *term, size_t part) {
    size_t slopes, points = count_points(term, part, &slopes);
    if (slopes == 0)
        return true; /* there is nothing to take */
    if (term->nv > MOST_VARIABLES || slopes > MOST_SLOPES)
        return true; /* most of a row would be variables at rest */
    if (points > f->capacity)
        return true; /* there is no room for all points at once */
    nevh__stencil *s = term->stencil[part] = nevh__array(1, sizeof *s);
    if (!s)
        return false;
    s->padded = nevh__padded(points);
    s->shift = nevh__array(term->nv * s->padded, sizeof *s->shift);
    s->source = nevh__array(term->nv * s->padded, sizeof *s->source);
    s->until = nevh__array(points, sizeof *s->until);
    s->instance = nevh__array(points, sizeof *s->instance);
    s->constants =
        nevh__array(term->term->decl.nc * f->capacity, sizeof *s->constants);
    if (!s->shift || !s->source || !s->until || !s->instance || !s->constants)
        return false;
    fill(f, term, part, s);
    return true;
}

/* Whether the slopes of a half are one for each row. */
static bool covers(const nevh_field *f, const nevh__stencil *s) {
    bool there[MOST_SLOPES] = {false};
    if (!s || s->slopes != f->n)
        return false;
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
        if (there[x->target])
            return false;
        there[x->target] = true;
    }
    return true;
}

bool nevh__central_stencil_plan(nevh_field *f) {
    bool q = false, p = false; /* whether a term has a share in them */
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++) {
        for (size_t part = 0; part < 3; part++)
            if (!plan_part(f, term, part))
                return false;
        /* Both halves have a stencil, or else blocks add them. */
        bool both = !term->nq || !term->np || term->stencil[2];
        if (!q && both && covers(f, term->stencil[0]))
            f->whole_q = term;
        if (!p && both && covers(f, term->stencil[1]))
            f->whole_p = term;
        q |= term->nq > 0;
        p |= term->np > 0;
    }
    return true;
}

void nevh__central_stencil_clear(nevh__planned *term) {
    for (size_t part = 0; part < 3; part++) {
        nevh__stencil *s = term->stencil[part];
        if (!s)
            continue;
        free(s->shift);
        free(s->source);
        free(s->until);
        free(s->instance);
        free(s->constants);
        free(s);
        term->stencil[part] = NULL;
    }
}

/* The width's lanes, or a part of them in whole vectors, for which there is
   room in a block; 0: there is none. */
static size_t lanes_of(const nevh__evaluation *e, const nevh__stencil *s) {
    size_t lanes = e->width;
    while (lanes > 0 &&
           (lanes * s->points > e->field->capacity || e->width % lanes))
        lanes -= lanes > NEVH__LANES ? NEVH__LANES : lanes;
    return lanes;
}

static bool applicable(const nevh__evaluation *e) {
    const nevh_field *f = e->field;
    if (!f->gradient->offsets)
        return false; /* there are no points */
    if (e->width != 1 && e->width % NEVH__LANES)
        return false; /* rows of points are whole vectors */
    if (f->n > NEVH__MOST_POINT_ROWS)
        return false; /* evaluations are for small systems */
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__stencil *s = f->terms[i].stencil[nevh__part_of(&e->at)];
        if (!nevh__wanted(&e->at, &f->terms[i]))
            continue;
        if (!s)
            return false; /* it is taken in blocks */
        if (!lanes_of(e, s))
            return false; /* there is no room for a vector of states */
    }
    return true;
}

static bool add_part(nevh__evaluation *e, nevh__planned *term) {
    nevh_field *f = e->field;
    const nevh__stencil *s = term->stencil[nevh__part_of(&e->at)];
    size_t lanes = lanes_of(e, s);
    if (e->count == NEVH__MOST_PARTS)
        return false;
    nevh__term_part *x = &e->terms[e->count++];
    *x = (nevh__term_part){.term = term,
                           .stencil = s,
                           .lanes = lanes,
                           .stride = nevh__padded(s->points * lanes),
                           .c = nevh__constants_plan(term, s, lanes),
                           .adds_q = term != f->whole_q,
                           .adds_p = term != f->whole_p};
    e->timed |= term->term->decl.time;
    bool known = !term->term->decl.nc || x->c;
    f->starved |= !known;
    return known;
}

static bool plan(nevh__evaluation *e) {
    nevh_field *f = e->field;
    e->clear_q = e->at.dh_dq && !f->whole_q;
    e->clear_p = e->at.dh_dp && !f->whole_p;
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++) {
        if (nevh__wanted(&e->at, term) && !add_part(e, term))
            return false;
    }
    e->stencil = true;
    return e->count > 0;
}

const nevh__evaluator nevh__central_stencil = {applicable, plan};

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

/* Where the slope of a variable goes, from a lane on, and whether it is added
   there. */
NEVH__INLINE double *place_of(const nevh__term_part *part,
                              const nevh__places *at, const slope *x,
                              size_t lane, bool *adds) {
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
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
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

/* Of any number of states. */
static bool add_lanes(const nevh_field *f, const nevh__term_part *part,
                      const nevh__places *at, size_t lane) {
    const nevh__stencil *s = part->stencil;
    size_t lanes = part->lanes;
    bool bad = false;
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
        size_t first = x->first * lanes;
        bool adds;
        double *out = place_of(part, at, x, lane, &adds);
        if (!adds)
            memset(out, 0, lanes * sizeof *out);
        bad |= nevh__add_slopes(x->method, lanes, lanes,
                                f->rows + x->k * part->stride + first,
                                f->h + first, out);
    }
    return !bad;
}

NEVH__INLINE bool add_one(const nevh_field *f, const nevh__term_part *part,
                          const nevh__places *at, size_t lane) {
    const nevh__stencil *s = part->stencil;
    double bad = 0;
    for (const slope *x = s->slope; x < s->slope + s->slopes; x++) {
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

/* A block of the points of all lanes from `lane` on, their values, and the
   slopes; whether all are finite. */
NEVH__INLINE bool take(nevh_field *f, const nevh__term_part *part,
                       const nevh__places *at, size_t lane, layout shape) {
    const nevh__stencil *s = part->stencil;
    nevh__planned *term = part->term;
    const nevh_term *decl = &term->term->decl;
    size_t used = s->points * part->lanes;
    double *row = f->rows;
    for (size_t k = 0; k < term->nv; k++, row += part->stride) {
        const double *x = (k < term->nq ? at->q : at->p) + lane;
        const double *shift = s->shift + k * s->padded;
        const size_t *source = s->source + k * s->padded;
        if (shape == ONE)
            shift_one(s, decl->count == 1, x, source, shift, row);
        else if (shape == VECTORS)
            shift_vectors(s, part->lanes, at->width, x, source, shift, row);
        else
            shift_lanes(s, part->lanes, at->width, x, source, shift, row);
        for (size_t i = used; shape == LANES && i < part->stride; i++)
            row[i] = row[0];
    }
    for (size_t i = 0; decl->time && i < part->stride; i++)
        f->times[i] = at->t[lane + (shape == ONE ? 0 : i % part->lanes)];
    nevh__term_values(term->term, f->portable, part->stride, used,
                      decl->time ? f->times : f->zeros, f->rows,
                      f->rows + term->nq * part->stride, part->c, f->h, f->one);
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

/* Tells what is not finite: a value, or else the first such slope. */
static int fail(nevh_field *f, const nevh__term_part *part,
                const nevh__places *at, size_t lane) {
    const nevh__stencil *s = part->stencil;
    size_t column = 0, used = s->points * part->lanes;
    nevh__block b = nevh__block_over(at->width, at->t, at->q, at->p, 1, 1);
    while (column + 1 < used && f->h[column] - f->h[column] == 0)
        column++;
    size_t point = column / part->lanes, instance = s->instance[point];
    const slope *x = s->slope;
    while (x + 1 < s->slope + s->slopes && x[1].first <= point)
        x++;
    b.lane = lane;
    b.lanes = part->lanes;
    b.groups = s->points; /* of a point, so that the instance comes out */
    b.group = instance - point;
    b.used = used;
    b.stride = part->stride;
    if (f->h[column] - f->h[column] == 0)
        return nevh__central_fail(f, part->term, &b, s->instance[0],
                                  s->slope->k);
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
            return fail(f, x, &e->at, 0);
        for (size_t lane = 0; lane < e->width && e->width > 1; lane += x->lanes)
            if (!take_vectors(f, x, &e->at, lane))
                return fail(f, x, &e->at, lane);
    }
    return NEVH_OK;
}

/* Any places: constants are filled where other lanes are asked for. */
static const double *constants(const nevh__planned *term, nevh__stencil *s,
                               size_t lanes, size_t stride) {
    const nevh_term *decl = &term->term->decl;
    for (size_t i = 0; s->lanes != lanes && i < decl->nc * stride; i++) {
        size_t point = i % stride / lanes;
        size_t instance = s->instance[point < s->points ? point : 0];
        s->constants[i] = decl->c[instance * decl->nc + i / stride];
    }
    s->lanes = lanes;
    return s->constants;
}

/* All lanes, or as many vectors of them in each block as may be. */
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
        x.c = constants(term, s, x.lanes, x.stride);
        bool finite = at->width == 1          ? take_one(f, &x, at)
                      : x.lanes % NEVH__LANES ? take_lanes(f, &x, at, lane)
                                              : take_vectors(f, &x, at, lane);
        if (!finite)
            return fail(f, &x, at, lane);
    }
    return NEVH_OK;
}
