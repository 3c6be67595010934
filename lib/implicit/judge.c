/* nevh: whether an iteration over stages gets on.

   It is not stopped at a tolerance, which would leave an error of one sign and
   let the energy drift [Hairer, McLachlan, Razakarivony, "Achieving Brouwer's
   law with implicit Runge-Kutta methods", BIT 48 (2008)].  The rule is that of
   Antonana, Makazaga, Murua ["Reducing and monitoring round-off error
   propagation for symplectic implicit Runge-Kutta schemes", Numer. Algorithms
   (2017)]: remember for each unknown the smallest change so far; sweep on while
   some unknown improves its own; when none does, allow one grace sweep, then
   stop.

   Their rule is believed only once the changes are small, since in the first
   sweeps of a hard step they may rise before they fall.  Small is 1e-10 of
   the unknown's scale, or what the rounding of H makes of a difference
   quotient.  And the largest change counts as one more unknown: where H is
   separable, sweeps take errors from momenta to coordinates and back in two
   chains that do not meet, and one of them may be at rounding by chance.  Under
   differences unknowns go on improving by chance, each drawing
   new noise in every sweep; there the iteration also ends when all changes are
   within that noise and the largest of them has ceased to fall.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include "work/work_private.h"
#include "gradient/field_private.h"
#include "system/system_private.h"
#include <float.h>
#include <math.h>

enum { MOST_STALLS = 8 };
const double nevh__stage_tiny = 1e-10;
const double nevh__stage_margin = 16;
static const double may_be_noise = 1e-4; /* not worth a look above */
static const double hardly_less = 0.9;

const nevh__stage_lane nevh__stage_fresh = {
    .change = INFINITY, .before = INFINITY, .least = INFINITY};

void nevh__stage_begin(nevh__stage_solver *s, size_t lane) {
    size_t width = s->work->width;
    for (size_t row = 0; row < s->rows; row++)
        s->least[row * width + lane] = INFINITY;
    s->lane[lane] = nevh__stage_fresh;
}

void nevh__stage_noise(nevh__stage_solver *s, size_t lane) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    double *q = s->noise + 2 * w->n, *p = q + w->n;
    for (size_t k = 0; k < w->n; k++) {
        q[k] = e->q[k * w->width + lane];
        p[k] = e->p[k * w->width + lane];
    }
    s->status =
        nevh__work_noise(s->work, e->t, q, p, s->noise + w->n, s->noise);
}

/* What noise makes of a step of one lane, in units of scale: the largest over
   all variables, since each draws the others along. */
static double noise_level(nevh__stage_solver *s, size_t lane) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    double most = 0;
    if (e->noise)
        s->status = e->noise(e->data, lane, s->noise);
    else
        nevh__stage_noise(s, lane);
    for (size_t k = 0; !s->status && k < 2 * w->n; k++)
        most = fmax(most, s->noise[k] / s->scale[k * w->width + lane]);
    return fabs(s->problem->h) * most;
}

bool nevh__stage_small(nevh__stage_solver *s, size_t lane, double change) {
    return change <= nevh__stage_tiny ||
           (change < INFINITY &&
            change <=
                nevh__stage_tiny + nevh__stage_margin * noise_level(s, lane));
}

/* Differences only: the last sweep drew noise and nothing else. */
static bool drowned(nevh__stage_solver *s, size_t lane,
                    const nevh__stage_progress *made) {
    return (s->problem->noise || s->work->field->gradient->offsets) &&
           made->change < may_be_noise &&
           made->change >= hardly_less * s->lane[lane].least &&
           made->change <= 2 * DBL_EPSILON + noise_level(s, lane);
}

nevh__stage_progress nevh__stage_compare(nevh__stage_solver *s, size_t lane,
                                         size_t stride, const double out[],
                                         const nevh__stage_rule *rule) {
    size_t width = s->work->width;
    const double *x = s->problem->x + lane;
    double *least = s->least + lane;
    nevh__stage_progress made = {false, 0, 0};
    for (size_t k = s->first, row = 0; k < 2 * s->work->n; k++) {
        double most = 0;
        for (size_t end = row + s->stages; row < end; row++) {
            double change = fabs(out[row * stride] - x[row * width]);
            bool better = change > 0 && change < rule->by * least[row * width];
            least[row * width] = better ? change : least[row * width];
            made.improved += better;
            made.moved |= change != 0;
            most = change > most ? change : most;
        }
        made.change = fmax(made.change, most * s->unit[k * width + lane]);
    }
    return made;
}

nevh__stage_state nevh__stage_judge(nevh__stage_solver *s, size_t lane,
                                    const nevh__stage_progress *made,
                                    const nevh__stage_rule *rule) {
    nevh__stage_lane *l = &s->lane[lane];
    l->strays |= made->change > 1 ||
                 (made->change > l->change && made->change > nevh__stage_tiny);
    l->before = l->change;
    l->change = made->change;
    if (!made->moved || drowned(s, lane, made))
        return NEVH__DONE;
    bool falls = rule->by == 1 && made->change < l->least;
    l->least = made->change < l->least ? made->change : l->least;
    if (made->improved > rule->chance || falls) {
        l->grace = false;
        return NEVH__GO_ON;
    }
    if (l->grace && rule->small(s, lane, l->change))
        return NEVH__DONE;
    l->stalls += l->grace;
    l->grace = true;
    return l->stalls < MOST_STALLS ? NEVH__GO_ON : NEVH__STUCK;
}

void nevh__stage_take(nevh__stage_solver *s, size_t lane, size_t stride,
                      const double out[]) {
    size_t width = s->work->width;
    double *x = s->problem->x + lane;
    for (size_t row = 0; row < s->rows; row++)
        x[row * width] = out[row * stride];
}
