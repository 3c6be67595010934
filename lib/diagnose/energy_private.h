/* nevh: the energies of orbits that begin and end apart.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENERGY_PRIVATE_H
#define NEVH_ENERGY_PRIVATE_H

#include <nevh/diagnose.h>

/* As nevh_energy_observe, with a time and a number of steps for each lane.
   on    in and out, width: the lanes to observe; false afterwards where a
         value of H, or a balance, is not finite, which stops no other lane */
void nevh__energy_observe_lanes(nevh_energy *, bool on[], const size_t step[],
                                const double t[], const double q[],
                                const double p[]);
/* The lane's next observation is its first. */
void nevh__energy_restart(nevh_energy *, size_t lane);

#endif
