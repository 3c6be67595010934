/* nevh: orbits side by side.

   Lanes are steps of one stepper; a lane whose orbit has ended takes the next
   one.  A lane without an orbit goes along with the orbit of another.  Where a
   step of all fails, each is taken alone, so that one that fails stops no
   other.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"
#include "gradient/field_private.h"
#include <fenv.h>
#include <math.h>
#include <string.h>

enum { PATIENCE = 64 }; /* steps until the next orbit is asked for again */

/* Columns. */

static void get_column(const double rows[], size_t count, size_t width,
                       size_t lane, double to[]) {
    for (size_t k = 0; k < count; k++)
        to[k] = rows[k * width + lane];
}

static void put_column(double rows[], size_t count, size_t width, size_t lane,
                       const double from[]) {
    for (size_t k = 0; k < count; k++)
        rows[k * width + lane] = from[k];
}

static void copy_column(double rows[], size_t count, size_t width, size_t from,
                        size_t to) {
    for (size_t k = 0; k < count; k++)
        rows[k * width + to] = rows[k * width + from];
}

void nevh__lane_to_narrow(nevh_ensemble *e, const double q[], const double p[],
                          const double memory[], size_t lane) {
    if (e->lanes[lane].narrow)
        e->narrow = e->lanes[lane].narrow;
    get_column(q, e->n, e->width, lane, e->q1);
    get_column(p, e->n, e->width, lane, e->p1);
    get_column(memory, e->stepper->rows, e->width, lane,
               e->narrow->work.memory);
}

static void narrow_to_lane(nevh_ensemble *e, size_t lane) {
    put_column(e->q, e->n, e->width, lane, e->q1);
    put_column(e->p, e->n, e->width, lane, e->p1);
    put_column(e->stepper->work.memory, e->stepper->rows, e->width, lane,
               e->narrow->work.memory);
}

int nevh__narrow_step(nevh_ensemble *e, double t, double h) {
    e->narrow->time_roundoff = 0;
    return nevh__advance(e->narrow, t, h, e->q1, e->p1);
}

/* Beginnings. */

static bool any_busy(const nevh_ensemble *e, size_t *which) {
    for (size_t lane = 0; lane < e->width; lane++)
        if (e->lanes[lane].busy) {
            *which = lane;
            return true;
        }
    return false;
}

/* The next member, which a lane can take. */
static bool next_member(nevh_ensemble *e, size_t lane, uint64_t *member) {
    while (e->next(e->data, member, e->q1, e->p1)) {
        if (!e->own || nevh__own_take(e, lane, *member))
            return true;
        e->refused(e->data, *member);
    }
    return false;
}

static bool lanes_begin(nevh_ensemble *e, size_t lane) {
    nevh__lane *l = &e->lanes[lane];
    uint64_t member;
    if (!next_member(e, lane, &member))
        return false;
    *l = (nevh__lane){.busy = true,
                      .fresh = true,
                      .look = true,
                      .member = member,
                      .narrow = l->narrow,
                      .t = e->options.t_start};
    put_column(e->q, e->n, e->width, lane, e->q1);
    put_column(e->p, e->n, e->width, lane, e->p1);
    if (e->chaotic)
        nevh__chaotic_begin(e, lane);
    double *memory = e->stepper->work.memory;
    for (size_t row = 0; row < e->stepper->rows; row++)
        memory[row * e->width + lane] = 0;
    return true;
}

static void go_along(nevh_ensemble *e, size_t lane, size_t with) {
    copy_column(e->q, e->n, e->width, with, lane);
    copy_column(e->p, e->n, e->width, with, lane);
    copy_column(e->stepper->work.memory, e->stepper->rows, e->width, with,
                lane);
    e->lanes[lane].t = e->lanes[with].t;
    if (e->own)
        nevh__own_copy(e, with, lane);
}

/* Fills lanes that are free.  Returns whether any orbit is new. */
static bool lanes_fill(nevh_ensemble *e) {
    size_t which;
    bool any = false, more = !(e->together && any_busy(e, &which));
    for (size_t lane = 0; lane < e->width; lane++)
        e->lanes[lane].look = false;
    for (size_t lane = 0; more && lane < e->width; lane++)
        if (!e->lanes[lane].busy) {
            more = lanes_begin(e, lane);
            any |= more;
        }
    if (any_busy(e, &which))
        for (size_t lane = 0; lane < e->width; lane++)
            if (!e->lanes[lane].busy)
                go_along(e, lane, which);
    return any;
}

/* Steps. */

void nevh__ensemble_look_back(nevh_ensemble *e, double h) {
    nevh__snapshot last = e->ago2;
    size_t lanes = e->stride * sizeof(double);
    e->ago2 = e->ago1;
    e->ago1 = last;
    memcpy(last.t, e->now.t, lanes);
    memcpy(last.value, e->now.value, e->n_outcomes * lanes);
    for (size_t lane = 0; lane < e->width; lane++)
        last.h[lane] = h;
    if (!e->looks_back)
        return;
    size_t size = e->n * e->width * sizeof(double);
    memcpy(last.q, e->q, size);
    memcpy(last.p, e->p, size);
    memcpy(last.memory, e->stepper->work.memory,
           e->stepper->rows * e->width * sizeof(double));
}

