/* nevh: the outcome rms(F): the root of the mean square over time, by the
   trapezoidal rule on the steps.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/outcomes/outcome_private.h"
#include "system/vector_private.h"
#include <math.h>

/* Values are multiplied by a power of two, so that squares neither overflow nor
   vanish. */
typedef struct {
    double scale;
    double sum, roundoff; /* sum + roundoff is the integral of squares */
} integral;

static void choose_scale(integral *x, double size) {
    const double large = 0x1p300;
    double scaled = size * x->scale;
    bool vanishes = scaled < 1 / large && x->sum == 0;
    if (!(size > 0 && isfinite(size)) || !(scaled > large || vanishes))
        return;
    double scale = ldexp(1, -(int)fmin(fmax(ilogb(size), -1000), 1000));
    double factor = x->sum == 0 ? 1 : scale / x->scale;
    x->sum *= factor * factor;
    x->roundoff *= factor * factor;
    x->scale = scale;
}

static void rms_begin(const nevh__observation *at, void *record) {
    integral *x = record;
    *x = (integral){.scale = 1};
    choose_scale(x, fabs(at->value));
}

static void rms_step(const nevh__observation *at, void *record) {
    integral *x = record;
    double t = at->t_before, value = at->value_before;
    for (size_t i = 0; i < at->count; i++) {
        double t_before = t, before = value;
        t = nevh__observed_t(at, i);
        value = nevh__observed(at, i);
        choose_scale(x, fmax(fabs(before), fabs(value)));
        double a = before * x->scale, b = value * x->scale;
        double part = (t - t_before) / 2 * (a * a + b * b);
        double next = x->sum + part;
        x->roundoff += nevh__roundoff(next, x->sum, part);
        x->sum = next;
    }
}

static void rms_end(const nevh__observation *at, const void *record,
                    double result[]) {
    const integral *x = record;
    double span = at->t - at->t_start;
    *result = span != 0 ? sqrt((x->sum + x->roundoff) / span) / x->scale
                        : fabs(at->value);
}

const nevh__outcome_type nevh__outcome_rms = {
    .info = {.name = "rms",
             .takes = NEVH_OUTCOME_TAKES_FORMULA,
             .unit = NEVH_UNIT_OF_FORMULA,
             .help = "the root mean square of a formula over time"},
    .of_values = true,
    .size = sizeof(integral),
    .begin = rms_begin,
    .step = rms_step,
    .end = rms_end,
};
