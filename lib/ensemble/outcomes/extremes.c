/* nevh: the outcomes min(F) and max(F): over the steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/outcomes/outcome_private.h"
#include <math.h>

static void extremes_begin(const nevh__observation *at, void *record) {
    *(double *)record = at->value;
}

static void step_min(const nevh__observation *at, void *record) {
    double least = *(double *)record;
    for (size_t i = 0; i < at->count; i++) {
        double value = nevh__observed(at, i);
        if (isnan(value) || value < least)
            least = value;
    }
    *(double *)record = least;
}

static void step_max(const nevh__observation *at, void *record) {
    double most = *(double *)record;
    for (size_t i = 0; i < at->count; i++) {
        double value = nevh__observed(at, i);
        if (isnan(value) || value > most)
            most = value;
    }
    *(double *)record = most;
}

static void extremes_end(const nevh__observation *at, const void *record,
                         double result[]) {
    (void)at;
    *result = *(const double *)record;
}

const nevh__outcome_type nevh__outcome_min = {
    .info = {.name = "min",
             .takes = NEVH_OUTCOME_TAKES_FORMULA,
             .unit = NEVH_UNIT_OF_FORMULA,
             .help = "the smallest value of a formula at the start and after "
                     "each step"},
    .of_values = true,
    .size = sizeof(double),
    .begin = extremes_begin,
    .step = step_min,
    .end = extremes_end,
};
const nevh__outcome_type nevh__outcome_max = {
    .info = {.name = "max",
             .takes = NEVH_OUTCOME_TAKES_FORMULA,
             .unit = NEVH_UNIT_OF_FORMULA,
             .help = "the largest value of a formula at the start and after "
                     "each step"},
    .of_values = true,
    .size = sizeof(double),
    .begin = extremes_begin,
    .step = step_max,
    .end = extremes_end,
};
