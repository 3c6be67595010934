/* nevh: an ensemble is planned.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 32, MOST_NUMBERS = 1 << 14 }; /* chosen; n times width */

/* Adds the needs of an outcome to those of the ensemble. */
static void take_outcome(nevh_ensemble *e, size_t i) {
    const nevh__outcome_type *type = e->outcomes[i].type;
    bool crosses = type->info.takes == NEVH_OUTCOME_TAKES_SECTION;
    e->columns += type->whole_state ? 2 * e->n : 1;
    e->moving |= type->info.takes && e->outcomes[i].decl.quantity.velocities;
    e->looks_back |= type->branches;
    e->has_energy |= type->of_energy;
    e->watches |= type->step || type->of_energy || crosses;
    if (crosses)
        e->crossing_of[e->n_crossings++] = i;
}

static int take_outcomes(nevh_ensemble *e) {
    e->n_outcomes = e->options.n_outcomes;
    e->outcomes = nevh__array(e->n_outcomes, sizeof *e->outcomes);
    e->crossing_of = nevh__array(e->n_outcomes, sizeof *e->crossing_of);
    e->crossings = nevh__array(e->n_outcomes, sizeof *e->crossings);
    if (!e->outcomes || !e->crossing_of || !e->crossings)
        return nevh__no_memory(&e->report);
    e->watches = e->options.stop.value;
    e->moving = e->options.stop.value && e->options.stop.velocities;
    for (size_t i = 0; i < e->n_outcomes; i++) {
        const nevh_outcome *o = &e->options.outcomes[i];
        const nevh__outcome_type *type = nevh__outcome_type_of(o->kind);
        if (!type || (type->info.takes && !o->quantity.value))
            return nevh__fail(&e->report, NEVH_EINVAL,
                              "outcome %zu is of no known kind, or lacks its "
                              "quantity",
                              i);
        e->outcomes[i] = (nevh__outcome_entry){.decl = *o, .type = type};
        take_outcome(e, i);
    }
    return NEVH_OK;
}

/* Chooses the number of orbits side by side. */
static size_t choose_width(const nevh_ensemble *e, const nevh_options *o) {
    const nevh_integrator *scheme = e->options.integrator;
    size_t width = e->options.width ? e->options.width : WIDTH;
    while (!e->options.width && width > NEVH__LANES &&
           width * e->n > MOST_NUMBERS)
        width /= 2;
    if (scheme->own_time || o->transform || (scheme->adaptive && o->balance) ||
        width == 1)
        return 1;
    return nevh__padded(width);
}

/* The options of a stepper of so many lanes, which all begin where the options
   say: so its plan is that of one. */
static int repeat_state(nevh_ensemble *e, size_t width, nevh_options *o,
                        double **room) {
    o->width = width;
    *room = nevh__array(2 * e->n * width, sizeof **room);
    if (!*room)
        return nevh__no_memory(&e->report);
    for (size_t i = 0; i < e->n * width; i++) {
        (*room)[i] = o->q ? o->q[i / width] : 0;
        (*room)[e->n * width + i] = o->p ? o->p[i / width] : 0;
    }
    o->q = o->q ? *room : NULL;
    o->p = o->p ? *room + e->n * width : NULL;
    return NEVH_OK;
}

int nevh__ensemble_stepper(nevh_ensemble *e, const nevh_system *system,
                           const nevh_options *options, size_t width,
                           nevh_stepper **s) {
    nevh_options o = *options;
    double *room;
    int status = repeat_state(e, width, &o, &room);
    if (status)
        return status;
    *s = nevh__stepper_watching(system, e->options.integrator, &o,
                                width > 1 ? nevh__ensemble_watched(e) : NULL);
    free(room);
    if (!*s)
        return nevh__no_memory(&e->report);
    return nevh_stepper_status(*s) ? nevh__fail_as(&e->report, &(*s)->report)
                                   : NEVH_OK;
}

/* One of all lanes, and one that steps where it fails, and last. */
static int plan_steppers(nevh_ensemble *e) {
    nevh_options spare = *e->options.options;
    spare.native = NEVH_NATIVE_NEVER;
    int status = nevh__ensemble_stepper(e, e->system, e->options.options,
                                        e->width, &e->stepper);
    if (!status)
        status = nevh__ensemble_stepper(e, e->system, &spare, 1, &e->spare);
    e->narrow = e->spare;
    return status;
}

