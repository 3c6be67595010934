/* nevh: the explicit Euler method.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

static const double a[] = {0}, b[] = {1}, c[] = {0};
static const nevh_butcher table = {.stages = 1, .a = a, .b = b, .c = c};

const nevh_integrator nevh__euler_entry = {
    .name = "euler",
    .aliases = "forward-euler, explicit-euler",
    .source = "L. Euler, Institutiones calculi integralis I (1768), sec. 650",
    .order = 1,
    .stages = 1,
    .gradients = 1,
    NEVH__EXPLICIT_RUNGE_KUTTA(table),
};
NEVH__PUBLISH(euler);
