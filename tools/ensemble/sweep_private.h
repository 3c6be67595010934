/* nevh sweep: what rows of CSV and an array share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SWEEP_PRIVATE_H
#define NEVH_SWEEP_PRIVATE_H

#include "experiment/plan.h"
#include "map.h"
#include "ranks.h"
#include "store.h"

typedef struct {
    const options *options;
    plan plan;
    const char *integrator;
    nevh_sweep *sweep;
    map *map; /* NULL: no picture */
    list notes, columns;
    output out;
    store store; /* of an array */
    ranks ranks;
    size_t threads;
    uint64_t count, failed, startless, told;
    char *why;          /* of the first that is not done, */
    uint64_t first;     /* which that is */
    bool fails;         /* rather than has no start */
    uint64_t undefined; /* members that are done, and an outcome has no value */
    const char *outcome; /* the first of these */
    double begun, shown;
} sweep_job;

/* Members are run between these; seconds count from the first. */
void sweep_begin(sweep_job *);
/* A member is done: it counts, and progress is shown. */
void sweep_count(sweep_job *, const nevh_sweep_result *);
/* The outcomes of a member that is done: whether any is undefined. */
void sweep_check_values(sweep_job *, const double values[]);
/* On stderr, where there are such. */
void sweep_tell_undefined(const sweep_job *);
/* status   of nevh_sweep_run
   returns  TOOL_OK, also where the run was stopped, or TOOL_USAGE with the
            message printed */
int sweep_end(const sweep_job *, int status);
/* Runs the members into FILE.npy, or joins its parts, and draws the picture.
   returns  the exit status, with its message printed */
int sweep_array(sweep_job *);

#endif
