/* nevh: the Hamiltonian that a symplectic scheme keeps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_SHADOW_H
#define NEVH_SHADOW_H

#include <nevh/run.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Steps of h of a symplectic scheme follow, but for errors that are exponentially
   small in 1/h, the exact orbits of a modified Hamiltonian, its shadow: H and a
   series in h.  Here are the first terms of that series,

       shadow = H + h d Hp.Hq + h^2 (a Hp.Hqq Hp + b Hq.Hpp Hq + c Hq.Hpq Hp),

   where Hp is dH/dp, Hqq the second derivatives by q, and so on:

                                    d      a      b      c     remainder
       symplectic-euler-a         -1/2   1/12   1/12     -      h^3
       symplectic-euler-b          1/2   1/12   1/12     -      h^3
       verlet                       0    1/12  -1/24     -      h^4
       position-verlet              0   -1/24   1/12     -      h^4
       lobatto2                     0    1/12  -1/24    1/12    h^4
       midpoint                     0   -1/24  -1/24    1/12    h^4

   [E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed.
   (2006), IX.3; for uses, and more terms from a run of steps, R. D. Skeel, D. J.
   Hardy, Practical construction of modified Hamiltonians, SIAM J. Sci. Comput. 23
   (2001) 1172-1188.]

   Along the run of steps the shadow stays level where H oscillates.  The series
   does not converge: beyond some h it is no better than H, and it says nothing of
   gradients whose differences are coarse.  One thread at a time. */
typedef struct nevh_shadow nevh_shadow;

/* h        of the steps, of either sign
   options  as the stepper's, of which scale (2n lengths over which H varies, NULL:
            probed around q, p) and portable matter; NULL: the defaults
   returns  to be freed with nevh_shadow_free; NULL only when memory is out;
            carries a status otherwise.  NEVH_ESTRUCT where there is no such
            shadow: for another scheme, an H that reads t, friction, a transform
            of time; NEVH_EINVAL where h is 0 or not finite.  The system is
            borrowed, and must not be changed.
   Second derivatives of formulas come from their tapes; of terms in C from
   differences of gradients, or of values where a term has no gradient. */
NEVH_API nevh_shadow *nevh_shadow_new(const nevh_system *,
                                      const nevh_integrator *, double h,
                                      const nevh_options *options);
NEVH_API void nevh_shadow_free(nevh_shadow *); /* NULL is allowed */
/* The status of planning or of the last call; NEVH_ENOMEM for NULL. */
NEVH_API int nevh_shadow_status(const nevh_shadow *);
/* The message to that status, or ""; never NULL. */
NEVH_API const char *nevh_shadow_message(const nevh_shadow *);
/* The power of h with which what is left out falls: 4, or 3 for symplectic
   Euler; 0 where there is no shadow. */
NEVH_API int nevh_shadow_order(const nevh_shadow *);

/* At one state, n each.
   energy   out, may be NULL: H there
   shadow   out, may be NULL: the shadow there; undefined on failure, both
   returns  NEVH_OK; NEVH_EDOM where one of them is not finite; NEVH_ESTALE where
            the system has changed; what planning failed with; NEVH_EINVAL for NULL
   cost     some five gradients of H by formulas; some 20 where terms in C bring
            gradients, and 6 values for each variable of such a one where not */
NEVH_API int nevh_shadow_value(nevh_shadow *, const double q[],
                               const double p[], double *energy,
                               double *shadow);

/* A nevh_observe_fn for runs of one orbit; data is the nevh_shadow.  States that
   are no whole number of steps from the first one, such as a shorter step to the
   end, are passed over. */
NEVH_API int nevh_shadow_observe(void *shadow, size_t step, double t,
                                 const double q[], const double p[]);
typedef struct {
    size_t samples;
    double energy, shadow; /* the largest |change| since the first state, of H
                              and of the shadow, in units of H */
    double correction;     /* the largest |shadow - H| met */
    double rounding;       /* what rounding alone may change them by */
    bool breaks_down; /* the shadow changes by more than rounding, and by more
                         than a quarter of what H does: steps are too long for these
                         terms of the series */
} nevh_shadow_report;
/* Zeros before the first observation and for NULL. */
NEVH_API nevh_shadow_report nevh_shadow_result(const nevh_shadow *);

#ifdef __cplusplus
}
#endif
#endif
