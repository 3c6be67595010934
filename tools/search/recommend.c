/* nevh recommend: the cheapest integrator, gradient and step that keep an
   error.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "recommend_private.h"
#include <math.h>
#include <string.h>

/* The length of the whole run over that of the pilot. */
static double stretch(const recommendation *a) {
    double start = a->search.plan.run->t_start;
    return (a->whole - start) / (a->pilot - start);
}

/* The number of grid places, at least one, that lessen the error by a factor of
   `over`, by the order. */
static int places_short(const row *r, double over) {
    double places = nevh_integrator_adaptive(r->scheme)
                        ? GRID_STRIDE * log10(over)
                        : 40 * log10(over) / r->order;
    return isfinite(places) ? 1 + (int)fmin(places, 2 * GRID_STRIDE)
                            : GRID_STRIDE;
}

/* As much as the whole should take by what the pilot took, and some more. */
static double work_limit_for(const recommendation *a, const row *pilot) {
    static const double more = 4;
    return fmax(more * pilot->work * stretch(a), a->search.plan.work_limit);
}

/* The place of the pilot's choice, finer if the energy drifts, as its error grows
   with the length. */
static int first_place(const recommendation *a, const study *l) {
    const row *r = recommend_keeps(a, l);
    double over = study_error(r) / a->target * stretch(a);
    int k = l->k[r - l->level];
    return row_drifts(r) && over > 1 ? k + places_short(r, over) : k;
}

/* True if the next coarser place was tried. */
static bool was_polished(const study *l, size_t level) {
    return level && l->k[level] - l->k[level - 1] == 1;
}

/* The pilot's choice on the whole run, with shorter steps where that is not
   enough. */
static study verified(recommendation *a, const study *l) {
    enum { TRIES = 6 };
    study full = study_like(l, l->gradient);
    int k = first_place(a, l);
    if (k == l->k[recommend_keeps(a, l) - l->level] &&
        was_polished(l, (size_t)(recommend_keeps(a, l) - l->level)))
        full.topped = 1; /* longer steps failed sooner */
    a->search.plan.work_limit = work_limit_for(a, recommend_keeps(a, l));
    for (int i = 0; i < TRIES && !(i && search_is_over(&a->search, 1)); i++) {
        size_t level = study_run(&a->search, &full, k);
        const row *r = &full.level[level];
        double over = study_error(r) / a->target;
        if (over <= 1 || r->over_limit)
            break;
        k += places_short(r, over) + i;
    }
    study_refine(&a->search, &full, a->target, 1);
    full.end = study_ends_level(&full) ? STUDY_FLOOR : STUDY_LIMIT;
    return full;
}

/* The next of the pilots that keep the target, the cheapest first: those with
   the gradient that all schemes were tried with, then others. */
static size_t list_next(const recommendation *a, bool taken[],
                        const study *found[RECOMMEND_MOST]) {
    size_t count = 0;
    bool *skipped = tool_allocate(a->count, sizeof *skipped);
    for (int others = 0; others < 2 && count == 0; others++) {
        for (size_t i = 0; i < a->count; i++)
            skipped[i] = taken[i] || (!others && a->study[i].gradient !=
                                                     a->gradients.item[0]);
        for (study *l;
             count < RECOMMEND_MOST && (l = recommend_next_best(a, skipped));) {
            skipped[l - a->study] = taken[l - a->study] = true;
            found[count++] = l;
        }
    }
    return count;
}

/* The pilot of the same integrator with the gradient that all were tried with;
   NULL: there is none that keeps the target. */
static const study *usual_gradient(const recommendation *a, const study *l) {
    for (size_t i = 0; i < a->count; i++)
        if (strcmp(a->study[i].integrator, l->integrator) == 0 &&
            a->study[i].gradient == a->gradients.item[0] &&
            recommend_keeps(a, &a->study[i]))
            return &a->study[i];
    return NULL;
}

/* True if the errors of a gradient may pass the target in the whole run, when they
   grow with its length. */
static bool adds_up(const recommendation *a, const study *l,
                    const study *usual) {
    double least = INFINITY;
    int k = l->k[recommend_keeps(a, l) - l->level];
    for (size_t i = 0; i < usual->count; i++)
        if (usual->k[i] <= k)
            least = study_error(&usual->level[i]);
    double own = study_error(recommend_keeps(a, l)) - least;
    return least + stretch(a) * fabs(own) > a->target;
}

/* The answers of the pilot; where errors of a gradient may add up, the usual
   gradient instead. */
static size_t list_pilots(const recommendation *a,
                          const study *found[RECOMMEND_MOST]) {
    size_t listed = recommend_list(a, found), count = 0;
    for (size_t i = 0; i < listed; i++) {
        const study *l = found[i], *usual = usual_gradient(a, l);
        bool known = false;
        if (!a->search.plan.by_state && usual && adds_up(a, l, usual))
            l = usual;
        for (size_t k = 0; k < count; k++)
            known |= found[k] == l;
        if (!known)
            found[count++] = l;
    }
    return count;
}

/* The answers of the pilot, and where none of them keeps the target over the
   whole run, as the gradient's own errors may add up in it, what is next. */
static void verify_pilots(recommendation *a) {
    const study *pilots[RECOMMEND_MOST];
    size_t count = list_pilots(a, pilots), done = 0;
    study *full = tool_allocate(a->count + 1, sizeof *full);
    bool *taken = tool_allocate(a->count, sizeof *taken), kept = false;
    for (size_t i = 0; i < count; i++)
        taken[pilots[i] - a->study] = true;
    while (count) {
        for (size_t i = 0; i < count; i++, done++) {
            full[done] = verified(a, pilots[i]);
            kept |= recommend_keeps(a, &full[done]) != NULL;
        }
        count = kept || search_is_over(&a->search, 1)
                    ? 0
                    : list_next(a, taken, pilots);
    }
    a->study = full, a->count = done;
}

