/* nevh: a scene with one set of the parameters that are varied.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sweep_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ANYTHING = NEVH__READS_TIME | NEVH__READS_STATE | NEVH__READS_V };

static bool variant_fail(nevh__report *report, int status, const char *text) {
    nevh__fail(report, status, "%s", text);
    return false;
}

/* LEFT - RIGHT, or LEFT alone where right is NULL, as a quantity. */
static bool make_quantity(nevh__variant *x, const char *left, const char *right,
                          nevh_quantity *quantity, nevh__report *report) {
    nevh__formula_error error = {0};
    char *text =
        right ? nevh__text("(%s) - (%s)", left, right) : nevh__text("%s", left);
    nevh__tree *tree = text ? nevh__tree_parse(text, &error) : NULL;
    nevh__tape *tape =
        tree ? nevh__tree_tape(tree, x->model->names, ANYTHING, &error) : NULL;
    nevh__tree_free(tree);
    nevh__tape **all =
        tape ? nevh__grow(x->tapes.tapes, x->tapes.count + 1, sizeof *all)
             : NULL;
    if (!all) {
        nevh__tape_free(tape);
        if (text && error.status && error.status != NEVH_ENOMEM)
            nevh__fail(report, error.status, "%s: %s", text, error.text);
        else
            variant_fail(report, NEVH_ENOMEM, "out of memory");
        free(text);
        return false;
    }
    free(text);
    x->tapes.tapes = all;
    all[x->tapes.count++] = tape;
    *quantity = (nevh_quantity){nevh__tape_quantity, tape,
                                nevh__tape_count(tape, NEVH__C) > 0};
    return true;
}

/* The period of a coordinate that is an angle; 0 for other formulas. */
static double period_of(const nevh__scene_model *m, const char *formula) {
    for (size_t k = 0; k < m->n; k++)
        if (strcmp(m->coordinate_names[k], formula) == 0)
            return m->period[k];
    return 0;
}

static bool make_outcome(nevh__variant *x, const nevh__scene_outcome *from,
                         nevh_outcome *to, nevh__report *report) {
    const char *left = from->left.text, *right = from->right.text;
    const nevh_scene_section *is;
    to->kind = nevh_outcome_find(from->type->info.name);
    switch (from->type->info.takes) {
    case NEVH_OUTCOME_TAKES_CONDITION:
        return make_quantity(x, from->below ? right : left,
                             from->below ? left : right, &to->quantity, report);
    case NEVH_OUTCOME_TAKES_FORMULA:
        to->modulus = from->type->of_turns ? period_of(x->model, left) : 0;
        return make_quantity(x, left, NULL, &to->quantity, report);
    case NEVH_OUTCOME_TAKES_SECTION:
        is = &x->model->crossings[from->section].decl;
        to->direction = is->direction;
        to->modulus = is->period;
        return make_quantity(x, is->left, is->right, &to->quantity, report);
    case NEVH_OUTCOME_TAKES_NOTHING:
        break;
    }
    return true;
}

static bool make_stop(nevh__variant *x, nevh__report *report) {
    const nevh__stop *stop = &x->model->stop;
    if (!stop->text)
        return true;
    char *value = nevh__text("%.17g", stop->value);
    const char *formula = stop->formula.piece.text;
    bool made =
        value && make_quantity(x, stop->below ? value : formula,
                               stop->below ? formula : value, &x->stop, report);
    if (!value)
        variant_fail(report, NEVH_ENOMEM, "out of memory");
    free(value);
    return made;
}

static bool make_sides(const nevh_sweep *s, nevh__variant *x,
                       nevh__report *report) {
    const nevh__scene_ensemble *e = s->ensemble;
    /* For values alone: a step that is given is not searched for. */
    nevh_options values = {.gradient = nevh_central2, .gradient_step = 1};
    x->sides = nevh__array(e->n_varied, sizeof *x->sides);
    x->padded = nevh__array(2 * x->model->n * NEVH__LANES, sizeof(double));
    x->energy = nevh_field_new(x->model->system, &values);
    if (!x->sides || !x->padded || !x->energy)
        return variant_fail(report, NEVH_ENOMEM, "out of memory");
    for (size_t i = 0; i < e->n_varied; i++) {
        const nevh__varied *v = &e->varied[i];
        if (v->how == NEVH__VARY_SOLVE &&
            !make_quantity(x, v->energy ? v->right.text : v->left.text,
                           v->energy ? NULL : v->right.text, &x->sides[i],
                           report))
            return false;
    }
    return true;
}

/* The message of a scene without its place: a set of parameters is at fault,
   not a line. */
static void quote_scene(const nevh_scene *s, nevh__report *report) {
    const char *what = strstr(s->message, "error: ");
    what = what ? what + strlen("error: ") : s->message;
    nevh__fail(report, s->status, "%.*s", (int)strcspn(what, "\n"), what);
}

bool nevh__variant_make(nevh_sweep *s, const double varied[], nevh__variant *x,
                        nevh__report *report) {
    *x = (nevh__variant){.model = s->scene->model};
    if (s->ensemble->parameters && varied) {
        struct nevh__overrides overrides = {s->ensemble, varied};
        s->scene->status = NEVH_OK;
        s->scene->message[0] = '\0';
        x->owned = true;
        x->model = nevh__model_with(s->scene, &overrides);
        if (!x->model) {
            quote_scene(s->scene, report);
            return false;
        }
    }
    x->outcomes = nevh__array(s->n_outcomes, sizeof *x->outcomes);
    x->room = nevh__velocity_buffer(x->model->system);
    if (!x->outcomes || !x->room)
        return variant_fail(report, NEVH_ENOMEM, "out of memory");
    for (size_t i = 0; i < s->n_outcomes; i++)
        if (!make_outcome(x, &s->outcomes[i], &x->outcomes[i], report))
            return false;
    return (!s->ensemble->solves || make_sides(s, x, report)) &&
           make_stop(x, report);
}

