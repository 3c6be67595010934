/* nevh: exact gradients that are taken many times at the same place in memory.

   All that can be known beforehand is: a call is a list of terms to evaluate,
   or of instances for a single state, the first of which writes each half, or
   its part of it, and others are added to that.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include <nevh/body.h>
#include <stdlib.h>

struct nevh__constants {
    struct nevh__constants *next;
    size_t width;
    double *rows;
};

void nevh__constants_free(struct nevh__constants *c) {
    while (c) {
        struct nevh__constants *next = c->next;
        free(c->rows);
        free(c);
        c = next;
    }
}

static void fill(const nevh_term *decl, size_t width, size_t stride,
                 double *rows) {
    for (size_t k = 0; k < decl->nc; k++)
        for (size_t i = 0; i < stride; i++) {
            size_t instance = i < decl->count * width ? i / width : 0;
            rows[k * stride + i] = decl->c[instance * decl->nc + k];
        }
}

const double *nevh__constants_plan(nevh__planned *term, size_t width) {
    const nevh_term *decl = &term->term->decl;
    size_t stride = nevh__padded(decl->count * width);
    struct nevh__constants *c = term->planned;
    while (c && c->width != width)
        c = c->next;
    if (c || !decl->nc)
        return c ? c->rows : NULL;
    c = nevh__array(1, sizeof *c);
    if (c)
        c->rows = nevh__array(decl->nc * stride, sizeof *c->rows);
    if (!c || !c->rows) {
        free(c);
        return NULL;
    }
    c->width = width;
    c->next = term->planned;
    term->planned = c;
    fill(decl, width, stride, c->rows);
    return c->rows;
}

/* One half of what a term gives: it is written if it is the first, else to
   scratch, and added. */
static void direct(const nevh__planned *term, const nevh__planned *writer,
                   const size_t index[], size_t width, double *half,
                   double *scratch, double **written, double **sum) {
    *sum = term == writer ? NULL : half + index[0] * width;
    *written = term == writer ? half : scratch;
}

static bool wanted(const nevh__call *c, const nevh__planned *term) {
    return (c->half[0] && term->nq) || (c->half[1] && term->np);
}

static bool add_term(nevh__call *c, nevh__planned *term, const double t[],
                     const double q[], const double p[]) {
    nevh_field *f = c->field;
    const nevh_term *decl = &term->term->decl;
    size_t width = c->width, stride = decl->count * width;
    if (c->count == NEVH__MOST_CALLED || !term->straight ||
        stride > f->capacity || (decl->time && decl->count > 1))
        return false;
    nevh__called *x = &c->terms[c->count++];
    *x = (nevh__called){.term = term,
                        .gradient = decl->gradient,
                        .params = decl->params,
                        .stride = stride,
                        .t = decl->time ? t : f->zeros,
                        .q = term->nq ? q + decl->q[0] * width : q,
                        .p = term->np ? p + decl->p[0] * width : p,
                        .c = nevh__constants_plan(term, width)};
    if (decl->nc && !x->c)
        return false;
    c->timed |= decl->time;
    if (c->half[0] && term->nq) {
        x->size_q = stride * term->nq;
        direct(term, f->writer_q, decl->q, width, c->half[0], f->slopes,
               &x->dh_dq, &x->sum_q);
    }
    if (c->half[1] && term->np) {
        x->size_p = stride * term->np;
        direct(term, f->writer_p, decl->p, width, c->half[1],
               f->slopes + stride * term->nq, &x->dh_dp, &x->sum_p);
    }
    x->sums = x->sum_q || x->sum_p;
    return true;
}

/* The variables of a half that have something, as bits. */
static uint64_t bits(size_t first, size_t count) {
    uint64_t low =
        count < NEVH__MOST_POINT_ROWS ? (UINT64_C(1) << count) - 1 : UINT64_MAX;
    return count ? low << first : 0;
}

static bool consecutive(size_t count, const size_t index[]) {
    for (size_t k = 1; k < count; k++)
        if (index[k] != index[0] + k)
            return false;
    return true;
}

/* One half of what an instance gives: written if nothing is there, added if
   something is everywhere, and else there is no way. */
static bool point_half(uint64_t *there, uint64_t here, double *half,
                       double *scratch, double **written, double **sum) {
    uint64_t met = *there & here;
    *sum = met ? half : NULL;
    *written = met ? scratch : half;
    *there |= here;
    return !met || met == here;
}

static bool add_point(nevh__call *c, const nevh__called *given, size_t instance,
                      uint64_t there[2]) {
    const nevh__planned *term = given->term;
    const nevh_term *decl = &term->term->decl;
    const size_t *all_q = decl->q + instance * term->nq;
    const size_t *all_p = decl->p + instance * term->np;
    size_t q = term->nq ? all_q[0] : 0, p = term->np ? all_p[0] : 0;
    if (c->count == NEVH__MOST_CALLED || !consecutive(term->nq, all_q) ||
        !consecutive(term->np, all_p))
        return false;
    nevh__called *x = &c->terms[c->count++];
    *x = *given;
    x->q += q;
    x->p += p;
    x->c = decl->c + instance * decl->nc;
    double *scratch_q = c->field->slopes, *scratch_p = scratch_q + term->nq;
    bool there_q =
        !x->size_q || point_half(&there[0], bits(q, x->size_q), c->half[0] + q,
                                 scratch_q, &x->dh_dq, &x->sum_q);
    bool there_p =
        !x->size_p || point_half(&there[1], bits(p, x->size_p), c->half[1] + p,
                                 scratch_p, &x->dh_dp, &x->sum_p);
    x->sums = x->sum_q || x->sum_p;
    return there_q && there_p;
}

