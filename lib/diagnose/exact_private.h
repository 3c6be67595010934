/* nevh: Hamiltonians whose motion is known.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_EXACT_PRIVATE_H
#define NEVH_EXACT_PRIVATE_H

#include "system/system_private.h"
#include <gsl/gsl_roots.h>

enum { NEVH__EXACT_DOF = 3 }; /* the most that any of them has */

typedef enum {
    NEVH__PENDULUM,
    NEVH__OSCILLATOR,
    NEVH__KEPLER,
    NEVH__EXACT_KINDS
} nevh__kind;

/* H = a p^2/2 + V(q) + const with
       V = -b cos(q - c)      a pendulum, b > 0
       V = b (q - c)^2/2      an oscillator, b > 0
       V = -b/|q|             Kepler's problem, b > 0 */
typedef struct {
    nevh__kind kind;
    size_t n;
    long double a, b, c;
    double doubt; /* of the constants, relative */
    gsl_root_fsolver *solver;
} nevh__exact_solution;

/* The solution that the system has around the orbit through (q, p) for times
   from t0 to t1.
   returns  NEVH_OK, also where none is recognised: *exact is NULL then;
            NEVH_ENOMEM */
int nevh__exact_recognise(nevh__exact_solution **exact, const nevh_system *,
                          double t0, double t1, const double q[],
                          const double p[]);
void nevh__exact_free(nevh__exact_solution *); /* NULL is allowed */
/* "Jacobi sn" */
const char *nevh__exact_name(const nevh__exact_solution *);
/* Carries a state on by t.  NEVH_OK or NEVH_EDOM. */
int nevh__exact_state(const nevh__exact_solution *, long double t,
                      const double q0[], const double p0[], double q[],
                      double p[]);
/* A time between 0 and `span`, as u is between 0 and 1: such that the motion
   is equally well covered everywhere. */
double nevh__exact_time(const nevh__exact_solution *, double span, double u,
                        const double q0[], const double p0[]);

#endif
