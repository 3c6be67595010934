/* nevh cost --against length: the digits that schemes of equal work keep, against the
   length of the run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cost_private.h"
#include "plot/order_plot.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LENGTHS = 5, FACTOR = 4 }; /* each so much longer */
static const double useless = 0.1,
                    rounding = 1e-13; /* errors that tell no rate */

typedef struct {
    plan plan;
    row *row; /* LENGTHS of each scheme, the shortest first */
    size_t schemes;
    double end[LENGTHS];
    double
        given; /* the scene's end, where the budget or the reference shortens the
                     run; else NAN */
} lengths;

static const row *row_at(const lengths *l, size_t scheme, size_t k) {
    return &l->row[scheme * LENGTHS + k];
}

static double error_at(const lengths *l, size_t scheme, size_t k) {
    return study_error(row_at(l, scheme, k));
}

/* True if its parts solve H: its errors are of rounding, whatever the step. */
static bool is_exact(const lengths *l, size_t scheme) {
    return plan_is_exact(&l->plan, row_at(l, scheme, 0)->scheme);
}

/* The power of the length that the error grows with, by the two longest runs; NAN
   where their errors are of rounding, or as large as the motion. */
static double growth(const lengths *l, size_t scheme) {
    if (is_exact(l, scheme))
        return NAN;
    double before = error_at(l, scheme, LENGTHS - 2);
    double last = error_at(l, scheme, LENGTHS - 1);
    return fmin(before, last) > rounding && fmax(before, last) < useless
               ? log(last / before) / log(FACTOR)
               : NAN;
}

/* Runs all schemes to the end k, with a reference as long as the run: one that is longer
   has few states early on. */
static int run_to(lengths *l, const search *s, size_t k) {
    plan part = l->plan;
    bool whole = k == LENGTHS - 1;
    int status = TOOL_OK;
    part.t_end = l->end[k];
    if (!whole) {
        part.reference = NULL;
        part.no_reference = NULL;
        status = plan_reference(&part, part.t_end);
    }
    for (size_t i = 0; i < l->schemes && !status; i++) {
        row *r = &l->row[i * LENGTHS + k];
        search_progress(s, r);
        row_run(&part, r);
        if (r->ran && whole)
            rows_time(&part, &r, 1, s->repeats ? s->repeats : ROUNDS, false);
    }
    if (!whole)
        plan_forget_reference(&part);
    return status;
}

/* Runs each scheme with one step, which costs as much as verlet's. */
static int run_lengths(lengths *l, const options *o) {
    row_list first = rows_of(&l->plan);
    int status = TOOL_OK;
    l->schemes = first.count;
    l->row = tool_allocate(first.count * LENGTHS, sizeof *l->row);
    search s = search_begin(&l->plan, o, cost_budget(o));
    for (size_t i = 0; i < first.count; i++) {
        match_row(&l->plan, &first.row[i]);
        for (size_t k = 0; k < LENGTHS; k++)
            l->row[i * LENGTHS + k] = first.row[i];
    }
    for (size_t k = 0; k < LENGTHS && !status; k++)
        status = run_to(l, &s, k);
    search_end(&s);
    return status;
}

static size_t best_at(const lengths *l, size_t k) {
    size_t best = l->schemes;
    for (size_t i = 0; i < l->schemes; i++)
        if (!is_exact(l, i) &&
            (best == l->schemes || error_at(l, i, k) < error_at(l, best, k)))
            best = i;
    return best;
}

static char *digits_text(const lengths *l, size_t scheme, size_t k) {
    const row *r = row_at(l, scheme, k);
    double error = error_at(l, scheme, k);
    const char *star = best_at(l, k) == scheme ? "*" : " ";
    return !r->ran ? text_print("  %s", r->failed ? "fails" : "refused")
           : is_exact(l, scheme) ? text_print("  exact")
           : isinf(error)        ? text_print("  -")
           : error == 0          ? text_print("%s all", star)
                        : text_print("%s %.1f", star, fmax(0, -log10(error)));
}

static table *table_of(const lengths *l) {
    table *t = table_new();
    bool gradients = l->plan.gradients.count > 1;
    table_titles(t, gradients ? "integrator,gradient,dt" : "integrator,dt");
    for (size_t k = 0; k < LENGTHS; k++)
        table_column(t, text_print("  t = %.3g", l->end[k]));
    table_titles(t, "error\ngrows as,ms");
    for (size_t i = 0; i < l->schemes; i++) {
        const row *longest = row_at(l, i, LENGTHS - 1);
        table_text(t, longest->integrator);
        if (gradients)
            table_text(t, longest->gradient);
        table_shown(t, "%.4g", longest->dt);
        for (size_t k = 0; k < LENGTHS; k++)
            table_text(t, digits_text(l, i, k));
        if (isnan(growth(l, i)))
            table_text(t, "-");
        else
            table_shown(t, "t^%.1f", growth(l, i));
        if (longest->ran)
            table_shown(t, "%.3g", 1000 * longest->seconds);
        else
            table_text(t, "-");
    }
    return t;
}

