/* nevh tests: takes N steps of every scheme, for tests/robust/valgrind.sh, which
   counts allocations.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/nevh.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <stdlib.h>

/* A wall at q = 1, into which fixed-point iteration throws the first stage. */
static double wall(double t, const double q[], const double p[],
                   const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 - 5 * log(1 - q[0] * q[0]);
}

/* Steps that need more than fixed-point iteration. */
static int rescue(const nevh_integrator *scheme, double h, size_t steps,
                  size_t rescues) {
    nevh_system *s = nevh_system_from(1, wall, NULL);
    nevh_options options = {.gradient_step = 0x1p-10};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < steps; i++) {
        double q[] = {0.9}, p[] = {0};
        status = nevh_stepper_apply(stepper, 0, h, q, p);
    }
    if (status)
        puts(nevh_stepper_message(stepper));
    nevh_counts counts = nevh_stepper_counts(stepper);
    if (counts.newtons != steps || counts.rescues != rescues)
        status = puts("not the rescues that were expected");
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return status;
}

/* For schemes that need formulas. */
static const char text[] =
    "[coordinates]\nx = 0.3\ny = 0\n[effects]\nK = (p_x^2 + p_y^2)/2\n"
    "V = (x^2 + y^2)/2 + x^2*y\n[run]\nt_end = 1\ndt = 0.01\n";

static int run(const nevh_integrator *scheme, size_t steps) {
    const nevh_model *model = nevh_coupled_oscillators_model;
    nevh_system *own = model->system(model->defaults);
    nevh_scene *scene = nevh_integrator_needs_formulas(scheme)
                            ? nevh_scene_parse("steps", text)
                            : NULL;
    const nevh_system *s = scene ? nevh_scene_system(scene) : own;
    double q[] = {model->q[0], model->q[1]}, p[] = {model->p[0], model->p[1]};
    bool needs = nevh_integrator_needs_tolerance(scheme);
    nevh_options options = {.q = q, .p = p, .tolerance = needs ? 1e-12 : 0};
    nevh_stepper *stepper = nevh_stepper_new(s, scheme, &options);
    nevh_energy *energy = nevh_energy_new(s, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    int status = nevh_run(stepper, 0, 0.01, steps, q, p, &watch, 1);
    if (status)
        puts(nevh_stepper_message(stepper));
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_scene_free(scene);
    nevh_system_free(own);
    return status;
}

int main(int argc, char **argv) {
    size_t steps = argc > 1 ? strtoul(argv[1], NULL, 10) : 1;
    for (const nevh_integrator *const *i = nevh_integrators(); *i; i++)
        if (run(*i, steps))
            return EXIT_FAILURE;
    return rescue(nevh_midpoint, 0.3, steps, 0) ||
                   rescue(nevh_gauss4, 1.73, steps, steps)
               ? EXIT_FAILURE
               : EXIT_SUCCESS;
}
