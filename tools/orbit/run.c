/* nevh run: the trajectory.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/commands.h"
#include "config.h"
#include "fit/measured.h"
#include "plot/plot.h"
#include "trajectory.h"
#include <math.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

enum { INTERVALS = 1000 }; /* at most, where nobody says how many */

typedef struct {
    const options *options;
    plan plan;
    const char *integrator;
    nevh_stepper *stepper;
    row_times rows;
    char *rows_text;
    list notes;
    measured data;               /* of no points where there is none */
    residuals_of_rows residuals; /* then their data are NULL */
    more_columns more;
    line_file lines;
    trajectory *trajectory;
    char *state, *settings; /* NULL: there is nothing to save */
    char *words;            /* said when it is interrupted */
    bool saves;             /* so far it could be saved */
} run_job;

static volatile sig_atomic_t interrupted;

static void note_signal(int number) {
    interrupted = number;
}

/* Choice of the rows. */

static void take_times(run_job *j) {
    const plan *p = &j->plan;
    numbers_sort(p->at, p->ats);
    for (size_t i = 0; i < p->ats; i++)
        if (j->rows.count == 0 || p->at[i] != p->at[j->rows.count - 1])
            p->at[j->rows.count++] = p->at[i];
    j->rows.by = BY_TIMES;
    j->rows.time = p->at;
    j->rows_text = text_print("%s", "at the times asked for");
}

static void take_samples(run_job *j, size_t count, const char *why) {
    j->rows.by = BY_SAMPLES;
    j->rows.count = count;
    j->rows_text = text_print("%zu at equal times%s", count, why);
}

static void take_every(run_job *j, size_t every) {
    j->rows.by = BY_STEPS;
    j->rows.every = every;
    j->rows_text = every == 1 ? text_print("after every step")
                              : text_print("after every %zu steps", every);
}

static int choose_rows(run_job *j) {
    const options *o = j->options;
    double span = j->plan.t_end - j->plan.run->t_start;
    if ((o->every > 0) + (o->samples > 0) + (o->at.count > 0) > 1)
        return tool_refuse("--every, --samples and --at: only one of them");
    if (o->samples == 1)
        return tool_refuse("--samples takes at least 2: the first row and the "
                           "last");
    if (o->fit.data) {
        j->rows = measured_times(&j->data);
        j->rows_text = text_print("at the times of %s", o->fit.data);
    } else if (o->at.count)
        take_times(j);
    else if (o->every)
        take_every(j, o->every);
    else if (o->samples)
        take_samples(j, o->samples, "");
    else if (span / j->plan.dt[0] <= INTERVALS)
        take_every(j, 1);
    else
        take_samples(j, INTERVALS + 1, "; see --every, --samples and --at");
    return TOOL_OK;
}

static int choose_integrator(run_job *j) {
    j->stepper = plan_first(&j->plan, &j->integrator);
    if (j->stepper && !nevh_stepper_compiles(j->stepper))
        plan_native_report(j->stepper);
    return j->stepper ? TOOL_OK : TOOL_USAGE;
}

static int check_options(const options *o) {
    bool other = option_given(o, "format") && o->format != FORMAT_CSV;
    if (o->resume && o->file)
        return tool_refuse("--resume names the file: leave -o out");
    if (o->resume && other)
        return tool_refuse("only CSV is resumed");
    if (o->fit.data && (o->resume || o->every || o->samples || o->at.count))
        return tool_refuse("--data sets the output times: leave out "
                           "--every, --samples, --at and --resume");
    return TOOL_OK;
}

/* Sets the rows to the times of --data. */
static int read_data(run_job *j) {
    const options *o = j->options;
    if (!o->fit.data)
        return TOOL_OK;
    if (measured_read(&j->data, &j->plan, o, NULL))
        return TOOL_USAGE;
    measured_bound(&j->data, &j->plan, o);
    if (!j->data.points || j->plan.t_end <= j->plan.run->t_start)
        return tool_refuse("--data %s: no point is within the run",
                           o->fit.data);
    return TOOL_OK;
}

