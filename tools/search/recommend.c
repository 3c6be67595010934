/* nevh recommend: the cheapest integrator, gradient and step that keep an
   error.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "recommend_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool counts(const advice *a, const study *l) {
    return a->named || a->search.by_state || !study_keeps_energy(l);
}

/* The cheapest level that keeps the target, of the studies that count. */
static const row *keeps(const advice *a, const study *l) {
    return counts(a, l) ? study_cheapest(l, a->target, a->search.by_state)
                        : NULL;
}

static double least_work(const advice *a) {
    double least = INFINITY;
    for (size_t i = 0; i < a->count; i++) {
        const study *l = &a->study[i];
        const row *r = study_least_work(l, a->target, a->search.by_state);
        if (counts(a, l) && r)
            least = fmin(least, r->work);
    }
    return least;
}

/* Times may tell otherwise than work: a factor of 2, at most. */
static const double nearly = 2.5;

/* A shorter step costs more, but for the sweeps that it saves. */
static bool is_hopeless(const advice *a, const study *l) {
    return l->level[l->count - 1].work > nearly * least_work(a);
}

static void descend(advice *a) {
    static const double share = 0.6;
    study *next;
    for (size_t i = 0; i < a->count; i++)
        study_begin(&a->search, &a->study[i]);
    while ((next = study_next(a->study, a->count)) &&
           !search_is_over(&a->search, share))
        if (keeps(a, next) || is_hopeless(a, next))
            next->end = STUDY_LIMIT;
        else
            study_descend(&a->search, next);
}

static void refine(advice *a) {
    for (size_t i = 0; i < a->count; i++) {
        study *l = &a->study[i];
        size_t k = 0;
        while (k < l->count &&
               study_error(&l->level[k], a->search.by_state) > a->target)
            k++;
        if (keeps(a, l) &&
            (k == 0 || l->level[k - 1].work < nearly * least_work(a)))
            study_refine(&a->search, l, a->target, GRID_COARSE);
    }
}

static const row *least_worked(const advice *a, const study *l) {
    return counts(a, l) ? study_least_work(l, a->target, a->search.by_state)
                        : NULL;
}

static void time_one(advice *a, study *l) {
    const row *r = least_worked(a, l);
    if (!r || isfinite(r->seconds))
        return;
    row *level = &l->level[r - l->level];
    rows_time(&a->search.plan, &level, 1, 1, a->search.repeats > 0);
}

/* The one that works least, of those without drift, or with another integrator
   than that of all; NULL: there is none. */
static study *least_of(const advice *a, bool steady, const study * not ) {
    study *best = NULL;
    for (size_t i = 0; i < a->count; i++) {
        study *l = &a->study[i];
        const row *r = least_worked(a, l);
        if (r && !(steady && row_drifts(r)) &&
            !(not &&strcmp(not ->integrator, l->integrator) == 0) &&
            (!best || r->work < least_worked(a, best)->work))
            best = l;
    }
    return best;
}

/* One run of each that may win, or be the runner-up or other evidence. */
static void time_once(advice *a) {
    double least = least_work(a);
    study *second = least_of(a, false, least_of(a, false, NULL));
    study *steady = least_of(a, true, NULL);
    for (size_t i = 0; i < a->count; i++) {
        study *l = &a->study[i];
        const row *r = least_worked(a, l);
        bool varied = strcmp(l->gradient, a->gradients.item[0]) != 0;
        if (r &&
            (varied || l == second || l == steady || r->work < nearly * least))
            time_one(a, l);
    }
}

/* Of those not yet taken. */
static study *next_best(const advice *a, const bool taken[]) {
    study *best = NULL;
    for (size_t i = 0; i < a->count; i++) {
        const row *r = taken[i] ? NULL : keeps(a, &a->study[i]);
        if (r && (!best || r->seconds < keeps(a, best)->seconds))
            best = &a->study[i];
    }
    return best;
}

static void add_study(advice *a, study l) {
    a->study = tool_enlarge(a->study, a->count + 1, sizeof *a->study);
    a->study[a->count++] = l;
}

/* The same steps with another gradient, and finer ones where that is not
   enough. */
static study with_gradient(advice *a, const study *l, int k,
                           const char *gradient) {
    study other = study_like(l, gradient);
    for (int finer = 0; finer <= GRID_STRIDE; finer += GRID_COARSE) {
        size_t i = study_run(&a->search, &other, k + finer);
        if (study_error(&other.level[i], a->search.by_state) <= a->target)
            break;
    }
    other.end = STUDY_LIMIT;
    return other;
}

