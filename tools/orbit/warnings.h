/* nevh: warnings of runs that go wrong, from trials with their own steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_WARNINGS_H
#define NEVH_WARNINGS_H

#include "experiment/trial_run.h"

/* passage_warnings.c: sentences of both kinds, without "Warning:" and full stop.  The
   first kind: for each dt, the schemes of which a few steps on the orbit have an energy
   error above a tenth of its scale, and a step that keeps it small.  Rows that ran
   without such an error are not tried, nor unstable ones.
   ahead  NULL: made where it is needed
   cost   16 steps a row at each of nine places; for the step, 4096 steps a row at
          each of them at most */
list warnings_of(const plan *, const trial_run *ahead, const row rows[],
                 size_t count);
/* The same with both. */
void warnings_words(const plan *, const trial_run *ahead, const row rows[],
                    size_t count, list *words);
/* saddle_warnings.c: for one degree of freedom, H = T(p) + V(q), without time and
   friction: rows whose steps carry the orbit over a saddle of larger energy, or turn it
   back before one of smaller energy, and a step that does not.  Rows that ran with
   errors far below the gap are not tried.
   cost   a search for equilibria as in nevh portrait; a run of 2e5 steps a row at most,
          and for the step five such runs a row that is warned of */
void saddle_warnings(const plan *, const row rows[], size_t count, list *found);

#endif
