/* nevh: orbits that outgrow their difference steps, which are found for the sizes
   around the start.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "lost_digits.h"
#include <math.h>

const char digits_lost_why[] =
    "the state has become so large that the steps of the differences are lost "
    "in it: rounding is more than 1e-6 of the gradient; take the exact "
    "gradient";

static double lost_digits_norm(const double x[], size_t n) {
    double sum = 0;
    for (size_t k = 0; k < n; k++)
        sum = hypot(sum, x[k]);
    return sum;
}

static bool has_outgrown(const double now[], const double start[], size_t n) {
    static const double much = 1e4;
    double before = lost_digits_norm(start, n);
    return before > 0 && lost_digits_norm(now, n) > much * before;
}

/* True where there is a gradient, whose size counts from now on. */
static bool lost_digits_take(lost_digits *d, nevh_field *f, size_t n, double t,
                             const double q[], const double p[]) {
    double *slope = tool_allocate(2 * n, sizeof *slope);
    bool there = !nevh_field_gradient(f, 1, &t, q, p, slope, slope + n);
    for (size_t i = 0; there && i < 2; i++)
        d->slope[i] = fmax(d->slope[i], lost_digits_norm(slope + i * n, n));
    tool_release(slope);
    return there;
}

/* False where steps have failed before: their error, not rounding, is what has
   grown. */
static bool is_orbit(const lost_digits *d, const plan *p, nevh_field *f,
                     double t, const double q[], const double m[]) {
    static const double large = 0.1; /* of the terms of H */
    double before, now, start = p->run->t_start;
    double size = d->slope[0] * lost_digits_norm(q, p->n) +
                  d->slope[1] * lost_digits_norm(m, p->n);
    return !nevh_field_value(f, 1, &start, p->q, p->p, &before) &&
           !nevh_field_value(f, 1, &t, q, m, &now) &&
           fabs(now - before) < large * size;
}

bool digits_are_lost(lost_digits *d, const plan *p, nevh_field *f, double t,
                     const double q[], const double m[]) {
    static const double most = 1e-6 / 4; /* of an rms */
    double noise = 0;                    /* in energy, in a unit of time */
    if (!nevh_field_step_count(f) || nevh_field_step_report(f, 0).given)
        return false;
    if (!has_outgrown(q, p->q, p->n) && !has_outgrown(m, p->p, p->n))
        return false;
    if (!d->begun)
        lost_digits_take(d, f, p->n, p->run->t_start, p->q, p->p);
    d->begun = true;
    return lost_digits_take(d, f, p->n, t, q, m) &&
           !nevh_field_energy_floor(f, t, q, m, 1, 1, &noise) &&
           noise > most * d->slope[0] * d->slope[1] &&
           is_orbit(d, p, f, t, q, m);
}
