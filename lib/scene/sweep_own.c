/* nevh: outcomes of a scene's own orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    nevh_sweep *sweep;
    bool begun;
    double *values; /* of outcomes */
    size_t count;
} own_orbit;

static bool own_start(void *data, uint64_t *member, double q[], double p[]) {
    own_orbit *o = data;
    bool first = !o->begun;
    o->begun = true;
    *member = 0;
    if (first && nevh_scene_start(o->sweep->scene, q, p)) {
        nevh__fail(&o->sweep->report, o->sweep->scene->status, "%s",
                   o->sweep->scene->message);
        return false;
    }
    return first;
}

static int own_end(void *data, const nevh_member_result *result) {
    own_orbit *o = data;
    if (result->status)
        nevh__fail(&o->sweep->report, result->status, "%s", result->message);
    else
        memcpy(o->values, result->values, o->count * sizeof *o->values);
    return 0;
}

static int run_own(nevh_sweep *s, double values[], size_t count) {
    const nevh__scene_model *m = s->scene->model;
    nevh_options o;
    nevh__variant x = {0};
    double *room = nevh__array(2 * m->n, sizeof *room);
    nevh_ensemble *e = NULL;
    own_orbit orbit = {s, false, values, count};
    if (!room)
        nevh__no_memory(&s->report);
    else if (nevh__variant_make(s, NULL, &x, &s->report)) {
        nevh_ensemble_options is = nevh__variant_options(s, &x, &o, room);
        is.width = 1;
        e = nevh_ensemble_new(x.model->system, &is);
        if (!e)
            nevh__no_memory(&s->report);
        else if (nevh_ensemble_status(e))
            nevh__fail(&s->report, nevh_ensemble_status(e), "%s",
                       nevh_ensemble_message(e));
        else if (nevh_ensemble_columns(e) != count)
            nevh__fail(&s->report, NEVH_EINVAL,
                       "there are %zu outcomes, not %zu",
                       nevh_ensemble_columns(e), count);
        else
            nevh_ensemble_run(e, own_start, own_end, &orbit);
    }
    nevh_ensemble_free(e);
    nevh__variant_free(&x);
    free(room);
    return s->report.status;
}

int nevh_scene_own_outcomes(nevh_scene *scene,
                            const nevh_sweep_options *options, double values[],
                            size_t count) {
    if (!scene || !options || !values)
        return NEVH_EINVAL;
    nevh_sweep *s = nevh__sweep_make(scene, options, true);
    if (!s)
        return NEVH_ENOMEM;
    int status = nevh_sweep_status(s);
    if (!status)
        status = run_own(s, values, count);
    if (status) {
        scene->status = status;
        snprintf(scene->message, sizeof scene->message, "%s",
                 nevh_sweep_message(s));
    }
    nevh_sweep_free(s);
    return status;
}
