/* nevh: when step control gives up.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "work/work_private.h"
#include "system/print_private.h"
#include <stdio.h>

bool nevh__too_many(nevh__pace *pace, double length, double done,
                    char why[NEVH__WHY]) {
    bool most = pace->substeps == NEVH__MOST_SUBSTEPS;
    bool stops = nevh__pace_count(pace, length, done);
    if (most)
        snprintf(why, NEVH__WHY, "more than a million substeps");
    else if (stops)
        nevh__print(
            why, NEVH__WHY,
            "ever shorter substeps (now %.2g; the rest would take %.0e of "
            "them: does the orbit end near by?)",
            pace->each, (length - done) / pace->each);
    return stops;
}
