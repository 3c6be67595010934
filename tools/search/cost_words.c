/* nevh cost: time for one more digit, and the table in words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include <math.h>
#include <string.h>

void cost_notes(const costs *c, list *notes) {
    const plan *p = &c->search.plan;
    if (c->whole > p->t_end)
        list_print(notes,
                   "shortened, so that all schemes can be tried; --t-end %g "
                   "runs all of it",
                   c->whole);
    list_print(notes,
               "cost: steps that keep the largest %s error of the run below "
               "10^-digits; CPU ms (dt%s), * cheapest",
               search_error(&c->search), p->per_unit);
}

/* Levels whose errors are neither coarse nor at rounding. */
typedef struct {
    double *error, *seconds, *evaluations, *frequency;
    size_t count;
} slope;

/* True if another level is more exact and takes no longer. */
static bool is_dominated(const study *l, size_t i) {
    for (size_t k = 0; k < l->count; k++)
        if (k != i && l->level[k].seconds <= l->level[i].seconds &&
            study_error(&l->level[k]) < study_error(&l->level[i]))
            return true;
    return false;
}

static slope slope_new(const study *l) {
    static const double coarse = 2e-2, floors = 30;
    slope s = {tool_allocate(l->count, sizeof(double)),
               tool_allocate(l->count, sizeof(double)),
               tool_allocate(l->count, sizeof(double)),
               tool_allocate(l->count, sizeof(double)), 0};
    double least = INFINITY;
    for (size_t i = 0; i < l->count; i++)
        least = fmin(least, study_error(&l->level[i]));
    least = l->end == STUDY_FLOOR ? fmax(floors * least, 1e-13) : least;
    for (size_t i = 0; i < l->count; i++) {
        const row *r = &l->level[i];
        double error = study_error(r);
        if (error > coarse || error < least || !(r->seconds > 0) ||
            is_dominated(l, i))
            continue;
        s.error[s.count] = error;
        s.seconds[s.count] = r->seconds;
        s.evaluations[s.count] =
            fmax((double)r->counts.gradients, r->counts.hamiltonians);
        s.frequency[s.count++] = 1 / r->dt;
    }
    return s;
}

static const char *remark(const study *l, double time, double theory) {
    bool is_implicit = nevh_integrator_explicit(l->scheme) == NEVH_NO &&
                       !nevh_integrator_adaptive(l->scheme);
    if (time < 0.95 * theory && is_implicit)
        return " fewer sweeps";
    if (time < 0.95 * theory && cost_drifts(l))
        return " drift falls faster";
    return "";
}

static void digit_words(const study *l, list *words) {
    slope s = slope_new(l);
    double time = grid_digit_factor(s.error, s.seconds, s.count);
    double evaluations = grid_digit_factor(s.error, s.evaluations, s.count);
    double steps = grid_digit_factor(s.error, s.frequency, s.count);
    double theory = pow(10, 1.0 / l->level[0].order);
    if (s.count > 2 && isfinite(time))
        list_print(words,
                   " %-21s x %-5.3g  x %-5.3g        x %-5.3g  x %-5.3g%s",
                   l->integrator, time, evaluations, steps, theory,
                   remark(l, evaluations, theory));
}

static void digits_words(const costs *c, list *words) {
    list lines = {0};
    for (size_t i = 0; i < c->count; i++)
        if (cost_draws(c, &c->study[i]) && c->study[i].count)
            digit_words(&c->study[i], &lines);
    if (lines.count)
        list_add(words, " one more digit         time     evaluations    "
                        "steps    10^(1/order)");
    for (size_t i = 0; i < lines.count; i++)
        list_add(words, lines.item[i]);
}

/* The last of the targets from `first` on that have the same cheapest. */
static size_t last_alike(const costs *c, size_t first) {
    const study *best = costs_cheapest(c, first, false);
    while (first + 1 < COST_TARGETS && !cost_is_beyond(c, first + 1) &&
           costs_cheapest(c, first + 1, false) == best)
        first++;
    return first;
}

/* "dt = 0.1", "tolerance = 0.001". */
static char *step_text(const row *r) {
    return r->tolerance > 0 ? text_print("tolerance = %.3g", r->tolerance)
                            : text_print("dt = %.6g", r->dt);
}

