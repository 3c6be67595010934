/* nevh: runs that end at a given time.

   A main orbit's steps are never shortened: the end, where it does not fall on
   a step, is reached by one step more from a copy of the state, and the
   stepper's memory stays with the orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double whole = 1e-9; /* how near to a whole number of steps */
enum { MOST_TRIALS = 100 };

/* The way to the end from the last state of the main orbit. */
typedef struct {
    nevh_stepper *stepper;
    double t, t_end, h;
    double roundoff;        /* of t, by rounding */
    double elapsed;         /* by a step of h */
    double *q, *p, *memory; /* the main orbit's */
    double *q_end, *p_end;  /* after a trial step */
    int status;
    gsl_root_fsolver *solver; /* NULL: times are not the scheme's own */
} branch;

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

static int branch_open(branch *b, nevh_stepper *s) {
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

static void branch_close(branch *b) {
    if (b->solver)
        gsl_root_fsolver_free(b->solver);
    free(b->q);
}

static void keep(branch *b, double t, const double q[], const double p[]) {
    nevh_stepper *s = b->stepper;
    b->t = t;
    b->roundoff = s->time_roundoff;
    memcpy(b->q, q, state_size(s));
    memcpy(b->p, p, state_size(s));
    memcpy(b->memory, s->work.memory, memory_size(s));
}

static void resume(const branch *b) {
    nevh_stepper *s = b->stepper;
    s->last_t = b->t;
    s->time_roundoff = b->roundoff;
    memcpy(s->work.memory, b->memory, memory_size(s));
}

/* A step of h from the main orbit's state to q_end, p_end. */
static int try_step(branch *b, double h) {
    nevh_stepper *s = b->stepper;
    memcpy(b->q_end, b->q, state_size(s));
    memcpy(b->p_end, b->p, state_size(s));
    resume(b);
    return nevh__advance(s, b->t, h, b->q_end, b->p_end);
}

/* How far the time after a step of `fraction` of h is from the end, as a part
   of the main orbit's step.  The ends of the bracket are known. */
static double miss(double fraction, void *data) {
    branch *b = data;
    double due = (b->t_end - b->t) / b->elapsed;
    if (b->status || fraction == 0)
        return -due;
    if (fraction == 1)
        return 1 - due;
    b->status = try_step(b, fraction * b->h);
    return b->status ? -due : b->stepper->work.elapsed / b->elapsed - due;
}

/* The fraction of h after which the time is t_end. */
static double find_fraction(branch *b) {
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

/* The step that ends at t_end. */
static int step_to_end(branch *b) {
    nevh_stepper *s = b->stepper;
    double due = b->t_end - b->t;
    if (!s->own_time || due / b->elapsed >= 1)
        return try_step(b, b->h);
    double fraction = find_fraction(b);
    int status = b->status ? b->status : try_step(b, fraction * b->h);
    if (status || fabs(s->work.elapsed - due) <= whole * fabs(due))
        return status;
    return nevh__fail(&s->report, NEVH_EMAXITER,
                      "no part of the step of %g from t = %.9g ends at %.9g: "
                      "take a smaller one",
                      b->h, b->t, b->t_end);
}

/* The last stretch; the stepper stays on the main orbit. */
static int branch_off(branch *b, double h, double q[], double p[],
                      const nevh_observer observers[], size_t count) {
    nevh_stepper *s = b->stepper;
    b->h = h;
    int status = step_to_end(b);
    memcpy(q, status ? b->q : b->q_end, state_size(s));
    memcpy(p, status ? b->p : b->p_end, state_size(s));
    if (!status) { /* what is shown includes what the last step gained */
        s->taken++;
        status =
            nevh__show(s, s->taken, true, b->t_end, q, p, observers, count);
    }
    resume(b);
    if (status && s->taken == 0)
        nevh__undo(s);
    else
        nevh__remember(s, b->q, b->p);
    return status;
}

/* One step of the main orbit; *t in and out. */
static int own_step(branch *b, double h, double *t, double q[], double p[]) {
    nevh_stepper *s = b->stepper;
    keep(b, *t, q, p);
    int status = nevh__advance(s, *t, h, q, p);
    if (status)
        return status;
    b->elapsed = s->work.elapsed;
    *t = s->last_t;
    if (b->elapsed / h > 0)
        return NEVH_OK;
    resume(b);
    memcpy(q, b->q, state_size(s));
    memcpy(p, b->p, state_size(s));
    return nevh__fail(&s->report, NEVH_EFAILED,
                      "%s: no time has passed in the step from t = %.9g by %g",
                      s->work.integrator->name, b->t, h);
}

/* Steps of the scheme's own time, until the next one would pass the end. */
static int run_own(branch *b, double h, double q[], double p[],
                   const nevh_observer observers[], size_t count) {
    nevh_stepper *s = b->stepper;
    double t = b->t, forward = h > 0 ? 1 : -1;
    int status = nevh__show(s, 0, t == b->t_end, t, q, p, observers, count);
    while (!status && t != b->t_end) {
        status = own_step(b, h, &t, q, p);
        if (status)
            break;
        if ((t - b->t_end) * forward > 0)
            return branch_off(b, h, q, p, observers, count);
        s->taken++;
        status =
            nevh__show(s, s->taken, t == b->t_end, t, q, p, observers, count);
    }
    nevh__end_run(s, q, p);
    return status;
}

/* `steps` steps that end at t_end to the last bit. */
static int run_whole(branch *b, double h, double steps, double q[], double p[],
                     const nevh_observer observers[], size_t count) {
    nevh_stepper *s = b->stepper;
    double t0 = b->t, before = fmax(steps - 1, 0);
    int status = nevh__run_steps(s, t0, h, (size_t)before, steps == 0, q, p,
                                 observers, count);
    if (!status && steps > 0)
        status = nevh__advance(s, t0 + before * h, h, q, p);
    if (!status && steps > 0) {
        s->taken++;
        s->last_t = b->t_end;
        status =
            nevh__show(s, s->taken, true, b->t_end, q, p, observers, count);
    }
    nevh__end_run(s, q, p);
    return status;
}

bool nevh__whole_steps(double span, double *h, double *steps) {
    *steps = round(span / *h);
    if (span == 0)
        return true;
    if (*steps > 0 && fabs(span / *h - *steps) <= whole * *steps) {
        *h = span / *steps;
        return true;
    }
    *steps = floor(span / *h);
    return false;
}

/* Whole steps, and what is left. */
static int run_fixed(branch *b, double h, double q[], double p[],
                     const nevh_observer observers[], size_t count) {
    nevh_stepper *s = b->stepper;
    double t0 = b->t, steps;
    if (nevh__whole_steps(b->t_end - t0, &h, &steps))
        return run_whole(b, h, steps, q, p, observers, count);
    int status =
        nevh__run_steps(s, t0, h, (size_t)steps, false, q, p, observers, count);
    if (status) {
        nevh__end_run(s, q, p);
        return status;
    }
    keep(b, t0 + steps * h, q, p);
    return branch_off(b, b->t_end - b->t, q, p, observers, count);
}

/* Also where h or a time is not a number. */
static int check(nevh_stepper *s, double t0, double h, double t_end) {
    double steps = (t_end - t0) / h;
    if (steps >= 0 && steps < 0x1p53)
        return NEVH_OK;
    return nevh__fail(&s->report, NEVH_EINVAL,
                      "no number of steps of %g leads from %.9g to %.9g", h, t0,
                      t_end);
}

int nevh_run_until(nevh_stepper *s, double t0, double h, double t_end,
                   double q[], double p[], const nevh_observer observers[],
                   size_t count) {
    int status = nevh__begin_run(s, t0, h, q, p);
    if (status)
        return status;
    branch b = {.t = t0, .t_end = t_end};
    status = check(s, t0, h, t_end);
    if (!status)
        status = branch_open(&b, s);
    if (status)
        nevh__undo(s);
    else
        status =
            (s->own_time ? run_own : run_fixed)(&b, h, q, p, observers, count);
    branch_close(&b);
    return status;
}
