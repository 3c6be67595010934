/* nevh tests: a model, its system and its field.
   SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NEVH_TESTS_MODELS_H
#define NEVH_TESTS_MODELS_H

#include "support.h"
#include <math.h>

typedef struct {
    const nevh_model *model;
    const void *params;
    nevh_system *system;
    nevh_field *field;
} setup;

static inline setup set_up(const nevh_model *model, const void *params,
                           const nevh_gradient *gradient) {
    nevh_options options = {.gradient = gradient, .gradient_step = 1. / 256};
    setup s = {.model = model, .params = params};
    s.system = model->system(params);
    ck_assert_str_eq(nevh_system_message(s.system), "");
    s.field = nevh_field_new(s.system, &options);
    ck_assert_str_eq(nevh_field_message(s.field), "");
    return s;
}

static inline void tear_down(setup s) {
    nevh_field_free(s.field);
    nevh_system_free(s.system);
}

/* The size of H at a state: the sum of what its effects amount to. */
static inline double size_of(nevh_field *field, size_t effects,
                             const double q[], const double p[]) {
    double h[8], size = 0;
    ck_assert_uint_le(effects, 8);
    ck_assert_int_eq(nevh_field_effects(field, 0, q, p, h), NEVH_OK);
    for (size_t i = 0; i < effects; i++)
        size += fabs(h[i]);
    return size;
}

static inline double largest(const double x[], size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

static inline void assert_close(const double a[], const double b[],
                                size_t count, double tolerance) {
    for (size_t i = 0; i < count; i++)
        ck_assert_double_le(fabs(a[i] - b[i]), tolerance);
}

#endif
