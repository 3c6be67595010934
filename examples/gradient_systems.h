/* Systems with every form of H, for what measures gradients.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef GRADIENT_SYSTEMS_H
#define GRADIENT_SYSTEMS_H

#include <nevh/nevh.h>

/* H as one term, units of 1 and g = 9.8: NULL when memory is out.  The caller
   frees it. */
nevh_system *power_system(const int *n); /* x^n + p^2/2; cos x where n is 0 */
nevh_system *pendulum_system(void);
nevh_system *double_pendulum_system(void);
nevh_system *kepler_system(void); /* in the plane */
/* A free chain of masses 1 and springs exp(-r) + r - 1 (Toda). */
nevh_system *chain_system(size_t masses);

/* States side by side, and room for their gradients. */
typedef struct {
    size_t n, width;
    double *t;                     /* width */
    double *q, *p, *dh_dq, *dh_dp; /* n x width each */
} gradient_states;

/* States spread by up to `spread` around (q, p), n each; NULL: around 0.
   Without memory t is NULL. */
gradient_states gradient_states_new(size_t n, size_t width, const double q[],
                                    const double p[], double spread);
void gradient_states_free(gradient_states *);
/* nevh_field_gradient of them all. */
int gradient_states_evaluate(nevh_field *, gradient_states *);
/* CPU time of that in nanoseconds: the median of some rounds. */
double gradient_states_time(nevh_field *, gradient_states *);
/* The largest difference to the exact gradient over its largest component. */
double gradient_states_error(const gradient_states *,
                             const gradient_states *exact);

#endif
