/* nevh: why orbits that begin side by side have separated.

   In chaos they do so exponentially, all the time.  At a saddle, or in a close
   pass, they do so once; and shear makes a difference grow by a power of the
   time, which is slow.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnose/reference_private.h"
#include <math.h>

static const double steady = 0.08; /* of all e-foldings, in a quarter */

bool nevh__spread_add(nevh__spread *s, double part, double growth) {
    size_t i = (size_t)(part * NEVH__SPREADS);
    bool another = s->count <= i;
    s->most = fmax(s->most, growth);
    i = i < NEVH__SPREADS ? i : NEVH__SPREADS - 1;
    for (; s->count <= i; s->count++)
        s->folds[s->count] = log(fmax(s->most, 1));
    s->folds[i] = log(fmax(s->most, 1));
    return another;
}

/* Least squares over all of them. */
static double slope(const nevh__spread *s) {
    double x = 0, y = 0, xx = 0, xy = 0, n = (double)s->count;
    for (size_t i = 0; i < s->count; i++) {
        double u = ((double)i + 1) / NEVH__SPREADS;
        x += u, y += s->folds[i], xx += u * u, xy += u * s->folds[i];
    }
    return (xy - x * y / n) / (xx - x * x / n);
}

double nevh__spread_rate(const nevh__spread *s, double time) {
    return s->count > 2 ? slope(s) / fabs(time) : NAN;
}

bool nevh__spread_steady(const nevh__spread *s) {
    int quarters = 0;
    double all = log(s->most), before = 0;
    for (size_t i = 1; i <= 4; i++) {
        size_t last = i * s->count / 4;
        double now = last ? s->folds[last - 1] : 0;
        quarters += now - before >= steady * all;
        before = now;
    }
    return quarters >= 3;
}