/* The best, and those that take less than `factor` times as long; at most
   `most`. */
static size_t list_best(const advice *a, double factor, study *found[],
                        size_t most) {
    bool *taken = tool_allocate(a->count, sizeof *taken);
    size_t count = 0;
    for (study *l; count < most && (l = next_best(a, taken));) {
        if (count &&
            keeps(a, l)->seconds > factor * keeps(a, found[0])->seconds)
            break;
        taken[l - a->study] = true;
        found[count++] = l;
    }
    free(taken);
    return count;
}

/* Other gradients for the best few schemes: they change the price of a step,
   and where errors end, but hardly the step that is needed. */
static void vary_gradients(advice *a) {
    enum { FEW = 10 };
    static const double factor = 2.2;
    study *found[FEW], model[FEW];
    int k[FEW];
    size_t count = list_best(a, factor, found, FEW);
    for (size_t i = 0; i < count; i++) {
        model[i] = *found[i];
        k[i] = found[i]->k[keeps(a, found[i]) - found[i]->level];
    }
    for (size_t i = 0; i < count; i++)
        for (size_t g = 1; g < a->gradients.count; g++)
            if (!search_is_over(&a->search, 1))
                add_study(
                    a, with_gradient(a, &model[i], k[i], a->gradients.item[g]));
}

/* The steps of those that may win, to the last place. */
static void polish(advice *a) {
    enum { FEW = 8 };
    static const double factor = 1.4;
    study *found[FEW];
    size_t count = list_best(a, factor, found, FEW);
    for (size_t i = 0; i < count; i++)
        study_refine(&a->search, found[i], a->target, 1);
}

/* Errors do not fall evenly: of the best few, each place up to half a stride
   beyond what keeps the target. */
static void look_beyond(advice *a) {
    enum { FEW = 8 };
    static const double factor = 1.4;
    study *found[FEW];
    size_t count = list_best(a, factor, found, FEW);
    for (size_t i = 0; i < count; i++) {
        int from = found[i]->k[keeps(a, found[i]) - found[i]->level];
        for (int k = from - 1; k >= from - GRID_STRIDE / 2; k--)
            if (!search_is_over(&a->search, 1) &&
                found[i]->end != STUDY_GIVEN &&
                !nevh_integrator_adaptive(found[i]->scheme) &&
                study_fits_steps(&a->search, k))
                study_run(&a->search, found[i], k);
    }
}

/* Medians for those that may win: of each the level that took least time, and
   the one that works least, of which one time may have been taken badly. */
static void time_best(advice *a) {
    enum { FEW = 24, USUAL = 9 };
    static const double factor = 1.7;
    study *found[FEW];
    row *level[2 * FEW];
    size_t count = list_best(a, factor, found, FEW), rows = 0;
    size_t repeats = a->search.repeats;
    for (size_t i = 0; i < count; i++) {
        const row *quick = keeps(a, found[i]);
        const row *light = least_worked(a, found[i]);
        level[rows++] = &found[i]->level[quick - found[i]->level];
        if (light != quick && isfinite(light->seconds))
            level[rows++] = &found[i]->level[light - found[i]->level];
    }
    rows_time(&a->search.plan, level, rows, repeats ? repeats : USUAL,
              repeats > 0);
}

static void take_gradients(advice *a, const options *o) {
    static const char *const names[] = {"exact",    "central4", "central2",
                                        "central6", "central8", "complex-step"};
    const plan *p = &a->search.plan;
    for (size_t i = 0; i < o->gradients.count; i++)
        list_add(&a->gradients, o->gradients.item[i]);
    for (size_t i = 0; !o->gradients.count && i < sizeof names / sizeof *names;
         i++)
        if (gradient_fits(p, names[i], NULL))
            list_add(&a->gradients, names[i]);
}

static void choose(advice *a) {
    bool *taken = tool_allocate(a->count, sizeof *taken);
    a->best = a->second = a->alone = a->steady = NULL;
    for (study *l; (l = next_best(a, taken));) {
        const char *name = l->integrator;
        taken[l - a->study] = true;
        if (!a->best)
            a->best = l;
        else if (!a->second && strcmp(name, a->best->integrator) != 0)
            a->second = l;
        if (!a->alone && strcmp(l->gradient, "exact") != 0)
            a->alone = l;
        if (!a->steady && !row_drifts(keeps(a, l)))
            a->steady = l;
    }
    free(taken);
}

