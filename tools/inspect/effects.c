/* nevh effects: what each effect reads and costs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "plot/plot.h"
#include "experiment/plan.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* seconds: for one effect, and at most for all */
static const double time_enough = 0.02, time_for_all = 1;
static const double step_given = 1e-3; /* where steps need not be good */

/* An effect with all others off. */
typedef struct {
    bool time, coordinates, momenta;
    double least, most; /* rates of friction; 0 and 0: none */
    double instances;
    double each, gradient; /* seconds an evaluation, and for a gradient; NAN */
} alone;

typedef struct {
    alone alone;
    bool on;
    double values, seconds; /* in the run; the latter an estimate */
} price;

/* The system with that effect alone; NULL when memory is out. */
static const nevh_system *leave_alone(plan *p, size_t effect) {
    const nevh_system *s = p->system;
    for (size_t i = 0; s && i < nevh_system_effect_count(s); i++) {
        char *name = text_print("%s", nevh_system_effect_name(s, i));
        bool failed = nevh_scene_enable(p->scene, name, i == effect);
        s = failed ? NULL : nevh_scene_system(p->scene);
    }
    return s;
}

static void find_rates(const nevh_system *s, size_t n, alone *a) {
    double *rates = tool_allocate(n, sizeof *rates);
    if (nevh_system_friction(s, rates)) {
        a->least = a->most = rates[0];
        for (size_t k = 0; k < n; k++) {
            a->least = fmin(a->least, rates[k]);
            a->most = fmax(a->most, rates[k]);
        }
    }
}

static void find_reads(const nevh_system *s, const plan *p, alone *a) {
    nevh_options o = {.gradient_step = step_given, .q = p->q, .p = p->p};
    nevh_field *field = nevh_field_new(s, &o);
    double value, t = p->run->t_start;
    for (size_t i = 0; i < nevh_field_step_count(field); i++)
        *(nevh_field_step_report(field, i).momentum ? &a->momenta
                                                    : &a->coordinates) = true;
    nevh_counts before = nevh_field_counts(field);
    nevh_field_value(field, 1, &t, p->q, p->p, &value);
    a->instances = (double)(nevh_field_counts(field).values - before.values);
    nevh_field_free(field);
}

/* Gradients at the start, until the clock has seen enough of them. */
static void time_gradients(nevh_field *field, const plan *p, alone *a) {
    double *d = tool_allocate(2 * p->n, sizeof *d), t = p->run->t_start, spent;
    uint64_t before = nevh_field_counts(field).values;
    size_t count = 0;
    int status = 0;
    double effects = (double)nevh_system_effect_count(p->system);
    double start = cpu_seconds(),
           enough = fmin(time_enough, time_for_all / effects);
    do {
        for (int i = 0; !status && i < 16; i++, count++)
            status = nevh_field_gradient(field, 1, &t, p->q, p->p, d, d + p->n);
        spent = cpu_seconds() - start;
    } while (!status && spent < enough);
    double values = (double)(nevh_field_counts(field).values - before);
    a->gradient = status ? NAN : spent / (double)count;
    a->each = status || values == 0 ? NAN : spent / values;
}

static void find_time(const nevh_system *s, const plan *p, alone *a) {
    nevh_options o = plan_options(p, p->gradients.item[0]);
    if (o.gradient_step == 0)
        o.gradient_step = step_given;
    nevh_field *field = nevh_field_new(s, &o);
    a->each = a->gradient = NAN;
    if (a->instances > 0 && !nevh_field_status(field))
        time_gradients(field, p, a);
    nevh_field_free(field);
}

/* Leaves that effect alone switched on. */
static void look_at(plan *p, size_t effect, alone *a) {
    const nevh_system *s = leave_alone(p, effect);
    if (!s)
        return;
    a->time = !(nevh_system_traits(s) & NEVH_AUTONOMOUS);
    find_rates(s, p->n, a);
    find_reads(s, p, a);
    find_time(s, p, a);
    p->system = s;
}

static void look_at_all(plan *p, price prices[], size_t count) {
    for (size_t i = 0; i < count; i++)
        prices[i].on = nevh_system_effect_on(
            p->system, nevh_system_effect_name(p->system, i));
    for (size_t i = 0; i < count; i++)
        look_at(p, i, &prices[i].alone);
    for (size_t i = 0; i < count; i++) {
        char *name = text_print("%s", nevh_system_effect_name(p->system, i));
        nevh_scene_enable(p->scene, name, prices[i].on);
    }
    p->system = nevh_scene_system(p->scene);
}

/* Derivatives that a term brings are no evaluations: then gradients count. */
static double seconds_of(const price *c, double gradients) {
    if (!c->on)
        return 0;
    return c->values > 0 ? c->values * c->alone.each
                         : gradients * c->alone.gradient;
}

