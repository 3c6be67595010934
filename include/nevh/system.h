/* nevh: a Hamiltonian as a sum of terms.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SYSTEM_H
#define NEVH_SYSTEM_H

#include <nevh/status.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* H(t, q, p) in the user's own words: all that is needed to begin.
   q and p have as many elements as the system has degrees of freedom. */
typedef double (*nevh_value_fn)(double t, const double q[], const double p[],
                                const void *params);

/* The value of one instance of a term.  q, p and c hold what the instance
   declared to read, in that order: q[k] is its k-th coordinate, not the
   system's. */
typedef double (*nevh_term_fn)(double t, const double q[], const double p[],
                               const double c[], const void *params);

/* The same for `width` states (or instances) at once, lanes innermost:
   q[k*width + lane], p, c likewise, t[lane], h[lane].  width is a multiple
   of 8.  A lane must not depend on its neighbours. */
typedef void (*nevh_block_fn)(size_t width, const double t[], const double q[],
                              const double p[], const double c[],
                              const void *params, double h[]);

/* Exact derivatives in the same layout: dh_dq[k*width + lane] is the
   derivative with respect to the instance's k-th coordinate.  Either output
   is NULL when it is not wanted. */
typedef void (*nevh_block_gradient_fn)(size_t width, const double t[],
                                       const double q[], const double p[],
                                       const double c[], const void *params,
                                       double dh_dq[], double dh_dp[]);

/* The same derivatives of one instance at one state: q, p and c are what
   nevh_term_fn is handed, and dh_dq[k] belongs to q[k].  Either output is NULL
   when it is not wanted.  It gives the results of the block, bit for bit, also
   where a half is wanted alone, and is but a shorter way for one orbit of up to
   eight instances, which then needs no blocks.  Where nevh_exact is planned the
   two are compared at some states, and NEVH_ENOGRAD refuses what differs.
   Sine and the like in vectors are not rounded as those of <math.h>:
   NEVH_GRADIENT of <nevh/body.h> makes both functions from one text, and
   nevh_point_sin is for those that are written by hand. */
typedef void (*nevh_point_gradient_fn)(double t, const double q[],
                                       const double p[], const double c[],
                                       const void *params, double dh_dq[],
                                       double dh_dp[]);

/* The value of one instance over complex numbers, for the complex step: pairs
   of real and imaginary part, so that C++ can include this header.  Imaginary
   parts are tiny (1e-100 of the variables): absolute values, comparisons and
   conjugation must look at the real part alone. */
typedef void (*nevh_complex_fn)(double t, const double q[][2],
                                const double p[][2], const double c[],
                                const void *params, double h[2]);

/* Tells whether an instance is a function of the actions (s q^2 + p^2/s)/2 of its
   coordinates alone, for all states; it is only asked of terms with as many momenta.
   of       of[k]: which of the coordinates has the k-th momentum
   s        out: the s of each coordinate, positive; 0 where the instance does not
            depend on it */
typedef bool (*nevh_actions_fn)(const double c[], const void *params,
                                const size_t of[], double s[]);

/* A term of H: `count` instances of one function (a spring between each pair
   of neighbours is one term).  It is handed only what it declares to read, so
   a declaration cannot lie; from the declarations follow separability, sparse
   gradients, and that what is off is never evaluated. */
typedef struct {
    const char *effect;  /* the effect it belongs to; required */
    const char *name;    /* unique in the system; NULL: the effect's name, made
                            unique by a number */
    size_t nq, np, nc;   /* coordinates, momenta, constants of one instance */
    const size_t *q;     /* count x nq indices; NULL: 0 ... nq-1 */
    const size_t *p;     /* count x np indices; NULL: 0 ... np-1 */
    const double *c;     /* count x nc constants; NULL when nc is 0 */
    size_t count;        /* instances; 0 means 1 */
    bool time;           /* reads t; a term that does not is handed t = 0 */
    nevh_term_fn value;  /* may be NULL when block is given */
    nevh_block_fn block; /* NULL: value, lane by lane */
    nevh_block_gradient_fn gradient;       /* NULL: no exact gradient */
    nevh_complex_fn complex_value;         /* NULL: no complex step */
    const void *params;                    /* borrowed; outlives the system */
    nevh_point_gradient_fn point_gradient; /* NULL: gradient, also for one;
                                              else gradient is there, too */
    nevh_block_fn time_slope; /* NULL, or the derivative with respect to t, in
                                 block form: for the balance of the energy,
                                 else found by differences */
    bool curved; /* is known to be no polynomial of degree 2 or less; else its
                    values and derivatives at some states decide */
    nevh_actions_fn actions; /* NULL: it is no function of actions */
} nevh_term;

