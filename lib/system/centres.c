/* nevh: coordinates that move about centres, H = p^2/2m - k/|q|.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/parts_private.h"
#include <stdlib.h>

/* Arrays of one for each coordinate. */
typedef struct {
    double *inverse_mass;
    bool *other; /* forms have more of it than p^2/2m */
    bool *owned; /* by a centre */
} places;

static size_t centres_place_of(const nevh_term *decl, size_t instance,
                               size_t i) {
    return i < decl->nq ? decl->q[instance * decl->nq + i]
                        : decl->p[instance * decl->np + i - decl->nq];
}

static void add_entry(const places *x, const nevh_term *decl, size_t instance,
                      size_t i, size_t j, double value) {
    size_t k = centres_place_of(decl, instance, i);
    if (i == j && i >= decl->nq)
        x->inverse_mass[k] += value;
    else if (value != 0)
        x->other[k] = true;
}

/* Adds an instance of a form; owned: asks instead if a centre owns one of its
   coordinates. */
static bool add_form(const places *x, const nevh__term_entry *term,
                     size_t instance, bool owned, double *room) {
    const nevh_term *decl = &term->decl;
    size_t nv = decl->nq + decl->np;
    bool meets = false;
    nevh__form_find(term, instance, room, room + nv * (nv + 1));
    for (size_t i = 0; i < nv; i++)
        for (size_t j = 0; j <= nv; j++) {
            double value = room[i * (nv + 1) + j];
            if (!owned)
                add_entry(x, decl, instance, i, j, value);
            meets |=
                value != 0 && x->owned[centres_place_of(decl, instance, i)];
        }
    return meets;
}

static int add_forms(const places *x, const nevh__term_entry *term, bool owned,
                     bool *meets) {
    const nevh_term *decl = &term->decl;
    size_t nv = decl->nq + decl->np;
    double *room =
        nevh__array(nevh__form_room(decl) + nv * (nv + 1), sizeof *room);
    *meets = false;
    for (size_t i = 0; room && i < decl->count; i++)
        *meets |= add_form(x, term, i, owned, room);
    free(room);
    return room ? NEVH_OK : NEVH_ENOMEM;
}

/* All instances, or none. */
static bool centres_own(const places *x, const nevh_term *decl) {
    size_t count = decl->count * decl->nq, taken = 0;
    for (; taken < count; taken++) {
        size_t k = decl->q[taken], first = decl->q[taken - taken % decl->nq];
        if (x->other[k] || x->owned[k] || !(x->inverse_mass[k] > 0) ||
            x->inverse_mass[k] != x->inverse_mass[first])
            break;
        x->owned[k] = true;
    }
    for (size_t i = 0; taken < count && i < taken; i++)
        x->owned[decl->q[i]] = false;
    return taken == count;
}

/* Forms that A must have, centres, and the other forms. */
static int centres_choose(const nevh_system *s, const places *x,
                          nevh__part_role part[]) {
    int status = NEVH_OK;
    bool meets;
    for (int pass = 0; pass < 3; pass++)
        for (size_t i = 0; !status && i < s->n_terms; i++) {
            const nevh__term_entry *term = s->terms[i];
            bool given =
                term->decl.np || s->effects[term->effect].speed == NEVH_FAST;
            if (pass == 1 && part[i] == NEVH__CENTRE &&
                !centres_own(x, &term->decl))
                part[i] = NEVH__KICK;
            if (pass == 1 || part[i] != NEVH__FORM || given != (pass == 0))
                continue;
            status = add_forms(x, term, pass == 2, &meets);
            part[i] = pass == 2 && meets ? NEVH__KICK : NEVH__FORM;
        }
    return status;
}

int nevh__centres_choose(const nevh_system *s, nevh__part_role part[]) {
    places x = {nevh__array(s->n, sizeof *x.inverse_mass),
                nevh__array(s->n, sizeof *x.other),
                nevh__array(s->n, sizeof *x.owned)};
    bool any = false;
    for (size_t i = 0; i < s->n_terms; i++)
        any |= part[i] == NEVH__CENTRE;
    int status = x.inverse_mass && x.other && x.owned ? NEVH_OK : NEVH_ENOMEM;
    if (any && !status)
        status = centres_choose(s, &x, part);
    free(x.inverse_mass);
    free(x.other);
    free(x.owned);
    return status;
}
