/* nevh: the orbit that others are measured against.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_REFERENCE_H
#define NEVH_REFERENCE_H

#include <nevh/run.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The orbit from a state, as it should be: an exact solution, or a run of its
   own with small steps whose error is known.  One thread at a time. */
typedef struct nevh_reference nevh_reference;

/* The orbit through (q, p) at t0, until t1 on either side of it.
   integrator  NULL: an exact solution where H is recognised to have one, else
               Taylor series where H is of formulas that are
               analytic and the work allows it, else gauss12, or dop853 where
               there is friction, which Gauss methods only take to second order.
               nevh_taylor: Taylor series, whatever the work.  Another one: a run
               of it.  Other schemes that choose their own times are refused
               with NEVH_EINVAL.
   returns     the reference, to be freed with nevh_reference_free; NULL only
               when memory is out.  Otherwise it carries NEVH_EINVAL, what
               planning or a step returned, or NEVH_EFAILED where no reference
               can be afforded; the message says why.
   The system is borrowed and must not be changed.

   H is recognised by its gradient at some thousand states in and around the
   region of the orbit, to rounding, never by a name.  Known are, without
   friction and without time,
       p^2/(2 M) + k/2 (q - c)^2 + const     n = 1, k > 0
       p^2/(2 M) - A cos(q - c) + const      n = 1, Jacobi's functions
       p^2/(2 m) - k/|q| + const             n = 2, 3, bound orbits
   in any units; the constants are fitted.

   Taylor series have 106 bits where there is libquadmath, else those of long
   double.  Two runs, of two orders and tolerances, are repeated once with smaller
   tolerances where their difference is above 5e-16 of the range of a variable.
   Each time they cost three seconds or so at most, by counted operations; where
   the second time would cost more, the first is kept and the text says so.

   A run of another scheme is repeated with smaller steps until runs with h and h/2 agree to 1e-11
   of the range of each variable, or to rounding, or to 1e-9 where they cost
   more than a twentieth of the following, or as well as can be afforded: 1e7
   gradients, or 2e8 evaluations of term instances, whichever is less.  The one
   with h/2 is kept, as checkpoints (at most 16 MB).  Gradients are exact where
   all terms bring them, else central8.  There are at least 128 steps of h.
   Where H reads no time and there is no friction, the runs must keep H as well
   as they keep the state: a run whose H changes by far more than the runs differ
   has stepped over something.  Then steps are shortened, and where H jumps, so
   that no step would do, there is NEVH_EDOM and a message that says where.
   cost        of an exact solution some milliseconds; of a run up to the
               bounds above, some seconds */
NEVH_API nevh_reference *nevh_reference_new(const nevh_system *,
                                            const nevh_integrator *integrator,
                                            double t0, double t1,
                                            const double q[], const double p[]);

/* Further options of a reference; zeros are those of nevh_reference_new. */
typedef struct {
    const nevh_integrator *integrator; /* as there */
    const size_t *kind; /* n numbers: coordinates of one number are of one kind
                           and share a range, and so do their momenta; NULL:
                           each has its own */
    double longest; /* step of a run, of either sign: no longer than a few of
                       the steps that are compared with it, so that it sees what
                       they see; 0: a 128th of the time.  The cost limit
                       takes precedence. */
    bool finest; /* Taylor series in place of an exact solution whose own error
                    is above 1e-15, where they have a smaller one and can be
                    afforded */
} nevh_reference_options;
/* options  borrowed for the call; NULL: zeros */
NEVH_API nevh_reference *
nevh_reference_with(const nevh_system *, const nevh_reference_options *options,
                    double t0, double t1, const double q[], const double p[]);
NEVH_API void nevh_reference_free(nevh_reference *); /* NULL is allowed */
/* The status of making it or of the last call; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_reference_status(const nevh_reference *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_reference_message(const nevh_reference *);

/* A description: "exact solution (Jacobi sn)", "gauss12 at dt = 0.005, own error
   3e-12"; "" if there is none.  Never NULL. */
NEVH_API const char *nevh_reference_text(const nevh_reference *);
/* Its own error in the units of state errors, the largest over its time:
   of an exact solution, what the last digits of the fitted constants do to the
   state, or rounding where long double has no more digits than double; of a
   run, the difference of those with h and h/2; of Taylor series, twice the
   difference of two runs, before states are rounded to doubles.  Smaller state
   errors mean nothing. */
NEVH_API double nevh_reference_error(const nevh_reference *);
/* The time after which state errors mean nothing, because the runs of which it
   was made have separated by more than 1e-3 of the range of a variable: of Taylor
   series, runs with tolerances of 1e-20 and 1e-19.  Until then their own error is
   that of runs with smaller tolerances, and the time may be earlier to keep that
   below 1e-15.
   INFINITY (-INFINITY where t1 < t0) where that does not happen. */
