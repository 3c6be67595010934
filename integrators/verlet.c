/* nevh: the Stoermer-Verlet method (leapfrog), in both orders.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* 1/2, 1, 1/2 follow. */
static const nevh_splitting kick_first = {NEVH_KICK, NEVH_PALINDROME, 0, NULL};
static const nevh_splitting drift_first = {NEVH_DRIFT, NEVH_PALINDROME, 0,
                                           NULL};

const nevh_integrator nevh__verlet_entry = {
    .name = "verlet",
    .aliases = "stormer-verlet, velocity-verlet, leapfrog",
    .source = "E. Hairer, C. Lubich, G. Wanner, Geometric numerical "
              "integration illustrated by the Stoermer-Verlet method, Acta "
              "Numerica 12 (2003) 399, eq. (1.15); kick, drift, kick",
    .order = 2,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(1, kick_first),
};
NEVH__PUBLISH(verlet);

const nevh_integrator nevh__position_verlet_entry = {
    .name = "position-verlet",
    .aliases = "PseudoVerletLeapfrog, ARKODE_SPRK_PSEUDO_LEAPFROG_2_2",
    .source = "M. Tuckerman, B. J. Berne, G. J. Martyna, Reversible multiple "
              "time scale molecular dynamics, J. Chem. Phys. 97 (1992) 1990, "
              "eq. (2.22); drift, kick, drift",
    .order = 2,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(1, drift_first),
};
NEVH__PUBLISH(position_verlet);
