/* nevh: what theory says of the error of the energy.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/energy_private.h"
#include "expression/tape_private.h"
#include "run/stepper_private.h"

/* True if a term that is a formula has kinks or jumps in coordinates or momenta. */
static bool is_rough(const nevh_system *s) {
    for (size_t i = 0; i < s->n_terms; i++) {
        const nevh_term *term = &s->terms[i]->decl;
        if (nevh__term_on(s, s->terms[i]) && term->block == nevh__tape_block &&
            nevh__tape_breaks(term->params))
            return true;
    }
    return false;
}

nevh_theory nevh__theory_of(const nevh_stepper *s) {
    const nevh_integrator *scheme = s->work.integrator;
    const nevh_system *system = s->work.system;
    nevh_claim symplectic = nevh_integrator_symplectic(scheme);
    bool keeps = symplectic == NEVH_YES || symplectic == NEVH_EXTENDED ||
                 nevh_integrator_preserves_energy(scheme) == NEVH_YES;
    if (!keeps && nevh_integrator_symmetric(scheme) == NEVH_NO)
        return NEVH_THEORY_LOSES;
    if (!keeps || !nevh__conserves_energy(system))
        return NEVH_THEORY_OPEN;
    return is_rough(system) ? NEVH_THEORY_ROUGH : NEVH_THEORY_KEEPS;
}
