/* nevh: Kutta's Runge-Kutta method of order 3.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const double a[] = {
    0,   0, 0, /* */
    0.5, 0, 0, /* */
    -1,  2, 0,
};
static const double b[] = {1. / 6, 2. / 3, 1. / 6};
static const double c[] = {0, 0.5, 1};
static const nevh_butcher table = {.stages = 3, .a = a, .b = b, .c = c};

const nevh_integrator nevh__rk3_entry = {
    .name = "rk3",
    .aliases = "RK3, kutta3, runge-kutta-3",
    .source = "W. Kutta, Beitrag zur naeherungsweisen Integration totaler "
              "Differentialgleichungen, Z. Math. Phys. 46 (1901) 435-453",
    .order = 3,
    .stages = 3,
    .gradients = 3,
    NEVH__EXPLICIT_RUNGE_KUTTA(table),
};
NEVH__PUBLISH(rk3);
