/* nevh: what the parts of nevh cost share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COST_PRIVATE_H
#define NEVH_COST_PRIVATE_H

#include "ladder.h"

enum { COST_TARGETS = 6 };
extern const double cost_target[COST_TARGETS];

typedef struct {
    search search;
    ladder *ladder;
    size_t count;
    double whole; /* t_end before it was shortened; NAN: as asked for */
    bool all; /* ladders are shown, not only those that are cheap somewhere */
} costs;
/* Whether its errors are to be compared with others'. */
bool costs_count(const costs *, const ladder *);
/* NULL: none keeps the target. */
const ladder *costs_cheapest(const costs *, double target);
bool cost_is_yardstick(const ladder *);
bool cost_shows(const costs *, const ladder *);

/* cost_table.c */
table *cost_table(const costs *);
/* The reference is not good enough for these digits. */
bool cost_is_beyond(const costs *, size_t target);
char *cost_milliseconds(double seconds);
bool cost_drifts(const ladder *); /* its energy */
/* cost_price.c: more rungs, with other gradients. */
void cost_price(costs *, list *words);
/* cost_plot.c: as plot_write. */
int cost_plot(const options *, const costs *);
/* cost_words.c */
void cost_notes(const costs *, list *notes);
void cost_words(costs *, list *words);

#endif
