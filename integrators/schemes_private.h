/* nevh: the list of schemes.  A new scheme is one more line here.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SCHEMES_PRIVATE_H
#define NEVH_SCHEMES_PRIVATE_H

#include <nevh/extend.h>

/* The claims of all splittings, and of all explicit Runge-Kutta methods, in their
   descriptors.
   structure  of H, beyond which a splitting would lose its order
   steps      its stages, each with one gradient
   method     its table */
#define NEVH__SPLITTING_FOR(structure, steps, method)                          \
    .stages = (steps), .gradients = (steps), .symplectic = NEVH_YES,           \
    .explicit_form = NEVH_YES, .preserves_energy = NEVH_NO,                    \
    .needs = (structure), .kernel = &nevh_splitting_kernel, .table = &(method)
#define NEVH__SPLITTING(steps, method)                                         \
    NEVH__SPLITTING_FOR(NEVH_SEPARABLE, steps, method)
#define NEVH__EXPLICIT_RUNGE_KUTTA(method)                                     \
    .symplectic = NEVH_NO, .symmetric = NEVH_NO, .explicit_form = NEVH_YES,    \
    .preserves_energy = NEVH_NO, .kernel = &nevh_runge_kutta_kernel,           \
    .table = &(method)

#define NEVH__SCHEMES(X)                                                       \
    X(symplectic_euler_a)                                                      \
    X(symplectic_euler_b)                                                      \
    X(verlet)                                                                  \
    X(position_verlet)                                                         \
    X(ruth3)                                                                   \
    X(mclachlan_atela4)                                                        \
    X(mclachlan_sb3a4)                                                         \
    X(mclachlan_sb3a5)                                                         \
    X(forest_ruth)                                                             \
    X(pefrl)                                                                   \
    X(suzuki4)                                                                 \
    X(blanes_moan4)                                                            \
    X(blanes_moan6)                                                            \
    X(rkn6b)                                                                   \
    X(rkn11b)                                                                  \
    X(rkn14a)                                                                  \
    X(yoshida6)                                                                \
    X(kahan_li6)                                                               \
    X(kahan_li8)                                                               \
    X(suzuki_umeno8)                                                           \
    X(sofroniou_spaletta10)                                                    \
    X(respa)                                                                   \
    X(wisdom_holman)                                                           \
    X(saba2)                                                                   \
    X(saba3)                                                                   \
    X(saba4)                                                                   \
    X(aba84)                                                                   \
    X(aba864)                                                                  \
    X(aba1064)                                                                 \
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
    X(lobatto2)                                                                \
    X(lobatto4)                                                                \
    X(lobatto6)                                                                \
    X(tao2)                                                                    \
    X(tao4)                                                                    \
    X(tao6)                                                                    \
    X(itoh_abe)                                                                \
    X(itoh_abe_symmetric)                                                      \
    X(gonzalez)                                                                \
    X(avf)                                                                     \
    X(adaptive_verlet)                                                         \
    X(naive_adaptive_verlet)                                                   \
    X(euler)                                                                   \
    X(implicit_euler)                                                          \
    X(explicit_midpoint)                                                       \
    X(heun)                                                                    \
    X(ralston)                                                                 \
    X(adams_bashforth2)                                                        \
    X(rk3)                                                                     \
    X(rk4)                                                                     \
    X(dopri5)                                                                  \
    X(dop853)                                                                  \
    X(dprkn12)                                                                 \
    X(gsl_rkf45)                                                               \
    X(gsl_rk8pd)                                                               \
    X(gsl_msadams)                                                             \
    X(taylor)

/* nevh__verlet_entry is the descriptor, nevh_verlet the public pointer to it. */
#define NEVH__DECLARE(id) extern const nevh_integrator nevh__##id##_entry;
NEVH__SCHEMES(NEVH__DECLARE)
#undef NEVH__DECLARE

#define NEVH__PUBLISH(id)                                                      \
    const nevh_integrator *const nevh_##id = &nevh__##id##_entry

#endif
