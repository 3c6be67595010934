/* nevh: samples of an orbit at equal times, of which frequencies are found.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/system_private.h"
#include <gsl/gsl_fft_real.h>
#include <nevh/simd.h>
#include <math.h>
#include <nevh/frequencies.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

struct nevh_spectral_samples {
    size_t room, count, every, first_step;
    double first_t, last_t;
    bool full;
    size_t size;      /* of the transform, a power of 2 */
    double *power;    /* size */
    double *values;   /* room */
    double numbers[]; /* all of them */
};

nevh_spectral_samples *nevh_spectral_samples_new(size_t room) {
    size_t size = NEVH_FEWEST_SAMPLES;
    while (size < room && size < SIZE_MAX / 64)
        size *= 2;
    if (room < NEVH_FEWEST_SAMPLES || size < room)
        return NULL;
    nevh_spectral_samples *s = nevh__array(
        1, sizeof(nevh_spectral_samples) + (size + room) * sizeof(double));
    if (!s)
        return NULL;
    s->room = room;
    s->size = size;
    s->power = s->numbers;
    s->values = s->numbers + size;
    nevh_spectral_samples_restart(s);
    return s;
}

void nevh_spectral_samples_free(nevh_spectral_samples *s) {
    free(s);
}

void nevh_spectral_samples_restart(nevh_spectral_samples *s) {
    if (!s)
        return;
    s->count = 0;
    s->every = 1;
    s->full = false;
}

/* The spectrum with the window (1 + cos(pi x))^3, without the mean. */
static void samples_transform(nevh_spectral_samples *s) {
    double mean = 0, last = (double)(s->count - 1);
    for (size_t k = 0; k < s->count; k++)
        mean += s->values[k] / (double)s->count;
    for (size_t k = 0; k < s->size; k++)
        s->power[k] = k < s->count
                          ? (s->values[k] - mean) *
                                pow(1 - cos(2 * pi * (double)k / last), 3)
                          : 0;
    gsl_fft_real_radix2_transform(s->power, 1, s->size);
}

/* True if half as many samples suffice: the faster half of the spectrum is empty. */
static bool are_dense(nevh_spectral_samples *s) {
    static const double nothing = 1e-6; /* of the largest line */
    double slow = 0, fast = 0;
    samples_transform(s);
    for (size_t j = 1; j < s->size / 2; j++) {
        double size = nevh_simd_hypot(s->power[j], s->power[s->size - j]);
        double *most = j < s->size / 4 ? &slow : &fast;
        *most = fmax(*most, size);
    }
    return fast <= nothing * slow;
}

static void samples_make_room(nevh_spectral_samples *s) {
    s->full = !are_dense(s);
    if (s->full)
        return;
    size_t kept = 0;
    for (size_t k = 0; k < s->count; k += 2)
        s->values[kept++] = s->values[k];
    if (s->count % 2 == 0)
        s->last_t -= (s->last_t - s->first_t) / (double)(s->count - 1);
    s->count = kept;
    s->every *= 2;
}

void nevh_spectral_samples_take(nevh_spectral_samples *s, size_t step, double t,
                                double x) {
    if (!s || s->full)
        return;
    if (s->count == 0) {
        s->first_step = step;
        s->first_t = t;
    }
    if ((step - s->first_step) % s->every != 0)
        return;
    double h = s->count > 1 ? (s->last_t - s->first_t) / (double)(s->count - 1)
                            : t - s->first_t;
    if (fabs(t - s->first_t - h * (double)s->count) > 1e-6 * h)
        return;
    s->values[s->count++] = x;
    s->last_t = t;
    if (s->count == s->room)
        samples_make_room(s);
}

static bool goes_round(const nevh_spectral_samples *s, double period) {
    double low = s->values[0], high = low;
    for (size_t k = 1; k < s->count; k++) {
        low = fmin(low, s->values[k]);
        high = fmax(high, s->values[k]);
    }
    return high - low > period;
}

bool nevh_spectral_samples_straighten(nevh_spectral_samples *s, double period) {
    bool is_angle = s && s->count && period > 0 && goes_round(s, period);
    for (size_t k = 0; is_angle && k < s->count; k++)
        s->values[k] = cos(2 * pi / period * s->values[k]);
    return is_angle;
}

const double *nevh_spectral_samples_values(const nevh_spectral_samples *s,
                                           size_t *count, double *h) {
    size_t is = s ? s->count : 0;
    if (count)
        *count = is;
    if (h)
        *h = is > 1 ? (s->last_t - s->first_t) / (double)(is - 1) : 0;
    return s ? s->values : NULL;
}
