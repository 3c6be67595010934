/* nevh frequencies: sentences about columns.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FREQUENCIES_PRIVATE_H
#define NEVH_FREQUENCIES_PRIVATE_H

#include "cli/tool.h"
#include <nevh/frequencies.h>

/* Refuses a column that grows steadily, which is no sum of oscillations.
   returns  true if it does, with the reason in the words */
bool frequencies_line_words(list *words, const char *integrator,
                            const char *name, const double x[], size_t count,
                            double h);
/* Notes that only the beginning of the run is analysed, when samples of all of it
   do not fit. */
void frequencies_length_words(list *words, const char *integrator,
                              const char *name, double length, double run);
/* Notes that the first frequency moves, or is not in both halves of the run. */
void frequencies_drift_words(list *words, const char *integrator,
                             const char *name, const nevh_spectral_line *);

#endif
