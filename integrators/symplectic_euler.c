/* nevh: the symplectic Euler method, in both orders.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

/* Both weights are 1, and follow. */
static const nevh_splitting kick_drift = {NEVH_KICK, NEVH_LISTED, 0, NULL};
static const nevh_splitting drift_kick = {NEVH_DRIFT, NEVH_LISTED, 0, NULL};

const nevh_integrator nevh__symplectic_euler_a_entry = {
    .name = "symplectic-euler-a",
    .aliases =
        "euler-cromer, semi-implicit-euler, SymplecticEulerA, ARKODE_SPRK_EULER_1_1",
    .source = "R. de Vogelaere, Methods of integration which preserve the "
              "contact transformation property of the Hamilton equations, "
              "Notre Dame report 4 (1956); kick, then drift",
    .order = 1,
    .symmetric = NEVH_NO,
    NEVH__SPLITTING(1, kick_drift),
};
NEVH__PUBLISH(symplectic_euler_a);

const nevh_integrator nevh__symplectic_euler_b_entry = {
    .name = "symplectic-euler-b",
    .aliases = "SymplecticEulerB",
    .source = "R. de Vogelaere, Methods of integration which preserve the "
              "contact transformation property of the Hamilton equations, "
              "Notre Dame report 4 (1956); drift, then kick",
    .order = 1,
    .symmetric = NEVH_NO,
    NEVH__SPLITTING(1, drift_kick),
};
NEVH__PUBLISH(symplectic_euler_b);
