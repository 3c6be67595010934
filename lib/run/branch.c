/* nevh: a step that branches off from the main orbit to a given time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/branch_private.h"
#include "run/fraction_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double close_enough = 1e-9; /* of the time of a step */

static size_t state_size(const nevh_stepper *s) {
    return s->work.size * sizeof(double);
}

static size_t memory_size(const nevh_stepper *s) {
    return s->rows * s->work.width * sizeof(double);
}

int nevh__branch_open(nevh__branch *b, nevh_stepper *s) {
    size_t size = s->work.size, memory = s->rows * s->work.width;
    b->stepper = s;
    b->q = nevh__array(4 * size + memory, sizeof *b->q);
    if (!b->q)
        return nevh__no_memory(&s->report);
    b->p = b->q + size;
    b->q_end = b->p + size;
    b->p_end = b->q_end + size;
    b->memory = b->p_end + size;
    return NEVH_OK;
}

void nevh__branch_close(nevh__branch *b) {
    free(b->q);
}

void nevh__branch_keep(nevh__branch *b, double t, const double q[],
                       const double p[]) {
    nevh_stepper *s = b->stepper;
    b->t = t;
    b->roundoff = s->time_roundoff;
    memcpy(b->q, q, state_size(s));
    memcpy(b->p, p, state_size(s));
    memcpy(b->memory, s->work.memory, memory_size(s));
}

void nevh__branch_resume(const nevh__branch *b) {
    nevh_stepper *s = b->stepper;
    s->last_t = b->t;
    s->time_roundoff = b->roundoff;
    memcpy(s->work.memory, b->memory, memory_size(s));
}

/* A step of h from the main orbit's state to q_end, p_end. */
static int try_step(nevh__branch *b, double h) {
    nevh_stepper *s = b->stepper;
    memcpy(b->q_end, b->q, state_size(s));
    memcpy(b->p_end, b->p, state_size(s));
    nevh__branch_resume(b);
    return nevh__advance(s, b->t, h, b->q_end, b->p_end);
}

int nevh__branch_measure(nevh__branch *b) {
    int status = try_step(b, b->h);
    b->elapsed = b->stepper->work.elapsed;
    return status;
}

struct nevh__fraction_owner {
    nevh__branch *branch;
    double due;
    int status;
};

NEVH__INLINE double nevh__fraction_miss(struct nevh__fraction_owner *o,
                                        double fraction) {
    nevh__branch *b = o->branch;
    o->status = try_step(b, fraction * b->h);
    return o->status ? NAN : b->stepper->work.elapsed / b->elapsed - o->due;
}

int nevh__branch_step(nevh__branch *b) {
    nevh_stepper *s = b->stepper;
    double due = b->t_end - b->t;
    if (!s->own_time || due / b->elapsed >= 1)
        return try_step(b, b->h);
    struct nevh__fraction_owner owner = {b, due / b->elapsed, NEVH_OK};
    double fraction = nevh__fraction_find(&owner, owner.due);
    int status = owner.status;
    if (!status)
        status = try_step(b, fraction * b->h);
    if (status || fabs(s->work.elapsed - due) <= close_enough * fabs(due))
        return status;
    return nevh__fail(&s->report, NEVH_EMAXITER,
                      "no part of the step of %g from t = %.9g ends at %.9g: "
                      "take a smaller one",
                      b->h, b->t, b->t_end);
}
