/* nevh: energies of orbits side by side at several steps, of which values are known.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/energy_state_private.h"
#include <math.h>

/* The largest distances from the first values, of so many rows; what is not finite
   makes them NaN, or infinite. */
NEVH_SIMD static void find_most(size_t width, size_t count, const double h[],
                                size_t pitch, const double initial[],
                                double most[]) {
    for (size_t at = 0; at < width; at += NEVH__LANES) {
        double far[NEVH__LANES] = {0}, bad[NEVH__LANES] = {0};
        for (size_t i = 0; i < count; i++)
            for (size_t k = 0; k < NEVH__LANES; k++) {
                double x = fabs(h[i * pitch + at + k] - initial[at + k]);
                far[k] = x > far[k] ? x : far[k];
                bad[k] += x - x;
            }
        for (size_t k = 0; k < NEVH__LANES; k++)
            most[at + k] = far[k] + bad[k];
    }
}

void nevh__energy_ask_largest(nevh_energy *e) {
    e->only_largest = true;
}

size_t nevh__energy_most_quiet(const nevh_energy *e, const bool on[]) {
    size_t most = SIZE_MAX;
    for (size_t lane = 0; lane < e->width; lane++) {
        size_t samples = e->trend[lane].samples, next = e->next_look[lane];
        size_t before = next > samples ? next - samples - 1 : 0;
        if (on[lane])
            most = before < most ? before : most;
    }
    return most;
}

/* As error_now in energy.c, where nothing comes from outside. */
static double error_of(const nevh_energy *e, size_t lane, double h) {
    return (h - e->initial[lane]) / e->scale[lane];
}

static size_t quiet_in(const nevh_energy *e, size_t lane, size_t count,
                       const double h[], size_t pitch) {
    double most = nevh__energy_higher * e->seen[lane];
    size_t i = 0;
    while (i < count && fabs(error_of(e, lane, h[i * pitch + lane])) <= most)
        i++;
    return i;
}

size_t nevh__energy_quiet(const nevh_energy *e, const bool on[], size_t count,
                          const double h[], size_t pitch) {
    double *most = e->t; /* times are of one step */
    find_most(e->width, count, h, pitch, e->initial, most);
    for (size_t lane = 0; lane < e->width; lane++)
        if (on[lane] && !(most[lane] / e->scale[lane] <=
                          nevh__energy_higher * e->seen[lane]))
            count = quiet_in(e, lane, count, h, pitch);
    return count;
}

void nevh__energy_observe_quiet(nevh_energy *e, const bool on[],
                                const size_t step[], double t0, double dt,
                                size_t count, const double h[], size_t pitch) {
    double *most = e->t;
    find_most(e->width, count, h, pitch, e->initial, most);
    for (size_t lane = 0; lane < e->width; lane++) {
        nevh__trend *trend = &e->trend[lane];
        if (!on[lane])
            continue;
        e->steps[lane] = step[lane] + count - 1;
        if (e->only_largest)
            nevh__trend_add_most(
                trend, count, most[lane] / e->scale[lane],
                error_of(e, lane, h[(count - 1) * pitch + lane]));
        for (size_t i = 0; !e->only_largest && i < count; i++)
            nevh__trend_add(trend, t0 + (double)(step[lane] + i) * dt,
                            error_of(e, lane, h[i * pitch + lane]),
                            e->largest[lane] / e->scale[lane]);
    }
}
