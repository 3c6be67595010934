/* nevh: the system's compiler, as a child in a process group of its own.

   A shell starts the compiler, and has a second child that waits for the end of a
   pipe, which this process holds: when this process ends, in whatever way, or gives
   the compiler up, the compiler is ended with all that it started, and its folder
   is removed.

   Signals that would end this process are blocked for the calling thread, so that
   a folder is removed before they take their course; the thread looks for pending
   ones while it waits.  A library owns no signal handlers.
   SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700
#include "native/compiler_private.h"
#include "system/system_private.h"
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

/* Milliseconds between looks, and seconds for a compiler to end that is given up. */
enum { LOOKS_APART = 20, PATIENCE = 3 };
/* The last ones may be used by a caller who has a handler: then they are let
   through. */
static const int minded[] = {SIGHUP,  SIGINT,  SIGQUIT, SIGTERM,
                             SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM,
                             SIGPROF, SIGXCPU, SIGPIPE};
enum { MINDED = sizeof minded / sizeof *minded, ALWAYS_HELD = 4 };

/* Linux keeps a blocked signal pending although it is ignored. */
static bool is_ignored(int number) {
    struct sigaction found;
    return sigaction(number, NULL, &found) == 0 && found.sa_handler == SIG_IGN;
}

static bool has_no_handler(int number) {
    struct sigaction found;
    return sigaction(number, NULL, &found) == 0 && found.sa_handler == SIG_DFL;
}

void nevh__signals_hold(sigset_t *before) {
    sigset_t held;
    sigemptyset(&held);
    for (size_t i = 0; i < MINDED; i++)
        if (i < ALWAYS_HELD || has_no_handler(minded[i]))
            sigaddset(&held, minded[i]);
    pthread_sigmask(SIG_BLOCK, &held, before);
}

void nevh__signals_release(const sigset_t *before) {
    pthread_sigmask(SIG_SETMASK, before, NULL);
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

/* The shell script that starts a compiler: its arguments are the folder and the
   command, and 3 is the pipe that closes when nobody waits any more. */
static const char watch[] =
    "folder=$1; shift\n"
    "(trap '' HUP INT QUIT TERM; exec >/dev/null 2>&1; read none <&3\n"
    "kill -TERM 0; rm -rf \"$folder\"; sleep 1; kill -KILL 0) & watch=$!\n"
    "\"$@\" 3<&-; status=$?\n"
    "kill -KILL $watch; exit $status";
enum { WATCH_WORDS = 5, LAST_WORDS = 5 };

static int set_attributes(posix_spawnattr_t *how, const sigset_t *before) {
    sigset_t
        usual; /* a shell that ignores its children's ends waits for none */
    sigemptyset(&usual);
    sigaddset(&usual, SIGCHLD);
    int wrong = posix_spawnattr_setflags(how, POSIX_SPAWN_SETPGROUP |
                                                  POSIX_SPAWN_SETSIGMASK |
                                                  POSIX_SPAWN_SETSIGDEF);
    if (!wrong)
        wrong = posix_spawnattr_setsigdefault(how, &usual);
    if (!wrong)
        wrong = posix_spawnattr_setpgroup(how, 0);
    return wrong ? wrong : posix_spawnattr_setsigmask(how, before);
}

static int set_files(posix_spawn_file_actions_t *files, int out, int lifeline) {
    int wrong = posix_spawn_file_actions_addopen(files, STDIN_FILENO,
                                                 "/dev/null", O_RDONLY, 0);
    if (!wrong)
        wrong = posix_spawn_file_actions_adddup2(files, out, STDOUT_FILENO);
    if (!wrong)
        wrong = posix_spawn_file_actions_adddup2(files, out, STDERR_FILENO);
    return wrong ? wrong : posix_spawn_file_actions_adddup2(files, lifeline, 3);
}

/* returns  0, or an error number */
static int compiler_start(const char *const arguments[],
                          char *const environment[], const sigset_t *before,
                          int out, int lifeline, pid_t *child) {
    posix_spawnattr_t how;
    posix_spawn_file_actions_t files;
    int wrong = posix_spawnattr_init(&how);
    if (wrong)
        return wrong;
    wrong = posix_spawn_file_actions_init(&files);
    if (!wrong) {
        wrong = set_attributes(&how, before);
        if (!wrong)
            wrong = set_files(&files, out, lifeline);
        if (!wrong)
            wrong = posix_spawn(child, arguments[0], &files, &how,
                                (char *const *)arguments, environment);
        posix_spawn_file_actions_destroy(&files);
    }
    posix_spawnattr_destroy(&how);
    return wrong;
}

/* Reads what there is, and keeps the beginning. */
static void hear(nevh__compiling *c) {
    nevh__compiler_output *output = &c->output;
    char block[512];
    ssize_t count;
    for (int i = 0; i < 64 && (count = read(c->pipe, block, sizeof block)) > 0;
         i++) {
        size_t left = sizeof output->text - 1 - output->used,
               kept = (size_t)count < left ? (size_t)count : left;
        memcpy(output->text + output->used, block, kept);
        output->used += kept;
    }
}

/* A process that a compiler has started, and left, may hold its pipe for ever. */
static bool has_ended(const nevh__compiling *c) {
    siginfo_t found = {.si_pid = 0};
    int wrong =
        waitid(P_PID, (id_t)c->child, &found, WEXITED | WNOHANG | WNOWAIT);
    return found.si_pid == c->child || (wrong && errno == ECHILD);
}

static double seconds_since(const struct timespec *begun) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - begun->tv_sec) +
           1e-9 * (double)(now.tv_nsec - begun->tv_nsec);
}

