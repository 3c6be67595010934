/* nevh: files that are there when they are whole.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "tool.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

/* mkostemp lets only the owner read.  A file that is replaced keeps its mode. */
static void allow_as_usual(int file, const char *replaced) {
    struct stat found;
    mode_t mask = umask(0);
    umask(mask);
    if (stat(replaced, &found) == 0)
        fchmod(file, found.st_mode & 07777);
    else
        fchmod(file, 0666 & ~mask);
}

/* The temporary files to remove when a signal ends the program: rows, and a
   picture of them, may be open together. */
enum { MOST_OPEN = 8 };
static const char *volatile unfinished[MOST_OPEN];
static void (*volatile leave)(int);
static volatile pid_t child; /* and its group; 0: none is at work */

static void remember(const char *forgotten, const char *name) {
    for (int i = 0; i < MOST_OPEN; i++)
        if (unfinished[i] == forgotten) {
            unfinished[i] = name;
            return;
        }
}

static void remove_all(int number) {
    for (int i = 0; i < MOST_OPEN; i++)
        if (unfinished[i])
            unlink(unfinished[i]);
    if (child > 0)
        kill(-child, SIGKILL);
    if (leave)
        leave(number);
}

void signal_end(int number) {
    signal(number, SIG_DFL);
    raise(number);
}

static void remove_and_end(int number) {
    remove_all(number);
    signal_end(number);
}

/* The function to call at the first signal; NULL: it ends the program, as others
   do. */
static void (*volatile to_note)(int);
static const char *volatile if_late;
static volatile sig_atomic_t noted;
static const int of_note[] = {SIGHUP, SIGINT, SIGTERM, SIGXCPU};

static void end_late(int number) {
    (void)number;
    ssize_t said = write(STDERR_FILENO, if_late, strlen(if_late));
    (void)said;
    remove_and_end(noted);
}

static void note_or_end(int number) {
    void (*note)(int) = to_note;
    to_note = NULL;
    if (!note) {
        remove_and_end(number);
        return;
    }
    noted = number;
    note(number);
    signal_catch(SIGALRM, end_late);
    alarm(1);
}

void signal_catch(int number, void (*note)(int)) {
    struct sigaction found, caught = {.sa_handler = note};
    if (sigaction(number, NULL, &found) == 0 && found.sa_handler != SIG_IGN)
        sigaction(number, &caught, NULL);
}

void timer_start(int timer, double seconds) {
    seconds = fmin(seconds, 1e9);
    double whole = floor(seconds);
    struct itimerval end = {
        .it_value = {(time_t)whole, (suseconds_t)(1e6 * (seconds - whole))}};
    setitimer(timer, &end, NULL);
}

void signals_catch(void (*note)(int), const char *late) {
    if (!note)
        alarm(0);
    if_late = late ? late : "";
    to_note = note;
    for (size_t i = 0; i < sizeof of_note / sizeof *of_note; i++)
        signal_catch(of_note[i], note_or_end);
}

/* For exits from anywhere, as when memory is exhausted. */
static void remove_at_exit(void) {
    remove_all(0);
}

/* Catches a signal that would end the program, unless it has a handler. */
static void catch_where_none_is(int number) {
    struct sigaction found;
    if (sigaction(number, NULL, &found) == 0 && found.sa_handler == SIG_DFL)
        signal_catch(number, remove_and_end);
}

static void watch_the_end(void) {
    static const int others[] = {SIGQUIT,   SIGUSR1, SIGUSR2, SIGALRM,
                                 SIGVTALRM, SIGPROF, SIGPIPE, SIGSYS,
                                 SIGABRT,   SIGTRAP, SIGPOLL};
    static bool watched;
    if (!watched)
        atexit(remove_at_exit);
    watched = true;
    if (!to_note)
        signals_catch(NULL, NULL);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        catch_where_none_is(others[i]);
#ifdef SIGPWR
    catch_where_none_is(SIGPWR);
#endif
#ifdef SIGSTKFLT
    catch_where_none_is(SIGSTKFLT);
#endif
    for (int number = SIGRTMIN; number <= SIGRTMAX; number++)
        catch_where_none_is(number);
}

void output_child(pid_t process) {
    child = process;
    if (process)
        watch_the_end();
}

void output_leave(void (*call)(int)) {
    leave = call;
    if (call)
        watch_the_end();
}

/* A device or a pipe is written to as it is, and so is what a symbolic link
   stands for that is not there yet. */
static bool can_be_replaced(const char *name) {
    struct stat found;
    if (stat(name, &found) == 0)
        return S_ISREG(found.st_mode);
    return lstat(name, &found) != 0 || !S_ISLNK(found.st_mode);
}

/* In the same folder, with a name that is not too long either. */
static char *temporary_name(const char *name) {
    enum { MOST = 200 };
    const char *slash = strrchr(name, '/'), *last = slash ? slash + 1 : name;
    return text_print("%.*s%.*s.XXXXXX", (int)(last - name), name, MOST, last);
}

