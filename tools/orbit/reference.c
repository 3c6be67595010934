/* nevh reference: states to digits that are certain.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "experiment/plan.h"
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/time.h>
#include <unistd.h>

enum { MOST_DIGITS = 30 };
static const size_t usual_digits = 24;
static const double usual_seconds = 600;

/* time + rest, of which few are doubles. */
typedef struct {
    double time;
    long double rest;
} moment;

typedef struct {
    const plan *plan;
    nevh_certain *orbit;
    size_t digits, fewest; /* asked for; had */
    double lost;           /* the first time with fewer; NAN */
    size_t left;           /* the fewest then */
    double t, part;        /* where the orbit is; what to go at once */
    long double rest;      /* it is at t + rest */
    double end;
    moment *moments; /* times that are asked for, in order */
    size_t count;
    double budget, begun, shown; /* in seconds of processor time */
    bool progress;               /* to be shown on stderr */
} reference_job;

static char *name_of(const plan *p, size_t k) {
    return text_print("%s%s", k < p->n ? "" : "p_",
                      nevh_scene_coordinate(p->scene, k % p->n));
}

/* As many digits as tell the time from others. */
static char *time_text(moment at) {
    char text[NUMBER_SIZE];
    return at.rest == 0
               ? text_print("%s", number_text(text, at.time))
               : text_adopt(tool_owned(nevh_certain_number(at.time, at.rest)));
}

