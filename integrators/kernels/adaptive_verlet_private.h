/* nevh: Verlet with steps that vary.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ADAPTIVE_VERLET_PRIVATE_H
#define NEVH_ADAPTIVE_VERLET_PRIVATE_H

#include <nevh/extend.h>

/* The table. */
typedef struct {
    bool reversible; /* the density is integrated; else s is taken as it is */
} nevh__step_control;
extern const nevh_kernel nevh__adaptive_verlet_kernel;
/* The units of coordinates, and of momenta, in which |f| is taken. */
double nevh__adaptive_verlet_units(const nevh_work *, double *unit_p);

#endif
