/* nevh: coefficients of implicit Runge-Kutta methods on symmetric nodes.
   SPDX-License-Identifier: GPL-3.0-or-later

   Coordinates are advanced with a_q, momenta with a_p.  The pair is symplectic
   if b_i a_q,ij + b_j a_p,ji = b_i b_j, which for mu_ij = a_ij / b_j reads
   mu_q,ij + mu_p,ji = 1, and symmetric in time if mu across the middle adds up
   to 1.  Rounding a and b breaks that and lets the energy drift by about 1e-18
   a step.  So of each four the one in [1/2, 2] is rounded and the others are
   mirrored as 1 - mu, which is exact; the rounded method is then symplectic to
   the last bit [Antonana, Makazaga, Murua, Numer. Algorithms 2017, sec. 3]. */
#ifndef NEVH_TABLEAU_PRIVATE_H
#define NEVH_TABLEAU_PRIVATE_H

#include <nevh/extend.h>
#include <stdbool.h>
#include <stddef.h>

enum { NEVH__MOST_STAGES = 64 };

/* A quadrature rule on [0, 1], symmetric, nodes rising. */
typedef struct {
    size_t stages;
    long double c[NEVH__MOST_STAGES], b[NEVH__MOST_STAGES];
} nevh__rule;

/* Matrices go column by column: a[j*stages + i]. */
typedef struct {
    size_t stages;
    double *c;           /* nodes */
    double *b;           /* weights */
    double *mu_q, *mu_p; /* a_ij / b_j */
    double *a_q, *a_p;   /* rounded mu times b */
    double *guess;       /* guess[j*stages + i]: Lagrange polynomial j at
                            1 + c_i */
    size_t steps;        /* that a guess from several steps takes slopes of */
    double *long_guess;  /* the same of these, the last step's first */
    size_t *order;       /* stages by rising size of the weight */
} nevh__tableau;

/* Gauss-Legendre, 1 to NEVH__MOST_STAGES: a_q = a_p.  Lobatto IIIA for
   coordinates and IIIB for momenta, from 2.  NULL when memory is out. */
nevh__tableau *nevh__gauss_new(size_t stages);
nevh__tableau *nevh__lobatto_new(size_t stages);
/* The implicit Euler method: one stage, at the end of the step.  NULL for more,
   or when memory is out. */
nevh__tableau *nevh__implicit_euler_new(size_t stages);
/* An implicit method of one's own. */
typedef struct {
    size_t stages;
    const long double *a, *b, *c; /* a row by row */
    bool symplectic;
} nevh__implicit_table;
extern const nevh_kernel nevh__implicit_kernel;
nevh__tableau *nevh__implicit_new(const nevh__implicit_table *);
/* The tableau of a scheme of one of the four. */
nevh__tableau *nevh__stage_tableau_new(const nevh_integrator *);
void nevh__tableau_free(nevh__tableau *);

/* Collocation on the rule's nodes for coordinates, its mirror for momenta;
   `alike`: they are the same but for rounding, and are to be so exactly. */
nevh__tableau *nevh__tableau_new(const nevh__rule *, bool alike);
void nevh__gauss_rule(size_t stages, nevh__rule *);
/* The number of steps whose derivatives predict those of the next; if several,
   their weights: of the derivative at stage j, k steps before the last,
   guess[(k*stages + j)*stages + i]. */
size_t nevh__guess_steps(size_t stages);
void nevh__guess_weights(const nevh__rule *, double guess[]);
/* Weights of `count` values at x whose polynomial of least squares is that at `to`. */
void nevh__guess_fit(size_t count, const long double x[], size_t degree,
                     long double to, long double weights[]);
/* Room for a tableau; and its order, once b is there. */
nevh__tableau *nevh__tableau_reserve(size_t stages, size_t steps);
void nevh__tableau_sort(nevh__tableau *);
/* P_s(x) and its derivative, |x| < 1; s from 1. */
long double nevh__legendre(size_t s, long double x, long double *slope);

#endif
