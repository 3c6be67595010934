/* nevh: what the parts of nevh recommend share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RECOMMEND_PRIVATE_H
#define NEVH_RECOMMEND_PRIVATE_H

#include "study.h"

typedef struct {
    search search;
    double target;
    double pilot, whole; /* ends of runs; NAN: there was no pilot */
    bool named; /* by the user: those that keep any energy count, too */
    list gradients;
    study *study;
    size_t count;
    study *best, *second;  /* with another integrator; NULL: none */
    study *alone, *steady; /* from values of H; without drift */
    double period;         /* the shortest that the orbit has; NAN: unknown */
    double longer;         /* the end to which promises were followed */
    char *not_longer;      /* why they were not; NULL */
} advice;

/* recommend_search.c */
void advice_take_gradients(advice *, const options *);
/* Follows studies to ever finer levels, until the cheapest that keep the target
   are known and timed. */
void advice_search(advice *);
/* The cheapest level of a study that keeps the target, if it counts; NULL:
   none does. */
const row *advice_keeps(const advice *, const study *);
/* The study that took least time, of those that keep the target, were timed and
   are not taken; NULL: there is none. */
study *advice_next_best(const advice *, const bool taken[]);
/* Times what may be an answer once; the best ones again. */
void advice_time_once(advice *);
void advice_time_best(advice *);
/* Which studies the answers are. */
void advice_choose(advice *);

/* promise.c: the answers on the whole run, against a reference, and for how
   long they keep the target in one three times as long. */
void advice_follow(advice *, plan *);
/* The time until which an answer keeps the target; INFINITY: to the end of the
   longer run; NAN: unknown. */
double advice_holds(const row *);

/* advice.c */
enum { ADVICE_MOST = 4 };
/* The answers, each once, the best first; returns their number. */
size_t advice_list(const advice *, const study *found[ADVICE_MOST]);
void advice_print(const advice *, const options *, FILE *);
/* Says why nothing keeps the target; TOOL_FAILED. */
int advice_none(const advice *);

#endif
