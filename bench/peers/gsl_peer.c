/* nevh: GSL's odeiv2 as a peer, through its driver.  The Jacobian that rk4imp
   asks for is made of forward differences.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "peer.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_version.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    const method *method;
    const problem *problem;
    double setting;
    gsl_odeiv2_system system;
    gsl_odeiv2_driver *driver;
} run;

/* As adaptive steps may fall to nothing. */
enum { MOST_STEPS = 1000000 };

static int jacobian(double t, const double y[], double *dfdy, double dfdt[],
                    void *data) {
    const problem *p = data;
    size_t size = 2 * p->n;
    double at[2 * MOST_N], here[2 * MOST_N], there[2 * MOST_N];
    memcpy(at, y, size * sizeof *y);
    p->slopes(t, y, here, NULL);
    for (size_t k = 0; k < size; k++) {
        double step = 0x1p-26 * fmax(fabs(y[k]), 0x1p-26);
        at[k] = y[k] + step;
        p->slopes(t, at, there, NULL);
        for (size_t i = 0; i < size; i++)
            dfdy[i * size + k] = (there[i] - here[i]) / (at[k] - y[k]);
        at[k] = y[k];
        dfdt[k] = 0;
    }
    return GSL_SUCCESS;
}

static void *open_run(const method *m, const problem *p, double setting) {
    const gsl_odeiv2_step_type *type =
        *(const gsl_odeiv2_step_type *const *)m->data;
    run *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    *r = (run){.method = m, .problem = p, .setting = setting};
    r->system = (gsl_odeiv2_system){p->slopes, jacobian, 2 * p->n, (void *)p};
    double tolerance = m->adaptive ? setting : 1e-6;
    r->driver = gsl_odeiv2_driver_alloc_y_new(&r->system, type, p->t_end / 1000,
                                              p->size * tolerance, tolerance);
    gsl_odeiv2_driver_set_nmax(r->driver, MOST_STEPS);
    return r;
}

static bool run_driver(void *data, double y[], double *seconds) {
    run *r = data;
    const problem *p = r->problem;
    double t = 0;
    (void)seconds;
    memcpy(y, p->start, 2 * p->n * sizeof *y);
    gsl_odeiv2_driver_reset_hstart(r->driver, p->t_end / 1000);
    int status = r->method->adaptive
                     ? gsl_odeiv2_driver_apply(r->driver, &t, p->t_end, y)
                     : gsl_odeiv2_driver_apply_fixed_step(
                           r->driver, &t, p->t_end / r->setting,
                           (unsigned long)r->setting, y);
    return status == GSL_SUCCESS;
}

static void close_run(void *data) {
    run *r = data;
    gsl_odeiv2_driver_free(r->driver);
    free(r);
}

#define METHOD(title, adapts, type, its_order)                                 \
    {                                                                          \
        .scheme = title, .adaptive = adapts, .open = open_run,                 \
        .run = run_driver, .close = close_run,                                 \
        .data = &gsl_odeiv2_step_##type, .order = its_order                    \
    }
static const method methods[] = {
    METHOD("rk4", false, rk4, 4),
    METHOD("rk8pd", false, rk8pd, 8),
    METHOD("rk4imp", false, rk4imp, 4),
    METHOD("rkf45, adaptive", true, rkf45, 5),
    METHOD("rk8pd, adaptive", true, rk8pd, 8),
    METHOD("msadams, adaptive", true, msadams, 12),
};
const library gsl_library = {.name = "GSL",
                             .version = GSL_VERSION,
                             .count = sizeof methods / sizeof *methods,
                             .methods = methods};
