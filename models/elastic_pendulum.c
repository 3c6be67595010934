/* nevh: a mass on a spring that swings in a plane.
   SPDX-License-Identifier: GPL-3.0-or-later

   H = p_r^2/(2m) + p_theta^2/(2 m r^2) + k/2 (r - l)^2 - m g r cos(theta);

   r is the length of the spring, theta its angle from straight down. */
#include "models_private.h"
#include <math.h>

NEVH_BODY(angular, void, {
    nevh_num r = nevh_q(0), p = nevh_p(0);
    return p * p / (2 * nevh_c(0) * (r * r));
})

NEVH_GRADIENT(angular, void, {
    double r = nevh_q(0), p = nevh_p(0), inertia = nevh_c(0) * (r * r);
    nevh_dh_dq(0) = -p * p / (inertia * r);
    nevh_dh_dp(0) = p / inertia;
})

NEVH_BODY(weight, void, {
    nevh_num r = nevh_q(0), theta = nevh_q(1);
    return -nevh_c(0) * r * nevh_cos(theta);
})

NEVH_GRADIENT(weight, void, {
    double r = nevh_q(0), theta = nevh_q(1);
    nevh_dh_dq(0) = -nevh_c(0) * nevh_cos(theta);
    nevh_dh_dq(1) = nevh_c(0) * r * nevh_sin(theta);
})

enum { R, THETA };

static nevh_system *elastic_system(const void *params) {
    const nevh_elastic_pendulum *a = params;
    static const size_t r[] = {R}, theta[] = {THETA};
    nevh_term terms[] = {nevh__kinetic_term,
                         {.effect = "kinetic",
                          .name = "angular",
                          .nq = 1,
                          .np = 1,
                          .nc = 1,
                          .q = r,
                          .p = theta,
                          .c = &a->m,
                          NEVH_FORMS(angular),
                          NEVH_GRADIENTS(angular)},
                         nevh__spring_term,
                         {.effect = "gravity",
                          .nq = 2,
                          .nc = 1,
                          .c = (const double[]){a->m * a->g},
                          NEVH_FORMS(weight),
                          NEVH_GRADIENTS(weight)}};
    terms[0].name = "radial";
    terms[0].c = &a->m;
    terms[2].c = (const double[]){a->k, a->l};
    return nevh__model_system(2, terms, 4);
}

static double elastic_hamiltonian(double t, const double q[], const double p[],
                                  const void *params) {
    const nevh_elastic_pendulum *a = params;
    double r = q[R], v = p[THETA] / r, stretch = r - a->l;
    (void)t;
    return (p[R] * p[R] + v * v) / (2 * a->m) + a->k / 2 * (stretch * stretch) -
           a->m * a->g * r * cos(q[THETA]);
}

const nevh_model nevh__elastic_pendulum_entry = {
    .name = "elastic-pendulum",
    .title = "Elastic pendulum",
    .n = 2,
    .defaults =
        &(const nevh_elastic_pendulum){.m = 1, .k = 40, .l = 1, .g = 9.8},
    /* Pulled out and turned aside.  The spring, sqrt(k/m) = 6.3 rad/s, and the
       swing, 2.8 rad/s where it hangs, trade energy and chaos is near. */
    .q = (const double[]){1.5, 1},
    .p = (const double[]){0, 0},
    .coords = (const char *const[]){"r", "theta"},
    .system = elastic_system,
    .hamiltonian = elastic_hamiltonian,
};
const nevh_model *const nevh_elastic_pendulum_model =
    &nevh__elastic_pendulum_entry;
