/* nevh: what the probes of a system share.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_PROBE_PRIVATE_H
#define NEVH_PROBE_PRIVATE_H

#include "system/system_private.h"

/* Around which states a term is tried. */
typedef struct {
    double t;
    const double *q, *p, *scale; /* q, p or scale may be NULL */
    size_t n;
    uint64_t random;
    double largest[2]; /* of q, and of p */
} nevh__origin;

nevh__origin nevh__origin_at(size_t n, double t, const double q[],
                             const double p[], const double scale[]);

/* The length over which variable i of kind x is varied; `first` is 0 for
   coordinates, n for momenta. */
double nevh__spread(const nevh__origin *, const double x[], size_t first,
                    size_t i);

/* The properties of T that values of H show. */
typedef struct {
    bool quadratic;
    const char *term; /* with the largest third difference in its momenta; NULL
                         if none reads any */
    double third;     /* that difference, relative */
} nevh__kinetic;

/* Evaluates every enabled term that reads momenta along lines in them, around
   (t, q, p), near and far; arguments as those of nevh_system_probe.
   returns  NEVH_OK; NEVH_EDOM when a term could be evaluated on no line (then
            quadratic is false, and the term is named); NEVH_ENOMEM
   cost     64 values of each such term instance, thread-safe */
int nevh__system_probe_kinetic(const nevh_system *, double t, const double q[],
                               const double p[], const double scale[],
                               nevh__kinetic *result);

/* Evaluates every enabled term that reads momenta and the time at pairs of
   both.
   term     out, the first whose part in the momenta depends on time; NULL: none
   returns  NEVH_OK or NEVH_ENOMEM
   cost     88 values of each such term instance, thread-safe */
int nevh__system_probe_kinetic_time(const nevh_system *, double t,
                                    const double q[], const double p[],
                                    const double scale[], const char **term);

#endif
