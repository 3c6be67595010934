/* nevh: a step that branches off from the main orbit to a given time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/branch_private.h"
#include <float.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double close_enough = 1e-9; /* of the time of a step */
enum { MOST_TRIALS = 100 };

static size_t state_size(const nevh_stepper *s) {
    return s->work.size * sizeof(double);
}

static size_t memory_size(const nevh_stepper *s) {
    return s->rows * s->work.width * sizeof(double);
}

/* GSL aborts where memory is out: ask first for more than it takes. */
static bool memory_suffices(void) {
    void *trial = nevh__array(64, sizeof(double));
    free(trial);
    return trial != NULL;
}

int nevh__branch_open(nevh__branch *b, nevh_stepper *s) {
    size_t size = s->work.size, memory = s->rows * s->work.width;
    b->stepper = s;
    b->q = nevh__array(4 * size + memory, sizeof *b->q);
    if (b->q && s->own_time && memory_suffices())
        b->solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    if (!b->q || (s->own_time && !b->solver))
        return nevh__fail(&s->report, NEVH_ENOMEM, "out of memory");
    b->p = b->q + size;
    b->q_end = b->p + size;
    b->p_end = b->q_end + size;
    b->memory = b->p_end + size;
    return NEVH_OK;
}

void nevh__branch_close(nevh__branch *b) {
    if (b->solver)
        gsl_root_fsolver_free(b->solver);
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

/* How far the time after a step of `fraction` of h is from the end, as a part
   of the main orbit's step.  The ends of the bracket are known. */
static double miss(double fraction, void *data) {
    nevh__branch *b = data;
    double due = (b->t_end - b->t) / b->elapsed;
    if (b->status || fraction == 0)
        return -due;
    if (fraction == 1)
        return 1 - due;
    b->status = try_step(b, fraction * b->h);
    return b->status ? -due : b->stepper->work.elapsed / b->elapsed - due;
}

/* The fraction of h after which the time is t_end. */
static double find_fraction(nevh__branch *b) {
    gsl_function f = {miss, b};
    double fraction = (b->t_end - b->t) / b->elapsed;
    int status = gsl_root_fsolver_set(b->solver, &f, 0, 1);
    for (int i = 0; !status && !b->status && i < MOST_TRIALS; i++) {
        status = gsl_root_fsolver_iterate(b->solver);
        fraction = gsl_root_fsolver_root(b->solver);
        double low = gsl_root_fsolver_x_lower(b->solver);
        double high = gsl_root_fsolver_x_upper(b->solver);
        if (high - low <= 4 * DBL_EPSILON * fraction)
            break;
    }
    return fraction;
}

int nevh__branch_step(nevh__branch *b) {
    nevh_stepper *s = b->stepper;
    double due = b->t_end - b->t;
    if (!s->own_time || due / b->elapsed >= 1)
        return try_step(b, b->h);
    double fraction = find_fraction(b);
    int status = b->status ? b->status : try_step(b, fraction * b->h);
    if (status || fabs(s->work.elapsed - due) <= close_enough * fabs(due))
        return status;
    return nevh__fail(&s->report, NEVH_EMAXITER,
                      "no part of the step of %g from t = %.9g ends at %.9g: "
                      "take a smaller one",
                      b->h, b->t, b->t_end);
}