static table *records_of(const lengths *l) {
    table *t = table_new();
    table_titles(
        t,
        "scene,integrator,gradient,dt,t_end,status,max_energy_error,"
        "state_error,observable_error,error_exponent,gradient_evals,seconds");
    for (size_t i = 0; i < l->schemes * LENGTHS; i++) {
        const row *r = &l->row[i];
        bool last = i % LENGTHS == LENGTHS - 1;
        table_text(t, l->plan.name);
        table_text(t, r->integrator);
        table_text(t, r->gradient);
        table_number(t, r->dt);
        table_number(t, l->end[i % LENGTHS]);
        table_text(t, r->status);
        table_number(t, r->ran ? r->energy.max : NAN);
        table_number(t, r->ran ? r->state_error : NAN);
        table_number(t, r->ran && r->observable ? r->observable_error : NAN);
        table_number(t, last ? growth(l, i / LENGTHS) : NAN);
        table_number(t, r->ran ? (double)r->counts.gradients : NAN);
        table_number(t, last && r->ran ? r->seconds : NAN);
    }
    return t;
}

/* The first of the two runs between which `to` comes to err less than `from`, as in all
   longer ones; LENGTHS: there are none, or they cross more than once. */
static size_t find_crossing(const lengths *l, size_t from, size_t to) {
    size_t at = 0;
    while (at < LENGTHS && error_at(l, from, at) < error_at(l, to, at))
        at++;
    for (size_t k = at; k < LENGTHS; k++)
        if (!(error_at(l, from, k) > error_at(l, to, k)))
            return LENGTHS;
    bool within = at > 0 && at < LENGTHS;
    return within && isfinite(error_at(l, from, at)) && error_at(l, to, at) > 0
               ? at - 1
               : LENGTHS;
}

/* Between two runs, on lines through logarithms; NAN: none. */
static double crossing_within(const lengths *l, size_t from, size_t to,
                              double *error) {
    size_t k = find_crossing(l, from, to);
    if (k == LENGTHS)
        return NAN;
    double before = error_at(l, to, k), now = error_at(l, to, k + 1);
    double a = log(error_at(l, from, k) / before);
    double b = log(error_at(l, from, k + 1) / now), share = a / (a - b);
    *error = before * pow(now / before, share);
    return l->end[k] * pow(l->end[k + 1] / l->end[k], share);
}

/* Beyond the longest run, at the rates of both; NAN: none. */
static double crossing_beyond(const lengths *l, size_t from, size_t to,
                              double *error) {
    enum { FARTHEST = 1000 }; /* lengths of the run */
    double last = error_at(l, to, LENGTHS - 1);
    double gap = log(last / error_at(l, from, LENGTHS - 1));
    double rate = growth(l, from) - growth(l, to), factor = exp(gap / rate);
    for (size_t k = 0; k < LENGTHS; k++)
        if (!(error_at(l, from, k) < error_at(l, to, k)))
            return NAN;
    *error = last * pow(factor, growth(l, to));
    return rate > 0.5 && factor < FARTHEST ? l->end[LENGTHS - 1] * factor : NAN;
}

/* The length from which `to` errs less than `from`, which errs less before that;
   NAN: none at which the orbit is still known. */
static double crossing(const lengths *l, size_t from, size_t to) {
    double error = INFINITY, t = crossing_within(l, from, to, &error);
    if (isnan(t))
        t = crossing_beyond(l, from, to, &error);
    return error < useless ? t : NAN;
}

static void crossing_word(const lengths *l, size_t from, size_t to,
                          list *words) {
    const row *a = row_at(l, from, 0), *b = row_at(l, to, 0);
    bool several = l->plan.gradients.count > 1;
    double t = crossing(l, from, to);
    if (!isfinite(t))
        return;
    char *rounded = text_print("%.2g", t);
    char *text = text_print(
        "%s errs less than %s%s%s up to t = %g%s, and more from then on",
        a->integrator, b->integrator, several ? " with " : "",
        several ? a->gradient : "", strtod(rounded, NULL),
        t > l->end[LENGTHS - 1] ? ", if both go on growing so (no run "
                                  "is as long)"
                                : "");
    if (!list_has(words, text))
        list_add(words, text);
}

