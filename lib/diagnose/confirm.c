/* nevh: a finer run, by which a statement is confirmed.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include "system/print_private.h"
#include <nevh/simd.h>
#include <math.h>
#include <nevh/confirm.h>
#include <nevh/diagnose.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double half = 0.5;
static const double usual_part = 1. / 30; /* of the run, to measure costs */
enum { FEWEST = 8, MOST = 4096 };         /* steps of that */
static const double dts_adaptive = 16;    /* a step that is landed on */

typedef struct {
    nevh_finer_kind kind;
    const nevh_integrator *integrator;
    nevh_options options;
    double dt;
} choice;

struct nevh_finer {
    nevh__report report;
    const nevh_system *system;
    nevh_finer_question question;
    choice chosen;
    nevh_stepper *stepper;
    char text[80];
    double allowed; /* seconds by nevh_counts_seconds */
    double part;
};

static double confirm_spent_by(const nevh_stepper *s, size_t steps) {
    nevh_counts c = nevh_stepper_counts(s);
    return nevh_counts_seconds(&c, s->work.n, s->work.integrator,
                               nevh_stepper_order(s), steps);
}

/* The costs of a run are measured until then. */
static size_t steps_to_try(const nevh_finer_question *q) {
    double steps = (double)q->steps * usual_part;
    steps = fmin(fmax(steps, FEWEST), MOST);
    return (size_t)fmin(steps, (double)q->steps);
}

/* A choice as a stepper, with exact gradients where all terms bring them. */
static nevh_stepper *stepper_of(const nevh_system *system, choice *c) {
    const nevh_gradient *given = c->options.gradient;
    c->options.gradient = nevh_exact;
    nevh_stepper *s = nevh_stepper_new(system, c->integrator, &c->options);
    if (nevh_stepper_status(s) != NEVH_ENOGRAD)
        return s;
    nevh_stepper_free(s);
    c->options.gradient = given;
    return nevh_stepper_new(system, c->integrator, &c->options);
}

/* The cost of a time of `until`; INFINITY where it is beyond `most`, or where the
   orbit ends. */
static double cost_of(nevh_finer *f, nevh_stepper *s, double dt, double until,
                      double most) {
    const nevh_finer_question *a = &f->question;
    size_t n = f->system->n, steps = (size_t)ceil(until / fabs(dt) - 1e-9);
    double *z = nevh__array(2 * n, sizeof *z), cost = 0;
    int status = z ? NEVH_OK : NEVH_ENOMEM;
    for (size_t k = 0; !status && k < n; k++) {
        z[k] = a->options->q[k];
        z[n + k] = a->options->p[k];
    }
    for (size_t i = 0; !status && cost <= most && i < steps; i++) {
        double t =
            s->own_time && i ? nevh_stepper_time(s) : a->t0 + (double)i * dt;
        status = nevh_stepper_apply(s, t, dt, z, z + n);
        cost = confirm_spent_by(s, i + 1);
    }
    free(z);
    if (status == NEVH_ENOMEM)
        nevh__fail(&f->report, status, "out of memory");
    return status || cost > most ? INFINITY : cost;
}

static bool keeps_tolerance(const nevh_finer_question *q) {
    return q->options->tolerance > 0 &&
           (nevh_integrator_adaptive(q->integrator) ||
            nevh_integrator_needs_tolerance(q->integrator));
}

static choice choice_of(const nevh_finer_question *q, nevh_finer_kind kind) {
    static const double finer = 16, finest = 1e-16;
    choice c = {kind, q->integrator, *q->options, q->dt};
    c.options.width = 1;
    c.options.balance = false;
    if (kind == NEVH_FINER_STEPS && keeps_tolerance(q))
        c.options.tolerance = fmax(c.options.tolerance / finer, finest);
    else if (kind == NEVH_FINER_STEPS)
        c.dt /= 2;
    else {
        bool series = kind == NEVH_FINER_TAYLOR;
        c.integrator = series ? nevh_taylor : nevh_dop853;
        c.options.tolerance = series ? 1e-15 : 1e-12;
        c.options.transform = NULL;
        c.dt *= series ? 1 : dts_adaptive;
    }
    return c;
}

static void confirm_describe(nevh_finer *f) {
    const choice *c = &f->chosen;
    const char *name = nevh_integrator_name(c->integrator);
    if (c->kind != NEVH_FINER_STEPS)
        snprintf(f->text, sizeof f->text, "%s", name);
    else if (keeps_tolerance(&f->question))
        nevh__print(f->text, sizeof f->text, "%s, tolerance = %.3g", name,
                    c->options.tolerance);
    else
        nevh__print(f->text, sizeof f->text, "%s, dt = %.4g", name, c->dt);
}

/* Takes that kind where it can be planned and costs no more than `most`; `whole`
   is what the question cost for the same time. */
static bool confirm_choose(nevh_finer *f, nevh_finer_kind kind, double until,
                           double whole, double most) {
    choice c = choice_of(&f->question, kind);
    nevh_stepper *s = stepper_of(f->system, &c);
    int status = nevh_stepper_status(s);
    double cost = status ? INFINITY : cost_of(f, s, c.dt, until, most);
    if (status)
        nevh__fail(&f->report, status, "%s",
                   s ? nevh_stepper_message(s) : "out of memory");
    nevh_stepper_free(s);
    if (!isfinite(cost))
        return false;
    f->chosen = c;
    f->stepper = stepper_of(f->system, &f->chosen);
    f->part = cost > 0 ? fmin(1, f->question.budget * whole / cost) : 1;
    f->report = (nevh__report){0};
    confirm_describe(f);
    return true;
}

