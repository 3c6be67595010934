/* nevh: how a field chooses its difference steps.
   SPDX-License-Identifier: GPL-3.0-or-later

   A step must suit the states of the run, of which at most the start is known.
   So the plan looks around, in three parts:

   lengths.c  how far may each variable move before H is no longer quadratic in
              it?  Found by doubling, without any idea of the user's units.
              Where H is quadratic in a variable (a momentum, often), the
              length is that over which H varies as much as over the others.
   rest.c     the same of an orbit from rest at 0, where nothing has a length.
   pilot.c    states to try steps at: those given; some of a coarse adaptive
              run from there, so that a pericentre is seen before it is
              reached; and a few displaced at random by a part of those
              lengths, because at an equilibrium, or where a momentum is
              exactly zero, H hides how it varies.
   step_scan.cfor each variable of each term, powers of two as steps, at all
              those states: the one whose worst error, by estimate, is least. */
#ifndef NEVH_STEP_SELECTION_PRIVATE_H
#define NEVH_STEP_SELECTION_PRIVATE_H

#include "gradient/field_private.h"

/* The number of instances, or of variables of an instance, that are probed in large
   terms; each of the others takes the step of the last one probed before it. */
enum { NEVH__PROBED = 64 };

/* States, n doubles of q and of p each. */
enum { NEVH__MOST_SAMPLES = 32 };
typedef struct {
    size_t count, most;
    double t[NEVH__MOST_SAMPLES + 1];
    double *q, *p; /* (most + 1) x n: the last one is nevh__verify's
                      and nevh__sizes_from_start's */
    double
        *largest; /* most x 2n: sizes at most on the pilot's way to a sample */
} nevh__samples;

/* The state of planning. */
typedef struct {
    nevh_field *field;
    const nevh_options *options;
    double *length; /* 2n */
    size_t
        *component; /* of each coordinate, and its momentum: of those that terms
                          connect; energies are looked for in each */
    nevh__samples samples;
    size_t lanes;        /* of them, given by the user: the first ones */
    size_t at;           /* the one whose lengths are looked for */
    bool shortened;      /* a length, there */
    const double *sizes; /* 2n: of the orbit, while lengths are found */
    size_t neighbours;   /* the first sample displaced at random */
    bool scales_alone; /* no steps are tried: the pilot ends with the scales */
} nevh__step_selection;

/* A variable of an instance, or the time, along which values are taken. */
#define NEVH__TIME SIZE_MAX
typedef struct {
    const nevh__step_selection *e;
    const nevh__planned *term;
    size_t instance, k;
} nevh__axis;

/* Distances between the instances, and between the variables of one kind, that
   are looked at. */
size_t nevh__stride(size_t count);
/* The variable whose step variable k takes. */
size_t nevh__probed(const nevh__planned *, size_t k);

/* Values at sample `at`, moved along an axis by each of `count` (up to the field's
   capacity) amounts; x: what was moved. */
void nevh__sample_line(const nevh__axis *, size_t at, size_t count,
                       const double move[], double x[], double h[]);
/* The largest effect of rounding on an instance's value at a sample: for a formula,
   the rounding of all its operations; for other code, that of its value h. */
double nevh__sample_rounding(const nevh__axis *, size_t at, double move,
                             double h);

/* Takes the states given and fills length; a status, recorded in the field. */
int nevh__step_selection_init(nevh__step_selection *, nevh_field *,
                              const nevh_options *);
void nevh__step_selection_clear(nevh__step_selection *);
/* The length of one variable of one instance, or of time: INFINITY where it is
   quadratic as far as one can see, NAN where nothing is to be seen. */
double nevh__curve_length(const nevh__axis *, double guess);
/* Fills length with the shortest over the lanes, of which it makes those
   samples that matter; false: memory is out. */
bool nevh__find_lengths(nevh__step_selection *);
/* True if all terms bring gradients, so that their orbits can be followed. */
bool nevh__has_gradients(const nevh_field *);
/* The largest size that each variable reaches, 2n, on the orbit from the first
   sample, which ends at the state after the last sample.  Of an orbit that leaves
   as exp(t) they are sizes at first, if `escapes`.
   returns  false where they are not to be found, or where an orbit leaves so and
            `escapes` is false */
bool nevh__sizes_from_start(const nevh__step_selection *, bool escapes,
                            double sizes[]);
/* From now on they are those of the field, of one orbit; false when memory is
   out. */
bool nevh__keep_lengths(const nevh__step_selection *);
/* For each variable, the largest over samples of the change of H within its length,
   over the length squared; 2n, zeros at first.  changes: room for 4n. */
void nevh__find_curvatures(nevh__step_selection *, double changes[],
                           double curvature[]);
/* Steps that will do for a pilot, from the lengths. */
void nevh__set_crude_steps(nevh__step_selection *);
/* The time in which the fastest variable moves a hundredth of its length; 0 if
   none moves.
   ode      a gsl_odeiv2_system of the field
   y        q and p
   dydt     out, 2n */
double nevh__first_step(const nevh__step_selection *, const void *ode, double t,
                        const double y[], double dydt[]);
/* The largest size of a variable on the way to the last of the first `count` samples,
   of which the states given come first. */
double nevh__largest_size(const nevh__step_selection *, size_t i, size_t count);
/* True if the first `count` samples of the pilot suffice for scales: the second
   half of them doubled no size that is below its length. */
bool nevh__sizes_settled(const nevh__step_selection *, size_t count);
/* Adds samples; false when memory is out. */
bool nevh__find_samples(nevh__step_selection *);
/* Adds only those displaced at random. */
void nevh__find_neighbours(nevh__step_selection *);
/* Checks a term's own gradient. */
int nevh__verify(nevh__step_selection *, const nevh__planned *);
/* Chooses the step of a method in one variable, or the time, that varies over
   a length. */
nevh__step nevh__scan_line(const nevh__axis *, const nevh_gradient *,
                           double length);
/* Chooses the steps of a term. */
void nevh__scan_steps(nevh__step_selection *, nevh__planned *);

/* Chooses the steps that the user does not give, and the scales. */
int nevh__field_select_steps(nevh_field *, const nevh_options *);
/* Compares exact gradients with differences. */
int nevh__field_verify(nevh_field *, const nevh_options *);
/* Steps are kept for a part of the instances: the rows of term->steps, and
   where the step of variable k of an instance is. */
size_t nevh__step_rows(const nevh__planned *);
size_t nevh__step_at(const nevh__planned *, size_t instance, size_t k);

#endif
