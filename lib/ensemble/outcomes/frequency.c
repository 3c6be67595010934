/* nevh: the outcome frequency(F): of the largest line in the spectrum of a formula.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/frequencies_private.h"
#include "ensemble/ensemble_private.h"
#include <math.h>

static const double pi = 3.14159265358979323846;
enum { LINES = 3 }; /* of a spectrum, of which the largest is told */
enum { MOST_SAMPLES = 1 << 12 }; /* of an orbit */

typedef nevh_spectral_samples *samples;

static int frequency_plan(nevh_ensemble *e, size_t outcome,
                          const nevh_options *o) {
    samples *records = nevh__record_of(e, outcome, 0);
    if (e->options.integrator->own_time || o->transform)
        return nevh__fail(&e->report, NEVH_EINVAL,
                          "frequency: it needs samples at equal times, and "
                          "%s chooses times of its own: choose another "
                          "integrator",
                          e->options.integrator->name);
    for (size_t lane = 0; lane < e->width; lane++)
        if (!(records[lane] = nevh_spectral_samples_new(MOST_SAMPLES)))
            return nevh__no_memory(&e->report);
    return NEVH_OK;
}

static void frequency_clear(void *record) {
    nevh_spectral_samples_free(*(samples *)record);
}

static void frequency_step(const nevh__observation *at, void *record) {
    for (size_t i = 0; i < at->count; i++)
        nevh_spectral_samples_take(
            *(samples *)record, nevh__observed_step(at, i),
            nevh__observed_t(at, i), nevh__observed(at, i));
}

static void frequency_begin(const nevh__observation *at, void *record) {
    nevh_spectral_samples_restart(*(samples *)record);
    frequency_step(at, record);
}

/* NAN where there is no line, or too few samples, or less than a turn. */
static void frequency_end(const nevh__observation *at, const void *record,
                          double result[]) {
    samples kept = *(const samples *)record;
    size_t count;
    double h;
    nevh_spectral_samples_straighten(kept, at->decl->modulus);
    const double *values = nevh_spectral_samples_values(kept, &count, &h);
    double w = nevh__main_frequency(h, count, values, LINES);
    double turns = w * h * (double)(count - 1) / (2 * pi);
    *result = turns >= 1 ? w : NAN;
}

const nevh__outcome_type nevh__outcome_frequency = {
    .info = {.name = "frequency",
             .takes = NEVH_OUTCOME_TAKES_FORMULA,
             .unit = NEVH_UNIT_FREQUENCY,
             .help = "the frequency of the largest line in the spectrum of a "
                     "formula"},
    .of_turns = true,
    .size = sizeof(samples),
    .plan = frequency_plan,
    .clear = frequency_clear,
    .begin = frequency_begin,
    .step = frequency_step,
    .end = frequency_end,
};
