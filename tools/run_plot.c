/* nevh run --plot: phase portraits, configurations, the energy.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "energy_plot.h"
#include "thinned.h"
#include "trajectory.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PANELS = 9, MOST_BOBS = 16 };

/* What is watched of a run; the state is the last one. */
typedef struct {
    const plan *plan;
    const char *integrator;
    nevh_stepper *stepper;
    double t, *q, *p;
    thinned rows;
} watched_run;

static int keep_time(void *data, size_t step, double t, const double q[],
                     const double p[]) {
    watched_run *o = data;
    (void)step, (void)q, (void)p;
    o->t = t;
    return NEVH_OK;
}

/* What goes wrong shows in the picture, and was said by nevh run. */
static void follow(watched_run *o, nevh_observer observers[], size_t count) {
    double stopped;
    observers[count - 1] = (nevh_observer){keep_time, o, 1};
    plan_run(o->plan, o->stepper, o->plan->dt[0], o->q, o->p, observers, count,
             &stopped);
}

static char *title_of(const watched_run *o, const char *more) {
    const plan *p = o->plan;
    const char *unit = nevh_scene_label(p->scene, "t");
    return text_print("%s (%s, dt = %.4g%s%s%s)", p->title, o->integrator,
                      p->dt[0], *unit ? " " : "", unit, more);
}

/* Phase portraits: rows of coordinates and momenta. */

static int keep_phase(void *data, size_t step, double t, const double q[],
                      const double p[]) {
    watched_run *o = data;
    double *at = thinned_next(&o->rows);
    (void)step, (void)t;
    for (size_t k = 0; at && k < o->rows.columns / 2; k++) {
        at[2 * k] = q[k];
        at[2 * k + 1] = p[k];
    }
    return NEVH_OK;
}

/* The period to take the coordinate modulo; 0 where it stays within one. */
static double wrapping(const watched_run *o, size_t k) {
    double period = nevh_scene_period(o->plan->scene, k);
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < o->rows.count; i++) {
        double q = o->rows.row[i * o->rows.columns + 2 * k];
        low = fmin(low, q);
        high = fmax(high, q);
    }
    return high - low > period ? period : 0;
}

/* A line leaves the panel at one side, and comes in at the other. */
static void turn_over(plot *to, size_t series, const double from[],
                      const double at[], double old, double new) {
    plot_point(to, series, at[0] - old, at[1]);
    plot_break(to, series);
    plot_point(to, series, from[0] - new, from[1]);
}

static void draw_phase(plot *to, const watched_run *o, size_t k) {
    double period = wrapping(o, k), shift = 0, last = 0;
    bool whole = o->rows.part == 1;
    size_t series = plot_series(to, NULL), width = o->rows.columns;
    plot_style(to, series, whole ? PLOT_LINES : PLOT_DOTS);
    if (period > 0)
        plot_span_x(to, -period / 2, period / 2);
    for (size_t i = 0; i < o->rows.count; i++, last = shift) {
        const double *at = o->rows.row + i * width + 2 * k;
        if (period > 0)
            shift = period * floor(at[0] / period + 0.5);
        if (i && shift != last && whole)
            turn_over(to, series, at - width, at, last, shift);
        plot_point(to, series, at[0] - shift, at[1]);
    }
}

static plot *plot_phase(watched_run *o) {
    const plan *p = o->plan;
    size_t panels = p->n < MOST_PANELS ? p->n : MOST_PANELS;
    char *more = p->n > panels
                     ? text_print("; %zu of %zu coordinates", panels, p->n)
                     : text_print("%s", "");
    nevh_observer observers[2] = {{keep_phase, o, 1}};
    o->rows = thinned_new(2 * panels);
    follow(o, observers, 2);
    char *title = title_of(o, more);
    free(more);
    plot *to = NULL;
    for (size_t k = 0; k < panels; k++) {
        const char *name = nevh_scene_coordinate(p->scene, k);
        char *momentum = text_print("p_%s", name);
        char *x = plot_label(p, name, name);
        char *y = plot_label(p, momentum, momentum);
        if (to)
            plot_panel(to, NULL, x, y);
        else
            to = plot_new(title, x, y);
        draw_phase(to, o, k);
        free(momentum);
        free(x);
        free(y);
    }
    free(title);
    return to;
}

/* Configurations: rows of the places of bobs. */

static size_t count_bobs(nevh_scene *s) {
    size_t count = 0;
    for (size_t i = 0; i < nevh_scene_part_count(s); i++)
        count += strcmp(nevh_scene_part_at(s, i).kind, "bob") == 0;
    return count < MOST_BOBS ? count : MOST_BOBS;
}

/* Of part i; NANs where its formulas have no value. */
static void part(const watched_run *o, size_t i, double t, const double q[],
                 const double p[], double values[4]) {
    for (size_t k = 0; k < 4; k++)
        values[k] = NAN;
    nevh_scene_part_values(o->plan->scene, i, t, q, p, values);
}

static int keep_bobs(void *data, size_t step, double t, const double q[],
                     const double p[]) {
    watched_run *o = data;
    nevh_scene *s = o->plan->scene;
    double *at = thinned_next(&o->rows), values[4];
    (void)step;
    for (size_t i = 0, bob = 0; at && bob < o->rows.columns / 2; i++)
        if (strcmp(nevh_scene_part_at(s, i).kind, "bob") == 0) {
            part(o, i, t, q, p, values);
            memcpy(at + 2 * bob++, values, 2 * sizeof *values);
        }
    return NEVH_OK;
}

