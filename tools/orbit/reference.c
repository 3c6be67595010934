/* nevh reference: states to digits that are certain.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/plan.h"
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

enum { MOST_DIGITS = 30 };
static const size_t usual_digits = 24;
static const double usual_seconds = 600;

typedef struct {
    const plan *plan;
    nevh_certain *orbit;
    size_t digits, fewest; /* asked for; had */
    double lost;           /* the first time with fewer; NAN */
    size_t left;           /* the fewest then */
    double t, part;        /* where the orbit is; what to go at once */
    double end;
    double budget, begun, shown; /* in seconds of processor time */
    bool progress;               /* to be shown on stderr */
    bool folded;                 /* numbers of formulas are doubles */
} job;

static char *name_of(const plan *p, size_t k) {
    return text_print("%s%s", k < p->n ? "" : "p_",
                      nevh_scene_coordinate(p->scene, k % p->n));
}

static void put_text(table *t, char *text) {
    table_text(t, text);
    free(text);
}

static void put_state(job *j, double t, table *rows) {
    char text[NUMBER_SIZE];
    for (size_t k = 0; k < 2 * j->plan->n; k++) {
        size_t digits = (size_t)nevh_certain_digits(j->orbit, k);
        double error = nevh_certain_error(j->orbit, k);
        bool still = nevh_certain_value(j->orbit, k) == 0 && error < 1e-30;
        table_text(rows, number_text(text, t));
        put_text(rows, name_of(j->plan, k));
        if (digits || still)
            put_text(rows, tool_owned(nevh_certain_text(j->orbit, k)));
        else
            table_text(rows, NULL);
        table_shown(rows, "%zu", digits);
        table_shown(rows, "%.0e", error);
        if (digits >= j->digits || still ||
            error <
                nevh_certain_size(j->orbit, k) * pow(10, -(double)j->digits))
            continue;
        j->fewest = digits < j->fewest ? digits : j->fewest;
        if (isnan(j->lost))
            j->lost = t;
        if (j->lost == t)
            j->left = j->fewest;
    }
}

/* The way that is left is taken to cost what the way behind did. */
static double seconds_left(const job *j) {
    double start = j->plan->run->t_start;
    return (cpu_seconds() - j->begun) * (j->end - j->t) / (j->t - start);
}

static void show_progress(job *j) {
    double now = cpu_seconds();
    if (!j->progress || now < j->shown + 1)
        return;
    j->shown = now;
    fprintf(stderr, "\r\033[Kt = %.4g of %.4g, %zu series, %.2g s left", j->t,
            j->end, nevh_certain_series(j->orbit), seconds_left(j));
}

static void clear_progress(const job *j) {
    fputs(j->progress ? "\r\033[K" : "", stderr);
}

/* Before a hundredth of the budget is spent nothing is foreseen. */
static int check_budget(const job *j) {
    double start = j->plan->run->t_start, spent = cpu_seconds() - j->begun;
    double whole = spent + seconds_left(j);
    if (spent < j->budget / 100 || whole <= j->budget)
        return TOOL_OK;
    clear_progress(j);
    tool_refuse("%s: t = %.9g takes about %.2g s of processor time, more than "
                "the %g s of --stop-after, which reach t = %.2g",
                j->plan->name, j->end, whole, j->budget,
                start + (j->t - start) * j->budget / spent);
    return TOOL_FAILED;
}

/* In parts of a tenth of a second or so; the orbit does not depend on them. */
static int go(job *j, double t) {
    while (j->t < t) {
        double before = cpu_seconds(), next = fmin(j->t + j->part, t);
        next = next > j->t ? next : nextafter(j->t, t);
        if (nevh_certain_go(j->orbit, next)) {
            clear_progress(j);
            tool_refuse("the orbit has no reference at t = %.9g: %s", t,
                        nevh_certain_message(j->orbit));
            return TOOL_FAILED;
        }
        j->t = next;
        j->part *= cpu_seconds() - before < 0.1 ? 2 : 0.5;
        show_progress(j);
        int status = check_budget(j);
        if (status)
            return status;
    }
    return TOOL_OK;
}

