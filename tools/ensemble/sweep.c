/* nevh sweep: a row for each member of an ensemble.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "members.h"
#include "sweep_private.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static bool is_array(const options *o) {
    const char *name = o->resume ? o->resume : o->file;
    size_t length = name ? strlen(name) : 0;
    return length > 4 && strcmp(name + length - 4, ".npy") == 0;
}

/* Running members. */

static int make_sweep(sweep_job *j) {
    plan *p = &j->plan;
    const options *o = j->options;
    const char *why;
    if (!plan_fits(p, &j->integrator))
        return TOOL_USAGE;
    j->threads = o->threads ? o->threads : ranks_threads(&j->ranks);
    nevh_sweep_options is = {.gradient =
                                 nevh_gradient_named(p->gradients.item[0]),
                             .gradient_step = o->gradient_step,
                             .dt = o->dt.count ? p->dt[0] : 0,
                             .t_end = o->t_end ? p->t_end : 0,
                             .portable = p->portable,
                             .width = o->width,
                             .threads = j->threads,
                             .ordered = !is_array(o),
                             .native = p->native,
                             .native_cache = p->no_cache ? "" : NULL};
    is.integrator = plan_scheme(p, j->integrator, &is.transformed);
    is.transformed = plan_transform(p, j->integrator) != NULL;
    is.substeps = nevh_substeps_named(j->integrator);
    if (nevh_integrator_adaptive(is.integrator) && p->tolerances)
        is.tolerance = p->tolerance[0];
    j->sweep = nevh_sweep_new(p->scene, &is);
    tool_owned(j->sweep);
    if (nevh_sweep_status(j->sweep))
        return tool_refuse("%s: %s", p->name, nevh_sweep_message(j->sweep));
    if (!nevh_sweep_native(j->sweep, &why))
        plan_why_report(why);
    return TOOL_OK;
}

/* Lines. */

static void note(sweep_job *j) {
    const plan *p = &j->plan;
    plan_notes(p, &j->notes);
    list_print(&j->notes, "scene: %s", p->name);
    settings_notes(j->options, &j->notes);
    const char *where;
    if (nevh_sweep_native(j->sweep, &where))
        list_print(&j->notes, "native: steps are compiled%s%s",
                   *where ? " " : "", where);
    for (size_t i = 0; i < j->options->vary.count; i++)
        list_print(&j->notes, "vary: %s", j->options->vary.item[i]);
    plan_note_first(p, j->integrator, &j->notes);
    list_print(&j->notes, "members: %llu",
               (unsigned long long)nevh_sweep_members(j->sweep));
    for (size_t k = 0; k < nevh_sweep_columns(j->sweep); k++)
        list_add(&j->columns, nevh_sweep_column(j->sweep, k));
    j->count = nevh_sweep_members(j->sweep);
}

