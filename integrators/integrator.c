/* nevh: what is known of a scheme.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/extend.h>

const char *nevh_integrator_name(const nevh_integrator *i) {
    return i->name;
}

const char *nevh_integrator_aliases(const nevh_integrator *i) {
    return i->aliases ? i->aliases : "";
}

const char *nevh_integrator_source(const nevh_integrator *i) {
    return i->source;
}

int nevh_integrator_order(const nevh_integrator *i) {
    return i->order;
}

int nevh_integrator_stages(const nevh_integrator *i) {
    return i->stages;
}

int nevh_integrator_gradients(const nevh_integrator *i) {
    return i->gradients;
}

int nevh_integrator_sweep_gradients(const nevh_integrator *i) {
    return i->sweep_gradients;
}

bool nevh_integrator_adaptive(const nevh_integrator *i) {
    return i->adaptive;
}

bool nevh_integrator_needs_tolerance(const nevh_integrator *i) {
    return i->needs_tolerance;
}

bool nevh_integrator_own_time(const nevh_integrator *i) {
    return i->own_time;
}

const char *nevh_claim_name(nevh_claim claim) {
    static const char *const names[] = {"no", "yes", "unproven", "extended"};
    return claim <= NEVH_EXTENDED ? names[claim] : "unknown";
}

nevh_claim nevh_integrator_symplectic(const nevh_integrator *i) {
    return i->symplectic;
}

nevh_claim nevh_integrator_symmetric(const nevh_integrator *i) {
    return i->symmetric;
}

nevh_claim nevh_integrator_explicit(const nevh_integrator *i) {
    return i->explicit_form;
}

nevh_claim nevh_integrator_preserves_energy(const nevh_integrator *i) {
    return i->preserves_energy;
}

unsigned nevh_integrator_needs(const nevh_integrator *i) {
    return i->needs;
}
