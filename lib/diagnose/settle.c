/* nevh: verdicts that a run leaves open, from a longer one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include <float.h>
#include <math.h>
#include <nevh/diagnose.h>
#include <stdlib.h>
#include <string.h>

/* Lengths of the run: the most, and what is worth it at least. */
static const double most = 32, least = 4;
/* Seconds that the longer run may take: a run that leaves no room for the least
   is long as it is. */
static const double usual = 8;
/* Seconds that nobody minds for a verdict to be confirmed, and lengths. */
static const double cheap = 0.1, confirmed = 128;
/* The same for open verdicts, which may take longer. */
static const double quick = 1, open = 2048;

/* Over the energies that the run itself met: a driven orbit beyond this has left
   its own. */
static const double grown = 4;
/* Part of the limit: larger errors may be those of an unstable run. */
static const double much_smaller = 0.01;

/* The cost of a gradient among many stages that are taken side by side, over that
   of a single one. */
static double side_by_side(const nevh_integrator *scheme) {
    static const double cheapest = 0.15;
    double stages = nevh_integrator_sweep_gradients(scheme);
    return stages > 1 ? cheapest + (1 - cheapest) / stages : 1;
}

/* Gradients and values of formulas, of which there may be many, as of pairs; an
   implicit step that Newton solves factors a matrix as well. */
double nevh_counts_seconds(const nevh_counts *c, size_t dof,
                           const nevh_integrator *scheme, int order,
                           size_t steps) {
    static const double an_order = 0.2; /* of a series, over a gradient */
    static const double a_term = 2;
    double n = (double)dof, m = 2 * n, terms = a_term * (double)c->instances;
    double gradient = c->hamiltonians > 0 ? 100 : fmax(250 + 40 * n, terms);
    if (nevh_integrator_needs_formulas(scheme))
        gradient *= an_order * order;
    double evaluations = gradient * (double)c->gradients +
                         fmax(100 + 40 * n, terms) * c->hamiltonians;
    return 1e-9 *
           (side_by_side(scheme) * evaluations + (50 + 10 * n) * (double)steps +
            m * m * m / 2 * (double)c->newtons);
}

typedef struct {
    nevh_energy *energy;
    double start, span, times; /* at so many lengths the verdict is asked for */
    double enough; /* lengths that a verdict takes, unless it is UNSTABLE */
    double own;    /* the largest error of the run itself */
    bool decided;
    nevh_energy_report before; /* at the last length that was judged */
    nevh_energy_report report;
} longer_run;

/* True if the error is level over so many lengths: a random walk would be above
   that many times the run's own error by now, at least half of the time.  A large
   one may be that of chaos among long steps, and is level where it stays as it is.
   Also true if the longer run explored more, and is level since: not where kinks leave
   no energy that is kept. */
static bool is_confirmed(const longer_run *l, double times) {
    static const double slow = 2.5, level = 1.3, few = 16, many = 256;
    static const double coarse = 0.03;                    /* of the limit */
    static const double ending = 0.2, ended_before = 0.5; /* powers of t */
    const nevh_energy_report *r = &l->report;
    bool ended = r->theory == NEVH_THEORY_KEEPS && r->rate[0] < ending &&
                 r->rate[1] < ended_before &&
                 r->last_fifth <= level * r->first_fifth;
    return r->max <= r->rounding || r->max > r->limit ||
           r->max <= l->own * (l->own > coarse * r->limit
                                   ? level
                                   : fmax(2, sqrt(times) / slow)) ||
           (r->max <= level * r->early && times >= few &&
            r->theory != NEVH_THEORY_ROUGH) ||
           (ended && times >= many);
}

/* Growth has ended, in so many lengths, of an error that theory keeps. */
static bool has_ended(const nevh_energy_report *r, double times) {
    static const double none = 0.1, slow = 0.75, few = 16;
    return r->theory == NEVH_THEORY_KEEPS && r->rate[0] < none &&
           r->rate[1] < slow && times >= few;
}

/* The verdict on as much as was run, if there will be no more. */
static nevh_verdict judge_last(const longer_run *l, double times) {
    const nevh_energy_report *r = &l->report;
    nevh_verdict verdict = nevh_energy_verdict(r, INFINITY);
    bool keeps = r->theory == NEVH_THEORY_KEEPS && r->max <= r->limit &&
                 !nevh_energy_stays(r);
    bool level = is_confirmed(l, times) || has_ended(r, times);
    if (verdict == NEVH_BOUNDED && !level)
        return NEVH_UNDECIDED;
    return verdict == NEVH_UNDECIDED && keeps && level ? NEVH_BOUNDED : verdict;
}

