/* nevh: what a run did to the energy, and what a step does to phase space.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_DIAGNOSE_H
#define NEVH_DIAGNOSE_H

#include <nevh/run.h>
#include <nevh/timing.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Watches the energy of a run. */
typedef struct nevh_energy nevh_energy;

/* options  as the stepper's, of which only width and portable matter; NULL: the
            defaults
   returns  the observer's data, to be freed with nevh_energy_free; NULL only
            when memory is out; carries the system's status otherwise */
NEVH_API nevh_energy *nevh_energy_new(const nevh_system *,
                                      const nevh_options *options);
NEVH_API void nevh_energy_free(nevh_energy *); /* NULL is allowed */
/* The status of planning or of the last call; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_energy_status(const nevh_energy *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_energy_message(const nevh_energy *);

/* Makes errors those of the balance: H(t) - H(0) less what the stepper says
   that came in from outside meanwhile, nevh_stepper_gain.  To be called before
   the first observation, of a run of that stepper.
   stepper  borrowed, until the last observation; made with
            nevh_options.balance where H reads t or there is friction
   returns  NEVH_OK; NEVH_EINVAL when the stepper keeps no balance, is for
            another system or width, or the first observation was made;
            carried by the observer, which then stops the run */
NEVH_API int nevh_energy_follow(nevh_energy *, const nevh_stepper *stepper);

/* Jumps of H in time are energy from outside, too: between two observations the
   difference of H after a jump and before it is booked, at the state between
   the two.  Where a term changes within half a step, or faster, the integral of
   dH/dt over that step is taken in the same way, in place of what the stepper
   says.  Of one orbit, observed after each step, before the first observation.
   timing   borrowed, until the last observation; NULL: none
   returns  NEVH_OK; NEVH_EINVAL when the observer is of more orbits */
NEVH_API int nevh_energy_book(nevh_energy *, const nevh_timing *timing);

/* Tests whether a step passed a pole of H, or an end of its domain, on the straight
   line between two states; the states after such a step are not on the orbit of H.
   Only terms that are formulas are tested, at steps whose error changes by more
   than that of others of the orbit.
   effect   out, may be NULL: whose term it is
   returns  the time after the first such step; NAN where there is none */
NEVH_API double nevh_energy_passed(const nevh_energy *, const char **effect);

/* Errors are to be relative to that energy, a positive number, instead of the
   one found at the first observation, before which it is given.
   returns  NEVH_OK; NEVH_EINVAL when it is not finite and positive */
NEVH_API int nevh_energy_set_scale(nevh_energy *, double scale);

/* A nevh_observe_fn; data is the nevh_energy.  The first call sets H0 and the
   scale.  A value of H, or a balance, that is not finite stops the
   run. */
NEVH_API int nevh_energy_observe(void *energy, size_t step, double t,
                                 const double q[], const double p[]);

/* Tells which scheme takes the steps, so that the verdict may use what theory
   knows of it; without that it goes by the errors alone.  To be called before
   the first observation.
   stepper  planned; read now, and not kept
   returns  NEVH_OK; NEVH_EINVAL when the stepper was refused, is for another
            system or width, or the first observation was made; carried by
            the observer */
NEVH_API int nevh_energy_expect(nevh_energy *, const nevh_stepper *stepper);

typedef enum {
    NEVH_BOUNDED,     /* level over the run, however large it is */
    NEVH_RANDOM_WALK, /* grows, but not along a line: rounding, or chaos */
    NEVH_DRIFTS,      /* its mean moves steadily, far above its uncertainty */
    NEVH_UNSTABLE,    /* above all energies at the start, and grows or stays */
    NEVH_UNDECIDED    /* the run is too short to tell */
} nevh_verdict;
NEVH_API const char *nevh_verdict_name(nevh_verdict);