/* Both of a pair have one gradient. */
static void crossing_words(const lengths *l, list *words) {
    for (size_t i = 0; i < l->schemes; i++)
        for (size_t j = 0; j < l->schemes; j++)
            if (i != j && !is_exact(l, i) && !is_exact(l, j) &&
                row_at(l, i, 0)->gradient == row_at(l, j, 0)->gradient)
                crossing_word(l, i, j, words);
}

static page page_of(const lengths *l, const options *o) {
    page result = {.table =
                       o->format == FORMAT_TABLE ? table_of(l) : records_of(l)};
    plan_notes(&l->plan, &result.before);
    if (l->given > l->plan.t_end)
        list_print(&result.before,
                   "shortened, so that the reference and all schemes can be "
                   "run; --t-end %g runs all of it",
                   l->given);
    list_print(&result.before, "digits: -log10 of the largest error of the %s",
               l->plan.observable ? "observable"
               : l->plan.by_state ? "orbit"
                                  : "energy");
    if (l->schemes < l->plan.integrators.count * l->plan.gradients.count)
        list_add(&result.before,
                 "schemes that choose their steps are left out: their work is "
                 "not matched");
    for (size_t i = 0; i < l->schemes; i++)
        if (is_exact(l, i))
            list_print(&result.before,
                       "%s: the parts solve this H exactly with any step, so "
                       "that there is no error to rank or to draw",
                       row_at(l, i, 0)->integrator);
    row_notes(o, &l->plan, l->row, l->schemes * LENGTHS, &result.before);
    state_notes(&l->plan, &result.before);
    observable_notes(&l->plan, &result.before);
    crossing_words(l, &result.after);
    return result;
}

static int print_lengths(lengths *l, const options *o) {
    output out;
    if (plot_check(o) || output_open(&out, o->file))
        return TOOL_USAGE;
    int status = run_lengths(l, o);
    if (!status && !l->schemes)
        status =
            tool_refuse("--against length needs an integrator of fixed steps: "
                        "--integrators verlet,rk4");
    size_t count = status ? 0 : l->schemes * LENGTHS;
    if (!status) {
        page result = page_of(l, o);
        page_print(&result, o, out.stream);
    }
    for (size_t i = 0; i < count; i++)
        if (l->row[i].failed && status != TOOL_FAILED)
            status = row_fails(&l->plan, &l->row[i]);
    status = output_close(&out, status);
    if (count && plot_wanted(o) &&
        order_plot(o, &l->plan, l->row, count, ORDER_LENGTH))
        status = TOOL_USAGE;
    return status;
}

/* Takes one step, a fraction of the scene's, so that digits are left at the end. */
static void choose_step(plan *p, const options *o) {
    static const double finer = 16;
    p->dts = 1;
    p->tolerances = 0; /* their work would not match */
    if (o->dt.count)
        return;
    double dt = p->dt[0] / finer;
    p->given_dt = tool_allocate(1, sizeof dt);
    p->given_dt[0] = dt;
    p->dt = p->given_dt;
}

/* Unless the end is given, one within the reach of the reference. */
static int choose_end(lengths *l, const options *o) {
    static const double within = 0.9;
    plan *p = &l->plan;
    l->given = o->t_end ? NAN : p->t_end;
    if (!o->t_end)
        plan_shorten(p, cost_budget(o));
    int status = plan_reference(p, p->t_end);
    if (!status && !o->t_end && p->by_state && p->reference &&
        p->t_end > nevh_reference_horizon(p->reference)) {
        double begin = p->run->t_start;
        p->t_end =
            begin + within * (nevh_reference_horizon(p->reference) - begin);
        plan_forget_reference(p);
        status = plan_reference(p, p->t_end);
    }
    if (!status && p->by_state)
        status = plan_require_reference(p);
    if (!status && o->observable)
        status = plan_observe(p, o->observable);
    if (!status && p->outcome)
        status =
            tool_refuse("--against length takes values along the orbit; %s "
                        "is an outcome of a whole run",
                        o->observable);
    return status;
}

int cost_lengths(const options *o) {
    lengths l = {0};
    plan *p = &l.plan;
    int status = plan_make(p, o);
    if (!status) {
        p->match_work = true;
        p->by_state = !option_given(o, "by") || o->search.by;
        choose_step(p, o);
        status = choose_end(&l, o);
        double begin = p->run->t_start, span = p->t_end - begin;
        for (int k = 0; k < LENGTHS; k++)
            l.end[k] = begin + span / pow(FACTOR, LENGTHS - 1 - k);
    }
    if (!status)
        status = print_lengths(&l, o);
    plan_free(p);
    return status;
}
