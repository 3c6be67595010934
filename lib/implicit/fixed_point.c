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
   quotient.  Lanes are independent of each other: one that is done is left
   alone.  A lane that makes no progress at large changes, that is still under
   way after `most_sweeps`, or that leaves the domain of H with growing changes
   is handed to the rescue.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include "gradient/field_private.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { MOST_SWEEPS = 100, MOST_STALLS = 8 };
static const double small = 1e-10;
static const double noise_margin = 16;

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
        s->lane[lane] = (nevh__stage_lane){.change = INFINITY};
    }
}

/* The noise of one lane's gradients at the start of the step; in slope order:
   dH/dp first.  Needs a lane's state in one piece. */
static bool find_noise(nevh__stage_solver *s, size_t lane) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    double *q = s->noise + 2 * w->n, *p = q + w->n;
    for (size_t k = 0; k < w->n; k++) {
        q[k] = e->q[k * w->width + lane];
        p[k] = e->p[k * w->width + lane];
    }
    return nevh__field_noise(w->field, e->t, q, p, s->noise + w->n, s->noise) ==
           NEVH_OK;
}

bool nevh__stage_small(nevh__stage_solver *s, size_t lane, double change,
                       const double *out, size_t stride, const double *x) {
    if (change <= small)
        return true;
    if (!(change < INFINITY) || !find_noise(s, lane))
        return false;
    size_t width = s->work->width;
    double h = fabs(s->problem->h);
    for (size_t row = 0; row < s->rows; row++) {
        size_t k = row / s->stages;
        double allowed =
            small * s->scale[k * width + lane] + noise_margin * h * s->noise[k];
        if (!(h * fabs(out[row * stride] - x[row * width]) <= allowed))
            return false;
    }
    return true;
}

typedef struct {
    bool moved, improved;
    double change;
} progress;

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
    l->grew |= made.change > l->change;
    l->change = made.change;
    if (!made.moved)
        return DONE;
    if (made.improved) {
        l->grace = false;
        return GO_ON;
    }
    if (l->grace && nevh__stage_small(s, lane, l->change, out, stride,
                                      s->problem->x + lane))
        return DONE;
    l->stalls += l->grace;
    l->grace = true;
    return l->stalls < MOST_STALLS ? GO_ON : STUCK;
}

/* One sweep over the lanes under way; those that are stuck are rescued. */
static int sweep(nevh__stage_solver *s, size_t *active, bool last) {
    size_t left = 0, count = *active;
    int status = s->problem->map(s->problem->data, count, s->lanes,
                                 s->problem->x, s->out);
    bool grew = false;
    for (size_t a = 0; a < count; a++)
        grew |= s->lane[s->lanes[a]].grew;
    if (status && (status != NEVH_EDOM || !grew))
        return status;
    bool lost = status == NEVH_EDOM;
    s->work->sweeps += count;
    for (size_t a = 0; a < count; a++) {
        size_t lane = s->lanes[a];
        lane_state state = lost ? STUCK : judge(s, lane, count, s->out + a);
        if (!lost)
            take(s, lane, count, s->out + a);
        if (state == GO_ON && !last)
            s->lanes[left++] = lane;
        else if (state != DONE && (status = nevh__rescue_lane(s, lane)))
            return status;
    }
    *active = left;
    return NEVH_OK;
}

int nevh__stage_solve(nevh__stage_solver *s,
                      const nevh__stage_problem *problem) {
    s->problem = problem;
    begin(s);
    size_t active = s->work->width;
    int status = NEVH_OK;
    for (size_t i = 1; !status && active > 0; i++)
        status = sweep(s, &active, i >= MOST_SWEEPS);
    return status;
}
