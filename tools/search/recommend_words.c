/* nevh recommend: the answer, with its evidence.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "recommend_private.h"
#include <math.h>
#include <string.h>

size_t recommend_list(const recommendation *a,
                      const study *found[RECOMMEND_MOST]) {
    const study *const all[RECOMMEND_MOST] = {a->best, a->second, a->alone,
                                              a->steady};
    size_t count = 0;
    for (size_t i = 0; i < RECOMMEND_MOST; i++) {
        bool known = !all[i];
        for (size_t k = 0; k < count; k++)
            known |= found[k] == all[i];
        if (!known)
            found[count++] = all[i];
    }
    return count;
}

static const char *name_of(const recommendation *a, const study *l) {
    return l == a->best     ? "cheapest"
           : l == a->second ? "runner-up"
           : l == a->alone  ? "from H alone"
                            : "no drift";
}

static void show_end(const recommendation *a, const row *r, table *t) {
    double holds = recommend_holds(r);
    if (isnan(holds))
        table_text(t, NULL);
    else if (isinf(holds))
        table_shown(t, "> %.4g", a->longer);
    else
        table_shown(t, "%.4g", holds);
}

static bool has_states(const recommendation *a) {
    return !a->search.plan.by_state && a->search.plan.reference;
}

static void show(const recommendation *a, const study *l, const char *what,
                 table *t) {
    const row *r = recommend_chosen(a, l);
    table_text(t, what);
    table_text(t, r->integrator);
    table_text(t, study_takes_gradients(l) ? r->gradient : NULL);
    table_shown(t, "%.6g", r->dt);
    table_shown(t, "%.1e", study_error(r));
    if (has_states(a))
        state_show(t, &a->search.plan, r);
    show_end(a, r, t);
    table_shown(t, "%.3g", 1000 * r->seconds);
    table_shown(t, "%llu", (unsigned long long)r->counts.gradients);
    table_shown(t, "%.0f", r->counts.hamiltonians);
    table_text(t, nevh_verdict_name(r->energy.verdict));
}

static table *shown(const recommendation *a) {
    table *t = table_new();
    table_column(t, "");
    table_column(t, "integrator");
    table_column(t, "gradient");
    table_column(t, "dt");
    table_column(t, text_print("%s\nerror", search_error(&a->search)));
    if (has_states(a))
        table_column(t, "state\nerror");
    table_titles(t, "holds\nuntil t,ms,gradients,H evals,energy");
    const study *found[RECOMMEND_MOST];
    size_t count = recommend_list(a, found);
    for (size_t i = 0; i < count; i++)
        show(a, found[i], name_of(a, found[i]), t);
    return t;
}

static size_t list_rows(const recommendation *a, row rows[RECOMMEND_MOST]) {
    const study *found[RECOMMEND_MOST];
    size_t count = recommend_list(a, found);
    for (size_t i = 0; i < count; i++)
        rows[i] = *recommend_chosen(a, found[i]);
    return count;
}

/* As the rows were run. */
static char *command_line(const recommendation *a, const options *o,
                          const row *r) {
    const plan *p = &a->search.plan;
    char *text = shell_line(o, "compare", p->name);
    text = shell_option(text, "integrators", r->integrator);
    if (study_takes_gradients(a->best))
        text = shell_option(text, "gradient", r->gradient);
    if (study_takes_gradients(a->best) && p->gradient_step > 0)
        text = shell_number(text, "gradient-step", p->gradient_step);
    text =
        shell_number(text, "dt", r->tolerance > 0 ? a->search.landing : r->dt);
    if (r->tolerance > 0)
        text = shell_number(text, "tolerance", r->tolerance);
    if (o->t_end)
        text = shell_option(text, "t-end", o->t_end);
    if (p->observable)
        text = shell_option(text, "observable", p->observable);
    return text;
}

static void setting_words(const recommendation *a, const row *r, list *words) {
    list_add(words, "  [run]");
    list_print(words, "  integrators = %s", r->integrator);
    if (study_takes_gradients(a->best))
        list_print(words, "  gradient = %s", r->gradient);
    list_print(words, "  dt = %.6g",
               r->tolerance > 0 ? a->search.landing : r->dt);
    if (r->tolerance > 0)
        list_print(words, "  tolerance = %.6g", r->tolerance);
}

/* In the observable's unit. */
static void size_words(const recommendation *a, const row *r, list *words) {
    const plan *p = &a->search.plan;
    const char *unit =
        nevh_scene_label(p->scene, p->observable ? p->observable : "");
    if (p->observable)
        list_print(words, "That is %.3g%s%s of %s.",
                   r->observable_error * p->observable_scale, *unit ? " " : "",
                   unit, p->observable);
}

