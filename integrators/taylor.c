/* nevh: Taylor series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/taylor_private.h"
#include "schemes_private.h"

/* The order is that of a tolerance of 1e-12 or so; a gradient is a series with
   derivatives of all orders. */
const nevh_integrator nevh__taylor_entry = {
    .name = "taylor",
    .aliases = "heyoka, taylor_adaptive, TaylorIntegration",
    .source = "A. Jorba, M. Zou, A software package for the numerical "
              "integration of ODEs by means of high-order Taylor methods, Exp. "
              "Math. 14 (2005) 99-117; order and step from the tolerance",
    .order = 18,
    .stages = 1,
    .gradients = 1,
    .adaptive = true,
    .needs_tolerance = true,
    .needs_formulas = true,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_NO,
    .explicit_form = NEVH_YES,
    .preserves_energy = NEVH_NO,
    .kernel = &nevh__taylor_kernel,
};
NEVH__PUBLISH(taylor);
