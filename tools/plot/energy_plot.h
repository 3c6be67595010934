/* nevh: energy errors against time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENERGY_PLOT_H
#define NEVH_ENERGY_PLOT_H

#include "experiment/envelope.h"
#include "plot.h"

/* A plot, or one more panel. */
plot *energy_plot_new(const plan *, const char *title, const char *heading);
void energy_plot_panel(plot *, const plan *, const char *heading);
/* The scale of the errors, and the steps per point, in words.
   turns  of the motion in the run; 0: not known */
char *energy_plot_words(const plan *, double turns);
/* The name of an axis of largest errors. */
const char *energy_plot_largest(const plan *);
/* A line in the current panel; name: NULL is none. */
void energy_plot_add(plot *, const plan *, double turns, const char *name,
                     const char *integrator, const envelope *);

#endif