/* returns  the series */
static size_t draw_trail(plot *to, const watched_run *o, size_t bob) {
    size_t series = plot_series(to, NULL);
    plot_style(to, series, o->rows.part < 1 ? PLOT_DOTS : PLOT_LINES);
    for (size_t i = 0; i < o->rows.count; i++) {
        const double *at = o->rows.row + i * o->rows.columns + 2 * bob;
        plot_point(to, series, at[0], at[1]);
    }
    return series;
}

static void draw_rod(plot *to, const double values[4]) {
    size_t series = plot_series(to, NULL);
    plot_style(to, series, PLOT_RODS);
    plot_point(to, series, values[0], values[1]);
    plot_point(to, series, values[2], values[3]);
}

static void draw_bob(plot *to, const char *name, size_t trail,
                     const double values[2]) {
    size_t series = plot_series(to, name);
    plot_style(to, series, PLOT_BOBS);
    plot_like(to, series, trail);
    plot_point(to, series, values[0], values[1]);
}

/* Where all is at the end. */
static void draw_rods(plot *to, const watched_run *o) {
    nevh_scene *s = o->plan->scene;
    double values[4];
    for (size_t i = 0; i < nevh_scene_part_count(s); i++)
        if (strcmp(nevh_scene_part_at(s, i).kind, "rod") == 0) {
            part(o, i, o->t, o->q, o->p, values);
            draw_rod(to, values);
        }
}

static void draw_bobs(plot *to, const watched_run *o, const size_t trails[]) {
    nevh_scene *s = o->plan->scene;
    size_t bobs = o->rows.columns / 2, bob = 0;
    double values[4];
    for (size_t i = 0; i < nevh_scene_part_count(s) && bob < bobs; i++)
        if (strcmp(nevh_scene_part_at(s, i).kind, "bob") == 0) {
            char *name = bobs > 1 ? text_print("bob %zu", bob + 1) : NULL;
            part(o, i, o->t, o->q, o->p, values);
            draw_bob(to, name, trails[bob++], values);
            free(name);
        }
}

static plot *plot_configuration(watched_run *o) {
    nevh_scene *s = o->plan->scene;
    size_t bobs = count_bobs(s), trails[MOST_BOBS];
    nevh_observer observers[2] = {{keep_bobs, o, 1}};
    o->rows = thinned_new(2 * bobs);
    follow(o, observers, 2);
    char *title = title_of(o, "");
    plot *to = plot_new(title, "x", "y");
    plot_equal(to);
    for (size_t bob = 0; bob < bobs; bob++)
        trails[bob] = draw_trail(to, o, bob);
    draw_rods(to, o);
    draw_bobs(to, o, trails);
    free(title);
    return to;
}

/* The energy. */

static nevh_energy *new_energy(const watched_run *o) {
    const plan *p = o->plan;
    nevh_options planned = plan_options(p, p->gradients.item[0]);
    nevh_energy *energy = nevh_energy_new(p->system, &planned);
    if (p->balance)
        nevh_energy_follow(energy, o->stepper);
    if (p->run->energy_scale > 0)
        nevh_energy_set_scale(energy, p->run->energy_scale);
    return energy;
}

static plot *plot_energy(watched_run *o) {
    const plan *p = o->plan;
    nevh_energy *energy = new_energy(o);
    energy_trace trace = {envelope_new(p->run->t_start, p->t_end), energy};
    nevh_observer observers[3] = {{nevh_energy_observe, energy, 1},
                                  {energy_trace_observe, &trace, 1}};
    follow(o, observers, 3);
    char *title = title_of(o, "");
    plot *to = energy_plot_new(p, title, NULL);
    energy_plot_add(to, NULL, trace.envelope);
    nevh_energy_free(energy);
    free(trace.envelope);
    free(title);
    return to;
}

static nevh_stepper *new_stepper(const plan *p, const char *integrator) {
    nevh_options o = plan_options(p, p->gradients.item[0]);
    bool transformed;
    const nevh_integrator *scheme = plan_scheme(integrator, &transformed);
    o.transform = plan_transform(p, integrator);
    o.balance = p->balance;
    if (nevh_integrator_needs_tolerance(scheme) && p->tolerances)
        o.tolerance = p->tolerance[0];
    return nevh_stepper_new(p->system, scheme, &o);
}

static double *copy(const double from[], size_t count) {
    double *to = tool_allocate(count, sizeof *to);
    memcpy(to, from, count * sizeof *to);
    return to;
}

int run_plot_check(const options *o, const plan *p) {
    options as = *o;
    as.file = o->resume ? o->resume : o->file;
    as.format = o->formatted ? o->format : FORMAT_CSV;
    if (plot_wanted(o) && o->plot_kind == PLOT_CONFIGURATION &&
        nevh_scene_part_count(p->scene) == 0)
        return tool_refuse("%s: the scene has no [picture] to plot, as: bob = "
                           "x, y",
                           p->name);
    return plot_check(&as);
}

int run_plot(const options *given, const plan *p, const char *integrator) {
    static plot *(*const draw[])(watched_run *) = {[PLOT_PHASE] = plot_phase,
                                                   [PLOT_CONFIGURATION] =
                                                       plot_configuration,
                                                   [PLOT_ENERGY] = plot_energy};
    watched_run o = {.plan = p,
                     .integrator = integrator,
                     .stepper = new_stepper(p, integrator),
                     .q = copy(p->q, p->n),
                     .p = copy(p->p, p->n)};
    plot *to = draw[given->plot_kind](&o);
    int status = plot_write(to, given);
    plot_free(to);
    thinned_free(&o.rows);
    nevh_stepper_free(o.stepper);
    free(o.q);
    free(o.p);
    return status;
}
