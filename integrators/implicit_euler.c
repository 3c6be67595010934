/* nevh: the implicit Euler method.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"

const nevh_integrator nevh__implicit_euler_entry = {
    .name = "implicit-euler",
    .aliases = "backward-euler",
    .source = "C. F. Curtiss, J. O. Hirschfelder, Integration of stiff "
              "equations, Proc. Nat. Acad. Sci. 38 (1952) 235-243",
    .order = 1,
    .stages = 1,
    .sweep_gradients = 1,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_NO,
    .explicit_form = NEVH_NO,
    .preserves_energy = NEVH_NO,
    .kernel = &nevh_implicit_euler_kernel,
};
NEVH__PUBLISH(implicit_euler);