/* Half the step costs what it costs; so does another kind where no other will
   do. */
static bool choose_any(nevh_finer *f, double until, double whole) {
    static const nevh_finer_kind kinds[] = {
        NEVH_FINER_TAYLOR, NEVH_FINER_ADAPTIVE, NEVH_FINER_STEPS};
    for (size_t i = 0; i < 6 && f->report.status != NEVH_ENOMEM; i++) {
        nevh_finer_kind kind = kinds[i % 3];
        bool free = i >= 3 || kind == NEVH_FINER_STEPS;
        if (f->question.kinds & kind &&
            confirm_choose(f, kind, until, whole,
                           free ? INFINITY : whole / half))
            return true;
    }
    return false;
}

static int confirm_plan(nevh_finer *f) {
    const nevh_finer_question *q = &f->question;
    size_t steps = steps_to_try(q);
    double until = (double)steps * fabs(q->dt);
    nevh_options o = *q->options;
    o.width = 1;
    nevh_stepper *s = nevh_stepper_new(f->system, q->integrator, &o);
    int status = nevh_stepper_status(s);
    if (status) {
        nevh__fail(&f->report, status, "%s",
                   s ? nevh_stepper_message(s) : "out of memory");
        nevh_stepper_free(s);
        return status;
    }
    double whole = cost_of(f, s, q->dt, until, INFINITY);
    nevh_stepper_free(s);
    f->allowed = q->budget * whole * (double)q->steps / (double)steps;
    if (isfinite(whole) && choose_any(f, until, whole)) {
        status = nevh_stepper_status(f->stepper);
        return status ? nevh__fail(&f->report, status, "%s",
                                   nevh_stepper_message(f->stepper))
                      : NEVH_OK;
    }
    return f->report.status
               ? f->report.status
               : nevh__fail(&f->report, NEVH_EFAILED,
                            "no finer run can be made of the first %zu steps",
                            steps);
}

nevh_finer *nevh_finer_new(const nevh_system *system,
                           const nevh_finer_question *q) {
    nevh_finer *f = system && q ? nevh__array(1, sizeof *f) : NULL;
    if (!f)
        return NULL;
    f->system = system;
    f->question = *q;
    if (!q->budget)
        f->question.budget = half;
    if (!q->kinds)
        f->question.kinds =
            NEVH_FINER_TAYLOR | NEVH_FINER_ADAPTIVE | NEVH_FINER_STEPS;
    if (!q->integrator || !q->options || !q->options->q || !q->options->p ||
        !q->steps || !(fabs(q->dt) > 0) || !isfinite(q->dt))
        nevh__fail(&f->report, NEVH_EINVAL,
                   "a finer run needs an integrator, a start, a step and a "
                   "number of steps");
    else if (confirm_plan(f)) {
        nevh_stepper_free(f->stepper);
        f->stepper = NULL;
    }
    return f;
}

void nevh_finer_free(nevh_finer *f) {
    if (!f)
        return;
    nevh_stepper_free(f->stepper);
    free(f);
}

NEVH__REPORTS(finer)

nevh_finer_kind nevh_finer_how(const nevh_finer *f) {
    return f && f->stepper ? f->chosen.kind : NEVH_FINER_NONE;
}

const char *nevh_finer_text(const nevh_finer *f) {
    return f && f->stepper ? f->text : "";
}

const nevh_integrator *nevh_finer_integrator(const nevh_finer *f) {
    return f && f->stepper ? f->chosen.integrator : NULL;
}

const nevh_options *nevh_finer_options(const nevh_finer *f) {
    return f && f->stepper ? &f->chosen.options : NULL;
}

double nevh_finer_dt(const nevh_finer *f) {
    return f && f->stepper ? f->chosen.dt : 0;
}

double nevh_finer_part(const nevh_finer *f) {
    return f && f->stepper ? f->part : 0;
}

nevh_stepper *nevh_finer_stepper(nevh_finer *f) {
    return f ? f->stepper : NULL;
}

typedef struct {
    const nevh_finer *finer;
    double t;
} budget_watch;

static int watch_budget(void *data, size_t step, double t, const double q[],
                        const double p[]) {
    budget_watch *w = data;
    (void)q, (void)p;
    w->t = t;
    return confirm_spent_by(w->finer->stepper, step) > w->finer->allowed
               ? NEVH_STOPPED
               : NEVH_OK;
}

int nevh_finer_run(nevh_finer *f, double t_end, double q[], double p[],
                   const nevh_observer observers[], size_t n_observers,
                   double *reached) {
    if (!f || !f->stepper)
        return f ? f->report.status : (int)NEVH_ENOMEM;
    budget_watch w = {f, f->question.t0};
    nevh_observer *all = malloc((n_observers + 1) * sizeof *all);
    if (!all)
        return NEVH_ENOMEM;
    if (n_observers)
        memcpy(all, observers, n_observers * sizeof *all);
    all[n_observers] = (nevh_observer){watch_budget, &w, 1};
    int status = nevh_run_until(f->stepper, f->question.t0, f->chosen.dt, t_end,
                                q, p, all, n_observers + 1);
    free(all);
    if (reached)
        *reached = w.t;
    return status;
}

bool nevh_agree(double a, double a_error, double b, double b_error) {
    static const double errors = 3;
    double error = nevh_simd_hypot(a_error, b_error);
    return isfinite(error) && fabs(a - b) <= errors * error;
}
