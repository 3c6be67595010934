/* nevh: the outcomes state and t: where an orbit ends, and when.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"

static void end_state(const nevh__observation *at, const void *record,
                      double result[]) {
    const nevh_ensemble *e = at->ensemble;
    (void)record;
    for (size_t k = 0; k < e->n; k++) {
        result[k] = e->q[k * e->width + at->lane];
        result[e->n + k] = e->p[k * e->width + at->lane];
    }
}

static void end_t(const nevh__observation *at, const void *record,
                  double result[]) {
    (void)record;
    *result = at->t;
}

const nevh__outcome_type nevh__outcome_state = {
    .info = {.name = "state", .help = "coordinates and momenta at the end"},
    .whole_state = true,
    .end = end_state,
};
const nevh__outcome_type nevh__outcome_t = {
    .info = {.name = "t", .help = "the time reached", .unit = NEVH_UNIT_TIME},
    .end = end_t,
};
