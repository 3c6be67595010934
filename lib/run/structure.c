/* nevh: does a scheme fit a Hamiltonian?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/stepper_private.h"
#include <stdio.h>
#include <stdlib.h>

/* "midpoint, gauss4, ..." of schemes that take any H. */
static void suggest(char *text, size_t size) {
    size_t at = 0, found = 0;
    text[0] = '\0';
    for (const nevh_integrator *const *i = nevh_integrators(); *i; i++) {
        if ((*i)->needs || (*i)->symplectic != NEVH_YES || ++found > 3)
            continue;
        int length =
            snprintf(text + at, size - at, "%s%s", at ? ", " : "", (*i)->name);
        at += length > 0 && (size_t)length < size - at ? (size_t)length : 0;
    }
}

/* Lane 0 of the state to plan at, in one piece; NULL where none was given or
   memory is out, both of which the probe takes for zeros. */
static double *first_lane(const nevh_work *w, const double x[]) {
    double *lane = x ? nevh__array(w->n, sizeof *lane) : NULL;
    for (size_t k = 0; lane && k < w->n; k++)
        lane[k] = x[k * w->width];
    return lane;
}

static int refuse(nevh_stepper *s, const nevh_separability *probe, int status) {
    char fit[80];
    const char *name = s->work.integrator->name;
    suggest(fit, sizeof fit);
    if (status == NEVH_ENOMEM)
        return nevh__fail(&s->report, status, "out of memory");
    if (status == NEVH_EDOM)
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "%s needs H = T(p) + V(q), but term \"%s\", which "
                          "reads coordinates and momenta, could not be probed: "
                          "it is not finite around the state to plan at; "
                          "schemes that fit any H: %s",
                          name, probe->term, fit);
    return nevh__fail(&s->report, NEVH_ESTRUCT,
                      "%s needs H = T(p) + V(q), but term \"%s\" mixes "
                      "coordinates and momenta (mixed difference %.2g of its "
                      "size, where rounding gives 1e-16); schemes that fit: %s",
                      name, probe->term, probe->mixed, fit);
}

int nevh__check_structure(nevh_stepper *s) {
    const nevh_work *w = &s->work;
    unsigned missing = w->integrator->needs & ~nevh_system_traits(w->system);
    if (!(missing & NEVH_SEPARABLE))
        return NEVH_OK;
    nevh_separability probe;
    double *q = first_lane(w, s->options.q), *p = first_lane(w, s->options.p);
    int status = NEVH_ENOMEM;
    probe.separable = false;
    if ((q || !s->options.q) && (p || !s->options.p))
        status = nevh_system_probe(w->system, s->options.t, q, p,
                                   s->options.scale, &probe);
    free(q);
    free(p);
    return probe.separable ? NEVH_OK : refuse(s, &probe, status);
}
