/* nevh: lines of a spectrum.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SPECTRUM_PRIVATE_H
#define NEVH_SPECTRUM_PRIVATE_H

#include <stdbool.h>
#include <stddef.h>

/* Samples of -1 ... 1, in units of half their length.  Rows are padded to vectors, by
   zeros and samples of no weight. */
typedef struct {
    size_t count, padded;
    double half; /* the time of half the length */
    double *values, *rest, *window, *time;
    double *rows; /* 1, waves of all lines, what moves change, and one more */
    size_t lines;
    double *w, *cosine, *sine; /* of each line: round the middle */
    double *move, *before;     /* by which w was last off; w before a line */
    double mean;
    size_t size;   /* of the transform, a power of 2 */
    double *power; /* size */
} nevh__spectrum;

/* Samples at times h apart, for `most` lines at most; false: memory is out. */
bool nevh__spectrum_open(nevh__spectrum *, double h, size_t count,
                         const double values[], size_t most);
void nevh__spectrum_close(nevh__spectrum *);
/* (1 + cos(pi x))^order, whose sum with the trapezoidal rule is exact. */
void nevh__spectrum_window(nevh__spectrum *, int order);
/* Finds lines, at most `most`; false: memory is out. */
bool nevh__spectrum_find_lines(nevh__spectrum *, size_t most);
/* The residual of all lines but `but`. */
void nevh__spectrum_take_off(nevh__spectrum *, size_t but);
/* The maximum of the square of the rest's transform between two frequencies;
   NAN: its derivative does not fall through 0 from one to the other. */
double nevh__spectrum_peak(const nevh__spectrum *, double low, double high);
/* The width of the window's peak on either side, in w. */
double nevh__spectrum_resolution(const nevh__spectrum *);
double nevh__spectrum_amplitude(const nevh__spectrum *, size_t i);

#endif