/* A field of CSV, in quotes where it must be. */
static void print_field(FILE *f, const char *text) {
    if (!strpbrk(text, ",\"")) {
        fputs(text, f);
        return;
    }
    fputc('"', f);
    for (; *text; text++)
        fprintf(f, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', f);
}

static void print_head(sweep_job *j) {
    FILE *f = j->out.stream;
    for (size_t i = 0; !j->options->quiet && i < j->notes.count; i++)
        fprintf(f, "# %s\n", j->notes.item[i]);
    fputs(sweep_command.columns, f);
    for (size_t k = 0; k < nevh_sweep_columns(j->sweep); k++) {
        fputc(',', f);
        print_field(f, nevh_sweep_column(j->sweep, k));
    }
    fputc('\n', f);
}

static const char *status_word(nevh_member_status status) {
    return status == NEVH_MEMBER_DONE     ? "ok"
           : status == NEVH_MEMBER_FAILED ? "failed"
                                          : "no start";
}

static void show_progress(sweep_job *j) {
    double now = wall_seconds();
    uint64_t all = j->count;
    if (j->options->quiet || !isatty(STDERR_FILENO) || now < j->shown + 1)
        return;
    j->shown = now;
    double rate = (double)j->told / (now - j->begun);
    fprintf(stderr,
            "\r\033[K%llu of %llu members, %llu not done, %.3g/s, %.0f s left",
            (unsigned long long)j->told, (unsigned long long)all,
            (unsigned long long)(j->failed + j->startless), rate,
            (double)(all - j->told) / rate);
}

void sweep_check_values(sweep_job *j, const double values[]) {
    for (size_t k = 0; k < nevh_sweep_columns(j->sweep); k++) {
        if (isfinite(values[k]) || !nevh_sweep_is_of_values(j->sweep, k))
            continue;
        j->outcome = j->outcome ? j->outcome : nevh_sweep_column(j->sweep, k);
        j->undefined++;
        return;
    }
}

void sweep_count(sweep_job *j, const nevh_sweep_result *r) {
    j->told++;
    j->failed += r->status == NEVH_MEMBER_FAILED;
    j->startless += r->status == NEVH_MEMBER_NO_START;
    if (r->status != NEVH_MEMBER_DONE && !j->why) {
        j->why = text_print("%s", r->message);
        j->first = r->member;
        j->fails = r->status == NEVH_MEMBER_FAILED;
    }
    show_progress(j);
}

void sweep_begin(sweep_job *j) {
    j->begun = j->shown = wall_seconds();
}

int sweep_end(const sweep_job *j, int status) {
    if (j->shown > j->begun)
        fputs("\r\033[K", stderr);
    return status && status != NEVH_STOPPED
               ? tool_refuse("%s", nevh_sweep_message(j->sweep))
               : TOOL_OK;
}

static int run_all(sweep_job *j, nevh_sweep_fn done) {
    sweep_begin(j);
    return sweep_end(j,
                     nevh_sweep_run(j->sweep, 0, nevh_sweep_members(j->sweep),
                                    NULL, done, j));
}

static int take_row(void *data, const nevh_sweep_result *r) {
    sweep_job *j = data;
    sweep_count(j, r);
    if (r->status == NEVH_MEMBER_DONE)
        sweep_check_values(j, r->values);
    map_take(j->map, r->member, r->status, r->values);
    return 0;
}

static int print_row(void *data, const nevh_sweep_result *r) {
    sweep_job *j = data;
    FILE *f = j->out.stream;
    char text[NUMBER_SIZE];
    fprintf(f, "%llu,%s", (unsigned long long)r->member,
            status_word(r->status));
    for (size_t k = 0; k < nevh_sweep_columns(j->sweep); k++)
        if (!isfinite(r->values[k]))
            fputc(',', f);
        else if (nevh_sweep_is_verdict(j->sweep, k))
            fprintf(f, ",%s", nevh_verdict_name((nevh_verdict)r->values[k]));
        else
            fprintf(f, ",%s", number_text(text, r->values[k]));
    fputc('\n', f);
    take_row(j, r);
    return ferror(f);
}

void sweep_tell_undefined(const sweep_job *j) {
    if (j->undefined)
        tool_refuse("%s: %llu of %llu members have no value of an outcome; the "
                    "first, %s, is undefined at some time",
                    j->plan.name, (unsigned long long)j->undefined,
                    (unsigned long long)j->count, j->outcome);
}

/* Members that are not done are told of, never dropped. */
static int report_failures(const sweep_job *j) {
    char *known = j->fails ? member_why(&j->plan, j->first, j->why)
                           : text_print("%s", j->why ? j->why : "");
    char *why =
        text_print("member %llu: %s", (unsigned long long)j->first, known);
    if (j->failed)
        tool_refuse("%s: %llu of %llu members failed; the first, %s",
                    j->plan.name, (unsigned long long)j->failed,
                    (unsigned long long)nevh_sweep_members(j->sweep), why);
    if (j->startless)
        tool_refuse("%s: %llu of %llu members have no start; %s%s",
                    j->plan.name, (unsigned long long)j->startless,
                    (unsigned long long)nevh_sweep_members(j->sweep),
                    j->failed ? "the first that is not done, " : "the first, ",
                    why);
    sweep_tell_undefined(j);
    return j->failed || j->startless ? TOOL_FAILED : TOOL_OK;
}

/* A picture alone. */
static int draw(sweep_job *j) {
    if (run_all(j, take_row) || map_draw(j->map, j->integrator))
        return TOOL_USAGE;
    if (!j->options->quiet)
        printf("%s: %" PRIu64 " members; -o FILE writes them\n",
               j->options->picture, j->count);
    return report_failures(j);
}

static int run(sweep_job *j) {
    if (j->map && !j->options->file)
        return draw(j);
    if (output_open(&j->out, j->options->file))
        return TOOL_USAGE;
    print_head(j);
    int status = run_all(j, print_row);
    status = output_close(&j->out, status ? status : report_failures(j));
    return status != TOOL_USAGE && map_draw(j->map, j->integrator) ? TOOL_USAGE
                                                                   : status;
}

/* Checks options that depend on each other. */
static int check_options(const options *o) {
    bool resumes = o->resume, parts = o->tasks, file = o->file;
    bool in_pieces = resumes || o->join || parts || o->stop_after > 0;
    const struct {
        bool clash;
        const char *words;
    } rules[] = {
        {option_given(o, "format") && o->format != FORMAT_CSV,
         "nevh sweep writes CSV, or with -o FILE.npy an array of NumPy"},
        {o->plot.script && !o->picture,
         "--keep-plot-script is of --picture: give both"},
        {resumes && file, "--resume names the file: leave -o out"},
        {resumes && parts,
         "--resume names the file of the part: leave --task out"},
        {o->join && (parts || !file), "--join makes -o FILE.npy of its parts: "
                                      "leave --task and --resume out"},
        {o->retry && !resumes,
         "--retry repeats failed members: give --resume FILE.npy"},
        {in_pieces && !is_array(o), "--resume, --stop-after, --task and --join "
                                    "take a FILE.npy: CSV is written in one "
                                    "go"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (rules[i].clash)
            return tool_refuse("%s", rules[i].words);
    return TOOL_OK;
}

/* Outcomes, as they are written. */
static void print_outcomes(FILE *f) {
    static const char *const argument[] = {"", "(F)", "(A > B)", "[(SECTION)]"};
    fputs("\nOutcomes:\n", f);
    for (size_t k = 0; nevh_outcomes()[k]; k++) {
        const nevh_outcome_info *o = nevh_outcomes()[k];
        int used = fprintf(f, "  %s%s", o->name, argument[o->takes]);
        help_print(f, used, 28, o->help);
    }
}

static int sweep(const options *o) {
    sweep_job j = {.options = o};
    int status = check_options(o);
    if (status)
        return status;
    status = ranks_begin(&j.ranks, o, is_array(o));
    if (!status) {
        status = plan_make(&j.plan, o);
        if (!status)
            status = members_check(&j.plan, o);
        if (!status)
            status = make_sweep(&j);
        status = ranks_agree(&j.ranks, status);
    }
    if (!status)
        status = map_new(&j.map, o, &j.plan, j.sweep);
    if (!status) {
        note(&j);
        status = is_array(o) ? sweep_array(&j) : run(&j);
    }
    nevh_sweep_free(j.sweep);
    plan_free(&j.plan);
    ranks_end(&j.ranks);
    return status;
}

const command sweep_command = {
    .name = "sweep",
    .operand = "SCENE",
    .brief = "many orbits, a row of outcomes for each",
    .help =
        "many orbits: a row for each member of the ensemble, with outcomes, as CSV or an array of NumPy (-o FILE.npy)",
    .examples =
        "sweep pendulum --t-end 50 --vary 'phi = range(0.1, 3, 20)' --outcomes period,energy_error\n"
        "sweep double-pendulum --t-end 20 --vary 'phi1 = range(-3, 3, 20)' --vary 'phi2 = range(-3, 3, 20)' --outcomes 'first(abs(phi2) > pi)' --picture flips.svg",
    .options =
        "SCENE STEPS NATIVE TABLE tolerance picture resume vary data outcomes retry stop-after task join threads width transform keep-plot-script",
    .columns = "member,status",
    .more = print_outcomes,
    .run = sweep,
};
