/* nevh: kinds of outcomes: what is kept of an orbit under way, and what of it is
   handed on.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_OUTCOME_PRIVATE_H
#define NEVH_OUTCOME_PRIVATE_H

#include "diagnose/chaos_private.h"
#include <nevh/ensemble.h>

/* Names of all kinds and what they take, in the order of nevh_outcome_kind; a new one
   is the last.
   NAME is defined as nevh__outcome_NAME by a file in this folder. */
#define NEVH__OUTCOMES(X)                                                      \
    X(state, NOTHING)                                                          \
    X(t, NOTHING)                                                              \
    X(energy_error, NOTHING)                                                   \
    X(verdict, NOTHING)                                                        \
    X(first, CONDITION)                                                        \
    X(last, FORMULA)                                                           \
    X(min, FORMULA)                                                            \
    X(max, FORMULA)                                                            \
    X(mean, FORMULA)                                                           \
    X(crossings, SECTION)                                                      \
    X(period, SECTION)                                                         \
    X(frequency, FORMULA)                                                      \
    X(lyapunov, NOTHING)                                                       \
    X(sali, NOTHING)                                                           \
    X(megno, NOTHING)                                                          \
    X(rms, FORMULA)

/* An orbit at its start, after steps, or at its end. */
typedef struct {
    nevh_ensemble *ensemble;
    const nevh_outcome *decl;
    size_t outcome, lane;     /* numbers */
    size_t step;              /* 0: the start */
    double t_start, t, value; /* value: of the quantity, if there is one */
    double t_before,
        value_before;     /* before the steps; of no use at the start */
    double value_earlier; /* a step before that */
    size_t count;         /* steps since then, */
    double h;             /* of that length if there are several */
    const double *values; /* after each, so far apart */
    size_t pitch;
} nevh__observation;

static inline double nevh__observed(const nevh__observation *at, size_t i) {
    return at->values[i * at->pitch];
}
/* The number of one of the steps, and the time after it. */
static inline size_t nevh__observed_step(const nevh__observation *at,
                                         size_t i) {
    return at->step - at->count + 1 + i;
}
static inline double nevh__observed_t(const nevh__observation *at, size_t i) {
    return i + 1 == at->count
               ? at->t
               : at->t_start + (double)nevh__observed_step(at, i) * at->h;
}

/* Functions may be NULL, but for `end` or `of_chaos`.  A record is what is kept of
   an orbit under way; it is 0 until `plan` is called. */
typedef struct {
    nevh_outcome_info info;
    bool whole_state; /* 2n numbers; others: one */
    bool of_values;   /* NAN only where the quantity is undefined */
    bool of_energy;   /* the ensemble has a nevh_energy */
    bool of_turns; /* angles are continued: the period of a coordinate counts */
    bool branches; /* shorter steps branch off from states before */
    size_t size;   /* of a record, in bytes */
    int (*plan)(nevh_ensemble *, size_t outcome, const nevh_options *);
    void (*clear)(void *record);
    void (*begin)(const nevh__observation *, void *record);
    void (*step)(const nevh__observation *, void *record); /* or several */
    /* Counts the first steps that need nothing but the values there; NULL: all. */
    size_t (*quiet)(const nevh__observation *, const void *record);
    bool (*known)(const void *record); /* it will not change any more */
    void (*end)(const nevh__observation *, const void *record, double result[]);
    double (*of_chaos)(const nevh__chaos_member *);
} nevh__outcome_type;

#define NEVH__OUTCOME_DECLARE(name, takes)                                     \
    extern const nevh__outcome_type nevh__outcome_##name;
NEVH__OUTCOMES(NEVH__OUTCOME_DECLARE)

#define NEVH__OUTCOME_ONE(name, takes) +1
enum { NEVH__OUTCOME_COUNT = 0 NEVH__OUTCOMES(NEVH__OUTCOME_ONE) };

/* outcomes.c: by number; NULL: there is none of that number. */
const nevh__outcome_type *nevh__outcome_type_of(int kind);

#endif
