/* nevh: what is to be run, from options, scene and defaults.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plan.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const nevh_integrator *plan_scheme_at(const plan *p, size_t i) {
    size_t own = 0;
    while (nevh_scene_integrator(p->scene, own) && own <= i)
        own++;
    return i < own ? nevh_scene_integrator(p->scene, i)
                   : nevh_integrators()[i - own];
}

const nevh_integrator *plan_scheme(const plan *p, const char *name,
                                   bool *transformed) {
    const char *plus = strchr(name, '+');
    *transformed = plus && strcmp(plus, "+transform") == 0;
    if (plus && !*transformed && !nevh_substeps_named(name))
        return NULL;
    char *own = text_print("%.*s", (int)strcspn(name, "+"), name);
    const nevh_integrator *scheme = nevh_scene_integrator_named(p->scene, own);
    tool_release(own);
    return scheme;
}

static void take_names(list *l, const list *given, const char *const scene[],
                       size_t count) {
    for (size_t i = 0; i < given->count; i++)
        list_add(l, given->item[i]);
    for (size_t i = 0; given->count == 0 && i < count; i++)
        list_add(l, scene[i]);
}

static void default_integrators(plan *p) {
    nevh_separability found = {0};
    if (!(nevh_system_traits(p->system) & NEVH_SEPARABLE))
        nevh_system_probe(p->system, p->run->t_start, p->q, p->p, NULL, &found);
    else
        found.separable = true;
    if (found.separable)
        list_add(&p->integrators, "verlet");
    list_split(&p->integrators, "midpoint,gauss4,rk4");
}

/* A transform that is given is used: by those that fit, beside themselves. */
static void add_transformed(plan *p, const options *o) {
    size_t count = p->integrators.count;
    bool used = !o->transform;
    p->added = used ? 0 : count;
    for (size_t i = 0; i < count; i++) {
        const nevh_integrator *scheme =
            nevh_scene_integrator_named(p->scene, p->integrators.item[i]);
        used = used || strchr(p->integrators.item[i], '+') ||
               (scheme && nevh_integrator_own_time(scheme));
    }
    for (size_t i = 0; !used && i < count; i++) {
        const char *name = p->integrators.item[i];
        const nevh_integrator *scheme =
            nevh_scene_integrator_named(p->scene, name);
        if (scheme && nevh_integrator_needs(scheme) == 0 &&
            nevh_integrator_symplectic(scheme) == NEVH_YES)
            list_print(&p->integrators, "%s+transform", name);
    }
}

static int check_integrators(const plan *p) {
    list names = {0};
    int status = TOOL_OK;
    for (size_t i = 0; plan_scheme_at(p, i); i++)
        list_add(&names, nevh_integrator_name(plan_scheme_at(p, i)));
    for (size_t i = 0; !status && i < p->integrators.count; i++) {
        bool transformed;
        const char *name = p->integrators.item[i];
        if (!plan_scheme(p, name, &transformed))
            status = tool_unknown("integrator", name, &names);
        else if (transformed && !nevh_scene_transform(p->scene))
            status = tool_refuse("%s: the scene has no transform", name);
    }
    return status;
}

static int check_gradients(const plan *p) {
    list names = {0};
    int status = TOOL_OK;
    for (size_t i = 0; nevh_gradients()[i]; i++)
        list_add(&names, nevh_gradient_name(nevh_gradients()[i]));
    for (size_t i = 0; !status && i < p->gradients.count; i++)
        if (!nevh_gradient_named(p->gradients.item[i]))
            status = tool_unknown("gradient", p->gradients.item[i], &names);
    return status;
}

/* The time between two numbers is counted in steps by a double. */
static int check_steps(const plan *p) {
    double span = p->t_end - p->run->t_start;
    for (size_t i = 0; i < p->dts; i++) {
        if (p->dt[i] > span * (1 + 1e-9))
            return tool_refuse("%s: dt = %g is longer than the run, from t = "
                               "%g to %g",
                               p->name, p->dt[i], p->run->t_start, p->t_end);
        if (!(span / p->dt[i] <= 0x1p53))
            return tool_refuse("%s: dt = %g makes more steps than can be "
                               "counted",
                               p->name, p->dt[i]);
    }
    return TOOL_OK;
}

