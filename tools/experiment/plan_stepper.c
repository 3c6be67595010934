/* nevh: the steppers of a plan, and what they are made with.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plan.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

nevh_options plan_options(const plan *p, const char *gradient) {
    return (nevh_options){.gradient = nevh_gradient_named(gradient),
                          .gradient_step = p->gradient_step,
                          .gradient_steps = p->gradient_steps,
                          .t = p->run->t_start,
                          .q = p->q,
                          .p = p->p,
                          .portable = p->portable,
                          .substeps = p->run->substeps,
                          .native = p->native,
                          .native_cache = p->no_cache ? "" : NULL};
}

/* True if pairs of bodies are all of H. */
static bool are_pairs_all(const plan *p) {
    enum { MOST = 6 }; /* coordinates */
    bool whole = false;
    if (p->n > MOST)
        return false;
    nevh_options o = plan_options(p, p->gradients.item[0]);
    nevh_stepper *s = nevh_stepper_new(p->system, nevh_wisdom_holman, &o);
    nevh_stepper_hierarchy(s, NULL, 0, &whole);
    nevh_stepper_free(s);
    return whole;
}

bool plan_parts_are_all(const plan *p) {
    size_t count = nevh_system_effect_count(p->system), kicks = 0;
    size_t *fast = tool_allocate(2 * count, sizeof *fast);
    bool fits = !nevh_system_effect_parts(p->system, fast, fast + count);
    for (size_t i = 0; i < count; i++)
        kicks += fast[count + i];
    tool_release(fast);
    return (fits && !kicks) || are_pairs_all(p);
}

bool plan_is_exact(const plan *p, const nevh_integrator *scheme) {
    return nevh_integrator_needs(scheme) & NEVH_PARTS && !p->friction &&
           plan_parts_are_all(p);
}

double plan_steps(const plan *p, double h) {
    double steps = fabs((p->t_end - p->run->t_start) / h);
    return isfinite(steps) ? steps : 0;
}

void plan_native_report(const nevh_stepper *s) {
    const char *why;
    int status = nevh_stepper_status(s);
    if ((!status || status == NEVH_STOPPED) && !nevh_stepper_native(s, &why))
        plan_why_report(why);
}

void plan_why_report(const char *why) {
    static uint64_t reported; /* digest of the last */
    uint64_t digest = digest_add(digest_begin(), why, strlen(why));
    if (!*why || digest == reported)
        return;
    fprintf(stderr, "nevh: steps are not compiled: %s\n", why);
    reported = digest;
}

const nevh_system *plan_transform(const plan *p, const char *name) {
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, name, &transformed);
    return transformed || nevh_integrator_own_time(scheme)
               ? nevh_scene_transform(p->scene)
               : NULL;
}

nevh_options plan_scheme_options(const plan *p, const char *name,
                                 const char *gradient,
                                 const nevh_integrator **scheme) {
    nevh_options o = plan_options(p, gradient);
    bool transformed;
    *scheme = plan_scheme(p, name, &transformed);
    o.transform = plan_transform(p, name);
    if (nevh_substeps_named(name))
        o.substeps = nevh_substeps_named(name);
    if (nevh_integrator_adaptive(*scheme) && p->tolerances)
        o.tolerance = p->tolerance[0];
    return o;
}

static nevh_options options_of(const plan *p, const char *name,
                               const nevh_integrator **scheme) {
    nevh_options o = plan_scheme_options(p, name, p->gradients.item[0], scheme);
    o.steps_foreseen = p->dts ? plan_steps(p, p->dt[0]) : 0;
    return o;
}

nevh_stepper *plan_stepper(const plan *p, const char *name) {
    const nevh_integrator *scheme;
    nevh_options o = options_of(p, name, &scheme);
    return nevh_stepper_new(p->system, scheme, &o);
}

