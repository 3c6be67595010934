/* nevh tests: takes N steps of every scheme, for tests/valgrind.sh, which
   counts allocations.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/nevh.h>
#include <stdio.h>
#include <stdlib.h>

static int run(const nevh_integrator *scheme, size_t steps) {
    const nevh_model *model = nevh_coupled_oscillators_model;
    nevh_system *s = model->system(model->defaults);
    double q[] = {model->q[0], model->q[1]}, p[] = {model->p[0], model->p[1]};
    nevh_options options = {.q = q, .p = p};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    nevh_energy *energy = nevh_energy_new(s, 1);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    /* The second step is far too long, and calls for the rescue. */
    int status = nevh_run(stepper, 0, 0.01, steps, q, p, &watch, 1);
    for (size_t i = 0; i < steps; i++)
        nevh_stepper_apply(stepper, 0, 5, q, p);
    if (status)
        puts(nevh_stepper_message(stepper));
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return status;
}

int main(int argc, char **argv) {
    size_t steps = argc > 1 ? strtoul(argv[1], NULL, 10) : 1;
    for (const nevh_integrator *const *i = nevh_integrators(); *i; i++)
        if (run(*i, steps))
            return EXIT_FAILURE;
    return EXIT_SUCCESS;
}