static void best_words(const costs *c, size_t first, size_t last, list *words) {
    const study *best = costs_cheapest(c, first, false);
    const row *a = cost_cell(best, first), *b = cost_cell(best, last);
    char *digits =
        text_print(first < last ? "%.0f to %.0f" : "%.0f",
                   -log10(cost_target[first]), -log10(cost_target[last]));
    char *from = cost_milliseconds(a->seconds),
         *to = cost_milliseconds(b->seconds), *begin = step_text(a),
         *end = step_text(b);
    if (a == b)
        list_print(words, "For %s digits take %s at %s: %s ms.", digits,
                   best->integrator, end, to);
    else
        list_print(words,
                   "For %s digits take %s, from %s (%s ms) to %s (%s "
                   "ms).",
                   digits, best->integrator, begin, from, end, to);
}

/* At the most digits that both reach. */
static void yardstick_words(const costs *c, const char *name, list *words) {
    for (size_t k = COST_TARGETS; k-- > 0;)
        for (size_t i = 0; i < c->count && !cost_is_beyond(c, k); i++) {
            const study *l = &c->study[i];
            const study *best = costs_cheapest(c, k, false);
            if (strcmp(l->integrator, name) != 0 || !best || best == l ||
                !cost_cell(l, k))
                continue;
            double factor =
                cost_cell(l, k)->seconds / cost_cell(best, k)->seconds;
            list_print(words,
                       factor < 9.5 ? "%.0f digits by %s take %.1f times as "
                                      "long."
                                    : "%.0f digits by %s take %.0f times as "
                                      "long.",
                       -log10(cost_target[k]), name, factor);
            return;
        }
}

static void winner_words(const costs *c, list *words) {
    bool any = false;
    for (size_t i = 0; i < c->count; i++)
        any |= !c->study[i].exact;
    for (size_t k = 0; k < COST_TARGETS && any && !cost_is_beyond(c, k); k++) {
        size_t last = last_alike(c, k);
        if (costs_cheapest(c, k, false))
            best_words(c, k, last, words);
        else
            list_print(words, "No integrator reaches %.0f digits.",
                       -log10(cost_target[k]));
        k = last;
    }
    yardstick_words(c, "verlet", words);
    yardstick_words(c, "rk4", words);
}

static char *names_where(const costs *c,
                         bool (*holds)(const costs *, const study *)) {
    char *names = text_print("%s", "");
    for (size_t i = 0; i < c->count; i++) {
        const study *l = &c->study[i];
        if (l->count && holds(c, l) && !strstr(names, l->integrator))
            text_extend(&names, "%s%s", *names ? ", " : "", l->integrator);
    }
    return names;
}

static bool drifts_here(const costs *c, const study *l) {
    return cost_shows(c, l) && cost_drifts(l);
}

static bool conserves_energy(const costs *c, const study *l) {
    return l->end != STUDY_REFUSED && !l->exact && !costs_count(c, l);
}

static bool is_exact(const costs *c, const study *l) {
    (void)c;
    return l->end != STUDY_REFUSED && l->exact;
}

static bool has_series(const costs *c, const study *l) {
    return cost_shows(c, l) && nevh_integrator_needs_formulas(l->scheme);
}

static bool has_parts(const costs *c, const study *l) {
    return cost_shows(c, l) && nevh_integrator_needs(l->scheme) & NEVH_PARTS;
}

static void name_words(const costs *c, list *words, const char *format,
                       bool (*holds)(const costs *, const study *)) {
    char *names = names_where(c, holds);
    if (*names)
        list_print(words, "%s: %s", names, format);
}

/* The first of the table in full, the others by name. */
static void failure_words(const costs *c, list *words) {
    enum { FEW = 4 };
    list others = {0};
    const row *first = NULL;
    for (size_t i = 0; i < c->count; i++) {
        const row *r = study_failure(&c->study[i]);
        if (!r)
            continue;
        if (first && !list_has(&others, r->integrator))
            list_add(&others, r->integrator);
        else if (!first)
            first = r;
    }
    char *names = list_joined(&others);
    if (first && costs_fail(c))
        list_print(words, "%s with %s at dt = %.4g %s.", first->integrator,
                   first->gradient, first->dt, first->status);
    else if (first)
        list_print(words,
                   "%s fails with each step that was tried: --integrators %s "
                   "tells why.",
                   first->integrator, first->integrator);
    if (others.count > FEW)
        list_print(words, "%zu others fail as well.", others.count);
    else if (others.count)
        list_print(words, "%s %s as well.", names,
                   others.count == 1 ? "fails" : "fail");
}

