/* nevh: a long run in few rows.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_THINNED_H
#define NEVH_THINNED_H

#include "cli/tool.h"

enum { THINNED_ROWS = 20001 };

/* Rows of numbers: of those that were seen all, or, where these are more than
   THINNED_ROWS, a part, spread over the run like multiples of the golden ratio
   modulo 1, so that no period of the orbit is met always at the same phases. */
typedef struct {
    size_t columns, count, seen;
    double part; /* 1, 1/2, 1/4, ... */
    double *row;
    size_t *number; /* of each row, in the run */
} thinned;

thinned thinned_new(size_t columns);
/* The place of the next row; NULL: the row is not needed. */
double *thinned_next(thinned *);

#endif