NEVH_API double nevh_reference_horizon(const nevh_reference *);
/* Why there is a horizon. */
typedef enum {
    NEVH_REFERENCE_WHOLE, /* there is none */
    NEVH_REFERENCE_CHAOS, /* orbits that start apart by the last digits separate
                             exponentially, all the time until then */
    NEVH_REFERENCE_SENSITIVE, /* they separate, but not so: at a saddle (as all
                                 do of one degree of freedom whose H does not
                                 read t), in a close pass */
    NEVH_REFERENCE_COARSE /* they do not separate: shorter steps bring nothing,
                             or cannot be afforded: at a pole, a jump, or with a
                             scheme of low order */
} nevh_reference_end;
NEVH_API nevh_reference_end nevh_reference_why(const nevh_reference *);
/* The rate of separation of chaotic and sensitive orbits, per time, by least
   squares, and the growth of a difference in the last digits.  NAN of others. */
NEVH_API double nevh_reference_exponent(const nevh_reference *);
NEVH_API double nevh_reference_growth(const nevh_reference *);

/* When the solution itself ends: near that time a coordinate or a momentum grows
   without bound, as in a collision, and no scheme goes on.  Known also where
   there is no reference for that reason.  NAN: not between t0 and t1, as far as
   was seen. */
NEVH_API double nevh_reference_ends(const nevh_reference *);
/* The same without a reference, by Taylor series of two tolerances, whose ends have six
   digits in common.
   cost     some milliseconds for planets; at most a second or so, after which
            the answer is NAN
   returns  INFINITY where series end at times that have not: the orbit is not known
            that far, as where it is chaotic */
NEVH_API double nevh_solution_ends(const nevh_system *, double t0, double t1,
                                   const double q[], const double p[]);
/* Tests by Taylor series whether H is smooth on the way of a solution: they end where
   an operation of a formula has a kink, a jump, or the edge of its domain.
   why      out, of `room` characters, may be NULL: the operation, its effect and
            the time; "" where there is none
   cost     at most 5000 series, and fewer where n > 14
   returns  NEVH_OK: it is, as far as was seen, or up to the end of the solution;
            NEVH_EDOM: it is not; NEVH_ESTRUCT where there are no series; NEVH_EFAILED
            where they get too short for another reason; NEVH_ENOMEM */
NEVH_API int nevh_solution_smooth(const nevh_system *, double t0, double t1,
                                  const double q[], const double p[],
                                  char why[], size_t room);

/* The state at a time between t0 and t1.
   q, p     out, n each
   returns  NEVH_OK; NEVH_EINVAL for times outside; NEVH_EDOM after the
            horizon; what a step returned
   cost     of an exact solution about a microsecond; of a run, steps from the
            last checkpoint, which are few where times are asked for in order.
            States are kept (at most 32 MB): asking again costs nothing. */
NEVH_API int nevh_reference_state(nevh_reference *, double t, double q[],
                                  double p[]);
/* The same by the time since t0, between 0 and t1 - t0: far from t = 0 a time
   is rounded, and an orbit may move within that rounding. */
NEVH_API int nevh_reference_state_after(nevh_reference *, double elapsed,
                                        double q[], double p[]);

/* The divisor of state errors of q[k] for k < n, else of p[k - n]: its own range,
   or the widest one among the variables of its kind.  If that is 0 or rounding, the
   largest one among all coordinates, or all momenta; 1 if all are. */
NEVH_API double nevh_reference_range(const nevh_reference *, size_t k);
/* The difference of the largest and the smallest value of that variable over
   the time; 0 where it does not move. */
NEVH_API double nevh_reference_own_range(const nevh_reference *, size_t k);

/* Watches a run: the largest |difference to the reference| / range over
   coordinates and momenta, at up to 1024 of the run's own times spread over
   that of the reference, the one at its end among them. */
typedef struct nevh_state_error nevh_state_error;

/* The reference is borrowed.  NULL when memory is out, or for NULL. */
NEVH_API nevh_state_error *nevh_state_error_new(nevh_reference *);
NEVH_API void nevh_state_error_free(nevh_state_error *); /* NULL is allowed */
/* The stepper that runs the orbit, borrowed: states are compared at the time
   that its steps add up to, which far from t = 0 is known better than t.  NULL:
   at t, as without a call. */
NEVH_API void nevh_state_error_follow(nevh_state_error *, const nevh_stepper *);
/* Is handed each pair of states that is compared.
   t          the run's own time
   q, p       its state, n each
   reference  the reference's at the same time, 2n: coordinates, then momenta */
typedef void (*nevh_pair_fn)(void *data, double t, const double q[],
                             const double p[], const double reference[]);
/* Whom to hand them to, for errors of what depends on the state.  NULL: nobody,
   as without a call.  data is borrowed. */
NEVH_API void nevh_state_error_hand(nevh_state_error *, nevh_pair_fn,
                                    void *data);
/* A nevh_observe_fn for runs of one orbit; data is the nevh_state_error.  It
   never stops a run: where the reference has no state there is no result. */
NEVH_API int nevh_state_error_observe(void *state_error, size_t step, double t,
                                      const double q[], const double p[]);
/* INFINITY when a state was not finite.  NAN: unknown, because nothing was
   observed or the reference failed, or meaningless, because the run went on
   after the horizon. */
NEVH_API double nevh_state_error_result(const nevh_state_error *);
/* The error of variable k alone, numbered as ranges are: the largest |difference|
   in the units of that variable, which may be divided by either range.  INFINITY
   and NAN as above. */
NEVH_API double nevh_state_error_of(const nevh_state_error *, size_t k);

#ifdef __cplusplus
}
#endif
#endif
