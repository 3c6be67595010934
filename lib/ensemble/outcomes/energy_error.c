/* nevh: the outcomes energy_error and verdict: what a nevh_energy says of the run.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "ensemble/ensemble_private.h"

static void end_error(const nevh__observation *at, const void *record,
                      double result[]) {
    (void)record;
    *result = nevh_energy_result(at->ensemble->energy, at->lane).max;
}

static void end_verdict(const nevh__observation *at, const void *record,
                        double result[]) {
    (void)record;
    *result = nevh_energy_result(at->ensemble->energy, at->lane).verdict;
}

const nevh__outcome_type nevh__outcome_energy_error = {
    .info = {.name = "energy_error",
             .help = "the largest error of the energy, relative"},
    .of_energy = true,
    .end = end_error,
};
const nevh__outcome_type nevh__outcome_verdict = {
    .info = {.name = "verdict",
             .help = "whether the error of the energy is bounded"},
    .of_energy = true,
    .end = end_verdict,
};
