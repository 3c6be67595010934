/* nevh: the pendulum, H = p^2/(2 m l^2) - m g l cos q, q from straight down.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "models_private.h"
#include "system/motion_private.h"
#include <math.h>

NEVH_BODY(cosine, void, { return -nevh_c(0) * nevh_cos(nevh_q(0)); })

NEVH_GRADIENT(cosine, void,
              { nevh_dh_dq(0) = nevh_c(0) * nevh_sin(nevh_q(0)); })

const nevh_term nevh__cosine_term = {.effect = "gravity",
                                     .nq = 1,
                                     .nc = 1,
                                     NEVH_FORMS(cosine),
                                     NEVH_GRADIENTS(cosine)};

static nevh_system *pendulum_system(const void *params) {
    const nevh_pendulum *a = params;
    nevh_term terms[] = {nevh__kinetic_term, nevh__cosine_term};
    terms[0].c = (const double[]){a->m * (a->l * a->l)};
    terms[1].c = (const double[]){a->m * a->g * a->l};
    return nevh__model_system(1, terms, 2);
}

static double pendulum_hamiltonian(double t, const double q[], const double p[],
                                   const void *params) {
    const nevh_pendulum *a = params;
    (void)t;
    return p[0] * p[0] / (2 * a->m * (a->l * a->l)) -
           a->m * a->g * a->l * cos(q[0]);
}

static int pendulum_exact(const void *params, double t, const double q0[],
                          const double p0[], double q[], double p[]) {
    const nevh_pendulum *a = params;
    long double m = a->m, l = a->l, to_q = q0[0], to_p = p0[0];
    if (!isfinite(t))
        return NEVH_EDOM;
    if (a->g != 0)
        nevh__swing(t, m * l * l, m * a->g * l, &to_q, &to_p);
    else
        to_q += to_p * t / (m * l * l);
    return nevh__model_state(1, &to_q, &to_p, q, p);
}

const nevh_model nevh__pendulum_entry = {
    .name = "pendulum",
    .title = "Pendulum",
    .n = 1,
    .defaults = &(const nevh_pendulum){.m = 1, .l = 1, .g = 9.8},
    .q = (const double[]){2},
    .p = (const double[]){0},
    .coords = (const char *const[]){"phi"},
    .system = pendulum_system,
    .hamiltonian = pendulum_hamiltonian,
    .exact = pendulum_exact,
};
const nevh_model *const nevh_pendulum_model = &nevh__pendulum_entry;
