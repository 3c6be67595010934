/* nevh: Ruth's method of order 3.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* Kick, drift, ...; -1/24 and 1 follow. */
static const long double weights[] = {7 / 24.L, 2 / 3.L, 3 / 4.L, -2 / 3.L};
static const nevh_splitting table = {NEVH_KICK, NEVH_LISTED, 4, weights};

const nevh_integrator nevh__ruth3_entry = {
    .name = "ruth3",
    .aliases = "Ruth3, Ruth1983, ARKODE_SPRK_RUTH_3_3",
    .source = "R. D. Ruth, A canonical integration technique, IEEE Trans. "
              "Nucl. Sci. 30 (1983) 2669-2671; kick first",
    .order = 3,
    .symmetric = NEVH_NO,
    NEVH__SPLITTING(3, table),
};
NEVH__PUBLISH(ruth3);
