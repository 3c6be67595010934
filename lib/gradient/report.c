/* nevh: what a field says about its steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/step_selection_private.h"
#include <fenv.h>
#include <math.h>
#include <stdlib.h>

/* Above this part of a derivative its error is no longer a matter of rounding
   and smoothness. */
static const double rough = 1e-5;

size_t nevh_field_step_count(const nevh_field *f) {
    return f ? f->n_steps : 0;
}

static nevh_step_report report_describe(const nevh_field *f,
                                        const nevh__planned *term, size_t at) {
    size_t row = at / term->nv, k = at % term->nv;
    size_t instance = row * nevh__stride(term->term->decl.count);
    const nevh__step *s = &term->steps[at];
    double error = s->truncation + s->rounding;
    return (nevh_step_report){.term = term->term->decl.name,
                              .effect = term->term->decl.effect,
                              .instance = instance,
                              .momentum = k >= term->nq,
                              .index = nevh__index(term, instance, k),
                              .step = s->delta,
                              .order = s->quadratic ? 2 : f->gradient->order,
                              .given = s->given,
                              .blind = s->blind,
                              .rough =
                                  !s->given && !s->blind &&
                                  (s->noisy || !(error <= rough * s->size)),
                              .truncation = s->truncation,
                              .rounding = s->rounding,
                              .size = s->size};
}

nevh_step_report nevh_field_step_report(const nevh_field *f, size_t i) {
    if (!f)
        return (nevh_step_report){0};
    if (i >= f->n_steps)
        return (nevh_step_report){.term = ""};
    size_t low = 0, high = f->n_terms; /* of terms that begin up to i */
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (f->terms[middle].first_step <= i)
            low = middle;
        else
            high = middle;
    }
    return report_describe(f, &f->terms[low], i - f->terms[low].first_step);
}

/* Power of the noise, a sum over variables of (velocity times noise in the
   force)^2; the bound epsilon |h| / delta is about four times the rms. */
static double noise_power(const nevh_field *f, const double *v) {
    const double *dq = v, *dp = dq + f->n, *nq = dp + f->n, *np = nq + f->n;
    double sum = 0;
    for (size_t k = 0; k < f->n; k++)
        sum += (dp[k] * nq[k]) * (dp[k] * nq[k]) +
               (dq[k] * np[k]) * (dq[k] * np[k]);
    return sum / 16;
}

int nevh_field_energy_floor(nevh_field *f, double t, const double q[],
                            const double p[], double h, size_t steps,
                            double *energy) {
    if (!f)
        return NEVH_EINVAL;
    double *v = nevh__array(4 * f->n, sizeof *v);
    if (!v)
        return nevh__no_memory(&f->report);
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    int status = nevh_field_gradient(f, 1, &t, q, p, v, v + f->n);
    if (!status)
        status = nevh__field_noise(f, t, q, p, v + 2 * f->n, v + 3 * f->n);
    if (!status)
        *energy = fabs(h) * sqrt((double)steps * noise_power(f, v));
    fesetenv(&own);
    free(v);
    return status;
}
