/* nevh: an observer that finds the points of sections.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/section_private.h"
#include "gradient/field_private.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int section_check(nevh_sections *x, const nevh_section *decl,
                         size_t number) {
    if (decl->value ? decl->every == 0
                    : decl->every > 0 && isfinite(decl->every)) {
        if (decl->period >= 0 && isfinite(decl->period) &&
            abs(decl->direction) <= 1)
            return NEVH_OK;
        return nevh__fail(&x->report, NEVH_EINVAL,
                          "section %zu: the direction is %d (1, -1 or 0) and "
                          "the period %g",
                          number, decl->direction, decl->period);
    }
    return nevh__fail(&x->report, NEVH_EINVAL,
                      "section %zu: either a value or a positive time between "
                      "points is to be given",
                      number);
}

static int plan_state(nevh_sections *x, size_t i, const nevh_section *decl) {
    nevh__section_state *k = &x->states[i];
    size_t n = x->branch->work.n;
    k->decl = *decl;
    k->number = i;
    k->decl.name = decl->name ? nevh__text("%s", decl->name) : NULL;
    k->q = nevh__array(n, sizeof *k->q);
    k->p = nevh__array(n, sizeof *k->p);
    x->crossings |= decl->value != NULL;
    if (!k->q || !k->p || (decl->name && !k->decl.name))
        return nevh__no_memory(&x->report);
    return section_check(x, decl, i);
}

/* GSL aborts where memory is out: ask first for more than it takes. */
static int plan_solvers(nevh_sections *x) {
    void *trial = nevh__array(128, sizeof(double));
    free(trial);
    if (!trial)
        return nevh__no_memory(&x->report);
    x->root = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    x->least = gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent);
    return x->root && x->least ? NEVH_OK : nevh__no_memory(&x->report);
}

static int plan_states(nevh_sections *x) {
    const nevh_stepper *s = x->branch;
    size_t n = s->work.n;
    x->q = nevh__array(6 * n, sizeof *x->q);
    x->memory = nevh__array(s->rows * s->work.width, sizeof *x->memory);
    if (!x->q || !x->memory)
        return nevh__no_memory(&x->report);
    x->p = x->q + n;
    x->q_try = x->p + n;
    x->p_try = x->q_try + n;
    x->dq = x->p_try + n;
    x->dp = x->dq + n;
    return NEVH_OK;
}

static int section_plan(nevh_sections *x, const nevh_section sections[]) {
    const nevh_stepper *s = x->branch;
    if (nevh_stepper_status(s))
        return nevh__fail_as(&x->report, &s->report);
    if (s->work.width > 1)
        return nevh__fail(&x->report, NEVH_EINVAL,
                          "sections take one orbit, not %zu side by side",
                          s->work.width);
    int status = plan_states(x);
    for (size_t i = 0; !status && i < x->count; i++)
        status = plan_state(x, i, &sections[i]);
    return status ? status : plan_solvers(x);
}

nevh_sections *nevh_sections_new(const nevh_stepper *stepper,
                                 const nevh_section sections[], size_t count,
                                 nevh_point_fn tell, void *data) {
    nevh_sections *x = stepper ? nevh__array(1, sizeof *x) : NULL;
    if (!x)
        return NULL;
    x->stepper = stepper;
    x->branch = nevh_stepper_copy(stepper);
    x->tell = tell;
    x->data = data;
    x->states = nevh__array(count, sizeof *x->states);
    x->count = x->states ? count : 0;
    int status =
        x->branch && x->states ? section_plan(x, sections) : NEVH_ENOMEM;
    x->planned = status == NEVH_OK;
    if (status != NEVH_ENOMEM)
        return x;
    nevh_sections_free(x);
    return NULL;
}

void nevh_sections_free(nevh_sections *x) {
    if (!x)
        return;
    for (size_t i = 0; i < x->count; i++) {
        free((char *)x->states[i].decl.name);
        free(x->states[i].q);
        free(x->states[i].p);
    }
    if (x->root)
        gsl_root_fsolver_free(x->root);
    if (x->least)
        gsl_min_fminimizer_free(x->least);
    nevh_stepper_free(x->branch);
    free(x->states);
    free(x->q);
    free(x->memory);
    free(x);
}

NEVH__REPORTS(sections)

nevh_counts nevh_sections_counts(const nevh_sections *x) {
    if (!x)
        return (nevh_counts){0};
    return nevh_stepper_counts(x->branch);
}

/* The state, from which the next step begins. */
static void section_keep(nevh_sections *x, double t, const double q[],
                         const double p[]) {
    const nevh_stepper *s = x->stepper;
    size_t size = s->work.size * sizeof(double);
    x->t = t;
    memcpy(x->q, q, size);
    memcpy(x->p, p, size);
    memcpy(x->memory, s->work.memory, s->rows * s->work.width * sizeof(double));
}

static bool section_goes_on(const nevh_sections *x, double t, const double q[],
                            const double p[]) {
    size_t size = x->stepper->work.size * sizeof(double);
    return x->begun && t == x->t && memcmp(q, x->q, size) == 0 &&
           memcmp(p, x->p, size) == 0;
}

