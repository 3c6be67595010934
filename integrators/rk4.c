/* nevh: the classical Runge-Kutta method.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const double a[] = {
    0,   0,   0, 0, /* */
    0.5, 0,   0, 0, /* */
    0,   0.5, 0, 0, /* */
    0,   0,   1, 0,
};
static const double b[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
static const double c[] = {0, 0.5, 0.5, 1};
static const nevh_butcher table = {.stages = 4, .a = a, .b = b, .c = c};

const nevh_integrator nevh__rk4_entry = {
    .name = "rk4",
    .aliases = "RK4, runge-kutta-4",
    .source = "W. Kutta, Beitrag zur naeherungsweisen Integration totaler "
              "Differentialgleichungen, Z. Math. Phys. 46 (1901) 435-453",
    .order = 4,
    .stages = 4,
    .gradients = 4,
    NEVH__EXPLICIT_RUNGE_KUTTA(table),
};
NEVH__PUBLISH(rk4);
