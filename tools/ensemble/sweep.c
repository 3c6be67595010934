/* nevh sweep: a row for each member of an ensemble.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "experiment/plan.h"
#include "ranks.h"
#include "map.h"
#include "store.h"
#include <ctype.h>
#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

typedef struct {
    const options *options;
    plan plan;
    const char *integrator;
    nevh_sweep *sweep;
    map *map; /* NULL: no picture */
    list notes, columns;
    output out;
    store store; /* of an array */
    ranks ranks;
    size_t threads;
    uint64_t first, count, failed, startless, told;
    char *why; /* of the first that is not done */
    double begun, shown;
} job;

/* What a signal stops; members under way are finished.  The second one ends the
   program. */
static nevh_sweep *volatile under_way;

static void note_signal(int number) {
    (void)number;
    if (under_way)
        nevh_sweep_stop(under_way);
}

static void mind_signals(double seconds) {
    static const int numbers[] = {SIGHUP, SIGINT, SIGTERM, SIGALRM};
    struct sigaction mind = {.sa_handler = note_signal,
                             .sa_flags = (int)SA_RESETHAND};
    struct sigaction found;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (sigaction(numbers[i], NULL, &found) == 0 &&
            found.sa_handler != SIG_IGN)
            sigaction(numbers[i], &mind, NULL);
    double whole = floor(fmin(seconds, 1e9));
    struct itimerval timer = {
        .it_value = {(time_t)whole, (suseconds_t)(1e6 * (seconds - whole))}};
    if (seconds > 0)
        setitimer(ITIMER_REAL, &timer, NULL);
}

