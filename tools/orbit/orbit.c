/* nevh: orbits to be drawn.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit.h"
#include <math.h>
#include <string.h>

enum { MOST_ORBITS = 16 };

static bool fits(const plan *p, const char *integrator) {
    nevh_stepper *s = plan_stepper(p, integrator);
    bool good = !nevh_stepper_status(s);
    nevh_stepper_free(s);
    return good;
}

static void add(orbits *all, const plan *p, const char *integrator,
                const double *dt, char *name) {
    orbit *one = &all->item[all->count++];
    *one = (orbit){.plan = *p, .integrator = integrator, .name = name};
    one->plan.dt = dt;
    one->plan.dts = 1;
}

static char *name_of(const plan *p, const char *integrator, double dt,
                     bool schemes, bool steps) {
    char *step = text_print("dt = %.4g%s", dt, p->unit);
    return schemes && steps ? text_print("%s, %s", integrator, step)
           : steps          ? text_print("%s", step)
                            : text_print("%s", integrator);
}

orbits orbits_new(const options *o, const plan *p, const char *integrator) {
    bool schemes = o->integrators.count > 1, steps = o->dt.count > 1;
    size_t names = schemes ? p->integrators.count : 1;
    orbits all = {tool_allocate(MOST_ORBITS, sizeof(orbit)), 0, {0}};
    for (size_t i = 0; i < names; i++) {
        const char *name = schemes ? p->integrators.item[i] : integrator;
        if (!fits(p, name)) {
            list_add(&all.left_out, name);
            continue;
        }
        for (size_t k = 0; k < (steps ? p->dts : 1); k++)
            if (all.count < MOST_ORBITS)
                add(&all, p, name, p->dt + k,
                    name_of(p, name, p->dt[k], schemes, steps));
            else
                list_add(&all.left_out, name);
    }
    return all;
}

typedef struct {
    orbit *orbit;
    orbit_fill *fill;
    void *data;
} filler;

static int take(void *data, double t, const double q[], const double p[]) {
    filler *f = data;
    orbit *o = f->orbit;
    double *row = thinned_next(&o->rows);
    size_t size = o->plan.n * sizeof *q;
    o->t = t;
    memcpy(o->q, q, size);
    memcpy(o->p, p, size);
    if (row) {
        row[0] = t;
        f->fill(f->data, t, q, p, row + 1);
    }
    return TOOL_OK;
}

int orbit_follow(orbit *o, const row_times *times, size_t columns,
                 orbit_fill *fill, void *data, bool quiet) {
    static const volatile sig_atomic_t no_signal;
    filler f = {o, fill, data};
    o->rows = thinned_new(columns + 1);
    o->q = tool_allocate(o->plan.n, sizeof *o->q);
    o->p = tool_allocate(o->plan.n, sizeof *o->p);
    nevh_stepper *s = plan_stepper(&o->plan, o->integrator);
    trajectory *r =
        trajectory_new(&o->plan, o->integrator, s, times,
                       (row_output){.take = take, .data = &f, .mute = quiet});
    o->status = trajectory_follow(r, &(trajectory_watch){.signal = &no_signal});
    trajectory_free(r);
    nevh_stepper_free(s);
    return o->status;
}

/* The largest change of a variable of `count` from its last value, over its range so
   far, which it widens. */
static double relative_change(size_t count, const double y[], double last[],
                              double low[], double high[]) {
    double most = 0;
    for (size_t k = 0; k < count; k++) {
        low[k] = fmin(low[k], y[k]);
        high[k] = fmax(high[k], y[k]);
        if (high[k] > low[k])
            most = fmax(most, fabs(y[k] - last[k]) / (high[k] - low[k]));
        last[k] = y[k];
    }
    return most;
}

/* Times are the closer the faster a variable changes, from a short one on: of the
   range nothing is known before.  They end where the scene's `stop` says. */
