/* nevh: verdicts that a run leaves open, from a longer one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include <math.h>
#include <nevh/diagnose.h>
#include <stdlib.h>
#include <string.h>

/* Lengths of the run: the most, and what is worth it at least. */
static const double most = 32, least = 4;
/* Seconds that the longer run may take: a run that leaves no room for the least
   is long as it is. */
static const double usual = 8;

/* Of the energies that the run itself met: what is driven has left its orbit. */
static const double grown = 4;
/* Of the limit: errors of a run that is not unstable. */
static const double much_smaller = 0.01;

/* What a gradient costs of many stages that are taken side by side, a single
   one being 1. */
static double side_by_side(const nevh_integrator *scheme) {
    static const double cheapest = 0.15;
    double stages = nevh_integrator_sweep_gradients(scheme);
    return stages > 1 ? cheapest + (1 - cheapest) / stages : 1;
}

/* Gradients and values of formulas; an implicit step that Newton solves factors
   a matrix as well. */
double nevh_counts_seconds(const nevh_counts *c, size_t dof,
                           const nevh_integrator *scheme, int order,
                           size_t steps) {
    static const double an_order = 0.2; /* of a series, over a gradient */
    double n = (double)dof, m = 2 * n;
    double gradient = c->hamiltonians > 0 ? 100 : 250 + 40 * n;
    if (nevh_integrator_needs_formulas(scheme))
        gradient *= an_order * order;
    double evaluations =
        gradient * (double)c->gradients + (100 + 40 * n) * c->hamiltonians;
    return 1e-9 *
           (side_by_side(scheme) * evaluations + (50 + 10 * n) * (double)steps +
            m * m * m / 2 * (double)c->newtons);
}

typedef struct {
    nevh_energy *energy;
    double start, span, times; /* at so many lengths the verdict is asked for */
    double most_met;           /* energies above are those of another motion */
    bool departs;              /* such were met */
    nevh_energy_report report;
} longer_run;

static int ask(void *data, size_t step, double t, const double q[],
               const double p[]) {
    longer_run *l = data;
    int status = nevh_energy_observe(l->energy, step, t, q, p);
    if (status || fabs(t - l->start) < l->times * fabs(l->span) * (1 - 1e-9))
        return status;
    l->report = nevh_energy_result(l->energy, 0);
    l->departs = l->report.met > l->most_met;
    if (l->departs)
        return NEVH_STOPPED;
    l->report.verdict = nevh_energy_verdict(&l->report, l->times);
    l->times *= 2;
    return l->report.verdict == NEVH_UNDECIDED ? NEVH_OK : NEVH_STOPPED;
}

static double lengths(const nevh_judged_run *r) {
    double allowed = r->allowed > 0 ? r->allowed : usual;
    double times = r->seconds > 0 ? fmin(most, allowed / r->seconds) : most;
    return times < least ? 1 : exp2(floor(log2(times)));
}

/* From the start, since the orbit is the same again. */
static int run(const nevh_judged_run *r, nevh_stepper *s, longer_run *l,
               double times) {
    size_t bytes = s->work.n * sizeof *r->q;
    nevh_observer *all = malloc((r->stops + 1) * sizeof *all);
    double *q = malloc(bytes), *p = malloc(bytes);
    int status = NEVH_ENOMEM;
    if (all && q && p) {
        memcpy(q, r->q, bytes);
        memcpy(p, r->p, bytes);
        all[0] = (nevh_observer){ask, l, 1};
        if (r->stops)
            memcpy(all + 1, r->stop, r->stops * sizeof *all);
        nevh_stepper_reset(s);
        status = nevh_run_until(s, r->t, r->h, r->t + times * l->span, q, p,
                                all, r->stops + 1);
    }
    free(all);
    free(q);
    free(p);
    return status;
}

/* What is left open is judged by as much as was seen: there is no more. */
static void end(longer_run *l, int status) {
    nevh_energy_report *r = &l->report;
    if (r->verdict != NEVH_UNDECIDED)
        return;
    *r = nevh_energy_result(l->energy, 0);
    bool failed = status != NEVH_OK && status != NEVH_STOPPED;
    if (failed && !(r->max <= r->limit))
        r->verdict = NEVH_UNSTABLE;
    else
        r->verdict = nevh_energy_verdict(r, INFINITY);
}

int nevh_verdict_settle(nevh_stepper *s, nevh_energy *energy,
                        const nevh_judged_run *r, nevh_energy_report *report) {
    double times = lengths(r);
    if (report->verdict != NEVH_UNDECIDED)
        return NEVH_OK;
    if (times < least) {
        report->verdict = nevh_energy_verdict(report, INFINITY);
        return NEVH_OK;
    }
    bool driven = report->theory == NEVH_THEORY_OPEN;
    longer_run l = {.energy = energy,
                    .most_met = driven ? grown * report->met : INFINITY,
                    .start = r->t,
                    .span = r->t_end - r->t,
                    .times = 2,
                    .report.verdict = NEVH_UNDECIDED};
    int status = run(r, s, &l, times);
    if (status == NEVH_ENOMEM)
        return status;
    if (l.departs) {
        report->verdict = nevh_energy_verdict(report, INFINITY);
        return NEVH_OK;
    }
    end(&l, status);
    bool small = report->max <= much_smaller * report->limit;
    *report = l.report;
    if (small && report->verdict == NEVH_UNSTABLE)
        report->verdict = NEVH_UNDECIDED;
    return NEVH_OK;
}
