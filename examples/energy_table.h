/* One row of an energy-error table, for the examples that print one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENERGY_TABLE_H
#define ENERGY_TABLE_H

#include <nevh/nevh.h>

typedef struct {
    int status;
    nevh_energy_report energy;
    nevh_counts counts;
    double seconds; /* CPU time of stepping, measured in a run nobody watches */
} row;

/* Runs from (q, p) to t_end, gradients by central4, and prints the row, or why
   there is none. */
row energy_row(const nevh_system *, const nevh_integrator *, const double q[],
               const double p[], double dt, double t_end);
/* The line above the rows. */
void energy_header(void);

#endif
