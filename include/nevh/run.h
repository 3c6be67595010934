/* nevh: steps and runs.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_RUN_H
#define NEVH_RUN_H

#include <nevh/gradient.h>
#include <nevh/integrator.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A system and a scheme, planned: structure checked, gradient steps chosen,
   workspace allocated.  Stepping allocates nothing, prints nothing and touches
   no globals, so one stepper a thread works, over one system that nobody
   changes meanwhile. */
typedef struct nevh_stepper nevh_stepper;

/* options   NULL: the defaults.  The state in it is that of the plan (scales,
             probes), best the one to start from.
   returns   the stepper, to be freed with nevh_stepper_free; NULL only when
             memory is out.  A scheme that does not fit the system gives a
             stepper that carries the refusal: NEVH_ESTRUCT with a message
             that names the term and schemes that fit, NEVH_ENOGRAD,
             NEVH_EINVAL, or the system's own status.

   Friction (nevh_system_add_friction) is taken by the Runge-Kutta references
   into their slopes.  Around a step of the others p is multiplied by
   exp(-rate h/2), before and after: with equal rates a symplectic scheme then
   shrinks the symplectic form by exactly exp(-rate h), and friction alone
   decays as it should [R. I. McLachlan, M. Perlmutter, Conformal Hamiltonian
   systems, J. Geom. Phys. 39 (2001) 276-300; A. Bhatt, D. Floyd, B. E. Moore,
   Second order conformal symplectic schemes for damped Hamiltonian systems, J.
   Sci. Comput. 66 (2016) 1234-1259].  That fits no scheme that chooses its own
   times: NEVH_ESTRUCT. */
NEVH_API nevh_stepper *nevh_stepper_new(const nevh_system *,
                                        const nevh_integrator *,
                                        const nevh_options *options);
NEVH_API void nevh_stepper_free(nevh_stepper *); /* NULL is allowed */
/* The status of planning or of the last call; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_stepper_status(const nevh_stepper *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_stepper_message(const nevh_stepper *);

/* One step from t to t + h.
   q, p     in and out, n x width each, lanes innermost (q[k*width + lane])
   returns  NEVH_OK; NEVH_EDOM (a value of H or the new state is not finite),
            NEVH_EMAXITER (the stage equations of an implicit scheme were not
            solved), NEVH_EFAILED (an adaptive scheme would need more than a
            million substeps, or steps below the resolution of a double),
            NEVH_ESTALE,
            NEVH_EINVAL (h not finite), or the refusal of a stepper that could
            not be planned.  On failure q, p and the stepper's memory are as
            before the step.

   A stepper remembers what it last returned (sums of rounding errors, the
   last gradient, a first guess for the stages).  Where q, p or t differ from
   that, the lane's memory is reset: the state may be changed between calls. */
NEVH_API int nevh_stepper_apply(nevh_stepper *, double t, double h, double q[],
                                double p[]);

/* The time after the last step: t + h, but for schemes that choose their own
   time (nevh_integrator_own_time). */
NEVH_API double nevh_stepper_time(const nevh_stepper *);

/* Forgets the memory and the gain, as if no step had been taken; counts stay. */
NEVH_API void nevh_stepper_reset(nevh_stepper *);
/* A second stepper with the same memory, for branch-offs that leave the first
   untouched.  Its counts start at 0.  NULL when memory is out. */
NEVH_API nevh_stepper *nevh_stepper_copy(const nevh_stepper *);
/* Bytes that nevh_stepper_save writes. */
NEVH_API size_t nevh_stepper_save_size(const nevh_stepper *);
/* Writes the memory to a buffer, so that after nevh_stepper_load into a
   stepper planned alike a run continues bit for bit. */
NEVH_API void nevh_stepper_save(const nevh_stepper *, void *buffer);
/* returns  NEVH_OK; NEVH_EINVAL when the buffer was saved by another scheme,
            size of system or width, or is cut short */
NEVH_API int nevh_stepper_load(nevh_stepper *, const void *buffer, size_t size);

/* The order to expect: the scheme's own, or that of Taylor series of this
   tolerance, but at most 2 where friction is put around its steps.  0 where there
   is no integrator. */
NEVH_API int nevh_stepper_order(const nevh_stepper *);

/* The energy that lane `lane` gained from outside in all steps since the
   stepper was made or reset: the integral of dH/dt at fixed q and p, less what
   friction took, each advanced by the scheme's own quadrature, at the points
   and with the weights at which it takes the gradient (what friction around a
   step takes is the difference of H, exactly).  H(t) - H(0) less that is the
   error that the scheme makes.  A jump to another state leaves the sum as it
   is.  0 unless nevh_options.balance asked for it, and where H does not read t
   and there is no friction; NAN where a kernel did not account for a whole
   step.
   cost     within a step: 8 values of what reads t a stage, four values of H
            where friction is put around it; none in nevh_stepper_counts */
