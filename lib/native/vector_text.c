/* nevh: derivatives by eight variables that follow one another, as C text, where
   all instances of terms follow one another, too: nothing goes through memory.

   Eight instances are taken for eight variables.  What they give to the eight
   that follow is kept for these, so that each is taken once.  Vectors that not
   all instances read, or to which more is added than loops do, are special: they
   are left to the loops.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/vector_text_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = NEVH__LANES, SHARE = 8, NEAR = 2 * LANES };

/* The place of the first of what the first instance reads. */
static size_t least_of(const nevh__term_loop *x) {
    size_t least = SIZE_MAX;
    for (size_t k = 0; k < x->s->term->nv; k++) {
        size_t at = nevh__loop_index(x, 0, k);
        least = at < least ? at : least;
    }
    return least;
}

/* The offset of variable k. */
static size_t shift_of(const nevh__term_loop *x, size_t k) {
    return nevh__loop_index(x, 0, k) - least_of(x);
}

/* Constants are read of instances that are not there, too: not far from those
   that are. */
static bool has_constants_near(const nevh__term_loop *x) {
    const nevh_term *is = &x->s->term->term->decl;
    size_t least = least_of(x);
    return is->nc == 0 || (least <= NEAR && nevh__padded(x->s->f->n) <=
                                                least + is->count + NEAR);
}

static bool vector_text_fits(const nevh__slope_text *s) {
    nevh__term_loop x;
    bool exact = s->f->gradient == nevh_exact;
    bool fine = nevh__loop_init(s, &x) && nevh__loop_is_local(&x) &&
                (!s->term->nq || !s->term->np) && has_constants_near(&x);
    for (size_t k = 0; fine && k < s->term->nv; k++)
        fine = shift_of(&x, k) <= LANES &&
               (exact || nevh__loop_has_common_step(s->term, k));
    nevh__loop_clear(&x);
    return fine;
}

static void vector_text_mark(nevh__vectors *v, size_t variable) {
    v->special[variable / LANES] = true;
}

/* True if a vector's variables get contributions of a term from different blocks of
   the tape in another order. */
static bool order_changes(const nevh__term_loop *x, size_t variable) {
    bool falls = true, same = true;
    for (size_t v = 1; v < x->n_vars; v++) {
        size_t a = nevh__loop_index(x, 0, x->vars[v - 1]),
               b = nevh__loop_index(x, 0, x->vars[v]);
        falls &= a >= b;
        same &= (variable - a) / x->s->f->capacity ==
                (variable - b) / x->s->f->capacity;
    }
    return !falls && !same;
}

static void mark_loop(nevh__vectors *v, const nevh__term_loop *x) {
    size_t count = x->s->term->term->decl.count;
    bool exact = x->s->f->gradient == nevh_exact;
    for (size_t at = 0; at < v->count * LANES; at++) {
        bool inside = at < x->s->f->n;
        for (size_t k = 0; k < x->s->term->nv; k++) {
            size_t base = nevh__loop_index(x, 0, k);
            inside &= at >= base && at - base < count;
        }
        if (!inside || (exact && order_changes(x, at)))
            vector_text_mark(v, at);
    }
}

static void mark_few(nevh__vectors *v, const nevh__slope_text *s) {
    for (size_t i = 0; i < s->term->term->decl.count; i++)
        for (size_t k = nevh__first_of(s); k < nevh__end_of(s); k++)
            vector_text_mark(v, nevh__index(s->term, i, k));
}

static bool mark_all(nevh__vectors *v, const nevh__slope_text *s) {
    nevh__term_loop x;
    if (!nevh__is_loop(s->term)) {
        mark_few(v, s);
        return true;
    }
    bool fine = vector_text_fits(s) && nevh__loop_init(s, &x);
    if (fine) {
        mark_loop(v, &x);
        for (size_t k = 0; k < s->term->nv; k++)
            v->reaches |= shift_of(&x, k) > 0;
        nevh__loop_clear(&x);
    }
    return fine;
}

