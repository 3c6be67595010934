/* nevh: fixed-point iteration to the rounding floor.

   Lanes are independent of each other: one that is done is left alone.  One
   that contracts too slowly, makes no progress at large changes, is still under
   way after NEVH__STAGE_SWEEPS, or leaves the domain of H with changes that grow or
   exceed the scale is given to Newton's iteration, and where that had to be
   done, at once for the next HOLD steps, lest each waste the sweeps that fail.

   Too slowly: in a small system, more than 1/2 a sweep, which would take 50
   sweeps from scratch; 2 n stages plus about as many evaluations as stages buy
   Newton's matrix and six sweeps more, but a factored matrix costs what tens of
   sweeps do.  In a larger one, where it costs hundreds, more than 0.7: that
   would not be through after NEVH__STAGE_SWEEPS.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/field_private.h"
#include "implicit/implicit_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>

enum { HOLD = 50 };

static void fixed_point_lay_out(nevh__arena *a, void *solver) {
    nevh__stage_solver *s = solver;
    size_t width = s->work->width, state = 2 * s->work->size;
    size_t unknowns = s->rows * width, each = sizeof(double);
    s->scale = nevh__arena_take(a, state, each);
    s->unit = nevh__arena_take(a, state, each);
    s->out = nevh__arena_take(a, unknowns, each);
    s->least = nevh__arena_take(a, unknowns, each);
    s->noise = nevh__arena_take(a, 4 * s->work->n, each);
    s->one_scale = nevh__arena_take(a, 2 * s->work->n, each);
    s->lanes = nevh__arena_take(a, width, sizeof *s->lanes);
    s->lane = nevh__arena_take(a, width, sizeof *s->lane);
}

nevh__stage_solver *nevh__stage_solver_new(nevh_work *w,
                                           const nevh__stage_shape *shape) {
    nevh__stage_solver *s = nevh__array(1, sizeof *s);
    if (!s)
        return NULL;
    s->work = w;
    s->shape = *shape;
    s->stages = shape->stages;
    s->first = shape->partitioned ? w->n : 0;
    s->rows = (2 * w->n - s->first) * s->stages;
    s->memory = nevh__arena_new(fixed_point_lay_out, s);
    bool large = 2 * w->n * s->stages > NEVH__MOST_DENSE;
    s->newton = large ? NULL : nevh__newton_new(s);
    s->rescue = large ? NULL : nevh__rescue_new(s);
    if (s->memory && (large || (s->newton && s->rescue)))
        return s;
    nevh__stage_solver_free(s);
    return NULL;
}

void nevh__stage_solver_free(nevh__stage_solver *s) {
    if (!s)
        return;
    nevh__newton_free(s->newton);
    nevh__rescue_free(s->rescue);
    free(s->memory);
    free(s);
}

static void find_scales(nevh__stage_solver *s) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    double h = fabs(e->h);
    for (size_t row = 0; row < 2 * w->n; row++) {
        const double *y = row < w->n ? e->q : e->p;
        size_t at = row * w->width;
        for (size_t i = 0; i < w->width; i++) {
            double size = fabs(y[row % w->n * w->width + i]);
            double least =
                w->field->lanes ? w->field->lane_scale[at + i] : w->scale[row];
            double scale = size > least ? size : least;
            s->scale[at + i] = scale;
            s->unit[at + i] = h / scale;
        }
    }
}

/* Updates the state of a lane whose sweep is out[row*stride]. */
static nevh__stage_state proceed(nevh__stage_solver *s, size_t lane,
                                 size_t stride, const double out[]) {
    nevh__stage_progress made =
        nevh__stage_compare(s, lane, stride, out, &nevh__fixed_point_rule);
    nevh__stage_state state = nevh__fixed_point_judge(s, lane, &made);
    nevh__stage_take(s, lane, stride, out);
    return state;
}