static int put_states(job *j, table *rows) {
    const plan *p = j->plan;
    const double *times = p->ats ? p->at : &p->t_end;
    size_t count = p->ats ? p->ats : 1;
    for (size_t i = 0; i < count; i++) {
        int status = go(j, times[i]);
        if (status)
            return status;
        if (i)
            table_group(rows);
        put_state(j, times[i], rows);
    }
    return TOOL_OK;
}

static void put_notes(const job *j, page *result) {
    const plan *p = j->plan;
    plan_notes(p, &result->before);
    list_print(&result->before,
               "Taylor series of more than double precision; certain is what "
               "runs of two orders and two tolerances have in common (%zu "
               "series)",
               nevh_certain_series(j->orbit));
    list_print(&result->before,
               "parameters, starts and times are the doubles nearest to what "
               "the scene says, taken exactly%s",
               j->folded
                   ? "; so are numbers that follow from parameters, since "
                     "the formulas are too long with these written out"
                   : "");
    if (nevh_scene_stops(p->scene))
        list_add(&result->before, "the stop of [run] is left aside");
    if (j->fewest == j->digits)
        return;
    list_print(&result->after,
               "From t = %.9g on not all digits asked for are certain, but "
               "%zu or more: the orbit makes differences in the last digits "
               "grow.",
               j->lost, j->fewest);
    if (!j->left)
        list_print(&result->after,
                   "At t = %.9g no digit is left: earlier times (--at) show "
                   "how long digits last.",
                   j->lost);
    if (j->digits < (j->left ? MOST_DIGITS : usual_digits))
        list_print(&result->after,
                   "--digits %d carries more of them, as far as 113 bits do.",
                   MOST_DIGITS);
}

static int reference_of(const options *o, const plan *p) {
    static const char *const columns[] = {"t", "variable", "value", "digits",
                                          "error"};
    double start = p->run->t_start, now = cpu_seconds();
    job j = {.plan = p,
             .digits = o->digits ? o->digits : usual_digits,
             .lost = NAN,
             .t = start,
             .end = p->ats ? p->at[p->ats - 1] : p->t_end,
             .budget = o->stop_after > 0 ? o->stop_after : usual_seconds,
             .begun = now,
             .shown = now,
             .progress = !o->quiet && isatty(STDERR_FILENO)};
    j.fewest = j.digits;
    j.part = 0x1p-60 * fmin(j.end - start, 1e18);
    const nevh_system *exact = nevh_scene_exact_system(p->scene);
    j.folded = !exact;
    if (!exact && nevh_scene_status(p->scene) == NEVH_ENOMEM)
        tool_owned(NULL); /* ends */
    j.orbit = tool_owned(nevh_certain_new(
        exact ? exact : p->system, p->run->t_start, p->q, p->p, (int)j.digits));
    page result = {.table = table_new()};
    int status = TOOL_OK;
    if (nevh_certain_status(j.orbit))
        status = tool_refuse("there is no reference: %s",
                             nevh_certain_message(j.orbit));
    table_columns(result.table, columns, sizeof columns / sizeof *columns);
    if (!status)
        status = put_states(&j, result.table);
    if (!status) {
        clear_progress(&j);
        put_notes(&j, &result);
        status = output_page(o, &result, status);
    }
    nevh_certain_free(j.orbit);
    page_free(&result);
    return status;
}

int reference_command(const options *o) {
    plan p = {0};
    options untimed = *o;
    untimed.no_steps = true;
    int status = plan_make(&p, &untimed);
    if (!status && o->file)
        status = output_check(o->file);
    if (!status)
        numbers_sort(p.at, p.ats);
    if (!status)
        status = reference_of(o, &p);
    plan_free(&p);
    return status;
}
