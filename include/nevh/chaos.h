/* nevh: is an orbit chaotic, and on which time scale.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_CHAOS_H
#define NEVH_CHAOS_H

#include <nevh/confirm.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Displacements from an orbit, moved by the tangent map of the scheme itself
   [Ch. Skokos, E. Gerlach, Numerical integration of variational equations, Phys.
   Rev. E 82 (2010) 036704].  With displacements (dq, dp) the sum of
   dq dH/dq + dp dH/dp is a Hamiltonian of (q, dq; dp, p), whose flow moves both
   the orbit and the displacement; a step of it is a step of H and its
   derivative, for splitting, Runge-Kutta and collocation methods alike.  Of
   formulas its gradient, which holds the product of the Hessian with the
   displacement, follows by forward over reverse differentiation; of terms in C
   by sixth-order differences of their gradients, or of their values.

   Other schemes (Tao's, those that keep the energy, GSL's) are differentiated
   as maps, by central differences of orbits near by, of which some steps at a
   time begin from a fresh memory.  Schemes with a time of their own are refused;
   those that keep a tolerance land on the end of each dt with all orbits. */
typedef struct nevh_chaos nevh_chaos;

/* Zeros are the defaults. */
typedef struct {
    const nevh_integrator *integrator;
    const nevh_options *options; /* as the stepper's; q and p, n each, are where
                                    the orbit starts; width is ignored.
                                    Derivatives are exact where terms bring
                                    them; else `gradient` */
    double t_start, dt;          /* dt < 0: backward in time */
    size_t starts;     /* the orbit and such as start near by, at the same
                          energy; 0: 8 */
    size_t exponents;  /* the largest ones, up to 2n; 0: 1 */
    size_t deviations; /* displacements of SALI and GALI, 2 ... 2n; 0: 2 */
    uint64_t seed;
    bool differences; /* as if the scheme were one of the others */
} nevh_chaos_options;

/* returns  to be freed with nevh_chaos_free; NULL only when memory is out;
            carries the stepper's refusal; NEVH_ESTRUCT where the scheme chooses
            its steps; NEVH_EDOM where H is not finite at the start; NEVH_EINVAL
   cost     that of planning two steppers */
NEVH_API nevh_chaos *nevh_chaos_new(const nevh_system *,
                                    const nevh_chaos_options *);
NEVH_API void nevh_chaos_free(nevh_chaos *); /* NULL is allowed */
/* The status of planning or of the last run; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_chaos_status(const nevh_chaos *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_chaos_message(const nevh_chaos *);
/* Begins anew, at another state, n each, and seed.
   returns  NEVH_OK; NEVH_EDOM, NEVH_EINVAL, or the status of planning */
NEVH_API int nevh_chaos_restart(nevh_chaos *, const double q[],
                                const double p[], uint64_t seed);
/* Goes on to the whole step nearest to `until`.  How a run is cut does not
   matter.
   returns  NEVH_OK; what a step returned (the message says when), then all
            that follows does; NEVH_EINVAL where `until` is no time; NEVH_EDOM
            where a displacement overflows
   cost     (deviations + exponents, where more than one is asked for) times
            `starts` orbits side by side, of a gradient that costs some three
            times that of H; allocates nothing */
NEVH_API int nevh_chaos_run(nevh_chaos *, double until);

typedef enum {
    NEVH_EARLY,          /* too early to say */
    NEVH_CHAOTIC,        /* displacements grow exponentially */
    NEVH_REGULAR,        /* they grow as those of a regular orbit */
    NEVH_UNSTABLE_ORBIT, /* they grow exponentially, but that is not chaos */
    NEVH_UNRESOLVED /* CHAOTIC or REGULAR of the steps, but not of finer ones; or
                       REGULAR where the force jumps, which displacements miss */
} nevh_chaos_verdict;
/* "early", "chaotic", "regular", "unstable", "unresolved"; "unknown" for other
   numbers. */
NEVH_API const char *nevh_chaos_verdict_name(nevh_chaos_verdict);

/* Results for the orbit itself, or for all starts where a member says so.

   CHAOTIC  the largest exponent is above three of its errors, of this start and
            of all that agree; displacements have grown by e^30, which is far more
            than once from one start near by to the next; SALI has fallen below
            1e-8 (1e-6 by differences), and MEGNO is above 4
   REGULAR  MEGNO is below 2.5, the exponent is below two of its errors, the run
            is 100 times as long as the fastest motion near the start takes for
            one turn, and each coordinate or its momentum, unless one of them
            rests, has gone through its range 40 times; or neighbours come
            together
   UNSTABLE as CHAOTIC, whatever the growth, but there is one degree of freedom
            and H does not read t; or the orbit rests at an equilibrium; or it
            runs away as its neighbours do; or, of at least 4 starts, only this
            one is chaotic and most are regular or unstable */
