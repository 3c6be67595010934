/* nevh frequencies: sentences about columns that are no sum of oscillations.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "frequencies_private.h"
#include <math.h>

/* True if it changes in one direction only, up to rounding. */
static bool is_monotone(const double x[], size_t count) {
    static const double rounding = 1e-12;
    double low = x[0], high = x[0], forth = 0, back = 0;
    for (size_t k = 1; k < count; k++) {
        double d = x[k] - x[k - 1];
        low = fmin(low, x[k]), high = fmax(high, x[k]);
        forth += fmax(d, 0), back += fmax(-d, 0);
    }
    return fmin(forth, back) <= rounding * fmax(high - low, fabs(high));
}

bool frequencies_line_words(list *words, const char *integrator,
                            const char *name, const double x[], size_t count,
                            double h) {
    static const double trend = 0.9, rounding = 1e-10; /* parts of squares */
    double n = (double)count, mean = 0, tt = 0, tx = 0, xx = 0;
    for (size_t k = 0; k < count; k++)
        mean += x[k] / n;
    for (size_t k = 0; k < count; k++) {
        double t = (double)k - (n - 1) / 2, d = x[k] - mean;
        tt += t * t, tx += t * d, xx += d * d;
    }
    bool line = xx > 0 && tx * tx > trend * tt * xx;
    bool straight = line && xx - tx * tx / tt <= rounding * xx;
    if (straight)
        list_print(words,
                   "%s, %s: no frequencies: it changes along a straight line, "
                   "by %.3g a unit of time: it is not periodic, or the run is "
                   "too short.",
                   integrator, name, tx / tt / h);
    else if (is_monotone(x, count))
        list_print(words,
                   "%s, %s: no frequencies: it goes one way all the time, from "
                   "%.4g to %.4g: it is not periodic, or the run is too short.",
                   integrator, name, x[0], x[count - 1]);
    else if (line)
        list_print(words,
                   "%s, %s: no frequencies: it changes by %.3g a unit of time "
                   "in the mean, which is most of its motion: it is not "
                   "periodic, or the run is too short.",
                   integrator, name, tx / tt / h);
    return line || is_monotone(x, count);
}

void frequencies_length_words(list *words, const char *integrator,
                              const char *name, double length, double run) {
    if (length < 0.49 * run)
        list_print(words,
                   "%s, %s: of the first %.6g of the run: there is no room for "
                   "more samples as dense as the fastest motion needs.",
                   integrator, name, length);
}

void frequencies_drift_words(list *words, const char *integrator,
                             const char *name, const nevh_spectral_line *l) {
    static const double moving = 1e-6;
    if (isnan(l->drift))
        list_print(words,
                   "%s, %s: a half of the run does not show the first "
                   "frequency: the orbit is chaotic, loses energy, or the run "
                   "is too short to tell lines apart.",
                   integrator, name);
    else if (fabs(l->drift) > moving * l->frequency)
        list_print(words,
                   "%s, %s: the first frequency moves by %.1e between the "
                   "halves of the run: the orbit is chaotic, loses energy, or "
                   "the run is too short to tell lines apart.",
                   integrator, name, l->drift);
}