/* In the orbit's own measure. */
static void step_words(const recommendation *a, const row *r, list *words) {
    const plan *p = &a->search.plan;
    if (a->best->exact) {
        list_print(words,
                   "The parts of %s solve this H exactly with any step: its "
                   "error is of rounding.",
                   r->integrator);
        return;
    }
    double steps = a->period / r->dt;
    bool at_start = a->period_at == p->run->t_start;
    char *where = at_start ? text_print("at the start")
                           : text_print("at t = %.3g", a->period_at);
    if (isfinite(steps))
        list_print(words,
                   steps < 1 ? "A step is %.3g times %.3g%s, the shortest "
                               "period of the orbit, %s%s."
                             : "That is %.3g steps in %.3g%s, the shortest "
                               "period of the orbit, %s%s.",
                   steps < 1 ? 1 / steps : steps, a->period, p->unit, where,
                   at_start ? "" : p->unit);
}

static void longer_words(const recommendation *a, const row *r, list *words) {
    double holds = recommend_holds(r);
    if (a->not_longer)
        list_print(words, "Nothing is known of longer runs: %s.",
                   a->not_longer);
    else if (isinf(holds))
        list_print(words,
                   "It keeps that in a run three times as long, too, until t = "
                   "%g.",
                   a->longer);
    else if (r->error_bound && r->error_bound->broken)
        list_print(words,
                   "In a longer run that holds until t = %.6g: beyond it ask "
                   "again, with --t-end.",
                   holds);
    else if (r->error_bound && holds > a->search.plan.t_end)
        list_print(words,
                   "In a longer run that holds until t = %.6g at least, up to "
                   "which it was followed.",
                   holds);
    else if (r->error_bound)
        list_add(words, "Longer runs were not followed to their end, for the "
                        "time that they take.");
}

/* Warns of errors that the energy does not show. */
static void warn(const recommendation *a, const row *r, list *words) {
    const plan *p = &a->search.plan;
    if (a->search.plan.by_state || !p->reference)
        return;
    char *unseen = energies_unseen(p, r);
    if (state_out_of_step(r))
        list_print(words,
                   "Warning: the orbit is out of step with the true one: its "
                   "state error is %.2g.  The energy does not show that; ask "
                   "for --state-error, or for what matters by --observable.",
                   r->state_error);
    else if (isnan(r->state_error))
        list_print(words,
                   "The energy alone is kept: after t = %.4g nothing is known "
                   "of the true orbit.",
                   nevh_reference_horizon(p->reference));
    if (unseen)
        list_add(words, unseen);
}

/* On its energy, as far as the run, or a longer one, decides it. */
static void drift_words(const row *r, list *words) {
    nevh_verdict verdict = r->energy.verdict;
    bool open = verdict == NEVH_UNDECIDED;
    bool still = r->energy.max == 0 && !(r->longer.max > 0);
    if (verdict == NEVH_DRIFTS)
        list_add(words, "Its energy drifts: for longer runs ask again.");
    if (r->followed > 0 && !open && (r->open || verdict != NEVH_BOUNDED))
        list_print(
            words,
            "The verdict on its energy is from a run %.3g times as long.",
            r->followed);
    if (open && !still)
        list_print(words,
                   "The run is too short to show whether its energy drifts: "
                   "nevh compare, or a longer --t-end, follows it further.");
}

static void answer_words(const recommendation *a, const options *o,
                         list *words) {
    const row *r = recommend_chosen(a, a->best);
    const char *what = search_error(&a->search);
    char *line = command_line(a, o, r);
    bool gradients = study_takes_gradients(a->best);
    list_print(words,
               "Take %s%s%s%s at %s = %.6g: the largest %s "
               "error over the whole run is %.1e, of the %.1e allowed.",
               r->integrator, gradients ? " with the " : "",
               gradients ? r->gradient : "", gradients ? " gradient" : "",
               r->tolerance > 0 ? "tolerance" : "dt",
               r->tolerance > 0 ? r->tolerance : r->dt, what, study_error(r),
               a->target);
    size_words(a, r, words);
    step_words(a, r, words);
    longer_words(a, r, words);
    warn(a, r, words);
    drift_words(r, words);
    if (isfinite(a->whole) && a->pilot < a->whole)
        list_print(words, "Chosen by runs until t = %g, and verified until %g.",
                   a->pilot, a->whole);
    if (a->second)
        list_print(words, "%s, the runner-up, takes %.2f times as long.",
                   a->second->integrator,
                   recommend_chosen(a, a->second)->fastest / r->fastest);
    if (a->alone && a->alone != a->best && a->alone != a->second)
        list_print(words,
                   "From values of H alone %s with %s takes %.2f times as "
                   "long.",
                   a->alone->integrator, a->alone->gradient,
                   recommend_chosen(a, a->alone)->fastest / r->fastest);
    if (a->steady && a->steady != a->best)
        list_print(words, "Without drift %s takes %.2f times as long.",
                   a->steady->integrator,
                   recommend_chosen(a, a->steady)->fastest / r->fastest);
    list_print(words, "%zu runs were tried.", a->search.runs);
    list_add(words, " ");
    list_add(words, line);
    list_add(words, " ");
    setting_words(a, r, words);
}

