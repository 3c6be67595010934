/* nevh: portraits: orbits over level curves of H.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PORTRAIT_H
#define NEVH_PORTRAIT_H

#include "ensemble/members.h"
#include "plot/plot.h"

typedef struct {
    double low_x, high_x, low_y, high_y;
} portrait_window;

/* Where dH is 0, of one degree of freedom. */
typedef struct {
    double x, y, energy;
    enum {
        PORTRAIT_CENTRE,
        PORTRAIT_SADDLE,
        PORTRAIT_DEGENERATE,
        PORTRAIT_KINDS
    } kind;
} equilibrium;

/* portrait_levels.c: H at t_start over a window, from its values alone. */
typedef struct {
    const plan *plan;
    portrait_window window;
    double *h; /* on a grid; NAN where H is not finite */
    nevh_field *field;
    equilibrium *found;
    size_t count;
} levels;
int levels_new(levels *, const plan *, portrait_window);
void levels_free(levels *);
/* Level curves through these energies, and through the saddles; the first panel
   names what is in the legend. */
void levels_draw(const levels *, plot *, const double energy[], size_t count);
double levels_energy(const levels *, double x, double y);

/* section.c: a panel, the points of the first section of all members by one
   integrator. */
int section_panel(plot **, const plan *, const options *,
                  const char *integrator);

#endif
