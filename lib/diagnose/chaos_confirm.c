/* nevh: chaos of H itself, and whether finer steps confirm what steps show.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/chaos_private.h"
#include "run/stepper_private.h"
#include <fenv.h>
#include <nevh/simd.h>
#include <math.h>
#include <nevh/diagnose.h>
#include <stdio.h>

static const double tolerance = 1e-10, usual_seconds = 2;
static const double usual_budget = 0.5, damped_budget = 4;
enum { STARTS = 4, LOOKS = 1024, PIECES = 64, LARGEST = 4096 };

/* The cost of gradients of many pieces, above that of few, which
   nevh_counts_seconds has. */
static double spent_on_terms(const nevh_chaos *c, const nevh_counts *counts) {
    static const double a_term = 8e-8, few = 32;
    size_t pieces = nevh_field_pieces(nevh_stepper_field(c->stepper));
    return a_term * fmax(0, (double)pieces - few) * (double)counts->gradients;
}

static double chaos_confirm_spent_by(const nevh_chaos *c) {
    nevh_counts counts = nevh_chaos_counts(c);
    size_t n = c->tangent ? 2 * c->n : c->n;
    double steps = c->start[0].clock.done * (double)c->width;
    return spent_on_terms(c, &counts) +
           nevh_counts_seconds(&counts, n, c->integrator,
                               nevh_stepper_order(c->stepper), (size_t)steps);
}

static nevh_chaos_finding finding(const nevh_chaos *c, double growth) {
    nevh_chaos_finding f = {nevh_chaos_result(c), .growth = growth};
    f.exponent = nevh_chaos_exponent(c, 0, &f.error);
    return f;
}

/* Towards `until`, as long as it costs no more than that; of chaos no further
   than until it is clear, where it is `sought`. */
static int chaos_confirm_follow(nevh_chaos *c, double until, double seconds,
                                bool sought, nevh_chaos_finding *f) {
    double t0 = c->t_start, growth = 0;
    int status = nevh_chaos_status(c);
    for (int i = 1;
         !status && i <= PIECES && chaos_confirm_spent_by(c) < seconds; i++) {
        double last = nevh__chaos_steps(c, t0 + i * (until - t0) / PIECES);
        while (chaos_confirm_spent_by(c) < seconds &&
               nevh__chaos_advance(c, last))
            ;
        status = c->report.status;
        growth = fmax(growth, nevh__chaos_growth(c, 0));
        if (sought && nevh_chaos_result(c).verdict == NEVH_CHAOTIC)
            break;
    }
    *f = finding(c, growth);
    return status;
}

int nevh_chaos_find(const nevh_system *system, const nevh_options *options,
                    double t0, double t1, double seconds,
                    nevh_chaos_finding *found) {
    if (!system || !options || !found || !(t1 > t0 || t1 < t0))
        return NEVH_EINVAL;
    *found = (nevh_chaos_finding){.error = INFINITY};
    if (system->n > LARGEST)
        return NEVH_EFAILED;
    nevh_options o = *options;
    o.tolerance = tolerance;
    o.transform = NULL;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    nevh_chaos *c =
        nevh_chaos_new(system, &(nevh_chaos_options){.integrator = nevh_dop853,
                                                     .options = &o,
                                                     .t_start = t0,
                                                     .dt = (t1 - t0) / LOOKS,
                                                     .starts = STARTS});
    int status = nevh_chaos_status(c);
    if (!status)
        status = chaos_confirm_follow(
            c, t1, seconds > 0 ? seconds : usual_seconds, false, found);
    nevh_chaos_free(c);
    fesetenv(&own);
    return status;
}

/* Half as many starts, so that the time may be longer. */
static nevh_chaos *finer_chaos(const nevh_chaos *c, const nevh_finer *f) {
    nevh_options o = *nevh_finer_options(f);
    if (nevh_finer_how(f) == NEVH_FINER_ADAPTIVE)
        o.tolerance = tolerance;
    size_t starts = c->starts > STARTS ? STARTS : c->starts;
    return nevh_chaos_new(
        c->system, &(nevh_chaos_options){.integrator = nevh_finer_integrator(f),
                                         .options = &o,
                                         .t_start = c->t_start,
                                         .dt = nevh_finer_dt(f),
                                         .starts = starts,
                                         .deviations = 2,
                                         .seed = c->seed,
                                         .differences = !c->tangent});
}

