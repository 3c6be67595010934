/* nevh: Verlet with steps that vary: reversibly, and naively for contrast.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/adaptive_verlet_private.h"
#include "schemes_private.h"

static const nevh__step_control reversible = {true}, naive = {false};

const nevh_integrator nevh__adaptive_verlet_entry = {
    .name = "adaptive-verlet",
    .source = "E. Hairer, G. Soederlind, Explicit, time reversible, adaptive "
              "step size control, SIAM J. Sci. Comput. 26 (2005) 1838-1851",
    .order = 2,
    .stages = 1,
    .gradients = 3,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_EXTENDED,
    .explicit_form = NEVH_YES,
    .preserves_energy = NEVH_NO,
    .own_time = true,
    .needs = NEVH_SEPARABLE,
    .kernel = &nevh__adaptive_verlet_kernel,
    .table = &reversible,
};
NEVH__PUBLISH(adaptive_verlet);

const nevh_integrator nevh__naive_adaptive_verlet_entry = {
    .name = "naive-adaptive-verlet",
    .source = "J. M. Sanz-Serna, M. P. Calvo, Numerical Hamiltonian Problems, "
              "Chapman and Hall (1994), ch. 9: what varying the step of a "
              "symplectic scheme from one state to the next destroys",
    .order = 2,
    .stages = 1,
    .gradients = 1,
    .symplectic = NEVH_NO,
    .symmetric = NEVH_NO,
    .explicit_form = NEVH_YES,
    .preserves_energy = NEVH_NO,
    .own_time = true,
    .needs = NEVH_SEPARABLE,
    .kernel = &nevh__adaptive_verlet_kernel,
    .table = &naive,
};
NEVH__PUBLISH(naive_adaptive_verlet);
