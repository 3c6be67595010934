/* nevh: gradients of H from its values.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_GRADIENT_H
#define NEVH_GRADIENT_H

#include <nevh/system.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct nevh_gradient nevh_gradient;

/* Central differences of order 2, 4, 6, 8 at x +- delta, x +- 2 delta, ...;
   the complex step, for terms that bring a complex form; and the derivatives
   that the terms bring themselves. */
NEVH_API extern const nevh_gradient *const nevh_central2;
NEVH_API extern const nevh_gradient *const nevh_central4;
NEVH_API extern const nevh_gradient *const nevh_central6;
NEVH_API extern const nevh_gradient *const nevh_central8;
NEVH_API extern const nevh_gradient *const nevh_complex_step;
NEVH_API extern const nevh_gradient *const nevh_exact;

/* All methods, ended by NULL. */
NEVH_API const nevh_gradient *const *nevh_gradients(void);
/* NULL when there is none of that name. */
NEVH_API const nevh_gradient *nevh_gradient_named(const char *name);
NEVH_API const char *nevh_gradient_name(const nevh_gradient *);
/* Order of the difference; 0 for derivatives without truncation error. */
NEVH_API int nevh_gradient_order(const nevh_gradient *);

/* The choice of compiled steps of formulas: native code by the C compiler that the
   environment names (CC) or cc, gcc or clang.  The orbit is the same to the last
   bit.  By default steps are compiled if the expected number of steps repays the
   compiler's time. */
typedef enum {
    NEVH_NATIVE_AUTO,
    NEVH_NATIVE_ALWAYS,
    NEVH_NATIVE_NEVER
} nevh_native_use;

/* Options of planning a field or a stepper; zeros and NULLs are the defaults. */
typedef struct {
    const nevh_gradient *gradient; /* NULL: nevh_central4 */
    double gradient_step;          /* the half-spread delta of every coordinate
                                      and momentum; 0: chosen by trial around
                                      the state to plan at */
    const double *gradient_steps;  /* 2n of them, coordinates first, 0: as
                                      gradient_step; NULL: all as that */
    const double *scale; /* 2n lengths over which H varies; NULL: found out */
    double t;            /* the state to plan at, best the one to start from: */
    const double *q, *p; /* n x width each; NULL: states around zero */
    size_t width;        /* orbits side by side; 0 means 1 */
    double tolerance;    /* of adaptive schemes, relative; 0: fixed steps */
    const nevh_system *transform; /* of time: s(q, p) > 0 as a system, borrowed;
                                     NULL: none; see <nevh/transform.h> */
    double binding;               /* omega of Tao's schemes, 1/t; 0: chosen */
    bool portable; /* terms with a scalar value are evaluated through it, never
                      in SIMD blocks: values that call functions other than
                      those of <nevh/simd.h> have one result for both.  Formulas
                      give the same digits without */
    bool balance;  /* steppers keep account of the energy that comes in from
                      outside: see nevh_stepper_gain */
    nevh_native_use native;   /* of steppers; see nevh_stepper_native */
    double steps_foreseen;    /* how many the stepper will take; 0: unknown, and
                                 NEVH_NATIVE_AUTO compiles nothing */
    const char *native_cache; /* the folder of compiled steps, borrowed; NULL:
                                 nevh in $XDG_CACHE_HOME, else in ~/.cache; "":
                                 nothing is kept */
    size_t substeps; /* of nevh_respa in a step; 0 means 8, at most 10000 */
} nevh_options;

/* A field is the gradient of H, planned: a system, a gradient method with its
   steps, and workspace.  Everything that can fail for lack of memory or
   structure has happened once it is made.  One thread at a time may use it;
   several fields may share one system that is not changed meanwhile. */
typedef struct nevh_field nevh_field;

/* options   NULL: the defaults
   returns   the field, to be freed with nevh_field_free; NULL only when memory
             is out.  A field that could not be planned carries its status:
             NEVH_ENOGRAD (a term lacks the gradient or complex form asked
             for, or its own gradient is not that of its values, or its point
             gradient not that gradient: the message names term, variable and
             both numbers), NEVH_EINVAL, or the system's own status.
   cost      of a few thousand values a variable, where steps are chosen by
             trial: some milliseconds for a small system.  Of many
             instances, lanes, or variables of an instance, 64 are tried.  A
             step set by the caller is used unchecked, at no cost. */
