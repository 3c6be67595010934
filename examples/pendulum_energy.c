/* What integrators do to the energy of a pendulum, in 1000 seconds.
   H = p^2/(2 m l^2) - m g l cos q, released at rest from 2 rad; nothing but H
   is given, gradients are central differences of order 4.  Look at two truths:
   symplectic schemes keep the energy bounded while rk4 loses it steadily; and
   yet at dt = 0.05 rk4's loss is still the smaller error, for a while.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "energy_table.h"
#include <math.h>
#include <stdio.h>

static const double t_end = 1000;

/* When a steady loss passes the largest error of a bounded one. */
static void compare(double dt, const row *verlet, const row *rk4) {
    double passes = verlet->energy.max / fabs(rk4->energy.drift);
    bool passed = passes < t_end;
    printf("At dt = %g rk4 has lost %.2g %% of the energy; verlet was never "
           "off by more than %.2g %%:\n",
           dt, 100 * rk4->energy.max, 100 * verlet->energy.max);
    printf("  rk4's error %s verlet's near t = %.0f s.\n",
           passed ? "passed" : "is still the smaller one, and will pass",
           passes);
}

int main(void) {
    const nevh_model *pendulum = nevh_pendulum_model;
    const nevh_integrator *const schemes[] = {nevh_symplectic_euler_a,
                                              nevh_verlet,
                                              nevh_midpoint,
                                              nevh_gauss4,
                                              nevh_gauss6,
                                              nevh_rk4,
                                              nevh_euler};
    enum { COUNT = sizeof schemes / sizeof *schemes, VERLET = 1, RK4 = 5 };
    const double steps[] = {0.1, 0.05};
    row rows[2][COUNT];
    int status = NEVH_OK;
    nevh_system *system = pendulum->system(pendulum->defaults);
    printf("Pendulum, m = l = 1, g = 9.8, released at rest from 2 rad\n"
           "t = 0 ... %g s; energy errors relative to |H0|; gradient central4, "
           "from H alone\n\n",
           t_end);
    energy_header();
    for (size_t j = 0; j < 2; j++, puts(""))
        for (size_t i = 0; i < COUNT; i++) {
            rows[j][i] = energy_row(system, schemes[i], pendulum->q,
                                    pendulum->p, steps[j], t_end);
            status |= rows[j][i].status;
        }
    puts("Symplectic schemes keep the energy bounded: no larger at the end "
         "than at the start.");
    for (size_t j = 0; !status && j < 2; j++)
        compare(steps[j], &rows[j][VERLET], &rows[j][RK4]);
    nevh_system_free(system);
    return status != NEVH_OK;
}
