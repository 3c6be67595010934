/* nevh: the kinetic energy of masses, T = sum_k p_k^2 / (2 m_k).

   Kernels that find no other T take the velocities p_k / m_k where they need
   them, without a call.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>

/* c: 1/m */
NEVH_BODY(mass, void, { return nevh_c(0) * nevh_p(0) * nevh_p(0) / 2; })

NEVH_GRADIENT(mass, void, { nevh_dh_dp(0) = nevh_c(0) * nevh_p(0); })

const double *nevh__term_inverse_masses(const nevh__term_entry *term) {
    return term->decl.gradient == mass_gradient ? term->decl.c : NULL;
}

static int masses_check(nevh_system *s, const char *effect,
                        const double masses[]) {
    char name[NEVH__VARIABLE];
    for (size_t k = 0; masses && k < s->n; k++)
        if (!isfinite(1 / masses[k]) || !isfinite(masses[k]))
            return nevh__fail(&s->report, NEVH_EINVAL,
                              "the mass of %s in effect \"%s\" is %g: it must "
                              "be a number other than 0",
                              nevh__variable_name(s, false, k, name),
                              effect ? effect : "", masses[k]);
    return NEVH_OK;
}

static int masses_add(nevh_system *s, const char *effect, const double masses[],
                      size_t index[], double inverse[]) {
    for (size_t k = 0; k < s->n; k++) {
        index[k] = k;
        inverse[k] = masses ? 1 / masses[k] : 1;
    }
    return nevh_system_add(s, &(nevh_term){.effect = effect,
                                           .np = 1,
                                           .nc = 1,
                                           .p = index,
                                           .c = inverse,
                                           .count = s->n,
                                           NEVH_FORMS(mass),
                                           NEVH_GRADIENTS(mass)});
}

int nevh_system_add_masses(nevh_system *s, const char *effect,
                           const double masses[]) {
    int status = nevh_system_status(s);
    if (!status)
        status = masses_check(s, effect, masses);
    if (status)
        return status;
    size_t *index = nevh__array(s->n, sizeof *index);
    double *inverse = nevh__array(s->n, sizeof *inverse);
    status = index && inverse ? masses_add(s, effect, masses, index, inverse)
                              : nevh__no_memory(&s->report);
    free(index);
    free(inverse);
    return status;
}
