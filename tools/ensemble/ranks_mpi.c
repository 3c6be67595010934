/* nevh-mpi: what it has beside nevh.

   Threads of a rank call MPI one at a time.  Waiting ranks poll with sleep:
   a processor may be another rank's.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ranks.h"
#include <errno.h>
#include <mpi.h>
#include <time.h>

static MPI_Win window;
static MPI_File file;
static uint64_t answer;
static char why[MPI_MAX_ERROR_STRING];

static const char *reason(int status) {
    int length;
    if (status == MPI_SUCCESS)
        return NULL;
    if (MPI_Error_string(status, why, &length))
        return "an error of MPI";
    return why;
}

static bool begin(size_t *rank, size_t *count, size_t *local) {
    int had, number;
    MPI_Comm here;
    if (MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &had) ||
        had < MPI_THREAD_SERIALIZED)
        return false;
    MPI_Comm_rank(MPI_COMM_WORLD, &number);
    *rank = (size_t)number;
    MPI_Comm_size(MPI_COMM_WORLD, &number);
    *count = (size_t)number;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL,
                        &here);
    MPI_Comm_size(here, &number);
    MPI_Comm_free(&here);
    *local = (size_t)number;
    return true;
}

static void largest(int values[2]) {
    const struct timespec longest = {0, 1000000};
    struct timespec pause = {0, 1000};
    MPI_Request request;
    int over = 0;
    MPI_Iallreduce(MPI_IN_PLACE, values, 2, MPI_INT, MPI_MAX, MPI_COMM_WORLD,
                   &request);
    while (!MPI_Test(&request, &over, MPI_STATUS_IGNORE) && !over) {
        nanosleep(&pause, NULL);
        if (pause.tv_nsec < longest.tv_nsec)
            pause.tv_nsec *= 2;
    }
}

/* Rank 0 answers when it calls MPI, and so may take a while. */
static void ask(void) {
    static const uint64_t one = 1;
    MPI_Fetch_and_op(&one, &answer, MPI_UINT64_T, 0, 0, MPI_SUM, window);
}

static uint64_t next(void) {
    MPI_Win_flush(0, window);
    uint64_t number = answer;
    ask();
    return number;
}

/* The counter begins with 0. */
static const char *open_file(const char *name) {
    int rank, status = MPI_File_open(MPI_COMM_WORLD, name, MPI_MODE_WRONLY,
                                     MPI_INFO_NULL, &file);
    uint64_t *counter;
    if (status)
        return reason(status);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Win_allocate(rank ? 0 : sizeof *counter, sizeof *counter, MPI_INFO_NULL,
                     MPI_COMM_WORLD, &counter, &window);
    MPI_Win_lock_all(0, window);
    if (!rank) {
        *counter = 0;
        MPI_Win_sync(window);
    }
    MPI_Barrier(MPI_COMM_WORLD);
    ask();
    return NULL;
}

/* Rank 0 also looks whether others ask for its counter. */
static bool write_file(const void *bytes, size_t count, uint64_t at) {
    int found, class, status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &found,
               MPI_STATUS_IGNORE);
    status = MPI_File_write_at(file, (MPI_Offset)at, bytes, (int)count,
                               MPI_BYTE, MPI_STATUS_IGNORE);
    if (status == MPI_SUCCESS)
        return true;
    MPI_Error_class(status, &class);
    errno = class == MPI_ERR_NO_SPACE ? ENOSPC
            : class == MPI_ERR_QUOTA  ? EDQUOT
                                      : EIO;
    return false;
}

static const char *close_file(void) {
    MPI_Win_unlock_all(window);
    MPI_Win_free(&window);
    return reason(MPI_File_close(&file));
}

static void end(void) {
    MPI_Finalize();
}

const ranks_functions ranks_mpi = {begin,      largest,    open_file, next,
                                   write_file, close_file, end};