void recommend_print(const recommendation *a, const options *o, FILE *f) {
    const plan *searched = &a->search.plan;
    bool is_table = o->format == FORMAT_TABLE;
    row rows[RECOMMEND_MOST];
    size_t count = list_rows(a, rows);
    page p = {.table = is_table ? shown(a) : records(searched, rows, count)};
    if (!is_table || !o->quiet) {
        plan_notes(searched, &p.before);
        native_notes(searched, rows, count, &p.before);
        time_notes(searched, &p.before);
        state_notes(searched, &p.before);
        observable_notes(searched, &p.before);
        answer_words(a, o, &p.after);
        time_words(searched, rows, count, &p.after);
        passed_words(searched, rows, count, &p.after);
    }
    page_print(&p, o, f);
}

/* Finds the smallest error of the studies that count; at_floor: of those that ended
   at their floor. */
static const study *most_exact(const recommendation *a, bool at_floor,
                               double *least) {
    const study *best = NULL;
    *least = INFINITY;
    for (size_t i = 0; i < a->count; i++)
        for (size_t k = 0;
             recommend_counts(a, &a->study[i]) && k < a->study[i].count; k++) {
            if (at_floor && a->study[i].end != STUDY_FLOOR)
                continue;
            double error = study_error(&a->study[i].level[k]);
            if (error < *least)
                *least = error, best = &a->study[i];
        }
    return best;
}

static const char *floor_of(const study *l, double least) {
    return least > 1e-11 && strcmp(l->gradient, "exact") != 0
               ? "the gradient's own error"
               : "rounding";
}

/* If the most exact study ended before its floor, another study whose floor is near
   the same error shows the effect of shorter steps. */
static char *reason(const recommendation *a, const study *l, double least) {
    static const double near = 30;
    double level;
    const study *floor = most_exact(a, true, &level);
    if (l->end == STUDY_GIVEN)
        return text_print("these steps do not reach it");
    if (l->end == STUDY_FLOOR)
        return text_print("shorter steps do not lessen it, for %s",
                          floor_of(l, least));
    if (floor && level < near * least)
        return text_print("of %s shorter steps do not lessen %.1e, for %s",
                          floor->integrator, level, floor_of(floor, level));
    return text_print("shorter steps take longer than was tried; --t-end "
                      "shortens the run");
}

/* Prints the reason why no error is there to choose by. */
static void print_reason(const recommendation *a) {
    const char *name = a->search.plan.name;
    const row *failed = NULL;
    bool keeps = false, late = false;
    for (size_t i = 0; i < a->count; i++) {
        const study *l = &a->study[i];
        keeps |=
            !recommend_counts(a, &a->study[i]) && l->count && l->level[0].ran;
        late |= l->end == STUDY_LIMIT;
        for (size_t k = 0; k < l->count && !failed; k++)
            if (l->level[k].failed && !l->level[k].over_limit)
                failed = &l->level[k];
    }
    if (keeps)
        tool_refuse("%s: the integrators that run keep the energy at any "
                    "step, so that its error selects no step; use "
                    "--state-error",
                    name);
    else if (failed)
        tool_refuse("%s: no integrator reaches the end: %s with the %s "
                    "gradient at dt = %g %s",
                    name, failed->integrator, failed->gradient, failed->dt,
                    failed->status);
    else if (late)
        tool_refuse("%s: all runs take longer than may be tried; --t-end "
                    "shortens them",
                    name);
    else
        tool_refuse("%s: no integrator fits; see nevh check", name);
}

int recommend_none(const recommendation *a) {
    double least;
    const study *l = most_exact(a, false, &least);
    const char *what = search_error(&a->search);
    double end = a->search.plan.t_end;
    if (!l) {
        print_reason(a);
        return TOOL_FAILED;
    }
    char *until = end < a->whole ? text_print(" until t = %g", end)
                                 : text_print("%s", "");
    tool_refuse("%s: nothing keeps the %s error below %g%s.  The least, %.1e,"
                " is that of %s with the %s gradient; %s",
                a->search.plan.name, what, a->target, until, least,
                l->integrator, l->gradient, reason(a, l, least));
    return TOOL_FAILED;
}
