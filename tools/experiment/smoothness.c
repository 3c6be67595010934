/* nevh: whether H is smooth on the way of its orbit.

   Differences of H tell of a kink that is within their reach, and take a
   singularity that the orbit only passes for one.  A Taylor series watches all
   functions of the formulas for the edges of their domains, on the orbit and
   nowhere else.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/trial_run.h"
#include <math.h>
#include <nevh/reference.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 1000 };
static const double tolerance = 1e-10;

static nevh_stepper *stepper(const plan *p) {
    nevh_options o = plan_options(p, "exact");
    o.tolerance = tolerance;
    o.native = NEVH_NATIVE_NEVER;
    return nevh_stepper_new(p->system, nevh_dop853, &o);
}

static double most(const plan *p) {
    static const double gradients = 5e3, pairs = 1e6; /* of variables */
    double n = (double)p->n;
    return fmin(gradients, pairs / (n * n));
}

/* An orbit that keeps H but for a jump, which derivatives do not tell of; NULL:
   there is none. */
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

/* Jumps on the orbit where H has no series, as of floor. */
static char *first_jump(const plan *p) {
    size_t n = p->n;
    nevh_stepper *s = stepper(p);
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
    nevh_stepper_free(s);
    nevh_energy_free(energy);
    return jumps;
}

smoothness smoothness_on_way(const plan *p, char **why) {
    char text[300];
    int status = nevh_solution_smooth(p->system, p->run->t_start, p->t_end,
                                      p->q, p->p, text, sizeof text);
    if (status == NEVH_OK)
        return SMOOTHNESS_ALL;
    *why = status == NEVH_EDOM ? text_print("%s", text) : first_jump(p);
    return *why ? SMOOTHNESS_NONE : SMOOTHNESS_UNKNOWN;
}

void smoothness_notes(const plan *p, list *notes) {
    char *why = NULL;
    if (smoothness_on_way(p, &why) == SMOOTHNESS_NONE)
        list_print(notes,
                   "H is not smooth on the orbit (%s): schemes may lose their "
                   "order there, and differences that reach across have larger "
                   "errors than estimated",
                   why);
}
