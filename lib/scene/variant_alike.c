/* nevh: whether varied parameters change more than where members start.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <string.h>

static bool same_bytes(const void *a, const void *b, size_t count,
                       size_t size) {
    return count == 0 || (a && b && memcmp(a, b, count * size) == 0);
}

/* Terms that are no formulas have no numbers to compare. */
static bool same_shape(const nevh__term_entry *a, const nevh__term_entry *b) {
    const nevh_term *x = &a->decl, *y = &b->decl;
    return x->value == nevh__tape_value && y->value == nevh__tape_value &&
           a->effect == b->effect && x->count == y->count && x->nq == y->nq &&
           x->np == y->np && x->nc == y->nc &&
           same_bytes(x->q, y->q, x->count * x->nq, sizeof *x->q) &&
           same_bytes(x->p, y->p, x->count * x->np, sizeof *x->p);
}

static bool alike_terms(const nevh__term_entry *a, const nevh__term_entry *b) {
    return same_shape(a, b) && nevh__tape_alike(a->decl.params, b->decl.params);
}

static bool same_terms(const nevh__term_entry *a, const nevh__term_entry *b) {
    const nevh_term *x = &a->decl, *y = &b->decl;
    return same_shape(a, b) &&
           same_bytes(x->c, y->c, x->count * x->nc, sizeof *x->c) &&
           nevh__tape_same(x->params, y->params);
}

static bool same_friction(const nevh_system *a, const nevh_system *b) {
    bool same = a->n_frictions == b->n_frictions;
    for (size_t i = 0; same && i < a->n_frictions; i++)
        same = a->frictions[i].effect == b->frictions[i].effect &&
               same_bytes(a->frictions[i].rates, b->frictions[i].rates, a->n,
                          sizeof(double));
    return same;
}

static bool compare_systems(const nevh_system *a, const nevh_system *b,
                            bool (*same)(const nevh__term_entry *,
                                         const nevh__term_entry *)) {
    if (a->n != b->n || a->n_terms != b->n_terms || !same_friction(a, b))
        return false;
    for (size_t i = 0; i < a->n_terms; i++)
        if (!same(a->terms[i], b->terms[i]))
            return false;
    return true;
}

static bool same_run(const nevh_scene_run *a, const nevh_scene_run *b,
                     size_t n) {
    bool steps = a->gradient_steps || b->gradient_steps;
    return a->t_start == b->t_start && a->t_end == b->t_end &&
           a->dts == b->dts && (!a->dts || a->dt[0] == b->dt[0]) &&
           a->energy_scale == b->energy_scale &&
           a->gradient_step == b->gradient_step &&
           (!steps || same_bytes(a->gradient_steps, b->gradient_steps, 2 * n,
                                 sizeof(double)));
}

/* Outcomes, what stops, what is solved for: tapes in one order. */
static bool same_outcomes(const nevh_sweep *s, const nevh__variant *a,
                          const nevh__variant *b) {
    if (a->tapes.count != b->tapes.count)
        return false;
    for (size_t i = 0; i < a->tapes.count; i++)
        if (!nevh__tape_same(a->tapes.tapes[i], b->tapes.tapes[i]))
            return false;
    for (size_t i = 0; i < s->n_outcomes; i++)
        if (a->outcomes[i].direction != b->outcomes[i].direction ||
            a->outcomes[i].modulus != b->outcomes[i].modulus)
            return false;
    return true;
}

static bool variant_alike_compare(const nevh_sweep *s, const nevh__variant *a,
                                  const nevh__variant *b,
                                  bool (*same)(const nevh__term_entry *,
                                               const nevh__term_entry *)) {
    const nevh__scene_model *x = a->model, *y = b->model;
    return !s->is.transformed && compare_systems(x->system, y->system, same) &&
           same_run(&x->run, &y->run, x->n) && same_outcomes(s, a, b);
}

bool nevh__variants_alike(const nevh_sweep *s, const nevh__variant *a,
                          const nevh__variant *b) {
    return variant_alike_compare(s, a, b, same_terms);
}

bool nevh__variants_differ_in_numbers(const nevh_sweep *s,
                                      const nevh__variant *a,
                                      const nevh__variant *b) {
    return variant_alike_compare(s, a, b, alike_terms);
}