static void put_state(reference_job *j, moment at, table *rows) {
    double t = at.time;
    for (size_t k = 0; k < 2 * j->plan->n; k++) {
        size_t digits = (size_t)nevh_certain_digits(j->orbit, k);
        double error = nevh_certain_error(j->orbit, k);
        bool still = nevh_certain_value(j->orbit, k) == 0 && error < 1e-30;
        table_text(rows, time_text(at));
        table_text(rows, name_of(j->plan, k));
        if (digits || still)
            table_text(rows,
                       text_adopt(tool_owned(nevh_certain_text(j->orbit, k))));
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
static double seconds_left(const reference_job *j) {
    double start = j->plan->run->t_start;
    return (cpu_seconds() - j->begun) * (j->end - j->t) / (j->t - start);
}

static void show_progress(reference_job *j) {
    double now = cpu_seconds();
    if (!j->progress || now < j->shown + 1)
        return;
    j->shown = now;
    fprintf(stderr, "\r\033[Kt = %.4g of %.4g, %zu series, %.2g s left", j->t,
            j->end, nevh_certain_series(j->orbit), seconds_left(j));
}

static void clear_progress(const reference_job *j) {
    fputs(j->progress ? "\r\033[K" : "", stderr);
}

/* Before a hundredth of the budget is spent nothing is foreseen. */
static int check_budget(const reference_job *j) {
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

static volatile sig_atomic_t over; /* the budget is */

static void note_end(int number) {
    (void)number;
    over = 1;
}

/* Series may get ever shorter: then no part of the way ends. */
static void stop_after(nevh_certain *orbit, double seconds) {
    signal_catch(SIGPROF, note_end);
    timer_start(ITIMER_PROF, seconds);
    nevh_certain_stop_at(orbit, &over);
}

static int refuse(const reference_job *j, double t) {
    clear_progress(j);
    if (over)
        tool_refuse("%s: t = %.9g takes more than the %g s of --stop-after, "
                    "%s",
                    j->plan->name, t, j->budget,
                    nevh_certain_message(j->orbit));
    else
        tool_refuse("the orbit has no reference at t = %.9g: %s", t,
                    nevh_certain_message(j->orbit));
    return TOOL_FAILED;
}

/* In parts of a tenth of a second or so; the orbit does not depend on them. */
static int go(reference_job *j, moment at) {
    bool there = j->t > at.time || (j->t == at.time && j->rest >= at.rest);
    while (!there) {
        double before = cpu_seconds(), next = fmin(j->t + j->part, at.time);
        if (next <= j->t && j->t < at.time)
            next = nextafter(j->t, at.time);
        there = next == at.time;
        if (nevh_certain_go_to(j->orbit, next, there ? at.rest : 0))
            return refuse(j, at.time);
        j->t = next;
        j->rest = there ? at.rest : 0;
        j->part *= cpu_seconds() - before < 0.1 ? 2 : 0.5;
        show_progress(j);
        int status = check_budget(j);
        if (status)
            return status;
    }
    return TOOL_OK;
}

static int put_states(reference_job *j, table *rows) {
    for (size_t i = 0; i < j->count; i++) {
        int status = go(j, j->moments[i]);
        if (status)
            return status;
        if (i)
            table_group(rows);
        put_state(j, j->moments[i], rows);
    }
    return TOOL_OK;
}

static void put_notes(const reference_job *j, page *result) {
    const plan *p = j->plan;
    plan_notes(p, &result->before);
    list_print(
        &result->before,
        "Taylor series of more than double precision; certain are the "
        "digits common to two runs of different order and tolerance (%zu "
        "series)",
        nevh_certain_series(j->orbit));
    list_add(&result->before,
             "numbers that are written, as 0.1, are the doubles nearest to "
             "them, taken exactly; what is computed of them, and pi, has 113 "
             "bits");
    if (nevh_scene_stops(p->scene))
        list_add(&result->before, "the stop of [run] is left aside");
    if (j->fewest == j->digits)
        return;
    list_print(&result->after,
               "From t = %.9g on at least %zu digits are certain, not all "
               "that were asked for: the orbit, or a difference of nearly "
               "equal numbers in the scene, amplifies what rounding leaves, "
               "or numbers below 1e-308 have lost theirs.",
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

static int compare_moments(const void *a, const void *b) {
    const moment *x = a, *y = b;
    if (x->time != y->time)
        return x->time < y->time ? -1 : 1;
    return (x->rest > y->rest) - (x->rest < y->rest);
}

static int take_moment(const options *o, nevh_scene *scene, const char *formula,
                       moment *at) {
    return nevh_scene_exact_number(scene, formula, &at->time, &at->rest)
               ? scene_report(scene, o)
               : TOOL_OK;
}

static int take_moments(const options *o, reference_job *j) {
    const plan *p = j->plan;
    j->count = p->ats ? p->ats : 1;
    j->moments = tool_allocate(j->count, sizeof *j->moments);
    int status =
        p->ats ? TOOL_OK : take_moment(o, p->scene, o->t_end, &j->moments[0]);
    for (size_t i = 0; !status && i < p->ats; i++)
        status = take_moment(o, p->scene, o->at.item[i], &j->moments[i]);
    qsort(j->moments, j->count, sizeof *j->moments, compare_moments);
    return status;
}

static int start_orbit(const options *o, reference_job *j) {
    nevh_scene *scene = j->plan->scene;
    j->orbit = nevh_scene_certain(scene, (int)j->digits);
    if (!j->orbit && nevh_scene_status(scene) == NEVH_ENOMEM)
        tool_owned(NULL); /* ends */
    if (!j->orbit)
        return scene_report(scene, o);
    return nevh_certain_status(j->orbit)
               ? tool_refuse("there is no reference: %s",
                             nevh_certain_message(j->orbit))
               : TOOL_OK;
}

static int reference_of(const options *o, const plan *p) {
    double start = p->run->t_start, now = cpu_seconds();
    reference_job j = {.plan = p,
                       .digits = o->digits ? o->digits : usual_digits,
                       .lost = NAN,
                       .t = start,
                       .budget =
                           o->stop_after > 0 ? o->stop_after : usual_seconds,
                       .begun = now,
                       .shown = now,
                       .progress = !o->quiet && isatty(STDERR_FILENO)};
    j.fewest = j.digits;
    page result = {.table = table_new()};
    int status = take_moments(o, &j);
    j.end = j.moments[j.count - 1].time;
    j.part = 0x1p-60 * fmin(j.end - start, 1e18);
    if (!status)
        status = start_orbit(o, &j);
    table_titles(result.table, reference_command.columns);
    if (!status)
        stop_after(j.orbit, j.budget);
    if (!status)
        status = put_states(&j, result.table);
    timer_start(ITIMER_PROF, 0);
    if (!status) {
        clear_progress(&j);
        put_notes(&j, &result);
        status = output_page(o, &result, status);
    }
    nevh_certain_free(j.orbit);
    return status;
}

static int reference(const options *o) {
    plan p = {0};
    options untimed = *o;
    untimed.no_steps = true;
    int status = plan_make(&p, &untimed);
    if (!status && o->file)
        status = output_check(o->file);
    if (!status)
        status = reference_of(o, &p);
    plan_free(&p);
    return status;
}

const command reference_command = {
    .name = "reference",
    .operand = "SCENE",
    .brief = "the state to digits that are certain",
    .help = "the state at the end, or at given times, with certain digits",
    .examples = "reference pendulum --at 1,10\n"
                "reference henon-heiles --t-end 20 --digits 20",
    .options = "SCENE TABLE at digits stop-after",
    .columns = "t,variable,value,digits,error",
    .run = reference,
};
