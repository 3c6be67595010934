/* nevh: many orbits of one system.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_ENSEMBLE_H
#define NEVH_ENSEMBLE_H

#include <nevh/run.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Numbers that belong to (seed, name, i) and to nothing else, so that a member
   of an ensemble is the same whoever computes it, and in which order:
   Philox4x32-10, a counter-based generator [J. K. Salmon, M. A. Moraes, R. O.
   Dror, D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3, Proc. SC11
   (2011)].  The key is made of seed and name by the same generator, the counter
   is i.
   returns  uniform: in (0, 1), a multiple of 2^-53 plus 2^-54; normal: of mean
            0 and variance 1, the inverse of the distribution function (GSL's)
            at the uniform number of the same i.  Thread-safe */
NEVH_API double nevh_uniform_at(uint64_t seed, const char *name, uint64_t i);
NEVH_API double nevh_normal_at(uint64_t seed, const char *name, uint64_t i);

/* A quantity of the state, at `width` states side by side, lanes innermost:
   q[k*width + lane], p and v = dH/dp likewise, t[lane], values[lane].  width is
   a multiple of 8.  v is NULL unless it was asked for.  A lane must not depend
   on its neighbours.  Called by several threads at once where several run. */
typedef void (*nevh_quantity_fn)(const void *data, size_t width,
                                 const double t[], const double q[],
                                 const double p[], const double v[],
                                 double values[]);
typedef struct {
    nevh_quantity_fn value;
    const void *data; /* the first argument of `value` */
    bool velocities;  /* `value` reads v */
} nevh_quantity;

/* Kinds of outcomes, numbers that are kept of an orbit; nevh_outcomes lists them.
   Kinds added later have no constant: nevh_outcome_find finds them by name. */
typedef enum {
    NEVH_OUTCOME_STATE,        /* coordinates and momenta at the end: 2n */
    NEVH_OUTCOME_TIME,         /* reached */
    NEVH_OUTCOME_ENERGY_ERROR, /* the largest, as nevh_energy_report has it */
    NEVH_OUTCOME_VERDICT,      /* a nevh_verdict on the run as it is */
    NEVH_OUTCOME_FIRST,        /* the first time at which the quantity is above
                                  0; NAN where it never is */
    NEVH_OUTCOME_LAST,         /* the quantity at the end */
    NEVH_OUTCOME_MINIMUM,      /* of the quantity, at the steps */
    NEVH_OUTCOME_MAXIMUM,
    NEVH_OUTCOME_MEAN, /* over time, by the trapezoidal rule on the steps */
    NEVH_OUTCOME_CROSSINGS, /* how often the quantity goes through 0 */
    NEVH_OUTCOME_PERIOD,    /* mean time between crossings; NAN below two */
    NEVH_OUTCOME_FREQUENCY, /* of the largest line of the quantity, as
                               nevh_frequencies has it; NAN where it does not
                               move, makes less than one turn, or below 64
                               steps */
    NEVH_OUTCOME_LYAPUNOV, /* what nevh_chaos finds of the orbit with one start:
                               its largest exponent, */
    NEVH_OUTCOME_SALI,     /* the alignment of two displacements, */
    NEVH_OUTCOME_MEGNO     /* and MEGNO */
} nevh_outcome_kind;

typedef enum {
    NEVH_OUTCOME_TAKES_NOTHING,
    NEVH_OUTCOME_TAKES_FORMULA,   /* NAME(F), the quantity */
    NEVH_OUTCOME_TAKES_CONDITION, /* NAME(A > B), where the quantity, A - B, is
                                     above 0 */
    NEVH_OUTCOME_TAKES_SECTION    /* NAME or NAME(SECTION), where the quantity
                                     goes through 0 */
} nevh_outcome_takes;
typedef enum {
    NEVH_UNIT_NONE,
    NEVH_UNIT_OF_FORMULA,
    NEVH_UNIT_TIME,
    NEVH_UNIT_FREQUENCY, /* angle over time */
    NEVH_UNIT_RATE       /* 1 over time */
} nevh_outcome_unit;
/* A kind of outcome. */
typedef struct {
    const char *name; /* in scenes, as "mean" */
    nevh_outcome_takes takes;
    nevh_outcome_unit unit; /* of its numbers */
    const char *help;       /* what it is, in a line */
} nevh_outcome_info;
/* All kinds, element k that of kind k; NULL ends the list. */
NEVH_API const nevh_outcome_info *const *nevh_outcomes(void);
/* The kind of a name; -1 where there is none, or for NULL. */
NEVH_API int nevh_outcome_find(const char *name);