/* Until one says something, or for a short time. */
static void wait_a_little(const nevh__compiling all[], size_t count) {
    struct pollfd looks[NEVH__MOST_COMPILERS];
    nfds_t running = 0;
    for (size_t i = 0; i < count; i++)
        if (all[i].runs)
            looks[running++] =
                (struct pollfd){.fd = all[i].pipe, .events = POLLIN};
    poll(looks, running, LOOKS_APART);
}

static bool any_runs(const nevh__compiling all[], size_t count) {
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any |= all[i].runs;
    return any;
}

/* Reads until all have ended, so many seconds have passed, or a signal comes;
   before  NULL: signals are not looked for */
static bool listen_to(nevh__compiling all[], size_t count,
                      const sigset_t *before, double seconds) {
    struct timespec begun;
    clock_gettime(CLOCK_MONOTONIC, &begun);
    while (any_runs(all, count)) {
        if (seconds_since(&begun) > seconds ||
            (before && is_interrupted(before)))
            return false;
        wait_a_little(all, count);
        for (size_t i = 0; i < count; i++)
            if (all[i].runs) {
                bool ended = has_ended(&all[i]);
                hear(&all[i]);
                all[i].runs = !ended;
            }
    }
    return true;
}

/* returns  its exit status, as a shell has it; 0 where somebody else has taken it:
   what was made tells */
