/* nevh sweep: processes of MPI that share a sweep.

   nevh does not link MPI.  Started by mpirun with several processes it becomes
   nevh-mpi, the same program with one file more, which has ranks_mpi.  Ranks take
   chunks of members from a counter of rank 0 by one-sided operations, so that a
   slow one holds up no other, and write records into the one file.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RANKS_H
#define NEVH_RANKS_H

#include "store.h"

/* The functions of MPI in use. */
typedef struct {
    /* rank, ranks, and those of this machine */
    bool (*begin)(size_t *rank, size_t *count, size_t *local);
    /* Each becomes that of the rank where it is largest; collective; waits
       without using a processor. */
    void (*largest)(int values[2]);
    /* The file, for writing, and the counter; collective.  NULL, or why not. */
    const char *(*open)(const char *name);
    uint64_t (*next)(void); /* the counter, which is one more then */
    bool (*write)(const void *bytes, size_t count, uint64_t at);
    const char *(*close)(void); /* collective */
    void (*end)(void);
} ranks_functions;
extern const ranks_functions ranks_mpi __attribute__((weak));

typedef struct {
    size_t rank, count, local; /* count 1: alone */
    uint64_t first, members;
    uint64_t threads;   /* ranks times the most that one has */
    uint64_t taken, at; /* the number of the last chunk, its first member */
    int stderr_kept;    /* a rank above 0 is silent while all do the same */
} ranks;

/* Replaces this process by nevh-mpi, if it is there, when mpirun started several
   for a sweep. */
void ranks_exec(char *argv[]);
/* All return TOOL_OK or, with a message, TOOL_USAGE. */
int ranks_begin(ranks *, const options *, bool array);
/* The largest status of all ranks, from all of them. */
int ranks_agree(ranks *, int status);
/* Rank 0 creates the file, or goes on with it; others look at it. */
int ranks_open(ranks *, store *, const char *name, bool resume, size_t threads);
/* The next chunk; nevh_chunk_fn. */
bool ranks_take(void *ranks, uint64_t *first, uint64_t *count);
/* All have done what they took: the file is whole.  Returns as ranks_agree. */
int ranks_close(ranks *, int status);
void ranks_end(ranks *);
/* Threads that a rank has processors for. */
size_t ranks_threads(const ranks *);

#endif
