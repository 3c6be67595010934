/* nevh: the starts of members of [ensemble], apart from a sweep.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint64_t nevh_scene_members(const nevh_scene *s) {
    return s && s->model && s->model->ensemble->n_varied
               ? s->model->ensemble->members
               : 0;
}

/* True of x and of x[1..3], which are several elements. */
static bool is_several(const char *name) {
    const char *index = strchr(name, '[');
    return !index || strspn(index + 1, "0123456789") + 1 < strcspn(index, "]");
}

/* A velocity decides on the momentum, too; all elements on one. */
static bool is_same_start(const char *a, const char *b) {
    bool both = strchr("pv", a[0]) && strchr("pv", b[0]) && a[0] && b[0] &&
                a[1] == '_' && b[1] == '_';
    size_t length = strcspn(a += both ? 2 : 0, "[");
    b += both ? 2 : 0;
    bool any = is_several(a) || is_several(b);
    return any ? strcspn(b, "[") == length && strncmp(a, b, length) == 0
               : strcmp(a, b) == 0;
}

bool nevh_scene_varies(const nevh_scene *s, const char *name) {
    if (!s || !s->model || !name)
        return false;
    const nevh__scene_ensemble *e = s->model->ensemble;
    for (size_t i = 0; i < e->n_varied; i++)
        if (is_same_start(e->varied[i].name, name))
            return true;
    return false;
}

static int member_refuse(nevh_scene *s, int status, const char *why) {
    s->status = status;
    snprintf(s->message, sizeof s->message, "%s", why);
    return status;
}

/* Fails unless the member's parameters change only the start. */
static int member_compare(nevh_sweep *s, const nevh__variant *x,
                          nevh__report *report) {
    nevh__variant own;
    bool alike = nevh__variant_make(s, NULL, &own, report) &&
                 nevh__variants_alike(s, &own, x);
    nevh__variant_free(&own);
    if (!alike && !report->status)
        nevh__fail(report, NEVH_EINVAL,
                   "parameters that are varied change more than where members "
                   "start, which gives each a system of its own: vary "
                   "coordinates, momenta, or parameters of these alone");
    return report->status;
}

static int member_find(nevh_sweep *s, uint64_t member, double varied[],
                       double q[], double p[], double v[],
                       nevh__report *report) {
    const nevh__scene_ensemble *e = s->ensemble;
    nevh__variant x;
    for (size_t i = 0; i < e->n_varied; i++)
        varied[i] = nevh__varied_value(e, &e->varied[i], member);
    int status =
        nevh__variant_make(s, varied, &x, report) ? NEVH_OK : report->status;
    if (!status && e->parameters)
        status = member_compare(s, &x, report);
    if (!status)
        status = nevh__variant_start(s, &x, varied, q, p, v, report);
    nevh__variant_free(&x);
    return status;
}

int nevh_scene_member_start(nevh_scene *s, uint64_t member, double q[],
                            double p[]) {
    nevh__report report = {0};
    if (!s || !s->model || member >= nevh_scene_members(s))
        return NEVH_EINVAL;
    nevh_sweep sweep = {.scene = s, .ensemble = s->model->ensemble};
    double *varied = nevh__array(sweep.ensemble->n_varied, sizeof *varied);
    double *v = nevh__array(s->model->n, sizeof *v);
    int status = varied && v
                     ? member_find(&sweep, member, varied, q, p, v, &report)
                     : nevh__no_memory(&report);
    free(varied);
    free(v);
    return status ? member_refuse(s, status, report.text) : NEVH_OK;
}
