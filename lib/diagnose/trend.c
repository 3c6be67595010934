/* nevh: does a series grow, and along a line?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/trend_private.h"
#include <math.h>

static const double pi = 3.14159265358979323846;
enum { FEWEST = 12 };    /* bins, for an error of the slope */
enum { SLOW_WAVES = 8 }; /* that the error of the slope is made from */

static void merge_neighbours(nevh__trend *s) {
    for (size_t i = 0; i < NEVH__BINS / 2; i++) {
        const nevh__bin *a = &s->bin[2 * i], *b = a + 1;
        s->bin[i] = (nevh__bin){a->t + b->t,
                                a->e + b->e,
                                fmin(a->lowest, b->lowest),
                                fmax(a->highest, b->highest),
                                fmin(a->least, b->least),
                                fmax(a->met, b->met),
                                a->samples + b->samples};
    }
    s->bins = NEVH__BINS / 2;
    s->per_bin *= 2;
}

static void add_to_bin(nevh__trend *s, double t, double e, double met) {
    if (s->bins == 0)
        s->per_bin = 1;
    if (s->bins == 0 || s->bin[s->bins - 1].samples == s->per_bin) {
        if (s->bins == NEVH__BINS)
            merge_neighbours(s);
        s->bin[s->bins++] =
            (nevh__bin){.lowest = e, .highest = e, .least = fabs(e)};
    }
    nevh__bin *bin = &s->bin[s->bins - 1];
    bin->samples++;
    bin->t += t;
    bin->e += e;
    bin->lowest = fmin(bin->lowest, e);
    bin->highest = fmax(bin->highest, e);
    bin->least = fmin(bin->least, fabs(e));
    bin->met = fmax(bin->met, met);
}

void nevh__trend_add(nevh__trend *s, double t, double e, double met) {
    if (s->samples++ == 0)
        s->first_t = t;
    s->last_t = t;
    double dt = t - s->mean_t, count = (double)s->samples;
    s->mean_t += dt / count;
    s->mean_e += (e - s->mean_e) / count;
    s->tt += dt * (t - s->mean_t);
    s->te += dt * (e - s->mean_e);
    s->squares += e * e;
    s->most = fmax(s->most, fabs(e));
    s->last = e;
    add_to_bin(s, t, e, met);
}

void nevh__trend_add_most(nevh__trend *s, size_t samples, double most,
                          double last) {
    s->samples += samples;
    s->most = fmax(s->most, most);
    s->last = last;
    s->bins = 1;
}

void nevh__trend_multiply(nevh__trend *s, double factor) {
    s->squares *= factor * factor;
    s->most *= factor;
    s->last *= factor;
    s->mean_e *= factor;
    s->te *= factor;
    for (size_t i = 0; i < s->bins; i++) {
        s->bin[i].e *= factor;
        s->bin[i].lowest *= factor;
        s->bin[i].highest *= factor;
        s->bin[i].least *= factor;
        s->bin[i].met *= factor;
    }
}

/* The union of some bins. */
static nevh__bin trend_join(const nevh__trend *s, size_t from, size_t to) {
    nevh__bin all = s->bin[from];
    for (size_t i = from + 1; i < to; i++) {
        all.lowest = fmin(all.lowest, s->bin[i].lowest);
        all.highest = fmax(all.highest, s->bin[i].highest);
        all.least = fmin(all.least, s->bin[i].least);
    }
    return all;
}

static double trend_largest(const nevh__trend *s, size_t from, size_t to) {
    nevh__bin all = trend_join(s, from, to);
    return fmax(fabs(all.lowest), fabs(all.highest));
}

/* |error| over the energies met by then. */
static double largest_relative(const nevh__trend *s, size_t from, size_t to) {
    double most = 0;
    for (size_t i = from; i < to; i++)
        if (s->bin[i].met > 0)
            most = fmax(most, trend_largest(s, i, i + 1) / s->bin[i].met);
    return most;
}

/* The means of bins about the line.  Means of bins average out what oscillates
   faster than a bin. */
static void find_residuals(const nevh__trend *s, double slope,
                           double residual[], nevh_energy_report *r) {
    double about_line = 0, about_mean = 0;
    for (size_t i = 0; i < s->bins; i++) {
        double count = (double)s->bin[i].samples;
        double dt = s->bin[i].t / count - s->mean_t;
        double de = s->bin[i].e / count - s->mean_e;
        residual[i] = de - slope * dt;
        about_mean += de * de;
        about_line += residual[i] * residual[i];
    }
    if (about_mean > 0)
        r->straightness = fmax(0, 1 - about_line / about_mean);
}

