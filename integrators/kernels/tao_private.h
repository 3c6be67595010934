/* nevh: inside Tao's schemes.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TAO_PRIVATE_H
#define NEVH_TAO_PRIVATE_H

#include "gradient/step_selection_private.h"
#include <nevh/extend.h>

/* The part of h that step i of the 2 count + 1 of a NEVH_COMPOSITION takes, as
   a time; its `first` does not matter. */
double nevh__composition_part(const nevh_splitting *, size_t i, double h);

enum { NEVH__TAO_MOST_WEIGHTS = 17 }; /* of a table */

/* The binding of the two copies. */
typedef struct {
    double omega;
    double *ratio; /* n: lengths of p over lengths of q */
    double weights[NEVH__TAO_MOST_WEIGHTS];
    double known_h; /* of which the following are */
    double lengths[3 * (2 * NEVH__TAO_MOST_WEIGHTS + 1)];
} nevh__binding;

/* Chooses both; a status, of which work keeps the message. */
int nevh__binding_choose(nevh_work *, nevh__binding *);

/* Adds states of a run from each lane to the samples; false when memory is
   out. */
bool nevh__add_run(nevh__step_selection *);

/* The rows of a stepper's memory, in blocks of n. */
enum {
    NEVH__TAO_COMPENSATION_Q, /* of the first copy */
    NEVH__TAO_COMPENSATION_P,
    NEVH__TAO_X, /* the second copy less the first: x - q and y - p */
    NEVH__TAO_Y,
    NEVH__TAO_DH_DQ, /* the gradient at (q, y), where the next step begins */
    NEVH__TAO_DH_DP,
    NEVH__TAO_BLOCKS /* then one row: whether there is such a gradient */
};

extern const nevh_kernel nevh__tao_kernel; /* its table composes */

#endif
