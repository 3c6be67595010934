/* nevh: the frequencies in an orbit, and their errors: from both halves of the samples
   and from another window.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/frequencies_private.h"
#include "diagnose/spectrum_private.h"
#include <fenv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LESS = 3 }; /* the order of the other window */
static const double pi = 3.14159265358979323846;

/* Line i of the whole in a part: its frequency there, other lines as they are;
   NAN where the part does not show it. */
static double frequency_in(const nevh__spectrum *whole, nevh__spectrum *part,
                           size_t i, size_t from, int order) {
    double width = 2 * nevh__spectrum_resolution(part);
    nevh__spectrum_window(part, order);
    nevh__spectrum_take_off((nevh__spectrum *)whole, i);
    memcpy(part->rest, whole->rest + from, part->count * sizeof *part->rest);
    double low = fmax(whole->w[i] - width, width / 16);
    return nevh__spectrum_peak(part, low, whole->w[i] + width);
}

/* The error of a line near by counts for this one, too, times the ratio of their
   amplitudes, at most 1.  Two lines that are hardly apart may both be off by a
   quarter of their distance. */
static void share_errors(const nevh__spectrum *a, nevh_spectral_line lines[]) {
    for (size_t i = 0; i < a->lines; i++)
        a->before[i] = lines[i].error;
    for (size_t i = 0; i < a->lines; i++)
        for (size_t k = 0; k < a->lines; k++) {
            double apart = fabs(a->w[i] - a->w[k]);
            double part = lines[k].amplitude / lines[i].amplitude;
            double off = apart < 1.25 * nevh__spectrum_resolution(a)
                             ? fmax(a->before[k], apart / 4)
                             : a->before[k];
            if (k != i && apart < 3 * nevh__spectrum_resolution(a) &&
                lines[i].amplitude > 0)
                lines[i].error = fmax(lines[i].error, off * fmin(1, part));
        }
}

/* Leaves out lines far below the largest that differ between both halves: they come
   from rounding and from differences of H. */
static void leave_out_noise(const nevh__spectrum *a, nevh_spectral_line lines[],
                            size_t *found) {
    static const double far_below = 1e-8, part = 0.125;
    double largest = 0;
    size_t kept = 0;
    for (size_t i = 0; i < *found; i++)
        largest = fmax(largest, lines[i].amplitude);
    for (size_t i = 0; i < *found; i++) {
        const nevh_spectral_line *l = &lines[i];
        bool small = l->amplitude < far_below * largest;
        bool steady = fabs(l->drift) < part * nevh__spectrum_resolution(a) &&
                      l->error < part * nevh__spectrum_resolution(a);
        if (!small || steady)
            lines[kept++] = *l;
    }
    *found = kept;
}

static bool frequencies_describe(nevh__spectrum *a, double h,
                                 nevh_spectral_line lines[], size_t *found) {
    nevh__spectrum half, again;
    size_t count = (a->count + 1) / 2;
    bool opened = nevh__spectrum_open(&half, h, count, a->values, 1);
    bool good =
        nevh__spectrum_open(&again, h, a->count, a->values, 1) && opened;
    for (size_t i = 0; good && i < a->lines; i++) {
        double first = frequency_in(a, &half, i, 0, LESS);
        double second = frequency_in(a, &half, i, a->count - count, LESS);
        double less = frequency_in(a, &again, i, 0, LESS);
        double error = fmax(fabs(less - a->w[i]), fabs(second - first));
        error = fmax(error, fabs(a->move[i]));
        if (isnan(less) || isnan(second - first))
            error = nevh__spectrum_resolution(a);
        double phase = atan2(-a->sine[i], a->cosine[i]) - a->w[i] * a->half;
        lines[(*found)++] = (nevh_spectral_line){
            a->w[i], nevh__spectrum_amplitude(a, i), remainder(phase, 2 * pi),
            fmax(error, 2e-16 * a->w[i]), second - first};
    }
    share_errors(a, lines);
    leave_out_noise(a, lines, found);
    nevh__spectrum_close(&again);
    nevh__spectrum_close(&half);
    return good;
}

static int by_amplitude(const void *a, const void *b) {
    double x = ((const nevh_spectral_line *)a)->amplitude;
    double y = ((const nevh_spectral_line *)b)->amplitude;
    return (x < y) - (x > y);
}

/* Looks for samples of which there are no lines. */
static int frequencies_check(double h, size_t count, const double values[],
                             size_t most) {
    if (!values || count < NEVH_FEWEST_SAMPLES || !(h > 0) || !most)
        return NEVH_EINVAL;
    for (size_t k = 0; k < count; k++)
        if (!isfinite(values[k]))
            return NEVH_EDOM;
    return NEVH_OK;
}

int nevh_frequencies(double h, size_t count, const double values[], size_t most,
                     nevh_spectral_line lines[], size_t *found) {
    nevh__spectrum a;
    int status = lines && found ? frequencies_check(h, count, values, most)
                                : NEVH_EINVAL;
    if (found)
        *found = 0;
    if (status)
        return status;
    fenv_t own; /* as in nevh_stepper_new */
    feholdexcept(&own);
    bool good = nevh__spectrum_open(&a, h, count, values, most) &&
                nevh__spectrum_find_lines(&a, most) &&
                frequencies_describe(&a, h, lines, found);
    nevh__spectrum_close(&a);
    fesetenv(&own);
    if (good)
        qsort(lines, *found, sizeof *lines, by_amplitude);
    return good ? NEVH_OK : NEVH_ENOMEM;
}

double nevh__main_frequency(double h, size_t count, const double values[],
                            size_t most) {
    nevh__spectrum a;
    double w = NAN, largest = -1;
    if (frequencies_check(h, count, values, most))
        return NAN;
    bool good = nevh__spectrum_open(&a, h, count, values, most) &&
                nevh__spectrum_find_lines(&a, most);
    for (size_t i = 0; good && i < a.lines; i++)
        if (nevh__spectrum_amplitude(&a, i) > largest) {
            largest = nevh__spectrum_amplitude(&a, i);
            w = a.w[i];
        }
    nevh__spectrum_close(&a);
    return w;
}
