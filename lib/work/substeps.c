/* nevh: when step control gives up.

   An orbit that ends in finite time stops substeps from shrinking only where
   they get as short as times can tell apart.  Where its slopes are noisy before
   that, trials neither fail nor arrive: they become slower as a power of their
   number, while near a mere pericentre some hundreds of them make a decade.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "work/work_private.h"
#include <stdio.h>

enum { FIRST = 10000, MOST_SLOWS = 2 };
static const double hopeless = 10.0 * NEVH__MOST_SUBSTEPS;

/* Looked at while their number doubles: whether the rest would take ten times
   as many as are allowed, and the pace falls to less than a half, twice. */
bool nevh__too_many(nevh__pace *pace, double length, double done,
                    char why[NEVH__WHY]) {
    if (pace->substeps == NEVH__MOST_SUBSTEPS) {
        snprintf(why, NEVH__WHY, "more than a million substeps");
        return true;
    }
    double next = pace->begun > 0 ? 2 * pace->begun : FIRST;
    if (pace->substeps++ < next)
        return false;
    double each = (done - pace->done) / (next - pace->begun);
    double rest = (length - done) / each;
    bool slow = rest > hopeless && each < pace->each / 2;
    pace->begun = next;
    pace->done = done;
    pace->each = each;
    pace->slows = slow ? pace->slows + 1 : 0;
    snprintf(why, NEVH__WHY,
             "ever shorter substeps (now %.2g; the rest would take %.0e of "
             "them: does the orbit end near by?)",
             each, rest);
    return pace->slows == MOST_SLOWS;
}
