/* nevh: what is known of a scheme.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include <nevh/extend.h>

const char *nevh_integrator_name(const nevh_integrator *i) {
    return i ? i->name : "";
}

const char *nevh_integrator_aliases(const nevh_integrator *i) {
    if (!i)
        return "";
    return i->aliases ? i->aliases : "";
}

const char *nevh_integrator_source(const nevh_integrator *i) {
    return i ? i->source : "";
}

int nevh_integrator_order(const nevh_integrator *i) {
    return i ? i->order : 0;
}

int nevh_integrator_stages(const nevh_integrator *i) {
    return i ? i->stages : 0;
}

int nevh_integrator_gradients(const nevh_integrator *i) {
    return i ? i->gradients : 0;
}

int nevh_integrator_sweep_gradients(const nevh_integrator *i) {
    return i ? i->sweep_gradients : 0;
}

bool nevh_integrator_adaptive(const nevh_integrator *i) {
    return i ? i->adaptive : false;
}

bool nevh_integrator_needs_tolerance(const nevh_integrator *i) {
    return i ? i->needs_tolerance : false;
}

bool nevh_integrator_needs_formulas(const nevh_integrator *i) {
    return i ? i->needs_formulas : false;
}

bool nevh_integrator_own_time(const nevh_integrator *i) {
    return i ? i->own_time : false;
}

const char *nevh_claim_name(nevh_claim claim) {
    static const char *const names[] = {"no", "yes", "unproven", "extended"};
    _Static_assert(sizeof names / sizeof *names == NEVH_EXTENDED + 1,
                   "each claim");
    return claim <= NEVH_EXTENDED ? names[claim] : "unknown";
}

nevh_claim nevh_integrator_symplectic(const nevh_integrator *i) {
    return i ? i->symplectic : NEVH_NO;
}

nevh_claim nevh_integrator_symmetric(const nevh_integrator *i) {
    return i ? i->symmetric : NEVH_NO;
}

nevh_claim nevh_integrator_explicit(const nevh_integrator *i) {
    return i ? i->explicit_form : NEVH_NO;
}

nevh_claim nevh_integrator_preserves_energy(const nevh_integrator *i) {
    return i ? i->preserves_energy : NEVH_NO;
}

unsigned nevh_integrator_needs(const nevh_integrator *i) {
    return i ? i->needs : 0;
}
