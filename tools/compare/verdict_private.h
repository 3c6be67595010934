/* nevh compare: the table in words.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VERDICT_PRIVATE_H
#define VERDICT_PRIVATE_H

#include "experiment/row.h"

/* verdict.c */
bool verdict_is(const row *, nevh_verdict);
/* "verlet at dt = 0.1", and the gradient where there are several. */
char *verdict_subject(const plan *, const row rows[], size_t count,
                      const row *);

/* Over the run, of the fitted line, which is no more than the errors that it is fitted to:
   about errors that jump, or end level, the line is steeper than they are. */
double verdict_drift(const plan *, const row *);

/* verdict_longer.c: what runs that are continued say of rows. */
/* The end of the run that a row's verdict is from. */
char *verdict_until(const plan *, const row *);
/* The outcome of a calm run when it is continued. */
void verdict_later_words(const plan *, const row rows[], size_t count,
                         const row *, list *words);
/* A row that even a longer run leaves open. */
void verdict_open_words(const plan *, const row rows[], size_t count,
                        const row *, list *words);
/* True if the longer run meets far larger energies. */
bool verdict_leaves(const row *);
/* Level errors of a run that are larger when it is continued. */
void verdict_larger_words(const plan *, const row rows[], size_t count,
                          list *words);
/* Which verdicts are not from the run alone. */
void verdict_followed_words(const plan *, const row rows[], size_t count,
                            list *words);

#endif
