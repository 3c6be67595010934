/* nevh: portraits: orbits over level curves of H.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PORTRAIT_H
#define NEVH_PORTRAIT_H

#include "ensemble/members.h"
#include "plot/plot.h"

typedef struct {
    double low_x, high_x, low_y, high_y;
} portrait_window;

/* A zero of dH, for one degree of freedom. */
typedef struct {
    double x, y, energy;
    double distance; /* from the start, in parts of the window */
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
    bool curve, many; /* degenerate ones fill it; there may be more */
} levels;
/* Exact, or by differences; the caller looks at its status. */
nevh_field *levels_field(const plan *);
int levels_new(levels *, const plan *, portrait_window);
/* Level curves through these energies, and through the saddles; the first panel
   names what is in the legend. */
void levels_draw(const levels *, plot *, const double energy[], size_t count);
/* portrait_equilibria.c, of plan, window and field alone: all of the window, those near the start first; of
   degenerate ones that fill a curve, one. */
void levels_find_equilibria(levels *);
double levels_energy(const levels *, double x, double y);

/* section.c: a panel, the points of the first section of all members by one
   integrator. */
int section_panel(plot **, const plan *, const options *,
                  const char *integrator);

#endif
