/* nevh: Suzuki's fractal of order 4: five Verlet steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* 1/(4 - 4^(1/3)), twice; the middle step is 1 - 4/(4 - 4^(1/3)) < 0. */
static const long double steps[] = {
    0.4144907717943757371423540628607614957118L,
    0.4144907717943757371423540628607614957118L,
};
static const nevh_splitting table = {NEVH_KICK, NEVH_COMPOSITION, 2, steps};

const nevh_integrator nevh__suzuki4_entry = {
    .name = "suzuki4",
    .aliases = "s5odr4, SuzukiFractal",
    .source = "M. Suzuki, Fractal decomposition of exponential operators with "
              "applications to many-body theories and Monte Carlo "
              "simulations, Phys. Lett. A 146 (1990) 319-323; kick first",
    .order = 4,
    .symmetric = NEVH_YES,
    NEVH__SPLITTING(5, table),
};
NEVH__PUBLISH(suzuki4);