static void hidden_words(const costs *c, list *words) {
    size_t dear = 0, untried = 0;
    for (size_t i = 0; i < c->count; i++) {
        const study *l = &c->study[i];
        untried += l->end == STUDY_LIMIT && !l->count;
        dear += l->end != STUDY_REFUSED && l->count && costs_count(c, l) &&
                !study_failure(l) && !cost_shows(c, l);
    }
    if (dear)
        list_print(words,
                   "%zu more integrators work but are never the cheapest; name "
                   "one with --integrators to see its row, or list all with "
                   "--format csv.",
                   dear);
    if (untried)
        list_print(words,
                   "%zu were not tried, for lack of time: --t-end shortens "
                   "the run, --integrators selects schemes.",
                   untried);
}

static double longest_cell(const costs *c) {
    double longest = 0;
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < c->study[i].count; k++)
            longest = fmax(longest, c->study[i].level[k].seconds);
    return longest;
}

/* The median of what was repeated. */
static double typical_spread(const costs *c) {
    size_t most = 0, count = 0;
    for (size_t i = 0; i < c->count; i++)
        most += c->study[i].count;
    double *part = tool_allocate(most, sizeof *part);
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < c->study[i].count; k++) {
            const row *r = &c->study[i].level[k];
            if (r->ran && r->spread > 0)
                part[count++] = r->spread / r->seconds;
        }
    return numbers_median(part, count);
}

static bool any_word(const costs *c, const char *wanted) {
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < COST_TARGETS; k++) {
            const char *word = cost_word(c, &c->study[i], k);
            if (word && strcmp(word, wanted) == 0 &&
                cost_shows(c, &c->study[i]) && !cost_is_empty(c, k))
                return true;
        }
    return false;
}

static bool any_repeated(const costs *c) {
    for (size_t i = 0; i < c->count; i++)
        for (size_t k = 0; k < COST_TARGETS; k++)
            if (cost_shows(c, &c->study[i]) && cost_repeats(c, &c->study[i], k))
                return true;
    return false;
}

/* The digits whose columns are left out, from the first of them on. */
static void empty_words(const costs *c, list *words) {
    size_t k = 0;
    while (k < COST_TARGETS && !cost_is_empty(c, k))
        k++;
    if (k == COST_TARGETS)
        return;
    if (cost_is_beyond(c, k))
        list_print(words,
                   "%.0f digits and more are not resolved: the error of the "
                   "reference is larger.",
                   -log10(cost_target[k]));
    else
        list_print(words, "No step reaches %.0f digits.",
                   -log10(cost_target[k]));
}

static void legend_words(const costs *c, list *words) {
    char *longest = cost_milliseconds(longest_cell(c));
    empty_words(c, words);
    if (any_repeated(c))
        list_add(words, "=: the same run as for the digits to its left, whose "
                        "step keeps these as well.");
    if (any_word(c, "> limit"))
        list_print(
            words,
            "> limit: not reached within the longest run (%s ms); others "
            "are much cheaper.",
            longest);
    if (any_word(c, "floor"))
        list_add(words, "floor: shorter steps do not reduce the error: "
                        "rounding, or the error of the gradient, limits it.");
    double spread = 100 * typical_spread(c);
    char *share =
        text_print(", half of which lie within %.1g %% of them", spread);
    list_print(
        words,
        "Times were measured on this machine: medians of repeated runs%s; "
        "evaluations are exact.",
        spread > 0 ? share : "");
}

void cost_words(costs *c, list *words) {
    digits_words(c, words);
    cost_price(c, words);
    list_add(words, " ");
    winner_words(c, words);
    name_words(
        c, words,
        "the error grows with time: a longer run costs more for the same "
        "digits.",
        drifts_here);
    name_words(
        c, words,
        "the energy is conserved exactly at any step, so that this table has "
        "no ranking; use --by state.",
        conserves_energy);
    if (c->search.plan.friction && !c->search.plan.by_state)
        list_add(words, "Friction " FRICTION_IS ": compare --by state.");
    name_words(
        c, words,
        "the parts solve this H exactly with any step, so that there is no error "
        "to rank or to draw.",
        is_exact);
    name_words(c, words, "a series counts as one evaluation.", has_series);
    name_words(c, words, "exact steps of parts are not counted as evaluations.",
               has_parts);
    failure_words(c, words);
    hidden_words(c, words);
    legend_words(c, words);
}
