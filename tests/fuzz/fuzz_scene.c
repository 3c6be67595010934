/* nevh tests: any bytes are a scene, or a message with a place.
   SPDX-License-Identifier: GPL-3.0-or-later

   For libFuzzer; see run.sh. */
#include <nevh/nevh.h>
#include <nevh/scene.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { MOST = 64 };

static void insist(int holds) {
    if (!holds)
        abort();
}

/* A few steps from where the scene begins. */
static void step(nevh_scene *s) {
    double q[MOST], p[MOST];
    if (nevh_scene_dof(s) > MOST || nevh_scene_start(s, q, p))
        return;
    nevh_options o = {.gradient = nevh_exact, .q = q, .p = p};
    nevh_stepper *stepper =
        nevh_stepper_new(nevh_scene_system(s), nevh_midpoint, &o);
    int status = nevh_run(stepper, 0, 1e-3, 3, q, p, NULL, 0);
    for (size_t k = 0; !status && k < nevh_scene_dof(s); k++)
        insist(q[k] - q[k] == 0 && p[k] - p[k] == 0);
    insist(!status || *nevh_stepper_message(stepper));
    nevh_stepper_free(stepper);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    char *text = malloc(size + 1);
    insist(text != NULL);
    memcpy(text, bytes, size);
    text[size] = '\0';
    nevh_scene *s = nevh_scene_parse("f", text);
    free(text);
    int status = nevh_scene_status(s);
    insist(!status || strstr(nevh_scene_message(s), ": error: ") != NULL ||
           status == NEVH_ENOMEM);
    insist((status != 0) == (nevh_scene_system(s) == NULL));
    if (!status)
        step(s);
    nevh_scene_set(s, "m = 2/g");
    nevh_scene_enable(s, "gravity", false);
    nevh_scene_free(s);
    return 0;
}
