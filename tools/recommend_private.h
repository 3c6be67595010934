/* nevh: what the parts of nevh recommend share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RECOMMEND_PRIVATE_H
#define NEVH_RECOMMEND_PRIVATE_H

#include "ladder.h"

typedef struct {
    search search;
    double target;
    double pilot, whole; /* ends of runs; NAN: there was no pilot */
    bool named; /* by the user: those that keep any energy count, too */
    list gradients;
    ladder *ladder;
    size_t count;
    ladder *best, *second;  /* with another integrator; NULL: none */
    ladder *alone, *steady; /* from values of H; without drift */
} advice;

/* advice.c */
enum { ADVICE_MOST = 4 };
/* The answers, each once, the best first; returns their number. */
size_t advice_list(const advice *, const ladder *found[ADVICE_MOST]);
void advice_print(const advice *, const options *, FILE *);
/* Says why nothing keeps the target; TOOL_FAILED. */
int advice_none(const advice *);

#endif
