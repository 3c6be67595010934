/* Systems with every form of H, for what measures gradients.  NEVH_BODY makes
   value, SIMD block and complex form from one text; NEVH_GRADIENT makes the
   exact derivatives of blocks and of one state from another, but for those
   whose form depends on a parameter.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient_systems.h"
#include <math.h>
#include <nevh/body.h>
#include <stdlib.h>
#include <time.h>

#define G 9.8

NEVH_BODY(power, int, {
    nevh_num x = nevh_q(0);
    return (*params ? nevh_pow(x, *params) : nevh_cos(x)) +
           nevh_p(0) * nevh_p(0) / 2;
})

static void power_gradient(size_t width, const double t[], const double q[],
                           const double p[], const double c[],
                           const void *params, double dh_dq[], double dh_dp[]) {
    int n = *(const int *)params;
    (void)t, (void)c;
    for (size_t i = 0; dh_dq && i < width; i++)
        dh_dq[i] = n ? n * pow(q[i], n - 1) : -sin(q[i]);
    for (size_t i = 0; dh_dp && i < width; i++)
        dh_dp[i] = p[i];
}

NEVH_BODY(pendulum, void,
          { return nevh_p(0) * nevh_p(0) / 2 - G * nevh_cos(nevh_q(0)); })

NEVH_GRADIENT(pendulum, void, {
    nevh_dh_dq(0) = G * nevh_sin(nevh_q(0));
    nevh_dh_dp(0) = nevh_p(0);
})

NEVH_BODY(double_pendulum, void, {
    nevh_num d = nevh_q(0) - nevh_q(1);
    nevh_num p1 = nevh_p(0);
    nevh_num p2 = nevh_p(1);
    nevh_num sine = nevh_sin(d);
    return (p1 * p1 + 2 * p2 * p2 - 2 * p1 * p2 * nevh_cos(d)) /
               (2 * (1 + sine * sine)) -
           G * (2 * nevh_cos(nevh_q(0)) + nevh_cos(nevh_q(1)));
})

NEVH_GRADIENT(double_pendulum, void, {
    double p1 = nevh_p(0), p2 = nevh_p(1), d = nevh_q(0) - nevh_q(1);
    double s = nevh_sin(d), k = nevh_cos(d), root = 1 + s * s;
    double form = p1 * p1 + 2 * p2 * p2 - 2 * p1 * p2 * k;
    double both = s * (p1 * p2 - form * k / root) / root;
    nevh_dh_dq(0) = both + 2 * G * nevh_sin(nevh_q(0));
    nevh_dh_dq(1) = -both + G * nevh_sin(nevh_q(1));
    nevh_dh_dp(0) = (p1 - p2 * k) / root;
    nevh_dh_dp(1) = (2 * p2 - p1 * k) / root;
})

NEVH_BODY(kepler, void, {
    return (nevh_p(0) * nevh_p(0) + nevh_p(1) * nevh_p(1)) / 2 -
           1 / nevh_sqrt(nevh_q(0) * nevh_q(0) + nevh_q(1) * nevh_q(1));
})

NEVH_GRADIENT(kepler, void, {
    double x = nevh_q(0), y = nevh_q(1), r2 = x * x + y * y;
    double r3 = r2 * nevh_sqrt(r2);
    nevh_dh_dq(0) = x / r3;
    nevh_dh_dq(1) = y / r3;
    nevh_dh_dp(0) = nevh_p(0);
    nevh_dh_dp(1) = nevh_p(1);
})

NEVH_BODY(spring, void, {
    nevh_num r = nevh_q(1) - nevh_q(0);
    return nevh_exp(-r) + r - 1;
})

NEVH_GRADIENT(spring, void, {
    double pull = 1 - nevh_exp(nevh_q(0) - nevh_q(1));
    nevh_dh_dq(0) = -pull;
    nevh_dh_dq(1) = pull;
})

/* The caller asks the system for its status when it plans. */
static nevh_system *from_term(size_t n, const nevh_term *term) {
    nevh_system *system = nevh_system_new(n);
    if (system)
        nevh_system_add(system, term);
    return system;
}

