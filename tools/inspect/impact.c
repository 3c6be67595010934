/* nevh effects --impact: what each effect changes in the orbit, what it costs,
   and what it makes impossible.

   Each is switched, and the run repeated by one integrator that fits both ways;
   the others stay as they are.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/trial_run.h"
#include "impact_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The integrators of a list, and a flag each: it fits the system. */
typedef struct {
    size_t count;
    char **name;
    bool *fits;
} choice;

static void add_choice(choice *c, const plan *p, const double scale[],
                       const char *name) {
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(p, name, &transformed);
    nevh_options o = plan_options(p, p->gradients.item[0]);
    o.gradient_step = o.gradient_step > 0 ? o.gradient_step : 1e-3;
    o.binding = 1; /* nothing runs: what planning would find out is spared */
    o.scale = scale;
    o.transform = plan_transform(p, name);
    if (nevh_integrator_needs_tolerance(scheme))
        o.tolerance = 1e-6;
    nevh_stepper *s = nevh_stepper_new(p->system, scheme, &o);
    c->name[c->count] = text_print("%s", name);
    c->fits[c->count++] = !nevh_stepper_status(s);
    nevh_stepper_free(s);
}

static choice choices(const plan *p) {
    size_t most = 0;
    while (plan_scheme_at(p, most))
        most++;
    choice c = {0, tool_allocate(2 * most, sizeof *c.name),
                tool_allocate(2 * most, sizeof *c.fits)};
    double *scale = tool_allocate(2 * p->n, sizeof *scale);
    for (size_t i = 0; i < 2 * p->n; i++)
        scale[i] = 1;
    for (size_t i = 0; i < most; i++) {
        const char *name = nevh_integrator_name(plan_scheme_at(p, i));
        char *transformed = text_print("%s+transform", name);
        add_choice(&c, p, scale, name);
        if (nevh_scene_transform(p->scene))
            add_choice(&c, p, scale, transformed);
    }
    return c;
}

static bool fits(const choice *c, const char *name) {
    for (size_t i = 0; i < c->count; i++)
        if (strcmp(c->name[i], name) == 0)
            return c->fits[i];
    return false;
}

/* The system with some effects on. */
typedef struct {
    choice choice;
    char *structure; /* NULL: nothing is known yet */
    bool time, friction;
    const char *integrator; /* of the trace; NULL: there is none yet */
    trace trace;
} way;

/* Both ways: [0] without the effect, [1] with it. */
typedef struct {
    way way[2];
    const char *integrator; /* NULL: none of the scene's fits both ways */
    bool ran;
} both;

bool impact_switch(plan *p, const char *effect, bool on) {
    if (nevh_scene_enable(p->scene, effect, on))
        return false;
    p->system = nevh_scene_system(p->scene);
    p->friction = nevh_system_friction(p->system, NULL);
    p->time = !(nevh_system_traits(p->system) & NEVH_AUTONOMOUS);
    p->balance = p->friction || p->time;
    nevh_timing_free(p->timing);
    nevh_timing_free(p->jumps);
    p->timing = p->jumps = NULL;
    plan_look_at_time(p);
    return true;
}

static void draw(plot **to, plan *p, const char *effect, const both *b) {
    trace dense[2];
    difference d = trace_difference(&b->way[0].trace, &b->way[1].trace);
    for (int on = 0; on < 2; on++) {
        impact_switch(p, effect, on);
        dense[on] = trace_dense(p, b->integrator);
    }
    impact_draw(to, p, effect, dense, &d);
}

static void look_at(const plan *p, way *w) {
    w->choice = choices(p);
    w->structure = plan_structure(p);
    w->time = p->time;
    w->friction = p->friction;
}

/* as_it_is: the way that one of both is, since effects other than this one stay;
   what is found out of it is of use to the next effect. */
static bool look(plan *p, const char *effect, way *as_it_is, both *b) {
    way *same = &b->way[nevh_system_effect_on(p->system, effect)];
    *same = *as_it_is;
    for (int on = 0; on < 2; on++) {
        if (!impact_switch(p, effect, on))
            return false;
        if (!b->way[on].structure)
            look_at(p, &b->way[on]);
    }
    for (size_t i = 0; !b->integrator && i < p->integrators.count; i++)
        if (fits(&b->way[0].choice, p->integrators.item[i]) &&
            fits(&b->way[1].choice, p->integrators.item[i]))
            b->integrator = p->integrators.item[i];
    b->ran = b->integrator;
    for (int on = 0; b->integrator && on < 2; on++) {
        way *w = &b->way[on];
        impact_switch(p, effect, on);
        if (w->integrator != b->integrator)
            w->trace = trace_run(p, b->integrator);
        w->integrator = b->integrator;
        b->ran &= !w->trace.status;
    }
    *as_it_is = *same;
    return true;
}