/* The share of the squares of residuals about the mean that two means explain, one of the
   bins before a time and one of those after it: at the best of such times. */
static void find_jump(const nevh__trend *s, nevh_energy_report *r) {
    double all = 0, squares = 0, sum = 0, most = 0;
    for (size_t i = 0; i < s->bins; i++)
        all += s->bin[i].e / (double)s->bin[i].samples - s->mean_e;
    double mean = s->mean_e + all / (double)s->bins;
    for (size_t i = 0; i < s->bins; i++) {
        double e = s->bin[i].e / (double)s->bin[i].samples - mean;
        double before = (double)(i + 1), after = (double)(s->bins - i - 1);
        squares += e * e;
        sum += e;
        double explained = after > 0 ? sum * sum * (1 / before + 1 / after) : 0;
        if (explained > most) {
            most = explained;
            r->jump_t = s->bin[i + 1].t / (double)s->bin[i + 1].samples;
        }
    }
    r->jump = squares > 0 ? fmin(1, most / squares) : 0;
}

/* The variance that a mean of the residuals has, times the number of bins: from its
   slowest waves, the cosines of one to SLOW_WAVES half periods (but for the
   first, which the line takes away) [U. K. Mueller, J. Econometrics 141 (2007)
   1331-1352]. */
static double slow_power(const double residual[], size_t bins) {
    size_t waves = bins / 4 < SLOW_WAVES ? bins / 4 : SLOW_WAVES;
    double power = 0;
    for (size_t k = 2; k < waves + 2; k++) {
        double sum = 0, angle = pi * (double)k / (double)bins;
        for (size_t i = 0; i < bins; i++)
            sum += residual[i] * cos(angle * ((double)i + 0.5));
        power += 2 * sum * sum / (double)bins;
    }
    return power / (double)waves;
}

static void fit_bins(const nevh__trend *s, nevh_energy_report *r) {
    double residual[NEVH__BINS], tt = 0;
    if (s->bins < 3)
        return;
    find_residuals(s, r->drift, residual, r);
    find_jump(s, r);
    for (size_t i = 0; i < s->bins; i++) {
        double dt = s->bin[i].t / (double)s->bin[i].samples - s->mean_t;
        tt += dt * dt;
    }
    if (s->bins >= FEWEST && tt > 0)
        r->drift_error = sqrt(slow_power(residual, s->bins) / tt);
}

/* The power of t with which the largest |error| grew, from the second quarter
   of so many bins to their second half. */
static double rate(const nevh__trend *s, size_t bins) {
    if (bins < 4)
        return 0;
    double before = trend_largest(s, bins / 4, bins / 2);
    double after = trend_largest(s, bins / 2, bins);
    return before > 0 && after > 0 ? log2(after / before) : 0;
}

/* Between the errors at both ends there is a gap as wide as either varies. */
static bool is_gone(const nevh__bin *a, const nevh__bin *b) {
    double gap = fmax(a->lowest - b->highest, b->lowest - a->highest);
    return gap > 0 &&
           gap > fmin(a->highest - a->lowest, b->highest - b->lowest);
}

void nevh__trend_report(const nevh__trend *s, nevh_energy_report *r) {
    r->samples = s->samples;
    if (s->samples == 0)
        return;
    size_t fifth = s->bins < 5 ? 1 : s->bins / 5;
    nevh__bin first = trend_join(s, 0, fifth);
    nevh__bin last = trend_join(s, s->bins - fifth, s->bins);
    r->max = s->most;
    r->rms = sqrt(s->squares / (double)s->samples);
    r->final = s->last;
    r->drift = s->tt > 0 ? s->te / s->tt : 0;
    fit_bins(s, r);
    r->first_fifth = trend_largest(s, 0, fifth);
    r->last_fifth = trend_largest(s, s->bins - fifth, s->bins);
    r->early = trend_largest(s, 0, s->bins < 8 ? 1 : s->bins / 8);
    for (size_t i = 0, bins = s->bins; i < 3; i++, bins /= 2)
        r->rate[i] = rate(s, bins);
    r->span = fabs(s->last_t - s->first_t);
    r->least = last.least;
    r->gone = is_gone(&first, &last);
    double met = s->bin[fifth - 1].met;
    r->grown = met > 0 ? s->bin[s->bins - 1].met / met : 1;
    r->relative[0] = largest_relative(s, 0, fifth);
    r->relative[1] = largest_relative(s, s->bins - fifth, s->bins);
}