/* The error of the energy that theory predicts. */
typedef enum {
    NEVH_THEORY_NONE,  /* nothing was told: nevh_energy_expect */
    NEVH_THEORY_OPEN,  /* nothing: friction, H of t, symmetric methods */
    NEVH_THEORY_KEEPS, /* no steady drift while steps resolve the orbit, but for
                          what rounding and the gradients bring: fixed steps of
                          symplectic methods and of those that preserve the
                          energy, H autonomous [Hairer, Lubich, Wanner,
                          Geometric Numerical Integration, chapter IX] */
    NEVH_THEORY_LOSES, /* a drift: each step adds its error */
    NEVH_THEORY_ROUGH /* nothing, where it would be KEEPS: formulas have kinks or
                          jumps, as of abs or floor, or values of H, also of terms
                          in C, show some where the orbit goes */
} nevh_theory;

/* Errors are of H(t) - H(0), or of the balance, relative to `scale`: |H0|
   without the terms that read nothing; where that is below 1e-6 of the largest
   |effect| at the start, that largest one.  Where all effects are below 1 % of the
   energies of the motion, these are taken: the largest, along the orbit, of the
   ranges of terms that read coordinates, and no time, and of what terms that read
   momenta are above rest. */
typedef struct {
    size_t samples;
    double initial; /* H0, all terms */
    double scale;
    double max, rms, final; /* |error|, root mean square, signed last error */
    double drift;           /* slope of a straight line, per unit of time */
    double drift_error;     /* standard error of that slope, from the slowest
                               changes about the line, as neighbouring errors
                               are not independent; 0 for fewer than 12 */
    double straightness;    /* share of the slow changes that the line explains:
                               1 for a steady loss, 0 for a level series */
    double first_fifth, last_fifth; /* largest |error| there */
    nevh_verdict verdict;           /* nevh_energy_verdict(this, 1) */
    nevh_theory theory;
    double span;  /* of time observed */
    double limit; /* the largest |effect| at the start over scale, or 1; of
                        theory OPEN, at least a tenth of `met`: energy that
                        comes in from outside makes errors larger */
    double met;   /* the largest sum of the terms' |values| met, over scale */
    double rounding; /* an error that rounding alone may have made by now: a
                        random walk of the largest energies met */
    double gradient; /* one that gradients by differences may have made, since
                        they are of no H; 0: they are exact, INFINITY: their
                        steps were given */
    double rate[3];  /* the power of t with which the largest |error| grows:
                        from the second quarter to the second half of the
                        run, and in the same way of half and a quarter of it */
    double early;    /* largest |error| in the first eighth */
    double least;    /* smallest |error| in the last fifth */
    bool gone;       /* no error of the last fifth comes near one of the first
                        fifth */
    double grown;    /* energies met by the end, over those met by the end of
                        the first fifth */
    double relative[2]; /* largest |error| in the first and in the last fifth,
                           over the energies met by then */
    double missed; /* changes of the error in steps that pass over a change of H
                      in time and are wrong about the energy from outside by as
                      much: their sum, of one orbit, with nevh_energy_book */
    double jump;   /* share of the slow changes that one jump explains: 1 of a
                      collision, 0.75 of a steady loss */
    double jump_t; /* its time */
} nevh_energy_report;

/* The verdict on a run, from the report on it, or on a run of the same steps
   that is `times` as long and begins alike; INFINITY: there will be none that
   is longer.

   OPEN where the energies met grow a hundredfold, or fourfold and steadily,
                 and the error no faster than they: UNDECIDED, for it grows with
                 the motion
   max > limit   UNDECIDED for theory LOSES where the energies met grow a
                 hundredfold, faster than any drift, and the error is below 10 % of
                 them; else UNSTABLE for it, or beyond all measure; else, once
                 times >= 16, BOUNDED where the error comes back, also within
                 the last fifth, and is level,
                 UNDECIDED where a drive of OPEN has brought more energy than
                 the error and relative to that it is level, else UNSTABLE
   max at rounding: BOUNDED, or where it grows RANDOM_WALK, once times >= 16; along
                 a line, above limit, and of LOSES: UNDECIDED, it may hide more
   LOSES         DRIFTS where the slope is above four times its error, or the
                 error never comes back
   KEEPS, OPEN, ROUGH
                 BOUNDED where the last fifth is at most twice the first, or,
                 once times >= 4, where growth has nearly ended; of errors above
                 3 % of the limit, once times >= 8.  Once times >= 16, DRIFTS
                 along a line that lasts (of KEEPS, one that the gradients may
                 bring, of OPEN and ROUGH with a straightness above 0.95),
                 RANDOM_WALK where growth is slower and lasts
                 KEEPS is UNDECIDED where a jump stays (nevh_energy_stays)
   NONE          BOUNDED as for OPEN, DRIFTS along a line, else RANDOM_WALK, of
                 the run as it is
   UNDECIDED     unless BOUNDED, where more than half of the largest error is of
                 steps that pass over a change of H in time, which are no measure
                 of the scheme (nevh_energy_passes_over).  Otherwise a longer run
                 may tell.  Also before the first step, and of a report without
                 samples

   Thread-safe. */
