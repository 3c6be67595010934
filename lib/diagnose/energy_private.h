/* nevh: the energies of orbits that begin and end apart.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENERGY_PRIVATE_H
#define NEVH_ENERGY_PRIVATE_H

#include <nevh/diagnose.h>
#include <nevh/gradient.h>

/* As nevh_energy_observe, with a time and a number of steps for each lane.
   on    in and out, width: the lanes to observe; false afterwards where a
         value of H, or a balance, is not finite, which stops no other lane */
void nevh__energy_observe_lanes(nevh_energy *, bool on[], const size_t step[],
                                const double t[], const double q[],
                                const double p[]);
/* For a system whose lanes have constants of their own: a lane takes those of each
   term, and the rounding and noise of a stepper of them. */
void nevh__energy_lane_take(nevh_energy *, size_t lane, const double *const c[],
                            const nevh_stepper *);
/* A lane takes the constants that another has. */
void nevh__energy_lane_copy(nevh_energy *, size_t from, size_t to);
/* The lane's next observation is its first. */
void nevh__energy_restart(nevh_energy *, size_t lane);

/* The energy error that theory predicts for the steps of that stepper, planned. */
nevh_theory nevh__theory_of(const nevh_stepper *);

#endif