/* Any of n variables from `first` on. */
static bool moves(const trace *o, size_t first) {
    for (size_t k = first; k < first + o->plan->n; k++)
        if (o->high[k] > o->low[k])
            return true;
    return false;
}

/* Without it there is no orbit to compare with, such as kinetic energy: though
   momenta change, coordinates do not. */
static bool is_essential(const both *b) {
    const trace *a = &b->way[0].trace;
    return b->ran && moves(&b->way[1].trace, 0) && !moves(a, 0) &&
           moves(a, a->plan->n);
}

static bool rests(const trace *o) {
    return !moves(o, 0) && !moves(o, o->plan->n);
}

/* Schemes that fit without, but not with it. */
static list ruled_out(const both *b) {
    list names = {0};
    for (size_t i = 0; i < b->way[0].choice.count; i++)
        if (b->way[0].choice.fits[i] && !b->way[1].choice.fits[i])
            list_add(&names, b->way[0].choice.name[i]);
    return names;
}

static void end_words(const char *effect, bool on, const trace *o,
                      list *words) {
    const char *with = on ? "With" : "Without";
    if (o->status)
        list_print(words, "%s %s the run fails: %s", with, effect, o->message);
    else if (isfinite(o->stopped))
        list_print(words, "%s %s the run stops at t = %.9g.", with, effect,
                   o->stopped);
}

static void effect_words(const char *effect, const both *b, const char *names,
                         size_t count, list *words) {
    if (count)
        list_print(words, "%s rules out %zu integrator%s: %s.", effect, count,
                   count > 1 ? "s" : "", names);
    if (strcmp(b->way[0].structure, b->way[1].structure) != 0)
        list_print(words, "With %s %s; without it %s.", effect,
                   b->way[1].structure, b->way[0].structure);
    if (b->way[1].time && !b->way[0].time)
        list_print(words,
                   "With %s H depends on time: its energy is not conserved, "
                   "and errors are those of the energy balance.",
                   effect);
    if (b->way[1].friction && !b->way[0].friction)
        list_print(words,
                   "%s is friction: steps of geometric schemes are split "
                   "around it, which is of order 2 at most.",
                   effect);
    if (!b->integrator)
        list_print(words,
                   "%s: none of the scene's integrators fits with and without "
                   "it; give others with --integrators.",
                   effect);
    for (int on = 0; b->integrator && on < 2; on++)
        end_words(effect, on, &b->way[on].trace, words);
    if (is_essential(b))
        list_print(words,
                   "Without %s no coordinate moves: there is no orbit to "
                   "compare with.",
                   effect);
    else if (b->ran && rests(&b->way[0].trace) && !rests(&b->way[1].trace))
        list_print(words, "Without %s nothing moves.", effect);
}

/* All digits, but for what is to be read. */
static void put(const options *o, table *t, bool known, const char *format,
                double x) {
    if (!known || !isfinite(x))
        table_text(t, NULL);
    else if (o->format == FORMAT_TABLE)
        table_shown(t, format, x);
    else
        table_number(t, x);
}

/* Returns whether the orbits were as far apart as they can be. */
static bool put_row(const options *o, const char *effect, bool on,
                    const both *b, double scale, page *result) {
    static const double far_apart = 0.5;
    table *t = result->table;
    const trace *a = &b->way[0].trace, *c = &b->way[1].trace;
    const bool shown = o->format == FORMAT_TABLE;
    difference d = {0};
    list out = ruled_out(b);
    size_t count = out.count;
    char *names = list_joined(&out);
    if (b->ran)
        d = trace_difference(a, c);
    table_text(t, effect);
    table_text(t, on ? "on" : "off");
    table_text(t, b->integrator);
    bool compared = b->ran && !(shown && is_essential(b));
    put(o, t, compared, "%.1e", d.at_end);
    put(o, t, compared, "%.1e", d.largest);
    put(o, t, compared, "%.4g", d.since);
    put(o, t, compared, "%+.1e", (c->energy - a->energy) / scale);
    put(o, t, b->ran && a->work > 0, "%.2f", c->work / a->work);
    put(o, t, b->ran && a->seconds > 0, "%.2f", c->seconds / a->seconds);
    if (shown)
        table_number(t, (double)count);
    else
        table_text(t, names);
    effect_words(effect, b, names, count, &result->after);
    return compared && d.largest > far_apart && !rests(a) && !rests(c);
}

