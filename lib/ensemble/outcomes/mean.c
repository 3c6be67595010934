/* nevh: the outcome mean(F): over time, by the trapezoidal rule on the steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/outcomes/outcome_private.h"
#include "system/vector_private.h"

typedef struct {
    double sum, roundoff; /* sum + roundoff is the integral */
} integral;

static void mean_begin(const nevh__observation *at, void *record) {
    (void)at;
    *(integral *)record = (integral){0};
}

static void mean_step(const nevh__observation *at, void *record) {
    integral x = *(integral *)record;
    double t = at->t_before, value = at->value_before;
    for (size_t i = 0; i < at->count; i++) {
        double t_before = t, before = value;
        t = nevh__observed_t(at, i);
        value = nevh__observed(at, i);
        double part = (t - t_before) / 2 * (before + value);
        double next = x.sum + part;
        x.roundoff += nevh__roundoff(next, x.sum, part);
        x.sum = next;
    }
    *(integral *)record = x;
}

static void mean_end(const nevh__observation *at, const void *record,
                     double result[]) {
    const integral *x = record;
    double span = at->t - at->t_start;
    *result = span != 0 ? (x->sum + x->roundoff) / span : at->value;
}

const nevh__outcome_type nevh__outcome_mean = {
    .info = {.name = "mean",
             .takes = NEVH_OUTCOME_TAKES_FORMULA,
             .unit = NEVH_UNIT_OF_FORMULA,
             .help = "the mean of a formula over time"},
    .of_values = true,
    .size = sizeof(integral),
    .begin = mean_begin,
    .step = mean_step,
    .end = mean_end,
};
