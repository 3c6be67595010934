/* nevh recommend: the search for what keeps an error, the cheapest first.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "recommend_private.h"
#include <math.h>
#include <string.h>

bool recommend_counts(const recommendation *a, const study *l) {
    return a->named || a->search.plan.by_state || !study_keeps_energy(l);
}

row *recommend_chosen(const recommendation *a, const study *l) {
    return study_cheapest(l, a->target);
}

/* The cheapest level that keeps the target, of the studies that count. */
row *recommend_keeps(const recommendation *a, const study *l) {
    return recommend_counts(a, l) ? recommend_chosen(a, l) : NULL;
}

/* The least work of the studies that take gradients: Taylor series that are far
   ahead do not end the search for the best of the others. */
static double least_work(const recommendation *a) {
    double least = INFINITY;
    for (size_t i = 0; i < a->count; i++) {
        const study *l = &a->study[i];
        const row *r = recommend_keeps(a, l);
        if (r && study_takes_gradients(l))
            least = fmin(least, r->work);
    }
    return least;
}

/* Times may tell otherwise than work: a factor of 2, at most. */
static const double nearly = 2.5;

/* The work at the target, by the last level: where errors fall with `orders` times
   the order of the scheme. */
static double expected_work(const recommendation *a, const study *l,
                            double orders) {
    const row *last = &l->level[l->count - 1];
    double over = study_error(last) / a->target;
    double order = fmax(nevh_integrator_order(l->scheme), 1);
    return isfinite(over)
               ? last->work * pow(fmax(over, 1), 1 / (orders * order))
               : last->work;
}

/* A shorter step costs more, but for the sweeps that it saves. */
static bool is_hopeless(const recommendation *a, const study *l) {
    static const double steep = 2; /* errors may fall faster for a while */
    return expected_work(a, l, steep) > nearly * least_work(a);
}

/* The open study that should reach the target first; NULL: there is none. */
static study *descend_next(const recommendation *a) {
    study *next = NULL;
    double least = INFINITY;
    for (size_t i = 0; i < a->count; i++) {
        study *l = &a->study[i];
        double work = l->end == STUDY_OPEN ? expected_work(a, l, 1) : NAN;
        if (work < least || (!next && l->end == STUDY_OPEN)) {
            least = work;
            next = l;
        }
    }
    return next;
}

static void descend(recommendation *a) {
    static const double share = 0.6;
    study *next;
    for (size_t i = 0; i < a->count; i++)
        study_begin(&a->search, &a->study[i]);
    while ((next = descend_next(a)) && !search_is_over(&a->search, share))
        if (recommend_keeps(a, next) || is_hopeless(a, next))
            next->end = STUDY_LIMIT;
        else
            study_descend(&a->search, next);
}

static void refine(recommendation *a) {
    for (size_t i = 0; i < a->count; i++) {
        study *l = &a->study[i];
        size_t k = 0;
        while (k < l->count && study_error(&l->level[k]) > a->target)
            k++;
        if (recommend_keeps(a, l) &&
            (k == 0 || l->level[k - 1].work < nearly * least_work(a)))
            study_refine(&a->search, l, a->target, GRID_COARSE);
    }
}

/* The one that works least, of those without drift, or with another integrator
   than that of all; NULL: there is none. */
static study *least_of(const recommendation *a, bool steady,
                       const study *without) {
    study *best = NULL;
    for (size_t i = 0; i < a->count; i++) {
        study *l = &a->study[i];
        const row *r = recommend_keeps(a, l);
        if (r && !(steady && row_drifts(r)) &&
            !(without && strcmp(without->integrator, l->integrator) == 0) &&
            (!best || r->work < recommend_keeps(a, best)->work))
            best = l;
    }
    return best;
}

static bool was_timed(const study *l) {
    bool timed = false;
    for (size_t i = 0; i < l->count; i++)
        timed |= isfinite(l->level[i].seconds);
    return timed;
}

/* Lists the rows that may win, be the runner-up or give other evidence, and are not
   timed yet, or have a cheaper level since; returns their number. */
