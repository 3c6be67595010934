/* nevh: the frequencies in an orbit.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_FREQUENCIES_H
#define NEVH_FREQUENCIES_H

#include <nevh/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { NEVH_FEWEST_SAMPLES = 64 };

/* A line of a quasi-periodic function, amplitude cos(frequency t + phase). */
typedef struct {
    double frequency;        /* radians a unit of time, 0 or more */
    double amplitude, phase; /* t is 0 at the first sample */
    double error; /* of the frequency, an estimate: the largest of the drift,
                     the difference from a window of less order, and the last
                     move of Newton's method; the width of the peak where a half
                     or that window does not show the line */
    double drift; /* the frequency in the second half less that in the first;
                     NAN where a half does not show the line */
} nevh_spectral_line;

/* Numerical analysis of fundamental frequencies [J. Laskar, The chaotic motion of
   the solar system, Icarus 88 (1990) 266-291; Introduction to frequency map
   analysis, in Hamiltonian Systems with Three or More Degrees of Freedom (1999)
   134-150].  A line is where the integral of the function times exp(-i w t) and a
   window is largest; lines are fitted together with their frequencies, taken off,
   and the next one is looked for.  Two lines are told apart where they beat twice
   over the length.  For a
   quasi-periodic function the error falls with a high power of the length.

   h        time between samples
   values   `count` samples, at least NEVH_FEWEST_SAMPLES
   lines    out, `most` of them, by amplitude, the largest first; the
            mean is taken off
   found    out: how many there are; fewer than `most` where the rest is below
            1e-12 of the largest value.  Lines below 1e-8 of the largest one that
            the halves do not share are noise, and left out
   returns  NEVH_OK; NEVH_EINVAL for too few samples, or where h is not positive;
            NEVH_EDOM where a value is not finite; NEVH_ENOMEM
   cost     some hundred sums over the samples a line */
NEVH_API int nevh_frequencies(double h, size_t count, const double values[],
                              size_t most, nevh_spectral_line lines[],
                              size_t *found);

/* Samples of an orbit at equal times, for nevh_frequencies.  Each step is taken
   while there is room.  Where the room is full every second sample is left out
   and twice as many steps are between two from then on, if the lines in the
   faster half of the spectrum are below 1e-6 of the largest one.  Else what
   follows is not taken: frequencies are those of the first part of the run, and
   no fast line passes for a slow one.

   One thread at a time may use an object. */
typedef struct nevh_spectral_samples nevh_spectral_samples;

/* room     samples, at least NEVH_FEWEST_SAMPLES
   returns  to be freed with nevh_spectral_samples_free; NULL when memory is out, or for
            less room */
NEVH_API nevh_spectral_samples *nevh_spectral_samples_new(size_t room);
NEVH_API void
nevh_spectral_samples_free(nevh_spectral_samples *); /* NULL is allowed */

/* Forgets all samples. */
NEVH_API void nevh_spectral_samples_restart(nevh_spectral_samples *);

/* The value x after `step` steps, at t; calls come in order of steps.  A shorter
   last step is left out.  Allocates nothing. */
NEVH_API void nevh_spectral_samples_take(nevh_spectral_samples *, size_t step,
                                         double t, double x);

/* Samples of an angle that goes round once or more become their cosine, which is
   quasi-periodic; others stay as they are.  No sample may be taken afterwards.

   period   of the angle; 0: it is none
   returns  whether they have become a cosine */
NEVH_API bool nevh_spectral_samples_straighten(nevh_spectral_samples *,
                                               double period);

/* count    out: how many samples there are; NULL is allowed
   h        out: the time between two of them; NULL is allowed
   returns  the samples, until the next call; NULL where the object is NULL */
NEVH_API const double *
nevh_spectral_samples_values(const nevh_spectral_samples *, size_t *count,
                             double *h);

#ifdef __cplusplus
}
#endif
#endif
