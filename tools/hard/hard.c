/* nevh hard: the rows of nevh compare on cases that are hard to integrate.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "experiment/row.h"
#include "hard_cases.h"
#include <math.h>
#include <string.h>
#include <unistd.h>

/* Seconds of work, as nevh_counts_seconds estimates them: the same on every
   machine. */
static const double most_work = 0.2, most_follow = 0.02;

/* The result of a row: a nevh_verdict, or one of these. */
enum {
    HARD_STOPPED = NEVH_UNDECIDED + 1,
    HARD_REFUSED,
    HARD_FAILED,
    HARD_KINDS
};

typedef struct {
    table *table;
    bool each; /* row, not each kind */
    size_t cases, rows, count[HARD_KINDS];
} suite;

static int kind_of(const row *r) {
    return r->ran          ? (int)r->energy.verdict
           : r->over_limit ? HARD_STOPPED
           : r->failed     ? HARD_FAILED
                           : HARD_REFUSED;
}

static const char *kind_name(int kind) {
    static const char *const others[] = {"stopped", "refused", "failed"};
    return kind < HARD_STOPPED ? nevh_verdict_name((nevh_verdict)kind)
                               : others[kind - HARD_STOPPED];
}

/* The command that repeats a case, from its options. */
static char *command_of(const options *o) {
    char *text = text_print("%s %s", o->operands.item[0], o->operands.item[1]);
    for (size_t i = 0; i < o->settings.count; i++)
        text_extend(&text, " --set %s", o->settings.item[i] + 1);
    if (o->dt.count)
        text_extend(&text, " --dt %s", o->dt.item[0]);
    if (o->t_end)
        text_extend(&text, " --t-end %s", o->t_end);
    return text;
}

static char *happened(const row *r) {
    if (!r->ran && !r->over_limit)
        return text_print("%s", r->status);
    if (r->over_limit)
        return text_print("energy error %.1e; stopped after %zu steps",
                          r->energy.max, r->steps);
    if (r->energy.verdict == NEVH_UNSTABLE)
        return text_print("energy error %.1e; %s", r->energy.max, r->status);
    return isnan(r->state_error)
               ? text_print("energy error %.1e", r->energy.max)
               : text_print("energy error %.1e, state error %.1e",
                            r->energy.max, r->state_error);
}

static void add_record(table *t, const plan *p, const hard_case *c,
                       const char *repeat, const row *r) {
    bool measured = r->ran || r->over_limit;
    table_text(t, c->name);
    table_text(t, repeat);
    table_text(t, r->integrator);
    table_text(t, r->gradient);
    table_number(t, r->dt);
    table_number(t, p->t_end);
    table_number(t, measured ? (double)r->steps : NAN);
    table_number(t, measured ? r->energy.max : NAN);
    table_number(t, r->ran ? r->state_error : NAN);
    table_text(t, r->status);
    table_text(t, kind_name(kind_of(r)));
}

/* The rows of one kind: how many, their errors, and what happened to the one
   whose error is largest. */
static void add_kind(table *t, const plan *p, const hard_case *c,
                     const row_list *all, int kind) {
    double least = INFINITY, most = 0;
    const row *worst = NULL;
    size_t count = 0;
    for (size_t i = 0; i < all->count; i++) {
        const row *r = &all->row[i];
        if (kind_of(r) != kind)
            continue;
        if (!worst || r->energy.max > most)
            worst = r;
        count++;
        least = fmin(least, r->energy.max);
        most = fmax(most, r->energy.max);
    }
    if (!count)
        return;
    bool numbers = kind != HARD_REFUSED && kind != HARD_FAILED;
    char *what = happened(worst);
    table_text(t, c->name);
    table_shown(t, "%.4g", p->dt[0]);
    table_shown(t, "%.6g", p->t_end);
    table_text(t, kind_name(kind));
    table_shown(t, "%zu", count);
    table_shown(t, numbers ? "%.1e" : "", least);
    table_shown(t, numbers ? "%.1e" : "", most);
    table_text(
        t, text_print("%s, %s: %s", worst->integrator, worst->gradient, what));
}

static void add_rows(suite *all, const plan *p, const hard_case *c,
                     const char *repeat, const row_list *rows) {
    table_group(all->table);
    for (size_t i = 0; all->each && i < rows->count; i++)
        add_record(all->table, p, c, repeat, &rows->row[i]);
    for (int kind = 0; !all->each && kind < HARD_KINDS; kind++)
        add_kind(all->table, p, c, rows, kind);
    for (size_t i = 0; i < rows->count; i++)
        all->count[kind_of(&rows->row[i])]++;
    all->rows += rows->count;
    all->cases++;
}

/* The options that nevh compare would be given. */
static options options_of(const options *o, const hard_case *c) {
    options own = *o;
    list settings = {0};
    own.operands = own.settings = own.dt = (list){0};
    list_add(&own.operands, "compare");
    list_add(&own.operands, c->scene);
    if (c->settings)
        list_split_at(&settings, c->settings, ';');
    for (size_t i = 0; i < settings.count; i++)
        list_print(&own.settings, "=%s", settings.item[i]);
    if (c->dt)
        list_add(&own.dt, c->dt);
    own.t_end = c->t_end;
    return own;
}

