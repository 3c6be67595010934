/* nevh: runs whose instructions bench/counts.sh has callgrind count.

       bench/counts [scheme...]

   Every scheme, or those named, with every gradient, on one orbit and on many
   side by side.  Each run prints the first four columns and the steps of a row
   of the table; callgrind writes a file at the end of each call of
   `take_steps`, in the same order.  Runs that a plan refuses are left out.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/nevh.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ORBITS = 32, MOST_N = 2, WARM_UP = 4, STEPS = 24, MANY_STEPS = 4 };
static const double h = 0.01, tolerance = 1e-9;

typedef struct {
    nevh_stepper *stepper;
    double q[MOST_N * MOST_ORBITS], p[MOST_N * MOST_ORBITS];
} orbits;

/* A name for callgrind: neither inlined nor cloned. */
__attribute__((noinline, noclone)) int take_steps(orbits *, double t,
                                                  size_t steps);

int take_steps(orbits *o, double t, size_t steps) {
    int status = nevh_run(o->stepper, t, h, steps, o->q, o->p, NULL, 0);
    __asm__ volatile("" ::: "memory");
    return status;
}

/* Orbits of slightly different energies. */
static void start(const nevh_model *model, size_t width, orbits *o) {
    for (size_t i = 0; i < model->n * width; i++) {
        double lane = (double)(i % width);
        o->q[i] = model->q[i / width] * (1 - lane / 256);
        o->p[i] = model->p[i / width] + lane / 512;
    }
}

static void fail(const nevh_integrator *scheme, const char *why) {
    fprintf(stderr, "counts: %s: %s\n", nevh_integrator_name(scheme), why);
    exit(EXIT_FAILURE);
}

/* The first steps are not counted: they have no slopes to continue. */
static void count(const nevh_model *model, const nevh_system *system,
                  const nevh_integrator *scheme, const nevh_gradient *gradient,
                  size_t width) {
    static orbits o;
    size_t steps = width > 1 ? MANY_STEPS : STEPS;
    bool adapts = nevh_integrator_needs_tolerance(scheme);
    start(model, width, &o);
    nevh_options options = {.gradient = gradient,
                            .width = width,
                            .tolerance = adapts ? tolerance : 0,
                            .q = o.q,
                            .p = o.p};
    o.stepper = nevh_stepper_new(system, scheme, &options);
    if (nevh_stepper_status(o.stepper) == NEVH_OK) {
        if (nevh_run(o.stepper, 0, h, WARM_UP, o.q, o.p, NULL, 0) ||
            take_steps(&o, WARM_UP * h, steps))
            fail(scheme, nevh_stepper_message(o.stepper));
        printf("%s,%s,%s,%zu,%zu\n", nevh_integrator_name(scheme),
               nevh_gradient_name(gradient), model->name, width, steps);
    }
    nevh_stepper_free(o.stepper);
}

static void count_scheme(const nevh_integrator *scheme) {
    const nevh_model *const models[] = {nevh_pendulum_model,
                                        nevh_double_pendulum_model};
    const nevh_gradient *const gradients[] = {nevh_exact, nevh_central2,
                                              nevh_central4, nevh_complex_step};
    for (size_t m = 0; m < 2; m++) {
        nevh_system *system = models[m]->system(models[m]->defaults);
        for (size_t g = 0; g < 4; g++)
            for (size_t width = 1; width <= MOST_ORBITS; width += 31)
                count(models[m], system, scheme, gradients[g], width);
        nevh_system_free(system);
    }
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        const nevh_integrator *scheme = nevh_integrator_named(argv[i]);
        if (!scheme) {
            fprintf(stderr, "counts: there is no scheme %s\n", argv[i]);
            return EXIT_FAILURE;
        }
        count_scheme(scheme);
    }
    for (size_t i = 0; argc < 2 && nevh_integrators()[i]; i++)
        count_scheme(nevh_integrators()[i]);
    return EXIT_SUCCESS;
}