static void open_temporary(output *o) {
    sigset_t all, before;
    sigfillset(&all);
    o->temporary = temporary_name(o->name);
    watch_the_end();
    sigprocmask(SIG_BLOCK, &all, &before);
    int file =
        mkostemp(o->temporary, O_CLOEXEC); /* no compiler keeps its lock */
    if (file >= 0)
        remember(NULL, o->temporary);
    sigprocmask(SIG_SETMASK, &before, NULL);
    o->stream = file < 0 ? NULL : fdopen(file, "w");
    if (o->stream) {
        allow_as_usual(file, o->name);
    } else if (file >= 0) {
        int why = errno;
        close(file);
        unlink(o->temporary);
        errno = why;
    }
}

static void forget(output *o) {
    remember(o->temporary, NULL);
    remember(o->made, NULL);
    if (o->locks)
        close(o->former);
}

bool file_is_regular(int file) {
    struct stat found;
    return fstat(file, &found) == 0 && S_ISREG(found.st_mode);
}

FILE *regular_open(const char *name) {
    int file = open(name, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file >= 0 && file_is_regular(file))
        return fdopen(file, "rb");
    if (file >= 0)
        close(file);
    return NULL;
}

char *file_read(FILE *f, size_t *size) {
    size_t room = 1 << 12, used = 0, count = 1;
    char *text = f ? tool_allocate(room, 1) : NULL;
    while (text && (count = fread(text + used, 1, room - used - 1, f)) > 0) {
        used += count;
        if (used + 1 == room)
            text = tool_enlarge(text, room *= 2, 1);
    }
    if (text) {
        text[used] = '\0';
        fclose(f);
    }
    if (size)
        *size = used;
    return text;
}

static bool failed;

bool output_failed(void) {
    return failed;
}

int output_open(output *o, const char *name) {
    *o = (output){.stream = stdout};
    if (!name)
        return TOOL_OK;
    o->name =
        text_adopt(realpath(name, NULL)); /* what a symbolic link stands for */
    if (!o->name)
        o->name = text_print("%s", name);
    if (can_be_replaced(o->name))
        open_temporary(o);
    else
        o->stream = fopen(o->name, "we");
    if (o->stream)
        return TOOL_OK;
    failed = true;
    tool_refuse("%s cannot be written: %s", name, strerror(errno));
    forget(o);
    return TOOL_USAGE;
}

static bool is_file_of(int file, const char *name) {
    struct stat here, there;
    return fstat(file, &here) == 0 && stat(name, &there) == 0 &&
           here.st_dev == there.st_dev && here.st_ino == there.st_ino;
}

/* Locks what stands under the name, an empty file where nothing does. */
static int lock_former(output *o, const char *name, const char *who) {
    struct stat found;
    if (stat(name, &found) != 0)
        o->made = text_print("%s", name);
    o->former = open(name, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    o->locks = o->former >= 0;
    char *real = o->made && o->locks ? text_adopt(realpath(name, NULL)) : NULL;
    if (real) /* the file, not a link that stands for it */
        o->made = real;
    if (!o->locks) {
        o->made = NULL;
        return tool_refuse("%s cannot be written: %s", name, strerror(errno));
    }
    bool busy = flock(o->former, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK;
    if (!busy && is_file_of(o->former, name)) {
        if (o->made)
            remember(NULL, o->made);
        return TOOL_OK;
    }
    return tool_refuse("%s: another %s is writing it", name, who);
}

int output_claim(output *o, const char *name, const char *who) {
    struct stat found;
    output claimed = {0};
    bool lasts = stat(name, &found) != 0 || S_ISREG(found.st_mode);
    int status = lasts ? lock_former(&claimed, name, who) : TOOL_OK;
    if (status || output_open(o, name)) {
        if (!status && claimed.made)
            unlink(claimed.made);
        forget(&claimed);
        return TOOL_USAGE;
    }
    o->former = claimed.former;
    o->locks = claimed.locks;
    o->made = claimed.made;
    if (o->locks)
        flock(fileno(o->stream), LOCK_EX | LOCK_NB);
    return TOOL_OK;
}

int output_check(const char *name) {
    output o;
    if (!can_be_replaced(name)) {
        if (access(name, W_OK) == 0 || errno == ENOENT)
            return TOOL_OK;
        return tool_refuse("%s cannot be written: %s", name, strerror(errno));
    }
    if (output_open(&o, name))
        return TOOL_USAGE;
    fclose(o.stream);
    unlink(o.temporary);
    forget(&o);
    return TOOL_OK;
}

static int write_all(output *o) {
    bool wrong = ferror(o->stream);
    return (o->name ? fclose(o->stream) : fflush(o->stream)) || wrong;
}

int output_close(output *o, int status) {
    errno = 0;
    int wrong = write_all(o);
    if (o->temporary && !wrong && status != TOOL_USAGE) {
        remember(o->made, NULL);
        wrong = rename(o->temporary, o->name);
    }
    failed |= wrong;
    if (wrong)
        status = tool_refuse("%s cannot be written: %s",
                             o->name ? o->name : "the output",
                             errno ? strerror(errno)
                                   : "writing stopped before the end: is the "
                                     "disk full?");
    if (o->temporary && status == TOOL_USAGE)
        unlink(o->temporary);
    if (o->made && status == TOOL_USAGE)
        unlink(o->made);
    forget(o);
    return status;
}

int output_page(const options *o, const page *p, int status) {
    output out;
    if (output_open(&out, o->file))
        return TOOL_USAGE;
    page_print(p, o, out.stream);
    return output_close(&out, status);
}
