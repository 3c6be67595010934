/* nevh: iterations over stages are judged.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "implicit/implicit_private.h"
#include "implicit/stage_judge.h"
#include "work/work_private.h"
#include "gradient/field_private.h"
#include "system/system_private.h"
#include <math.h>

const nevh__stage_lane nevh__stage_fresh = {.change = INFINITY,
                                            .before = INFINITY,
                                            .least = INFINITY,
                                            .first = INFINITY};

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
    if (w->field->lanes)
        nevh__field_alone(w->field, lane);
    s->status =
        nevh__work_noise(s->work, e->t, q, p, s->noise + w->n, s->noise);
}

/* The largest of a lane's noise over its scale, of 2n variables. */
static double worst_noise(const nevh_work *w, const double noise[],
                          const double scale[], size_t lane) {
    double most = 0;
    for (size_t k = 0; k < 2 * w->n; k++)
        most = fmax(most, noise[k] / scale[k * w->width + lane]);
    return most;
}

/* The effect of noise on a step of one lane, in units of scale: the largest over
   all variables, since each affects the others. */
static double noise_level(nevh__stage_solver *s, size_t lane) {
    const nevh_work *w = s->work;
    const nevh__stage_problem *e = s->problem;
    if (e->noise)
        s->status = e->noise(e->data, lane, s->noise);
    else
        nevh__stage_noise(s, lane);
    return s->status ? 0
                     : fabs(e->h) * worst_noise(w, s->noise, s->scale, lane);
}

bool nevh__stage_small(nevh__stage_solver *s, size_t lane, double change) {
    return change <= NEVH__STAGE_TINY ||
           (change < INFINITY &&
            change <=
                NEVH__STAGE_TINY + NEVH__STAGE_MARGIN * noise_level(s, lane));
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

struct nevh__stage_judge_owner {
    nevh__stage_solver *s;
    size_t lane;
    const nevh__stage_rule *rule;
};

NEVH__INLINE bool nevh__stage_is_small(const nevh__stage_judged *x,
                                       double change) {
    return x->owner->rule->small(x->owner->s, x->owner->lane, change);
}

NEVH__INLINE double nevh__stage_noise_level(const nevh__stage_judged *x) {
    return noise_level(x->owner->s, x->owner->lane);
}

NEVH__INLINE nevh__stage_judged
judged(const struct nevh__stage_judge_owner *owner) {
    const nevh__stage_solver *s = owner->s;
    return (nevh__stage_judged){.chance = owner->rule->chance,
                                .falls = owner->rule->by == 1,
                                .noisy = s->problem->noise ||
                                         s->work->field->gradient->offsets,
                                .newton = s->newton,
                                .unknowns = s->rows,
                                .owner = owner};
}

nevh__stage_state nevh__stage_judge(nevh__stage_solver *s, size_t lane,
                                    const nevh__stage_progress *made,
                                    const nevh__stage_rule *rule) {
    const struct nevh__stage_judge_owner owner = {s, lane, rule};
    const nevh__stage_judged x = judged(&owner);
    return nevh__stage_judge_sweep(&x, &s->lane[lane], made);
}

const nevh__stage_rule nevh__fixed_point_rule = {1, 0, nevh__stage_small};

nevh__stage_state nevh__fixed_point_judge(nevh__stage_solver *s, size_t lane,
                                          const nevh__stage_progress *made) {
    const struct nevh__stage_judge_owner owner = {s, lane,
                                                  &nevh__fixed_point_rule};
    const nevh__stage_judged x = judged(&owner);
    return nevh__stage_judge_fixed_point(&x, &s->lane[lane], made);
}

void nevh__stage_take(nevh__stage_solver *s, size_t lane, size_t stride,
                      const double out[]) {
    size_t width = s->work->width;
    double *x = s->problem->x + lane;
    for (size_t row = 0; row < s->rows; row++)
        x[row * width] = out[row * stride];
}
