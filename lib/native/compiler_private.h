/* nevh: the system's C compiler.  Files that include this one ask for POSIX.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COMPILER_PRIVATE_H
#define NEVH_COMPILER_PRIVATE_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum { NEVH__MOST_OUTPUT = 1200 };
typedef struct {
    char text[NEVH__MOST_OUTPUT +
              1]; /* the beginning of what it says; where there
                                         is no compiler, its name; where it was not
                                         started, why */
    size_t used;
    bool interrupted; /* by a signal, which is still pending */
    bool late;        /* ended because it took too long */
} nevh__compiler_output;
/* Between these the calling thread gets none of the signals that end a process
   from outside.
   before  out: the mask that was */
void nevh__signals_hold(sigset_t *before);
void nevh__signals_release(const sigset_t *before);
/* The command: CC of the environment, which is the name of a file or words apart by
   blanks, with quotes as a shell has them; else the first of cc, gcc and clang that
   exists. Ended by NULL, and to be freed in one piece.  NULL: memory is out. */
char **nevh__compiler_words(void);
/* The file that a command is; to be freed.  NULL: there is none. */
char *nevh__command_find(const char *name);
enum { NEVH__NO_COMPILER = -2 };
/* A compiler at work.  So many may be at once. */
enum { NEVH__MOST_COMPILERS = 16 };
typedef struct {
    pid_t child;  /* 0: it was not started */
    int pipe;     /* what it says */
    int lifeline; /* once that is closed, it is ended */
    bool runs;
    int status; /* once it has ended: its exit status as a shell has it,
                   NEVH__NO_COMPILER, or -1 */
    nevh__compiler_output output;
} nevh__compiling;
/* A source that becomes a shared object, by flags that are ended by NULL.  The
   compiler's own files go to the folder. */
typedef struct {
    const char *const *flags, *source, *object, *folder;
} nevh__compilation;
/* Starts it, all signals being held. */
void nevh__compile_begin(const nevh__compilation *, const sigset_t *before,
                         nevh__compiling *);
/* Waits until all have ended, or ends them: after a signal, or so many seconds. */
void nevh__compile_await(nevh__compiling[], size_t count,
                         const sigset_t *before, double seconds);
/* Why there is no object. */
#define NEVH__TOO_LONG                                                         \
    "the C compiler took too long; it is tried again ten minutes later"
void nevh__compiler_tell(const nevh__compiling *, char why[], size_t size);
enum { NEVH__LONGEST_COMPILATION = 120 }; /* seconds */
/* A folder of nobody else's, in that of temporary files; to be removed and
   freed.  NULL: none can be made. */
char *nevh__new_folder(void);
/* A folder of files, removed with them. */
void nevh__folder_remove(const char *folder);

#endif
