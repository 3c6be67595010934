/* Who keeps what, on a double pendulum in chaos.
   A step with the derivative M is symplectic if M'JM = J: its defect is the
   largest element of the difference.  It is reversible if as many steps back
   lead to the start.  And it may keep the energy itself.  Look for a row that
   keeps all three: there is none, since a symplectic scheme that kept the
   energy would follow the exact orbit, if not its clock [Z. Ge, J. E. Marsden,
   Phys. Lett. A 133 (1988) 134-139].  Beside each figure stands the claim; tao2
   and tao4 are symplectic for pairs of states, which one state does not see.
   Differences measure defects down to about 1e-13.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/nevh.h>
#include <stdio.h>

static const double dt = 0.01;
static const double start_q[] = {1.57, 0}, start_p[] = {2, 1};
enum { STEPS = 4000, THERE_AND_BACK = 100 };

typedef struct {
    double energy, form, reversal; /* largest error; defects */
} losses;

static int measure(const nevh_system *system, nevh_stepper *stepper,
                   losses *l) {
    double q[] = {start_q[0], start_q[1]}, p[] = {start_p[0], start_p[1]};
    nevh_energy *energy = nevh_energy_new(system, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    int status = nevh_run(stepper, 0, dt, STEPS, q, p, &watch, 1);
    l->energy = nevh_energy_result(energy, 0).max;
    nevh_energy_free(energy);
    if (status)
        return status;
    status = nevh_symplecticity_defect(stepper, 0, dt, start_q, start_p, NULL,
                                       &l->form);
    if (status)
        return status;
    return nevh_reversal_defect(stepper, 0, dt, THERE_AND_BACK, start_q,
                                start_p, NULL, &l->reversal);
}

/* With exact gradients, so that nothing shows but the scheme. */
static int print_row(const nevh_system *system, const nevh_integrator *scheme) {
    losses l;
    nevh_options options = {.gradient = nevh_exact, .q = start_q, .p = start_p};
    nevh_stepper *stepper = nevh_stepper_new(system, scheme, &options);
    int status = measure(system, stepper, &l);
    if (status)
        printf(" %-18s %s\n", nevh_integrator_name(scheme),
               nevh_stepper_message(stepper));
    else
        printf(" %-18s %5d   %8.1e %-7s   %8.1e %-7s   %8.1e %s\n",
               nevh_integrator_name(scheme), nevh_integrator_order(scheme),
               l.energy,
               nevh_claim_name(nevh_integrator_preserves_energy(scheme)),
               l.form, nevh_claim_name(nevh_integrator_symplectic(scheme)),
               l.reversal, nevh_claim_name(nevh_integrator_symmetric(scheme)));
    nevh_stepper_free(stepper);
    return status;
}

int main(void) {
    const char *const names[] = {"midpoint", "gauss4",   "gauss8",
                                 "lobatto4", "itoh-abe", "itoh-abe-symmetric",
                                 "gonzalez", "avf",      "tao2",
                                 "tao4",     "euler",    "rk4",
                                 "dopri5"};
    const nevh_model *model = nevh_double_pendulum_model;
    nevh_system *system = model->system(model->defaults);
    int status = NEVH_OK;
    printf("Double pendulum from q = (%g, %g), p = (%g, %g), dt = %g s, exact "
           "gradients\n"
           "energy: its error in %g s; back: after %d steps and as many "
           "back\n\n",
           start_q[0], start_q[1], start_p[0], start_p[1], dt, STEPS * dt,
           THERE_AND_BACK);
    printf(" %-18s %5s   %8s %-7s   %8s %-7s   %8s %s\n", "integrator", "order",
           "energy", "kept?", "M'JM - J", "zero?", "back", "at start?");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        status |= print_row(system, nevh_integrator_named(names[i]));
    }
    nevh_system_free(system);
    return status != NEVH_OK;
}
