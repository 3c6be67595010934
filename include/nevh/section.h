/* nevh: Poincare sections and other events along a run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SECTION_H
#define NEVH_SECTION_H

#include <nevh/run.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The value whose zeros are looked for; n each.  Any status but NEVH_OK, and a
   value that is not finite, stops the run. */
typedef int (*nevh_section_fn)(void *data, double t, const double q[],
                               const double p[], double *value);

/* The definition of a section; zeros are the defaults. */
typedef struct {
    const char *name;      /* for messages; NULL: its number */
    nevh_section_fn value; /* NULL: a stroboscopic section */
    void *data;            /* the first argument of `value` */
    int direction; /* 1: values that rise with t, -1: that fall, 0: both.
                      With t also where a run goes backward. */
    double period; /* crossings of all its multiples count, as those of
                      an angle that goes round; 0: of 0 alone */
    double every;  /* where there is no value: time between points, the
                      first that long after the run begins */
} nevh_section;

/* A point of a section.  q and p, n each, are valid during the call. */
typedef struct {
    size_t section;
    int direction; /* 1 rising, -1 falling with t; 0 stroboscopic */
    double t;
    const double *q, *p;
} nevh_point;

/* Is called with each point, in the order in which the run comes by.  A result
   other than 0 stops the run. */
typedef int (*nevh_point_fn)(void *data, const nevh_point *);

/* An observer that finds the points of sections.  A point is the end of a
   shorter step that branches off from the state before it: of a copy of the
   stepper with the same memory, its length found by root finding [after M.
   Henon, On the numerical computation of Poincare maps, Physica D 5 (1982)
   412-414], until the length is certain to the last digits.  So points are as
   accurate as the orbit is, nothing is interpolated, and the orbit is the same,
   to the last bit, whether or not anyone looks.

   A crossing is where the value goes from one side of 0 to the other.  The
   state that a run begins with does not count, nor does a value that touches 0
   and turns, nor one that jumps from one side to the other.  A zero that falls
   on a step counts once.  Two or three crossings within one step are found as
   well, where the value over that step, taken together with its slope at both
   ends, turns like a cubic; what is between steps may be missed where the value
   turns more often than that.

   A run that begins at the state, and at the time, at which the last one ended
   goes on: no point is lost or doubled there.

   Works with schemes that adapt and that choose their own times, too; with the
   former a point is off by what their tolerance lets pass. */
typedef struct nevh_sections nevh_sections;

/* stepper   whose runs are to be observed; borrowed
   sections  `count` of them; copied, but not their data
   tell      is called with the points
   returns   the observer's data, to be freed with nevh_sections_free; NULL
             only when memory is out.  Carries NEVH_EINVAL where a section makes
             no sense, or the stepper takes more than one orbit, or the
             stepper's own refusal.
   cost      a second stepper, planned like the first.  Along a run, a gradient
             and two values of each section a step; some five short steps a
             point, a few more where a value turns near 0.  Observing allocates
             nothing. */
NEVH_API nevh_sections *nevh_sections_new(const nevh_stepper *stepper,
                                          const nevh_section sections[],
                                          size_t count, nevh_point_fn tell,
                                          void *data);
NEVH_API void nevh_sections_free(nevh_sections *); /* NULL is allowed */
/* The status of planning or of the last observation, NEVH_STOPPED where `tell`
   stopped the run; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_sections_status(const nevh_sections *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_sections_message(const nevh_sections *);

/* A nevh_observe_fn, data is the nevh_sections; to be called after every step.
   Stops the run, which then returns NEVH_STOPPED, where a section's value or a
   step that branches off fails (the reason is in nevh_sections_status), and
   where `tell` says so. */
NEVH_API int nevh_sections_observe(void *sections, size_t step, double t,
                                   const double q[], const double p[]);

/* The evaluations of the search, by a second stepper: they are not in the counts of
   the first. */
NEVH_API nevh_counts nevh_sections_counts(const nevh_sections *);

#ifdef __cplusplus
}
#endif
#endif