nevh_system *power_system(const int *n) {
    return from_term(1, &(nevh_term){.effect = "all",
                                     .nq = 1,
                                     .np = 1,
                                     NEVH_FORMS(power),
                                     .gradient = power_gradient,
                                     .params = n});
}

nevh_system *pendulum_system(void) {
    return from_term(1, &(nevh_term){.effect = "all",
                                     .nq = 1,
                                     .np = 1,
                                     NEVH_FORMS(pendulum),
                                     NEVH_GRADIENTS(pendulum)});
}

nevh_system *double_pendulum_system(void) {
    return from_term(2, &(nevh_term){.effect = "all",
                                     .nq = 2,
                                     .np = 2,
                                     NEVH_FORMS(double_pendulum),
                                     NEVH_GRADIENTS(double_pendulum)});
}

nevh_system *kepler_system(void) {
    return from_term(2, &(nevh_term){.effect = "all",
                                     .nq = 2,
                                     .np = 2,
                                     NEVH_FORMS(kepler),
                                     NEVH_GRADIENTS(kepler)});
}

nevh_system *chain_system(size_t masses) {
    nevh_system *system = nevh_system_new(masses);
    size_t *ends = malloc(2 * masses * sizeof *ends);
    for (size_t i = 0; ends && i < 2 * (masses - 1); i++)
        ends[i] = (i + 1) / 2;
    bool made = system && ends &&
                !nevh_system_add_masses(system, "kinetic", NULL) &&
                !nevh_system_add(system, &(nevh_term){.effect = "springs",
                                                      .nq = 2,
                                                      .q = ends,
                                                      .count = masses - 1,
                                                      NEVH_FORMS(spring),
                                                      NEVH_GRADIENTS(spring)});
    free(ends);
    if (made)
        return system;
    nevh_system_free(system);
    return NULL;
}

/* Numbers from -1 to 1 that look random. */
static double scatter(size_t k) {
    return 2 * fmod((double)(k + 1) * 0.6180339887498949, 1) - 1;
}

gradient_states gradient_states_new(size_t n, size_t width, const double q[],
                                    const double p[], double spread) {
    size_t size = n * width;
    gradient_states s = {.n = n, .width = width};
    s.t = calloc(width + 4 * size, sizeof *s.t);
    if (!s.t)
        return s;
    s.q = s.t + width;
    s.p = s.q + size;
    s.dh_dq = s.p + size;
    s.dh_dp = s.dh_dq + size;
    for (size_t i = 0; i < size; i++) {
        s.q[i] = (q ? q[i / width] : 0) + spread * scatter(i);
        s.p[i] = (p ? p[i / width] : 0) + spread * scatter(size + i);
    }
    return s;
}

void gradient_states_free(gradient_states *s) {
    free(s->t);
    s->t = NULL;
}

int gradient_states_evaluate(nevh_field *field, gradient_states *s) {
    return nevh_field_gradient(field, s->width, s->t, s->q, s->p, s->dh_dq,
                               s->dh_dp);
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double gradient_states_time(nevh_field *field, gradient_states *s) {
    enum { ROUNDS = 5, BATCH = 256 };
    const double least = 0.004 * CLOCKS_PER_SEC;
    double ns[ROUNDS], count;
    for (int i = 0; i < ROUNDS; i++) {
        clock_t start = clock(), now = start;
        for (count = 0; (double)(now - start) < least; now = clock())
            for (size_t k = 0; k < BATCH; k += s->n * s->width, count++)
                gradient_states_evaluate(field, s);
        ns[i] = 1e9 / CLOCKS_PER_SEC * (double)(now - start) / count;
    }
    qsort(ns, ROUNDS, sizeof *ns, by_size);
    return ns[ROUNDS / 2];
}

double gradient_states_error(const gradient_states *s,
                             const gradient_states *exact) {
    double size = 0, most = 0;
    for (size_t i = 0; i < 2 * s->n * s->width; i++) { /* dh_dp follows dh_dq */
        size = fmax(size, fabs(exact->dh_dq[i]));
        most = fmax(most, fabs(s->dh_dq[i] - exact->dh_dq[i]));
    }
    return most / size;
}
