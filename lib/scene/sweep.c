/* nevh: a sweep is planned.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool name_column(nevh_sweep *s, const char *format, const char *name) {
    char *text = nevh__text(format, name);
    s->names[s->columns++] = text;
    return text;
}

/* last(x), last(p_x) */
static bool name_state(nevh_sweep *s) {
    const nevh__scene_model *m = s->scene->model;
    for (size_t k = 0; k < 2 * m->n; k++)
        if (!name_column(s, k < m->n ? "last(%s)" : "last(p_%s)",
                         m->coordinate_names[k % m->n]))
            return false;
    return true;
}

static bool name_columns(nevh_sweep *s) {
    const nevh__scene_ensemble *e = s->ensemble;
    for (size_t i = 0; i < e->n_varied; i++)
        if (!name_column(s, "%s", e->varied[i].name))
            return false;
    for (size_t i = 0; i < s->n_outcomes; i++) {
        const nevh__scene_outcome *o = &s->outcomes[i];
        size_t first = s->columns;
        if (o->type->whole_state ? !name_state(s)
                                 : !name_column(s, "%s", o->piece.text))
            return false;
        for (size_t k = first; k < s->columns; k++)
            s->types[k] = o->type;
    }
    return true;
}

static int check_names(nevh_sweep *s) {
    for (size_t i = 0; i < s->columns; i++)
        for (size_t k = 0; k < i; k++)
            if (strcmp(s->names[i], s->names[k]) == 0)
                return nevh__fail(&s->report, NEVH_EINVAL,
                                  "two columns would be called %s",
                                  s->names[i]);
    return NEVH_OK;
}

static int take_outcomes(nevh_sweep *s) {
    const nevh__scene_ensemble *e = s->ensemble;
    s->outcomes = e->outcomes;
    s->n_outcomes = e->n_outcomes;
    if (!s->n_outcomes) {
        s->default_outcomes[0].type = &nevh__outcome_state;
        s->default_outcomes[1].type = &nevh__outcome_energy_error;
        s->default_outcomes[1].piece.text = "energy_error";
        s->outcomes = s->default_outcomes;
        s->n_outcomes = 2;
    }
    size_t most = e->n_varied + s->n_outcomes * 2 * s->scene->model->n;
    s->names = nevh__array(most, sizeof *s->names);
    s->types = nevh__array(most, sizeof *s->types);
    if (!s->names || !s->types || !name_columns(s))
        return nevh__no_memory(&s->report);
    return check_names(s);
}

/* Plans the scene as it is, to find refusals that all members would meet. */
static int try(nevh_sweep *s) {
    const nevh__scene_model *m = s->scene->model;
    nevh_options o;
    nevh__variant x = {0};
    double *room = nevh__array(2 * m->n, sizeof *room);
    nevh_ensemble *e = NULL;
    if (!room)
        nevh__no_memory(&s->report);
    else if (nevh__variant_make(s, NULL, &x, &s->report)) {
        nevh_ensemble_options is = nevh__variant_options(s, &x, &o, room);
        if (!(is.dt > 0))
            nevh__fail(&s->report, NEVH_EINVAL, "there is no time step");
        else if (isnan(is.t_end))
            nevh__fail(&s->report, NEVH_EINVAL, "there is no end of the run");
        else if (!(e = nevh_ensemble_new(x.model->system, &is)))
            nevh__no_memory(&s->report);
        else if (nevh_ensemble_status(e))
            nevh__fail(&s->report, nevh_ensemble_status(e), "%s",
                       nevh_ensemble_message(e));
    }
    const char *why = "";
    s->native = nevh_ensemble_native(e, &why);
    if (s->native && s->ensemble->parameters &&
        s->is.native != NEVH_NATIVE_ALWAYS && nevh__ensemble_may_vary(e) &&
        !nevh__ensemble_may_vary_compiled(e))
        why = "where eight members or more have the same parameters";
    snprintf(s->why_native, sizeof s->why_native, "%s", why);
    nevh_ensemble_free(e);
    nevh__variant_free(&x);
    free(room);
    return s->report.status;
}

nevh_sweep *nevh__sweep_make(nevh_scene *scene,
                             const nevh_sweep_options *options, bool own) {
    nevh_sweep *s = scene ? nevh__array(1, sizeof *s) : NULL;
    if (!s)
        return NULL;
    s->scene = scene;
    s->is = options ? *options : (nevh_sweep_options){0};
    s->is.threads = s->is.threads ? s->is.threads : 1;
    pthread_mutex_init(&s->lock, NULL);
    pthread_cond_init(&s->moved, NULL);
    s->ensemble = scene->model ? scene->model->ensemble : NULL;
    int status = NEVH_OK;
    if (!scene->model)
        status = nevh__fail(&s->report, scene->status, "%s", scene->message);
    else if (!own && !s->ensemble->n_varied)
        status = nevh__fail(&s->report, NEVH_EINVAL,
                            "nothing is varied: give [ensemble] a line such "
                            "as %s = range(0, 1, 11)",
                            scene->model->coordinate_names[0]);
    else
        status = take_outcomes(s);
    if (!status)
        status = try(s);
    if (status != NEVH_ENOMEM)
        return s;
    nevh_sweep_free(s);
    return NULL;
}

nevh_sweep *nevh_sweep_new(nevh_scene *scene,
                           const nevh_sweep_options *options) {
    return nevh__sweep_make(scene, options, false);
}

void nevh_sweep_free(nevh_sweep *s) {
    if (!s)
        return;
    for (size_t i = 0; i < s->columns; i++)
        free(s->names[i]);
    free(s->names);
    free(s->types);
    pthread_mutex_destroy(&s->lock);
    pthread_cond_destroy(&s->moved);
    free(s);
}

NEVH__REPORTS(sweep)

uint64_t nevh_sweep_members(const nevh_sweep *s) {
    if (!s)
        return 0;
    return s->ensemble ? s->ensemble->members : 0;
}

size_t nevh_sweep_columns(const nevh_sweep *s) {
    return s ? s->columns : 0;
}

size_t nevh_sweep_varied(const nevh_sweep *s) {
    if (!s)
        return 0;
    return s->ensemble ? s->ensemble->n_varied : 0;
}

const char *nevh_sweep_column(const nevh_sweep *s, size_t k) {
    if (!s)
        return "";
    return k < s->columns ? s->names[k] : NULL;
}

bool nevh_sweep_is_verdict(const nevh_sweep *s, size_t k) {
    if (!s)
        return false;
    return k < s->columns && s->types[k] == &nevh__outcome_verdict;
}

bool nevh_sweep_is_of_values(const nevh_sweep *s, size_t k) {
    return s && k < s->columns && s->types[k] && s->types[k]->of_values;
}

bool nevh_sweep_native(const nevh_sweep *s, const char **why) {
    if (why)
        *why = s ? s->why_native : "out of memory";
    return s && s->native;
}
