/* nevh: how far rounding in H moves derivatives by differences, as C text.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/writer_private.h"
#include <stdio.h>

typedef struct {
    const nevh__planned *term;
    size_t constants; /* of the term, in the table of numbers */
} place;

static void noise_text_name_at_state(nevh__writer *w,
                                     const nevh__formula_text *f,
                                     nevh__variable kind, size_t k,
                                     char name[NEVH__NAME]) {
    const place *at = f->data;
    const nevh_term *is = &at->term->term->decl;
    if (kind == NEVH__T)
        snprintf(name, NEVH__NAME, "t");
    else if (kind == NEVH__C && w->readable)
        nevh__number_text(is->c[f->instance * is->nc + k], name);
    else if (kind == NEVH__C)
        snprintf(name, NEVH__NAME, "N[%zu]",
                 at->constants + f->instance * is->nc + k);
    else
        snprintf(name, NEVH__NAME, "y[%s%zu]", kind == NEVH__P ? "DOF + " : "",
                 kind == NEVH__P ? is->p[f->instance * is->np + k]
                                 : is->q[f->instance * is->nq + k]);
}

/* The noise that one instance adds to what it reads. */
static bool write_instance(nevh__writer *w, nevh__formula_text *f) {
    const place *at = f->data;
    const nevh__planned *term = at->term;
    char value[NEVH__NAME], delta[NEVH__NAME];
    if (!nevh__write_value(w, f, value))
        return false;
    nevh__write(w, "    *bad += %s - %s;\n", value, value);
    for (size_t k = 0; k < term->nv; k++) {
        nevh__write_number(w, term->delta[f->instance * term->nv + k], delta);
        nevh__write(w, "    noise[%s%zu] += 0x1p-52 * fabs(%s) / %s;\n",
                    k < term->nq ? "DOF + " : "", /* moves momenta */
                    nevh__index(term, f->instance, k), value, delta);
    }
    return true;
}

static void write_head(nevh__writer *w) {
    static const char head[] =
        "static $1double worst_noise($2double t, const double *y,\n"
        "                          const double *scale, double *bad) {\n"
        "    double noise[2 * DOF] = {0}, most = 0;\n"
        "    (void)t;\n";
    if (w->readable)
        nevh__write(w, "/* The largest noise of a derivative, over the scale: "
                       "H is rounded by\n   2^-52 |H|, and a difference "
                       "divides that by its step. */\n");
    nevh__write_filled(
        w, head,
        (const char *const[]){w->readable ? "" : "__attribute__((noinline)) ",
                              w->readable ? "" : "const double *N, "});
}

bool nevh__write_noise(nevh__writer *w, const nevh_field *f) {
    bool fine = true;
    write_head(w);
    for (size_t i = 0; fine && i < f->n_terms; i++) {
        place at = {&f->terms[i], 0};
        const nevh_term *is = &at.term->term->decl;
        nevh__formula_text formula = {.tape = is->params,
                                      .variable = noise_text_name_at_state,
                                      .data = &at};
        if (!at.term->delta)
            continue;
        if (!w->readable)
            at.constants = nevh__writer_share(w, is->count * is->nc, is->c);
        for (size_t k = 0; fine && k < is->count; k++) {
            formula.instance = k;
            fine = write_instance(w, &formula);
        }
    }
    nevh__write(w, "    NEVH__EACH(k, 1, 2 * DOF) {\n"
                   "        double part = noise[k] / scale[k];\n"
                   "        most = part > most ? part : most;\n"
                   "    }\n    return most;\n}\n\n");
    return fine;
}
