/* nevh: states of a run that is to come, for the binding of Tao's copies.

   Unlike the pilot of lib/gradient, which need not stay on an orbit, this one
   is accurate: at states that are not met, H may be curved by orders of
   magnitude more.  GSL's Prince-Dormand pair of order 8 takes some steps from
   one state to the next.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/control_private.h"
#include "tao_private.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <nevh/gsl.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 24, STRIDE = 8, EACH = 140 /* gradients a sample */ };
static const double tolerance = 1e-8; /* of a step, in lengths */
static const double most_work = 2e7;  /* values of terms */

/* As many samples as most_work allows, and the selection has room for. */
static size_t affordable(const nevh__step_selection *e) {
    const nevh_field *f = e->field;
    size_t room = e->samples.most - e->samples.count;
    double work = 1;
    for (size_t j = 0; j < f->n_terms; j++)
        work += (double)f->terms[j].term->decl.count * (double)f->terms[j].nv *
                fmax(1, f->gradient->order);
    double most = fmin(SAMPLES, most_work / (work * EACH));
    return (size_t)fmin(most, (double)room);
}

/* GSL's stepper and its state; y: room for four states. */
typedef struct {
    gsl_odeiv2_system ode;
    gsl_odeiv2_step *step;
    nevh__control control;
    gsl_odeiv2_evolve *evolve;
    double *y;
} trial_run;

/* From lane `at` of the samples to `count` states more. */
static void run(nevh__step_selection *e, trial_run *m, size_t at,
                size_t count) {
    nevh__samples *s = &e->samples;
    size_t n = e->field->n;
    double *y = m->y, t = s->t[at];
    memcpy(y, s->q + at * n, n * sizeof *y);
    memcpy(y + n, s->p + at * n, n * sizeof *y);
    double h = nevh__first_step(e, &m->ode, t, y, y + 2 * n);
    int status = h > 0 ? GSL_SUCCESS : GSL_FAILURE;
    gsl_odeiv2_evolve_reset(m->evolve);
    for (size_t i = 1; !status && i <= count * STRIDE; i++) {
        status = gsl_odeiv2_evolve_apply(m->evolve, &m->control.gsl, m->step,
                                         &m->ode, &t, HUGE_VAL, &h, y);
        if (status || i % STRIDE)
            continue;
        s->t[s->count] = t;
        memcpy(s->q + s->count * n, y, n * sizeof *y);
        memcpy(s->p + s->count * n, y + n, n * sizeof *y);
        s->count++;
    }
}

/* Memory that is out inside GSL ends in its error handler, which aborts, so
   as much is asked for first. */
static bool assemble(trial_run *m, const nevh__step_selection *e) {
    size_t d = 2 * e->field->n;
    double *trial = nevh__array(40 * d, sizeof *trial);
    free(trial);
    *m = (trial_run){.ode = nevh_gsl_system(e->field)};
    m->y = nevh__array(2 * d, sizeof *m->y);
    if (!trial || !m->y || !m->ode.jacobian)
        return false;
    m->step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, d);
    m->control = (nevh__control){.absolute = tolerance, .scale = e->length};
    nevh__control_init(&m->control);
    m->evolve = gsl_odeiv2_evolve_alloc(d);
    return m->step && m->evolve;
}

static void dismantle(trial_run *m) {
    if (m->step)
        gsl_odeiv2_step_free(m->step);
    if (m->evolve)
        gsl_odeiv2_evolve_free(m->evolve);
    free(m->y);
}

bool nevh__add_run(nevh__step_selection *e) {
    size_t count = affordable(e) / e->lanes;
    bool given = e->options->q || e->options->p;
    if (count == 0 || !given)
        return true;
    trial_run m;
    bool made = assemble(&m, e);
    for (size_t lane = 0; made && lane < e->lanes; lane++)
        run(e, &m, lane, count);
    dismantle(&m);
    return made;
}
