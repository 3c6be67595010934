/* nevh: the starts of members of [ensemble], apart from a sweep.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <stdio.h>
#include <stdlib.h>

uint64_t nevh_scene_members(const nevh_scene *s) {
    return s && s->model && s->model->ensemble->n_varied
               ? s->model->ensemble->members
               : 0;
}

static int refuse(nevh_scene *s, int status, const char *why) {
    s->status = status;
    snprintf(s->message, sizeof s->message, "%s", why);
    return status;
}

static int find(nevh_scene *s, uint64_t member, double q[], double p[],
                nevh__report *report) {
    const nevh__scene_ensemble *e = s->model->ensemble;
    nevh_sweep sweep = {.scene = s, .ensemble = e};
    nevh__variant x;
    double *varied = nevh__array(e->n_varied, sizeof *varied);
    double *v = nevh__array(s->model->n, sizeof *v);
    int status = NEVH_ENOMEM;
    if (varied && v && nevh__variant_make(&sweep, NULL, &x, report)) {
        for (size_t i = 0; i < e->n_varied; i++)
            varied[i] = nevh__varied_value(e, &e->varied[i], member);
        status = nevh__variant_start(&sweep, &x, varied, q, p, v, report);
    } else if (report->status) {
        status = report->status;
    }
    if (varied && v)
        nevh__variant_free(&x);
    free(varied);
    free(v);
    return status;
}

int nevh_scene_member_start(nevh_scene *s, uint64_t member, double q[],
                            double p[]) {
    nevh__report report = {0};
    if (!s || !s->model || member >= nevh_scene_members(s))
        return NEVH_EINVAL;
    if (s->model->ensemble->parameters)
        return refuse(s, NEVH_EINVAL,
                      "members have parameters of their own, and so each a "
                      "system of its own: vary starts alone");
    int status = find(s, member, q, p, &report);
    return status ? refuse(s, status, report.text) : NEVH_OK;
}
