/* What integrators do to the energy of a double pendulum.
   H of two equal bobs; the kinetic energy depends on the angles, so explicit
   splitting does not fit and verlet is refused, with the reason.  Look at the
   orders: each stage more of a Gauss method buys decades at the same step, and
   rk4, the only one that drifts, does so at any step.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "energy_table.h"
#include <stdio.h>

int main(void) {
    const nevh_model *model = nevh_double_pendulum_model;
    const nevh_integrator *const schemes[] = {nevh_verlet, nevh_midpoint,
                                              nevh_gauss4, nevh_gauss6,
                                              nevh_gauss8, nevh_rk4};
    const double *q = model->q, *p = model->p, t_end = 500;
    const double steps[] = {0.02, 0.01};
    int status = NEVH_OK;
    nevh_system *system = model->system(model->defaults);
    printf("Double pendulum, m = l = 1, g = 9.8, released at rest from "
           "(%g, %g) rad\n"
           "t = 0 ... %g s; energy errors relative to |H0|; gradient central4, "
           "from H alone\n\n",
           q[0], q[1], t_end);
    energy_header();
    for (size_t j = 0; j < 2; j++, puts(""))
        for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++) {
            /* What is refused is refused at any step. */
            if (j > 0 && nevh_integrator_needs(schemes[i]) & NEVH_SEPARABLE)
                continue;
            row r = energy_row(system, schemes[i], q, p, steps[j], t_end);
            status |= r.status == NEVH_ESTRUCT ? NEVH_OK : r.status;
        }
    nevh_system_free(system);
    return status != NEVH_OK;
}
