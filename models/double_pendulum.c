/* nevh: the planar double pendulum of two equal bobs on two equal rods.
   SPDX-License-Identifier: GPL-3.0-or-later

   H = (p1^2 + w p2^2 - 2 p1 p2 cos d) / (2 m l^2 (1 + sin^2 d))
       - m g l (2 cos q1 + cos q2),  d = q1 - q2;

   both angles are measured from straight down.  The inverse of the mass matrix
   m l^2 ((2, cos d), (cos d, 1)) gives w = 2.  Amoreira & Amoreira, Numerical
   Evolution from the Hamiltonian, eq. dph, prints w = 1, which is no double
   pendulum; that model is here to reproduce their figure. */
#include "models_private.h"
#include <math.h>

static const double CORRECT = 2, AS_PRINTED = 1;

/* q1, q2, p1, p2; c: w and 2 m l^2 */
NEVH_BODY(kinetic, void, {
    nevh_num p1 = nevh_p(0), p2 = nevh_p(1), d = nevh_q(0) - nevh_q(1);
    nevh_num sine = nevh_sin(d), cosine = nevh_cos(d);
    nevh_num form = p1 * p1 + nevh_c(0) * (p2 * p2) - 2 * p1 * p2 * cosine;
    return form / (nevh_c(1) * (1 + sine * sine));
})

NEVH_GRADIENT(kinetic, void, {
    double p1 = nevh_p(0), p2 = nevh_p(1), d = nevh_q(0) - nevh_q(1);
    double w = nevh_c(0), scale = nevh_c(1);
    double cosine = nevh_cos(d), sine = nevh_sin(d);
    double form = p1 * p1 + w * (p2 * p2) - 2 * p1 * p2 * cosine;
    /* One division, which takes as long as ten products. */
    double inverse = 2 / (scale * (1 + sine * sine));
    double torque =
        sine * (p1 * p2 - form * cosine * (scale * inverse / 2)) * inverse;
    nevh_dh_dq(0) = torque;
    nevh_dh_dq(1) = -torque;
    nevh_dh_dp(0) = (p1 - p2 * cosine) * inverse;
    nevh_dh_dp(1) = (w * p2 - p1 * cosine) * inverse;
})

static nevh_system *new_system(const nevh_double_pendulum *a, double w) {
    static const size_t both[] = {0, 1};
    double weight = a->m * a->g * a->l;
    nevh_term terms[] = {
        {.effect = "kinetic",
         .nq = 2,
         .np = 2,
         .nc = 2,
         .c = (const double[]){w, 2 * a->m * (a->l * a->l)},
         NEVH_FORMS(kinetic),
         NEVH_GRADIENTS(kinetic)},
        nevh__cosine_term,
    };
    terms[1].count = 2;
    terms[1].q = both;
    terms[1].c = (const double[]){2 * weight, weight};
    return nevh__model_system(2, terms, 2);
}

static double energy(const double q[], const double p[],
                     const nevh_double_pendulum *a, double w) {
    double d = q[0] - q[1], sine = sin(d);
    double form = p[0] * p[0] + w * (p[1] * p[1]) - 2 * p[0] * p[1] * cos(d);
    return form / (2 * a->m * (a->l * a->l) * (1 + sine * sine)) -
           a->m * a->g * a->l * (2 * cos(q[0]) + cos(q[1]));
}

static nevh_system *correct_system(const void *params) {
    return new_system(params, CORRECT);
}

static double correct_hamiltonian(double t, const double q[], const double p[],
                                  const void *params) {
    (void)t;
    return energy(q, p, params, CORRECT);
}

static nevh_system *printed_system(const void *params) {
    return new_system(params, AS_PRINTED);
}

static double printed_hamiltonian(double t, const double q[], const double p[],
                                  const void *params) {
    (void)t;
    return energy(q, p, params, AS_PRINTED);
}

static const nevh_double_pendulum defaults = {.m = 1, .l = 1, .g = 9.8};
static const double start_q[] = {1.5707963267948966, 0}; /* pi/2 */
static const double start_p[] = {0, 0};
static const char *const coords[] = {"phi1", "phi2"};

const nevh_model nevh__double_pendulum_entry = {
    .name = "double-pendulum",
    .title = "Double pendulum",
    .n = 2,
    .defaults = &defaults,
    .q = start_q,
    .p = start_p,
    .coords = coords,
    .system = correct_system,
    .hamiltonian = correct_hamiltonian,
};
const nevh_model *const nevh_double_pendulum_model =
    &nevh__double_pendulum_entry;

const nevh_model nevh__double_pendulum_as_printed_entry = {
    .name = "double-pendulum-as-printed",
    .title = "Double pendulum with the paper's misprinted H",
    .n = 2,
    .defaults = &defaults,
    .q = start_q,
    .p = start_p,
    .coords = coords,
    .system = printed_system,
    .hamiltonian = printed_hamiltonian,
};
const nevh_model *const nevh_double_pendulum_as_printed_model =
    &nevh__double_pendulum_as_printed_entry;
