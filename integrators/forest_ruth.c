/* nevh: the method of Forest and Ruth: three Verlet steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* 1/(2 - 2^(1/3)); the middle step is 1 - 2/(2 - 2^(1/3)) < 0. */
static const long double steps[] = {
    1.351207191959657634047687808971460826922L,
};
static const nevh_splitting table = {NEVH_KICK, NEVH_COMPOSITION, 1, steps};

const nevh_integrator nevh__forest_ruth_entry = {
    .name = "forest-ruth",
    .aliases = "yoshida4, CandyRoz4, ARKODE_SPRK_CANDY_ROZMUS_4_4, "
               "CandyRozmus1991ForestRuth1990, TripleJump",
    .source = "E. Forest, R. D. Ruth, Fourth-order symplectic integration, "
              "Physica D 43 (1990) 105-117, eq. (4.8); kick first",
    .order = 4,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(3, table),
};
NEVH__PUBLISH(forest_ruth);
