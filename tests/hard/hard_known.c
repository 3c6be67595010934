/* nevh tests: hard cases: what is known of each, and those of the tests alone.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard_judge.h"
#include <math.h>
#include <string.h>

static double pendulum(double t, const double q[], const double p[],
                       const void *params) {
    (void)t, (void)params;
    return p[0] * p[0] / 2 - cos(q[0]);
}

static double offset(double t, const double q[], const double p[],
                     const void *params) {
    return 1e12 + pendulum(t, q, p, params);
}

/* Another value with each call, by up to 1e-6. */
static double fickle(double t, const double q[], const double p[],
                     const void *params) {
    static unsigned calls;
    calls = calls * 1664525u + 1013904223u;
    return pendulum(t, q, p, params) + 1e-6 * (double)(calls >> 8) * 0x1p-24;
}

static nevh_system *black_box(void) {
    return nevh_system_from(1, pendulum, NULL);
}
static nevh_system *offset_box(void) {
    return nevh_system_from(1, offset, NULL);
}
static nevh_system *fickle_box(void) {
    return nevh_system_from(1, fickle, NULL);
}

static const hard_known own[] = {
    {{"Kepler, there and back", "hard/kepler", NULL, NULL, NULL},
     HARD_RETURN,
     NULL},
    {{"offset of 1e12 in C", NULL, NULL, "0.1", "40"},
     HARD_BLACK_BOX | HARD_NOISE,
     offset_box},
    {{"H in C as one function", NULL, NULL, "0.1", "40"},
     HARD_BLACK_BOX,
     black_box},
    {{"H changes from call to call", NULL, NULL, "0.1", "40"},
     HARD_BLACK_BOX | HARD_NOISE,
     fickle_box},
    {{NULL, NULL, NULL, NULL, NULL}, 0, NULL}};

static const struct {
    const char *name;
    unsigned facts;
} known[] = {
    {"pendulum at rest", HARD_REST},
    {"double pendulum, regular", HARD_MIXED},
    {"double pendulum, chaotic", HARD_MIXED},
    {"stiff spring 1e2, resolved", HARD_SHORT},
    {"stiff spring 1e4, resolved", HARD_SHORT},
    {"stiff spring 1e6, resolved", HARD_SHORT},
    {"resonance omega dt = sqrt(2)", HARD_ESCAPE},
    {"resonance omega dt = sqrt(3)", HARD_ESCAPE},
    {"resonance omega dt = 1.99", HARD_ESCAPE},
    {"resonance omega dt = 2 pi/3", HARD_ESCAPE},
    {"resonance omega dt = pi", HARD_ESCAPE},
    {"driven, with friction", HARD_FRICTION},
    {"Kepler e = 0.99", HARD_EDGE},
    {"Kepler e = 0.999", HARD_EDGE},
    {"Kepler head-on", HARD_EDGE},
    {"Henon-Heiles at 1/6", HARD_ESCAPE},
    {"Henon-Heiles above escape", HARD_ESCAPE},
    {"three bodies, Pythagorean", HARD_EDGE},
    {"charge, uniform field", HARD_MIXED},
    {"charge, magnetic mirror", HARD_MIXED},
    {"orbit around a black hole", HARD_MIXED},
    {"swinging Atwood machine", HARD_MIXED},
    {"H with a kink", HARD_KINK},
    {"H ends on the way", HARD_EDGE},
    {"dt = 1e300", HARD_ANY_STEP},
    {"1e9 steps, one output", HARD_ENDLESS},
};

hard_known hard_known_at(size_t i) {
    size_t shared = 0;
    while (hard_cases[shared].name)
        shared++;
    if (i >= shared)
        return own[i - shared];
    hard_known found = {hard_cases[i], 0, NULL};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(known[k].name, found.given.name) == 0)
            found.facts = known[k].facts;
    return found;
}
