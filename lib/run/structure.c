/* nevh: does a scheme fit a Hamiltonian?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernels/form_flow_private.h"
#include "kernels/hierarchy_private.h"
#include "run/stepper_private.h"
#include "system/probe_private.h"
#include <stdio.h>
#include <stdlib.h>

typedef const nevh_integrator *const *entry; /* in the registry */

/* Lower orders first; among equals those that spend more evaluations on their
   order, which are the more accurate ones. */
static bool precedes(entry a, entry b) {
    if ((*a)->order != (*b)->order)
        return (*a)->order < (*b)->order;
    return (*a)->gradients != (*b)->gradients
               ? (*a)->gradients > (*b)->gradients
               : a < b;
}

/* The next after `last` of the symplectic schemes that are of no lower order
   than the refused one, and do not need what is lacking. */
static entry next_fit(const nevh_integrator *refused, unsigned lacking,
                      entry last) {
    entry best = NULL;
    for (entry i = nevh_integrators(); *i; i++) {
        bool fits = (*i)->symplectic == NEVH_YES && !((*i)->needs & lacking) &&
                    (*i)->order >= refused->order;
        if (fits && (!last || precedes(last, i)) &&
            (!best || precedes(i, best)))
            best = i;
    }
    return best;
}

/* "gauss4, gauss6, gauss8". */
static void suggest(const nevh_integrator *refused, unsigned lacking,
                    char *text, size_t size) {
    size_t at = 0;
    entry fit = next_fit(refused, lacking, NULL);
    snprintf(text, size, "none of this order");
    for (int i = 0; fit && i < 3 && at < size; i++) {
        at += (size_t)snprintf(text + at, size - at, "%s%s", at ? ", " : "",
                               (*fit)->name);
        fit = next_fit(refused, lacking, fit);
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

static int refuse_mixed(nevh_stepper *s, const nevh_separability *probe,
                        int status) {
    char fit[80];
    const nevh_integrator *scheme = s->work.integrator;
    suggest(scheme, NEVH_SEPARABLE | NEVH_PARTS, fit, sizeof fit);
    if (status == NEVH_EDOM)
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "%s needs H = T(p) + V(q), but term \"%s\", which "
                          "reads coordinates and momenta, could not be probed: "
                          "it is not finite around the state to plan at; "
                          "schemes that fit any H: %s",
                          scheme->name, probe->term, fit);
    return nevh__fail(&s->report, NEVH_ESTRUCT,
                      "%s needs H = T(p) + V(q), but term \"%s\" mixes "
                      "coordinates and momenta (mixed difference %.2g of its "
                      "size, where rounding gives 1e-16); schemes that fit: %s",
                      scheme->name, probe->term, probe->mixed, fit);
}

/* Below degree 4 the conditions for any T are those for a quadratic one, and
   symmetric schemes are of even order. */
static int refuse_kinetic(nevh_stepper *s, const nevh__kinetic *probe,
                          int status) {
    char fit[80];
    const nevh_integrator *scheme = s->work.integrator;
    suggest(scheme, NEVH_QUADRATIC_KINETIC | NEVH_PARTS, fit, sizeof fit);
    if (status == NEVH_EDOM)
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "%s needs a T quadratic in p, but term \"%s\", which "
                          "reads momenta, could not be probed: it is not "
                          "finite around the state to plan at; schemes that "
                          "fit any T(p): %s",
                          scheme->name, probe->term, fit);
    return nevh__fail(&s->report, NEVH_ESTRUCT,
                      "%s needs a T quadratic in p, but term \"%s\" is not "
                      "(third difference %.2g of its size, where rounding "
                      "gives 1e-16): it would be of order %d instead of %d; "
                      "schemes that fit: %s",
                      scheme->name, probe->term, probe->third,
                      scheme->symmetric == NEVH_YES ? 4 : 3, scheme->order,
                      fit);
}

