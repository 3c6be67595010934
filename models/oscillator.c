/* nevh: the harmonic oscillator, H = p^2/(2m) + k q^2/2, and the quadratic
   terms that other models are made of, too.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "models_private.h"
#include "system/motion_private.h"

NEVH_BODY(kinetic, void, { return nevh_p(0) * nevh_p(0) / (2 * nevh_c(0)); })

NEVH_GRADIENT(kinetic, void, { nevh_dh_dp(0) = nevh_p(0) / nevh_c(0); })

const nevh_term nevh__kinetic_term = {.effect = "kinetic",
                                      .np = 1,
                                      .nc = 1,
                                      NEVH_FORMS(kinetic),
                                      NEVH_GRADIENTS(kinetic)};

NEVH_BODY(spring, void, {
    nevh_num stretch = nevh_q(0) - nevh_c(1);
    return nevh_c(0) / 2 * (stretch * stretch);
})

NEVH_GRADIENT(spring, void,
              { nevh_dh_dq(0) = nevh_c(0) * (nevh_q(0) - nevh_c(1)); })

const nevh_term nevh__spring_term = {.effect = "spring",
                                     .nq = 1,
                                     .nc = 2,
                                     NEVH_FORMS(spring),
                                     NEVH_GRADIENTS(spring)};

static nevh_system *oscillator_system(const void *params) {
    const nevh_oscillator *a = params;
    nevh_term terms[] = {nevh__kinetic_term, nevh__spring_term};
    terms[0].c = &a->m;
    terms[1].c = (const double[]){a->k, 0};
    return nevh__model_system(1, terms, 2);
}

static double oscillator_hamiltonian(double t, const double q[],
                                     const double p[], const void *params) {
    const nevh_oscillator *a = params;
    (void)t;
    return p[0] * p[0] / (2 * a->m) + a->k / 2 * (q[0] * q[0]);
}

static int oscillator_exact(const void *params, double t, const double q0[],
                            const double p0[], double q[], double p[]) {
    const nevh_oscillator *a = params;
    long double m = a->m, x = q0[0], v = p0[0] / m;
    nevh__normal_mode(a->k / m, t, &x, &v);
    v *= m;
    return nevh__model_state(1, &x, &v, q, p);
}

const nevh_model nevh__oscillator_entry = {
    .name = "harmonic-oscillator",
    .title = "Harmonic oscillator",
    .n = 1,
    /* k = 4 pi^2: the period is 1. */
    .defaults = &(const nevh_oscillator){.m = 1, .k = 39.478417604357434},
    .q = (const double[]){1},
    .p = (const double[]){0},
    .coords = (const char *const[]){"x"},
    .system = oscillator_system,
    .hamiltonian = oscillator_hamiltonian,
    .exact = oscillator_exact,
};
const nevh_model *const nevh_oscillator_model = &nevh__oscillator_entry;
