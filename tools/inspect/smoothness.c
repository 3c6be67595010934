/* nevh check: whether H is smooth on the way of its orbit.

   Differences of H tell of a kink that is within their reach, and take a
   singularity that the orbit only passes for one.  A Taylor series watches all
   functions of the formulas for the edges of their domains, on the orbit and
   nowhere else.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "experiment/pace.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A series goes eight steps ahead at most. */
enum { STEPS = 1000 };
static const double most_series = 5e3,
                    most_pairs = 1e6; /* of variables, in all */
static const double tolerance = 1e-10;

static nevh_stepper *stepper(const plan *p) {
    nevh_options o = plan_options(p, "exact");
    o.tolerance = tolerance;
    o.native = NEVH_NATIVE_NEVER;
    return nevh_stepper_new(p->system, nevh_taylor, &o);
}

static double most(const plan *p) {
    double n = (double)p->n;
    return fmin(most_series, most_pairs / (n * n));
}

smoothness smoothness_on_way(const plan *p, char **why) {
    size_t n = p->n;
    nevh_stepper *s = stepper(p);
    double *z = tool_allocate(2 * n, sizeof *z);
    double begin = p->run->t_start, h = (p->t_end - begin) / STEPS;
    int status = nevh_stepper_status(s);
    bool series = !status;
    memcpy(z, p->q, n * sizeof *z);
    memcpy(z + n, p->p, n * sizeof *z);
    for (int i = 0; !status && i < STEPS; i++) {
        status = nevh_stepper_apply(s, begin + i * h, h, z, z + n);
        if ((double)nevh_stepper_counts(s).gradients > most(p))
            break;
    }
    bool ends = series && status == NEVH_EDOM;
    if (ends)
        *why = text_print("%s", nevh_stepper_message(s));
    nevh_stepper_free(s);
    free(z);
    return ends     ? SMOOTHNESS_NONE
           : series ? SMOOTHNESS_ALL
                    : SMOOTHNESS_UNKNOWN;
}
