/* nevh hard: the cases.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "hard_private.h"
#include <math.h>

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

const hard_case hard_cases[] = {
    {"pendulum at rest", "pendulum-modulus", "k=0", 0, 0, HARD_REST, NULL},
    {"pendulum k = 0.999", "pendulum-modulus", NULL, 0, 0, 0, NULL},
    {"below the separatrix by 1e-10", "pendulum-modulus", "k=1-1e-10", 0, 0, 0,
     NULL},
    {"above the separatrix by 1e-10", "pendulum-modulus", "k=1+1e-10", 0, 0, 0,
     NULL},
    {"rotating pendulum", "pendulum-modulus", "k=2", 0, 0, 0, NULL},
    {"pendulum after 1e6 turns", "pendulum-modulus", "turns=1e6", 0, 0, 0,
     NULL},
    {"double pendulum, regular", "double-pendulum", NULL, 0, 0, HARD_MIXED,
     NULL},
    {"double pendulum, chaotic", "double-pendulum", "phi=0; p2=3.873", 0, 0,
     HARD_MIXED, NULL},
    {"stiff spring 1e2, resolved", "elastic-pendulum", NULL, 0, 0, HARD_SHORT,
     NULL},
    {"stiff spring 1e2, stepped over", "elastic-pendulum", NULL, 0.05, 10, 0,
     NULL},
    {"stiff spring 1e4, resolved", "elastic-pendulum", "ratio=1e4", 0, 0,
     HARD_SHORT, NULL},
    {"stiff spring 1e4, stepped over", "elastic-pendulum", "ratio=1e4", 0.05,
     10, 0, NULL},
    {"stiff spring 1e6, resolved", "elastic-pendulum", "ratio=1e6", 0, 0,
     HARD_SHORT, NULL},
    {"stiff spring 1e6, stepped over", "elastic-pendulum", "ratio=1e6", 0.05,
     10, 0, NULL},
    {"resonance omega dt = sqrt(2)", "resonance", NULL, M_SQRT2, 0, HARD_ESCAPE,
     NULL},
    {"resonance omega dt = sqrt(3)", "resonance", NULL, 1.7320508075688772, 0,
     HARD_ESCAPE, NULL},
    {"resonance omega dt = 1.99", "resonance", NULL, 1.99, 0, HARD_ESCAPE,
     NULL},
    {"resonance omega dt = 2 pi/3", "resonance", NULL, 2 * M_PI / 3, 0,
     HARD_ESCAPE, NULL},
    {"resonance omega dt = pi", "resonance", NULL, M_PI, 0, HARD_ESCAPE, NULL},
    {"Kapitza, stable", "kapitza", "w=60", 0.01, 4, 0, NULL},
    {"Kapitza, unstable", "kapitza", "w=35", 0.01, 4, 0, NULL},
    {"driven, from t = 1e6", "late-start", NULL, 0, 0, 0, NULL},
    {"driven, with friction", "damped-driven-pendulum", NULL, 0, 40,
     HARD_FRICTION, NULL},
    {"Kepler e = 0.6", "kepler", NULL, 0, 0, 0, NULL},
    {"Kepler e = 0.9", "kepler", "e=0.9", 0, 0, 0, NULL},
    {"Kepler e = 0.99", "kepler", "e=0.99", 0, 0, HARD_EDGE, NULL},
    {"Kepler e = 0.999", "kepler", "e=0.999", 0, 0, HARD_EDGE, NULL},
    {"Kepler head-on", "head-on", NULL, 0, 0, HARD_EDGE, NULL},
    {"Kepler, there and back", "kepler", NULL, 0, 0, HARD_RETURN, NULL},
    {"Henon-Heiles at 1/12", "henon-heiles", NULL, 0, 0, 0, NULL},
    /* where bounds are small, and tell one coefficient from another */
    {"Henon-Heiles, small steps", "henon-heiles", NULL, 0.002, 20, 0, NULL},
    {"Henon-Heiles at 1/6", "henon-heiles", "E=1/6", 0, 0, HARD_ESCAPE, NULL},
    /* gone at t = 13.94 */
    {"Henon-Heiles above escape", "henon-heiles", "E=0.3", 0, 13.8, HARD_ESCAPE,
     NULL},
    {"three bodies, Pythagorean", "pythagorean", NULL, 0, 0, HARD_EDGE, NULL},
    {"three bodies, figure of eight", "figure-eight", NULL, 0, 12.65182796, 0,
     NULL},
    {"outer planets", "outer-planets", NULL, 0, 0, 0, NULL},
    {"charge, uniform field", "uniform-field", NULL, 0, 0, HARD_MIXED, NULL},
    {"charge, magnetic mirror", "magnetic-mirror", NULL, 0, 0, HARD_MIXED,
     NULL},
    {"orbit around a black hole", "schwarzschild", NULL, 0, 0, HARD_MIXED,
     NULL},
    {"FPUT, 32 springs", "fput", NULL, 0, 0, 0, NULL},
    {"Toda lattice", "toda", NULL, 0, 0, 0, NULL},
    {"swinging Atwood machine", "swinging-atwood", NULL, 0, 0, HARD_MIXED,
     NULL},
    {"offset of 1e12 in a formula", "offset", NULL, 0, 0, 0, NULL},
    {"offset of 1e12 in C", NULL, NULL, 0.1, 40, HARD_BLACK_BOX | HARD_NOISE,
     offset_box},
    {"H in C as one function", NULL, NULL, 0.1, 40, HARD_BLACK_BOX, black_box},
    {"H changes from call to call", NULL, NULL, 0.1, 40,
     HARD_BLACK_BOX | HARD_NOISE, fickle_box},
    {"the Earth in SI units", "earth", NULL, 0, 0, 0, NULL},
    {"a molecule in SI units", "molecule", NULL, 0, 0, 0, NULL},
    {"H with a kink", "kink", NULL, 0, 0, HARD_KINK, NULL},
    {"H ends on the way", "edge", NULL, 0, 0, HARD_EDGE, NULL},
    {"dt = 1e-300", "pendulum-modulus", NULL, 1e-300, 1e-298, 0, NULL},
    {"dt = 1e300", "pendulum-modulus", NULL, 1e300, 1e302, HARD_ANY_STEP, NULL},
    {"1e9 steps, one output", "pendulum-modulus", NULL, 0.1, 1e8, HARD_ENDLESS,
     NULL},
    {NULL, NULL, NULL, 0, 0, 0, NULL}};