/* Variables that few instances read together reach, too. */
static bool reaches_far(nevh__writer *w, nevh_field *f, bool kick) {
    return nevh__slope_reach(w, f, kick) > LANES;
}

bool nevh__vectors_init(nevh__vectors *v, nevh__writer *w, nevh_field *f,
                        bool kick) {
    size_t special = 0;
    *v = (nevh__vectors){.count = nevh__padded(f->n) / LANES, .kick = kick};
    v->special = nevh__array(v->count + 1, sizeof *v->special);
    bool fine = v->special &&
                (f->gradient == nevh_exact || f->gradient->offsets) &&
                !reaches_far(w, f, kick);
    v->reaches = nevh__slope_reach(w, f, kick) > 0;
    w->failed |= !v->special;
    for (size_t i = 0; fine && i < f->n_terms; i++) {
        nevh__slope_text s = {w, f, &f->terms[i], kick};
        if (nevh__is_wanted(f, s.term, kick))
            fine = mark_all(v, &s);
    }
    for (size_t i = 0; fine && i < v->count; i++)
        special += v->special[i];
    return fine && special * SHARE <= v->count + 2 * SHARE;
}

void nevh__vectors_clear(nevh__vectors *v) {
    free(v->special);
}

/* Text. */

/* A name's eight values, `shift` variables further on. */
static void write_shifted(nevh__writer *w, nevh__vectors *v, const char *name,
                          size_t shift) {
    nevh__write(w, "    slope += ");
    if (shift == 0)
        nevh__write(w, "%s;\n", name);
    else if (shift == LANES)
        nevh__write(w, "before[%zu];\n", v->before);
    for (size_t lane = 0; lane < LANES && shift % LANES; lane++) {
        nevh__write(w, "%s", lane ? ", " : "(wide){");
        if (lane < shift)
            nevh__write(w, "before[%zu]", v->before);
        nevh__write(w, "%s[%zu]%s", lane < shift ? "" : name,
                    (LANES - shift + lane) % LANES,
                    lane + 1 < LANES ? "" : "};\n");
    }
    if (shift)
        nevh__write(w, "    before[%zu] = %s;\n", v->before++, name);
}

static void write_part(const nevh__term_loop *x, nevh__vectors *v, size_t k) {
    char name[NEVH__NAME];
    snprintf(name, sizeof name, "row%u_%zu", x->id, k);
    write_shifted(x->s->w, v, name, shift_of(x, k));
}

/* In the order of loops: differences' of what is read furthest on first. */
static void vector_text_write_parts(const nevh__term_loop *x,
                                    nevh__vectors *v) {
    for (size_t shift = x->method ? LANES + 1 : 1; shift-- > 0;)
        for (size_t i = 0; i < x->n_vars; i++)
            if (!x->method || shift_of(x, x->vars[i]) == shift)
                write_part(x, v, x->vars[i]);
}

static void vector_text_write_loads(const nevh__term_loop *x) {
    nevh__writer *w = x->s->w;
    const nevh_term *is = &x->s->term->term->decl;
    size_t first = nevh__loop_constants(x);
    for (size_t k = 0; k < x->s->term->nv; k++)
        nevh__write(w, "    wide x%u_%zu = *(const wide *)(y + %zu);\n", x->id,
                    k, shift_of(x, k));
    for (size_t k = 0; k < is->nc; k++)
        nevh__write(w,
                    "    wide c%u_%zu = *(const wide *)(N + %zu + (8 * k - "
                    "%zu));\n",
                    x->id, k, first + k * is->count, least_of(x));
}

static bool write_pass(nevh__term_loop *x, nevh__vectors *v) {
    x->id = x->s->w->formulas;
    x->in_registers = true;
    if (x->n_vars == 0)
        return true;
    vector_text_write_loads(x);
    bool fine = nevh__write_loop_body(x);
    vector_text_write_parts(x, v);
    return fine;
}