NEVH_API double nevh_stepper_gain(const nevh_stepper *, size_t lane);

/* The steps as a C program that needs nothing but the C library: it starts from
   nevh_options.t, q and p, and prints t, q and p; or, called with the word
   "energy", errors of the energy as nevh compare has them.  Implicit steps are
   iterated as here, but where Newton's iteration would have to help, the program
   says so and ends.  It gives the digits of a stepper.
   names      of the coordinates, n
   h, t_end   as of nevh_run_until
   every      steps between rows, at least 1
   functions  the functions alone, for another program
   energy_scale  that errors of the energy are relative to; 0: it prints none
   returns    the text, to be freed with free; NULL when memory is out, or with a
              status and message where the scheme or the system has no such text:
              see nevh_stepper_native */
typedef struct {
    const char *const *names;
    double h, t_end;
    size_t every;
    bool functions;
    double energy_scale;
} nevh_program;
NEVH_API char *nevh_stepper_program(nevh_stepper *, const nevh_program *);

/* True if steps run as native code: H and the scheme written as one C function,
   compiled and loaded when the stepper was made or nevh_stepper_foresee was
   called.  With NEVH_NATIVE_AUTO one orbit does not wait for the compiler: until it
   is done, steps are interpreted, with the same bits.  This function and
   nevh_stepper_free wait for it.
   Requires formulas, a scheme with nevh_integrator_native, fixed steps, and
   nevh_options.balance off.  The width must be 1 or a multiple of 8; Nystroem
   methods and the complex step require width 1, and implicit schemes take no
   complex step.  Steps that fail to converge are repeated by the interpreter.
   Series of nevh_taylor are always compiled.
   why      out, may be NULL: the reason where compiling was possible but failed
            ("there is no C compiler: ..."), else ""; owned by the stepper, never
            NULL */
NEVH_API bool nevh_stepper_native(const nevh_stepper *, const char **why);
/* True if a compiler runs in the background and steps are not native yet.  Does not
   wait. */
NEVH_API bool nevh_stepper_compiles(const nevh_stepper *);
/* Raises the expected number of steps.  With NEVH_NATIVE_AUTO, a stepper that is not
   compiled is compiled now if that many steps repay it.
   steps    as nevh_options.steps_foreseen; fewer than before change nothing
   returns  whether the steps repay compiling, and are compiled or being compiled */
NEVH_API bool nevh_stepper_foresee(nevh_stepper *, double steps);
/* The same for several steppers, some of which may be NULL.  Compilers run side by
   side, one a processor, where a cache keeps their results. */
NEVH_API void nevh_steppers_foresee(nevh_stepper *const[], size_t count,
                                    double steps);
/* Seconds that compiling would save: the interpreter's time for so many steps less
   that of the compiled ones and of the compiler.  The sum decides for several
   steppers that are compiled together or not at all.  Nothing is compiled.
   returns  NAN where steps cannot be compiled, or options.native forbids it */
NEVH_API double nevh_stepper_native_saves(nevh_stepper *, double steps);
/* True if a scheme's steps can be compiled at all; false for NULL.  Thread-safe. */
NEVH_API bool nevh_integrator_native(const nevh_integrator *);

NEVH_API nevh_counts nevh_stepper_counts(const nevh_stepper *);
/* The field that the stepper takes its gradients from: its counts, steps and
   values.  Owned by the stepper. */
NEVH_API nevh_field *nevh_stepper_field(nevh_stepper *);

/* Writes the pairs of bodies with -k/|a - b| which a scheme by parts moves in Jacobi
   coordinates; they are found at the state to plan at.
   text     out: "((x[1], x[2]), x[3])" where x[2] moves about x[1] and x[3] about the
            centre of mass of both, by first coordinates; cut off at size; NULL if size
            is 0.  Where there are no such pairs it is the reason why attractions stay
            in B, or empty where there are none
   whole    out, or NULL: whether H has nothing else, so that steps are exact
   returns  the number of pairs; 0: there are none, or the scheme is another one */
NEVH_API size_t nevh_stepper_hierarchy(const nevh_stepper *, char text[],
                                       size_t size, bool *whole);
/* The first coordinate of the body that coordinate k belongs to; k where no pair moves
   it. */