static int check_times(const plan *p, const options *o) {
    if (p->dts == 0 && !o->no_steps)
        return tool_refuse("%s: no time step: give dt in [run], or --dt",
                           p->name);
    if (isnan(p->t_end))
        return tool_refuse("%s: no end: give t_end in [run], or --t-end",
                           p->name);
    if (p->t_end == p->run->t_start)
        return tool_refuse("%s: the run ends at its start, t = %g; give "
                           "t_end in [run], or --t-end",
                           p->name, p->t_end);
    if (p->t_end < p->run->t_start)
        return tool_refuse("%s: the run ends at t = %g, before it begins at "
                           "t = %g",
                           p->name, p->t_end, p->run->t_start);
    return o->no_steps ? TOOL_OK : check_steps(p);
}

static int start(plan *p, const options *o) {
    p->n = nevh_scene_dof(p->scene);
    p->q = tool_allocate(p->n, sizeof *p->q);
    p->p = tool_allocate(p->n, sizeof *p->p);
    if (!nevh_scene_start(p->scene, p->q, p->p))
        return TOOL_OK;
    return scene_report(p->scene, o);
}

static void take_lists(plan *p, const options *o) {
    take_names(&p->gradients, &o->gradients, p->run->gradient,
               p->run->gradients);
    if (p->gradients.count == 0)
        list_add(&p->gradients, "central4");
    take_names(&p->integrators, &o->integrators, p->run->integrator,
               p->run->integrators);
    if (p->integrators.count == 0)
        default_integrators(p);
    add_transformed(p, o);
    p->dt = o->dt.count ? p->given_dt : p->run->dt;
    p->dts = o->dt.count ? o->dt.count : p->run->dts;
    p->tolerance = o->tolerances ? o->tolerance : p->run->tolerance;
    p->tolerances = o->tolerances ? o->tolerances : p->run->tolerances;
}

static char *unit_after(const plan *p, const char *mark, const char *name) {
    const char *unit = nevh_scene_label(p->scene, name);
    return text_print("%s%s", *unit ? mark : "", unit);
}

static void take_settings(plan *p, const options *o) {
    p->system = nevh_scene_system(p->scene);
    p->run = nevh_scene_run_settings(p->scene);
    p->t_end = p->run->t_end;
    p->gradient_step =
        o->gradient_step > 0 ? o->gradient_step : p->run->gradient_step;
    p->gradient_steps = o->gradient_step > 0 ? NULL : p->run->gradient_steps;
    p->portable = o->portable;
    p->native = option_given(o, "native") ? o->native.use : p->run->native;
    p->no_cache = o->native.no_cache;
    p->repeats = o->search.repeats;
    p->diagnostics = o->diagnostics;
    p->match_work = o->match == MATCH_WORK ||
                    (o->match == MATCH_SCENE && p->run->match_work);
    p->friction = nevh_system_friction(p->system, NULL);
    p->time = !(nevh_system_traits(p->system) & NEVH_AUTONOMOUS);
    p->balance = p->friction || p->time;
    p->unit = unit_after(p, " ", "t");
    p->per_unit = unit_after(p, "/", "t");
    p->energy_unit = unit_after(p, " ", "energy");
}

/* The formulas of an option. */
static int take_numbers(plan *p, const options *o, const list *formulas,
                        double **numbers) {
    *numbers = tool_allocate(formulas->count, sizeof **numbers);
    for (size_t i = 0; i < formulas->count; i++)
        if (scene_number(p->scene, o, formulas->item[i], &(*numbers)[i]))
            return TOOL_USAGE;
    return TOOL_OK;
}

/* Within the run, so that a time is not taken for another. */
static int check_at(const plan *p, const options *o) {
    for (size_t i = 0; i < p->ats; i++)
        if (!(p->at[i] >= p->run->t_start && p->at[i] <= p->t_end))
            return tool_refuse("--at %s: the run is from t = %g to %g",
                               o->at.item[i], p->run->t_start, p->t_end);
    return TOOL_OK;
}

static int take_times(plan *p, const options *o) {
    if (take_numbers(p, o, &o->dt, &p->given_dt) ||
        take_numbers(p, o, &o->at, &p->at))
        return TOOL_USAGE;
    p->ats = o->at.count;
    for (size_t i = 0; i < o->dt.count; i++)
        if (!(p->given_dt[i] > 0))
            return tool_refuse("--dt takes numbers above 0, not %s",
                               o->dt.item[i]);
    return o->t_end ? scene_number(p->scene, o, o->t_end, &p->t_end) : TOOL_OK;
}

const char plan_kinks_text[] =
    "not resolved: the force jumps where the orbit goes, and the growth of "
    "displacements misses what that adds; a short smooth bend, such as sqrt(x^2 "
    "+ 1e-4) for abs(x), has an exponent.";

