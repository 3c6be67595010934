/* nevh: the stages of one orbit as vectors.
   SPDX-License-Identifier: GPL-3.0-or-later

   A row is what belongs to one variable, a number a stage.  In the stage
   equations rows follow each other closely; here those that are written have
   room for whole vectors, `stride` numbers.  Weights are stages x stride, and 0
   in the room behind the stages, so that what is written there is as good a
   state as any. */
#ifndef NEVH_STAGE_ROWS_PRIVATE_H
#define NEVH_STAGE_ROWS_PRIVATE_H

#include "tableau_private.h"

typedef struct {
    size_t count, stages, stride;
} nevh__rows;

/* points[i] = y + (sum_j weights[j][i] (hb[j] slopes[j]) + carry), for each
   row: y, carry are one number a row. */
void nevh__rows_combine(const nevh__rows *, const double weights[],
                        const double hb[], const double slopes[],
                        const double y[], const double carry[],
                        double points[]);
/* out[i] = sum_j weights[j][i] slopes[j] */
void nevh__rows_multiply(const nevh__rows *, const double weights[],
                         const double slopes[], double out[]);
/* x = -x */
void nevh__rows_negate(const nevh__rows *, double x[]);
/* sum + lost += sum_j hb[j] slopes[j] with compensation, small weights first;
   count is a multiple of width, slopes are (count / width) x stages x width. */
void nevh__rows_sum(const nevh__tableau *, size_t count, size_t width,
                    const double hb[], const double slopes[], double sum[],
                    double lost[]);
/* Takes `count` rows with room behind them to rows without. */
void nevh__rows_close(const nevh__rows *, size_t count, const double from[],
                      double to[]);

#endif
