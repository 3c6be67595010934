/* nevh: which terms are in A, and which in B?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/parts_private.h"
#include <fenv.h>
#include <stdlib.h>
#include <string.h>

/* True if all instances are; false, too, if memory is out. */
static bool is_pairs(const nevh__term_entry *term) {
    const nevh_term *decl = &term->decl;
    size_t beside[NEVH__PAIR];
    double k, *room = nevh__array(nevh__form_room(decl), sizeof *room);
    bool all = room;
    for (size_t i = 0; all && i < decl->count; i++)
        all = nevh__pair_find(term, i, &k, beside, room);
    free(room);
    return all;
}

/* form, centre: out, true if all instances are forms, or -k/|q|. */
static int classify(const nevh__term_entry *term, bool *form, bool *centre) {
    const nevh_term *decl = &term->decl;
    size_t nv = decl->nq + decl->np;
    double k, *room = nevh__array(nevh__form_room(decl) + nv * (nv + 1),
                                  sizeof *room);
    if (!room)
        return NEVH_ENOMEM;
    *form = !decl->curved;
    *centre = true;
    for (size_t i = 0; *form && i < decl->count; i++)
        *form = nevh__form_find(term, i, room, room + nv * (nv + 1));
    for (size_t i = 0; *centre && i < decl->count; i++)
        *centre = nevh__centre_find(term, i, &k, room);
    free(room);
    return NEVH_OK;
}

enum { MOST_READ = 64 }; /* by an instance of a form */

static int parts_choose(const nevh_system *s, const nevh__term_entry *term,
                        nevh__part_role *part) {
    const nevh_term *decl = &term->decl;
    size_t nv = decl->nq + decl->np;
    bool form = false, centre = false;
    *part = NEVH__KICK;
    if (!nevh__term_on(s, term) ||
        s->effects[term->effect].speed == NEVH_SLOW || decl->time || !nv ||
        nv > MOST_READ)
        return NEVH_OK;
    int status = classify(term, &form, &centre);
    *part = form ? NEVH__FORM : centre ? NEVH__CENTRE : NEVH__KICK;
    return status;
}

/* NULL: none.  Pairs that are to be fast are the scheme's to judge, which knows a
   state. */
static const char *reason_of(const nevh_system *s, const nevh__term_entry *term,
                             bool substeps, nevh__part_role part) {
    const nevh_term *decl = &term->decl;
    nevh_speed speed = s->effects[term->effect].speed;
    if (part != NEVH__KICK || !(decl->nq + decl->np))
        return NULL;
    if (speed == NEVH_FAST && !decl->np && decl->nq >= 2 * NEVH__PLANE &&
        is_pairs(term))
        return NULL;
    if (speed == NEVH_FAST)
        return substeps && decl->time ? "is to be fast and reads the time"
                                      : "is to be fast and is no such form";
    return !decl->np            ? NULL
           : speed == NEVH_SLOW ? "is to be slow and reads momenta"
           : decl->time         ? "reads momenta and the time"
                                : "reads momenta and is no such form";
}

/* A term that is to be fast and is left to kick. */
static bool is_inner(const nevh_system *s, const nevh__term_entry *term) {
    const nevh_term *decl = &term->decl;
    return nevh__term_on(s, term) && decl->nq && !decl->np && !decl->time &&
           s->effects[term->effect].speed == NEVH_FAST;
}

int nevh__parts_find(const nevh_system *s, bool substeps,
                     nevh__part_role part[], nevh__parts_fault *fault) {
    bool any = false, *turn = nevh__array(s->n_terms, sizeof *turn);
    int status = turn ? NEVH_OK : NEVH_ENOMEM;
    *fault = (nevh__parts_fault){NULL, NULL};
    for (size_t i = 0; !status && i < s->n_terms; i++)
        status = parts_choose(s, s->terms[i], &part[i]);
    if (!status)
        status = nevh__centres_choose(s, part);
    if (!status)
        status = nevh__turns_choose(s, part, turn);
    for (size_t i = 0; !status && i < s->n_terms; i++) {
        const nevh__term_entry *term = s->terms[i];
        any |= part[i] != NEVH__KICK;
        if (substeps && part[i] == NEVH__KICK && is_inner(s, term))
            part[i] = NEVH__INNER;
        const char *reason = nevh__term_on(s, term) && !turn[i]
                                 ? reason_of(s, term, substeps, part[i])
                                 : NULL;
        if (reason && !fault->term)
            *fault = (nevh__parts_fault){&term->decl, reason};
    }
    free(turn);
    return status ? status : any && !fault->term ? NEVH_OK : NEVH_ESTRUCT;
}

/* Instances of each effect's terms that are on, among the fast and among others. */
static int parts_count(const nevh_system *s, size_t fast[], size_t slow[],
                       nevh__parts_fault *fault) {
    nevh__part_role *all = nevh__array(s->n_terms, sizeof *all);
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = all ? nevh__parts_find(s, false, all, fault) : NEVH_ENOMEM;
    fesetenv(&own);
    for (size_t i = 0; i < s->n_effects; i++)
        fast[i] = slow[i] = 0;
    for (size_t i = 0; status != NEVH_ENOMEM && i < s->n_terms; i++) {
        const nevh__term_entry *term = s->terms[i];
        size_t *counts = all[i] == NEVH__KICK ? slow : fast;
        if (nevh__term_on(s, term))
            counts[term->effect] += term->decl.count;
    }
    free(all);
    return status;
}

int nevh_system_effect_parts(const nevh_system *s, size_t fast[],
                             size_t slow[]) {
    nevh__parts_fault fault = {NULL, NULL};
    int status = nevh_system_status(s);
    if (!status && (!fast || !slow))
        return NEVH_EINVAL;
    return status ? status : parts_count(s, fast, slow, &fault);
}

int nevh_system_parts(const nevh_system *s, const char *effect, size_t *fast,
                      size_t *slow, const char **term) {
    nevh__parts_fault fault = {NULL, NULL};
    int status = nevh_system_status(s);
    if (status)
        return status;
    size_t *counts = nevh__array(2 * s->n_effects, sizeof *counts), at = 0;
    status = counts ? parts_count(s, counts, counts + s->n_effects, &fault)
                    : NEVH_ENOMEM;
    while (at < s->n_effects &&
           (!effect || strcmp(s->effects[at].name, effect) != 0))
        at++;
    bool known = status != NEVH_ENOMEM && at < s->n_effects;
    if (fast)
        *fast = known ? counts[at] : 0;
    if (slow)
        *slow = known ? counts[s->n_effects + at] : 0;
    if (term && status != NEVH_ENOMEM)
        *term = fault.term ? fault.term->name : NULL;
    free(counts);
    return status == NEVH_ENOMEM || known ? status : NEVH_EINVAL;
}
