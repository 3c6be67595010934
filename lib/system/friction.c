/* nevh: friction, an effect that is no term of H.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <math.h>
#include <stdlib.h>

static int friction_check(nevh_system *s, const char *effect,
                          const double rates[]) {
    if (!effect || !effect[0])
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "friction needs the name of its effect");
    if (!rates)
        return nevh__fail(&s->report, NEVH_EINVAL,
                          "effect %s: the rates of friction are NULL", effect);
    char name[NEVH__VARIABLE];
    for (size_t k = 0; k < s->n; k++)
        if (!isfinite(rates[k]))
            return nevh__fail(&s->report, NEVH_EINVAL,
                              "effect %s: the rate of friction %g of %s is not "
                              "a finite number",
                              effect, rates[k],
                              nevh__variable_name(s, true, k, name));
    return NEVH_OK;
}

/* Makes room first, so that the system is as before when memory is out. */
static int friction_append(nevh_system *s, const char *name,
                           const double rates[]) {
    nevh__friction *all =
        nevh__grow(s->frictions, s->n_frictions + 1, sizeof *all);
    s->frictions = all ? all : s->frictions;
    double *copy = all ? nevh__copy(rates, s->n, sizeof *rates) : NULL;
    size_t effect = copy ? nevh__effect_index(s, name) : SIZE_MAX;
    if (effect == SIZE_MAX) {
        free(copy);
        return nevh__no_memory(&s->report);
    }
    all[s->n_frictions++] = (nevh__friction){effect, copy};
    s->revision++;
    return NEVH_OK;
}

int nevh_system_add_friction(nevh_system *s, const char *effect,
                             const double rates[]) {
    if (nevh_system_status(s))
        return nevh_system_status(s);
    int status = friction_check(s, effect, rates);
    return status ? status : friction_append(s, effect, rates);
}

bool nevh_system_friction(const nevh_system *s, double rates[]) {
    if (!s)
        return false;
    bool any = false;
    for (size_t k = 0; k < s->n && (rates || s->n_frictions); k++) {
        double sum = 0;
        for (size_t i = 0; i < s->n_frictions; i++)
            if (s->effects[s->frictions[i].effect].on)
                sum += s->frictions[i].rates[k];
        any |= sum != 0;
        if (rates)
            rates[k] = sum;
    }
    return any;
}

bool nevh__conserves_energy(const nevh_system *s) {
    return nevh_system_traits(s) & NEVH_AUTONOMOUS &&
           !nevh_system_friction(s, NULL);
}
