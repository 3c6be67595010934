/* nevh: the frequencies in an orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FREQUENCIES_H
#define NEVH_FREQUENCIES_H

#include <nevh/status.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A line of a quasi-periodic function, amplitude cos(frequency t + phase). */
typedef struct {
    double frequency;        /* radians a unit of time, 0 or more */
    double amplitude, phase; /* t is 0 at the first sample */
    double
        error; /* of the frequency: an estimate, from a window of less order */
    double drift; /* the frequency in the second half less that in the first;
                     NAN where a half does not show the line */
} nevh_spectral_line;

/* Numerical analysis of fundamental frequencies [J. Laskar, The chaotic motion of
   the solar system, Icarus 88 (1990) 266-291; Introduction to frequency map
   analysis, in Hamiltonian Systems with Three or More Degrees of Freedom (1999)
   134-150].  A line is where the integral of the function times exp(-i w t) and a
   window is largest; lines are fitted together, taken off, and the next one is
   looked for; at the end each is refined with all others taken off.  For a
   quasi-periodic function the error falls with a high power of the length.

   h        time between samples
   values   `count` samples, at least 64
   lines    out, `most` of them, by amplitude, the largest first; the
            mean is taken off
   found    out: how many there are; fewer than `most` where the rest is below
            1e-12 of the largest value
   returns  NEVH_OK; NEVH_EINVAL for too few samples, or where h is not positive;
            NEVH_EDOM where a value is not finite; NEVH_ENOMEM
   cost     some hundred sums over the samples a line */
NEVH_API int nevh_frequencies(double h, size_t count, const double values[],
                              size_t most, nevh_spectral_line lines[],
                              size_t *found);

#ifdef __cplusplus
}
#endif
#endif
