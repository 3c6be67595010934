/* nevh: fixed-point iteration to the rounding floor.

   The iteration is not stopped at a tolerance, which would leave an error of
   one sign and let the energy drift [Hairer, McLachlan, Razakarivony,
   "Achieving Brouwer's law with implicit Runge-Kutta methods", BIT 48 (2008)].
   The rule is that of Antonana, Makazaga, Murua ["Reducing and monitoring
   round-off error propagation for symplectic implicit Runge-Kutta schemes",
   Numer. Algorithms (2017)]: remember for each unknown the smallest change so
   far; sweep on while some unknown improves its own; when none does, allow one
   grace sweep, then stop.

   Their rule is believed only once the changes are small, since in the first
   sweeps of a hard step they may rise before they fall.  Small is 1e-10 of
   the unknown's scale, or what the rounding of H makes of a difference
   quotient.  Under differences unknowns go on improving by chance, each drawing
   new noise in every sweep; there the iteration also ends when all changes are
   within that noise and the largest of them has ceased to fall.  Lanes are
   independent of each other: one that is done is left alone.  A lane that makes
   no progress at large changes, that is still under way after MOST_SWEEPS, or
   that leaves the domain of H with growing changes is handed to the rescue.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include "gradient/field_private.h"
#include "work_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_SWEEPS = 100, MOST_STALLS = 8 };
static const double small = 1e-10;
static const double noise_margin = 16;
static const double may_be_noise = 1e-4; /* not worth a look above */

nevh__stage_solver *nevh__stage_solver_new(nevh_work *w, size_t stages) {
    nevh__stage_solver *s = nevh__array(1, sizeof *s);
    if (!s)
        return NULL;
    s->work = w;
    s->stages = stages;
    s->rows = 2 * w->n * stages;
    s->scale = nevh__array(2 * w->size, sizeof *s->scale);
    s->out = nevh__array(s->rows * w->width, sizeof *s->out);
    s->least = nevh__array(s->rows * w->width, sizeof *s->least);
    s->noise = nevh__array(4 * w->n, sizeof *s->noise);
    s->lanes = nevh__array(w->width, sizeof *s->lanes);
    s->lane = nevh__array(w->width, sizeof *s->lane);
    bool large = s->rows > 1024;
    s->rescue = large ? NULL : nevh__rescue_new(s);
    if (s->scale && s->out && s->least && s->noise && s->lanes && s->lane &&
        (large || s->rescue))
        return s;
    nevh__stage_solver_free(s);
    return NULL;
}

void nevh__stage_solver_free(nevh__stage_solver *s) {
    if (!s)
        return;
    nevh__rescue_free(s->rescue);
    free(s->scale);
    free(s->out);
    free(s->least);
    free(s->noise);
    free(s->lanes);
    free(s->lane);
    free(s);
}

static void begin(nevh__stage_solver *s) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    for (size_t i = 0; i < w->size; i++) {
        size_t k = i / w->width;
        s->scale[i] = fmax(w->scale[k], fabs(e->q[i]));
        s->scale[w->size + i] = fmax(w->scale[w->n + k], fabs(e->p[i]));
    }
    for (size_t i = 0; i < s->rows * w->width; i++)
        s->least[i] = INFINITY;
    for (size_t lane = 0; lane < w->width; lane++) {
        s->lanes[lane] = lane;
        s->lane[lane] =
            (nevh__stage_lane){.change = INFINITY, .least = INFINITY};
    }
}

/* What the noise of one lane's gradients makes of a step, in units of scale:
   the largest over all variables, since each draws the others along.  Taken at
   the start of the step, whose state it needs in one piece. */
static double noise_level(nevh__stage_solver *s, size_t lane) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    double *q = s->noise + 2 * w->n, *p = q + w->n, most = 0;
    for (size_t k = 0; k < w->n; k++) {
        q[k] = e->q[k * w->width + lane];
        p[k] = e->p[k * w->width + lane];
    }
    s->status =
        nevh__work_noise(s->work, e->t, q, p, s->noise + w->n, s->noise);
    for (size_t k = 0; !s->status && k < 2 * w->n; k++)
        most = fmax(most, s->noise[k] / s->scale[k * w->width + lane]);
    return fabs(e->h) * most;
}

