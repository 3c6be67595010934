/* nevh: the system's C compiler.  Files that include this one ask for POSIX.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COMPILER_PRIVATE_H
#define NEVH_COMPILER_PRIVATE_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

enum { NEVH__MOST_OUTPUT = 1200 };
typedef struct {
    char text[NEVH__MOST_OUTPUT + 1]; /* the beginning of what it says */
    size_t used;
    bool interrupted; /* by a signal, which is still pending */
} nevh__compiler_output;
/* Between these the calling thread gets none of the signals that end a process
   from outside.
   before  out: the mask that was */
void nevh__signals_hold(sigset_t *before);
void nevh__signals_release(const sigset_t *before);
/* Compiles `path` into term.so of the folder, all signals being held.
   returns  the compiler's exit status, 127 when there is none; or -1 */
int nevh__compile(const char *path, const char *folder, const sigset_t *before,
                  nevh__compiler_output *);
/* A folder of files, removed with them. */
void nevh__folder_remove(const char *folder);

#endif
