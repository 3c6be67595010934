/* nevh compare: a table of energy errors, a row an integrator and dt.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "verdict_private.h"
#include "cli/commands.h"
#include "experiment/envelope.h"
#include "experiment/trial_run.h"
#include "orbit/warnings.h"
#include "plot/order_plot.h"
#include <math.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Shows progress on a terminal, for work of more than a second. */
static void progress(const row_list *r, size_t i, double seconds, bool last) {
    if (seconds < 1 || !isatty(STDERR_FILENO))
        return;
    if (last)
        fputs("\r\033[K", stderr);
    else
        fprintf(stderr, "\r\033[K%zu of %zu: %s, dt = %g", i + 1, r->count,
                r->row[i].integrator, r->row[i].dt);
    fflush(stderr);
}

static void time_rows(const plan *p, row_list *r) {
    row **ran = tool_allocate(r->count, sizeof *ran);
    size_t count = 0;
    for (size_t i = 0; i < r->count; i++)
        if (r->row[i].ran)
            ran[count++] = &r->row[i];
    rows_time(p, ran, count, p->repeats ? p->repeats : ROUNDS, p->repeats > 0);
}

static void settle_rows(const plan *p, row_list *r) {
    row **all = tool_allocate(r->count, sizeof *all);
    for (size_t i = 0; i < r->count; i++)
        all[i] = &r->row[i];
    rows_choose_native(p, all, r->count, false);
}

static void run_rows(const plan *p, row_list *r, bool quiet) {
    time_t start = time(NULL);
    settle_rows(p, r);
    for (size_t i = 0; i < r->count; i++) {
        if (!quiet)
            progress(r, i, difftime(time(NULL), start), false);
        row_run(p, &r->row[i]);
    }
    time_rows(p, r);
    if (!quiet)
        progress(r, r->count, difftime(time(NULL), start), true);
}

/* The latest end of all rows, up to which a reference is needed. */
static double last_end(const plan *p, const row_list *r) {
    double last = p->run->t_start + p->dt[0];
    if (!nevh_scene_stops(p->scene))
        return p->t_end;
    for (size_t i = 0; i < r->count && last < p->t_end; i++)
        last = fmax(last, row_end(p, &r->row[i]));
    return fmin(last, p->t_end);
}

static void show_count(table *t, double count) {
    if (count < 1e4)
        table_shown(t, "%.0f", count);
    else if (count < 1e7)
        table_shown(t, "%.0fk", count / 1e3);
    else
        table_shown(t, "%.0fM", count / 1e6);
}

static void show_numbers(table *t, const plan *p, const row *r) {
    table_shown(t, "%.1e", r->energy.max);
    if (r->energy.verdict == NEVH_DRIFTS || r->energy.verdict == NEVH_UNSTABLE)
        table_shown(t, "%+.1e", verdict_drift(p, r));
    else
        table_shown(t, "-");
    state_show(t, p, r);
    if (p->observable)
        observable_show(t, p, r);
    if (p->dts > 1 && isfinite(r->observed_order))
        table_shown(t, "%.1f", r->observed_order);
    else if (p->dts > 1)
        table_text(t, NULL);
    show_count(t, r->counts.hamiltonians);
    table_shown(t, "%.3g", 1000 * r->seconds);
    table_text(t, nevh_verdict_name(r->energy.verdict));
    diagnostics_show(t, p, r);
    energies_put(t, p, r, true);
}

/* Rows of one scheme that chooses its steps differ in the tolerance. */
static void show_name(table *t, const row *r) {
    char *name = r->tolerance > 0
                     ? text_print("%s %.0e", r->integrator, r->tolerance)
                     : text_print("%s", r->integrator);
    table_text(t, name);
}

static void show_row(table *t, const plan *p, const row *r) {
    show_name(t, r);
    table_shown(t, "%d", r->order);
    table_text(t, nevh_claim_name(nevh_integrator_symplectic(r->scheme)));
    if (p->gradients.count > 1)
        table_text(t, r->gradient);
    table_shown(t, "%.4g", r->dt);
    if (r->ran) {
        show_numbers(t, p, r);
        return;
    }
    for (int i = 0; i < 5 + (p->observable != NULL) + (p->dts > 1); i++)
        table_text(t, NULL);
    table_text(t, r->failed ? "failed" : "refused");
    diagnostics_show(t, p, r);
    energies_put(t, p, r, true);
}

static table *shown(const plan *p, const row_list *r) {
    table *t = table_new();
    char *dt = text_print("dt%s", p->per_unit);
    table_column(t, "integrator");
    table_key(t);
    table_titles(t, "order,sympl.");
    if (p->gradients.count > 1) {
        table_column(t, "gradient");
        table_key(t);
    }
    table_column(t, dt);
    table_key(t);
    table_titles(t, "max\nenergy\nerror,drift\nover\nthe run,"
                    "state\nerror");
    if (p->observable)
        table_column(t, "observable\nerror");
    if (p->dts > 1)
        table_column(t, "order\nseen");
    table_titles(t, "H\nevals,ms,energy");
    if (p->diagnostics)
        table_break(t);
    diagnostics_columns(t, p, true);
    energies_columns(t, p, true);
    for (size_t i = 0; i < r->count; i++) {
        if (i && r->row[i].group != r->row[i - 1].group)
            table_group(t);
        show_row(t, p, &r->row[i]);
    }
    return t;
}

