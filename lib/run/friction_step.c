/* nevh: friction put around the steps of a scheme that knows none.

   The flow of dp/dt = -rate p over half a step is p exp(-rate h/2).  Putting it
   before and after a step keeps a symmetric scheme symmetric and a symplectic
   one conformally symplectic [McLachlan, Perlmutter, "Conformal Hamiltonian
   systems", J. Geom. Phys. 39 (2001) 276-300].  Two such halves meet between
   steps; they are not joined, so that the orbit is the same whether or not
   anyone looks.

   A factor has two parts and so has a product, whose second part is carried on:
   otherwise the error of the one rounded factor would grow with each step.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include "work/ledger_private.h"
#include <nevh/simd.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct nevh__friction_step {
    double h;                   /* that the factors are for */
    double *factor, *remainder; /* n: exp(-rate h/2) is their sum */
    double *q, *p;              /* n x width: a step under way */
    double *before;             /* the memory that is not the ledger's */
};

int nevh__plan_friction(nevh_stepper *s) {
    nevh_work *w = &s->work;
    const nevh_integrator *scheme = w->integrator;
    if (!nevh_system_friction(w->system, NULL))
        return NEVH_OK;
    s->rates = nevh__array(w->n, sizeof *s->rates);
    if (!s->rates)
        return nevh__no_memory(&s->report);
    nevh_system_friction(w->system, s->rates);
    char name[NEVH__VARIABLE];
    for (size_t k = 0; k < w->n; k++)
        if (!isfinite(s->rates[k]))
            return nevh__fail(&s->report, NEVH_EINVAL,
                              "the rates of friction of %s add up to %g",
                              nevh__variable_name(w->system, true, k, name),
                              s->rates[k]);
    if (s->options.transform && !scheme->own_time)
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "%s takes no friction under a time transform, which "
                          "needs an energy that is conserved",
                          scheme->name);
    if (scheme->kernel->has_friction)
        w->friction = s->rates;
    else if (scheme->own_time)
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "%s takes no friction: it chooses its own times, and "
                          "friction is put around steps of a given one",
                          scheme->name);
    return NEVH_OK;
}

int nevh__friction_step_plan(nevh_stepper *s) {
    const nevh_work *w = &s->work;
    if (!s->rates || w->friction)
        return NEVH_OK;
    struct nevh__friction_step *d = s->friction = nevh__array(1, sizeof *d);
    if (!d)
        return nevh__no_memory(&s->report);
    d->h = NAN;
    d->factor = nevh__array(w->n, sizeof *d->factor);
    d->remainder = nevh__array(w->n, sizeof *d->remainder);
    d->q = nevh__array(w->size, sizeof *d->q);
    d->p = nevh__array(w->size, sizeof *d->p);
    d->before =
        nevh__array((w->memory_rows + w->n) * w->width, sizeof *d->before);
    if (d->factor && d->remainder && d->q && d->p && d->before)
        return NEVH_OK;
    return nevh__no_memory(&s->report);
}

void nevh__friction_step_free(struct nevh__friction_step *d) {
    if (!d)
        return;
    free(d->factor);
    free(d->remainder);
    free(d->q);
    free(d->p);
    free(d->before);
    free(d);
}

/* Near 1 the two parts hold what exp(x) - 1 = 2 sinh(x/2) exp(x/2) knows beyond the
   last bit of exp. */
static void set_factors(const nevh_stepper *s, double h) {
    struct nevh__friction_step *d = s->friction;
    if (d->h == h)
        return;
    for (size_t k = 0; k < s->work.n; k++) {
        double x = -s->rates[k] * h / 2;
        double change = 2 * nevh_simd_sinh(x / 2) * nevh_simd_exp(x / 2);
        bool near = fabs(change) <= 0.5;
        d->factor[k] = near ? 1 + change : nevh_simd_exp(x);
        d->remainder[k] = near ? change - (d->factor[k] - 1) : 0;
    }
    d->h = h;
}

/* p and its compensation times the factors; whether all p are finite. */
static bool friction_step_multiply(const nevh_work *w,
                                   struct nevh__friction_step *d,
                                   double compensation[]) {
    double check = 0;
    for (size_t i = 0; i < w->size; i++) {
        double factor = d->factor[i / w->width],
               remainder = d->remainder[i / w->width];
        double x = d->p[i], next = x * factor;
        double roundoff =
            fma(x, factor, -next) + (x * remainder + compensation[i] * factor);
        d->p[i] = next + roundoff;
        compensation[i] = roundoff - (d->p[i] - next);
        check += d->p[i] - d->p[i];
    }
    return check == 0;
}

/* Half a step of friction at time t. */
static int friction_step_apply(nevh_stepper *s, double t, double h) {
    nevh_work *w = &s->work;
    struct nevh__friction_step *d = s->friction;
    int status = nevh__ledger_add(w, -1, t, d->q, d->p);
    if (!status &&
        !friction_step_multiply(w, d, w->memory + w->memory_rows * w->width))
        status = nevh__fail(&s->report, NEVH_EDOM,
                            "friction over half a step of %g from t = %.9g "
                            "leaves the range of numbers: take a smaller one",
                            h, t);
    if (!status && w->integrator->kernel->apply_friction)
        w->integrator->kernel->apply_friction(w, d->factor);
    return status ? status : nevh__ledger_add(w, 1, t, d->q, d->p);
}

int nevh__friction_step_apply(nevh_stepper *s, double t, double h, double q[],
                              double p[]) {
    nevh_work *w = &s->work;
    struct nevh__friction_step *d = s->friction;
    size_t size = w->size * sizeof *q;
    size_t memory = s->fresh_rows * w->width * sizeof *w->memory;
    set_factors(s, h);
    memcpy(d->before, w->memory, memory);
    memcpy(d->q, q, size);
    memcpy(d->p, p, size);
    int status = friction_step_apply(s, t, h);
    if (!status)
        status = nevh__native_step(w, t, h, d->q, d->p);
    if (!status)
        status = friction_step_apply(s, t + h, h);
    if (status) {
        memcpy(w->memory, d->before, memory);
        return status;
    }
    memcpy(q, d->q, size);
    memcpy(p, d->p, size);
    return NEVH_OK;
}

int nevh_stepper_order(const nevh_stepper *s) {
    if (!s || !s->work.integrator)
        return 0;
    int order = s->work.order ? s->work.order : s->work.integrator->order;
    return s->friction && order > 2 ? 2 : order;
}