/* A reference for the whole is a plan's own. */
static void verify(recommendation *a, plan *p) {
    p->t_end = a->search.plan.t_end = a->whole;
    if (p->reference) {
        plan_forget_reference(p);
        plan_reference(p, p->t_end);
        a->search.plan.reference = p->reference;
        a->search.plan.reference_end = p->reference_end;
    }
    if (p->reference && p->observable && !plan_observe(p, p->observable)) {
        a->search.plan.observable_scale = p->observable_scale;
        a->search.plan.observable_level = p->observable_level;
    }
    a->search.budget = a->search.spent + 2 * SEARCH_BUDGET;
    verify_pilots(a);
    recommend_time_once(a);
    recommend_time_best(a);
    recommend_choose(a);
}

/* Verdicts that the runs of answers leave open, from longer ones; what is
   without drift follows from them. */
static void decide(recommendation *a) {
    enum { ROUNDS_AT_MOST = 2 };
    a->search.plan.follow = 2;
    for (int i = 0; i < ROUNDS_AT_MOST; i++) {
        const study *found[RECOMMEND_MOST];
        size_t count = recommend_list(a, found);
        for (size_t k = 0; k < count; k++) {
            row *r = recommend_keeps(a, found[k]);
            if (!(r->followed > 0))
                row_follow(&a->search.plan, r);
        }
        recommend_choose(a);
    }
}

static int advise(const options *o, plan *p, double whole) {
    output out;
    if (output_open(&out, o->file))
        return TOOL_USAGE;
    recommendation a = {
        .search = search_begin(p, o, SEARCH_BUDGET),
        .pilot = p->t_end,
        .whole = whole,
        .target = fmax(fmax(o->search.state_error, o->search.energy_error),
                       o->search.error),
        .named = o->integrators.count > 0};
    a.search.plan.by_state = o->search.state_error > 0 || o->observable;
    a.search.keeping = a.named;
    recommend_take_gradients(&a, o);
    recommend_search(&a);
    if (a.best && whole > p->t_end)
        verify(&a, p);
    if (a.best) {
        decide(&a);
        recommend_follow(&a, p);
    }
    int status = a.best ? TOOL_OK : recommend_none(&a);
    search_end(&a.search);
    if (a.best)
        recommend_print(&a, o, out.stream);
    return output_close(&out, status);
}

static int check_target(const options *o) {
    bool energy = o->search.energy_error > 0, state = o->search.state_error > 0;
    if (o->observable && !(o->search.error > 0))
        return tool_refuse("--observable needs --error X, which X is to be "
                           "relative to its range");
    if (o->search.error > 0 && !o->observable)
        return tool_refuse("--error is that of --observable FORMULA");
    if (o->observable && (energy || state))
        return tool_refuse("nevh recommend takes one of --energy-error, "
                           "--state-error and --observable");
    if (o->observable)
        return TOOL_OK;
    if (energy && state)
        return tool_refuse("nevh recommend takes one of --energy-error and "
                           "--state-error, not both");
    if (!energy && !state)
        return tool_refuse("nevh recommend needs --energy-error X or "
                           "--state-error X, or --observable FORMULA --error "
                           "X");
    return TOOL_OK;
}

/* Errors to be told, over that of the reference: another one, of a longer run,
   differs by as much. */
static const double surely = 3;

static int check_observable(plan *p, const options *o) {
    int status = plan_require_reference(p);
    if (!status)
        status = plan_observe(p, o->observable);
    if (status || o->search.error >= surely * p->observable_error)
        return status;
    tool_refuse("%s: an error of %g of %s is not resolved: that of the "
                "reference is %.1e (%s)",
                p->name, o->search.error, o->observable, p->observable_error,
                nevh_reference_text(p->reference));
    return TOOL_FAILED;
}

static int check_reference(plan *p, double target) {
    int status = plan_require_reference(p);
    if (status || target >= surely * nevh_reference_error(p->reference))
        return status;
    tool_refuse("%s: a state error of %g is not resolved: that of the "
                "reference is %.1e (%s)",
                p->name, target, nevh_reference_error(p->reference),
                nevh_reference_text(p->reference));
    return TOOL_FAILED;
}

static int recommend(const options *o) {
    plan p;
    double whole = NAN;
    if (check_target(o))
        return TOOL_USAGE;
    int status = plan_make(&p, o);
    if (!status)
        status = plan_search(&p, o);
    if (!status && !o->dt.count)
        whole = plan_shorten(&p, SEARCH_BUDGET);
    if (!status && o->search.state_error > 0)
        status = check_reference(&p, o->search.state_error);
    if (!status && o->observable)
        status = check_observable(&p, o);
    if (!status)
        status = advise(o, &p, whole);
    plan_free(&p);
    return status;
}

const command recommend_command = {
    .name = "recommend",
    .operand = "SCENE",
    .brief = "the cheapest way to keep an error below a target",
    .help =
        "the cheapest integrator, gradient and step whose error stays below a target",
    .examples = "recommend pendulum --t-end 20 --energy-error 1e-8\n"
                "recommend kepler --t-end 20 --state-error 1e-6",
    .options =
        "SCENE STEPS NATIVE TABLE energy-error state-error observable error repeat",
    .columns = RECORD_COLUMNS,
    .run = recommend,
};
