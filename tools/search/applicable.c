/* nevh: which schemes and gradients fit a scene.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "study.h"
#include <math.h>
#include <stdlib.h>

/* With a gradient that takes no time to plan: what a scheme needs is asked of
   H, and whether a gradient fits is another question. */
static bool fits(const plan *p, const nevh_integrator *scheme) {
    nevh_options o = plan_options(p, "central2");
    o.gradient_step = 1e-3;
    o.gradient_steps = NULL;
    o.transform = plan_transform(p, nevh_integrator_name(scheme));
    if (nevh_integrator_adaptive(scheme))
        o.tolerance = 1e-6;
    nevh_stepper *s = nevh_stepper_new(p->system, scheme, &o);
    int status = nevh_stepper_status(s);
    nevh_stepper_free(s);
    return !status;
}

/* True if effects that are to be fast are no forms. */
static bool takes_substeps(const plan *p) {
    return fits(p, nevh_respa) && !fits(p, nevh_wisdom_holman);
}

static void fitting_integrators(const plan *p, list *names) {
    const nevh_integrator *scheme;
    for (size_t i = 0; (scheme = plan_scheme_at(p, i)); i++)
        if (fits(p, scheme))
            list_split(names, scheme == nevh_respa && takes_substeps(p)
                                  ? "respa+2,respa+4,respa+8,respa+16"
                                  : nevh_integrator_name(scheme));
}

bool gradient_fits(const plan *p, const char *gradient, char **why) {
    nevh_options o = plan_options(p, gradient);
    nevh_field *field = nevh_field_new(p->system, &o);
    int status = nevh_field_status(field);
    if (why)
        *why = text_print("%s", nevh_field_message(field));
    nevh_field_free(field);
    return !status;
}

int plan_require_reference(plan *p) {
    int status = plan_reference(p, p->t_end);
    if (status)
        return status;
    if (!p->reference)
        tool_refuse("%s: no state errors: %s", p->name, p->no_reference);
    else if (p->t_end > nevh_reference_horizon(p->reference))
        tool_refuse("%s: no state errors after the predictability horizon "
                    "t = %.4g (%s); --t-end shortens the run",
                    p->name, nevh_reference_horizon(p->reference),
                    nevh_reference_text(p->reference));
    else
        return TOOL_OK;
    return TOOL_FAILED;
}

/* 1, 0.5, 0.2, 0.1, ...: the largest that is not above x. */
static double share_below(double x) {
    int k = 0;
    while (grid_tolerance(k) > x)
        k += GRID_COARSE;
    return grid_tolerance(k);
}

double plan_shorten(plan *p, double budget) {
    enum { RUNS = 8 }; /* of the kind that is measured, an integrator */
    double whole = p->t_end, span = whole - p->run->t_start;
    nevh_field *field = plan_values(p);
    nevh_counts step = {.gradients = 1,
                        .instances = nevh_field_counts(field).instances};
    double runs = (double)(RUNS * p->integrators.count);
    double share = budget / 6 /
                   (runs * nevh_counts_seconds(&step, p->n, nevh_verlet, 2, 1) *
                    span / plan_shortest_dt(p));
    nevh_field_free(field);
    if (share < 1)
        p->t_end = p->run->t_start + share_below(share) * span;
    return whole;
}

/* TOOL_FAILED, with a message, where the run is to stop at its start. */
static int plan_goes_anywhere(const plan *p) {
    bool reached = false;
    if (nevh_scene_stops(p->scene) &&
        !nevh_scene_stop_reached(p->scene, p->run->t_start, p->q, p->p,
                                 &reached) &&
        reached) {
        tool_refuse("%s: the run stops at its start, where %s holds already",
                    p->name, nevh_scene_stop_text(p->scene));
        return TOOL_FAILED;
    }
    return TOOL_OK;
}

int plan_search(plan *p, const options *o) {
    if (o->gradients.count == 0) {
        p->gradients = (list){0};
        list_add(&p->gradients,
                 gradient_fits(p, "exact", NULL) ? "exact" : "central4");
    }
    if (o->integrators.count == 0) {
        p->integrators = (list){0};
        fitting_integrators(p, &p->integrators);
    }
    if (!plan_fits(p, NULL))
        return TOOL_USAGE;
    int status = plan_goes_anywhere(p);
    return status ? status : plan_refuse_end(p);
}
