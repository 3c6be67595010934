/* nevh: errors against the step or the length of the run, with slopes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ORDER_PLOT_H
#define NEVH_ORDER_PLOT_H

#include "experiment/row.h"
#include "plot.h"

/* Takes five steps where none are given, each half of the one before, and a run of 200 of
   the longest, unless its end is given. */
void order_plot_steps(const options *, plan *);
/* Before the long work.
   steps    how many each scheme is to have
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int order_plot_check(const options *, size_t steps);
/* The axis that errors are drawn against. */
typedef enum { ORDER_DT, ORDER_LENGTH } order_axis;
/* A panel for each kind of error that the rows have; as plot_write. */
int order_plot(const options *, const plan *, const row rows[], size_t count,
               order_axis);

#endif
