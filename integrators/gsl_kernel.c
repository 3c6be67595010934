/* nevh: GSL's Runge-Kutta steppers behind nevh's interface.

   With a tolerance of 0 a step is one GSL step of h, so that order and energy
   error can be compared at equal h.  With a tolerance, GSL's own control takes
   as many steps within h as it needs; the size it arrived at is remembered.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "gsl_private.h"
#include "work_private.h"
#include "system/system_private.h"
#include <gsl/gsl_errno.h>
#include <math.h>
#include <nevh/gsl.h>
#include <stdlib.h>

enum { MOST_SUBSTEPS = 1000000 };

typedef struct {
    gsl_odeiv2_system system;
    gsl_odeiv2_step *step;
    gsl_odeiv2_control *control; /* NULL: fixed steps */
    gsl_odeiv2_evolve *evolve;
} gsl_plan;

static void unplan(nevh_work *w) {
    gsl_plan *g = w->plan;
    if (!g)
        return;
    gsl_odeiv2_step_free(g->step);
    gsl_odeiv2_control_free(g->control);
    gsl_odeiv2_evolve_free(g->evolve);
    free(g);
    w->plan = NULL;
}

/* Memory: the size of the last step within a step. */
static int plan(nevh_work *w) {
    const gsl_odeiv2_step_type *const *type = w->integrator->table;
    double tolerance = w->options->tolerance;
    gsl_plan *g = w->plan = nevh__array(1, sizeof *g);
    void *trial = nevh__array(2 * w->n, 32 * sizeof(double));
    free(trial); /* GSL aborts where memory is out: ask first */
    if (!g || !trial)
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    g->system = nevh_gsl_system(w->field);
    g->step = gsl_odeiv2_step_alloc(*type, 2 * w->n);
    g->evolve = gsl_odeiv2_evolve_alloc(2 * w->n);
    if (tolerance > 0)
        g->control = gsl_odeiv2_control_y_new(0, tolerance);
    if (!g->system.jacobian || !g->step || !g->evolve ||
        (tolerance > 0 && !g->control))
        return nevh_work_fail(w, NEVH_ENOMEM, "out of memory");
    w->memory_rows = 1;
    w->scratch_size = 2 * w->n * (w->width + 1) + w->width;
    return NEVH_OK;
}

static int fail(nevh_work *w, double t, int gsl_status) {
    if (nevh_field_status(w->field))
        return nevh_work_fail(w, nevh_field_status(w->field), "%s",
                              nevh_field_message(w->field));
    return nevh_work_fail(w, NEVH_EFAILED, "%s gave up at t = %.9g: %s",
                          w->integrator->name, t, gsl_strerror(gsl_status));
}

/* From t to t + h under GSL's control; y and the step's size in and out. */
static int adapt(nevh_work *w, double t, double h, double y[], double *size) {
    gsl_plan *g = w->plan;
    double end = t + h;
    gsl_odeiv2_evolve_reset(g->evolve);
    int status = GSL_SUCCESS;
    for (int i = 0; !status && (h > 0 ? t < end : t > end); i++) {
        status = i < MOST_SUBSTEPS
                     ? gsl_odeiv2_evolve_apply(g->evolve, g->control, g->step,
                                               &g->system, &t, end, size, y)
                     : GSL_EMAXITER;
        if (!status && *size == 0)
            status = GSL_EFAILED;
    }
    return status ? fail(w, t, status) : NEVH_OK;
}

/* Where GSL writes its estimates, behind the states of all lanes. */
static double *errors(const nevh_work *w) {
    return w->scratch + 2 * w->n * w->width;
}

static int take(nevh_work *w, double t, double h, double y[], double *size) {
    gsl_plan *g = w->plan;
    gsl_odeiv2_step_reset(g->step);
    if (g->control)
        return adapt(w, t, h, y, size);
    int status = gsl_odeiv2_step_apply(g->step, t, h, y, errors(w), NULL, NULL,
                                       &g->system);
    return status ? fail(w, t, status) : NEVH_OK;
}

/* One lane, from q, p to y; the result must be finite. */
static int step_lane(nevh_work *w, double t, double h, size_t lane,
                     const double q[], const double p[], double y[],
                     double *size) {
    for (size_t k = 0; k < w->n; k++) {
        y[k] = q[k * w->width + lane];
        y[w->n + k] = p[k * w->width + lane];
    }
    if (*size == 0 || (*size > 0) != (h > 0))
        *size = h;
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
        w->memory[lane] = size[lane];
    }
    return status;
}

const nevh_kernel nevh__gsl_kernel = {
    .plan = plan, .step = step, .unplan = unplan, .opaque = true};