static int hand_over(nevh__stage_solver *s, size_t lane) {
    if (s->problem->hold)
        s->problem->hold[lane] = HOLD;
    return nevh__newton_lane(s, lane);
}

static int sweep_alone(nevh__stage_solver *, size_t lanes[], size_t count,
                       size_t *active, bool last);

/* One sweep over lanes under way; those that remain so move to the front.
   Those that are stuck are handed over.  Where H is not defined for one, each
   is swept alone, lest it decide over the others. */
static int fixed_point_sweep(nevh__stage_solver *s, size_t lanes[],
                             size_t *active, bool last) {
    size_t count = *active;
    int status =
        s->problem->map(s->problem->data, count, lanes, s->problem->x, s->out);
    *active = 0;
    if (status == NEVH_EDOM && count > 1)
        return sweep_alone(s, lanes, count, active, last);
    bool lost = status == NEVH_EDOM && s->lane[lanes[0]].strays;
    if (status && !lost)
        return status;
    s->work->sweeps += count;
    for (size_t a = 0; a < count; a++) {
        size_t lane = lanes[a];
        nevh__stage_state state =
            lost ? NEVH__STUCK : proceed(s, lane, count, s->out + a);
        if (s->status)
            return s->status;
        if (state == NEVH__GO_ON && !last)
            lanes[(*active)++] = lane;
        else if (state != NEVH__DONE && (status = hand_over(s, lane)))
            return status;
    }
    return NEVH_OK;
}

static int sweep_alone(nevh__stage_solver *s, size_t lanes[], size_t count,
                       size_t *active, bool last) {
    int status = NEVH_OK;
    for (size_t a = 0; !status && a < count; a++) {
        size_t lane = lanes[a], one = 1;
        status = fixed_point_sweep(s, &lane, &one, last);
        if (one)
            lanes[(*active)++] = lane;
    }
    return status;
}

/* True if the lane is left to Newton's iteration, which then solves it. */
static bool held(nevh__stage_solver *s, size_t lane, int *status) {
    double *hold = s->newton ? s->problem->hold : NULL;
    if (!hold || !(hold[lane] > 0))
        return false;
    hold[lane] -= 1;
    *status = nevh__newton_lane(s, lane);
    return true;
}

/* Lanes from `first` to `until` - 1 are to be swept unless they are held. */
static int fixed_point_begin(nevh__stage_solver *s, size_t first, size_t until,
                             size_t *active) {
    const nevh__stage_group *group = s->problem->group;
    int status = NEVH_OK;
    for (size_t lane = first; !status && lane < until; lane++) {
        nevh__stage_begin(s, lane);
        if (held(s, lane, &status))
            continue;
        if (group)
            group->guess(s->problem->data, lane);
        s->lanes[(*active)++] = lane;
    }
    return status;
}

/* Lanes of a group, from `first` on. */
typedef struct {
    size_t first, count, left; /* left: are under way */
    bool settled[NEVH__MOST_GROUP];
} group_state;

static int fixed_point_settle(nevh__stage_solver *s, group_state *g, size_t i,
                              nevh__stage_state state, size_t sweeps) {
    const nevh__stage_problem *e = s->problem;
    g->settled[i] = true;
    g->left--;
    s->work->sweeps += sweeps;
    e->group->count(e->data, sweeps);
    if (state != NEVH__DONE)
        return hand_over(s, g->first + i);
    e->group->fetch(e->data, i);
    return NEVH_OK;
}

static bool fixed_point_all_finite(const group_state *g,
                                   const nevh__stage_progress made[]) {
    bool finite = true;
    for (size_t i = 0; i < g->count; i++)
        finite &= g->settled[i] || made[i].change < INFINITY;
    return finite;
}

