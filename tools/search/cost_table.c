/* nevh cost: target digits beside each other, a row an integrator.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include <math.h>
#include <string.h>

bool cost_is_yardstick(const study *l) {
    static const char *const names[] = {"verlet", "midpoint", "rk4"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(l->integrator, names[i]) == 0)
            return true;
    return false;
}

/* Cheapest, or nearly so, for some target. */
static bool is_cheap(const costs *c, const study *l) {
    static const double nearly = 1.1;
    for (size_t k = 0; k < COST_TARGETS; k++) {
        const study *best = costs_cheapest(c, k, false);
        const row *r = cost_cell(l, k);
        if (best && r && r->seconds <= nearly * cost_cell(best, k)->seconds)
            return true;
    }
    return false;
}

/* True if so few fail that each has a row. */
static bool few_fail(const costs *c) {
    enum { FEW = 4 };
    size_t count = 0;
    for (size_t i = 0; i < c->count; i++)
        count += study_failure(&c->study[i]) != NULL;
    return count <= FEW;
}

bool cost_draws(const costs *c, const study *l) {
    return cost_shows(c, l) && !l->exact && !study_failure(l);
}

bool cost_shows(const costs *c, const study *l) {
    if (c->all)
        return l->count > 0;
    if (study_failure(l))
        return cost_is_yardstick(l) || few_fail(c);
    return l->end != STUDY_REFUSED && costs_count(c, l) &&
           (cost_is_yardstick(l) || is_cheap(c, l));
}

char *cost_milliseconds(double seconds) {
    return text_print(seconds < 0.0995 ? "%.2g" : "%.0f", 1000 * seconds);
}

/* At most of the steps that keep some digits and are above rounding. */
bool cost_drifts(const study *l) {
    size_t count = 0, drifting = 0;
    for (size_t i = 0; i < l->count; i++) {
        const nevh_energy_report *e = &l->level[i].energy;
        bool counts =
            l->level[i].ran && e->max < cost_target[0] && e->max > 1e-12;
        count += counts;
        drifting += counts && row_drifts(&l->level[i]);
    }
    return 2 * drifting > count;
}

bool cost_is_beyond(const costs *c, size_t target) {
    return c->search.plan.by_state &&
           cost_target[target] <
               (c->search.plan.observable
                    ? c->search.plan.observable_error
                    : nevh_reference_error(c->search.plan.reference));
}

static char *cell_text(const row *r, bool star) {
    return text_print("%s %s (%.6g)", star ? "*" : " ",
                      cost_milliseconds(r->seconds), r->dt);
}

const char *cost_word(const costs *c, const study *l, size_t target) {
    if (cost_is_beyond(c, target))
        return "-";
    if (l->end == STUDY_REFUSED)
        return "refused";
    if (study_failure(l))
        return "fails";
    if (!costs_count(c, l) && !l->exact)
        return "-";
    if (cost_cell(l, target))
        return NULL;
    return l->end == STUDY_LIMIT   ? "> limit"
           : l->end == STUDY_GIVEN ? "-"
                                   : "floor";
}

bool cost_is_empty(const costs *c, size_t target) {
    for (size_t i = 0; i < c->count; i++) {
        const char *word = cost_word(c, &c->study[i], target);
        if (cost_shows(c, &c->study[i]) && !(word && strcmp(word, "-") == 0))
            return false;
    }
    return true;
}

bool cost_repeats(const costs *c, const study *l, size_t target) {
    return target && !cost_word(c, l, target - 1) && !cost_word(c, l, target) &&
           cost_cell(l, target) == cost_cell(l, target - 1);
}

static void show_cell(const costs *c, const study *l, size_t target, table *t) {
    const char *word = cost_word(c, l, target);
    bool star = costs_cheapest(c, target, false) == l;
    char *text = word ? text_print("  %s", word)
                 : cost_repeats(c, l, target)
                     ? text_print("%s =", star ? "*" : " ")
                     : cell_text(cost_cell(l, target), star);
    table_text(t, text);
}

table *cost_table(const costs *c) {
    table *t = table_new();
    bool gradients = c->search.plan.gradients.count > 1;
    table_column(t, "integrator");
    if (gradients)
        table_column(t, "gradient");
    for (size_t k = 0; k < COST_TARGETS; k++) {
        if (cost_is_empty(c, k))
            continue;
        table_column(t, text_print("  1e%.0f", log10(cost_target[k])));
    }
    for (size_t i = 0; i < c->count; i++) {
        const study *l = &c->study[i];
        if (!cost_shows(c, l))
            continue;
        table_text(t, text_print("%s%s", l->integrator,
                                 cost_drifts(l) ? ", drifts" : ""));
        if (gradients)
            table_text(t, l->gradient);
        for (size_t k = 0; k < COST_TARGETS; k++)
            if (!cost_is_empty(c, k))
                show_cell(c, l, k, t);
    }
    return t;
}
