/* nevh: what is found of states between steps, as C text.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/slope_private.h"
#include <stdio.h>

enum { MOST_FORMULAS = 64 };

/* NULL: a formula of the whole state. */
typedef struct {
    const nevh_term *term;
    size_t constants; /* of the term, in the table of numbers */
} place;

static void name_in_step(nevh__writer *w, const nevh__formula_text *f,
                         nevh__variable kind, size_t k, char name[NEVH__NAME]) {
    const place *at = f->data;
    const nevh_term *is = at->term;
    (void)w;
    if (kind == NEVH__C)
        snprintf(name, NEVH__NAME, "ALL(N[%zu])",
                 at->constants + f->instance * is->nc + k);
    else if (kind == NEVH__P)
        snprintf(name, NEVH__NAME, "y[DOF + %zu]",
                 is ? is->p[f->instance * is->np + k] : k);
    else
        snprintf(name, NEVH__NAME, "y[%zu]",
                 is ? is->q[f->instance * is->nq + k] : k);
}

static bool write_formulas(nevh__writer *w) {
    for (size_t i = 0; i < w->watched->count; i++) {
        nevh__formula_text f = {.tape = w->watched->tapes[i],
                                .lanes = &nevh__eight,
                                .variable = name_in_step,
                                .data = &(place){NULL, 0}};
        char value[NEVH__NAME];
        if (!nevh__write_value(w, &f, value))
            return false;
        nevh__write(w, "    *(wide *)(to + %zu * WIDTH) = %s;\n", i, value);
    }
    return true;
}

/* As nevh_field_value adds them. */
static bool watch_text_write_term(nevh__writer *w, const nevh_term *is) {
    place at = {is, nevh__writer_share(w, is->count * is->nc, is->c)};
    nevh__formula_text f = {.tape = is->params,
                            .lanes = &nevh__eight,
                            .variable = name_in_step,
                            .data = &at};
    for (; f.instance < is->count; f.instance++) {
        char value[NEVH__NAME];
        if (!nevh__write_value(w, &f, value))
            return false;
        nevh__write(w,
                    "    next = sum + %s;\n"
                    "    lost += nevh__roundoff(next, sum, %s);\n"
                    "    sum = next;\n",
                    value, value);
    }
    return true;
}

static bool write_energy(nevh__writer *w, const nevh_field *field) {
    nevh__write(w, "    wide sum = {0}, lost = {0}, next;\n");
    for (size_t i = 0; i < field->n_terms; i++)
        if (!watch_text_write_term(w, &field->terms[i].term->decl))
            return false;
    nevh__write(w, "    *(wide *)(to + %zu * WIDTH) = sum + lost;\n",
                w->watched->count);
    return true;
}

/* True if H is short, of formulas, and does not depend on time. */
static bool has_text(const nevh_field *field) {
    size_t formulas = 0;
    for (size_t i = 0; i < field->n_terms; i++) {
        const nevh_term *is = &field->terms[i].term->decl;
        formulas += is->count;
        if (!nevh__is_tape(is) || is->time)
            return false;
    }
    return formulas <= MOST_FORMULAS;
}

bool nevh__write_watch(nevh__writer *w) {
    const nevh__watched *x = w->watched;
    if (x->energy && !has_text(w->field)) {
        w->refusal = "H is long";
        return false;
    }
    nevh__write_form(w, "NEVH__WATCHES");
    nevh__write(w,
                "enum { WATCHED = %zu };\n"
                "INLINE void watch(const double *N, const wide *y, "
                "double *to) {\n"
                "    (void)N;\n",
                nevh__watched_rows(x));
    bool fine = write_formulas(w) && (!x->energy || write_energy(w, w->field));
    nevh__write(w, "}\n");
    return fine;
}
