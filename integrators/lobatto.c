/* nevh: Lobatto IIIA-IIIB pairs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

#define LOBATTO(id, title, other, count)                                       \
    const nevh_integrator nevh__##id##_entry = {                               \
        .name = title,                                                         \
        .aliases = other,                                                      \
        .source = "G. Sun, Symplectic partitioned Runge-Kutta methods, J. "    \
                  "Comput. Math. 11 (1993) 365-372; L. O. Jay, Symplectic "    \
                  "partitioned Runge-Kutta methods for constrained "           \
                  "Hamiltonian systems, SIAM J. Numer. Anal. 33 (1996) "       \
                  "368-387; E. Hairer, C. Lubich, G. Wanner, Geometric "       \
                  "Numerical Integration, II.1.4 and IV.2",                    \
        .order = 2 * (count)-2,                                                \
        .stages = (count),                                                     \
        .sweep_gradients = (count),                                            \
        .symplectic = NEVH_YES,                                                \
        .symmetric = NEVH_YES,                                                 \
        .explicit_form = NEVH_NO,                                              \
        .preserves_energy = NEVH_NO,                                           \
        .kernel = &nevh_lobatto_kernel,                                        \
    };                                                                         \
    NEVH__PUBLISH(id)

LOBATTO(lobatto2, "lobatto2", "generalized-leapfrog, LobattoIIIAIIIB(2)", 2);
LOBATTO(lobatto4, "lobatto4", "LobattoIIIAIIIB(3)", 3);
LOBATTO(lobatto6, "lobatto6", "LobattoIIIAIIIB(4)", 4);
