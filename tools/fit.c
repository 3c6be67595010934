/* nevh: which schemes and gradients fit a scene.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ladder.h"
#include <math.h>

static bool fits(const plan *p, const char *gradient,
                 const nevh_integrator *scheme) {
    nevh_options o = plan_options(p, gradient);
    if (o.gradient_step == 0)
        o.gradient_step = 1e-3; /* nothing is run: no need to choose it */
    o.transform = plan_transform(p, nevh_integrator_name(scheme));
    if (nevh_integrator_adaptive(scheme))
        o.tolerance = 1e-6;
    nevh_stepper *s = nevh_stepper_new(p->system, scheme, &o);
    int status = nevh_stepper_status(s);
    nevh_stepper_free(s);
    return !status;
}

void fitting_integrators(const plan *p, const char *gradient, list *names) {
    for (size_t i = 0; nevh_integrators()[i]; i++)
        if (fits(p, gradient, nevh_integrators()[i]))
            list_add(names, nevh_integrator_name(nevh_integrators()[i]));
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