static size_t list_untimed(const recommendation *a, row *found[]) {
    double least = least_work(a);
    study *second = least_of(a, false, least_of(a, false, NULL));
    study *steady = least_of(a, true, NULL);
    size_t count = 0;
    for (size_t i = 0; i < a->count; i++) {
        study *l = &a->study[i];
        row *r = recommend_keeps(a, l);
        bool varied = strcmp(l->gradient, a->gradients.item[0]) != 0;
        if (r && isnan(r->seconds) &&
            (varied || was_timed(l) || l == second || l == steady ||
             r->work < nearly * least))
            found[count++] = r;
    }
    return count;
}

void recommend_time_once(recommendation *a) {
    row **found = tool_allocate(a->count, sizeof *found);
    size_t count = list_untimed(a, found);
    rows_choose_native(&a->search.plan, found, count, true);
    for (size_t i = 0; i < count; i++)
        rows_time(&a->search.plan, &found[i], 1, 1, a->search.repeats > 0);
}

/* True if it is the better of two that take as long: no drift, or less work. */
static bool is_preferred(const row *r, const row *to) {
    bool drifts = row_drifts(r), other = row_drifts(to);
    return drifts == other ? r->work < to->work : other;
}

study *recommend_next_best(const recommendation *a, const bool taken[]) {
    static const double alike = 1.1; /* of times, which noise may make */
    study *best = NULL;
    double least = INFINITY;
    for (size_t i = 0; i < a->count; i++) {
        const row *r = taken[i] ? NULL : recommend_keeps(a, &a->study[i]);
        if (r)
            least = fmin(least, r->fastest);
    }
    for (size_t i = 0; i < a->count; i++) {
        const row *r = taken[i] ? NULL : recommend_keeps(a, &a->study[i]);
        if (r && r->fastest <= alike * least &&
            (!best || is_preferred(r, recommend_keeps(a, best))))
            best = &a->study[i];
    }
    return best;
}

static void add_study(recommendation *a, study l) {
    a->study = tool_grown(a->study, a->count, sizeof *a->study);
    a->study[a->count++] = l;
}

/* The same steps with another gradient, and finer ones where that is not
   enough. */
static study with_gradient(recommendation *a, const study *l, int k,
                           const char *gradient) {
    study other = study_like(l, gradient);
    for (int finer = 0; finer <= GRID_STRIDE; finer += GRID_COARSE) {
        size_t i = study_run(&a->search, &other, k + finer);
        if (study_error(&other.level[i]) <= a->target)
            break;
    }
    other.end = STUDY_LIMIT;
    return other;
}

/* The best, and those that take less than `factor` times as long; at most
   `most`.  With `gradients`: of those that take gradients. */
static size_t list_best(const recommendation *a, double factor, bool gradients,
                        study *found[], size_t most) {
    bool *taken = tool_allocate(a->count, sizeof *taken);
    size_t count = 0;
    for (size_t i = 0; i < a->count; i++)
        taken[i] = gradients && !study_takes_gradients(&a->study[i]);
    for (study *l; count < most && (l = recommend_next_best(a, taken));) {
        if (count && recommend_keeps(a, l)->fastest >
                         factor * recommend_keeps(a, found[0])->fastest)
            break;
        taken[l - a->study] = true;
        found[count++] = l;
    }
    return count;
}

/* The least work that keeps the target without the exact gradient. */
static double least_by_values(const recommendation *a) {
    double least = INFINITY;
    for (size_t i = 0; i < a->count; i++) {
        const study *l = &a->study[i];
        const row *r = recommend_keeps(a, l);
        if (r && study_takes_gradients(l) && strcmp(l->gradient, "exact") != 0)
            least = fmin(least, r->work);
    }
    return least;
}

/* Other gradients for the best few schemes: they change the price of a step, and
   where errors end, but hardly the step that is needed.  What they change the price
   by, the first scheme tells: with others only those are run that may be cheaper. */
