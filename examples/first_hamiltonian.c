/* The paper's first listing: only H is written down.
   H = k x^2/2 + p^2/(2m) with k = 4 pi^2, m = 1 has period 1.  The motion from
   x = 1 at rest is compared with the exact cos(2 pi t).  Look at the last
   column: the difference quotient of a quadratic H is exact, so what is left
   is the error of the integrator (gauss8), near rounding.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/nevh.h>
#include <stdio.h>

static const double pi = 3.141592653589793;

typedef struct {
    double k, m;
} oscillator;

static double H(double t, const double q[], const double p[],
                const void *params) {
    const oscillator *o = params;
    (void)t;
    return o->k * q[0] * q[0] / 2 + p[0] * p[0] / (2 * o->m);
}

int main(void) {
    oscillator params = {.k = 4 * pi * pi, .m = 1};
    double q[] = {1}, p[] = {0}, dt = 0.025;
    nevh_system *system = nevh_system_from(1, H, &params);
    nevh_stepper *stepper =
        nevh_stepper_new(system, nevh_gauss8, &(nevh_options){.q = q, .p = p});
    int status = nevh_stepper_status(stepper);
    printf("harmonic oscillator, period 1, from H alone; gauss8, dt = %g\n\n",
           dt);
    printf("     t             x             p     x - exact\n");
    for (int row = 0; !status && row <= 15; row++) {
        double t = row * 0.2;
        printf("%6.2f  %12.9f  %12.9f  %12.1e\n", t, q[0], p[0],
               q[0] - cos(2 * pi * t));
        status = nevh_run(stepper, t, dt, 8, q, p, NULL, 0);
    }
    if (status)
        fprintf(stderr, "%s\n", nevh_stepper_message(stepper));
    nevh_stepper_free(stepper);
    nevh_system_free(system);
    return status != NEVH_OK;
}