static bool add_points(nevh__call *c, nevh__planned *term, const double t[],
                       const double q[], const double p[], uint64_t there[2]) {
    const nevh_term *decl = &term->term->decl;
    nevh__called given = {.term = term,
                          .point = decl->point_gradient,
                          .params = decl->params,
                          .size_q = c->half[0] ? term->nq : 0,
                          .size_p = c->half[1] ? term->np : 0,
                          .t = decl->time ? t : c->field->zeros,
                          .q = q,
                          .p = p};
    c->timed |= decl->time;
    for (size_t i = 0; given.point && i < decl->count; i++)
        if (!add_point(c, &given, i, there))
            return false;
    return given.point;
}

static bool plan_points(nevh__call *c, const double t[], const double q[],
                        const double p[]) {
    nevh_field *f = c->field;
    uint64_t there[2] = {0, 0}, all = bits(0, f->n);
    if (f->n > NEVH__MOST_POINT_ROWS)
        return false;
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++)
        if (wanted(c, term) && !add_points(c, term, t, q, p, there))
            return false;
    return (!c->half[0] || there[0] == all) && (!c->half[1] || there[1] == all);
}

static bool plan_blocks(nevh__call *c, const double t[], const double q[],
                        const double p[]) {
    nevh_field *f = c->field;
    if (c->width % NEVH__LANES || (c->half[0] && !f->writer_q) ||
        (c->half[1] && !f->writer_p))
        return false;
    for (nevh__planned *term = f->terms; term < f->terms + f->n_terms; term++)
        if (wanted(c, term) && !add_term(c, term, t, q, p))
            return false;
    return true;
}

/* Whether no other term reads momenta. */
static void find_masses(nevh__call *c) {
    const nevh__called *x = c->terms;
    const nevh_term *decl = &x->term->term->decl;
    const double *inverse = nevh__term_inverse_masses(x->term->term);
    size_t alone = c->width == 1 ? decl->count : 1;
    if (c->half[0] || !inverse || c->count != alone ||
        decl->count != c->field->n)
        return;
    c->inverse = c->width == 1 ? inverse : x->c;
}

static bool plan_exact(nevh__call *c, const double t[], const double q[],
                       const double p[]) {
    bool there =
        c->width == 1 ? plan_points(c, t, q, p) : plan_blocks(c, t, q, p);
    if (there)
        find_masses(c);
    return there;
}

/* Of small systems, for whole vectors of states, or one. */
static bool plan_values(nevh__call *c) {
    const nevh_field *f = c->field;
    c->count = f->n_terms;
    c->timed = true;
    return f->n <= NEVH__MOST_POINT_ROWS;
}

nevh__call nevh__call_plan(nevh_field *f, size_t width, const double t[],
                           const double q[], const double p[], double dh_dq[],
                           double dh_dp[]) {
    nevh__call c = {.field = f,
                    .width = width,
                    .exact = f->gradient == nevh_exact,
                    .t = t,
                    .q = q,
                    .p = p,
                    .half = {dh_dq, dh_dp}};
    bool there = !nevh__field_ready(f) &&
                 (c.exact ? plan_exact(&c, t, q, p) : plan_values(&c));
    return there ? c : (nevh__call){0};
}

int nevh__call_run_values(const nevh__call *c) {
    nevh_field *f = c->field;
    double *dh_dq = c->half[0], *dh_dp = c->half[1];
    bool differences = f->gradient->offsets;
    int status = NEVH_OK;
    for (size_t i = 0; dh_dq && i < f->n * c->width; i++)
        dh_dq[i] = 0;
    for (size_t i = 0; dh_dp && i < f->n * c->width; i++)
        dh_dp[i] = 0;
    for (nevh__planned *term = f->terms;
         !status && term < f->terms + f->n_terms; term++)
        if (wanted(c, term))
            status =
                (differences ? nevh__gradient_central : nevh__gradient_complex)(
                    f, term, c->width, c->t, c->q, c->p, dh_dq, dh_dp);
    return status;
}

NEVH_SIMD static void add(size_t size, const double x[], double sum[]) {
    NEVH_LANES(i, size) {
        sum[i] += x[i];
    }
}

static void add_numbers(size_t size, const double x[], double sum[]) {
    for (size_t k = 0; k < size; k++)
        sum[k] += x[k];
}

void nevh__call_add(const nevh__called *x) {
    void (*to)(size_t, const double *, double *) = x->point ? add_numbers : add;
    if (x->sum_q)
        to(x->size_q, x->dh_dq, x->sum_q);
    if (x->sum_p)
        to(x->size_p, x->dh_dp, x->sum_p);
}

bool nevh__call_take(const nevh__call *c) {
    double sum = 0;
    nevh__call_run(c);
    for (size_t half = 0; half < 2; half++)
        for (size_t k = 0; c->half[half] && k < c->field->n; k++) {
            double x = c->half[half][k * c->width];
            sum += x - x;
        }
    if (sum != 0)
        return false;
    if (c->half[0])
        c->field->gradients++;
    return true;
}