/* The words of a setting in the title. */
static char *change_of(const char *setting) {
    enum { MOST = 32 };
    const char *text = setting + 1;
    if (*setting == '+' || *setting == '-')
        return text_print("%s %s", *setting == '+' ? "with" : "without", text);
    if (strlen(text) <= MOST)
        return text_print("%s", text);
    return text_print("%.*s changed", (int)strcspn(text, " =["), text);
}

char *plan_title(const nevh_scene *scene, const char *name, const options *o) {
    const char *own = nevh_scene_title(scene);
    char *title = text_print("%s", *own ? own : name);
    size_t changes = 0;
    for (size_t i = 0; i < o->settings.count; i++)
        text_extend(&title, "%s%s", changes++ ? ", " : ", but ",
                    change_of(o->settings.item[i]));
    for (size_t i = 0; i < o->vary.count; i++) {
        const char *text = o->vary.item[i];
        bool one = text[strcspn(text, ",(:")] == '\0';
        if (strchr(text, '=') && one)
            text_extend(&title, "%s%s", changes++ ? ", " : ", but ", text);
        else if (strchr(text, '='))
            text_extend(&title, "%s%.*s varied", changes++ ? ", " : ", but ",
                        (int)strcspn(text, " =["), text);
    }
    return title;
}

/* It takes an orbit to find: of many effects as long as a row does. */
struct start_scale {
    char *of; /* what it depends on; NULL: none was found yet */
    double *start;
    double scale;
    bool known;
};

int plan_make(plan *p, const options *o) {
    *p = (plan){.name = o->operands.count > 1 ? o->operands.item[1] : "",
                .ends = NAN,
                .steppers = stepper_cache_new(),
                .start_scale = tool_allocate(1, sizeof(start_scale))};
    if (scene_open(&p->scene, o))
        return TOOL_USAGE;
    take_settings(p, o);
    if (take_times(p, o))
        return TOOL_USAGE;
    p->title = plan_title(p->scene, p->name, o);
    if (start(p, o))
        return TOOL_USAGE;
    take_lists(p, o);
    if (check_integrators(p) || check_gradients(p))
        return TOOL_USAGE;
    for (size_t i = 0; o->no_steps && i < p->ats; i++)
        p->t_end = i ? fmax(p->t_end, p->at[i]) : p->at[i];
    if (check_times(p, o) || check_at(p, o))
        return TOOL_USAGE;
    plan_look_at_time(p);
    return TOOL_OK;
}

void plan_free(plan *p) {
    nevh_timing_free(p->timing);
    nevh_timing_free(p->jumps);
    plan_forget_reference(p);
    energies_free(p->energies);
    stepper_cache_free(p->steppers);
    nevh_scene_free(p->scene);
}

nevh_field *plan_values(const plan *p) {
    /* With a step for differences, which are not taken, none is looked for. */
    const nevh_options o = {.gradient_step = 1e-3, .portable = p->portable};
    return nevh_field_new(p->system, &o);
}

double plan_longest_dt(const plan *p) {
    double longest = 0;
    for (size_t i = 0; i < p->dts; i++)
        longest = fmax(longest, p->dt[i]);
    return longest;
}

double plan_shortest_dt(const plan *p) {
    double shortest = p->dts ? p->dt[0] : 0;
    for (size_t i = 1; i < p->dts; i++)
        shortest = fmin(shortest, p->dt[i]);
    return shortest;
}

double *plan_state(const plan *p) {
    double *state = tool_allocate(2 * p->n, sizeof *state);
    memcpy(state, p->q, p->n * sizeof *state);
    memcpy(state + p->n, p->p, p->n * sizeof *state);
    return state;
}

double plan_period(const plan *p, const char *shown) {
    for (size_t k = 0; k < p->n; k++)
        if (strcmp(nevh_scene_coordinate(p->scene, k), shown) == 0)
            return nevh_scene_period(p->scene, k);
    return 0;
}

/* The largest energy of an effect until the scene's `stop` ends the run of the first
   scheme that fits; INFINITY: not in its first 100 000 steps. */
