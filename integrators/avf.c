/* nevh: the averaged vector field.

       D = integral of dH(z + s (z' - z)) over s from 0 to 1,

   by Gauss-Legendre quadrature with as many nodes as there are stages, which is
   exact, and so keeps the energy, for polynomials H of degree 2 * stages.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "discrete_gradient_private.h"
#include "schemes_private.h"

static const nevh__discrete_gradient averaged = {
    .parts = 1, .averages = true, .gradient = nevh__average_gradient};

const nevh_integrator nevh__avf = {
    .name = "avf",
    .aliases = "averaged-vector-field",
    .source = "G. R. W. Quispel, D. I. McLaren, A new class of energy-"
              "preserving numerical integration methods, J. Phys. A 41 (2008) "
              "045206",
    .order = 2,
    .stages = 8,
    .sweep_gradients = 8,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_YES,
    .explicit_form = NEVH_NO,
    .preserves_energy = NEVH_YES,
    .kernel = &nevh__discrete_gradient_kernel,
    .table = &averaged,
};
NEVH__PUBLISH(avf);
