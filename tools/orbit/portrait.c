/* nevh portrait: orbits by each integrator over level curves of H.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "portrait.h"
#include "fit/measured.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { USUAL_STEPS = 2000, MOST_POINTS = 4000, MOST_LEVELS = 16 };

/* The orbits of all members by one integrator. */
typedef struct {
    const char *integrator;
    double *points; /* x, y of each */
    size_t *member; /* of each */
    size_t count, every, at, failed;
    char *status; /* why there are none, or the first that failed; or NULL */
    bool refused, symplectic;
} orbits_of;

typedef struct {
    plan plan;
    members members;
    measured data; /* of no points where there is none */
    size_t x, p_x; /* their columns */
    orbits_of *of;
    size_t count;
    levels levels;
} portrait_job;

static int take(void *data, size_t step, double t, const double q[],
                const double p[]) {
    orbits_of *o = data;
    (void)step, (void)t;
    o->points = tool_grown(o->points, o->count, 2 * sizeof *o->points);
    o->member = tool_grown(o->member, o->count, sizeof *o->member);
    o->points[2 * o->count] = q[0];
    o->points[2 * o->count + 1] = p[0];
    o->member[o->count++] = o->at;
    return 0;
}

static double end_of(const portrait_job *j, const options *o) {
    const plan *p = &j->plan;
    double usual = p->run->t_start + USUAL_STEPS * p->dt[0];
    return o->t_end ? p->t_end : fmin(p->t_end, usual);
}

static char *why_of(const portrait_job *j, const orbits_of *o,
                    const char *message) {
    return j->members.several
               ? member_why(&j->plan, j->members.number[o->at], message)
               : plan_why(&j->plan, message);
}

/* An orbit that failed is named as in the picture, if there are several. */
static char *failure_of(const portrait_job *j, const orbits_of *o,
                        const char *message) {
    char *why = why_of(j, o, message);
    if (j->members.count == 1)
        return text_print("failed: %s", why);
    return text_print("failed (%s): %s",
                      members_start(&j->members, &j->plan, o->at), why);
}

static void run_orbits(portrait_job *j, orbits_of *o) {
    const plan *p = &j->plan;
    nevh_stepper *s = plan_stepper(p, o->integrator);
    o->symplectic = nevh_integrator_symplectic(plan_scheme(
                        p, o->integrator, &(bool){false})) == NEVH_YES;
    if (nevh_stepper_status(s)) {
        o->refused = true;
        o->status = text_print("refused: %s", nevh_stepper_message(s));
    }
    nevh_stepper_foresee(s, (double)j->members.count * plan_steps(p, p->dt[0]));
    o->every = (size_t)(plan_steps(p, p->dt[0]) / MOST_POINTS) + 1;
    for (o->at = 0; !o->refused && o->at < j->members.count; o->at++) {
        double q = j->members.q[o->at], m = j->members.p[o->at], stopped;
        nevh_observer observer = {take, o, o->every};
        nevh_stepper_reset(s);
        if (plan_run_from(p, s, &q, &m, &observer, 1, &stopped) && !o->failed++)
            o->status = failure_of(j, o, nevh_stepper_message(s));
    }
    nevh_stepper_free(s);
}

/* Into the period of the window, or round 0 where there is no window. */
static double wrapped(const portrait_job *j, double x) {
    const portrait_window *w = &j->levels.window;
    double period = nevh_scene_period(j->plan.scene, 0);
    double middle = (w->low_x + w->high_x) / 2;
    return period > 0 ? x - period * floor((x - middle) / period + 0.5) : x;
}

static bool is_symplectic(const orbits_of *o) {
    return !o->refused && o->symplectic;
}

/* The least angle of a window of a period: half a period below 0, or 0 or a period below
   it, where orbits about half a period are then in one piece. */
static double least_angle(double low, double high, double period) {
    double half = period / 2;
    return low > 0 && low < half && high > half && high < period      ? 0
           : high < 0 && high > -half && low < -half && low > -period ? -period
                                                                      : -half;
}

static void hold(portrait_window *w, double x, double y) {
    w->low_x = fmin(w->low_x, x);
    w->high_x = fmax(w->high_x, x);
    w->low_y = fmin(w->low_y, y);
    w->high_y = fmax(w->high_y, y);
}

