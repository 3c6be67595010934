/* nevh: which evaluator takes a gradient is decided here, when it is planned.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/evaluation_private.h"
#include "system/vector_private.h"
#include <nevh/body.h>
#include <stdlib.h>
#include <string.h>

/* Exact gradients have another way of their own, which looks at its results:
   who plans them takes them so where no evaluator is applicable. */
static bool any_but_exact(const nevh__evaluation *e) {
    const nevh_field *f = e->field;
    if (f->gradient == nevh_exact)
        return false;
    if (f->n > NEVH__MOST_POINT_ROWS)
        return false; /* evaluations are for small systems */
    return true;
}

static bool plan_terms(nevh__evaluation *e) {
    e->count = e->field->n_terms;
    e->timed = true;
    return true;
}

static const nevh__evaluator term_by_term = {any_but_exact, plan_terms};

static const nevh__evaluator *const evaluators[] = {
    &nevh__exact_point, &nevh__exact_block, &nevh__central_stencil,
    &term_by_term};

/* The inverse masses, if no other term reads momenta. */
static const double *find_masses(const nevh__evaluation *e) {
    const nevh__term_part *x = e->terms;
    const nevh_term *decl = &x->term->term->decl;
    const double *inverse = nevh__term_inverse_masses(x->term->term);
    size_t alone = e->width == 1 ? decl->count : 1;
    if (e->at.dh_dq || !inverse || e->count != alone ||
        decl->count != e->field->n)
        return NULL;
    return e->width == 1 ? inverse : x->c;
}

nevh__evaluation nevh__evaluation_plan(nevh_field *f, size_t width,
                                       const double t[], const double q[],
                                       const double p[], double dh_dq[],
                                       double dh_dp[]) {
    const nevh__evaluation asked = {
        .field = f, .width = width, .at = {width, t, q, p, dh_dq, dh_dp}};
    size_t count = sizeof evaluators / sizeof *evaluators;
    for (size_t i = 0; i < count && !nevh__field_ready(f); i++) {
        nevh__evaluation e = asked;
        if (!evaluators[i]->applicable(&e) || !evaluators[i]->plan(&e))
            continue;
        e.exact = f->gradient == nevh_exact;
        if (e.exact)
            e.inverse = find_masses(&e);
        return e;
    }
    return (nevh__evaluation){0};
}

int nevh__field_terms(nevh_field *f, const nevh__places *at) {
    size_t size = f->n * at->width * sizeof(double);
    int status = NEVH_OK;
    if (at->dh_dq && !nevh__writes(f, f->whole_q, at->width))
        memset(at->dh_dq, 0, size);
    if (at->dh_dp && !nevh__writes(f, f->whole_p, at->width))
        memset(at->dh_dp, 0, size);
    nevh__gradient_fn evaluate = f->gradient->evaluate;
    for (size_t i = 0; !status && i < f->n_pieces; i++) {
        nevh__planned *piece = f->pieces[i];
        if (!nevh__wanted(f, at, piece))
            continue;
        status = evaluate(f, piece, at);
        nevh__joint_count(f, piece);
        if (status)
            status = nevh__joint_fail(f, piece, at, status);
    }
    return status;
}

NEVH_SIMD static void evaluation_add(size_t size, const double x[],
                                     double sum[]) {
    NEVH_LANES(i, size) {
        sum[i] += x[i];
    }
}

static void add_numbers(size_t size, const double x[], double sum[]) {
    for (size_t k = 0; k < size; k++)
        sum[k] += x[k];
}

void nevh__evaluation_add(const nevh__term_part *x) {
    void (*to)(size_t, const double *, double *) =
        x->point ? add_numbers : evaluation_add;
    if (x->sum_q)
        to(x->size_q, x->dh_dq, x->sum_q);
    if (x->sum_p)
        to(x->size_p, x->dh_dp, x->sum_p);
}

/* A term's constants for blocks of so many states. */
struct nevh__constants {
    struct nevh__constants *next;
    const nevh__stencil *of; /* NULL: of instances */
    size_t width, blocks;
    double rows[];
};

void nevh__constants_free(struct nevh__constants *c) {
    while (c) {
        struct nevh__constants *next = c->next;
        free(c);
        c = next;
    }
}

static size_t columns_of(const nevh__planned *term, const nevh__stencil *of) {
    return of ? nevh__stencil_points(of) : term->term->decl.count;
}

static void evaluation_fill(const nevh_field *f, const nevh__planned *term,
                            struct nevh__constants *c) {
    size_t columns = columns_of(term, c->of), nc = term->term->decl.nc;
    size_t stride = nevh__padded(columns * c->width), size = nc * stride;
    for (size_t i = 0; i < c->blocks * size; i++) {
        size_t column = i % stride / c->width;
        size_t x = column < columns ? column : 0;
        size_t instance = c->of ? nevh__stencil_instance(c->of, x) : x;
        size_t state = i / size * c->width + i % stride % c->width;
        c->rows[i] = nevh__constant(f, term, instance, i % size / stride,
                                    nevh__lane_of(f, c->width, state));
    }
}

void nevh__constants_fill(const nevh_field *f, const nevh__planned *term) {
    for (struct nevh__constants *c = term->constants; c; c = c->next)
        evaluation_fill(f, term, c);
}

void nevh__evaluation_refresh(const nevh__evaluation *e) {
    for (const nevh__term_part *x = e->terms; x < e->terms + e->count; x++)
        for (struct nevh__constants *c = x->term->constants; c; c = c->next)
            if (c->rows == x->c)
                evaluation_fill(e->field, x->term, c);
}

