/* nevh: the gradient methods.
   SPDX-License-Identifier: GPL-3.0-or-later

   Weights of central differences: B. Fornberg, "Generation of finite
   difference formulas on arbitrarily spaced grids", Math. Comp. 51 (1988)
   699-706, table 1, written for the slopes of chords; for order 2m the weight
   of chord j is 2 (-1)^(j+1) (m!)^2 / ((m-j)! (m+j)!). */
#include "gradient/field_private.h"
#include <string.h>

static const nevh_gradient central2 = {"central2", 2, 1, {1}};
static const nevh_gradient central4 = {"central4", 4, 2, {4. / 3, -1. / 3}};
static const nevh_gradient central6 = {
    "central6", 6, 3, {3. / 2, -3. / 5, 1. / 10}};
static const nevh_gradient central8 = {
    "central8", 8, 4, {8. / 5, -4. / 5, 8. / 35, -1. / 35}};
static const nevh_gradient exact = {"exact", 0, 0, {0}};

const nevh_gradient *const nevh_central2 = &central2;
const nevh_gradient *const nevh_central4 = &central4;
const nevh_gradient *const nevh_central6 = &central6;
const nevh_gradient *const nevh_central8 = &central8;
const nevh_gradient *const nevh_exact = &exact;

static const nevh_gradient *const all[] = {
    &central2, &central4, &central6, &central8, &exact, NULL,
};

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
    return gradient->name;
}

int nevh_gradient_order(const nevh_gradient *gradient) {
    return gradient->order;
}
