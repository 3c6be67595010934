/* nevh: what can be known of H from its values.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PROBE_H
#define NEVH_PROBE_H

#include <nevh/gradient.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    NEVH_IS_SEPARABLE,  /* H = T(t, p) + V(t, q) */
    NEVH_IS_AUTONOMOUS, /* H does not depend on t */
    NEVH_IS_QUADRATIC,  /* in the momenta: what Nystroem schemes need */
    NEVH_IS_REVERSIBLE, /* H(q, -p) = H(q, p), or H stays as it is where some
                           coordinates and the momenta of the others change
                           their signs: orbits run backwards, too */
    NEVH_IS_SMOOTH,     /* differences of order 4 find a good step */
    NEVH_FINDINGS
} nevh_question;

/* An answer, and what it rests on. */
typedef struct {
    bool holds;
    double evidence;  /* the largest violation met, relative to the values of H
                         compared (SMOOTH: estimated error over derivative);
                         rounding, about 1e-16, where it holds */
    double limit;     /* up to which it is taken for rounding */
    const char *term; /* the term that violates most; NULL: H as a whole.  Of
                         REVERSIBLE, where it holds and momenta alone are not
                         enough: "(y, p_x) -> -(y, p_x)"; owned by the probe */
    double t;         /* where that was met, */
    const double *q, *p; /* n each; owned by the probe */
} nevh_finding;

typedef struct nevh_probe nevh_probe;

/* Evaluates the enabled terms around a state: there, along a short pilot orbit,
   and at a few states displaced at random.
   options   of which t, q, p, scale and width (lane 0 is taken) matter; NULL:
             the defaults
   returns   the probe, to be freed with nevh_probe_free; NULL only when memory
             is out; carries NEVH_EDOM when H is finite nowhere around the
             state, or the system's own status
   cost      a few thousand values a variable; thread-safe over a system that
             is not changed meanwhile */
NEVH_API nevh_probe *nevh_probe_new(const nevh_system *, const nevh_options *);
NEVH_API void nevh_probe_free(nevh_probe *); /* NULL is allowed */
NEVH_API int nevh_probe_status(const nevh_probe *);
NEVH_API const char *nevh_probe_message(const nevh_probe *);

NEVH_API nevh_finding nevh_probe_finding(const nevh_probe *, nevh_question);
/* "separable", "autonomous", ...; "unknown" for what is no question. */
NEVH_API const char *nevh_question_name(nevh_question);
/* The lengths over which H varies, 2n, coordinates first; where H is quadratic
   in a variable, over which it varies as much as over the others. */
NEVH_API const double *nevh_probe_lengths(const nevh_probe *);

#ifdef __cplusplus
}
#endif
#endif
