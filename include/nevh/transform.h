/* nevh: steps that follow the orbit.
   SPDX-License-Identifier: GPL-3.0-or-later

   A step that an error estimate shortens and stretches destroys what makes a
   symplectic scheme worth its price.  Instead time itself is transformed: with
   a positive function s of the state, the flow of

       K(q, p) = s(q, p) / s(q0, p0) (H(q, p) - H(q0, p0))

   is, on the orbit through (q0, p0), that of H in a time tau with
   dt/dtau = s / s(q0, p0).  Equal steps of tau are short steps of t where s is
   small, and every scheme for any H takes K as it takes H [E. Hairer,
   Variable time step integration with symplectic methods, Appl. Numer. Math.
   25 (1997) 219-227; S. Reich, SIAM J. Numer. Anal. 36 (1999) 1549-1570].

   s is a system like any other: its "H" is s.  It is named in nevh_options:

       nevh_system *s = nevh_distance_power(2, 2, 1.5);
       nevh_options options = {.transform = s, ...};

   H must not depend on time: one function of everything is probed for that.
   h is then a step of tau, and nevh_stepper_time the time reached.  The schemes
   adaptive-verlet and naive-adaptive-verlet take s for the length of their
   steps, without transforming H. */
#ifndef NEVH_TRANSFORM_H
#define NEVH_TRANSFORM_H

#include <nevh/system.h>

#ifdef __cplusplus
extern "C" {
#endif

/* s = |q|^power, the distance from the origin.  For one body about a centre of
   attraction; a power of 1.5 spends as many steps near the centre as far from
   it.
   n         degrees of freedom, of which the first `count` are the position
   returns   a system with exact gradient, as nevh_system_new; carries
             NEVH_EINVAL where count is not between 1 and n */
NEVH_API nevh_system *nevh_distance_power(size_t n, size_t count, double power);

/* s = (sum over pairs of bodies of 1/r^2)^(-power/2): about the distance of the
   closest pair to that power, and smooth.
   bodies      at least 2
   dimensions  coordinates of a body: body i has coordinates
               i*dimensions ... i*dimensions + dimensions-1
   returns     as above; n = bodies * dimensions */
NEVH_API nevh_system *nevh_closeness_power(size_t bodies, size_t dimensions,
                                           double power);

#ifdef __cplusplus
}
#endif
#endif
