/* nevh: the frequencies in an orbit, without their errors.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FREQUENCIES_PRIVATE_H
#define NEVH_FREQUENCIES_PRIVATE_H

#include <nevh/frequencies.h>

/* The frequency of the largest of the lines, at most `most`, that nevh_frequencies
   finds; NAN where there is none.  Errors take most of its time. */
double nevh__main_frequency(double h, size_t count, const double values[],
                            size_t most);

#endif
