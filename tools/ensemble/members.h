/* nevh: the starts of an ensemble, for pictures.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_MEMBERS_H
#define NEVH_MEMBERS_H

#include "experiment/plan.h"

/* The members that have a start. */
typedef struct {
    size_t n, count, startless;
    bool several;     /* there is an ensemble; else it is the plan's start */
    size_t *number;   /* count: which member it is */
    double *q, *p;    /* count x n, member by member */
    char *why;        /* the first has none; or NULL */
    double low, high; /* of their energies at the start; NAN: not known */
} members;
/* Refuses --set and --start of what [ensemble] or --vary gives to each member. */
int members_check(const plan *, const options *);
/* returns  TOOL_OK, or TOOL_USAGE with the message printed */
int members_read(members *, const plan *);
/* Reports members without a start: TOOL_FAILED if there are some. */
int members_tell(const members *, const plan *);
void members_note(const members *, list *notes);
/* "start phi = 0.3": the first coordinate or momentum in which members differ, as a
   key.  NULL where they are one, or too many for a key. */
char *members_start(const members *, const plan *, size_t i);
/* Notes that points of a section lie on several surfaces of energy. */
void members_note_energies(const members *, const plan *, list *notes);

#endif
