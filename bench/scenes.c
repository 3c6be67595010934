/* nevh bench: how long it takes to read scenes and to plan for them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/nevh.h>
#include <nevh/scene.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { REPEATS = 9 };

static double seconds(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

/* What a plan takes, the start included, after reading. */
static double plan(nevh_scene *s) {
    double begin = seconds();
    size_t n = nevh_scene_dof(s);
    const nevh_scene_run *run = nevh_scene_run_settings(s);
    double *q = calloc(2 * n, sizeof *q);
    nevh_scene_start(s, q, q + n);
    nevh_options o = {.gradient_step = run->gradient_step,
                      .gradient_steps = run->gradient_steps,
                      .t = run->t_start,
                      .q = q,
                      .p = q + n};
    nevh_stepper *by =
        nevh_stepper_new(nevh_scene_system(s), nevh_midpoint, &o);
    if (nevh_stepper_status(by))
        puts(nevh_stepper_message(by));
    nevh_stepper_free(by);
    free(q);
    return seconds() - begin;
}

static int measure(const char *path) {
    double read = 1e300, planned = 1e300;
    for (int i = 0; i < REPEATS; i++) {
        double begin = seconds();
        nevh_scene *s = nevh_scene_read(path);
        double spent = seconds() - begin;
        if (nevh_scene_status(s)) {
            puts(nevh_scene_message(s));
            nevh_scene_free(s);
            return EXIT_FAILURE;
        }
        double more = plan(s);
        read = spent < read ? spent : read;
        planned = more < planned ? more : planned;
        nevh_scene_free(s);
    }
    printf("%8.3f %8.3f  %s\n", 1e3 * read, 1e3 * planned, path);
    return EXIT_SUCCESS;
}

int main(int argc, char **argv) {
    int status = EXIT_SUCCESS;
    puts(" read/ms  plan/ms  scene (midpoint, central4)");
    for (int i = 1; !status && i < argc; i++)
        status = measure(argv[i]);
    return status;
}
