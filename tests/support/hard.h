/* nevh tests: orbits of the scenes of nevh hard.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_HARD_H
#define NEVH_TESTS_HARD_H

#include "support.h"
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

static inline nevh_scene *read_scene(const char *folder, const char *name) {
    const char *source = getenv("srcdir");
    char file[500];
    snprintf(file, sizeof file, "%s/%s/%s.nevh", source ? source : ".", folder,
             name);
    nevh_scene *scene = nevh_scene_read(file);
    ck_assert_msg(!nevh_scene_status(scene), "%s", nevh_scene_message(scene));
    return scene;
}

typedef struct {
    nevh_scene *scene;
    nevh_stepper *stepper;
    size_t n;
    double q[40], p[40];
} orbit;

static inline orbit begin(nevh_scene *scene, const nevh_integrator *scheme) {
    orbit o = {scene, NULL, nevh_scene_dof(scene), {0}, {0}};
    ck_assert_uint_le(o.n, 40);
    ck_assert_int_eq(nevh_scene_start(scene, o.q, o.p), NEVH_OK);
    nevh_options options = {.gradient = nevh_exact, .q = o.q, .p = o.p};
    o.stepper = nevh_stepper_new(nevh_scene_system(scene), scheme, &options);
    ck_assert_msg(!nevh_stepper_status(o.stepper), "%s",
                  nevh_stepper_message(o.stepper));
    return o;
}

static inline void end(const orbit *o) {
    nevh_stepper_free(o->stepper);
    nevh_scene_free(o->scene);
}

#endif
