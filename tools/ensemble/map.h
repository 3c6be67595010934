/* nevh sweep --picture: an outcome over what is varied.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_MAP_H
#define NEVH_MAP_H

#include "experiment/plan.h"
#include <nevh/sweep.h>

typedef struct map map;
/* Creates the picture of --picture; without it *made is NULL.
   returns  TOOL_OK, or TOOL_USAGE with the message printed */
int map_new(map **made, const options *, const plan *, const nevh_sweep *);
/* A member's values: what is varied, then outcomes; nothing for NULL. */
void map_take(map *, uint64_t member, nevh_member_status,
              const double values[]);
/* returns  TOOL_OK, also for NULL, or TOOL_USAGE with the message printed */
int map_draw(map *, const char *integrator);

#endif