NEVH_API nevh_verdict nevh_energy_verdict(const nevh_energy_report *,
                                          double times);

/* True if the errors come from steps that pass over changes of H in time, not from
   the scheme; false for NULL.  Thread-safe. */
NEVH_API bool nevh_energy_passes_over(const nevh_energy_report *);
/* True if the error, above 10 % of the limit where theory KEEPS it, never comes back and
   is the same number, to 1 %, throughout the last fifth, as after a collision: the
   verdict is not BOUNDED, for nothing tells what a second one would add.  False for
   NULL.  Thread-safe. */
NEVH_API bool nevh_energy_stays(const nevh_energy_report *);

/* About how many seconds of a processor of 2020 that many evaluations of formulas
   and steps take, by a model: what is decided by it is decided alike on all
   machines, and with all loads.
   dof      degrees of freedom
   order    as nevh_stepper_order
   Thread-safe. */
NEVH_API double nevh_counts_seconds(const nevh_counts *, size_t dof,
                                    const nevh_integrator *, int order,
                                    size_t steps);

/* A run of one orbit, to be taken again. */
typedef struct {
    double t, h, t_end;        /* as of nevh_run_until */
    const double *q, *p;       /* its start, dof each */
    const nevh_observer *stop; /* what else may stop the longer run */
    size_t stops;              /* how many of them */
    double seconds;            /* nevh_counts_seconds of the run */
    double allowed;            /* of the longer run; 0: 8 */
    bool regular; /* neighbours of the orbit are known not to part, and H does
                     not read t: an error that is level stays so */
} nevh_judged_run;

/* Replaces the verdict UNDECIDED by that of a longer run: from the start again, to
   2, 4 ... 32 lengths, or 2048 that take a second, until the verdict is another one
   or the seconds allowed are spent.  BOUNDED is confirmed in the same way: by as
   many lengths as take a tenth of a second, up to 128, and where nearby orbits may
   separate by 4 that take a second.  A run that is then still open, or is too long
   to be followed to 4 lengths, is judged by the part that was run.  UNSTABLE of a
   longer run says nothing of a run whose errors are below 1 % of the limit, or, if
   H depends on time, of one that met a quarter of its energies: the verdict is
   UNDECIDED.  It is also UNDECIDED if errors of the latter grow no faster than the
   energies.  What theory LOSES leaves UNDECIDED above the limit stays so, for a longer
   run tells no more.  Errors of the run itself that rounding explains stay BOUNDED, and
   so do level errors of an orbit that `stop` ends at energies four times as large.
   stepper  as it took the run, of width 1; begins afresh
   energy   as of the run (nevh_energy_expect, nevh_energy_follow), but new
   report   in and out: nevh_energy_result of the run; of the longer one, whose
            span is longer, where there was one
   returns  NEVH_OK, also where the longer run failed; NEVH_ENOMEM
   cost     nothing where the verdict is another one; else a run, mostly of 4 to
            16 lengths */
NEVH_API int nevh_verdict_settle(nevh_stepper *, nevh_energy *,
                                 const nevh_judged_run *,
                                 nevh_energy_report *report);

/* The last error of a lane, as `final` of the report, but at no cost. */
NEVH_API double nevh_energy_error(const nevh_energy *, size_t lane);

