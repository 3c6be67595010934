/* nevh: GSL's steppers behind nevh's interface.

   With a tolerance of 0 a step is one GSL step of h, so that order and energy
   error can be compared at equal h.  With a tolerance, GSL's own control takes
   as many steps within h as it needs; the size it arrived at is remembered,
   the history of a multistep method is not: each step begins with order 1.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gradient/control_private.h"
#include "gsl_private.h"
#include "work/work_private.h"
#include "system/system_private.h"
#include <gsl/gsl_errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

/* GSL's time begins at 0 with every step, so that it can be told how short a
   substep is wherever on the clock the step stands. */
typedef struct {
    gsl_odeiv2_system system;
    gsl_odeiv2_step *step;
    gsl_odeiv2_control *control; /* NULL: fixed steps */
    nevh__control tolerance;
    gsl_odeiv2_evolve *evolve;
    gsl_odeiv2_driver driver; /* multistep methods ask it for the control */
    double start;
} gsl_plan;

static void clear(nevh_work *w) {
    gsl_plan *g = w->plan;
    if (!g)
        return;
    gsl_odeiv2_step_free(g->step);
    gsl_odeiv2_evolve_free(g->evolve);
    free(g);
    w->plan = NULL;
}

static int slopes(double t, const double y[], double dydt[], void *params) {
    nevh_work *w = params;
    const gsl_plan *g = w->plan;
    size_t n = w->n;
    double time = g->start + t;
    if (nevh_field_gradient(w->field, 1, &time, y, y + n, dydt + n, dydt))
        return GSL_EBADFUNC;
    for (size_t i = n; i < 2 * n; i++)
        dydt[i] = -dydt[i];
    for (size_t k = 0; w->friction && k < n; k++)
        dydt[n + k] -= w->friction[k] * y[n + k];
    return GSL_SUCCESS;
}

/* Tolerances relative to max(|y|, scale) or so: GSL adds the two. */
static void plan_control(nevh_work *w) {
    gsl_plan *g = w->plan;
    double tolerance = w->options->tolerance;
    g->tolerance = (nevh__control){.absolute = tolerance,
                                   .relative = tolerance,
                                   .by_size = true,
                                   .scale = w->scale};
    nevh__control_init(&g->tolerance);
    g->control = &g->tolerance.gsl;
    g->driver = (gsl_odeiv2_driver){
        .sys = &g->system, .s = g->step, .c = g->control, .e = g->evolve};
    gsl_odeiv2_step_set_driver(g->step, &g->driver);
}

/* An error of 0 over one of 0 is good enough for GSL. */
static int check_tolerance(nevh_work *w) {
    double tolerance = w->options->tolerance;
    if (!(tolerance > 0))
        return NEVH_OK;
    int status = nevh_work_find_scale(w);
    if (status)
        return status;
    for (size_t i = 0; i < 2 * w->n; i++)
        if (!(tolerance * w->scale[i] > 0))
            return nevh_work_fail(w, NEVH_EINVAL,
                                  "the tolerance %g of a length of %g is 0",
                                  tolerance, w->scale[i]);
    return NEVH_OK;
}

/* Memory: the size of the last step within a step. */
static int plan(nevh_work *w) {
    const gsl_odeiv2_step_type *const *type = w->integrator->table;
    bool adapts = w->options->tolerance > 0;
    if (w->integrator->needs_tolerance && !adapts)
        return nevh_work_fail(w, NEVH_EINVAL,
                              "%s has no fixed steps: it needs a tolerance",
                              w->integrator->name);
    int status = check_tolerance(w);
    if (status)
        return status;
    gsl_plan *g = w->plan = nevh__array(1, sizeof *g);
    void *trial = nevh__array(2 * w->n, 64 * sizeof(double));
    free(trial); /* GSL aborts where memory is out: ask first */
    if (!g || !trial)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    g->system = (gsl_odeiv2_system){slopes, NULL, 2 * w->n, w};
    g->step = gsl_odeiv2_step_alloc(*type, 2 * w->n);
    g->evolve = gsl_odeiv2_evolve_alloc(2 * w->n);
    if (adapts && g->step)
        plan_control(w);
    if (!g->step || !g->evolve)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = 1;
    w->scratch_size = 2 * w->n * (w->width + 1) + w->width;
    return NEVH_OK;
}

