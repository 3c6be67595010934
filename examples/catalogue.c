/* The explicit schemes at equal work: a star in a galaxy [M. Henon, C. Heiles,
   Astron. J. 69 (1964) 73-79].  Every scheme may evaluate the force equally
   often, so that one with more stages takes longer steps.  Look at schemes of
   one order: forest-ruth and yoshida6 were the first of theirs and have the
   fewest stages; those that spend a few more on small error terms are better by
   two or three decades.  And rk4 and gsl-rk8pd, which are not symplectic, fall
   behind in long runs: the error of their state grows with the square of time.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/body.h>
#include <nevh/nevh.h>
#include <stdio.h>
#include <stdlib.h>

static const double t_end = 1000;
static const double forces[] = {25, 100}; /* evaluations a unit of time */
enum { MOST = 100 };

typedef struct {
    const nevh_integrator *scheme;
    double h[2], energy[2], state[2]; /* steps and errors with either number */
} row;

NEVH_BODY(kinetic, void,
          { return (nevh_p(0) * nevh_p(0) + nevh_p(1) * nevh_p(1)) / 2; })
NEVH_BODY(galaxy, void, {
    nevh_num x = nevh_q(0);
    nevh_num y = nevh_q(1);
    return (x * x + y * y) / 2 + x * x * y - y * y * y / 3;
})

/* To the state at t_end, q and then p.  Complex steps are exact gradients. */
static int run(const nevh_system *star, const nevh_integrator *scheme, double h,
               double z[4], double *energy_error) {
    z[0] = 0, z[1] = 0.1, z[2] = 0.35, z[3] = 0.1;
    nevh_options options = {.gradient = nevh_complex_step, .q = z, .p = z + 2};
    nevh_stepper *stepper = nevh_stepper_new(star, scheme, &options);
    nevh_energy *energy = nevh_energy_new(star, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    int status = nevh_run_until(stepper, 0, h, t_end, z, z + 2, &watch, 1);
    *energy_error = nevh_energy_result(energy, 0).max;
    if (status)
        fprintf(stderr, "%s\n", nevh_stepper_message(stepper));
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    return status;
}

static int measure(const nevh_system *star, const double exact[], row *r) {
    double z[4];
    int status = NEVH_OK;
    for (int i = 0; i < 2; i++) {
        r->h[i] = nevh_integrator_gradients(r->scheme) / forces[i];
        status |= run(star, r->scheme, r->h[i], z, &r->energy[i]);
        r->state[i] = hypot(hypot(z[0] - exact[0], z[1] - exact[1]),
                            hypot(z[2] - exact[2], z[3] - exact[3]));
    }
    return status;
}

static int by_state_error(const void *a, const void *b) {
    double x = ((const row *)a)->state[1], y = ((const row *)b)->state[1];
    return (x > y) - (x < y);
}

static bool takes_part(const nevh_integrator *scheme) {
    return scheme == nevh_rk4 || scheme == nevh_gsl_rk8pd ||
           (nevh_integrator_needs(scheme) & NEVH_SEPARABLE &&
            !nevh_integrator_own_time(scheme));
}

int main(void) {
    const nevh_term terms[] = {{"kinetic", .np = 2, NEVH_FORMS(kinetic)},
                               {"galaxy", .nq = 2, NEVH_FORMS(galaxy)}};
    nevh_system *star = nevh_system_new(2);
    int status = nevh_system_add(star, &terms[0]);
    status |= nevh_system_add(star, &terms[1]);
    row rows[MOST], *end = rows;
    double exact[4], error;
    status |= run(star, nevh_gauss20, 0.1, exact, &error);
    for (const nevh_integrator *const *i = nevh_integrators(); *i; i++)
        if (takes_part(*i) && end < rows + MOST) {
            end->scheme = *i;
            status |= measure(star, exact, end++);
        }
    qsort(rows, (size_t)(end - rows), sizeof *rows, by_state_error);
    printf("Henon-Heiles, to t = %g; errors of energy and state at %g and %g "
           "forces a unit of time\n\n"
           " integrator           order     dt   energy     state       dt   "
           "energy     state\n",
           t_end, forces[0], forces[1]);
    for (const row *r = rows; r < end; r++)
        printf(" %-20s %5d  %5.2f  %.1e   %.1e    %5.2f  %.1e   %.1e\n",
               nevh_integrator_name(r->scheme),
               nevh_integrator_order(r->scheme), r->h[0], r->energy[0],
               r->state[0], r->h[1], r->energy[1], r->state[1]);
    nevh_system_free(star);
    return status != NEVH_OK;
}
