/* nevh sweep: an array of NumPy is filled, in one go, in parts or by several
   processes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "config.h"
#include "sweep_private.h"
#include <ctype.h>
#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

/* The sweep that a signal stops, and the signal; members under way are left. */
static nevh_sweep *volatile under_way;
static volatile sig_atomic_t interrupted;

static void note_time(int number) {
    (void)number;
    if (under_way)
        nevh_sweep_stop(under_way);
}

static void note_signal(int number) {
    interrupted = number;
    note_time(number);
}

/* Unless the seconds are 0. */
static void stop_after(double seconds) {
    signal_catch(SIGALRM, note_time);
    timer_start(ITIMER_REAL, seconds);
}

/* All that a record depends on. */
static char *describe(const sweep_job *j) {
    const plan *p = &j->plan;
    const options *o = j->options;
    char *columns = list_joined(&j->columns);
    return text_print(
        "nevh: %s\nscene: %016llx\nmembers: %llu\ncolumns: %s\n"
        "integrator: %s\ndt: %.17g\nt_end: %.17g\ngradient: %s\n"
        "gradient_step: %.17g\ntolerance: %.17g\nportable: %s\n",
        PACKAGE_VERSION, (unsigned long long)nevh_scene_digest(p->scene),
        (unsigned long long)nevh_sweep_members(j->sweep), columns,
        j->integrator, o->dt.count ? p->dt[0] : 0, o->t_end ? p->t_end : 0,
        p->gradients.item[0], o->gradient_step,
        p->tolerances ? p->tolerance[0] : 0, p->portable ? "yes" : "no");
}

/* For who reads the side file. */
static char *describe_file(const sweep_job *j) {
    char *all = text_print("%s", "");
    for (size_t i = 0; i < j->notes.count; i++)
        text_extend(&all, "# %s\n", j->notes.item[i]);
    char *scene = text_adopt(tool_owned(nevh_scene_write(j->plan.scene, NULL)));
    text_extend(&all,
                "# status: 0 not yet run, 1 done, 2 failed, 3 no start\n\n"
                "[scene as run]\n%s",
                scene);
    return all;
}

static bool is_wanted(void *data, uint64_t member) {
    sweep_job *j = data;
    nevh_member_status status = store_read(&j->store, member, NULL);
    return status == NEVH_MEMBER_MISSING ||
           (j->options->retry && status == NEVH_MEMBER_FAILED);
}

static int keep(void *data, const nevh_sweep_result *r) {
    sweep_job *j = data;
    if (store_write(&j->store, r))
        return 1;
    sweep_count(j, r);
    return 0;
}

/* Finds how many members of the file have each status.
   look  whether values that are undefined are counted */
static void count_members(sweep_job *j, bool look, uint64_t have[4]) {
    store *s = &j->store;
    double *values = tool_allocate(s->columns->count, sizeof *values);
    uint64_t looked = 0;
    for (uint64_t i = store_next(s, 0); i < s->count;
         i = store_next(s, i + 1), looked++) {
        nevh_member_status status = store_read(s, s->first + i, values);
        have[status]++;
        if (look && status == NEVH_MEMBER_DONE)
            sweep_check_values(j, values);
    }
    have[NEVH_MEMBER_MISSING] += s->count - looked;
}

/* A member is not saved before its end: calls that are shorter than one repeat the
   same steps for ever. */
static int report_no_progress(const sweep_job *j, uint64_t missing) {
    bool alone = j->options->width == 1;
    tool_refuse("%s: none of the %" PRIu64
                " members that are left ended in the %g s of --stop-after, and "
                "--resume begins them anew: give more time%s",
                j->store.name, missing, j->options->stop_after,
                alone ? "" : ", or --width 1, which runs one after the other");
    return TOOL_FAILED;
}

/* Reports the counts of the file, those of earlier runs included.
   missing  how many members there were to run */
