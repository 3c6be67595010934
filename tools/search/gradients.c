/* nevh gradients: errors and costs of gradient methods and steps along the
   orbit, and their part in the energy error.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "experiment/trial_run.h"
#include "gradients_private.h"
#include "plot/plot.h"
#include <math.h>
#include <string.h>

static void add_numbers(const finding *g, table *t, bool for_people) {
    bool chosen = g->step == 0 && strncmp(g->gradient, "central", 7) == 0;
    const struct {
        const char *format;
        double number;
    } cell[] = {{"%.1e", g->error},
                {"%.1e", chosen ? g->truncation : NAN},
                {"%.1e", chosen ? g->rounding : NAN},
                {"%.1f", g->evaluations},
                {"%.0f", g->nanoseconds},
                {"%.1e", g->energy},
                {"%.1e", g->influx},
                {"%.1e", g->floor}};
    for (size_t i = 0; i < sizeof cell / sizeof *cell; i++)
        if (for_people && isfinite(cell[i].number))
            table_shown(t, cell[i].format, cell[i].number);
        else
            table_number(t, cell[i].number);
}

static void add_finding(page *result, const finding *g, bool for_people) {
    table *t = result->table;
    if (!g->good && g->step > 0)
        list_print(&result->after, "%s, half-spread %.2g: %s", g->gradient,
                   g->step, g->why);
    else if (!g->good)
        list_print(&result->after, "%s: %s", g->gradient, g->why);
    if (!g->good)
        return;
    table_text(t, g->gradient);
    if (g->step > 0 && for_people)
        table_shown(t, "%.2g", g->step);
    else if (g->step > 0)
        table_number(t, g->step);
    else
        table_text(t, strncmp(g->gradient, "central", 7) ? NULL : "auto");
    add_numbers(g, t, for_people);
}

enum { DECADES = 2, MOST = 1 + 2 * DECADES + 1 };

typedef struct {
    finding *item;
    size_t count;
} findings;

/* With the step that it chooses, and with steps around it. */
static void find_method(const gradients_job *c, findings *f,
                        const char *gradient) {
    finding *g = &f->item[f->count++];
    *g = gradient_find(c, gradient, c->plan->gradient_step);
    g->first = true;
    if (!g->good || strncmp(gradient, "central", 7) ||
        c->plan->gradient_step > 0)
        return;
    double middle = pow(10, round(log10(gradient_own_step(c, gradient))));
    for (int k = DECADES; isfinite(middle) && k >= -DECADES; k--)
        f->item[f->count++] = gradient_find(c, gradient, middle * pow(10, k));
}

static bool is_wanted(const options *o, const char *gradient) {
    return o->gradients.count == 0 || list_has(&o->gradients, gradient);
}

static findings find_all(const gradients_job *c, const options *o) {
    size_t methods = 0;
    while (nevh_gradients()[methods])
        methods++;
    findings f = {tool_allocate(methods * MOST, sizeof *f.item), 0};
    for (size_t i = 0; i < methods; i++)
        if (is_wanted(o, nevh_gradient_name(nevh_gradients()[i])))
            find_method(c, &f, nevh_gradient_name(nevh_gradients()[i]));
    gradients_influx(c, f.item, f.count);
    return f;
}

static void add_all(page *result, findings *f, bool for_people) {
    for (size_t i = 0; i < f->count; i++) {
        if (f->item[i].first)
            table_group(result->table);
        add_finding(result, &f->item[i], for_people);
        nevh_field_free(f->item[i].field);
    }
}

static table *new_table(bool for_people) {
    table *t = table_new();
    if (for_people)
        table_titles(t, "gradient,half-\nspread,largest\nerror,"
                        "trunca-\ntion,round-\ning,H\nevals,\nns,"
                        "energy\nerror,from the\ngradient,from\nrounding");
    else
        table_titles(t, gradients_command.columns);
    return t;
}

static void orbit_notes(const gradients_job *c, page *result) {
    list_print(&result->before,
               "orbit of %s at dt = %.4g, %zu steps, t = %g ... %g; errors of "
               "the gradient at %zu states, relative to its largest component",
               c->integrator, c->dt, c->steps, c->plan->run->t_start,
               c->plan->run->t_start + (double)c->steps * c->dt,
               c->exact.count);
    smoothness_notes(c->plan, &result->before);
    list_print(
        &result->after,
        "truncation, rounding: errors expected when the half-spread was "
        "chosen. energy error: of the orbit with that gradient. from the "
        "gradient: the energy error caused by the gradient alone, along the "
        "orbit of the %s one; from rounding: the unavoidable rounding part of "
        "this, which grows with the root of the time.",
        c->yardstick);
    double own = 0;
    for (size_t i = 0; i < c->exact.count; i++)
        own = fmax(own, fabs(c->exact.h[i] - c->exact.h[0]) / c->scale);
    if (!c->plan->balance && own == 0)
        list_print(&result->after,
                   "%s itself keeps the energy exactly on this orbit.",
                   c->integrator);
    else if (!c->plan->balance)
        list_print(&result->after,
                   "%s itself makes an energy error of %.1e at this dt: %s",
                   c->integrator, own,
                   own > 1 ? "that is more than the energy: take a smaller "
                             "step before you compare gradients."
                           : "a gradient whose part is well below that is "
                             "good enough.");
    list_add(&result->after, "Times were measured on this machine.");
}

static int gradients_plan(const options *o, const plan *p) {
    gradients_job c = {0};
    page result = {0};
    bool for_people = o->format == FORMAT_TABLE;
    int status = plot_check(o) ? TOOL_USAGE : gradients_job_make(&c, p),
        drawn = TOOL_OK;
    bool first = plot_goes_first(o);
    if (!status && first)
        drawn = gradients_plot(o, &c);
    if (!status) {
        result.table = new_table(for_people);
        findings f = find_all(&c, o);
        add_all(&result, &f, for_people);
        if (!o->quiet || !for_people) {
            plan_notes(p, &result.before);
            orbit_notes(&c, &result);
        }
        status = output_page(o, &result, TOOL_OK);
        if (plot_wanted(o) && !first)
            drawn = gradients_plot(o, &c);
    }
    nevh_field_free(c.exact.field);
    return drawn ? TOOL_USAGE : status;
}

static int gradients(const options *o) {
    plan p;
    int status = plan_make(&p, o);
    if (!status && o->file)
        status = output_check(o->file);
    if (!status)
        status = gradients_plan(o, &p);
    plan_free(&p);
    return status;
}

const command gradients_command = {
    .name = "gradients",
    .operand = "SCENE",
    .brief = "error and cost of the gradient methods",
    .help = "error and cost of each gradient method and step along the orbit",
    .examples = "gradients pendulum\n"
                "gradients pendulum --t-end 10 --plot gradients.svg",
    .options = "SCENE STEPS NATIVE TABLE PLOT",
    .columns = "gradient,half_spread,max_error,truncation_estimate,"
               "rounding_estimate,hamiltonian_evals,nanoseconds,"
               "max_energy_error,energy_from_gradient,energy_floor",
    .run = gradients,
};