/* An orbit that the caller stops on its way to larger energies, which is its end:
   errors there say nothing of those before. */
static bool leaves(const nevh_energy_report *own, const longer_run *l,
                   int status) {
    return own->theory == NEVH_THEORY_KEEPS && status == NEVH_STOPPED &&
           !nevh_energy_status(l->energy) && !l->decided &&
           l->report.met > grown * own->met && own->max <= own->limit;
}

/* As far as such an orbit was judged before. */
static nevh_verdict judge_before(const nevh_energy_report *own,
                                 const longer_run *l) {
    static const double small = 0.03; /* of the limit: steps are short */
    const nevh_energy_report *last = l->before.samples ? &l->before : own;
    bool level = own->max <= small * own->limit &&
                 nevh_energy_verdict(own, INFINITY) == NEVH_BOUNDED &&
                 nevh_energy_verdict(last, INFINITY) == NEVH_BOUNDED &&
                 last->met <= grown * own->met && last->max <= 2 * own->max;
    return level ? NEVH_BOUNDED : NEVH_UNDECIDED;
}

/* The verdict on a driven run that stays undecided because its motion grows: DRIFTS
   if the error of the run itself is a line. */
static nevh_verdict judge_own(const nevh_energy_report *own,
                              const nevh_energy_report *longer) {
    static const double straight = 0.95;
    bool line = own->theory == NEVH_THEORY_OPEN &&
                longer->met > grown * own->met &&
                own->straightness > straight &&
                nevh_energy_verdict(own, INFINITY) == NEVH_DRIFTS;
    return line ? NEVH_DRIFTS : NEVH_UNDECIDED;
}

static int settle_ask(void *data, size_t step, double t, const double q[],
                      const double p[]) {
    longer_run *l = data;
    int status = nevh_energy_observe(l->energy, step, t, q, p);
    if (status || fabs(t - l->start) < l->times * fabs(l->span) * (1 - 1e-9))
        return status;
    l->report = nevh_energy_result(l->energy, 0);
    l->report.verdict = nevh_energy_verdict(&l->report, l->times);
    l->before = l->report;
    nevh_verdict now = l->report.verdict;
    bool early = now != NEVH_UNSTABLE && l->times < l->enough * (1 - 1e-9);
    early = early || now == NEVH_RANDOM_WALK ||
            (now == NEVH_BOUNDED && !is_confirmed(l, l->times));
    l->times *= 2;
    l->decided = !early && now != NEVH_UNDECIDED;
    return l->decided ? NEVH_STOPPED : NEVH_OK;
}

/* A power of 2. */
static double lengths_in(double seconds, const nevh_judged_run *r,
                         double most_lengths) {
    double times = r->seconds > 0 ? fmin(most_lengths, seconds / r->seconds)
                                  : most_lengths;
    return times < least ? 1 : exp2(floor(log2(times)));
}

static double lengths(const nevh_judged_run *r) {
    double allowed = r->allowed > 0 ? r->allowed : usual;
    return fmax(lengths_in(allowed, r, most),
                lengths_in(fmin(allowed, quick), r, open));
}

/* The lengths over which a level error must be confirmed. */
static double confirming(const nevh_judged_run *r) {
    double enough = lengths_in(cheap, r, confirmed);
    return r->regular ? enough : fmax(enough, lengths_in(quick, r, least));
}