/* One lane, from where the group's one lane stands after so many sweeps. */
static int iterate_one(nevh__stage_solver *s, size_t lane, size_t sweeps) {
    const nevh__stage_problem *e = s->problem;
    nevh__stage_progress made;
    nevh__stage_state state = NEVH__GO_ON;
    for (; state == NEVH__GO_ON && sweeps < NEVH__STAGE_SWEEPS; sweeps++) {
        int status = e->group->sweep(e->data, &made);
        bool lost = status == NEVH_EDOM && s->lane[lane].strays;
        if (status && !lost)
            return status;
        state = lost ? NEVH__STUCK : nevh__fixed_point_judge(s, lane, &made);
        if (s->status)
            return s->status;
    }
    s->work->sweeps += sweeps;
    e->group->count(e->data, sweeps);
    if (state != NEVH__DONE)
        return hand_over(s, lane);
    e->group->fetch(e->data, 0);
    return NEVH_OK;
}

static int solve_one(nevh__stage_solver *s, size_t lane) {
    int status = NEVH_OK;
    s->lane[lane] = nevh__stage_fresh;
    return held(s, lane, &status) ? status : iterate_one(s, lane, 0);
}

/* One sweep of several.  NEVH_EDOM: each has to be swept alone, lest one decide
   over the others. */
static int sweep_group(nevh__stage_solver *s, group_state *g, size_t sweeps) {
    const nevh__stage_problem *e = s->problem;
    nevh__stage_progress made[NEVH__MOST_GROUP];
    int status = e->group->sweep(e->data, made);
    if (!status && !fixed_point_all_finite(g, made))
        status = NEVH_EDOM;
    for (size_t i = 0; !status && i < g->count; i++) {
        if (g->settled[i])
            continue;
        nevh__stage_state state =
            nevh__fixed_point_judge(s, g->first + i, &made[i]);
        if (s->status)
            return s->status;
        if (state != NEVH__GO_ON || sweeps == NEVH__STAGE_SWEEPS)
            status = fixed_point_settle(s, g, i, state, sweeps);
    }
    return status;
}

/* The last lanes of a group go on one by one. */
static int iterate_rest(nevh__stage_solver *s, const group_state *g,
                        size_t sweeps) {
    const nevh__stage_problem *e = s->problem;
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < g->count; i++) {
        if (g->settled[i])
            continue;
        e->group->leave(e->data, g->first + i);
        status = iterate_one(s, g->first + i, sweeps);
    }
    return status;
}

/* Lanes that have to be swept alone are listed. */
static int solve_group(nevh__stage_solver *s, size_t first, size_t count,
                       size_t *active) {
    group_state g = {.first = first, .count = count, .left = count};
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < count; i++) {
        s->lane[first + i] = nevh__stage_fresh;
        g.settled[i] = held(s, first + i, &status);
        g.left -= g.settled[i];
    }
    for (size_t i = 1; !status && g.left > 0; i++) {
        status = sweep_group(s, &g, i);
        if (!status && g.left <= s->problem->group->few)
            return iterate_rest(s, &g, i);
    }
    if (status != NEVH_EDOM)
        return status;
    status = NEVH_OK;
    for (size_t i = 0; !status && i < count; i++)
        if (!g.settled[i])
            status = fixed_point_begin(s, first + i, first + i + 1, active);
    return status;
}

int nevh__stage_solve(nevh__stage_solver *s,
                      const nevh__stage_problem *problem) {
    size_t width = s->work->width, first = 0, active = 0;
    int status = NEVH_OK;
    s->problem = problem;
    s->status = NEVH_OK;
    find_scales(s);
    while (problem->group && !status && first < width) {
        size_t count = problem->group->begin(problem->data, first, s->unit);
        if (count == 0)
            break;
        status = count == 1 ? solve_one(s, first)
                            : solve_group(s, first, count, &active);
        first += count;
    }
    if (!status)
        status = fixed_point_begin(s, first, width, &active);
    for (size_t i = 1; !status && active > 0; i++)
        status =
            fixed_point_sweep(s, s->lanes, &active, i >= NEVH__STAGE_SWEEPS);
    return status;
}
