/* nevh sweep: a row for each member of an ensemble.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "experiment/plan.h"
#include "orbit/trajectory.h"
#include <math.h>
#include <nevh/sweep.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef struct {
    const options *options;
    plan plan;
    const char *integrator;
    nevh_sweep *sweep;
    list notes;
    output out;
    uint64_t failed, startless, told;
    char *why; /* of the first that is not done */
    double begun, shown;
} job;

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static size_t processors(void) {
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (size_t)count : 1;
}

/* How members are run. */

static int make_sweep(job *j) {
    const plan *p = &j->plan;
    const options *o = j->options;
    nevh_stepper *first = plan_first(p, &j->integrator);
    if (!first)
        return TOOL_USAGE;
    nevh_stepper_free(first);
    nevh_sweep_options is = {.gradient =
                                 nevh_gradient_named(p->gradients.item[0]),
                             .gradient_step = o->gradient_step,
                             .dt = o->dt.count ? p->dt[0] : 0,
                             .t_end = o->t_end ? p->t_end : 0,
                             .portable = p->portable,
                             .width = o->width,
                             .threads = o->threads ? o->threads : processors(),
                             .ordered = true};
    is.integrator = plan_scheme(j->integrator, &is.transformed);
    is.transformed = plan_transform(p, j->integrator) != NULL;
    if (nevh_integrator_adaptive(is.integrator) && p->tolerances)
        is.tolerance = p->tolerance[0];
    j->sweep = nevh_sweep_new(p->scene, &is);
    tool_owned(j->sweep);
    return nevh_sweep_status(j->sweep)
               ? tool_refuse("%s: %s", p->name, nevh_sweep_message(j->sweep))
               : TOOL_OK;
}

/* Lines. */

static void note(job *j) {
    const plan *p = &j->plan;
    plan_notes(p, &j->notes);
    list_print(&j->notes, "scene: %s", p->name);
    settings_notes(j->options, &j->notes);
    for (size_t i = 0; i < j->options->vary.count; i++)
        list_print(&j->notes, "vary: %s", j->options->vary.item[i]);
    plan_note_first(p, j->integrator, &j->notes);
    list_print(&j->notes, "members: %llu",
               (unsigned long long)nevh_sweep_members(j->sweep));
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

static void print_head(job *j) {
    FILE *f = j->out.stream;
    for (size_t i = 0; !j->options->quiet && i < j->notes.count; i++)
        fprintf(f, "# %s\n", j->notes.item[i]);
    fputs("member,status", f);
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

static void show_progress(job *j) {
    double now = seconds();
    uint64_t members = nevh_sweep_members(j->sweep);
    if (j->options->quiet || !isatty(STDERR_FILENO) || now < j->shown + 1)
        return;
    j->shown = now;
    double rate = (double)j->told / (now - j->begun);
    fprintf(stderr,
            "\r\033[K%llu of %llu members, %llu not done, %.3g/s, %.0f s left",
            (unsigned long long)j->told, (unsigned long long)members,
            (unsigned long long)(j->failed + j->startless), rate,
            (double)(members - j->told) / rate);
}

static int print_row(void *data, const nevh_sweep_result *r) {
    job *j = data;
    FILE *f = j->out.stream;
    fprintf(f, "%llu,%s", (unsigned long long)r->member,
            status_word(r->status));
    for (size_t k = 0; k < nevh_sweep_columns(j->sweep); k++)
        if (!isfinite(r->values[k]))
            fputc(',', f);
        else if (nevh_sweep_is_verdict(j->sweep, k))
            fprintf(f, ",%s", nevh_verdict_name((nevh_verdict)r->values[k]));
        else
            fprintf(f, ",%.17g", r->values[k]);
    fputc('\n', f);
    j->told++;
    j->failed += r->status == NEVH_MEMBER_FAILED;
    j->startless += r->status == NEVH_MEMBER_NO_START;
    if (r->status != NEVH_MEMBER_DONE && !j->why)
        j->why = text_print("member %llu: %s", (unsigned long long)r->member,
                            r->message);
    show_progress(j);
    return ferror(f);
}

/* Members that are not done are told of, never dropped. */
static int tell_failures(const job *j) {
    if (j->failed)
        tool_refuse("%s: %llu of %llu members failed; the first, %s",
                    j->plan.name, (unsigned long long)j->failed,
                    (unsigned long long)nevh_sweep_members(j->sweep), j->why);
    if (j->startless)
        tool_refuse("%s: %llu of %llu members have no start; %s%s",
                    j->plan.name, (unsigned long long)j->startless,
                    (unsigned long long)nevh_sweep_members(j->sweep),
                    j->failed ? "the first that is not done, " : "the first, ",
                    j->why);
    return j->failed || j->startless ? TOOL_FAILED : TOOL_OK;
}

static int run(job *j) {
    if (output_open(&j->out, j->options->file))
        return TOOL_USAGE;
    print_head(j);
    j->begun = j->shown = seconds();
    int status = nevh_sweep_run(j->sweep, 0, nevh_sweep_members(j->sweep), NULL,
                                print_row, j);
    if (j->shown > j->begun)
        fputs("\r\033[K", stderr);
    if (status && status != NEVH_STOPPED)
        return output_close(&j->out,
                            tool_refuse("%s", nevh_sweep_message(j->sweep)));
    return output_close(&j->out, tell_failures(j));
}

static int check_format(const options *o) {
    if (o->formatted && o->format != FORMAT_CSV)
        return tool_refuse("nevh sweep writes CSV");
    return TOOL_OK;
}

int sweep(const options *o) {
    job j = {.options = o};
    int status = check_format(o);
    if (status)
        return status;
    status = plan_make(&j.plan, o);
    if (!status)
        status = make_sweep(&j);
    if (!status) {
        note(&j);
        status = run(&j);
    }
    nevh_sweep_free(j.sweep);
    list_free(&j.notes);
    free(j.why);
    plan_free(&j.plan);
    return status;
}
