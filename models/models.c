/* nevh: the list of models, and what all of them do alike.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "models_private.h"
#include <math.h>
#include <string.h>

nevh_system *nevh__model_system(size_t n, const nevh_term terms[],
                                size_t count) {
    nevh_system *sys = nevh_system_new(n);
    for (size_t i = 0; sys && i < count; i++)
        nevh_system_add(sys, &terms[i]);
    return sys;
}

static bool is_double(long double x) {
    return isfinite((double)x);
}

int nevh__model_state(size_t n, const long double from_q[],
                      const long double from_p[], double q[], double p[]) {
    for (size_t i = 0; i < n; i++)
        if (!is_double(from_q[i]) || !is_double(from_p[i]))
            return NEVH_EDOM;
    for (size_t i = 0; i < n; i++) {
        q[i] = (double)from_q[i];
        p[i] = (double)from_p[i];
    }
    return NEVH_OK;
}

const nevh_model *const *nevh_models(void) {
#define NEVH__MODEL_ENTRY(id) &nevh__##id##_entry,
    static const nevh_model *const list[] = {
        NEVH__MODELS(NEVH__MODEL_ENTRY) NULL,
    };
    return list;
}

const nevh_model *nevh_model_named(const char *name) {
    const nevh_model *const *model = nevh_models();
    while (*model && (!name || strcmp((*model)->name, name) != 0))
        model++;
    return *model;
}
