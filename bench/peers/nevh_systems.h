/* nevh: the bench's problems as systems.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_BENCH_SYSTEMS_H
#define NEVH_BENCH_SYSTEMS_H

#include "problems.h"
#include <nevh/nevh.h>

nevh_system *nevh_system_of(const problem *);
/* The same as formulas, which Taylor series need; coordinates in their order. */
nevh_scene *nevh_scene_of(const problem *);

#endif
