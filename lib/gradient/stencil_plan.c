/* nevh: central differences whose points are laid out when planned.

   For a few orbits most time would go into bookkeeping, and into waiting for
   single numbers just written to be read back as vectors.  So the points of all
   variables and instances of a term are made whole: each row is its variable
   plus a row of shifts, -0 where the variable is not moved (x + -0 is x to the
   last bit, also for -0).
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/stencil_private.h"
#include "system/vector_private.h"
#include <stdlib.h>

enum { MOST_VARIABLES = 16 };

size_t nevh__stencil_points(const nevh__stencil *s) {
    return s->points;
}

size_t nevh__stencil_instance(const nevh__stencil *s, size_t point) {
    return s->instance[point];
}

/* The range of a pass in the requested halves of the gradient. */
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
            s->slope[s->slopes++] = (nevh__stencil_slope){
                k, nevh__index(term, i, k), s->points,
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
static void stencil_plan_fill(const nevh_field *f, const nevh__planned *term,
                              size_t part, nevh__stencil *s) {
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
    if (term->nv > MOST_VARIABLES || slopes > NEVH__MOST_SLOPES)
        return true; /* most of a row would be variables at rest */
    if (points > f->capacity)
        return true; /* there is no room for all points at once */
    nevh__stencil *s = term->stencil[part] =
        nevh__array(1, sizeof *s + slopes * sizeof *s->slope);
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
    stencil_plan_fill(f, term, part, s);
    return true;
}

/* True if the stencil has one derivative for each row of a half. */
static bool covers(const nevh_field *f, const nevh__stencil *s) {
    bool there[NEVH__MOST_SLOPES] = {false};
    if (!s || s->slopes != f->n)
        return false;
    for (const nevh__stencil_slope *x = s->slope; x < s->slope + s->slopes;
         x++) {
        if (there[x->target])
            return false;
        there[x->target] = true;
    }
    return true;
}

bool nevh__central_stencil_plan(nevh_field *f) {
    bool q = false, p = false; /* whether a term has a share in them */
    if (!nevh__field_join(f))
        return false;
    for (size_t i = 0; i < f->n_pieces; i++) {
        nevh__planned *term = f->pieces[i];
        for (size_t part = 0; part < 3; part++)
            if (!plan_part(f, term, part))
                return false;
        /* Both halves have a stencil, or else blocks add them. */
        bool both = !term->nq || !term->np || term->stencil[2];
        both = both && !term->members; /* which add to 0 */
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

void nevh__central_stencils_clear(nevh_field *f) {
    for (size_t i = 0; i < f->n_pieces; i++)
        nevh__central_stencil_clear(f->pieces[i]);
    f->whole_q = f->whole_p = NULL;
}

/* The width's lanes, or a part of them in whole vectors, for which there is
   room in a block; 0: there is none. */
static size_t stencil_plan_lanes_of(const nevh__evaluation *e,
                                    const nevh__stencil *s) {
    size_t lanes = e->width;
    while (lanes > 0 &&
           (lanes * s->points > e->field->capacity || e->width % lanes))
        lanes -= lanes > NEVH__LANES ? NEVH__LANES : lanes;
    return lanes;
}

static bool stencil_plan_applicable(const nevh__evaluation *e) {
    const nevh_field *f = e->field;
    if (!f->gradient->offsets)
        return false; /* there are no points */
    if (f->lanes && e->width % NEVH__LANES)
        return false; /* constants of lanes are whole vectors */
    if (f->n > NEVH__MOST_POINT_ROWS)
        return false; /* evaluations are for small systems */
    for (size_t i = 0; i < f->n_terms; i++) {
        const nevh__stencil *s = f->terms[i].stencil[nevh__part_of(&e->at)];
        if (!nevh__wanted(f, &e->at, &f->terms[i]))
            continue;
        if (!s)
            return false; /* it is taken in blocks */
        if (!stencil_plan_lanes_of(e, s))
            return false; /* there is no room for a vector of states */
    }
    return true;
}

static bool stencil_plan_add_part(nevh__evaluation *e, nevh__planned *term) {
    nevh_field *f = e->field;
    const nevh__stencil *s = term->stencil[nevh__part_of(&e->at)];
    size_t lanes = stencil_plan_lanes_of(e, s);
    if (e->count == NEVH__MOST_PARTS)
        return false;
    nevh__term_part *x = &e->terms[e->count++];
    *x = (nevh__term_part){
        .term = term,
        .stencil = s,
        .lanes = lanes,
        .stride = nevh__padded(s->points * lanes),
        .c = nevh__constants_plan(f, term, s, lanes, e->width),
        .pitch = f->lanes ? s->points * term->term->decl.nc : 0,
        .adds_q = term != f->whole_q,
        .adds_p = term != f->whole_p};
    e->timed |= term->term->decl.time;
    bool known = !term->term->decl.nc || x->c;
    f->starved |= !known;
    return known;
}

static bool stencil_plan_plan(nevh__evaluation *e) {
    nevh_field *f = e->field;
    e->clear_q = e->at.dh_dq && !f->whole_q;
    e->clear_p = e->at.dh_dp && !f->whole_p;
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++) {
        if (nevh__wanted(f, &e->at, term) && !stencil_plan_add_part(e, term))
            return false;
    }
    e->stencil = true;
    return e->count > 0;
}

const nevh__evaluator nevh__central_stencil = {stencil_plan_applicable,
                                               stencil_plan_plan};
