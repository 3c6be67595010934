/* Simulate only what a scene calls for: an elastic pendulum with and without
   gravity.  H is a sum of terms; an effect is a named group of them.  What is
   off is never evaluated, and the orbit is that of a system to which it was
   never added, to the last bit.  Without gravity the bob keeps its angular
   momentum p_theta, and verlet still does not fit: the kinetic energy mixes r
   with p_theta.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <inttypes.h>
#include <nevh/nevh.h>
#include <stdio.h>

/* Ten seconds of gauss6; prints what each effect cost. */
static int run(const nevh_system *system) {
    const nevh_model *model = nevh_elastic_pendulum_model;
    double q[] = {model->q[0], model->q[1]}, p[] = {model->p[0], 0.5};
    nevh_options options = {.q = q, .p = p};
    nevh_stepper *stepper = nevh_stepper_new(system, nevh_gauss6, &options);
    nevh_energy *energy = nevh_energy_new(system, 1);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    int status = nevh_run(stepper, 0, 0.02, 500, q, p, &watch, 1);
    if (status)
        printf("%s\n", nevh_stepper_message(stepper));
    for (size_t i = 0; !status && i < nevh_system_effect_count(system); i++) {
        const char *name = nevh_system_effect_name(system, i);
        printf("  %-8s %-3s  %9" PRIu64 " evaluations\n", name,
               nevh_system_effect_on(system, name) ? "on" : "off",
               nevh_field_effect_values(nevh_stepper_field(stepper), name));
    }
    if (!status)
        printf("  r = %.9f, theta = %.9f, p_theta = %.9f; energy error %.1e\n",
               q[0], q[1], p[1], nevh_energy_result(energy, 0).max);
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    return status;
}

int main(void) {
    const nevh_model *model = nevh_elastic_pendulum_model;
    nevh_system *system = model->system(model->defaults);
    puts("elastic pendulum, all effects on (p_theta starts at 0.5):");
    int status = run(system);
    if (!status)
        status = nevh_system_enable(system, "gravity", false);
    puts("without gravity:");
    if (!status)
        status = run(system);
    nevh_system_free(system);
    return status != NEVH_OK;
}