/* The range of symplectic integrators, if there are any, and of measured points, with a
   margin; of an angle a period. */
static portrait_window find_window(const portrait_job *j) {
    static const double room = 0.2;
    portrait_window w = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    double period = nevh_scene_period(j->plan.scene, 0);
    bool any = false;
    for (size_t i = 0; i < j->count; i++)
        any = any || is_symplectic(&j->of[i]);
    for (size_t i = 0; i < j->count; i++)
        for (size_t k = 0;
             (is_symplectic(&j->of[i]) || !any) && k < j->of[i].count; k++)
            hold(&w, j->of[i].points[2 * k], j->of[i].points[2 * k + 1]);
    for (size_t i = 0; i < j->data.points; i++) {
        const double *at = j->data.value + i * j->data.columns;
        hold(&w, period > 0 ? w.low_x : at[j->x], at[j->p_x]);
    }
    double least = least_angle(w.low_x, w.high_x, period);
    double x = room * (w.high_x - w.low_x), y = room * (w.high_y - w.low_y);
    x = x > 0 ? x : fmax(1, fabs(w.high_x));
    y = y > 0 ? y : fmax(1, fabs(w.high_y));
    w = (portrait_window){w.low_x - x, w.high_x + x, w.low_y - y, w.high_y + y};
    if (period > 0) {
        w.low_x = least;
        w.high_x = least + period;
    }
    return w;
}

/* Chooses energies of members, if they are many; of a single member, energies up to
   it and beyond. */
static size_t choose_levels(const portrait_job *j, double energy[MOST_LEVELS]) {
    size_t count = j->members.count, chosen = 0;
    double *all = tool_allocate(count, sizeof *all);
    for (size_t i = 0; i < count; i++)
        all[i] = levels_energy(&j->levels, j->members.q[i], j->members.p[i]);
    numbers_sort(all, count);
    for (size_t i = 0; i < MOST_LEVELS && count > 1; i++) {
        double level = all[i * (count - 1) / (MOST_LEVELS - 1)];
        if (!chosen || level > energy[chosen - 1])
            energy[chosen++] = level;
    }
    double lowest = all[0];
    for (size_t i = 0; i < j->levels.count; i++)
        lowest = fmin(lowest, j->levels.found[i].energy);
    for (int i = 1; count == 1 && i <= 12; i++)
        energy[chosen++] = lowest + (all[0] - lowest) * (i / 8.0) * (i / 8.0);
    return chosen;
}

static size_t orbit_series(const portrait_job *j, const orbits_of *o,
                           size_t member, plot *to) {
    size_t series =
        plot_series(to, members_start(&j->members, &j->plan, member));
    if (j->members.count > 1)
        plot_member(to, series, member, j->members.count);
    else {
        plot_style(to, series, PLOT_DOTS);
        plot_integrator(to, series, o->integrator);
        plot_size(to, series, 0.6);
    }
    return series;
}

/* Until they leave the window up or down: what wraps round then fills it. */
static void draw_orbits(const portrait_job *j, const orbits_of *o, plot *to) {
    const portrait_window *w = &j->levels.window;
    size_t series = 0;
    bool inside = true;
    for (size_t k = 0, next = 0; k < o->count; k++) {
        double y = o->points[2 * k + 1];
        for (; next <= o->member[k]; next++, inside = true)
            series = orbit_series(j, o, next, to);
        inside = inside && y >= w->low_y && y <= w->high_y;
        if (inside)
            plot_point(to, series, wrapped(j, o->points[2 * k]), y);
    }
}

static void draw_measured(const portrait_job *j, plot *to) {
    const measured *m = &j->data;
    size_t series = m->points ? plot_series(to, "measured") : 0;
    if (m->points)
        plot_style(to, series, PLOT_MEASURED);
    for (size_t i = 0; i < m->points; i++) {
        const double *at = m->value + i * m->columns;
        plot_point(to, series, wrapped(j, at[j->x]), at[j->p_x]);
    }
}

/* The largest change of H along an orbit. */
static double energy_change(const portrait_job *j, const orbits_of *o) {
    double most = 0, first = NAN;
    for (size_t k = 0; k < o->count; k++) {
        double h =
            levels_energy(&j->levels, o->points[2 * k], o->points[2 * k + 1]);
        if (k == 0 || o->member[k] != o->member[k - 1])
            first = h;
        most = fmax(most, fabs(h - first));
    }
    return most;
}

