/* nevh: two masses in a row between two walls, held by three springs.
   SPDX-License-Identifier: GPL-3.0-or-later

   H = p1^2/(2 m1) + p2^2/(2 m2)
       + k1/2 q1^2 + k2/2 q2^2 + coupling/2 (q1 - q2)^2;

   each q is measured from where its mass rests, both to the same side. */
#include "models_private.h"
#include "system/motion_private.h"
#include <math.h>

NEVH_BODY(coupling, void, {
    nevh_num stretch = nevh_q(0) - nevh_q(1);
    return nevh_c(0) / 2 * (stretch * stretch);
})

NEVH_GRADIENT(coupling, void, {
    double force = nevh_c(0) * (nevh_q(0) - nevh_q(1));
    nevh_dh_dq(0) = force;
    nevh_dh_dq(1) = -force;
})

static nevh_system *coupled_system(const void *params) {
    const nevh_coupled_oscillators *a = params;
    static const size_t both[] = {0, 1};
    nevh_term terms[] = {nevh__kinetic_term,
                         nevh__spring_term,
                         {.effect = "coupling",
                          .nq = 2,
                          .nc = 1,
                          .c = &a->coupling,
                          NEVH_FORMS(coupling),
                          NEVH_GRADIENTS(coupling)}};
    terms[0].count = 2;
    terms[0].p = both;
    terms[0].c = (const double[]){a->m1, a->m2};
    terms[1].effect = "springs";
    terms[1].count = 2;
    terms[1].q = both;
    terms[1].c = (const double[]){a->k1, 0, a->k2, 0};
    return nevh__model_system(2, terms, 3);
}

static double coupled_hamiltonian(double t, const double q[], const double p[],
                                  const void *params) {
    const nevh_coupled_oscillators *a = params;
    double stretch = q[0] - q[1];
    (void)t;
    return p[0] * p[0] / (2 * a->m1) + p[1] * p[1] / (2 * a->m2) +
           a->k1 / 2 * (q[0] * q[0]) + a->k2 / 2 * (q[1] * q[1]) +
           a->coupling / 2 * (stretch * stretch);
}

/* In x = sqrt(m) q the equations are x'' = -A x with A symmetric. */
typedef struct {
    long double root_m1, root_m2;
    long double w2[2];        /* the eigenvalues of A, squared frequencies */
    long double cosine, sine; /* the first eigenvector; (-s, c) is the other */
} modes;

static modes normal_modes(const nevh_coupled_oscillators *a) {
    long double m1 = a->m1, m2 = a->m2, k1 = a->k1, k2 = a->k2;
    long double coupling = a->coupling;
    long double a11 = (k1 + coupling) / m1, a22 = (k2 + coupling) / m2;
    long double a12 = -coupling / sqrtl(m1 * m2);
    long double mean = (a11 + a22) / 2, half = (a11 - a22) / 2;
    long double radius = hypotl(half, a12), turn = atan2l(a12, half) / 2;
    long double larger = mean + radius, smaller = mean - radius;
    if (larger > 0) /* the determinant does not cancel in a soft mode */
        smaller = (k1 * k2 + coupling * (k1 + k2)) / (m1 * m2) / larger;
    return (modes){.root_m1 = sqrtl(m1),
                   .root_m2 = sqrtl(m2),
                   .w2 = {larger, smaller},
                   .cosine = cosl(turn),
                   .sine = sinl(turn)};
}

static int coupled_exact(const void *params, double t, const double q0[],
                         const double p0[], double q[], double p[]) {
    modes a = normal_modes(params);
    long double x1 = q0[0] * a.root_m1, x2 = q0[1] * a.root_m2;
    long double v1 = p0[0] / a.root_m1, v2 = p0[1] / a.root_m2;
    long double y[] = {x1 * a.cosine + x2 * a.sine,
                       x2 * a.cosine - x1 * a.sine};
    long double u[] = {v1 * a.cosine + v2 * a.sine,
                       v2 * a.cosine - v1 * a.sine};
    for (int i = 0; i < 2; i++)
        nevh__normal_mode(a.w2[i], t, &y[i], &u[i]);
    long double x[] = {(y[0] * a.cosine - y[1] * a.sine) / a.root_m1,
                       (y[0] * a.sine + y[1] * a.cosine) / a.root_m2};
    long double v[] = {(u[0] * a.cosine - u[1] * a.sine) * a.root_m1,
                       (u[0] * a.sine + u[1] * a.cosine) * a.root_m2};
    return nevh__model_state(2, x, v, q, p);
}

const nevh_model nevh__coupled_oscillators_entry = {
    .name = "coupled-oscillators",
    .title = "Two coupled oscillators",
    .n = 2,
    .defaults =
        &(const nevh_coupled_oscillators){
            .m1 = 1, .m2 = 1, .k1 = 1, .k2 = 1, .coupling = 0.1},
    .q = (const double[]){1, 0}, /* one at rest: the swing wanders over */
    .p = (const double[]){0, 0},
    .coords = (const char *const[]){"x1", "x2"},
    .system = coupled_system,
    .hamiltonian = coupled_hamiltonian,
    .exact = coupled_exact,
};
const nevh_model *const nevh_coupled_oscillators_model =
    &nevh__coupled_oscillators_entry;