static bool lane_step(nevh_ensemble *e, size_t lane, double h) {
    nevh__lane *l = &e->lanes[lane];
    nevh__lane_to_narrow(e, e->q, e->p, e->stepper->work.memory, lane);
    if (nevh__narrow_step(e, l->t, h)) {
        nevh__ensemble_fail(e, lane, &e->narrow->report);
        return false;
    }
    narrow_to_lane(e, lane);
    return true;
}

/* One by one, where the step of all failed. */
static void step_apart(nevh_ensemble *e) {
    size_t with;
    for (size_t lane = 0; lane < e->width; lane++)
        if (e->lanes[lane].busy)
            lane_step(e, lane, e->h);
    for (with = 0; with < e->width; with++)
        if (e->lanes[with].busy && !e->lanes[with].over)
            break;
    for (size_t lane = 0; with < e->width && lane < e->width; lane++)
        if (!e->lanes[lane].busy || e->lanes[lane].over)
            go_along(e, lane, with);
}

/* The times after so many steps. */
static void pass_steps(nevh_ensemble *e, size_t steps) {
    for (size_t lane = 0; lane < e->width; lane++) {
        nevh__lane *l = &e->lanes[lane];
        l->look = l->busy && !l->over;
        l->step += steps;
        bool last = e->whole && (double)l->step >= e->steps;
        l->t = last ? e->options.t_end
                    : e->options.t_start + (double)l->step * e->h;
    }
}

/* The step that all take. */
static void step_together(nevh_ensemble *e) {
    size_t which = 0;
    any_busy(e, &which);
    if (nevh__advance(e->stepper, e->lanes[which].t, e->h, e->q, e->p))
        step_apart(e);
    pass_steps(e, 1);
}

/* Steps that all take before one that ends an orbit, at most `most`. */
static size_t steps_unseen(const nevh_ensemble *e, size_t most) {
    double steps = (double)most;
    for (size_t lane = 0; lane < e->width; lane++) {
        const nevh__lane *l = &e->lanes[lane];
        if (l->busy)
            steps = l->over ? 0 : fmin(steps, e->steps - (double)l->step - 1);
    }
    return steps > 0 ? (size_t)steps : 0;
}

/* Steps whose states nobody looks at.  Returns how many. */
static size_t leap(nevh_ensemble *e) {
    nevh_stepper *s = e->stepper;
    size_t which = 0, steps = steps_unseen(e, PATIENCE);
    if (!steps || (e->watches && !e->watch) || !nevh__steps_are_plain(s))
        return 0;
    any_busy(e, &which);
    size_t from = s->taken = e->lanes[which].step;
    if (e->watches)
        s->taken += nevh__ensemble_watch(e, from, steps);
    else
        nevh__advance_unseen(s, e->options.t_start, e->h, from + steps, e->q,
                             e->p);
    pass_steps(e, s->taken - from);
    return s->taken - from;
}

/* The same for one lane. */
static void look_back_in(nevh_ensemble *e, size_t lane, double h) {
    nevh__snapshot *to = &e->ago2, *from = &e->ago1;
    size_t n = e->n, width = e->width, rows = e->stepper->rows;
    to->t[lane] = from->t[lane];
    to->h[lane] = from->h[lane];
    from->t[lane] = e->now.t[lane];
    from->h[lane] = h;
    for (size_t i = lane; i < e->n_outcomes * e->stride; i += e->stride) {
        to->value[i] = from->value[i];
        from->value[i] = e->now.value[i];
    }
    if (!e->looks_back)
        return;
    for (size_t i = lane; i < n * width; i += width) {
        to->q[i] = from->q[i];
        to->p[i] = from->p[i];
        from->q[i] = e->q[i];
        from->p[i] = e->p[i];
    }
    for (size_t i = lane; i < rows * width; i += width) {
        to->memory[i] = from->memory[i];
        from->memory[i] = e->stepper->work.memory[i];
    }
}

/* Takes the shorter step to t_end in lanes that have taken all others. */
static void step_to_end(nevh_ensemble *e) {
    double reached = e->options.t_start + e->steps * e->h;
    double rest = e->options.t_end - reached;
    bool any = false;
    for (size_t lane = 0; lane < e->width; lane++) {
        nevh__lane *l = &e->lanes[lane];
        bool ends = l->busy && !l->over && (double)l->step >= e->steps;
        l->look = false;
        if (ends && !e->whole) {
            look_back_in(e, lane, rest);
            l->look = lane_step(e, lane, rest);
            l->step++;
            l->t = e->options.t_end;
        }
        any |= l->look;
        l->ends = ends;
    }
    if (any)
        nevh__ensemble_look(e);
    for (size_t lane = 0; lane < e->width; lane++)
        e->lanes[lane].over |= e->lanes[lane].busy && e->lanes[lane].ends;
}

