/* nevh: the gradient methods.
   SPDX-License-Identifier: GPL-3.0-or-later

   Weights of central differences: B. Fornberg, "Generation of finite
   difference formulas on arbitrarily spaced grids", Math. Comp. 51 (1988)
   699-706, table 1, written for the slopes of chords; for order 2m the weight
   of chord j is 2 (-1)^(j+1) (m!)^2 / ((m-j)! (m+j)!). */
#include "gradient/field_private.h"
#include <string.h>

#define CENTRAL(id, accuracy, ...)                                             \
    static const nevh_gradient id = {.name = #id,                              \
                                     .evaluate = nevh__gradient_central,       \
                                     .order = (accuracy),                      \
                                     .offsets = (accuracy) / 2,                \
                                     .weights = __VA_ARGS__};                  \
    _Static_assert((accuracy) / 2 <= NEVH__MOST_OFFSETS, #id)
CENTRAL(central2, 2, {1});
CENTRAL(central4, 4, {4. / 3, -1. / 3});
CENTRAL(central6, 6, {3. / 2, -3. / 5, 1. / 10});
CENTRAL(central8, 8, {8. / 5, -4. / 5, 8. / 35, -1. / 35});

static bool has_gradient(const nevh_term *term) {
    return term->gradient;
}

static bool has_complex_value(const nevh_term *term) {
    return term->complex_value;
}

static const nevh_gradient complex_step = {.name = "complex-step",
                                           .evaluate = nevh__gradient_complex,
                                           .has = has_complex_value,
                                           .wants = "complex form"};
static const nevh_gradient exact = {.name = "exact",
                                    .evaluate = nevh__gradient_exact,
                                    .has = has_gradient,
                                    .wants = "exact gradient"};
const nevh_gradient nevh__no_gradient = {.name = "none"};

const nevh_gradient *const nevh_central2 = &central2;
const nevh_gradient *const nevh_central4 = &central4;
const nevh_gradient *const nevh_central6 = &central6;
const nevh_gradient *const nevh_central8 = &central8;
const nevh_gradient *const nevh_complex_step = &complex_step;
const nevh_gradient *const nevh_exact = &exact;

static const nevh_gradient *const all[] = {
    &central2, &central4, &central6, &central8, &complex_step, &exact, NULL,
};

const nevh_gradient *nevh__best_gradient(const nevh_system *s) {
    for (size_t i = 0; i < s->n_terms; i++)
        if (nevh__term_on(s, s->terms[i]) && !s->terms[i]->decl.gradient)
            return nevh_central6;
    return nevh_exact;
}

const nevh_gradient *const *nevh_gradients(void) {
    return all;
}

const nevh_gradient *nevh_gradient_named(const char *name) {
    for (size_t i = 0; name && all[i]; i++)
        if (strcmp(all[i]->name, name) == 0)
            return all[i];
    return NULL;
}

const char *nevh_gradient_name(const nevh_gradient *gradient) {
    return gradient ? gradient->name : "";
}

int nevh_gradient_order(const nevh_gradient *gradient) {
    return gradient ? gradient->order : 0;
}
