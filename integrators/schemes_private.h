/* nevh: the list of schemes.  A new scheme is one more line here.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCHEMES_PRIVATE_H
#define NEVH_SCHEMES_PRIVATE_H

#include <nevh/extend.h>

#define NEVH__SCHEMES(X)                                                       \
    X(symplectic_euler_a)                                                      \
    X(symplectic_euler_b)                                                      \
    X(verlet)                                                                  \
    X(position_verlet)                                                         \
    X(midpoint)                                                                \
    X(gauss4)                                                                  \
    X(gauss6)                                                                  \
    X(gauss8)                                                                  \
    X(gauss10)                                                                 \
    X(gauss12)                                                                 \
    X(gauss14)                                                                 \
    X(gauss16)                                                                 \
    X(gauss18)                                                                 \
    X(gauss20)                                                                 \
    X(itoh_abe)                                                                \
    X(itoh_abe_symmetric)                                                      \
    X(gonzalez)                                                                \
    X(avf)                                                                     \
    X(euler)                                                                   \
    X(rk4)                                                                     \
    X(gsl_rkf45)                                                               \
    X(gsl_rk8pd)

/* nevh__verlet is the descriptor, nevh_verlet the public pointer to it. */
#define NEVH__DECLARE(id) extern const nevh_integrator nevh__##id;
NEVH__SCHEMES(NEVH__DECLARE)
#undef NEVH__DECLARE

#define NEVH__PUBLISH(id) const nevh_integrator *const nevh_##id = &nevh__##id

#endif
