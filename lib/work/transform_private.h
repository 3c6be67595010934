/* nevh: the time transform of a step's Hamiltonian; see <nevh/transform.h>.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TRANSFORM_PRIVATE_H
#define NEVH_TRANSFORM_PRIVATE_H

#include <nevh/extend.h>

/* A step that takes less than this part of its nominal time gets nowhere. */
#define NEVH__LEAST_RATE 1e-9
/* The memory of a lane: NEVH__TRANSFORM_ROWS doubles. */
enum { NEVH__BEGUN, NEVH__ENERGY, NEVH__UNIT, NEVH__TRANSFORM_ROWS };

typedef struct nevh__transform {
    nevh_field *field;     /* of s */
    size_t capacity;       /* points that the arrays have room for */
    double *h, *s;         /* capacity */
    double *ds_dq, *ds_dp; /* n x capacity */
    double *effects;       /* of H, at one state */
    const double *memory;  /* H0 and s0 of the orbit under way */
} nevh__transform;

/* The field of w->options->transform, to be freed. */
int nevh__transform_field(nevh_work *, nevh_field **);
/* Takes over its failure. */
int nevh__transform_fail(nevh_work *, const nevh_field *);
/* Makes w->transform; refuses what cannot take one. */
int nevh__transform_plan(nevh_work *);
void nevh__transform_free(nevh__transform *);
/* Begins a step: memory is NEVH__TRANSFORM_ROWS doubles, zero for an orbit that
   starts here. */
int nevh__transform_begin(nevh_work *, double memory[], double t,
                          const double q[], const double p[]);
/* From the gradient of H (in dh_dq, dh_dp) to that of K; from H to K. */
int nevh__transform_gradient(nevh_work *, size_t points, const double t[],
                             const double q[], const double p[], double dh_dq[],
                             double dh_dp[]);
int nevh__transform_value(nevh_work *, size_t points, const double t[],
                          const double q[], const double p[], double h[]);
/* From the noise of grad H, as nevh__field_noise, to that of grad K. */
int nevh__transform_noise(nevh_work *, double t, const double q[],
                          const double p[], double noise_q[], double noise_p[]);
/* A part of the step that is `weight` long in tau: adds to w->elapsed the time
   that goes by, as fast as at this one state; a failure is recorded. */
int nevh__transform_pass(nevh_work *, double weight, const double t[],
                         const double q[], const double p[]);

#endif