static int refuse_parts(nevh_stepper *s, const nevh__parts_fault *fault) {
    char fit[80];
    const nevh_integrator *scheme = s->work.integrator;
    bool mixed = !(nevh_system_traits(s->work.system) & NEVH_SEPARABLE);
    suggest(scheme,
            NEVH_PARTS | NEVH_QUADRATIC_KINETIC | (mixed ? NEVH_SEPARABLE : 0),
            fit, sizeof fit);
    if (!fault->term)
        return nevh__fail(&s->report, NEVH_ESTRUCT,
                          "%s moves quadratic forms with constant "
                          "coefficients and -k/|q| exactly, but no term is "
                          "one; schemes that fit: %s",
                          scheme->name, fit);
    return nevh__fail(
        &s->report, NEVH_ESTRUCT,
        "%s needs H = A + V(q), where A has quadratic forms with "
        "constant coefficients and -k/|q| and V may read actions "
        "(q^2 + p^2)/2 for coordinates, but term \"%s\" of effect "
        "\"%s\" %s; schemes that fit: %s",
        scheme->name, fault->term->name, fault->term->effect, fault->reason,
        fit);
}

int nevh__choose_parts(nevh_stepper *s, nevh__part_role **part) {
    const nevh_work *w = &s->work;
    nevh__parts_fault fault;
    *part = NULL;
    if (!(w->integrator->needs & NEVH_PARTS))
        return NEVH_OK;
    *part = nevh__array(w->system->n_terms, sizeof **part);
    int status =
        *part ? nevh__parts_find(w->system, w->integrator->kernel->has_substeps,
                                 *part, &fault)
              : NEVH_ENOMEM;
    if (status == NEVH_ENOMEM)
        return nevh__no_memory(&s->report);
    return status ? refuse_parts(s, &fault) : NEVH_OK;
}

size_t nevh_stepper_hierarchy(const nevh_stepper *s, char text[], size_t size,
                              bool *whole) {
    const nevh__form_flow *flow =
        s && s->planned ? nevh__parts_flow_of(&s->work) : NULL;
    const nevh__hierarchy *h = flow ? nevh__form_flow_bodies(flow) : NULL;
    const char *why = flow ? nevh__form_flow_why(flow) : NULL;
    if (whole)
        *whole = h && nevh__hierarchy_is_whole(h);
    if (size)
        snprintf(text, size, "%s", why ? why : "");
    return h ? nevh__hierarchy_words(h, s->work.system, text, size) : 0;
}

size_t nevh_stepper_body(const nevh_stepper *s, size_t k) {
    const nevh__hierarchy *h =
        s && s->planned ? nevh__parts_hierarchy(&s->work) : NULL;
    return h ? nevh__hierarchy_body(h, k) : k;
}

int nevh_stepper_kick(nevh_stepper *s, double t, const double q[],
                      const double p[], double dh_dq[]) {
    if (!s || !s->planned || s->work.width != 1 || !q || !p || !dh_dq)
        return NEVH_EINVAL;
    const nevh__hierarchy *h = nevh__parts_hierarchy(&s->work);
    int status = nevh_field_gradient(s->work.field, 1, &t, q, p, dh_dq, NULL);
    if (h && !status)
        nevh__hierarchy_lessen(h, 1, q, dh_dq);
    return status;
}

static int check_separable(nevh_stepper *s, const double q[],
                           const double p[]) {
    nevh_separability probe;
    int status = nevh_system_probe(s->work.system, s->options.t, q, p,
                                   s->options.scale, &probe);
    if (status == NEVH_ENOMEM)
        return nevh__fail(&s->report, status, "out of memory");
    return probe.separable ? NEVH_OK : refuse_mixed(s, &probe, status);
}

static int check_kinetic(nevh_stepper *s, const double q[], const double p[]) {
    nevh__kinetic probe;
    int status = nevh__system_probe_kinetic(s->work.system, s->options.t, q, p,
                                            s->options.scale, &probe);
    if (status == NEVH_ENOMEM)
        return nevh__fail(&s->report, status, "out of memory");
    return probe.quadratic ? NEVH_OK : refuse_kinetic(s, &probe, status);
}

int nevh__check_structure(nevh_stepper *s) {
    const nevh_work *w = &s->work;
    unsigned missing = w->integrator->needs & ~nevh_system_traits(w->system);
    if (!(missing & (NEVH_SEPARABLE | NEVH_QUADRATIC_KINETIC)))
        return NEVH_OK;
    double *q = first_lane(w, s->options.q), *p = first_lane(w, s->options.p);
    int status = NEVH_OK;
    if ((s->options.q && !q) || (s->options.p && !p))
        status = nevh__no_memory(&s->report);
    if (!status && missing & NEVH_SEPARABLE)
        status = check_separable(s, q, p);
    if (!status && missing & NEVH_QUADRATIC_KINETIC)
        status = check_kinetic(s, q, p);
    free(q);
    free(p);
    return status;
}
