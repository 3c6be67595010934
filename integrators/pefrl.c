/* nevh: the position extended Forest-Ruth-like method.

   In the paper: xi = 0.1786178958448091, chi = -0.06626458266981849 and
   lambda = -0.2123418310626054, refined here to what they were rounded from.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* xi (drift), (1 - 2 lambda)/2 (kick), chi (drift); the kick lambda and the
   drift 1 - 2 (xi + chi) follow. */
static const long double weights[] = {
    0.1786178958448090670599037670811929367843L,
    0.7123418310626054038318904580688403927837L,
    -0.06626458266981849627801562176460284253787L,
};
static const nevh_splitting table = {NEVH_DRIFT, NEVH_PALINDROME, 3, weights};

const nevh_integrator nevh__pefrl_entry = {
    .name = "pefrl",
    .aliases = "PEFRL",
    .source = "I. P. Omelyan, I. M. Mryglod, R. Folk, Optimized Forest-Ruth- "
              "and Suzuki-like algorithms for integration of motion in "
              "many-body systems, Comput. Phys. Commun. 146 (2002) 188-202; "
              "drift first",
    .order = 4,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(4, table),
};
NEVH__PUBLISH(pefrl);