/* Differences that chaos makes, of effects of any size. */
static void chaos_words(const plan *p, list *words) {
    trial_run found = trial_run_new(p, true);
    if (found.chaos.report.verdict == NEVH_CHAOTIC)
        list_print(words,
                   "The orbit is chaotic: a difference grows by a factor e in "
                   "%.3g%s, until orbits are unrelated.  Compare the times of "
                   "1 %%, not the final differences, which only show that.",
                   1 / found.chaos.exponent, p->unit);
}

/* Tells what the step alone does to the orbit, where both runs end at one time. */
static void step_words(plan *p, const char *integrator, list *words) {
    enum { FEW = 2 };
    static const double nothing = 1e-6;
    const double *dt = p->dt, shorter = dt[0] / 2;
    trace whole = trace_sampled(p, integrator, FEW);
    p->dt = &shorter;
    trace half = trace_sampled(p, integrator, FEW);
    p->dt = dt;
    if (fabs(whole.t - half.t) <= nothing * shorter)
        half.t = whole.t;
    difference d = trace_difference(&whole, &half);
    if (!whole.status && !half.status && d.at_end > nothing)
        list_print(words,
                   "%s at dt = %g: half the step changes the state at the end "
                   "by %.1e.  A difference that is no larger may be the "
                   "step's.",
                   integrator, dt[0], d.at_end);
}

/* returns  TOOL_FAILED where no effect could be compared, since runs failed */
static int add_all(const options *o, plan *p, page *result, plot **to) {
    size_t count = nevh_system_effect_count(p->system);
    double scale = plan_energy_scale(p);
    bool apart = false, ran = false;
    const char *used = NULL;
    char *why = NULL;
    way as_it_is = {0};
    for (size_t i = 0; i < count; i++) {
        char *effect = text_print("%s", nevh_system_effect_name(p->system, i));
        bool on = nevh_system_effect_on(p->system, effect);
        both b = {0};
        if (look(p, effect, &as_it_is, &b))
            apart |= put_row(o, effect, on, &b, scale, result);
        else
            list_print(&result->after, "%s cannot be switched on: %s", effect,
                       nevh_scene_message(p->scene));
        if (plot_wanted(o) && b.ran)
            draw(to, p, effect, &b);
        ran |= b.ran;
        used = b.ran ? b.integrator : used;
        if (b.integrator && !b.ran && !why)
            why = text_print("%s", b.way[!b.way[0].trace.status].trace.message);
        impact_switch(p, effect, on);
    }
    if (apart)
        chaos_words(p, &result->after);
    if (used)
        step_words(p, used, &result->after);
    bool failed = why && !ran;
    if (failed)
        tool_refuse("%s: no effect can be compared: the run fails: %s", p->name,
                    why);
    return failed ? TOOL_FAILED : TOOL_OK;
}

static int write_plot(const options *o, plot *to) {
    if (!plot_wanted(o))
        return TOOL_OK;
    return to ? plot_write(to, o)
              : tool_refuse("there is nothing to plot: no effect has runs with "
                            "and without it");
}

int impact(const options *o, plan *p) {
    page result = {.table = table_new()};
    plot *to = NULL;
    if (plot_check(o))
        return TOOL_USAGE;
    plan_notes(p, &result.before);
    list_print(&result.before,
               "each row: the run with all effects that are on compared with "
               "the run without this one (of an effect that is off: with it); "
               "dt = %g",
               p->dt[0]);
    list_add(&result.before,
             "differences of the state are divided by the range of each "
             "variable, those of the energy by energy_scale");
    table_titles(result.table,
                 "effect,state,integrator,difference\nat the end,"
                 "largest\ndifference,1 %\nat t =,energy\nat the end,"
                 "work\nratio,time\nratio,rules\nout");
    int status = add_all(o, p, &result, &to);
    if (!o->quiet)
        list_add(
            &result.after,
            "difference: of the states, with the effect and without it. 1 %: "
            "when they first differ by that much, at the times compared. energy: "
            "H at the end of the run with the effect, less that without it. "
            "work ratio, time ratio: evaluations of H and CPU time of "
            "the run with the effect, over those without it. rules out: "
            "integrators that fit only without it.");
    if (o->quiet && o->format == FORMAT_TABLE)
        result.before = (list){0};
    bool first = plot_goes_first(o);
    int drawn = first ? write_plot(o, to) : TOOL_OK;
    status = output_page(o, &result, status);
    if (!first)
        drawn = write_plot(o, to);
    return drawn ? TOOL_USAGE : status;
}