/* From the start, since the orbit is the same again. */
static int settle_run(const nevh_judged_run *r, nevh_stepper *s, longer_run *l,
                      double times) {
    size_t bytes = s->work.n * sizeof *r->q;
    nevh_observer *all = malloc((r->stops + 1) * sizeof *all);
    double *q = malloc(bytes), *p = malloc(bytes);
    int status = NEVH_ENOMEM;
    if (all && q && p) {
        memcpy(q, r->q, bytes);
        memcpy(p, r->p, bytes);
        all[0] = (nevh_observer){settle_ask, l, 1};
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

/* Judges a run that is still open by as much as was run. */
static void settle_end(longer_run *l, int status) {
    nevh_energy_report *r = &l->report;
    if (l->decided)
        return;
    *r = nevh_energy_result(l->energy, 0);
    bool failed = status != NEVH_OK && status != NEVH_STOPPED;
    if (failed && !(r->max <= fmax(r->limit, r->rounding)))
        r->verdict = NEVH_UNSTABLE;
    else
        r->verdict = judge_last(l, r->span / fabs(l->span));
    if (failed && r->verdict == NEVH_BOUNDED && r->max > r->rounding)
        r->verdict = NEVH_UNDECIDED;
}

/* For a run that met larger energies than before: true if the error relative to
   them is level. */
static bool is_carried(const nevh_energy_report *r) {
    static const double level = 2;
    return r->relative[1] <= level * r->relative[0];
}

/* True if the error is no more than rounding explains. */
static bool is_rounding(const nevh_energy_report *own) {
    static const double small = 1e-3;
    return own->theory != NEVH_THEORY_LOSES && own->max <= own->rounding &&
           own->rounding < small;
}

/* A level error of a driven run, where larger energies bring rounding later. */
static bool only_rounding_grows(const nevh_energy_report *own,
                                const nevh_energy_report *longer) {
    return longer->max <= longer->rounding &&
           nevh_energy_verdict(own, INFINITY) == NEVH_BOUNDED;
}

/* A driven run that meets larger energies later. */
static nevh_verdict judge_driven(const nevh_energy_report *own,
                                 const nevh_energy_report *longer) {
    nevh_verdict verdict = longer->verdict;
    bool grows = verdict == NEVH_RANDOM_WALK || verdict == NEVH_DRIFTS;
    bool larger = longer->max > grown * own->max;
    bool doubtful =
        verdict == NEVH_BOUNDED ? larger : grows && is_carried(longer);
    return doubtful ? NEVH_UNDECIDED : verdict;
}

/* A drift may be beyond the limit: that of a balance, whose error adds up.
   beyond: the error is above the limit;
   carried: level relative to energies that were met later; spared: it cannot be
   unstable. */
static nevh_verdict judge_size(nevh_verdict verdict, bool beyond, bool carried,
                               bool spared) {
    if (beyond && verdict != NEVH_BOUNDED && verdict != NEVH_DRIFTS &&
        !(carried && verdict == NEVH_UNDECIDED))
        verdict = NEVH_UNSTABLE;
    return spared && verdict == NEVH_UNSTABLE ? NEVH_UNDECIDED : verdict;
}

/* The verdict of the longer run, as far as it says something of the run itself. */
static nevh_verdict judge_longer(const nevh_energy_report *own,
                                 const longer_run *l, int status) {
    const nevh_energy_report *longer = &l->report;
    bool small = own->max <= much_smaller * own->limit;
    bool beyond = !(own->max <= fmax(own->limit, own->rounding));
    bool met =
        own->theory == NEVH_THEORY_OPEN && longer->met > grown * own->met;
    bool driven = met && !beyond;
    bool rounded =
        is_rounding(own) || (driven && only_rounding_grows(own, longer));
    nevh_verdict verdict = driven ? judge_driven(own, longer) : longer->verdict;
    if (verdict == NEVH_UNDECIDED)
        verdict = judge_own(own, longer);
    verdict =
        judge_size(verdict, beyond, met && is_carried(longer), small || driven);
    if (leaves(own, l, status))
        verdict = judge_before(own, l);
    return rounded && verdict == NEVH_UNDECIDED ? NEVH_BOUNDED : verdict;
}

int nevh_verdict_settle(nevh_stepper *s, nevh_energy *energy,
                        const nevh_judged_run *r, nevh_energy_report *report) {
    bool level = report->verdict == NEVH_BOUNDED;
    if (report->scale > 0 && report->scale < DBL_MIN)
        return NEVH_OK; /* of H below the least normal number no run tells */
    if (report->theory == NEVH_THEORY_LOSES &&
        report->verdict == NEVH_UNDECIDED &&
        !(report->max <= fmax(report->limit, report->rounding)))
        return NEVH_OK; /* carried along by a motion that grows, ever more so */
    double enough = confirming(r);
    double times = fmax(enough, lengths(r));
    if (level ? enough < least : report->verdict != NEVH_UNDECIDED)
        return NEVH_OK;
    if (times < least) {
        report->verdict = nevh_energy_verdict(report, INFINITY);
        return NEVH_OK;
    }
    longer_run l = {.energy = energy,
                    .start = r->t,
                    .span = r->t_end - r->t,
                    .times = 2,
                    .enough = enough,
                    .own = report->max,
                    .report.verdict = NEVH_UNDECIDED};
    int status = settle_run(r, s, &l, times);
    if (status == NEVH_ENOMEM)
        return status;
    settle_end(&l, status);
    l.report.verdict = judge_longer(report, &l, status);
    *report = l.report;
    return NEVH_OK;
}
