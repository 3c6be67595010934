/* One row of an energy-error table, for the examples that print one.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "energy_table.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { MOST_DOF = 8 };

void energy_header(void) {
    puts(" integrator         order sympl. dt/s  max energy   drift over "
         "    final   H evals     CPU  energy\n"
         "                                          error      the run "
         "     error                ms");
}

static void print(const nevh_integrator *scheme, double dt, double t_end,
                  const row *r) {
    char drift[16] = "-";
    if (r->energy.verdict == NEVH_DRIFTS || r->energy.verdict == NEVH_UNSTABLE)
        snprintf(drift, sizeof drift, "%+.1e", r->energy.drift * t_end);
    printf(" %-18s %5d   %-4s %5g   %8.1e  %9s %9.1e %9.0f %9.2f  %s\n",
           nevh_integrator_name(scheme), nevh_integrator_order(scheme),
           nevh_integrator_symplectic(scheme) == NEVH_YES ? "yes" : "no", dt,
           r->energy.max, drift, r->energy.final, r->counts.hamiltonians,
           1000 * r->seconds, nevh_verdict_name(r->energy.verdict));
}

/* One run; watched by `energy` unless that is NULL, which is for timing. */
static int run(const nevh_system *system, const nevh_integrator *scheme,
               const double q0[], const double p0[], double dt, double t_end,
               nevh_energy *energy, row *r) {
    double q[MOST_DOF], p[MOST_DOF];
    memcpy(q, q0, nevh_system_dof(system) * sizeof *q);
    memcpy(p, p0, nevh_system_dof(system) * sizeof *p);
    nevh_options options = {.gradient = nevh_central4, .q = q, .p = p};
    nevh_stepper *stepper = nevh_stepper_new(system, scheme, &options);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    clock_t start = clock();
    r->status = nevh_run(stepper, 0, dt, (size_t)lround(t_end / dt), q, p,
                         &watch, energy ? 1 : 0);
    r->seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    r->counts = nevh_stepper_counts(stepper);
    if (r->status)
        printf(" %-18s %s: %s\n", nevh_integrator_name(scheme),
               r->status == NEVH_ESTRUCT ? "refused" : "failed",
               nevh_stepper_message(stepper));
    nevh_stepper_free(stepper);
    return r->status;
}

row energy_row(const nevh_system *system, const nevh_integrator *scheme,
               const double q[], const double p[], double dt, double t_end) {
    row r = {0};
    nevh_energy *energy = nevh_energy_new(system, NULL);
    if (!run(system, scheme, q, p, dt, t_end, energy, &r)) {
        r.energy = nevh_energy_result(energy, 0);
        if (!run(system, scheme, q, p, dt, t_end, NULL, &r))
            print(scheme, dt, t_end, &r);
    }
    nevh_energy_free(energy);
    return r;
}
