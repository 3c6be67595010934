/* nevh: steps by parts, exact in the small part: nodes and weights of
   Gauss-Legendre quadrature.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/form_flow_private.h"
#include "schemes_private.h"

static const nevh_splitting one = {NEVH_DRIFT, NEVH_COMPOSITION, 0, NULL};

const nevh_integrator nevh__wisdom_holman_entry = {
    .name = "wisdom-holman",
    .aliases = "SABA1, REB_SABA_1",
    .source = "J. Wisdom, M. Holman, Symplectic maps for the n-body problem, "
              "Astron. J. 102 (1991) 1528-1538; flow, kick, flow",
    .order = 2,
    .stages = 1,
    .gradients = 1,
    .symplectic = NEVH_YES,
    .symmetric = NEVH_YES,
    .explicit_form = NEVH_YES,
    .preserves_energy = NEVH_NO,
    .needs = NEVH_PARTS,
    .kernel = &nevh__parts_kernel,
    .table = &one,
};
NEVH__PUBLISH(wisdom_holman);

#define SABA(id, stages, given, weights, aliases)                              \
    NEVH__BY_PARTS(id, 2, stages, given, weights, aliases,                     \
                   "J. Laskar, P. Robutel, High order symplectic integrators " \
                   "for perturbed Hamiltonian systems, Celest. Mech. Dyn. "    \
                   "Astron. 80 (2001) 39-62")

/* 1/2 - sqrt(3)/6; with e for the size of B the error is e h^4 + e^2 h^2. */
static const long double two[] = {
    0.2113248654051871177454256097490212721762L,
};
SABA(saba2, 2, 1, two, "REB_SABA_2");

/* 1/2 - sqrt(15)/10; e h^6 + e^2 h^2. */
static const long double three[] = {
    0.1127016653792583114820734600217600389167L,
    5.0L / 18,
};
SABA(saba3, 3, 2, three, "REB_SABA_3");

/* With x = sqrt(3/7 -+ 2/7 sqrt(6/5)): half of 1 - x_2 and of x_2 - x_1, and
   (18 - sqrt(30))/72; e h^8 + e^2 h^2. */
static const long double four[] = {
    0.06943184420297371238802675555359524745214L,
    0.1739274225687269286865319746109997036177L,
    0.2605776340045981552106403648947824089476L,
};
SABA(saba4, 4, 3, four, "REB_SABA_4");