/* Hands on the orbits that are over.  Returns whether there were any. */
static bool end_lanes(nevh_ensemble *e) {
    bool any = false;
    for (size_t lane = 0; lane < e->width; lane++)
        if (e->lanes[lane].busy && e->lanes[lane].over) {
            nevh__ensemble_end(e, lane);
            any = true;
        }
    return any;
}

static bool look_and_end(nevh_ensemble *e) {
    nevh__ensemble_look(e);
    step_to_end(e);
    return end_lanes(e);
}

/* True if a lane has ended, or if each step must be observed. */
static bool to_look(const nevh_ensemble *e) {
    bool any = e->watches;
    for (size_t lane = 0; !any && lane < e->width; lane++) {
        const nevh__lane *l = &e->lanes[lane];
        any = l->busy && (l->over || (double)l->step >= e->steps);
    }
    return any;
}

static void run_lanes(nevh_ensemble *e) {
    size_t steps = 0, which;
    bool asks = true;
    while (!e->stopped) {
        if (asks && lanes_fill(e)) {
            asks = look_and_end(e);
            if (asks)
                continue;
        }
        if (!any_busy(e, &which))
            break;
        steps += leap(e);
        if (e->watches)
            nevh__ensemble_look_back(e, e->h);
        step_together(e);
        bool ended = to_look(e) && look_and_end(e);
        asks = ended || ++steps >= PATIENCE;
        steps = asks ? 0 : steps;
        e->stopped |= nevh__ensemble_ends(e);
    }
}

/* One orbit after the other. */

static int observe(void *ensemble, size_t step, double t, const double q[],
                   const double p[]) {
    nevh_ensemble *e = ensemble;
    nevh__lane *l = e->lanes;
    l->step = step;
    l->t = t;
    l->look = true;
    if (!l->fresh) {
        e->ago1.h[0] = e->stepper->last_h;
    }
    memcpy(e->q, q, e->n * sizeof *q);
    memcpy(e->p, p, e->n * sizeof *p);
    nevh__ensemble_look(e);
    if (!l->over)
        nevh__ensemble_look_back(
            e, 0); /* the step from here is known when it is taken */
    return l->over || nevh__ensemble_ends(e);
}

/* Sections observe after the records have begun. */
static int observe_sections(void *ensemble, size_t step, double t,
                            const double q[], const double p[]) {
    nevh_ensemble *e = ensemble;
    if (!e->sections || e->lanes->over)
        return 0;
    int status = nevh_sections_observe(e->sections, step, t, q, p);
    if (status)
        nevh__ensemble_fail(e, 0, &e->sections->report);
    return status;
}

static void run_one(nevh_ensemble *e) {
    nevh_stepper *s = e->stepper;
    nevh_observer observers[] = {{observe, e, 1}, {observe_sections, e, 1}};
    nevh_stepper_reset(s);
    s->last_t = e->options.t_start;
    s->time_roundoff = 0;
    if (e->sections)
        e->sections->begun = false;
    double *q = e->run_q, *p = e->run_p;
    memcpy(q, e->q, e->n * sizeof *q);
    memcpy(p, e->p, e->n * sizeof *p);
    int status = nevh_run_until(s, e->options.t_start, e->options.dt,
                                e->options.t_end, q, p, observers, 2);
    e->stopped = status == NEVH_STOPPED && !e->lanes->over;
    if (e->stopped)
        return;
    if (status && status != NEVH_STOPPED && !e->lanes->report.status)
        nevh__ensemble_fail(e, 0, &s->report);
    nevh__ensemble_end(e, 0);
}

int nevh_ensemble_run(nevh_ensemble *e, nevh_member_fn next,
                      nevh_result_fn done, void *data) {
    if (!e || !e->planned)
        return nevh_ensemble_status(e);
    e->report = (nevh__report){0};
    if (e->stepper->work.field->revision != e->system->revision)
        return nevh__fail(&e->report, NEVH_ESTALE,
                          "effects were added or switched since this was "
                          "planned: make a new ensemble");
    e->next = next;
    e->done = done;
    e->data = data;
    e->stopped = false;
    for (size_t lane = 0; lane < e->width; lane++)
        e->lanes[lane].busy = false;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    if (e->chaotic && nevh__chaotic_run(e))
        ; /* nothing else is asked for */
    else if (e->alone)
        while (!e->stopped && lanes_begin(e, 0))
            run_one(e);
    else
        run_lanes(e);
    fesetenv(&own);
    if (e->chaotic)
        nevh__chaotic_finish(e);
    for (size_t lane = 0; lane < e->width; lane++)
        nevh__own_drop(e, lane);
    if (!e->stopped)
        return NEVH_OK;
    return nevh__fail(&e->report, NEVH_STOPPED, "the run was to stop");
}