bool nevh__stage_small(nevh__stage_solver *s, size_t lane, double change) {
    return change <= small ||
           (change < INFINITY &&
            change <= small + noise_margin * noise_level(s, lane));
}

typedef struct {
    bool moved, improved;
    double change;
} progress;

/* Differences only: the last sweep drew noise and nothing else. */
static bool drowned(nevh__stage_solver *s, size_t lane, const progress *made) {
    return s->work->field->gradient->offsets && made->change < may_be_noise &&
           made->change >= s->lane[lane].least &&
           made->change <= 2 * DBL_EPSILON + noise_level(s, lane);
}

/* Compares one lane's sweep with the one before. */
static progress compare(nevh__stage_solver *s, size_t lane, size_t stride,
                        const double *out) {
    size_t width = s->work->width;
    const double *x = s->problem->x + lane;
    double *least = s->least + lane;
    const double *scale = s->scale + lane;
    double h = fabs(s->problem->h);
    progress made = {false, false, 0};
    for (size_t k = 0, row = 0; k < 2 * s->work->n; k++) {
        double most = 0;
        for (size_t end = row + s->stages; row < end; row++) {
            double change = fabs(out[row * stride] - x[row * width]);
            bool better = change > 0 && change < least[row * width];
            least[row * width] = better ? change : least[row * width];
            made.improved |= better;
            made.moved |= change != 0;
            most = change > most ? change : most;
        }
        made.change = fmax(made.change, h * most / scale[k * width]);
    }
    return made;
}

static void take(nevh__stage_solver *s, size_t lane, size_t stride,
                 const double *out) {
    size_t width = s->work->width;
    double *x = s->problem->x + lane;
    for (size_t row = 0; row < s->rows; row++)
        x[row * width] = out[row * stride];
}

typedef enum { GO_ON, DONE, STUCK } lane_state;

static lane_state judge(nevh__stage_solver *s, size_t lane, size_t stride,
                        const double *out) {
    nevh__stage_lane *l = &s->lane[lane];
    progress made = compare(s, lane, stride, out);
    l->grew |= made.change > l->change && made.change > small;
    l->change = made.change;
    if (!made.moved || drowned(s, lane, &made))
        return DONE;
    l->least = fmin(l->least, made.change);
    if (made.improved) {
        l->grace = false;
        return GO_ON;
    }
    if (l->grace && nevh__stage_small(s, lane, l->change))
        return DONE;
    l->stalls += l->grace;
    l->grace = true;
    return l->stalls < MOST_STALLS ? GO_ON : STUCK;
}

static int sweep_alone(nevh__stage_solver *, size_t lanes[], size_t count,
                       size_t *active, bool last);

/* One sweep over lanes under way; those that remain so move to the front.
   Those that are stuck are rescued.  Where H is not defined for one, each is
   swept alone, lest it decide over the others. */
static int sweep(nevh__stage_solver *s, size_t lanes[], size_t *active,
                 bool last) {
    size_t count = *active;
    int status =
        s->problem->map(s->problem->data, count, lanes, s->problem->x, s->out);
    *active = 0;
    if (status == NEVH_EDOM && count > 1)
        return sweep_alone(s, lanes, count, active, last);
    bool lost = status == NEVH_EDOM && s->lane[lanes[0]].grew;
    if (status && !lost)
        return status;
    s->work->sweeps += count;
    for (size_t a = 0; a < count; a++) {
        size_t lane = lanes[a];
        lane_state state = lost ? STUCK : judge(s, lane, count, s->out + a);
        if (s->status)
            return s->status;
        if (!lost)
            take(s, lane, count, s->out + a);
        if (state == GO_ON && !last)
            lanes[(*active)++] = lane;
        else if (state != DONE && (status = nevh__rescue_lane(s, lane)))
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

int nevh__stage_solve(nevh__stage_solver *s,
                      const nevh__stage_problem *problem) {
    s->problem = problem;
    s->status = NEVH_OK;
    begin(s);
    size_t active = s->work->width;
    int status = NEVH_OK;
    for (size_t i = 1; !status && active > 0; i++)
        status = sweep(s, s->lanes, &active, i >= MOST_SWEEPS);
    return status;
}
