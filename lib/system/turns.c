/* nevh: terms that turn oscillators, V((s q^2 + p^2/s)/2, ...) of one or several.

   Such a term keeps the action of each, (s q^2 + p^2/s)/2, and turns q and p at a
   constant angular velocity, which is the derivative of V by the action.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/parts_private.h"
#include <math.h>
#include <stdlib.h>

/* Other terms read the coordinate, or turn it with another s. */
static const double not_turned = -1;

/* Instances of a term that is no turn, or a turn with other s, hinder. */
static void take_scale(double *scale, double s) {
    if (*scale == 0)
        *scale = s;
    else if (s != 0 && fabs(*scale - s) > 1e-12 * s)
        *scale = not_turned;
}

static bool kicks(const nevh_system *s, const nevh__part_role part[],
                  size_t i) {
    return nevh__term_on(s, s->terms[i]) && part[i] == NEVH__KICK;
}

/* turn: whether all instances turn; marks their coordinates, or those of others. */
static int mark_term(const nevh__term_entry *term, double scale[], bool *turn) {
    const nevh_term *decl = &term->decl;
    double *s = nevh__array(decl->nq + 1, sizeof *s);
    size_t *of = nevh__array(decl->np + 1, sizeof *of);
    bool room = s && of;
    *turn = decl->np > 0;
    for (size_t k = 0; room && *turn && k < decl->count; k++)
        *turn = nevh__turn_find(term, k, of, s);
    for (size_t k = 0; room && k < decl->count; k++) {
        if (*turn)
            nevh__turn_find(term, k, of, s);
        for (size_t i = 0; i < decl->nq; i++)
            take_scale(&scale[decl->q[k * decl->nq + i]],
                       *turn ? s[i] : not_turned);
        for (size_t i = 0; !*turn && i < decl->np; i++)
            scale[decl->p[k * decl->np + i]] = not_turned;
    }
    free(s);
    free(of);
    return room ? NEVH_OK : NEVH_ENOMEM;
}

int nevh__turns_choose(const nevh_system *s, const nevh__part_role part[],
                       bool turn[]) {
    double *scale = nevh__array(s->n, sizeof *scale);
    bool any = false;
    int status = scale ? NEVH_OK : NEVH_ENOMEM;
    for (size_t i = 0; i < s->n_terms; i++) {
        turn[i] = false;
        any |= kicks(s, part, i) && s->terms[i]->decl.np;
    }
    for (size_t i = 0; any && !status && i < s->n_terms; i++)
        if (kicks(s, part, i))
            status = mark_term(s->terms[i], scale, &turn[i]);
    for (size_t i = 0; !status && i < s->n_terms; i++) {
        const nevh_term *decl = &s->terms[i]->decl;
        for (size_t k = 0; turn[i] && k < decl->count * decl->nq; k++)
            turn[i] = scale[decl->q[k]] != not_turned;
    }
    free(scale);
    return status;
}
