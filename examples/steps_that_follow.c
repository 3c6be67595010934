/* Steps that follow the orbit of a comet, of eccentricity 0.9.
   Near the sun it calls for steps eighty times shorter than far away; fixed
   steps are that short everywhere.  Steps proportional to s = r^k keep what
   fixed ones keep if time itself is transformed (gauss4, gauss8: symplectic) or
   if the step is a variable of its own (adaptive-verlet: reversible), but not
   if it is just h s at the start of each step.  Look at the share of H's
   evaluations for about the same error, and at the drift of the naive scheme.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <nevh/nevh.h>
#include <stdio.h>

static const double e = 0.9, year = 2 * 3.141592653589793, years = 100;

typedef struct {
    const char *scheme;
    double power; /* of r in s; 0: fixed steps, which begin a group */
    double steps; /* a year, if all were as long as the first */
} entry;

static double kinetic(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)q, (void)c, (void)params;
    return (p[0] * p[0] + p[1] * p[1]) / 2;
}

static double gravity(double t, const double q[], const double p[],
                      const double c[], const void *params) {
    (void)t, (void)p, (void)c, (void)params;
    return -1 / hypot(q[0], q[1]);
}

static void print(const entry *x, const nevh_stepper *stepper,
                  nevh_energy_report energy, double missed) {
    static double first; /* evaluations of the group's fixed steps */
    double evaluations = nevh_stepper_counts(stepper).hamiltonians;
    char drift[16] = "-", s[16] = "fixed";
    if (energy.verdict == NEVH_DRIFTS || energy.verdict == NEVH_UNSTABLE)
        snprintf(drift, sizeof drift, "%+.1e", energy.drift * year * years);
    if (x->power > 0)
        snprintf(s, sizeof s, "r^%g", x->power);
    else
        first = evaluations, puts("");
    printf(" %-21s %-5s %6.0f %9.0f  %5.1f%%  %8.1e   %8s  %8.1e  %s\n",
           x->scheme, s, (double)nevh_stepper_taken(stepper) / years,
           evaluations, 100 * evaluations / first, energy.max, drift, missed,
           nevh_verdict_name(energy.verdict));
}

/* From the far end of the orbit; after whole years it is there again. */
static int run(const nevh_system *comet, const entry *x) {
    double q[] = {1 + e, 0}, p[] = {0, sqrt((1 - e) / (1 + e))};
    nevh_system *s = x->power > 0 ? nevh_distance_power(2, 2, x->power) : NULL;
    nevh_options options = {.q = q, .p = p, .transform = s};
    nevh_stepper *stepper =
        nevh_stepper_new(comet, nevh_integrator_named(x->scheme), &options);
    nevh_energy *energy = nevh_energy_new(comet, NULL);
    nevh_observer watch = {nevh_energy_observe, energy, 1};
    int status = nevh_run_until(stepper, 0, year / x->steps, year * years, q, p,
                                &watch, 1);
    if (status)
        printf(" %-21s %s\n", x->scheme, nevh_stepper_message(stepper));
    else
        print(x, stepper, nevh_energy_result(energy, 0),
              hypot(q[0] - (1 + e), q[1]));
    nevh_energy_free(energy);
    nevh_stepper_free(stepper);
    nevh_system_free(s);
    return status;
}

int main(void) {
    const entry entries[] = {{"verlet", 0, 2700},
                             {"adaptive-verlet", 1.5, 50},
                             {"naive-adaptive-verlet", 1.5, 50},
                             {"gauss4", 0, 2000},
                             {"gauss4", 1, 64},
                             {"gauss4", 1.5, 28},
                             {"gauss8", 0, 480},
                             {"gauss8", 1, 14},
                             {"gauss8", 1.5, 4}};
    const nevh_term terms[] = {{"kinetic", .np = 2, .value = kinetic},
                               {"gravity", .nq = 2, .value = gravity}};
    nevh_system *comet = nevh_system_new(2);
    int status = nevh_system_add(comet, &terms[0]);
    status |= nevh_system_add(comet, &terms[1]);
    printf(
        "Kepler's problem, eccentricity %g, %g years from the far end; "
        "gradient central4\n\n"
        " integrator            s      steps   H evals   share    energy   "
        "drift in  position  energy\n"
        "                              a year                       error    "
        "the run     error\n",
        e, years);
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
        status |= run(comet, &entries[i]);
    nevh_system_free(comet);
    return status != NEVH_OK;
}
