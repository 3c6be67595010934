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

enum { MOST_EFFECTS = 3 };

typedef struct {
    int status;
    double q[2], p[2], error; /* the end of the orbit; its energy error */
    uint64_t values[MOST_EFFECTS];
} result;

/* Ten seconds of gauss6, and what each effect cost. */
static result run(const nevh_system *system) {
    const nevh_model *model = nevh_elastic_pendulum_model;
    result r = {.q = {model->q[0], model->q[1]}, .p = {model->p[0], 0.5}};
    nevh_options options = {.q = r.q, .p = r.p};
    nevh_stepper *stepper = nevh_stepper_new(system, nevh_gauss6, &options);
    nevh_energy *energy = nevh_energy_new(system, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    r.status = nevh_run(stepper, 0, 0.02, 500, r.q, r.p, &watch, 1);
    if (r.status)
        printf("%s\n", nevh_stepper_message(stepper));
    for (size_t i = 0; !r.status && i < MOST_EFFECTS; i++)
        r.values[i] = nevh_field_effect_values(
            nevh_stepper_field(stepper), nevh_system_effect_name(system, i));
    r.error = nevh_energy_result(energy, 0).max;
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    return r;
}

int main(void) {
    const nevh_model *model = nevh_elastic_pendulum_model;
    nevh_system *system = model->system(model->defaults);
    result all = run(system);
    nevh_system_enable(system, "gravity", false);
    result less = run(system);
    int status = all.status | less.status | nevh_system_status(system);
    puts("Elastic pendulum, 10 s of gauss6, dt = 0.02; evaluations of each "
         "effect\n\n effect        all on  without gravity");
    for (size_t i = 0; !status && i < MOST_EFFECTS; i++)
        printf(" %-9s %10" PRIu64 " %16" PRIu64 "\n",
               nevh_system_effect_name(system, i), all.values[i],
               less.values[i]);
    printf("\n r           %9.6f %16.6f\n theta       %9.6f %16.6f\n", all.q[0],
           less.q[0], all.q[1], less.q[1]);
    printf(" p_theta     %9.6f %16.6f   kept: nothing turns it\n", all.p[1],
           less.p[1]);
    printf(" energy error %8.1e %16.1e\n", all.error, less.error);
    nevh_system_free(system);
    return status != NEVH_OK;
}