NEVH_API nevh_field *nevh_field_new(const nevh_system *, const nevh_options *);
NEVH_API void nevh_field_free(nevh_field *); /* NULL is allowed */
/* The status of planning or of the last call; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_field_status(const nevh_field *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_field_message(const nevh_field *);

/* The gradient of the sum of the enabled terms.
   width    states side by side, any number from 1; lanes innermost
   t        in, width
   q, p     in, n x width each
   dh_dq    out, n x width, overwritten; NULL when not wanted
   dh_dp    out, n x width, overwritten; NULL when not wanted
   cost     order values a variable, instance and state (central), 2 where H
            was found to be quadratic in the variable
   traps    a caller's traps of floating-point exceptions stay on, also in
            nevh_field_value and nevh_field_effects: to hold them takes half as
            long as the gradient of a pendulum
   returns  NEVH_OK; NEVH_EDOM when a value is not finite (the message names
            the term; outputs are undefined); NEVH_ESTALE; the status of a
            field that could not be planned */
NEVH_API int nevh_field_gradient(nevh_field *, size_t width, const double t[],
                                 const double q[], const double p[],
                                 double dh_dq[], double dh_dp[]);

/* The values of H at `width` states: h[lane].  Summed with compensation. */
NEVH_API int nevh_field_value(nevh_field *, size_t width, const double t[],
                              const double q[], const double p[], double h[]);

/* The value of each effect at one state: h[i] for nevh_system_effect_name(i),
   0 for those that are off.  h has nevh_system_effect_count elements. */
NEVH_API int nevh_field_effects(nevh_field *, double t, const double q[],
                                const double p[], double h[]);

/* The energy of groups of variables, such as bodies, at one state: h[g] is the
   sum of all instances of enabled terms that read a coordinate or a momentum of
   group g.  An interaction counts for all groups that take part in it, so that
   the sum over groups is not H.
   group    in, n: of coordinate k and its momentum, less than `count`; any other
            number: of none
   h        out, count
   cost     one value of H, and the square of the number of variables that an
            instance reads
   returns  as nevh_field_value */
NEVH_API int nevh_field_groups(nevh_field *, double t, const double q[],
                               const double p[], size_t count,
                               const size_t group[], double h[]);

/* The step delta that central differences take in coordinate i (i < n) or
   momentum i - n of the given term instance; 0 if it does not read it. */
NEVH_API double nevh_field_step(const nevh_field *, const char *term,
                                size_t instance, size_t i);

/* The origin of the difference step of one variable of one term instance, and
   estimates of the errors of the derivative, the worst over the states tried in
   planning. */
typedef struct {
    const char *term, *effect;
    size_t instance;
    bool momentum; /* of p[index]; else of q[index] */
    size_t index;
    double step;                 /* delta; a power of two unless given */
    int order;                   /* 2 where H is quadratic, else the method's */
    bool given;                  /* by the user: no estimates were made */
    bool blind;                  /* nothing varied: a guess from the scale */
    bool rough;                  /* no step is good: a kink, or noise in H */
    double truncation, rounding; /* of the derivative */
    double size;                 /* largest derivative met */
} nevh_step_report;

/* Reports on the steps of a field, one a variable of every instance that was
   tried; 0 of them where there are no differences. */
NEVH_API size_t nevh_field_step_count(const nevh_field *);
/* i < nevh_field_step_count. */
NEVH_API nevh_step_report nevh_field_step_report(const nevh_field *, size_t i);

/* The part of an energy error that rounding in the differences makes
   inevitable: an estimate of |H(t) - H(0)| after `steps` steps of h from
   around (t, q, p), n each; a random walk, so it grows with the root of steps.
   returns  NEVH_OK, or as nevh_field_value */
NEVH_API int nevh_field_energy_floor(nevh_field *, double t, const double q[],
                                     const double p[], double h, size_t steps,
                                     double *floor);

/* Counts of evaluations of a field since it was made.  They depend only on the
   computation, never on padding or on the machine. */
typedef struct {
    uint64_t values;     /* evaluations of term instances */
    uint64_t gradients;  /* evaluations of dH/dq of all enabled terms; where H
                            is not separable, of the whole gradient */
    uint64_t sweeps;     /* iterations over the stages of implicit steps */
    uint64_t newtons;    /* implicit steps that fixed-point iteration did not
                            solve, or too slowly: simplified Newton took over */
    uint64_t rescues;    /* those that needed GSL's multiroot solver as well */
    double hamiltonians; /* values over the number of enabled instances */
    uint64_t instances;  /* that number */
} nevh_counts;
NEVH_API nevh_counts nevh_field_counts(const nevh_field *);
/* Evaluations of instances of the terms of one effect; 0 if unknown or off. */
NEVH_API uint64_t nevh_field_effect_values(const nevh_field *,
                                           const char *effect);
/* The number of pieces that a gradient is taken of, one after another: a term,
   or neighbouring terms of one formula.  Of some thousands each costs as much
   as some tens of instances of a term.  0: there is no field. */
NEVH_API size_t nevh_field_pieces(const nevh_field *);

#ifdef __cplusplus
}
#endif
#endif
