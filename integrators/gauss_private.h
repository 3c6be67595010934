/* nevh: coefficients of Gauss-Legendre methods.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_GAUSS_PRIVATE_H
#define NEVH_GAUSS_PRIVATE_H

#include <stddef.h>

enum { NEVH__MOST_STAGES = 64 };

typedef struct {
    size_t stages;
    double *c;  /* nodes in (0, 1), rising */
    double *b;  /* weights */
    double *mu; /* mu[j*stages + i] = a_ij / b_j; mu_ij + mu_ji = 1 exactly */
    double *guess; /* guess[j*stages + i]: Lagrange polynomial j at 1 + c_i */
    size_t *order; /* stages by rising weight */
} nevh__gauss;

/* NULL when memory is out; stages from 1 to NEVH__MOST_STAGES. */
nevh__gauss *nevh__gauss_new(size_t stages);
void nevh__gauss_free(nevh__gauss *);

#endif
