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
    double period_at;      /* when it has that */
    double longer;         /* the end of the longer runs */
    char *not_longer;      /* why there are none; NULL */
} recommendation;

/* recommend_search.c */
void recommend_take_gradients(recommendation *, const options *);
/* Follows studies to ever finer levels, until the cheapest that keep the target
   are known and timed. */
void recommend_search(recommendation *);
/* True if its errors are comparable with those of other studies. */
bool recommend_counts(const recommendation *, const study *);
/* The cheapest level of a study that keeps the target; NULL: none does. */
row *recommend_chosen(const recommendation *, const study *);
/* The same of a study that counts, else NULL. */
row *recommend_keeps(const recommendation *, const study *);
/* The study that took least time, of those that keep the target, were timed and
   are not taken; NULL: there is none.  By the shortest times, which other work of the
   machine lengthens least; where these are alike, one without drift, of least work. */
study *recommend_next_best(const recommendation *, const bool taken[]);
/* Times what may be an answer once; the best ones again. */
void recommend_time_once(recommendation *);
void recommend_time_best(recommendation *);
/* Which studies the answers are. */
void recommend_choose(recommendation *);

/* recommend_longer.c: the answers on the whole run, against a reference, and for how
   long they keep the target in one three times as long. */
void recommend_follow(recommendation *, plan *);
/* The time until which an answer keeps the target; INFINITY: to the end of the
   longer run; NAN: unknown. */
double recommend_holds(const row *);

/* recommend_words.c */
enum { RECOMMEND_MOST = 4 };
/* The answers, each once, the best first; returns their number. */
size_t recommend_list(const recommendation *,
                      const study *found[RECOMMEND_MOST]);
void recommend_print(const recommendation *, const options *, FILE *);
/* Says why nothing keeps the target; TOOL_FAILED. */
int recommend_none(const recommendation *);

#endif