static int fail(nevh_work *w, double t, const char *why) {
    if (nevh_field_status(w->field))
        return nevh_work_fail(w, nevh_field_status(w->field), "%s",
                              nevh_field_message(w->field));
    return nevh_work_fail(w, NEVH_EFAILED, "%s gave up at t = %.9g: %s",
                          w->integrator->name, t, why);
}

/* Scratch for GSL's error estimates, behind the states of all lanes. */
static double *errors(const nevh_work *w) {
    return w->scratch + 2 * w->n * w->width;
}

/* GSL would begin with all of h, from which H may be far beyond its domain. */
static int choose_size(nevh_work *w, double h, const double y[], double *size) {
    gsl_plan *g = w->plan;
    int order = (int)gsl_odeiv2_step_order(g->step);
    bool anew = w->integrator->needs_tolerance; /* from order 1 */
    double length = anew ? 0 : *size;
    if (length == 0 && slopes(0, y, errors(w), w))
        return GSL_EBADFUNC;
    if (length == 0)
        length =
            nevh__first_substep(w, order > 1 ? order : 2, h, 1, y, errors(w));
    *size = copysign(length, h);
    return fabs(length) > DBL_EPSILON * fabs(h) ? GSL_SUCCESS : GSL_EMAXITER;
}

/* Steps by h under GSL's control; y and the step's size in and out. */
static int adapt(nevh_work *w, double h, double y[], double *size) {
    gsl_plan *g = w->plan;
    double t = 0;
    gsl_odeiv2_evolve_reset(g->evolve);
    int status = h == 0 ? GSL_SUCCESS : choose_size(w, h, y, size);
    nevh__pace pace = {0};
    char why[NEVH__WHY];
    while (!status && (h > 0 ? t < h : t > h)) {
        if (nevh__too_many(&pace, fabs(h), fabs(t), why))
            return fail(w, g->start + t, why);
        status = gsl_odeiv2_evolve_apply(g->evolve, g->control, g->step,
                                         &g->system, &t, h, size, y);
        if (!status && *size == 0)
            status = GSL_EFAILED;
    }
    return status ? fail(w, g->start + t, gsl_strerror(status)) : NEVH_OK;
}

static int take(nevh_work *w, double t, double h, double y[], double *size) {
    gsl_plan *g = w->plan;
    g->start = t;
    gsl_odeiv2_step_reset(g->step);
    if (g->control)
        return adapt(w, h, y, size);
    int status = gsl_odeiv2_step_apply(g->step, 0, h, y, errors(w), NULL, NULL,
                                       &g->system);
    return status ? fail(w, t, gsl_strerror(status)) : NEVH_OK;
}

/* One lane, from q, p to y; the result must be finite. */
static int step_lane(nevh_work *w, double t, double h, size_t lane,
                     const double q[], const double p[], double y[],
                     double *size) {
    for (size_t k = 0; k < w->n; k++) {
        y[k] = q[k * w->width + lane];
        y[w->n + k] = p[k * w->width + lane];
    }
    int status = take(w, t, h, y, size);
    double check = 0;
    for (size_t k = 0; !status && k < 2 * w->n; k++)
        check += y[k] - y[k];
    return check == 0 ? status : nevh__fail_range(w, t, h);
}

static int step(nevh_work *w, double t, double h, double q[], double p[]) {
    size_t n = w->n, each = 2 * n;
    double *y = w->scratch, *size = y + (w->width + 1) * each;
    int status = NEVH_OK;
    for (size_t lane = 0; !status && lane < w->width; lane++) {
        size[lane] = w->memory[lane];
        status = step_lane(w, t, h, lane, q, p, y + lane * each, size + lane);
    }
    for (size_t lane = 0; !status && lane < w->width; lane++) {
        for (size_t k = 0; k < n; k++) {
            q[k * w->width + lane] = y[lane * each + k];
            p[k * w->width + lane] = y[lane * each + n + k];
        }
        w->memory[lane] = fabs(size[lane]);
    }
    return status;
}

const nevh_kernel nevh__gsl_kernel = {.plan = plan,
                                      .step = step,
                                      .clear = clear,
                                      .has_friction = true,
                                      .opaque = true};
