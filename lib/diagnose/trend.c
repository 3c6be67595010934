/* nevh: does a series grow, and along a line?
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/trend_private.h"
#include <float.h>
#include <math.h>

/* The verdict's rule; see nevh_energy_report. */
static const double unstable_above = 1;
static const double growth_allowed = 2;
static const double rounding = 16 * DBL_EPSILON;
static const double straightness = 0.8;

static void merge_neighbours(nevh__trend *s) {
    for (size_t i = 0; i < NEVH__BINS / 2; i++) {
        const nevh__bin *a = &s->bin[2 * i], *b = a + 1;
        s->bin[i] =
            (nevh__bin){a->t + b->t, a->e + b->e, fmax(a->most, b->most),
                        a->samples + b->samples};
    }
    s->bins = NEVH__BINS / 2;
    s->per_bin *= 2;
}

static void add_to_bin(nevh__trend *s, double t, double e) {
    if (s->bins == 0)
        s->per_bin = 1;
    if (s->bins == 0 || s->bin[s->bins - 1].samples == s->per_bin) {
        if (s->bins == NEVH__BINS)
            merge_neighbours(s);
        s->bin[s->bins++] = (nevh__bin){0};
    }
    nevh__bin *bin = &s->bin[s->bins - 1];
    bin->samples++;
    bin->t += t;
    bin->e += e;
    bin->most = fmax(bin->most, fabs(e));
}

void nevh__trend_add(nevh__trend *s, double t, double e) {
    s->samples++;
    double dt = t - s->mean_t, count = (double)s->samples;
    s->mean_t += dt / count;
    s->mean_e += (e - s->mean_e) / count;
    s->tt += dt * (t - s->mean_t);
    s->te += dt * (e - s->mean_e);
    s->squares += e * e;
    s->most = fmax(s->most, fabs(e));
    s->last = e;
    add_to_bin(s, t, e);
}

static double largest(const nevh__trend *s, size_t from, size_t to) {
    double most = 0;
    for (size_t i = from; i < to; i++)
        most = fmax(most, s->bin[i].most);
    return most;
}

/* Scatter of the bins' means about the line and about their mean.  Means of
   bins average out what oscillates faster than a bin. */
static void fit_bins(const nevh__trend *s, nevh_energy_report *r) {
    double about_line = 0, about_mean = 0, tt = 0;
    for (size_t i = 0; i < s->bins; i++) {
        double count = (double)s->bin[i].samples;
        double dt = s->bin[i].t / count - s->mean_t;
        double de = s->bin[i].e / count - s->mean_e;
        about_mean += de * de;
        about_line += (de - r->drift * dt) * (de - r->drift * dt);
        tt += dt * dt;
    }
    if (s->bins < 3 || tt == 0 || about_mean == 0)
        return;
    r->drift_error = sqrt(about_line / (double)(s->bins - 2) / tt);
    r->straightness = fmax(0, 1 - about_line / about_mean);
}

static nevh_verdict judge(const nevh_energy_report *r) {
    if (!(r->max <= unstable_above))
        return NEVH_UNSTABLE;
    if (r->max <= rounding || r->last_fifth <= growth_allowed * r->first_fifth)
        return NEVH_BOUNDED;
    return r->straightness >= straightness ? NEVH_DRIFTS : NEVH_RANDOM_WALK;
}

void nevh__trend_report(const nevh__trend *s, nevh_energy_report *r) {
    r->samples = s->samples;
    if (s->samples == 0)
        return;
    size_t fifth = s->bins < 5 ? 1 : s->bins / 5;
    r->max = s->most;
    r->rms = sqrt(s->squares / (double)s->samples);
    r->final = s->last;
    r->drift = s->tt > 0 ? s->te / s->tt : 0;
    fit_bins(s, r);
    r->first_fifth = largest(s, 0, fifth);
    r->last_fifth = largest(s, s->bins - fifth, s->bins);
    r->verdict = judge(r);
}
