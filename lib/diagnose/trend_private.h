/* nevh: does a series grow?
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TREND_PRIVATE_H
#define NEVH_TREND_PRIVATE_H

#include <nevh/diagnose.h>

/* The series is kept as bins of equally many samples; when all are full,
   neighbours are merged.  So any length takes the same memory, and there are
   always between NEVH__BINS / 2 and NEVH__BINS of them in a long run. */
enum { NEVH__BINS = 200 };

typedef struct {
    double t, e;            /* sums of time and error */
    double lowest, highest; /* errors */
    double least;           /* |error| */
    double met;             /* energies, up to its end */
    size_t samples;
} nevh__bin;

typedef struct {
    size_t samples, bins, per_bin; /* per_bin: samples of a full bin */
    double squares, most, last, first_t, last_t;
    double mean_t, mean_e, tt, te; /* for the straight line */
    nevh__bin bin[NEVH__BINS];
} nevh__trend;

/* met  the largest energies so far, in units of the errors' scale */
void nevh__trend_add(nevh__trend *, double t, double e, double met);
/* So many errors, of whose series nothing is asked but the largest. */
void nevh__trend_add_most(nevh__trend *, size_t samples, double most,
                          double last);
/* The same series, errors and energies times a factor. */
void nevh__trend_multiply(nevh__trend *, double factor);
/* Fills the report's members on the series, from samples to straightness, rate,
   least, gone, grown and relative. */
void nevh__trend_report(const nevh__trend *, nevh_energy_report *);

#endif
