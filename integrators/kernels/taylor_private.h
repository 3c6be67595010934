/* nevh: steps along Taylor series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TAYLOR_PRIVATE_H
#define NEVH_TAYLOR_PRIVATE_H

#include "taylor/series_private.h"
#include <float.h>
#include <nevh/extend.h>

extern const nevh_kernel nevh__taylor_kernel;

/* Compiled code of the coefficients, in place of the recurrences.
   numbers  those of the recurrence as doubles, borrowed
   watched  out: as nevh__series_watched_double
   differs  borrowed, and set once the code gives other digits than the recurrence,
            which is taken then */
typedef int nevh__series_code(const double numbers[], double t,
                              const double state[], double rows[],
                              double watched[]);

/* Numbers of a chain before its rows, and how many orders have digits that doubles
   lose. */
enum { NEVH__TAYLOR_HEAD = 5, NEVH__TAYLOR_FIRST = 8 };

/* True if long doubles have 64 bits.  Elsewhere, where they are doubles, or a hundred
   times as slow, doubles are used. */
enum { NEVH__TAYLOR_LONGER = LDBL_MANT_DIG == 64 };

typedef struct {
    nevh__recurrence *recurrence;
    nevh__series_double *series;
    size_t order;
    nevh__series_long *first; /* of low orders; NULL: doubles will do */
    long double *first_rows;
    double longest;          /* of a series, in steps of the caller's */
    nevh__series_code *code; /* NULL: there is none */
    const double *numbers;
    double *watched; /* what it watched last; order times n_watched */
    bool *differs;   /* the code, from the recurrence */
    size_t compared; /* series */
} nevh__taylor_plan;

/* The series of one lane, in memory or scratch. */
typedef struct {
    double *begun;          /* whether there is a series */
    double *since;          /* time since its beginning, of either sign, */
    double *since_roundoff; /* and what that lost */
    double *reach;          /* how long it holds, to either side */
    double *unit;           /* of time, in rows and lost: a power of two */
    double *roundoff;       /* 2n: of the state at its beginning */
    double *rows;           /* 2n times order + 1: its coefficients */
    double
        *lost; /* 2n times NEVH__TAYLOR_FIRST: what those of low orders lost */
} nevh__taylor_chain;

static inline size_t nevh__taylor_chain_size(size_t n,
                                             const nevh__taylor_plan *plan) {
    return NEVH__TAYLOR_HEAD +
           2 * n * (plan->order + 2 + (plan->first ? NEVH__TAYLOR_FIRST : 0));
}

/* As of a kernel. */
int nevh__taylor_plan_new(nevh_work *);
void nevh__taylor_clear(nevh_work *);

/* Takes up to `steps` steps, as nevh__native_run; of the states between them none is
   evaluated. */
size_t nevh__taylor_run(nevh_work *, double t0, double h, size_t from,
                        size_t steps, double q[], double p[]);
const nevh__recurrence *nevh__taylor_recurrence(const nevh_work *,
                                                size_t *order);
void nevh__taylor_use(nevh_work *, nevh__series_code *, const double numbers[],
                      bool *differs);

#endif