void nevh__variant_free(nevh__variant *x) {
    if (x->owned)
        nevh__model_free(x->model);
    nevh__owned_free(&x->tapes);
    free(x->outcomes);
    free(x->room);
    free(x->sides);
    free(x->padded);
    nevh_field_free(x->energy);
    *x = (nevh__variant){0};
}

/* The scene's own start, with the variant's parameters, is where steps of
   differences are chosen: the same for every member. */
static bool plan_state(const nevh__variant *x, double q[], double p[]) {
    const nevh__scene_model *m = x->model;
    nevh__report report = {0};
    bool any = false;
    for (size_t k = 0; k < m->n; k++)
        any |= m->by_velocity[k];
    memcpy(q, m->q, m->n * sizeof *q);
    memcpy(p, m->p, m->n * sizeof *p);
    return (!any || !nevh__momenta_find(m, q, p, &report)) &&
           !nevh__effect_not_finite(m->system, m->run.t_start, q, p, x->room);
}

/* Steps are compiled for all members or for none, by the work of all: the last
   digits must depend neither on width or threads nor on what the cache holds. */
static double steps_foreseen(const nevh_sweep *s, double steps) {
    static const double compiling_pays = 4e6; /* gradients */
    int each = nevh_integrator_stages(s->is.integrator);
    double members = (double)nevh_sweep_members(s);
    return steps * members * (each > 1 ? each : 1) > compiling_pays ? INFINITY
                                                                    : 0;
}

nevh_ensemble_options nevh__variant_options(const nevh_sweep *s,
                                            const nevh__variant *x,
                                            nevh_options *o, double room[]) {
    const nevh__scene_model *m = x->model;
    const nevh_scene_run *run = &m->run;
    bool planned = plan_state(x, room, room + m->n);
    bool own = s->is.gradient_step > 0;
    size_t substeps = s->is.substeps ? s->is.substeps : run->substeps;
    *o = (nevh_options){.gradient = s->is.gradient,
                        .gradient_step =
                            own ? s->is.gradient_step : run->gradient_step,
                        .gradient_steps = own ? NULL : run->gradient_steps,
                        .t = run->t_start,
                        .q = planned ? room : NULL,
                        .p = planned ? room + m->n : NULL,
                        .tolerance = s->is.tolerance,
                        .transform = s->is.transformed ? m->transform : NULL,
                        .portable = s->is.portable,
                        .substeps = substeps,
                        .native = s->is.native,
                        .native_cache = s->is.native_cache};
    double t_end = s->is.t_end != 0 ? s->is.t_end : run->t_end;
    double dt = s->is.dt > 0 ? s->is.dt : run->dts ? run->dt[0] : 0;
    o->steps_foreseen = steps_foreseen(s, (t_end - run->t_start) / dt);
    return (nevh_ensemble_options){.integrator = s->is.integrator,
                                   .options = o,
                                   .t_start = run->t_start,
                                   .t_end = t_end,
                                   .dt = dt,
                                   .width = s->is.width,
                                   .energy_scale = run->energy_scale,
                                   .outcomes = x->outcomes,
                                   .n_outcomes = s->n_outcomes,
                                   .stop = x->stop};
}

/* Finds what is solved for, one after the other. */
static int variant_solve(const nevh_sweep *s, const nevh__variant *x,
                         double varied[], double q[], double p[],
                         nevh__report *report) {
    const nevh__scene_ensemble *e = s->ensemble;
    for (size_t i = 0; i < e->n_varied; i++) {
        const nevh__varied *is = &e->varied[i];
        if (is->how != NEVH__VARY_SOLVE)
            continue;
        bool found = nevh__variant_solve(s, x, i, q, p);
        varied[i] = !found                     ? NAN
                    : is->is == NEVH__MOMENTUM ? p[is->index]
                                               : q[is->index];
        if (!found)
            return nevh__fail(report, NEVH_EMAXITER,
                              "%s = %s has no solution that the search from "
                              "%.9g finds",
                              is->name, is->statement->value.text, is->a);
    }
    return NEVH_OK;
}

int nevh__variant_start(const nevh_sweep *s, const nevh__variant *x,
                        double varied[], double q[], double p[], double v[],
                        nevh__report *report) {
    const nevh__scene_ensemble *e = s->ensemble;
    nevh__scene_model m = *x->model;
    bool any = false;
    memcpy(q, m.q, m.n * sizeof *q);
    memcpy(p, m.p, m.n * sizeof *p);
    memcpy(v, m.v, m.n * sizeof *v);
    for (size_t i = 0; i < e->n_varied; i++) {
        const nevh__varied *is = &e->varied[i];
        double *to = is->is == NEVH__COORDINATE ? q
                     : is->is == NEVH__MOMENTUM ? p
                     : is->is == NEVH__VELOCITY ? v
                                                : NULL;
        if (to)
            to[is->index] = varied[i];
    }
    for (size_t k = 0; k < m.n; k++) {
        any |= e->by_velocity[k];
        if (e->by_velocity[k])
            p[k] = 0; /* until it is found */
    }
    m.v = v;
    m.by_velocity = e->by_velocity;
    int status = any ? nevh__momenta_find(&m, q, p, report) : NEVH_OK;
    if (!status)
        status = variant_solve(s, x, varied, q, p, report);
    if (status)
        return status;
    const char *effect =
        nevh__effect_not_finite(m.system, m.run.t_start, q, p, x->room);
    return effect ? nevh__fail(report, NEVH_EDOM,
                               "%s is not finite in the initial state", effect)
                  : NEVH_OK;
}
