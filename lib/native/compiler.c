/* nevh: the system's compiler, as a child in a process group of its own.

   A signal that would end this process while the child runs must leave neither
   the child nor its files behind.  A library owns no signal handlers, so the
   calling thread blocks such signals and looks for pending ones while it waits.
   When there is one, the group is ended, the folder is removed, and then the
   signal takes its course.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "native/compiler_private.h"
#include "system/system_private.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

/* Milliseconds: between looks, for a compiler to end that was asked to, and for
   any to compile. */
enum { LOOKS_APART = 20, PATIENCE = 2000, LONGEST = 120000 };
static const int minded[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM};
enum { MINDED = sizeof minded / sizeof *minded };

void nevh__signals_hold(sigset_t *before) {
    sigset_t held;
    sigemptyset(&held);
    for (size_t i = 0; i < MINDED; i++)
        sigaddset(&held, minded[i]);
    pthread_sigmask(SIG_BLOCK, &held, before);
}

void nevh__signals_release(const sigset_t *before) {
    pthread_sigmask(SIG_SETMASK, before, NULL);
}

/* Linux keeps a blocked signal pending although it is ignored. */
static bool is_ignored(int number) {
    struct sigaction found;
    return sigaction(number, NULL, &found) == 0 && found.sa_handler == SIG_IGN;
}

/* One that is delivered as soon as it is released. */
static bool is_interrupted(const sigset_t *before) {
    sigset_t pending;
    if (sigpending(&pending))
        return false;
    for (size_t i = 0; i < MINDED; i++)
        if (sigismember(&pending, minded[i]) == 1 &&
            !sigismember(before, minded[i]) && !is_ignored(minded[i]))
            return true;
    return false;
}

/* The environment, but that the compiler's own temporary files go to the
   folder; the first is to be freed. */
static char **environment_in(const char *folder) {
    size_t count = 0, kept = 0;
    while (environ[count])
        count++;
    char **all = nevh__array(count + 2, sizeof *all);
    char *temporary = nevh__text("TMPDIR=%s", folder);
    if (!all || !temporary) {
        free(all);
        free(temporary);
        return NULL;
    }
    all[kept++] = temporary;
    for (size_t i = 0; i < count; i++)
        if (strncmp(environ[i], "TMPDIR=", 7) != 0)
            all[kept++] = environ[i];
    return all;
}

static void free_environment(char **all) {
    if (all)
        free(all[0]);
    free(all);
}

static int set_attributes(posix_spawnattr_t *how, const sigset_t *before) {
    int wrong = posix_spawnattr_setflags(how, POSIX_SPAWN_SETPGROUP |
                                                  POSIX_SPAWN_SETSIGMASK);
    if (!wrong)
        wrong = posix_spawnattr_setpgroup(how, 0);
    return wrong ? wrong : posix_spawnattr_setsigmask(how, before);
}

static int set_files(posix_spawn_file_actions_t *files, int out) {
    int wrong = posix_spawn_file_actions_addopen(files, STDIN_FILENO,
                                                 "/dev/null", O_RDONLY, 0);
    if (!wrong)
        wrong = posix_spawn_file_actions_adddup2(files, out, STDOUT_FILENO);
    return wrong ? wrong
                 : posix_spawn_file_actions_adddup2(files, out, STDERR_FILENO);
}

/* returns  0, or an error number */
static int start(char *const arguments[], char *const environment[],
                 const sigset_t *before, int out, pid_t *child) {
    posix_spawnattr_t how;
    posix_spawn_file_actions_t files;
    int wrong = posix_spawnattr_init(&how);
    if (wrong)
        return wrong;
    wrong = posix_spawn_file_actions_init(&files);
    if (!wrong) {
        wrong = set_attributes(&how, before);
        if (!wrong)
            wrong = set_files(&files, out);
        if (!wrong)
            wrong = posix_spawnp(child, arguments[0], &files, &how, arguments,
                                 environment);
        posix_spawn_file_actions_destroy(&files);
    }
    posix_spawnattr_destroy(&how);
    return wrong;
}

/* Reads what there is, and keeps the beginning.
   returns  whether the pipe's other end is closed by all */
static bool has_ended(nevh__compiling *c) {
    nevh__compiler_output *output = &c->output;
    char block[512];
    ssize_t count = read(c->pipe, block, sizeof block);
    if (count < 0)
        return errno != EINTR;
    size_t left = sizeof output->text - 1 - output->used,
           kept = (size_t)count < left ? (size_t)count : left;
    memcpy(output->text + output->used, block, kept);
    output->used += kept;
    return count == 0;
}

/* Reads until all groups have ended, which is when nobody holds their pipes, until
   `give_up` milliseconds have passed, or until a signal comes; before  NULL: signals
   are not looked for */
