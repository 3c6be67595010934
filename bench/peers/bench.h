/* nevh: a contest and its results.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_BENCH_H
#define NEVH_BENCH_H

#include "peer.h"
#include <stdio.h>

enum {
    TARGETS = 4,
    MOST_ROUNDS = 25,
    MOST_LIBRARIES = 10,
    MOST_ENTRIES = 2000
};
extern const double targets[TARGETS]; /* of the state error, 1e-3 first */

/* A method with the setting that is just good enough. */
typedef struct {
    const problem *problem;
    const library *library;
    const method *method;
    size_t target;
    double setting, error;
    size_t runs, rounds; /* runs of a turn; rounds measured */
    double seconds[MOST_ROUNDS], median, spread; /* of one run */
} entry;

typedef struct {
    const library *libraries[MOST_LIBRARIES];
    size_t library_count;
    entry entries[MOST_ENTRIES];
    size_t count, rounds;
} contest;

/* Made ready, run once and put away: the error, INFINITY where it failed, and
   its CPU seconds. */
double one_run(const library *, const method *, const problem *, double setting,
               const double ranges[], double *seconds);
/* All entries of a problem. */
void find_entries(contest *, const problem *, const double ranges[],
                  double longest);
/* `rounds` turns of each entry of a problem, one after another. */
void play(contest *, const problem *);

/* The library's fastest at a target; NULL if none gets there. */
const entry *fastest(const contest *, const library *, const problem *,
                     size_t target);
/* The fastest of all that are not nevh and run in this process. */
const entry *fastest_peer(const contest *, const problem *, size_t target);
/* The median over the rounds of a's time over b's. */
double ratio(const entry *a, const entry *b);

/* What the results hold for. */
typedef struct {
    const char *commit, *compiler, *flags, *missing;
} circumstances;
void write_csv(FILE *, const contest *, const circumstances *);
void write_markdown(FILE *, const contest *, const circumstances *);
/* The processor's name, as Linux tells it. */
const char *processor(void);

#endif