static bool is_array(const options *o) {
    const char *name = o->resume ? o->resume : o->file;
    size_t length = name ? strlen(name) : 0;
    return length > 4 && strcmp(name + length - 4, ".npy") == 0;
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* How members are run. */

static int make_sweep(job *j) {
    plan *p = &j->plan;
    const options *o = j->options;
    nevh_native_use native = p->native;
    const char *why;
    p->native = NEVH_NATIVE_NEVER; /* that one takes no steps */
    nevh_stepper *first = plan_first(p, &j->integrator);
    p->native = native;
    if (!first)
        return TOOL_USAGE;
    nevh_stepper_free(first);
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
    is.integrator = plan_scheme(j->integrator, &is.transformed);
    is.transformed = plan_transform(p, j->integrator) != NULL;
    if (nevh_integrator_adaptive(is.integrator) && p->tolerances)
        is.tolerance = p->tolerance[0];
    j->sweep = nevh_sweep_new(p->scene, &is);
    tool_owned(j->sweep);
    if (!nevh_sweep_native(j->sweep, &why))
        plan_tell_why(why);
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
    if (nevh_sweep_native(j->sweep, NULL))
        list_add(&j->notes, "native: steps are compiled");
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
    uint64_t members = j->count;
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

static void count(job *j, const nevh_sweep_result *r) {
    j->told++;
    j->failed += r->status == NEVH_MEMBER_FAILED;
    j->startless += r->status == NEVH_MEMBER_NO_START;
    if (r->status != NEVH_MEMBER_DONE && !j->why)
        j->why = text_print("member %llu: %s", (unsigned long long)r->member,
                            r->message);
    show_progress(j);
}

static int take_row(void *data, const nevh_sweep_result *r) {
    job *j = data;
    count(j, r);
    map_take(j->map, r->member, r->status, r->values);
    return 0;
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
    take_row(j, r);
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

/* A picture alone. */
static int draw(job *j) {
    j->begun = j->shown = seconds();
    int status = nevh_sweep_run(j->sweep, 0, nevh_sweep_members(j->sweep), NULL,
                                take_row, j);
    if (j->shown > j->begun)
        fputs("\r\033[K", stderr);
    if (status && status != NEVH_STOPPED)
        return tool_refuse("%s", nevh_sweep_message(j->sweep));
    if (map_draw(j->map, j->integrator))
        return TOOL_USAGE;
    if (!j->options->quiet)
        printf("%s: %" PRIu64 " members; -o FILE writes them\n",
               j->options->picture, j->count);
    return tell_failures(j);
}

static int run(job *j) {
    if (j->map && !j->options->file)
        return draw(j);
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
    status = output_close(&j->out, tell_failures(j));
    return status != TOOL_USAGE && map_draw(j->map, j->integrator) ? TOOL_USAGE
                                                                   : status;
}

/* An array of records. */

/* All that a record depends on. */
static char *describe(const job *j) {
    const plan *p = &j->plan;
    const options *o = j->options;
    char *columns = list_joined(&j->columns);
    char *all = text_print(
        "nevh: %s\nscene: %016llx\nmembers: %llu\ncolumns: %s\n"
        "integrator: %s\ndt: %.17g\nt_end: %.17g\ngradient: %s\n"
        "gradient_step: %.17g\ntolerance: %.17g\nportable: %s\n",
        PACKAGE_VERSION, (unsigned long long)nevh_scene_digest(p->scene),
        (unsigned long long)nevh_sweep_members(j->sweep), columns,
        j->integrator, o->dt.count ? p->dt[0] : 0, o->t_end ? p->t_end : 0,
        p->gradients.item[0], o->gradient_step,
        p->tolerances ? p->tolerance[0] : 0, p->portable ? "yes" : "no");
    free(columns);
    return all;
}

/* For who reads the side file. */
static char *tell_story(const job *j) {
    char *all = text_print("%s", "");
    for (size_t i = 0; i < j->notes.count; i++) {
        char *longer = text_print("%s# %s\n", all, j->notes.item[i]);
        free(all);
        all = longer;
    }
    char *scene = nevh_scene_write(j->plan.scene, NULL);
    char *whole =
        text_print("%s# status: 0 not yet run, 1 done, 2 failed, 3 no "
                   "start\n\n[scene as run]\n%s",
                   all, scene ? scene : "");
    free(scene);
    free(all);
    return whole;
}

static bool is_wanted(void *data, uint64_t member) {
    const job *j = data;
    nevh_member_status status = store_status(&j->store, member);
    return status == NEVH_MEMBER_MISSING ||
           (j->options->retry && status == NEVH_MEMBER_FAILED);
}

static int keep(void *data, const nevh_sweep_result *r) {
    job *j = data;
    if (store_write(&j->store, r))
        return 1;
    count(j, r);
    return 0;
}

/* What the file has, of all times that it was gone on with. */
static int tell_array(const job *j) {
    uint64_t have[4] = {0};
    const store *s = &j->store;
    for (uint64_t i = 0; i < s->count; i++)
        have[store_status(s, s->first + i) & 3]++;
    if (have[NEVH_MEMBER_FAILED] || have[NEVH_MEMBER_NO_START])
        tool_refuse("%s: of %" PRIu64 " members %" PRIu64 " failed and %" PRIu64
                    " have no start: see %s",
                    s->name, s->count, have[NEVH_MEMBER_FAILED],
                    have[NEVH_MEMBER_NO_START], s->side);
    if (have[NEVH_MEMBER_MISSING]) {
        tool_refuse("%s: stopped before %" PRIu64 " of %" PRIu64
                    " members: go on with --resume %s",
                    s->name, have[NEVH_MEMBER_MISSING], s->count, s->name);
        return TOOL_STOPPED;
    }
    return have[NEVH_MEMBER_FAILED] || have[NEVH_MEMBER_NO_START] ? TOOL_FAILED
                                                                  : TOOL_OK;
}

static int run_array(job *j) {
    under_way = j->sweep;
    mind_signals(j->options->stop_after);
    j->begun = j->shown = seconds();
    bool shared = j->ranks.count > 1;
    int status = shared ? nevh_sweep_run_chunks(j->sweep, ranks_take, &j->ranks,
                                                is_wanted, keep, j)
                        : nevh_sweep_run(j->sweep, j->store.first,
                                         j->store.count, is_wanted, keep, j);
    under_way = NULL;
    if (j->shown > j->begun)
        fputs("\r\033[K", stderr);
    status = status && status != NEVH_STOPPED
                 ? tool_refuse("%s", nevh_sweep_message(j->sweep))
                 : TOOL_OK;
    if (shared)
        status = ranks_close(&j->ranks, status);
    j->store.write = NULL;
    if (!status && !j->ranks.rank)
        status = store_finish(&j->store) ? TOOL_USAGE : tell_array(j);
    return ranks_agree(&j->ranks, status);
}

/* The first member of a part. */
static uint64_t begin_of(const job *j, uint64_t task, uint64_t tasks) {
    uint64_t members = nevh_sweep_members(j->sweep);
    return members / tasks * (task - 1) + members % tasks * (task - 1) / tasks;
}

static void take_part(const job *j, uint64_t task, uint64_t tasks,
                      uint64_t *first, uint64_t *members) {
    *first = begin_of(j, task, tasks);
    *members = begin_of(j, task + 1, tasks) - *first;
}

/* N of FILE.1-of-N.npy; 0 with a message where there is none, or several. */
static uint64_t find_parts(const char *file) {
    const char *slash = strrchr(file, '/');
    char *folder = slash ? text_print("%.*s", (int)(slash - file) + 1, file)
                         : text_print("./");
    const char *last = slash ? slash + 1 : file;
    char *before = text_print("%.*s.1-of-", (int)strlen(last) - 4, last);
    uint64_t found = 0, number;
    DIR *all = opendir(folder);
    int end, several = 0;
    for (struct dirent *one; all && (one = readdir(all));) {
        const char *tail = one->d_name + strlen(before);
        if (strncmp(one->d_name, before, strlen(before)) == 0 &&
            sscanf(tail, "%" SCNu64 ".npy%n", &number, &end) == 1 &&
            !tail[end] && isdigit((unsigned char)*tail)) {
            several += found != 0;
            found = number;
        }
    }
    if (all)
        closedir(all);
    if (several)
        tool_refuse("%s%s...: there are parts of several sweeps: remove those "
                    "of all but one",
                    folder, before);
    else if (!found)
        tool_refuse("there is nothing to join: no %s%sN.npy", folder, before);
    free(folder);
    free(before);
    return several ? 0 : found;
}

static int join(job *j) {
    const char *file = j->options->file;
    uint64_t parts = find_parts(file);
    if (!parts)
        return TOOL_USAGE;
    if (parts > j->count)
        return tool_refuse("%s: %" PRIu64 " parts of %" PRIu64 " members", file,
                           parts, j->count);
    int status = store_create(&j->store, file);
    bool created = !status;
    for (uint64_t i = 1; !status && i <= parts; i++) {
        uint64_t first, members;
        char *name = store_name(file, i, parts);
        take_part(j, i, parts, &first, &members);
        status = store_take(&j->store, name, first, members);
        free(name);
    }
    if (!status)
        status = store_finish(&j->store);
    if (!status)
        return tell_array(j);
    if (created) {
        unlink(j->store.name);
        unlink(j->store.side);
    }
    return status;
}

/* As far as members were run. */
static int draw_array(job *j, int status) {
    const store *s = &j->store;
    double *values = tool_allocate(j->columns.count, sizeof *values);
    for (uint64_t i = 0; i < s->count; i++) {
        memcpy(values, s->map + s->header + i * s->record + 8,
               j->columns.count * sizeof *values);
        if (store_status(s, s->first + i) != NEVH_MEMBER_MISSING)
            map_take(j->map, s->first + i, store_status(s, s->first + i),
                     values);
    }
    free(values);
    return map_draw(j->map, j->integrator) ? TOOL_USAGE : status;
}

static int fill_array(job *j) {
    const options *o = j->options;
    char *settings = describe(j), *story = tell_story(j), *name = NULL;
    j->store = (store){.file = -1,
                       .columns = &j->columns,
                       .settings = settings,
                       .story = story,
                       .count = j->count};
    int status = TOOL_OK;
    if (o->tasks)
        take_part(j, o->task, o->tasks, &j->store.first, &j->store.count);
    if (o->resume)
        status = ranks_agree(&j->ranks, store_range(o->resume, &j->store.first,
                                                    &j->store.count));
    j->count = o->join ? j->count : j->store.count;
    if (!status && o->join) {
        status = join(j);
    } else if (!status) {
        name = store_name(o->resume ? o->resume : o->file, o->task, o->tasks);
        status = ranks_open(&j->ranks, &j->store, name, o->resume, j->threads);
        if (!status)
            status = run_array(j);
    }
    if (j->map && !j->ranks.rank && status != TOOL_USAGE)
        status = draw_array(j, status);
    store_close(&j->store);
    free(name);
    free(settings);
    free(story);
    return status;
}

/* What belongs together. */
static int check_options(const options *o) {
    if (o->formatted && o->format != FORMAT_CSV)
        return tool_refuse(
            "nevh sweep writes CSV, or with -o FILE.npy an array "
            "of NumPy");
    if (o->plot.script && !o->picture)
        return tool_refuse("--keep-plot-script is of --picture: give both");
    if (o->resume && o->file)
        return tool_refuse("--resume names the file: leave -o out");
    if (o->resume && o->tasks)
        return tool_refuse("--resume names the file of the part: leave --task "
                           "out");
    if (o->join && (o->tasks || !o->file))
        return tool_refuse(
            "--join makes -o FILE.npy of its parts: leave --task "
            "and --resume out");
    if (o->retry && !o->resume)
        return tool_refuse("--retry is of members that failed before: give "
                           "--resume FILE.npy");
    if ((o->resume || o->join || o->tasks || o->stop_after > 0) && !is_array(o))
        return tool_refuse("--resume, --stop-after, --task and --join take a "
                           "FILE.npy: CSV is written in one go");
    return TOOL_OK;
}

int sweep(const options *o) {
    job j = {.options = o};
    int status = check_options(o);
    if (status)
        return status;
    status = ranks_begin(&j.ranks, o, is_array(o));
    if (!status) {
        status = plan_make(&j.plan, o);
        if (!status)
            status = make_sweep(&j);
        status = ranks_agree(&j.ranks, status);
    }
    if (!status)
        status = map_new(&j.map, o, &j.plan, j.sweep);
    if (!status) {
        note(&j);
        status = is_array(o) ? fill_array(&j) : run(&j);
    }
    map_free(j.map);
    nevh_sweep_free(j.sweep);
    list_free(&j.notes);
    list_free(&j.columns);
    free(j.why);
    plan_free(&j.plan);
    ranks_end(&j.ranks);
    return status;
}
