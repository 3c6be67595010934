/* nevh: steps that keep an error of the energy to the end of a run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/trial_run.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The error that steps are for. */
static const double target = 0.01;
/* Limits: work of all runs together, as nevh_counts_seconds; steps of a run; and
   steps of a run from which a guess may be made. */
static const double most_work = 4, most_steps = 3e5, enough_steps = 1e5;
enum { FINER = 3, HALVINGS = 60 };

/* The longest step, in two digits, that keeps the target. */
typedef struct {
    double dt;    /* 0: none was found */
    bool guessed; /* from how long shorter steps keep it: it was not run */
} suggested_step;

typedef struct {
    const plan *plan;
    const row *row;
    double work;
} step_search;

/* A run with that dt, for as long as the error keeps the target at each of so
   many steps. */
static energy_limit run(step_search *s, double dt, size_t every) {
    const plan *p = s->plan;
    row r = *s->row;
    double stopped;
    nevh_stepper *stepper = row_stepper(p, &r, p->balance);
    energy_limit e = {.energy = row_energy(p, &r, stepper),
                      .limit = target,
                      .t = p->run->t_start};
    nevh_counts before = nevh_stepper_counts(stepper);
    int status = plan_run(p, stepper, dt,
                          &(nevh_observer){energy_limit_observe, &e, every}, 1,
                          &stopped);
    nevh_counts c = row_counts(stepper, before);
    s->work += nevh_counts_seconds(&c, p->n, r.scheme,
                                   nevh_stepper_order(stepper), e.step);
    e.passed = e.passed || status;
    nevh_energy_free(e.energy);
    row_stepper_keep(p, &r, p->balance, stepper);
    return e;
}

/* Most runs fail, for which a look from time to time is enough. */
static energy_limit try_step(step_search *s, double dt) {
    energy_limit e = run(s, dt, 8);
    return e.passed ? e : run(s, dt, 1);
}

/* The number that so many digits say, which is the one that is run. */
static double rounded_down(double x, int digits) {
    double unit = pow(10, floor(log10(x)) - digits + 1);
    char text[32];
    snprintf(text, sizeof text, "%.*g", digits,
             floor(x / unit * (1 + 1e-12)) * unit);
    return strtod(text, NULL);
}

/* Between steps that keep the target and such that do not. */
static double refine(step_search *s, double kept, double lost) {
    for (int i = 0; i < FINER && s->work < most_work; i++) {
        double dt = rounded_down(sqrt(kept * lost), 2);
        if (dt <= kept)
            break;
        *(try_step(s, dt).passed ? &lost : &kept) = dt;
    }
    return kept;
}

/* From the times that two steps keep the target for, along a power law; none
   where these do not grow as such steps let expect, nor where H reads t: what it
   does later, as a next pulse, no shorter run shows. */
static double guess(const step_search *s, double dt, double keeps,
                    double longer_dt, double longer_keeps) {
    double span = s->plan->t_end - s->plan->run->t_start;
    double power = log(keeps / longer_keeps) / log(longer_dt / dt);
    if (s->plan->time || !(power > 0.5 && power < 12))
        return 0;
    return rounded_down(dt * pow(keeps / span, 1 / power), 1);
}

/* Predicts the number of steps of a run with half the step from the growth of that
   number. */
static double next_steps(const step_search *s, double dt, double steps,
                         double steps_before) {
    double span = s->plan->t_end - s->plan->run->t_start;
    return fmin(span / dt, fmax(steps, steps * steps / steps_before));
}

static suggested_step look(step_search *s) {
    double start = s->plan->run->t_start;
    double before = s->row->dt, kept_before = NAN, steps_before = NAN;
    for (int i = 0; i < HALVINGS; i++) {
        double dt = rounded_down(before / 2, 2);
        energy_limit e = try_step(s, dt);
        double keeps = e.t - start;
        if (!e.passed)
            return (suggested_step){refine(s, dt, before), false};
        double steps = (double)e.step, guessed = 0;
        bool last = s->work > most_work || steps > most_steps;
        if (last || (steps > enough_steps &&
                     next_steps(s, dt / 2, steps, steps_before) > most_steps))
            guessed = guess(s, dt, keeps, before, kept_before);
        if (last || guessed > 0)
            return (suggested_step){guessed, true};
        before = dt;
        kept_before = keeps;
        steps_before = steps;
    }
    return (suggested_step){0, false};
}

static suggested_step find(const plan *p, const row *r) {
    step_search s = {.plan = p, .row = r};
    return look(&s);
}

bool needs_shorter_step(const row *r) {
    bool drifts = r->energy.verdict == NEVH_DRIFTS && r->energy.max > target;
    return r->ran && r->tolerance == 0 &&
           (drifts || r->energy.verdict == NEVH_UNSTABLE);
}

/* The row with the shortest steps of those of one integrator that need a shorter step;
   NULL unless `first` is the first of them. */
static const row *shortest(const row rows[], size_t count, const row *first) {
    const row *found = first;
    for (const row *r = rows; r < rows + count; r++) {
        bool same = strcmp(r->integrator, first->integrator) == 0 &&
                    needs_shorter_step(r);
        if (same && r < first)
            return NULL;
        if (same && r->dt < found->dt)
            found = r;
    }
    return found;
}

static void row_words(const plan *p, const row *r, list *words) {
    bool loses = nevh_integrator_symplectic(r->scheme) == NEVH_NO;
    bool always = loses && nevh_stability_limit(r->scheme) == 0;
    const char *gains = always ? " gains energy at every dt, and" : "";
    const char *other = loses ? ", or a symplectic scheme" : "";
    suggested_step found = find(p, r);
    if (found.dt > 0 && found.guessed)
        list_print(words,
                   "%s%s would keep its error below %g %% until t = %.4g%s "
                   "only with dt below about %.1g%s, as shorter runs show%s.",
                   r->integrator, gains, 100 * target, p->t_end, p->unit,
                   found.dt, p->unit,
                   loses ? "; or take a symplectic scheme" : "");
    else if (found.dt > 0)
        list_print(words,
                   "To keep the energy error of %s below %g %% until t = "
                   "%.4g%s take dt = %.2g%s%s.",
                   r->integrator, 100 * target, p->t_end, p->unit, found.dt,
                   p->unit, other);
}

void suggested_step_words(const plan *p, const row rows[], size_t count,
                          list *words) {
    for (size_t i = 0; i < count; i++) {
        const row *r = needs_shorter_step(&rows[i])
                           ? shortest(rows, count, &rows[i])
                           : NULL;
        if (r)
            row_words(p, r, words);
    }
}