typedef struct {
    int kind;               /* a nevh_outcome_kind, or another number of
                               nevh_outcomes */
    nevh_quantity quantity; /* of kinds that take anything */
    int direction;          /* of kinds that take a section, as in
                               nevh_section */
    double modulus;         /* likewise: multiples of it count, too; 0: none; of
                               FREQUENCY: the period of an angle, whose cosine
                               is taken where it goes round */
} nevh_outcome;

/* Times of NEVH_OUTCOME_FIRST, NEVH_OUTCOME_CROSSINGS and NEVH_OUTCOME_PERIOD
   are found to rounding, by shorter steps that branch off from the orbit, not
   by interpolation.  FIRST also finds what holds only between two steps, where
   the quantity has a maximum that a parabola through three steps tells of.
   NEVH_OUTCOME_FREQUENCY keeps at most 4096 samples of an orbit, as nevh_spectral_samples
   does, and needs steps of equal length. */
typedef struct {
    const nevh_integrator *integrator;
    const nevh_options *options; /* NULL: the defaults; q and p: one state to
                                      plan at, n each; width is ignored */
    double t_start, t_end, dt;   /* as nevh_run_until takes them */
    size_t width;                /* orbits side by side; 0: chosen */
    double energy_scale;         /* 0: of each orbit, as nevh_energy has it */
    const nevh_outcome *outcomes;
    size_t n_outcomes;
    nevh_quantity stop; /* an orbit ends at the step at which this is above 0;
                           value NULL: none does */
} nevh_ensemble_options;

/* Displacements of NEVH_OUTCOME_LYAPUNOV to NEVH_OUTCOME_MEGNO are drawn as those
   of a nevh_chaos of seed 0, in the lengths of H at the state to plan at.  They
   are of orbits of their own, beside those of other outcomes, until the same
   time.  SALI is taken once a turn of the fastest motion there, unless MEGNO is
   asked for, too; an orbit ends where SALI is below 1e-8 and neither of the
   other two is asked for.

   Orbits of one system by one scheme, side by side.  Each is the one that
   nevh_run_until takes alone, to the last bit, whatever the width, its
   neighbours and the order in which the orbits begin.  An orbit ends at t_end,
   where it is to stop, once all its outcomes are known, or where a step fails;
   the next one then takes its place.

   One thread at a time may use an ensemble; several, one a thread, may share a
   system that nobody changes meanwhile. */
typedef struct nevh_ensemble nevh_ensemble;

/* returns  to be freed with nevh_ensemble_free; NULL when memory is out, or
            where an argument is NULL; carries the stepper's refusal, or
            NEVH_EINVAL, otherwise.  Orbits of schemes that choose their own
            times are taken one by one, whatever the width
   cost     that of planning two steppers; then memory that is proportional to
            the width, whatever the number of orbits */
NEVH_API nevh_ensemble *nevh_ensemble_new(const nevh_system *,
                                          const nevh_ensemble_options *);
NEVH_API void nevh_ensemble_free(nevh_ensemble *); /* NULL is allowed */
/* The status of planning or of the last run; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_ensemble_status(const nevh_ensemble *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_ensemble_message(const nevh_ensemble *);
/* Numbers that an orbit leaves: one an outcome, 2n of NEVH_OUTCOME_STATE. */
NEVH_API size_t nevh_ensemble_columns(const nevh_ensemble *);
/* Orbits side by side. */
NEVH_API size_t nevh_ensemble_width(const nevh_ensemble *);
/* True if the steps of orbits side by side are compiled, as nevh_stepper_native. */
NEVH_API bool nevh_ensemble_native(const nevh_ensemble *, const char **why);

/* Asks for the next orbit.
   member   out: any number, to tell it by
   q, p     out, n each: where it starts
   returns  whether there is one; false may be changed later, as long as orbits
            are under way */
typedef bool (*nevh_member_fn)(void *data, uint64_t *member, double q[],
                               double p[]);
/* The result of an orbit; valid during the call. */
typedef struct {
    uint64_t member;
    int status;           /* NEVH_OK, or that of the step that failed */
    const char *message;  /* to that status, or "" */
    const double *values; /* nevh_ensemble_columns; NAN where unknown */
} nevh_member_result;
/* Is called with each orbit that has ended.  A result other than 0 stops the
   run. */
typedef int (*nevh_result_fn)(void *data, const nevh_member_result *);

/* Takes orbits until there are no more.
   returns  NEVH_OK, also where orbits failed; NEVH_STOPPED when `done` said so;
            NEVH_ESTALE, or the status of an ensemble that could not be planned
   cost     allocates nothing where there is more than one lane, a few copies of
            the state for each orbit where there is one */
NEVH_API int nevh_ensemble_run(nevh_ensemble *, nevh_member_fn next,
                               nevh_result_fn done, void *data);

#ifdef __cplusplus
}
#endif
#endif
