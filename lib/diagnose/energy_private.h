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
/* States side by side at several steps, `count` rows of values of H, so far apart: those
   at which nothing but the error is asked for.
   returns  how many of the first are: a state must be looked at from time to time, and
            where the error rises, or is not finite */
size_t nevh__energy_quiet(const nevh_energy *, const bool on[], size_t count,
                          const double h[], size_t pitch);
/* At most so many follow. */
size_t nevh__energy_most_quiet(const nevh_energy *, const bool on[]);
/* Observes them; step i is at t0 + (step + i) dt. */
void nevh__energy_observe_quiet(nevh_energy *, const bool on[],
                                const size_t step[], double t0, double dt,
                                size_t count, const double h[], size_t pitch);
/* Before the first observation: nothing but the largest error is asked for. */
void nevh__energy_ask_largest(nevh_energy *);
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
/* True if terms are functions in C, or formulas that may have kinks without such
   operations, as sqrt(x^2): only values tell. */
bool nevh__theory_doubts(const nevh_system *);

#endif
