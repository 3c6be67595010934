/* nevh tests: takes N steps of a scene by one scheme, for tests/robust/effects_off.sh,
   which counts instructions.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/nevh.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <stdlib.h>

static int run(nevh_scene *s, const nevh_integrator *scheme, size_t steps) {
    size_t n = nevh_scene_dof(s);
    double *q = calloc(2 * n, sizeof *q), *p = q + n;
    int status = q ? nevh_scene_start(s, q, p) : NEVH_ENOMEM;
    nevh_options options = {.gradient_step = 0x1p-8, .q = q, .p = p};
    nevh_stepper *by = nevh_stepper_new(nevh_scene_system(s), scheme, &options);
    if (!status)
        status = nevh_run(by, 0, 0.01, steps, q, p, NULL, 0);
    if (status)
        puts(nevh_stepper_message(by));
    nevh_stepper_free(by);
    free(q);
    return status;
}

int main(int argc, char **argv) {
    if (argc != 4)
        return EXIT_FAILURE;
    nevh_scene *s = nevh_scene_read(argv[1]);
    if (nevh_scene_status(s))
        puts(nevh_scene_message(s));
    int status = nevh_scene_status(s) ? EXIT_FAILURE
                                      : run(s, nevh_integrator_named(argv[2]),
                                            strtoul(argv[3], NULL, 10));
    nevh_scene_free(s);
    return status ? EXIT_FAILURE : EXIT_SUCCESS;
}