size_t orbit_follow_reference(orbit *o, nevh_reference *r, size_t columns,
                              orbit_fill *fill, void *data) {
    enum { MOST = THINNED_ROWS - 1, FEWEST = 4000 };
    static const double change = 0.01, most_growth = 1.5, least = 0.1,
                        first = 1e-3;
    size_t n = o->plan.n, count = 2 * n;
    filler f = {o, fill, data};
    double *y = tool_allocate(4 * count, sizeof *y), *last = y + count;
    double *low = last + count, *high = low + count;
    double begin = o->plan.run->t_start;
    double span = o->plan.t_end - begin,
           until = nevh_reference_horizon(r) - begin;
    span = fabs(until) < fabs(span) ? until : span;
    stop ends = {.scene = o->plan.scene};
    bool stops = nevh_scene_stops(o->plan.scene);
    o->rows = thinned_new(columns + 1);
    o->q = tool_allocate(n, sizeof *o->q);
    o->p = tool_allocate(n, sizeof *o->p);
    for (double part = 0, step = first / FEWEST;;) {
        if (tool_status(nevh_reference_state_after(r, part * span, y, y + n)))
            break;
        if (part == 0)
            for (size_t k = 0; k < count; k++)
                low[k] = high[k] = last[k] = y[k];
        take(&f, begin + part * span, y, y + n);
        if (part == 1 || o->rows.count == MOST ||
            (stops && stop_observe(&ends, 0, o->t, y, y + n)))
            break;
        double moved = relative_change(count, y, last, low, high);
        step *= fmax(least, fmin(most_growth, change / moved));
        step = fmin(step, 1. / FEWEST);
        step = fmax(step, (1 - part) / (double)(MOST - o->rows.count));
        part = fmin(part + step, 1);
    }
    return o->rows.count;
}

row_times orbit_dense_times(const plan *p) {
    static const double enough = THINNED_ROWS - 1, most = 50, whole = 1e-9;
    double begin = p->run->t_start, span = p->t_end - begin;
    double steps = span / p->dt[0], h = p->dt[0];
    if (fabs(steps - round(steps)) <= whole * steps && round(steps) > 0) {
        steps = round(steps);
        h = span / steps;
    }
    double each = fmin(floor(enough / ceil(steps)), most);
    row_times r = {.by = BY_TIMES};
    if (each < 2)
        return (row_times){.by = BY_STEPS, .every = 1};
    r.time = tool_allocate((size_t)(ceil(steps) * each) + 1, sizeof *r.time);
    for (double i = 0; i < steps * each - whole * steps; i++)
        r.time[r.count++] =
            begin + (floor(i / each) + fmod(i, each) / each) * h;
    r.time[r.count++] = p->t_end;
    return r;
}

const double *orbit_row(const orbit *o, size_t i) {
    return o->rows.row + i * o->rows.columns + 1;
}

double orbit_turns(const orbit *o, size_t k) {
    double sum = 0;
    size_t crossings = 0;
    for (size_t i = 0; i < o->rows.count; i++)
        sum += orbit_row(o, i)[k];
    double mean = sum / (double)o->rows.count;
    for (size_t i = 1; i < o->rows.count; i++)
        crossings +=
            (orbit_row(o, i)[k] > mean) != (orbit_row(o, i - 1)[k] > mean);
    return (double)crossings / 2;
}

/* An orbit_fill; data are the number of coordinates. */
static void fill_state(void *data, double t, const double q[], const double p[],
                       double values[]) {
    size_t n = *(const size_t *)data;
    (void)t;
    memcpy(values, q, n * sizeof *q);
    memcpy(values + n, p, n * sizeof *p);
}

double orbit_turns_of(const plan *p) {
    if (!p->dts || !p->integrators.count)
        return 0;
    size_t n = p->n;
    orbit o = {.plan = *p, .integrator = p->integrators.item[0]};
    row_times steps = {.by = BY_STEPS, .every = 1};
    double most = 0;
    o.plan.dts = 1;
    if (fits(p, o.integrator) &&
        !orbit_follow(&o, &steps, 2 * n, fill_state, &n, true))
        for (size_t k = 0; k < 2 * n && o.rows.part == 1; k++)
            most = fmax(most, orbit_turns(&o, k));
    return most;
}