static int await(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return errno == ECHILD ? 0 : -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void close_lifeline(nevh__compiling *c) {
    if (c->lifeline >= 0)
        close(c->lifeline);
    c->lifeline = -1;
}

/* The watch ends them; where there is none, a signal does. */
static void end_all(nevh__compiling all[], size_t count) {
    for (size_t i = 0; i < count; i++)
        if (all[i].runs)
            close_lifeline(&all[i]);
    if (listen_to(all, count, NULL, PATIENCE))
        return;
    for (size_t i = 0; i < count; i++)
        if (all[i].runs)
            kill(-all[i].child, SIGKILL);
    listen_to(all, count, NULL, PATIENCE);
}

void nevh__compile_await(nevh__compiling all[], size_t count,
                         const sigset_t *before, double seconds) {
    if (!listen_to(all, count, before, seconds)) {
        bool interrupted = is_interrupted(before);
        for (size_t i = 0; i < count; i++) {
            all[i].output.interrupted = all[i].runs && interrupted;
            all[i].output.late = all[i].runs && !interrupted;
        }
        end_all(all, count);
    }
    for (size_t i = 0; i < count; i++) {
        if (!all[i].child)
            continue;
        all[i].status = await(all[i].child);
        if (all[i].output.late || all[i].output.interrupted)
            all[i].status = -1;
        close(all[i].pipe);
        close_lifeline(&all[i]);
    }
}

/* Away from 0, 1, 2 and 3, which the child has for itself. */
static bool open_pipe(int ends[2]) {
    enum { ABOVE = 4 };
    int low[2];
    ends[0] = ends[1] = -1;
    if (pipe(low))
        return false;
    for (int i = 0; i < 2; i++) {
        ends[i] = fcntl(low[i], F_DUPFD_CLOEXEC, ABOVE);
        close(low[i]);
    }
    return ends[0] >= 0 && ends[1] >= 0;
}

static void close_pipe(const int ends[2]) {
    for (int i = 0; i < 2; i++)
        if (ends[i] >= 0)
            close(ends[i]);
}

static void compiler_begin(const char *const arguments[],
                           char *const environment[], const sigset_t *before,
                           nevh__compiling *c) {
    int out[2], life[2] = {-1, -1}, wrong = EMFILE;
    if (open_pipe(out) && open_pipe(life))
        wrong = compiler_start(arguments, environment, before, out[1], life[0],
                               &c->child);
    if (wrong) {
        c->child = 0;
        snprintf(c->output.text, sizeof c->output.text,
                 "it cannot be started: %s", strerror(wrong));
        close_pipe(out);
        close_pipe(life);
        return;
    }
    close(out[1]);
    close(life[0]);
    fcntl(out[0], F_SETFL, O_NONBLOCK);
    c->pipe = out[0];
    c->lifeline = life[1];
    c->runs = true;
}

static size_t compiler_length_of(const char *const list[]) {
    size_t count = 0;
    while (list[count])
        count++;
    return count;
}

/* The shell, NAME FLAGS -o OBJECT SOURCE -lm */
static void begin_words(char *const words[], const char *command,
                        const nevh__compilation *is, char *const environment[],
                        const sigset_t *before, nevh__compiling *c) {
    const char *first[] = {"/bin/sh", "-c", watch, "nevh", is->folder},
               *last[] = {"-o", is->object, is->source, "-lm", NULL};
    size_t count = compiler_length_of((const char *const *)words),
           flags = compiler_length_of(is->flags);
    const char **all =
        nevh__array(WATCH_WORDS + count + flags + LAST_WORDS, sizeof *all);
    if (!all)
        return;
    memcpy(all, first, sizeof first);
    memcpy(all + WATCH_WORDS, words, count * sizeof *all);
    all[WATCH_WORDS] = command;
    memcpy(all + WATCH_WORDS + count, is->flags, flags * sizeof *all);
    memcpy(all + WATCH_WORDS + count + flags, last, sizeof last);
    compiler_begin(all, environment, before, c);
    free(all);
}

void nevh__compile_begin(const nevh__compilation *is, const sigset_t *before,
                         nevh__compiling *c) {
    char **words = nevh__compiler_words(),
         **environment = environment_in(is->folder);
    char *command = words ? nevh__command_find(words[0]) : NULL;
    *c = (nevh__compiling){.status = -1, .lifeline = -1};
    if (words && !command) {
        c->status = NEVH__NO_COMPILER;
        snprintf(c->output.text, sizeof c->output.text, "%s", words[0]);
    }
    if (command && environment)
        begin_words(words, command, is, environment, before, c);
    free(command);
    free(words);
    free_environment(environment);
}

/* The first line that is an error; where there is none, the first that has
   anything. */
static const char *first_error(const char *text) {
    static const char mark[] = "error: ";
    const char *error = strstr(text, mark);
    return error ? error + sizeof mark - 1 : text + strspn(text, " \t\r\n");
}

/* Puts question marks for characters that control a terminal. */
static void make_printable(char *text) {
    for (; *text; text++)
        if (iscntrl((unsigned char)*text))
            *text = '?';
}

static void tell_failure(const nevh__compiling *run, char why[], size_t size) {
    const char *error = first_error(run->output.text);
    if (*error) {
        snprintf(why, size, "the C compiler fails: %.*s",
                 (int)strcspn(error, "\r\n"), error);
        make_printable(why);
    } else if (run->status > 128)
        snprintf(why, size, "the C compiler fails: signal %d ended it",
                 run->status - 128);
    else
        snprintf(why, size,
                 "the C compiler fails: exit status %d, without a message",
                 run->status);
}

void nevh__compiler_tell(const nevh__compiling *run, char why[], size_t size) {
    if (run->output.interrupted)
        snprintf(why, size, "a signal ended the compiler");
    else if (run->output.late)
        snprintf(why, size, "%s", NEVH__TOO_LONG);
    else if (run->status == NEVH__NO_COMPILER)
        snprintf(why, size,
                 "there is no C compiler%s%.200s: install one, or name it in "
                 "the environment, CC=...",
                 *run->output.text ? " " : "", run->output.text);
    else
        tell_failure(run, why, size);
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
        bool own = strcmp(file->d_name, ".") && strcmp(file->d_name, "..");
        char *path = own ? nevh__text("%s/%s", folder, file->d_name) : NULL;
        if (path && unlink(path) && (errno == EISDIR || errno == EPERM))
            nevh__folder_remove(path); /* a compiler made it */
        free(path);
    }
    if (all)
        closedir(all);
    rmdir(folder);
}