/* The other answers, where they are too dear to win. */
static void polish_others(advice *a) {
    study *const others[] = {a->second, a->alone, a->steady};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (others[i])
            study_refine(&a->search, others[i], a->target, 1);
}

static void search_all(advice *a) {
    const plan *p = &a->search.plan;
    a->study = tool_allocate(p->integrators.count, sizeof *a->study);
    for (size_t i = 0; i < p->integrators.count; i++)
        a->study[a->count++] =
            study_new(p->integrators.item[i], a->gradients.item[0]);
    descend(a);
    refine(a);
    time_once(a);
    time_best(a);
    vary_gradients(a);
    time_once(a);
    polish(a);
    time_once(a);
    look_beyond(a);
    time_once(a);
    time_best(a);
    choose(a);
    polish_others(a);
    time_once(a);
    choose(a);
}

/* How many places finer a level must be, as its order tells, at least one. */
static int places_short(const advice *a, const row *r) {
    double over = study_error(r, a->search.by_state) / a->target;
    double places = nevh_integrator_adaptive(r->scheme)
                        ? GRID_STRIDE * log10(over)
                        : 40 * log10(over) / r->order;
    return isfinite(places) ? 1 + (int)fmin(places, 2 * GRID_STRIDE)
                            : GRID_STRIDE;
}

/* As much as the whole should take by what the pilot took, and some more. */
static double patience_for(const advice *a, const row *pilot) {
    static const double more = 4;
    double start = a->search.plan.run->t_start;
    return fmax(more * pilot->work * (a->whole - start) / (a->pilot - start),
                a->search.plan.patience);
}

/* Whether the next place that is coarser was tried. */
static bool was_polished(const study *l, size_t level) {
    return level && l->k[level] - l->k[level - 1] == 1;
}

/* The pilot's choice on the whole run, with shorter steps where that is not
   enough. */
static study verified(advice *a, const study *l) {
    enum { TRIES = 6 };
    study full = study_like(l, l->gradient);
    int k = l->k[keeps(a, l) - l->level];
    if (was_polished(l, (size_t)(keeps(a, l) - l->level)))
        full.topped = 1; /* longer steps failed sooner */
    a->search.plan.patience = patience_for(a, keeps(a, l));
    for (int i = 0; i < TRIES && !(i && search_is_over(&a->search, 1)); i++) {
        size_t level = study_run(&a->search, &full, k);
        const row *r = &full.level[level];
        if (study_error(r, a->search.by_state) <= a->target || r->late)
            break;
        k += places_short(a, r) + i;
    }
    study_refine(&a->search, &full, a->target, 1);
    full.end =
        study_ends_level(&full, a->search.by_state) ? STUDY_FLOOR : STUDY_LIMIT;
    return full;
}

/* The next of the pilots that keep the target, the cheapest first: those with
   the gradient that all schemes were tried with, then others. */
static size_t list_next(const advice *a, bool taken[],
                        const study *found[ADVICE_MOST]) {
    size_t count = 0;
    bool *skipped = tool_allocate(a->count, sizeof *skipped);
    for (int others = 0; others < 2 && count == 0; others++) {
        for (size_t i = 0; i < a->count; i++)
            skipped[i] = taken[i] || (!others && a->study[i].gradient !=
                                                     a->gradients.item[0]);
        for (study *l; count < ADVICE_MOST && (l = next_best(a, skipped));) {
            skipped[l - a->study] = taken[l - a->study] = true;
            found[count++] = l;
        }
    }
    free(skipped);
    return count;
}

/* The answers of the pilot, and where none of them keeps the target over the
   whole run, as the gradient's own errors may add up in it, what is next. */
static void verify_pilots(advice *a) {
    const study *pilots[ADVICE_MOST];
    size_t count = advice_list(a, pilots), done = 0;
    study *full = tool_allocate(a->count + 1, sizeof *full);
    bool *taken = tool_allocate(a->count, sizeof *taken), kept = false;
    for (size_t i = 0; i < count; i++)
        taken[pilots[i] - a->study] = true;
    while (count) {
        for (size_t i = 0; i < count; i++, done++) {
            full[done] = verified(a, pilots[i]);
            kept |= least_worked(a, &full[done]) != NULL;
        }
        count = kept || search_is_over(&a->search, 1)
                    ? 0
                    : list_next(a, taken, pilots);
    }
    free(taken);
    for (size_t i = 0; i < a->count; i++)
        study_free(&a->study[i]);
    free(a->study);
    a->study = full, a->count = done;
}

