/* nevh sweep: a file of records.

   FILE.npy is one structured array of NumPy's format: a header of fixed length,
   then a record a member: a status byte, 7 bytes of nothing, a double a column.
   A record is written with status 0 first and its status after that, so that a
   process that is killed leaves records that are whole or not there.
   FILE.npy.txt says what it was made from, and why members are not done.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STORE_H
#define NEVH_STORE_H

#include "cli/tool.h"
#include <nevh/sweep.h>

typedef struct {
    char *name, *side; /* FILE.npy, FILE.npy.txt */
    int file;
    const list *columns;
    const char *settings;  /* lines NAME: VALUE; what a resumed sweep shares */
    const char *story;     /* what else the side file begins with */
    uint64_t first, count; /* members */
    size_t header, record; /* bytes */
    char *bytes;           /* of a record */
    const unsigned char *map; /* the whole file; NULL: not mapped */
    size_t mapped;
    uint64_t reasons; /* written */
    /* Writes to the file, as pwrite does; NULL: pwrite. */
    bool (*write)(const void *bytes, size_t count, uint64_t at);
} store;

/* FILE.npy, or for task I of N (0: there are no tasks) FILE.I-of-N.npy; to be
   freed. */
char *store_name(const char *file, uint64_t task, uint64_t tasks);
/* Fills in what follows from the rest; all return TOOL_OK or, with a message,
   TOOL_USAGE. */
int store_create(store *, const char *name);
/* Opens a file that was left, whose settings must be the same. */
int store_resume(store *, const char *name);
/* Looks at a file that another process has opened. */
int store_attach(store *, const char *name);
/* The first member, and how many, of a file that is to be resumed. */
int store_range(const char *name, uint64_t *first, uint64_t *count);
/* The status of a member. */
/* The first record from the i-th on that is no hole of the file; those before are of
   members that are missing. */
uint64_t store_skip_hole(int file, uint64_t header, uint64_t record, uint64_t i,
                         uint64_t count);
uint64_t store_next(const store *, uint64_t i);
nevh_member_status store_status(const store *, uint64_t member);
int store_write(store *, const nevh_sweep_result *);
/* Sorts the reasons, where all members were run; makes it last. */
int store_finish(store *);
void store_close(store *); /* zeros are allowed */
/* Copies the records of a shard that is whole. */
int store_take(store *to, const char *shard, uint64_t first, uint64_t count);

#endif