/* Properties of the sum of the enabled terms. */
enum nevh_trait {
    NEVH_SEPARABLE = 1,         /* H = T(t, p) + V(t, q) */
    NEVH_AUTONOMOUS = 2,        /* H does not read t */
    NEVH_QUADRATIC_KINETIC = 4, /* T is quadratic in p; no declaration says so:
                                   where a scheme needs it, H is probed */
    NEVH_PARTS = 8, /* forms of degree 2 with constant coefficients that have
                       all momenta, -k/|q| and V(t, q); terms are probed, too */
};

typedef struct nevh_system nevh_system;

/* A system of n degrees of freedom without terms.
   returns  the system, to be freed with nevh_system_free; NULL only when
            memory is out.  With n = 0 the system is there but carries
            NEVH_EINVAL. */
NEVH_API nevh_system *nevh_system_new(size_t n);

/* A system whose H is one function that reads everything (effect "H").
   params   borrowed; may be NULL
   returns  as nevh_system_new; carries NEVH_EINVAL when H is NULL */
NEVH_API nevh_system *nevh_system_from(size_t n, nevh_value_fn H,
                                       const void *params);

/* NULL is allowed.  Steppers and fields made from it must be freed before. */
NEVH_API void nevh_system_free(nevh_system *);

/* Adds a term.  The description, its indices and constants are copied.
   An index may be read only once by one instance.
   returns  NEVH_OK; NEVH_EINVAL (indices out of range or repeated, no
            function, a point gradient without a gradient, a name used twice,
            an empty effect name), NEVH_ENOMEM.
            The system is as before on failure, but carries the status: no
            stepper is made from a system that lacks what it was meant to
            have. */
NEVH_API int nevh_system_add(nevh_system *, const nevh_term *);

/* Adds the kinetic energy of masses, the sum over k of p_k^2 / (2 m_k), in all
   forms that a term may have.  Say it so where T is no more than that: one
   orbit is then faster than with a term of one's own.
   effect   as nevh_term has it
   masses   in, n of them, or moments of inertia, copied; NULL: 1 each
   returns  NEVH_OK; NEVH_EINVAL (a mass that is 0 or not finite, and as
            nevh_system_add), NEVH_ENOMEM; carried by the system as after
            nevh_system_add */
NEVH_API int nevh_system_add_masses(nevh_system *, const char *effect,
                                    const double masses[]);

/* Adds friction: dp_k/dt gains -rates[k] p_k.  It is proportional to momentum,
   not to velocity, and no term of H: energies do not count it.
   effect   the effect that it belongs to, on or off by name like any other.
            Terms and further friction may have the same one: they are switched
            together.  The rates of all effects that are on add up.
   rates    in, n rates in 1/time, copied.  Negative ones drive the momentum;
            with zeros only, orbits are those without friction, bit for bit.
   returns  NEVH_OK; NEVH_EINVAL (no name, rates NULL or not finite),
            NEVH_ENOMEM; carried by the system as after nevh_system_add */
NEVH_API int nevh_system_add_friction(nevh_system *, const char *effect,
                                      const double rates[]);

/* Switches an effect, that is all terms and friction of that effect name, on or
   off.  Steppers and fields made before notice, and refuse to go on.
   returns  NEVH_OK; NEVH_EINVAL when nothing has that effect, and the system
            carries that status from then on, as after nevh_system_add: ask
            nevh_system_effect_name first where names come from a user */
NEVH_API int nevh_system_enable(nevh_system *, const char *effect, bool on);