static int plan_energy(nevh_ensemble *e) {
    nevh_options o = {.width = e->width,
                      .portable = e->options.options->portable};
    if (!e->has_energy)
        return NEVH_OK;
    e->energy = nevh_energy_new(e->system, &o);
    if (!e->energy)
        return nevh__no_memory(&e->report);
    if (e->options.energy_scale != 0)
        nevh_energy_set_scale(e->energy, e->options.energy_scale);
    bool verdict = false;
    for (size_t i = 0; i < e->n_outcomes; i++)
        verdict |= e->outcomes[i].type == &nevh__outcome_verdict;
    if (!verdict)
        nevh__energy_ask_largest(e->energy);
    nevh_energy_follow(e->energy, e->stepper);
    nevh_energy_expect(e->energy, e->stepper);
    return nevh_energy_status(e->energy)
               ? nevh__fail(&e->report, nevh_energy_status(e->energy), "%s",
                            nevh_energy_message(e->energy))
               : NEVH_OK;
}

/* Velocities are exact, where terms bring their derivatives. */
static int plan_motion(nevh_ensemble *e) {
    nevh_options o = *e->options.options;
    if (!e->moving)
        return NEVH_OK;
    for (int i = 0; i < 2; i++) {
        o.gradient = i ? nevh_central6 : nevh_exact;
        o.width = 1;
        nevh_field_free(e->motion);
        e->motion = nevh_field_new(e->system, &o);
        if (!e->motion)
            return nevh__no_memory(&e->report);
        if (!nevh_field_status(e->motion))
            return NEVH_OK;
    }
    return nevh__fail(&e->report, nevh_field_status(e->motion), "%s",
                      nevh_field_message(e->motion));
}

static double *numbers(nevh__arena *a, size_t count) {
    return nevh__arena_take(a, count, sizeof(double));
}

static void lay_out_snapshot(const nevh_ensemble *e, nevh__arena *a,
                             nevh__snapshot *s, bool state) {
    s->t = numbers(a, e->stride);
    s->h = numbers(a, e->width);
    s->value = numbers(a, e->n_outcomes * e->stride);
    if (!state || !e->looks_back)
        return;
    s->q = numbers(a, e->n * e->width);
    s->p = numbers(a, e->n * e->width);
    s->memory = numbers(a, e->stepper->rows * e->width);
}

static void ensemble_lay_out(nevh__arena *a, void *ensemble) {
    nevh_ensemble *e = ensemble;
    size_t n = e->n, width = e->width, stride = e->stride;
    bool copies = stride != width;
    e->lanes = nevh__arena_take(a, width, sizeof *e->lanes);
    for (size_t i = 0; i < e->n_outcomes; i++)
        e->outcomes[i].records =
            nevh__arena_take(a, width * e->outcomes[i].type->size, 1);
    e->on = nevh__arena_take(a, width, sizeof *e->on);
    e->step = nevh__arena_take(a, width, sizeof *e->step);
    e->q = numbers(a, n * width);
    e->p = numbers(a, n * width);
    e->stop = numbers(a, stride);
    e->v = numbers(a, n * stride);
    e->wide_q = copies ? numbers(a, n * stride) : e->q;
    e->wide_p = copies ? numbers(a, n * stride) : e->p;
    e->run_q = numbers(a, n);
    e->run_memory = numbers(a, e->stepper->rows);
    e->run_p = numbers(a, n);
    e->q1 = numbers(a, n);
    e->p1 = numbers(a, n);
    e->wide_q1 = numbers(a, n * NEVH__LANES);
    e->wide_p1 = numbers(a, n * NEVH__LANES);
    e->v1 = numbers(a, n * NEVH__LANES);
    e->t1 = numbers(a, NEVH__LANES);
    e->value1 = numbers(a, NEVH__LANES);
    e->result = numbers(a, e->columns);
    lay_out_snapshot(e, a, &e->now, false);
    lay_out_snapshot(e, a, &e->ago1, true);
    lay_out_snapshot(e, a, &e->ago2, true);
}

/* GSL aborts where memory is out: ask first for more than it takes. */
static bool plan_root(nevh_ensemble *e) {
    void *trial = nevh__array(64, sizeof(double));
    free(trial);
    e->root = trial ? gsl_root_fsolver_alloc(gsl_root_fsolver_brent) : NULL;
    return e->root;
}

