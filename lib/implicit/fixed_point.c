/* nevh: fixed-point iteration to the rounding floor.

   Lanes are independent of each other: one that is done is left alone.  One
   that contracts too slowly, makes no progress at large changes, is still under
   way after MOST_SWEEPS, or leaves the domain of H with changes that grow or
   exceed the scale is given to Newton's iteration, and where that had to be
   done, at once for the next HOLD steps, lest each waste the sweeps that fail.

   Too slowly: in a small system, more than 1/2 a sweep, which would take 50
   sweeps from scratch; 2 n stages plus about as many evaluations as stages buy
   Newton's matrix and six sweeps more, but a factored matrix costs what tens of
   sweeps do.  In a larger one, where it costs hundreds, more than 0.7: that
   would not be through after MOST_SWEEPS.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>

enum {
    MOST_SWEEPS = 100,
    MOST_SLOW = 4,
    SMALL_ROWS = 32,
    HOLD = 50,
    MOST_DENSE = 1024
};
static const double slow_small = 0.25, slow_large = 0.5; /* in two sweeps */

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
    s->scale = nevh__array(2 * w->size, sizeof *s->scale);
    size_t unknowns = nevh__padded(s->rows * w->width);
    s->room = nevh__array(2 * unknowns + NEVH__LANES, sizeof *s->room);
    s->out = s->room ? nevh__aligned(s->room) : NULL;
    s->least = s->room ? s->out + unknowns : NULL;
    s->unit = nevh__array(2 * w->size, sizeof *s->unit);
    s->noise = nevh__array(4 * w->n, sizeof *s->noise);
    s->lanes = nevh__array(w->width, sizeof *s->lanes);
    s->lane = nevh__array(w->width, sizeof *s->lane);
    bool large = 2 * w->n * s->stages > MOST_DENSE;
    s->newton = large ? NULL : nevh__newton_new(s);
    s->rescue = large ? NULL : nevh__rescue_new(s);
    if (s->scale && s->unit && s->room && s->noise && s->lanes && s->lane &&
        (large || (s->newton && s->rescue)))
        return s;
    nevh__stage_solver_free(s);
    return NULL;
}

void nevh__stage_solver_free(nevh__stage_solver *s) {
    if (!s)
        return;
    nevh__newton_free(s->newton);
    nevh__rescue_free(s->rescue);
    free(s->scale);
    free(s->unit);
    free(s->room);
    free(s->noise);
    free(s->lanes);
    free(s->lane);
    free(s);
}

static void find_scales(nevh__stage_solver *s) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    for (size_t i = 0; i < w->size; i++) {
        size_t k = i / w->width;
        s->scale[i] = fmax(w->scale[k], fabs(e->q[i]));
        s->scale[w->size + i] = fmax(w->scale[w->n + k], fabs(e->p[i]));
    }
    for (size_t i = 0; i < 2 * w->size; i++)
        s->unit[i] = fabs(e->h) / s->scale[i];
}

/* Whether the lane would take too long; looked at after a judgement. */
static bool too_slow(nevh__stage_solver *s, size_t lane, double before) {
    nevh__stage_lane *l = &s->lane[lane];
    double most = s->rows <= SMALL_ROWS ? slow_small : slow_large;
    bool slow = l->change > nevh__stage_tiny && l->change > most * before;
    l->slow = slow ? l->slow + 1 : 0;
    return l->slow >= MOST_SLOW && s->newton &&
           !nevh__stage_small(s, lane, l->change);
}

static const nevh__stage_rule rule = {1, 0, nevh__stage_small};

static nevh__stage_state judge(nevh__stage_solver *s, size_t lane,
                               const nevh__stage_progress *made) {
    double before = s->lane[lane].before;
    nevh__stage_state state = nevh__stage_judge(s, lane, made, &rule);
    return state == NEVH__GO_ON && too_slow(s, lane, before) ? NEVH__STUCK
                                                             : state;
}

/* What becomes of a lane whose sweep is out[row*stride]. */
static nevh__stage_state proceed(nevh__stage_solver *s, size_t lane,
                                 size_t stride, const double out[]) {
    nevh__stage_progress made =
        nevh__stage_compare(s, lane, stride, out, &rule);
    nevh__stage_state state = judge(s, lane, &made);
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
static int sweep(nevh__stage_solver *s, size_t lanes[], size_t *active,
                 bool last) {
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
        status = sweep(s, &lane, &one, last);
        if (one)
            lanes[(*active)++] = lane;
    }
    return status;
}

/* Lanes held by Newton's iteration are solved; the others are to be swept. */
static int begin(nevh__stage_solver *s, size_t *active) {
    double *hold = s->newton ? s->problem->hold : NULL;
    int status = NEVH_OK;
    *active = 0;
    find_scales(s);
    for (size_t lane = 0; !status && lane < s->work->width; lane++) {
        if (s->problem->sweep)
            s->lane[lane] = nevh__stage_fresh;
        else
            nevh__stage_begin(s, lane);
        if (!hold || !(hold[lane] > 0)) {
            s->lanes[(*active)++] = lane;
            continue;
        }
        hold[lane] -= 1;
        status = nevh__newton_lane(s, lane);
    }
    return status;
}

/* One lane that knows how to sweep and compare at once. */
static int sweep_orbit(nevh__stage_solver *s) {
    const nevh__stage_problem *e = s->problem;
    nevh__stage_progress made;
    nevh__stage_state state = NEVH__GO_ON;
    for (int i = 0; state == NEVH__GO_ON && i < MOST_SWEEPS; i++) {
        int status = e->sweep(e->sweeps, s->unit, &made);
        bool lost = status == NEVH_EDOM && s->lane->strays;
        if (status && !lost)
            return status;
        s->work->sweeps++;
        state = lost ? NEVH__STUCK : judge(s, 0, &made);
        if (s->status)
            return s->status;
    }
    if (state != NEVH__DONE)
        return hand_over(s, 0);
    e->fetch(e->data);
    return NEVH_OK;
}

int nevh__stage_solve(nevh__stage_solver *s,
                      const nevh__stage_problem *problem) {
    size_t active;
    s->problem = problem;
    s->status = NEVH_OK;
    int status = begin(s, &active);
    if (!status && active > 0 && problem->sweep)
        return sweep_orbit(s);
    for (size_t i = 1; !status && active > 0; i++)
        status = sweep(s, s->lanes, &active, i >= MOST_SWEEPS);
    return status;
}