/* lane < width.  All zeros, and UNDECIDED, before the first observation. */
NEVH_API nevh_energy_report nevh_energy_result(const nevh_energy *,
                                               size_t lane);

/* The deviation of one step from a canonical map: the largest element of
   |M' J M - J|, where M is the step's derivative with respect to (q, p) in units of
   `scale`, by sixth-order differences.
   q, p     in, n each; the stepper's width must be 1
   scale    in, 2n; NULL: ones
   returns  NEVH_OK, NEVH_ENOMEM, NEVH_EINVAL, or what the step returned
   cost     12 n steps, each from a fresh memory */
NEVH_API int nevh_symplecticity_defect(nevh_stepper *, double t, double h,
                                       const double q[], const double p[],
                                       const double scale[], double *defect);

/* `steps` steps of h and as many of -h: the largest difference to the start,
   in units of `scale`.  Arguments as above. */
NEVH_API int nevh_reversal_defect(nevh_stepper *, double t, double h,
                                  size_t steps, const double q[],
                                  const double p[], const double scale[],
                                  double *defect);

/* The largest h omega up to which steps of h stay bounded on an oscillator of
   frequency omega, H = (p^2 + omega^2 q^2)/2: there the spectral radius of the
   step's matrix first passes 1.  2 for Verlet's method, 2 sqrt(2) for rk4; 0 for
   schemes whose orbits grow at every step, as those of euler, heun and gsl-rkf45
   do; INFINITY where none is found up to 16, as with Gauss-Legendre.  Of Tao's
   methods, in a space of their own, what 500 steps show, to 1/32.  NAN for respa,
   and for schemes that take no fixed step.  A nonlinear H has resonances below
   that, of which 2 pi/3 and pi/2 per step matter most.
   cost     some thousand steps of one degree of freedom, never more than 2e5;
            each returns with all schemes of nevh, and one that does not is not
            interrupted.  Thread-safe */
NEVH_API double nevh_stability_limit(const nevh_integrator *);
/* The factor by which the amplitude of that oscillator grows in a period at h omega
   = x; 1 where it does not grow, or by less than 1e-11 a step.  NAN where there is no limit, and for x <= 0. */
NEVH_API double nevh_stability_growth(const nevh_integrator *, double x);
/* The angle, 0 ... pi, by which a step of h omega = x turns that oscillator's
   phase: x and an error of the scheme's order.  Steps that make a third or a
   quarter of a turn resonate with the terms of H beyond the quadratic.  NAN
   beyond the limit, and where there is none. */
NEVH_API double nevh_stability_angle(const nevh_integrator *, double x);

/* The rates at which small displacements from an orbit rotate and grow, from the
   eigenvalues of the linearised motion. */
typedef struct nevh_rates nevh_rates;

/* options  t, q, p: a state to plan at; scale: 2n lengths to difference over,
            NULL: probed; gradient: NULL: exact derivatives where all terms
            bring them, else central6; gradient_step(s) as in a field
   returns  to be freed with nevh_rates_free; NULL only when memory is out;
            carries a status otherwise */
NEVH_API nevh_rates *nevh_rates_new(const nevh_system *,
                                    const nevh_options *options);
NEVH_API void nevh_rates_free(nevh_rates *); /* NULL is allowed */
NEVH_API int nevh_rates_status(const nevh_rates *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_rates_message(const nevh_rates *);
/* At one state, n each.
   frequency  out: the largest angular frequency, |Im| of an eigenvalue
   growth     out: the largest rate of growth, Re of an eigenvalue: above 0
              where neighbours part exponentially; NAN for more than 48 degrees
              of freedom, where `frequency` is the largest |eigenvalue|
   returns    NEVH_OK; NEVH_EDOM (H is not finite near by), NEVH_EFAILED (the
              eigenvalues were not found), NEVH_ESTALE, NEVH_ENOMEM
   cost       12n gradients and the eigenvalues of a 2n x 2n matrix; of large
              systems 360 gradients */
NEVH_API int nevh_rates_at(nevh_rates *, double t, const double q[],
                           const double p[], double *frequency, double *growth);

#ifdef __cplusplus
}
#endif
#endif