static int plan_rooms(nevh_ensemble *e) {
    e->memory = nevh__arena_new(ensemble_lay_out, e);
    return e->memory && plan_root(e) ? NEVH_OK : nevh__no_memory(&e->report);
}

static int plan_outcomes(nevh_ensemble *e) {
    int status = NEVH_OK;
    for (size_t i = 0; i < e->n_outcomes && !status; i++)
        if (e->outcomes[i].type->plan)
            status = e->outcomes[i].type->plan(e, i, e->options.options);
    return status;
}

static int check_times(nevh_ensemble *e) {
    const nevh_ensemble_options *o = &e->options;
    double steps = (o->t_end - o->t_start) / o->dt;
    if (!(steps >= 0 && steps < 0x1p53))
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "no number of steps of %g leads from %.9g to %.9g",
                          o->dt, o->t_start, o->t_end);
    e->h = o->dt;
    e->whole = nevh__whole_steps(o->t_end - o->t_start, &e->h, &e->steps);
    return NEVH_OK;
}

/* Takes what all plans need; refuses what cannot be run. */
static int take_options(nevh_ensemble *e) {
    if (e->system->report.status)
        return nevh__fail_as(&e->report, &e->system->report);
    if (!e->options.integrator)
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "the integrator is NULL: is its name spelt right?");
    e->n = e->system->n;
    int status = check_times(e);
    return status ? status : take_outcomes(e);
}

static int ensemble_plan(nevh_ensemble *e) {
    static int (*const plans[])(nevh_ensemble *) = {
        plan_steppers,
        plan_energy,
        nevh__ensemble_watch_begin,
        plan_motion,
        plan_rooms,
        plan_outcomes,
        nevh__chaotic_plan,
        nevh__ensemble_plan_crossings};
    nevh_options o =
        e->options.options ? *e->options.options : (nevh_options){0};
    int status = take_options(e);
    if (status)
        return status;
    e->options.options = &o;
    bool autonomous = nevh_system_traits(e->system) & NEVH_AUTONOMOUS;
    o.balance =
        e->has_energy && (!autonomous || nevh_system_friction(e->system, NULL));
    e->width = choose_width(e, &o);
    e->stride = nevh__padded(e->width);
    e->alone = e->width == 1;
    e->together = !autonomous;
    if (!nevh__ensemble_watch_plan(e))
        return nevh__no_memory(&e->report);
    for (size_t i = 0; i < sizeof plans / sizeof *plans && !status; i++)
        status = plans[i](e);
    return status;
}

nevh_ensemble *nevh_ensemble_new(const nevh_system *system,
                                 const nevh_ensemble_options *options) {
    nevh_ensemble *e = system && options ? nevh__array(1, sizeof *e) : NULL;
    if (!e)
        return NULL;
    e->system = system;
    e->options = *options;
    int status = ensemble_plan(e);
    e->planned = !status;
    e->options.options = NULL; /* lives until now */
    e->options.outcomes = NULL;
    if (status != NEVH_ENOMEM)
        return e;
    nevh_ensemble_free(e);
    return NULL;
}

void nevh_ensemble_free(nevh_ensemble *e) {
    if (!e)
        return;
    for (size_t i = 0; e->memory && i < e->n_outcomes * e->width; i++)
        if (e->outcomes[i / e->width].type->clear)
            e->outcomes[i / e->width].type->clear(
                nevh__record_of(e, i / e->width, i % e->width));
    nevh_energy_free(e->energy);
    nevh__chaotic_free(e->chaotic);
    nevh__ensemble_watch_free(e->watch);
    nevh__ensemble_free_crossings(e);
    nevh_field_free(e->motion);
    nevh_stepper_free(e->stepper);
    nevh_stepper_free(e->spare);
    if (e->root)
        gsl_root_fsolver_free(e->root);
    free(e->outcomes);
    free(e->memory);
    free(e);
}

void nevh__ensemble_set_stop(nevh_ensemble *e,
                             const volatile sig_atomic_t *ending) {
    if (e)
        e->ending = ending;
}

NEVH__REPORTS(ensemble)

bool nevh_ensemble_native(const nevh_ensemble *e, const char **why) {
    return nevh_stepper_native(e ? e->stepper : NULL, why);
}

size_t nevh_ensemble_columns(const nevh_ensemble *e) {
    return e ? e->columns : 0;
}

size_t nevh_ensemble_width(const nevh_ensemble *e) {
    return e ? e->width : 0;
}
