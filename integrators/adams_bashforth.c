/* nevh: the explicit Adams method of two steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/adams_bashforth_private.h"
#include "schemes_private.h"

const nevh_integrator nevh__adams_bashforth2_entry = {
    .name = "adams-bashforth2",
    .aliases = "ab2",
    .source = "F. Bashforth, J. C. Adams, An attempt to test the theories of "
              "capillary action (1883), chapter III, as E. Hairer, S. P. "
              "Norsett, G. Wanner, Solving Ordinary Differential Equations I "
              "(1993), III.1 and III.5, have it",
    .order = 2,
    .stages = 1,
    .gradients = 1,
    .multistep = true,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_NO,
    .explicit_form = NEVH_YES,
    .preserves_energy = NEVH_NO,
    .kernel = &nevh__adams_bashforth_kernel,
};
NEVH__PUBLISH(adams_bashforth2);