/* Messages of rows without numbers, each once. */
static void list_reasons(const row_list *r, list *words) {
    for (size_t i = 0; i < r->count; i++) {
        bool known = r->row[i].ran;
        for (size_t k = 0; !known && k < i; k++)
            known = r->row[k].integrator == r->row[i].integrator &&
                    strcmp(r->row[k].status, r->row[i].status) == 0;
        if (!known)
            list_print(words, "%s %s", r->row[i].integrator, r->row[i].status);
    }
}

/* True if a row failed, became unstable or lost its energy, as all do after the end of
   the solution. */
static bool any_trouble(const row_list *r) {
    for (size_t i = 0; i < r->count; i++)
        if (r->row[i].failed || needs_shorter_step(&r->row[i]) ||
            (r->row[i].ran && r->row[i].energy.verdict == NEVH_UNSTABLE))
            return true;
    return false;
}

/* A step that keeps the energy to the end of a run whose solution may end before is
   no advice. */
static void advise(const plan *p, const row_list *r, list *words) {
    if (isnan(p->ends)) {
        suggested_step_words(p, r->row, r->count, words);
        return;
    }
    list_print(words,
               "The orbit is not known so far as to say whether the solution "
               "ends before t = %.4g%s, as where it is chaotic: no step that "
               "keeps its energy until then is looked for.",
               p->t_end, p->unit);
}

/* Verdicts on runs past the end of their solution are none. */
static void judge(const plan *p, const row_list *r, bool is_table,
                  list *words) {
    char *ends = ends_text(p, p->ends);
    if (!ends)
        verdict_words(p, r->row, r->count, words);
    else
        list_print(words, "No verdicts: %s.", ends);
    energies_words(p, r->row, r->count, words);
    if (is_table)
        shadow_words(p, r->row, r->count, words);
    if (is_table && !ends)
        stability_words(p, r->row, r->count, words);
    if (is_table && !ends)
        advise(p, r, words);
    time_words(p, r->row, r->count, words);
    passed_words(p, r->row, r->count, words);
}

static page make_page(const options *o, const plan *p, const row_list *r) {
    page result = {0};
    bool is_table = o->format == FORMAT_TABLE;
    result.table = is_table ? shown(p, r) : records(p, r->row, r->count);
    if (is_table && o->quiet)
        return result;
    plan_notes(p, &result.before);
    row_notes(o, p, r->row, r->count, &result.before);
    time_notes(p, &result.before);
    state_notes(p, &result.before);
    observable_notes(p, &result.before);
    energies_notes(p, &result.before);
    judge(p, r, is_table, &result.after);
    if (!isfinite(p->ends)) /* words below a table are no part of CSV */
        warnings_words(p, NULL, r->row, r->count,
                       is_table ? &result.after : &result.before);
    if (is_table)
        list_reasons(r, &result.after);
    return result;
}

static int draw_rows(const options *o, const plan *p, const row_list *r) {
    return o->plot.kind == PLOT_KIND_order
               ? order_plot(o, p, r->row, r->count, ORDER_DT)
               : compare_plot(o, p, r->row, r->count);
}

/* Runs past the end of the solution have no verdict. */
static void look_for_end(plan *p, row_list *r) {
    bool open = !p->reference || isfinite(nevh_reference_horizon(p->reference));
    if (isnan(p->ends) && open && any_trouble(r))
        p->ends = plan_ends(p);
    for (size_t i = 0; isfinite(p->ends) && i < r->count; i++)
        r->row[i].energy.verdict = NEVH_UNDECIDED;
}

static int compare_rows(const options *o, plan *p, row_list *r) {
    output out;
    int status = TOOL_OK;
    if (order_plot_check(o, p->dts) || plot_check(o) ||
        output_open(&out, o->file))
        return TOOL_USAGE;
    for (size_t i = 0; plot_wanted(o) && i < r->count; i++)
        r->row[i].errors = envelope_new(p->run->t_start, p->t_end);
    run_rows(p, r, o->quiet);
    observe_orders(r->row, r->count);
    look_for_end(p, r);
    page result = make_page(o, p, r);
    bool first = plot_goes_first(o);
    int drawn = first ? draw_rows(o, p, r) : TOOL_OK;
    page_print(&result, o, out.stream);
    for (size_t i = 0; i < r->count; i++)
        if (r->row[i].failed)
            status = row_fails(p, &r->row[i]);
    status = output_close(&out, status);
    if (plot_wanted(o) && !first)
        drawn = draw_rows(o, p, r);
    return drawn > status ? drawn : status;
}

static int compare_plan(const options *o, plan *p) {
    row_list r = rows_of(p);
    for (size_t i = 0; i < r.count; i++)
        match_row(p, &r.row[i]);
    int status = plan_reference(p, last_end(p, &r));
    if (!status && o->observable)
        status = plan_observe(p, o->observable);
    if (!status && p->diagnostics && p->reference)
        plan_energies(p);
    if (!status)
        status = compare_rows(o, p, &r);
    return status;
}

static int compare(const options *o) {
    plan p;
    int status = plan_make(&p, o);
    if (!status) {
        order_plot_steps(o, &p);
        status = compare_plan(o, &p);
    }
    plan_free(&p);
    return status;
}

const command compare_command = {
    .name = "compare",
    .operand = "SCENE",
    .brief = "energy error, orbit error and cost of each integrator",
    .help =
        "one row for each integrator and dt: energy error, orbit error, cost; then a verdict",
    .examples =
        "compare pendulum\n"
        "compare double-pendulum --integrators verlet,gauss4,rk4 --dt 0.01 --t-end 20 --plot energy.svg",
    .options =
        "SCENE STEPS NATIVE TABLE PLOT tolerance observable repeat transform match diagnostics plot-kind",
    .draws = "order",
    .columns = RECORD_COLUMNS,
    .run = compare,
};
