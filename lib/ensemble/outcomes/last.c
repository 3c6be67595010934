/* nevh: the outcome last(F): a formula at the end.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/outcomes/outcome_private.h"

static void last_end(const nevh__observation *at, const void *record,
                     double result[]) {
    (void)record;
    *result = at->value;
}

const nevh__outcome_type nevh__outcome_last = {
    .info = {.name = "last",
             .takes = NEVH_OUTCOME_TAKES_FORMULA,
             .unit = NEVH_UNIT_OF_FORMULA,
             .help = "a formula at the end"},
    .of_values = true,
    .end = last_end,
};
