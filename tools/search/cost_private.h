/* nevh: what the parts of nevh cost share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_COST_PRIVATE_H
#define NEVH_COST_PRIVATE_H

#include "study.h"

enum { COST_TARGETS = 6 };
/* Said of friction, in the words and the picture. */
#define FRICTION_IS                                                            \
    "around a step is exact in the balance, though not in the orbit"
extern const double cost_target[COST_TARGETS];

typedef struct {
    search search;
    study *study;
    size_t count;
    double whole; /* t_end before it was shortened; NAN: as asked for */
    bool all; /* studies are shown, not only those that are cheap somewhere */
} costs;
/* True if its errors are comparable with those of other studies. */
bool costs_count(const costs *, const study *);
/* True if a failure is one of the command: schemes were named, or none ran. */
bool costs_fail(const costs *);
/* The cheapest level of a study for a target; NULL: none keeps it. */
const row *cost_cell(const study *, size_t target);
/* The study that takes least time; NULL: none keeps the target.
   gradients  of those that take gradients */
const study *costs_cheapest(const costs *, size_t target, bool gradients);
bool cost_is_yardstick(const study *);
bool cost_shows(const costs *, const study *);
/* True if it is shown, and has a place in pictures. */
bool cost_draws(const costs *, const study *);

/* cost_table.c */
table *cost_table(const costs *);
/* The reference is not good enough for these digits. */
bool cost_is_beyond(const costs *, size_t target);
/* The entry of the table if no step keeps the target: "-", "floor", ...; NULL: a
   step does. */
const char *cost_word(const costs *, const study *, size_t target);
/* No integrator that is shown has anything there: the column is left out. */
bool cost_is_empty(const costs *, size_t target);
/* The same run as for the target before. */
bool cost_repeats(const costs *, const study *, size_t target);
char *cost_milliseconds(double seconds);
bool cost_drifts(const study *); /* its energy */
/* cost_price.c: more levels, with other gradients. */
void cost_price(costs *, list *words);
/* cost_plot.c: as plot_write. */
int cost_plot(const options *, const costs *);
/* cost.c: the budget of work. */
double cost_budget(const options *);
/* cost_length.c: the whole command with --against length. */
int cost_lengths(const options *);
/* cost_words.c */
void cost_notes(const costs *, list *notes);
void cost_words(costs *, list *words);

#endif
