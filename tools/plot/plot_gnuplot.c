/* nevh: gnuplot as a child.  No shell takes part, and scripts and messages pass
   through files, not pipes: whoever ends early leaves nobody waiting, and no
   SIGPIPE.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot_private.h"
#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

static int spawn(char *const arguments[], int in, int out, int messages,
                 const posix_spawnattr_t *how, pid_t *child) {
    posix_spawn_file_actions_t files;
    int wrong = posix_spawn_file_actions_init(&files);
    if (wrong)
        return wrong;
    posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, messages, STDERR_FILENO);
    wrong = posix_spawnp(child, arguments[0], &files, how, arguments, environ);
    posix_spawn_file_actions_destroy(&files);
    return wrong;
}

/* In a group of its own, which ends with it.  A signal waits until the child is one
   that ends with this program, which is told of the child's end whatever its caller
   ignores. */
static int start(char *const arguments[], int in, int out, int messages,
                 pid_t *child) {
    posix_spawnattr_t how;
    sigset_t all, before;
    int wrong = posix_spawnattr_init(&how);
    if (wrong)
        return wrong;
    sigfillset(&all);
    sigprocmask(SIG_BLOCK, &all, &before);
    posix_spawnattr_setsigmask(&how, &before);
    posix_spawnattr_setpgroup(&how, 0);
    posix_spawnattr_setflags(&how,
                             POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    signal(SIGCHLD, SIG_DFL);
    wrong = spawn(arguments, in, out, messages, &how, child);
    if (!wrong)
        output_child(*child);
    sigprocmask(SIG_SETMASK, &before, NULL);
    posix_spawnattr_destroy(&how);
    return wrong;
}

/* Seconds: fonts that are used for the first time take some. */
enum { LONGEST_DRAWING = 120, LOOKS_APART = 5 /* milliseconds */ };
enum { TOO_LONG = -1 };

/* returns  its status, or TOO_LONG: it was ended with its group */
static int await(pid_t child) {
    const struct timespec pause = {.tv_nsec = LOOKS_APART * 1000000L};
    double begun = wall_seconds();
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (wall_seconds() - begun > LONGEST_DRAWING) {
            kill(-child, SIGKILL);
            waitpid(child, &status, 0);
            return TOO_LONG;
        }
        nanosleep(&pause, NULL);
    }
    return status;
}

/* In one line, of which no more than `size`. */
static void read_message(FILE *messages, char text[], size_t size) {
    size_t length = 0;
    int c;
    rewind(messages);
    while ((c = getc(messages)) != EOF && length + 1 < size) {
        bool blank = c <= ' ' || c == 0x7f;
        if (!blank)
            text[length++] = (char)c;
        else if (length && text[length - 1] != ' ')
            text[length++] = ' ';
    }
    while (length && text[length - 1] == ' ')
        length--;
    text[length] = '\0';
}

static int refuse_end(int status, FILE *messages) {
    char text[400], *how;
    if (status == TOO_LONG)
        return tool_refuse("gnuplot took longer than %d s and was ended: does "
                           "gnuplot --version end?  Pictures in files .svg do "
                           "not need it",
                           LONGEST_DRAWING);
    read_message(messages, text, sizeof text);
    if (WIFSIGNALED(status))
        how = text_print("signal %d", WTERMSIG(status));
    else
        how = text_print("exit status %d", WEXITSTATUS(status));
    return tool_refuse(
        *text ? "gnuplot failed (%s): %s" : "gnuplot failed (%s)", how, text);
}

static int run(char *const arguments[], FILE *in, FILE *out, FILE *messages) {
    pid_t child;
    int wrong =
        start(arguments, fileno(in), fileno(out), fileno(messages), &child);
    if (wrong == ENOENT)
        return tool_refuse(
            "pictures other than .svg need gnuplot, which was not "
            "found (Debian has it as gnuplot-nox)");
    if (wrong)
        return tool_refuse("gnuplot cannot be run: %s", strerror(wrong));
    int status = await(child);
    output_child(0);
    return status ? refuse_end(status, messages) : TOOL_OK;
}

/* Runs it with a file for its messages. */
static int run_heard(char *const arguments[], FILE *in, FILE *out) {
    FILE *messages = tmpfile();
    if (!messages)
        return tool_refuse("no temporary file: %s", strerror(errno));
    int status = run(arguments, in, out, messages);
    fclose(messages);
    return status;
}

int gnuplot_check(void) {
    char *const arguments[] = {"gnuplot", "--version", NULL};
    FILE *nothing = fopen("/dev/null", "r+e");
    if (!nothing)
        return tool_refuse("/dev/null cannot be opened: %s", strerror(errno));
    int status = run_heard(arguments, nothing, nothing);
    fclose(nothing);
    return status;
}

/* The last bytes of a complete drawing; gnuplot reports no error when the disk is
   full. */
static const struct {
    const char *bytes;
    size_t count;
} ends[] = {
    [PLOT_SVG] = {"", 0},      [PLOT_PNG] = {"IEND", 4},
    [PLOT_PDF] = {"%%EOF", 5}, [PLOT_GIF] = {"\0;", 2},
    [PLOT_TEXT] = {"", 0},     [PLOT_SCREEN] = {"", 0},
};

/* True for a file that ends as its medium does. */
static bool is_whole(FILE *f, medium m) {
    enum { TAIL = 16 };
    struct stat found;
    char tail[TAIL];
    if (fstat(fileno(f), &found) != 0)
        return false;
    off_t from = found.st_size > TAIL ? found.st_size - TAIL : 0;
    ssize_t count = pread(fileno(f), tail, sizeof tail, from);
    return count < 0 || (count > 0 && memmem(tail, (size_t)count, ends[m].bytes,
                                             ends[m].count));
}

int gnuplot_draw(FILE *script, FILE *drawing, medium m) {
    /* Without the user's own settings; by name, since gnuplot reads what has none one
       byte at a time. */
    char *const arguments[] = {"gnuplot", "--default-settings", "/dev/stdin",
                               NULL};
    int status = run_heard(arguments, script, drawing);
    if (!status && !is_whole(drawing, m))
        return tool_refuse(
            "gnuplot drew nothing, or a part: is the disk full?");
    return status;
}