typedef struct {
    double t;
    nevh_chaos_verdict verdict;
    double sali;   /* the smaller alignment index of two displacements: falls
                        as exp(-(l1 - l2) t) in chaos, stays above 0 on a torus
                        of two dimensions or more [Ch. Skokos, J. Phys. A 34
                        (2001) 10029] */
    double megno;  /* the mean over time of 2/t int t' dlog|w|: 2 for a regular
                        orbit (0 where all periods are equal), t times half the
                        exponent in chaos [P. M. Cincotta, C. M. Giordano, C.
                        Simo, Physica D 182 (2003) 151] */
    size_t starts; /* of all that run, */
    size_t
        agreeing; /* those on which the verdict is that on the orbit, each by itself */
    /* The force jumps where the orbit goes, as that of abs(x): the growth of
       displacements misses what that adds. */
    bool kinks;
} nevh_chaos_report;
/* Zeros, and EARLY, before the first step and for NULL. */
NEVH_API nevh_chaos_report nevh_chaos_result(const nevh_chaos *);
/* The i-th exponent, counted from 0 and the largest: its mean over the starts
   that agree, without the first tenth of the run, or with friction the first half.
   error    out, may be NULL: standard error from batches in time or from the
            spread of the starts, whichever is larger, together with what linear
            growth, which is not exponential, leaves at this time, log(10)/(0.9
            t), with friction log(2)/(0.5 t); INFINITY before there is any
   returns  NAN where there is none */
NEVH_API double nevh_chaos_exponent(const nevh_chaos *, size_t i,
                                    double *error);
/* The volume of the first k displacements made unit vectors, 2 <= k <=
   deviations [Ch. Skokos, T. C. Bountis, Ch. Antonopoulos, Physica D 231 (2007)
   30]; NAN for other k. */
NEVH_API double nevh_chaos_gali(const nevh_chaos *, size_t k);
/* The evaluations of the stepper so far, of all lanes; zeros for NULL. */
NEVH_API nevh_counts nevh_chaos_counts(const nevh_chaos *);

/* The indicators for H itself, from steps of dop853 with a tolerance. */
typedef struct {
    nevh_chaos_report report; /* of 4 starts, at the time that was reached */
    double exponent, error;   /* as nevh_chaos_exponent */
    double growth; /* of a displacement: its largest logarithm so far */
} nevh_chaos_finding;
/* The orbit of options->q and p from t0 towards t1.
   options  as those of nevh_chaos_options; the tolerance is 1e-10
   seconds  that it may cost, as nevh_counts_seconds has them; 0: 2
   found    out: zeros, and EARLY, where nothing could be followed
   returns  NEVH_OK; what nevh_chaos_new or nevh_chaos_run returned, and then what
            was found until there is in `found`; NEVH_EINVAL where
            t1 is t0 or is none
   Thread-safe. */
NEVH_API int nevh_chaos_find(const nevh_system *, const nevh_options *options,
                             double t0, double t1, double seconds,
                             nevh_chaos_finding *found);

/* The verdict and the exponent of a run, by finer steps: see <nevh/confirm.h>. */
typedef struct {
    nevh_finer_kind how; /* NONE: nothing was to be confirmed, or could be */
    char text[80];       /* nevh_finer_text */
    nevh_chaos_finding found;
    nevh_chaos_verdict verdict; /* that of the run, or UNRESOLVED: finer steps
                                   contradict it, or leave chaos open */
    bool agrees;                /* so do the exponents, by nevh_agree */
    double error; /* of the run's exponent; with friction at least its
                     difference from that of the finer steps */
} nevh_chaos_confirmation;
/* CHAOTIC and REGULAR of a run that has ended are confirmed; others are taken as
   they are.  A finer run of chaos ends as soon as it is chaotic; with friction it
   goes on, since chaos may be that before an attractor is reached, and must end with
   the verdict of the run.
   budget   of what the run cost; 0: a half, with friction four times that run
   returns  NEVH_OK; NEVH_ENOMEM; what the finer run returned: then nothing is
            confirmed, and the verdict is UNRESOLVED */
NEVH_API int nevh_chaos_confirm(const nevh_chaos *, double budget,
                                nevh_chaos_confirmation *);

/* True if the steps are those of the tangent map.
   why  out, may be NULL: why they are not, else ""; never NULL */
NEVH_API bool nevh_chaos_is_tangent(const nevh_chaos *, const char **why);

#ifdef __cplusplus
}
#endif
#endif