static int run(const plan *p, price prices[], size_t count, list *notes) {
    const char *integrator;
    double stopped;
    nevh_stepper *s = plan_first(p, &integrator);
    if (!s)
        return TOOL_USAGE;
    uint64_t before = nevh_stepper_counts(s).gradients;
    int status = plan_run(p, s, p->dt[0], NULL, 0, &stopped);
    double gradients = (double)(nevh_stepper_counts(s).gradients - before);
    for (size_t i = 0; i < count; i++) {
        prices[i].values = (double)nevh_field_effect_values(
            nevh_stepper_field(s), nevh_system_effect_name(p->system, i));
        prices[i].seconds = seconds_of(&prices[i], gradients);
    }
    list_print(notes,
               "evaluations of terms, counted in a run of %s (the first "
               "integrator that fits), dt = %g, gradient %s",
               integrator, p->dt[0], p->gradients.item[0]);
    if (isfinite(stopped))
        list_print(notes, "the run stopped at t = %.9g", stopped);
    list_add(notes, "time: of the gradients of each effect alone, this "
                    "machine's");
    if (status) {
        char *why = plan_why(p, nevh_stepper_message(s));
        list_print(notes, "the run failed: %s", why);
        tool_refuse("%s: the run failed: %s", p->name, why);
    }
    nevh_stepper_free(s);
    return status ? TOOL_FAILED : TOOL_OK;
}

static char *reading(const alone *a) {
    char *text = text_print("%s%s%s", a->time ? "t, " : "",
                            a->coordinates ? "coordinates, " : "",
                            a->momenta ? "momenta, " : "");
    size_t length = strlen(text);
    if (length)
        text[length - 2] = 0;
    if (length || (a->least == 0 && a->most == 0))
        return text;
    return text_print("momenta (friction)");
}

static char *friction(const alone *a) {
    if (a->least == 0 && a->most == 0)
        return NULL;
    return a->least == a->most ? text_print("%g", a->most)
                               : text_print("%g ... %g", a->least, a->most);
}

static void put_share(table *t, double part, double whole) {
    if (part >= 0 && whole > 0)
        table_shown(t, "%.3f", part / whole);
    else
        table_text(t, NULL);
}

static void put_row(table *t, const char *name, const price *c,
                    const price *sum) {
    table_text(t, name);
    table_text(t, c->on ? "on" : "off");
    table_text(t, reading(&c->alone));
    table_text(t, friction(&c->alone));
    table_number(t, c->alone.instances);
    table_number(t, c->values);
    put_share(t, c->values, sum->values);
    if (c->on && isfinite(c->alone.each))
        table_shown(t, "%.3g", 1e9 * c->alone.each);
    else
        table_text(t, NULL);
    put_share(t, c->seconds, sum->seconds);
}

static void fill(const plan *p, const price prices[], size_t count, table *t) {
    price sum = {0};
    table_titles(t, effects_command.columns);
    for (size_t i = 0; i < count; i++) {
        sum.values += prices[i].values;
        if (prices[i].seconds > 0)
            sum.seconds += prices[i].seconds;
    }
    for (size_t i = 0; i < count; i++)
        put_row(t, nevh_system_effect_name(p->system, i), &prices[i], &sum);
}

static int effects_of(const options *o, plan *p) {
    page result = {.table = table_new()};
    size_t count = nevh_system_effect_count(p->system);
    price *prices = tool_allocate(count, sizeof *prices);
    plan_notes(p, &result.before);
    look_at_all(p, prices, count);
    int status = run(p, prices, count, &result.before);
    if (status != TOOL_USAGE) {
        fill(p, prices, count, result.table);
        if (o->quiet && o->format == FORMAT_TABLE)
            result.before = (list){0};
        status = output_page(o, &result, status);
    }
    return status;
}

static int effects(const options *o) {
    plan p;
    if (plot_wanted(o) && !o->impact)
        return tool_refuse("nevh effects draws with --impact --plot %s",
                           o->plot.file ? o->plot.file : "FILE");
    int status = plan_make(&p, o);
    if (!status && o->file)
        status = output_check(o->file);
    if (!status)
        status = o->impact       ? impact(o, &p)
                 : o->observable ? needed(o, &p)
                                 : effects_of(o, &p);
    plan_free(&p);
    return status;
}

const command effects_command = {
    .name = "effects",
    .operand = "SCENE",
    .brief = "the effects, what each reads, changes and costs",
    .help =
        "each effect: on or off, what it reads, evaluations, time; with --impact what it changes; with --needed which of them are called for",
    .examples = "effects elastic-pendulum\n"
                "effects damped-driven-pendulum --t-end 20 --impact",
    .options = "SCENE STEPS TABLE PLOT impact needed error",
    .columns = "effect,state,reads,friction,instances,evaluations,"
               "share,ns each,share of time",
    .run = effects,
};
