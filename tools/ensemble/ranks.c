/* nevh sweep: processes of MPI that share a sweep; without MPI, that there are
   none.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ranks.h"
#include <fcntl.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LEAST_CHUNK = 32, MOST_CHUNK = 2048, SHARE = 16 };

static bool has_mpi(void) {
    return &ranks_mpi != NULL;
}

static size_t number_in(const char *name) {
    const char *text = getenv(name);
    return text ? strtoul(text, NULL, 10) : 0;
}

/* The number of processes that mpirun, or srun with PMI, started; 0: unknown. */
static size_t launched(void) {
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE",
                                        "MV2_COMM_WORLD_SIZE"};
    size_t most = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        most = number_in(names[i]) > most ? number_in(names[i]) : most;
    if (getenv("PMIX_RANK") && number_in("SLURM_STEP_NUM_TASKS") > most)
        most = number_in("SLURM_STEP_NUM_TASKS");
    return most;
}

static bool has_word(char *argv[], const char *word) {
    for (; *argv; argv++)
        if (strncmp(*argv, word, strlen(word)) == 0)
            return true;
    return false;
}

void ranks_exec(char *argv[]) {
    char path[4096];
    if (has_mpi() || launched() < 2 || !has_word(argv, "sweep") ||
        has_word(argv, "--task"))
        return;
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 16);
    if (length <= 0)
        return;
    path[length] = '\0';
    char *slash = strrchr(path, '/');
    strcpy(slash ? slash + 1 : path, "nevh-mpi");
    execv(path, argv); /* comes back where there is none */
}

/* Ranks above 0 would say the same. */
static void hush(ranks *r) {
    int nothing = r->rank ? open("/dev/null", O_WRONLY | O_CLOEXEC) : -1;
    if (nothing < 0)
        return;
    r->stderr_kept = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
    dup2(nothing, STDERR_FILENO);
    close(nothing);
}

static void speak(ranks *r) {
    if (r->stderr_kept < 0)
        return;
    dup2(r->stderr_kept, STDERR_FILENO);
    close(r->stderr_kept);
    r->stderr_kept = -1;
}

int ranks_begin(ranks *r, const options *o, bool array) {
    *r = (ranks){.count = 1, .local = 1, .stderr_kept = -1};
    if (!has_mpi())
        return launched() < 2 || o->tasks || o->join
                   ? TOOL_OK
                   : tool_refuse("mpirun started %zu processes, but nevh-mpi "
                                 "is not beside this nevh, which was built "
                                 "without MPI: give each its part by --task "
                                 "I/N",
                                 launched());
    if (!ranks_mpi.begin(&r->rank, &r->count, &r->local))
        return tool_refuse("MPI cannot be initialized");
    hush(r);
    if (r->count > 1 && (!array || o->tasks || o->join))
        return ranks_agree(
            r, tool_refuse("processes of mpirun share one array: give "
                           "-o FILE.npy, without --task and --join"));
    return TOOL_OK;
}

int ranks_agree(ranks *r, int status) {
    if (!has_mpi() || r->count == 1)
        return status;
    int ends[] = {status, -status};
    ranks_mpi.largest(ends);
    speak(r);
    if (status && -ends[1] == TOOL_OK && r->rank)
        tool_refuse("rank %zu cannot begin: are its scene and folder those of "
                    "rank 0?",
                    r->rank);
    return ends[0];
}

size_t ranks_threads(const ranks *r) {
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    size_t online = count > 0 ? (size_t)count : 1, own = online;
    cpu_set_t bound;
    if (sched_getaffinity(0, sizeof bound, &bound) == 0)
        own = (size_t)CPU_COUNT(&bound);
    if (own >= online) /* bound to nothing: ranks share them */
        own = online / r->local;
    return own ? own : 1;
}

static int open_store(store *s, const char *name, bool resume) {
    if (resume)
        return store_resume(s, name);
    return store_create(s, name) ? TOOL_USAGE : store_settle(s);
}

int ranks_open(ranks *r, store *s, const char *name, bool resume,
               size_t threads) {
    if (r->count == 1)
        return open_store(s, name, resume);
    int status = r->rank ? TOOL_OK : open_store(s, name, resume);
    status = ranks_agree(r, status);
    if (!status)
        status = ranks_agree(r, r->rank ? store_attach(s, name) : TOOL_OK);
    if (status)
        return status;
    const char *why = ranks_mpi.open(name);
    status = why ? tool_refuse("%s cannot be written: %s", name, why) : TOOL_OK;
    s->write = ranks_mpi.write;
    r->first = s->first;
    r->members = s->count;
    int most[] = {(int)threads, 0};
    ranks_mpi.largest(most);
    r->threads = r->count * (size_t)most[0];
    return ranks_agree(r, status);
}

/* The chunk that begins there, the same on all ranks.  Chunks get smaller, so that
   ranks end together, though a slow one has two of them: one is asked for ahead. */
static uint64_t chunk_at(const ranks *r, uint64_t at) {
    uint64_t left = r->members - at, chunk = left / (SHARE * r->threads);
    chunk = chunk < LEAST_CHUNK  ? LEAST_CHUNK
            : chunk > MOST_CHUNK ? MOST_CHUNK
                                 : chunk;
    return left < chunk ? left : chunk;
}

bool ranks_take(void *data, uint64_t *first, uint64_t *count) {
    ranks *r = data;
    for (uint64_t k = ranks_mpi.next(); r->taken < k; r->taken++)
        r->at += chunk_at(r, r->at);
    *first = r->first + r->at;
    *count = chunk_at(r, r->at);
    return *count > 0;
}

int ranks_close(ranks *r, int status) {
    status = ranks_agree(r, status);
    const char *why = ranks_mpi.close();
    if (why && !status)
        status = tool_refuse("the file cannot be written: %s", why);
    return ranks_agree(r, status);
}

void ranks_end(ranks *r) {
    speak(r);
    if (has_mpi() && r->count)
        ranks_mpi.end();
}