/* Orbits of a drive, or under friction, leave the levels of H. */
static char *heading_of(const portrait_job *j, const orbits_of *o) {
    const plan *p = &j->plan;
    const char *failed = o->failed ? ", then failed" : "";
    if (p->time || p->friction)
        return text_print("%s; lines: H at t = %.6g%s%s", o->integrator,
                          p->run->t_start,
                          p->friction ? ", without friction" : "", failed);
    return text_print("%s: H within %.2g%s%s", o->integrator,
                      energy_change(j, o), p->energy_unit, failed);
}

static plot *draw_plane(portrait_job *j) {
    const plan *p = &j->plan;
    const char *name = nevh_scene_coordinate(p->scene, 0);
    char *momentum = text_print("p_%s", name);
    char *x = plot_label(p, name, name), *y = plot_label(p, momentum, momentum);
    double energy[MOST_LEVELS];
    size_t count = choose_levels(j, energy);
    plot *to = NULL;
    for (size_t i = 0; i < j->count; i++) {
        const orbits_of *o = &j->of[i];
        if (o->refused)
            continue;
        char *heading = heading_of(j, o);
        if (to) {
            plot_panel(to, heading, x, y);
        } else {
            to = plot_new(p->title, x, y);
            plot_heading(to, heading);
        }
        plot_span_x(to, j->levels.window.low_x, j->levels.window.high_x);
        plot_span_y(to, j->levels.window.low_y, j->levels.window.high_y);
        levels_draw(&j->levels, to, energy, count);
        draw_orbits(j, o, to);
        draw_measured(j, to);
    }
    return to;
}

static int run_plane(portrait_job *j, plot **to, const options *o) {
    int worst = members_tell(&j->members, &j->plan);
    j->plan.t_end = end_of(j, o);
    j->count = j->plan.integrators.count;
    j->of = tool_allocate(j->count, sizeof *j->of);
    size_t points = 0;
    for (size_t i = 0; i < j->count; i++) {
        j->of[i].integrator = j->plan.integrators.item[i];
        run_orbits(j, &j->of[i]);
        points += j->of[i].count;
        worst = j->of[i].failed ? TOOL_FAILED : worst;
    }
    if (!points)
        return tool_refuse("%s: none of the integrators fits; see nevh check",
                           j->plan.name);
    if (levels_new(&j->levels, &j->plan, find_window(j)))
        return TOOL_USAGE;
    *to = draw_plane(j);
    return worst;
}

/* A plane of section. */
static int run_section(portrait_job *j, plot **to, const options *o) {
    int worst = members_tell(&j->members, &j->plan);
    for (size_t i = 0; i < j->plan.integrators.count; i++) {
        int status =
            section_panel(to, &j->plan, o, j->plan.integrators.item[i]);
        if (status == TOOL_USAGE)
            return status;
        worst = status > worst ? status : worst;
    }
    return *to ? worst
               : tool_refuse("%s: there is nothing to draw: no integrator "
                             "finds a point of the section",
                             j->plan.name);
}

static int read_data(portrait_job *j, const options *o) {
    if (!o->fit.data)
        return TOOL_OK;
    if (j->plan.n > 1)
        return tool_refuse(
            "--data is drawn in the plane of a coordinate and its "
            "momentum; here are %zu",
            j->plan.n);
    if (measured_read(&j->data, &j->plan, o, NULL))
        return TOOL_USAGE;
    char *momentum =
        text_print("p_%s", nevh_scene_coordinate(j->plan.scene, 0));
    j->x = measured_find(&j->data, nevh_scene_coordinate(j->plan.scene, 0));
    j->p_x = measured_find(&j->data, momentum);
    bool both = j->x < j->data.columns && j->p_x < j->data.columns;
    return both ? TOOL_OK
                : tool_refuse("--data %s: a portrait takes columns %s "
                              "and %s",
                              o->fit.data, momentum + 2, momentum);
}

/* True if it is an equilibrium found before, shifted by a period. */
static bool is_again(const portrait_job *j, size_t i) {
    const equilibrium *found = j->levels.found, *e = &found[i];
    const portrait_window *w = &j->levels.window;
    double period = nevh_scene_period(j->plan.scene, 0);
    for (size_t k = 0; period > 0 && k < i; k++)
        if (fabs(remainder(e->x - found[k].x, period)) < 1e-9 * period &&
            fabs(e->y - found[k].y) < 1e-9 * (w->high_y - w->low_y))
            return true;
    return false;
}

