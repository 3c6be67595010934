/* nevh: steps along Taylor series.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TAYLOR_PRIVATE_H
#define NEVH_TAYLOR_PRIVATE_H

#include "taylor/series_private.h"
#include <nevh/extend.h>

extern const nevh_kernel nevh__taylor_kernel;

/* What coefficients are of; and compiled code that takes them, instead of the
   recurrences.
   numbers  those of the recurrence as doubles, borrowed
   watched  out: as nevh__series_watched_double
   differs  borrowed, and set once the code gives other digits than the recurrence,
            which is taken then */
typedef int nevh__series_code(const double numbers[], double t,
                              const double state[], double rows[],
                              double watched[]);
const nevh__recurrence *nevh__taylor_recurrence(const nevh_work *,
                                                size_t *order);
void nevh__taylor_use(nevh_work *, nevh__series_code *, const double numbers[],
                      bool *differs);

#endif