static int section_begin(nevh_sections *x, double t, const double q[],
                         const double p[]) {
    int status = NEVH_OK;
    x->begun = x->first = true;
    x->origin = t;
    for (size_t i = 0; !status && i < x->count; i++) {
        nevh__section_state *k = &x->states[i];
        k->came = 0;
        k->points = 0;
        if (k->decl.value)
            status = nevh__section_value(x, k, t, q, p, &k->value);
    }
    return status;
}

/* dq/dt and dp/dt; whether they are known. */
static bool flow(nevh_sections *x, double t, const double q[],
                 const double p[]) {
    nevh_stepper *s = x->branch;
    if (nevh__field_whole_gradient(s->work.field, 1, &t, q, p, x->dp, x->dq))
        return false;
    for (size_t i = 0; i < s->work.n; i++)
        x->dp[i] = -x->dp[i] - (s->rates ? s->rates[i] * p[i] : 0);
    return true;
}

/* The slope of a value along the flow, NAN where it is unknown. */
static double slope(nevh_sections *x, const nevh__section_state *k, double t,
                    const double q[], const double p[], double value) {
    double d = nevh__section_ahead * (x->t_after - x->t), next;
    for (size_t i = 0; i < x->branch->work.n; i++) {
        x->q_try[i] = q[i] + d * x->dq[i];
        x->p_try[i] = p[i] + d * x->dp[i];
    }
    if (k->decl.value(k->decl.data, t + d, x->q_try, x->p_try, &next))
        return NAN;
    return (next - value) / d;
}

static void find_slopes_before(nevh_sections *x) {
    bool flows = flow(x, x->t, x->q, x->p);
    for (nevh__section_state *k = x->states; k < x->states + x->count; k++)
        if (k->decl.value)
            k->slope = flows ? slope(x, k, x->t, x->q, x->p, k->value) : NAN;
}

static void find_slopes_after(nevh_sections *x) {
    bool flows = flow(x, x->t_after, x->q_after, x->p_after);
    for (nevh__section_state *k = x->states; k < x->states + x->count; k++)
        if (k->decl.value)
            k->slope_after = flows ? slope(x, k, x->t_after, x->q_after,
                                           x->p_after, k->value_after)
                                   : NAN;
}

/* The first point of each section within the step. */
static int section_look(nevh_sections *x, nevh__section_state *k) {
    int status = NEVH_OK;
    k->piece = 0;
    k->opened = false;
    if (k->decl.value)
        status = nevh__section_nodes(x, k);
    return status ? status : nevh__section_next(x, k);
}

static nevh__section_state *earliest(nevh_sections *x) {
    nevh__section_state *first = NULL;
    for (nevh__section_state *k = x->states; k < x->states + x->count; k++)
        if (k->found && (!first || k->s < first->s))
            first = k;
    return first;
}

static int section_tell(nevh_sections *x) {
    int status = NEVH_OK;
    nevh__section_state *k;
    while (!status && (k = earliest(x))) {
        nevh_point point = {k->number, k->direction, k->t, k->q, k->p};
        if (x->tell(x->data, &point))
            return nevh__fail(&x->report, NEVH_STOPPED,
                              "the run was to stop at a point at t = %.9g",
                              k->t);
        status = nevh__section_next(x, k);
    }
    return status;
}

int nevh__sections_search(nevh_sections *x) {
    int status = NEVH_OK;
    x->tried = NAN;
    for (size_t i = 0; !status && i < x->count; i++)
        status = section_look(x, &x->states[i]);
    return status ? status : section_tell(x);
}

static int section_search(nevh_sections *x) {
    int status = NEVH_OK;
    for (size_t i = 0; !status && i < x->count; i++) {
        nevh__section_state *k = &x->states[i];
        if (k->decl.value)
            status = nevh__section_value(x, k, x->t_after, x->q_after,
                                         x->p_after, &k->value_after);
    }
    if (status)
        return status;
    if (x->crossings && x->first)
        find_slopes_before(x);
    if (x->crossings)
        find_slopes_after(x);
    return nevh__sections_search(x);
}

static int pass(nevh_sections *x, double t, const double q[],
                const double p[]) {
    x->t_after = t;
    x->h = x->stepper->last_h;
    x->q_after = q;
    x->p_after = p;
    x->memory_after = x->stepper->work.memory;
    int status = section_search(x);
    for (nevh__section_state *k = x->states; k < x->states + x->count; k++) {
        k->value = k->value_after;
        k->slope = k->slope_after;
    }
    x->first = false;
    return status;
}

int nevh_sections_observe(void *sections, size_t step, double t,
                          const double q[], const double p[]) {
    nevh_sections *x = sections;
    if (!x || !x->planned)
        return nevh_sections_status(x);
    int status = NEVH_OK;
    bool starts = step == 0 && !section_goes_on(x, t, q, p);
    x->report = (nevh__report){0};
    if (starts)
        status = section_begin(x, t, q, p);
    else if (step > 0 && (!x->begun || step != x->step + 1))
        status = nevh__fail(&x->report, NEVH_EINVAL,
                            "sections are to be shown every step, not step %zu "
                            "after step %zu",
                            step, x->step);
    else if (step > 0)
        status = pass(x, t, q, p);
    section_keep(x, t, q, p);
    x->step = step;
    x->begun = status == NEVH_OK || status == NEVH_STOPPED;
    return status;
}