const double *nevh__constants_plan(const nevh_field *f, nevh__planned *term,
                                   const nevh__stencil *of, size_t width,
                                   size_t total) {
    size_t blocks = f->lanes ? total / width : 1;
    size_t rows = nevh__padded(columns_of(term, of) * width);
    size_t count = term->term->decl.nc * rows * blocks;
    struct nevh__constants *c = term->constants;
    while (c && (c->width != width || c->of != of || c->blocks != blocks))
        c = c->next;
    if (c || !count)
        return c ? c->rows : NULL;
    c = nevh__array(1, sizeof *c + count * sizeof *c->rows);
    if (!c)
        return NULL;
    c->next = term->constants;
    c->of = of;
    c->width = width;
    c->blocks = blocks;
    term->constants = c;
    evaluation_fill(f, term, c);
    return c->rows;
}

/* One state goes through places of the field's own, for dH/dq, dH/dp, or
   both. */
struct nevh__single {
    nevh__evaluation of[3];
    double t[NEVH__LANES], numbers[]; /* q, p, dH/dq, dH/dp */
};

/* A number for a state, or one for each lane of a vector. */
static nevh__evaluation plan_single(nevh_field *f, size_t width, size_t part) {
    struct nevh__single *s = f->single;
    size_t size = f->n * NEVH__LANES;
    double *x = nevh__aligned(s->numbers);
    return nevh__evaluation_plan(f, width, s->t, x, x + size,
                                 part != 1 ? x + 2 * size : NULL,
                                 part != 0 ? x + 3 * size : NULL);
}

bool nevh__single_plan(nevh_field *f) {
    size_t size = (4 * f->n + 1) * NEVH__LANES * sizeof(double);
    if (f->gradient != nevh_exact || f->n > NEVH__MOST_POINT_ROWS)
        return true;
    f->single = nevh__array(1, sizeof *f->single + size);
    for (size_t part = 0; f->single && part < 3; part++) {
        nevh__evaluation *e = &f->single->of[part];
        *e = plan_single(f, 1, part);
        if (!e->count && f->broadcasts)
            *e = plan_single(f, NEVH__LANES, part);
        if (!e->exact)
            e->count = 0; /* as well where the state is */
    }
    return f->single && !f->starved;
}

void nevh__single_free(struct nevh__single *s) {
    free(s);
}

/* Stores in parts are slow to load as a vector. */
NEVH_SIMD static void evaluation_repeat(size_t count, const double from[],
                                        double to[]) {
    nevh__broadcast(count, from, to);
}

static void evaluation_load(size_t width, size_t count, const double from[],
                            const double to[]) {
    if (width > 1)
        evaluation_repeat(count, from, (double *)to);
    else
        for (size_t k = 0; k < count; k++)
            ((double *)to)[k] = from[k];
}

/* As if added to 0; returns the sum of x - x. */
static double evaluation_store(size_t width, size_t count, const double from[],
                               double to[]) {
    double sum = 0;
    for (size_t k = 0; to && k < count; k++, from += width) {
        to[k] = 0 + *from;
        sum += *from - *from;
    }
    return sum;
}

/* False: there is no such evaluation, or something is not finite. */
static bool take_single(nevh_field *f, const nevh__places *at) {
    const nevh__evaluation *e =
        f->single ? &f->single->of[nevh__part_of(at)] : NULL;
    if (!e || !e->count || (!at->dh_dq && !at->dh_dp))
        return false;
    evaluation_load(e->width, 1, at->t, e->at.t);
    evaluation_load(e->width, f->n, at->q, e->at.q);
    evaluation_load(e->width, f->n, at->p, e->at.p);
    nevh__evaluation_run(e);
    return evaluation_store(e->width, f->n, e->at.dh_dq, at->dh_dq) +
               evaluation_store(e->width, f->n, e->at.dh_dp, at->dh_dp) ==
           0;
}

int nevh__field_gradient_padded(nevh_field *f, size_t used,
                                const nevh__places *at) {
    int status = nevh__field_ready(f);
    if (status)
        return status;
    if (at->dh_dq)
        f->gradients += used;
    if (at->width == 1 && !f->lanes && take_single(f, at))
        return NEVH_OK;
    return nevh__field_terms(f, at);
}

/* Takes the terms of some parts; afterwards gradients are of those that kick again. */
static int take_parts(nevh_field *f, unsigned parts, const nevh__places *at) {
    int status = nevh__field_ready(f);
    unsigned kept = f->parts;
    f->parts = parts;
    if (!status)
        status = nevh__field_terms(f, at);
    f->parts = kept;
    return status;
}

int nevh__field_inner_gradient(nevh_field *f, const nevh__places *at) {
    f->inner += f->n_inner * at->width;
    return take_parts(f, 1u << NEVH__INNER, at);
}

int nevh__field_whole_gradient(nevh_field *f, size_t width, const double t[],
                               const double q[], const double p[],
                               double dh_dq[], double dh_dp[]) {
    const nevh__places at = {width, t, q, p, dh_dq, dh_dp};
    return f->parts != NEVH__ALL_PARTS
               ? take_parts(f, NEVH__ALL_PARTS, &at)
               : nevh_field_gradient(f, width, t, q, p, dh_dq, dh_dp);
}

int nevh_field_gradient(nevh_field *f, size_t width, const double t[],
                        const double q[], const double p[], double dh_dq[],
                        double dh_dp[]) {
    if (!f)
        return NEVH_EINVAL;
    return nevh__field_gradient_padded(
        f, width, &(nevh__places){width, t, q, p, dh_dq, dh_dp});
}
