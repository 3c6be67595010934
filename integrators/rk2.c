/* nevh: explicit Runge-Kutta methods of two stages.

   b2 c2 = 1/2 makes them order 2; c2 is 1/2, 2/3 or 1.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const double a_midpoint[] = {0, 0, 0.5, 0};
static const double b_midpoint[] = {0, 1};
static const double c_midpoint[] = {0, 0.5};
static const nevh_butcher explicit_midpoint_table = {
    .stages = 2, .a = a_midpoint, .b = b_midpoint, .c = c_midpoint};

static const double a_heun[] = {0, 0, 1, 0};
static const double b_heun[] = {0.5, 0.5};
static const double c_heun[] = {0, 1};
static const nevh_butcher heun_table = {
    .stages = 2, .a = a_heun, .b = b_heun, .c = c_heun};

static const double a_ralston[] = {0, 0, 2. / 3, 0};
static const double b_ralston[] = {0.25, 0.75};
static const double c_ralston[] = {0, 2. / 3};
static const nevh_butcher ralston_table = {
    .stages = 2, .a = a_ralston, .b = b_ralston, .c = c_ralston};

#define TWO_STAGES(id, title, other, paper)                                    \
    const nevh_integrator nevh__##id##_entry = {                               \
        .name = title,                                                         \
        .aliases = other,                                                      \
        .source = paper,                                                       \
        .order = 2,                                                            \
        .stages = 2,                                                           \
        .gradients = 2,                                                        \
        .symplectic = NEVH_NO,                                                 \
        .symmetric = NEVH_NO,                                                  \
        .explicit_form = NEVH_YES,                                             \
        .preserves_energy = NEVH_NO,                                           \
        .kernel = &nevh_runge_kutta_kernel,                                    \
        .table = &id##_table,                                                  \
    };                                                                         \
    NEVH__PUBLISH(id)

TWO_STAGES(explicit_midpoint, "explicit-midpoint",
           "rk2, euler-richardson, modified-euler",
           "C. Runge, Ueber die numerische Aufloesung von "
           "Differentialgleichungen, Math. Ann. 46 (1895) 167-178");
TWO_STAGES(heun, "heun", "improved-euler, explicit-trapezoidal",
           "K. Heun, Neue Methoden zur approximativen Integration der "
           "Differentialgleichungen einer unabhaengigen Veraenderlichen, "
           "Z. Math. Phys. 45 (1900) 23-38");
TWO_STAGES(ralston, "ralston", "ralston2",
           "A. Ralston, Runge-Kutta methods with minimum error bounds, Math. "
           "Comp. 16 (1962) 431-437");