static void fill_residuals(void *data, double t, const double q[],
                           const double p[], double values[]) {
    residuals_take(data, t, q, p, values);
}

static const more_columns *residual_columns(run_job *j) {
    const list *names = &j->data.names;
    if (!j->data.points)
        return NULL;
    residuals_begin(&j->residuals, &j->data, &j->plan);
    for (size_t k = 0; k < names->count; k++)
        list_print(&j->more.titles, "%s_residual", names->item[k]);
    j->more.fill = fill_residuals;
    j->more.data = &j->residuals;
    return &j->more;
}

static void note(run_job *j) {
    const plan *p = &j->plan;
    plan_notes(p, &j->notes);
    list_print(&j->notes, "scene: %s", p->name);
    settings_notes(j->options, &j->notes);
    plan_note_first(p, j->integrator, &j->notes);
    time_notes(p, &j->notes);
    list_print(&j->notes, "rows: %s", j->rows_text);
    if (j->data.points)
        measured_note(&j->data, &j->notes);
    if (nevh_stepper_compiles(j->stepper) ||
        nevh_stepper_native(j->stepper, NULL))
        list_add(&j->notes, "native: steps are compiled, or those of the "
                            "formulas until they are: the same digits");
}

/* All that the orbit and its rows depend on. */
static char *describe(const run_job *j) {
    const plan *p = &j->plan;
    text_file times;
    text_open(&times);
    for (size_t i = 0; j->rows.by == BY_TIMES && i < j->rows.count; i++)
        fprintf(times.file, " %.17g", j->rows.time[i]);
    return text_print(
        "nevh = %s\nscene = %016llx\nintegrator = %s\ndt = %.17g\n"
        "t_end = %.17g\ngradient = %s\ngradient step = %.17g\n"
        "tolerance = %.17g\nportable = %s\ntransform = %s\n"
        "rows = %s%s\n",
        PACKAGE_VERSION, (unsigned long long)nevh_scene_digest(p->scene),
        j->integrator, p->dt[0], p->t_end, p->gradients.item[0],
        p->gradient_step, p->tolerances ? p->tolerance[0] : 0,
        p->portable ? "yes" : "no",
        p->run->transform ? p->run->transform : "none", j->rows_text,
        text_close(&times));
}

/* Saving. */

static int save(run_job *j, bool lasting) {
    run_state *s = trajectory_state(j->trajectory);
    if (lines_flush(&j->lines))
        return TOOL_USAGE;
    if (!j->saves)
        return TOOL_OK;
    if (lasting)
        fdatasync(j->lines.file);
    s->at.bytes = j->lines.bytes;
    s->at.digest = j->lines.digest;
    j->saves = !state_save(j->state, j->settings, s, lasting);
    return TOOL_OK; /* what went wrong was said once; the run goes on */
}

static int save_often(void *data) {
    return save(data, true);
}

static void begin_saving(run_job *j, const char *name) {
    j->state = text_print("%s" STATE_ENDING, name);
    if (!j->options->quiet)
        j->words =
            text_print("nevh: interrupted; to go on: --resume %s\n", name);
    j->settings = describe(j);
    j->saves = true;
}

/* Output. */

static int open_new(run_job *j) {
    const options *o = j->options;
    if (lines_open(&j->lines, o->file))
        return TOOL_USAGE;
    for (size_t i = 0; !o->quiet && i < j->notes.count; i++)
        lines_comment(&j->lines, j->notes.item[i]);
    trajectory_header(j->trajectory);
    if (j->lines.regular)
        begin_saving(j, o->file);
    int status = j->lines.regular ? save(j, false) : TOOL_OK;
    if (o->file) /* the file stands: a signal leaves it to be resumed */
        signals_catch(note_signal, j->words);
    return status;
}

static int open_again(run_job *j) {
    const char *name = j->options->resume;
    run_state *s = trajectory_state(j->trajectory);
    begin_saving(j, name);
    signals_catch(note_signal, j->words);
    if (state_load(j->state, j->settings, s) ||
        trajectory_restore(j->trajectory) ||
        lines_reopen(&j->lines, name, s->at.bytes, s->at.digest))
        return TOOL_USAGE;
    return save(j, false);
}

