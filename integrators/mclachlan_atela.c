/* nevh: the optimal method of order 4 by McLachlan and Atela.

   The condition on [V,[V,[V,T]]] is left out, which vanishes where T is
   quadratic.  Kicks and drifts must not be exchanged: that is of order 3.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* Kick, drift, ...; the paper gives 18 digits, refined here. */
static const long double weights[] = {
    0.1344961992774310892050105067278597707121L,
    0.5153528374311229364036781996249275617244L,
    -0.2248198030794208058048565495696773204627L,
    -0.08578201941297364607516029897462943221582L,
    0.7563200005156682910978875251686189371300L,
    0.4415830236164665242533371601954845243621L,
};
static const nevh_splitting table = {NEVH_KICK, NEVH_LISTED, 6, weights};

const nevh_integrator nevh__mclachlan_atela4_entry = {
    .name = "mclachlan-atela4",
    .aliases = "McAte4, ARKODE_SPRK_MCLACHLAN_4_4, "
               "McLachlanAtela1992Order4Optimal",
    .source = "R. I. McLachlan, P. Atela, The accuracy of symplectic "
              "integrators, Nonlinearity 5 (1992) 541-562, table 2; kick first",
    .order = 4,
    .symmetric = NEVH_NO,
    NEVH__SPLITTING_FOR(NEVH_SEPARABLE | NEVH_QUADRATIC_KINETIC, 4, table),
};
NEVH__PUBLISH(mclachlan_atela4);
