/* nevh: kicks of steps by parts that turn oscillators.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TURN_PRIVATE_H
#define NEVH_TURN_PRIVATE_H

#include "work/work_private.h"

/* s of each coordinate that terms of B turn, or 0. */
typedef struct nevh__turns nevh__turns;
/* turns    out; NULL where B has none
   returns  NEVH_OK; NEVH_ENOMEM */
int nevh__turns_new(const nevh_field *, nevh__turns **turns);
void nevh__turns_free(nevh__turns *); /* NULL is allowed */
/* Adds to dz the kick over h of B with those slopes at q, p, n x width each: coordinates
   that are turned keep their actions. */
void nevh__turns_add(const nevh__turns *, size_t width, double h,
                     const double q[], const double p[], const double slope_q[],
                     const double slope_p[], double dq[], double dp[]);

#endif