static bool vector_text_write_term(const nevh__slope_text *s,
                                   nevh__vectors *v) {
    nevh__term_loop x;
    bool fine = nevh__loop_init(s, &x);
    if (s->f->gradient == nevh_exact)
        fine = fine && write_pass(&x, v);
    else
        for (int i = 0; fine && i < 2; i++) {
            nevh__loop_take_pass(&x, i);
            fine = write_pass(&x, v);
        }
    nevh__loop_clear(&x);
    return fine;
}

static void append_zeros(nevh__writer *w) {
    for (size_t i = 0; i < NEAR + LANES; i++)
        nevh__writer_append(w, 0);
}

/* A bit for each vector. */
static size_t append_special(nevh__writer *w, const nevh__vectors *v) {
    size_t first = w->count;
    for (size_t i = 0; i < v->count; i += 64) {
        uint64_t bits = 0;
        double number;
        for (size_t k = 0; k < 64 && i + k < v->count; k++)
            bits |= (uint64_t)v->special[i + k] << k;
        memcpy(&number, &bits, sizeof number);
        nevh__writer_append(w, number);
    }
    return first;
}

static const char helpers[] =
    "typedef size bits __attribute__((may_alias));\n"
    "typedef struct { wide slope; double bad; } special;\n";

void nevh__write_vector_helpers(nevh__writer *w) {
    nevh__write(w, "%s", helpers);
}

static const char function_begins[] =
    "INLINE wide $1_vector(const double *N, double t, const wide *from, size k,\n"
    "        wide *before, wide *worst) {\n"
    "    const double *y = (const double *)from;\n"
    "    wide slope = {0}, bad = *worst;\n";
static const char function_ends[] =
    "    *worst = bad;\n"
    "    return slope;\n}\n"
    "static __attribute__((noinline, cold, pure)) special $1_special(const double *N, "
    "double t, const wide *y, size k) {\n"
    "    special x;\n"
    "    x.bad = $1_slope(N, t, y - k, y - k, &x.slope - k, 8 * k, 8 * k + 8);\n"
    "    return x;\n}\n"
    "INLINE wide $1_at(const double *N, double t, const wide *y, size k, "
    "wide *before, wide *bad) {\n"
    "    wide last = *bad, slope = $1_vector(N, t, y, k, before, bad);\n"
    "    if (((const bits *)(N + $2))[k / 64] >> k % 64 & 1) {\n"
    "        wide copy = *y;\n"
    "        special x = $1_special(N, t, $3, k);\n"
    "        slope = x.slope;\n"
    "        *bad = last + ALL(x.bad);\n"
    "    }\n"
    "    return slope;\n}\n"
    "enum { $1_before = $4 };\n";

static bool write_function(nevh__writer *w, nevh_field *f, nevh__vectors *v,
                           const char *name) {
    bool fine = true;
    nevh__write_filled(w, function_begins, (const char *const[]){name});
    for (size_t i = 0; fine && i < f->n_terms; i++) {
        nevh__slope_text s = {w, f, &f->terms[i], v->kick};
        if (nevh__is_wanted(f, s.term, s.kick) && nevh__is_loop(s.term))
            fine = vector_text_write_term(&s, v);
    }
    return fine;
}

bool nevh__write_vector_slope(nevh__writer *w, nevh_field *f,
                              nevh__vectors *v) {
    const char *name = v->kick ? "kick" : "drift";
    char special[24], before[24];
    append_zeros(w);
    bool fine = write_function(w, f, v, name);
    snprintf(special, sizeof special, "%zu", append_special(w, v));
    snprintf(before, sizeof before, "%zu", v->before + 1);
    nevh__write_filled(w, function_ends,
                       (const char *const[]){
                           name, special, v->reaches ? "y" : "&copy", before});
    append_zeros(w);
    return fine;
}