NEVH_API size_t nevh_stepper_body(const nevh_stepper *, size_t k);
/* The gradient of B, by which a scheme by parts kicks; of other schemes that of H.
   t, q, p  one state: the stepper's width has to be 1
   dh_dq    out, n numbers
   returns  NEVH_OK; NEVH_EINVAL; or a status that is recorded in the stepper's field */
NEVH_API int nevh_stepper_kick(nevh_stepper *, double t, const double q[],
                               const double p[], double dh_dq[]);

/* Is called with the state after `step` steps, at time t.  A result other
   than 0 stops the run. */
typedef int (*nevh_observe_fn)(void *data, size_t step, double t,
                               const double q[], const double p[]);
typedef struct {
    nevh_observe_fn observe;
    void *data;
    size_t every; /* steps between calls; 0 means 1.  The first and the last
                     state are always shown.  observe may change it: the next call
                     is at the next multiple. */
} nevh_observer;

/* `steps` steps of h from t0, the time of step i being t0 + i*h (the sum of
   their times where the scheme chooses them).
   q, p       in and out, n x width each
   observers  n_observers of them; NULL when that is 0.  The orbit does not
              depend on them, to the last bit.
   returns    as nevh_stepper_apply; NEVH_STOPPED when an observer stopped the
              run.  q and p are the last good state; nevh_stepper_taken tells
              after how many steps. */
NEVH_API int nevh_run(nevh_stepper *, double t0, double h, size_t steps,
                      double q[], double p[], const nevh_observer observers[],
                      size_t n_observers);
/* From t0 to t_end in steps of h, of which the last may be shorter.  Where
   t_end - t0 is within 1e-9 of a whole number of steps, h is adjusted to it;
   else the end is reached by one step more that branches off: the steps before
   it are those of nevh_run, bit for bit, and the stepper's memory, time and
   gain stay with the state before the end.  For schemes of own time the length
   of that last step is found by GSL's root finding.
   returns    as nevh_run; NEVH_EINVAL when h leads away from t_end, or when
              there would be more than 2^53 steps; NEVH_ENOMEM
   cost       allocates a few copies of the state */
NEVH_API int nevh_run_until(nevh_stepper *, double t0, double h, double t_end,
                            double q[], double p[],
                            const nevh_observer observers[],
                            size_t n_observers);
/* As nevh_run_until, of one orbit, whose states at given times are kept.  A time
   between two steps is reached by a shorter step that branches off, so that the
   orbit does not depend on the times.
   times    in, count, in the order in which the run passes them, from t0 to
            t_end; may be equal
   states   out, 2n x count: states[k*count + i] at times[i], coordinates first,
            then momenta
   kept     out: how many of them there are, also where the run failed or was
            stopped; NULL: not wanted
   returns  as nevh_run_until; NEVH_EINVAL where a time is out of order, or the
            stepper's width is not 1
   cost     a step for each time between two steps; of taylor no series, unless
            a step is longer than two */
NEVH_API int nevh_run_at(nevh_stepper *, double t0, double h, double t_end,
                         const double times[], size_t count, double states[],
                         size_t *kept, double q[], double p[],
                         const nevh_observer observers[], size_t n_observers);
/* A run to t_end; members that are 0 are not used. */
typedef struct {
    double t0, h, t_end; /* as of nevh_run_until */
    const nevh_observer *observers;
    size_t n_observers;
    /* Samples: sample(sample_data, i, times[i], q, p) is called at each of n_times
       times, in the order in which the run passes them; a result other than 0
       stops the run.  times NULL: at equal distances, the first at t0, the last at
       t_end; n_times is at least 2.  Samples at the time of a state come before its
       observers.  Samples may not save the stepper. */
    const double *times;
    size_t n_times;
    nevh_observe_fn sample;
    void *sample_data;
    /* To continue a saved run: steps and samples before, and the time of the state
       (used where steps_before is not 0). */
    size_t steps_before, samples_before;
    double t_before;
} nevh_orbit;
/* As nevh_run_until, with samples as those of nevh_run_at.  Observers of a state
   are called before samples between it and the next step (after those before it
   where the scheme chooses its own time, or holds series), and may save the
   stepper: it and q, p are all that a run needs to continue to the last bit.
   Steps that no observer or sample needs are taken in batches.
   q, p     in and out, n x width; with samples the width is 1
   returns  as nevh_run_at; NEVH_STOPPED where an observer or sample stopped it */
NEVH_API int nevh_orbit_run(nevh_stepper *, const nevh_orbit *, double q[],
                            double p[]);
/* Steps completed by the last run, including nevh_orbit.steps_before. */
NEVH_API size_t nevh_stepper_taken(const nevh_stepper *);

#ifdef __cplusplus
}
#endif
#endif