nevh_finer *plan_finer(const plan *p, const char *name, nevh_finer_kind kind) {
    const nevh_integrator *scheme;
    nevh_options o = options_of(p, name, &scheme);
    const nevh_finer_question q = {.integrator = scheme,
                                   .options = &o,
                                   .t0 = p->run->t_start,
                                   .dt = p->dt[0],
                                   .steps =
                                       (size_t)fmax(plan_steps(p, p->dt[0]), 1),
                                   .kinds = kind};
    nevh_finer *f = tool_owned(nevh_finer_new(p->system, &q));
    tool_status(nevh_finer_status(f));
    return f;
}

/* The first from there on that fits; NULL: none does. */
static nevh_stepper *fitting(const plan *p, size_t from, const char **name) {
    const list *names = &p->integrators;
    for (size_t i = from; i < names->count; i++) {
        nevh_stepper *s = plan_stepper(p, names->item[i]);
        if (name)
            *name = names->item[i];
        if (!nevh_stepper_status(s))
            return s;
        if (names->count == 1)
            tool_refuse("%s: %s", p->name, nevh_stepper_message(s));
        nevh_stepper_free(s);
    }
    return NULL;
}

nevh_stepper *plan_first(const plan *p, const char **name) {
    nevh_stepper *s = p->added ? fitting(p, p->added, name) : NULL;
    if (!s)
        s = fitting(p, 0, name);
    if (!s && p->integrators.count > 1)
        tool_refuse("%s: none of the integrators fits; see nevh check",
                    p->name);
    return s;
}

bool plan_fits(const plan *p, const char **name) {
    plan idle = *p;
    idle.native = NEVH_NATIVE_NEVER;
    nevh_stepper *s = plan_first(&idle, name);
    bool fits = s != NULL;
    nevh_stepper_free(s);
    return fits;
}

static char *gsl_functions(const plan *p) {
    const char *name;
    list names = {0};
    for (size_t i = 0; (name = nevh_scene_gsl_function(p->scene, i)); i++)
        list_add(&names, name);
    return list_joined(&names);
}

void plan_note_digits(const plan *p, const list *integrators, list *notes) {
    list gsl = {0}, wide = {0}, parts = {0};
    char *functions = gsl_functions(p);
    if (*functions)
        list_add(&gsl, functions);
    for (size_t i = 0; i < integrators->count; i++) {
        bool transformed;
        const char *name = integrators->item[i];
        const nevh_integrator *x = plan_scheme(p, name, &transformed);
        bool finest = false;
        for (size_t k = 0; x == nevh_taylor && k < p->tolerances; k++)
            finest |= p->tolerance[k] < DBL_EPSILON;
        if (strncmp(name, "gsl-", 4) == 0)
            list_add(&gsl, name);
        else if (finest || nevh_integrator_needs(x) & NEVH_PARTS)
            list_add(&wide, name);
    }
    if (gsl.count)
        list_print(&parts, "GSL computes %s", list_joined(&gsl));
    if (wide.count)
        list_print(&parts, "%s %s long double", list_joined(&wide),
                   wide.count > 1 ? "take" : "takes");
    if (text_adopt(nevh_scene_code_path(p->scene, 0)))
        list_add(&parts, "effects in C may call the C library");
    if (parts.count)
        list_print(notes, "Last digits may differ between machines: %s",
                   list_sentence(&parts, "and"));
}

void plan_note_first(const plan *p, const char *integrator, list *notes) {
    list_print(notes, "integrator: %s, dt = %.9g%s", integrator, p->dt[0],
               p->integrators.count > 1 || p->dts > 1
                   ? " (the scene's first that fits)"
                   : "");
    bool transformed;
    if (nevh_integrator_adaptive(plan_scheme(p, integrator, &transformed)) &&
        p->tolerances)
        list_print(notes,
                   "tolerance: %.9g%s; steps are at most dt long and end at "
                   "its multiples",
                   p->tolerance[0],
                   p->tolerances > 1 ? ", the first of the list" : "");
    list_print(notes, "gradient: %s%s", p->gradients.item[0],
               p->gradients.count > 1 ? ", the first of the list" : "");
    list one = {0};
    list_add(&one, integrator);
    plan_note_digits(p, &one, notes);
}
