/* nevh: the problems as a user of nevh would state them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "nevh_systems.h"
#include <nevh/body.h>
#include <stdio.h>

enum { PAIRS = BODIES * (BODIES - 1) / 2 };

/* The derivatives are the formulas that peers are given in problems.h. */

NEVH_BODY(cosine, void, { return -nevh_cos(nevh_q(0)); })

NEVH_GRADIENT(cosine, void, { nevh_dh_dq(0) = nevh_sin(nevh_q(0)); })

NEVH_BODY(attraction, void, {
    return -1 / nevh_sqrt(nevh_q(0) * nevh_q(0) + nevh_q(1) * nevh_q(1));
})

NEVH_GRADIENT(attraction, void, {
    double x = nevh_q(0), y = nevh_q(1), square = x * x + y * y;
    double factor = 1 / (square * nevh_sqrt(square));
    nevh_dh_dq(0) = factor * x;
    nevh_dh_dq(1) = factor * y;
})

NEVH_BODY(galaxy, void, {
    nevh_num x = nevh_q(0), y = nevh_q(1);
    return (x * x + y * y) / 2 + x * x * y - y * y * y / 3;
})

NEVH_GRADIENT(galaxy, void, {
    double x = nevh_q(0), y = nevh_q(1);
    nevh_dh_dq(0) = x + 2 * x * y;
    nevh_dh_dq(1) = y + x * x - y * y;
})

/* Two bodies; c: G m m'. */
NEVH_BODY(gravity, void, {
    nevh_num x = nevh_q(3) - nevh_q(0);
    nevh_num y = nevh_q(4) - nevh_q(1);
    nevh_num z = nevh_q(5) - nevh_q(2);
    return -nevh_c(0) / nevh_sqrt(x * x + y * y + z * z);
})

NEVH_SIMD
static void gravity_gradient(size_t width, const double t[], const double q[],
                             const double p[], const double c[],
                             const void *params, double dh_dq[],
                             double dh_dp[]) {
    (void)t, (void)p, (void)params, (void)dh_dp;
    const double *q1 = q + width, *q2 = q1 + width, *q3 = q2 + width,
                 *q4 = q3 + width, *q5 = q4 + width;
    double *d1 = dh_dq + width, *d2 = d1 + width, *d3 = d2 + width,
           *d4 = d3 + width, *d5 = d4 + width;
    if (!dh_dq)
        return;
    NEVH_LANES(i, width) {
        double x = q3[i] - q[i], y = q4[i] - q1[i], z = q5[i] - q2[i];
        double square = x * x + y * y + z * z;
        double factor = c[i] / (square * nevh_simd_sqrt(square));
        d3[i] = factor * x;
        d4[i] = factor * y;
        d5[i] = factor * z;
        dh_dq[i] = -d3[i];
        d1[i] = -d4[i];
        d2[i] = -d5[i];
    }
}

static nevh_system *unit_mass(size_t n, nevh_term potential) {
    nevh_system *s = nevh_system_new(n);
    nevh_system_add_masses(s, "kinetic", NULL);
    potential.effect = "potential";
    potential.nq = n;
    nevh_system_add(s, &potential);
    return s;
}

static nevh_system *outer_sun(void) {
    nevh_system *s = nevh_system_new(MOST_N);
    double masses[MOST_N], c[PAIRS];
    size_t q[6 * PAIRS], pair = 0;
    for (size_t i = 0; i < BODIES; i++)
        for (size_t j = i + 1; j < BODIES; j++, pair++) {
            c[pair] = sun_gravity * sun_masses[i] * sun_masses[j];
            for (size_t k = 0; k < 3; k++) {
                q[6 * pair + k] = 3 * i + k;
                q[6 * pair + 3 + k] = 3 * j + k;
            }
        }
    for (size_t k = 0; k < MOST_N; k++)
        masses[k] = sun_masses[k / 3];
    nevh_system_add_masses(s, "kinetic", masses);
    nevh_system_add(s, &(nevh_term){.effect = "gravity",
                                    .nq = 6,
                                    .nc = 1,
                                    .q = q,
                                    .c = c,
                                    .count = PAIRS,
                                    NEVH_FORMS(gravity),
                                    .gradient = gravity_gradient});
    return s;
}

nevh_system *nevh_system_of(const problem *p) {
    switch (p - problems) {
    case PENDULUM:
        return unit_mass(
            1, (nevh_term){NEVH_FORMS(cosine), NEVH_GRADIENTS(cosine)});
    case DOUBLE_PENDULUM:
        return nevh_double_pendulum_model->system(
            nevh_double_pendulum_model->defaults);
    case KEPLER:
        return unit_mass(
            2, (nevh_term){NEVH_FORMS(attraction), NEVH_GRADIENTS(attraction)});
    case HENON_HEILES:
        return unit_mass(
            2, (nevh_term){NEVH_FORMS(galaxy), NEVH_GRADIENTS(galaxy)});
    default:
        return outer_sun();
    }
}

static const char *const formulas[] = {
    [PENDULUM] = "[coordinates]\nq = 0\n[effects]\n"
                 "T = p_q^2/2\nV = -cos(q)\n",
    [DOUBLE_PENDULUM] =
        "[coordinates]\na = 0\nb = 0\n[effects]\n"
        "T = (p_a^2 + 2*p_b^2 - 2*p_a*p_b*cos(a - b))/(2*(1 + sin(a - b)^2))\n"
        "V = -9.8*(2*cos(a) + cos(b))\n",
    [KEPLER] = "[coordinates]\nx = 1\ny = 0\n[effects]\n"
               "T = (p_x^2 + p_y^2)/2\nV = -1/sqrt(x^2 + y^2)\n",
    [HENON_HEILES] = "[coordinates]\nx = 0\ny = 0\n[effects]\n"
                     "T = (p_x^2 + p_y^2)/2\n"
                     "V = (x^2 + y^2)/2 + x^2*y - y^3/3\n"};

/* q[3*i - 2] to q[3*i] are of body i. */
static nevh_scene *outer_sun_scene(void) {
    enum { ROOM = 2000 };
    char text[ROOM];
    int used = snprintf(text, ROOM, "[parameters]\nN = %d\nm[1..N] = ", BODIES);
    for (int i = 0; i < BODIES; i++)
        used += snprintf(text + used, (size_t)(ROOM - used), "%s%.17g",
                         i ? ", " : "", sun_masses[i]);
    snprintf(text + used, (size_t)(ROOM - used),
             "\nG = %.17g\n[coordinates]\nq[i = 1..3*N] = i\n[effects]\n"
             "T = sum(i = 1..N, (p_q[3*i - 2]^2 + p_q[3*i - 1]^2 + "
             "p_q[3*i]^2)/(2*m[i]))\n"
             "V = -G*sum(i = 1..N, j = i + 1..N, m[i]*m[j]/"
             "sqrt((q[3*i - 2] - q[3*j - 2])^2 + (q[3*i - 1] - q[3*j - 1])^2 "
             "+ (q[3*i] - q[3*j])^2))\n",
             sun_gravity);
    return nevh_scene_parse("outer-sun", text);
}

nevh_scene *nevh_scene_of(const problem *p) {
    if (p - problems == OUTER_SUN)
        return outer_sun_scene();
    return nevh_scene_parse(p->name, formulas[p - problems]);
}