static int run_case(suite *all, const options *o, const hard_case *c) {
    plan p;
    options own = options_of(o, c);
    int status = plan_make(&p, &own);
    p.dts = p.tolerances = 1;
    p.native = NEVH_NATIVE_NEVER;
    p.screening = true; /* rows are finished here, and not timed */
    p.work_limit = most_work;
    p.follow = most_follow;
    if (!status)
        status = plan_reference(&p, p.t_end);
    if (!status) {
        row_list rows = rows_of(&p);
        for (size_t i = 0; i < rows.count; i++) {
            row_run(&p, &rows.row[i]);
            if (rows.row[i].ran)
                row_finish(&p, &rows.row[i]);
        }
        add_rows(all, &p, c, command_of(&own), &rows);
    }
    plan_free(&p);
    return status;
}

static bool is_wanted(const options *o, const char *name) {
    for (size_t i = 1; i < o->operands.count; i++)
        if (strcmp(o->operands.item[i], name) == 0)
            return true;
    return o->operands.count == 1;
}

static int check_names(const options *o, size_t *cases) {
    list names = {0};
    int status = TOOL_OK;
    for (const hard_case *c = hard_cases; c->name; c++) {
        list_add(&names, c->name);
        *cases += is_wanted(o, c->name);
    }
    for (size_t i = 1; !status && i < o->operands.count; i++)
        if (!list_has(&names, o->operands.item[i]))
            status = tool_unknown("case", o->operands.item[i], &names);
    return status;
}

/* Every scheme with differences of two orders and exact gradients. */
static options with_defaults(const options *o) {
    options own = *o;
    for (size_t i = 0; !o->integrators.count && nevh_integrators()[i]; i++)
        list_add(&own.integrators, nevh_integrator_name(nevh_integrators()[i]));
    if (!o->gradients.count)
        list_split(&own.gradients, "central2,central6,exact");
    return own;
}

/* Runs take 0.06 s on average on the machines that this was measured on. */
static void announce(const options *o, size_t cases) {
    size_t runs = cases * o->integrators.count * o->gradients.count;
    double minutes = (double)runs * 0.06 / 60;
    if (!o->quiet && minutes > 0.3)
        fprintf(stderr, "nevh: %zu runs, about %.0f minute%s\n", runs,
                ceil(minutes), ceil(minutes) > 1 ? "s" : "");
}

static void progress(const options *o, const suite *all, size_t cases,
                     const char *name) {
    if (o->quiet || !isatty(STDERR_FILENO))
        return;
    fputs("\r\033[K", stderr);
    if (name)
        fprintf(stderr, "%zu of %zu: %s", all->cases + 1, cases, name);
    fflush(stderr);
}

static int run_cases(suite *all, const options *o, size_t cases) {
    int status = TOOL_OK;
    for (const hard_case *c = hard_cases; !status && c->name; c++) {
        if (!is_wanted(o, c->name))
            continue;
        progress(o, all, cases, c->name);
        status = run_case(all, o, c);
    }
    progress(o, all, cases, NULL);
    return status;
}

static int print_suite(const suite *all, const options *o) {
    page result = {.table = all->table};
    list counts = {0};
    for (int kind = 0; kind < HARD_KINDS; kind++)
        if (all->count[kind])
            list_print(&counts, "%zu %s", all->count[kind], kind_name(kind));
    list_print(o->format == FORMAT_CSV ? &result.before : &result.after,
               "%zu cases, %zu rows: %s.", all->cases, all->rows,
               list_sentence(&counts, "and"));
    return output_page(o, &result, TOOL_OK);
}

static int hard(const options *o) {
    suite all = {.table = table_new()};
    options own = with_defaults(o);
    size_t cases = 0;
    int status = check_names(o, &cases);
    all.each = o->all || o->format != FORMAT_TABLE;
    table_titles(all.table, all.each ? hard_command.columns
                                     : "case,dt,t_end,energy,rows,error\nfrom,"
                                       "\nto,the worst of them");
    if (!all.each)
        table_below(all.table);
    if (!status) {
        announce(&own, cases);
        status = run_cases(&all, &own, cases);
    }
    if (!status)
        status = print_suite(&all, o);
    return status;
}

const command hard_command = {
    .name = "hard",
    .operand = "",
    .brief = "every integrator on hard cases",
    .help = "the rows of nevh compare on cases that are hard to integrate",
    .examples = "hard --integrators verlet\n"
                "hard 'Kepler e = 0.9' --all",
    .options = "TABLE integrators gradient all",
    .columns = "case,repeat,integrator,gradient,dt,t_end,steps,"
               "max_energy_error,state_error,status,verdict",
    .run = hard,
};
