/* nevh: whether H is smooth on the way of its orbit.

   Differences of H tell of a kink that is within their reach, and take a
   singularity that the orbit only passes for one.  A Taylor series watches all
   functions of the formulas for the edges of their domains, on the orbit and
   nowhere else.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/trial_run.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A series goes eight steps ahead at most. */
enum { STEPS = 1000 };
static const double most_series = 5e3,
                    most_pairs = 1e6; /* of variables, in all */
static const double tolerance = 1e-10;

static nevh_stepper *stepper(const plan *p, const nevh_integrator *scheme) {
    nevh_options o = plan_options(p, "exact");
    o.tolerance = tolerance;
    o.native = NEVH_NATIVE_NEVER;
    return nevh_stepper_new(p->system, scheme, &o);
}

static double most(const plan *p) {
    double n = (double)p->n;
    return fmin(most_series, most_pairs / (n * n));
}

/* An orbit that keeps H but for a jump, which derivatives do not tell of; to be
   freed, NULL: there is none. */
static char *jump(const plan *p, const nevh_energy *energy, double before,
                  double t) {
    static const double sudden = 1e-6; /* of the energies met */
    double now = nevh_energy_error(energy, 0);
    double met = fmax(1, nevh_energy_result(energy, 0).met);
    if (p->time || p->friction || !(fabs(now - before) > sudden * met))
        return NULL;
    return text_print("H jumps on the orbit before t = %.6g, by %.2g of its "
                      "scale, which no derivative shows",
                      t, now - before);
}

smoothness smoothness_on_way(const plan *p, char **why) {
    size_t n = p->n;
    nevh_stepper *s = stepper(p, nevh_taylor);
    bool series = !nevh_stepper_status(s);
    if (!series) { /* of floor, for instance: jumps alone are looked for */
        nevh_stepper_free(s);
        s = stepper(p, nevh_dop853);
    }
    nevh_energy *energy = nevh_energy_new(p->system, NULL);
    double *z = tool_allocate(2 * n, sizeof *z);
    double begin = p->run->t_start, h = (p->t_end - begin) / STEPS;
    int status = nevh_stepper_status(s);
    memcpy(z, p->q, n * sizeof *z);
    memcpy(z + n, p->p, n * sizeof *z);
    char *jumps = NULL;
    plan_set_scale(p, energy);
    nevh_energy_observe(energy, 0, begin, z, z + n);
    for (int i = 0; !status && !jumps && i < STEPS; i++) {
        double before = nevh_energy_error(energy, 0), t = begin + (i + 1) * h;
        status = nevh_stepper_apply(s, begin + i * h, h, z, z + n);
        if (!status && !nevh_energy_observe(energy, (size_t)i + 1, t, z, z + n))
            jumps = jump(p, energy, before, t);
        if ((double)nevh_stepper_counts(s).gradients > most(p))
            break;
    }
    bool out = series && status == NEVH_EDOM;
    bool ends = out && !isfinite(plan_ends(p)); /* else the solution does */
    if (ends)
        *why = text_print("%s", nevh_stepper_message(s));
    else if (jumps)
        *why = jumps;
    nevh_stepper_free(s);
    nevh_energy_free(energy);
    free(z);
    return ends || jumps                ? SMOOTHNESS_NONE
           : series && (!status || out) ? SMOOTHNESS_ALL
                                        : SMOOTHNESS_UNKNOWN;
}
