/* nevh: Yoshida's method of order 6: seven Verlet steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* Counted from the middle, w3, w2, w1 of the paper, to more digits. */
static const long double steps[] = {
    0.7845136104775572638194976338663498757768L,
    0.2355732133593581336847931829785346016865L,
    -1.177679984178871006946415680964315734639L,
};
static const nevh_splitting table = {NEVH_KICK, NEVH_COMPOSITION, 3, steps};

const nevh_integrator nevh__yoshida6_entry = {
    .name = "yoshida6",
    .aliases = "Yoshida6, ARKODE_SPRK_YOSHIDA_6_8, Yos6",
    .source = "H. Yoshida, Construction of higher order symplectic "
              "integrators, Phys. Lett. A 150 (1990) 262-268, table 1, "
              "solution A; kick first",
    .order = 6,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(7, table),
};
NEVH__PUBLISH(yoshida6);