/* The rest of a run that was told to end. */
static int give_up(run_job *j) {
    int number = interrupted;
    if (save(j, true))
        return TOOL_USAGE;
    if (j->words && j->saves)
        fputs(j->words, stderr);
    lines_close(&j->lines);
    signal_end(number);
    return TOOL_FAILED;
}

static int follow(run_job *j, int (*saver)(void *)) {
    bool progress = !j->options->quiet && isatty(STDERR_FILENO);
    return trajectory_follow(
        j->trajectory, &(trajectory_watch){&interrupted, saver, j, progress});
}

static int write_lines(run_job *j) {
    int status = j->options->resume ? open_again(j) : open_new(j);
    if (!status)
        status = follow(j, save_often);
    signals_catch(NULL, NULL);
    if (!status && !trajectory_finished(j->trajectory))
        return give_up(j);
    list words = {0};
    residuals_words(&j->residuals, &j->plan, &words);
    for (size_t i = 0; !j->options->quiet && i < words.count; i++)
        lines_comment(&j->lines, words.item[i]);
    if (status == TOOL_USAGE || lines_flush(&j->lines))
        return TOOL_USAGE;
    if (j->state)
        state_remove(j->state);
    return status;
}

static int write_page(run_job *j, page *result) {
    result->table = table_new();
    if (j->options->format == FORMAT_TABLE)
        table_round(result->table);
    trajectory_header(j->trajectory);
    int status = follow(j, NULL);
    if (status == TOOL_USAGE)
        return status;
    residuals_words(&j->residuals, &j->plan, &result->after);
    if (!(j->options->quiet && j->options->format == FORMAT_TABLE))
        result->before = j->notes;
    return output_page(j->options, result, status);
}

static int write_rows(run_job *j) {
    const options *o = j->options;
    page result = {0};
    bool pages = option_given(o, "format") && o->format != FORMAT_CSV;
    j->trajectory =
        trajectory_new(&j->plan, j->integrator, j->stepper, &j->rows,
                       (row_output){.lines = &j->lines,
                                    .page = pages ? &result : NULL,
                                    .more = residual_columns(j),
                                    .quiet = o->quiet});
    note(j);
    return pages ? write_page(j, &result) : write_lines(j);
}

static int run_rows(run_job *j) {
    const options *o = j->options;
    if (choose_rows(j) || choose_integrator(j) || run_plot_check(o, &j->plan))
        return TOOL_USAGE;
    bool plots = plot_wanted(o), first = plots && !o->file && !o->resume;
    int drawn = TOOL_OK, status = TOOL_OK;
    if (first)
        drawn = run_plot(o, &j->plan, j->integrator, &j->rows);
    if (!plot_replaces_rows(o))
        status = write_rows(j);
    if (plots && !first && status != TOOL_USAGE)
        drawn = run_plot(o, &j->plan, j->integrator, &j->rows);
    return drawn > status ? drawn : status;
}

static int run_scene(const options *o) {
    run_job j = {.options = o, .lines.file = -1};
    int status = check_options(o);
    if (!status)
        status = plan_make(&j.plan, o);
    if (!status)
        status = read_data(&j);
    if (!status)
        status = run_rows(&j);
    fflush(stdout);
    if (j.stepper)
        plan_native_report(j.stepper); /* of a compiler in the background */
    nevh_stepper_free(j.stepper);
    residuals_end(&j.residuals);
    plan_free(&j.plan);
    lines_close(&j.lines);
    return status;
}

const command run_command = {
    .name = "run",
    .operand = "SCENE",
    .brief = "the trajectory, as CSV or as a picture",
    .help =
        "the trajectory as CSV: t, coordinates, momenta, observables, energy",
    .examples = "run pendulum --t-end 10 --samples 11\n"
                "run kepler --t-end 20 --plot kepler.svg",
    .options =
        "SCENE STEPS NATIVE TABLE PLOT tolerance every samples at resume data transform plot-kind columns",
    .draws = &(RUN_PLOTS(PLOT_WORD))[1],
    .columns = "t",
    .run = run_scene,
};