static void vary_gradients(recommendation *a) {
    enum { FEW = 10 };
    static const double factor = 2.2, margin = 1.3;
    study *found[FEW], model[FEW];
    int k[FEW];
    double work[FEW], *price = tool_allocate(a->gradients.count, sizeof *price);
    size_t count = list_best(a, factor, true, found, FEW);
    for (size_t i = 0; i < count; i++) {
        const row *r = recommend_keeps(a, found[i]);
        model[i] = *found[i];
        k[i] = found[i]->k[r - found[i]->level];
        work[i] = r->work;
    }
    for (size_t i = 0; i < count; i++)
        for (size_t g = 1; g < a->gradients.count; g++) {
            if (search_is_over(&a->search, 1) ||
                (i && !(price[g] * work[i] <= margin * least_by_values(a))))
                continue;
            study l = with_gradient(a, &model[i], k[i], a->gradients.item[g]);
            if (i == 0)
                price[g] = l.level[0].work / work[0];
            add_study(a, l);
        }
}

/* The steps of those that may win, to the last place. */
static void polish(recommendation *a) {
    enum { FEW = 8 };
    static const double factor = 1.4;
    study *found[FEW];
    size_t count = list_best(a, factor, false, found, FEW);
    for (size_t i = 0; i < count; i++)
        study_refine(&a->search, found[i], a->target, 1);
}

/* Errors do not fall evenly: of the best few, each place up to half a stride
   beyond what keeps the target. */
static void look_beyond(recommendation *a) {
    enum { FEW = 8 };
    static const double factor = 1.4;
    study *found[FEW];
    size_t count = list_best(a, factor, false, found, FEW);
    for (size_t i = 0; i < count; i++) {
        int from = found[i]->k[recommend_keeps(a, found[i]) - found[i]->level];
        for (int k = from - 1; k >= from - GRID_STRIDE / 2; k--)
            if (!search_is_over(&a->search, 1) &&
                found[i]->end != STUDY_GIVEN &&
                !nevh_integrator_adaptive(found[i]->scheme) &&
                study_fits_steps(&a->search, k))
                study_run(&a->search, found[i], k);
    }
}

static void time_within(recommendation *a, double factor, size_t rounds) {
    enum { FEW = 24 };
    study *found[FEW];
    row *level[FEW];
    size_t count = list_best(a, factor, false, found, FEW);
    size_t repeats = a->search.repeats;
    for (size_t i = 0; i < count; i++)
        level[i] = recommend_keeps(a, found[i]);
    rows_time(&a->search.plan, level, count, repeats ? repeats : rounds,
              repeats > 0);
}

/* Times those that may win, and more often those that may be the first of them. */
void recommend_time_best(recommendation *a) {
    time_within(a, 1.7, 9);
    if (!a->search.repeats)
        time_within(a, 1.15, 25);
}

void recommend_take_gradients(recommendation *a, const options *o) {
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

void recommend_choose(recommendation *a) {
    bool *taken = tool_allocate(a->count, sizeof *taken);
    a->best = a->second = a->alone = a->steady = NULL;
    for (study *l; (l = recommend_next_best(a, taken));) {
        const char *name = l->integrator;
        taken[l - a->study] = true;
        if (!a->best)
            a->best = l;
        else if (!a->second && strcmp(name, a->best->integrator) != 0)
            a->second = l;
        if (!a->alone && study_takes_gradients(l) &&
            strcmp(l->gradient, "exact") != 0)
            a->alone = l;
        if (!a->steady && !row_drifts(recommend_keeps(a, l)))
            a->steady = l;
    }
}

/* The other answers, where they are too dear to win. */
static void polish_others(recommendation *a) {
    study *const others[] = {a->second, a->alone, a->steady};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (others[i])
            study_refine(&a->search, others[i], a->target, 1);
}

void recommend_search(recommendation *a) {
    const plan *p = &a->search.plan;
    a->study = tool_allocate(p->integrators.count, sizeof *a->study);
    for (size_t i = 0; i < p->integrators.count; i++)
        a->study[a->count++] =
            study_new(p, p->integrators.item[i], a->gradients.item[0]);
    descend(a);
    refine(a);
    recommend_time_once(a);
    recommend_time_best(a);
    vary_gradients(a);
    recommend_time_once(a);
    polish(a);
    recommend_time_once(a);
    look_beyond(a);
    recommend_time_once(a);
    recommend_time_best(a);
    recommend_choose(a);
    polish_others(a);
    recommend_time_once(a);
    recommend_choose(a);
}
