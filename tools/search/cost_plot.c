/* nevh cost --plot: errors against time, and against evaluations.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include "plot/energy_plot.h"
#include <math.h>

static const double useless = 10; /* as an error */

typedef double work_of(const row *);

static double milliseconds(const row *r) {
    return 1000 * r->seconds;
}
static double values(const row *r) {
    return r->counts.hamiltonians;
}
static double slopes(const row *r) {
    return (double)r->counts.gradients;
}

typedef struct {
    const costs *costs;
    plot *to;
    work_of *work;
    size_t left_out; /* levels */
} drawing;

static double error_of(const study *l, size_t k) {
    return study_error(&l->level[k]);
}

/* True if a shorter step evaluates no more and errs less: steps may be so long that
   solving their equations takes more work than they save.  Times decide nothing: those
   of short runs differ from one to the next. */
static bool is_outdone(const study *l, size_t k) {
    for (size_t i = k + 1; i < l->count; i++)
        if (l->level[i].work > 0 && l->level[i].work <= l->level[k].work &&
            error_of(l, i) <= error_of(l, k))
            return true;
    return false;
}

/* Without a break where there was no time to measure it. */
static bool is_drawn(const drawing *d, const study *l, size_t k) {
    return isfinite(error_of(l, k)) && d->work(&l->level[k]) > 0 &&
           !is_outdone(l, k);
}

static void draw_study(drawing *d, const study *l) {
    bool alone = d->costs->search.plan.gradients.count < 2;
    char *name = alone ? text_print("%s", l->integrator)
                       : text_print("%s, %s", l->integrator, l->gradient);
    size_t series = plot_series(d->to, name);
    plot_integrator(d->to, series, l->integrator);
    plot_style(d->to, series, PLOT_BOTH);
    for (size_t k = 0; k < l->count; k++)
        if (is_drawn(d, l, k))
            plot_point(d->to, series, d->work(&l->level[k]), error_of(l, k));
        else
            d->left_out += isfinite(error_of(l, k)) && is_outdone(l, k);
}

/* Draws a line of the order of a scheme with fixed steps, a factor to the right of
   the middle of its curve. */
static void draw_guide(const drawing *d, const study *l) {
    static const double aside = 1.5, decades = 1.5;
    size_t drawn[2] = {0, 0}, count = 0;
    for (size_t k = 0; k < l->count; k++)
        if (is_drawn(d, l, k) && error_of(l, k) < 1) {
            drawn[0] = count++ ? drawn[0] : k;
            drawn[1] = k;
        }
    if (count < 3)
        return;
    size_t middle = (drawn[0] + drawn[1]) / 2;
    double order = nevh_integrator_order(l->scheme);
    double work = aside * d->work(&l->level[middle]);
    double error = error_of(l, middle);
    size_t series = plot_series(d->to, text_print("order %g", order));
    plot_style(d->to, series, PLOT_GUIDE);
    plot_point(d->to, series, work * pow(10, -decades / order / 2),
               error * pow(10, decades / 2));
    plot_point(d->to, series, work * pow(10, decades / order / 2),
               error * pow(10, -decades / 2));
}

/* For the first scheme of each order up to 4: those of higher ones have few
   steps between useless and rounding. */
static void draw_guides(const drawing *d) {
    static const int highest = 4;
    bool seen[5] = {false};
    for (size_t i = 0; i < d->costs->count; i++) {
        const study *l = &d->costs->study[i];
        int order = nevh_integrator_order(l->scheme);
        if (!cost_draws(d->costs, l) || order > highest || seen[order] ||
            nevh_integrator_adaptive(l->scheme))
            continue;
        seen[order] = true;
        draw_guide(d, l);
    }
}

static void draw_panel(drawing *d) {
    plot_log(d->to, true, true);
    plot_limit_y(d->to, 0, useless);
    for (size_t i = 0; i < d->costs->count; i++)
        if (cost_draws(d->costs, &d->costs->study[i]))
            draw_study(d, &d->costs->study[i]);
}

/* True if all levels shown have such counts: exact gradients evaluate no H, and
   some schemes nothing but H. */
static bool all_have(const costs *c, work_of *count) {
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < c->study[i].count; k++)
            if (cost_draws(c, &c->study[i]) && c->study[i].level[k].ran &&
                !(count(&c->study[i].level[k]) > 0))
                return false;
    return true;
}

static void add_note(const drawing *d) {
    const plan *p = &d->costs->search.plan;
    char *text = text_print(
        "%s%s%s",
        p->by_state ? "errors relative to the range of each variable"
                    : "errors relative to the scale of the energy",
        p->friction && !p->by_state ? "; friction " FRICTION_IS ": --by state"
                                    : "",
        d->left_out ? "; steps that cost no less than shorter ones are left out"
                    : "");
    plot_note_run(d->to, p, NULL, text);
}

static bool draws_any(const costs *c) {
    bool any = false;
    for (size_t i = 0; i < c->count; i++)
        any |= cost_draws(c, &c->study[i]);
    return any;
}

int cost_plot(const options *o, const costs *c) {
    const plan *p = &c->search.plan;
    if (!draws_any(c))
        return tool_refuse("there is nothing to plot: no scheme has an error");
    const char *error =
        p->by_state ? "largest state error, relative" : energy_plot_largest(p);
    bool h = all_have(c, values);
    drawing d = {c, plot_new(p->title, "CPU time (ms)", error), NULL, 0};
    d.work = milliseconds;
    draw_panel(&d);
    plot_panel(d.to,
               h || all_have(c, slopes) ? NULL : "only schemes that take it",
               h ? "evaluations of H" : "evaluations of the gradient", error);
    d.work = h ? values : slopes;
    draw_panel(&d);
    draw_guides(&d);
    add_note(&d);
    return plot_write(d.to, o);
}