static int report_array(sweep_job *j, uint64_t missing) {
    uint64_t have[4] = {0};
    store *s = &j->store;
    count_members(j, true, have);
    sweep_tell_undefined(j);
    if (j->options->stop_after > 0 && !interrupted &&
        have[NEVH_MEMBER_MISSING] && have[NEVH_MEMBER_MISSING] == missing)
        return report_no_progress(j, missing);
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

static int run_array(sweep_job *j) {
    char *late = text_print("nevh: %s: stopped: go on with --resume %s\n",
                            j->store.name, j->store.name);
    uint64_t before[4] = {0};
    if (!j->ranks.rank)
        count_members(j, false, before);
    under_way = j->sweep;
    signals_catch(note_signal, late);
    stop_after(j->options->stop_after);
    sweep_begin(j);
    bool shared = j->ranks.count > 1;
    int status = shared ? nevh_sweep_run_chunks(j->sweep, ranks_take, &j->ranks,
                                                is_wanted, keep, j)
                        : nevh_sweep_run(j->sweep, j->store.first,
                                         j->store.count, is_wanted, keep, j);
    signals_catch(NULL, NULL);
    under_way = NULL;
    status = sweep_end(j, status);
    if (shared)
        status = ranks_close(&j->ranks, status);
    j->store.write = NULL;
    if (!status && !j->ranks.rank)
        status = store_finish(&j->store)
                     ? TOOL_USAGE
                     : report_array(j, before[NEVH_MEMBER_MISSING]);
    return ranks_agree(&j->ranks, status);
}

/* The first member of a part. */
static uint64_t begin_of(const sweep_job *j, uint64_t task, uint64_t tasks) {
    uint64_t members = nevh_sweep_members(j->sweep);
    return members / tasks * (task - 1) + members % tasks * (task - 1) / tasks;
}

static void take_part(const sweep_job *j, uint64_t task, uint64_t tasks,
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
    return several ? 0 : found;
}

static int join(sweep_job *j) {
    const char *file = j->options->file;
    uint64_t parts = find_parts(file);
    if (!parts)
        return TOOL_USAGE;
    if (parts > j->count)
        return tool_refuse("%s: %" PRIu64 " parts of %" PRIu64 " members", file,
                           parts, j->count);
    int status = store_create(&j->store, file);
    for (uint64_t i = 1; !status && i <= parts; i++) {
        uint64_t first, members;
        char *name = output_part(file, i, parts);
        take_part(j, i, parts, &first, &members);
        status = store_take(&j->store, name, first, members);
    }
    if (!status)
        status = store_finish(&j->store);
    if (!status)
        status = store_settle(&j->store);
    return status ? status : report_array(j, j->store.count);
}

/* As far as members were run. */
static int draw_array(sweep_job *j, int status) {
    store *s = &j->store;
    double *values = tool_allocate(j->columns.count, sizeof *values);
    for (uint64_t i = store_next(s, 0); i < s->count;
         i = store_next(s, i + 1)) {
        nevh_member_status found = store_read(s, s->first + i, values);
        if (found != NEVH_MEMBER_MISSING)
            map_take(j->map, s->first + i, found, values);
    }
    return map_draw(j->map, j->integrator) ? TOOL_USAGE : status;
}

/* The members of a part, or those that a file lacks. */
static int run_members(sweep_job *j) {
    const options *o = j->options;
    store *s = &j->store;
    int status = TOOL_OK;
    if (o->tasks)
        take_part(j, o->task, o->tasks, &s->first, &s->count);
    if (o->resume)
        status = ranks_agree(&j->ranks,
                             store_range(o->resume, &s->first, &s->count));
    if (status)
        return status;
    j->count = s->count;
    char *name =
        output_part(o->resume ? o->resume : o->file, o->task, o->tasks);
    status = ranks_open(&j->ranks, s, name, o->resume, j->threads);
    if (!status)
        status = run_array(j);
    return status;
}

int sweep_array(sweep_job *j) {
    char *settings = describe(j), *story = describe_file(j);
    j->store = (store){.file = -1,
                       .columns = &j->columns,
                       .settings = settings,
                       .story = story,
                       .count = j->count};
    int status = j->options->join ? join(j) : run_members(j);
    bool ends = status == TOOL_STOPPED && interrupted;
    if (j->map && !j->ranks.rank && status != TOOL_USAGE && !ends)
        status = draw_array(j, status);
    store_close(&j->store);
    if (ends && j->ranks.count == 1)
        signal_end(interrupted);
    return status;
}
