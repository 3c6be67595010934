/* nevh: slopes as C text, and their loops.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SLOPE_PRIVATE_H
#define NEVH_SLOPE_PRIVATE_H

#include "native/writer_private.h"

/* A term's part of dH/dq, a kick, or dH/dp. */
typedef struct {
    nevh__writer *w;
    nevh_field *f;
    const nevh__planned *term;
    bool kick;
} nevh__slope_text;

/* The first of the half's variables, and where they end. */
static inline size_t nevh__first_of(const nevh__slope_text *s) {
    return s->kick ? 0 : s->term->nq;
}
static inline size_t nevh__end_of(const nevh__slope_text *s) {
    return s->kick ? s->term->nq : s->term->nv;
}

/* True if the term's formula depends on a variable. */
static inline bool nevh__slope_reads(const nevh__slope_text *s, size_t k) {
    const nevh__tape *tape = s->term->term->decl.params;
    size_t nq = s->term->nq;
    return k < nq ? nevh__tape_reads(tape, NEVH__Q, k)
                  : nevh__tape_reads(tape, NEVH__P, k - nq);
}

/* Places of what instances read. */
typedef struct {
    const nevh__slope_text *s;
    unsigned id;
    size_t *step; /* of variables: 1, or 0: all of a piece read one */
    size_t pieces;
    bool listed;                 /* indices are read: there are no pieces */
    size_t *vars, n_vars;        /* whose slopes are taken */
    const nevh_gradient *method; /* of differences; else NULL */
    bool in_registers; /* what instances give is not written to rows */
} nevh__term_loop;

static inline const nevh_term *nevh__loop_term(const nevh__term_loop *x) {
    return &x->s->term->term->decl;
}
/* false when memory is out; to be cleared in all cases. */
bool nevh__loop_init(const nevh__slope_text *, nevh__term_loop *);
void nevh__loop_clear(nevh__term_loop *);
static inline size_t nevh__loop_index(const nevh__term_loop *x, size_t instance,
                                      size_t k) {
    return nevh__index(x->s->term, instance, k);
}
/* The least and the largest index of the half's variables of one instance. */
void nevh__loop_bases(const nevh__term_loop *, size_t instance, size_t *least,
                      size_t *most);
/* True if instance i reads what is i further on than what the first reads. */
bool nevh__loop_is_local(const nevh__term_loop *);
/* Appends constants to the numbers, those of all instances one after the other;
   returns the place of the first. */
size_t nevh__loop_constants(const nevh__term_loop *);
/* True if all instances of differences have one step by variable k. */
bool nevh__loop_has_common_step(const nevh__planned *, size_t k);
/* Appends to the numbers, as pairs of 32 bits: of each piece its first instance
   and what that reads; or what instances read, variable after variable. */
void nevh__loop_pack(const nevh__term_loop *);
/* Appends a column, two numbers of 32 bits to a double; an odd one has 0 behind. */
void nevh__loop_pack_all(nevh__writer *, const uint32_t column[], size_t count);
/* loop_pairs.c: the loop over blocks of pairs, of exact slopes. */
bool nevh__write_pairs(const nevh__term_loop *);

static inline bool nevh__is_tape(const nevh_term *is) {
    return is->gradient == nevh__tape_block_gradient;
}
/* Names of variables: in vectors of instances, and for readers. */
void nevh__loop_name(nevh__writer *, const nevh__formula_text *, nevh__variable,
                     size_t k, char name[NEVH__NAME]);
/* The loop's body where it takes differences: the slopes of eight instances, or
   for readers of one, to rows. */
bool nevh__write_differences(const nevh__term_loop *);
/* Slopes are those of one of the two passes of differences. */
void nevh__loop_take_pass(nevh__term_loop *, int pass);
/* The loop's body: the slopes of eight instances, or for readers of one. */
bool nevh__write_loop_body(const nevh__term_loop *);
/* "row3_1 ... = NAME;" */
void nevh__write_row(const nevh__term_loop *, size_t k, const char *name);
/* Columns of differences' steps where instances have their own, for readers. */
void nevh__write_steps(const nevh__term_loop *);

/* True if a term has a part in a half of the gradient. */
static inline bool nevh__is_wanted(const nevh_field *f,
                                   const nevh__planned *term, bool kick) {
    return f->parts >> term->part & 1 && (kick ? term->nq : term->np);
}
/* True if points of differences stand in a vector's lanes. */
static inline bool nevh__side_by_side(const nevh__writer *w) {
    return !w->readable && !nevh__has_lanes(w);
}
/* True if the text of slopes that are called so often is short enough; else sets
   w->refusal. */
bool nevh__slopes_fit(nevh__writer *, const nevh_field *, size_t calls);
/* Vectors of orbits that a step of so many slopes takes at once, 1 or 2: one waits
   while the other is evaluated. */
size_t nevh__vectors_at_once(const nevh__writer *, const nevh_field *,
                             size_t slopes);
/* True if a term is a loop where w->loops is set. */
bool nevh__is_loop(const nevh__planned *);
/* "if (...) {": whether any of a term's slopes are asked for. */
void nevh__write_asked(const nevh__slope_text *);
/* A loop that adds the term's derivatives to slope[], from `first` to `past`. */
bool nevh__write_loop(const nevh__slope_text *);
/* For readers: a loop that adds the term's values to sum and lost. */
bool nevh__write_loop_of_values(nevh__writer *, const nevh__planned *);

#endif