/* A reference for the whole is a plan's own. */
static void verify(advice *a, plan *p) {
    p->t_end = a->search.plan.t_end = a->whole;
    if (p->reference) {
        nevh_reference_free(p->reference);
        p->reference = NULL;
        plan_reference(p, p->t_end);
        a->search.plan.reference = p->reference;
        a->search.plan.reference_end = p->reference_end;
    }
    if (p->reference && p->observable && !plan_observe(p, p->observable)) {
        a->search.plan.observable_scale = p->observable_scale;
        a->search.plan.observable_level = p->observable_level;
    }
    a->search.budget = a->search.spent + SEARCH_BUDGET;
    verify_pilots(a);
    time_once(a);
    time_best(a);
    choose(a);
}

/* Verdicts that the runs of answers leave open, from longer ones; what is
   without drift follows from them. */
static void decide(advice *a) {
    enum { ROUNDS_AT_MOST = 2 };
    a->search.plan.follow = 2;
    for (int i = 0; i < ROUNDS_AT_MOST; i++) {
        const study *found[ADVICE_MOST];
        size_t count = advice_list(a, found);
        for (size_t k = 0; k < count; k++) {
            const row *r = keeps(a, found[k]);
            if (!(r->followed > 0))
                row_follow(&a->search.plan,
                           &found[k]->level[r - found[k]->level]);
        }
        choose(a);
    }
}

static int advise(const options *o, plan *p, double whole) {
    output out;
    if (output_open(&out, o->file))
        return TOOL_USAGE;
    advice a = {.search = search_begin(p, o, SEARCH_BUDGET),
                .pilot = p->t_end,
                .whole = whole,
                .target = fmax(fmax(o->state_error, o->energy_error), o->error),
                .named = o->integrators.count > 0};
    a.search.by_state = o->state_error > 0 || o->observable;
    a.search.keeping = a.named;
    take_gradients(&a, o);
    search_all(&a);
    if (a.best && whole > p->t_end)
        verify(&a, p);
    if (a.best) {
        decide(&a);
        advice_follow(&a, p);
    }
    int status = a.best ? TOOL_OK : advice_none(&a);
    search_end(&a.search);
    if (a.best)
        advice_print(&a, o, out.stream);
    for (size_t i = 0; i < a.count; i++)
        study_free(&a.study[i]);
    free(a.study);
    free(a.not_longer);
    list_free(&a.gradients);
    return output_close(&out, status);
}

static int check_target(const options *o) {
    bool energy = o->energy_error > 0, state = o->state_error > 0;
    if (o->observable && !(o->error > 0))
        return tool_refuse("--observable needs --error X, which X is to be "
                           "relative to its range");
    if (o->error > 0 && !o->observable)
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
    if (status || o->error >= surely * p->observable_error)
        return status;
    tool_refuse("%s: an error of %g of %s cannot be told: the reference's own "
                "is %.1e (%s)",
                p->name, o->error, o->observable, p->observable_error,
                nevh_reference_text(p->reference));
    return TOOL_FAILED;
}

static int check_reference(plan *p, double target) {
    int status = plan_require_reference(p);
    if (status || target >= surely * nevh_reference_error(p->reference))
        return status;
    tool_refuse("%s: a state error of %g cannot be told: that of the reference "
                "is %.1e (%s)",
                p->name, target, nevh_reference_error(p->reference),
                nevh_reference_text(p->reference));
    return TOOL_FAILED;
}

int recommend(const options *o) {
    plan p;
    double whole = NAN;
    if (check_target(o))
        return TOOL_USAGE;
    int status = plan_make(&p, o);
    if (!status)
        status = plan_search(&p, o);
    if (!status && !o->dt.count)
        whole = plan_shorten(&p, SEARCH_BUDGET);
    if (!status && o->state_error > 0)
        status = check_reference(&p, o->state_error);
    if (!status && o->observable)
        status = check_observable(&p, o);
    if (!status)
        status = advise(o, &p, whole);
    plan_free(&p);
    return status;
}