static bool listen_to(nevh__compiling all[], size_t count,
                      const sigset_t *before, int give_up) {
    struct timespec begun, now;
    clock_gettime(CLOCK_MONOTONIC, &begun);
    for (double waited = 0;
         waited < give_up && !(before && is_interrupted(before));) {
        struct pollfd looks[NEVH__MOST_COMPILERS];
        nfds_t running = 0;
        for (size_t i = 0; i < count; i++)
            if (all[i].runs)
                looks[running++] =
                    (struct pollfd){.fd = all[i].pipe, .events = POLLIN};
        if (!running)
            return true;
        int ready = poll(looks, running, LOOKS_APART);
        for (size_t i = 0, k = 0; ready > 0 && i < count; i++)
            if (all[i].runs && looks[k++].revents)
                all[i].runs = !has_ended(&all[i]);
        clock_gettime(CLOCK_MONOTONIC, &now);
        waited = 1e3 * (double)(now.tv_sec - begun.tv_sec) +
                 1e-6 * (double)(now.tv_nsec - begun.tv_nsec);
    }
    return false;
}

static void signal_groups(const nevh__compiling all[], size_t count,
                          int number) {
    for (size_t i = 0; i < count; i++)
        if (all[i].runs)
            kill(-all[i].child, number);
}

/* returns  its exit status, or -1 */
static int await(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void nevh__compile_await(nevh__compiling all[], size_t count,
                         const sigset_t *before) {
    if (!listen_to(all, count, before, LONGEST)) {
        bool interrupted = is_interrupted(before);
        for (size_t i = 0; i < count; i++) {
            all[i].output.interrupted = all[i].runs && interrupted;
            all[i].output.late = all[i].runs && !interrupted;
        }
        signal_groups(all, count, SIGTERM);
        if (!listen_to(all, count, NULL, PATIENCE))
            signal_groups(all, count, SIGKILL);
        listen_to(all, count, NULL, PATIENCE);
    }
    for (size_t i = 0; i < count; i++) {
        if (!all[i].child)
            continue;
        all[i].status = await(all[i].child);
        close(all[i].pipe);
    }
}

static void begin(char *const arguments[], char *const environment[],
                  const sigset_t *before, nevh__compiling *c) {
    int ends[2];
    if (pipe(ends))
        return;
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    int wrong = start(arguments, environment, before, ends[1], &c->child);
    close(ends[1]);
    c->pipe = ends[0];
    c->runs = !wrong;
    if (!wrong)
        return;
    close(ends[0]);
    c->child = 0;
    c->status = wrong == ENOENT ? NEVH__NO_COMPILER : -1;
}

/* The file that the shell would run; NULL: there is none. */
char *nevh__command_find(const char *name) {
    const char *path = getenv("PATH");
    char *found = NULL;
    if (strchr(name, '/'))
        return access(name, X_OK) ? NULL : nevh__text("%s", name);
    for (const char *at = path ? path : ""; *at && !found;) {
        size_t bytes = strcspn(at, ":");
        found = nevh__text("%.*s/%s", (int)bytes, at, name);
        if (found && (!bytes || access(found, X_OK))) {
            free(found);
            found = NULL;
        }
        at += bytes + (at[bytes] == ':');
    }
    return found;
}

char *nevh__compiler_name(void) {
    static const char *const usual[] = {"cc", "gcc", "clang"};
    const char *given = getenv("CC");
    if (given && given[strspn(given, " \t\n")])
        return nevh__text("%s", given);
    for (size_t i = 0; i < sizeof usual / sizeof *usual; i++) {
        char *found = nevh__command_find(usual[i]);
        free(found);
        if (found)
            return nevh__text("%s", usual[i]);
    }
    return nevh__text("%s", usual[0]);
}

/* NAME FLAGS -o OBJECT SOURCE -lm */
static void begin_words(char *name, const char *const flags[],
                        const char *source, const char *object,
                        char *const environment[], const sigset_t *before,
                        nevh__compiling *c) {
    const char *arguments[NEVH__MOST_ARGUMENTS + 5];
    size_t count = 0;
    char *rest = NULL;
    for (char *word = strtok_r(name, " \t\n", &rest);
         word && count < NEVH__MOST_ARGUMENTS;
         word = strtok_r(NULL, " \t\n", &rest))
        arguments[count++] = word;
    for (; *flags && count < NEVH__MOST_ARGUMENTS; flags++)
        arguments[count++] = *flags;
    const char *last[] = {"-o", object, source, "-lm", NULL};
    memcpy(arguments + count, last, sizeof last);
    begin((char *const *)arguments, environment, before, c);
}

void nevh__compile_begin(const char *const flags[], const char *source,
                         const char *object, const char *folder,
                         const sigset_t *before, nevh__compiling *c) {
    char *name = nevh__compiler_name(), **environment = environment_in(folder);
    *c = (nevh__compiling){.status = -1};
    if (name && environment)
        begin_words(name, flags, source, object, environment, before, c);
    free(name);
    free_environment(environment);
}

char *nevh__new_folder(void) {
    const char *where = getenv("TMPDIR");
    char *folder =
        nevh__text("%s/nevh-XXXXXX", where && *where ? where : "/tmp");
    if (folder && mkdtemp(folder))
        return folder;
    free(folder);
    return NULL;
}

void nevh__folder_remove(const char *folder) {
    DIR *all = opendir(folder);
    for (struct dirent *file; all && (file = readdir(all));) {
        char *path = nevh__text("%s/%s", folder, file->d_name);
        if (path)
            unlink(path); /* no folder is: not . and .. either */
        free(path);
    }
    if (all)
        closedir(all);
    rmdir(folder);
}
