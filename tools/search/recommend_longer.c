/* nevh recommend: what an answer is worth: its orbit, and longer runs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/trial_run.h"
#include "recommend_private.h"
#include <math.h>

static const double lengths = 3;
static const double most_work = 6; /* as nevh_counts_seconds */
/* The share of the target that a longer run may use: the last bits of h change
   errors that walk. */
static const double margin = 0.98;

/* The same run once more, as `run` says. */
static row again(const plan *run, const row *r, error_bound *bound) {
    row copy = {.integrator = r->integrator,
                .gradient = r->gradient,
                .scheme = r->scheme,
                .dt = r->step,
                .tolerance = r->tolerance,
                .error_bound = bound};
    row_run(run, &copy);
    return copy;
}

/* Compares the orbit with the true one, which the energy does not determine. */
static void compare_orbit(const plan *p, row *r) {
    row copy = again(p, r, NULL);
    r->state_error = copy.state_error;
    r->energies = copy.energies;
}

static void follow(const recommendation *a, const plan *longer, row *r) {
    double start = longer->run->t_start;
    error_bound *bound = tool_allocate(1, sizeof *bound);
    *bound = (error_bound){.most = fmax(margin * a->target, study_error(r)),
                           .by_state = a->search.plan.by_state,
                           .until = start};
    row copy = again(longer, r, bound);
    if (copy.over_limit)
        bound->unknown = true;
    else if (!copy.ran && !bound->unknown)
        bound->broken = true;
    if (!bound->broken) /* the run itself keeps it */
        bound->until = fmax(bound->until, a->search.plan.t_end);
    r->error_bound = bound;
}

/* Three times as long, with a reference of its own where states count. */
static plan longer_plan(recommendation *a) {
    plan longer = a->search.plan;
    double start = longer.run->t_start;
    longer.work_limit = most_work;
    longer.t_end = start + lengths * (longer.t_end - start);
    a->longer = longer.t_end;
    longer.reference = NULL;
    if (!a->search.plan.by_state)
        return longer;
    longer.no_reference = NULL;
    plan_reference(&longer, longer.t_end);
    if (!longer.reference)
        a->not_longer = text_print("%s", longer.no_reference);
    return longer;
}

/* Differences across a kink give rates that no motion has. */
static void find_period(recommendation *a) {
    char *why = NULL;
    const plan *p = &a->search.plan;
    trial_run f = trial_run_new(p, false);
    bool kinked = smoothness_on_way(p, &why) == SMOOTHNESS_NONE;
    a->period = f.frequency > 0 && !kinked ? 2 * acos(-1) / f.frequency : NAN;
    a->period_at = f.frequency_at;
}

void recommend_follow(recommendation *a, plan *p) {
    const study *found[RECOMMEND_MOST];
    size_t count = recommend_list(a, found);
    plan *whole = &a->search.plan;
    whole->work_limit = 0;
    if (!a->search.plan.by_state) {
        plan_reference(p, whole->t_end);
        whole->reference = p->reference;
        whole->no_reference = p->no_reference;
        whole->reference_end = p->reference_end;
        if (p->reference)
            plan_energies(p);
        whole->energies = p->energies;
    }
    for (size_t i = 0; i < count && !a->search.plan.by_state && p->reference;
         i++)
        compare_orbit(whole, recommend_chosen(a, found[i]));
    plan longer = longer_plan(a);
    for (size_t i = 0; i < count && !a->not_longer; i++)
        follow(a, &longer, recommend_chosen(a, found[i]));
    if (a->search.plan.by_state)
        plan_forget_reference(&longer);
    whole->error_bounds = true;
    find_period(a);
}

double recommend_holds(const row *r) {
    const error_bound *bound = r->error_bound;
    if (!bound)
        return NAN;
    return bound->broken || bound->unknown ? bound->until : INFINITY;
}