/* Prints the equilibria, those near the start first. */
static void print_equilibria(const portrait_job *j) {
    enum { MOST_SHOWN = 200 };
    static const char *const kinds[] = {"centre", "saddle", "degenerate"};
    _Static_assert(sizeof kinds / sizeof *kinds == PORTRAIT_KINDS, "each kind");
    const char *name = nevh_scene_coordinate(j->plan.scene, 0);
    size_t shown = 0, left_out = 0;
    for (size_t i = 0; i < j->levels.count; i++) {
        const equilibrium *e = &j->levels.found[i];
        if (is_again(j, i))
            continue;
        if (shown == MOST_SHOWN) {
            left_out++;
            continue;
        }
        shown++;
        printf("%s at %s = %.10g, p_%s = %.10g: H = %.10g%s\n", kinds[e->kind],
               name, e->x, name, e->y, e->energy, j->plan.energy_unit);
    }
    if (left_out)
        printf("left out: %s%zu equilibria that are farther from the start\n",
               j->levels.many ? "more than " : "", left_out);
    if (j->levels.curve)
        printf(
            "degenerate equilibria fill a curve, of which the nearest to the "
            "start is listed\n");
}

static void print_notes(const portrait_job *j, const options *o) {
    if (o->quiet)
        return;
    printf("%s: %zu orbit%s by each integrator\n",
           o->plot.file ? o->plot.file : o->plot.script, j->members.count,
           j->members.count == 1 ? "" : "s");
    print_equilibria(j);
    for (size_t i = 0; i < j->count; i++)
        if (j->of[i].refused)
            printf("%s %s\n", j->of[i].integrator, j->of[i].status);
}

static void print_failures(const portrait_job *j) {
    for (size_t i = 0; i < j->count; i++)
        if (j->of[i].failed)
            tool_refuse("%s: %s %s", j->plan.name, j->of[i].integrator,
                        j->of[i].status);
}

static int draw(portrait_job *j, const options *o) {
    plot *to = NULL;
    int status = j->plan.n == 1 ? run_plane(j, &to, o) : run_section(j, &to, o);
    if (status == TOOL_USAGE)
        return status;
    char *more = j->plan.n == 1
                     ? text_print("dt = %.4g%s; %zu orbit%s, grey: levels of H",
                                  j->plan.dt[0], j->plan.unit, j->members.count,
                                  j->members.count == 1 ? "" : "s")
                     : text_print("dt = %.4g%s; %zu orbit%s", j->plan.dt[0],
                                  j->plan.unit, j->members.count,
                                  j->members.count == 1 ? "" : "s");
    plot_note_run(to, &j->plan, NULL, more);
    int drawn = plot_write(to, o);
    if (!drawn)
        print_notes(j, o);
    print_failures(j);
    return drawn ? drawn : status;
}

static int portrait(const options *o) {
    portrait_job j = {0};
    if (!plot_wanted(o))
        return tool_refuse("nevh portrait draws: give --plot FILE.svg, or "
                           "--plot - for the terminal");
    int status = plan_make(&j.plan, o);
    if (!status)
        status = members_check(&j.plan, o);
    if (!status)
        status = members_read(&j.members, &j.plan);
    if (!status)
        status = read_data(&j, o);
    if (!status)
        status = plot_check(o);
    if (!status)
        status = draw(&j, o);
    nevh_field_free(j.levels.field);
    plan_free(&j.plan);
    return status;
}

const command portrait_command = {
    .name = "portrait",
    .operand = "SCENE",
    .brief = "orbits over level curves of H, a panel a scheme",
    .help =
        "draws the orbits of the ensemble by each integrator, over level curves of H or in a plane of section",
    .examples =
        "portrait pendulum --t-end 20 --vary 'phi = range(0.5, 3, 6)' --plot portrait.svg\n"
        "portrait pendulum --t-end 20 --integrators verlet,rk4 --dt 0.3 --plot portrait.svg",
    .options = "SCENE STEPS NATIVE PLOT tolerance vary data section quiet",
    .instead = {"output",
                "it writes no rows: give the picture's name to --plot"},
    .run = portrait,
};