/* Chaos that steps make is less with finer ones.  A finer run may be too short for a
   verdict of its own. */
static bool is_chaotic_too(const nevh_chaos_confirmation *c, double value) {
    static const double most = 0.7; /* of an exponent, that is less */
    const nevh_chaos_finding *f = &c->found;
    bool less = !c->agrees && f->exponent < most * value;
    return (f->report.verdict == NEVH_CHAOTIC && !less) ||
           ((f->report.verdict == NEVH_EARLY || f->report.kinks) && c->agrees &&
            f->exponent > 2 * f->error);
}

static void chaos_confirm_judge(const nevh_chaos_report *run, double value,
                                double error, nevh_chaos_confirmation *to) {
    const nevh_chaos_finding *f = &to->found;
    to->agrees = nevh_agree(value, error, f->exponent, f->error);
    bool holds = run->verdict == NEVH_CHAOTIC
                     ? is_chaotic_too(to, value)
                     : f->report.verdict != NEVH_CHAOTIC;
    to->verdict = holds ? run->verdict : NEVH_UNRESOLVED;
}

/* With friction the steps decide on the attractor, as steps of any length have some:
   finer ones must have the same verdict, at the end, and their exponent is within the
   error. */
static void judge_damped(const nevh_chaos_report *run, double value,
                         double error, nevh_chaos_confirmation *to) {
    const nevh_chaos_finding *f = &to->found;
    chaos_confirm_judge(run, value, error, to);
    to->error = nevh_simd_hypot(error, value - f->exponent);
    if (f->report.verdict != run->verdict)
        to->verdict = NEVH_UNRESOLVED;
}

static int confirm(const nevh_chaos *c, const nevh_finer *f, double seconds,
                   nevh_chaos_confirmation *to) {
    nevh_chaos_report run = nevh_chaos_result(c);
    bool damped = nevh_system_friction(c->system, NULL);
    double error, value = nevh_chaos_exponent(c, 0, &error);
    nevh_chaos *finer = finer_chaos(c, f);
    int status = nevh_chaos_status(finer);
    to->how = nevh_finer_how(f);
    snprintf(to->text, sizeof to->text, "%s", nevh_finer_text(f));
    if (!status)
        status = chaos_confirm_follow(finer, run.t, seconds,
                                      run.verdict == NEVH_CHAOTIC && !damped,
                                      &to->found);
    nevh_chaos_free(finer);
    if (!status)
        (damped ? judge_damped : chaos_confirm_judge)(&run, value, error, to);
    return status;
}

int nevh_chaos_confirm(const nevh_chaos *c, double budget,
                       nevh_chaos_confirmation *to) {
    if (!c || !c->planned || !to)
        return c ? NEVH_EINVAL : NEVH_ENOMEM;
    bool damped = nevh_system_friction(c->system, NULL);
    double usual = damped ? damped_budget : usual_budget;
    double part = budget > 0 ? budget : usual;
    unsigned kinds = NEVH_FINER_ADAPTIVE;
    kinds |= damped ? 0u : NEVH_FINER_STEPS;
    nevh_chaos_verdict verdict = nevh_chaos_result(c).verdict;
    *to = (nevh_chaos_confirmation){.verdict = verdict, .agrees = true};
    nevh_chaos_exponent(c, 0, &to->error);
    if (verdict != NEVH_CHAOTIC && verdict != NEVH_REGULAR)
        return NEVH_OK;
    nevh_finer *f = nevh_finer_new(
        c->system,
        &(nevh_finer_question){.integrator = c->integrator,
                               .options = &c->options,
                               .t0 = c->t_start,
                               .dt = c->way * c->dt,
                               .steps = (size_t)c->start[0].clock.done,
                               .kinds = kinds,
                               .budget = part});
    int status = nevh_finer_status(f);
    to->verdict = NEVH_UNRESOLVED;
    to->agrees = false;
    if (!status)
        status = confirm(c, f, part * chaos_confirm_spent_by(c), to);
    nevh_finer_free(f);
    return status;
}