/* The first error of this system, or NEVH_OK; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_system_status(const nevh_system *);
/* The message of that error, or ""; never NULL. */
NEVH_API const char *nevh_system_message(const nevh_system *);

/* Degrees of freedom. */
NEVH_API size_t nevh_system_dof(const nevh_system *);

/* Effects in the order in which they were first named. */
NEVH_API size_t nevh_system_effect_count(const nevh_system *);
/* NULL when i is out of range. */
NEVH_API const char *nevh_system_effect_name(const nevh_system *, size_t i);
/* false for an unknown effect, too. */
NEVH_API bool nevh_system_effect_on(const nevh_system *, const char *effect);

/* The friction that is on, summed over its effects.
   rates    out, n; NULL when not wanted
   returns  whether a rate is not 0
   cost     n times the frictions added; thread-safe */
NEVH_API bool nevh_system_friction(const nevh_system *, double rates[]);

/* The traits that follow from the declarations of the enabled terms alone,
   an or of nevh_trait.  A term that reads coordinates and momenta makes the
   sum non-separable here; nevh_system_probe looks into it.
   cost     one pass over the terms; thread-safe */
NEVH_API unsigned nevh_system_traits(const nevh_system *);

/* The part of H = A + B that an effect belongs to, for schemes by parts: A, fast, is
   quadratic forms with constant coefficients and, of bodies whose momenta have but
   p^2/2m, -k/|q| of two or three coordinates; B = V(t, q) is slow. */
typedef enum {
    NEVH_BY_TERM, /* terms that are such forms are in A, others in B */
    NEVH_FAST,    /* all its terms are in A */
    NEVH_SLOW     /* all its terms are in B */
} nevh_speed;
/* Says so; the first is the default.  Steppers and fields made before refuse to go
   on.
   returns  NEVH_OK; NEVH_EINVAL when nothing has that effect, carried by the system
            as after nevh_system_enable */
NEVH_API int nevh_system_set_speed(nevh_system *, const char *effect,
                                   nevh_speed);
/* The parts of an effect that is on.
   fast, slow  out, the instances of its terms in A and in B; may be NULL
   term        out, may be NULL: the first term of any effect that belongs to neither
               part, so that no scheme by parts fits; NULL: there is none
   returns     NEVH_OK; NEVH_ESTRUCT where there is such a term, or A is empty;
               NEVH_EINVAL when nothing has that effect; NEVH_ENOMEM
   cost        a few gradients of each instance; thread-safe */
NEVH_API int nevh_system_parts(const nevh_system *, const char *effect,
                               size_t *fast, size_t *slow, const char **term);

/* The parts of all effects, as of nevh_system_parts, at the cost of one.
   fast, slow  out, a number for each effect; 0 of those that are off
   returns     as nevh_system_parts */
NEVH_API int nevh_system_effect_parts(const nevh_system *, size_t fast[],
                                      size_t slow[]);

/* The separability that values of H alone show. */
typedef struct {
    bool separable;
    const char *term; /* the term with the largest mixed part; NULL if no term
                         reads coordinates and momenta */
    double mixed;     /* |H(q1,p1) + H(q2,p2) - H(q1,p2) - H(q2,p1)| of that
                         term over the size of its four values; rounding
                         where the term is a sum T(p) + V(q) */
    size_t states;    /* pairs of states the term could be evaluated at */
} nevh_separability;

/* Evaluates every enabled term that reads coordinates and momenta at pairs of
   states around (t, q, p), to see whether it is a sum T(p) + V(q).
   q, p     in, n each; NULL: zeros
   scale    in, 2n lengths over which coordinates and then momenta vary;
            NULL: the size of q and p, 1 where all are 0
   returns  NEVH_OK; NEVH_EDOM when a term could be evaluated at no pair (then
            separable is false); NEVH_ENOMEM; the system's own status
   cost     64 values of each such term instance, thread-safe */
NEVH_API int nevh_system_probe(const nevh_system *, double t, const double q[],
                               const double p[], const double scale[],
                               nevh_separability *result);

#ifdef __cplusplus
}
#endif
#endif