static double largest_until_stop(const plan *whole) {
    static const double most = 1e5;
    const nevh_options as = {.portable = whole->portable};
    if (!nevh_scene_stops(whole->scene) || !whole->dts)
        return INFINITY;
    plan begin = *whole, *p = &begin;
    double span = p->t_end - p->run->t_start;
    p->t_end = p->run->t_start +
               copysign(fmin(fabs(span), most * fabs(p->dt[0])), span);
    nevh_stepper *s = plan_first(p, NULL);
    nevh_energy *e = nevh_energy_new(p->system, &as);
    nevh_observer watch = {nevh_energy_observe, e, 1};
    double stopped = NAN;
    if (s)
        plan_run(p, s, p->dt[0], &watch, 1, &stopped);
    nevh_energy_report run = nevh_energy_result(e, 0);
    nevh_energy_free(e);
    nevh_stepper_free(s);
    return isfinite(stopped) ? run.met * run.scale : INFINITY;
}

static char *effects_that_are(const nevh_system *s, bool on) {
    list names = {0};
    for (size_t i = 0; i < nevh_system_effect_count(s); i++) {
        const char *name = nevh_system_effect_name(s, i);
        if (nevh_system_effect_on(s, name) == on)
            list_add(&names, name);
    }
    return list_joined(&names);
}

/* The energy scale after one observation, which may leave it unknown.  It may be that
   of a motion that outlasts the run, but not of one that goes on beyond its `stop`. */
static double find_scale(const plan *p, bool *known) {
    const nevh_options as = {.portable = p->portable};
    nevh_energy *e = nevh_energy_new(p->system, &as);
    nevh_energy_observe(e, 0, p->run->t_start, p->q, p->p);
    nevh_energy_report start = nevh_energy_result(e, 0);
    nevh_energy_free(e);
    *known = start.scale > 0 && (start.scale != 1 || start.met > 0);
    double scale = start.scale, own = fabs(start.initial);
    return scale > own * (1 + 1e-9) && own > 0
               ? fmin(scale, fmax(own, largest_until_stop(p)))
               : scale;
}

/* The scale depends on these, and on the state. */
static char *scale_key(const plan *p) {
    return text_print("%p %d %a %a %a %s %s", (const void *)p->system,
                      (int)p->portable, p->run->t_start, p->t_end,
                      p->dts ? p->dt[0] : 0, list_joined(&p->integrators),
                      effects_that_are(p->system, true));
}

/* The same, found once for all rows of a plan. */
static double scale_of_start(const plan *p, bool *known) {
    start_scale *last = p->start_scale;
    double *start = plan_state(p);
    char *of = scale_key(p);
    bool found = last->of && strcmp(last->of, of) == 0 &&
                 memcmp(last->start, start, 2 * p->n * sizeof *start) == 0;
    if (!found) {
        double scale = find_scale(p, known);
        *last = (start_scale){of, start, scale, *known};
    }
    *known = last->known;
    return last->scale;
}

double plan_energy_scale(const plan *p) {
    bool known;
    return p->run->energy_scale > 0 ? p->run->energy_scale
                                    : scale_of_start(p, &known);
}

void plan_set_scale(const plan *p, nevh_energy *energy) {
    bool known = true;
    double scale = p->run->energy_scale > 0 ? p->run->energy_scale
                                            : scale_of_start(p, &known);
    if (known)
        nevh_energy_set_scale(energy, scale);
}

char *plan_structure(const plan *p) {
    nevh_separability found = {0};
    const char *t = p->time ? "t, " : "";
    if (nevh_system_traits(p->system) & NEVH_SEPARABLE)
        return text_print("H = T(p) + V(%sq)", t);
    if (nevh_system_probe(p->system, p->run->t_start, p->q, p->p, NULL, &found))
        return text_print("H(%sq, p), of unknown structure", t);
    if (found.separable)
        return text_print("H = T(p) + V(%sq), according to its values", t);
    return text_print("H(%sq, p) is not separable: %s mixes coordinates and "
                      "momenta",
                      t, found.term);
}

static void note_effects(const plan *p, list *notes) {
    char *on = effects_that_are(p->system, true);
    char *off = effects_that_are(p->system, false);
    list_print(notes,
               *off ? "effects on: %s    off: %s (never evaluated)"
                    : "effects on: %s",
               on, off);
}

void plan_notes(const plan *p, list *notes) {
    char *structure = plan_structure(p);
    list_add(notes, p->title);
    note_effects(p, notes);
    list_add(notes, structure);
    list_print(notes,
               nevh_scene_stops(p->scene) ? "t = %g ... %g%s, or until %s"
                                          : "t = %g ... %g%s",
               p->run->t_start, p->t_end, p->unit,
               nevh_scene_stop_text(p->scene));
}
