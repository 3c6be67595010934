/* nevh: central differences of a term of many instances as C text: the body of
   its loop, of which each variable is moved in turn.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/slope_private.h"
#include <stdio.h>
#include <stdlib.h>

/* A variable that is moved. */
typedef struct {
    const nevh__term_loop *x;
    size_t k;
    unsigned id;
} moved;

static void name_moved(nevh__writer *w, const nevh__formula_text *f,
                       nevh__variable kind, size_t k, char name[NEVH__NAME]) {
    const moved *m = f->data;
    size_t all = kind == NEVH__P ? m->x->s->term->nq + k : k;
    nevh__formula_text at = *f;
    at.data = m->x;
    if ((kind == NEVH__Q || kind == NEVH__P) && all == m->k)
        snprintf(name, NEVH__NAME, "y%u", m->id);
    else
        nevh__loop_name(w, &at, kind, k, name);
}

static double loop_differences_step_of(const nevh__term_loop *x,
                                       size_t instance, size_t k) {
    return x->s->term->delta[instance * x->s->term->nv + k];
}

bool nevh__loop_has_common_step(const nevh__planned *term, size_t k) {
    for (size_t i = 1; i < term->term->decl.count; i++)
        if (term->delta[i * term->nv + k] != term->delta[k])
            return false;
    return true;
}

/* Names the step of variable k. */
static void name_step(const nevh__term_loop *x, size_t k,
                      char name[NEVH__NAME]) {
    nevh__writer *w = x->s->w;
    char number[NEVH__NAME];
    if (nevh__loop_has_common_step(x->s->term, k)) {
        nevh__write_number(w, loop_differences_step_of(x, 0, k), number);
        snprintf(name, NEVH__NAME, w->readable ? "%.30s" : "ALL(%.30s)",
                 number);
        return;
    }
    if (w->readable)
        snprintf(name, NEVH__NAME, "step%u_%zu[i]", x->id, k);
    else
        snprintf(name, NEVH__NAME, "load_row(N + %zu + i, left)", w->count);
    for (size_t i = 0; !w->readable && i < x->s->term->term->decl.count; i++)
        nevh__writer_append(w, loop_differences_step_of(x, i, k));
}

void nevh__write_steps(const nevh__term_loop *x) {
    size_t count = x->s->term->term->decl.count;
    for (size_t v = 0; x->method && v < x->n_vars; v++) {
        char name[60];
        double *column = nevh__array(count, sizeof *column);
        if (!column) {
            x->s->w->failed = true;
            return;
        }
        for (size_t i = 0; i < count; i++)
            column[i] = loop_differences_step_of(x, i, x->vars[v]);
        snprintf(name, sizeof name, "    static const double step%u_%zu", x->id,
                 x->vars[v]);
        if (!nevh__loop_has_common_step(x->s->term, x->vars[v]))
            nevh__write_numbers(x->s->w, name, count, column);
        free(column);
    }
}

/* The value where the variable is moved by so many steps: y and h of an id. */
static bool write_point(const nevh__term_loop *x, size_t k, const char *step,
                        double times, unsigned *id) {
    nevh__writer *w = x->s->w;
    moved m = {x, k, w->formulas};
    nevh__formula_text f = {.tape = x->s->term->term->decl.params,
                            .lanes = w->readable ? NULL : &nevh__eight,
                            .variable = name_moved,
                            .data = &m};
    const char *type = w->readable ? "double" : "wide";
    char place[NEVH__NAME], result[NEVH__NAME];
    nevh__formula_text here = {.data = x};
    size_t nq = x->s->term->nq;
    nevh__loop_name(w, &here, k < nq ? NEVH__Q : NEVH__P, k < nq ? k : k - nq,
                    place);
    nevh__write(w, "    %s y%u = %s %c %.1f * %s;\n", type, m.id, place,
                times < 0 ? '-' : '+', times < 0 ? -times : times, step);
    *id = m.id;
    if (!nevh__write_value(w, &f, result))
        return false;
    nevh__write(w, "    %s h%u = %s;\n", type, m.id, result);
    return true;
}

static bool write_difference(const nevh__term_loop *x, size_t k) {
    nevh__writer *w = x->s->w;
    unsigned first = w->formulas;
    char step[NEVH__NAME], name[NEVH__NAME], weight[NEVH__NAME];
    snprintf(name, sizeof name, "d%u", first);
    name_step(x, k, step);
    nevh__write(w, "    %s %s = %s;\n", w->readable ? "double" : "wide", name,
                step);
    unsigned id[2 * NEVH__MOST_OFFSETS];
    for (size_t j = 0; j < 2 * x->method->offsets; j++) {
        double times = (double)(j / 2 + 1);
        if (!write_point(x, k, name, j % 2 ? -times : times, &id[j]))
            return false;
    }
    snprintf(name, sizeof name, "s%u", first);
    nevh__write(w, "    %s %s = ", w->readable ? "double" : "wide", name);
    for (size_t j = 0; j < x->method->offsets; j++) {
        unsigned plus = id[2 * j], minus = id[2 * j + 1];
        nevh__write_number(w, x->method->weights[j], weight);
        nevh__write(w, "%s%s * ((h%u - h%u) / (y%u - y%u))", j ? " + " : "",
                    weight, plus, minus, plus, minus);
    }
    nevh__write(w, ";\n");
    nevh__write_row(x, k, name);
    return true;
}

bool nevh__write_differences(const nevh__term_loop *x) {
    for (size_t v = 0; v < x->n_vars; v++)
        if (!write_difference(x, x->vars[v]))
            return false;
    return true;
}
