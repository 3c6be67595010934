/* nevh: the state at t_start.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene_ensemble_private.h"
#include <fenv.h>
#include <stdlib.h>
#include <string.h>

static void start_fail(nevh_scene *scene, const nevh__report *report) {
    const nevh__scene_model *m = scene->model;
    size_t k = 0;
    while (!m->by_velocity[k])
        k++;
    if (report->status == NEVH_ENOMEM)
        nevh__scene_no_memory(scene);
    else
        nevh__scene_fail(scene, report->status, &m->moving[k]->key, "%s",
                         report->text);
}

static int find_momenta(nevh_scene *scene, double q[], double p[]) {
    nevh__report report = {0};
    if (nevh__momenta_find(scene->model, q, p, &report))
        start_fail(scene, &report);
    return report.status;
}

/* The statement of an effect: a scene that begins where H is not finite is
   wrong there. */
static bool fail_effect(nevh_scene *scene, const char *effect) {
    for (size_t i = 0; i < scene->n_statements; i++) {
        const nevh__statement *s = &scene->statements[i];
        if (s->section == NEVH__EFFECTS && strcmp(s->head.name, effect) == 0)
            return nevh__scene_fail(scene, NEVH_EDOM, &s->value,
                                    "this is not finite in the initial state");
    }
    return true;
}

static int check_values(nevh_scene *scene, const double q[], const double p[]) {
    const nevh__scene_model *m = scene->model;
    double *buffer = nevh__velocity_buffer(m->system);
    if (!buffer)
        return nevh__scene_no_memory(scene), NEVH_ENOMEM;
    const char *effect =
        nevh__effect_not_finite(m->system, m->run.t_start, q, p, buffer);
    free(buffer);
    if (effect)
        fail_effect(scene, effect);
    return scene->status;
}

int nevh_scene_start(nevh_scene *scene, double q[], double p[]) {
    if (!scene)
        return NEVH_EINVAL;
    const nevh__scene_model *m = scene->model;
    bool any = false;
    if (!m)
        return scene->status;
    scene->status = NEVH_OK;
    scene->message[0] = '\0';
    for (size_t k = 0; k < m->n; k++) {
        q[k] = m->q[k];
        p[k] = m->p[k];
        any |= m->by_velocity[k];
    }
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = any ? find_momenta(scene, q, p) : NEVH_OK;
    if (!status)
        status = check_values(scene, q, p);
    fesetenv(&own);
    return status;
}
