/* nevh cost --plot: errors against time, and against evaluations.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include "plot.h"
#include <math.h>
#include <stdlib.h>

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

/* Exact gradients evaluate no H. */
static bool counts_values(const costs *c) {
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < c->ladder[i].count; k++)
            if (c->ladder[i].rung[k].counts.hamiltonians > 0)
                return true;
    return false;
}

static void draw_ladder(plot *to, const costs *c, const ladder *l,
                        work_of *work) {
    bool alone = c->search.plan.gradients.count < 2;
    char *name = alone ? text_print("%s", l->integrator)
                       : text_print("%s, %s", l->integrator, l->gradient);
    size_t series = plot_series(to, name);
    plot_style(to, series, PLOT_BOTH);
    for (size_t k = 0; k < l->count; k++) {
        double error = ladder_error(&l->rung[k], c->search.by_state);
        if (isfinite(error))
            plot_point(to, series, work(&l->rung[k]), error);
    }
    free(name);
}

static void draw_panel(plot *to, const costs *c, work_of *work) {
    plot_log(to, true, true);
    plot_limit_y(to, 0, useless);
    for (size_t i = 0; i < c->count; i++)
        if (cost_shows(c, &c->ladder[i]))
            draw_ladder(to, c, &c->ladder[i], work);
}

int cost_plot(const options *o, const costs *c) {
    const plan *p = &c->search.plan;
    const char *title = nevh_scene_title(p->scene);
    const char *error = c->search.by_state ? "largest state error, relative"
                                           : "largest energy error, relative";
    bool h = counts_values(c);
    plot *to = plot_new(*title ? title : p->name, "CPU time (ms)", error);
    draw_panel(to, c, milliseconds);
    plot_panel(to, NULL, h ? "evaluations of H" : "evaluations of the gradient",
               error);
    draw_panel(to, c, h ? values : slopes);
    int status = plot_write(to, o);
    plot_free(to);
    return status;
}
