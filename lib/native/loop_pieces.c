/* nevh: where the instances of a term stand in the state.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "native/slope_private.h"
#include <stdlib.h>
#include <string.h>

/* Instances of a piece, on the average, below which indices are read; and of a
   loop that is no loop over pairs. */
enum { SHORT_PIECE = 8, FEWEST_INSTANCES = 16 };

bool nevh__is_loop(const nevh__planned *term) {
    return term->turned || term->term->decl.count >= FEWEST_INSTANCES;
}

bool nevh__has_loops(const nevh_field *f) {
    if (f->gradient != nevh_exact && !f->gradient->offsets)
        return false;
    for (size_t i = 0; i < f->n_terms; i++)
        if (nevh__is_tape(&f->terms[i].term->decl) &&
            nevh__is_loop(&f->terms[i]))
            return true;
    return false;
}

static bool loop_pieces_goes_on(const nevh__term_loop *x, size_t instance) {
    for (size_t k = 0; k < x->s->term->nv; k++)
        if (nevh__loop_index(x, instance, k) !=
            nevh__loop_index(x, instance - 1, k) + x->step[k])
            return false;
    return true;
}

static void find_pieces(nevh__term_loop *x) {
    size_t count = nevh__loop_term(x)->count;
    for (size_t k = 0; k < x->s->term->nv; k++) {
        size_t same = 0, next = 0;
        for (size_t i = 1; i < count; i++) {
            size_t before = nevh__loop_index(x, i - 1, k),
                   here = nevh__loop_index(x, i, k);
            same += here == before;
            next += here == before + 1;
        }
        x->step[k] = next >= same;
    }
    x->pieces = 1;
    for (size_t i = 1; i < count; i++)
        x->pieces += !loop_pieces_goes_on(x, i);
    size_t most = x->s->w->readable ? 1 : count / SHORT_PIECE;
    x->listed = x->pieces > most;
}

void nevh__loop_bases(const nevh__term_loop *x, size_t instance, size_t *least,
                      size_t *most) {
    *least = SIZE_MAX;
    *most = 0;
    for (size_t k = nevh__first_of(x->s); k < nevh__end_of(x->s); k++) {
        size_t at = nevh__loop_index(x, instance, k);
        *least = at < *least ? at : *least;
        *most = at > *most ? at : *most;
    }
}

bool nevh__loop_is_local(const nevh__term_loop *x) {
    bool all = x->pieces == 1 && !x->listed;
    for (size_t k = nevh__first_of(x->s); k < nevh__end_of(x->s); k++)
        all &= x->step[k] == 1;
    return all;
}

/* Two to a double. */
typedef struct {
    nevh__writer *w;
    uint32_t half[2];
    size_t count;
} packing;

static void pack(packing *p, size_t x) {
    p->half[p->count++ % 2] = (uint32_t)x;
    if (p->count % 2 == 0) {
        double both;
        memcpy(&both, p->half, sizeof both);
        nevh__writer_append(p->w, both);
    }
}

void nevh__loop_pack(const nevh__term_loop *x) {
    packing p = {.w = x->s->w};
    size_t nv = x->s->term->nv, count = nevh__loop_term(x)->count;
    for (size_t k = 0; x->listed && k < nv; k++)
        for (size_t i = 0; i < count; i++)
            pack(&p, nevh__loop_index(x, i, k));
    for (size_t i = 0; !x->listed && i < count; i++) {
        if (i > 0 && loop_pieces_goes_on(x, i))
            continue;
        pack(&p, i);
        for (size_t k = 0; k < nv; k++)
            pack(&p, nevh__loop_index(x, i, k));
    }
    pack(&p, count);
    pack(&p, 0);
}

void nevh__loop_pack_all(nevh__writer *w, const uint32_t column[],
                         size_t count) {
    packing p = {.w = w};
    for (size_t i = 0; i < count; i++)
        pack(&p, column[i]);
    if (count % 2)
        pack(&p, 0);
}

size_t nevh__loop_constants(const nevh__term_loop *x) {
    const nevh_term *is = nevh__loop_term(x);
    size_t first = x->s->w->count;
    for (size_t k = 0; k < is->nc; k++)
        for (size_t i = 0; i < is->count; i++)
            nevh__writer_append(x->s->w, is->c[i * is->nc + k]);
    return first;
}

bool nevh__loop_init(const nevh__slope_text *s, nevh__term_loop *x) {
    size_t nv = s->term->nv;
    *x = (nevh__term_loop){.s = s, .id = s->w->formulas};
    x->step = nevh__array(nv, sizeof *x->step);
    x->vars = nevh__array(nv, sizeof *x->vars);
    bool fine = x->step && x->vars;
    if (fine)
        find_pieces(x);
    for (size_t k = nevh__first_of(x->s); fine && k < nevh__end_of(x->s); k++)
        if (nevh__slope_reads(s, k))
            x->vars[x->n_vars++] = k;
    s->w->failed |= !fine;
    return fine;
}

void nevh__loop_clear(nevh__term_loop *x) {
    free(x->step);
    free(x->vars);
}

/* The reach of one term. */
static size_t loop_pieces_reach_of(const nevh__slope_text *s) {
    size_t reach = 0;
    nevh__term_loop x;
    bool far = !nevh__loop_init(s, &x) ||
               (nevh__is_loop(s->term) && !nevh__loop_is_local(&x));
    for (size_t i = 0; !far && i < s->term->term->decl.count; i++) {
        size_t least, most;
        nevh__loop_bases(&x, i, &least, &most);
        reach = most - least > reach ? most - least : reach;
    }
    nevh__loop_clear(&x);
    return far ? SIZE_MAX : reach;
}

size_t nevh__slope_reach(nevh__writer *w, nevh_field *f, bool kick) {
    size_t reach = 0;
    for (size_t i = 0; i < f->n_terms; i++) {
        nevh__slope_text s = {w, f, &f->terms[i], kick};
        if (nevh__first_of(&s) == nevh__end_of(&s))
            continue;
        size_t here = loop_pieces_reach_of(&s);
        reach = here > reach ? here : reach;
    }
    return reach;
}
