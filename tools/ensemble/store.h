/* nevh sweep: a file of records.

   FILE.npy is one structured array of NumPy's format: a header of fixed length,
   then a record a member: a status byte, 7 bytes of a digest of the record, a double
   a column.  A record is written with status 0 first and its status after that, so
   that a process that is killed leaves records that are whole or not there; one that
   was damaged since then is not there.  All space is taken from the disk at first.
   FILE.npy.txt says what it was made from, and why members are not done.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_STORE_H
#define NEVH_STORE_H

#include "cli/tool.h"
#include <nevh/sweep.h>
#include <pthread.h>

/* Records that were read together. */
typedef struct {
    pthread_mutex_t lock; /* threads ask for members */
    unsigned char *bytes;
    uint64_t first, count; /* records of the file */
} store_block;

typedef struct {
    char *name, *side; /* FILE.npy, FILE.npy.txt */
    int file;
    output array, text; /* until they are settled */
    bool waits;
    const char *place; /* of the side file now */
    const list *columns;
    const char *settings;  /* lines NAME: VALUE; what a resumed sweep shares */
    const char *story;     /* what else the side file begins with */
    uint64_t first, count; /* members */
    size_t header, record; /* bytes */
    unsigned char *bytes;  /* of a record */
    store_block block;
    uint64_t reasons; /* written */
    uint64_t damaged; /* records that were read */
    /* Writes to the file, as pwrite does; NULL: pwrite. */
    bool (*write)(const void *bytes, size_t count, uint64_t at);
} store;

/* Fills in what follows from the rest; all return TOOL_OK or, with a message,
   TOOL_USAGE. */
int store_create(store *, const char *name);
/* Replaces an earlier file by the one created. */
int store_settle(store *);
/* Opens a file that was left, whose settings must be the same. */
int store_resume(store *, const char *name);
/* Looks at a file that another process has opened. */
int store_attach(store *, const char *name);
/* The first member, and how many, of a file that is to be resumed. */
int store_range(const char *name, uint64_t *first, uint64_t *count);
/* The status of a member; `values`, unless NULL, become its columns. */
nevh_member_status store_read(store *, uint64_t member, double values[]);
/* The first record from the i-th on that is no hole of the file; those before are of
   members that are missing. */
uint64_t store_skip_hole(int file, uint64_t header, uint64_t record, uint64_t i,
                         uint64_t count);
uint64_t store_next(const store *, uint64_t i);
int store_write(store *, const nevh_sweep_result *);
/* Sorts the reasons, where all members were run; makes it last. */
int store_finish(store *);
void store_close(store *); /* zeros are allowed */
/* Copies the records of a shard that is whole. */
int store_take(store *to, const char *shard, uint64_t first, uint64_t count);

/* store_record.c: the header, records, and blocks of them. */
enum { STORE_BEFORE_TEXT = 12 }; /* bytes of a header */
/* The header, as long as s->header says, which is set. */
char *store_header(store *);
void record_write(const store *, unsigned char record[],
                  const nevh_sweep_result *);
/* MISSING where the record is not as it was written. */
nevh_member_status record_read(const store *, const unsigned char record[],
                               uint64_t member, double values[]);
/* A block with record i of the file; false with errno where it cannot be read. */
bool block_reach(store_block *, int file, uint64_t header, size_t record,
                 uint64_t all, uint64_t i);

#endif
