/* nevh: what the parts of nevh recommend share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RECOMMEND_PRIVATE_H
#define NEVH_RECOMMEND_PRIVATE_H

#include "ladder.h"

typedef struct {
    search search;
    double target;
    bool named; /* by the user: those that keep any energy count, too */
    list gradients;
    ladder *ladder;
    size_t count;
    ladder *best, *second, *alone; /* alone: from values of H; or NULL */
} advice;

/* advice.c */
void advice_print(const advice *, const options *, FILE *);
/* Says why nothing keeps the target; TOOL_FAILED. */
int advice_none(const advice *);

#endif
