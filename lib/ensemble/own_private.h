/* nevh: members of an ensemble with systems of their own.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_OWN_PRIVATE_H
#define NEVH_OWN_PRIVATE_H

#include <nevh/ensemble.h>
#include <signal.h>

/* The constants, options and system of one member, if systems differ only in the
   constants of their terms; see nevh__ensemble_vary. */
typedef struct {
    const nevh_system *system;
    const nevh_options *options;
    const double *const *constants; /* of the ensemble's terms: count x nc */
} nevh__own;
/* Returns those of the member that was requested last; valid until the next call. */
typedef const nevh__own *(*nevh__own_fn)(void *data, uint64_t member);
/* The member cannot go beside others. */
typedef void (*nevh__refused_fn)(void *data, uint64_t member);

/* Members have systems of their own from now on, each with the terms of the
   ensemble's but for constants; that one is by_lane, and members are run side
   by side.  What is not run so is refused: those whose differences have other
   points, or whose stepper is not made.  Functions are called with the data
   of nevh_ensemble_run.
   returns  whether the ensemble can: it may have no more than orbits by kernels
            that own.c lists, their energies, and quantities that all share */
bool nevh__ensemble_vary(nevh_ensemble *, nevh__own_fn, nevh__refused_fn);
/* True if such an ensemble, but by_lane, can run members with constants of their
   own. */
bool nevh__ensemble_may_vary(const nevh_ensemble *);
/* And by compiled steps, where it has these. */
bool nevh__ensemble_may_vary_compiled(const nevh_ensemble *);

/* Orbits under way are left, soon, once *ending is not 0. */
void nevh__ensemble_set_stop(nevh_ensemble *,
                             const volatile sig_atomic_t *ending);

#endif
