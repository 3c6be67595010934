/* nevh: the Gauss-Legendre family.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

#define GAUSS(id, title, other, count)                                         \
    const nevh_integrator nevh__##id##_entry = {                               \
        .name = title,                                                         \
        .aliases = other,                                                      \
        .source = "J. C. Butcher, Implicit Runge-Kutta processes, Math. "      \
                  "Comp. 18 (1964) 50-64; J. M. Sanz-Serna, Runge-Kutta "      \
                  "schemes for Hamiltonian systems, BIT 28 (1988) 877-883",    \
        .order = 2 * (count),                                                  \
        .stages = (count),                                                     \
        .sweep_gradients = (count),                                            \
        .symplectic = NEVH_YES,                                                \
        .symmetric = NEVH_YES,                                                 \
        .explicit_form = NEVH_NO,                                              \
        .preserves_energy = NEVH_NO,                                           \
        .kernel = &nevh_gauss_kernel,                                          \
    };                                                                         \
    NEVH__PUBLISH(id)

GAUSS(midpoint, "midpoint", "gauss2, implicit-midpoint, ImplicitMidpoint", 1);
GAUSS(gauss4, "gauss4", "GLRK(2), hammer-hollingsworth", 2);
GAUSS(gauss6, "gauss6", "GLRK(3), kuntzmann-butcher", 3);
GAUSS(gauss8, "gauss8", "GLRK(4)", 4);
GAUSS(gauss10, "gauss10", "GLRK(5)", 5);
GAUSS(gauss12, "gauss12", "GLRK(6)", 6);
GAUSS(gauss14, "gauss14", "GLRK(7)", 7);
GAUSS(gauss16, "gauss16", "GLRK(8)", 8);
GAUSS(gauss18, "gauss18", "GLRK(9)", 9);
GAUSS(gauss20, "gauss20", "GLRK(10)", 10);
