/* nevh tests: a program of someone who has only what make install brings.
   SPDX-License-Identifier: GPL-3.0-or-later

   A spherical pendulum in a rotating frame, as one body; exits with 0 when the
   forms agree.  Built by tests/build/pkgconfig.sh. */
#include <nevh/nevh.h>
#include <nevh/body.h>
#include <stdio.h>
#include <string.h>

typedef struct {
    double m, l, g, rate;
} sphere;

enum { THETA, PHI };

NEVH_BODY(spherical, sphere, {
    nevh_num sine = nevh_sin(nevh_q(THETA)), across = nevh_p(PHI) / sine;
    nevh_num swing = nevh_p(THETA) * nevh_p(THETA) + nevh_pow(across, 2);
    return swing / (2 * params->m * (params->l * params->l)) -
           params->m * params->g * params->l * nevh_cos(nevh_q(THETA)) -
           params->rate * nevh_p(PHI);
})

NEVH_BODY(area, void, { return nevh_q(0) * nevh_p(1) - nevh_q(1) * nevh_p(0); })

/* Lanes whose products were joined with the difference, by instructions that
   this function has not. */
static int contracted_lanes(void) {
    int count = 0;
#if defined NEVH__VECTORS && !defined __FMA__
    double t[8] = {0}, q[16], p[16], h[8];
    for (int i = 0; i < 16; i++) {
        q[i] = 1 / (i + 3.);
        p[i] = 1 / (i + 7.);
    }
    area_block(8, t, q, p, NULL, NULL, h);
    for (int i = 0; i < 8; i++)
        count += h[i] != area_value(0, (double[]){q[i], q[8 + i]},
                                    (double[]){p[i], p[8 + i]}, NULL, NULL);
#endif
    return count;
}

static const sphere bob = {0.7, 1.3, 9.8, 0.2};
enum { WIDTH = 16 };

/* The largest difference of value and block, relative to the value. */
static double block_error(void) {
    double t[WIDTH] = {0}, q[2 * WIDTH], p[2 * WIDTH], h[WIDTH], worst = 0;
    for (int i = 0; i < WIDTH; i++) {
        q[i] = 0.3 + 0.1 * i;
        q[WIDTH + i] = 0;
        p[i] = 1.7 - 0.2 * i;
        p[WIDTH + i] = 0.9;
    }
    spherical_block(WIDTH, t, q, p, NULL, &bob, h);
    for (int i = 0; i < WIDTH; i++) {
        double h1 = spherical_value(0, (double[]){q[i], 0},
                                    (double[]){p[i], 0.9}, NULL, &bob);
        worst = fmax(worst, fabs(h[i] - h1) / fabs(h1));
    }
    return worst;
}

/* How far the complex step is from dH/dq and dH/dp, by formula. */
static double complex_error(nevh_system *sys) {
    nevh_options options = {.gradient = nevh_complex_step};
    nevh_field *field = nevh_field_new(sys, &options);
    double t = 0, q[] = {0.8, 0.1}, p[] = {1.1, 0.9}, dh_dq[2], dh_dp[2];
    double worst = INFINITY;
    if (nevh_field_gradient(field, 1, &t, q, p, dh_dq, dh_dp) == NEVH_OK) {
        double inertia = bob.m * (bob.l * bob.l), s = sin(q[0]), c = cos(q[0]);
        worst = fabs(dh_dq[0] + p[1] * p[1] * c / (inertia * s * s * s) -
                     bob.m * bob.g * bob.l * s);
        worst = fmax(worst, fabs(dh_dq[1]));
        worst = fmax(worst, fabs(dh_dp[0] - p[0] / inertia));
        worst =
            fmax(worst, fabs(dh_dp[1] - p[1] / (inertia * s * s) + bob.rate));
    }
    nevh_field_free(field);
    return worst;
}

/* The library is that of the headers. */
static int version_differs(void) {
    char text[40];
    snprintf(text, sizeof text, "%d.%d.%d", NEVH_VERSION_MAJOR,
             NEVH_VERSION_MINOR, NEVH_VERSION_PATCH);
    return strcmp(text, nevh_version()) != 0;
}

int main(void) {
    if (version_differs()) {
        puts("the headers have another version than the library");
        return 1;
    }
    nevh_term term = {.effect = "all",
                      .nq = 2,
                      .np = 2,
                      .params = &bob,
                      NEVH_FORMS(spherical)};
    nevh_system *sys = nevh_system_new(2);
    nevh_system_add(sys, &term);
    double block = block_error(), step = complex_error(sys);
    nevh_system_free(sys);
    if (contracted_lanes()) {
        puts("a block's products were contracted");
        return 1;
    }
    if (block < 1e-14 && step < 1e-13)
        return 0;
    printf("block off by %g, complex step by %g\n", block, step);
    return 1;
}
