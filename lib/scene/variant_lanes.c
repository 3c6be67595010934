/* nevh: one system for variants that differ in numbers.

   Numbers of formulas that depend on what is varied become constants of the
   terms, of which each lane has its own.  They are found by comparing a few
   members; one that has others is run apart.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <stdlib.h>
#include <string.h>

static const nevh__tape *tape_of(const nevh__variant *x, size_t term) {
    return x->model->system->terms[term]->decl.params;
}

bool nevh__lane_form_begin(nevh__lane_form *f, nevh__variant *base) {
    const nevh_system *s = base->model->system;
    *f = (nevh__lane_form){.base = *base};
    *base = (nevh__variant){0};
    f->opened = nevh__array(s->n_terms, sizeof *f->opened);
    f->constants = nevh__array(s->n_terms, sizeof *f->constants);
    f->of_field = nevh__array(s->n_terms, sizeof *f->of_field);
    bool room = f->opened && f->constants && f->of_field;
    for (size_t i = 0; room && i < s->n_terms; i++) {
        const double *numbers;
        if (s->terms[i]->decl.value == nevh__tape_value) {
            size_t count = nevh__tape_numbers(tape_of(&f->base, i), &numbers);
            room = (f->opened[i] = nevh__array(count, sizeof(bool)));
        }
    }
    return room;
}

/* True if number i of a term is the same in both. */
static bool same_number(const nevh__lane_form *f, const nevh__variant *x,
                        size_t term, size_t i) {
    const double *a, *b;
    nevh__tape_numbers(tape_of(&f->base, term), &a);
    nevh__tape_numbers(tape_of(x, term), &b);
    return memcmp(&a[i], &b[i], sizeof *a) == 0;
}

static size_t count_numbers(const nevh__lane_form *f, size_t term) {
    const double *numbers;
    return nevh__tape_numbers(tape_of(&f->base, term), &numbers);
}

void nevh__lane_form_see(const nevh_sweep *s, nevh__lane_form *f,
                         const nevh__variant *x) {
    if (!nevh__variants_differ_in_numbers(s, &f->base, x))
        return;
    for (size_t term = 0; term < x->model->system->n_terms; term++)
        for (size_t i = 0; i < count_numbers(f, term); i++)
            f->opened[term][i] |= !same_number(f, x, term, i);
}

/* The constants of a term: of each instance its own, then numbers. */
static void variant_lanes_fill(const nevh__lane_form *f, const nevh__variant *x,
                               size_t term) {
    const nevh_term *decl = &x->model->system->terms[term]->decl;
    size_t count = count_numbers(f, term);
    const double *numbers;
    double *to = f->constants[term];
    nevh__tape_numbers(tape_of(x, term), &numbers);
    for (size_t at = 0; at < decl->count; at++) {
        for (size_t k = 0; k < decl->nc; k++)
            *to++ = decl->c[at * decl->nc + k];
        for (size_t i = 0; i < count; i++)
            if (f->opened[term][i])
                *to++ = numbers[i];
    }
}

/* The base's term with constants in place of numbers. */
static bool variant_lanes_add_term(nevh__lane_form *f, size_t term) {
    const nevh_system *base = f->base.model->system;
    nevh_term decl = base->terms[term]->decl;
    nevh__tape *tape = nevh__tape_open(decl.params, f->opened[term]);
    nevh__tape **all =
        tape ? nevh__grow(f->tapes.tapes, f->tapes.count + 1, sizeof *all)
             : NULL;
    if (!all) {
        nevh__tape_free(tape);
        return false;
    }
    f->tapes.tapes = all;
    all[f->tapes.count++] = tape;
    size_t nc = nevh__tape_count(tape, NEVH__C);
    f->constants[term] = nevh__array(decl.count * nc, sizeof(double));
    if (!f->constants[term])
        return false;
    variant_lanes_fill(f, &f->base, term);
    nevh__tape_shape(&decl, tape);
    decl.c = f->constants[term];
    return !nevh_system_add(f->system, &decl);
}

static bool add_frictions(nevh__lane_form *f) {
    const nevh_system *base = f->base.model->system;
    for (size_t i = 0; i < base->n_frictions; i++) {
        const nevh__friction *x = &base->frictions[i];
        if (nevh_system_add_friction(f->system, base->effects[x->effect].name,
                                     x->rates))
            return false;
    }
    return true;
}

bool nevh__lane_form_finish(nevh__lane_form *f) {
    const nevh_system *base = f->base.model->system;
    size_t on = 0;
    f->system = nevh_system_new(base->n);
    for (size_t i = 0; f->system && i < base->n_terms; i++) {
        if (!variant_lanes_add_term(f, i))
            return false;
        if (nevh__term_on(base, base->terms[i]))
            f->of_field[on++] = f->constants[i];
    }
    if (!f->system || !add_frictions(f))
        return false;
    for (size_t i = 0; i < base->n_effects; i++)
        nevh_system_enable(f->system, base->effects[i].name,
                           base->effects[i].on);
    f->system->by_lane = true;
    f->system->names = base->names;
    return !f->system->report.status;
}

void nevh__lane_form_free(nevh__lane_form *f) {
    size_t count = f->base.model ? f->base.model->system->n_terms : 0;
    for (size_t i = 0; i < count; i++) {
        if (f->opened)
            free(f->opened[i]);
        if (f->constants)
            free(f->constants[i]);
    }
    free(f->opened);
    free(f->constants);
    free(f->of_field);
    nevh_system_free(f->system);
    nevh__owned_free(&f->tapes);
    nevh__variant_free(&f->base);
}

bool nevh__lane_form_fits(const nevh_sweep *s, nevh__lane_form *f,
                          const nevh__variant *x) {
    if (!nevh__variants_differ_in_numbers(s, &f->base, x))
        return false;
    for (size_t term = 0; term < x->model->system->n_terms; term++)
        for (size_t i = 0; i < count_numbers(f, term); i++)
            if (!f->opened[term][i] && !same_number(f, x, term, i))
                return false;
    for (size_t term = 0; term < x->model->system->n_terms; term++)
        variant_lanes_fill(f, x, term);
    return true;
}
